//! Parameters of the tracker.

use crate::ConfigError;
use serde::{Deserialize, Serialize};

/// Parameters of [`Tracker`](super::Tracker).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TrackerConfig {
    /// Hits this near to an occupied cell of the known map are hits on it \[m\]; whole cells count.
    pub explained_m: f64,
    /// Successive hits that are farther apart than this belong to different things \[m\]; where
    /// beams are farther apart, twice their distance counts.
    pub gap_m: f64,
    /// Anything wider than this is no mover \[m\].
    pub largest_diameter_m: f64,
    /// A range is no farther than this from the truth \[m\], errors of the pose included.
    pub range_noise_m: f64,
    /// No mover is faster than this \[m/s\].
    pub speed_mps: f64,
    /// Movers hardly ever change their velocity faster than this \[m/s²\].
    pub acceleration_mps2: f64,
    /// A mover that stays where it is for this long counts as standing \[s\].
    pub standing_s: f64,
    /// A track is dropped when it has been out of view for this long \[s\].
    pub forget_s: f64,
}

impl Default for TrackerConfig {
    /// For people and other robots around a robot: up to 1.2 m wide, 2 m/s fast, accelerating at up
    /// to 2 m/s². Hits within 0.1 m of known walls are hits on them, ranges are right to 0.02 m,
    /// hits 0.2 m apart are two things; a mover stands after 2 s, and is remembered for 2 s.
    fn default() -> Self {
        Self {
            explained_m: 0.1,
            gap_m: 0.2,
            largest_diameter_m: 1.2,
            range_noise_m: 0.02,
            speed_mps: 2.0,
            acceleration_mps2: 2.0,
            standing_s: 2.0,
            forget_s: 2.0,
        }
    }
}

impl TrackerConfig {
    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("explained_m", self.explained_m)?;
        let positive = [
            ("gap_m", self.gap_m),
            ("largest_diameter_m", self.largest_diameter_m),
            ("range_noise_m", self.range_noise_m),
            ("speed_mps", self.speed_mps),
            ("acceleration_mps2", self.acceleration_mps2),
            ("standing_s", self.standing_s),
            ("forget_s", self.forget_s),
        ];
        let mut positive = positive.into_iter();
        positive.try_for_each(|(field, value)| ConfigError::unless_positive(field, value))
    }
}
