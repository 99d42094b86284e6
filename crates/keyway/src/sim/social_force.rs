//! How somebody on the way to a place gives way to others: the social force model.
//!
//! Source: [Helbing1995] (the drive towards a goal, and the highest speed), with the interaction of
//! [Moussaid2009], which was measured between pairs of people, who turn aside as well as brake:
//!
//! ```text
//! dv/dt = (v0 e - v) / tau + sum over others of f
//! D = lambda (v - v_other) + e_other,  t = D / |D|,  B = gamma |D|
//! f = -A exp(-d / B) (exp(-(n' B theta)^2) t + K exp(-(n B theta)^2) n)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | v0, e | `speed_mps`, the direction to `goal` |
//! | tau | [`RELAXATION_S`] |
//! | `e_other`, d | the direction to the other, and the gap to it |
//! | lambda, gamma, n, n', A | [`LAMBDA`], [`GAMMA`], [`N`], [`N_PRIME`], [`STRENGTH_MPS2`] |
//! | theta | the angle from t to `e_other`, and `BIAS` B |
//! | K | its sign |
//! | n | t turned to the left |
//!
//! It differs from the sources in three points. d is the gap between two outlines, not the distance of two centres: robots and
//! obstacles have all sizes. Who is straight ahead counts as slightly to the left, so that both who meet turn to their
//! right ([Moussaid2009] has this bias, too, without a side). Walls exert no force: nobody here sees any.
//!
//! Nothing in it forbids contact. It costs a few operations for each other.

use crate::geometry::Point;

/// Time in which the wanted velocity is taken up \[s\].
const RELAXATION_S: f64 = 0.54;
/// Nobody is faster than the wanted speed times this ([Helbing1995]).
pub(super) const FASTEST: f64 = 1.3;
/// Strength of the force between two at contact \[m/s²\].
const STRENGTH_MPS2: f64 = 4.5;
/// Range of the force per length of D \[m\].
const GAMMA: f64 = 0.35;
/// Weight of the relative velocity in D \[s/m\].
const LAMBDA: f64 = 2.0;
/// Sharpness of turning aside.
const N: f64 = 2.0;
/// Sharpness of braking.
const N_PRIME: f64 = 3.0;
/// What is added to the angle, per metre of B \[rad/m\].
const BIAS_RADPM: f64 = 0.005;

/// Something round that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) centre: Point,
    pub(super) radius_m: f64,
    pub(super) velocity_mps: Point,
}

impl Body {
    /// Its velocity after a time \[m/s\], on the way to a goal at a wanted speed among others.
    pub(super) fn next_velocity(
        &self,
        goal: Point,
        speed_mps: f64,
        others: impl Iterator<Item = Self>,
        dt_s: f64,
    ) -> Point {
        let wanted_mps = unit(goal - self.centre) * speed_mps;
        let drive = (wanted_mps - self.velocity_mps) * RELAXATION_S.recip();
        let force = others.fold(drive, |force, other| force + self.force_of(&other));
        // A long step must not overshoot.
        let velocity_mps = self.velocity_mps + force * dt_s.min(RELAXATION_S);
        let fastest_mps = FASTEST * speed_mps;
        velocity_mps * (fastest_mps / velocity_mps.norm().max(fastest_mps))
    }

    /// What another one exerts on this one \[m/s²\].
    fn force_of(&self, other: &Self) -> Point {
        let apart = other.centre - self.centre;
        let ahead = unit(apart);
        let gap_m = (apart.norm() - self.radius_m - other.radius_m).max(0.0);
        let interaction = (self.velocity_mps - other.velocity_mps) * LAMBDA + ahead;
        let towards = unit(interaction);
        let range_m = GAMMA * interaction.norm();
        if range_m == 0.0 {
            return Point::default();
        }
        let angle_rad = libm::atan2(towards.cross(ahead), towards.dot(ahead));
        let angle_rad = angle_rad + BIAS_RADPM * range_m;
        let share = |sharpness: f64| {
            let width = sharpness * range_m * angle_rad;
            STRENGTH_MPS2 * libm::exp(-gap_m / range_m - width * width)
        };
        let left = Point::new(-towards.y, towards.x);
        towards * -share(N_PRIME) + left * -share(N).copysign(angle_rad)
    }
}

/// The direction of a vector; none of no length.
fn unit(vector: Point) -> Point {
    let length = vector.norm();
    if length > 0.0 { vector * length.recip() } else { Point::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(x: f64, y: f64, v: f64) -> Body {
        Body { centre: Point::new(x, y), radius_m: 0.25, velocity_mps: Point::new(v, 0.0) }
    }

    #[test]
    fn alone_the_wanted_velocity_is_taken_up_as_in_the_closed_form() {
        let mut walker = body(0.0, 0.0, 0.0);
        let (goal, dt_s) = (Point::new(100.0, 0.0), 0.001);
        for _ in 0..540 {
            walker.velocity_mps = walker.next_velocity(goal, 1.2, std::iter::empty(), dt_s);
        }
        // v0 (1 - exp(-t / tau)) after tau.
        let expected_mps = 1.2 * (1.0 - libm::exp(-1.0));
        assert!((walker.velocity_mps.x - expected_mps).abs() < 1e-3, "{walker:?}");
        assert_eq!(walker.velocity_mps.y, 0.0);
    }

    #[test]
    fn the_force_by_hand() {
        // Two who meet at 1 m/s each with a gap of 1 m: D = 2 * 2 + 1 = 5, B = 1.75, theta = 0.00875.
        let force = body(0.0, 0.0, 1.0).force_of(&body(1.5, 0.0, -1.0));
        let range = libm::exp(-1.0 / 1.75);
        let brake = 4.5 * range * libm::exp(-(3.0_f64 * 1.75 * 0.00875).powi(2));
        let aside = 4.5 * range * libm::exp(-(2.0_f64 * 1.75 * 0.00875).powi(2));
        assert!((force.x + brake).abs() < 1e-12 && (force.y + aside).abs() < 1e-12, "{force:?}");
        // Somebody to the right is passed on the left, and one who goes ahead at the same speed is far.
        assert!(body(0.0, 0.0, 1.0).force_of(&body(1.5, -0.3, 0.0)).y > 0.0);
        assert!(body(0.0, 0.0, 1.0).force_of(&body(2.5, 0.0, 1.0)).norm() < 0.03);
    }

    #[test]
    fn nobody_is_faster_than_allowed() {
        let walker = body(0.0, 0.0, 1.0);
        let behind = std::iter::repeat_n(body(-0.6, 0.0, 3.0), 20);
        let velocity_mps = walker.next_velocity(Point::new(9.0, 0.0), 1.0, behind, 0.5);
        assert!((velocity_mps.norm() - FASTEST).abs() < 1e-12, "{velocity_mps:?}");
    }
}
