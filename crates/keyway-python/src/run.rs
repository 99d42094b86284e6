//! Simulated runs.

use crate::arrays::{Floats2, Json, Records, json, of_points, records};
use crate::errors::{bad_value, scene_navigate_error};
use crate::map::Map;
use crate::pictures;
use crate::scene::{Scene, SceneOrFile};
use crate::watched::{Cycles, Progress, watched};
use keyway::geometry::{Disc, Polyline};
use keyway::map::OccupancyGrid;
use keyway_draw::Svg;
use keyway_sim::episode::{RobotReport, RunError, RunOptions, watch_episode};
use keyway_sim::parallel::processors;
use keyway_sim::report::{Inputs, MapSource};
use keyway_sim::sim::MovingObstacle;
use pyo3::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// A simulated run, and its measurements.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
/// >>> run = keyway.simulate(keyway.Scene(grid, (1, 2), (4, 2)))
/// >>> run
/// <keyway.Run reached: 2.980 m in 7.1 s>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Run {
    grid: Arc<OccupancyGrid>,
    report: RobotReport,
}

impl Run {
    fn picture(&self) -> Svg {
        pictures::of_run(&self.grid, &self.report)
    }
}

#[pymethods]
impl Run {
    /// Outcome of the run: `reached`, `collided`, `timeout`, `stuck` or `no_path`.
    #[getter]
    fn outcome(&self) -> &'static str {
        self.report.outcome.name()
    }

    /// Message with the reason for not reaching the goal; otherwise `None`.
    #[getter]
    fn reason(&self) -> Option<&str> {
        self.report.reason.as_deref()
    }

    /// The start, the end of every cycle, and the contact if there was one: a structured array of
    /// shape (n,) with the fields `t_s`, `x_m`, `y_m`, `yaw_rad`, `v_mps` and `omega_radps`, all
    /// float64. It is empty if there was no route.
    #[getter]
    fn trajectory(&self, py: Python<'_>) -> PyResult<Records> {
        let rows = self.report.trajectory.as_deref().unwrap_or_default();
        let names = ["t_s", "x_m", "y_m", "yaw_rad", "v_mps", "omega_radps"];
        records(py, names, rows.iter().copied(), rows.len())
    }

    /// The first route after smoothing: a read-only array of float64 of shape (n, 2) [m]. A curve
    /// is approximated by chords. It is empty if there was no route.
    #[getter]
    fn route(&self, py: Python<'_>) -> Floats2 {
        let smoothed = self.report.smoothed.as_ref().map(|smoothed| &smoothed.waypoints_m);
        Floats2(of_points(py, smoothed.map_or(&[], Polyline::points)))
    }

    /// Start of the robot (x, y) [m], or with a given heading (x, y, yaw) [m, m, rad]. In `report`
    /// headings are in degrees.
    #[getter]
    fn start(&self) -> Vec<f64> {
        in_radians(&self.report.inputs.start)
    }

    /// Goal of the robot (x, y) [m], or with a given heading (x, y, yaw) [m, m, rad].
    #[getter]
    fn goal(&self) -> Vec<f64> {
        in_radians(&self.report.inputs.goal)
    }

    /// The map that was known to the robot.
    #[getter]
    fn map(&self) -> Map {
        let Inputs { map, map_digest, placement, .. } = &self.report.inputs;
        let source =
            MapSource { name: map.clone(), digest: map_digest.clone(), placement: *placement };
        Map::shared(Arc::clone(&self.grid), source)
    }

    /// The moving obstacles during the run: for each, a structured array with the fields `t_s`,
    /// `x_m`, `y_m` and `radius_m`, all float64, at the times of `trajectory`. Where an obstacle
    /// jumps, a row has a position of NaN.
    #[getter]
    fn moving(&self, py: Python<'_>) -> PyResult<Vec<Records>> {
        let given = &self.report.inputs.moving;
        let run = self.report.run.as_ref();
        let moving = run.map_or_else(|| given.clone(), |run| run.movers(given));
        let times: Vec<f64> = self.report.trajectory.iter().flatten().map(|row| row[0]).collect();
        moving.iter().map(|obstacle| moved(py, obstacle, &times)).collect()
    }

    /// Metrics of the run, with the names of `run` in `docs/reference/json.md`: `time_s`,
    /// `length_m`, `min_clearance_m` and more. It is empty if there was no route.
    #[getter]
    fn metrics(&self, py: Python<'_>) -> PyResult<Json> {
        match &self.report.run {
            Some(run) => json(py, run),
            None => Ok(Json(pyo3::types::PyDict::new(py).unbind())),
        }
    }

    /// The whole report, `keyway.navigate/4` of `docs/reference/json.md`.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Json> {
        json(py, &self.report)
    }

    fn __repr__(&self) -> String {
        let measured = self.report.run.as_ref();
        let measured =
            measured.map(|run| format!(": {:.3} m in {:.1} s", run.length_m, run.time_s));
        format!("<keyway.Run {}{}>", self.outcome(), measured.unwrap_or_default())
    }

    fn _repr_svg_(&self) -> String {
        self.picture().as_str().to_owned()
    }

    fn _repr_png_(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        py.detach(|| pictures::png(&self.picture()))
    }
}

/// Converts a place with a heading in degrees.
fn in_radians(place: &[f64]) -> Vec<f64> {
    let mut place = place.to_vec();
    if let Some(heading) = place.get_mut(2) {
        *heading = heading.to_radians();
    }
    place
}

/// Positions of a moving obstacle at some times, separated where it jumps.
fn moved(py: Python<'_>, obstacle: &MovingObstacle, times: &[f64]) -> PyResult<Records> {
    let (mut rows, mut last_s) = (Vec::with_capacity(times.len()), f64::INFINITY);
    for &t_s in times {
        let jump_s = obstacle.motion().next_jump_s(last_s.min(t_s));
        if jump_s.is_some_and(|jump_s| jump_s <= t_s) {
            rows.push([t_s, f64::NAN, f64::NAN, obstacle.radius_m()]);
        }
        let Disc { centre, radius_m } = obstacle.at(t_s);
        rows.push([t_s, centre.x, centre.y, radius_m]);
        last_s = t_s;
    }
    let count = rows.len();
    records(py, ["t_s", "x_m", "y_m", "radius_m"], rows.into_iter(), count)
}

pub(crate) fn run_error(error: &RunError) -> PyErr {
    match error {
        RunError::Navigate(error) => scene_navigate_error(error),
        error => bad_value(error),
    }
}

/// Simulates the run of a scene. The same scene gives the same run, to the last digit. A scene may
/// be the path of its file.
///
/// A start without a route, a collision and a timeout are outcomes, not exceptions.
/// `progress(cycles, None)` is called meanwhile. With `times`, the times of decisions are
/// measured; two reports then differ in them.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 80), dtype=bool), resolution=0.1)
/// >>> scene = keyway.Scene(grid, (1, 2), (7, 2), unknown=[{"position": [4, 2.1], "radius_m": 0.3}])
/// >>> run = keyway.simulate(scene)
/// >>> run.outcome, run.metrics["min_clearance_m"] > 0
/// ('reached', True)
#[pyfunction]
#[pyo3(signature = (scene, progress=None, times=false))]
pub(crate) fn simulate(
    py: Python<'_>,
    scene: SceneOrFile,
    progress: Option<Progress>,
    times: bool,
) -> PyResult<Run> {
    let scene = Scene::clone(&scene);
    watched(py, progress.as_ref(), move |watch| {
        let episode = scene.episode_of_one()?;
        let begin = Instant::now();
        let clock = || begin.elapsed().as_secs_f64();
        let clock: Option<&(dyn Fn() -> f64 + Sync)> = if times { Some(&clock) } else { None };
        let options = RunOptions { clock, ..RunOptions::default() };
        let report = watch_episode(&episode, options, &mut [Cycles(watch)]);
        let report = report.map_err(|error| run_error(&error.why))?.first();
        Ok(Run { grid: Arc::new(episode.known), report })
    })?
}

/// Simulates the runs of all robots of a scene, which drive in one world at the same time.
/// Returns one run per robot, in their order.
///
/// >>> import keyway, numpy as np
/// >>> text = '''
/// ... version = 2
/// ... map = "empty.map"
/// ... [[robots]]
/// ... start = [1.0, 1.0]
/// ... goal = [7.0, 1.0]
/// ... [[robots]]
/// ... start = [7.0, 4.0]
/// ... goal = [1.0, 4.0]
/// ... '''
/// >>> import tempfile
/// >>> folder = tempfile.mkdtemp()
/// >>> keyway.Map.from_array(np.zeros((5, 8), dtype=bool), resolution=1.0).write(folder + "/empty.map")
/// >>> [run.outcome for run in keyway.simulate_team(keyway.Scene.from_toml(text, folder))]
/// ['reached', 'reached']
#[pyfunction]
#[pyo3(signature = (scene, progress=None))]
pub(crate) fn simulate_team(
    py: Python<'_>,
    scene: SceneOrFile,
    progress: Option<Progress>,
) -> PyResult<Vec<Run>> {
    let scene = Scene::clone(&scene);
    watched(py, progress.as_ref(), move |watch| {
        let episode = scene.episode()?;
        let mut cycles: Vec<Cycles<'_>> = episode.robots.iter().map(|_| Cycles(watch)).collect();
        let options = RunOptions { threads: processors(), ..RunOptions::default() };
        let report = watch_episode(&episode, options, &mut cycles).map_err(|error| {
            if error.robot.is_none() { run_error(&error.why) } else { bad_value(&error) }
        })?;
        let grid = Arc::new(episode.known);
        Ok(report
            .robots
            .into_iter()
            .map(|report| Run { grid: Arc::clone(&grid), report })
            .collect())
    })?
}
