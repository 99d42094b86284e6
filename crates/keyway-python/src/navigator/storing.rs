//! Snapshots of a navigator.

use super::Navigator;
use crate::errors::bad_value;
use keyway::navigate::Snapshot;
use keyway::sense::Scan;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

/// A snapshot, and the name of its stack.
#[derive(Serialize, Deserialize)]
struct Stored {
    stack: String,
    snapshot: Snapshot,
}

#[pymethods]
impl Navigator {
    /// Returns the complete state as bytes. `Navigator.restore` creates the same navigator from
    /// them, which gives the same steps from here on. Copying and pickling use snapshots.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
    /// >>> navigator = keyway.Navigator(grid)
    /// >>> navigator.relocate((1, 1, 0))
    /// >>> navigator.set_goal((3, 1))
    /// >>> keyway.Navigator.restore(navigator.snapshot())
    /// <keyway.Navigator keyway: 2.000 m to go, 360 beams>
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let stored = py.detach(|| {
            let snapshot = self.lock().navigator.snapshot();
            let mut bytes = Vec::new();
            let stored = Stored { stack: self.stack.clone(), snapshot };
            ciborium::into_writer(&stored, &mut bytes).map(|()| bytes)
        });
        Ok(PyBytes::new(py, &stored.map_err(bad_value)?))
    }

    /// Restores the navigator of a snapshot.
    ///
    /// Raises `ValueError` for bytes that are not a snapshot, or of another version of Keyway.
    ///
    /// >>> import keyway
    /// >>> keyway.Navigator.restore(b"nonsense")
    /// Traceback (most recent call last):
    /// ValueError: snapshot: ...
    #[staticmethod]
    fn restore(py: Python<'_>, snapshot: &[u8]) -> PyResult<Self> {
        let blame = |error: &dyn std::fmt::Display| bad_value(format!("snapshot: {error}"));
        let restored = py.detach(|| {
            let Stored { stack, snapshot } =
                ciborium::from_reader(snapshot).map_err(|error| error.to_string())?;
            let navigator = keyway::navigate::Navigator::restore(snapshot);
            Ok((stack, navigator.map_err(|error| error.to_string())?))
        });
        let (stack, navigator) = restored.map_err(|error: String| blame(&error))?;
        let robot = navigator.stack().robot();
        let scans = robot.sensors.iter().map(Scan::of_nothing).collect();
        let (cycle_s, sensors) = (robot.cycle_s, robot.sensors.clone());
        Ok(Self::of_parts(navigator, scans, (stack, cycle_s, sensors)))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let restore = py.get_type::<Self>().getattr("restore")?;
        Ok((restore, (self.snapshot(py)?,)))
    }
}
