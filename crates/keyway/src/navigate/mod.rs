//! Driving: a map and a goal -> a route -> one command per cycle. No simulator is needed: a
//! [`Controller`] sees the known map, poses, velocities and scans, and nothing else. A [`Stack`] is
//! its parameters. Fitted to a robot ([`Stack::fit`]) it is what a controller takes; there a local
//! planner or a guide of your own can be put in, as in the example `own_local_planner`.
//!
//! ```
//! use keyway::geometry::{Point, Pose, Velocity};
//! use keyway::map::OccupancyGrid;
//! use keyway::navigate::{Controller, Stack, Step};
//! use keyway::robot::Robot;
//! use keyway::sense::Scan;
//!
//! let (map, robot) = (OccupancyGrid::from_ascii(&["......", "......", "......"]), Robot::small());
//! let (start, goal) = (Point::new(0.5, 1.5), Point::new(5.5, 1.5));
//! let stack = Stack::keyway(&robot).fit(&robot)?;
//! let mut controller = Controller::new(&map, &stack, start, goal)?;
//! // Stand for the odometry, the lidar and the motors of a robot: nothing is seen, each command is obeyed.
//! let (mut pose, mut velocity) = (Pose::new(0.5, 1.5, 0.0), Velocity::ZERO);
//! let nothing = Scan {
//!     angle_min_rad: 0.0,
//!     angle_increment_rad: 0.1,
//!     range_min_m: 0.1,
//!     range_max_m: 3.5,
//!     ranges_m: vec![f64::INFINITY; 63],
//! };
//! let mut cycles = 0;
//! loop {
//!     velocity = match controller.step(pose, velocity, &nothing) {
//!         Step::Drive(command) | Step::Blocked { command, .. } => command,
//!         Step::Arrived => break,
//!     };
//!     pose = pose.after_arc(velocity, robot.cycle_s);
//!     cycles += 1;
//!     assert!(cycles < 300, "5 m at up to 0.5 m/s, in cycles of 0.1 s");
//! }
//! assert!(pose.point().distance(goal) < 0.2);
//! # Ok::<(), keyway::navigate::NavigateError>(())
//! ```

mod blocked;
mod controller;
mod fitted;
mod goal;
mod headings;
mod misfit;
mod progress;
mod recovery;
mod route;
mod stack;
mod stacks;
mod start;
mod under_way;
mod walked_ground;
mod watch;

pub use blocked::{Blocked, Step};
pub use controller::Controller;
pub use fitted::FittedStack;
pub use goal::Goal;
pub use headings::HeadingRange;
pub use misfit::Misfit;
pub use progress::WayProgress;
pub use recovery::{RecoveryCounts, RecoveryKind};
pub use route::NavigateError;
pub use stack::{ControllerConfig, Stack};
pub use start::StartTooNear;
pub use start::touches;
