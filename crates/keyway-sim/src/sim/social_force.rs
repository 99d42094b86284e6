//! Social force model: motion of a body that approaches a goal and gives way to others.
//!
//! Source: [Helbing1995] (the drive towards a goal, and the highest speed), with the interaction
//! of [Moussaid2009], which was measured between pairs of pedestrians. They turn aside as well as
//! brake:
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
//! | theta | the angle from t to `e_other`, plus [`BIAS_RADPM`] B |
//! | K | its sign |
//! | n | t turned to the left |
//!
//! The model differs from the sources in four points:
//! - d is the gap between two outlines, not the distance between two centres, because robots and
//!   obstacles have all sizes.
//! - A body straight ahead counts as slightly to the left, so that two bodies that meet both turn
//!   to their right ([Moussaid2009] has this bias, too, without a side).
//! - Walls exert no force.
//! - A term of the force with a total exponent below minus [`FARTHEST`] counts as zero: it would
//!   be 1.51 mm/s² at most. So a body farther away than [`FARTHEST`] B exerts no force.
//!
//! The model does not prevent contact. It costs a few operations for each pair of bodies near
//! each other; the angle and the exponentials are computed only for terms that count.

use super::overlapping::overlapping;
use keyway::geometry::{Disc, Point};
use std::f64::consts::FRAC_PI_2;

/// Relaxation time towards the desired velocity \[s\].
const RELAXATION_S: f64 = 0.54;
/// Highest speed as a multiple of the desired speed ([Helbing1995]).
pub(super) const FASTEST: f64 = 1.3;
/// Strength of the force between two bodies in contact \[m/s²\].
const STRENGTH_MPS2: f64 = 4.5;
/// Range of the force per length of D \[m\].
const GAMMA: f64 = 0.35;
/// Largest gap across which a body exerts a force, in ranges of the force. A term of the force
/// counts if it is at least A exp(-8).
const FARTHEST: f64 = 8.0;
/// Weight of the relative velocity in D \[s/m\].
const LAMBDA: f64 = 2.0;
/// Sharpness of turning aside.
const N: f64 = 2.0;
/// Sharpness of braking.
const N_PRIME: f64 = 3.0;
/// Bias added to the angle, per metre of B \[rad/m\].
const BIAS_RADPM: f64 = 0.005;

/// A round moving body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) centre: Point,
    pub(super) radius_m: f64,
    pub(super) velocity_mps: Point,
}

/// Adds the forces that all bodies exert on each other \[m/s²\], in the order of the bodies. A
/// body whose force is `None` does not give way.
pub(super) fn add_forces(bodies: &[Body], forces: &mut [Option<Point>]) {
    let reaches: Vec<Disc> = bodies.iter().map(Body::reach).collect();
    for (one, others) in overlapping(&reaches).into_iter().enumerate() {
        for other in others {
            if forces[one].is_none() && forces[other].is_none() {
                continue;
            }
            let force = bodies[one].force_of(&bodies[other]);
            forces[one] = forces[one].map(|sum| sum + force);
            // The reaction on the other body is the exact opposite, to the last bit.
            forces[other] = forces[other].map(|sum| sum - force);
        }
    }
}

impl Body {
    /// Returns the force that draws the body to a goal at a desired speed \[m/s²\].
    pub(super) fn drive(&self, goal: Point, speed_mps: f64) -> Point {
        let wanted_mps = unit(goal - self.centre) * speed_mps;
        (wanted_mps - self.velocity_mps) * RELAXATION_S.recip()
    }

    /// Returns the velocity after a time under a force \[m/s\].
    pub(super) fn next_velocity(&self, force: Point, speed_mps: f64, dt_s: f64) -> Point {
        // A long step must not overshoot.
        let velocity_mps = self.velocity_mps + force * dt_s.min(RELAXATION_S);
        let fastest_mps = FASTEST * speed_mps;
        velocity_mps * (fastest_mps / velocity_mps.norm().max(fastest_mps))
    }

    /// Disc of influence: two bodies exert forces on each other only if their discs overlap. |D|
    /// is at most the sum of the contributions of the two bodies.
    fn reach(&self) -> Disc {
        let range_m = GAMMA * (LAMBDA * self.velocity_mps.norm() + 0.5);
        // Rounding must not shrink the disc.
        let radius_m = (self.radius_m + FARTHEST * range_m) * (1.0 + 1e-9);
        Disc { centre: self.centre, radius_m }
    }

    /// Returns the force that another body exerts on this one \[m/s²\].
    fn force_of(&self, other: &Self) -> Point {
        let apart = other.centre - self.centre;
        let ahead = unit(apart);
        // Computed in the same order from both sides.
        let gap_m = (apart.norm() - (self.radius_m + other.radius_m)).max(0.0);
        let interaction = (self.velocity_mps - other.velocity_mps) * LAMBDA + ahead;
        let towards = unit(interaction);
        let range_m = GAMMA * interaction.norm();
        if range_m == 0.0 || gap_m > FARTHEST * range_m {
            return Point::default();
        }
        let (sin, cos) = (towards.cross(ahead), towards.dot(ahead));
        let exponent = |sharpness: f64, angle_rad: f64| {
            let width = sharpness * range_m * angle_rad;
            gap_m / range_m + width * width
        };
        // No angle is smaller than its sine.
        let least_rad = if cos > 0.0 { sin.abs() } else { FRAC_PI_2 } - BIAS_RADPM * range_m;
        if exponent(N, least_rad.max(0.0)) > FARTHEST {
            return Point::default();
        }
        let angle_rad = libm::atan2(sin, cos) + BIAS_RADPM * range_m;
        let share = |sharpness: f64| {
            let exponent = exponent(sharpness, angle_rad);
            if exponent > FARTHEST { 0.0 } else { STRENGTH_MPS2 * libm::exp(-exponent) }
        };
        let left = Point::new(-towards.y, towards.x);
        towards * -share(N_PRIME) + left * -share(N).copysign(angle_rad)
    }
}

/// Unit vector in the direction of a vector; zero for a vector without length.
fn unit(vector: Point) -> Point {
    let length = vector.norm();
    if length > 0.0 { vector * length.recip() } else { Point::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    use keyway::random::Random;
    use proptest::prelude::*;

    fn body(x: f64, y: f64, v: f64) -> Body {
        Body { centre: Point::new(x, y), radius_m: 0.25, velocity_mps: Point::new(v, 0.0) }
    }

    #[test]
    fn alone_the_wanted_velocity_is_taken_up_as_in_the_closed_form() {
        let mut walker = body(0.0, 0.0, 0.0);
        let (goal, dt_s) = (Point::new(100.0, 0.0), 0.001);
        for _ in 0..540 {
            walker.velocity_mps = walker.next_velocity(walker.drive(goal, 1.2), 1.2, dt_s);
        }
        // v0 (1 - exp(-t / tau)) after tau.
        let expected_mps = 1.2 * (1.0 - libm::exp(-1.0));
        assert!((walker.velocity_mps.x - expected_mps).abs() < 1e-3, "{walker:?}");
        assert_eq!(walker.velocity_mps.y, 0.0);
    }

    #[test]
    fn the_force_by_hand() {
        // Two bodies meet at 1 m/s each with a gap of 1 m: D = 2 * 2 + 1 = 5, B = 1.75, theta =
        // 0.00875.
        let force = body(0.0, 0.0, 1.0).force_of(&body(1.5, 0.0, -1.0));
        let range = libm::exp(-1.0 / 1.75);
        let brake = 4.5 * range * libm::exp(-(3.0_f64 * 1.75 * 0.00875).powi(2));
        let aside = 4.5 * range * libm::exp(-(2.0_f64 * 1.75 * 0.00875).powi(2));
        assert!((force.x + brake).abs() < 1e-12 && (force.y + aside).abs() < 1e-12, "{force:?}");
        // A body to the right is passed on the left. A body ahead at the same speed has little
        // effect.
        assert!(body(0.0, 0.0, 1.0).force_of(&body(1.5, -0.3, 0.0)).y > 0.0);
        assert!(body(0.0, 0.0, 1.0).force_of(&body(2.5, 0.0, 1.0)).norm() < 0.03);
    }

    #[test]
    fn nobody_is_faster_than_allowed() {
        let walker = body(0.0, 0.0, 1.0);
        let mut forces = vec![None; 21];
        forces[0] = Some(walker.drive(Point::new(9.0, 0.0), 1.0));
        let mut bodies = vec![body(-0.6, 0.0, 3.0); 21];
        bodies[0] = walker;
        add_forces(&bodies, &mut forces);
        let velocity_mps = walker.next_velocity(forces[0].unwrap(), 1.0, 0.5);
        assert!((velocity_mps.norm() - FASTEST).abs() < 1e-12, "{velocity_mps:?}");
    }

    #[test]
    fn who_is_far_is_not_looked_at() {
        let mut random = Random::new(3);
        let mut at = || random.between([0.0, 200.0]);
        let bodies: Vec<Body> = (0..1000).map(|_| body(at(), at(), 1.0)).collect();
        let reaches: Vec<Disc> = bodies.iter().map(Body::reach).collect();
        let pairs: usize = overlapping(&reaches).iter().map(Vec::len).sum();
        // Discs of 7.25 m around each: 2.1 % of all pairs, fewer at the border.
        assert!((5_000..10_500).contains(&pairs), "{pairs} of {}", 1000 * 999 / 2);
    }

    /// The force by its equations, with all terms.
    fn whole_force(one: &Body, other: &Body) -> Point {
        let apart = other.centre - one.centre;
        let gap_m = (apart.norm() - one.radius_m - other.radius_m).max(0.0);
        let d = (one.velocity_mps - other.velocity_mps) * 2.0 + unit(apart);
        let (t, b) = (unit(d), 0.35 * d.norm());
        let theta = libm::atan2(t.cross(unit(apart)), t.dot(unit(apart))) + 0.005 * b;
        let term = |n: f64| 4.5 * libm::exp(-gap_m / b) * libm::exp(-(n * b * theta).powi(2));
        t * -term(3.0) + Point::new(-t.y, t.x) * -term(2.0).copysign(theta)
    }

    proptest! {
        /// Checks that no omitted term is above A exp(-8), 1.51 mm/s².
        #[test]
        fn what_is_left_out_of_a_force_is_small(
            (x, y) in (0.1..12.0f64, -12.0..12.0f64), (vx, vy) in (-3.0..3.0f64, -3.0..3.0f64),
        ) {
            let one = Body { velocity_mps: Point::new(vx, vy), ..body(0.0, 0.0, 0.0) };
            let other = body(x, y, 0.7);
            let off = one.force_of(&other) - whole_force(&one, &other);
            prop_assert!(off.norm() < 1.51e-3 * std::f64::consts::SQRT_2, "{off:?}");
        }

        /// Compares the forces with the sum over all other bodies in their order, near or far, to
        /// the last bit.
        #[test]
        fn forces_are_those_of_all_others(
            bodies in prop::collection::vec(((-20.0..20.0f64, -20.0..20.0f64), 0.0..1.0f64, (-3.0..3.0f64, -3.0..3.0f64), any::<bool>()), 0..40),
        ) {
            let feels: Vec<bool> = bodies.iter().map(|body| body.3).collect();
            let body = |&((x, y), radius_m, (vx, vy), _): &_| {
                Body { centre: Point::new(x, y), radius_m, velocity_mps: Point::new(vx, vy) }
            };
            let bodies: Vec<Body> = bodies.iter().map(body).collect();
            let drive = |body: &Body| body.drive(Point::new(3.0, 4.0), 1.0);
            let drives = bodies.iter().zip(&feels).map(|(body, feels)| feels.then(|| drive(body)));
            let mut forces: Vec<Option<Point>> = drives.collect();
            add_forces(&bodies, &mut forces);
            for (own, body) in bodies.iter().enumerate() {
                let others = bodies.iter().enumerate().filter(|(other, _)| *other != own);
                let sum = others.fold(drive(body), |sum, (_, other)| sum + body.force_of(other));
                prop_assert_eq!(forces[own], feels[own].then_some(sum));
            }
        }
    }
}
