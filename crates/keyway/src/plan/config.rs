//! All planners by name: the one place where a new one is entered.

use super::{
    AStar, AStar4, AStar4Config, AStarConfig, Bidirectional24, Bidirectional24Config,
    BidirectionalAStar, BidirectionalAStarConfig, BidirectionalJps, BidirectionalJpsConfig,
    BidirectionalJpsFixed, BidirectionalJpsFixedConfig, BidirectionalOptimal,
    BidirectionalOptimalConfig, DensityAStar, DensityAStarConfig, Dijkstra, DijkstraConfig,
    GlobalPlanner, GreedyBestFirst, GreedyConfig, Hsta, HstaConfig, Jps, JpsConfig, LazyThetaStar,
    LazyThetaStarConfig, PlanError, Prepared, PreparedConfig, RatioAStar, RatioAStarConfig, Rrt,
    RrtConfig, ThetaStar, ThetaStarConfig,
};
use crate::map::SearchMap;
use crate::search::CornerRule;
use serde::{Deserialize, Serialize};

/// Enters planners: documentation, variant, config, type, and how the one becomes the other.
macro_rules! planners {
    ($($(#[$attribute:meta])* $variant:ident($config:ty) => $planner:ty = $build:expr;)+) => {
        /// A planner and its parameters, as data.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(tag = "name", rename_all = "kebab-case")]
        #[non_exhaustive]
        pub enum PlannerConfig {
            $($(#[$attribute])* $variant($config),)+
        }

        impl PlannerConfig {
            /// Names of all planners, for [`Self::by_name`].
            pub const NAMES: [&'static str; [$(<$planner>::NAME),+].len()] = [$(<$planner>::NAME),+];

            /// A planner with its default parameters.
            pub fn by_name(name: &str) -> Option<Self> {
                $(if name == <$planner>::NAME {
                    return Some(Self::$variant(<$config>::default()));
                })+
                None
            }

            /// The planner's name.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => <$planner>::NAME,)+
                }
            }

            /// The planner. `map` is the one that it will plan on, if it [needs a static
            /// map](Self::needs_static_map); the others do not look at it.
            ///
            /// # Errors
            /// When a parameter cannot be used, which the error names, or the map cannot be prepared.
            pub fn build(
                &self,
                map: &SearchMap,
            ) -> Result<Box<dyn GlobalPlanner + Send + Sync>, PlanError> {
                Ok(match self {
                    $(Self::$variant(config) => {
                        let build: fn($config, &SearchMap) -> Result<$planner, PlanError> = $build;
                        Box::new(build(config.clone(), map)?)
                    })+
                })
            }
        }
    };
}

planners! {
    /// Dijkstra's algorithm: shortest paths, without any estimate of the rest.
    Dijkstra(DijkstraConfig) => Dijkstra = |config, _| Ok(Dijkstra::new(config));
    /// Greedy best-first search: some path quickly, not a shortest one.
    Greedy(GreedyConfig) => GreedyBestFirst = |config, _| Ok(GreedyBestFirst::new(config));
    /// A*: shortest paths under either corner rule, unless other parameters are changed.
    #[serde(rename = "astar")]
    AStar(AStarConfig) => AStar = |config, _| Ok(AStar::new(config));
    /// A* with 4 neighbours: shortest paths without diagonal steps.
    #[serde(rename = "astar4")]
    AStar4(AStar4Config) => AStar4 = |config, _| Ok(AStar4::new(config));
    /// Bidirectional A*: shortest paths, searched for from both ends.
    BidirectionalOptimal(BidirectionalOptimalConfig) => BidirectionalOptimal =
        |config, _| Ok(BidirectionalOptimal::new(config));
    /// Jump point search: shortest paths without corner cutting, found much faster.
    Jps(JpsConfig) => Jps = |JpsConfig {}, _| Ok(Jps);
    /// Prepared map: shortest paths without corner cutting in microseconds, on a map that stays as it
    /// is.
    Prepared(PreparedConfig) => Prepared = |PreparedConfig {}, map| Ok(Prepared::build(map)?);
    /// Bidirectional A* as usually published: some path quickly, where searches from both ends first
    /// meet.
    #[serde(rename = "bidirectional-astar")]
    BidirectionalAStar(BidirectionalAStarConfig) => BidirectionalAStar =
        |config, _| Ok(BidirectionalAStar::new(config));
    /// Bidirectional A* with 24 neighbours: some path with steps in 16 directions.
    #[serde(rename = "bidirectional-24")]
    Bidirectional24(Bidirectional24Config) => Bidirectional24 =
        |config, _| Ok(Bidirectional24::new(config));
    /// Bidirectional jump point A* with fixed targets: from both ends, each side aims at the other's
    /// root.
    BidirectionalJpsFixed(BidirectionalJpsFixedConfig) => BidirectionalJpsFixed =
        |config, _| BidirectionalJpsFixed::new(config);
    /// Improved bidirectional jump point A*: from both ends, each side aims at the node that the other
    /// expanded last.
    BidirectionalJps(BidirectionalJpsConfig) => BidirectionalJps =
        |config, _| BidirectionalJps::new(config);
    /// Density-weighted A*: an estimate that weighs less the farther from the start, against a cost
    /// that weighs more the denser the obstacles; not a shortest path.
    #[serde(rename = "density-astar")]
    DensityAStar(DensityAStarConfig) => DensityAStar = |config, _| Ok(DensityAStar::new(config));
    /// Weight-ratio A*: an estimate that weighs X times as much as the cost; not a shortest path.
    #[serde(rename = "ratio-astar")]
    RatioAStar(RatioAStarConfig) => RatioAStar = |config, _| RatioAStar::new(config);
    /// HSTA*: bidirectional A* with a dynamic weight, a correction factor and a distance kept from
    /// obstacles, lowered where it leaves no path; not shortest paths.
    Hsta(HstaConfig) => Hsta = |config, _| Hsta::new(config);
    /// Rapidly-exploring random tree: some path with many turns, from a seed.
    Rrt(RrtConfig) => Rrt = |config, _| Rrt::new(config);
    /// Theta*: paths in any direction, hardly longer than shortest ones.
    ThetaStar(ThetaStarConfig) => ThetaStar = |config, _| Ok(ThetaStar::new(config));
    /// Lazy Theta*: paths in any direction like those of Theta*, with fewer line-of-sight checks.
    LazyThetaStar(LazyThetaStarConfig) => LazyThetaStar = |config, _| Ok(LazyThetaStar::new(config));
}

impl PlannerConfig {
    /// Whether its paths are shortest among those without corner cutting.
    pub fn is_optimal(&self) -> bool {
        match self {
            Self::Dijkstra(config) => config.corners == CornerRule::Forbid,
            Self::AStar(config) => config.corners == CornerRule::Forbid && config.is_exact(),
            Self::BidirectionalOptimal(config) => config.corners == CornerRule::Forbid,
            Self::Jps(_) | Self::Prepared(_) => true,
            // In any direction, without diagonal steps, without regard to the cost so far, or as a paper has it.
            _ => false,
        }
    }

    /// The parameters as the planner's paper publishes them; `None` for planners without such a paper.
    pub const fn as_published(&self) -> Option<Self> {
        Some(match self {
            Self::BidirectionalJpsFixed(_) => {
                Self::BidirectionalJpsFixed(BidirectionalJpsFixedConfig::PAPER)
            }
            Self::BidirectionalJps(_) => Self::BidirectionalJps(BidirectionalJpsConfig::PAPER),
            Self::DensityAStar(_) => Self::DensityAStar(DensityAStarConfig::PAPER),
            Self::RatioAStar(_) => Self::RatioAStar(RatioAStarConfig::PAPER),
            Self::Hsta(_) => Self::Hsta(HstaConfig::PAPER),
            _ => return None,
        })
    }

    /// The fields of [`Self::as_published`] for which the paper gives no value: they are readings.
    pub const fn readings(&self) -> &'static [&'static str] {
        match self {
            Self::BidirectionalJpsFixed(_) => BidirectionalJpsFixedConfig::READINGS,
            Self::BidirectionalJps(_) => BidirectionalJpsConfig::READINGS,
            Self::DensityAStar(_) => DensityAStarConfig::READINGS,
            Self::Hsta(_) => HstaConfig::READINGS,
            _ => &[],
        }
    }

    /// Whether [`Self::build`] prepares the map: the planner is then of no use on another one, or
    /// after an edit.
    pub const fn needs_static_map(&self) -> bool {
        matches!(self, Self::Prepared(_))
    }
}
