//! Answers to a query without a search: whether its ends are free and connected.

use super::{PathEnd, PlanError};
use crate::map::{Cell, Connectivity, SearchMap};
use crate::search::{IfUnreachable, Query, SearchStatistics};

/// The query to be searched: both ends are on the map and free, and there is a path between them by
/// the steps of `connectivity`. Its goal is the one asked for, or the nearest cell that can be
/// reached where the query allows it.
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
            // A start that is free is itself a cell that can be reached.
            Ok(Query { goal: nearest.unwrap_or(query.start), ..*query })
        }
    }
}

/// Refuses an end that is outside the map, or blocked.
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
