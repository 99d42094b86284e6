//! JSON schema of scene files: their fields, for editors and for programs that write scenes.
//!
//! It is generated from the type that reads scenes, and its descriptions are the documentation of
//! that type.

use crate::catalogue::plain;
use keyway_sim::scene_files::SceneFile;
use schemars::schema_for;
use serde_json::Value;

/// Returns the JSON schema of scene files, with the name and the version of their format.
pub fn scene_schema() -> Value {
    let mut schema = schema_for!(SceneFile);
    schema.insert("title".to_owned(), format!("keyway.scene.file/{}", SceneFile::VERSION).into());
    let mut document = schema.to_value();
    describe_plainly(&mut document);
    document
}

/// Rewrites descriptions for authors of scenes, who do not read the code.
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

/// Returns a description without its example in Rust. In a file, a field without a value is absent.
fn in_files(description: &str) -> String {
    let text = description.split("```").next().unwrap_or_default();
    plain(text.trim_end()).replace("  ", " ").replace("`None`", "absent")
}
