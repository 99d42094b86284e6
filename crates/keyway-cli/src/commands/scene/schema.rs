//! The JSON schema of scene files, `keyway.scene.file/2`: what fields there are, for editors and for programs that write scenes.
//!
//! It is made from the type that reads scenes, and its descriptions are the documentation of that type.

use crate::commands::Done;
use crate::commands::list::plain;
use crate::error::CliError;
use keyway_sim::scene_files::SceneFile;
use schemars::schema_for;
use serde_json::Value;

pub(super) fn print() -> Result<Done, CliError> {
    crate::json::print(&document())?;
    Ok(Done::Success)
}

/// The schema under the name and the version of the format.
fn document() -> Value {
    let mut schema = schema_for!(SceneFile);
    schema.insert("title".to_owned(), format!("keyway.scene.file/{}", SceneFile::VERSION).into());
    let mut document = schema.to_value();
    describe_plainly(&mut document);
    document
}

/// Descriptions are for people who write scenes, not for those who read the documentation of the code.
fn describe_plainly(node: &mut Value) {
    match node {
        Value::Object(members) => {
            for (name, member) in members {
                match member {
                    Value::String(text) if name == "description" => *text = in_files(text),
                    member => describe_plainly(member),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(describe_plainly),
        _ => {}
    }
}

/// Without the example in Rust, and a field that has no value is not there.
fn in_files(description: &str) -> String {
    let text = description.split("```").next().unwrap_or_default();
    plain(text.trim_end()).replace("  ", " ").replace("`None`", "absent")
}
