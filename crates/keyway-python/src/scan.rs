//! Laser scans.

use crate::arrays::{Floats1, copied};
use crate::errors::bad_value;
use crate::values::{Ranges, described};
use keyway::sense::Scan as Beams;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

/// One scan of a range sensor, with the names and the meaning of `sensor_msgs/LaserScan`.
///
/// `ranges` are those of all beams [m]: infinity means no hit, and NaN or 0 an invalid beam. Beam
/// i has the bearing `angle_min + i * angle_increment` [rad], 0 straight ahead and positive to
/// the left; if the beams go clockwise, `angle_increment` is negative. Sensors start at the back,
/// at the front or at a side, so neither angle has a default. `stamp` is the time of the scan
/// [s]; by default it is that of the pose given with it.
///
/// >>> import keyway, numpy as np
/// >>> scan = keyway.Scan(np.full(360, np.inf), angle_min=0.0, angle_increment=np.pi / 180)
/// >>> scan, round(float(scan.bearings[90]), 3)
/// (<keyway.Scan 360 beams from 0.000 to 6.266 rad>, 1.571)
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Scan {
    beams: Beams,
    stamp_s: Option<f64>,
}

impl Scan {
    pub(crate) const fn new(beams: Beams, stamp_s: Option<f64>) -> Self {
        Self { beams, stamp_s }
    }
}

#[pymethods]
impl Scan {
    #[new]
    #[pyo3(signature = (ranges, angle_min, angle_increment, stamp=None))]
    fn of(
        ranges: Ranges<'_>,
        angle_min: f64,
        angle_increment: f64,
        stamp: Option<f64>,
    ) -> PyResult<Self> {
        Ok(Self { beams: beams(&ranges, angle_min, angle_increment)?, stamp_s: stamp })
    }

    /// Ranges of all beams: a new array of float64 [m].
    #[getter]
    fn ranges(&self, py: Python<'_>) -> Floats1 {
        copied(py, &self.beams.ranges_m)
    }

    /// Bearing of beam 0 [rad], 0 straight ahead, positive to the left.
    #[getter]
    const fn angle_min(&self) -> f64 {
        self.beams.angle_min_rad
    }

    /// Bearing from one beam to the next [rad], negative if they go clockwise.
    #[getter]
    const fn angle_increment(&self) -> f64 {
        self.beams.angle_increment_rad
    }

    /// Bearings of all beams: a new array of float64 [rad].
    #[getter]
    fn bearings(&self, py: Python<'_>) -> Floats1 {
        let bearings = (0..self.beams.ranges_m.len()).map(|beam| self.beams.bearing_rad(beam));
        copied(py, &bearings.collect::<Vec<_>>())
    }

    /// Time of the scan [s]; `None` if it was not given.
    #[getter]
    const fn stamp(&self) -> Option<f64> {
        self.stamp_s
    }

    fn __len__(&self) -> usize {
        self.beams.ranges_m.len()
    }

    fn __repr__(&self) -> String {
        let count = self.beams.ranges_m.len();
        let [first, last] = [0, count - 1].map(|beam| self.beams.bearing_rad(beam));
        format!("<keyway.Scan {count} beams from {first:.3} to {last:.3} rad>")
    }
}

/// Checks the beams of a scan. The maximum range is checked by the robot's sensor.
fn beams(ranges: &Ranges<'_>, angle_min_rad: f64, angle_increment_rad: f64) -> PyResult<Beams> {
    let ranges_m = ranges.numbers("ranges")?;
    let beams = Beams { angle_min_rad, angle_increment_rad, ranges_m, ..Beams::default() };
    beams.check().map_err(bad_value)?;
    Ok(beams)
}

/// A scan argument: one of this package, or any object with the same three attributes, such as a
/// ROS message with a stamp in its header.
pub(crate) struct LaserScan {
    beams: Beams,
    stamp_s: Option<f64>,
}

impl LaserScan {
    /// Overwrites the beams of a scan. Returns the stamp of this one \[s\], if it has one.
    pub(crate) fn move_to(self, scan: &mut Beams) -> Option<f64> {
        let Beams { angle_min_rad, angle_increment_rad, ranges_m, .. } = self.beams;
        (scan.angle_min_rad, scan.angle_increment_rad) = (angle_min_rad, angle_increment_rad);
        scan.ranges_m = ranges_m;
        self.stamp_s
    }
}

/// The scans of a cycle: that of the robot's only sensor, or a list with one per sensor, `None`
/// for a sensor without a scan.
pub(crate) struct LaserScans(pub(crate) Vec<Option<LaserScan>>);

impl<'py> FromPyObject<'_, 'py> for LaserScans {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        pyo3::type_hint_identifier!("keyway.typing", "LaserScans");

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
            return object.extract().map(Self);
        }
        object.extract().map(|scan| Self(vec![Some(scan)]))
    }
}

impl<'py> FromPyObject<'_, 'py> for LaserScan {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        pyo3::type_hint_identifier!("keyway.typing", "LaserScan");

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scan) = object.cast::<Scan>() {
            let Scan { beams, stamp_s } = scan.get();
            return Ok(Self { beams: beams.clone(), stamp_s: *stamp_s });
        }
        let expected = |_: PyErr| {
            let got = described(&object);
            PyTypeError::new_err(format!(
                "expected a keyway.Scan, or a message such as sensor_msgs/LaserScan, got {got}: ranges alone do not contain \
                 the bearings of the beams"
            ))
        };
        let ranges: Ranges<'_> = object.getattr("ranges").map_err(expected)?.extract()?;
        let angle = |name| object.getattr(name).and_then(|angle| angle.extract()).map_err(expected);
        let beams = beams(&ranges, angle("angle_min")?, angle("angle_increment")?)?;
        Ok(Self { beams, stamp_s: header_stamp_s(&object) })
    }
}

/// Stamp of a ROS message \[s\]; `None` if it is not set.
fn header_stamp_s(message: &Bound<'_, PyAny>) -> Option<f64> {
    let stamp = message.getattr("header").and_then(|header| header.getattr("stamp")).ok()?;
    let part = |name| stamp.getattr(name).and_then(|part| part.extract::<f64>()).ok();
    let stamp_s = part("sec")? + 1e-9 * part("nanosec")?;
    (stamp_s != 0.0).then_some(stamp_s)
}
