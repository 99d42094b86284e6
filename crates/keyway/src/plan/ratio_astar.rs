//! Weight-ratio A* \[Wang2019\]: a map and two cells -> an 8-connected path with few turns.
//!
//! A* whose estimate weighs X times as much as the cost so far. X = 1 is plain A*. A larger X
//! directs the search more strongly towards the goal: it expands fewer cells and prefers straight
//! segments, but the path may be longer.
//!
//! # Source
//! \[Wang2019\]: steps 1 to 8, equations (5) to (9) and (13) to (15), section 2.2.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | c(n), eq. (8) | the length of a step | cells | 1 or sqrt(2) |
//! | g'(n), eq. (6), (9) | the cost of the path, a [`crate::search::Cost::key`] | cells | |
//! | h(n), eq. (5) | [`RatioAStarConfig::heuristic`] | cells | the straight line |
//! | X, eq. (13) | [`RatioAStarConfig::x`] | 1 | 1.1 |
//! | f'(n), eq. (14) | times 1 + X, the key of the open list | cells | |
//! | Open, Closed | the open list; a bit of each node | | |
//!
//! The paper's *traditional* A*, whose g is the straight line from the start, is [`super::AStar`]
//! with `g = "straight-line"`, `heuristic = "euclidean"` and `corners = "allow"`. The paper's third
//! and fourth improvements are stages of their own: a smoother, and the obstacle expansion of the
//! map ([`crate::map::PublishedConstraints::expansion_cells`]).
//!
//! # Where this differs from the paper
//! - Equation (12) says g'(n) <= g(n), with g the straight line from the start. The opposite
//!   holds: a path is never shorter than the straight line, so g'(n) >= g(n), and the first
//!   improvement does not lower the weight of the past cost but raises it. Equations (6) to (9)
//!   stand.
//! - The open list is ordered by (1 + X) f' = g' + X h, which is the same order without rounding
//!   g': X = 1 expands exactly the cells that A* does. X h is rounded to whole units of
//!   [`crate::search::Cost::key`] (1e-8 cells); sums that do not fit into 64 bits count as equal.
//! - Step 5: an open node accepts a value that is smaller *or equal*; the parent is then the
//!   neighbour that was expanded last. Step 3: the search ends when the goal appears in the open
//!   list, so its last step need not be the best one, even with X = 1. With
//!   [`SearchEnd::GoalExpanded`] the search continues until the goal is taken from the list.
//! - Ties, on which the paper is silent: the larger g', then the lower cell index.
//!
//! # Errors / cost
//! See [`PlanError`]. With `end = "goal-expanded"` and a consistent heuristic a path is at most
//! max(1, X) times as long as the shortest one. O(n log n) in the number n of reached cells; 16
//! bytes per cell of the padded map, of which only the pages of reached cells are touched.

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Heuristic, Plan, PlanError, best_first};
use crate::ConfigError;
use crate::map::{CellIndex, Connectivity, SearchMap};
use crate::search::{
    AtGeneration, CornerRule, DistanceTo, GridStep, Metric, Moves, Observer, Query, Rule, Workspace,
};
use serde::{Deserialize, Serialize};

/// The event that ends a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum SearchEnd {
    /// The goal appears in the open list \[Wang2019, step 3\].
    GoalGenerated,
    /// The goal is taken from the open list, as in A*.
    GoalExpanded,
}

/// Parameters of [`RatioAStar`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct RatioAStarConfig {
    /// X, the weight of the estimate relative to the cost; more than 0. 1 is plain A*.
    pub x: f64,
    /// The event that ends the search: `goal-generated` as in the paper, or `goal-expanded`.
    pub end: SearchEnd,
    /// Diagonal steps past blocked side neighbours: `forbid`, or `allow` as in the paper.
    pub corners: CornerRule,
    /// The estimate of the remaining cost: `octile`, `euclidean` as in the paper, `manhattan` or
    /// `mean`.
    pub heuristic: Heuristic,
}

impl RatioAStarConfig {
    /// The paper's choice.
    pub const PAPER: Self = Self {
        x: 1.1,
        end: SearchEnd::GoalGenerated,
        corners: CornerRule::Allow,
        heuristic: Heuristic::Euclidean,
    };
}

impl Default for RatioAStarConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// A* with a ratio of weights; not optimal.
#[derive(Clone, Debug)]
pub struct RatioAStar {
    config: RatioAStarConfig,
}

impl RatioAStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "ratio-astar";

    /// Creates a planner with these parameters.
    ///
    /// # Errors
    /// Returns an error if X is not a positive number.
    pub fn new(config: RatioAStarConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config })
    }
}

impl PlannerParameters for RatioAStarConfig {
    fn check(&self) -> Result<(), ConfigError> {
        if self.x > 0.0 && self.x.is_finite() {
            return Ok(());
        }
        Err(ConfigError::must_be("x", "a number above 0", self.x))
    }

    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(RatioAStar::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }
}

impl GlobalPlanner for RatioAStar {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        self.config.corners.connectivity()
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let RatioAStarConfig { x, end, corners, heuristic } = self.config;
        let moves = Moves::Eight(corners);
        with_metric!(heuristic, metric => {
            let rule = WeightRatio { x, to_goal: DistanceTo::new(map, metric, query.goal) };
            match end {
                SearchEnd::GoalExpanded => {
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
                SearchEnd::GoalGenerated => {
                    let rule = AtGeneration(rule);
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
            }
        })
    }
}

/// f' = g' / (1 + X) + h X / (1 + X).
struct WeightRatio<M> {
    x: f64,
    to_goal: DistanceTo<M>,
}

impl<M: Metric> Rule for WeightRatio<M> {
    // Step 5: "smaller or equal".
    const TAKES_EQUAL: bool = true;

    // Eq. (6) and (8); with the start's g' = 0 this is the sum of eq. (9).
    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        key(self.x, g, self.to_goal.from(at))
    }
}

/// Eq. (14) times 1 + X, in units of [`crate::search::Cost::key`].
fn key(x: f64, g: u64, h: u64) -> u64 {
    // Values that are too large saturate.
    let weighted = if x == 1.0 { h } else { (x * h as f64).round() as u64 };
    g.saturating_add(weighted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid};
    use crate::plan::{AStar, AStarConfig, Stop};
    use crate::search::{Cost, Euclidean, Side};
    use proptest::prelude::*;

    const Q: u64 = Cost::KEY_STRAIGHT;

    /// Expanded cells with their path costs.
    #[derive(Default)]
    struct Log(Vec<(Cell, f64)>);

    impl Observer for Log {
        fn expanded(&mut self, _: Side, at: Cell, g_cells: f64) {
            self.0.push((at, g_cells));
        }
    }

    impl Log {
        fn cells(&self) -> Vec<Cell> {
            self.0.iter().map(|(cell, _)| *cell).collect()
        }
    }

    fn run(planner: &impl GlobalPlanner, map: &SearchMap, query: &Query) -> (Option<Plan>, Log) {
        let (mut log, mut plan) = (Log::default(), Plan::default());
        let mut workspace = Workspace::default();
        let result = planner.plan_into(map, query, &mut workspace, Some(&mut log), &mut plan);
        (result.is_ok().then_some(plan), log)
    }

    fn cells(pairs: &[(i32, i32)]) -> Vec<Cell> {
        pairs.iter().map(|&(x, y)| Cell::new(x, y)).collect()
    }

    /// Eq. (6) and (8) step by step: from g' = 2 a straight step gives 3, a diagonal one 2 +
    /// sqrt(2) = 3.414. Eq. (9) is their sum from the start (g' = 0): over two straight and one
    /// diagonal step it is 2 + sqrt(2) as well. Eq. (7), the estimate, and (5): 3 columns and 4
    /// rows are 5.
    #[test]
    fn equations_5_to_9_by_hand() {
        let map = OccupancyGrid::from_ascii(&["....", "....", "....", "....", "...."]);
        let map = SearchMap::new(&map, LayerConfig::default()).unwrap();
        let to_goal = DistanceTo::new(&map, Euclidean, Cell::new(3, 4));
        let rule = WeightRatio { x: 1.0, to_goal };
        let step = |x, y, cost| GridStep { to: map.index(Cell::new(x, y)), cost };
        let straight = step(1, 0, Cost::KEY_STRAIGHT);
        let diagonal = step(2, 1, Cost::KEY_DIAGONAL);
        assert_eq!(rule.value(2 * Q, straight), 3 * Q);
        let sum = rule.value(rule.value(rule.value(0, straight), straight), diagonal);
        assert_eq!(sum, rule.value(2 * Q, diagonal));
        assert!((sum as f64 / Q as f64 - 3.414).abs() < 1e-3);
        assert_eq!(rule.key(map.index(Cell::new(0, 0)), 0), 5 * Q);
    }

    /// Eq. (13): 1 / 2.1 + 1.1 / 2.1 = 1. Eq. (14) for g' = 2, h = 3 and X = 1.1: 2 / 2.1 + 3.3 /
    /// 2.1 = 5.3 / 2.1 = 2.5238, times 2.1 is 5.3. Eq. (15), X = 1: 0.5 * 2 + 0.5 * 3 = 2.5, times
    /// 2 is 5.
    #[test]
    fn equations_13_to_15_by_hand() {
        let f = |x, g: u64, h: u64| key(x, g * Q, h * Q) as f64 / Q as f64 / (1.0 + x);
        assert!((f(1.1, 1, 1) - 1.0).abs() < 1e-7);
        assert!((f(1.1, 2, 3) - 2.5238).abs() < 1e-4);
        assert_eq!(f(1.0, 2, 3), 2.5);
        assert_eq!(key(1.0, 2 * Q + 1, 3 * Q + 1), 5 * Q + 2);
        assert_eq!(key(1e300, 5, Q), u64::MAX);
        assert_eq!(key(1e300, 5, 0), 5);
    }

    /// The map, with g' + 1.1 h of the cells around the obstacle:
    ///
    /// ```text
    /// 4.479  3.874  3.970   .          (1, 2): sqrt(2) + 1.1 sqrt(5), (2, 2): 1 + sqrt(2) + 1.1 sqrt(2)
    ///   S      #    3.928   G          (2, 1): 2 sqrt(2) + 1.1
    /// 4.479  3.874  3.970   .
    /// ```
    ///
    /// After the start, (1, 0) is taken, as its index is lower than that of (1, 2), which comes
    /// next. (1, 2) gives (2, 1) the same g' as (1, 0) did, so it becomes its parent. (2, 1) then
    /// generates the goal.
    #[test]
    fn a_scene_by_hand() {
        let map = OccupancyGrid::from_ascii(&["....", ".#..", "...."]);
        let map = SearchMap::new(&map, LayerConfig::default()).unwrap();
        let query = Query::new(Cell::new(0, 1), Cell::new(3, 1));
        let planner = RatioAStar::new(RatioAStarConfig::PAPER).unwrap();
        let (plan, log) = run(&planner, &map, &query);
        let plan = plan.unwrap();
        assert_eq!(log.cells(), cells(&[(0, 1), (1, 0), (1, 2), (2, 1)]));
        assert_eq!(plan.cells, cells(&[(0, 1), (1, 2), (2, 1), (3, 1)]));
        assert_eq!(plan.cost.steps(), Some(Cost::new(1, 2)));
        assert_eq!(plan.stop, Some(Stop::GoalGenerated));

        // The goal's own value, 1 + 2 sqrt(2) = 3.828, is then the smallest.
        let config = RatioAStarConfig { end: SearchEnd::GoalExpanded, ..RatioAStarConfig::PAPER };
        let (plan, log) = run(&RatioAStar::new(config).unwrap(), &map, &query);
        assert_eq!(log.cells(), cells(&[(0, 1), (1, 0), (1, 2), (2, 1), (3, 1)]));
        assert_eq!(plan.unwrap().stop, Some(Stop::GoalExpanded));
    }

    #[test]
    fn x_must_be_positive() {
        for x in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = RatioAStar::new(RatioAStarConfig { x, ..RatioAStarConfig::PAPER });
            assert_eq!(error.unwrap_err().path, "x", "{x}");
        }
    }

    fn any_scene() -> impl Strategy<Value = (SearchMap, Query)> {
        let free = prop::collection::vec(prop::bool::weighted(0.7), 20 * 12);
        (free, (0i32..20, 0i32..12), (0i32..20, 0i32..12)).prop_map(|(free, start, goal)| {
            let frame = GridFrame::new(20, 12, 1.0, crate::geometry::Pose::default()).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |cell| {
                let is_free = free[(cell.y * 20 + cell.x) as usize];
                if is_free { CellState::Free } else { CellState::Occupied }
            });
            let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
            let cell = |(x, y)| map.nearest_free(Cell::new(x, y)).unwrap_or(Cell::new(x, y));
            let query = Query::new(cell(start), cell(goal));
            (map, query)
        })
    }

    fn any_corners() -> impl Strategy<Value = CornerRule> {
        prop_oneof![Just(CornerRule::Forbid), Just(CornerRule::Allow)]
    }

    proptest! {
        #[test]
        fn x_1_expands_what_astar_does((map, query) in any_scene(), corners in any_corners()) {
            for heuristic in [Heuristic::Octile, Heuristic::Euclidean, Heuristic::Mean] {
                let astar = AStarConfig { corners, heuristic, ..AStarConfig::default() };
                let (by_astar, expected) = run(&AStar::new(astar), &map, &query);
                let config = RatioAStarConfig { x: 1.0, end: SearchEnd::GoalExpanded, corners, heuristic };
                let (plan, log) = run(&RatioAStar::new(config.clone()).unwrap(), &map, &query);
                prop_assert_eq!(&log.0, &expected.0);
                prop_assert_eq!(plan.map(|plan| plan.cost), by_astar.map(|plan| plan.cost));
                // The paper's stop condition is only met earlier.
                let config = RatioAStarConfig { end: SearchEnd::GoalGenerated, ..config };
                let (_, log) = run(&RatioAStar::new(config).unwrap(), &map, &query);
                prop_assert!(expected.0.starts_with(&log.0));
            }
        }

        /// Eq. (12) corrected.
        #[test]
        fn no_path_is_shorter_than_the_straight_line((map, query) in any_scene(), x in 0.1..5.0f64) {
            let config = RatioAStarConfig { x, ..RatioAStarConfig::PAPER };
            let (_, log) = run(&RatioAStar::new(config).unwrap(), &map, &query);
            for (at, g_cells) in log.0 {
                let line = f64::from(at.x - query.start.x).hypot(f64::from(at.y - query.start.y));
                prop_assert!(g_cells >= line - 1e-9, "{} {} {}", at, g_cells, line);
            }
        }

        #[test]
        fn the_excess_is_at_most_x((map, query) in any_scene(), corners in any_corners(), x in 0.1..5.0f64) {
            let optimal = AStar::new(AStarConfig { corners, ..AStarConfig::default() });
            let (optimum, _) = run(&optimal, &map, &query);
            let end = SearchEnd::GoalExpanded;
            let config = RatioAStarConfig { x, end, corners, ..RatioAStarConfig::PAPER };
            let (plan, _) = run(&RatioAStar::new(config).unwrap(), &map, &query);
            prop_assert_eq!(plan.is_some(), optimum.is_some());
            if let (Some(plan), Some(optimum)) = (plan, optimum) {
                let bound = x.max(1.0) * optimum.cost.cells() + 1e-6;
                prop_assert!(plan.cost >= optimum.cost && plan.cost.cells() <= bound);
            }
        }
    }
}
