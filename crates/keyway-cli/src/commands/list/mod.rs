//! `keyway list`: what there is to choose from, and the parameters of each choice.

mod catalogue;
mod file;
mod parameters;
mod published;

use super::{Done, print};
use crate::args::{Format, ListArgs};
use crate::error::{CliError, Kind};
use crate::inputs::{DEFAULT_ROBOT, PAPER_ROBOT, published_stack, robot};
use catalogue::{Entry, EntryKind, catalogue};
use keyway::files::did_you_mean;
use keyway_lab::table::{facts, paragraph, rows};
use parameters::Parameter;
pub(super) use parameters::plain;
use published::Published;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// `keyway.list/1`.
#[derive(Serialize)]
struct ListReport {
    schema: &'static str,
    /// The robot that defaults are derived for.
    robot: String,
    entries: Vec<Entry>,
}

pub(crate) fn run(args: &ListArgs) -> Result<Done, CliError> {
    let usual = if args.as_published { PAPER_ROBOT } else { DEFAULT_ROBOT };
    let robot_name = args.robot.as_deref().unwrap_or(usual);
    let mut entries = catalogue(&robot(robot_name, Path::new(""))?, args.as_published);
    match &args.name {
        None => entries.iter_mut().for_each(|entry| {
            entry.parameters = None;
            entry.published = None;
        }),
        Some(name) => {
            let known: Vec<&str> = entries.iter().map(|entry| entry.name).collect();
            if !known.contains(&name.as_str()) {
                let meant = did_you_mean(name, known.iter().copied());
                let known = known.join(", ");
                let message =
                    format!("there is nothing named `{name}`, expected one of {known}{meant}");
                return Err(CliError::new(Kind::Usage, message).field("NAME"));
            }
            if args.as_published {
                published_stack(name).map_err(|error| error.field("NAME"))?;
            }
            entries.retain(|entry| entry.name == name);
        }
    }
    let robot = robot_name.to_owned();
    let report = ListReport { schema: "keyway.list/1", robot, entries };
    match args.format {
        Format::Json => crate::json::print(&report)?,
        Format::Table => show(&report)?,
    }
    Ok(Done::Success)
}

fn show(report: &ListReport) -> Result<(), CliError> {
    if report.entries.iter().all(|entry| entry.parameters.is_none()) {
        let row = |e: &Entry| vec![e.kind.name().to_owned(), e.name.to_owned(), e.summary.clone()];
        print(&rows(&["kind", "name", "what it is"], report.entries.iter().map(row).collect(), 3))?;
        print("\n`keyway list NAME` prints the parameters of one.")?;
        return Ok(());
    }
    for entry in &report.entries {
        if let Some(file) = &entry.file {
            print(file.trim_end())?;
            continue;
        }
        let head = format!("{} ({}): {}", entry.name, entry.kind.name(), entry.summary);
        print(&paragraph(&head))?;
        let parameters = entry.parameters.as_deref().unwrap_or_default();
        if parameters.is_empty() {
            print("\nNo parameters.")?;
        } else {
            show_parameters(report, entry, parameters)?;
        }
        show_published(entry)?;
    }
    Ok(())
}

fn show_parameters(
    report: &ListReport,
    entry: &Entry,
    parameters: &[Parameter],
) -> Result<(), CliError> {
    let default = format!("default for {}", report.robot);
    let value = if entry.kind.depends_on_robot() { default.as_str() } else { "value" };
    let row = |p: &Parameter| {
        let paper = p.paper.as_ref().map_or_else(|| "-".to_owned(), value_text);
        vec![p.path.clone(), p.unit.unwrap_or("-").to_owned(), value_text(&p.default), paper]
    };
    let header = ["parameter", "unit", value, "paper"];
    print(&format!("\n{}", rows(&header, parameters.iter().map(row).collect(), 2)))?;
    print(&format!(
        "\n{}",
        facts(parameters.iter().map(|p| (p.path.as_str(), p.description_with_choices())))
    ))
}

/// The methods of the papers, each as a line of options to paste.
fn show_published(entry: &Entry) -> Result<(), CliError> {
    let published = entry.published.as_deref().unwrap_or_default();
    if published.is_empty() {
        return Ok(());
    }
    let command = if entry.kind == EntryKind::LocalPlanner { "navigate" } else { "plan" };
    print(&format!("\nIn the papers (docs/PAPERS.md), as options of `keyway {command}`:"))?;
    for Published { source, method, options } in published {
        print(&format!("  [{source}] {method}:\n    {}", options.join(" ")))?;
    }
    Ok(())
}

/// Enough digits for people.
fn value_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or_default();
            format!("{}", (number * 1e6).round() / 1e6)
        }
        other => other.to_string(),
    }
}
