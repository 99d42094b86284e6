//! A line of the results of a batch.

use keyway_sim::episode::{EpisodeOutcome, EpisodeReport};
use keyway_sim::report::RunPart;
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

/// A line of `runs.jsonl` and `runs.csv`: the same whenever and wherever it is made. Or one of `robots.jsonl` and `robots.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    pub(super) scene: String,
    pub(super) stack: String,
    pub(super) seed: u64,
    /// Which of several robots it is; `None`: the run as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) robot: Option<u32>,
    pub(super) occupied_share: Option<f64>,
    pub(super) outcome: EpisodeOutcome,
    /// How many it is of.
    pub(super) robots: u32,
    /// How many of them reached their goals.
    pub(super) robots_reached: u32,
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
    /// Between two robots; `None` where there is only one.
    pub(super) min_robot_clearance_m: Option<f64>,
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

impl Row {
    pub(super) fn id(&self) -> RunId<'_> {
        let Self { scene, stack, seed, digest, .. } = self;
        RunId { scene, stack, seed: *seed, digest }
    }
}

/// What all robots of a run have in common.
pub(super) struct World {
    pub(super) occupied_share: Option<f64>,
    pub(super) reference_time_s: Option<f64>,
}

impl Row {
    /// Of one robot.
    pub(super) fn of(id: RunId<'_>, report: &EpisodeReport, world: &World) -> Self {
        let outcome = report.outcome;
        let run = report.run.as_ref();
        let time_s = run.map(|run| run.time_s);
        let touched = run.and_then(|run| run.contact);
        let contact = touched.map(|contact| {
            if contact.robot_stood { ContactWhile::Standing } else { ContactWhile::Driving }
        });
        let &World { occupied_share, reference_time_s } = world;
        let of = |get: fn(&RunPart) -> f64| run.map(get);
        let mrpb = run.map(|run| run.mrpb);
        Self {
            scene: id.scene.to_owned(),
            stack: report.inputs.stack.clone().unwrap_or_default(),
            seed: id.seed,
            robot: None,
            occupied_share,
            outcome,
            robots: 1,
            robots_reached: u32::from(outcome == EpisodeOutcome::Reached),
            contact,
            mover_speed_mps: touched.and_then(|contact| contact.mover_speed_mps),
            jumped_onto: touched.map(|contact| contact.jumped_onto),
            time_s,
            length_m: of(|run| run.length_m),
            mean_speed_mps: run.and_then(|run| run.mean_speed_mps),
            min_clearance_m: run.and_then(|run| run.min_clearance_m),
            min_standing_clearance_m: run.and_then(|run| run.min_standing_clearance_m),
            min_mover_clearance_m: run.and_then(|run| run.min_mover_clearance_m),
            min_robot_clearance_m: None,
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
            score: reference_time_s.map(|best_s| score(outcome, time_s, best_s)),
            reason: report.reason.clone(),
            left_out: report.inputs.random.map(|placed| placed.left_out()),
            digest: id.digest.to_owned(),
        }
    }
}

/// The score of BARN.
pub(super) fn score(outcome: EpisodeOutcome, time_s: Option<f64>, best_s: f64) -> f64 {
    match time_s {
        Some(time_s) if outcome == EpisodeOutcome::Reached => {
            best_s / time_s.clamp(2.0 * best_s, 8.0 * best_s)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Of a robot that reached its goal after 10 s and 4 m.
    pub(in crate::commands::batch) fn reached(robot: u32) -> Row {
        let text = r#"{"scene":"a","stack":"b","seed":1,"occupied_share":0.1,"outcome":"reached","robots":1,"robots_reached":1,
            "time_s":10.0,"length_m":4.0,"mean_speed_mps":0.4,"min_clearance_m":0.3,"routes_planned":2,"recoveries":1,
            "v_variation_mps":1.0,"omega_variation_radps":2.0,"share_near":0.1,"reference_time_s":4.0,"score":0.4,"digest":"c"}"#;
        Row { robot: Some(robot), ..serde_json::from_str(text).unwrap() }
    }

    #[test]
    fn the_score_by_hand() {
        let reached = |time_s| score(EpisodeOutcome::Reached, Some(time_s), 6.0);
        assert_eq!([reached(5.0), reached(12.0), reached(24.0)], [0.5, 0.5, 0.25]);
        assert_eq!(reached(99.0), 0.125);
        assert_eq!(score(EpisodeOutcome::Stuck, Some(12.0), 6.0), 0.0);
    }
}
