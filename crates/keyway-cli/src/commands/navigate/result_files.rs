//! The files that a run leaves.

use super::drive::{Drive, Driven};
use crate::error::CliError;
use crate::out_dir::OutDir;
use crate::pictures::{DrivenPicture, RunPicture, driven_point, png, speed_svg};
use crate::report_text::WithFiles;
use keyway::episode::Episode;
use keyway_draw::layers::DrivenPoint;
use std::fmt::Write as _;

/// Names of all files that [`write_files`] may write.
pub(crate) const FILES: [&str; 6] =
    ["report.json", "map.svg", "map.png", "speed.svg", "speed.png", "trajectory.csv"];

/// Names of the files that [`write_files`] will write.
pub(crate) fn written(driven: &Driven) -> &'static [&'static str] {
    if driven.drive.is_some() { &FILES } else { &FILES[..3] }
}

/// Without a run: the report, and the map with start and goal. `files` are the paths of all of them.
pub(crate) fn write_files(
    episode: &Episode,
    driven: &Driven,
    files: &[String],
    out: &mut OutDir,
) -> Result<(), CliError> {
    let [report_json, map_svg, map_png, speed, speed_png, trajectory_csv] = FILES;
    let Driven { report, drive } = driven;
    let rows = report.trajectory.as_deref().unwrap_or_default();
    let points: Vec<DrivenPoint> = rows.iter().map(driven_point).collect();
    let text = crate::json::to_string(&WithFiles { report, files });
    out.write(report_json, text.as_bytes())?;
    let picture = RunPicture {
        map: &episode.known,
        robot: &episode.robot,
        obstacles: &episode.obstacles,
        movers: &episode.movers,
        start: episode.start.position,
        goal: episode.goal,
        tolerance_m: episode.stack.controller.goal_tolerance_m,
        driven: drive.as_ref().map(|Drive { route, sensed }| DrivenPicture {
            line: route.line.polyline(),
            smoothed: &route.smoothed,
            key_points: report.key_points_m.as_deref().unwrap_or_default(),
            sensed,
            points: &points,
        }),
    };
    let svg = picture.svg();
    out.write(map_svg, svg.as_str().as_bytes())?;
    out.write(map_png, &png(&svg)?)?;
    if drive.is_some() {
        let svg = speed_svg(&episode.stack_name, &points, &episode.robot);
        out.write(speed, svg.as_str().as_bytes())?;
        out.write(speed_png, &png(&svg)?)?;
        out.write(trajectory_csv, csv(rows).as_bytes())?;
    }
    Ok(())
}

fn csv(rows: &[[f64; 6]]) -> String {
    let mut text = "t_s,x_m,y_m,yaw_rad,v_mps,omega_radps\n".to_owned();
    for [t, x, y, yaw, v, omega] in rows {
        let _ = writeln!(text, "{t},{x},{y},{yaw},{v},{omega}");
    }
    text
}
