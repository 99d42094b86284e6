//! The cost of coming near to a moving obstacle.

use super::room::Room;
use crate::geometry::Point;

/// Prediction of a moving obstacle, in the positions of a lattice.
///
/// It keeps its velocity until it reaches a stationary obstacle; from then on it may go anywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foreseen {
    pub(super) centre: Point,
    pub(super) velocity_mps: Point,
    /// Distance of the centres at contact: the sum of its radius and that of the robot \[m\].
    pub(super) reach_m: f64,
    /// Standard deviations of its position \[m\], of its velocity \[m/s\], and of its
    /// acceleration \[m/s²\].
    pub(super) off_m: f64,
    pub(super) off_mps: f64,
    pub(super) off_mps2: f64,
    /// Time at which it reaches a stationary obstacle \[s\].
    pub(super) wall_s: f64,
    /// Squared distances within which it matters, up to the end of each part of the horizon
    /// \[m²\].
    pub(super) matters_sq: [f64; PARTS],
}

/// Number of parts of the horizon.
const PARTS: usize = 16;

/// All moving obstacles in one cycle.
#[derive(Debug)]
pub(super) struct Meeting<'a> {
    pub(super) movers: &'a [Foreseen],
    /// Preferred clearance from them \[m\].
    pub(super) comfortable_m: f64,
    /// Cost of a second in contact \[s\].
    pub(super) contact: f64,
    /// Horizon of all trajectories, for which [`look_ahead`](Foreseen::look_ahead) was called
    /// \[s\].
    pub(super) horizon_s: f64,
}

impl Foreseen {
    /// It may matter anywhere.
    pub(super) const ALWAYS: [f64; PARTS] = [f64::INFINITY; PARTS];

    /// It has reached a wall if its clearance is below this fraction of its radius: pedestrians
    /// also walk along walls.
    const WALL: f64 = 0.7;

    /// Rate at which its position becomes less certain once it may have turned around, as a
    /// fraction of its speed.
    const ASTRAY: f64 = 0.7;

    /// Time until a moving obstacle of this radius reaches a stationary obstacle, up to a
    /// horizon.
    pub(super) fn until_wall_s(&self, radius_m: f64, room: &Room, horizon_s: f64) -> f64 {
        let speed_mps = self.velocity_mps.norm();
        // It may be beside a wall already.
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

    /// Sets the distances within which it matters, for a robot with a preferred clearance of
    /// `comfortable_m`. Its position becomes less certain all the time, so the end of a part
    /// decides.
    pub(super) fn look_ahead(&mut self, comfortable_m: f64, horizon_s: f64) {
        self.matters_sq = std::array::from_fn(|part| {
            let end_s = horizon_s * (part + 1) as f64 / PARTS as f64;
            let matters_m = self.reach_m + wide_m(comfortable_m, self.deviation_m(end_s));
            matters_m * matters_m
        });
    }

    /// Expected position.
    #[inline]
    fn centre_at(&self, after_s: f64) -> Point {
        self.centre + self.velocity_mps * after_s.min(self.wall_s)
    }

    /// Standard deviation of the expected position \[m\].
    #[inline]
    fn deviation_m(&self, after_s: f64) -> f64 {
        let straight_s = after_s.min(self.wall_s);
        let astray_m = Self::ASTRAY * self.velocity_mps.norm() * (after_s - straight_s);
        // The errors are independent.
        let (drifted_m, turned_m) = (self.off_mps * after_s, self.turned_away_m(after_s));
        let off_m = (self.off_m * self.off_m + drifted_m * drifted_m + turned_m * turned_m).sqrt();
        off_m + astray_m
    }

    /// Position error due to its acceleration \[m\]. The velocity changes by no more than the
    /// present speed: a strolling pedestrian does not begin to run.
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
    /// Relative increase of the cost on the left of a moving obstacle, and decrease on its right.
    const TO_THE_LEFT: f64 = 0.1;

    /// Cost of a second at a position for a robot with this velocity \[s\].
    ///
    /// With the gap g between the discs, the standard deviation s and the preferred clearance n,
    /// it is `contact` R² / (R² + s²) (1 + |v| / 2) times the sum of
    /// - 1 - g / R, if the discs overlap (g < 0, R the distance at which they touch);
    /// - (0.1 + 0.4 s / (s + 0.1)) (1 - g / (n + 2 s))², up to g = n + 2 s: the larger the
    ///   uncertainty, the more likely a contact is outside the disc, and the less likely it is
    ///   inside. It is up to [`Self::TO_THE_LEFT`] more on the left of a moving obstacle, and
    ///   less on its right, because two that mirror each other's motion would never get past.
    #[inline]
    pub(super) fn cost_s(&self, at: Point, after_s: f64, velocity_mps: Point) -> f64 {
        let part = (after_s / self.horizon_s * PARTS as f64) as usize;
        let part = part.min(PARTS - 1);
        let mut sum = 0.0;
        for mover in self.movers {
            let apart = at - mover.centre_at(after_s);
            let apart_sq = apart.norm_sq();
            // Most are far away: their square root is not computed.
            if apart_sq >= mover.matters_sq[part] {
                continue;
            }
            let off_m = mover.deviation_m(after_s);
            let wide_m = wide_m(self.comfortable_m, off_m);
            let enough_m = mover.reach_m + wide_m;
            if apart_sq >= enough_m * enough_m {
                continue;
            }
            let gap_m = apart_sq.sqrt() - mover.reach_m;
            let near = (1.0 - gap_m / wide_m).min(1.0);
            let grazing = 0.1 + 0.4 * off_m / (off_m + 0.1);
            let left = to_the_left(apart, velocity_mps - mover.velocity_mps);
            let grazing = grazing * (1.0 + Self::TO_THE_LEFT * left);
            let touching = if gap_m < 0.0 { 1.0 - gap_m / mover.reach_m } else { 0.0 };
            let reach_sq = mover.reach_m * mover.reach_m;
            let likely = reach_sq / (reach_sq + off_m * off_m);
            sum += likely * (grazing * near * near + touching);
        }
        self.contact * (1.0 + 0.5 * velocity_mps.norm()) * sum
    }
}

/// Degree to which a robot at the offset `apart` keeps to the left of a moving obstacle: from 1,
/// if they pass at a right angle, to -1, if it keeps to the right. Both sides of an encounter get
/// the same value.
#[inline]
fn to_the_left(apart: Point, relative_mps: Point) -> f64 {
    let most = (apart.norm_sq() * relative_mps.norm_sq()).sqrt();
    if most > 0.0 { relative_mps.cross(apart) / most } else { 0.0 }
}

/// The gap up to which a moving obstacle costs something \[m\].
#[inline]
fn wide_m(comfortable_m: f64, off_m: f64) -> f64 {
    comfortable_m + 2.0 * off_m
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
        matters_sq: Foreseen::ALWAYS,
    };

    const STANDING: Point = Point::new(0.0, 0.0);

    /// They approach each other with a lateral offset of 0.6 m.
    #[test]
    fn keeping_left_costs_more_and_both_agree() {
        let (robot, other) = (Point::new(4.0, 5.0), Point::new(5.0, 5.6));
        let (east, west) = (Point::new(1.0, 0.0), Point::new(-1.0, 0.0));
        let right = to_the_left(robot - other, east - west);
        let left = to_the_left(other - robot, east - west);
        assert!(right < -0.5 && left == -right, "{right} {left}");
        assert_eq!(right, to_the_left(other - robot, west - east));
        assert_eq!(left, to_the_left(robot - other, west - east));
        let cost = |y: f64| {
            let movers = [Foreseen { velocity_mps: west, ..WALKER }];
            let meeting =
                Meeting { movers: &movers, comfortable_m: 0.2, contact: 30.0, horizon_s: 3.1 };
            meeting.cost_s(Point::new(5.0, y), 0.0, east)
        };
        let (right, left) = (cost(4.4), cost(5.6));
        let more = (1.0 + Meeting::TO_THE_LEFT) / (1.0 - Meeting::TO_THE_LEFT);
        assert!((left / right - more).abs() < 1e-9, "{right} {left}");
    }

    #[test]
    fn cost_by_hand() {
        let movers = [WALKER];
        let meeting =
            Meeting { movers: &movers, comfortable_m: 0.2, contact: 30.0, horizon_s: 3.1 };
        let cost = |x: f64, after_s: f64| meeting.cost_s(Point::new(x, 5.0), after_s, STANDING);
        assert_eq!(cost(5.7, 0.0), 0.0, "0.2 m apart");
        assert!((cost(5.6, 0.0) - 30.0 * 0.1 * 0.25).abs() < 1e-9);
        assert!((cost(5.5, 0.0) - 3.0).abs() < 1e-9, "they touch");
        assert!((cost(5.0, 0.0) - 30.0 * (0.1 + 2.0)).abs() < 1e-9);
        assert_eq!(cost(5.0, 1.0), 0.0, "it has gone");
        assert!((cost(6.5, 1.0) - 3.0).abs() < 1e-9);
        let moving = meeting.cost_s(Point::new(6.5, 5.0), 1.0, Point::new(2.0, 0.0));
        assert!((moving - 6.0).abs() < 1e-9, "twice as much at 2 m/s");
    }

    #[test]
    fn what_is_uncertain_is_wider_and_less_likely() {
        let sure = [WALKER];
        let unsure = [Foreseen { off_mps: 0.3, ..WALKER }];
        let cost = |movers: &[Foreseen], x: f64| {
            Meeting { movers, comfortable_m: 0.2, contact: 30.0, horizon_s: 3.1 }.cost_s(
                Point::new(x, 5.0),
                1.0,
                STANDING,
            )
        };
        assert!(cost(&unsure, 7.0) > 0.0 && cost(&sure, 7.0) == 0.0);
        assert!(cost(&unsure, 6.0) < cost(&sure, 6.0));
    }

    /// The precomputed distances change no cost, and exclude everything far away.
    #[test]
    fn what_does_not_matter_costs_nothing() {
        let walker = Foreseen { off_m: 0.1, off_mps: 0.2, off_mps2: 0.6, wall_s: 1.5, ..WALKER };
        let mut ahead = walker;
        ahead.look_ahead(0.2, 3.1);
        // At the end: errors of 0.1, 0.62 and 2.27 m, and 1.12 m astray.
        let off_m = 0.1_f64.hypot(0.62).hypot(3.1 - 0.5 / 0.6) + 0.7 * 1.6;
        let matters_m = ahead.matters_sq.map(f64::sqrt);
        assert!((matters_m[PARTS - 1] - (0.5 + 0.2 + 2.0 * off_m)).abs() < 1e-12);
        assert!(matters_m.is_sorted() && matters_m[0] < 1.0);
        for i in 0..4000 {
            let (x, after_s) = (0.06 * f64::from(i % 400), 0.31 * f64::from(i / 400));
            let cost = |mover| {
                let meeting =
                    Meeting { movers: &[mover], comfortable_m: 0.2, contact: 30.0, horizon_s: 3.1 };
                meeting.cost_s(Point::new(x, 5.3), after_s, Point::new(0.3, 0.4))
            };
            assert_eq!(cost(ahead).to_bits(), cost(walker).to_bits(), "{x} {after_s}");
        }
    }

    /// After 2 s: 0.3 m from its position, 0.4 m from its velocity, 1.17 m from its acceleration.
    #[test]
    fn errors_add_up_in_squares() {
        let walker = Foreseen { off_m: 0.3, off_mps: 0.2, off_mps2: 0.6, ..WALKER };
        let off_m = walker.deviation_m(2.0);
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
        let (centre, off_m) = (walker.centre_at(3.0), walker.deviation_m(3.0));
        assert!(centre.distance(Point::new(7.0, 5.0)) < 1e-12 && (off_m - 0.7).abs() < 1e-12);
    }
}
