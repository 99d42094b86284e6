//! A whole run: from a world, a robot and a stack to a drive and its figures.
//!
//! [`run_episode`] plans, simulates and measures; it needs nothing else and writes nothing. The
//! same episode gives the same report: all randomness in a run follows from a seed
//! ([`Episode::disturbances`]), and times are measured only by a clock of the caller's
//! ([`watch_episode`], which also shows every cycle to an [`EpisodeObserver`]). [`run_with_parts`]
//! drives with your own local planner or guide. Several robots in one world, each with its own
//! stack, are a [`Team`], driven by [`run_team`].
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

/// Description of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Map that the robot knows. Its occupied cells are real obstacles, and so are its unknown
    /// cells if `stack.map.unknown` plans around them.
    pub known: OccupancyGrid,
    /// Identification of the map in the report.
    pub source: MapSource,
    /// Real static obstacles that are not on the map.
    pub obstacles: Vec<Circle>,
    /// Real static polygons that are not on the map.
    pub polygons: Vec<StandingPolygon>,
    /// Occupied cells that the map does not show, in ascending order.
    pub hidden_cells: Vec<Cell>,
    /// Moving obstacles.
    pub movers: Vec<Mover>,
    /// Number of random ones among these obstacles, and of those not placed
    /// ([`RandomObstacles::put_into`]).
    pub random: Option<Placed>,
    /// The robot.
    pub robot: Robot,
    /// Errors of its sensor, its motors and its localisation.
    pub disturbances: Disturbances,
    /// Stack that plans and drives.
    pub stack: Stack,
    /// Name of the stack in the report.
    pub stack_name: String,
    /// Start of the robot.
    pub start: Start,
    /// Way-points, in order \[m\].
    pub via: Vec<Point>,
    /// Goal of the robot.
    pub goal: Goal,
    /// Rules that end the run.
    pub rules: EpisodeRules,
}

/// Rules that end a run.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeRules {
    /// Goal tolerance \[m\]; `None`: `controller.goal_tolerance_m` of the stack.
    pub goal_tolerance_m: Option<f64>,
    /// Arrival rule: whether the robot has to stop at the goal, with the goal's heading, or may
    /// pass.
    pub arrival: Arrival,
    /// Limit of the simulated time \[s\]; `None`: 60 s plus four times the route's duration at top
    /// speed.
    pub time_limit_s: Option<f64>,
    /// See [`RunRules::stuck_window_s`] \[s\].
    pub stuck_window_s: f64,
    /// See [`RunRules::stuck_progress_m`] \[m\]; `None`: what its controller takes for
    /// progress in that time ([`Progress::step_m`](keyway::navigate::Progress::step_m)).
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
    /// Creates an episode with a correct map and an ideal robot, with the usual stack for the
    /// robot. The robot starts facing along the path.
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
