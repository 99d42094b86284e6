//! Masks of Nav2's costmap filters: keep-out zones and speed limits.

use super::Pilot;
use super::maps::{MapError, frame_of};
use crate::messages::nav_msgs::OccupancyGrid;
use crate::messages::nav2_msgs::CostmapFilterInfo;
use keyway::map::CellState;
use keyway::navigate::{Masks, SpeedMask};
use std::sync::Arc;

impl Pilot {
    /// Replaces the mask of its kind.
    pub(crate) fn take_mask(
        &mut self,
        info: &CostmapFilterInfo,
        mask: &OccupancyGrid,
    ) -> Result<(), MapError> {
        self.check_frame(&mask.header.frame_id)?;
        let full_mps = self.settings.stack.robot().limits.v_max_mps;
        match info.kind {
            CostmapFilterInfo::KEEP_OUT => self.masks.keep_out = Some(keep_out(mask)?),
            CostmapFilterInfo::SPEED_PERCENT => {
                self.masks.speed = Some(speeds(info, mask, 0.01 * full_mps)?);
            }
            CostmapFilterInfo::SPEED => self.masks.speed = Some(speeds(info, mask, 1.0)?),
            other => return Err(MapError::Frame(format!("unknown filter type {other}"))),
        }
        self.set_masks();
        Ok(())
    }

    /// Passes the masks to the navigator.
    pub(super) fn set_masks(&mut self) {
        if let Some(navigator) = &mut self.navigator {
            navigator.set_masks(Masks::clone(&self.masks));
        }
    }
}

/// Keep-out zone: cells that Nav2 forbids for the robot's centre.
fn keep_out(mask: &OccupancyGrid) -> Result<Arc<keyway::OccupancyGrid>, MapError> {
    const CLOSED: i8 = 99;
    let mut values = mask.data.iter();
    Ok(Arc::new(keyway::OccupancyGrid::from_fn(frame_of(mask)?, |_| match values.next() {
        Some(&value) if value >= CLOSED => CellState::Occupied,
        _ => CellState::Free,
    })))
}

/// Speed limits; 0 and unknown values are no limit, as in Nav2.
fn speeds(
    info: &CostmapFilterInfo,
    mask: &OccupancyGrid,
    unit_mps: f64,
) -> Result<SpeedMask, MapError> {
    let limit_mps = |&value: &i8| {
        let given = f64::from(info.base) + f64::from(info.multiplier) * f64::from(value);
        let is_limit = value > 0 && given > 0.0 && given.is_finite();
        if is_limit { given * unit_mps } else { f64::INFINITY }
    };
    let limits_mps = mask.data.iter().map(limit_mps).collect();
    SpeedMask::new(frame_of(mask)?, limits_mps).map_err(|error| MapError::Frame(error.to_string()))
}
