//! Obstacles that stand for a time only, or that sensors miss.

use super::StandingPolygon;
use super::world::{to_circle, to_polygon};
use keyway::ConfigError;
use keyway::geometry::{Disc, Point, Pose};
use keyway::robot::Footprint;
use serde::Serialize;

/// An obstacle that stands for a time only, or that sensors miss: a parcel that is put down, a door
/// that opens, a pane of glass, a low rail.
///
/// Contact is as with any other obstacle while it stands. It appears and goes at the beginning of
/// the first cycle that is not before its time.
///
/// ```
/// use keyway::geometry::{Disc, Point};
/// use keyway_sim::sim::{ElusiveObstacle, ElusiveShape, Presence};
///
/// let parcel = ElusiveShape::Disc(Disc::new(Point::new(2.0, 1.0), 0.2));
/// let from_8_s = Presence { from_s: 8.0, ..Presence::ALWAYS };
/// let parcel = ElusiveObstacle::new(parcel, from_8_s)?;
/// assert!(!parcel.stands_at(7.9) && parcel.stands_at(8.0));
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(into = "ElusiveRow")]
pub struct ElusiveObstacle {
    shape: ElusiveShape,
    presence: Presence,
}

/// Shape of an elusive obstacle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ElusiveShape {
    /// A round one.
    Disc(Disc),
    /// A polygon.
    Polygon(StandingPolygon),
}

/// Time in which an obstacle stands, and how well sensors see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presence {
    /// Time at which it appears \[s\].
    pub from_s: f64,
    /// Time at which it goes \[s\]; `None`: never.
    pub until_s: Option<f64>,
    /// Share of the beams on it that see it, from 0 to 1, chosen independently for every beam and
    /// scan; the others pass through it. 0: something low or of glass.
    pub seen: f64,
}

/// An elusive obstacle in a report.
#[derive(Serialize)]
struct ElusiveRow {
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    vertices_m: Option<StandingPolygon>,
    from_s: f64,
    until_s: Option<f64>,
    seen: f64,
}

impl Presence {
    /// That of an obstacle that always stands and is seen by every beam.
    pub const ALWAYS: Self = Self { from_s: 0.0, until_s: None, seen: 1.0 };

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let Self { from_s, until_s, seen } = *self;
        if !(0.0..=1e9).contains(&from_s) {
            return Err(ConfigError::must_be("from_s", "a time from 0 to 1000000000 s", from_s));
        }
        if let Some(until_s) = until_s.filter(|until_s| until_s.is_nan() || *until_s <= from_s) {
            return Err(ConfigError::must_be("until_s", "a time after `from_s`", until_s));
        }
        if (0.0..=1.0).contains(&seen) {
            return Ok(());
        }
        Err(ConfigError::must_be("seen", "a share from 0 to 1", seen))
    }

    fn includes(self, t_s: f64) -> bool {
        // A cycle that begins at a time begins there, rounded or not.
        const ROUNDING_S: f64 = 1e-9;
        let t_s = t_s + ROUNDING_S;
        t_s >= self.from_s && self.until_s.is_none_or(|until_s| t_s < until_s)
    }
}

impl ElusiveObstacle {
    /// An obstacle of this shape.
    ///
    /// # Errors
    /// If a value of the presence cannot be used, or the disc's centre or radius is not finite or
    /// its radius negative.
    pub fn new(shape: ElusiveShape, presence: Presence) -> Result<Self, ConfigError> {
        presence.validate()?;
        if let ElusiveShape::Disc(disc) = &shape
            && !disc.is_valid()
        {
            let reason = "needs a finite centre and a radius of at least 0";
            return Err(ConfigError::new("the disc", reason));
        }
        Ok(Self { shape, presence })
    }

    /// Its shape.
    pub const fn shape(&self) -> &ElusiveShape {
        &self.shape
    }

    /// Time in which it stands, and how well it is seen.
    pub const fn presence(&self) -> Presence {
        self.presence
    }

    /// True if it stands at a time.
    pub fn stands_at(&self, t_s: f64) -> bool {
        self.presence.includes(t_s)
    }

    /// Distance from a footprint at a pose \[m\]: 0 if they meet, `reach_m` if they are at least
    /// that far apart.
    pub(super) fn distance_m(&self, footprint: &Footprint, pose: Pose, reach_m: f64) -> f64 {
        match &self.shape {
            ElusiveShape::Disc(disc) => to_circle(footprint, pose, disc, reach_m),
            ElusiveShape::Polygon(polygon) => to_polygon(footprint, pose, polygon, reach_m),
        }
    }
}

impl From<ElusiveObstacle> for ElusiveRow {
    fn from(ElusiveObstacle { shape, presence }: ElusiveObstacle) -> Self {
        let Presence { from_s, until_s, seen } = presence;
        let (position, radius_m, vertices_m) = match shape {
            ElusiveShape::Disc(disc) => (Some(disc.centre), Some(disc.radius_m), None),
            ElusiveShape::Polygon(polygon) => (None, None, Some(polygon)),
        };
        Self { position, radius_m, vertices_m, from_s, until_s, seen }
    }
}

#[cfg(test)]
mod tests;
