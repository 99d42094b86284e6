//! Keep-out zones and speed zones.

use crate::ConfigError;
use crate::geometry::Point;
use crate::map::{CellState, GridFrame, OccupancyGrid};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Keep-out zones and speed zones, as in the costmap filters of Nav2. Each mask has its own
/// frame, which may differ from that of the map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Masks {
    /// Keep-out zones: occupied cells count as obstacles for every planner.
    pub keep_out: Option<Arc<OccupancyGrid>>,
    /// Speed zones.
    pub speed: Option<SpeedMask>,
}

/// Speed limits by position.
///
/// ```
/// use keyway::geometry::{Point, Pose};
/// use keyway::map::GridFrame;
/// use keyway::navigate::SpeedMask;
///
/// // Two cells of 5 m: at most 0.3 m/s in the right one.
/// let frame = GridFrame::new(2, 1, 5.0, Pose::default())?;
/// let mask = SpeedMask::new(frame, vec![f64::INFINITY, 0.3])?;
/// assert_eq!(mask.limit_mps(Point::new(7.0, 1.0)), 0.3);
/// assert_eq!(mask.limit_mps(Point::new(2.0, 1.0)), f64::INFINITY);
/// assert_eq!(mask.limit_mps(Point::new(-2.0, 1.0)), f64::INFINITY);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SpeedMaskParts")]
pub struct SpeedMask {
    frame: GridFrame,
    limits_mps: Arc<[f64]>,
}

/// A mask before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SpeedMaskParts {
    frame: GridFrame,
    limits_mps: Vec<f64>,
}

impl TryFrom<SpeedMaskParts> for SpeedMask {
    type Error = ConfigError;

    fn try_from(parts: SpeedMaskParts) -> Result<Self, ConfigError> {
        Self::new(parts.frame, parts.limits_mps)
    }
}

impl Masks {
    /// The state of a map's cell at a position, with keep-out zones as obstacles.
    pub(super) fn state(&self, place: Point, state: CellState) -> CellState {
        let Some(mask) = &self.keep_out else { return state };
        let cell = mask.frame().cell_from_world(place);
        let is_kept_out = cell.is_some_and(|cell| mask.occupied().get(cell));
        if is_kept_out { CellState::Occupied } else { state }
    }

    /// A map with keep-out zones as obstacles.
    pub(super) fn over(&self, map: &Arc<OccupancyGrid>) -> Arc<OccupancyGrid> {
        if self.keep_out.is_none() {
            return Arc::clone(map);
        }
        let frame = *map.frame();
        let state = |cell| map.state(cell).unwrap_or(CellState::Unknown);
        let masked = |cell| self.state(frame.world_from_cell(cell), state(cell));
        Arc::new(OccupancyGrid::from_fn(frame, masked))
    }

    /// The speed limit at a position \[m/s\]; infinite if there is none.
    pub(super) fn limit_mps(&self, place: Point) -> f64 {
        self.speed.as_ref().map_or(f64::INFINITY, |mask| mask.limit_mps(place))
    }
}

impl SpeedMask {
    /// A mask with the speed limit of each cell \[m/s\], row by row from the bottom; infinite for
    /// no limit.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if there is not one limit per cell, or if one is not positive.
    pub fn new(frame: GridFrame, limits_mps: Vec<f64>) -> Result<Self, ConfigError> {
        let cells = frame.width() as usize * frame.height() as usize;
        if limits_mps.len() != cells {
            let expected = format!("{cells} numbers, one for each cell");
            return Err(ConfigError::must_be("limits_mps", &expected, limits_mps.len() as f64));
        }
        let index = limits_mps.iter().position(|&limit_mps| limit_mps.is_nan() || limit_mps <= 0.0);
        if let Some(index) = index {
            let path = format!("limits_mps[{index}]");
            return Err(ConfigError::must_be(path, "a positive speed", limits_mps[index]));
        }
        Ok(Self { frame, limits_mps: limits_mps.into() })
    }

    /// The speed limit at a position \[m/s\]; infinite if there is none, and outside the mask.
    pub fn limit_mps(&self, place: Point) -> f64 {
        let index = |cell: crate::map::Cell| {
            cell.y as usize * self.frame.width() as usize + cell.x as usize
        };
        let cell = self.frame.cell_from_world(place);
        cell.map_or(f64::INFINITY, |cell| self.limits_mps[index(cell)])
    }
}
