//! Conversion of an occupancy value to the state of a cell.
//!
//! # Source
//! `nav2_map_server/src/map_io.cpp` of Nav2, which saves a map by this rule. Nav2's costmaps
//! count all values but 100 as free, even a cell that nine of ten scans have seen occupied.

use super::CellState;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Thresholds of occupancy values (0 to 100): a cell is occupied from one value on, and free up to
/// the other. A value between the two is unknown, and so is one above 100.
///
/// ```
/// use keyway::map::{CellState, OccupancyThresholds};
/// let usual = OccupancyThresholds::default();
/// assert_eq!((usual.occupied(), usual.free()), (65, 25));
/// assert_eq!([25, 26, 64, 65].map(|value| usual.state(value)), [
///     CellState::Free, CellState::Unknown, CellState::Unknown, CellState::Occupied,
/// ]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OccupancyThresholds {
    occupied: u8,
    free: u8,
}

/// Reason why occupancy values, or their thresholds, cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OccupancyError {
    /// Thresholds that are out of order or out of range.
    #[error(
        "the occupied threshold must be from 1 to 100 and the free threshold below it, got {occupied} and {free}"
    )]
    Thresholds {
        /// The given threshold for occupied cells.
        occupied: u8,
        /// The given threshold for free cells.
        free: u8,
    },
    /// The number of values differs from that of cells.
    #[error("expected {expected} occupancy values, one for each cell, got {got}")]
    Count {
        /// The number of cells.
        expected: u64,
        /// The number of values.
        got: u64,
    },
    /// Not all cells are empty, yet no value comes near to occupied: usually a mask of 0 and 1.
    #[error(
        "the largest occupancy is {largest} of 100, so every cell would be free; pass an occupancy \
         mask as type bool"
    )]
    Mask {
        /// The largest value.
        largest: u8,
    },
}

impl Default for OccupancyThresholds {
    /// The thresholds of Nav2's map saver: 65 and 25.
    fn default() -> Self {
        Self { occupied: 65, free: 25 }
    }
}

impl OccupancyThresholds {
    /// Creates thresholds: occupied from the first on, free up to the second.
    ///
    /// # Errors
    /// Returns [`OccupancyError`] unless `free` is below `occupied`, and that is at most 100.
    pub const fn new(occupied: u8, free: u8) -> Result<Self, OccupancyError> {
        if free < occupied && occupied <= 100 {
            return Ok(Self { occupied, free });
        }
        Err(OccupancyError::Thresholds { occupied, free })
    }

    /// Converts the thresholds of a map file, as parts of 1. If they are exchanged, values that
    /// satisfy both are occupied; 0 never is.
    #[cfg(feature = "formats")]
    pub(super) fn of_file(occupied_thresh: f64, free_thresh: f64) -> Self {
        let percent = |part: f64| (100.0 * part).round_ties_even() as u8;
        let occupied = percent(occupied_thresh).clamp(1, 100);
        Self { occupied, free: percent(free_thresh).min(occupied - 1) }
    }

    /// The smallest value of an occupied cell.
    pub const fn occupied(self) -> u8 {
        self.occupied
    }

    /// The largest value of a free cell.
    pub const fn free(self) -> u8 {
        self.free
    }

    /// The state of a cell with this value.
    pub const fn state(self, value: u8) -> CellState {
        match value {
            101.. => CellState::Unknown,
            _ if value >= self.occupied => CellState::Occupied,
            _ if value <= self.free => CellState::Free,
            _ => CellState::Unknown,
        }
    }

    /// Rejects values that are usually a mask of 0 and 1: they are not all 0, and the largest is
    /// below the free threshold.
    ///
    /// # Errors
    /// Returns [`OccupancyError`] for such values.
    pub fn check(self, values: &[u8]) -> Result<(), OccupancyError> {
        let largest = values.iter().copied().filter(|&value| value <= 100).max().unwrap_or(0);
        if largest == 0 || largest >= self.free {
            return Ok(());
        }
        Err(OccupancyError::Mask { largest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use CellState::{Free, Occupied, Unknown};

    #[test]
    fn the_rule_of_the_map_saver() {
        let usual = OccupancyThresholds::default();
        let states = [0, 25, 26, 64, 65, 90, 99, 100, 101, 255].map(|value| usual.state(value));
        let expected = [
            Free, Free, Unknown, Unknown, Occupied, Occupied, Occupied, Occupied, Unknown, Unknown,
        ];
        assert_eq!(states, expected);
        let nav2 = OccupancyThresholds::new(100, 99).unwrap();
        assert_eq!(
            [0, 99, 100, 101].map(|value| nav2.state(value)),
            [Free, Free, Occupied, Unknown]
        );
    }

    #[test]
    fn thresholds_are_in_order() {
        for (occupied, free) in [(25, 65), (50, 50), (101, 25), (0, 0)] {
            let error = OccupancyThresholds::new(occupied, free).unwrap_err();
            assert_eq!(error, OccupancyError::Thresholds { occupied, free });
        }
        assert!(OccupancyThresholds::new(1, 0).is_ok());
    }

    #[test]
    fn a_mask_of_0_and_1_is_refused() {
        let check = |values: &[u8]| OccupancyThresholds::default().check(values);
        for (values, largest) in [(&[0, 1][..], 1), (&[1, 1], 1), (&[0, 24, 255], 24)] {
            let error = check(values).unwrap_err();
            assert_eq!(error, OccupancyError::Mask { largest });
            assert!(error.to_string().contains("bool"), "{error}");
        }
        for values in [&[0, 0][..], &[0, 255], &[255], &[], &[0, 25], &[1, 100]] {
            assert_eq!(check(values), Ok(()));
        }
        let all = OccupancyThresholds::new(1, 0).unwrap();
        assert_eq!(all.check(&[0, 1]), Ok(()));
    }
}
