//! The report of a reproduction, and the rule of its verdicts.

use super::Reproduction;
use super::measure::Measured;
use crate::claims::{AblationReport, Claim, ClaimReport, ExperimentReport};
use serde::Serialize;

/// Rule of the verdicts, in words; it accompanies every list of verdicts.
pub(super) const VERDICT_RULE: &str = "A figure holds if the 95 % interval of its mean change over \
    the maps lies on the side that the paper states, and the mean is at least half of the published \
    change, if there is one; it does not hold if the interval lies on the other side, or below that \
    half; otherwise it is undecided. A statement about all maps holds if it is true on significantly \
    more than nine maps in ten. Times are reported, but not judged. A claim holds if all of its \
    judged figures hold, and does not hold if none holds and some do not; otherwise it is mixed.";

/// Report `keyway.reproduce/2`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReproduceReport {
    /// Name of the format.
    pub schema: &'static str,
    /// Seed of the first map.
    pub seed: u64,
    /// Requested number of maps.
    pub maps: usize,
    /// True if times were measured.
    pub times: bool,
    /// The claims with their verdicts.
    pub claims: Vec<ClaimReport>,
    /// The experiments of the claims.
    pub experiments: Vec<ExperimentReport>,
    /// Ablations of the claims' papers, if requested.
    pub ablations: Vec<AblationReport>,
    /// Paths of the files that were written.
    pub files: Vec<String>,
}

/// Results of all experiments.
#[derive(Clone, Debug)]
pub struct Measurements {
    /// Results of the claims' experiments, each once.
    pub of_claims: Vec<Measured>,
    /// Results of the ablations, in their order.
    pub of_ablations: Vec<Measured>,
}

impl Measurements {
    /// Returns the results of all experiments, those of the claims first.
    pub fn all(&self) -> impl Iterator<Item = &Measured> {
        self.of_claims.iter().chain(&self.of_ablations)
    }
}

impl Reproduction {
    /// Reports measurements, without files.
    pub fn report(&self, measurements: &Measurements) -> ReproduceReport {
        let times = self.request.has_times;
        let claim_report = |claim: &&'static Claim| {
            let name = claim.experiment.name;
            let one = measurements.of_claims.iter().find(|one| one.experiment.name == name)?;
            Some(ClaimReport::new(claim, &one.family, times))
        };
        let experiment = |one: &Measured| ExperimentReport::new(one.experiment, &one.family);
        let both = self.ablations.iter().zip(&measurements.of_ablations);
        ReproduceReport {
            schema: "keyway.reproduce/2",
            seed: self.request.seed,
            maps: self.request.maps,
            times,
            claims: self.claims.iter().filter_map(claim_report).collect(),
            experiments: measurements.of_claims.iter().map(experiment).collect(),
            ablations: both.map(|(ablation, one)| ablation.report(&one.family, times)).collect(),
            files: Vec::new(),
        }
    }
}
