//! What all planners share that search from both ends.

use super::Plan;
use crate::map::{CellIndex, SearchMap};
use crate::search::{Frontier, SearchStatistics};

/// What both sides did.
pub(super) const fn statistics(forward: &Frontier, backward: &Frontier) -> SearchStatistics {
    SearchStatistics { forward: forward.statistics(), backward: backward.statistics() }
}

/// Writes the path over a cell that both sides reached, where they met and what they did. The path's
/// waypoints are the nodes of the two searches.
pub(super) fn join(
    map: &SearchMap,
    (forward, backward): (&Frontier, &Frontier),
    meeting: CellIndex,
    plan: &mut Plan,
) {
    forward.path_into(map, meeting, &mut plan.cells);
    // The meeting cell ends the one half and begins the other.
    plan.cells.pop();
    backward.append_path_back(map, meeting, &mut plan.cells);
    plan.statistics = statistics(forward, backward);
    plan.meeting = Some(map.cell(meeting));
}
