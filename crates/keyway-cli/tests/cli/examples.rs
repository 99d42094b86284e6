//! Every example in a help text or in the README works.

use crate::support::keyway;
use std::path::Path;

/// All commands; the test below finds out when one is missing.
pub(crate) const COMMANDS: [&str; 27] = [
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
    "pdf",
    "man",
    "completions",
];

fn help(folder: &Path, command: &str) -> String {
    keyway(folder, &format!("{command} --help")).expect_code(0).out
}

/// Runs a line as a shell would that knows `> FILE`.
fn run(folder: &Path, line: &str) {
    let (line, file) = line.split_once(" > ").map_or((line, None), |(line, to)| (line, Some(to)));
    let answer = keyway(folder, line);
    assert_eq!(answer.code, 0, "keyway {line}\n{}{}", answer.out, answer.err);
    if let Some(file) = file {
        std::fs::write(folder.join(file.trim()), answer.out).unwrap();
    }
}

/// A file that examples name, as small as it can be.
fn example_file(name: &str) -> &'static str {
    match name {
        "pairs.csv" => {
            "map,start_x_m,start_y_m,goal_x_m,goal_y_m\n\
             keyway-demo/small_house.yaml,-8.175,-2.825,-4,-2.6\n"
        }
        "noise.toml" => "[actuation]\nv_relative = 0.05\nomega_relative = 0.05\n",
        _ => unreachable!("{name}"),
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
    // The tables of a benchmark, as small as they can be.
    let cylinders = "world,x,y,radius\n0,-2.0,8.0,0.075\n1,-2.5,9.0,0.075\n";
    std::fs::write(folder.path().join("barn_cylinders.csv"), cylinders).unwrap();
    let summary = "world,optimal_time_s\n0,5\n1,5\n";
    std::fs::write(folder.path().join("barn_summary.csv"), summary).unwrap();
    let frames = "plugin,duration_s,t,x,y\na,9,0,5,5\na,9,8,5,-5\n";
    std::fs::write(folder.path().join("dynabarn_keyframes.csv"), frames).unwrap();
    let worlds = "world,plugin,radius\n0,a,0.5\n";
    std::fs::write(folder.path().join("dynabarn_worlds.csv"), worlds).unwrap();
    for name in ["pairs.csv", "noise.toml"] {
        std::fs::write(folder.path().join(name), example_file(name)).unwrap();
    }
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

/// The pages whose commands run here; the others are about ROS, records or files of a reader.
const PAGES: [&str; 8] = [
    "README.md",
    "docs/choosing.md",
    "docs/compare.md",
    "docs/getting-started.md",
    "docs/recipes.md",
    "docs/safety.md",
    "docs/stack.md",
    "docs/your-robot.md",
];

/// The commands of a page's code blocks.
fn fenced_commands(text: &str) -> Vec<String> {
    let blocks = text.split("```").skip(1).step_by(2);
    let lines = blocks.filter_map(|block| block.strip_prefix("sh\n")).flat_map(str::lines);
    let commands = lines.filter_map(|line| line.trim().strip_prefix("keyway "));
    // Text after a `#` is for people.
    commands.map(|line| line.split(" #").next().unwrap().to_owned()).collect()
}

/// The whole commands in the text of a page, between backticks: those with options and without a
/// name to fill in.
fn inline_commands(text: &str) -> Vec<String> {
    let text = text.split("```").step_by(2).collect::<Vec<_>>().join("\n").replace('\n', " ");
    let commands = text.split('`').skip(1).step_by(2).filter_map(|it| it.strip_prefix("keyway "));
    let is_whole = |line: &&str| {
        line.contains(" --")
            && !["NAME", "FILE", "COMMAND", "..."].iter().any(|open| line.contains(open))
    };
    let commands = commands.filter(is_whole);
    commands.map(|line| line.split(" >").next().unwrap().to_owned()).collect()
}

#[test]
fn every_command_of_the_pages_works() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for page in PAGES {
        // The crate on its own has none.
        let Ok(text) = std::fs::read_to_string(root.join(page)) else { return };
        let folder = tempfile::tempdir().unwrap();
        keyway(folder.path(), "demo").expect_code(0);
        for name in ["pairs.csv", "noise.toml"] {
            std::fs::write(folder.path().join(name), example_file(name)).unwrap();
        }
        let (fenced, inline) = (fenced_commands(&text), inline_commands(&text));
        assert!(!fenced.is_empty() || !inline.is_empty(), "{page}");
        for line in fenced.iter().chain(&inline) {
            run(folder.path(), line);
        }
    }
}
