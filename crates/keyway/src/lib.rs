//! Mobile-robot path planning on occupancy grids.
//!
//! A global search finds a route, and a smoother makes it short and safe. A local planner, which
//! searches space-time trajectories, follows it among unmapped obstacles. This is the default
//! stack, `keyway`. Others, such as dynamic window approaches, are available by name. A robot has a
//! differential drive or car-like steering, and up to eight lidars.
//!
//! Data flows one way; each stage is a module that depends only on the earlier ones:
//!
//! | stage | module | from -> to |
//! |---|---|---|
//! | map | [`map`] | a file -> occupancy grid -> the layers that a search reads |
//! | plan | [`plan`] (over [`search`]) | a map and two cells -> a path |
//! | smooth | [`smooth`] | a line -> a shorter line with the same clearance |
//! | route | [`route`] | a map and two positions -> a smoothed route |
//! | sense | [`sense`] | scans -> obstacles that are not on the map |
//! | guide | [`guide`] | a path -> the point to drive towards |
//! | decide | [`local`] | a scene -> a velocity |
//! | navigate | [`navigate`] | all of the above, as a value that observes and steps |
//!
//! Units are SI and radians; frames follow ROS REP 103. Everything is deterministic: equal inputs
//! give equal bytes. No function prints or reads a clock. Invalid input gives an error, not a
//! panic; the few functions that panic, such as on grids of different sizes, document it.
//!
//! ```
//! use keyway::{Navigator, OccupancyGrid, Point, Pose, Robot, Stack};
//!
//! let map = OccupancyGrid::from_ascii(&["........", "...##...", "...##...", "........"]);
//! let robot = Robot::small();
//! let stack = Stack::keyway(&robot).fit(&robot)?;
//! let mut navigator = Navigator::new(&map, &stack)?;
//! navigator.relocate(Pose::new(0.5, 0.5, 0.0));
//! navigator.set_goal(Point::new(7.5, 3.5))?;
//! let route = navigator.route().expect("it has a goal");
//! assert!(route.smoothed.length_m() < 8.7);
//! # Ok::<(), keyway::navigate::NavigateError>(())
//! ```
//!
//! | feature | adds |
//! |---|---|
//! | `files`, the default | reading and writing files; turns `formats` on |
//! | `formats` | maps, prepared maps, robots, stacks and parameters from bytes, and back |
//! | `images` | BMP, GIF, JPEG and TIFF images as maps; turns `formats` on |
//! | `schema` | JSON schemas of all parameters |
//!
//! On a robot, pass the measurements to [`Navigator::observe`] and call [`Navigator::step`] once
//! per cycle; the example `own_robot` is such a loop.
//!
//! Guides, such as how to describe a robot and what safety needs, are in the
//! [documentation](https://github.com/keyway-robotics/keyway/blob/main/docs/index.md).

mod config_error;
#[cfg(feature = "formats")]
pub mod file_error;
#[cfg(feature = "files")]
pub mod file_system;
#[cfg(feature = "formats")]
pub mod files;
pub mod geometry;
pub mod given;
pub mod guide;
pub mod local;
pub mod map;
pub mod navigate;
pub mod plan;
pub mod random;
mod registry;
pub mod robot;
pub mod route;
pub mod search;
pub mod sense;
pub mod smooth;

pub use config_error::ConfigError;
// The nouns of a control loop.
pub use geometry::{Point, Pose, Velocity};
pub use map::OccupancyGrid;
pub use navigate::{Goal, Navigator, Stack, Step};
pub use robot::Robot;
pub use sense::Scan;
