//! Several robots in one world: a scene with `[[robots]]`.

use super::drive::bad_input;
use super::episode::{Given, given};
use super::result_files::{COLUMNS, FILES, prepared};
use super::{Wanted, warn_of_those_left_out, watch::Watcher};
use crate::args::{DriveFileArgs, Format, NavigateArgs};
use crate::commands::Done;
use crate::error::{CliError, Kind};
use crate::out_file::write_animation;
use crate::pictures::{png, trajectory_point};
use crate::report_text::WithFiles;
use crate::stdout::print_files;
use crate::team_pictures::TeamPicture;
use keyway_lab::measure::wall_clock;
use keyway_lab::results::OutDir;
pub(crate) use keyway_lab::run_tables::team_table as table;
use keyway_sim::episode::{
    Episode, EpisodeError, EpisodeOutcome, EpisodeReport, RobotReport, RunOptions, watch_episode,
};
use keyway_sim::parallel::processors;
use keyway_sim::scene_files::SceneFile;
use keyway_sim::sim::{MovingObstacle, TrajectoryPoint};
use std::fmt::Write as _;

/// Drives all robots of a scene.
pub(super) fn run(args: &NavigateArgs, scene: &SceneFile) -> Result<Done, CliError> {
    refuse_what_is_for_one(&args.files)?;
    let Given { episode: team, sources } = given(args, Some(scene))?;
    warn_of_those_left_out(team.random);
    let out = prepared(&args.files, &sources)?;
    let report = drive(&team)?;
    let files = write_all(&args.files, &team, &report, out)?;
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &report, files: &files })?,
        Format::Table => {
            crate::commands::print(&table(&report))?;
            print_files(&files)?;
        }
    }
    let is_reached = |&outcome: &EpisodeOutcome| outcome == EpisodeOutcome::Reached;
    Ok(Done::when(report.outcomes.iter().all(is_reached)))
}

/// Writes the requested files and returns their paths.
pub(crate) fn write_all(
    args: &DriveFileArgs,
    team: &Episode,
    report: &EpisodeReport,
    out: Option<OutDir>,
) -> Result<Vec<String>, CliError> {
    let driven: Vec<Vec<TrajectoryPoint>> = report.robots.iter().map(points).collect();
    let movers = moved(team, report);
    let picture = TeamPicture { team, driven: &driven, movers: &movers };
    let mut files = Vec::new();
    if let Some(out) = &out {
        files.extend(written(report).iter().map(|name| out.path(name).display().to_string()));
    }
    let animate = args.animate.as_ref().filter(|_| has_run(report));
    files.extend(animate.map(|file| file.path.display().to_string()));
    if let Some(mut out) = out {
        write_files(&picture, report, &files, &mut out)?;
        out.finish()?;
    }
    if let Some(file) = animate {
        write_animation(file, "--animate", |progress| picture.animation(progress))?;
    }
    Ok(files)
}

/// Refuses outputs that show the decisions of a single robot.
pub(crate) fn refuse_what_is_for_one(args: &DriveFileArgs) -> Result<(), CliError> {
    let given = [
        ("--fan", args.fan.is_some()),
        ("--explain", args.explain.is_some()),
        ("--record", args.record.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let message = format!(
                "{option} shows the decisions of a single robot, but the scene has `[[robots]]`; drive one of them alone, \
                 in a scene with its `start` and `goal`"
            );
            Err(CliError::new(Kind::Usage, message).field(option))
        }
        None => Ok(()),
    }
}

pub(crate) fn drive(team: &Episode) -> Result<EpisodeReport, CliError> {
    let mut watchers: Vec<Watcher> =
        team.robots.iter().map(|_| Watcher::new(Wanted::default())).collect();
    let clock = wall_clock();
    let options =
        RunOptions { clock: Some(&clock), threads: processors(), ..RunOptions::default() };
    let mut report = watch_episode(team, options, &mut watchers).map_err(|error| blame(&error))?;
    for (robot, Watcher { why, .. }) in report.robots.iter_mut().zip(watchers) {
        if why.is_some() {
            robot.plan.why.clone_from(&why);
            robot.reason = why;
        }
    }
    Ok(report)
}

/// Moving obstacles, as they moved until the last run ended.
fn moved(team: &Episode, report: &EpisodeReport) -> Vec<MovingObstacle> {
    let runs = report.robots.iter().filter_map(|robot| robot.run.as_ref());
    let last = runs.max_by_key(|run| run.cycles);
    last.map_or_else(|| team.movers.clone(), |run| run.movers(&team.movers))
}

/// Converts an error; that of a single robot names its table in the scene.
fn blame(error: &EpisodeError) -> CliError {
    let CliError { kind, message, field } = bad_input(&error.why);
    let Some(index) = error.robot else { return CliError { kind, message, field } };
    let in_scene = |field: String| match field.as_str() {
        "--start" | "--goal" | "--via" => field.replace("--", &format!("robots[{index}].")),
        _ => field,
    };
    let message = format!("robot {index}: {message}");
    CliError { kind, message, field: field.map(in_scene) }
}

fn points(report: &RobotReport) -> Vec<TrajectoryPoint> {
    report.trajectory.iter().flatten().map(trajectory_point).collect()
}

fn has_run(report: &EpisodeReport) -> bool {
    report.robots.iter().any(|robot| robot.run.is_some())
}

/// Names of the files that [`write_files`] will write.
fn written(report: &EpisodeReport) -> &'static [&'static str] {
    &FILES[..if has_run(report) { 6 } else { 3 }]
}

fn write_files(
    picture: &TeamPicture<'_>,
    report: &EpisodeReport,
    files: &[String],
    out: &mut OutDir,
) -> Result<(), CliError> {
    let [report_json, map_svg, map_png, speed, speed_png, trajectory_csv, ..] = FILES;
    let text = crate::json::to_string(&WithFiles { report, files });
    out.write(report_json, text.as_bytes())?;
    let svg = picture.svg();
    out.write(map_svg, svg.as_str().as_bytes())?;
    out.write(map_png, &png(&svg)?)?;
    if has_run(report) {
        let svg = picture.speed_svg();
        out.write(speed, svg.as_str().as_bytes())?;
        out.write(speed_png, &png(&svg)?)?;
        out.write(trajectory_csv, csv(report).as_bytes())?;
    }
    Ok(())
}

/// The trajectories of all robots, one after the other.
fn csv(report: &EpisodeReport) -> String {
    let mut text = format!("robot,{COLUMNS}\n");
    for (index, robot) in report.robots.iter().enumerate() {
        for [t, x, y, yaw, v, omega] in robot.trajectory.iter().flatten() {
            let _ = writeln!(text, "{index},{t},{x},{y},{yaw},{v},{omega}");
        }
    }
    text
}
