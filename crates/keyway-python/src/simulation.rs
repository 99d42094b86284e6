//! A simulated run that Python code drives.

use crate::errors::bad_value;
use crate::run::run_error;
use crate::scan::Scan;
use crate::scene::{Scene, SceneOrFile};
use crate::watched::{Progress, watched};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::Limits;
use keyway_sim::episode::{Episode, EpisodeRobot};
use keyway_sim::sim::{Action, Arrival, Control, Outcome, Stepper};
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

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
    goal: Point,
    cycle_s: f64,
    limits: Limits,
    sensors: usize,
    range_m: f64,
}

impl Simulation {
    fn lock(&self) -> std::sync::MutexGuard<'_, Stepper> {
        self.stepper.lock().unwrap_or_else(PoisonError::into_inner)
    }
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
            goal: goal.position,
            cycle_s: robot.cycle_s,
            limits: robot.limits,
            sensors: robot.sensors.len(),
            range_m: robot.sensors.iter().map(|sensor| sensor.range_m).fold(0.0, f64::max),
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
            let straight_m = stepper.state().pose.point().distance(self.goal);
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
        let mut scans: Vec<Option<Scan>> = (0..self.sensors).map(|_| None).collect();
        for one in stepper.scans() {
            scans[one.sensor] = Some(Scan::new(one.scan.owned(), Some(one.stamp_s)));
        }
        scans
    }

    /// Position of the goal (x, y) [m].
    #[getter]
    fn goal(&self) -> (f64, f64) {
        (self.goal.x, self.goal.y)
    }

    /// Duration of a step [s].
    #[getter]
    fn cycle(&self) -> f64 {
        self.cycle_s
    }

    /// Lowest and highest velocity of the robot: (v, omega) of each [m/s, rad/s].
    #[getter]
    fn limits(&self) -> ((f64, f64), (f64, f64)) {
        let Limits { v_min_mps, v_max_mps, omega_max_radps, .. } = self.limits;
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
