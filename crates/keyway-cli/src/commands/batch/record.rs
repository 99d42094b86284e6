//! What is kept of a run.

use super::clutter::occupied_share;
use super::plan::Planned;
use keyway::episode::{Episode, EpisodeOutcome, EpisodeReport};
use keyway::report::RunPart;
use serde::{Deserialize, Serialize};

/// Which run it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RunId<'a> {
    pub(super) scene: &'a str,
    pub(super) stack: &'a str,
    pub(super) seed: u64,
    /// Of all that the run depends on.
    pub(super) digest: &'a str,
}

/// A finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) run: Row,
    pub(super) measured: Measured,
}

/// A line of `runs.jsonl` and `runs.csv`: the same whenever and wherever it is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) stack: String,
    pub(super) seed: u64,
    pub(super) occupied_share: Option<f64>,
    pub(super) outcome: EpisodeOutcome,
    /// Whether the robot drove or stood at the contact that ended the run.
    pub(super) contact: Option<ContactWhile>,
    /// How fast the obstacle moved that was touched, if it was one that moves \[m/s\].
    pub(super) mover_speed_mps: Option<f64>,
    /// Whether it had just jumped there.
    pub(super) jumped_onto: Option<bool>,
    pub(super) time_s: Option<f64>,
    pub(super) length_m: Option<f64>,
    pub(super) mean_speed_mps: Option<f64>,
    pub(super) min_clearance_m: Option<f64>,
    pub(super) min_standing_clearance_m: Option<f64>,
    pub(super) min_mover_clearance_m: Option<f64>,
    pub(super) routes_planned: Option<u32>,
    /// All kinds together.
    pub(super) recoveries: Option<u32>,
    pub(super) unsafe_commands: Option<u32>,
    pub(super) v_variation_mps: Option<f64>,
    pub(super) omega_variation_radps: Option<f64>,
    /// As the three that follow: the measures of MRPB.
    pub(super) min_distance_m: Option<f64>,
    pub(super) share_near: Option<f64>,
    pub(super) path_smoothness_m2: Option<f64>,
    pub(super) velocity_smoothness_mps2: Option<f64>,
    pub(super) reference_time_s: Option<f64>,
    /// Success times reference over time, the latter between twice and eight times the reference: at most 0.5.
    pub(super) score: Option<f64>,
    pub(super) reason: Option<String>,
    /// How many of the random obstacles found no place.
    pub(super) left_out: Option<u32>,
    /// Of all that the run depends on.
    pub(super) digest: String,
}

/// What a robot did when it was touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ContactWhile {
    Driving,
    Standing,
}

/// What is never the same twice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Measured {
    /// Wall clock of the whole run \[s\].
    pub(super) wall_s: f64,
    /// Mean wall clock of a decision \[us\].
    pub(super) mean_cycle_us: Option<f64>,
}

impl Measured {
    pub(super) fn of(report: &EpisodeReport, wall_s: f64) -> Self {
        Self { wall_s, mean_cycle_us: report.run.as_ref().and_then(|run| run.mean_cycle_us) }
    }
}

impl Row {
    pub(super) fn id(&self) -> RunId<'_> {
        let Self { scene, stack, seed, digest, .. } = self;
        RunId { scene, stack, seed: *seed, digest }
    }
}

impl Record {
    pub(super) fn of(
        planned: &Planned,
        episode: &Episode,
        report: &EpisodeReport,
        reference_time_s: Option<f64>,
        measured: Measured,
    ) -> Self {
        let outcome = report.outcome;
        let run = report.run.as_ref();
        let time_s = run.map(|run| run.time_s);
        let touched = run.and_then(|run| run.contact);
        let contact = touched.map(|contact| {
            if contact.robot_stood { ContactWhile::Standing } else { ContactWhile::Driving }
        });
        let score =
            reference_time_s.map(|best_s| score(outcome, time_s.unwrap_or_default(), best_s));
        let of = |get: fn(&RunPart) -> f64| run.map(get);
        let mrpb = run.map(|run| run.mrpb);
        let run = Row {
            scene: planned.scene.clone(),
            stack: planned.stack.clone(),
            seed: planned.seed,
            occupied_share: occupied_share(episode),
            outcome,
            contact,
            mover_speed_mps: touched.and_then(|contact| contact.mover_speed_mps),
            jumped_onto: touched.map(|contact| contact.jumped_onto),
            time_s,
            length_m: of(|run| run.length_m),
            mean_speed_mps: run.and_then(|run| run.mean_speed_mps),
            min_clearance_m: run.and_then(|run| run.min_clearance_m),
            min_standing_clearance_m: run.and_then(|run| run.min_standing_clearance_m),
            min_mover_clearance_m: run.and_then(|run| run.min_mover_clearance_m),
            routes_planned: run.map(|run| run.routes_planned),
            recoveries: run.map(|run| run.recoveries.total()),
            unsafe_commands: run.and_then(|run| run.unsafe_commands).map(|counts| counts.total()),
            v_variation_mps: of(|run| run.v_variation_mps),
            omega_variation_radps: of(|run| run.omega_variation_radps),
            min_distance_m: mrpb.and_then(|mrpb| mrpb.min_distance_m),
            share_near: mrpb.and_then(|mrpb| mrpb.share_near),
            path_smoothness_m2: mrpb.map(|mrpb| mrpb.path_smoothness_m2),
            velocity_smoothness_mps2: mrpb.and_then(|mrpb| mrpb.velocity_smoothness_mps2),
            reference_time_s,
            score,
            reason: report.reason.clone(),
            left_out: report.inputs.random.map(|placed| placed.left_out()),
            digest: planned.digest.clone(),
        };
        Self { run, measured }
    }
}

/// The score of BARN.
fn score(outcome: EpisodeOutcome, time_s: f64, best_s: f64) -> f64 {
    if outcome == EpisodeOutcome::Reached {
        best_s / time_s.clamp(2.0 * best_s, 8.0 * best_s)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_by_hand() {
        let reached = |time_s| score(EpisodeOutcome::Reached, time_s, 6.0);
        assert_eq!([reached(5.0), reached(12.0), reached(24.0)], [0.5, 0.5, 0.25]);
        assert_eq!(reached(99.0), 0.125);
        assert_eq!(score(EpisodeOutcome::Stuck, 12.0, 6.0), 0.0);
    }
}
