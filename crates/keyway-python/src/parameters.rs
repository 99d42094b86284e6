//! Parameters from Python: dictionaries with the names and types of the TOML files.

use crate::errors::{bad_value, parameter_error, scene_file_error};
use keyway::files::{StackBase, find_robot};
use keyway::navigate::Stack;
use keyway::robot::{Footprint, Robot};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use toml::{Table, Value};

/// A dictionary, which may have dictionaries in it.
#[derive(Clone, Default)]
pub(crate) struct Parameters(pub(crate) Table);

impl<'py> FromPyObject<'_, 'py> for Parameters {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
        pyo3::type_hint_identifier!("collections.abc", "Mapping"),
        pyo3::type_hint_identifier!("builtins", "str"),
        pyo3::type_hint_identifier!("typing", "Any")
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let whole = object.cast::<PyDict>().map_err(|_| {
            let got = crate::values::described(&object);
            pyo3::exceptions::PyTypeError::new_err(format!(
                "expected a dictionary of parameters, got {got}"
            ))
        })?;
        pythonize::depythonize::<Table>(whole.as_any()).map(Self).map_err(|error| {
            bad_value(format!(
                "parameters are texts, numbers, lists and dictionaries of them: {error}"
            ))
        })
    }
}

impl Parameters {
    /// As `path=value`, a word for each.
    pub(crate) fn assignments(&self) -> Vec<String> {
        fn walk(table: &Table, path: &str, out: &mut Vec<String>) {
            for (key, value) in table {
                let here = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                match value {
                    Value::Table(inner) => walk(inner, &here, out),
                    value => out.push(format!("{here}={value}")),
                }
            }
        }
        let mut out = Vec::new();
        walk(&self.0, "", &mut out);
        out
    }

    /// Laid over a stack.
    pub(crate) fn over(&self, base: StackBase<'_>) -> PyResult<Stack> {
        base.with(&self.0).map_err(|error| parameter_error(&error))
    }
}

/// A robot by its name, or from a file; as a disc of another radius where one is given.
pub(crate) fn robot(name: &str, radius_m: Option<f64>) -> PyResult<Robot> {
    let robot = find_robot(name, Path::new("")).map_err(|error| scene_file_error(&error))?;
    let Some(radius_m) = radius_m else { return Ok(robot) };
    let footprint =
        Footprint::circle(radius_m).map_err(|error| bad_value(format!("radius: {error}")))?;
    Ok(Robot { footprint, ..robot })
}
