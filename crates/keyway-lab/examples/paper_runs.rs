//! Every driving scene of the papers with every stack: the outcome of each run, its time, the
//! driven distance, and the least clearance.
//!
//! `cargo run --release -p keyway-lab --example paper_runs -- scenes runs.json`
//! prints the tables of docs/lab/findings.md, and writes the measurements of each run to the file,
//! which may be omitted.

use keyway::files::find_robot;
use keyway::map::formats::read_map;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeOutcome, EpisodeReport, RobotReport, run_episode};
use keyway_sim::report::RunPart;
use keyway_sim::scene_files::{SceneFile, read_scene};
use serde::Serialize;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Folders of the scenes, by paper.
const PAPERS: [&str; 3] = ["you2021", "s1", "zhuyin2024"];

/// One run.
#[derive(Serialize)]
struct Row {
    scene: String,
    stack: &'static str,
    as_published: bool,
    /// Outcome; `None` if the run was refused.
    outcome: Option<EpisodeOutcome>,
    /// Reason why the goal was not reached.
    reason: Option<String>,
    run: Option<RunPart>,
}

/// A scene of a paper, ready to be driven.
struct Scene {
    name: String,
    file: SceneFile,
    path: PathBuf,
    robot: Robot,
}

impl Scene {
    fn read(path: PathBuf) -> Result<Self, Box<dyn Error>> {
        let file = read_scene(&path)?;
        let robot = find_robot(&file.robot, folder_of(&path))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, file, path, robot })
    }

    fn drive(&self, name: &'static str, as_published: bool) -> Result<Option<Row>, Box<dyn Error>> {
        let stack = if as_published {
            Stack::published_by_name(name)
        } else {
            Stack::by_name(name, &self.robot)
        };
        let Some(stack) = stack else { return Ok(None) };
        let map = self.file.map.as_ref().ok_or("the scenes of the papers have map files")?;
        let map = read_map(&folder_of(&self.path).join(map), None)?;
        let episode: Episode = self.file.episode_with(map, &self.robot, &stack)?;
        let (outcome, reason, run) = match run_episode(&episode).map(EpisodeReport::first) {
            Ok(RobotReport { outcome, reason, run, .. }) => (Some(outcome), reason, run),
            Err(error) => (None, Some(error.to_string()), None),
        };
        Ok(Some(Row { scene: self.name.clone(), stack: name, as_published, outcome, reason, run }))
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn read_scenes(folder: &Path) -> Result<Vec<Scene>, Box<dyn Error>> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    paths.into_iter().map(Scene::read).collect()
}

/// Result of a run, as a cell of a table.
fn cell(row: &Row) -> String {
    let Some(outcome) = row.outcome else { return "refused".to_owned() };
    let Some(run) = &row.run else { return "no path".to_owned() };
    let clearance = run.min_clearance_m.map_or_else(|| "-".to_owned(), |m| format!("{m:.2} m"));
    let figures = format!("{:.1} s, {:.1} m, {clearance}", run.time_s, run.length_m);
    match (outcome, &run.contact) {
        (EpisodeOutcome::Reached, _) => figures,
        (_, Some(contact)) if contact.robot_stood => format!("run into at {:.1} s", run.time_s),
        (_, Some(_)) => format!("contact at {:.1} s", run.time_s),
        (_, None) => format!("{} at {:.1} s", outcome.name(), run.time_s),
    }
}

/// True if the moving robot hit something: a moving obstacle may also hit a stationary robot.
fn touched_something(row: &Row) -> bool {
    let contact = row.run.as_ref().and_then(|run| run.contact.as_ref());
    contact.is_some_and(|contact| !contact.robot_stood)
}

/// A row for each scene, a column for each stack.
fn print_table(title: &str, scenes: &[Scene], rows: &[Row]) {
    let is_there = |stack: &&str| rows.iter().any(|row| row.stack == *stack);
    let stacks: Vec<&str> = Stack::NAMES.into_iter().filter(is_there).collect();
    println!("{title}, by scene:\n");
    println!("| scene | {} |", stacks.join(" | "));
    println!("|---|{}", "--:|".repeat(stacks.len()));
    for Scene { name, .. } in scenes {
        let of = |stack: &&str| {
            let row = rows.iter().find(|row| row.stack == *stack && row.scene == *name);
            row.map_or_else(|| "-".to_owned(), cell)
        };
        println!("| {name} | {} |", stacks.iter().map(of).collect::<Vec<_>>().join(" | "));
    }
    let count = |is: &dyn Fn(&Row) -> bool| -> String {
        let of = |stack: &&str| rows.iter().filter(|row| row.stack == *stack && is(row)).count();
        let counts = stacks.iter().map(of);
        counts.map(|count| format!("{count} of {}", scenes.len())).collect::<Vec<_>>().join(" | ")
    };
    println!("| reached | {} |", count(&|row| row.outcome == Some(EpisodeOutcome::Reached)));
    println!("| contact while driving | {} |", count(&touched_something));
    println!();
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("expected the folder of the scenes: `scenes`")?;
    let mut all = Vec::new();
    for (title, as_published) in [("As published", true), ("For the scene's robot", false)] {
        let mut scenes = Vec::new();
        for paper in PAPERS {
            scenes.extend(read_scenes(&Path::new(&folder).join(paper))?);
        }
        // The stacks were published with this robot.
        scenes.retain(|scene: &Scene| !as_published || scene.file.robot == "paper");
        let mut rows = Vec::new();
        for (scene, stack) in
            scenes.iter().flat_map(|scene| Stack::NAMES.map(|stack| (scene, stack)))
        {
            rows.extend(scene.drive(stack, as_published)?);
        }
        print_table(title, &scenes, &rows);
        all.extend(rows);
    }
    if let Some(file) = arguments.next() {
        std::fs::write(&file, serde_json::to_string_pretty(&all)?)?;
        println!("wrote {file}");
    }
    Ok(())
}
