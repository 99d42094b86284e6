//! The output files of a run.

use super::Wanted;
use super::drive::{Drive, Driven};
use crate::args::DriveFileArgs;
use crate::drive_pictures::Stage;
use crate::error::CliError;
use crate::inputs::{refuse_to_replace_a_source, refuse_unwritable};
use crate::out_dir::prepare;
use crate::out_file::{write_animation, write_file};
use crate::pictures::{DrivenPicture, RunPicture, png, speed_svg, trajectory_point};
use crate::report_text::WithFiles;
use keyway_lab::results::OutDir;
use keyway_sim::episode::{Episode, EpisodeOutcome};
use keyway_sim::sim::{MovingObstacle, TrajectoryPoint};
use std::fmt::Write as _;
use std::path::PathBuf;

const EXPLAIN: &str = "--explain";
const ANIMATE: &str = "--animate";
const RECORD: &str = "--record";
const FAN: &str = "--fan";

/// Names of all files that [`write_files`] may write.
pub(crate) const FILES: [&str; 8] = [
    "report.json",
    "map.svg",
    "map.png",
    "speed.svg",
    "speed.png",
    "trajectory.csv",
    "fan.svg",
    "fan.png",
];

/// Columns of a trajectory.
pub(super) const COLUMNS: &str = "t_s,x_m,y_m,yaw_rad,v_mps,omega_radps";

/// Names of the files that [`write_files`] will write.
pub(crate) fn written(driven: &Driven) -> Vec<&'static str> {
    let count = match &driven.drive {
        Some(Drive { fan: Some(_), .. }) => FILES.len(),
        Some(_) => 6,
        None => 3,
    };
    FILES[..count].to_vec()
}

/// The data of a run needed for the requested files.
pub(crate) const fn wanted(args: &DriveFileArgs) -> Wanted {
    Wanted {
        explanations: args.explain.is_some(),
        fan_s: args.fan,
        film: args.animate.is_some(),
        recording: args.record.is_some(),
    }
}

/// Prepares the result folder, if one was requested. Refuses outputs that would replace an input
/// file or cannot be written.
pub(crate) fn prepared(
    args: &DriveFileArgs,
    sources: &[PathBuf],
) -> Result<Option<OutDir>, CliError> {
    let explain = args.explain.as_ref().map(|path| (path, EXPLAIN));
    let animate = args.animate.as_ref().map(|file| (&file.path, ANIMATE));
    let record = args.record.as_ref().map(|path| (path, RECORD));
    for (path, field) in explain.into_iter().chain(animate).chain(record) {
        refuse_to_replace_a_source(sources, path, field)?;
        // The result folder and its parents may be created by this run.
        let folder = path.parent().filter(|folder| !folder.exists());
        let is_made = |folder| args.out.iter().any(|out| out.ancestors().any(|it| it == folder));
        if !folder.is_some_and(is_made) {
            refuse_unwritable(path, field)?;
        }
    }
    args.out.as_ref().map(|folder| prepare(folder, &FILES)).transpose()
}

/// Writes all requested files and returns their paths.
pub(crate) fn write_all(
    args: &DriveFileArgs,
    episode: &Episode,
    driven: &Driven,
    out: Option<OutDir>,
) -> Result<Vec<String>, CliError> {
    warn_without_a_run(args, driven);
    warn_without_a_fan(args, driven);
    let mut files = Vec::new();
    if let Some(out) = &out {
        let names = written(driven).into_iter();
        files.extend(names.map(|name| out.path(name).display().to_string()));
    }
    files.extend(own_files(args, driven));
    let mut out = out;
    if let Some(out) = &mut out {
        write_files(episode, driven, &files, out)?;
    }
    write_own_files(args, episode, driven)?;
    out.map(OutDir::finish).transpose()?;
    Ok(files)
}

/// Warns of requested files that are not written, because there was no run.
fn warn_without_a_run(args: &DriveFileArgs, driven: &Driven) {
    if driven.drive.is_some() {
        return;
    }
    let given = [
        (EXPLAIN, args.explain.is_some()),
        (ANIMATE, args.animate.is_some()),
        (RECORD, args.record.is_some()),
        (FAN, args.fan.is_some()),
    ];
    for (option, _) in given.into_iter().filter(|&(_, is_given)| is_given) {
        crate::stdout::warn(format!(
            "{option}: no file was written, because the robot did not start"
        ));
    }
}

/// Warns if the run ended before the requested time of the candidate picture.
fn warn_without_a_fan(args: &DriveFileArgs, driven: &Driven) {
    if let (Some(fan_s), Some(Drive { fan: None, .. })) = (args.fan, &driven.drive) {
        let time_s = driven.report.run.as_ref().map_or(0.0, |run| run.time_s);
        let message = format!(
            "{FAN} {fan_s}: no candidates were drawn, because the run ended after {time_s:.1} s"
        );
        crate::stdout::warn(message);
    }
}

/// Paths of the files that [`write_own_files`] will write.
fn own_files(args: &DriveFileArgs, driven: &Driven) -> Vec<String> {
    let animate = args.animate.iter().map(|file| &file.path);
    let files = args.explain.iter().chain(animate).chain(&args.record);
    let files = files.filter(|_| driven.drive.is_some());
    files.map(|path| path.display().to_string()).collect()
}

/// Writes the files with names of their own. Without a run nothing is written; files of an
/// earlier run are kept.
fn write_own_files(
    args: &DriveFileArgs,
    episode: &Episode,
    driven: &Driven,
) -> Result<(), CliError> {
    let Some(drive) = &driven.drive else { return Ok(()) };
    if let Some(path) = &args.explain {
        write_file(path, drive.explanations.as_bytes(), EXPLAIN)?;
    }
    if let Some(file) = &args.animate {
        let points = points(driven);
        let stage = stage(episode, &driven.movers);
        write_animation(file, ANIMATE, |progress| {
            stage.animation(&drive.moments, &points, progress)
        })?;
    }
    if let (Some(path), Some(bytes)) = (&args.record, &drive.recording) {
        write_file(path, bytes, RECORD)?;
    }
    Ok(())
}

fn stage<'a>(episode: &'a Episode, movers: &'a [MovingObstacle]) -> Stage<'a> {
    let robot = &episode.robots[0];
    Stage {
        map: &episode.known,
        robot: &robot.robot,
        obstacles: episode.obstacles.as_slice(),
        polygons: episode.polygons.as_slice(),
        hidden_cells: episode.hidden_cells.as_slice(),
        absent_cells: episode.absent_cells.as_slice(),
        elusive: episode.elusive.as_slice(),
        movers,
        start: robot.start.position,
        goal: robot.goal.position,
        tolerance_m: robot.stack.controller.goal_tolerance_m,
    }
}

fn points(driven: &Driven) -> Vec<TrajectoryPoint> {
    driven.report.trajectory.iter().flatten().map(trajectory_point).collect()
}

/// Writes the result files. Without a run, these are the report and the map with start and goal.
/// `files` are the paths of all of them.
pub(crate) fn write_files(
    episode: &Episode,
    driven: &Driven,
    files: &[String],
    out: &mut OutDir,
) -> Result<(), CliError> {
    let [report_json, map_svg, map_png, speed, speed_png, trajectory_csv, fan_svg, fan_png] = FILES;
    let Driven { report, movers, drive } = driven;
    let rows = report.trajectory.as_deref().unwrap_or_default();
    let points = points(driven);
    let text = crate::json::to_string(&WithFiles { report, files });
    out.write(report_json, text.as_bytes())?;
    let picture = RunPicture {
        stage: stage(episode, movers),
        driven: drive.as_ref().map(|Drive { route, sensed, walked, .. }| DrivenPicture {
            line: route.line.polyline(),
            smoothed: &route.smoothed,
            key_points: report.key_points_m.as_deref().unwrap_or_default(),
            sensed,
            walked,
            points: &points,
            routes: report.run.as_ref().map_or(0, |run| run.routes_planned),
            ended_by: ended_by(report.outcome),
        }),
    };
    let svg = picture.svg();
    out.write(map_svg, svg.as_str().as_bytes())?;
    out.write(map_png, &png(&svg)?)?;
    if let Some(drive) = drive {
        let robot = &episode.robots[0];
        let svg = speed_svg(&robot.stack_name, &points, &robot.robot);
        out.write(speed, svg.as_str().as_bytes())?;
        out.write(speed_png, &png(&svg)?)?;
        out.write(trajectory_csv, csv(rows).as_bytes())?;
        if let Some(moment) = &drive.fan {
            let svg = stage(episode, movers).fan_svg(moment);
            out.write(fan_svg, svg.as_str().as_bytes())?;
            out.write(fan_png, &png(&svg)?)?;
        }
    }
    Ok(())
}

/// Returns the reason of an end before the goal, as the legend of a picture names it.
const fn ended_by(outcome: EpisodeOutcome) -> Option<&'static str> {
    match outcome {
        EpisodeOutcome::Collided => Some("contact"),
        EpisodeOutcome::Stuck => Some("stuck"),
        EpisodeOutcome::Timeout => Some("time limit"),
        _ => None,
    }
}

fn csv(rows: &[[f64; 6]]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for [t, x, y, yaw, v, omega] in rows {
        let _ = writeln!(text, "{t},{x},{y},{yaw},{v},{omega}");
    }
    text
}
