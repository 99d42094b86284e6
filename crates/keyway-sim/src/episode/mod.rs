//! Complete runs: a world, robots and their stacks are simulated and measured.
//!
//! An [`Episode`] is one or several robots in one world, each with its own stack. [`run_episode`]
//! plans, simulates and measures; it needs nothing else and writes nothing. The same episode
//! gives the same report: all randomness in a run follows from a seed
//! ([`EpisodeRobot::disturbances`]). [`watch_episode`] shows every cycle to an
//! [`EpisodeObserver`], measures times by the caller's clock, and drives with the caller's own
//! local planners or guides ([`RunOptions`]). [`Episode::stepper`] gives control of the robot to
//! an external controller.
//!
//! ```
//! use keyway_sim::episode::{Episode, EpisodeOutcome, run_episode};
//! use keyway::geometry::{Disc, Point};
//! use keyway::map::OccupancyGrid;
//! use keyway::robot::Robot;
//!
//! let map = OccupancyGrid::from_ascii(&["........", "........", "........", "........"]);
//! let (start, goal) = (Point::new(0.6, 2.0), Point::new(7.4, 2.0));
//! let mut episode = Episode::new(map, Robot::small(), start, goal);
//! // In the middle of the way, and not on the map.
//! episode.obstacles = vec![Disc::new(Point::new(4.0, 2.1), 0.3)];
//! let report = run_episode(&episode)?.first();
//! assert_eq!(report.outcome, EpisodeOutcome::Reached);
//! let run = report.run.as_ref().expect("there was a route to drive");
//! assert!(run.length_m > 6.7 && run.min_clearance_m > Some(0.0));
//! assert_eq!(run_episode(&episode)?.first(), report);
//! # Ok::<(), keyway_sim::episode::EpisodeError>(())
//! ```

mod cycle_report;
mod driver;
mod error;
mod nearest;
mod observer;
mod random_obstacles;
mod report;
mod robot;
mod rules;
mod run;
mod start;
mod stepper;
mod task;

pub use cycle_report::{CycleReport, Scored, Speeds, StepName};
pub use error::{EpisodeError, RunError};
pub use nearest::NearestGoal;
pub use observer::{Cycle, EpisodeObserver};
pub use random_obstacles::{RandomMoving, RandomObstacles, RandomUnknown};
pub use report::{EpisodeOutcome, EpisodeReport, RobotReport};
pub use robot::EpisodeRobot;
pub use rules::EpisodeRules;
pub use run::{RunOptions, run_episode, watch_episode};
pub use start::Start;

use crate::report::{MapSource, Placed};
use crate::sim::{ElusiveObstacle, MovingObstacle, StandingPolygon};
use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::given::Given;
use keyway::map::{Cell, OccupancyGrid};
use keyway::navigate::Goal;
use keyway::robot::Robot;

/// One or several robots that drive in one world at the same time, each with its own stack and
/// its own goal. They are moving obstacles for each other: no robot knows another's plans, so
/// each has to sense the others.
///
/// A robot whose run has ended, with any outcome, is an obstacle for the others from then on; a
/// robot without a route is one from the beginning. All robots have the same control cycle.
///
/// ```
/// use keyway_sim::episode::{Episode, EpisodeOutcome, EpisodeRobot, run_episode};
/// use keyway::geometry::Point;
/// use keyway::map::OccupancyGrid;
/// use keyway::robot::Robot;
///
/// let map = OccupancyGrid::from_ascii(&["........"; 8]);
/// let robot = |from: [f64; 2], to: [f64; 2]| {
///     EpisodeRobot::new(Robot::small(), Point::from(from), Point::from(to))
/// };
/// let robots = vec![robot([0.6, 2.0], [7.4, 2.0]), robot([7.4, 6.0], [0.6, 6.0])];
/// let report = run_episode(&Episode::of_robots(map, robots))?;
/// assert_eq!(report.outcomes, [EpisodeOutcome::Reached; 2]);
/// assert!(report.min_robot_clearance_m > Some(3.0));
/// # Ok::<(), keyway_sim::episode::EpisodeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Map that all robots know. Its occupied cells are true obstacles, and so are its unknown
    /// cells if `stack.map.unknown` of all robots plans around them.
    pub known: OccupancyGrid,
    /// Identification of the map in the report.
    pub source: MapSource,
    /// True static obstacles that are not on the map.
    pub obstacles: Vec<Disc>,
    /// True static polygons that are not on the map.
    pub polygons: Vec<StandingPolygon>,
    /// Occupied cells that the map does not show, in ascending order.
    pub hidden_cells: Vec<Cell>,
    /// Cells that the map shows as occupied although they are free, in ascending order.
    pub absent_cells: Vec<Cell>,
    /// Obstacles that are present for a limited time, or that sensors miss.
    pub elusive: Vec<ElusiveObstacle>,
    /// Moving obstacles.
    pub movers: Vec<MovingObstacle>,
    /// Numbers of random obstacles that were placed and that were left out
    /// ([`RandomObstacles::put_into`]).
    pub random: Option<Placed>,
    /// The robots: one or several.
    pub robots: Vec<EpisodeRobot>,
    /// Rules that end each robot's run. Without a time limit, all robots get the longest default
    /// limit of any of them, because a robot that lets another one pass first needs the time.
    pub rules: EpisodeRules,
}

impl Episode {
    /// Creates an episode of one ideal robot with its default stack on a correct map. The robot
    /// starts facing along the path.
    pub fn new(known: OccupancyGrid, robot: Robot, start: Point, goal: impl Into<Goal>) -> Self {
        Self::of_robots(known, vec![EpisodeRobot::new(robot, start, goal)])
    }

    /// Creates an episode with a correct map.
    pub fn of_robots(known: OccupancyGrid, robots: Vec<EpisodeRobot>) -> Self {
        Self {
            known,
            source: MapSource::default(),
            obstacles: Vec::new(),
            polygons: Vec::new(),
            hidden_cells: Vec::new(),
            absent_cells: Vec::new(),
            elusive: Vec::new(),
            movers: Vec::new(),
            random: None,
            robots,
            rules: EpisodeRules::default(),
        }
    }

    /// Returns the episode with each robot changed.
    #[must_use]
    pub fn with_each_robot(mut self, change: impl FnMut(&mut EpisodeRobot)) -> Self {
        self.robots.iter_mut().for_each(change);
        self
    }

    /// Checks that there are robots, and that all have the same cycle; returns the first.
    fn check(&self) -> Result<&EpisodeRobot, EpisodeError> {
        let Some(first) = self.robots.first() else {
            let error = ConfigError::new("robots", "must be one or more, got none");
            return Err(EpisodeError::of_all(error));
        };
        let first_s = first.robot.cycle_s;
        for (index, EpisodeRobot { robot, .. }) in self.robots.iter().enumerate() {
            if robot.cycle_s != first_s {
                let expected = format!("{}, the cycle of robot 0", Given(first_s));
                let error = ConfigError::must_be("robot.cycle_s", &expected, robot.cycle_s);
                return Err(EpisodeError::of_robot(Some(index), error));
            }
        }
        Ok(first)
    }
}
