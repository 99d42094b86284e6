//! How the layers of a search follow from a map.

use crate::ConfigError;
use crate::map::GridFrame;
use crate::map::layers::dilation::BlockedNeighbourhood;
use serde::{Deserialize, Serialize};

/// What a search makes of unknown cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum UnknownPolicy {
    /// They are obstacles.
    #[default]
    Blocked,
    /// They are free.
    Free,
    /// They may be crossed, but each step into one costs [`LayerConfig::unknown_penalty`] times
    /// as much.
    Penalised,
}

/// How the blocked cells of a [`crate::map::SearchMap`] follow from an
/// [`crate::map::OccupancyGrid`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LayerConfig {
    /// What unknown cells are.
    pub unknown: UnknownPolicy,
    /// How many times the usual cost a step into a penalised unknown cell has.
    pub unknown_penalty: u32,
    /// Radius of the robot, or any clearance asked for: a cell is free only when its centre keeps
    /// this distance from every obstacle square, and when a disc of this radius does not leave the
    /// map.
    pub clearance_m: f64,
    /// Obstacle expansion \[cells\] \[Wang2019\]: 1 blocks the 8 neighbours of every obstacle.
    pub expansion_cells: u32,
    /// Collision constraint L \[ZhuYin2024, eq. (2)\]: a cell is free only when its centre is at
    /// least this far from every obstacle's centre in the L1 norm, in reference cells; 0 for none.
    /// With cells of side s that keeps L - s / 2 from an obstacle's square straight ahead and (L -
    /// s) / sqrt(2) past its corner: for L = 2, 1.5 and 0.71 m on cells of 1 m, 1.98 and 1.38 m on
    /// cells of 0.05 m.
    pub l1_constraint: f64,
    /// Side of the reference cell of [`Self::l1_constraint`] \[m\].
    pub reference_cell_m: f64,
    /// Radius of the discs around start and goal in which clearance, expansion and constraint are
    /// lifted (never obstacles) \[m\]; 0 for none.
    pub free_ends_m: f64,
}

impl Default for LayerConfig {
    fn default() -> Self {
        Self {
            unknown: UnknownPolicy::Blocked,
            unknown_penalty: 3,
            clearance_m: 0.0,
            expansion_cells: 0,
            l1_constraint: 0.0,
            reference_cell_m: 1.0,
            free_ends_m: 0.0,
        }
    }
}

/// The cells around an obstacle that it blocks, for each reason.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::map) struct Neighbourhoods {
    pub(in crate::map) clearance: BlockedNeighbourhood,
    pub(in crate::map) expansion: BlockedNeighbourhood,
    pub(in crate::map) constraint: BlockedNeighbourhood,
}

impl Neighbourhoods {
    /// What is blocked for any of the reasons.
    pub(in crate::map) fn union(&self) -> BlockedNeighbourhood {
        self.clearance.clone().union(&self.expansion).union(&self.constraint)
    }
}

impl LayerConfig {
    /// No wider neighbourhood than this may be asked for around an obstacle \[cells\].
    pub(crate) const MAX_REACH_CELLS: f64 = 100_000.0;
    /// Searches add up steps in numbers of 64 bits, of which one diagonal step takes 27, and add
    /// two such sums.
    const MAX_PENALISED_CELLS: u64 = 1 << 36;

    /// On a map of this size.
    pub(in crate::map) fn neighbourhoods(
        &self,
        frame: &GridFrame,
    ) -> Result<Neighbourhoods, ConfigError> {
        let resolution_m = frame.resolution_m();
        let side = frame.width().max(frame.height()) as i32;
        let check = |field, value: f64, ok: bool, expected| {
            if ok { Ok(()) } else { Err(ConfigError::must_be(field, expected, value)) }
        };
        let reach =
            |length_m: f64| length_m >= 0.0 && length_m / resolution_m <= Self::MAX_REACH_CELLS;
        let (clearance, l1, cell) = (self.clearance_m, self.l1_constraint, self.reference_cell_m);
        let length = "a length of at least 0 and at most 100000 cells";
        check("clearance_m", clearance, reach(clearance), length)?;
        check("reference_cell_m", cell, cell > 0.0 && cell.is_finite(), "a positive length")?;
        check("l1_constraint", l1, reach(l1 * cell), length)?;
        let expansion = f64::from(self.expansion_cells);
        check("expansion_cells", expansion, expansion <= Self::MAX_REACH_CELLS, length)?;
        check("free_ends_m", self.free_ends_m, reach(self.free_ends_m), length)?;
        let penalty = f64::from(self.unknown_penalty);
        let expected = "a factor from 1 to 1000";
        check("unknown_penalty", penalty, (1.0..=1000.0).contains(&penalty), expected)?;
        Ok(Neighbourhoods {
            clearance: BlockedNeighbourhood::disc(clearance / resolution_m, side),
            expansion: BlockedNeighbourhood::square(self.expansion_cells, side),
            constraint: BlockedNeighbourhood::diamond(l1 * cell / resolution_m, side),
        })
    }

    /// Refuses a penalty with which the cost of a way over all cells would not fit into a search's
    /// keys.
    pub(in crate::map) fn check_penalty(&self, cells: u64) -> Result<(), ConfigError> {
        let penalty = u64::from(self.unknown_penalty);
        if self.unknown != UnknownPolicy::Penalised
            || cells.saturating_mul(penalty) <= Self::MAX_PENALISED_CELLS
        {
            return Ok(());
        }
        let expected = "a factor whose product with the number of cells is at most 2^36";
        Err(ConfigError::must_be("unknown_penalty", expected, f64::from(self.unknown_penalty)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn penalties_fit_into_keys() {
        let penalised = |unknown_penalty| LayerConfig {
            unknown: UnknownPolicy::Penalised,
            unknown_penalty,
            ..LayerConfig::default()
        };
        assert_eq!(penalised(1000).check_penalty(1 << 26), Ok(()));
        let error = penalised(1000).check_penalty(199_000_000).unwrap_err();
        assert_eq!(error.path, "unknown_penalty");
        assert!(error.reason.ends_with(", got 1000"), "{error}");
        assert_eq!(LayerConfig::default().check_penalty(u64::MAX), Ok(()));
    }
}
