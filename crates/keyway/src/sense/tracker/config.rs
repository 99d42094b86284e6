//! Parameters of the tracker.

use crate::ConfigError;
use serde::{Deserialize, Serialize};

/// Parameters of [`Tracker`](super::Tracker).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TrackerConfig {
    /// Hits within this distance of an occupied cell of the known map are hits on it \[m\];
    /// rounded up to whole cells.
    pub explained_m: f64,
    /// Successive hits that are farther apart than this belong to different objects \[m\]. If
    /// neighbouring beams are farther apart, twice their distance is used.
    pub gap_m: f64,
    /// Largest diameter of a moving obstacle \[m\].
    pub largest_diameter_m: f64,
    /// Largest error of a range \[m\], errors of the pose included.
    pub range_noise_m: f64,
    /// Maximum speed of a moving obstacle \[m/s\].
    pub speed_mps: f64,
    /// Acceleration that moving obstacles hardly ever exceed \[m/s²\].
    pub acceleration_mps2: f64,
    /// A moving obstacle that stays at its position for this long becomes stationary \[s\].
    pub standing_s: f64,
    /// A track is dropped when it has been out of view for this long \[s\].
    pub forget_s: f64,
}

impl Default for TrackerConfig {
    /// Values for people and other robots: up to 1.2 m wide, up to 2 m/s, accelerating at up to 2
    /// m/s². Hits within 0.1 m of known walls are hits on them, ranges are accurate to 0.02 m,
    /// and hits more than 0.2 m apart are two objects. A moving obstacle becomes stationary after
    /// 2 s at its position, and is remembered for 2 s out of view.
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
    /// Checks every field.
    ///
    /// # Errors
    /// Returns [`ConfigError`] for the first field that cannot be used.
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
