//! Discs at given positions.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::Point;
use serde::{Deserialize, Serialize};

/// Discs in the world frame, `[x, y, radius]` each \[m\]; parts of them outside the map are
/// ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct Discs(pub Vec<[f64; 3]>);

impl Discs {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        for (i, [x, y, radius_m]) in self.0.iter().enumerate() {
            for (axis, value) in [x, y].into_iter().enumerate() {
                if !value.is_finite() {
                    let field = format!("discs[{i}][{axis}]");
                    return Err(ConfigError::must_be(field, "a finite number", *value));
                }
            }
            ConfigError::unless_not_negative(&format!("discs[{i}][2]"), *radius_m)?;
        }
        Ok(())
    }

    /// Draws the discs on a map whose lower left corner lies at `origin`.
    pub(super) fn draw(&self, canvas: &mut Canvas, origin: Point) {
        for &[x, y, radius_m] in &self.0 {
            canvas.fill_disc(Point::new(x, y) - origin, radius_m);
        }
    }
}
