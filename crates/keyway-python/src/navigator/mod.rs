//! The navigator, which drives a robot.

mod changes;
mod storing;
mod tasks;

use crate::arrays::{Floats2, Json, json, of_points};
use crate::errors::{bad_value, config_file_error, navigate_error};
use crate::given_map::GivenMap;
use crate::measured::Measured;
use crate::parameters::{Parameters, RobotName, robot};
use crate::points::AllPoints;
use crate::scan::LaserScans;
use crate::step::Step;
use crate::values::{Numbers, place};
use crate::watched::{Progress, watched};
use keyway::files::{StackBase, find_stack};
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::{Goal, Stack};
use keyway::robot::RangeSensor;
use keyway::sense::Scan;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Drives a robot to goals: plans on the known map, remembers sensed obstacles, and decides on a
/// velocity in every cycle.
///
/// `robot` and `stack` are names of `keyway.names`, or files. A robot may also be a dictionary
/// with the fields of its file, such as `dict(like="jackal", limits=dict(v_max_mps=0.5))`; the
/// default is `small`. `parameters` override those of the stack, as a dictionary with the names
/// of the TOML files. With `as_published` the stack has the parameters of its paper. With `safe`,
/// only commands are issued after which the robot can still stop before a contact, overriding the
/// stack. `progress(done, expected)` is called while the layers of the map are built; they are
/// not counted: (0, None).
///
/// A new navigator has no goal. Goals may change while the robot drives; sensed obstacles are
/// kept.
///
/// Raises `ValueError` for an invalid value.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
/// >>> navigator = keyway.Navigator(grid, robot="small", stack="keyway")
/// >>> navigator.relocate((1, 1, 0))
/// >>> navigator.set_goal((3, 1))
/// >>> navigator
/// <keyway.Navigator keyway: 2.000 m to go, 360 beams>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Navigator {
    inner: Mutex<Inner>,
    stack: String,
    cycle_s: f64,
    sensors: Vec<RangeSensor>,
}

struct Inner {
    navigator: keyway::navigate::Navigator,
    /// The last scan of each sensor.
    scans: Vec<Scan>,
}

impl Navigator {
    fn lock(&self) -> std::sync::MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn of_parts(
        navigator: keyway::navigate::Navigator,
        scans: Vec<Scan>,
        (stack, cycle_s, sensors): (String, f64, Vec<RangeSensor>),
    ) -> Self {
        let inner = Mutex::new(Inner { navigator, scans });
        Self { inner, stack, cycle_s, sensors }
    }
}

#[pymethods]
impl Navigator {
    #[new]
    #[pyo3(signature = (grid, robot=None, stack="keyway", parameters=None, as_published=false, radius=None, safe=false, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        grid: GivenMap,
        robot: Option<RobotName>,
        stack: &str,
        parameters: Option<Parameters>,
        as_published: bool,
        radius: Option<f64>,
        safe: bool,
        progress: Option<Progress>,
    ) -> PyResult<Self> {
        let name = robot.as_ref().map_or("small", |RobotName(name)| name);
        let robot = self::robot(name, radius)?;
        let base = if as_published {
            let unknown = || bad_value(format!("the stack `{stack}` has no published parameters"));
            Stack::published_by_name(stack).ok_or_else(unknown)?
        } else {
            find_stack(stack, Path::new(""), &robot).map_err(|error| config_file_error(&error))?
        };
        let base = base.safe_if(safe, &robot);
        let over = if as_published { StackBase::as_published } else { StackBase::for_robot };
        let config = parameters.unwrap_or_default().over(over(&base, &robot))?;
        let scans = robot.sensors.iter().map(Scan::of_nothing).collect();
        let (cycle_s, sensors) = (robot.cycle_s, robot.sensors.clone());
        let known = Arc::clone(&grid.grid);
        let navigator = watched(py, progress.as_ref(), move |_| {
            keyway::navigate::Navigator::new(&known, &config.fit(&robot)?)
        })?;
        let navigator = navigator.map_err(|error| navigate_error(&error))?;
        Ok(Self::of_parts(navigator, scans, (stack.to_owned(), cycle_s, sensors)))
    }

    /// Messages about inconsistencies in recent observations, such as a velocity that is always 0
    /// although the pose changes.
    #[getter]
    fn doubts(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.lock().navigator.doubts().iter().map(ToString::to_string).collect())
    }

    /// Passes an observation: at a time [s], the pose (x, y, theta) [m, m, rad] and velocity (v,
    /// omega) [m/s, rad/s] of the robot, and the data of its sensors. Stamps may be of any clock,
    /// the same for all. They are the times of the measurements, not of their arrival.
    ///
    /// `scan` is a `keyway.Scan`, which has the bearing of each beam: `Simulation.scan`, or
    /// `keyway.Scan(ranges, angle_min, angle_increment)`. A ROS message, `sensor_msgs/LaserScan`,
    /// is accepted as it is, with the stamp of its header. A scan without a stamp has that of the
    /// pose. For a robot with several sensors it is a list with one scan per sensor, in their
    /// order, `None` for a sensor without a new scan. Without `scan`, there is no new scan.
    /// `points` are those of other sensors: a `keyway.Points`, or a list of them.
    ///
    /// An implausible observation, or one older than the last, is ignored; the next `step` then
    /// stops the robot and gives the reason.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=-np.pi, angle_increment=np.pi / 180)
    /// >>> navigator.observe(12.5, (1, 1, 0), (0.2, 0), scan)
    /// >>> navigator.set_goal((3, 1))
    /// >>> step = navigator.step()
    /// >>> step.v > 0.2, step.status
    /// (True, 'drive')
    #[pyo3(signature = (stamp, pose, velocity, scan=None, points=None))]
    fn observe(
        &self,
        py: Python<'_>,
        stamp: f64,
        pose: Numbers,
        velocity: Numbers,
        scan: Option<LaserScans>,
        points: Option<AllPoints>,
    ) -> PyResult<()> {
        let pose = told_pose(&pose)?;
        let [v, omega] = velocity.exactly("velocity", "(v, omega)")?;
        let given = scan.map_or_else(Vec::new, |LaserScans(given)| given);
        if given.len() != self.sensors.len() && !given.is_empty() {
            let (given, sensors) = (given.len(), self.sensors.len());
            return Err(bad_value(format!("scan: got {given} scans for {sensors} sensors")));
        }
        let points = points.map_or_else(Vec::new, |AllPoints(points)| points);
        let measured = Measured { stamp_s: stamp, pose, velocity: Velocity::new(v, omega) };
        py.detach(|| {
            let Inner { navigator, scans } = &mut *self.lock();
            measured.observe(navigator, (&self.sensors, scans), given, &points);
        });
        Ok(())
    }

    /// Runs one control cycle: returns the command for the robot, based on the observations. The
    /// cycle covers the time between the stamps of the last step and now; the first one lasts one
    /// cycle of the robot.
    fn step(&self, py: Python<'_>) -> Step {
        py.detach(|| {
            let navigator = &mut self.lock().navigator;
            let step = navigator.step();
            Step::new(step, navigator.too_near().map(ToString::to_string))
        })
    }

    /// A scan of the robot's first sensor without hits.
    #[getter]
    fn clear_scan(&self) -> crate::scan::Scan {
        crate::scan::Scan::new(Scan::of_nothing(&self.sensors[0]), None)
    }

    /// Time between two commands [s].
    #[getter]
    fn cycle(&self) -> f64 {
        self.cycle_s
    }

    /// The goal (x, y) [m], or with a heading (x, y, heading) [m, m, rad]; `None` if there is
    /// none.
    #[getter]
    fn goal(&self, py: Python<'_>) -> Option<Vec<f64>> {
        let Goal { position, heading_rad } = py.detach(|| self.lock().navigator.goal())?;
        Some(place(position, heading_rad))
    }

    /// The current route: a read-only array of float64 of shape (n, 2) [m]; empty without a goal.
    #[getter]
    fn route(&self, py: Python<'_>) -> Floats2 {
        let points = py.detach(|| {
            let inner = self.lock();
            inner.navigator.route().map_or_else(Vec::new, |route| route.smoothed.points().to_vec())
        });
        Floats2(of_points(py, &points))
    }

    /// The points of the guide along the route, its end last: a read-only array of float64 of
    /// shape (n, 2) [m].
    #[getter]
    fn guide_points(&self, py: Python<'_>) -> Floats2 {
        Floats2(of_points(py, &py.detach(|| self.lock().navigator.guide_points())))
    }

    /// Message that the robot had less clearance than it needs when it got its goal, until it has
    /// left the obstacle; otherwise `None`.
    #[getter]
    fn notice(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.lock().navigator.too_near().map(ToString::to_string))
    }

    /// Remaining length of the route [m]; `None` without a goal.
    #[getter]
    fn remaining(&self, py: Python<'_>) -> Option<f64> {
        py.detach(|| self.lock().navigator.guidance().map(|guidance| guidance.remaining_m))
    }

    /// Number of route searches: one for each goal, and more when a scan shows an obstacle on the
    /// route, at waypoints, after waits, and in recoveries.
    #[getter]
    fn routes_planned(&self, py: Python<'_>) -> u32 {
        py.detach(|| self.lock().navigator.routes_planned())
    }

    /// Returns the number of recoveries, by kind.
    fn recoveries(&self, py: Python<'_>) -> PyResult<Json> {
        json(py, &py.detach(|| self.lock().navigator.recoveries()))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let beams: u32 = self.sensors.iter().map(|sensor| sensor.beams).sum();
        let doing = self.remaining(py).map_or_else(
            || "no goal".to_owned(),
            |remaining_m| format!("{remaining_m:.3} m to go"),
        );
        format!("<keyway.Navigator {}: {doing}, {beams} beams>", self.stack)
    }
}

/// Converts a pose. Its angle may be non-finite: the navigator refuses it.
fn told_pose(pose: &Numbers) -> PyResult<Pose> {
    let [x, y, theta] = pose.exactly("pose", "(x, y, theta)")?;
    Ok(if theta.is_finite() { Pose::new(x, y, theta) } else { Pose { x, y, theta } })
}
