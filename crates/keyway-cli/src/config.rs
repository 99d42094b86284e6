//! Parameters of a command: a stack, overridden by a file, overridden by options.

use crate::args::{ConfigArgs, Unknown};
use crate::error::{CliError, Kind};
use keyway::files::{
    ConfigFileError, FieldValue, LayerError, ParameterFile, ParameterLayer, ParameterLayers,
    StackBase, read_parameters,
};
use keyway::navigate::Stack;
use std::path::Path;

/// Parameter layers of `--config`, options and `--set`. An option has the name of its field.
pub(crate) fn given_parameters(
    args: &ConfigArgs,
    options: impl IntoIterator<Item = Option<FieldValue>>,
) -> Result<ParameterLayers, CliError> {
    let unknown = FieldValue::if_given("unknown", "map.unknown", args.unknown.map(Unknown::name));
    Ok(ParameterLayers {
        file: args.config.as_deref().map(read_file).transpose()?,
        fields: options.into_iter().chain([unknown]).flatten().collect(),
        assignments: args.set.clone(),
    })
}

/// Lays the parameters over a stack, and checks the result ([`ParameterLayers::over`]).
pub(crate) fn resolve(
    base: StackBase<'_>,
    args: &ConfigArgs,
    options: impl IntoIterator<Item = Option<FieldValue>>,
    others: &[String],
) -> Result<Stack, CliError> {
    Ok(given_parameters(args, options)?.over(base, others)?)
}

fn read_file(path: &Path) -> Result<ParameterFile, CliError> {
    read_parameters(path).map_err(|error| {
        let is_parsed = matches!(error, ConfigFileError::Toml { .. });
        let kind = if is_parsed { Kind::Config } else { Kind::Input };
        CliError::new(kind, error).field("--config")
    })
}

impl From<LayerError> for CliError {
    fn from(error: LayerError) -> Self {
        unusable_parameter(&error, &error.path)
    }
}

/// Blames the option, or the parameter if it comes from `--set`, a file, or a combination of
/// layers.
pub(crate) fn unusable_parameter(error: &LayerError, path: &str) -> CliError {
    let LayerError { layer, fault, .. } = error;
    let named = |message: String, field: &str| {
        let error = CliError::new(Kind::Config, message);
        if field.is_empty() { error } else { error.field(field) }
    };
    match layer {
        Some(ParameterLayer::Field(field)) => {
            named(format!("--{field}: {fault}"), &format!("--{field}"))
        }
        Some(ParameterLayer::Assignment) => named(format!("--set: {fault}"), path),
        _ => named(error.to_string(), path),
    }
}
