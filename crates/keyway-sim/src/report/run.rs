//! Report of a simulated run.

use crate::metrics::{Mrpb, RunMetrics};
use crate::sim::{MoverWay, MovingObstacle, Obstacle, Outcome, Run, TrajectoryPoint};
use keyway::geometry::Point;
use keyway::local::RefusalCounts;
use keyway::navigate::RecoveryCounts;
use serde::Serialize;

/// Metrics of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunPart {
    /// Simulated time until the run ended \[s\].
    pub time_s: f64,
    /// Distance driven \[m\].
    pub length_m: f64,
    /// Distance over time \[m/s\]; `None` for a run of zero duration.
    pub mean_speed_mps: Option<f64>,
    /// Smallest distance from the footprint to any true obstacle \[m\]; `None` without obstacles.
    pub min_clearance_m: Option<f64>,
    /// Smallest distance from the footprint to static obstacles \[m\]; `None` without any.
    pub min_standing_clearance_m: Option<f64>,
    /// Smallest distance from the footprint to moving obstacles \[m\]; `None` without any.
    pub min_mover_clearance_m: Option<f64>,
    /// The contact that ended the run; `None` without one.
    pub contact: Option<ContactPart>,
    /// Control cycles driven.
    pub cycles: u64,
    /// Mean wall-clock time of a decision \[us\]; `None` without a clock, or without a decision.
    pub mean_cycle_us: Option<f64>,
    /// Searches for a route, including searches that found none or the same route again: the
    /// first one; one each time a scan shows an obstacle on the route, or no point of the route
    /// is in sight; one at each way-point; one after each wait without a route; and the searches
    /// of the recoveries.
    pub routes_planned: u32,
    /// Recoveries that were tried because the robot made no progress.
    pub recoveries: RecoveryCounts,
    /// Commands that the stop rule changed; `None` without a stop rule.
    pub unsafe_commands: Option<RefusalCounts>,
    /// Each way-point with the time at which it was passed; `None` without way-points.
    pub way_points: Option<Vec<WayPointPart>>,
    /// Positions of the obstacles that give way; omitted if none does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gave_way: Vec<MoverWay>,
    /// Sign changes of the turn rate per metre driven \[1/m\]; `None` without driven distance.
    pub omega_sign_changes_per_m: Option<f64>,
    /// Total variation of the speed \[m/s\].
    pub v_variation_mps: f64,
    /// Total variation of the turn rate \[rad/s\].
    pub omega_variation_radps: f64,
    /// Largest jerk of the commands: the change of their acceleration from cycle to cycle, per
    /// time \[m/s³\].
    pub max_jerk_mps3: f64,
    /// Largest angular jerk of the commands \[rad/s³\].
    pub max_angular_jerk_radps3: f64,
    /// MRPB metrics.
    pub mrpb: Mrpb,
}

/// A way-point of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WayPointPart {
    /// Position \[m\].
    pub position: Point,
    /// Time at which the robot passed it \[s\]; `None` if it did not.
    pub passed_s: Option<f64>,
}

/// Metrics of a controller in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Controlled {
    /// Searches for a route, including searches that found none or the same route again: the
    /// first one; one each time a scan shows an obstacle on the route, or no point of the route
    /// is in sight; one at each way-point; one after each wait without a route; and the searches
    /// of the recoveries.
    pub routes_planned: u32,
    /// Recoveries that were tried because the robot made no progress.
    pub recoveries: RecoveryCounts,
    /// Commands that the stop rule changed; `None` without a stop rule.
    pub unsafe_commands: Option<RefusalCounts>,
    /// The way-points.
    pub way_points: Vec<WayPointPart>,
    /// Mean wall-clock time of a decision \[us\].
    pub mean_cycle_us: Option<f64>,
    /// Largest jerk of the commands \[m/s³\].
    pub max_jerk_mps3: f64,
    /// Largest angular jerk of the commands \[rad/s³\].
    pub max_angular_jerk_radps3: f64,
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactPart {
    /// Time of the contact \[s\].
    pub t_s: f64,
    /// Position of the robot \[m\].
    pub at: Point,
    /// Obstacle that was touched.
    pub with: Obstacle,
    /// True if the robot was stationary or, as a disc, turned on the spot: the obstacle ran into
    /// it, or the run began in contact.
    pub robot_stood: bool,
    /// True if the obstacle had jumped there within the last cycle, unpredictably.
    pub jumped_onto: bool,
    /// Speed of the obstacle at the contact \[m/s\]; `None` if it was not a moving obstacle.
    pub mover_speed_mps: Option<f64>,
}

impl ContactPart {
    fn of(run: &Run) -> Option<Self> {
        let Outcome::Collided { pose, with, robot_stood, jumped_onto, mover_speed_mps } =
            run.outcome
        else {
            return None;
        };
        let t_s = run.samples.last()?.t_s;
        Some(Self { t_s, at: pose.point(), with, robot_stood, jumped_onto, mover_speed_mps })
    }
}

impl RunPart {
    /// Measures a run.
    pub fn of(run: &Run, mrpb: Mrpb, controlled: Controlled) -> Self {
        let Controlled {
            routes_planned,
            recoveries,
            unsafe_commands,
            way_points,
            mean_cycle_us,
            max_jerk_mps3,
            max_angular_jerk_radps3,
        } = controlled;
        let metrics = RunMetrics::of_run(run);
        Self {
            time_s: metrics.time_s,
            length_m: metrics.length_m,
            mean_speed_mps: metrics.mean_speed_mps,
            min_clearance_m: metrics.min_clearance_m,
            min_standing_clearance_m: metrics.min_standing_clearance_m,
            min_mover_clearance_m: metrics.min_mover_clearance_m,
            contact: ContactPart::of(run),
            cycles: run.cycles,
            mean_cycle_us,
            routes_planned,
            recoveries,
            unsafe_commands,
            way_points: (!way_points.is_empty()).then_some(way_points),
            gave_way: run.movers.clone(),
            omega_sign_changes_per_m: metrics.omega_sign_changes_per_m,
            v_variation_mps: metrics.v_variation_mps,
            omega_variation_radps: metrics.omega_variation_radps,
            max_jerk_mps3,
            max_angular_jerk_radps3,
            mrpb,
        }
    }
}

impl RunPart {
    /// Moving obstacles as they moved in this run: those that give way follow their recorded
    /// positions.
    pub fn movers(&self, given: &[MovingObstacle]) -> Vec<MovingObstacle> {
        let mut movers = given.to_vec();
        for way in &self.gave_way {
            if let Some(mover) = movers.get_mut(way.index) {
                *mover = way.mover(mover);
            }
        }
        movers
    }
}

/// Returns one sample as `[t_s, x_m, y_m, yaw_rad, v_mps, omega_radps]`.
pub fn trajectory_row(sample: &TrajectoryPoint) -> [f64; 6] {
    let TrajectoryPoint { t_s, pose, velocity } = *sample;
    [t_s, pose.x, pose.y, pose.theta, velocity.v, velocity.omega]
}
