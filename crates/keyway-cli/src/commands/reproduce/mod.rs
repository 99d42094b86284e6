//! `keyway reproduce`: measures the papers' claims over families of maps, and gives a verdict on
//! each.

mod experiment_figures;
mod figures;
mod stage;
mod variants;

use super::{Done, print};
use crate::args::{Format, ReproduceArgs};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use crate::progress::Progress;
use crate::stdout::print_files;
use experiment_figures::{names_of_experiment, of_experiment};
use keyway_lab::reproduce::{
    FILES, Measurements, PageParts, REPORT_FILE, ReproduceError, ReproduceReport, ReproduceRequest,
    Reproduction, claims_notes, claims_table, text_files,
};
use keyway_lab::results::{Journal, OutDir};

pub(crate) fn run(args: &ReproduceArgs) -> Result<Done, CliError> {
    let reproduction = request(args).check()?;
    let names: Vec<String> =
        FILES.into_iter().map(str::to_owned).chain(figure_names(&reproduction)).collect();
    let mut out = prepare(&args.out, &names)?;
    let mut journal = Journal::open(&out)?;
    let progress = Progress::over_maps();
    let measurements = reproduction.measure(&out, &mut journal, &progress)?;
    drop(progress);
    let report = write(&reproduction, &measurements, &mut out)?;
    out.finish()?;
    journal.remove();
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&claims_table(&report.claims))?;
            claims_notes(&report).iter().try_for_each(|it| print(it))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::Success)
}

fn request(args: &ReproduceArgs) -> ReproduceRequest {
    ReproduceRequest {
        claims: args.claims.clone(),
        has_ablations: args.ablations,
        maps: args.maps,
        seed: args.seed,
        jobs: args.jobs,
        has_times: !args.no_times,
    }
}

/// The names of all possible pictures.
fn figure_names(reproduction: &Reproduction) -> impl Iterator<Item = String> {
    let of_claims = reproduction.claims().iter().flat_map(|claim| figures::names_of_claim(claim));
    let experiments = reproduction.experiments().into_iter();
    let of_experiments = experiments.flat_map(|one| names_of_experiment(one.name));
    let of_ablations = reproduction.ablations().iter().flat_map(|one| variants::names(one));
    of_claims.chain(of_experiments).chain(of_ablations)
}

/// Writes all files; their content is that of the report.
fn write(
    reproduction: &Reproduction,
    measurements: &Measurements,
    out: &mut OutDir,
) -> Result<ReproduceReport, CliError> {
    let mut report = reproduction.report(measurements);
    let parts = page_parts(reproduction, measurements, &report)?;
    let texts = text_files(&report, measurements, &parts);
    let texts = texts.iter().map(|file| (file.name, file.text.as_str()));
    let svgs = parts.figures().map(|figure| (figure.file.as_str(), figure.svg.as_str()));
    let files: Vec<(&str, &str)> = texts.chain(svgs).collect();
    let names = std::iter::once(REPORT_FILE).chain(files.iter().map(|(name, _)| *name));
    report.files = names.map(|name| out.path(name).display().to_string()).collect();
    out.write(REPORT_FILE, crate::json::to_string(&report).as_bytes())?;
    files.iter().try_for_each(|(name, text)| out.write(name, text.as_bytes()))?;
    Ok(report)
}

/// All pictures, and the commands of the page.
fn page_parts(
    reproduction: &Reproduction,
    measurements: &Measurements,
    report: &ReproduceReport,
) -> Result<PageParts, CliError> {
    let request = reproduction.request();
    let of_experiments = measurements.of_claims.iter().map(|one| {
        let mut claims = reproduction.claims().iter();
        let claim = claims.find(|claim| claim.experiment.name == one.experiment.name);
        of_experiment(one, claim.map_or("", |claim| claim.id), request)
    });
    Ok(PageParts {
        claims: report.claims.iter().map(|claim| figures::of_claim(claim, request)).collect(),
        experiments: of_experiments.collect::<Result<_, _>>()?,
        ablations: report.ablations.iter().map(|one| variants::figures(one, request)).collect(),
        command: |id| format!("keyway reproduce {id} --out DIR"),
    })
}

impl From<ReproduceError> for CliError {
    fn from(error: ReproduceError) -> Self {
        let argument = error.field().map(|field| match field {
            "claims" => "CLAIM",
            "maps" => "--maps",
            field => field,
        });
        let kind = match error {
            ReproduceError::Results(error) => return error.into(),
            ReproduceError::NoClaim { .. } | ReproduceError::TooFewMaps { .. } => Kind::Usage,
            _ => Kind::Config,
        };
        Self { field: argument.map(str::to_owned), ..Self::new(kind, error) }
    }
}
