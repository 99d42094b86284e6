//! Collision checks of a footprint that drives straight on.

use super::turn::LEAST_CELLS;
use crate::geometry::{Point, Pose, Segment};
use crate::map::DistanceField;
use crate::robot::{Footprint, Polygon};

impl Footprint {
    /// True if the footprint is certainly free ([`Self::is_free`]) at every pose of a straight
    /// drive from `pose` on, by `length_m` along its heading, negative backwards. Also false if a
    /// polygon comes within a thousandth of a cell of an obstacle or of the map's border in
    /// between, and for numbers that are not finite.
    ///
    /// The test does not sample poses. Around each pose tested, no part of the footprint moves
    /// farther than the robot; if that is not less than the clearance, the drive is halved.
    pub fn is_free_drive(&self, pose: Pose, length_m: f64, field: &DistanceField) -> bool {
        self.keeps_room_driving(pose, length_m, 0.0, field)
    }

    /// True if the footprint certainly keeps a clearance of `room_m` \[m\] from obstacles and from
    /// the border of the map during a straight drive: [`Self::is_free_drive`] with a margin.
    pub fn keeps_room_driving(
        &self,
        pose: Pose,
        length_m: f64,
        room_m: f64,
        field: &DistanceField,
    ) -> bool {
        let (end, room_m) = (driven(pose, length_m), room_m.max(0.0));
        let keeps_room = |pose| self.keeps_room(pose, room_m, field);
        if !length_m.is_finite() || !keeps_room(pose) || !keeps_room(end) {
            return false;
        }
        match self {
            Self::Circle(circle) => {
                let way = Segment::new(pose.point(), end.point());
                field.clearance().is_clear(way, circle.radius_m() + room_m)
            }
            Self::Polygon(polygon) => {
                length_m == 0.0 || polygon.is_free_along(pose, [0.0, length_m], room_m, field)
            }
        }
    }
}

impl Polygon {
    fn is_free_along(
        &self,
        pose: Pose,
        [from_m, to_m]: [f64; 2],
        room_m: f64,
        field: &DistanceField,
    ) -> bool {
        let clearance = field.clearance();
        let middle_m = 0.5 * (from_m + to_m);
        let middle = driven(pose, middle_m);
        let moves_m = 0.5 * (to_m - from_m).abs();
        let cell_m = clearance.frame().resolution_m();
        let (moves, room, least) = (moves_m / cell_m, room_m / cell_m, 1e-3 * LEAST_CELLS);
        // One lookup decides nearly all stretches in open areas, for any heading.
        let point = middle.point();
        let nearest_m = field.square_bounds_m(point).0.min(clearance.to_border(point));
        if nearest_m > self.circumscribed_radius_m() + room_m + moves_m + least * cell_m {
            return true;
        }
        if self.has_room(middle, room + moves + least, &clearance) {
            return true;
        }
        moves > LEAST_CELLS
            && self.is_clear(middle, &clearance)
            && (room <= 0.0 || self.has_room(middle, room, &clearance))
            && self.is_free_along(pose, [from_m, middle_m], room_m, field)
            && self.is_free_along(pose, [middle_m, to_m], room_m, field)
    }
}

/// The pose after a straight drive.
fn driven(pose: Pose, length_m: f64) -> Pose {
    let (sin, cos) = libm::sincos(pose.theta);
    let Point { x, y } = pose.point() + Point::new(cos, sin) * length_m;
    Pose { x, y, theta: pose.theta }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::star;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn is_free_drive(
        footprint: &Footprint,
        pose: Pose,
        length_m: f64,
        grid: &OccupancyGrid,
    ) -> bool {
        let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
        footprint.is_free_drive(pose, length_m, &field)
    }

    #[test]
    fn drives_by_hand() {
        // A lane of 1 m with a blocked cell ahead at x = 5 m.
        let lane = OccupancyGrid::from_ascii(&["########", ".....#..", "########"]);
        let pose = Pose::new(2.0, 1.5, 0.0);
        for footprint in [Footprint::circle(0.4).unwrap(), Footprint::rectangle(0.8, 0.8).unwrap()]
        {
            let drives = |length_m| is_free_drive(&footprint, pose, length_m, &lane);
            assert!(drives(0.0) && drives(2.59) && drives(-1.59));
            assert!(!drives(2.61) && !drives(4.6), "into the cell, and beyond it");
            assert!(!drives(-1.61), "it leaves the map");
            assert!(!drives(f64::NAN) && !drives(f64::INFINITY));
            let across = Pose::new(2.0, 1.5, FRAC_PI_2);
            assert!(!is_free_drive(&footprint, across, 0.2, &lane));
        }
    }

    #[test]
    fn room_is_kept_by_hand() {
        // 0.1 m to each side in a lane of 1 m, 0.6 m to a cell ahead.
        let lane = OccupancyGrid::from_ascii(&["########", ".....#..", "########"]);
        let field = DistanceField::new(lane.frame(), lane.occupied(), &FieldConfig::default());
        let pose = Pose::new(2.0, 1.5, 0.0);
        for footprint in [Footprint::circle(0.4).unwrap(), Footprint::rectangle(0.8, 0.8).unwrap()]
        {
            let keeps =
                |length_m, room_m| footprint.keeps_room_driving(pose, length_m, room_m, &field);
            assert!(keeps(1.0, 0.09) && !keeps(1.0, 0.11));
            assert!(keeps(2.5, 0.09) && !keeps(2.55, 0.09), "before the cell");
            assert!(keeps(-1.5, 0.09) && !keeps(-1.55, 0.09), "before the border");
            assert!(footprint.keeps_room(pose, 0.09, &field));
            assert!(!footprint.keeps_room(pose, 0.11, &field));
            assert!(!footprint.keeps_room(Pose::new(0.45, 1.5, 0.0), 0.09, &field));
        }
    }

    proptest! {
        /// A motion reported to keep a clearance keeps it at 200 poses; any other comes nearer at
        /// one of them.
        #[test]
        fn room_agrees_with_dense_samples(cells in prop::collection::vec(prop::bool::weighted(0.05), 20 * 16),
                radii in prop::collection::vec(0.05..0.5f64, 3..8), x in 0.2..0.8f64, y in 0.2..0.6f64,
                theta in -3.1..3.1f64, by in -0.5..0.5f64, turns in prop::bool::ANY, room_m in 0.001..0.05f64) {
            let frame = GridFrame::new(20, 16, 0.05, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
            let vertices = star(&radii, (0.0, 0.0)).iter().map(|&p| p * 0.2).collect();
            let footprint = Footprint::polygon(vertices).unwrap();
            let pose = Pose::new(x, y, theta);
            let says = if turns {
                footprint.keeps_room_turning(pose.point(), [theta, 4.0 * by], room_m, &field)
            } else {
                footprint.keeps_room_driving(pose, by, room_m, &field)
            };
            let samples = (0..=200).map(|i| {
                let part = f64::from(i) / 200.0;
                if turns { Pose { theta: theta + 4.0 * by * part, ..pose } } else { driven(pose, by * part) }
            });
            let at_m = |at| footprint.distance_m(at, &field.clearance(), 1.0)
                .min(footprint.to_border_m(at, &field.clearance()));
            let nearest_m = samples.map(at_m).fold(f64::INFINITY, f64::min);
            prop_assert!(!says || nearest_m >= room_m - 1e-9, "{nearest_m}");
            prop_assert!(says || nearest_m <= room_m + 1.3e-3 + 2.0 * LEAST_CELLS * 0.05, "{nearest_m}");
        }

        /// A drive reported as free is free at 200 poses; any other comes near an obstacle or the
        /// border at one of them.
        #[test]
        fn agrees_with_dense_samples(cells in prop::collection::vec(prop::bool::weighted(0.05), 20 * 16),
                radii in prop::collection::vec(0.05..0.5f64, 3..8), is_round in prop::bool::ANY,
                x in 0.1..0.9f64, y in 0.1..0.7f64, theta in -3.1..3.1f64, length_m in -0.5..0.5f64) {
            let frame = GridFrame::new(20, 16, 0.05, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let field = DistanceField::new(grid.frame(), grid.occupied(), &FieldConfig::default());
            let footprint = if is_round { Footprint::circle(0.3 * radii[0]).unwrap() }
                else { Footprint::polygon(star(&radii, (0.0, 0.0)).iter().map(|&p| p * 0.3).collect()).unwrap() };
            let pose = Pose::new(x, y, theta);
            let says = footprint.is_free_drive(pose, length_m, &field);
            let samples = (0..=200).map(|i| driven(pose, length_m * f64::from(i) / 200.0));
            let is_free = samples.clone().all(|at| footprint.is_free(at, &field));
            prop_assert!(!says || is_free);
            let room_m = |at| footprint.distance_m(at, &field.clearance(), 1.0)
                .min(footprint.to_border_m(at, &field.clearance()));
            let nearest_m = samples.map(room_m).fold(f64::INFINITY, f64::min);
            // Between two samples the robot drives at most 2.5 mm.
            prop_assert!(says || nearest_m <= 1.3e-3 + 2.0 * LEAST_CELLS * 0.05);
        }
    }
}
