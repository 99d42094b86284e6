//! The registry of all planners by name. A new planner is entered here only.

use super::parameters::PlannerParameters;
use super::{
    AStar, AStar4, AStar4Config, AStarConfig, Bidirectional24, Bidirectional24Config,
    BidirectionalAStar, BidirectionalAStarConfig, BidirectionalJps, BidirectionalJpsConfig,
    BidirectionalJpsFixed, BidirectionalJpsFixedConfig, BidirectionalOptimal,
    BidirectionalOptimalConfig, DensityAStar, DensityAStarConfig, Dijkstra, DijkstraConfig,
    GlobalPlanner, GreedyBestFirst, GreedyConfig, Hsta, HstaConfig, Jps, JpsConfig, LazyThetaStar,
    LazyThetaStarConfig, PlanError, PrepareProgress, Prepared, PreparedConfig, RatioAStar,
    RatioAStarConfig, Rrt, RrtConfig, ThetaStar, ThetaStarConfig,
};
use crate::ConfigError;
use crate::map::SearchMap;
use crate::registry::registry;
use std::ops::ControlFlow;

registry! {
    /// A planner and its parameters, as data.
    PlannerConfig by PlannerParameters;
    /// Dijkstra's algorithm: shortest paths, without a heuristic.
    Dijkstra(DijkstraConfig) => Dijkstra;
    /// Greedy best-first search: finds a path quickly, but not a shortest one.
    Greedy(GreedyConfig) => GreedyBestFirst;
    /// A*: shortest paths under either corner rule with the default heuristic and g.
    #[serde(rename = "astar")]
    AStar(AStarConfig) => AStar;
    /// A* with 4 neighbours: shortest paths without diagonal steps.
    #[serde(rename = "astar4")]
    AStar4(AStar4Config) => AStar4;
    /// Bidirectional A*: shortest paths, searched for from start and goal.
    BidirectionalOptimal(BidirectionalOptimalConfig) => BidirectionalOptimal;
    /// Jump point search: shortest paths without corner cutting, much faster than A*.
    Jps(JpsConfig) => Jps;
    /// Prepared map: shortest paths without corner cutting in microseconds, on a static map.
    Prepared(PreparedConfig) => Prepared;
    /// Bidirectional A* as usually published: finds a path quickly, where the searches from start
    /// and goal first meet.
    #[serde(rename = "bidirectional-astar")]
    BidirectionalAStar(BidirectionalAStarConfig) => BidirectionalAStar;
    /// Bidirectional A* with 24 neighbours: a path with steps in 16 directions.
    #[serde(rename = "bidirectional-24")]
    Bidirectional24(Bidirectional24Config) => Bidirectional24;
    /// Bidirectional jump point A* with fixed targets: each side aims at the other's root.
    BidirectionalJpsFixed(BidirectionalJpsFixedConfig) => BidirectionalJpsFixed;
    /// Improved bidirectional jump point A*: each side aims at the node that the other expanded
    /// last.
    BidirectionalJps(BidirectionalJpsConfig) => BidirectionalJps;
    /// Density-weighted A*: the weight of the estimate falls with the distance from the start, and
    /// the weight of the cost rises with the density of obstacles; not a shortest path.
    #[serde(rename = "density-astar")]
    DensityAStar(DensityAStarConfig) => DensityAStar;
    /// Weight-ratio A*: the estimate weighs X times as much as the cost; not a shortest path.
    #[serde(rename = "ratio-astar")]
    RatioAStar(RatioAStarConfig) => RatioAStar;
    /// HSTA*: bidirectional A* with a dynamic weight, a correction factor and a minimum distance
    /// from obstacles, which is lowered if it leaves no path; not shortest paths.
    Hsta(HstaConfig) => Hsta;
    /// Rapidly-exploring random tree: a path with many turns, from a seed.
    Rrt(RrtConfig) => Rrt;
    /// Theta*: paths in any direction, hardly longer than the shortest ones.
    ThetaStar(ThetaStarConfig) => ThetaStar;
    /// Lazy Theta*: paths in any direction like those of Theta*, with fewer line-of-sight checks.
    LazyThetaStar(LazyThetaStarConfig) => LazyThetaStar;
}

impl PlannerConfig {
    /// Scales distances to a robot that keeps this safe distance \[m\], instead of those of
    /// papers, whose cells are 1 m wide: the constraint of [`Hsta`] becomes as many safe distances
    /// as it was cells.
    #[must_use]
    pub fn keeping(mut self, safe_distance_m: f64) -> Self {
        if let Self::Hsta(config) = &mut self {
            *config = config.clone().keeping(safe_distance_m);
        }
        self
    }

    /// Checks the parameters as [`Self::build`] does, but without a map.
    ///
    /// # Errors
    /// Names the first parameter that is out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        self.parameters().check()
    }

    /// Builds the planner. `map` is the one that it will plan on, if it [needs a static
    /// map](Self::needs_static_map); other planners ignore it.
    ///
    /// # Errors
    /// Returns an error if a parameter is out of range, which the error names, or if the map
    /// cannot be prepared.
    pub fn build(
        &self,
        map: &SearchMap,
    ) -> Result<Box<dyn GlobalPlanner + Send + Sync>, PlanError> {
        self.parameters().build(map)
    }

    /// Like [`Self::build`], and reports the progress of the preparation, if there is one.
    /// `progress` may stop it.
    ///
    /// # Errors
    /// As for [`Self::build`]; and [`PrepareError::Stopped`](super::PrepareError::Stopped).
    pub fn build_with_progress(
        &self,
        map: &SearchMap,
        progress: &mut dyn FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> Result<Box<dyn GlobalPlanner + Send + Sync>, PlanError> {
        self.parameters().build_with_progress(map, progress)
    }

    /// True if its paths are shortest among those without corner cutting.
    pub fn is_optimal(&self) -> bool {
        self.parameters().is_optimal()
    }

    /// True if [`Self::build`] prepares the map: the planner is then invalid for any other map,
    /// and after an edit.
    pub fn needs_static_map(&self) -> bool {
        self.parameters().needs_static_map()
    }
}
