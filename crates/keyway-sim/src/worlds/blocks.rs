//! Randomly placed blocks of whole cells, as in published benchmark maps.

use super::canvas::Canvas;
use super::clutter::unless_share;
use keyway::ConfigError;
use keyway::map::Cell;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// Rectangles of whole cells at random positions, added until they cover a share of the map. They
/// may overlap and lie side by side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Blocks {
    /// Minimum share of the map that is covered, from 0 to 1. Cells that are then freed around
    /// starts, way-points and goals are not replaced.
    pub share: f64,
    /// Smallest and largest width and height \[m\], each rounded to a whole number of cells and at
    /// least one.
    pub side_m: [f64; 2],
}

impl Blocks {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        unless_share("share", self.share)?;
        ConfigError::unless_range("side_m", self.side_m)
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [columns, rows] = canvas.size_cells();
        // A block is at most as long as the map.
        let longest = f64::from(columns.max(rows));
        let cell_m = canvas.cell_m();
        let [least, most] = self.side_m.map(|m| (m / cell_m).round().clamp(1.0, longest) as u32);
        let wanted = self.share * f64::from(columns) * f64::from(rows);
        let mut covered = 0;
        while (covered as f64) < wanted {
            let low = Cell::new(random.below(columns) as i32, random.below(rows) as i32);
            let mut side = || (least + random.below(most - least + 1)) as i32;
            covered += canvas.fill_cells(low, side(), side());
        }
    }
}
