//! How the positions of a route are joined to the cells of its path.

use crate::geometry::{Point, Segment};
use crate::map::{Cell, Clearance, SearchMap};
use crate::plan::{PathEnd, PlanError, check_end};

/// How a position is joined to the cells of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum EndRule {
    /// By the cell in which it lies; the planner refuses a blocked one.
    #[default]
    OwnCell,
    /// By the cell in which it lies if that is free, otherwise by the nearest free one, if a disc
    /// can go there straight. Where the disc has no room even at the position (a cell was sensed
    /// too near), the way may not come nearer than that.
    NearestFree {
        /// Radius of the disc \[m\].
        radius_m: f64,
    },
}

impl EndRule {
    /// The cell at which a route from (or to) a position meets the grid.
    ///
    /// # Errors
    /// Why the position's own cell cannot be used, where no other can be.
    pub(super) fn cell(
        &self,
        map: &SearchMap,
        end: PathEnd,
        position: Point,
    ) -> Result<Cell, PlanError> {
        let own = map.frame().cell_near(position);
        let Self::NearestFree { radius_m } = *self else { return Ok(own) };
        let Err(why) = check_end(map, end, own) else { return Ok(own) };
        let PlanError::Blocked { nearest: Some(cell), .. } = why else { return Err(why) };
        let way = Segment::new(position, map.frame().world_from_cell(cell));
        let room_m = map.clearance().of_point(position, radius_m);
        if map.clearance().is_clear(way, room_m) { Ok(cell) } else { Err(why) }
    }

    /// Room that a straight way from (or to) a position must keep \[m\], for a route that keeps
    /// `clearance_m`.
    pub(super) fn room_m(
        &self,
        clearance: Clearance<'_>,
        position: Point,
        clearance_m: f64,
    ) -> f64 {
        match *self {
            Self::OwnCell => clearance_m,
            Self::NearestFree { radius_m } => clearance.of_point(position, radius_m),
        }
    }

    /// What the smoothed line keeps where the path does: where cells are too coarse for a lane,
    /// shortcuts must still fit the disc.
    pub(super) fn clearance_m(&self, map: &SearchMap) -> f64 {
        match *self {
            Self::OwnCell => map.config().clearance_m,
            Self::NearestFree { radius_m } => map.config().clearance_m.max(radius_m),
        }
    }
}
