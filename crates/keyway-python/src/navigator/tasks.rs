//! Goals, external paths and single behaviours of a navigator, and queries about paths.

use super::Navigator;
use crate::arrays::{Floats2, of_points};
use crate::errors::{bad_value, navigate_error};
use crate::values::{Numbers, Positions};
use crate::watched::{Progress, watched};
use keyway::geometry::{PlannedLine, Point, Polyline};
use keyway::navigate::Goal;
use pyo3::prelude::*;

impl Navigator {
    /// Searches without locking the navigator, and sets the goal only if no exception is raised
    /// meanwhile.
    fn set(
        &self,
        py: Python<'_>,
        via: &[Point],
        goal: &Numbers,
        progress: Option<&Progress>,
    ) -> PyResult<()> {
        let (position, heading_rad) = goal.place(py, "goal")?;
        let goal = Goal { position, heading_rad };
        let job = py.detach(|| self.lock().navigator.plan_job(via, goal));
        let job = job.map_err(|error| navigate_error(&error))?;
        let planned = watched(py, progress, move |_| job.run())?;
        py.detach(|| self.lock().navigator.accept(planned)).map_err(|error| navigate_error(&error))
    }
}

#[pymethods]
impl Navigator {
    /// Sets the goal, in place of the last one: a position [m], or with a heading [m, m, rad].
    ///
    /// The robot may continue to drive in another thread during the search.
    /// `progress(done, expected)` is called meanwhile; nothing is counted: (0, None).
    ///
    /// Raises `NoRoom` if the robot does not fit at its pose or at the goal, `NoPath` if no path
    /// leads there, and `ValueError` if the pose of the robot is unknown. The navigator then
    /// continues as before.
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

    /// Sets a goal with waypoints before it, in their order [m].
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

    /// Follows an external path to its end, as closely as a route of its own. `path` is an array
    /// of shape (n, 2) [m] that starts near the robot. If an obstacle blocks it, a new route to
    /// its end replaces it.
    ///
    /// Raises `NoRoom` if the robot does not fit along it on the map, and `ValueError` for an
    /// invalid path. The navigator then continues as before.
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
    /// brakes first, and the turn ends when it is stationary again. It avoids contact: without
    /// enough clearance it waits, until the time is over. A car-like robot refuses (`ValueError`).
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.spin(1.5, allowance=20)
    fn spin(&self, py: Python<'_>, angle: f64, allowance: f64) -> PyResult<()> {
        py.detach(|| self.lock().navigator.spin(angle, allowance)).map_err(bad_value)
    }

    /// Drives straight back by a distance [m], with the same rules as `spin`.
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

    /// Drives straight ahead by a distance [m], with the same rules as `spin`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.drive_on_heading(0.5, allowance=20)
    fn drive_on_heading(&self, py: Python<'_>, distance: f64, allowance: f64) -> PyResult<()> {
        py.detach(|| self.lock().navigator.drive_on_heading(distance, allowance)).map_err(bad_value)
    }

    /// Cancels the current task: the robot brakes to a stop.
    fn cancel(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.cancel());
    }

    /// Plans a route between two positions on the map and the sensed obstacles: a read-only array
    /// of float64 of shape (n, 2) [m]. The navigator does not change. Raises an exception if the
    /// robot is in contact at the start.
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

    /// True if the robot fits along the whole path on the map and among the sensed obstacles,
    /// turning on the spot at its corners.
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

    /// Smooths a line of positions as the navigator's routes are, with the same clearance to the
    /// map and the sensed obstacles where the line has it. Returns a read-only array of float64
    /// of shape (n, 2) [m].
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.smooth([(1, 1), (2, 1.5), (3, 1)]).tolist()
    /// [[1.0, 1.0], [3.0, 1.0]]
    fn smooth(&self, py: Python<'_>, path: Positions) -> PyResult<Floats2> {
        let line = PlannedLine::from(Polyline::new(path.points("path")?));
        let smoothed = py.detach(|| self.lock().navigator.smooth(&line));
        Ok(Floats2(of_points(py, smoothed.points())))
    }

    /// Returns the position nearest to a goal that is reachable from a start, on the map and the
    /// sensed obstacles [m]; `None` if nothing is reachable.
    ///
    /// >>> import keyway, numpy as np
    /// >>> walls = np.zeros((40, 40), dtype=bool)
    /// >>> walls[:, 20] = True
    /// >>> navigator = keyway.Navigator(keyway.Map.from_array(walls, resolution=0.1))
    /// >>> navigator.nearest_reachable((1, 1), (3, 1))[0] < 2
    /// True
    fn nearest_reachable(
        &self,
        py: Python<'_>,
        start: Numbers,
        goal: Numbers,
    ) -> PyResult<Option<(f64, f64)>> {
        let (start, goal) = (start.position("start")?, goal.position("goal")?);
        let nearest = py.detach(|| self.lock().navigator.nearest_reachable(start, goal));
        Ok(nearest.map(|Point { x, y }| (x, y)))
    }
}
