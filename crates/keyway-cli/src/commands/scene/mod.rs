//! `keyway scene`: scene files of the field's benchmarks, of tables of starts and goals and of the papers' maps, and the schema of scene
//! files.

mod barn;
mod dynabarn;
mod pairs;
mod papers;
mod rows;
mod schema;

use super::{Done, print};
use crate::args::{Format, SceneCommand};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use keyway_sim::scene_files::SceneFile;
use serde::Serialize;
use std::path::Path;

/// `keyway.scene/1`.
#[derive(Serialize)]
struct SceneReport {
    schema: &'static str,
    /// Paths of the scenes that were written.
    files: Vec<String>,
}

/// A scene and the name of its file.
struct Named {
    file: String,
    scene: SceneFile,
}

pub(crate) fn run(command: &SceneCommand) -> Result<Done, CliError> {
    match command {
        SceneCommand::Barn(args) => write(&args.out, &barn::scenes(args)?, args.format),
        SceneCommand::Pairs(args) => write(&args.out, &pairs::scenes(args)?, args.format),
        SceneCommand::Papers(args) => write(&args.out, &papers::scenes(args)?, args.format),
        SceneCommand::Dynabarn(args) => write(&args.out, &dynabarn::scenes(args)?, args.format),
        SceneCommand::Schema => schema::print(),
    }
}

/// Writes all scenes, or none where one of them may not be written.
fn write(folder: &Path, scenes: &[Named], format: Format) -> Result<Done, CliError> {
    let names: Vec<&str> = scenes.iter().map(|named| named.file.as_str()).collect();
    let mut out = prepare(folder, &names)?;
    for Named { file, scene } in scenes {
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

/// Refuses a file in which there is nothing.
fn unless_empty<T>(rows: &[T], path: &Path, field: &str) -> Result<(), CliError> {
    if rows.is_empty() {
        let message = format!("{}: there is no line below the header", path.display());
        return Err(CliError::new(Kind::Input, message).field(field));
    }
    Ok(())
}
