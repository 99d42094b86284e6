//! The corner rule of a planner.

use keyway::map::Connectivity;
use keyway::plan::GlobalPlanner;
use keyway::search::CornerRule;

/// Returns the corner rule that the connectivity of a planner implies: only planners that cut
/// corners reach cells over a corner.
pub fn corner_rule(planner: &dyn GlobalPlanner) -> CornerRule {
    match planner.connectivity() {
        Connectivity::Four => CornerRule::Forbid,
        Connectivity::Eight => CornerRule::Allow,
    }
}
