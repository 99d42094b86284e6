//! Output files named on the command line: each is written completely or not at all.

use crate::args::{AnimationFile, AnimationFormat};
use crate::error::{CliError, Kind};
use crate::progress::picture_bar;
use keyway::file_system::write_atomically;
use keyway_draw::{Animation, DrawError};
use std::path::Path;

/// Writes a file. An error blames the option that requested it.
pub(crate) fn write_file(path: &Path, bytes: &[u8], field: &str) -> Result<(), CliError> {
    write_atomically(path, bytes).map_err(|error| CliError::new(Kind::Output, error).field(field))
}

/// Writes an animation. `make` receives a callback for the number of pictures drawn so far and
/// their total, which drives a progress bar.
pub(crate) fn write_animation(
    file: &AnimationFile,
    field: &str,
    make: impl FnOnce(&mut dyn FnMut(usize, usize)) -> Result<Animation, DrawError>,
) -> Result<(), CliError> {
    let bar = picture_bar();
    let animation = make(&mut |done, of| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    let bytes = animation.and_then(|animation| match file.format {
        AnimationFormat::Gif => animation.to_gif(),
        AnimationFormat::Apng => animation.to_apng(),
    });
    let bytes = bytes.map_err(|error| CliError::new(Kind::Output, error).field(field))?;
    write_file(&file.path, &bytes, field)
}
