//! `keyway reproduce`: claims of the papers -> what they come to over families of maps, and a verdict on each.

mod figure_rows;
mod map_rows;
mod measure;
mod table;

use super::{Done, print};
use crate::args::{Format, ReproduceArgs};
use crate::csv_text::csv;
use crate::error::{CliError, Kind};
use crate::out_dir::OutDir;
use crate::stdout::print_files;
use figure_rows::figure_rows;
use keyway::claims::{Claim, ClaimReport, Experiment, ExperimentReport};
use map_rows::map_rows;
use measure::{Measured, measure};
use serde::Serialize;

/// The report, its figures as a table, and what was measured on each map.
const FILES: [&str; 3] = ["report.json", "claims.csv", "maps.csv"];

/// `keyway.reproduce/1`.
#[derive(Serialize)]
struct ReproduceReport {
    schema: &'static str,
    /// The first of the maps' seeds.
    seed: u64,
    /// How many maps were asked for.
    maps: usize,
    /// Whether times were measured.
    times: bool,
    claims: Vec<ClaimReport>,
    experiments: Vec<ExperimentReport>,
    files: Vec<String>,
}

pub(crate) fn run(args: &ReproduceArgs) -> Result<Done, CliError> {
    let claims = chosen(&args.claims)?;
    let mut out = OutDir::prepare(&args.out, &FILES)?;
    let measured = measure(&experiments(&claims), args)?;
    let report = report(&claims, &measured, (args, &out));
    let [json, figures, maps] = FILES;
    out.write(json, crate::json::to_string(&report).as_bytes())?;
    out.write(figures, csv(&figure_rows(&report.claims)).as_bytes())?;
    out.write(maps, csv(&map_rows(&measured)).as_bytes())?;
    out.finish()?;
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&table::table(&report.claims))?;
            table::notes(&report.claims, &report.experiments)
                .iter()
                .try_for_each(|it| print(it))?;
            print_files(&report.files)?;
        }
    }
    Ok(Done::Success)
}

fn report(
    claims: &[&'static Claim],
    measured: &[Measured],
    (args, out): (&ReproduceArgs, &OutDir),
) -> ReproduceReport {
    let family_of = |claim: &Claim| {
        let name = claim.experiment?.name;
        measured.iter().find(|one| one.experiment.name == name).map(|one| &one.family)
    };
    let times = !args.no_times;
    ReproduceReport {
        schema: "keyway.reproduce/1",
        seed: args.seed,
        maps: args.maps,
        times,
        claims: claims
            .iter()
            .map(|claim| ClaimReport::new(claim, family_of(claim), times))
            .collect(),
        experiments: measured
            .iter()
            .map(|one| ExperimentReport::new(one.experiment, &one.family))
            .collect(),
        files: FILES.iter().map(|name| out.path(name).display().to_string()).collect(),
    }
}

/// The claims of all names, each once, in the order of the papers.
fn chosen(names: &[String]) -> Result<Vec<&'static Claim>, CliError> {
    let mut ids = Vec::new();
    for name in names {
        let named = Claim::named(name);
        if named.is_empty() {
            let message = format!(
                "there is no claim `{name}`; expected one such as S0-1, or s0, s1, s2, s4 or all; all of them: {}",
                Claim::all().map(|claim| claim.id).collect::<Vec<_>>().join(", ")
            );
            return Err(CliError::new(Kind::Usage, message).field("CLAIM"));
        }
        ids.extend(named.iter().map(|claim| claim.id));
    }
    Ok(Claim::all().filter(|claim| ids.contains(&claim.id)).collect())
}

/// The experiments of claims, each once.
fn experiments(claims: &[&'static Claim]) -> Vec<&'static Experiment> {
    let mut all: Vec<&'static Experiment> = Vec::new();
    for experiment in claims.iter().filter_map(|claim| claim.experiment) {
        if all.iter().all(|known| known.name != experiment.name) {
            all.push(experiment);
        }
    }
    all
}
