//! Maps as arguments.

use crate::map::Map;
use crate::values::{described, is_path};
use numpy::PyUntypedArray;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use std::ops::Deref;

/// A map, or the path of its file, which is read here.
pub(crate) struct GivenMap(Py<Map>);

impl<'py> FromPyObject<'_, 'py> for GivenMap {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr =
        type_hint_union!(<Map as pyo3::PyTypeInfo>::TYPE_HINT, std::path::PathBuf::INPUT_TYPE);

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(map) = object.cast::<Map>() {
            return Ok(Self(map.to_owned().unbind()));
        }
        if is_path(&object) {
            let map = Map::read(object.py(), object.extract()?, None, None, None)?;
            return Ok(Self(Py::new(object.py(), map)?));
        }
        let hint = if object.is_instance_of::<PyUntypedArray>() {
            ": Map.from_array makes a map of an array"
        } else {
            ""
        };
        let got = described(&object);
        let text = format!("expected a keyway.Map, or the path of a map file, got {got}{hint}");
        Err(PyTypeError::new_err(text))
    }
}

impl Deref for GivenMap {
    type Target = Map;

    fn deref(&self) -> &Map {
        self.0.get()
    }
}
