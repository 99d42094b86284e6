//! Claims of the papers, measured over families of maps, with a verdict on each.
//!
//! A [`ReproduceRequest`] is checked once and returns a [`Reproduction`], which measures all
//! experiments, writes each finished map into a journal, and reports. [`text_files`] returns the
//! tables and the page of the report. The caller draws the pictures.

mod error;
mod figure_rows;
mod files;
mod kept;
mod latex;
mod map_rows;
mod markdown;
mod measure;
mod page;
mod report;
mod terminal;
mod words;

pub use error::ReproduceError;
pub use files::{FILES, REPORT_FILE, TextFile, text_files};
pub use kept::{MapGroup, MapLine};
pub use measure::Measured;
pub use page::{PageFigure, PageParts};
pub use report::{Measurements, ReproduceReport};
pub use terminal::{claims_notes, claims_table};
pub use words::{measure_name, measured_text, published_of, published_text, statement};

use crate::claims::{Ablation, Claim, Experiment};
use crate::progress::Progress;
use crate::results::{Journal, OutDir};
use files::LINES;
use kept::KeptLines;
use keyway_sim::parallel::processors;
use measure::Work;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// Smallest number of maps for which an interval exists.
const LEAST_MAPS: usize = 2;

/// Claims to measure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReproduceRequest {
    /// Names of claims, of papers, or `all` ([`Claim::named`]).
    pub claims: Vec<String>,
    /// True if the ablations of the claims' papers are measured, too.
    pub has_ablations: bool,
    /// Number of maps for each claim; at least 2.
    pub maps: usize,
    /// Seed of the first map; the following maps have the following numbers.
    pub seed: u64,
    /// Number of maps that are measured in parallel; `None`: the number of processors. It does
    /// not affect the results.
    pub jobs: Option<usize>,
    /// True if times are measured; they differ from run to run.
    pub has_times: bool,
}

/// A checked request.
#[derive(Clone, Debug)]
pub struct Reproduction {
    request: ReproduceRequest,
    claims: Vec<&'static Claim>,
    ablations: Vec<&'static Ablation>,
}

impl ReproduceRequest {
    /// Checks the request.
    ///
    /// # Errors
    /// Returns [`ReproduceError`] if a name has no claim, or there are too few maps.
    pub fn check(self) -> Result<Reproduction, ReproduceError> {
        if self.maps < LEAST_MAPS {
            return Err(ReproduceError::TooFewMaps { maps: self.maps });
        }
        let claims = chosen(&self.claims)?;
        let is_asked = |ablation: &&Ablation| {
            self.has_ablations && claims.iter().any(|claim| claim.paper == ablation.paper)
        };
        let ablations = Ablation::all().filter(is_asked).collect();
        Ok(Reproduction { request: self, claims, ablations })
    }
}

impl Reproduction {
    /// Returns the request.
    pub const fn request(&self) -> &ReproduceRequest {
        &self.request
    }

    /// Returns the claims, each once, in the order of the papers.
    pub fn claims(&self) -> &[&'static Claim] {
        &self.claims
    }

    /// Returns the requested ablations.
    pub fn ablations(&self) -> &[&'static Ablation] {
        &self.ablations
    }

    /// Returns the experiments of the claims, each once.
    pub fn experiments(&self) -> Vec<&'static Experiment> {
        let mut all: Vec<&'static Experiment> = Vec::new();
        for experiment in self.claims.iter().map(|claim| claim.experiment) {
            if all.iter().all(|known| known.name != experiment.name) {
                all.push(experiment);
            }
        }
        all
    }

    /// Measures all experiments. Each finished map is appended to the journal. Maps that are in the
    /// journal, or in earlier results of the folder, are not measured again.
    ///
    /// # Errors
    /// Returns [`ReproduceError`] if a file of the folder cannot be used, or the observer stops
    /// the measurement.
    pub fn measure(
        &self,
        out: &OutDir,
        journal: &mut Journal<MapLine>,
        progress: &dyn Progress,
    ) -> Result<Measurements, ReproduceError> {
        let kept = KeptLines::new(&out.earlier(LINES)?.unwrap_or_default(), journal.take());
        let ReproduceRequest { maps, seed, jobs, has_times, .. } = self.request.clone();
        let mut work = Work {
            maps,
            seed,
            jobs: jobs.unwrap_or_else(processors),
            has_times,
            kept,
            journal: Mutex::new(journal),
            progress,
            is_stopped: AtomicBool::new(false),
            fitted: BTreeMap::new(),
        };
        let of_ablations: Vec<_> = self.ablations.iter().map(|it| it.experiment).collect();
        Ok(Measurements {
            of_claims: work.measure(&self.experiments())?,
            of_ablations: work.measure(&of_ablations)?,
        })
    }
}

/// Returns the claims of all names, each once, in the order of the papers.
fn chosen(names: &[String]) -> Result<Vec<&'static Claim>, ReproduceError> {
    let mut ids = Vec::new();
    for name in names {
        let named = Claim::named(name);
        if named.is_empty() {
            return Err(ReproduceError::NoClaim { name: name.clone() });
        }
        ids.extend(named.iter().map(|claim| claim.id));
    }
    Ok(Claim::all().filter(|claim| ids.contains(&claim.id)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::Verdict;
    use std::ops::ControlFlow;
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Stops the work after this many answers.
    struct Stopping(AtomicUsize);

    impl Progress for Stopping {
        fn expect(&self, _: usize) {}

        fn answered(&self) -> ControlFlow<()> {
            match self.0.fetch_sub(1, Ordering::Relaxed) {
                0 | 1 => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        }
    }

    fn request(claims: &[&str]) -> ReproduceRequest {
        ReproduceRequest {
            claims: claims.iter().map(|&name| name.to_owned()).collect(),
            has_ablations: false,
            maps: 2,
            seed: 1,
            jobs: Some(1),
            has_times: false,
        }
    }

    fn measure(folder: &Path, progress: &dyn Progress) -> Result<Measurements, ReproduceError> {
        let out = OutDir::prepare(folder, &FILES)?;
        let mut journal = Journal::open(&out)?;
        request(&["S4-6"]).check()?.measure(&out, &mut journal, progress)
    }

    #[test]
    fn requests_are_checked_once() {
        let named = |names: &[&str]| -> Vec<&str> {
            request(names).check().unwrap().claims.iter().map(|claim| claim.id).collect()
        };
        assert_eq!(named(&["S4-6", "s0-2", "S4-6"]), ["S0-2", "S4-6"]);
        let both = request(&["S2-2", "S2-3"]);
        let with_parts = ReproduceRequest { has_ablations: true, ..both.clone() }.check().unwrap();
        assert_eq!(with_parts.ablations.len(), 2);
        assert!(both.check().unwrap().ablations.is_empty());
        let error = request(&["S0-1", "S9"]).check().unwrap_err();
        let text = "there is no claim `S9`; expected a claim such as S0-1, a paper (s0, s1, s2, s4) or all; \
                    the claims are S0-1, S0-2";
        assert!(error.to_string().starts_with(text), "{error}");
        assert_eq!(error.field(), Some("claims"));
        let few = ReproduceRequest { maps: 1, ..request(&["S0-1"]) }.check().unwrap_err();
        assert_eq!(few.to_string(), "`maps` must be at least 2, got 1");
        assert_eq!(few.field(), Some("maps"));
    }

    #[test]
    fn a_stopped_measurement_goes_on_where_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let stopped = measure(folder.path(), &Stopping(AtomicUsize::new(2)));
        assert!(matches!(stopped, Err(ReproduceError::Stopped)), "{stopped:?}");
        let journal = folder.path().join(crate::results::JOURNAL_NAME);
        let held = std::fs::read_to_string(&journal).unwrap();
        assert_eq!(held.lines().count(), 2);
        // A mark that a new measurement would not have.
        let marked = held.replacen("\"expanded\":", "\"expanded\":1000", 1);
        std::fs::write(&journal, &marked).unwrap();
        let measurements = measure(folder.path(), &()).unwrap();
        let lines: Vec<&MapLine> = measurements.all().flat_map(|one| &one.lines).collect();
        let first = serde_json::to_string(lines[0]).unwrap();
        assert_eq!(first, marked.lines().next().unwrap());
        assert!(lines.len() > 2);
    }

    #[test]
    fn files_and_report_are_about_the_same_claims() {
        let folder = tempfile::tempdir().unwrap();
        let measurements = measure(folder.path(), &()).unwrap();
        let report = request(&["S4-6"]).check().unwrap().report(&measurements);
        assert_eq!((report.claims.len(), report.experiments.len()), (1, 1));
        assert_ne!(report.claims[0].verdict, Verdict::NotMeasured);
        let figure = PageFigure { file: "a.svg".to_owned(), svg: "<svg/>".to_owned() };
        let parts = PageParts {
            claims: vec![vec![figure]],
            experiments: vec![Vec::new()],
            ablations: Vec::new(),
            command: |id| format!("measure {id}"),
        };
        let files = text_files(&report, &measurements, &parts);
        let names: Vec<&str> = files.iter().map(|file| file.name).collect();
        assert!(names.iter().all(|name| FILES.contains(name) && *name != REPORT_FILE));
        assert_eq!(names.len() + 1, FILES.len());
        let page = &files.iter().find(|file| file.name == "report.html").unwrap().text;
        assert!(page.contains("<svg/>") && page.contains("measure S4-6"), "{page}");
        assert!(claims_table(&report.claims).contains("S4-6"));
    }
}
