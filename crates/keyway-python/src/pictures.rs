//! Pictures for notebooks.

use crate::errors::bad_value;
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway_draw::layers::{
    CellTint, DrivenPath, ElusiveObstacles, Footprints, GoalMark, HatchedDiscs, Movers, PathLine,
    Polygons, StartMark,
};
use keyway_draw::{MapPicture, Svg};
use keyway_sim::episode::RobotReport;
use keyway_sim::sim::{StandingPolygon, TrajectoryPoint};
use pyo3::PyResult;

/// Pixels per unit of the picture.
const SCALE: f64 = 1.5;

pub(crate) fn of_map(grid: &OccupancyGrid) -> Svg {
    MapPicture::new(grid).svg()
}

/// Draws a path on a map, and its smoothed path, if there is one.
pub(crate) fn of_path(grid: &OccupancyGrid, path: &Polyline, smoothed: Option<&Polyline>) -> Svg {
    let mut picture = MapPicture::new(grid).with(PathLine::planned(path));
    if let Some(smoothed) = smoothed {
        picture = picture.with(PathLine::smoothed(smoothed));
    }
    if let (Some(&start), Some(&point)) = (path.points().first(), path.points().last()) {
        picture = picture.with(StartMark(start)).with(GoalMark { point, tolerance_m: None });
    }
    picture.svg()
}

/// Draws the trajectory of a run on its map, with the obstacles.
pub(crate) fn of_run(grid: &OccupancyGrid, report: &RobotReport) -> Svg {
    let inputs = &report.inputs;
    let at = |numbers: &[f64]| Point::new(numbers[0], numbers[1]);
    let disc = |&[x, y, radius_m]: &[f64; 3]| Disc { centre: Point::new(x, y), radius_m };
    let discs: Vec<Disc> = inputs.obstacles.iter().map(disc).collect();
    let polygons: Vec<&[Point]> = inputs.polygons.iter().map(StandingPolygon::vertices).collect();
    let point = |&[t_s, x, y, theta, v, omega]: &[f64; 6]| {
        let (pose, velocity) = (Pose::new(x, y, theta), Velocity::new(v, omega));
        TrajectoryPoint { t_s, pose, velocity }
    };
    let driven: Vec<TrajectoryPoint> = report.trajectory.iter().flatten().map(point).collect();
    let movers = report.run.as_ref().map(|run| run.movers(&inputs.moving)).unwrap_or_default();
    let mut picture = MapPicture::new(grid)
        .with(HatchedDiscs::unknown_obstacles(&discs))
        .with(Polygons::unknown_obstacles(&polygons))
        .with(CellTint::unknown_obstacles(&inputs.hidden_cells))
        .with(CellTint::absent(&inputs.absent_cells))
        .with(ElusiveObstacles::new(&inputs.elusive))
        .with(Movers::new(&movers, &driven))
        .with(StartMark(at(&inputs.start)))
        .with(GoalMark { point: at(&inputs.goal), tolerance_m: None });
    if let Some(robot) = inputs.robot.as_ref().filter(|_| !driven.is_empty()) {
        picture = picture
            .with(DrivenPath::new(&driven).v_max_mps(robot.limits.v_max_mps))
            .with(Footprints::new(&driven, &robot.footprint));
    }
    picture.svg()
}

pub(crate) fn png(svg: &Svg) -> PyResult<Vec<u8>> {
    svg.to_png(SCALE).map_err(bad_value)
}
