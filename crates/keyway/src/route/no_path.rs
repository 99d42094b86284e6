//! The reason why no path joins a start and a goal.

use crate::map::{
    Cell, Connectivity, LayerConfig, OccupancyGrid, SearchMap, Separation, UnknownPolicy,
};
use std::fmt::{self, Display, Formatter};

/// Separation of a start and a goal that no path joins.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NoPath {
    /// The clearance at which a path would exist, or the separation of the two.
    pub separation: Separation,
    /// True if a path would exist if unknown cells were free.
    pub is_joined_through_unknown: bool,
}

/// The separation of two cells; `None` if a path joins them or one of them is blocked. `grid` is
/// the map from which the layers of `map` were derived.
///
/// Costs several times as much as a search: meant for diagnostics on request, not for a control
/// cycle.
pub fn why_no_path(
    map: &SearchMap,
    grid: &OccupancyGrid,
    ends: [Cell; 2],
    connectivity: Connectivity,
) -> Option<NoPath> {
    let separation = map.separation(ends[0], ends[1], connectivity)?;
    let is_joined_through_unknown = is_joined_through_unknown(map, grid, ends, connectivity);
    Some(NoPath { separation, is_joined_through_unknown })
}

fn is_joined_through_unknown(
    map: &SearchMap,
    grid: &OccupancyGrid,
    ends: [Cell; 2],
    connectivity: Connectivity,
) -> bool {
    let config = LayerConfig { unknown: UnknownPolicy::Free, ..map.config().clone() };
    let can_differ = map.config().unknown == UnknownPolicy::Blocked;
    let Some(mut open) = SearchMap::new(grid, config).ok().filter(|_| can_differ) else {
        return false;
    };
    open.free_ends(&ends);
    let [from, to] = ends.map(|cell| open.component(cell, connectivity));
    from.is_some() && from == to
}

impl Display for NoPath {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { separation, is_joined_through_unknown } = self;
        write!(f, "{separation}")?;
        if *is_joined_through_unknown {
            f.write_str("; with `map.unknown` = \"free\", a path through unknown space exists")?;
        }
        Ok(())
    }
}
