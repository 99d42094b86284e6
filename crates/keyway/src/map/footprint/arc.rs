//! Collision checks of a footprint that drives along an arc.

use super::turn::LEAST_CELLS;
use crate::geometry::{Pose, Velocity};
use crate::map::DistanceField;
use crate::robot::Footprint;

impl Footprint {
    /// True if the footprint certainly keeps a clearance of `room_m` \[m\] from obstacles and from
    /// the border of the map on an arc of this length \[m\], negative backwards, on which the
    /// robot turns by `turn_rad`, positive to the left. Also false if it comes within a thousandth
    /// of a cell of that clearance in between, and for numbers that are not finite.
    ///
    /// The test does not sample poses. Around each pose tested, no part of the footprint moves
    /// farther than the length driven and the circumscribed radius times the angle; if that is not
    /// less than the clearance, the arc is halved.
    pub fn keeps_room_on_arc(
        &self,
        pose: Pose,
        [length_m, turn_rad]: [f64; 2],
        room_m: f64,
        field: &DistanceField,
    ) -> bool {
        let (arc, room_m) = (Velocity::new(length_m, turn_rad), room_m.max(0.0));
        length_m.is_finite()
            && turn_rad.is_finite()
            && self.keeps_room(pose, room_m, field)
            && self.keeps_room(pose.after_arc(arc, 1.0), room_m, field)
            && self.keeps_room_between((pose, arc), [0.0, 1.0], room_m, field)
    }

    /// The test between two fractions of an arc.
    fn keeps_room_between(
        &self,
        (pose, arc): (Pose, Velocity),
        [from, to]: [f64; 2],
        room_m: f64,
        field: &DistanceField,
    ) -> bool {
        let middle = 0.5 * (from + to);
        let at = pose.after_arc(arc, middle);
        let swing_m = match self {
            Self::Circle(_) => 0.0,
            Self::Polygon(_) => self.circumscribed_radius_m(),
        };
        let moves_m = (arc.v.abs() + swing_m * arc.omega.abs()) * 0.5 * (to - from);
        let least_m = LEAST_CELLS * field.frame().resolution_m();
        if self.keeps_room(at, room_m + moves_m + 1e-3 * least_m, field) {
            return true;
        }
        let halves =
            |[from, to]: [f64; 2]| self.keeps_room_between((pose, arc), [from, to], room_m, field);
        moves_m > least_m
            && self.keeps_room(at, room_m, field)
            && halves([from, middle])
            && halves([middle, to])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, OccupancyGrid};
    use proptest::prelude::*;

    fn field(rows: &[&str]) -> DistanceField {
        let map = OccupancyGrid::from_ascii(rows);
        DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default())
    }

    #[test]
    fn a_quarter_circle_around_a_pillar() {
        // From (1, 2) to the right around the square from (2, 1) to (3, 2), or through it.
        let obstacles = field(&["......", "......", "..#...", "......"]);
        let disc = Footprint::circle(0.4).unwrap();
        let is_free = |x: f64, radius_m: f64| {
            let pose = Pose::new(x, 1.2, std::f64::consts::FRAC_PI_2);
            let quarter = std::f64::consts::FRAC_PI_2;
            disc.keeps_room_on_arc(pose, [radius_m * quarter, -quarter], 0.0, &obstacles)
        };
        assert!(is_free(1.0, 1.7));
        assert!(!is_free(1.0, 0.7));
    }

    proptest! {
        /// An arc without a turn is a straight drive, and one without a length a turn. Sampled
        /// poses of a free one are free, and those of one that is not come near to something.
        #[test]
        fn it_agrees_with_drives_turns_and_samples(
            x in 1.0..9.0_f64, y in 1.0..5.0_f64, theta in -3.2..3.2_f64,
            length_m in -2.0..2.0_f64, turn_rad in -2.0..2.0_f64, room_m in 0.0..0.3_f64, is_round: bool,
        ) {
            let obstacles = field(&["..........", "...#......", "......#...", ".#........", "......#...", ".........."]);
            let footprint =
                if is_round { Footprint::circle(0.3) } else { Footprint::rectangle(0.8, 0.5) };
            let (footprint, pose) = (footprint.unwrap(), Pose::new(x, y, theta));
            let on_arc = |length_m, turn_rad, room_m| {
                footprint.keeps_room_on_arc(pose, [length_m, turn_rad], room_m, &obstacles)
            };
            // Each may refuse what comes within a thousandth of a cell of the clearance.
            let drives = |room_m| footprint.keeps_room_driving(pose, length_m, room_m, &obstacles);
            prop_assert!(!on_arc(length_m, 0.0, room_m + 0.002) || drives(room_m));
            prop_assert!(!drives(room_m + 0.002) || on_arc(length_m, 0.0, room_m));
            let turns = |room_m| {
                let turn = [theta, turn_rad];
                footprint.keeps_room_turning(pose.point(), turn, room_m, &obstacles)
            };
            prop_assert!(!on_arc(0.0, turn_rad, room_m + 0.002) || turns(room_m));
            prop_assert!(!turns(room_m + 0.002) || on_arc(0.0, turn_rad, room_m));
            let all = |room_m| (0..=200).all(|i| {
                let at = pose.after_arc(Velocity::new(length_m, turn_rad), f64::from(i) / 200.0);
                footprint.keeps_room(at, room_m, &obstacles)
            });
            let is_free = on_arc(length_m, turn_rad, room_m);
            prop_assert!(!is_free || all(room_m));
            prop_assert!(is_free || !all(room_m + 0.02));
        }
    }
}
