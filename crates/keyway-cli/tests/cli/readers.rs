//! Tests of unusable files: their messages, their sizes, and a prompt answer.

use crate::support::{Answer, folder, keyway, read, write};
use std::fs;
use tempfile::TempDir;

const PLAN: &str = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5";

/// Words that only programmers understand.
const FORBIDDEN: [&str; 28] = [
    "u8",
    "u16",
    "u32",
    "u64",
    "usize",
    "i8",
    "i16",
    "i32",
    "i64",
    "i128",
    "f32",
    "f64",
    "::",
    "Some(",
    "Error",
    "Options",
    "Policy",
    "from_str",
    "budget",
    "Budget",
    "recursi",
    "struct ",
    "enum",
    "variant",
    "tuple",
    "digit found",
    "os error",
    "ChunkType",
];

#[track_caller]
fn refused(folder: &TempDir, line: &str, parts: &[&str]) -> String {
    let Answer { out, err, .. } = keyway(folder.path(), line).expect_code(2);
    assert!(out.is_empty() && err.starts_with("error: "), "{line}: {out}{err}");
    let found: Vec<&&str> = FORBIDDEN.iter().filter(|word| err.contains(**word)).collect();
    assert!(found.is_empty(), "{line}: {found:?} in: {err}");
    assert_eq!(err.lines().count(), 1, "{line}: {err}");
    for part in parts {
        assert!(err.contains(part), "{line}: {part}: {err}");
    }
    err
}

#[test]
fn parameters_say_what_a_field_should_be() {
    let folder = folder();
    for (toml, parts) in [
        ("map = 3", &["bad.toml", "`map`: ", "`3`, expected a table"][..]),
        ("[map]\nclearance_m = \"a\"", &["`map.clearance_m`: ", "\"a\", expected a number"]),
        ("[map]\nclearance_m = [1]", &["`map.clearance_m`: ", "array, expected a number"]),
        (
            "[map.published]\nexpansion_cells = -1",
            &["`map.published.expansion_cells`", "a whole number from 0 to 4294967295", "-1"],
        ),
        ("[map.published]\nexpansion_cells = 5000000000", &["a whole number", "4294967295"]),
        (
            "[map.published]\nexpansion_cells = 1.5",
            &["`map.published.expansion_cells`: ", "`1.5`, expected a whole number"],
        ),
        ("[map]\nunknown = \"grey\"", &["`map.unknown`", "`grey`", "`blocked`"]),
        ("[map]\nunknown = true", &["`map.unknown`: invalid type, expected a string"]),
        ("[planner]\nname = \"x\"", &["`planner.name` must be one of"]),
        ("[planner]\nname = 3", &["`planner.name`: ", "`3`, expected a string"]),
        ("[local]\nx = 1", &["there is no field `local.x`"]),
        ("a", &["bad.toml: line 1, column 2: key with no value, expected `=`"]),
        ("a = [1, 2", &["bad.toml: line 1, column 10: unclosed array"]),
        ("a = 1\na = 2", &["bad.toml: line 2, column 1: duplicate key"]),
        (
            "a = 99999999999999999999",
            &[
                "bad.toml: line 1, column 5",
                "`99999999999999999999`, expected a whole number from -9223372036854775808 to 9",
            ],
        ),
    ] {
        write(&folder, "bad.toml", toml);
        refused(&folder, &format!("{PLAN} --config bad.toml"), parts);
    }
    write(&folder, "empty.toml", "");
    keyway(folder.path(), &format!("{PLAN} --config empty.toml")).expect_code(0);
}

#[test]
fn every_kind_of_file_is_named_with_its_line() {
    let folder = folder();
    let prepare = "prepare walled.map --out walled.prepared";
    keyway(folder.path(), prepare).expect_code(0);
    let yaml = read(&folder, "small_house.yaml");
    for (name, text, line, parts) in [
        (
            "a.yaml",
            yaml.replace("0.050000", "1e9"),
            "map info a.yaml",
            &["a.yaml: line 2: `resolution`"][..],
        ),
        ("a.yaml", format!("{yaml}negate: 1\n"), "map info a.yaml", &["a.yaml: line 7", "twice"]),
        (
            "a.yaml",
            format!("{yaml}---\na: b\n"),
            "map info a.yaml",
            &["a.yaml: line 8", "second document"],
        ),
        ("a.yaml", "[".repeat(2000), "map info a.yaml", &["a.yaml: line 1"]),
        (
            "a.yaml",
            " ".repeat((1 << 20) + 1),
            "map info a.yaml",
            &["a.yaml: it is larger than the limit of 1 MiB"],
        ),
        ("a.png", "P5 1 1".into(), "map info a.png", &["a.png: line 1: the largest value"]),
        (
            "a.png",
            "P5 9999999999 1 255\n".into(),
            "map info a.png",
            &["the width", "expected a whole number from 1 to 2147483648"],
        ),
        (
            "a.yaml",
            yaml.replace("resolution", "\tresolution"),
            "map info a.yaml",
            &["a.yaml: line 2, column 1: the line begins with a tab"],
        ),
        (
            "a.map",
            "type octile\n".into(),
            "map info a.map",
            &["a.map: line 1: got the end of the file"],
        ),
        (
            "a.scen",
            "version 3\n".into(),
            "bench grid a.scen",
            &["a.scen: line 1: the version is \"3\""],
        ),
        (
            "a.csv",
            "1,2,3,x\n".into(),
            "compare walled.map --pairs a.csv",
            &["a.csv: line 1: the goal_y_m is `x`"],
        ),
        (
            "a.csv",
            "1,2,3\n".into(),
            "compare walled.map --pairs a.csv",
            &["a.csv: line 1: 3 values"],
        ),
        (
            "a.toml",
            "version = 1\nmap = \"walled.map\"\n".into(),
            "navigate --scene a.toml",
            &["a.toml", "`start`"],
        ),
        ("a.toml", "version = 1.5\n".into(), "navigate --scene a.toml", &["`version` is 1.5"]),
        (
            "a.toml",
            "cycle_s = true\n".into(),
            "list dwa --robot a.toml",
            &["boolean `true`, expected a number"],
        ),
        (
            "a.prepared",
            "x".into(),
            &format!("{PLAN} --prepared a.prepared"),
            &["not a prepared map"],
        ),
    ] {
        write(&folder, name, &text);
        refused(&folder, line, parts);
        fs::write(folder.path().join(name), b"version 1\n\xff\n").unwrap();
        refused(&folder, line, &[name]);
        fs::remove_file(folder.path().join(name)).unwrap();
        refused(&folder, line, &[name, "there is no such file or folder"]);
        fs::create_dir(folder.path().join(name)).unwrap();
        refused(&folder, line, &[name, "it is a folder, expected a file"]);
        fs::remove_dir(folder.path().join(name)).unwrap();
    }
}

/// Size and speed are sufficient, or a base robot; the message names both alternatives at once.
#[test]
fn what_a_robot_file_needs_is_named() {
    let folder = folder();
    write(&folder, "a.toml", "cycle_s = 0.1\n");
    let parts =
        ["a.toml: the robot needs `footprint`, or the `radius_m`", "and `v_max_mps`", "`like = "];
    refused(&folder, "list dwa --robot a.toml", &parts);
    write(&folder, "b.toml", "like = \"small\"\n[[sensors]]\nbeams = 9\n");
    refused(
        &folder,
        "list dwa --robot b.toml",
        &["b.toml: line 2", "missing field `field_of_view_deg`"],
    );
    write(&folder, "c.toml", "like = \"smal\"\n");
    refused(
        &folder,
        "list dwa --robot c.toml",
        &["c.toml: like must be a bundled robot (small, ", "got `smal`"],
    );
}

/// A device without end, and pipes, which do not report their size.
#[cfg(target_os = "linux")]
#[test]
fn no_reader_reads_without_end() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    for name in ["zero.png", "zero.map", "zero.yaml", "zero.scen"] {
        symlink("/dev/zero", folder.path().join(name)).unwrap();
    }
    let least = "it is larger than the limit of";
    for (line, limit) in [
        (format!("{PLAN} --config /dev/zero"), "16 MiB"),
        (format!("{PLAN} --prepared /dev/zero"), "256 MiB"),
        (format!("{PLAN} --curve a.csv --robot /dev/zero"), "16 MiB"),
        ("list dwa --robot /dev/zero".to_owned(), "16 MiB"),
        ("navigate --scene /dev/zero".to_owned(), "16 MiB"),
        ("compare walled.map --pairs /dev/zero".to_owned(), "256 MiB"),
        ("compare walled.map --scen zero.scen".to_owned(), "256 MiB"),
        ("map info zero.yaml".to_owned(), "1 MiB"),
        ("map info zero.map".to_owned(), "256 MiB"),
        ("map info zero.png".to_owned(), "256 MiB"),
    ] {
        refused(&folder, &line, &[&format!("{least} {limit}")]);
    }
}

/// Pipes, as in `--config <(...)`.
#[cfg(target_os = "linux")]
#[test]
fn pipes_are_read() {
    use std::io::Write;
    use std::process::{Command, Stdio};
    let folder = folder();
    let scene = read(&folder, "small_house.toml").replace("small_house.yaml", "nowhere.yaml");
    let pairs = "1.5,0.5,5.5,0.5\n";
    for (line, text, code, part) in [
        (format!("{PLAN} --config /dev/stdin"), "[planner]\nname = \"astar\"\n", 0, "astar"),
        ("compare walled.map --pairs /dev/stdin".to_owned(), pairs, 0, "jps"),
        ("navigate --scene /dev/stdin".to_owned(), &scene, 2, "nowhere.yaml"),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_keyway"));
        command.args(line.split_whitespace()).current_dir(folder.path());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut run = command.spawn().unwrap();
        run.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = run.wait_with_output().unwrap();
        let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}: {said}");
        assert!(said.contains(part), "{line}: {said}");
    }
}

/// The check comes before any computation: the start is in a wall, which only the search detects.
#[cfg(target_os = "linux")]
#[test]
fn outputs_that_cannot_be_written_are_found_first() {
    let folder = folder();
    let wall = PLAN.replace("1.5,0.5", "3.5,1.5");
    for (line, flag) in [
        (wall.clone(), "--picture /proc/a.svg"),
        (wall.clone(), "--animate /proc/a.gif"),
        (wall.clone(), "--curve /proc/a.csv"),
        (wall.clone(), "--curve walled.map/a.csv"),
        ("navigate walled.map --start 3.5,1.5 --goal 5.5,2.5".into(), "--out /proc/run"),
        ("navigate walled.map --start 3.5,1.5 --goal 5.5,2.5".into(), "--out walled.map/run"),
        ("compare nowhere.map".into(), "--out /proc/run"),
        ("bench scale walled.map --sides 16".into(), "--out /proc/run"),
        ("prepare walled.map".into(), "--out /proc/a.prepared"),
        ("map convert walled.map".into(), "/proc/a.yaml"),
        ("demo".into(), "--out /proc/demo"),
    ] {
        let line = format!("{line} {flag}");
        let json = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        assert_eq!(json["kind"], "output", "{line}: {json}");
        let err = refused(&folder, &line, &[]);
        assert!(err.contains("cannot write") || err.contains("is not a folder"), "{line}: {err}");
    }
}

/// In metres these lengths exceed any map: a computation that scales with them would take
/// minutes.
#[test]
fn lengths_in_millimetres_are_answered() {
    let folder = folder();
    let rooms = "plan rooms.map --start 1.5,1.5 --goal 30.5,30.5";
    for (line, parts) in [
        (
            format!("{rooms} --radius 4000"),
            &["a radius of 4000 m", "32.000 x 32.000 m", "millimetres"][..],
        ),
        (format!("{rooms} --radius 100000"), &["a radius of 100000 m", "millimetres"]),
        ("prepare rooms.map --out a --radius 4000".into(), &["millimetres"]),
        ("compare rooms.map --radius 4000".into(), &["millimetres"]),
        ("bench grid rooms.map.scen --set map.clearance_m=4000".into(), &["millimetres"]),
        ("bench scale rooms.map --sides 64 --set map.clearance_m=4000".into(), &["millimetres"]),
        (
            "navigate --scene small_house.toml --radius 180".into(),
            &["a radius of 180 m", "millimetres"],
        ),
        (
            format!("{rooms} --set map.published.expansion_cells=100000"),
            &["expansion_cells is 100000"],
        ),
        (format!("{rooms} --set map.published.l1_constraint=100000"), &["l1_constraint is 100000"]),
    ] {
        refused(&folder, &line, parts);
    }
    let ends = "--set map.published.expansion_cells=100000 --set map.free_ends_m=100000";
    keyway(folder.path(), &format!("{rooms} {ends}")).expect_code(0);
    for setting in [
        "key-points --set smoother.safe_distance_m=100000",
        "hierarchical --set smoother.safe_distance_m=100000",
        "bidirectional --set smoother.safety_distance_cells=100000",
        "shortcut --set smoother.expansion_cells=100000",
    ] {
        keyway(folder.path(), &format!("{rooms} --smoother {setting}"));
    }
}
