//! Parameters from Python: dictionaries with the names and types of the TOML files.

use crate::errors::{bad_value, config_file_error, parameter_error};
use crate::values::described;
use keyway::files::{StackBase, find_robot};
use keyway::navigate::Stack;
use keyway::robot::{Footprint, Robot};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use std::path::Path;
use toml::{Table, Value};

/// A dictionary, which may be nested.
#[derive(Clone, Default)]
pub(crate) struct Parameters(pub(crate) Table);

impl<'py> FromPyObject<'_, 'py> for Parameters {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
        pyo3::type_hint_identifier!("builtins", "dict"),
        pyo3::type_hint_identifier!("builtins", "str"),
        pyo3::type_hint_identifier!("typing", "Any")
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let whole = object.cast::<PyDict>().map_err(|_| {
            let got = described(&object);
            PyTypeError::new_err(format!("expected a dictionary of parameters, got {got}"))
        })?;
        table(&whole, 0).map(Self)
    }
}

/// Maximum nesting depth of tables and lists. A dictionary may contain itself.
const MOST_NESTED: usize = 100;

fn table(dict: &Bound<'_, PyDict>, depth: usize) -> PyResult<Table> {
    let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key = key.extract::<String>().map_err(|_| {
            bad_value(format!("names of parameters are strings, got {}", described(&key)))
        })?;
        let value = value_of(&value, depth + 1, &key)?;
        Ok((key, value))
    };
    // The copy guards against changes of the dictionary during the conversion.
    dict.copy()?.iter().map(entry).collect()
}

/// Converts a value to TOML; numpy numbers and arrays become plain ones.
fn value_of(object: &Bound<'_, PyAny>, depth: usize, name: &str) -> PyResult<Value> {
    if depth > MOST_NESTED {
        return Err(bad_value("lists and dictionaries of parameters are nested too deeply"));
    }
    if let Ok(dict) = object.cast::<PyDict>() {
        return table(dict, depth).map(Value::Table);
    }
    let is_list = object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>();
    if is_list {
        let items = object.try_iter()?.map(|item| value_of(&item?, depth + 1, name));
        return items.collect::<PyResult<_>>().map(Value::Array);
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    if object.is_instance_of::<PyBool>() {
        return object.extract().map(Value::Boolean);
    }
    if object.is_instance_of::<PyInt>() {
        let too_large =
            |_| bad_value(format!("`{name}`: expected a number of at most 64 bits, got {object}"));
        return object.extract().map(Value::Integer).map_err(too_large);
    }
    if object.is_instance_of::<PyFloat>() {
        return object.extract().map(Value::Float);
    }
    let numpy = object.py().import("numpy")?;
    if object.is_instance(&numpy.getattr("generic")?)?
        || object.is_instance(&numpy.getattr("ndarray")?)?
    {
        let plain = object.call_method0("tolist")?;
        // Numpy values without a Python equivalent are unchanged by the conversion.
        if !plain.is(object) && !plain.get_type().is(object.get_type()) {
            return value_of(&plain, depth + 1, name);
        }
    }
    Err(bad_value(format!(
        "`{name}`: expected a string, a number, a boolean, a list or a dictionary, got {}",
        described(object)
    )))
}

impl Parameters {
    /// Lays the parameters over a stack.
    pub(crate) fn over(&self, base: StackBase<'_>) -> PyResult<Stack> {
        base.with(&self.0).map_err(|error| parameter_error(&error))
    }
}

/// A robot: its name, its file, or a dictionary with the fields of a robot file. It is stored as
/// the text that `find_robot` accepts.
pub(crate) struct RobotName(pub(crate) String);

impl<'py> FromPyObject<'_, 'py> for RobotName {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = type_hint_union!(
        pyo3::type_hint_identifier!("builtins", "str"),
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("os", "PathLike"),
            pyo3::type_hint_identifier!("builtins", "str")
        ),
        Parameters::INPUT_TYPE
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if object.is_instance_of::<PyDict>() {
            let Parameters(table) = object.extract()?;
            return Ok(Self(Value::Table(table).to_string()));
        }
        if let Ok(name) = object.cast::<PyString>() {
            return Ok(Self(name.to_str()?.to_owned()));
        }
        let expected = |_: PyErr| {
            let got = described(&object);
            PyTypeError::new_err(format!(
                "expected the name of a robot, its file, or a dictionary of its values, got {got}"
            ))
        };
        let path: std::path::PathBuf = object.extract().map_err(expected)?;
        Ok(Self(path.to_string_lossy().into_owned()))
    }
}

/// Finds a robot by its name, or reads it from a file. With `radius_m`, its footprint is a disc
/// of that radius.
pub(crate) fn robot(name: &str, radius_m: Option<f64>) -> PyResult<Robot> {
    let robot = find_robot(name, Path::new("")).map_err(|error| config_file_error(&error))?;
    let Some(radius_m) = radius_m else { return Ok(robot) };
    let footprint =
        Footprint::circle(radius_m).map_err(|error| bad_value(format!("radius: {error}")))?;
    Ok(Robot { footprint, ..robot })
}
