//! Navigation: a map and a goal -> a route -> one command per cycle. No simulator is needed: a
//! [`Navigator`] takes the known map, poses, velocities and scans, and nothing else. A [`Stack`]
//! holds its parameters. A navigator takes a stack that is fitted to a robot ([`Stack::fit`]), in
//! which parts can be replaced by custom ones, as in the example `own_local_planner`.
//!
//! ```
//! use keyway::geometry::{Point, Pose, Velocity};
//! use keyway::map::OccupancyGrid;
//! use keyway::navigate::{Navigator, Stack, Step};
//! use keyway::robot::Robot;
//! use keyway::sense::{Observation, Scan, SensorScan};
//!
//! let (map, robot) = (OccupancyGrid::from_ascii(&["......", "......", "......"]), Robot::small());
//! let stack = Stack::keyway(&robot).fit(&robot)?;
//! let mut navigator = Navigator::new(&map, &stack)?;
//! // Stand for the odometry, the lidar and the motors of a robot: nothing is seen, each command is obeyed.
//! let (mut pose, mut velocity) = (Pose::new(0.5, 1.5, 0.0), Velocity::ZERO);
//! let nothing = Scan {
//!     angle_min_rad: 0.0,
//!     angle_increment_rad: 0.1,
//!     range_min_m: 0.1,
//!     range_max_m: 3.5,
//!     ranges_m: vec![f64::INFINITY; 63],
//! };
//! navigator.relocate(pose);
//! let goal = Point::new(5.5, 1.5);
//! navigator.set_goal(goal)?;
//! let mut stamp_s = 0.0;
//! loop {
//!     let scans = [SensorScan::centred(stamp_s, &nothing)];
//!     navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
//!     let step = navigator.step();
//!     if step == Step::Arrived {
//!         break;
//!     }
//!     velocity = step.command();
//!     pose = pose.after_arc(velocity, robot.cycle_s);
//!     stamp_s += robot.cycle_s;
//!     assert!(stamp_s < 30.0, "5 m at up to 0.5 m/s");
//! }
//! assert!(pose.point().distance(goal) < 0.2);
//! # Ok::<(), keyway::navigate::NavigateError>(())
//! ```

mod act;
mod blocked;
mod doubts;
mod encounter;
mod error;
mod fitted;
mod goal;
mod headings;
mod layers;
mod masks;
mod met;
mod misfit;
mod mode;
mod motors;
mod navigator;
mod plan_job;
mod poses;
mod progress;
mod recovery;
mod restore_error;
mod route;
mod snapshot;
mod stack;
mod stacks;
mod start;
mod task;
mod time;
mod walked_ground;
mod watch;
mod world;

pub use blocked::{Blocked, Step};
pub use doubts::{Doubt, ScanFault};
pub use error::NavigateError;
pub use fitted::FittedStack;
pub use goal::Goal;
pub use headings::HeadingRange;
pub use masks::{Masks, SpeedMask};
pub use misfit::Misfit;
pub use navigator::Navigator;
pub use plan_job::{PlanJob, Planned};
pub use progress::{WayLeft, WayProgress};
pub use recovery::{RecoveryCounts, RecoveryKind};
pub use restore_error::RestoreError;
pub use snapshot::Snapshot;
pub use stack::{ControllerConfig, IfWayPointBlocked, Stack};
pub use start::StartTooNear;
pub use start::touches;
