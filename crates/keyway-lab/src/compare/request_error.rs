//! Errors of requests for comparisons.

use super::columns::ColumnError;
use super::map_names::SameMap;
use keyway::files::{ConfigFileError, LayerError, ParameterLayer};
use keyway::robot::FootprintError;
use thiserror::Error;

/// Reason why a request for a comparison is refused, with the field of the request.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CompareRequestError {
    /// A list of names cannot be used.
    #[error("{field}: {error}")]
    Names {
        /// The field.
        field: &'static str,
        /// Fault of the list.
        error: NamesError,
    },
    /// A column cannot be shown.
    #[error("columns: {0}")]
    Columns(ColumnError),
    /// A number is too small or too large.
    #[error("{field}: expected a whole number from {least} to {most}, got {got}")]
    Count {
        /// The field.
        field: &'static str,
        /// Smallest number.
        least: u64,
        /// Largest number.
        most: u64,
        /// Number in the request.
        got: u64,
    },
    /// The radius is not a valid length.
    #[error("radius: expected a length of at least 0 in metres, got {radius_m:?}")]
    Radius {
        /// The radius \[m\].
        radius_m: f64,
    },
    /// No robot can have this radius.
    #[error("radius: {0}; lengths are in metres, not in millimetres")]
    Footprint(FootprintError),
    /// The robot cannot be used.
    #[error(transparent)]
    Robot(ConfigFileError),
    /// A parameter cannot be used.
    #[error("{}{error}", owner.as_ref().map_or_else(String::new, |owner| format!("{owner}: ")))]
    Parameters {
        /// Name of the planner or smoother with the parameter, if it belongs to one.
        owner: Option<String>,
        /// Path of the parameter as given.
        path: String,
        /// Layer and fault.
        error: LayerError,
    },
    /// A parameter belongs to a part that is not compared.
    #[error(
        "{path}: this part is not compared; the planners are {}, the smoothers {}",
        planners.join(", "), smoothers.join(", ")
    )]
    NotCompared {
        /// Path of the parameter.
        path: String,
        /// Names of the planners.
        planners: Vec<String>,
        /// Names of the smoothers.
        smoothers: Vec<String>,
    },
    /// A parameter renames a compared part.
    #[error(
        "parameters: `{path}` cannot be set in a comparison; use planners and smoothers to select \
         what is compared"
    )]
    Renamed {
        /// Path of the parameter.
        path: String,
    },
    /// A map is named twice.
    #[error(transparent)]
    SameMap(#[from] SameMap),
}

/// Fault of a list of names.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NamesError {
    /// A name is empty.
    #[error("a name is missing in `{}`", names.join(","))]
    Missing {
        /// All names.
        names: Vec<String>,
    },
    /// The name for all is combined with others.
    #[error("`{all}` stands for all names; give it alone")]
    AllAndOthers {
        /// The name for all.
        all: &'static str,
    },
    /// A name is repeated.
    #[error("{name} is given twice")]
    Repeated {
        /// The name.
        name: String,
    },
}

impl CompareRequestError {
    /// Returns the name of the request's field that is at fault.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Names { field, .. } | Self::Count { field, .. } => field,
            Self::Columns(_) => "columns",
            Self::Radius { .. } | Self::Footprint(_) => "radius",
            Self::Robot(_) => "robot",
            Self::Parameters { error, .. } => match error.layer {
                Some(ParameterLayer::Field(field)) => field,
                _ => "parameters",
            },
            Self::NotCompared { .. } | Self::Renamed { .. } => "parameters",
            Self::SameMap(_) => "maps",
        }
    }
}
