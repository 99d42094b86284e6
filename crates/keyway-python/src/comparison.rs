//! Comparison of planners and smoothers.

use crate::arrays::{Json, JsonRows, json};
use crate::errors::{bad_value, why_without_path};
use crate::given_map::GivenMap;
use crate::parameters::{Parameters, RobotName};
use crate::values::Listed;
use crate::watched::{Progress, Watch, watched};
use keyway::files::{Assignment, ParameterLayers, StartingValues};
use keyway::map::OccupancyGrid;
use keyway::plan::PlanError;
use keyway_lab::compare::{CompareError, CompareRequest, Comparison as Checked, QueryChoice};
use pyo3::prelude::*;
use serde_json::Value;

/// Result of a comparison: a row for each combination of planner and smoother.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.eye(30, dtype=bool)[::-1] & (np.arange(30) % 3 > 0), resolution=0.1)
/// >>> comparison = keyway.compare(grid, planners=["jps", "theta-star"], smoothers=["none"], times=False)
/// >>> comparison
/// <keyway.Comparison 2 rows>
/// >>> [row["planner"] for row in comparison.rows]
/// ['jps', 'theta-star']
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Comparison {
    report: Value,
    latex: String,
    /// Column names of the table, and its cells row by row.
    header: Vec<&'static str>,
    cells: Vec<Vec<String>>,
}

#[pymethods]
impl Comparison {
    /// The rows as dictionaries. Their keys are the columns of `table.csv`.
    #[getter]
    fn rows(&self, py: Python<'_>) -> PyResult<JsonRows> {
        Ok(JsonRows(pythonize::pythonize(py, &self.report["rows"])?.unbind()))
    }

    /// The whole report: `keyway.compare/1` of `docs/reference/json.md`. It also has every query,
    /// and the tests of each row against the first.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Json> {
        json(py, &self.report)
    }

    /// The table as LaTeX, for use in a paper.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    /// >>> "tabular" in keyway.compare(grid, planners=["jps"], times=False).to_latex()
    /// True
    fn to_latex(&self) -> &str {
        &self.latex
    }

    /// The rows as a `pandas.DataFrame`; requires pandas.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.call_method1("DataFrame", (self.rows(py)?,))
    }

    fn __len__(&self) -> usize {
        self.report["rows"].as_array().map_or(0, Vec::len)
    }

    fn __repr__(&self) -> String {
        format!("<keyway.Comparison {} rows>", self.__len__())
    }

    fn _repr_html_(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = &str>, tag: &str| {
            let cell = |cell| format!("<{tag}>{}</{tag}>", html_text(cell));
            format!("<tr>{}</tr>\n", cells.map(cell).collect::<Vec<_>>().concat())
        };
        let header = line(&mut self.header.iter().copied(), "th");
        let row = |row: &Vec<String>| line(&mut row.iter().map(String::as_str), "td");
        let rows: String = self.cells.iter().map(row).collect();
        format!("<table>\n<thead>\n{header}</thead>\n<tbody>\n{rows}</tbody>\n</table>\n")
    }
}

/// Compares the paths of planners and smoothers on a map, with each other and with the shortest
/// line, as `keyway compare` does.
///
/// `planners` and `smoothers` are lists of names, or `["all"]`. `queries` random queries are
/// drawn from `seed`. `radius` is the clearance of paths to every obstacle [m]; `robot` is a
/// robot whose radius is used as clearance. `parameters` are those of the TOML files, as a
/// dictionary; those of one planner or smoother are set by its name:
/// `{"hsta": {"if_no_path": "fail"}}`. With `as_published`, planners and smoothers use the
/// parameters of their papers, for maps with cells of 1 m, whatever the robot. Without `times`,
/// the report is deterministic. `progress(done, expected)` is called meanwhile.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
/// >>> keyway.compare(grid, planners=["jps", "jsp"])
/// Traceback (most recent call last):
/// ValueError: planners: `planner.name` must be one of ...
#[pyfunction]
#[pyo3(signature = (grid, planners=None, smoothers=None, queries=10, seed=0, repeat=1, radius=None, robot=None, parameters=None, as_published=false, columns=None, times=true, progress=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn compare(
    py: Python<'_>,
    grid: GivenMap,
    planners: Option<Listed<String>>,
    smoothers: Option<Listed<String>>,
    queries: u64,
    seed: u64,
    repeat: u64,
    radius: Option<f64>,
    robot: Option<RobotName>,
    parameters: Option<Parameters>,
    as_published: bool,
    columns: Option<Listed<String>>,
    times: bool,
    progress: Option<Progress>,
) -> PyResult<Comparison> {
    let parameters = ParameterLayers {
        assignments: Assignment::all_of(&parameters.unwrap_or_default().0),
        ..ParameterLayers::default()
    };
    let count = usize::try_from(queries).unwrap_or(usize::MAX);
    let request = CompareRequest {
        planners: names("planners", planners)?,
        smoothers: names("smoothers", smoothers)?,
        columns: names("columns", columns)?,
        queries: QueryChoice::Random { count, seed },
        repeat,
        radius_m: radius,
        robot: robot.map(|RobotName(name)| name),
        parameters,
        values: StartingValues::published_if(as_published),
        has_times: times,
        why: why_without_path,
        ..CompareRequest::new(vec!["map".into()])
    };
    let grid = OccupancyGrid::clone(&grid.grid);
    watched(py, progress.as_ref(), move |watch| compared(grid, request, watch))?
}

/// Names of a list; without a list, the default names.
fn names(argument: &str, list: Option<Listed<String>>) -> PyResult<Vec<String>> {
    match list.map(|list| list.named(argument)).transpose()? {
        Some(names) if names.is_empty() => {
            Err(bad_value(format!("{argument}: expected at least one name")))
        }
        names => Ok(names.unwrap_or_default()),
    }
}

fn compared(grid: OccupancyGrid, request: CompareRequest, watch: &Watch) -> PyResult<Comparison> {
    let checked: Checked = request.check().map_err(bad_value)?;
    let map = checked.queried(0, grid).map_err(bad_value)?;
    let map = checked.on(map, watch).map_err(|error| match error {
        CompareError::Planner { error: error @ PlanError::NeedsUniformCost { .. }, .. } => {
            bad_value(format!("{error}; planners=[\"all\"] omits such planners"))
        }
        error => bad_value(error),
    })?;
    let report = checked.report(&[map], None);
    let latex = checked.columns().latex(&report.rows);
    let (header, cells, _) = checked.columns().table(&report.rows);
    let report = serde_json::to_value(&report).map_err(bad_value)?;
    Ok(Comparison { report, latex, header, cells })
}

/// Escapes a text for HTML.
fn html_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
