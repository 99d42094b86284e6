//! What it costs to come near to something that moves.

use super::room::Room;
use crate::geometry::Point;

/// A mover as it is expected to go on, in the positions of a lattice.
///
/// It keeps its velocity until it comes to something that stands; from then on it may go anywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foreseen {
    pub(super) centre: Point,
    pub(super) velocity_mps: Point,
    /// Centres that are farther apart do not touch: its radius and that of the robot \[m\].
    pub(super) reach_m: f64,
    /// A standard deviation of its position \[m\], of its velocity \[m/s\], and of what it accelerates \[m/s²\].
    pub(super) off_m: f64,
    pub(super) off_mps: f64,
    pub(super) off_mps2: f64,
    /// When it comes to something that stands \[s\].
    pub(super) wall_s: f64,
}

/// Everything that moves, in one cycle.
#[derive(Debug)]
pub(super) struct Meeting<'a> {
    pub(super) movers: &'a [Foreseen],
    /// Room to them that the robot likes to have \[m\].
    pub(super) comfortable_m: f64,
    /// What a second in contact counts as \[s\].
    pub(super) contact: f64,
}

impl Foreseen {
    /// It has come to a wall when it has less room than this part of its radius: movers also walk along walls.
    const WALL: f64 = 0.7;

    /// The part of its speed by which it becomes less certain where it is, once it may have turned around.
    const ASTRAY: f64 = 0.7;

    /// When it comes to something that stands, if that is within a horizon; a mover of this radius.
    pub(super) fn until_wall_s(&self, radius_m: f64, room: &Room, horizon_s: f64) -> f64 {
        let speed_mps = self.velocity_mps.norm();
        // It may stand beside a wall already.
        let least_m = Self::WALL * room.of_point(self.centre).min(radius_m);
        let mut after_s = 0.0;
        while after_s < horizon_s {
            let room_m = room.of_point(self.centre + self.velocity_mps * after_s);
            if room_m < least_m {
                return after_s;
            }
            after_s += (room_m - least_m).max(0.05) / speed_mps.max(1e-3);
        }
        horizon_s
    }

    /// Where it is expected, and a standard deviation of that \[m\].
    #[inline]
    fn at(&self, after_s: f64) -> (Point, f64) {
        let straight_s = after_s.min(self.wall_s);
        let astray_m = Self::ASTRAY * self.velocity_mps.norm() * (after_s - straight_s);
        // Errors that have nothing to do with each other.
        let (drifted_m, turned_m) = (self.off_mps * after_s, self.turned_away_m(after_s));
        let off_m = (self.off_m * self.off_m + drifted_m * drifted_m + turned_m * turned_m).sqrt();
        (self.centre + self.velocity_mps * straight_s, off_m + astray_m)
    }

    /// How far its accelerating leads \[m\]. What it changes its velocity by is no more than that velocity: who strolls does not begin to
    /// run.
    #[inline]
    fn turned_away_m(&self, after_s: f64) -> f64 {
        let most_mps = self.velocity_mps.norm();
        if self.off_mps2 * after_s <= most_mps {
            return 0.5 * self.off_mps2 * after_s * after_s;
        }
        most_mps * (after_s - 0.5 * most_mps / self.off_mps2)
    }
}

impl Meeting<'_> {
    /// What a second at a place costs a robot of this speed \[s\].
    ///
    /// With the gap g between the discs, the standard deviation s and the comfortable room n, it counts as
    /// `contact` R² / (R² + s²) (1 + |v| / 2) times
    /// - 1 - g / R, where the discs overlap (g < 0, R the distance at which they touch);
    /// - (0.1 + 0.4 s / (s + 0.1)) (1 - g / (n + 2 s))², up to g = n + 2 s: the less is known, the more likely a contact
    ///   is outside the disc, and the less likely it is inside.
    #[inline]
    pub(super) fn cost_s(&self, at: Point, after_s: f64, v_mps: f64) -> f64 {
        let mut sum = 0.0;
        for mover in self.movers {
            let (centre, off_m) = mover.at(after_s);
            let wide_m = self.comfortable_m + 2.0 * off_m;
            let enough_m = mover.reach_m + wide_m;
            let apart = at - centre;
            if apart.norm_sq() >= enough_m * enough_m {
                continue;
            }
            let gap_m = apart.norm() - mover.reach_m;
            let near = (1.0 - gap_m / wide_m).min(1.0);
            let grazing = 0.1 + 0.4 * off_m / (off_m + 0.1);
            let touching = if gap_m < 0.0 { 1.0 - gap_m / mover.reach_m } else { 0.0 };
            let reach_sq = mover.reach_m * mover.reach_m;
            let likely = reach_sq / (reach_sq + off_m * off_m);
            sum += likely * (grazing * near * near + touching);
        }
        self.contact * (1.0 + 0.5 * v_mps.abs()) * sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice::Lattice;
    use super::*;
    use crate::map::{DistanceField, FieldConfig, OccupancyGrid};

    const WALKER: Foreseen = Foreseen {
        centre: Point::new(5.0, 5.0),
        velocity_mps: Point::new(1.0, 0.0),
        reach_m: 0.5,
        off_m: 0.0,
        off_mps: 0.0,
        off_mps2: 0.0,
        wall_s: 100.0,
    };

    #[test]
    fn cost_by_hand() {
        let movers = [WALKER];
        let meeting = Meeting { movers: &movers, comfortable_m: 0.2, contact: 30.0 };
        let cost = |x: f64, after_s: f64| meeting.cost_s(Point::new(x, 5.0), after_s, 0.0);
        assert_eq!(cost(5.7, 0.0), 0.0, "0.2 m apart");
        assert!((cost(5.6, 0.0) - 30.0 * 0.1 * 0.25).abs() < 1e-9);
        assert!((cost(5.5, 0.0) - 3.0).abs() < 1e-9, "they touch");
        assert!((cost(5.0, 0.0) - 30.0 * (0.1 + 2.0)).abs() < 1e-9);
        assert_eq!(cost(5.0, 1.0), 0.0, "it has gone");
        assert!((cost(6.5, 1.0) - 3.0).abs() < 1e-9);
        let moving = meeting.cost_s(Point::new(6.5, 5.0), 1.0, 2.0);
        assert!((moving - 6.0).abs() < 1e-9, "twice as much at 2 m/s");
    }

    #[test]
    fn what_is_uncertain_is_wider_and_less_likely() {
        let sure = [WALKER];
        let unsure = [Foreseen { off_mps: 0.3, ..WALKER }];
        let cost = |movers: &[Foreseen], x: f64| {
            Meeting { movers, comfortable_m: 0.2, contact: 30.0 }.cost_s(
                Point::new(x, 5.0),
                1.0,
                0.0,
            )
        };
        assert!(cost(&unsure, 7.0) > 0.0 && cost(&sure, 7.0) == 0.0);
        assert!(cost(&unsure, 6.0) < cost(&sure, 6.0));
    }

    /// After 2 s: 0.3 m of its position, 0.4 m of its velocity, 1.17 m of what it accelerates.
    #[test]
    fn errors_add_up_in_squares() {
        let walker = Foreseen { off_m: 0.3, off_mps: 0.2, off_mps2: 0.6, ..WALKER };
        let (_, off_m) = walker.at(2.0);
        let exact_m = 0.3_f64.hypot(0.4).hypot(1.0 * (2.0 - 0.5 / 0.6));
        assert!(
            (off_m - exact_m).abs() < 1e-12,
            "{off_m}: it changes its velocity by no more than 1 m/s"
        );
    }

    #[test]
    fn at_a_wall_it_may_go_anywhere() {
        let map = OccupancyGrid::from_ascii(&["..........#"; 11]);
        let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
        let mut room = Room::default();
        room.fill(Lattice::around(map.frame(), Point::new(5.0, 5.0), 6.0, 1.0), &field, 9.0);
        let wall_s = WALKER.until_wall_s(0.4, &room, 20.0);
        // The wall begins at 10 m; the disc of 0.7 times its radius comes to it 0.28 m before.
        assert!((wall_s - 4.72).abs() < 0.5, "{wall_s}");
        assert_eq!(WALKER.until_wall_s(0.4, &room, 2.0), 2.0);
        let walker = Foreseen { wall_s: 2.0, ..WALKER };
        let (centre, off_m) = walker.at(3.0);
        assert!(centre.distance(Point::new(7.0, 5.0)) < 1e-12 && (off_m - 0.7).abs() < 1e-12);
    }
}
