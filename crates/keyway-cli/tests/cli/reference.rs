//! The generated pages of the reference are those of this program. After a change of a help text or
//! of a parameter, `KEYWAY_WRITE_REFERENCE=1 cargo test -p keyway-cli --test cli reference` writes
//! them again.

use crate::examples::COMMANDS;
use crate::support::keyway;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

const EXIT_CODES: &str = "\
| exit code | meaning |
|---|---|
| 0 | success |
| 1 | no path, or a goal that was not reached |
| 2 | wrong usage, or input that cannot be used |

With `--format json` every command writes a report with a versioned schema
([reports and files](json.md)), errors included.
";

/// The page as it is written in the repository; a crate on its own has none.
#[track_caller]
fn expect_page(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference").join(name);
    if std::env::var_os("KEYWAY_WRITE_REFERENCE").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let Ok(written) = std::fs::read_to_string(path) else { return };
    let different = written.lines().zip(text.lines()).find(|(written, made)| written != made);
    assert_eq!(different, None, "docs/reference/{name} is not that of this program");
    assert_eq!(written.len(), text.len(), "docs/reference/{name}");
}

#[test]
fn the_page_of_commands_is_that_of_the_help_texts() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = format!(
        "# Commands and exit codes\n\nGenerated from `keyway COMMAND --help`.\n\n{EXIT_CODES}"
    );
    for command in COMMANDS {
        let help = keyway(folder.path(), &format!("{command} --help")).expect_code(0).out;
        let title = format!("keyway {command}");
        let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
        write!(text, "\n## {}\n\n```text\n{}\n```\n", title.trim(), lines.join("\n")).unwrap();
    }
    expect_page("commands.md", &text);
}

/// A value as TOML has it.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        value => format!("`{value}`"),
    }
}

fn table(entry: &Value) -> String {
    let mut text = "| parameter | unit | default | paper | |\n|---|---|---|---|---|\n".to_owned();
    for parameter in entry["parameters"].as_array().unwrap() {
        let description = parameter["description"].as_str().unwrap_or_default();
        let choices = parameter["choices"].as_array().map_or(String::new(), |choices| {
            let names: Vec<String> =
                choices.iter().map(|it| format!("`{}`", text_of(it))).collect();
            format!(" One of {}.", names.join(", "))
        });
        writeln!(
            text,
            "| `{}` | {} | {} | {} | {}{choices} |",
            text_of(&parameter["path"]),
            text_of(&parameter["unit"]),
            shown(&parameter["default"]),
            shown(&parameter["paper"]),
            description.replace('|', "\\|"),
        )
        .unwrap();
    }
    text
}

fn text_of(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

#[test]
fn the_page_of_parameters_is_that_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let list = |name: &str| keyway(folder.path(), &format!("list {name} --format json")).json();
    let all = list("");
    let entries = all["entries"].as_array().unwrap();
    let mut text = "# Parameters\n\nGenerated from `keyway list NAME --format json`. The defaults are \
        those for the robot `small`; `--robot` gives others. The column *paper* holds the published \
        values, which `--as-published` takes.\n"
        .to_owned();
    for kind in ["planner", "smoother", "guide", "local planner"] {
        writeln!(text, "\n## {}{}s", kind[..1].to_uppercase(), &kind[1..]).unwrap();
        for entry in entries.iter().filter(|entry| entry["kind"] == kind) {
            let name = text_of(&entry["name"]);
            writeln!(text, "\n### `{name}`\n\n{}\n", text_of(&entry["summary"])).unwrap();
            let of_name = list(name);
            let parts = of_name["entries"].as_array().unwrap();
            let part = parts.iter().find(|part| part["kind"] == kind).unwrap();
            if part["parameters"].as_array().is_some_and(|all| !all.is_empty()) {
                text.push_str(&table(part));
            } else {
                text.push_str("No parameters.\n");
            }
        }
    }
    let stack = list("keyway");
    let stack = &stack["entries"][0];
    write!(text, "\n## The stack `keyway`\n\n{}\n\n{}", text_of(&stack["summary"]), table(stack))
        .unwrap();
    expect_page("parameters.md", &text);
}
