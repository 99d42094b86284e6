//! A planned path.

use crate::arrays::{Cells, Floats2, Json, Lazy, Records, json, of_points, of_rows, records};
use crate::errors::bad_value;
use crate::parameters::{RobotName, robot};
use crate::pictures;
use crate::ready::Ready;
use keyway::route::Route;
use keyway::smooth::{SmootherConfig, SpeedProfile, SpeedProfileConfig};
use keyway_draw::Svg;
use keyway_sim::metrics::PathMetrics;
use keyway_sim::report::CurveSample;
use pyo3::prelude::*;
use std::sync::Arc;

/// A planned and smoothed path.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
/// >>> keyway.plan(grid, (0.5, 0.5), (3.5, 6.5))
/// <keyway.Plan jps with none: 7.243 m, 3 points, 7 cells, 1 expanded>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Plan {
    ready: Arc<Ready>,
    route: Route,
    xy: Lazy<f64>,
    cells: Lazy<i32>,
}

impl Plan {
    pub(crate) fn new(ready: Arc<Ready>, route: Route) -> Self {
        Self { ready, route, xy: Lazy::new(), cells: Lazy::new() }
    }

    fn picture(&self) -> Svg {
        let is_smoothed = !matches!(self.ready.stack.smoother, SmootherConfig::None(_));
        let smoothed = is_smoothed.then_some(&self.route.smoothed);
        pictures::of_path(&self.ready.grid, self.route.line.polyline(), smoothed)
    }
}

#[pymethods]
impl Plan {
    /// The smoothed path as a line: a read-only array of float64 of shape (n, 2) [m]. A curve is
    /// approximated by chords.
    #[getter]
    fn xy(&self, py: Python<'_>) -> Floats2 {
        let points = || of_points(py, self.route.smoothed.points());
        Floats2(self.xy.get_or_init(py, points).clone_ref(py))
    }

    /// The planner's path before smoothing: a read-only array of int32 of shape (n, 2), column
    /// and row of each cell.
    #[getter]
    fn cells(&self, py: Python<'_>) -> Cells {
        let cells = &self.route.plan.cells;
        let rows = || of_rows(py, cells.iter().map(|cell| [cell.x, cell.y]), cells.len());
        Cells(self.cells.get_or_init(py, rows).clone_ref(py))
    }

    /// Indices of the cells that are jump points, ascending.
    #[getter]
    fn jump_points(&self) -> Vec<usize> {
        self.route.plan.jump_points.clone()
    }

    /// Cost of the planner's path [cells]. For grid planners it is an exact number of straight
    /// and diagonal steps.
    #[getter]
    fn cost(&self) -> f64 {
        self.route.plan.cost.cells()
    }

    /// Length of the smoothed path [m].
    #[getter]
    fn length(&self) -> f64 {
        self.route.smoothing.path.length_m()
    }

    /// Number of expanded nodes: nodes taken from the open list.
    #[getter]
    fn expanded(&self) -> u64 {
        self.route.plan.statistics.expanded()
    }

    /// Number of generated nodes: nodes inserted or improved in the open list.
    #[getter]
    fn generated(&self) -> u64 {
        self.route.plan.statistics.generated()
    }

    /// Name of the planner.
    #[getter]
    fn planner(&self) -> &'static str {
        self.ready.stack.planner.name()
    }

    /// Name of the smoother.
    #[getter]
    fn smoother(&self) -> &'static str {
        self.ready.stack.smoother.name()
    }

    /// Clearance that the path guarantees [m], if it is less than requested; otherwise `None`.
    #[getter]
    fn kept_clearance(&self) -> Option<f64> {
        self.route.smoothing.kept_clearance_m
    }

    /// Returns metrics of the smoothed path: `length_m`, `points`, `redundant_points`, `turns`,
    /// `turning_angle_deg`, `non_smooth_turns` and `min_clearance_m`. They are computed at every
    /// call.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
    /// >>> keyway.plan(grid, (0.5, 0.5), (3.5, 6.5)).metrics()["turns"]
    /// 1
    fn metrics(&self, py: Python<'_>) -> PyResult<Json> {
        let (path, map) = (&self.route.smoothing.path, &self.ready.map);
        let metrics = py.detach(|| PathMetrics::of_path(path, map.clearance()));
        json(py, &metrics)
    }

    /// Samples the smoothed path by arc length, with the fastest speeds within the limits of a
    /// robot (a name of `keyway.names`, a file, or a dictionary of its values).
    ///
    /// Returns a structured array of shape (n,) with the fields `s_m`, `x_m`, `y_m`,
    /// `heading_rad`, `curvature_per_m`, `t_s`, `v_mps` and `omega_radps`, all float64. At a
    /// corner the robot stops and turns on the spot.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((10, 10), dtype=bool), resolution=1.0)
    /// >>> curve = keyway.plan(grid, (0.5, 0.5), (4.5, 0.5)).curve(spacing=1.0)
    /// >>> curve["s_m"].tolist()
    /// [0.0, 1.0, 2.0, 3.0, 4.0]
    #[pyo3(signature = (spacing=0.05, robot=None))]
    fn curve(&self, py: Python<'_>, spacing: f64, robot: Option<RobotName>) -> PyResult<Records> {
        let robot = match robot {
            Some(RobotName(name)) => self::robot(&name, None)?,
            None => self.ready.robot.clone(),
        };
        let config = SpeedProfileConfig { spacing_m: spacing, ..SpeedProfileConfig::default() };
        let path = &self.route.smoothing.path;
        config.check_spacing(path).map_err(bad_value)?;
        let profile = py.detach(|| SpeedProfile::of_path(path, &robot.limits, &config));
        let profile = profile.map_err(bad_value)?;
        let row = |&sample| {
            let CurveSample { sample, omega_radps } = CurveSample::from(sample);
            let at = sample.at;
            let place = [at.s_m, at.x_m, at.y_m, at.heading_rad, at.curvature_per_m];
            let [s_m, x_m, y_m, heading_rad, curvature_per_m] = place;
            [s_m, x_m, y_m, heading_rad, curvature_per_m, sample.t_s, sample.v_mps, omega_radps]
        };
        let names =
            ["s_m", "x_m", "y_m", "heading_rad", "curvature_per_m", "t_s", "v_mps", "omega_radps"];
        records(py, names, profile.samples.iter().map(row), profile.samples.len())
    }

    fn __len__(&self) -> usize {
        self.route.smoothed.points().len()
    }

    fn __repr__(&self) -> String {
        let (points, cells) = (self.route.smoothed.points().len(), self.route.plan.cells.len());
        format!(
            "<keyway.Plan {} with {}: {:.3} m, {points} points, {cells} cells, {} expanded>",
            self.planner(),
            self.smoother(),
            self.length(),
            self.expanded()
        )
    }

    fn _repr_svg_(&self) -> String {
        self.picture().as_str().to_owned()
    }

    fn _repr_png_(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        py.detach(|| pictures::png(&self.picture()))
    }
}
