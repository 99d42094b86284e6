//! `keyway pdf`: pictures as PDF, for LaTeX.

use super::Done;
use crate::args::PdfArgs;
use crate::error::{CliError, Kind};
use crate::out_file::write_file;
use crate::stdout::print_files;
use keyway_draw::Svg;

pub(crate) fn run(args: &PdfArgs) -> Result<Done, CliError> {
    let mut files = Vec::new();
    for path in &args.pictures {
        // Checked beforehand, so that a wrong name leaves no files.
        if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("svg")) {
            let message = format!("{}: give the SVG file of the picture", path.display());
            return Err(CliError::new(Kind::Usage, message).field("<FILE.svg>"));
        }
    }
    for path in &args.pictures {
        let blamed = |kind, error: &dyn std::fmt::Display| {
            CliError::new(kind, format!("{}: {error}", path.display())).field("<FILE.svg>")
        };
        let text = std::fs::read_to_string(path).map_err(|error| blamed(Kind::Input, &error))?;
        let pdf = Svg::from_text(text).to_pdf().map_err(|error| blamed(Kind::Input, &error))?;
        let to = path.with_extension("pdf");
        write_file(&to, &pdf, "<FILE.svg>")?;
        files.push(to.display().to_string());
    }
    print_files(&files)?;
    Ok(Done::Success)
}
