//! The files that a run leaves.

use super::Job;
use super::drive::{Drive, Driven};
use crate::error::CliError;
use crate::out_dir::OutDir;
use crate::pictures::{DrivenPicture, RunPicture, driven_points, png, speed_svg};
use crate::report::sample_row;
use keyway::sim::Run;
use std::fmt::Write as _;

/// Names of all files that [`write_outputs`] may write.
pub(crate) const FILES: [&str; 6] =
    ["report.json", "map.svg", "map.png", "speed.svg", "speed.png", "trajectory.csv"];

/// Names of the files that [`write_outputs`] will write.
pub(crate) fn written(driven: &Driven) -> &'static [&'static str] {
    if driven.drive.is_some() { &FILES } else { &FILES[..3] }
}

/// Without a run: the report, and the map with start and goal.
pub(crate) fn write_outputs(job: &Job, driven: &Driven, out: &mut OutDir) -> Result<(), CliError> {
    let [report, map_svg, map_png, speed, speed_png, trajectory] = FILES;
    let drive = driven.drive.as_ref();
    let points = drive.map(|drive| driven_points(&drive.run)).unwrap_or_default();
    out.write(report, crate::json::to_string(&driven.report).as_bytes())?;
    let picture = RunPicture {
        map: &job.loaded.grid,
        robot: &job.robot,
        obstacles: &job.obstacles,
        start: job.start.position,
        goal: job.goal,
        tolerance_m: job.stack.controller.goal_tolerance_m,
        driven: drive.map(|Drive { route, key_points, sensed, .. }| DrivenPicture {
            line: &route.line,
            smoothed: &route.smoothed,
            key_points,
            sensed,
            points: &points,
        }),
    };
    let svg = picture.svg();
    out.write(map_svg, svg.as_str().as_bytes())?;
    out.write(map_png, &png(&svg)?)?;
    if let Some(drive) = drive {
        let svg = speed_svg(&job.stack_name, &points, &job.robot);
        out.write(speed, svg.as_str().as_bytes())?;
        out.write(speed_png, &png(&svg)?)?;
        out.write(trajectory, csv(&drive.run).as_bytes())?;
    }
    Ok(())
}

fn csv(run: &Run) -> String {
    let mut text = "t_s,x_m,y_m,yaw_rad,v_mps,omega_radps\n".to_owned();
    for sample in &run.samples {
        let [t, x, y, yaw, v, omega] = sample_row(sample);
        let _ = writeln!(text, "{t},{x},{y},{yaw},{v},{omega}");
    }
    text
}
