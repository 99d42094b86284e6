//! Moving obstacles: their estimated state, and the area that they may reach in a given time.

use crate::ConfigError;
use crate::geometry::{Disc, Point};
use serde::{Deserialize, Serialize};

/// A moving obstacle of circular shape, as estimated at one instant. Frames and units are those
/// of the map.
///
/// ```
/// use keyway::geometry::Point;
/// use keyway::sense::{Mover, MoverBounds};
///
/// let walker = Mover {
///     velocity_mps: Point::new(1.0, 0.0),
///     position_uncertainty_m: 0.05,
///     velocity_uncertainty_mps: 0.2,
///     ..Mover::standing(0, Point::new(2.0, 1.0), 0.25)
/// };
/// // Whatever it does at up to 1.5 m/s:
/// let anywhere = MoverBounds { speed_mps: 1.5, acceleration_mps2: None };
/// let disc = walker.at(1.0, &anywhere);
/// assert_eq!(disc.centre, Point::new(2.0, 1.0));
/// assert!((disc.radius_m - (0.25 + 0.05 + 1.5)).abs() < 1e-12);
/// // What it is seen to do leaves less.
/// let inert = MoverBounds { speed_mps: 1.5, acceleration_mps2: Some(0.5) };
/// let disc = walker.at(1.0, &inert);
/// assert!(disc.centre.x > 2.9 && disc.radius_m < 0.8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mover {
    /// Identifier: constant from scan to scan and never reused for another obstacle.
    pub id: u64,
    /// Centre \[m\].
    pub centre: Point,
    /// Velocity \[m/s\].
    pub velocity_mps: Point,
    /// Radius \[m\].
    pub radius_m: f64,
    /// Time since the start of the track \[s\].
    pub age_s: f64,
    /// Time since it was last seen \[s\]; 0 if the last scan hit it.
    pub unseen_s: f64,
    /// Bound on the error of `centre` \[m\].
    pub position_uncertainty_m: f64,
    /// Bound on the error of `velocity_mps` \[m/s\].
    pub velocity_uncertainty_mps: f64,
}

/// A point on the surface of a moving obstacle that a beam has hit \[m\], and a possible velocity
/// of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovingPoint {
    pub(crate) place: Point,
    pub(crate) velocity_mps: Point,
}

/// Bounds on the motion of moving obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MoverBounds {
    /// Maximum speed \[m/s\].
    pub speed_mps: f64,
    /// Maximum acceleration \[m/s²\]. Without it, a moving obstacle may reverse instantly, and
    /// its estimated velocity does not predict its motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_mps2: Option<f64>,
}

impl MoverBounds {
    /// Checks every field.
    ///
    /// # Errors
    /// Returns [`ConfigError`] for the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("speed_mps", self.speed_mps)?;
        let acceleration_mps2 = self.acceleration_mps2.unwrap_or_default();
        ConfigError::unless_not_negative("acceleration_mps2", acceleration_mps2)
    }
}

impl Mover {
    /// A stationary obstacle of exactly known state, seen for the first time.
    pub const fn standing(id: u64, centre: Point, radius_m: f64) -> Self {
        Self {
            id,
            centre,
            velocity_mps: Point::new(0.0, 0.0),
            radius_m,
            age_s: 0.0,
            unseen_s: 0.0,
            position_uncertainty_m: 0.0,
            velocity_uncertainty_mps: 0.0,
        }
    }

    /// Prediction at constant velocity. The position uncertainty grows with the velocity
    /// uncertainty.
    pub(crate) fn after(&self, duration_s: f64) -> Self {
        Self {
            centre: self.centre + self.velocity_mps * duration_s,
            position_uncertainty_m: self.position_uncertainty_m
                + self.velocity_uncertainty_mps * duration_s,
            ..*self
        }
    }

    /// The area that it may cover now.
    pub fn now(&self) -> Disc {
        Disc { centre: self.centre, radius_m: self.radius_m + self.position_uncertainty_m }
    }

    /// The smallest disc that contains the area it may cover after `duration_s`: the intersection
    /// of [`Self::by_speed`] and [`Self::by_estimate`].
    pub fn at(&self, duration_s: f64, bounds: &MoverBounds) -> Disc {
        let by_speed = self.by_speed(duration_s, bounds);
        let Some(by_estimate) = self.by_estimate(duration_s, bounds) else { return by_speed };
        // Intersect the discs of the centre first, then add the body.
        let shrunk = |disc: Disc| Disc { radius_m: disc.radius_m - self.radius_m, ..disc };
        let centres = shrunk(by_speed).shared_with(&shrunk(by_estimate));
        Disc { radius_m: centres.radius_m + self.radius_m, ..centres }
    }

    /// The area that it may cover after `duration_s`, bounded by speed alone: any direction, at
    /// the larger of the maximum speed and its estimated speed.
    pub fn by_speed(&self, duration_s: f64, bounds: &MoverBounds) -> Disc {
        let now = self.now();
        let spread_m = self.fastest_mps(bounds) * duration_s;
        Disc { radius_m: now.radius_m + spread_m, ..now }
    }

    /// The area that it may cover after `duration_s` around the prediction at constant velocity,
    /// given the velocity uncertainty and the maximum acceleration; `None` without a maximum
    /// acceleration.
    pub fn by_estimate(&self, duration_s: f64, bounds: &MoverBounds) -> Option<Disc> {
        let now = self.now();
        let changed_mps = 0.5 * bounds.acceleration_mps2? * duration_s;
        let spread_m = (self.velocity_uncertainty_mps + changed_mps) * duration_s;
        Some(Disc {
            centre: now.centre + self.velocity_mps * duration_s,
            radius_m: now.radius_m + spread_m,
        })
    }

    /// The larger of the maximum speed and the estimated speed \[m/s\].
    pub(crate) fn fastest_mps(&self, bounds: &MoverBounds) -> f64 {
        bounds.speed_mps.max(self.velocity_mps.norm())
    }

    /// True if every number is finite and no length is negative.
    pub(crate) fn is_usable(&self) -> bool {
        let lengths = [self.radius_m, self.position_uncertainty_m, self.velocity_uncertainty_mps];
        self.centre.is_finite()
            && self.velocity_mps.is_finite()
            && lengths.iter().all(|length| (0.0..f64::INFINITY).contains(length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn shared_discs_by_hand() {
        let disc = |x: f64, radius_m: f64| Disc { centre: Point::new(x, 0.0), radius_m };
        // Circles of radius 5 and 5, 8 apart, intersect 3 above and below the middle.
        let shared = disc(0.0, 5.0).shared_with(&disc(8.0, 5.0));
        assert!((shared.centre.x - 4.0).abs() < 1e-12 && (shared.radius_m - 3.0).abs() < 1e-12);
        assert_eq!(disc(0.0, 5.0).shared_with(&disc(1.0, 2.0)), disc(1.0, 2.0));
        assert_eq!(disc(0.0, 5.0).shared_with(&disc(0.0, 2.0)), disc(0.0, 2.0));
        assert_eq!(disc(0.0, 1.0).shared_with(&disc(9.0, 2.0)), disc(0.0, 1.0), "nothing");
        // The intersection covers more than half of the smaller one.
        assert_eq!(disc(0.0, 5.0).shared_with(&disc(4.5, 2.0)), disc(4.5, 2.0));
    }

    #[test]
    fn bounds_that_cannot_be_used_are_named() {
        let bounds = MoverBounds { speed_mps: f64::NAN, acceleration_mps2: None };
        assert_eq!(bounds.validate().unwrap_err().path, "speed_mps");
        let bounds = MoverBounds { speed_mps: 1.0, acceleration_mps2: Some(-1.0) };
        assert_eq!(bounds.validate().unwrap_err().path, "acceleration_mps2");
        let text = toml::to_string(&MoverBounds { acceleration_mps2: None, ..bounds }).unwrap();
        assert_eq!(text.trim(), "speed_mps = 1.0");
    }

    proptest! {
        /// A moving obstacle that changes its velocity at random within the bounds always stays
        /// inside.
        #[test]
        fn a_mover_is_where_it_may_be(
            off in (-1.0..1.0f64, -1.0..1.0f64), velocity_off in (-1.0..1.0f64, -1.0..1.0f64),
            heading in -3.1..3.1f64, share in 0.0..1.0f64,
            pushes in prop::collection::vec((-3.1..3.1f64, 0.0..1.0f64), 20), has_acceleration: bool,
        ) {
            let acceleration_mps2 = has_acceleration.then_some(1.5);
            let bounds = MoverBounds { speed_mps: 1.2, acceleration_mps2 };
            let direction = |rad: f64| Point::new(libm::cos(rad), libm::sin(rad));
            let within = |(x, y): (f64, f64), most: f64| Point::new(x, y) * (most / 2f64.sqrt());
            let mut velocity = direction(heading) * (1.2 * share);
            let mut at = Point::new(1.0, 2.0);
            let mover = Mover {
                velocity_mps: velocity + within(velocity_off, 0.3),
                position_uncertainty_m: 0.1, velocity_uncertainty_mps: 0.3,
                ..Mover::standing(1, at + within(off, 0.1), 0.2)
            };
            for (step, &(towards, strength)) in pushes.iter().enumerate() {
                // Velocity jumps at the start of a step only if the acceleration is unbounded.
                let before = velocity;
                velocity = match acceleration_mps2 {
                    Some(most) => velocity + direction(towards) * (strength * most * 0.1),
                    None => direction(towards) * (strength * 1.2),
                };
                if velocity.norm() > 1.2 {
                    velocity = velocity * (1.2 / velocity.norm());
                }
                let mean = if has_acceleration { before.lerp(velocity, 0.5) } else { velocity };
                at = at + mean * 0.1;
                let elapsed_s = (step + 1) as f64 * 0.1;
                for disc in [mover.at(elapsed_s, &bounds), mover.by_speed(elapsed_s, &bounds)] {
                    let farthest_m = disc.centre.distance(at) + 0.2;
                    prop_assert!(farthest_m <= disc.radius_m + 1e-9, "{farthest_m} {disc:?}");
                }
            }
        }
    }
}
