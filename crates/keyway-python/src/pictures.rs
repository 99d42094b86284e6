//! Pictures for notebooks.

use crate::errors::bad_value;
use keyway::geometry::{Point, Polyline};
use keyway::map::OccupancyGrid;
use keyway_draw::layers::{Goal, PathLine, Start};
use keyway_draw::{MapPicture, Svg};
use pyo3::PyResult;

/// Pixels per unit of a picture.
const SCALE: f64 = 1.5;

pub(crate) fn of_map(grid: &OccupancyGrid) -> Svg {
    MapPicture::new(grid).svg()
}

/// A path on a map.
pub(crate) fn of_path(grid: &OccupancyGrid, planned: Option<&Polyline>, path: &Polyline) -> Svg {
    let mut picture = MapPicture::new(grid);
    if let Some(planned) = planned {
        picture = picture.with(PathLine::planned(planned));
    }
    picture = picture.with(PathLine::smoothed(path));
    if let (Some(&start), Some(&point)) = (path.points().first(), path.points().last()) {
        picture = picture.with(Start(start)).with(Goal { point, tolerance_m: None });
    }
    picture.svg()
}

/// Where a robot drove on a map, and where it was to go.
pub(crate) fn of_run(grid: &OccupancyGrid, driven: &Polyline, [start, goal]: [Point; 2]) -> Svg {
    let driven = PathLine::smoothed(driven).label("driven");
    let goal = Goal { point: goal, tolerance_m: None };
    MapPicture::new(grid).with(driven).with(Start(start)).with(goal).svg()
}

pub(crate) fn png(svg: &Svg) -> PyResult<Vec<u8>> {
    svg.to_png(SCALE).map_err(bad_value)
}
