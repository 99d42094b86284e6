//! Obstacles that are present for a limited time, or that sensors miss.

use super::StandingPolygon;
use super::world::{to_circle, to_polygon};
use keyway::ConfigError;
use keyway::geometry::{Disc, Point, Pose};
use keyway::robot::Footprint;
use serde::Serialize;

/// An obstacle that is present for a limited time, or that sensors miss: a parcel, a door that
/// opens, a pane of glass, a low rail.
///
/// While it is present, contact is the same as with any other obstacle. It appears and disappears
/// at the beginning of the first cycle that is not before its time.
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
    /// A disc.
    Disc(Disc),
    /// A polygon.
    Polygon(StandingPolygon),
}

/// Time for which an obstacle is present, and its visibility to sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presence {
    /// Time at which it appears \[s\].
    pub from_s: f64,
    /// Time at which it disappears \[s\]; `None`: never.
    pub until_s: Option<f64>,
    /// Share of the beams on it that detect it, from 0 to 1, chosen independently for each beam
    /// and scan; the others pass through it. 0 for a low obstacle, or one of glass.
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
    /// Presence of an obstacle that is always there and is detected by every beam.
    pub const ALWAYS: Self = Self { from_s: 0.0, until_s: None, seen: 1.0 };

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
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
        // A cycle that begins at a time includes it, despite rounding.
        const ROUNDING_S: f64 = 1e-9;
        let t_s = t_s + ROUNDING_S;
        t_s >= self.from_s && self.until_s.is_none_or(|until_s| t_s < until_s)
    }
}

impl ElusiveObstacle {
    /// Creates an obstacle of this shape.
    ///
    /// # Errors
    /// Returns an error if a value of the presence is invalid, or the disc's centre or radius is
    /// not finite or its radius negative.
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

    /// Shape of the obstacle.
    pub const fn shape(&self) -> &ElusiveShape {
        &self.shape
    }

    /// Time for which it is present, and its visibility.
    pub const fn presence(&self) -> Presence {
        self.presence
    }

    /// True if the obstacle is present at a time.
    pub fn stands_at(&self, t_s: f64) -> bool {
        self.presence.includes(t_s)
    }

    /// Distance from a footprint at a pose \[m\]: 0 if they touch, `reach_m` if they are at least
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
