//! Changes of the robot's environment: its pose, the clock, the map, and limits.

use super::{Navigator, told_pose};
use crate::errors::{bad_value, navigate_error};
use crate::given_map::GivenMap;
use crate::map::{Map, map_of_array};
use crate::values::Numbers;
use keyway::geometry::Velocity;
use keyway::map::Edit;
use keyway::navigate::{Masks, SpeedMask};
use pyo3::prelude::*;
use std::sync::Arc;

#[pymethods]
impl Navigator {
    /// Sets the pose of the robot (x, y, theta) [m, m, rad]: before the first observation, or
    /// after a correction of the localisation.
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

    /// Notes that the robot received a command (v, omega) [m/s, rad/s] from another source, such
    /// as a joystick or a safety controller, in place of that of the last step. `now` is the time
    /// by the clock of the stamps [s]. Call it for every such command.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.note_override(0.1, (0, 0))
    fn note_override(&self, py: Python<'_>, now: f64, command: Numbers) -> PyResult<()> {
        let [v, omega] = command.exactly("command", "(v, omega)")?;
        py.detach(|| self.lock().navigator.note_override(now, Velocity::new(v, omega)));
        Ok(())
    }

    /// Replaces the map, such as by one that has grown, or whose origin has moved. Sensed
    /// obstacles keep their positions in the world.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> free = np.zeros((80, 80), dtype=bool)
    /// >>> navigator.set_map(keyway.Map.from_array(free, resolution=0.1, origin=(-2, -2)))
    /// >>> navigator.set_goal((-1, -1))
    fn set_map(&self, py: Python<'_>, grid: GivenMap) -> PyResult<()> {
        let map = Arc::clone(&grid.grid);
        py.detach(|| self.lock().navigator.set_map(&map)).map_err(|error| navigate_error(&error))
    }

    /// Replaces a part of the map by that of another one, cell by cell at the centres of the
    /// cells of `window`.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> wall = np.ones((2, 5), dtype=bool)
    /// >>> navigator.edit_map(keyway.Map.from_array(wall, resolution=0.1, origin=(2, 1)))
    /// >>> navigator.map
    /// <keyway.Map 40 x 40 cells of 0.1 m from (0, 0), 10 occupied, 0 unknown>
    fn edit_map(&self, py: Python<'_>, window: GivenMap) {
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

    /// The map as given, with all edits.
    #[getter]
    fn map(&self, py: Python<'_>) -> Map {
        py.detach(|| map_of_array(self.lock().navigator.map().clone()))
    }

    /// Limits the speed from now on [m/s]; `None` removes the limit.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.set_speed_limit(0.2)
    #[pyo3(signature = (speed=None))]
    fn set_speed_limit(&self, py: Python<'_>, speed: Option<f64>) -> PyResult<()> {
        py.detach(|| self.lock().navigator.set_speed_limit(speed)).map_err(bad_value)
    }

    /// Keeps out of the occupied cells of one map, and limits the speed [m/s] on those of another
    /// one. They replace earlier masks. Their frames may differ from that of the navigator's map.
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
        keep_out: Option<GivenMap>,
        slow: Option<(GivenMap, f64)>,
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

    /// Clears everything sensed, static and moving.
    fn forget_sensed(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.forget_sensed());
    }

    /// Restarts the clock of all stamps: the next observation may have any stamp.
    fn restart_clock(&self, py: Python<'_>) {
        py.detach(|| self.lock().navigator.restart_clock());
    }
}
