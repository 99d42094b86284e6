//! Round moving obstacles.

mod key_frames;
mod random_walk;
mod spline;
mod table;
mod way_points;

pub use key_frames::{KeyFrame, KeyFrames};
pub use random_walk::{RandomWalk, RandomWalkConfig};
pub use spline::Spline;
use table::MoverTable;
pub use way_points::WayPoints;

use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::given::Given;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// A round moving obstacle. It passes through other obstacles and gives way to nothing, unless
/// its motion says so.
///
/// In files and reports it is a table with its `radius_m` and the fields of one motion:
/// `position` and `velocity_mps`; or `key_frames`; or `spline` and `duration_s`; or `way_points`
/// and `speed_mps`, with `to_and_fro` if it turns back and `gives_way` if it gives way; or
/// `random_walk`.
///
/// ```
/// use keyway::geometry::Point;
/// use keyway_sim::sim::{ObstacleMotion, MovingObstacle, WayPoints};
///
/// let corners = vec![Point::new(0.0, 0.0), Point::new(4.0, 0.0), Point::new(4.0, 1.0)];
/// let motion = ObstacleMotion::WayPoints(WayPoints::to_and_fro(corners, 0.5)?);
/// let mover = MovingObstacle::new(0.25, motion)?;
/// assert_eq!(mover.at(9.0).centre, Point::new(4.0, 0.5));
/// assert_eq!(mover.at(12.0).centre, Point::new(4.0, 0.0));
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MoverTable", into = "MoverTable")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "MoverTable"))]
pub struct MovingObstacle {
    radius_m: f64,
    motion: ObstacleMotion,
}

/// Motion of an obstacle: its position at any time, bounds of its speed, and the times of its
/// jumps.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ObstacleMotion {
    /// Constant velocity, indefinitely.
    Straight {
        /// Position at time 0 \[m\].
        from: Point,
        /// Velocity \[m/s\].
        velocity_mps: Point,
    },
    /// Straight from position to position at given times.
    KeyFrames(KeyFrames),
    /// Smooth and periodic, through positions at given times. The obstacle may jump from the end
    /// of a lap to the beginning of the next.
    Spline(Spline),
    /// Closed path at constant speed, indefinitely.
    WayPoints(WayPoints),
    /// Random walk in a rectangle, indefinitely.
    RandomWalk(RandomWalk),
    /// From way-point to way-point, repeated, giving way to robots and other moving obstacles.
    /// The path depends on them, so this motion is stationary at its first way-point, and
    /// [`simulate`](super::simulate) computes the path ([`Run::movers`](super::Run::movers)).
    GivesWay(WayPoints),
}

impl ObstacleMotion {
    /// Position at a time \[m\]; at the instant of a jump, the position after it.
    pub fn position(&self, t_s: f64) -> Point {
        match self {
            Self::Straight { from, velocity_mps } => *from + *velocity_mps * t_s,
            Self::KeyFrames(frames) => frames.position(t_s),
            Self::Spline(spline) => spline.position(t_s),
            Self::WayPoints(points) => points.position(t_s),
            Self::RandomWalk(walk) => walk.position(t_s),
            Self::GivesWay(points) => points.points()[0],
        }
    }

    /// Position just before a time \[m\]: at the instant of a jump, the position before it;
    /// otherwise [`Self::position`].
    pub fn position_before(&self, t_s: f64) -> Point {
        if let Self::Spline(spline) = self {
            spline.position_before(t_s)
        } else {
            self.position(t_s)
        }
    }

    /// Time of the first jump after a time \[s\].
    pub fn next_jump_s(&self, t_s: f64) -> Option<f64> {
        if let Self::Spline(spline) = self { spline.next_jump_s(t_s) } else { None }
    }

    /// Time of the last jump that is not after a time \[s\].
    pub fn last_jump_s(&self, t_s: f64) -> Option<f64> {
        if let Self::Spline(spline) = self { spline.last_jump_s(t_s) } else { None }
    }

    /// Upper bound of the speed at any time from `from_s` to `to_s` \[m/s\], up to rounding.
    /// Jumps do not count. The bound of a part of the interval is not higher.
    pub fn speed_bound_mps(&self, from_s: f64, to_s: f64) -> f64 {
        match self {
            Self::Straight { velocity_mps, .. } => velocity_mps.norm(),
            Self::KeyFrames(frames) => frames.speed_bound_mps(from_s, to_s),
            Self::Spline(spline) => spline.speed_bound_mps(from_s, to_s),
            Self::WayPoints(points) => points.speed_mps(),
            Self::RandomWalk(walk) => walk.speed_bound_mps(from_s, to_s),
            Self::GivesWay(_) => 0.0,
        }
    }
}

impl MovingObstacle {
    /// Highest speed of an obstacle \[m/s\], except along a [`Spline`]. Contact is exact at every
    /// instant, so fast motion costs computing time.
    pub const FASTEST_MPS: f64 = 100.0;

    /// Speed above which a motion counts as darting \[m/s\]: nothing that walks or drives among
    /// robots is faster.
    pub const DART_MPS: f64 = 5.0;

    /// Creates an obstacle with this radius and motion.
    ///
    /// # Errors
    /// Returns an error if the radius is negative, the radius or the position is not finite, or
    /// the velocity is higher than [`Self::FASTEST_MPS`].
    pub fn new(radius_m: f64, motion: ObstacleMotion) -> Result<Self, ConfigError> {
        ConfigError::unless_not_negative("radius_m", radius_m)?;
        if let ObstacleMotion::Straight { from, velocity_mps } = &motion {
            unless_finite("position", *from)?;
            unless_finite("velocity_mps", *velocity_mps)?;
            unless_usable_speed("velocity_mps", velocity_mps.norm())?;
        }
        Ok(Self { radius_m, motion })
    }

    /// Creates an obstacle that moves at constant velocity, indefinitely.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn straight(from: Point, radius_m: f64, velocity_mps: Point) -> Result<Self, ConfigError> {
        Self::new(radius_m, ObstacleMotion::Straight { from, velocity_mps })
    }

    /// True for a random walk without a seed of its own.
    pub const fn needs_seed(&self) -> bool {
        matches!(&self.motion, ObstacleMotion::RandomWalk(walk) if walk.config().seed.is_none())
    }

    /// Returns the obstacle. If it [needs a seed](Self::needs_seed), it gets one derived from
    /// another seed and the `index` of the obstacle.
    #[must_use]
    pub fn seeded(self, seed: u64, index: u64) -> Self {
        let ObstacleMotion::RandomWalk(walk) = &self.motion else { return self };
        if !self.needs_seed() {
            return self;
        }
        // Seeds in files have at most 63 bits.
        let own = Random::stream(seed, &[index]).bits() >> 1;
        let config = RandomWalkConfig { seed: Some(own), ..walk.config().clone() };
        // Only the random choices change, so the configuration stays valid.
        let walk = RandomWalk::new(config).unwrap_or_else(|_| walk.clone());
        Self { motion: ObstacleMotion::RandomWalk(walk), ..self }
    }

    /// Radius \[m\].
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Motion of the obstacle.
    pub const fn motion(&self) -> &ObstacleMotion {
        &self.motion
    }

    /// Returns the obstacle with another motion.
    pub(super) const fn moving(&self, motion: ObstacleMotion) -> Self {
        Self { radius_m: self.radius_m, motion }
    }

    /// Appends a key frame to an obstacle that moves along key frames.
    pub(super) fn goes_on(&mut self, frame: KeyFrame) {
        if let ObstacleMotion::KeyFrames(frames) = &mut self.motion {
            frames.push(frame);
        }
    }

    /// Speed at a time \[m/s\]; the higher one if it changes abruptly.
    pub fn speed_mps(&self, t_s: f64) -> f64 {
        self.motion.speed_bound_mps(t_s, t_s)
    }

    /// Disc that the obstacle covers at a time.
    pub fn at(&self, t_s: f64) -> Disc {
        Disc::new(self.motion.position(t_s), self.radius_m)
    }
}

fn unless_finite(path: &str, point: Point) -> Result<(), ConfigError> {
    let bad = [point.x, point.y].into_iter().position(|coordinate| !coordinate.is_finite());
    bad.map_or(Ok(()), |axis| {
        let value = [point.x, point.y][axis];
        Err(ConfigError::must_be(format!("{path}[{axis}]"), "a finite number", value))
    })
}

fn unless_usable_speed(path: &str, speed_mps: f64) -> Result<(), ConfigError> {
    unless_faster(path, speed_mps, MovingObstacle::FASTEST_MPS)
}

/// Returns an error for a speed above a limit or NaN.
fn unless_faster(path: &str, speed_mps: f64, fastest_mps: f64) -> Result<(), ConfigError> {
    if speed_mps <= fastest_mps {
        return Ok(());
    }
    let got = Given(speed_mps);
    Err(ConfigError::new(path, format!("must be no faster than {fastest_mps} m/s, got {got} m/s")))
}

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(in crate::sim) use tests::{moving_obstacle, place_of};
