//! Constraints from papers that any planner can satisfy.

use crate::ConfigError;
use crate::map::layers::dilation::check_reach;
use serde::{Deserialize, Serialize};

/// Distances that papers keep from obstacles, each in a measure of its own; none by default. They
/// hold in addition to [`crate::map::LayerConfig::clearance_m`], so that any planner can be
/// compared on the layers of a paper.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct PublishedConstraints {
    /// Obstacle expansion \[cells\] \[Wang2019, its expanded map\]: 1 blocks the 8 neighbours of
    /// every obstacle.
    pub expansion_cells: u32,
    /// Collision constraint L \[ZhuYin2024, eq. (2)\]: a cell is free only if its centre is at
    /// least this far from every obstacle's centre in the L1 norm, in reference cells; 0 for
    /// none. With cells of side s, this keeps L - s / 2 from an obstacle's square straight ahead
    /// and (L - s) / sqrt(2) past its corner: for L = 2, 1.5 and 0.71 m on cells of 1 m, 1.98 and
    /// 1.38 m on cells of 0.05 m.
    pub l1_constraint: f64,
    /// Side of the reference cell of [`Self::l1_constraint`] \[m\] \[ZhuYin2024: cells of 1 m\].
    pub reference_cell_m: f64,
}

impl PublishedConstraints {
    /// No constraint.
    pub const NONE: Self = Self { expansion_cells: 0, l1_constraint: 0.0, reference_cell_m: 1.0 };

    /// The collision constraint in metres.
    pub(in crate::map) const fn l1_m(&self) -> f64 {
        self.l1_constraint * self.reference_cell_m
    }

    /// Rejects numbers that cannot be used on cells of this side.
    pub(in crate::map) fn check(&self, resolution_m: f64) -> Result<(), ConfigError> {
        let cell_m = self.reference_cell_m;
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return Err(ConfigError::must_be("reference_cell_m", "a positive length", cell_m));
        }
        let l1_cells = self.l1_m() / resolution_m;
        check_reach("l1_constraint", l1_cells, self.l1_constraint)?;
        let expansion = f64::from(self.expansion_cells);
        check_reach("expansion_cells", expansion, expansion)
    }
}

impl Default for PublishedConstraints {
    fn default() -> Self {
        Self::NONE
    }
}
