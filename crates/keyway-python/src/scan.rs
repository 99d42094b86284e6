//! Scans.

use crate::arrays::{Floats1, copied};
use crate::errors::bad_value;
use crate::values::{Ranges, described};
use keyway::sense::Scan as Beams;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// One turn of a range sensor, with the names and the meaning of `sensor_msgs/LaserScan`.
///
/// `ranges` are those of all beams [m]: infinity means that nothing was met, and NaN or 0 that the beam says nothing. Beam i looks
/// at the bearing `angle_min + i * angle_increment` [rad], 0 straight ahead and positive to the left: where the beams go
/// clockwise, `angle_increment` is negative. Sensors begin at the back, ahead or at a side; so neither angle has a default.
///
/// >>> import keyway, numpy as np
/// >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=0.0, angle_increment=np.pi / 180)
/// >>> scan, round(float(scan.bearings[90]), 3)
/// (<keyway.Scan 360 beams from 0.000 to 6.266 rad>, 1.571)
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Scan(Beams);

impl Scan {
    pub(crate) const fn new(beams: Beams) -> Self {
        Self(beams)
    }
}

#[pymethods]
impl Scan {
    #[new]
    #[pyo3(signature = (ranges, angle_min, angle_increment))]
    fn of(ranges: Ranges<'_>, angle_min: f64, angle_increment: f64) -> PyResult<Self> {
        beams(&ranges, angle_min, angle_increment).map(Self)
    }

    /// Ranges of all beams: a new array of float64 [m].
    #[getter]
    fn ranges(&self, py: Python<'_>) -> Floats1 {
        copied(py, &self.0.ranges_m)
    }

    /// Bearing of beam 0 [rad], 0 straight ahead, positive to the left.
    #[getter]
    const fn angle_min(&self) -> f64 {
        self.0.angle_min_rad
    }

    /// Bearing from one beam to the next [rad], negative where they go clockwise.
    #[getter]
    const fn angle_increment(&self) -> f64 {
        self.0.angle_increment_rad
    }

    /// Bearings of all beams: a new array of float64 [rad].
    #[getter]
    fn bearings(&self, py: Python<'_>) -> Floats1 {
        let bearings = (0..self.0.ranges_m.len()).map(|beam| self.0.bearing_rad(beam));
        copied(py, &bearings.collect::<Vec<_>>())
    }

    fn __len__(&self) -> usize {
        self.0.ranges_m.len()
    }

    fn __repr__(&self) -> String {
        let count = self.0.ranges_m.len();
        let [first, last] = [0, count - 1].map(|beam| self.0.bearing_rad(beam));
        format!("<keyway.Scan {count} beams from {first:.3} to {last:.3} rad>")
    }
}

/// The beams of a scan that can be true. How far they see is the robot's to say.
fn beams(ranges: &Ranges<'_>, angle_min_rad: f64, angle_increment_rad: f64) -> PyResult<Beams> {
    let ranges_m = ranges.numbers("ranges")?;
    let beams = Beams { angle_min_rad, angle_increment_rad, ranges_m, ..Beams::default() };
    beams.check().map_err(bad_value)?;
    Ok(beams)
}

/// A scan that comes in: one of this package, or anything else with the same three attributes, such as a message of ROS.
pub(crate) struct LaserScan(Beams);

impl LaserScan {
    /// Overwrites the beams of a scan.
    pub(crate) fn move_to(self, scan: &mut Beams) {
        let Beams { angle_min_rad, angle_increment_rad, ranges_m, .. } = self.0;
        (scan.angle_min_rad, scan.angle_increment_rad) = (angle_min_rad, angle_increment_rad);
        scan.ranges_m = ranges_m;
    }
}

impl<'py> FromPyObject<'_, 'py> for LaserScan {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        pyo3::type_hint_identifier!("keyway.typing", "LaserScan");

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scan) = object.cast::<Scan>() {
            return Ok(Self(scan.get().0.clone()));
        }
        let expected = |_: PyErr| {
            let got = described(&object);
            PyTypeError::new_err(format!(
                "expected a keyway.Scan, or a message such as sensor_msgs/LaserScan, got {got}: ranges alone do not say where \
                 their beams look"
            ))
        };
        let ranges: Ranges<'_> = object.getattr("ranges").map_err(expected)?.extract()?;
        let angle = |name| object.getattr(name).and_then(|angle| angle.extract()).map_err(expected);
        beams(&ranges, angle("angle_min")?, angle("angle_increment")?).map(Self)
    }
}
