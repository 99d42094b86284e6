//! `keyway reproduce`: claims of the papers -> what they come to over families of maps, and a verdict on each.

mod experiment_figures;
mod figure_rows;
mod figures;
mod known;
mod map_rows;
mod markdown;
mod measure;
mod page;
mod paper;
mod stage;
mod table;
mod variants;
mod words;

use super::{Done, print};
use crate::args::{Format, ReproduceArgs};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use crate::stdout::print_files;
use experiment_figures::{names_of_experiment, of_experiment};
use figure_rows::figure_rows;
use keyway_lab::claims::{
    Ablation, AblationReport, Claim, ClaimReport, Experiment, ExperimentReport,
};
use keyway_lab::results::Journal;
use keyway_lab::results::OutDir;
use keyway_lab::table::csv;
use known::{Known, Line};
use map_rows::map_rows;
use measure::{Measured, Work};
use page::Pictures;
use serde::Serialize;

/// What was measured on each map, and again as a table; the report, its figures as tables, and the page.
const LINES: &str = "maps.jsonl";
const MAPS: &str = "maps.csv";
const JSON: &str = "report.json";
const CSV: &str = "claims.csv";
const TEX: &str = "claims.tex";
const TABLES: &str = "tables.md";
const PAGE: &str = "report.html";

/// What is said of verdicts wherever there are any.
const VERDICT_RULE: &str = "A claim holds when each of its figures goes the published way, the 95 % interval of its mean change over the \
    maps excludes zero, and the mean is at least half of the published change; it holds in part when one figure does so with such an interval; \
    otherwise it does not hold. Where nothing comparable was published, the sign decides. What is to be so always has to be so on every map, \
    and in part on more than half of them with a certainty of 95 %.";

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
    /// Of the claims' papers, if they were asked for.
    ablations: Vec<AblationReport>,
    files: Vec<String>,
}

pub(crate) fn run(args: &ReproduceArgs) -> Result<Done, CliError> {
    let claims = chosen(&args.claims)?;
    let is_asked = |ablation: &&Ablation| {
        args.ablations && claims.iter().any(|claim| claim.paper == ablation.paper)
    };
    let asked = Asked { ablations: Ablation::all().filter(is_asked).collect(), claims };
    let tables = [LINES, MAPS, JSON, CSV, TEX, TABLES, PAGE].map(str::to_owned);
    let names: Vec<String> = tables.into_iter().chain(asked.figures()).collect();
    let mut out = prepare(&args.out, &names)?;
    let mut journal = Journal::<Line>::open(&out)?;
    let known = Known::of(&out.earlier(LINES)?.unwrap_or_default(), journal.take());
    let measured = Work::new(args, known, &mut journal).measure(&asked.experiments())?;
    let report = write(&asked, &measured, args, &mut out)?;
    out.finish()?;
    journal.remove();
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

/// What is to be measured.
struct Asked {
    claims: Vec<&'static Claim>,
    ablations: Vec<&'static Ablation>,
}

impl Asked {
    /// The experiments, each once.
    fn experiments(&self) -> Vec<&'static Experiment> {
        let of_ablations = self.ablations.iter().map(|ablation| ablation.experiment);
        experiments(&self.claims).into_iter().chain(of_ablations).collect()
    }

    /// The names of all pictures that there may be.
    fn figures(&self) -> Vec<String> {
        let of_ablations = self.ablations.iter().flat_map(|ablation| variants::names(ablation));
        let of_claims = self.claims.iter().flat_map(|claim| figures::names_of_claim(claim));
        let of_experiments =
            experiments(&self.claims).into_iter().flat_map(|one| names_of_experiment(one.name));
        of_claims.chain(of_experiments).chain(of_ablations).collect()
    }
}

/// Writes all files; what they say is the report.
fn write(
    asked: &Asked,
    measured: &[Measured],
    args: &ReproduceArgs,
    out: &mut OutDir,
) -> Result<ReproduceReport, CliError> {
    let mut report = report(asked, measured, args);
    // A claim that an experiment is measured for; those of the claims come first.
    let of_experiments = measured.iter().take(report.experiments.len()).map(|one| {
        let claim = asked.claims.iter().find(|it| it.experiment.name == one.experiment.name);
        of_experiment(one, claim.map_or("", |claim| claim.id), args)
    });
    let of_claims = report.claims.iter().map(|claim| figures::of_claim(claim, args));
    let of_ablations = report.ablations.iter().map(|one| variants::figures(one, args));
    let pictures = Pictures {
        claims: of_claims.collect(),
        experiments: of_experiments.collect::<Result<_, _>>()?,
        ablations: of_ablations.collect(),
    };
    let lines = measured.iter().flat_map(|one| &one.lines);
    // A line is plain data with string keys: this cannot fail.
    let line = |line| serde_json::to_string(line).unwrap_or_default() + "\n";
    let lines: String = lines.map(line).collect();
    let all = pictures.claims.iter().chain(&pictures.experiments);
    let all = all.chain(&pictures.ablations).flatten();
    let tables = [
        (LINES, lines),
        (MAPS, csv(&map_rows(measured))),
        (CSV, csv(&figure_rows(&report.claims))),
        (TEX, paper::latex(&report.claims)),
        (TABLES, markdown::markdown(&report)),
        (PAGE, page::page(&report, &pictures)),
    ];
    let svgs = all.map(|figure| (figure.file.as_str(), figure.svg.as_str()));
    let texts = tables.iter().map(|(name, text)| (*name, text.as_str())).chain(svgs);
    let texts: Vec<(&str, &str)> = texts.collect();
    let names = std::iter::once(JSON).chain(texts.iter().map(|(name, _)| *name));
    report.files = names.map(|name| out.path(name).display().to_string()).collect();
    out.write(JSON, crate::json::to_string(&report).as_bytes())?;
    texts.iter().try_for_each(|(name, text)| out.write(name, text.as_bytes()))?;
    Ok(report)
}

fn report(asked: &Asked, measured: &[Measured], args: &ReproduceArgs) -> ReproduceReport {
    let times = !args.no_times;
    let claim_report = |claim: &&'static Claim| {
        let name = claim.experiment.name;
        let one = measured.iter().find(|one| one.experiment.name == name)?;
        Some(ClaimReport::new(claim, &one.family, times))
    };
    // Those of the claims come first.
    let of_claims = measured.iter().take(experiments(&asked.claims).len());
    ReproduceReport {
        schema: "keyway.reproduce/1",
        seed: args.seed,
        maps: args.maps,
        times,
        claims: asked.claims.iter().filter_map(claim_report).collect(),
        experiments: of_claims
            .map(|one| ExperimentReport::new(one.experiment, &one.family))
            .collect(),
        ablations: variants::reports(&asked.ablations, measured, times),
        files: Vec::new(),
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
    for experiment in claims.iter().map(|claim| claim.experiment) {
        if all.iter().all(|known| known.name != experiment.name) {
            all.push(experiment);
        }
    }
    all
}
