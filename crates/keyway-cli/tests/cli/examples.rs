//! Tests that every example in a help text or in the README works.

use crate::support::keyway;
use std::path::Path;

/// All commands; the test below fails if one is missing.
pub(crate) const COMMANDS: [&str; 25] = [
    "",
    "demo",
    "plan",
    "prepare",
    "navigate",
    "compare",
    "bench",
    "bench grid",
    "bench scale",
    "map",
    "map info",
    "map convert",
    "scene",
    "scene barn",
    "scene dynabarn",
    "scene narrow",
    "scene pairs",
    "scene papers",
    "scene schema",
    "batch",
    "batch merge",
    "replay",
    "reproduce",
    "list",
    "completions",
];

fn help(folder: &Path, command: &str) -> String {
    keyway(folder, &format!("{command} --help")).expect_code(0).out
}

/// Runs a line like a shell that supports `> FILE`.
fn run(folder: &Path, line: &str) {
    let (line, file) = line.split_once(" > ").map_or((line, None), |(line, to)| (line, Some(to)));
    let answer = keyway(folder, line);
    assert_eq!(answer.code, 0, "keyway {line}\n{}{}", answer.out, answer.err);
    if let Some(file) = file {
        std::fs::write(folder.join(file.trim()), answer.out).unwrap();
    }
}

#[test]
fn every_command_is_known_here() {
    let folder = tempfile::tempdir().unwrap();
    for command in COMMANDS {
        let text = help(folder.path(), command);
        let Some((_, rest)) = text.split_once("Commands:\n") else { continue };
        let lines = rest.lines().take_while(|line| !line.is_empty());
        for name in lines.filter_map(|line| line.split_whitespace().next()) {
            let full = format!("{command} {name}");
            assert!(name == "help" || COMMANDS.contains(&full.trim()), "{full}");
        }
    }
}

#[test]
fn every_help_text_has_examples_that_work() {
    let folder = tempfile::tempdir().unwrap();
    keyway(folder.path(), "demo").expect_code(0);
    // Tables of a benchmark, of minimal size.
    let cylinders = "world,x,y,radius\n0,-2.0,8.0,0.075\n1,-2.5,9.0,0.075\n";
    std::fs::write(folder.path().join("barn_cylinders.csv"), cylinders).unwrap();
    let summary = "world,optimal_time_s\n0,5\n1,5\n";
    std::fs::write(folder.path().join("barn_summary.csv"), summary).unwrap();
    let frames = "plugin,duration_s,t,x,y\na,9,0,5,5\na,9,8,5,-5\n";
    std::fs::write(folder.path().join("dynabarn_keyframes.csv"), frames).unwrap();
    let worlds = "world,plugin,radius\n0,a,0.5\n";
    std::fs::write(folder.path().join("dynabarn_worlds.csv"), worlds).unwrap();
    let pairs = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\n\
                 keyway-demo/small_house.yaml,-8.175,-2.825,-4,-2.6\n";
    std::fs::write(folder.path().join("pairs.csv"), pairs).unwrap();
    let noise = "[actuation]\nv_relative = 0.05\nomega_relative = 0.05\n";
    std::fs::write(folder.path().join("noise.toml"), noise).unwrap();
    for command in COMMANDS {
        let text = help(folder.path(), command);
        let (_, examples) = text.split_once("Examples:\n").unwrap_or_else(|| panic!("{text}"));
        let lines: Vec<&str> =
            examples.lines().filter_map(|line| line.strip_prefix("  keyway ")).collect();
        assert!(!lines.is_empty(), "{text}");
        for line in lines {
            run(folder.path(), line);
        }
    }
}

/// Commands in backticks in the text of a page; a flag or a name alone does not count.
fn inline_commands(text: &str) -> Vec<String> {
    let text = text.replace('\n', " ");
    let spans = text.split('`').skip(1).step_by(2);
    let commands =
        spans.filter_map(|span| span.strip_prefix("keyway ")).filter(|line| !line.contains("NAME"));
    commands.map(|line| line.split(" >").next().unwrap().to_owned()).collect()
}

#[test]
fn every_command_on_the_page_of_the_stack_works() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/stack.md");
    let Ok(text) = std::fs::read_to_string(page) else { return };
    let folder = tempfile::tempdir().unwrap();
    keyway(folder.path(), "demo").expect_code(0);
    let commands = inline_commands(&text);
    assert!(commands.len() >= 2, "{commands:?}");
    for line in commands.iter().filter(|line| *line != "batch") {
        run(folder.path(), line);
    }
}

#[test]
fn every_command_in_the_readme_works() {
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    // The published crate has no README of the repository.
    let Ok(text) = std::fs::read_to_string(readme) else { return };
    let folder = tempfile::tempdir().unwrap();
    keyway(folder.path(), "demo").expect_code(0);
    let mut is_fenced = false;
    for line in text.lines() {
        is_fenced ^= line.starts_with("```");
        let line = line.trim().trim_start_matches("$ ");
        if let Some(line) = line.strip_prefix("keyway ").filter(|_| is_fenced) {
            // Text after a `#` is a comment for readers.
            let line = line.split(" #").next().unwrap();
            run(folder.path(), line);
        }
    }
}
