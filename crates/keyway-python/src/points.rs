//! Points of sensors other than lidars.

use crate::errors::bad_value;
use crate::values::{Numbers, Positions, described};
use keyway::geometry::{Point, Pose};
use keyway::sense::{FieldOfView, SensorPoints};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use pyo3::types::{PyList, PyTuple};

/// Hits of a depth camera, a sonar or a bumper, as points on the ground.
///
/// `positions` is an array of shape (n, 2), in the frame of the sensor [m]; non-finite points are
/// ignored. `mount` is the pose of the sensor on the robot (x, y, theta) [m, m, rad]. Robots with
/// several such sensors number them by `sensor`, from 0 to 7. `stamp` is the time of the
/// measurement [s]; by default it is that of the pose given with it.
///
/// The points mark obstacles, which stay until the same sensor clears them. A sensor clears if it
/// has `bearings`, those of its right and left edge [rad] (0 straight ahead, positive to the
/// left), and `ranges`, its minimum and maximum range [m]. Within these it detects every static
/// obstacle that is not occluded.
///
/// >>> import keyway
/// >>> keyway.Points([(1.0, 0.2), (1.0, 0.3)], bearings=(-0.7, 0.7), ranges=(0.3, 3.0))
/// <keyway.Points 2 of sensor 0, which sees from 0.3 to 3 m>
/// >>> keyway.Points([(0.2, 0.0)], sensor=1)
/// <keyway.Points 1 of sensor 1, which only marks>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Points {
    positions: Vec<Point>,
    mount: Pose,
    sensor: usize,
    stamp_s: Option<f64>,
    clears: Option<FieldOfView>,
}

#[pymethods]
impl Points {
    #[new]
    #[pyo3(signature = (positions, mount=None, sensor=0, stamp=None, bearings=None, ranges=None))]
    fn new(
        positions: Positions,
        mount: Option<Numbers>,
        sensor: usize,
        stamp: Option<f64>,
        bearings: Option<(f64, f64)>,
        ranges: Option<(f64, f64)>,
    ) -> PyResult<Self> {
        if sensor >= SensorPoints::MOST_SENSORS {
            let most = SensorPoints::MOST_SENSORS - 1;
            return Err(bad_value(format!(
                "sensor: expected a number from 0 to {most}, got {sensor}"
            )));
        }
        let mount = mount.map(|mount| mount.exactly("mount", "(x, y, theta)")).transpose()?;
        let [x, y, theta] = mount.unwrap_or_default();
        if !(x.is_finite() && y.is_finite() && theta.is_finite()) {
            return Err(bad_value("mount: expected three finite numbers"));
        }
        let clears = match (bearings, ranges) {
            (None, None) => None,
            (Some((from_rad, to_rad)), Some((range_min_m, range_max_m))) => {
                Some(FieldOfView { from_rad, to_rad, range_min_m, range_max_m })
            }
            _ => return Err(bad_value("bearings and ranges: expected both or neither")),
        };
        if clears.is_some_and(|view| !view.is_usable()) {
            return Err(bad_value(
                "bearings and ranges: expected the bearings of the right and the left edge, at most one turn apart, and the \
                 smallest and the largest range, all finite",
            ));
        }
        let positions = positions.0.iter().map(|&[x, y]| Point::new(x, y)).collect();
        let mount = Pose::new(x, y, theta);
        Ok(Self { positions, mount, sensor, stamp_s: stamp, clears })
    }

    fn __len__(&self) -> usize {
        self.positions.len()
    }

    fn __repr__(&self) -> String {
        let (count, sensor) = (self.positions.len(), self.sensor);
        let sees = match self.clears {
            Some(view) => format!("sees from {} to {} m", view.range_min_m, view.range_max_m),
            None => "only marks".to_owned(),
        };
        format!("<keyway.Points {count} of sensor {sensor}, which {sees}>")
    }
}

impl Points {
    /// The same points, with the time \[s\] as stamp if they have none.
    pub(crate) fn at(&self, stamp_s: f64) -> SensorPoints<'_> {
        let Self { positions: points, mount, sensor, clears, .. } = self;
        let stamp_s = self.stamp_s.unwrap_or(stamp_s);
        SensorPoints { stamp_s, sensor: *sensor, mount: *mount, points, clears: *clears }
    }
}

/// The points of a cycle: those of one sensor, or a list of those of several.
pub(crate) struct AllPoints(pub(crate) Vec<Py<Points>>);

impl<'py> FromPyObject<'_, 'py> for AllPoints {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = type_hint_union!(
        <Points as pyo3::PyTypeInfo>::TYPE_HINT,
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("collections.abc", "Sequence"),
            <Points as pyo3::PyTypeInfo>::TYPE_HINT
        )
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let is_list = object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>();
        if is_list {
            return object.extract().map(Self);
        }
        match object.cast::<Points>() {
            Ok(points) => Ok(Self(vec![points.to_owned().unbind()])),
            Err(_) => Err(PyTypeError::new_err(format!(
                "expected keyway.Points, or a list of them, got {}",
                described(&object)
            ))),
        }
    }
}
