//! Conversion of arguments: positions, poses, ranges, grids.

use crate::errors::{bad_value, warn};
use keyway::geometry::Point;
use numpy::ndarray::ArrayView2;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
#[cfg(feature = "stubs")]
use pyo3::type_hint_union;
use pyo3::types::{PyComplex, PyString};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Type of a numeric argument in the stubs.
macro_rules! numbers_hint {
    () => {
        #[cfg(feature = "stubs")]
        const INPUT_TYPE: pyo3::inspect::PyStaticExpr = type_hint_union!(
            pyo3::type_hint_subscript!(
                pyo3::type_hint_identifier!("collections.abc", "Sequence"),
                pyo3::type_hint_identifier!("builtins", "float")
            ),
            pyo3::type_hint_subscript!(
                pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
                pyo3::type_hint_identifier!("typing", "Any")
            )
        );
    };
}

/// A sequence of numbers: a tuple, a list or an array.
pub(crate) struct Numbers(Vec<f64>);

impl<'py> FromPyObject<'_, 'py> for Numbers {
    type Error = PyErr;
    numbers_hint!();

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok((x, y)) = object.extract::<(f64, f64)>() {
            return Ok(Self(vec![x, y]));
        }
        let expected = |_: PyErr| {
            let text = format!("expected numbers such as (1.0, 2.0), got {}", described(&object));
            PyTypeError::new_err(text)
        };
        let is_text = object.is_instance_of::<PyString>();
        let length = object.len().ok().filter(|length| *length <= 3 && !is_text);
        if length.is_none() {
            return Err(expected(bad_value("")));
        }
        let numbers = object.try_iter().map_err(expected)?;
        let real = |number: Bound<'py, PyAny>| {
            let is_complex = number.is_instance_of::<PyComplex>();
            if is_complex { Err(bad_value("")) } else { number.extract::<f64>() }
        };
        let numbers = numbers.map(|number| real(number?));
        Ok(Self(numbers.collect::<PyResult<_>>().map_err(expected)?))
    }
}

impl Numbers {
    /// A position \[m\].
    pub(crate) fn position(&self, name: &str) -> PyResult<Point> {
        match self.0[..] {
            [x, y] => finite(Point::new(x, y), name),
            _ => Err(self.wrong(name, "(x, y) in metres")),
        }
    }

    /// A position \[m\], or a pose \[m, m, rad\]. A heading of more than a turn is probably in
    /// degrees, and gives a warning.
    pub(crate) fn place(&self, py: Python<'_>, name: &str) -> PyResult<(Point, Option<f64>)> {
        match self.0[..] {
            [x, y] => Ok((finite(Point::new(x, y), name)?, None)),
            [x, y, heading_rad] if heading_rad.is_finite() => {
                if heading_rad.abs() > TAU + 1e-6 {
                    let text = format!(
                        "{name}: {heading_rad} is more than a turn: headings are in radians, and only in files in degrees"
                    );
                    warn(py, &text)?;
                }
                Ok((finite(Point::new(x, y), name)?, Some(heading_rad)))
            }
            [_, _, heading_rad] => Err(bad_value(format!(
                "{name}: the heading must be a finite number, got {heading_rad}"
            ))),
            _ => Err(self.wrong(name, "(x, y) or (x, y, heading) in metres and radians")),
        }
    }

    /// Exactly this many numbers, with their names in `names` for errors. The navigator checks
    /// the values.
    pub(crate) fn exactly<const N: usize>(&self, name: &str, names: &str) -> PyResult<[f64; N]> {
        <[f64; N]>::try_from(&self.0[..]).map_err(|_| self.wrong(name, names))
    }

    fn wrong(&self, name: &str, expected: &str) -> PyErr {
        bad_value(format!("{name}: expected {expected}, got {} numbers", self.0.len()))
    }
}

/// A position \[m\], with its heading \[rad\] if it has one.
pub(crate) fn place(Point { x, y }: Point, heading_rad: Option<f64>) -> Vec<f64> {
    [Some(x), Some(y), heading_rad].into_iter().flatten().collect()
}

/// Formats a position for messages, with few digits.
pub(crate) fn point_text(Point { x, y }: Point) -> String {
    let is_short = x.abs().max(y.abs()) < 1e9;
    if is_short { format!("({x}, {y})") } else { format!("({x:e}, {y:e})") }
}

fn finite(point: Point, name: &str) -> PyResult<Point> {
    if point.is_finite() {
        return Ok(point);
    }
    Err(bad_value(format!(
        "{name}: both coordinates must be finite numbers, got ({}, {})",
        point.x, point.y
    )))
}

/// A list of strings or paths, or the description of something else. A single string is refused:
/// Python would treat it as a list of letters.
pub(crate) struct Listed<T>(Result<Vec<T>, String>);

/// Items of a list, with their name for messages.
pub(crate) trait Item {
    const NAME: &str;
}

impl Item for String {
    const NAME: &str = "strings";
}

impl Item for PathBuf {
    const NAME: &str = "paths";
}

impl<'py, T: FromPyObjectOwned<'py> + Item> FromPyObject<'_, 'py> for Listed<T> {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = Vec::<T>::INPUT_TYPE;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let item = |item: &Bound<'py, PyAny>| item.extract::<T>().map_err(Into::into);
        Ok(Self(items(&object).and_then(|all| listed(&all, item))))
    }
}

impl<T: Item> Listed<T> {
    /// Returns the items of the argument of this name.
    pub(crate) fn named(self, name: &str) -> PyResult<Vec<T>> {
        self.0.map_err(|got| {
            PyTypeError::new_err(format!("{name}: expected a list of {}, got {got}", T::NAME))
        })
    }
}

/// Returns the items of a list or a tuple, or the description of something else.
pub(crate) fn items<'py>(object: &Bound<'py, PyAny>) -> Result<Vec<Bound<'py, PyAny>>, String> {
    if is_path(object) {
        return Err(format!("{}: put it into a list", described(object)));
    }
    object.extract().map_err(|_: PyErr| described(object))
}

/// Converts all items, or describes the first one that cannot be.
pub(crate) fn listed<'py, T>(
    items: &[Bound<'py, PyAny>],
    convert: impl Fn(&Bound<'py, PyAny>) -> PyResult<T>,
) -> Result<Vec<T>, String> {
    let described = |(i, item): (usize, &Bound<'py, PyAny>)| {
        convert(item).map_err(|error| {
            // A string may be wrong, too, such as one that is no valid Unicode.
            let why = if is_path(item) { format!(": {error}") } else { String::new() };
            format!("{} at index {i}{why}", described(item))
        })
    };
    items.iter().enumerate().map(described).collect()
}

/// True if an argument is a string or an `os.PathLike`.
pub(crate) fn is_path(object: &Bound<'_, PyAny>) -> bool {
    object.is_instance_of::<PyString>() || object.hasattr("__fspath__").unwrap_or(false)
}

/// Describes an argument for an error: its type, and the shape of an array.
pub(crate) fn described(object: &Bound<'_, PyAny>) -> String {
    if let Ok(array) = object.cast::<PyUntypedArray>() {
        return format!("an array of {} of shape {}", array.dtype(), shape_text(array.shape()));
    }
    object.get_type().name().map_or_else(|_| "something else".to_owned(), |name| format!("{name}"))
}

fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Converts real numbers of any type to an array of float64. Complex numbers and strings are
/// refused, which numpy would convert.
fn reals<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let array = object.py().import("numpy")?.call_method1("asarray", (object,))?;
    let kind: char = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"biuf".contains(kind) {
        return Err(PyTypeError::new_err(format!("got {}", described(&array))));
    }
    array.call_method1("astype", ("float64", "K", "unsafe", true, false))
}

/// A 1-D array of numbers, such as the ranges of a scan; an array of float64 is read in place.
pub(crate) struct Ranges<'py>(Bound<'py, PyAny>);

impl<'py> FromPyObject<'_, 'py> for Ranges<'py> {
    type Error = PyErr;
    numbers_hint!();

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(object.to_owned()))
    }
}

impl Ranges<'_> {
    /// Returns the numbers.
    pub(crate) fn numbers(&self, name: &str) -> PyResult<Vec<f64>> {
        let wrong =
            |got: String| bad_value(format!("{name}: expected a sequence of numbers, got {got}"));
        let array = if let Ok(array) = self.0.cast::<PyArray1<f64>>() {
            array.clone()
        } else {
            let made = reals(&self.0).map_err(|error| {
                PyTypeError::new_err(format!("{name}: expected a sequence of numbers ({error})"))
            })?;
            made.cast_into::<PyArray1<f64>>()
                .map_err(|error| wrong(described(&error.into_inner())))?
        };
        let view = array.try_readonly().map_err(bad_value)?;
        Ok(view.as_array().iter().copied().collect())
    }
}

/// Positions, one per row; an array of float64 is read in place.
pub(crate) struct Positions(pub(crate) Vec<[f64; 2]>);

impl<'py> FromPyObject<'_, 'py> for Positions {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = type_hint_union!(
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("collections.abc", "Sequence"),
            pyo3::type_hint_subscript!(
                pyo3::type_hint_identifier!("collections.abc", "Sequence"),
                pyo3::type_hint_identifier!("builtins", "float")
            )
        ),
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
            pyo3::type_hint_identifier!("typing", "Any")
        )
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let expected = || {
            let got = described(&object);
            PyTypeError::new_err(format!(
                "expected positions (x, y) in metres as an array of shape (n, 2), got {got}"
            ))
        };
        if object.len().is_ok_and(|length| length == 0) {
            return Ok(Self(Vec::new()));
        }
        let array = reals(&object).ok().and_then(|array| array.cast_into::<PyArray2<f64>>().ok());
        let array = array.ok_or_else(expected)?;
        let array = array.try_readonly().map_err(bad_value)?;
        let array = array.as_array();
        if array.ncols() != 2 {
            return Err(expected());
        }
        Ok(Self(array.rows().into_iter().map(|row| [row[0], row[1]]).collect()))
    }
}

impl Positions {
    /// Converts them to points. An error names the first invalid one.
    pub(crate) fn points(&self, name: &str) -> PyResult<Vec<Point>> {
        let point =
            |(i, &[x, y]): (usize, &[f64; 2])| finite(Point::new(x, y), &format!("{name}[{i}]"));
        self.0.iter().enumerate().map(point).collect()
    }
}

/// Cells of a map: a mask of the occupied ones, or their occupancy as in `nav_msgs`.
pub(crate) enum Grid<'py> {
    Mask(Bound<'py, PyArray2<bool>>),
    Values(Bound<'py, PyArray2<i8>>),
}

impl<'py> FromPyObject<'_, 'py> for Grid<'py> {
    type Error = PyErr;
    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = type_hint_union!(
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
            pyo3::type_hint_identifier!("numpy", "bool_")
        ),
        pyo3::type_hint_subscript!(
            pyo3::type_hint_identifier!("numpy.typing", "NDArray"),
            pyo3::type_hint_identifier!("numpy", "int8")
        )
    );

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(mask) = object.cast::<PyArray2<bool>>() {
            return Ok(Self::Mask(mask.to_owned()));
        }
        if let Ok(values) = object.cast::<PyArray2<i8>>() {
            return Ok(Self::Values(values.to_owned()));
        }
        Err(PyTypeError::new_err(format!(
            "expected a two-dimensional array of bool, or of int8 as in nav_msgs (-1 unknown, 0 free to 100 occupied), \
             got {}",
            described(&object)
        )))
    }
}

impl Grid<'_> {
    /// Number of rows and columns.
    pub(crate) fn shape(&self) -> (usize, usize) {
        let shape = match self {
            Self::Mask(array) => array.shape(),
            Self::Values(array) => array.shape(),
        };
        (shape[0], shape[1])
    }

    /// Reads the array in place, whatever its strides.
    pub(crate) fn read<R>(
        &self,
        mask: impl FnOnce(ArrayView2<'_, bool>) -> R,
        values: impl FnOnce(ArrayView2<'_, i8>) -> R,
    ) -> PyResult<R> {
        Ok(match self {
            Self::Mask(array) => mask(array.try_readonly().map_err(bad_value)?.as_array()),
            Self::Values(array) => values(array.try_readonly().map_err(bad_value)?.as_array()),
        })
    }
}
