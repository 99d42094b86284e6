//! Randomly placed discs.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Discs of random sizes at random positions, which may overlap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Clutter {
    /// Total area of all discs as a share of the map's area, from 0 to 1. The discs overlap, so
    /// they cover less.
    pub share: f64,
    /// Smallest and largest radius \[m\].
    pub radius_m: [f64; 2],
}

impl Clutter {
    /// Largest supported number of discs.
    const MOST: f64 = 1e7;

    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        unless_share("share", self.share)?;
        ConfigError::unless_range("radius_m", self.radius_m)
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        let [low_m, high_m] = self.radius_m;
        // The mean of r² over the radii.
        let mean_m2 = PI * (low_m * low_m + low_m * high_m + high_m * high_m) / 3.0;
        let count = (self.share * width_m * height_m / mean_m2).round().min(Self::MOST);
        for _ in 0..count as u32 {
            let x = random.between([0.0, width_m]);
            let y = random.between([0.0, height_m]);
            canvas.fill_disc(Point::new(x, y), random.between(self.radius_m));
        }
    }
}

/// Returns an error for a value that is not from 0 to 1.
pub(super) fn unless_share(field: &str, value: f64) -> Result<(), ConfigError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(());
    }
    Err(ConfigError::must_be(field, "from 0 to 1", value))
}
