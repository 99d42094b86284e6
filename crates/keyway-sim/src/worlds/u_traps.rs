//! U-shaped obstacles.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// Squares of three walls, open to one of the four sides: local minima for a greedy planner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct UTraps {
    /// Number of obstacles.
    pub count: u32,
    /// Smallest and largest side \[m\].
    pub size_m: [f64; 2],
    /// Thickness of the walls \[m\].
    pub wall_m: f64,
}

impl UTraps {
    /// Largest supported number of obstacles.
    const MOST: u32 = 1_000_000;

    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_range("size_m", self.size_m)?;
        ConfigError::unless_positive("wall_m", self.wall_m)?;
        if self.count > Self::MOST {
            let count = f64::from(self.count);
            return Err(ConfigError::must_be("count", "at most 1000000", count));
        }
        if self.wall_m > 0.25 * self.size_m[0] {
            let expected = "at most a quarter of size_m[0]";
            return Err(ConfigError::must_be("wall_m", expected, self.wall_m));
        }
        Ok(())
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        for _ in 0..self.count {
            let size_m = random.between(self.size_m);
            let x = random.between([0.0, (width_m - size_m).max(0.0)]);
            let y = random.between([0.0, (height_m - size_m).max(0.0)]);
            let (low, high) = (Point::new(x, y), Point::new(x + size_m, y + size_m));
            let wall_m = self.wall_m;
            let walls = [
                (low, Point::new(low.x + wall_m, high.y)),
                (low, Point::new(high.x, low.y + wall_m)),
                (Point::new(high.x - wall_m, low.y), high),
                (Point::new(low.x, high.y - wall_m), high),
            ];
            let open = random.below(4) as usize;
            for (side, (low, high)) in walls.into_iter().enumerate() {
                if side != open {
                    canvas.fill_box(low, high);
                }
            }
        }
    }
}
