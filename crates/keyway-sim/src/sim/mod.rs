//! A simulated world with robots and their lidars. Controllers are closures, and the simulation
//! does not depend on their decision logic.
//!
//! [`simulate`] drives one or several robots in the same world at the same time. They sense each
//! other and may collide. A scan does not show which objects move, so each controller interprets
//! the other robots itself. A [`keyway::navigate::Navigator`] tracks moving objects if its stack
//! has `controller.movers`. Otherwise the controller treats everything as static: it does not run
//! into a stationary robot, but two robots that drive towards each other may collide.
//!
//! Moving obstacles follow their own path, or give way to robots and to each other
//! ([`ObstacleMotion::GivesWay`]).
//!
//! A participant may be disturbed ([`Disturbances`]): faulty scans, delayed, weak or inexact
//! motors, and localisation errors. The record shows the true motion.
//!
//! ```
//! use keyway::geometry::{Disc, Point, Pose, Velocity};
//! use keyway::map::OccupancyGrid;
//! use keyway::robot::Robot;
//! use keyway::sense::Observation;
//! use keyway_sim::sim::{
//!     Action, Control, Disturbances, Obstacle, Outcome, Participant, RunRules, World, simulate,
//! };
//!
//! let map = OccupancyGrid::from_ascii(&["........", "........"]);
//! let post = Disc::new(Point::new(5.0, 1.0), 0.25);
//! let world = World::from_known(&map, vec![post])?;
//! let (robot, start, goal) = (Robot::small(), Pose::new(1.0, 1.0, 0.0), Point::new(7.0, 1.0));
//! let radius_m = robot.footprint.inscribed_radius_m();
//! let mut nearest_m = f64::INFINITY;
//! let mut straight_on = |&Observation { pose, scans, .. }: &Observation<'_>| {
//!     // There is none in a cycle without a scan.
//!     let ranges_m = scans.iter().flat_map(|one| one.scan.ranges_m.iter());
//!     nearest_m = ranges_m.fold(nearest_m, f64::min);
//!     // Whatever is seen.
//!     let action = Action::Drive(Velocity::new(0.3, 0.0));
//!     let remaining_m = pose.point().distance(goal);
//!     Control { action, remaining_m, turn_left_rad: 0.0, route: 0 }
//! };
//! // An ideal robot.
//! let ideal = Disturbances::default;
//! let rules = RunRules::default();
//! let one = Participant {
//!     robot: &robot,
//!     start,
//!     goal,
//!     disturbances: ideal(),
//!     rules,
//!     controller: &mut straight_on,
//! };
//! let run = simulate(&world, &mut [one])?.remove(0);
//! assert!(matches!(run.outcome, Outcome::Collided { with: Obstacle::Circle(0), .. }));
//! // Until the footprint touched the post.
//! assert!((run.length_m - (4.0 - 0.25 - radius_m)).abs() < 1e-3);
//!
//! // Another robot stands in its way.
//! let mut stay = |_: &Observation<'_>| Control {
//!     action: Action::Stop,
//!     remaining_m: 4.0,
//!     turn_left_rad: 0.0,
//!     route: 0,
//! };
//! let there = Pose::new(3.0, 1.0, 0.0);
//! let rules = RunRules::default;
//! let mut both = [
//!     Participant {
//!         robot: &robot,
//!         start,
//!         goal,
//!         disturbances: ideal(),
//!         rules: rules(),
//!         controller: &mut straight_on,
//!     },
//!     Participant {
//!         robot: &robot,
//!         start: there,
//!         goal,
//!         disturbances: ideal(),
//!         rules: rules(),
//!         controller: &mut stay,
//!     },
//! ];
//! let runs = simulate(&world, &mut both)?;
//! assert!(matches!(runs[0].outcome, Outcome::Collided { with: Obstacle::Robot(1), .. }));
//! assert!(matches!(runs[1].outcome, Outcome::Collided { with: Obstacle::Robot(0), .. }));
//! assert!((runs[0].length_m - (2.0 - 2.0 * radius_m)).abs() < 1e-3);
//! assert!(nearest_m < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cycle_motion;
mod disturbances;
mod drive;
mod elusive;
mod fleet;
mod free_squares;
mod giving_way;
mod lidar;
mod mover;
mod overlapping;
mod participant;
mod rules;
mod run;
mod social_force;
mod standing_polygon;
mod stepper;
mod sweep;
#[cfg(test)]
mod test_shapes;
mod world;

pub use disturbances::{ActuationFaults, Disturbances, LocalisationFaults, SensorFaults};
pub use drive::{SimError, simulate, simulate_on};
pub use elusive::{ElusiveObstacle, ElusiveShape, Presence};
pub use mover::{
    KeyFrame, KeyFrames, MovingObstacle, ObstacleMotion, RandomWalk, RandomWalkConfig, Spline,
    WayPoints,
};
pub use participant::{Action, Control, Participant};
pub use rules::{Arrival, ReachedBy, RunRules};
pub use run::{MoverWay, Outcome, RobotState, Run, TrajectoryPoint};
pub use standing_polygon::StandingPolygon;
pub use stepper::Stepper;
pub use world::{Obstacle, World, WorldAt, WorldError};
