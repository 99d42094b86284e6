//! Planners of the papers' comparisons, as data.

use keyway::plan::{
    AStarConfig, BidirectionalAStarConfig, Heuristic, JpsConfig, PathCost, PlannerConfig,
};
use keyway::search::CornerRule;

/// Optimal planner without corner cutting: the yardstick of every comparison; no paper has one.
pub(super) const JPS: PlannerConfig = PlannerConfig::Jps(JpsConfig {});

/// A*, with the octile distance: shortest paths.
pub(super) const fn astar(corners: CornerRule) -> PlannerConfig {
    let (heuristic, g) = (Heuristic::Octile, PathCost::Accumulated);
    PlannerConfig::AStar(AStarConfig { corners, heuristic, g })
}

/// A* that cuts corners, with the Euclidean distance: shortest paths.
pub(super) const EUCLIDEAN_ASTAR: PlannerConfig = PlannerConfig::AStar(AStarConfig {
    corners: CornerRule::Allow,
    heuristic: Heuristic::Euclidean,
    g: PathCost::Accumulated,
});

/// A* as above, searching from both ends until the two sides first meet.
pub(super) const EUCLIDEAN_BIDIRECTIONAL_ASTAR: PlannerConfig =
    PlannerConfig::BidirectionalAStar(BidirectionalAStarConfig {
        corners: CornerRule::Allow,
        heuristic: Heuristic::Euclidean,
    });
