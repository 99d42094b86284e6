//! Point clouds of depth cameras and 3-D lidars: extracts the points at the height of the robot,
//! on the ground.

use crate::messages::sensor_msgs::{PointCloud2, PointField};
use crate::settings::PointsTaken;
use crate::transforms::Placement;
use keyway::geometry::{Point, Pose};
use keyway::sense::{FieldOfView, SensorPoints};
use std::collections::HashSet;
use std::f64::consts::TAU;
use thiserror::Error;

/// Error of an unreadable cloud.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(crate) enum CloudError {
    #[error("a cloud has no field `{0}` of floating-point numbers")]
    Field(char),
    #[error("a cloud of {points} points of {step} bytes has {bytes} bytes")]
    Size { points: u64, step: u32, bytes: usize },
}

/// The obstacles of a cloud, relative to the ground position of its sensor.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) sensor: usize,
    pub(super) stamp_s: f64,
    /// Position of the sensor in the robot's frame, with the heading of the robot.
    mount: Pose,
    points: Vec<Point>,
    clears: Option<FieldOfView>,
}

impl Seen {
    /// Extracts the obstacles. `in_robot` and `in_map` are the placements of the cloud's frame in
    /// those of the robot and of the map; heights are measured in the map.
    pub(super) fn of(
        sensor: usize,
        cloud: &PointCloud2,
        [in_robot, in_map]: [&Placement; 2],
        taken: &PointsTaken,
    ) -> Result<Self, CloudError> {
        let at = in_robot.on_ground().point();
        let mount = Pose::new(at.x, at.y, 0.0);
        let (mut view, mut points, mut squares) = (View::default(), Vec::new(), HashSet::new());
        for point in Reader::new(cloud)?.points() {
            // Many drivers write zeros for missing returns.
            if point == [0.0; 3] || !point.iter().all(|value| value.is_finite()) {
                continue;
            }
            let ([x, y, _], [.., height_m]) = (in_robot.point(point), in_map.point(point));
            let point = mount.body_from_world(Point::new(x, y));
            let range_m = point.norm();
            // A point beyond the range still shows that the sensor sees up to the range.
            view.look_at(point.heading(), range_m.min(taken.range_m));
            if range_m > taken.range_m {
                continue;
            }
            if taken.heights_m.contains(&height_m) && squares.insert(near(point)) {
                points.push(point);
            }
        }
        let stamp_s = cloud.header.stamp.stamp_s();
        Ok(Self { sensor, stamp_s, mount, points, clears: view.field_of_view() })
    }

    pub(super) fn borrowed(&self) -> SensorPoints<'_> {
        let &Self { sensor, stamp_s, mount, clears, .. } = self;
        SensorPoints { stamp_s, sensor, mount, points: &self.points, clears }
    }
}

/// Index of a 2 cm square; points in the same square count once.
fn near(point: Point) -> (i32, i32) {
    const SIDE_M: f64 = 0.02;
    ((point.x / SIDE_M).floor() as i32, (point.y / SIDE_M).floor() as i32)
}

/// The ground covered by a cloud, estimated from its points: between the nearest and the farthest
/// range, and between the outermost bearings.
struct View {
    /// True for the sectors of the turn that contain a point.
    bearings: [bool; Self::PARTS],
    nearest_m: f64,
    farthest_m: f64,
}

impl Default for View {
    fn default() -> Self {
        Self { bearings: [false; Self::PARTS], nearest_m: f64::INFINITY, farthest_m: 0.0 }
    }
}

impl View {
    const PARTS: usize = 180;

    fn look_at(&mut self, bearing_rad: f64, range_m: f64) {
        let part = bearing_rad.rem_euclid(TAU) / TAU * Self::PARTS as f64;
        self.bearings[(part as usize).min(Self::PARTS - 1)] = true;
        self.nearest_m = self.nearest_m.min(range_m);
        self.farthest_m = self.farthest_m.max(range_m);
    }

    /// The turn without its widest gap; `None` for fewer than two bearings.
    fn field_of_view(&self) -> Option<FieldOfView> {
        let seen: Vec<usize> = (0..Self::PARTS).filter(|&part| self.bearings[part]).collect();
        let gap = |at: usize| {
            let next = seen.get(at + 1).copied().unwrap_or(seen[0] + Self::PARTS);
            next - seen[at]
        };
        // Of equal gaps, the first one.
        let widest = (0..seen.len()).rev().max_by_key(|&at| gap(at))?;
        let first = seen[(widest + 1) % seen.len()];
        let parts = Self::PARTS - gap(widest);
        let part_rad = TAU / Self::PARTS as f64;
        let from_rad = (first as f64 + 0.5) * part_rad;
        let view = FieldOfView {
            from_rad,
            to_rad: from_rad + parts as f64 * part_rad,
            range_min_m: self.nearest_m,
            range_max_m: self.farthest_m,
        };
        view.is_usable().then_some(view)
    }
}

/// Decoder of the coordinates in a cloud.
struct Reader<'a> {
    cloud: &'a PointCloud2,
    /// Offset of each coordinate, and true if it has double precision.
    fields: [(usize, bool); 3],
}

impl<'a> Reader<'a> {
    fn new(cloud: &'a PointCloud2) -> Result<Self, CloudError> {
        let field = |name: char| {
            let is_it = |field: &&PointField| field.name.chars().eq([name]);
            let field = cloud.fields.iter().find(is_it).ok_or(CloudError::Field(name))?;
            let is_double = field.datatype == PointField::FLOAT64;
            let bytes = if is_double { 8 } else { 4 };
            let is_number = is_double || field.datatype == PointField::FLOAT32;
            let is_inside = u64::from(field.offset) + bytes <= u64::from(cloud.point_step);
            let place = (field.offset as usize, is_double);
            (is_number && is_inside).then_some(place).ok_or(CloudError::Field(name))
        };
        let fields = [field('x')?, field('y')?, field('z')?];
        let row = u64::from(cloud.width) * u64::from(cloud.point_step);
        let rows = u64::from(cloud.height).saturating_sub(1);
        let least = rows.saturating_mul(u64::from(cloud.row_step)).saturating_add(row);
        let is_whole = u64::from(cloud.row_step) >= row && least <= cloud.data.len() as u64;
        let points = u64::from(cloud.width).saturating_mul(u64::from(cloud.height));
        if points > 0 && !is_whole {
            let (step, bytes) = (cloud.point_step, cloud.data.len());
            return Err(CloudError::Size { points, step, bytes });
        }
        Ok(Self { cloud, fields })
    }

    fn points(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let PointCloud2 { height, width, point_step, row_step, .. } = *self.cloud;
        let begins = move |row: u32| row as usize * row_step as usize;
        let of_row = move |row: u32| {
            (0..width).map(move |column| begins(row) + column as usize * point_step as usize)
        };
        let rows = if width == 0 { 0 } else { height };
        (0..rows).flat_map(of_row).map(|at| self.fields.map(|field| self.number(at, field)))
    }

    fn number(&self, at: usize, (offset, is_double): (usize, bool)) -> f64 {
        let is_big = self.cloud.is_bigendian;
        let from = at + offset;
        if is_double {
            let bytes = bytes_at::<8>(&self.cloud.data, from);
            if is_big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
        } else {
            let bytes = bytes_at::<4>(&self.cloud.data, from);
            f64::from(if is_big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
        }
    }
}

fn bytes_at<const COUNT: usize>(data: &[u8], from: usize) -> [u8; COUNT] {
    std::array::from_fn(|index| data[from + index])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::std_msgs::Header;

    const TAKEN: PointsTaken = PointsTaken { heights_m: 0.05..=1.5, range_m: 5.0, timeout_s: 0.0 };

    /// A cloud of two rows, each with four bytes of padding at its end.
    fn cloud(points: &[[f32; 3]], is_bigendian: bool) -> PointCloud2 {
        let width = points.len().div_ceil(2);
        let mut data = Vec::new();
        for row in points.chunks(width.max(1)) {
            for point in row {
                for value in [point[0], 7.0, point[1], point[2]] {
                    let bytes =
                        if is_bigendian { value.to_be_bytes() } else { value.to_le_bytes() };
                    data.extend(bytes);
                }
            }
            data.extend([0; 4]);
        }
        let field = |(name, offset): (&str, u32)| PointField {
            name: name.to_owned(),
            offset,
            datatype: PointField::FLOAT32,
            count: 1,
        };
        PointCloud2 {
            header: Header::new(3.0, "camera"),
            height: 2,
            width: width as u32,
            fields: [("x", 0), ("intensity", 4), ("y", 8), ("z", 12)].map(field).to_vec(),
            is_bigendian,
            point_step: 16,
            row_step: 16 * width as u32 + 4,
            data,
            is_dense: false,
        }
    }

    /// A camera 0.5 m above the ground, 0.2 m ahead of the robot's centre: z ahead, y down.
    fn camera() -> Placement {
        Placement::new([0.2, 0.0, 0.5], [-0.5, 0.5, -0.5, 0.5]).unwrap()
    }

    #[test]
    fn what_is_at_the_height_of_the_robot_is_an_obstacle() {
        let points = [
            // 2 m ahead: on the ground, 10 cm above it, and far above.
            [0.0, 0.5, 2.0],
            [0.0, 0.4, 2.0],
            [0.0, -1.5, 2.0],
            // Once more, to the right, a missing return, and too far.
            [0.0, 0.3, 2.0],
            [1.0, 0.3, 1.0],
            [0.0, 0.0, 0.0],
            [f32::NAN, 0.3, 1.0],
            [0.0, 0.0, 9.0],
        ];
        for is_bigendian in [false, true] {
            let cloud = cloud(&points, is_bigendian);
            let seen = Seen::of(1, &cloud, [&camera(); 2], &TAKEN).unwrap();
            let expected = [Point::new(2.0, 0.0), Point::new(1.0, -1.0)];
            assert_eq!(seen.points.len(), expected.len(), "{:?}", seen.points);
            let apart = |(found, expected): (&Point, Point)| found.distance(expected);
            assert!(seen.points.iter().zip(expected).map(apart).all(|apart_m| apart_m < 1e-6));
            let shown = seen.borrowed();
            assert_eq!((shown.sensor, shown.stamp_s), (1, 3.0));
            assert!((shown.mount.x - 0.2).abs() < 1e-9 && shown.mount.theta == 0.0);
            let view = shown.clears.unwrap();
            assert!((view.from_rad - (TAU - TAU / 8.0)).abs() < 0.04, "{view:?}");
            assert!((view.to_rad - TAU).abs() < 0.04, "{view:?}");
            assert!((view.range_max_m - 5.0).abs() < 1e-6 && view.range_min_m < 1.5);
        }
    }

    #[test]
    fn who_looks_all_around_clears_all_around() {
        let around = |i: u32| {
            let (sin, cos) = (f64::from(i) * TAU / 360.0).sin_cos();
            [2.0 * cos as f32, 2.0 * sin as f32, 0.3]
        };
        let points: Vec<[f32; 3]> = (0..360).map(around).collect();
        let seen = Seen::of(0, &cloud(&points, false), [&Placement::default(); 2], &TAKEN).unwrap();
        let view = seen.clears.unwrap();
        assert!(view.to_rad - view.from_rad > 0.98 * TAU, "{view:?}");
        let alone = Seen::of(0, &cloud(&[points[0]; 2], false), [&Placement::default(); 2], &TAKEN);
        assert_eq!(alone.unwrap().clears, None, "a single point shows where it is alone");
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let seen = |cloud: &PointCloud2| Seen::of(0, cloud, [&camera(); 2], &TAKEN).unwrap_err();
        let whole = cloud(&[[1.0; 3]; 6], false);
        let mut without = whole.clone();
        without.fields[2].name = "v".to_owned();
        assert_eq!(seen(&without), CloudError::Field('y'));
        let mut short = whole.clone();
        short.data.truncate(90);
        assert_eq!(seen(&short), CloudError::Size { points: 6, step: 16, bytes: 90 });
        let mut outside = whole.clone();
        outside.fields[3].offset = 13;
        assert_eq!(seen(&outside), CloudError::Field('z'));
        let absurd = PointCloud2 { width: u32::MAX, height: u32::MAX, ..whole };
        assert!(matches!(seen(&absurd), CloudError::Size { .. }));
        assert!(Seen::of(0, &cloud(&[], false), [&camera(); 2], &TAKEN).unwrap().points.is_empty());
    }
}
