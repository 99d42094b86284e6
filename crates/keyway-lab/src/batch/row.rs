//! Row of the results of a batch.

use keyway_sim::episode::{EpisodeOutcome, RobotReport};
use keyway_sim::report::RunPart;
use serde::{Deserialize, Serialize};

/// Identifier of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RunId<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Name of the stack.
    pub stack: &'a str,
    /// Seed of the run.
    pub seed: u64,
    /// Digest of all inputs of the run.
    pub digest: &'a str,
}

/// A line of `runs.jsonl` and `runs.csv`, or one of `robots.jsonl` and `robots.csv`; it is
/// deterministic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Name of the stack.
    pub stack: String,
    /// Seed of the run.
    pub seed: u64,
    /// Number of the robot among several; `None` for the run as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<u32>,
    /// Occupied share of the map.
    pub occupied_share: Option<f64>,
    /// End of the run.
    pub outcome: EpisodeOutcome,
    /// Number of robots.
    pub robots: u32,
    /// Robots that reached their goals.
    pub robots_reached: u32,
    /// Motion state of the robot at the contact that ended the run.
    pub contact: Option<ContactWhile>,
    /// Speed of the moving obstacle that was touched \[m/s\].
    pub mover_speed_mps: Option<f64>,
    /// True if the obstacle had just jumped there.
    pub jumped_onto: Option<bool>,
    /// Simulated time \[s\].
    pub time_s: Option<f64>,
    /// Length of the driven path \[m\].
    pub length_m: Option<f64>,
    /// Mean speed \[m/s\].
    pub mean_speed_mps: Option<f64>,
    /// Least clearance from any obstacle \[m\].
    pub min_clearance_m: Option<f64>,
    /// Least clearance from static obstacles \[m\].
    pub min_standing_clearance_m: Option<f64>,
    /// Least clearance from moving obstacles \[m\].
    pub min_mover_clearance_m: Option<f64>,
    /// Least clearance between two robots \[m\]; `None` if there is only one.
    pub min_robot_clearance_m: Option<f64>,
    /// Searches for a route.
    pub routes_planned: Option<u32>,
    /// Recoveries of all kinds.
    pub recoveries: Option<u32>,
    /// Commands that the stop rule changed.
    pub unsafe_commands: Option<u32>,
    /// Total variation of the speed \[m/s\].
    pub v_variation_mps: Option<f64>,
    /// Total variation of the turn rate \[rad/s\].
    pub omega_variation_radps: Option<f64>,
    /// Least distance from an obstacle \[m\]; this and the next three are metrics of MRPB.
    pub min_distance_m: Option<f64>,
    /// Share of the time spent nearer than the safe distance.
    pub share_near: Option<f64>,
    /// Smoothness of the path \[m²\].
    pub path_smoothness_m2: Option<f64>,
    /// Smoothness of the velocity \[m/s²\].
    pub velocity_smoothness_mps2: Option<f64>,
    /// `rules.reference_time_s` of the scene \[s\].
    pub reference_time_s: Option<f64>,
    /// Score: success times reference time over time, with the time clamped to two to eight times
    /// the reference; at most 0.5.
    pub score: Option<f64>,
    /// Reason why the goal was not reached.
    pub reason: Option<String>,
    /// Random obstacles that could not be placed.
    pub left_out: Option<u32>,
    /// Digest of all inputs of the run.
    pub digest: String,
}

/// Motion state of a robot at a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactWhile {
    /// The robot was driving.
    Driving,
    /// The robot was stationary.
    Standing,
}

impl Row {
    /// Identifier of the run.
    pub fn id(&self) -> RunId<'_> {
        let Self { scene, stack, seed, digest, .. } = self;
        RunId { scene, stack, seed: *seed, digest }
    }
}

/// Values that all robots of a run share.
pub(super) struct World {
    /// Occupied share of the map.
    pub occupied_share: Option<f64>,
    /// `rules.reference_time_s` of the scene \[s\].
    pub reference_time_s: Option<f64>,
}

impl Row {
    /// True if all robots reached their goals.
    pub(super) fn has_reached(&self) -> bool {
        self.outcome == EpisodeOutcome::Reached
    }

    /// Returns the row of one robot.
    pub(super) fn of(id: RunId<'_>, report: &RobotReport, world: &World) -> Self {
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

    /// Row of a robot that reached its goal after 10 s and 4 m.
    pub(in crate::batch) fn reached(robot: u32) -> Row {
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
