//! What is reported of a simulated run.

use crate::metrics::{Mrpb, RunMetrics};
use crate::sim::{Mover, MoverWay, Obstacle, Outcome, Run, Sample};
use keyway::geometry::Point;
use keyway::local::RefusalCounts;
use keyway::navigate::RecoveryCounts;
use serde::Serialize;

/// What was measured of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunPart {
    /// Simulated time until the run ended \[s\].
    pub time_s: f64,
    /// Distance driven \[m\].
    pub length_m: f64,
    /// Distance over time \[m/s\]; `None` where no time passed.
    pub mean_speed_mps: Option<f64>,
    /// Smallest distance from the footprint to any real obstacle \[m\]; `None` without obstacles.
    pub min_clearance_m: Option<f64>,
    /// The same from obstacles that stand; `None` without any.
    pub min_standing_clearance_m: Option<f64>,
    /// The same from obstacles that move; `None` without any.
    pub min_mover_clearance_m: Option<f64>,
    /// The contact that ended the run; `None` without one.
    pub contact: Option<ContactPart>,
    /// Control cycles driven.
    pub cycles: u64,
    /// Mean wall clock of a decision \[us\]; `None` without a clock, or without a decision.
    pub mean_cycle_us: Option<f64>,
    /// Searches for a route, those that found none or the same way again included: the first one;
    /// one each time a scan shows something on the route, or no place of it is in sight; one at
    /// each way-point, and one after each wait where there was no route; and those of the
    /// recoveries.
    pub routes_planned: u32,
    /// What was tried because the robot got no farther.
    pub recoveries: RecoveryCounts,
    /// Commands that the stop rule changed; `None` without one.
    pub unsafe_commands: Option<RefusalCounts>,
    /// Each way-point, and when it was passed; `None` without way-points.
    pub way_points: Option<Vec<WayPointPart>>,
    /// Where obstacles that give way were; not written where none does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gave_way: Vec<MoverWay>,
    /// Changes of the turning direction per metre driven \[1/m\]; `None` where nothing was driven.
    pub omega_sign_changes_per_m: Option<f64>,
    /// Total variation of the speed \[m/s\].
    pub v_variation_mps: f64,
    /// Total variation of the turn rate \[rad/s\].
    pub omega_variation_radps: f64,
    /// The measures of MRPB.
    pub mrpb: Mrpb,
}

/// A way-point of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WayPointPart {
    /// Where it is \[m\].
    pub position: Point,
    /// When the robot passed it \[s\]; `None`: never.
    pub passed_s: Option<f64>,
}

/// What a controller did in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Controlled {
    /// Searches for a route, those that found none or the same way again included: the first one;
    /// one each time a scan shows something on the route, or no place of it is in sight; one at
    /// each way-point, and one after each wait where there was no route; and those of the
    /// recoveries.
    pub routes_planned: u32,
    /// What was tried because the robot got no farther.
    pub recoveries: RecoveryCounts,
    /// Commands that the stop rule changed; `None` without one.
    pub unsafe_commands: Option<RefusalCounts>,
    /// The way-points.
    pub way_points: Vec<WayPointPart>,
    /// Mean wall clock of a decision \[us\].
    pub mean_cycle_us: Option<f64>,
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactPart {
    /// When \[s\].
    pub t_s: f64,
    /// Where the robot was \[m\].
    pub at: Point,
    /// What it touched.
    pub with: Obstacle,
    /// Whether the robot stood or, as a disc, turned on the spot: it was run into, or began in contact.
    pub robot_stood: bool,
    /// Whether what it touched had jumped there within the last cycle, unforeseeably.
    pub jumped_onto: bool,
    /// How fast it moved then \[m/s\]; `None` where it was nothing that moves.
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
        let Controlled { routes_planned, recoveries, unsafe_commands, way_points, mean_cycle_us } =
            controlled;
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
            mrpb,
        }
    }
}

impl RunPart {
    /// The obstacles that move, as they did in this run: those that give way go where they went.
    pub fn movers(&self, given: &[Mover]) -> Vec<Mover> {
        let mut movers = given.to_vec();
        for way in &self.gave_way {
            if let Some(mover) = movers.get_mut(way.index) {
                *mover = way.mover(mover);
            }
        }
        movers
    }
}

/// One sample as `[t_s, x_m, y_m, yaw_rad, v_mps, omega_radps]`.
pub fn trajectory_row(sample: &Sample) -> [f64; 6] {
    let Sample { t_s, pose, velocity } = *sample;
    [t_s, pose.x, pose.y, pose.theta, velocity.v, velocity.omega]
}
