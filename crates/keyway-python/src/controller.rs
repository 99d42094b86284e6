//! Driving a robot.

use crate::arrays::{Floats2, Json, json, of_points};
use crate::errors::{bad_value, config_file_error, navigate_error};
use crate::map::Map;
use crate::parameters::{Parameters, robot};
use crate::scan::LaserScan;
use crate::values::{Numbers, Positions};
use crate::watched::{Progress, watched};
use keyway::files::{StackBase, find_stack};
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::{Goal, Stack};
use keyway::robot::RangeSensor;
use keyway::sense::Scan;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// What a robot is to do until the next cycle.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
/// >>> controller = keyway.Controller(grid, start=(1, 1), goal=(3, 1))
/// >>> controller.step(pose=(1, 1, 0), velocity=(0, 0), scan=controller.clear_scan)
/// <keyway.Step drive: 0.050 m/s, 0.000 rad/s>
#[pyclass(frozen, get_all, module = "keyway")]
pub(crate) struct Step {
    /// Forward speed [m/s].
    v: f64,
    /// Turn rate, positive to the left [rad/s].
    omega: f64,
    /// `drive`, `blocked` (there is no good way on at the moment; the command is safe) or `arrived`.
    status: &'static str,
    /// Why the robot is blocked, for people; otherwise `None`.
    why: Option<String>,
    /// A notice for people: the robot began nearer to something than it can stand, and is leaving it. Otherwise `None`.
    notice: Option<String>,
}

#[pymethods]
impl Step {
    fn __repr__(&self) -> String {
        let Self { v, omega, status, why, .. } = self;
        let why = why.as_ref().map_or_else(String::new, |why| format!(" ({why})"));
        format!("<keyway.Step {status}: {v:.3} m/s, {omega:.3} rad/s{why}>")
    }
}

impl Step {
    fn new(step: keyway::navigate::Step, notice: Option<String>) -> Self {
        use keyway::navigate::Step;
        let Velocity { v, omega, .. } = step.command();
        let (status, why) = match step {
            Step::Drive(_) => ("drive", None),
            Step::Arrived => ("arrived", None),
            Step::Blocked { why, .. } => ("blocked", Some(why.to_string())),
        };
        Self { v, omega, status, why, notice }
    }
}

/// Drives a robot to a goal: plans on the known map, remembers what scans show, and decides on a velocity in every cycle.
///
/// `robot` and `stack` are names of `keyway.names`, or files. `goal` is a position [m], or with a heading [m, m, rad]; `via` are
/// positions on the way. `parameters` are laid over the stack, as a dictionary with the names of the TOML files.
/// With `as_published` the stack has the values of its paper. With `safe` only commands are issued after which the robot can still
/// stop before it touches anything, whatever the stack wants. `progress(done, expected)` is called while the first route is
/// planned, which is not counted: (0, None).
///
/// Raises `NoRoom` where the robot does not fit at the start or goal, `NoPath` where no way leads there, and `ValueError` for a
/// value that cannot be used.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
/// >>> keyway.Controller(grid, robot="small", stack="keyway", start=(1, 1), goal=(3, 1))
/// <keyway.Controller keyway: 2.000 m to go, 360 beams>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Controller {
    inner: Mutex<Inner>,
    stack: String,
    cycle_s: f64,
    sensor: RangeSensor,
}

struct Inner {
    controller: keyway::navigate::Controller,
    scan: Scan,
}

impl Controller {
    fn lock(&self) -> std::sync::MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Controller {
    #[new]
    #[pyo3(signature = (grid, start, goal, robot="small", stack="keyway", via=None, parameters=None, as_published=false, radius=None, safe=false, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        grid: &Map,
        start: Numbers,
        goal: Numbers,
        robot: &str,
        stack: &str,
        via: Option<Positions>,
        parameters: Option<Parameters>,
        as_published: bool,
        radius: Option<f64>,
        safe: bool,
        progress: Option<Progress>,
    ) -> PyResult<Self> {
        let robot = self::robot(robot, radius)?;
        let base = if as_published {
            let unknown = || bad_value(format!("nobody has published the stack `{stack}`"));
            Stack::published_by_name(stack).ok_or_else(unknown)?
        } else {
            find_stack(stack, Path::new(""), &robot).map_err(|error| config_file_error(&error))?
        };
        let base = base.safe_if(safe, &robot);
        let over = if as_published { StackBase::as_published } else { StackBase::for_robot };
        let config = parameters.unwrap_or_default().over(over(&base, &robot))?;
        let start = start.position("start")?;
        let (position, heading_rad) = goal.place("goal")?;
        let via = via.map_or_else(|| Ok(Vec::new()), |via| via.points("via"))?;
        let scan = Scan::of_nothing(&robot.sensor);
        let (cycle_s, sensor) = (robot.cycle_s, robot.sensor.clone());
        let known = Arc::clone(&grid.grid);
        let controller = watched(py, progress.as_ref(), move |_| {
            let goal = Goal { position, heading_rad };
            let stack = config.fit(&robot)?;
            keyway::navigate::Controller::by_way_of(&known, &stack, start, &via, goal)
        })?;
        let controller = controller.map_err(|error| navigate_error(&error))?;
        let inner = Mutex::new(Inner { controller, scan });
        Ok(Self { inner, stack: stack.to_owned(), cycle_s, sensor })
    }

    /// One control cycle: where the robot is (x, y, theta) [m, m, rad], how it moves (v, omega) [m/s, rad/s], and what its
    /// sensor sees.
    ///
    /// `scan` is a `keyway.Scan`, which says where each beam looks: `Simulation.scan`, or
    /// `keyway.Scan(ranges, angle_min, angle_increment)`. A message of ROS, `sensor_msgs/LaserScan`, is taken as it is.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> controller = keyway.Controller(grid, start=(1, 1), goal=(3, 1))
    /// >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=-np.pi, angle_increment=np.pi / 180)
    /// >>> step = controller.step((1, 1, 0), (0.2, 0), scan)
    /// >>> step.v > 0.2, step.status
    /// (True, 'drive')
    fn step(
        &self,
        py: Python<'_>,
        pose: Numbers,
        velocity: Numbers,
        scan: LaserScan,
    ) -> PyResult<Step> {
        let [x, y, theta] = pose.exactly("pose", "(x, y, theta)")?;
        let [v, omega] = velocity.exactly("velocity", "(v, omega)")?;
        // An angle that is no number stays one: the controller refuses it.
        let pose = if theta.is_finite() { Pose::new(x, y, theta) } else { Pose { x, y, theta } };
        Ok(py.detach(|| {
            let mut inner = self.lock();
            let Inner { controller, scan: own } = &mut *inner;
            scan.move_to(own);
            let step = controller.step(pose, Velocity::new(v, omega), own);
            Step::new(step, controller.too_near().map(ToString::to_string))
        }))
    }

    /// A scan of the robot's sensor in which nothing was met.
    #[getter]
    fn clear_scan(&self) -> crate::scan::Scan {
        crate::scan::Scan::new(Scan::of_nothing(&self.sensor))
    }

    /// Time between two commands [s].
    #[getter]
    fn cycle(&self) -> f64 {
        self.cycle_s
    }

    /// The route being followed: a read-only array of float64 of shape (n, 2) [m].
    #[getter]
    fn route(&self, py: Python<'_>) -> Floats2 {
        let route = py.detach(|| self.lock().controller.route().smoothed.clone());
        Floats2(of_points(py, route.points()))
    }

    /// The points that the guide hands out along the route, its end last: a read-only array of float64 of shape (n, 2) [m].
    #[getter]
    fn guide_points(&self, py: Python<'_>) -> Floats2 {
        let points = py.detach(|| self.lock().controller.guide_points());
        Floats2(of_points(py, &points))
    }

    /// That the robot begins nearer to something than it can stand, until it has left it, for people; otherwise `None`.
    #[getter]
    fn notice(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.lock().controller.too_near().map(ToString::to_string))
    }

    /// What is left of the way [m].
    #[getter]
    fn remaining(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.lock().controller.guidance().remaining_m)
    }

    /// Number of searches for a route: at first, when a scan showed something on it, at way-points, after waits, and in recoveries.
    #[getter]
    fn routes_planned(&self, py: Python<'_>) -> u32 {
        py.detach(|| self.lock().controller.routes_planned())
    }

    /// What was tried because the robot got no farther, by kind.
    fn recoveries(&self, py: Python<'_>) -> PyResult<Json> {
        let counts = py.detach(|| self.lock().controller.recoveries());
        json(py, &counts)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (remaining, beams) = (self.remaining(py), self.sensor.beams);
        format!("<keyway.Controller {}: {remaining:.3} m to go, {beams} beams>", self.stack)
    }
}
