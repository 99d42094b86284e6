//! Rules that join the start and goal positions of a route to the cells of its path.

use crate::geometry::{Point, Segment};
use crate::map::{Cell, Clearance, SearchMap};
use crate::plan::{PathEnd, PlanError, check_end};

/// Rule that joins a position to a cell of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum EndRule {
    /// The cell that contains the position; the planner refuses a blocked one.
    #[default]
    OwnCell,
    /// The cell that contains the position if it is free, otherwise the nearest free cell if a
    /// disc can reach it in a straight line. If the disc lacks clearance even at the position (a
    /// cell was sensed too close), the connection may not come closer to obstacles than the
    /// position itself.
    NearestFree {
        /// Radius of the disc \[m\].
        radius_m: f64,
    },
}

impl EndRule {
    /// The cell at which a route from (or to) a position meets the grid.
    ///
    /// # Errors
    /// Returns the error of the position's own cell if no other cell can be used either.
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

    /// Clearance that a straight connection from (or to) a position must keep \[m\], for a route
    /// that keeps `clearance_m`.
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

    /// Clearance that the smoothed line keeps wherever the path does \[m\]. On cells that are too
    /// coarse for a lane, shortcuts must still fit the disc.
    pub(super) fn clearance_m(&self, map: &SearchMap) -> f64 {
        match *self {
            Self::OwnCell => map.config().clearance_m,
            Self::NearestFree { radius_m } => map.config().clearance_m.max(radius_m),
        }
    }
}
