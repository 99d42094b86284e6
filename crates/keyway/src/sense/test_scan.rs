//! Scans for tests: the ranges of a noise-free sensor among cells and discs.

use super::{ProjectedScan, Scan};
use crate::geometry::{Point, Pose};
use crate::map::{BitGrid, GridFrame, RayCells};
use crate::robot::{Footprint, RangeSensor};

/// A scan of a point robot.
pub(crate) fn projected(frame: &GridFrame, pose: Pose, scan: &Scan) -> ProjectedScan {
    ProjectedScan::new(frame, &Footprint::POINT, pose, scan)
}

/// Distances from the sensor to the first occupied cell or disc. A disc is given by its centre
/// and its radius \[m\].
pub(crate) fn scan_among(
    (frame, occupied): (&GridFrame, &[&BitGrid]),
    discs: &[(Point, f64)],
    pose: Pose,
    sensor: &RangeSensor,
) -> Scan {
    let mut scan = Scan::of_nothing(sensor);
    for beam in 0..scan.ranges_m.len() {
        let (sin, cos) = libm::sincos(pose.theta + scan.bearing_rad(beam));
        let ray = (pose.point(), Point::new(cos, sin));
        let to_cell_m = occupied.iter().map(|occupied| to_cell_m(frame, occupied, ray));
        let to_disc_m = discs.iter().map(|&disc| to_disc_m(disc, ray));
        let range_m = to_cell_m.chain(to_disc_m).fold(f64::INFINITY, f64::min);
        scan.ranges_m[beam] = if range_m > sensor.range_m { f64::INFINITY } else { range_m };
    }
    scan
}

/// Cell by cell; only for maps that are not rotated.
fn to_cell_m(frame: &GridFrame, occupied: &BitGrid, (from, along): (Point, Point)) -> f64 {
    assert_eq!(frame.origin().theta, 0.0);
    let mut cells = RayCells::new(frame, frame.grid_from_world(from), along, f64::INFINITY);
    let first = cells.find(|passed| occupied.get(passed.cell));
    first.map_or(f64::INFINITY, |passed| passed.enter * frame.resolution_m())
}

fn to_disc_m((centre, radius_m): (Point, f64), (from, along): (Point, Point)) -> f64 {
    let off = centre - from;
    if off.norm() <= radius_m {
        return 0.0;
    }
    let (ahead_m, aside_m) = (off.dot(along), off.cross(along));
    let half_sq = radius_m * radius_m - aside_m * aside_m;
    if ahead_m > 0.0 && half_sq > 0.0 { ahead_m - half_sq.sqrt() } else { f64::INFINITY }
}
