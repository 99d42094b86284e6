//! Driving a robot.

use crate::arrays::{Floats2, Json, json, of_points};
use crate::errors::{bad_value, config_file_error, navigate_error};
use crate::map::{Map, map_of_array};
use crate::measured::Measured;
use crate::parameters::{Parameters, RobotName, robot};
use crate::points::AllPoints;
use crate::scan::LaserScans;
use crate::step::Step;
use crate::values::{Numbers, Positions};
use crate::watched::{Progress, watched};
use keyway::files::{StackBase, find_stack};
use keyway::geometry::{Point, Polyline, Pose, Velocity};
use keyway::map::Edit;
use keyway::navigate::{Goal, Masks, SpeedMask, Stack};
use keyway::robot::RangeSensor;
use keyway::sense::Scan;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Drives a robot to goals: plans on the known map, remembers what scans show, and decides on a
/// velocity in every cycle.
///
/// `robot` and `stack` are names of `keyway.names`, or files; a robot may also be a dictionary with
/// the fields of its file, such as `dict(like="jackal", limits=dict(v_max_mps=0.5))`, and is the
/// `small` one unless given. `parameters` are laid over the stack, as a dictionary with the names
/// of the TOML files. With `as_published` the stack has the values
/// of its paper. With `safe` only commands are issued after which the robot can still stop before
/// it touches anything, whatever the stack wants. `progress(done, expected)` is called while the
/// layers of the map are made, which are not counted: (0, None).
///
/// It has no goal at first. Goals come and go while the robot drives; what was sensed stays.
///
/// Raises `ValueError` for a value that cannot be used.
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

    /// Searches without holding the navigator, and takes the goal only if nothing is raised
    /// meanwhile.
    fn set(
        &self,
        py: Python<'_>,
        via: &[Point],
        goal: &Numbers,
        progress: Option<&Progress>,
    ) -> PyResult<()> {
        let (position, heading_rad) = goal.place("goal")?;
        let goal = Goal { position, heading_rad };
        let job = py.detach(|| self.lock().navigator.plan_job(via, goal));
        let job = job.map_err(|error| navigate_error(&error))?;
        let planned = watched(py, progress, move |_| job.run())?;
        py.detach(|| self.lock().navigator.accept(planned)).map_err(|error| navigate_error(&error))
    }
}

#[pymethods]
impl Navigator {
    #[new]
    #[pyo3(signature = (grid, robot=None, stack="keyway", parameters=None, as_published=false, radius=None, safe=false, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        grid: &Map,
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
            let unknown = || bad_value(format!("nobody has published the stack `{stack}`"));
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
        let inner = Mutex::new(Inner { navigator, scans });
        Ok(Self { inner, stack: stack.to_owned(), cycle_s, sensors })
    }

    /// Tells it where the robot is (x, y, theta) [m, m, rad]: before the first observation, or when
    /// the localisation has been corrected.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    fn relocate(&self, py: Python<'_>, pose: Numbers) -> PyResult<()> {
        let pose = told_pose(&pose)?;
        py.detach(|| self.lock().navigator.relocate(pose));
        Ok(())
    }

    /// Drives to a goal from now on, in the place of the last one: a position [m], or with a
    /// heading [m, m, rad].
    ///
    /// The robot may drive on in another thread while the route is searched. `progress(done,
    /// expected)` is called meanwhile; nothing is counted: (0, None).
    ///
    /// Raises `NoRoom` where the robot does not fit where it is or at the goal, `NoPath` where no
    /// way leads there, and `ValueError` where nobody has said where the robot is. Then it goes on
    /// as before.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.set_goal((3, 1))
    /// >>> navigator.goal
    /// [3.0, 1.0]
    #[pyo3(signature = (goal, progress=None))]
    fn set_goal(&self, py: Python<'_>, goal: Numbers, progress: Option<Progress>) -> PyResult<()> {
        self.set(py, &[], &goal, progress.as_ref())
    }

    /// The same by way of some positions, in their order [m].
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.set_goals([(3, 1)], (3, 3))
    /// >>> round(navigator.remaining, 3)
    /// 4.0
    #[pyo3(signature = (via, goal, progress=None))]
    fn set_goals(
        &self,
        py: Python<'_>,
        via: Positions,
        goal: Numbers,
        progress: Option<Progress>,
    ) -> PyResult<()> {
        self.set(py, &via.points("via")?, &goal, progress.as_ref())
    }

    /// Drives along a path from elsewhere, an array of shape (n, 2) [m] that begins near the robot,
    /// to its end, as closely as along a route of its own. Where something is in the way, such a
    /// route to the end takes its place.
    ///
    /// Raises `NoRoom` where the map shows that the robot does not fit along it, and `ValueError`
    /// for what is no path. Then it goes on as before.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.follow([(1, 1), (1, 3), (3, 3)])
    /// >>> round(navigator.remaining, 3)
    /// 4.0
    fn follow(&self, py: Python<'_>, path: Positions) -> PyResult<()> {
        let path = Polyline::new(path.points("path")?);
        py.detach(|| self.lock().navigator.follow(path)).map_err(|error| navigate_error(&error))
    }

    /// Turns on the spot by an angle [rad], positive to the left, within a time [s]. The robot
    /// brakes first, and has arrived when it stands again. Nothing is touched: where there is no
    /// room it waits, until its time is over.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.spin(1.5, allowance=20)
    fn spin(&self, py: Python<'_>, angle: f64, allowance: f64) -> PyResult<()> {
        py.detach(|| self.lock().navigator.spin(angle, allowance)).map_err(bad_value)
    }

    /// Drives straight back by a distance [m] in the same way.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.back_up(0.5, allowance=20)
    /// Traceback (most recent call last):
    /// ValueError: distance_m cannot be driven: the robot does not drive backwards (`v_min_mps`)
    fn back_up(&self, py: Python<'_>, distance: f64, allowance: f64) -> PyResult<()> {
        py.detach(|| self.lock().navigator.back_up(distance, allowance)).map_err(bad_value)
    }

    /// Drives straight ahead by a distance [m] in the same way.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.drive_on_heading(0.5, allowance=20)
    fn drive_on_heading(&self, py: Python<'_>, distance: f64, allowance: f64) -> PyResult<()> {
        py.detach(|| self.lock().navigator.drive_on_heading(distance, allowance)).map_err(bad_value)
    }

    /// Drives on another map from now on: one that has grown, or whose origin has moved. What was
    /// sensed keeps its place in the world.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> free = np.zeros((80, 80), dtype=bool)
    /// >>> navigator.set_map(keyway.Map.from_array(free, resolution=0.1, origin=(-2, -2)))
    /// >>> navigator.set_goal((-1, -1))
    fn set_map(&self, py: Python<'_>, grid: &Map) -> PyResult<()> {
        let map = Arc::clone(&grid.grid);
        py.detach(|| self.lock().navigator.set_map(&map)).map_err(|error| navigate_error(&error))
    }

    /// Changes a part of the map to that of another one, cell by cell at the centres of the cells
    /// of `window`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> wall = np.ones((2, 5), dtype=bool)
    /// >>> navigator.edit_map(keyway.Map.from_array(wall, resolution=0.1, origin=(2, 1)))
    /// >>> navigator.map
    /// <keyway.Map 40 x 40 cells of 0.1 m from (0, 0), 10 occupied, 0 unknown>
    fn edit_map(&self, py: Python<'_>, window: &Map) {
        let window = Arc::clone(&window.grid);
        py.detach(|| {
            let navigator = &mut self.lock().navigator;
            let (from, to) = (*window.frame(), *navigator.map().frame());
            let edit = |cell| {
                let state = window.state(cell)?;
                Some(Edit { cell: to.cell_from_world(from.world_from_cell(cell))?, state })
            };
            let edits: Vec<Edit> = from.cells().filter_map(edit).collect();
            navigator.edit_map(&edits);
        });
    }

    /// The map, as it was given and edited.
    #[getter]
    fn map(&self, py: Python<'_>) -> Map {
        py.detach(|| map_of_array(self.lock().navigator.map().clone()))
    }

    /// Drives no faster than this from now on [m/s]; `None`: as fast as the robot can.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.set_speed_limit(0.2)
    #[pyo3(signature = (speed=None))]
    fn set_speed_limit(&self, py: Python<'_>, speed: Option<f64>) -> PyResult<()> {
        py.detach(|| self.lock().navigator.set_speed_limit(speed)).map_err(bad_value)
    }

    /// Keeps out of the occupied cells of one map, and drives no faster than a speed [m/s] on those
    /// of another one, in the place of what was given before. Their frames need not be that of the
    /// navigator's map.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> zone = keyway.Map.from_array(np.ones((1, 1), dtype=bool), resolution=1.0, origin=(2, 2))
    /// >>> navigator.set_masks(keep_out=zone)
    #[pyo3(signature = (keep_out=None, slow=None))]
    fn set_masks(
        &self,
        py: Python<'_>,
        keep_out: Option<PyRef<'_, Map>>,
        slow: Option<(PyRef<'_, Map>, f64)>,
    ) -> PyResult<()> {
        let keep_out = keep_out.map(|map| Arc::clone(&map.grid));
        let speed = slow.map(|(map, speed_mps)| {
            let grid = &map.grid;
            let limit = |cell| if grid.occupied().get(cell) { speed_mps } else { f64::INFINITY };
            SpeedMask::new(*grid.frame(), grid.frame().cells().map(limit).collect())
        });
        let speed = speed.transpose().map_err(bad_value)?;
        py.detach(|| self.lock().navigator.set_masks(Masks { keep_out, speed }));
        Ok(())
    }

    /// Forgets all that was sensed, standing and moving.
    fn forget_sensed(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.forget_sensed());
    }

    /// The clock of all stamps begins anew: the next observation may have any stamp.
    fn restart_clock(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.restart_clock());
    }

    /// A route between two positions on what is known and sensed: a read-only array of float64 of
    /// shape (n, 2) [m]. Nothing changes by it.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.plan((1, 1), (3, 1)).tolist()
    /// [[1.0, 1.0], [3.0, 1.0]]
    fn plan(&self, py: Python<'_>, start: Numbers, goal: Numbers) -> PyResult<Floats2> {
        let (start, goal) = (start.position("start")?, goal.position("goal")?);
        let route = py.detach(|| self.lock().navigator.plan(start, goal));
        let route = route.map_err(|error| navigate_error(&error))?;
        Ok(Floats2(of_points(py, route.smoothed.points())))
    }

    /// True if the robot fits along all of a path among what is known and sensed, turning on the
    /// spot at its corners.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.is_path_valid([(1, 1), (3, 1)]), navigator.is_path_valid([(1, 1), (9, 1)])
    /// (True, False)
    fn is_path_valid(&self, py: Python<'_>, path: Positions) -> PyResult<bool> {
        let path = Polyline::new(path.points("path")?);
        Ok(py.detach(|| self.lock().navigator.is_path_valid(&path)))
    }

    /// Contradictions in what was observed lately, for people, such as a velocity that is always 0
    /// although the pose moves.
    #[getter]
    fn doubts(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.lock().navigator.doubts().iter().map(ToString::to_string).collect())
    }

    /// Gives up what it was asked to do: the robot brakes, and stands.
    fn cancel(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.cancel());
    }

    /// Takes in what was measured: at a time [s], where the robot is (x, y, theta) [m, m, rad], how
    /// it moves (v, omega) [m/s, rad/s], and what its sensors see. Stamps are by any clock, the
    /// same for all. They say when something was measured, not when it arrived.
    ///
    /// `scan` is a `keyway.Scan`, which says where each beam looks: `Simulation.scan`, or
    /// `keyway.Scan(ranges, angle_min, angle_increment)`. A message of ROS,
    /// `sensor_msgs/LaserScan`, is taken as it is, with the stamp of its header. A scan without a
    /// stamp was made when the pose was measured. A robot with several sensors gives a list with
    /// one scan of each, in their order, `None` where a sensor has made none. Without `scan` none
    /// has arrived. `points` are those of other sensors: a `keyway.Points`, or a list of them.
    ///
    /// An observation that cannot be true, or is older than the last one, is not taken in; the next
    /// `step` then stops the robot and says why.
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

    /// One control cycle: what the robot is to do, from what was observed. It counts for the time
    /// that has passed by the stamps since the last step; the first one for a cycle of the robot.
    fn step(&self, py: Python<'_>) -> Step {
        py.detach(|| {
            let navigator = &mut self.lock().navigator;
            let step = navigator.step();
            Step::new(step, navigator.too_near().map(ToString::to_string))
        })
    }

    /// A scan of the robot's first sensor in which nothing was met.
    #[getter]
    fn clear_scan(&self) -> crate::scan::Scan {
        crate::scan::Scan::new(Scan::of_nothing(&self.sensors[0]), None)
    }

    /// Time between two commands [s].
    #[getter]
    fn cycle(&self) -> f64 {
        self.cycle_s
    }

    /// The goal (x, y) [m], or with a heading (x, y, heading) [m, m, rad]; `None` where there is
    /// none.
    #[getter]
    fn goal(&self, py: Python<'_>) -> Option<Vec<f64>> {
        let Goal { position, heading_rad } = py.detach(|| self.lock().navigator.goal())?;
        Some([Some(position.x), Some(position.y), heading_rad].into_iter().flatten().collect())
    }

    /// The route being followed: a read-only array of float64 of shape (n, 2) [m]; empty without a
    /// goal.
    #[getter]
    fn route(&self, py: Python<'_>) -> Floats2 {
        let points = py.detach(|| {
            let inner = self.lock();
            inner.navigator.route().map_or_else(Vec::new, |route| route.smoothed.points().to_vec())
        });
        Floats2(of_points(py, &points))
    }

    /// The points that the guide hands out along the route, its end last: a read-only array of
    /// float64 of shape (n, 2) [m].
    #[getter]
    fn guide_points(&self, py: Python<'_>) -> Floats2 {
        Floats2(of_points(py, &py.detach(|| self.lock().navigator.guide_points())))
    }

    /// That the robot was nearer to something than it can stand when it got its goal, until it has
    /// left it, for people; otherwise `None`.
    #[getter]
    fn notice(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| self.lock().navigator.too_near().map(ToString::to_string))
    }

    /// Remaining length of the way [m]; `None` without a goal.
    #[getter]
    fn remaining(&self, py: Python<'_>) -> Option<f64> {
        py.detach(|| self.lock().navigator.guidance().map(|guidance| guidance.remaining_m))
    }

    /// Number of searches for a route: at first for each goal, when a scan showed something on it,
    /// at way-points, after waits, and in recoveries.
    #[getter]
    fn routes_planned(&self, py: Python<'_>) -> u32 {
        py.detach(|| self.lock().navigator.routes_planned())
    }

    /// Counts of what was tried because the robot got no farther, by kind.
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

/// A pose whose angle may be no number: the navigator refuses it.
fn told_pose(pose: &Numbers) -> PyResult<Pose> {
    let [x, y, theta] = pose.exactly("pose", "(x, y, theta)")?;
    Ok(if theta.is_finite() { Pose::new(x, y, theta) } else { Pose { x, y, theta } })
}
