//! Several robots in one world.

use super::driver::{Ended, Entry, run_all};
use super::task::Task;
use super::{EpisodeObserver, EpisodeRules, Start, TeamError, TeamReport};
use crate::report::{Clock, MapSource, Placed};
use crate::sim::{Circle, Disturbances, Mover, StandingPolygon};
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::given::Given;
use keyway::map::{Cell, OccupancyGrid};
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;

/// Several robots that drive in one world at the same time, each with its own stack and to its own
/// goal. To each other they are moving obstacles: no robot knows the plans of another, and has to
/// sense it.
///
/// A robot whose run has ended, with any outcome, stands in the way of the others from then on; a
/// robot without a route does so from the beginning. All robots have the same control cycle.
///
/// ```
/// use keyway_sim::episode::{EpisodeOutcome, Team, TeamRobot, run_team};
/// use keyway::geometry::Point;
/// use keyway::map::OccupancyGrid;
/// use keyway::robot::Robot;
///
/// let map = OccupancyGrid::from_ascii(&["........"; 8]);
/// let robot = |from: [f64; 2], to: [f64; 2]| {
///     TeamRobot::new(Robot::small(), Point::from(from), Point::from(to))
/// };
/// let robots = vec![robot([0.6, 2.0], [7.4, 2.0]), robot([7.4, 6.0], [0.6, 6.0])];
/// let report = run_team(&Team::new(map, robots))?;
/// assert_eq!(report.outcomes, [EpisodeOutcome::Reached; 2]);
/// assert!(report.min_robot_clearance_m > Some(3.0));
/// # Ok::<(), keyway_sim::episode::TeamError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Team {
    /// Map that all robots know. Its occupied cells are real obstacles, and so are its unknown
    /// cells if `stack.map.unknown` of all robots plans around them.
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
    /// ([`RandomObstacles::put_into_team`](super::RandomObstacles::put_into_team)).
    pub random: Option<Placed>,
    /// The robots.
    pub robots: Vec<TeamRobot>,
    /// Rules that end each robot's run. Without a time limit, all robots have the longest limit
    /// that an [`Episode`](super::Episode) of one of them would have: a robot that lets another one
    /// pass first needs the time.
    pub rules: EpisodeRules,
}

/// A robot of a [`Team`].
#[derive(Clone, Debug, PartialEq)]
pub struct TeamRobot {
    /// The robot.
    pub robot: Robot,
    /// Errors of its sensor, its motors and its localisation. Robots with the same seed draw
    /// different numbers.
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
}

impl TeamRobot {
    /// Creates an ideal robot with the usual stack for it. It starts facing along its path.
    pub fn new(robot: Robot, start: Point, goal: impl Into<Goal>) -> Self {
        Self {
            stack: Stack::keyway(&robot),
            stack_name: Stack::DEFAULT.to_owned(),
            robot,
            disturbances: Disturbances::default(),
            start: Start { position: start, heading_rad: None },
            via: Vec::new(),
            goal: goal.into(),
        }
    }
}

impl Team {
    /// Creates a team with a correct map.
    pub fn new(known: OccupancyGrid, robots: Vec<TeamRobot>) -> Self {
        Self {
            known,
            source: MapSource::default(),
            obstacles: Vec::new(),
            polygons: Vec::new(),
            hidden_cells: Vec::new(),
            movers: Vec::new(),
            random: None,
            robots,
            rules: EpisodeRules::default(),
        }
    }

    /// Checks that there are robots, and that all have the same cycle.
    fn check(&self) -> Result<(), TeamError> {
        let Some(first) = self.robots.first() else {
            let error = ConfigError::new("robots", "must be one or more, got none");
            return Err(TeamError::of_all(error));
        };
        let first_s = first.robot.cycle_s;
        for (index, TeamRobot { robot, .. }) in self.robots.iter().enumerate() {
            if robot.cycle_s != first_s {
                let expected = format!("{}, the cycle of robot 0", Given(first_s));
                let error = ConfigError::must_be("robot.cycle_s", &expected, robot.cycle_s);
                return Err(TeamError::of_robot(index, error));
            }
        }
        Ok(())
    }

    fn task<'a>(&'a self, robot: &'a TeamRobot) -> Task<'a> {
        Task {
            known: &self.known,
            source: &self.source,
            obstacles: &self.obstacles,
            polygons: &self.polygons,
            hidden_cells: &self.hidden_cells,
            movers: &self.movers,
            random: self.random,
            rules: &self.rules,
            robot: &robot.robot,
            disturbances: robot.disturbances,
            stack: &robot.stack,
            stack_name: &robot.stack_name,
            start: robot.start,
            via: &robot.via,
            goal: robot.goal,
        }
    }
}

/// Runs a team. Equal teams give equal reports; times are not measured.
///
/// # Errors
/// When the team cannot be run. No route, a collision or a timeout are results.
pub fn run_team(team: &Team) -> Result<TeamReport, TeamError> {
    watch_team(team, None, 1, |_| ()).map(|(report, _)| report)
}

/// Runs a team with an observer for each robot, and measures times by the caller's clock. The
/// decisions of a cycle are spread over this many threads; the reports are the same for any number.
/// `observer` is called with the index of each robot and returns its observer; all observers are
/// returned, in the order of the robots.
///
/// # Errors
/// As for [`run_team`].
pub fn watch_team<O: EpisodeObserver>(
    team: &Team,
    clock: Clock<'_>,
    threads: usize,
    observer: impl FnMut(usize) -> O,
) -> Result<(TeamReport, Vec<O>), TeamError> {
    team.check()?;
    let mut observers: Vec<O> = (0..team.robots.len()).map(observer).collect();
    let mut entries = Vec::with_capacity(team.robots.len());
    for (index, (robot, observer)) in team.robots.iter().zip(&mut observers).enumerate() {
        let task = team.task(robot);
        let stack = task.fit().map_err(|error| TeamError::of_robot(index, error))?;
        entries.push(Entry { task, stack, observer });
    }
    let (reports, clearances_m): (Vec<_>, Vec<_>) = run_all(entries, clock, threads)?
        .into_iter()
        .map(|Ended { report, min_robot_clearance_m }| (report, min_robot_clearance_m))
        .unzip();
    let min_robot_clearance_m = clearances_m.into_iter().flatten().reduce(f64::min);
    Ok((TeamReport::of(reports, min_robot_clearance_m), observers))
}
