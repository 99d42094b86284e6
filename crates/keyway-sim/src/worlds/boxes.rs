//! Boxes at given positions, rotated together.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::{Point, Pose};
use serde::{Deserialize, Serialize};

/// Boxes at given positions, independent of the seed. They may overlap, and extend beyond the
/// map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Boxes {
    /// Lower left and upper right corner of each box before the rotation, in the world frame:
    /// `[x, y, x, y]` \[m\].
    pub boxes: Vec<[f64; 4]>,
    /// Angle by which all boxes are rotated about the middle of the map \[deg\],
    /// counter-clockwise.
    #[serde(default)]
    pub turned_deg: f64,
}

impl Boxes {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        for (i, of) in self.boxes.iter().enumerate() {
            for (axis, value) in of.iter().enumerate() {
                let field = format!("boxes[{i}][{axis}]");
                if !value.is_finite() {
                    return Err(ConfigError::must_be(&field, "a finite number", *value));
                }
                if axis >= 2 && *value < of[axis - 2] {
                    let expected = "no less than that of the lower left corner";
                    return Err(ConfigError::must_be(&field, expected, *value));
                }
            }
        }
        if !self.turned_deg.is_finite() {
            return Err(ConfigError::must_be("turned_deg", "a finite number", self.turned_deg));
        }
        Ok(())
    }

    /// Draws the boxes on a map whose lower left corner lies at `origin`.
    pub(super) fn draw(&self, canvas: &mut Canvas, origin: Point) {
        let [width_m, height_m] = canvas.size_m();
        let middle = Point::new(0.5 * width_m, 0.5 * height_m);
        let back = Pose::new(0.0, 0.0, -self.turned_deg.to_radians());
        canvas.fill_where(|at| {
            let Point { x, y } = middle + back.world_from_body(at - middle) + origin;
            let holds = |[left, low, right, top]: &[f64; 4]| {
                (*left..=*right).contains(&x) && (*low..=*top).contains(&y)
            };
            self.boxes.iter().any(holds)
        });
    }
}
