//! `keyway list`: lists the available choices, and the parameters of each.

use super::{Done, print};
use crate::args::{Format, ListArgs};
use crate::error::{CliError, Kind};
use crate::inputs::{DEFAULT_ROBOT, PAPER_ROBOT, published_stack, robot};
use keyway::files::did_you_mean;
use keyway_lab::catalogue::{
    CatalogueEntry, EntryKind, Parameter, PublishedSetup, PublishedUse, StackValues, catalogue,
    robot_entry, value_text,
};
use keyway_lab::table::{facts, paragraph, rows};
use serde::Serialize;
use std::path::Path;

/// `keyway.list/1`.
#[derive(Serialize)]
struct ListReport<'a> {
    schema: &'static str,
    /// The robot that defaults are derived for.
    robot: &'a str,
    entries: Vec<Listed<'a>>,
}

#[derive(Serialize)]
struct Listed<'a> {
    kind: EntryKind,
    name: &'a str,
    summary: &'a str,
    /// `None` if they were not requested.
    parameters: Option<&'a [Parameter]>,
    /// Its uses in the papers; `None` if they were not requested.
    published: Option<Vec<Published>>,
}

/// A method of a paper, as options of the command line.
#[derive(Serialize)]
struct Published {
    source: &'static str,
    method: &'static str,
    /// Options of `keyway plan`; of a local planner or a stack, of `keyway navigate`.
    options: Vec<String>,
}

pub(crate) fn run(args: &ListArgs) -> Result<Done, CliError> {
    let usual = if args.as_published { PAPER_ROBOT } else { DEFAULT_ROBOT };
    let robot_name = args.robot.as_deref().unwrap_or(usual);
    let values = if args.as_published { StackValues::AsPublished } else { StackValues::ForRobot };
    let mut entries = catalogue(&robot(robot_name, Path::new(""))?, values);
    let is_file = |name: &&String| Path::new(name).extension().is_some_and(|kind| kind == "toml");
    if let Some(file) = args.name.as_ref().filter(is_file) {
        let own = robot(file, Path::new("")).map_err(|error| error.field("NAME"))?;
        entries = vec![robot_entry(file, &own)];
    } else if let Some(name) = &args.name {
        let known: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
        if !known.contains(&name.as_str()) {
            let meant = did_you_mean(name, known.iter().copied());
            let known = known.join(", ");
            let message = format!("there is no entry `{name}`, expected one of {known}{meant}");
            return Err(CliError::new(Kind::Usage, message).field("NAME"));
        }
        entries.retain(|entry| &entry.name == name);
    }
    if let Some(name) = args.name.as_ref().filter(|_| args.as_published) {
        published_stack(name).map_err(|error| error.field("NAME"))?;
    }
    let is_whole = args.name.is_some();
    match args.format {
        Format::Json => {
            let entries = entries.iter().map(|entry| listed(entry, is_whole)).collect();
            let report = ListReport { schema: "keyway.list/1", robot: robot_name, entries };
            crate::json::print(&report)?;
        }
        Format::Table if is_whole => {
            entries.iter().try_for_each(|entry| show(entry, robot_name))?;
        }
        Format::Table => show_names(&entries)?,
    }
    Ok(Done::Success)
}

fn listed(entry: &CatalogueEntry, is_whole: bool) -> Listed<'_> {
    Listed {
        kind: entry.kind,
        name: &entry.name,
        summary: &entry.summary,
        parameters: is_whole.then_some(&entry.parameters),
        published: is_whole.then(|| entry.published.iter().map(published).collect()),
    }
}

fn published(&PublishedUse { source, method, setup }: &PublishedUse) -> Published {
    let (mut options, set) = match setup {
        PublishedSetup::Plan { planner, smoother, set } => {
            (vec![format!("--planner {planner}"), format!("--smoother {smoother}")], set)
        }
        PublishedSetup::Drive { stack, set } => {
            (vec![format!("--stack {stack}"), "--as-published".to_owned()], set)
        }
    };
    options.extend(set.iter().map(|set| format!("--set {set}")));
    Published { source, method, options }
}

fn show_names(entries: &[CatalogueEntry]) -> Result<(), CliError> {
    let row =
        |e: &CatalogueEntry| vec![e.kind.name().to_owned(), e.name.clone(), e.summary.clone()];
    print(&rows(&["kind", "name", "description"], entries.iter().map(row).collect(), 3))?;
    print("\n`keyway list NAME` prints the parameters of an entry.")
}

fn show(entry: &CatalogueEntry, robot: &str) -> Result<(), CliError> {
    if let Some(file) = &entry.file {
        return print(file.trim_end());
    }
    let head = format!("{} ({}): {}", entry.name, entry.kind.name(), entry.summary);
    print(&paragraph(&head))?;
    if entry.parameters.is_empty() {
        print("\nNo parameters.")?;
    } else {
        show_parameters(entry, robot)?;
    }
    show_published(entry)
}

fn show_parameters(entry: &CatalogueEntry, robot: &str) -> Result<(), CliError> {
    let default = format!("default for {robot}");
    let value = if entry.kind.depends_on_robot() { default.as_str() } else { "value" };
    let row = |p: &Parameter| {
        let paper = p.paper.as_ref().map_or_else(|| "-".to_owned(), value_text);
        vec![p.path.clone(), p.unit.unwrap_or("-").to_owned(), value_text(&p.default), paper]
    };
    let (header, parameters) = (["parameter", "unit", value, "paper"], entry.parameters.iter());
    print(&format!("\n{}", rows(&header, parameters.clone().map(row).collect(), 2)))?;
    print(&format!(
        "\n{}",
        facts(parameters.map(|p| (p.path.as_str(), p.description_with_choices())))
    ))
}

/// Prints the methods of the papers, each as a line of options.
fn show_published(entry: &CatalogueEntry) -> Result<(), CliError> {
    if entry.published.is_empty() {
        return Ok(());
    }
    let command = if entry.kind == EntryKind::LocalPlanner { "navigate" } else { "plan" };
    print(&format!("\nMethods of the papers (docs/papers.md), as options of `keyway {command}`:"))?;
    for Published { source, method, options } in entry.published.iter().map(published) {
        print(&format!("  [{source}] {method}:\n    {}", options.join(" ")))?;
    }
    Ok(())
}
