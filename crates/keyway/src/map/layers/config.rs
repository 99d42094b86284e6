//! Configuration of the layers that a search derives from a map.

use crate::ConfigError;
use crate::map::GridFrame;
use crate::map::layers::dilation::{BlockedNeighbourhood, check_reach};
use crate::map::layers::published::PublishedConstraints;
use serde::{Deserialize, Serialize};

/// Treatment of unknown cells by a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum UnknownPolicy {
    /// Unknown cells are obstacles.
    #[default]
    Blocked,
    /// Unknown cells are free.
    Free,
    /// Unknown cells may be crossed, but each step into one costs
    /// [`LayerConfig::unknown_penalty`] times as much.
    Penalised,
}

/// Rules that derive the blocked cells of a [`crate::map::SearchMap`] from a
/// [`crate::map::OccupancyGrid`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LayerConfig {
    /// Treatment of unknown cells.
    pub unknown: UnknownPolicy,
    /// Cost factor of a step into a penalised unknown cell.
    pub unknown_penalty: u32,
    /// Radius of the robot, or any required clearance \[m\]: a cell is free only if its centre
    /// keeps this distance from every obstacle square, and if a disc of this radius around it
    /// does not leave the map.
    pub clearance_m: f64,
    /// Radius of the discs around start and goal in which clearance, expansion and constraint are
    /// lifted (never obstacles) \[m\]; 0 for none.
    pub free_ends_m: f64,
    /// Constraints from papers, in addition to the clearance.
    pub published: PublishedConstraints,
}

impl Default for LayerConfig {
    fn default() -> Self {
        Self {
            unknown: UnknownPolicy::Blocked,
            unknown_penalty: 3,
            clearance_m: 0.0,
            free_ends_m: 0.0,
            published: PublishedConstraints::NONE,
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
    /// The cells blocked for any of the reasons.
    pub(in crate::map) fn union(&self) -> BlockedNeighbourhood {
        self.clearance.clone().union(&self.expansion).union(&self.constraint)
    }
}

impl LayerConfig {
    /// Largest number of cells times penalty. Searches sum steps in 64-bit numbers, of which one
    /// diagonal step takes 27 bits, and add two such sums.
    const MAX_PENALISED_CELLS: u64 = 1 << 36;

    /// The neighbourhoods on a map of this size.
    pub(in crate::map) fn neighbourhoods(
        &self,
        frame: &GridFrame,
    ) -> Result<Neighbourhoods, ConfigError> {
        let resolution_m = frame.resolution_m();
        let side = frame.width().max(frame.height()) as i32;
        let length = |field, length_m| check_reach(field, length_m / resolution_m, length_m);
        length("clearance_m", self.clearance_m)?;
        length("free_ends_m", self.free_ends_m)?;
        self.published.check(resolution_m).map_err(|error| error.within("published"))?;
        let penalty = f64::from(self.unknown_penalty);
        if !(1.0..=1000.0).contains(&penalty) {
            let expected = "a factor from 1 to 1000";
            return Err(ConfigError::must_be("unknown_penalty", expected, penalty));
        }
        Ok(Neighbourhoods {
            clearance: BlockedNeighbourhood::disc(self.clearance_m / resolution_m, side),
            expansion: BlockedNeighbourhood::square(self.published.expansion_cells, side),
            constraint: BlockedNeighbourhood::diamond(self.published.l1_m() / resolution_m, side),
        })
    }

    /// Rejects a penalty with which the cost of a path over all cells would not fit into a
    /// search's keys.
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
