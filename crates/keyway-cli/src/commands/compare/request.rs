//! Converts the arguments of `keyway compare` into a request, and its errors into those of the
//! command line.

use crate::args::CompareArgs;
use crate::commands::{unusable_planner, why};
use crate::config::{given_parameters, unusable_parameter};
use crate::error::{CliError, Kind};
use crate::inputs::{bad_file, bad_layers, bad_radius};
use keyway::files::StartingValues;
use keyway::plan::PlanError;
use keyway_lab::compare::{
    ColumnError, CompareError, CompareRequest, CompareRequestError, QueriedError, QueryChoice,
    QueryError,
};

/// Returns the request for the arguments.
pub(super) fn request(args: &CompareArgs) -> Result<CompareRequest, CliError> {
    let count = args.queries;
    let queries = match (&args.pairs, &args.scen) {
        (Some(file), _) => QueryChoice::Pairs { file: file.clone() },
        (None, Some(file)) => QueryChoice::Scenarios { file: file.clone(), count },
        (None, None) => QueryChoice::Random {
            count: count.unwrap_or(QueryChoice::USUAL_COUNT),
            seed: args.seed,
        },
    };
    Ok(CompareRequest {
        maps: args.maps.clone(),
        planners: args.planners.clone(),
        smoothers: args.smoothers.clone(),
        parameters: given_parameters(&args.config, [])?,
        values: StartingValues::published_if(args.as_published),
        robot: args.size.robot.clone(),
        radius_m: args.size.radius,
        queries,
        repeat: args.repeat,
        has_times: !args.no_times,
        columns: args.columns.clone(),
        why,
    })
}

impl From<CompareRequestError> for CliError {
    fn from(error: CompareRequestError) -> Self {
        let usage = |message: String, field: &str| Self::new(Kind::Usage, message).field(field);
        match error {
            CompareRequestError::Columns(error) => {
                const FIELD: &str = "--columns";
                let message = match &error {
                    ColumnError::Time { name } => {
                        format!("{name} is a time, which --no-times omits; remove it or --no-times")
                    }
                    error => error.to_string(),
                };
                usage(format!("{FIELD}: {message}"), FIELD)
            }
            CompareRequestError::Robot(error) => bad_file(error, "--robot"),
            CompareRequestError::Footprint(error) => bad_radius(&error),
            CompareRequestError::Parameters { owner, path, error } => {
                let error = unusable_parameter(&error, &path);
                let Some(owner) = owner else { return error };
                Self { message: format!("{owner}: {}", error.message), ..error }
            }
            CompareRequestError::NotCompared { ref path, .. } => {
                Self::new(Kind::Config, format!("--set {error}")).field(path)
            }
            CompareRequestError::Renamed { path } => {
                let message = format!(
                    "--set: `{path}` cannot be set in a comparison; use --planners and --smoothers to \
                     select what is compared"
                );
                Self::new(Kind::Config, message).field(path)
            }
            CompareRequestError::SameMap(error) => usage(error.to_string(), "MAP"),
            error => usage(format!("--{error}"), &format!("--{}", error.field())),
        }
    }
}

impl From<QueriedError> for CliError {
    fn from(error: QueriedError) -> Self {
        let field = match error {
            QueriedError::Layers { map, error } => {
                let error = bad_layers(&error);
                let message = format!("{}: {}", map.display(), error.message);
                return Self { message, ..error };
            }
            QueriedError::Queries(QueryError::PairsFile(_) | QueryError::Pairs { .. }) => "--pairs",
            QueriedError::Queries(QueryError::Unconnected { .. }) => "MAP",
            _ => "--scen",
        };
        Self::new(Kind::Input, error).field(field)
    }
}

impl From<CompareError> for CliError {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Planner { error: error @ PlanError::NeedsUniformCost { .. }, .. } => {
                let message = format!("{error}; `--planners all` omits such planners");
                Self::new(Kind::Config, message).field("--planners")
            }
            CompareError::Planner { name, error: PlanError::Config(error) } => {
                Self::new(Kind::Config, format!("{name}: {error}")).field(error.path)
            }
            CompareError::Planner { name, error } => {
                let error = unusable_planner(error);
                Self { message: format!("{name}: {}", error.message), ..error }
            }
            CompareError::Smoother(error) => {
                Self::new(Kind::Config, &error).field(error.path.as_str())
            }
            CompareError::Query(error) => Self::new(Kind::Config, error).field("--planners"),
            error => Self::new(Kind::Usage, error),
        }
    }
}
