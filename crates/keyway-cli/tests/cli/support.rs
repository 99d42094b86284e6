//! Runs the program in a folder.

use serde_json::Value;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The result of a run of the program.
pub(crate) struct Answer {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Answer {
    #[track_caller]
    pub(crate) fn expect_code(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout:\n{}\nstderr:\n{}", self.out, self.err);
        self
    }

    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        let parsed = serde_json::from_str(&self.out);
        parsed.unwrap_or_else(|error| panic!("{error}\n{}\n{}", self.out, self.err))
    }
}

/// Runs `keyway` with arguments in a folder.
pub(crate) fn keyway_args<'a>(folder: &Path, args: impl IntoIterator<Item = &'a str>) -> Answer {
    let mut command = Command::new(env!("CARGO_BIN_EXE_keyway"));
    let output = command.args(args).current_dir(folder).output().unwrap();
    Answer {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Runs `keyway` with arguments separated by spaces.
pub(crate) fn keyway(folder: &Path, line: &str) -> Answer {
    keyway_args(folder, line.split_whitespace())
}

/// A folder with the bundled maps and scene, as written by `keyway demo`, and a small map with a
/// wall: `walled.map`, columns 0 to 6, rows 0 to 4, the wall in column 3 open in row 4 only.
pub(crate) fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for entry in std::fs::read_dir(scenes).unwrap() {
        let from = entry.unwrap().path();
        std::fs::copy(&from, folder.path().join(from.file_name().unwrap())).unwrap();
    }
    let walled = ".......\n...@...\n...@...\n...@...\n...@...\n";
    write(&folder, "walled.map", &format!("type octile\nheight 5\nwidth 7\nmap\n{walled}"));
    let closed = walled.replacen("...", "...@", 1).replacen("@....", "@...", 1);
    write(&folder, "closed.map", &format!("type octile\nheight 5\nwidth 7\nmap\n{closed}"));
    folder
}

pub(crate) fn write(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).unwrap();
}

pub(crate) fn read(folder: &TempDir, name: &str) -> String {
    std::fs::read_to_string(folder.path().join(name)).unwrap()
}

/// Sets every measured time to null: the only values that may differ between two runs.
pub(crate) fn without_times(mut report: Value) -> Value {
    let plan = if report.get("plan").is_some() { &mut report["plan"] } else { &mut report };
    plan["time_s"] = Value::Null;
    if report["smoothed"].is_object() {
        report["smoothed"]["time_s"] = Value::Null;
    }
    if report["run"].is_object() {
        report["run"]["mean_cycle_us"] = Value::Null;
    }
    report
}

/// The name of a member of an object, and a predicate for its value.
pub(crate) type Member = (&'static str, fn(&Value) -> bool);

/// Checks the names and values of all members of an object.
#[track_caller]
pub(crate) fn expect_members(value: &Value, members: &[Member]) {
    let object = value.as_object().unwrap();
    let names: Vec<&str> = object.keys().map(String::as_str).collect();
    let expected: Vec<&str> = members.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, expected);
    for (name, is_right) in members {
        assert!(is_right(&object[*name]), "{name}: {}", object[*name]);
    }
}
