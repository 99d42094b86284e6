//! A simulated world, robot and lidar. The controller comes in as a closure; nothing here knows how
//! it decides.
//!
//! ```
//! use keyway::geometry::{Point, Pose, Velocity};
//! use keyway::map::OccupancyGrid;
//! use keyway::robot::Robot;
//! use keyway::sim::{Action, Circle, Control, Obstacle, Outcome, RunRules, World, simulate};
//!
//! let map = OccupancyGrid::from_ascii(&["........", "........"]);
//! let post = Circle::standing(Point::new(5.0, 1.0), 0.25);
//! let world = World::from_known(&map, vec![post])?;
//! let (robot, start, goal) = (Robot::small(), Pose::new(1.0, 1.0, 0.0), Point::new(7.0, 1.0));
//! let mut nearest_m = f64::INFINITY;
//! let run = simulate(&world, &robot, start, goal, &RunRules::default(), |pose, _, scan| {
//!     nearest_m = scan.ranges_m.iter().copied().fold(nearest_m, f64::min);
//!     // Straight on, whatever is seen.
//!     let action = Action::Drive(Velocity::new(0.3, 0.0));
//!     Control { action, remaining_m: pose.point().distance(goal), route: 0 }
//! })?;
//! assert!(matches!(run.outcome, Outcome::Collided { with: Obstacle::Circle(0), .. }));
//! // Until the footprint touched the post.
//! assert!((run.length_m - (4.0 - 0.25 - robot.footprint.inscribed_radius_m())).abs() < 1e-3);
//! assert!(nearest_m < 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod drive;
mod lidar;
mod motion;
mod world;

pub use drive::{Action, Control, Outcome, Run, RunRules, Sample, SimError, simulate};
pub use world::{Circle, Obstacle, World, WorldAt, WorldError};
