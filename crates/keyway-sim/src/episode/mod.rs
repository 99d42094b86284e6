//! A whole run: a world, a robot and a stack -> a drive and its figures.
//!
//! [`run_episode`] plans, simulates and measures; nothing else is needed, and nothing is written. The same episode
//! gives the same report: what is random in a run follows from a seed ([`Episode::disturbances`]), and times are only measured by a clock that the caller brings
//! ([`watch_episode`], which also shows every cycle to an [`EpisodeObserver`]). A local planner or a guide of your own is driven
//! by [`run_with_parts`]. Several robots in one world, each with its own stack, are a [`Team`], driven by [`run_team`].
//!
//! ```
//! use keyway_sim::episode::{Episode, EpisodeOutcome, run_episode};
//! use keyway::geometry::Point;
//! use keyway::map::OccupancyGrid;
//! use keyway::robot::Robot;
//! use keyway_sim::sim::Circle;
//!
//! let map = OccupancyGrid::from_ascii(&["........", "........", "........", "........"]);
//! let (start, goal) = (Point::new(0.6, 2.0), Point::new(7.4, 2.0));
//! let mut episode = Episode::new(map, Robot::small(), start, goal);
//! // In the middle of the way, and not on the map.
//! episode.obstacles = vec![Circle::standing(Point::new(4.0, 2.1), 0.3)];
//! let report = run_episode(&episode)?;
//! assert_eq!(report.outcome, EpisodeOutcome::Reached);
//! let run = report.run.as_ref().expect("there was a route to drive");
//! assert!(run.length_m > 6.7 && run.min_clearance_m > Some(0.0));
//! assert_eq!(run_episode(&episode)?, report);
//! # Ok::<(), keyway_sim::episode::EpisodeError>(())
//! ```

mod cycle_report;
mod driver;
mod error;
mod observer;
mod random_obstacles;
mod report;
mod run;
mod start;
mod stepper;
mod task;
mod team;
mod team_report;

pub use cycle_report::{CycleReport, Scored, Speeds, StepName};
pub use error::{EpisodeError, TeamError};
pub use observer::{Cycle, EpisodeObserver};
pub use random_obstacles::{RandomMoving, RandomObstacles, RandomUnknown};
pub use report::{EpisodeOutcome, EpisodeReport};
pub use run::{run_episode, run_with_parts, watch_episode};
pub use start::Start;
pub use team::{Team, TeamRobot, run_team, watch_team};
pub use team_report::TeamReport;

use crate::report::{MapSource, Placed};
use crate::sim::{Arrival, Circle, Disturbances, Mover, RunRules, StandingPolygon};
use keyway::geometry::Point;
use keyway::map::{Cell, OccupancyGrid};
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;

/// A run to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// The map that the robot knows. Its occupied cells are real, and its unknown ones where
    /// `stack.map.unknown` plans around them.
    pub known: OccupancyGrid,
    /// What identifies the map in the report.
    pub source: MapSource,
    /// Obstacles that are real, stand, and are not on the map.
    pub obstacles: Vec<Circle>,
    /// Polygons of the same kind.
    pub polygons: Vec<StandingPolygon>,
    /// Cells of the map that are in truth occupied, in ascending order.
    pub hidden_cells: Vec<Cell>,
    /// Obstacles that move.
    pub movers: Vec<Mover>,
    /// How many of these are random, and how many found no place ([`RandomObstacles::put_into`]).
    pub random: Option<Placed>,
    /// The robot.
    pub robot: Robot,
    /// What its sensor, its motors and its localisation get wrong.
    pub disturbances: Disturbances,
    /// How it plans and drives.
    pub stack: Stack,
    /// Name of the stack in the report.
    pub stack_name: String,
    /// Where the robot stands.
    pub start: Start,
    /// By way of which points, in their order \[m\].
    pub via: Vec<Point>,
    /// Where it is to go.
    pub goal: Goal,
    /// When the run is given up.
    pub rules: EpisodeRules,
}

/// When a run ends.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeRules {
    /// How near to the goal is near enough \[m\]; `None`: `controller.goal_tolerance_m` of the stack.
    pub goal_tolerance_m: Option<f64>,
    /// Whether the robot has to stand there, facing where it is to; or whether it may pass.
    pub arrival: Arrival,
    /// Limit of the simulated time \[s\]; `None`: 60 s and four times what the route takes at top speed.
    pub time_limit_s: Option<f64>,
    /// See [`RunRules::stuck_window_s`] \[s\].
    pub stuck_window_s: f64,
    /// See [`RunRules::stuck_progress_m`] \[m\]; `None`: 0.1 m, or a twentieth of what a slow robot drives in
    /// `stuck_window_s`.
    pub stuck_progress_m: Option<f64>,
}

impl Default for EpisodeRules {
    fn default() -> Self {
        let RunRules { stuck_window_s, .. } = RunRules::default();
        Self {
            goal_tolerance_m: None,
            arrival: Arrival::Standing,
            time_limit_s: None,
            stuck_window_s,
            stuck_progress_m: None,
        }
    }
}

impl Episode {
    /// An episode in which the map is right and the robot ideal, with the usual stack for the robot. It begins facing along the path.
    pub fn new(known: OccupancyGrid, robot: Robot, start: Point, goal: impl Into<Goal>) -> Self {
        Self {
            known,
            source: MapSource::default(),
            obstacles: Vec::new(),
            polygons: Vec::new(),
            hidden_cells: Vec::new(),
            movers: Vec::new(),
            random: None,
            stack: Stack::keyway(&robot),
            stack_name: Stack::DEFAULT.to_owned(),
            robot,
            disturbances: Disturbances::default(),
            start: Start { position: start, heading_rad: None },
            via: Vec::new(),
            goal: goal.into(),
            rules: EpisodeRules::default(),
        }
    }
}
