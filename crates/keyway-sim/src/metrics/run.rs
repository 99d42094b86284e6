//! Metrics of a simulated run.

use super::path::{JUMP_DEG, SAMPLE_M};
use crate::sim::{Outcome, Run};
use keyway::geometry::wrap_angle;
use serde::{Deserialize, Serialize};

/// Turn rates up to this are rounding errors and have no sign \[rad/s\].
const STRAIGHT_RADPS: f64 = 1e-9;

/// Metrics of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunMetrics {
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Simulated time from the start to the end \[s\]; for a run that reached its goal, until it
    /// was within the tolerance.
    pub time_s: f64,
    /// Distance driven \[m\].
    pub length_m: f64,
    /// Distance driven over time \[m/s\]; `None` for a run of zero duration.
    pub mean_speed_mps: Option<f64>,
    /// The footprint's smallest clearance from an obstacle \[m\]; `None` without obstacles.
    pub min_clearance_m: Option<f64>,
    /// The footprint's smallest clearance from static obstacles \[m\].
    pub min_standing_clearance_m: Option<f64>,
    /// The footprint's smallest clearance from moving obstacles \[m\].
    pub min_mover_clearance_m: Option<f64>,
    /// Sign changes of the turn rate per metre driven \[1/m\], ignoring intervals with a turn
    /// rate of 0; `None` without driven distance.
    pub omega_sign_changes_per_m: Option<f64>,
    /// Total variation of the speed: sum of its absolute changes from cycle to cycle \[m/s\].
    pub v_variation_mps: f64,
    /// Total variation of the turn rate \[rad/s\].
    pub omega_variation_radps: f64,
}

impl RunMetrics {
    /// Measures a run from its driven velocities. Costs a few operations per cycle.
    pub fn of_run(run: &Run) -> Self {
        let time_s = run.samples.last().map_or(0.0, |sample| sample.t_s);
        let velocities = || run.samples.iter().map(|sample| sample.velocity);
        let sign_changes = count_sign_changes(velocities().map(|velocity| velocity.omega));
        let length_m = run.length_m;
        Self {
            outcome: run.outcome,
            time_s,
            length_m,
            mean_speed_mps: (time_s > 0.0).then(|| length_m / time_s),
            min_clearance_m: run.min_clearance_m,
            min_standing_clearance_m: run.min_standing_clearance_m,
            min_mover_clearance_m: run.min_mover_clearance_m,
            omega_sign_changes_per_m: (length_m > 0.0).then(|| sign_changes as f64 / length_m),
            v_variation_mps: total_variation(velocities().map(|velocity| velocity.v)),
            omega_variation_radps: total_variation(velocities().map(|velocity| velocity.omega)),
        }
    }
}

fn count_sign_changes(omegas: impl Iterator<Item = f64>) -> usize {
    let mut previous = 0.0;
    let mut changes = 0;
    for omega in omegas.filter(|omega| omega.abs() > STRAIGHT_RADPS) {
        changes += usize::from(omega * previous < 0.0);
        previous = omega.signum();
    }
    changes
}

/// Returns the number of points at which the heading of a run jumps, as on a curve: changes of
/// more than 5 degrees between points of the driven path 1 cm apart, such as a turn on the spot.
/// Turns before the first and after the last of these points do not count. Costs a few operations
/// per sample and per centimetre.
pub fn count_run_heading_jumps(run: &Run) -> usize {
    let (mut s_m, mut jumps, mut before_rad) = (0.0, 0, None);
    let mut next_m = 0.0;
    for pair in run.samples.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let driven_m = 0.5 * (from.velocity.v + to.velocity.v).abs() * (to.t_s - from.t_s);
        let turned_rad = wrap_angle(to.pose.theta - from.pose.theta);
        while driven_m > 0.0 && next_m <= s_m + driven_m {
            let heading_rad = from.pose.theta + turned_rad * (next_m - s_m) / driven_m;
            let is_jump = |before_rad: f64| {
                wrap_angle(heading_rad - before_rad).abs() > JUMP_DEG.to_radians()
            };
            jumps += usize::from(before_rad.is_some_and(is_jump));
            before_rad = Some(heading_rad);
            next_m += SAMPLE_M;
        }
        s_m += driven_m;
    }
    jumps
}

fn total_variation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values
        .clone()
        .zip(values.skip(1))
        .fold(0.0, |sum, (before, after)| sum + (after - before).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::TrajectoryPoint;
    use keyway::geometry::{Pose, Velocity};

    fn run(velocities: &[(f64, f64)], length_m: f64) -> Run {
        let sample = |(i, &(v, omega)): (usize, &(f64, f64))| TrajectoryPoint {
            t_s: i as f64 * 0.5,
            pose: Pose::default(),
            velocity: Velocity::new(v, omega),
        };
        Run {
            outcome: Outcome::Reached,
            samples: velocities.iter().enumerate().map(sample).collect(),
            length_m,
            min_clearance_m: Some(0.25),
            min_standing_clearance_m: Some(0.5),
            min_mover_clearance_m: Some(0.25),
            min_robot_clearance_m: None,
            movers: Vec::new(),
            cycles: velocities.len() as u64 - 1,
        }
    }

    #[test]
    fn measures_by_hand() {
        let driven = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.0), (0.5, -1.0), (0.5, 1e-12), (0.0, -0.5)];
        let metrics = RunMetrics::of_run(&run(&driven, 2.0));
        assert_eq!((metrics.time_s, metrics.mean_speed_mps), (2.5, Some(0.8)));
        // Once, from + to -; 1e-12 is rounding.
        assert_eq!(metrics.omega_sign_changes_per_m, Some(0.5));
        assert_eq!(metrics.v_variation_mps, 2.0);
        assert!((metrics.omega_variation_radps - 4.5).abs() < 1e-9);
        assert_eq!(metrics.min_clearance_m, Some(0.25));
        assert_eq!(metrics.min_standing_clearance_m, Some(0.5));
    }

    #[test]
    fn a_weave_on_one_side_changes_no_sign() {
        let driven = [(0.5, 0.1), (0.5, 0.9), (0.5, 0.1), (0.5, 0.0), (0.5, 0.2)];
        let metrics = RunMetrics::of_run(&run(&driven, 1.0));
        assert_eq!(metrics.omega_sign_changes_per_m, Some(0.0));
        assert_eq!(metrics.v_variation_mps, 0.0);
    }

    /// The velocity within a cycle is interpolated linearly, and the heading is that of the pose.
    #[test]
    fn a_turn_on_the_spot_is_a_jump_and_a_bend_is_none() {
        let count = |states: &[(f64, f64)]| {
            let sample = |(i, &(v, theta_deg)): (usize, &(f64, f64))| TrajectoryPoint {
                t_s: i as f64 * 0.5,
                pose: Pose::new(0.0, 0.0, theta_deg.to_radians()),
                velocity: Velocity::new(v, 0.0),
            };
            let samples = states.iter().enumerate().map(sample).collect();
            count_run_heading_jumps(&Run { samples, ..run(&[(0.0, 0.0)], 0.0) })
        };
        // 10 degrees over 25 cm; on the spot; within 1.25 cm; across +/-180 degrees.
        assert_eq!(count(&[(0.5, 0.0), (0.5, 10.0), (0.5, 10.0)]), 0);
        let spot = [(0.5, 0.0), (0.0, 0.0), (0.0, 10.0), (0.0, 20.0), (0.5, 20.0)];
        assert_eq!(count(&spot), 1);
        assert_eq!(count(&[(0.5, 0.0), (0.025, 0.0), (0.025, 10.0), (0.5, 10.0)]), 1);
        assert_eq!(count(&[(0.5, 178.0), (0.0, 178.0), (0.0, -179.0), (0.5, -179.0)]), 0);
        // Before and after the path.
        assert_eq!(count(&[(0.0, 0.0), (0.0, 90.0), (0.5, 90.0), (0.0, 90.0), (0.0, 0.0)]), 0);
    }

    #[test]
    fn a_run_of_no_time() {
        let metrics = RunMetrics::of_run(&run(&[(0.0, 0.0)], 0.0));
        assert_eq!((metrics.time_s, metrics.mean_speed_mps), (0.0, None));
        assert_eq!(metrics.omega_sign_changes_per_m, None);
        let text = serde_json::to_string(&metrics).unwrap();
        assert_eq!(serde_json::from_str::<RunMetrics>(&text).unwrap(), metrics);
    }
}
