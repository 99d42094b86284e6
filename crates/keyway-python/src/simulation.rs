//! A simulated run that Python code drives.

use crate::arrays::{Floats2, Mask, of_points, of_rows};
use crate::errors::bad_value;
use crate::map::Map;
use crate::run::run_error;
use crate::scan::Scan;
use crate::scene::{Scene, SceneOrFile};
use crate::watched::{Progress, watched};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::map::{CellState, OccupancyGrid};
use keyway::navigate::Goal;
use keyway::robot::{Footprint, Limits, Robot};
use keyway_sim::episode::{Episode, EpisodeRobot};
use keyway_sim::report::MapSource;
use keyway_sim::sim::{Action, Arrival, Control, ElusiveShape, Outcome, Stepper};
use pyo3::prelude::*;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

/// The world of a scene, driven by the caller: one control cycle per call, as in reinforcement
/// learning.
///
/// The goal is reached as soon as the robot is within its tolerance, even while moving. The stack
/// of the scene plans only the first route, which determines the initial heading and the time
/// limit; it does not drive. `progress(done, expected)` is called meanwhile; the work is not
/// counted: (0, None).
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
/// >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2), (7, 2)))
/// >>> while simulation.outcome is None:
/// ...     outcome = simulation.step(0.5, 0.0)
/// >>> simulation.outcome
/// 'reached'
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Simulation {
    stepper: Mutex<Stepper>,
    grid: Arc<OccupancyGrid>,
    source: MapSource,
    goal: Goal,
    robot: Robot,
    range_m: f64,
}

impl Simulation {
    fn lock(&self) -> std::sync::MutexGuard<'_, Stepper> {
        self.stepper.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Number of chords of the outline of a circle.
const CHORDS: u32 = 32;

fn of_discs(py: Python<'_>, discs: &[Disc]) -> Floats2 {
    let row = |disc: &Disc| [disc.centre.x, disc.centre.y, disc.radius_m];
    Floats2(of_rows(py, discs.iter().map(row), discs.len()))
}

fn name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Reached => "reached",
        Outcome::Timeout => "timeout",
        Outcome::Stuck => "stuck",
        // An outcome unknown to this file cannot be a success.
        _ => "collided",
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scene, progress=None))]
    fn new(py: Python<'_>, scene: SceneOrFile, progress: Option<Progress>) -> PyResult<Self> {
        let scene = Scene::clone(&scene);
        let (stepper, mut episode) = watched(py, progress.as_ref(), move |_| {
            let mut episode: Episode = scene.episode_of_one()?;
            episode.rules.arrival = Arrival::Passing;
            let stepper = episode.stepper().map_err(|error| run_error(&error.why))?;
            Ok::<_, PyErr>((stepper, episode))
        })??;
        let EpisodeRobot { goal, robot, .. } = episode.robots.swap_remove(0);
        Ok(Self {
            stepper: Mutex::new(stepper),
            grid: Arc::new(episode.known),
            source: episode.source,
            goal,
            range_m: robot.sensors.iter().map(|sensor| sensor.range_m).fold(0.0, f64::max),
            robot,
        })
    }

    /// Runs one control cycle: the robot accelerates towards the velocity (v, omega) [m/s,
    /// rad/s], within its limits. Returns the outcome once the run has ended, and `None` before
    /// that. A run that has ended does not change.
    ///
    /// `remaining` is the remaining distance to the goal [m], which decides whether the robot is
    /// stuck; by default it is the straight-line distance.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
    /// >>> simulation = keyway.Simulation(keyway.Scene(grid, (1, 2, 0), (7, 2)))
    /// >>> simulation.step(0.5, 0.0) is None, round(simulation.velocity[0], 3)
    /// (True, 0.05)
    #[pyo3(signature = (v, omega, remaining=None))]
    fn step(
        &self,
        py: Python<'_>,
        v: f64,
        omega: f64,
        remaining: Option<f64>,
    ) -> PyResult<Option<&'static str>> {
        let ended = py.detach(|| {
            let mut stepper = self.lock();
            let straight_m = stepper.state().pose.point().distance(self.goal.position);
            let remaining_m = remaining.unwrap_or(straight_m);
            let action = Action::Drive(Velocity::new(v, omega));
            stepper.step(&Control { action, remaining_m, route: 0, turn_left_rad: 0.0 })
        });
        Ok(ended.map_err(bad_value)?.map(name))
    }

    /// Outcome of the run, `reached`, `collided`, `timeout` or `stuck`; `None` while it is
    /// running.
    #[getter]
    fn outcome(&self) -> Option<&'static str> {
        self.lock().outcome().map(name)
    }

    /// Estimated pose of the robot (x, y, theta) [m, m, rad].
    #[getter]
    fn pose(&self) -> (f64, f64, f64) {
        let Pose { x, y, theta } = self.lock().told().pose;
        (x, y, theta)
    }

    /// Estimated velocity of the robot (v, omega) [m/s, rad/s].
    #[getter]
    fn velocity(&self) -> (f64, f64) {
        let Velocity { v, omega, .. } = self.lock().told().velocity;
        (v, omega)
    }

    /// Time at which `pose` and `velocity` were measured [s].
    #[getter]
    fn stamp(&self) -> f64 {
        self.lock().told().stamp_s
    }

    /// The current scan of the first sensor: ranges and bearings of its beams.
    /// `Navigator.observe` accepts it for a robot with a single sensor.
    #[getter]
    fn scan(&self) -> Scan {
        let stepper = self.lock();
        let first = stepper.scans().first().filter(|one| one.sensor == 0).map(|one| one.stamp_s);
        Scan::new(stepper.scan().clone(), first)
    }

    /// The current scans of all sensors, in their order; `None` for a sensor without a scan in
    /// this cycle. `Navigator.observe` accepts them.
    #[getter]
    fn scans(&self) -> Vec<Option<Scan>> {
        let stepper = self.lock();
        let mut scans: Vec<Option<Scan>> = (0..self.robot.sensors.len()).map(|_| None).collect();
        for one in stepper.scans() {
            scans[one.sensor] = Some(Scan::new(one.scan.owned(), Some(one.stamp_s)));
        }
        scans
    }

    /// Position of the goal (x, y) [m].
    #[getter]
    fn goal(&self) -> (f64, f64) {
        let Point { x, y } = self.goal.position;
        (x, y)
    }

    /// Heading that the robot is to have at the goal [rad]; `None` if any will do. The run ends at
    /// the goal with any heading.
    #[getter]
    fn goal_heading(&self) -> Option<f64> {
        self.goal.heading_rad
    }

    /// The map that the robot knows.
    #[getter]
    fn map(&self) -> Map {
        Map::shared(Arc::clone(&self.grid), self.source.clone())
    }

    /// Mask of the cells that are occupied and that the map shows as free: a new array of bool of
    /// shape (rows, columns).
    #[getter]
    fn hidden(&self, py: Python<'_>) -> PyResult<Mask> {
        let squares = self.lock().world().world().squares().clone();
        let is_free = |cell| self.grid.state(cell) == Some(CellState::Free);
        self.map().mask(py, |cell| squares.get(cell) && is_free(cell))
    }

    /// Static obstacles that are not on the map and are present now: a read-only array of float64
    /// of shape (n, 3) with the centre (x, y) and the radius of each [m].
    #[getter]
    fn obstacles(&self, py: Python<'_>) -> Floats2 {
        let stepper = self.lock();
        let world = stepper.world();
        let elusive = world.elusive().filter_map(|obstacle| match obstacle.shape() {
            ElusiveShape::Disc(disc) => Some(*disc),
            _ => None,
        });
        let discs: Vec<Disc> = world.world().discs().iter().copied().chain(elusive).collect();
        of_discs(py, &discs)
    }

    /// Vertices of static obstacles that are not on the map and are present now: for each, a
    /// read-only array of float64 of shape (n, 2) [m].
    #[getter]
    fn polygons(&self, py: Python<'_>) -> Vec<Floats2> {
        let stepper = self.lock();
        let world = stepper.world();
        let elusive = world.elusive().filter_map(|obstacle| match obstacle.shape() {
            ElusiveShape::Polygon(polygon) => Some(polygon),
            _ => None,
        });
        let all = world.world().polygons().iter().chain(elusive);
        all.map(|polygon| Floats2(of_points(py, polygon.vertices()))).collect()
    }

    /// Moving obstacles at this time: a read-only array of float64 of shape (n, 3) with the centre
    /// (x, y) and the radius of each [m].
    #[getter]
    fn moving(&self, py: Python<'_>) -> Floats2 {
        let stepper = self.lock();
        let world = stepper.world();
        let standing = world.world().discs().len();
        let moving: Vec<Disc> = world.discs().skip(standing).collect();
        of_discs(py, &moving)
    }

    /// True pose of the robot (x, y, theta) [m, m, rad].
    #[getter]
    fn true_pose(&self) -> (f64, f64, f64) {
        let Pose { x, y, theta } = self.lock().state().pose;
        (x, y, theta)
    }

    /// Outline of the robot at its true pose: a read-only array of float64 of shape (n, 2) [m]. A
    /// circle is approximated by chords.
    #[getter]
    fn outline(&self, py: Python<'_>) -> Floats2 {
        let pose = self.lock().state().pose;
        let vertices: Vec<Point> = match &self.robot.footprint {
            Footprint::Polygon(polygon) => polygon.vertices().to_vec(),
            Footprint::Circle(_) => {
                let radius_m = self.robot.footprint.inscribed_radius_m();
                let on_circle = |i: u32| {
                    let angle_rad = TAU * f64::from(i) / f64::from(CHORDS);
                    Point::new(angle_rad.cos(), angle_rad.sin()) * radius_m
                };
                (0..CHORDS).map(on_circle).collect()
            }
        };
        let outline: Vec<Point> =
            vertices.into_iter().map(|vertex| pose.world_from_body(vertex)).collect();
        Floats2(of_points(py, &outline))
    }

    /// Duration of a step [s].
    #[getter]
    fn cycle(&self) -> f64 {
        self.robot.cycle_s
    }

    /// Lowest and highest velocity of the robot: (v, omega) of each [m/s, rad/s].
    #[getter]
    fn limits(&self) -> ((f64, f64), (f64, f64)) {
        let Limits { v_min_mps, v_max_mps, omega_max_radps, .. } = self.robot.limits;
        ((v_min_mps, -omega_max_radps), (v_max_mps, omega_max_radps))
    }

    /// Range of the sensor [m]; the longest one of several.
    #[getter]
    fn range(&self) -> f64 {
        self.range_m
    }

    fn __repr__(&self) -> String {
        let (x, y, _) = self.pose();
        let outcome = self.outcome().unwrap_or("running");
        format!("<keyway.Simulation {outcome} at ({x:.3}, {y:.3})>")
    }
}
