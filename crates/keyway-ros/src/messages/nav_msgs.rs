//! `nav_msgs`.

use super::Named;
use super::builtin_interfaces::Time;
use super::geometry_msgs::{Pose, PoseStamped, PoseWithCovariance, TwistWithCovariance};
use super::std_msgs::Header;
use keyway::geometry::{self, Point};
use keyway::map::{self, CellState, GridFrame};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MapMetaData {
    pub(crate) map_load_time: Time,
    pub(crate) resolution: f32,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) origin: Pose,
}

/// A grid of rows from the bottom; 0 is free, 100 is occupied, -1 is unknown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OccupancyGrid {
    pub(crate) header: Header,
    pub(crate) info: MapMetaData,
    pub(crate) data: Vec<i8>,
}

impl Named for OccupancyGrid {
    const NAME: (&'static str, &'static str) = ("nav_msgs", "OccupancyGrid");
}

impl MapMetaData {
    /// The size and placement of a grid.
    pub(crate) fn of(frame: &GridFrame, map_load_time: Time) -> Self {
        Self {
            map_load_time,
            resolution: frame.resolution_m() as f32,
            width: frame.width(),
            height: frame.height(),
            origin: frame.origin().into(),
        }
    }
}

impl OccupancyGrid {
    /// Converts a map.
    pub(crate) fn of(map: &map::OccupancyGrid, header: Header) -> Self {
        let value = |cell| match map.state(cell) {
            Some(CellState::Free) => 0,
            Some(CellState::Occupied) => 100,
            _ => -1,
        };
        let frame = map.frame();
        let info = MapMetaData::of(frame, header.stamp);
        Self { header, info, data: frame.cells().map(value).collect() }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Odometry {
    pub(crate) header: Header,
    pub(crate) child_frame_id: String,
    pub(crate) pose: PoseWithCovariance,
    pub(crate) twist: TwistWithCovariance,
}

impl Named for Odometry {
    const NAME: (&'static str, &'static str) = ("nav_msgs", "Odometry");
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Path {
    pub(crate) header: Header,
    pub(crate) poses: Vec<PoseStamped>,
}

impl Named for Path {
    const NAME: (&'static str, &'static str) = ("nav_msgs", "Path");
}

/// Several poses, in their order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Goals {
    pub(crate) header: Header,
    pub(crate) goals: Vec<PoseStamped>,
}

impl Path {
    /// Maximum distance between two poses that path consumers accept \[m\].
    const STEP_M: f64 = 0.05;

    /// Samples a polyline in small steps, with its headings; the last pose has the given heading.
    pub(crate) fn along(header: &Header, points: &[Point], heading_rad: Option<f64>) -> Self {
        let mut dense: Vec<Point> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let steps = (pair[0].distance(pair[1]) / Self::STEP_M).ceil().max(1.0) as u32;
            let step = |step| pair[0].lerp(pair[1], f64::from(step) / f64::from(steps));
            dense.extend((1..=steps).map(step));
        }
        Self::new(header, &dense, heading_rad)
    }

    /// Poses at these points, each with the heading to the next one. The last one has the given
    /// heading, or that of the last segment.
    pub(crate) fn new(header: &Header, points: &[Point], heading_rad: Option<f64>) -> Self {
        let along_rad = |index: usize| {
            let next = points.get(index + 1).map(|next| (points[index], *next));
            let last = index.checked_sub(1).map(|before| (points[before], points[index]));
            next.or(last).map_or(0.0, |(from, to)| (to - from).heading())
        };
        let heading_rad = |index: usize| {
            let is_last = index + 1 == points.len();
            heading_rad.filter(|_| is_last).unwrap_or_else(|| along_rad(index))
        };
        let pose = |index: usize| {
            geometry::Pose::new(points[index].x, points[index].y, heading_rad(index))
        };
        let stamped = |index| PoseStamped { header: header.clone(), pose: pose(index).into() };
        Self { header: header.clone(), poses: (0..points.len()).map(stamped).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn poses_of_a_path_look_along_it() {
        let points = [Point::new(0.0, 0.0), Point::new(2.0, 0.0), Point::new(2.0, 3.0)];
        let headings = |heading_rad| {
            let path = Path::new(&Header::new(1.0, "map"), &points, heading_rad);
            path.poses
                .iter()
                .map(|pose| pose.pose.orientation.heading_rad().unwrap())
                .collect::<Vec<_>>()
        };
        let near = |found: Vec<f64>, expected: [f64; 3]| {
            found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12)
        };
        assert!(near(headings(None), [0.0, FRAC_PI_2, FRAC_PI_2]));
        assert!(near(headings(Some(-1.0)), [0.0, FRAC_PI_2, -1.0]));
        assert_eq!(Path::along(&Header::default(), &points[..1], None).poses.len(), 1);
        let dense = Path::along(&Header::default(), &points, None);
        let place = |index: usize| dense.poses[index].pose.position;
        assert_eq!((dense.poses.len(), place(40).x, place(100).y), (101, 2.0, 3.0));
        assert!((place(10).x - 0.5).abs() < 1e-12);
    }
}
