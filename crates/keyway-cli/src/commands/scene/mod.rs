//! `keyway scene`: generates scene files from benchmarks, from tables of starts and goals, on the
//! papers' maps and in narrow environments; and prints their schema.

use super::{Done, print};
use crate::args::{Format, SceneCommand};
use crate::error::{CliError, Kind};
use crate::inputs::bad_file;
use crate::out_dir::prepare;
use keyway_lab::scenes::{
    BarnRequest, DynabarnRequest, NamedScene, NarrowRequest, PairsRequest, PapersRequest,
    ScenesError, scene_schema,
};
use serde::Serialize;
use std::path::Path;

/// `keyway.scene/1`.
#[derive(Serialize)]
struct SceneReport {
    schema: &'static str,
    /// Paths of the written scenes.
    files: Vec<String>,
}

pub(crate) fn run(command: &SceneCommand) -> Result<Done, CliError> {
    match command {
        SceneCommand::Barn(args) => {
            let (cylinders, summary) = (args.cylinders.clone(), args.summary.clone());
            let request = BarnRequest { cylinders, summary, is_known: args.known };
            write(&args.out, &request.scenes()?, args.format)
        }
        SceneCommand::Pairs(args) => {
            let request = PairsRequest {
                pairs: args.pairs.clone(),
                robot: args.robot.clone(),
                unknown: args.unknown,
                moving: args.moving,
                gives_way: args.gives_way,
                folder: args.out.clone(),
            };
            write(&args.out, &request.scenes()?, args.format)
        }
        SceneCommand::Papers(args) => {
            let request = PapersRequest { names: args.names.clone(), count: args.count };
            write(&args.out, &request.scenes()?, args.format)
        }
        SceneCommand::Narrow(args) => {
            let (names, seed, count) = (args.names.clone(), args.seed, args.count);
            write(&args.out, &NarrowRequest { names, seed, count }.scenes()?, args.format)
        }
        SceneCommand::Dynabarn(args) => {
            let (key_frames, worlds) = (args.key_frames.clone(), args.worlds.clone());
            let request = DynabarnRequest { key_frames, worlds };
            write(&args.out, &request.scenes()?, args.format)
        }
        SceneCommand::Schema => {
            crate::json::print(&scene_schema())?;
            Ok(Done::Success)
        }
    }
}

/// Writes all scenes, or none if one of them may not be written.
fn write(folder: &Path, scenes: &[NamedScene], format: Format) -> Result<Done, CliError> {
    let names: Vec<&str> = scenes.iter().map(|named| named.file.as_str()).collect();
    let mut out = prepare(folder, &names)?;
    for NamedScene { file, scene } in scenes {
        // A scene is plain data with string keys: this cannot fail.
        let text = toml::to_string(scene).unwrap_or_default();
        out.write(file, text.as_bytes())?;
    }
    let files = names.iter().map(|name| out.path(name).display().to_string()).collect();
    out.finish()?;
    let report = SceneReport { schema: "keyway.scene/1", files };
    match format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => {
            print(&format!("{} scenes in {}", scenes.len(), folder.display()))?;
        }
    }
    Ok(Done::Success)
}

impl From<ScenesError> for CliError {
    fn from(error: ScenesError) -> Self {
        let argument = error.field().map(argument);
        let kind = match error {
            ScenesError::Robot(error) => return bad_file(error, "--robot"),
            ScenesError::Unknown { .. } | ScenesError::TooFew { .. } => Kind::Usage,
            ScenesError::Baseline(_) | ScenesError::Reconstruction(_) => Kind::Config,
            _ => Kind::Input,
        };
        Self { field: argument.map(str::to_owned), ..Self::new(kind, error) }
    }
}

/// Returns the argument for a field of a request.
fn argument(field: &'static str) -> &'static str {
    match field {
        "cylinders" => "CYLINDERS.csv",
        "summary" => "--summary",
        "key_frames" => "KEYFRAMES.csv",
        "worlds" => "--worlds",
        "pairs" => "PAIRS.csv",
        "robot" => "--robot",
        "folder" => "--out",
        "names" => "NAME",
        "count" => "--count",
        field => field,
    }
}
