//! Headings at which a footprint fits at a position.

use crate::geometry::{Point, Pose};
use crate::map::DistanceField;
use crate::robot::Footprint;
use std::fmt;

/// A range of headings, counter-clockwise from one to another, both from -180 to 180 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HeadingRange {
    /// First heading \[deg\].
    pub from_deg: f64,
    /// Last heading \[deg\], not less than the first one.
    pub to_deg: f64,
}

impl HeadingRange {
    /// All ranges of headings at which a footprint is free ([`Footprint::is_free`]) at a
    /// position, in steps of one degree, from -180 to 180. A range across 180 degrees is split in
    /// two, the first and the last.
    pub fn all_free(
        footprint: &Footprint,
        position: Point,
        obstacles: &DistanceField,
    ) -> Vec<Self> {
        let is_free = |degree: i32| {
            let theta = f64::from(degree).to_radians();
            footprint.is_free(Pose::new(position.x, position.y, theta), obstacles)
        };
        let free: Vec<i32> = (-180..=180).filter(|&degree| is_free(degree)).collect();
        let range = |run: &[i32]| Some([*run.first()?, *run.last()?]);
        let runs = free.chunk_by(|one, next| one + 1 == *next).filter_map(range);
        let degrees =
            |[from, to]: [i32; 2]| Self { from_deg: f64::from(from), to_deg: f64::from(to) };
        runs.map(degrees).collect()
    }
}

impl fmt::Display for HeadingRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from_deg, to_deg } = self;
        if from_deg == to_deg {
            write!(f, "{from_deg}")
        } else {
            write!(f, "{from_deg} to {to_deg}")
        }
    }
}

/// True if a footprint fits at a pose, rotated by up to a tolerance \[rad\] to either side.
pub(super) fn fits_within(
    footprint: &Footprint,
    pose: Pose,
    tolerance_rad: f64,
    obstacles: &DistanceField,
) -> bool {
    let turned = |part: f64| Pose::new(pose.x, pose.y, pose.theta + part * tolerance_rad);
    [0.0, 0.5, -0.5, 1.0, -1.0].into_iter().any(|part| footprint.is_free(turned(part), obstacles))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, OccupancyGrid};

    #[test]
    fn ranges_by_hand() {
        // A box of 2 m x 0.8 m around its rear end, in a lane of 1 m: it fits along the lane, in
        // both directions.
        let field = |rows: &[&str]| {
            let grid = OccupancyGrid::from_ascii(rows);
            DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default())
        };
        let long = Footprint::rectangle(2.0, 0.8).unwrap();
        let texts = |footprint: &Footprint, rows: &[&str]| -> Vec<String> {
            let ranges = HeadingRange::all_free(footprint, Point::new(2.5, 1.5), &field(rows));
            ranges.iter().map(ToString::to_string).collect()
        };
        // A corner 1 m ahead and 0.4 m aside is at sin t + 0.4 cos t: 0.5 m at 5.86 degrees.
        let lane = ["#####", ".....", "#####"];
        assert_eq!(texts(&long, &lane), ["-180 to -175", "-5 to 5", "175 to 180"]);
        assert_eq!(texts(&long, &["#####", "..#..", "#####"]), Vec::<String>::new());
        assert_eq!(texts(&long, &["....."; 3]), ["-180 to 180"]);
        // If it is as wide as the lane, it fits along it only.
        let wide = Footprint::rectangle(2.0, 1.0).unwrap();
        assert_eq!(texts(&wide, &lane), ["-180", "0", "180"]);
    }

    #[test]
    fn a_heading_may_be_off_by_the_tolerance() {
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
        let long = Footprint::rectangle(2.0, 0.8).unwrap();
        let fits = |degrees: f64, tolerance_rad: f64| {
            let pose = Pose::new(2.5, 1.5, degrees.to_radians());
            fits_within(&long, pose, tolerance_rad, &field)
        };
        assert!(fits(5.0, 0.0) && !fits(7.0, 0.0));
        assert!(fits(7.0, 0.05) && fits(-7.0, 0.05) && !fits(9.0, 0.05));
    }
}
