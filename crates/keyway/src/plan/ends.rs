//! Checks of start and goal before the search: both must be free and connected.

use super::{PathEnd, PlanError};
use crate::map::{Cell, Connectivity, SearchMap};
use crate::search::{IfUnreachable, Query, SearchStatistics};

/// Returns the query to search: start and goal are on the map and free, and a path with the steps
/// of `connectivity` joins them. The goal is the requested one, or the nearest reachable cell
/// where the query allows it.
///
/// Costs two look-ups in the map's components, which the first call computes.
pub(super) fn settle_ends(
    map: &SearchMap,
    query: &Query,
    connectivity: Connectivity,
) -> Result<Query, PlanError> {
    check_inside(map, PathEnd::Start, query.start)?;
    check_inside(map, PathEnd::Goal, query.goal)?;
    check_free(map, PathEnd::Start, query.start)?;
    let components = map.components(connectivity);
    let is_reachable = map.is_free(query.goal)
        && components.of_free(query.start) == components.of_free(query.goal);
    if is_reachable {
        return Ok(*query);
    }
    match query.if_unreachable {
        IfUnreachable::Fail => {
            check_free(map, PathEnd::Goal, query.goal)?;
            Err(PlanError::NoPath { statistics: SearchStatistics::default() })
        }
        IfUnreachable::NearestReachable => {
            let nearest = map.nearest_connected(query.start, query.goal, connectivity);
            // A free start is itself a reachable cell.
            Ok(Query { goal: nearest.unwrap_or(query.start), ..*query })
        }
    }
}

/// Refuses a start or goal that is outside the map or blocked.
pub(crate) fn check_end(map: &SearchMap, end: PathEnd, cell: Cell) -> Result<(), PlanError> {
    check_inside(map, end, cell)?;
    check_free(map, end, cell)
}

fn check_inside(map: &SearchMap, end: PathEnd, cell: Cell) -> Result<(), PlanError> {
    if map.frame().contains(cell) {
        return Ok(());
    }
    let (width, height) = (map.frame().width(), map.frame().height());
    Err(PlanError::OutsideMap { end, cell, width, height })
}

fn check_free(map: &SearchMap, end: PathEnd, cell: Cell) -> Result<(), PlanError> {
    match map.blocked_by(cell) {
        None => Ok(()),
        Some(by) => Err(PlanError::Blocked { end, cell, by, nearest: map.nearest_free(cell) }),
    }
}
