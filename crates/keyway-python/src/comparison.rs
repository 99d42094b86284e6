//! Comparing planners and smoothers.

use crate::arrays::{Json, JsonRows, json};
use crate::errors::bad_value;
use crate::map::Map;
use crate::parameters::Parameters;
use crate::values::Listed;
use crate::watched::{Progress, watched};
use keyway::map::OccupancyGrid;
use keyway_cli::CliError;
use pyo3::prelude::*;
use std::ffi::OsString;

/// What a comparison gave: a row for each planner with each smoother.
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
    inner: keyway_cli::Comparison,
}

#[pymethods]
impl Comparison {
    /// The rows as dictionaries, with the names of the columns of `table.csv` in `docs/JSON.md`.
    #[getter]
    fn rows(&self, py: Python<'_>) -> PyResult<JsonRows> {
        Ok(JsonRows(pythonize::pythonize(py, &self.inner.report["rows"])?.unbind()))
    }

    /// The whole report, `keyway.compare/1` of `docs/JSON.md`: also every query, and the tests of each row against the first.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Json> {
        json(py, &self.inner.report)
    }

    /// The table as LaTeX, as a paper would print it.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((20, 20), dtype=bool), resolution=1.0)
    /// >>> "tabular" in keyway.compare(grid, planners=["jps"], times=False).to_latex()
    /// True
    fn to_latex(&self) -> &str {
        &self.inner.latex
    }

    /// The rows as a `pandas.DataFrame`; pandas has to be installed.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.call_method1("DataFrame", (self.rows(py)?,))
    }

    fn __len__(&self) -> usize {
        self.inner.report["rows"].as_array().map_or(0, Vec::len)
    }

    fn __repr__(&self) -> String {
        format!("<keyway.Comparison {} rows>", self.__len__())
    }

    fn _repr_html_(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = &str>, tag: &str| {
            let cell = |cell| format!("<{tag}>{}</{tag}>", html_text(cell));
            format!("<tr>{}</tr>\n", cells.map(cell).collect::<Vec<_>>().concat())
        };
        let header = line(&mut self.inner.header.iter().copied(), "th");
        let row = |row: &Vec<String>| line(&mut row.iter().map(String::as_str), "td");
        let rows: String = self.inner.cells.iter().map(row).collect();
        format!("<table>\n<thead>\n{header}</thead>\n<tbody>\n{rows}</tbody>\n</table>\n")
    }
}

/// Compares the paths of planners and smoothers on a map, with each other and with the shortest line, as `keyway compare`
/// does.
///
/// `planners` and `smoothers` are lists of names, or `["all"]`. `queries` random queries are made from `seed`. `radius` is what
/// paths keep from every obstacle [m], `robot` a robot whose radius they keep. `parameters` are those of the TOML files as a
/// dictionary; by their names, of one planner or smoother only: `{"hsta": {"if_no_path": "fail"}}`.
/// With `as_published` they begin with the values of their papers, for maps with cells of 1 m,
/// whatever the robot. Without `times`, the same arguments give the same report.
/// `progress(done, expected)` is called meanwhile.
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
    grid: &Map,
    planners: Option<Listed<String>>,
    smoothers: Option<Listed<String>>,
    queries: u64,
    seed: u64,
    repeat: u64,
    radius: Option<f64>,
    robot: Option<String>,
    parameters: Option<Parameters>,
    as_published: bool,
    columns: Option<Listed<String>>,
    times: bool,
    progress: Option<Progress>,
) -> PyResult<Comparison> {
    let mut words = Words::default();
    words.list("--planners", planners);
    words.list("--smoothers", smoothers);
    words.list("--columns", columns);
    words.option("--queries", Some(queries));
    words.option("--seed", Some(seed));
    words.option("--repeat", Some(repeat));
    words.option("--radius", radius);
    words.option("--robot", robot);
    for assignment in parameters.unwrap_or_default().assignments() {
        words.option("--set", Some(assignment));
    }
    words.flag("--as-published", as_published);
    words.flag("--no-times", !times);
    let grid = OccupancyGrid::clone(&grid.grid);
    let compare = move |watch: &crate::watched::Watch| keyway_cli::compare(grid, &words.0, watch);
    let inner = watched(py, progress.as_ref(), compare)?.map_err(|error| refused(&error))?;
    Ok(Comparison { inner })
}

/// A text in which no character means anything to HTML.
fn html_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The words of a command line that say the same.
#[derive(Default)]
pub(crate) struct Words(pub(crate) Vec<OsString>);

impl Words {
    pub(crate) fn list(&mut self, option: &str, values: Option<Listed<String>>) {
        self.option(option, values.map(|Listed(values)| values.join(",")));
    }

    pub(crate) fn option(&mut self, option: &str, value: Option<impl ToString>) {
        if let Some(value) = value {
            self.0.push(format!("{option}={}", value.to_string()).into());
        }
    }

    pub(crate) fn flag(&mut self, flag: &str, is_set: bool) {
        if is_set {
            self.0.push(flag.into());
        }
    }
}

/// Why a command was refused. Its options are named as arguments of Python: `planners`, not `--planners`. Names of files keep
/// their dashes.
pub(crate) fn refused(error: &CliError) -> PyErr {
    let text = error.to_string();
    let mut words = text.split("--");
    let mut message = words.next().unwrap_or_default().to_owned();
    for word in words {
        let end = word.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(word.len());
        let (option, rest) = word.split_at(end);
        if message.ends_with(|before: char| !" `'(".contains(before)) {
            message.extend(["--", option]);
        } else {
            message += &option.replace('-', "_");
        }
        message += rest;
    }
    bad_value(message)
}
