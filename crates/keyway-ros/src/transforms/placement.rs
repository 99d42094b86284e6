//! Placement of a frame in another one.

use keyway::geometry::Pose;

/// The 3-D pose of a frame in another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    /// Its origin \[m\].
    at: [f64; 3],
    /// Its rotation, as a quaternion (x, y, z, w) of length 1.
    turn: [f64; 4],
}

impl Default for Placement {
    /// The identity.
    fn default() -> Self {
        Self { at: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0] }
    }
}

impl Placement {
    /// Creates a placement from a quaternion (x, y, z, w), whose length may be slightly off.
    /// `None` for an invalid rotation, such as four zeros, or a position that is not finite.
    pub(crate) fn new(at: [f64; 3], turn: [f64; 4]) -> Option<Self> {
        const LEAST_NORM: f64 = 0.5;
        let norm = dot(turn, turn).sqrt();
        let is_usable = at.iter().chain(&turn).all(|value| value.is_finite()) && norm >= LEAST_NORM;
        is_usable.then(|| Self { at, turn: turn.map(|part| part / norm) })
    }

    /// An upright placement on the ground.
    #[cfg(test)]
    pub(crate) fn upright(pose: Pose) -> Self {
        let (z, w) = (0.5 * pose.theta).sin_cos();
        Self { at: [pose.x, pose.y, 0.0], turn: [0.0, 0.0, z, w] }
    }

    /// The projection to the ground: its position, and the heading of its x axis, as ROS computes
    /// yaw.
    pub(crate) fn on_ground(&self) -> Pose {
        let [x, y, z, w] = self.turn;
        let heading_rad = (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z);
        Pose::new(self.at[0], self.at[1], heading_rad)
    }

    /// True if up in one frame is down in the other.
    pub(crate) fn is_upside_down(&self) -> bool {
        let [x, y, z, w] = self.turn;
        w * w - x * x - y * y + z * z < 0.0
    }

    /// Transforms a point of this frame to the other one \[m\].
    pub(crate) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = turned(self.turn, point);
        [0, 1, 2].map(|axis| self.at[axis] + turned[axis])
    }

    /// The placement of a frame that is placed in this one.
    #[must_use]
    pub(super) fn compose(&self, inner: &Self) -> Self {
        Self { at: self.point(inner.at), turn: product(self.turn, inner.turn) }
    }

    /// The placement of the other frame in this one.
    #[must_use]
    pub(super) fn inverse(&self) -> Self {
        let [x, y, z, w] = self.turn;
        let turn = [-x, -y, -z, w];
        Self { at: turned(turn, self.at).map(|along| -along), turn }
    }

    /// Interpolates towards another placement by a share, with a uniform rotation along the
    /// shorter arc.
    #[must_use]
    pub(super) fn lerp(&self, to: &Self, share: f64) -> Self {
        /// Cosine above which rotations are mixed linearly, to avoid a division by zero.
        const SAME: f64 = 1.0 - 1e-12;
        let at = [0, 1, 2].map(|axis| self.at[axis] + share * (to.at[axis] - self.at[axis]));
        let cos = dot(self.turn, to.turn);
        let (side, cos) = (cos.signum(), cos.abs());
        let parts = if cos >= SAME {
            [1.0 - share, share]
        } else {
            let angle_rad = cos.acos();
            [(1.0 - share) * angle_rad, share * angle_rad].map(|part| part.sin() / angle_rad.sin())
        };
        let mixed =
            [0, 1, 2, 3].map(|axis| parts[0] * self.turn[axis] + side * parts[1] * to.turn[axis]);
        let norm = dot(mixed, mixed).sqrt();
        Self { at, turn: mixed.map(|part| part / norm) }
    }
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// Product of quaternions (x, y, z, w).
fn product([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    let across = cross([ax, ay, az], [bx, by, bz]);
    [
        aw * bx + bw * ax + across[0],
        aw * by + bw * ay + across[1],
        aw * bz + bw * az + across[2],
        aw * bw - (ax * bx + ay * by + az * bz),
    ]
}

/// Rotates a vector by a quaternion (x, y, z, w) of length 1.
fn turned([x, y, z, w]: [f64; 4], vector: [f64; 3]) -> [f64; 3] {
    let twice = cross([x, y, z], vector).map(|part| 2.0 * part);
    let across = cross([x, y, z], twice);
    [0, 1, 2].map(|axis| vector[axis] + w * twice[axis] + across[axis])
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::wrap_angle;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn is_at(found: [f64; 3], expected: [f64; 3]) -> bool {
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9)
    }

    /// The optical frame of a camera: z ahead, x to the right, y down.
    #[test]
    fn what_a_camera_sees_ahead_is_ahead() {
        let optical = Placement::new([0.2, 0.0, 0.5], [-0.5, 0.5, -0.5, 0.5]).unwrap();
        assert!(is_at(optical.point([0.0, 0.0, 2.0]), [2.2, 0.0, 0.5]), "{optical:?}");
        assert!(is_at(optical.point([0.3, 0.0, 2.0]), [2.2, -0.3, 0.5]), "to the right");
        assert!(is_at(optical.point([0.0, 0.4, 2.0]), [2.2, 0.0, 0.1]), "below");
        let turned = Placement::upright(Pose::new(1.0, 1.0, FRAC_PI_2)).compose(&optical);
        assert!(is_at(turned.point([0.0, 0.0, 2.0]), [1.0, 3.2, 0.5]));
    }

    /// A lidar mounted upside down and turned by a quarter: its left is ahead.
    #[test]
    fn upside_down_left_is_right() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quarter = Placement::upright(Pose::new(0.0, 0.0, FRAC_PI_2));
        let hangs = quarter.compose(&Placement::new([0.0; 3], [1.0, 0.0, 0.0, 0.0]).unwrap());
        assert!(hangs.is_upside_down() && (hangs.on_ground().theta - FRAC_PI_2).abs() < 1e-12);
        assert!(is_at(hangs.point([0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]), "{hangs:?}");
        let tilted = Placement::new([0.0; 3], [half, 0.0, 0.0, half]).unwrap();
        assert!(!tilted.compose(&tilted.inverse()).is_upside_down());
    }

    #[test]
    fn what_is_no_rotation_is_no_placement() {
        assert_eq!(Placement::new([0.0; 3], [0.0; 4]), None);
        assert_eq!(Placement::new([0.0; 3], [0.0, 0.0, 0.0, f64::NAN]), None);
        assert_eq!(Placement::new([f64::INFINITY, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]), None);
        let long = Placement::new([0.0; 3], [0.0, 0.0, 0.0, 1.01]).unwrap();
        assert_eq!(long, Placement::default());
    }

    fn placements() -> impl Strategy<Value = Placement> {
        let turn = [-1.0..1.0f64, -1.0..1.0, -1.0..1.0, -1.0..1.0];
        let at = [-9.0..9.0f64, -9.0..9.0, -9.0..9.0];
        (at, turn).prop_filter_map("a rotation", |(at, turn)| Placement::new(at, turn))
    }

    proptest! {
        #[test]
        fn there_and_back_is_nowhere(
            outer in placements(), inner in placements(), x in -9.0..9.0f64, y in -9.0..9.0f64,
        ) {
            let point = [x, y, 1.0];
            let both = outer.compose(&inner);
            prop_assert!(is_at(both.point(point), outer.point(inner.point(point))));
            let back = outer.inverse().compose(&both);
            prop_assert!(is_at(back.point(point), inner.point(point)), "{:?}", back);
        }

        /// On the ground it turns uniformly along the shorter arc.
        #[test]
        fn between_two_headings_are_those_in_between(
            from in -3.1..3.1f64, by in -3.0..3.0f64, share in 0.0..1.0f64,
        ) {
            let at = |heading| Placement::upright(Pose::new(0.0, 0.0, heading));
            let found = at(from).lerp(&at(from + by), share).on_ground().theta;
            prop_assert!(wrap_angle(found - from - share * by).abs() < 1e-6, "{}", found);
        }
    }
}
