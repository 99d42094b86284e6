//! Output arrays. Their memory is moved to numpy without a copy.

use keyway::geometry::Point;
use numpy::ndarray::Array2;
use numpy::{PyArray1, PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};
use std::convert::Infallible;

/// Defines a type of arrays that also has a type in the stubs.
macro_rules! array_type {
    ($(#[$doc:meta])* $name:ident, $array:ty, $item:literal) => {
        $(#[$doc])*
        pub(crate) struct $name(pub(crate) Py<$array>);

        impl<'py> IntoPyObject<'py> for $name {
            type Target = $array;
            type Output = Bound<'py, $array>;
            type Error = Infallible;

            #[cfg(feature = "stubs")]
            const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
                pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
                pyo3::type_hint_identifier!("numpy", $item)
            );

            fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
                Ok(self.0.into_bound(py))
            }
        }
    };
}

array_type!(
    /// A 2-D array of numbers.
    Floats2, PyArray2<f64>, "float64"
);
array_type!(
    /// A 1-D array of numbers.
    Floats1, PyArray1<f64>, "float64"
);
array_type!(
    /// An array of cells, one per row.
    Cells, PyArray2<i32>, "int32"
);
array_type!(
    /// A mask of cells.
    Mask, PyArray2<bool>, "bool_"
);
array_type!(
    /// Occupancy of cells, as in `nav_msgs`.
    Occupancy, PyArray2<i8>, "int8"
);

/// A structured array, with named columns.
pub(crate) struct Records(pub(crate) Py<PyAny>);

impl<'py> IntoPyObject<'py> for Records {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;

    #[cfg(feature = "stubs")]
    const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
        pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
        pyo3::type_hint_identifier!("numpy", "void")
    );

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0.into_bound(py))
    }
}

/// Points as (n, 2).
pub(crate) fn of_points(py: Python<'_>, points: &[Point]) -> Py<PyArray2<f64>> {
    of_rows(py, points.iter().map(|point| [point.x, point.y]), points.len())
}

/// Rows of equal length as (n, N). The array is read-only, as a result must not change.
pub(crate) fn of_rows<const N: usize, T: numpy::Element>(
    py: Python<'_>,
    rows: impl Iterator<Item = [T; N]>,
    count: usize,
) -> Py<PyArray2<T>> {
    let mut numbers = Vec::with_capacity(count * N);
    rows.for_each(|row| numbers.extend(row));
    let shape = (numbers.len() / N, N);
    let array =
        Array2::from_shape_vec(shape, numbers).unwrap_or_else(|_| unreachable!("whole rows"));
    read_only(PyArray2::from_owned_array(py, array))
}

/// Makes an array read-only: a write into it would change the result.
fn read_only<T: numpy::Element>(array: Bound<'_, PyArray2<T>>) -> Py<PyArray2<T>> {
    match array.try_readwrite() {
        Ok(writable) => (*writable.make_nonwriteable()).clone().unbind(),
        Err(_) => array.unbind(),
    }
}

/// A view of the same memory with named columns: a structured array of (n,).
pub(crate) fn records<const N: usize>(
    py: Python<'_>,
    names: [&str; N],
    rows: impl Iterator<Item = [f64; N]>,
    count: usize,
) -> PyResult<Records> {
    let array = of_rows(py, rows, count).into_bound(py);
    let fields = PyList::new(py, names.map(|name| (name, "<f8")))?;
    let dtype = py.import("numpy")?.getattr("dtype")?.call1((fields,))?;
    let view = array.call_method1("view", (dtype,))?;
    Ok(Records(view.call_method1("reshape", (-1,))?.unbind()))
}

/// A 1-D array, copied, as the numbers change with the next cycle.
pub(crate) fn copied(py: Python<'_>, numbers: &[f64]) -> Floats1 {
    Floats1(numbers.to_pyarray(py).unbind())
}

/// An array that is created on first access.
pub(crate) type Lazy<T> = PyOnceLock<Py<PyArray2<T>>>;

/// A JSON object as a Python dictionary; a separate type for the stubs.
pub(crate) struct Json(pub(crate) Py<PyDict>);

impl<'py> IntoPyObject<'py> for Json {
    type Target = PyDict;
    type Output = Bound<'py, PyDict>;
    type Error = Infallible;

    #[cfg(feature = "stubs")]
    const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
        pyo3::type_hint_identifier!("builtins", "dict"),
        pyo3::type_hint_identifier!("builtins", "str"),
        pyo3::type_hint_identifier!("typing", "Any")
    );

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0.into_bound(py))
    }
}

/// Rows of a report.
pub(crate) struct JsonRows(pub(crate) Py<PyAny>);

impl<'py> IntoPyObject<'py> for JsonRows {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = Infallible;

    #[cfg(feature = "stubs")]
    const OUTPUT_TYPE: pyo3::inspect::PyStaticExpr = pyo3::type_hint_subscript!(
        pyo3::type_hint_identifier!("builtins", "list"),
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("builtins", "dict"),
            pyo3::type_hint_identifier!("builtins", "str"),
            pyo3::type_hint_identifier!("typing", "Any")
        )
    );

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Infallible> {
        Ok(self.0.into_bound(py))
    }
}

/// A report as a dictionary, with the names of `docs/reference/json.md`.
pub(crate) fn json(py: Python<'_>, report: &impl serde::Serialize) -> PyResult<Json> {
    Ok(Json(pythonize::pythonize(py, report)?.cast_into::<PyDict>()?.unbind()))
}
