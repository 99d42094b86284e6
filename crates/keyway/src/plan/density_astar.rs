//! Density-weighted A* \[S1\]: a map and two cells -> an 8-connected path, found with fewer
//! expansions.
//!
//! The estimate is weighted by 1.5 at the start, where the search should advance quickly; the
//! weight falls along a sigmoid towards 1 with the distance from the start. The denser the
//! obstacles, the higher the weight of the cost so far. Diagonal steps past obstacles are not
//! taken ("safe children").
//!
//! # Source
//! \[S1\], section 1: 1.2 evaluation, 1.3 safe children. Its equations have no numbers.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | g(n) | [`DensityAStarConfig::g`], a [`crate::search::Cost::key`] | cells | |
//! | h(n) | [`DensityAStarConfig::heuristic`] | cells | the straight line |
//! | d | the straight line from the start to n | cells | |
//! | D | the straight line from the start to the goal | cells | |
//! | the factor of h | [`DensityAStarConfig::weight`] | 1 | a sigmoid |
//! | P | [`DensityAStarConfig::density`] | 1 | the first formula has none |
//! | children 1 to 8, classes I to III | [`CornerRule::Forbid`] | | |
//!
//! # Where this differs from the paper
//! - The paper writes g as the straight line from the start, and calls it the actual cost of the
//!   path. Here it is the cost of the path. [`PathCost::StraightLine`] follows the paper to the
//!   letter, with the rules of \[Wang2019\] (see [`super::AStar`]): an open cell's parent is the
//!   neighbour that was expanded last, and the search ends when the goal appears in the open list.
//! - The paper does not define the region in which P is measured. Here P is the share of occupied
//!   cells in the box that start and goal span; see [`Density`] for alternatives. Cells that are
//!   only blocked by a clearance or an expansion do not count, and neither do unknown ones, even
//!   if they are not traversable.
//! - Children are numbered 1 2 3 / 4 . 5 / 6 7 8 around the parent. An obstacle above drops 1, 2,
//!   3, one below 6, 7, 8, one to the left 1, 4, 6, one to the right 3, 5, 8: this is exactly
//!   [`CornerRule::Forbid`]. The paper's traditional A* is [`CornerRule::Allow`].
//! - The estimate is inadmissible, so a shorter path to a closed cell may be found later. The
//!   paper is silent; by default the cell stays closed.
//! - f is rounded to whole units of [`crate::search::Cost::key`] (1e-8 cells), and to 53 bits,
//!   which is coarser only for paths of more than 96 million cells; values that do not fit into 64
//!   bits count as equal. Ties go to the larger g, then to the lower cell index.
//!
//! # Errors / cost
//! See [`PlanError`]. If P is the same for all cells, closed cells are reopened, g is accumulated
//! and the heuristic is consistent, a path is at most max(1, 1.5 / (1 + P)) times as long as the
//! shortest one: an open cell of the shortest path always has f <= max(1 + P, 1.5) times its
//! length, and the goal is taken with f = (1 + P) g. Without reopening there is no bound.
//!
//! O(n log n) in the number n of reached cells unless they are reopened (in clutter this may take
//! many times as many expansions as there are cells), with one exponential for each generated
//! node; 16 bytes per cell of the padded map, of which only the pages of reached cells are
//! touched. [`Density::Box`] and [`Density::Map`] count 64 cells at a time, once per query;
//! [`Density::Remaining`] makes a pass over all cells of the map for every query, and takes 4
//! bytes for each.

mod summed_area;

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Heuristic, PathCost, Plan, PlanError, best_first};
use crate::map::{Cell, CellIndex, Connectivity, SearchMap};
use crate::search::{
    CornerRule, DistanceTo, Euclidean, GridStep, Metric, Moves, Observer, Query, Rule, Workspace,
};
use serde::{Deserialize, Serialize};
use summed_area::SummedArea;

/// The region in which the density P of obstacles, the share of occupied cells, is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Density {
    /// The box that start and goal span, both included.
    Box,
    /// The box that the node and the goal span: P differs from node to node.
    Remaining,
    /// The whole map.
    Map,
    /// None: P = 0, the paper's first formula.
    None,
}

/// The factor of the estimate h.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum EstimateWeight {
    /// A sigmoid that falls from 1.5 at the start to 1.119 at the goal.
    Sigmoid,
    /// 1 everywhere.
    One,
}

/// The treatment of a closed cell to which a shorter path is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Closed {
    /// It stays closed.
    Stay,
    /// It is reopened, and may be expanded more than once.
    Reopen,
}

/// Parameters of [`DensityAStar`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct DensityAStarConfig {
    /// The factor of the estimate: `sigmoid` as in the paper, or `one`.
    pub weight: EstimateWeight,
    /// The region in which the share P of occupied cells is measured: the `box` of start and goal,
    /// the `remaining` box of node and goal, the whole `map`, or `none` for P = 0.
    pub density: Density,
    /// The cost of a node: `accumulated` along its path, or the `straight-line` from the start.
    pub g: PathCost,
    /// Diagonal steps past blocked side neighbours: `forbid` (the paper's safe children) or
    /// `allow` (its traditional A*).
    pub corners: CornerRule,
    /// The treatment of a closed cell to which a shorter path is found: `stay` or `reopen`. Has no
    /// effect with a straight-line g.
    pub closed: Closed,
    /// The estimate of the remaining cost: `octile`, `euclidean` as in the paper, `manhattan` or
    /// `mean`.
    pub heuristic: Heuristic,
}

impl DensityAStarConfig {
    /// The paper's choice, as interpreted above.
    pub const PAPER: Self = Self {
        weight: EstimateWeight::Sigmoid,
        density: Density::Box,
        g: PathCost::Accumulated,
        corners: CornerRule::Forbid,
        closed: Closed::Stay,
        heuristic: Heuristic::Euclidean,
    };
}

impl Default for DensityAStarConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// A* with a sigmoid weight and the density of obstacles; not optimal.
#[derive(Clone, Debug, Default)]
pub struct DensityAStar {
    config: DensityAStarConfig,
}

impl DensityAStar {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "density-astar";

    /// Creates a planner with these parameters.
    pub const fn new(config: DensityAStarConfig) -> Self {
        Self { config }
    }
}

impl PlannerParameters for DensityAStarConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(DensityAStar::new(self.clone())))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["density", "g", "closed"]
    }
}

impl GlobalPlanner for DensityAStar {
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
        // The search borrows the rest of the workspace.
        let mut table = std::mem::take(workspace.part::<SummedArea>());
        let share = Share::of(self.config.density, map, query, &mut table);
        let result = self.search(map, query, share, workspace, seen, plan);
        *workspace.part::<SummedArea>() = table;
        result
    }
}

impl DensityAStar {
    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        share: Share<'_>,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let DensityAStarConfig { weight, g, corners, closed, heuristic, .. } = self.config;
        let moves = Moves::Eight(corners);
        let from_start = DistanceTo::new(map, Euclidean, query.start);
        with_metric!(heuristic, metric => {
            let to_goal = DistanceTo::new(map, metric, query.goal);
            // Start and goal may be the same cell, where d is 0 as well.
            let whole = from_start.from(map.index(query.goal)).max(1) as f64;
            let f = Evaluation { weight, share, from_start, whole, to_goal };
            match g {
                PathCost::Accumulated => {
                    let rule = Weighted { f, closed };
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
                PathCost::StraightLine => {
                    let rule = WeightedLine(f);
                    best_first::plan(map, query, moves, &rule, workspace, seen, plan)
                }
            }
        })
    }
}

/// P, as far as it is known before the search.
enum Share<'a> {
    Constant(f64),
    Remaining { map: &'a SearchMap, occupied: &'a SummedArea, goal: Cell },
}

impl<'a> Share<'a> {
    fn of(density: Density, map: &'a SearchMap, query: &Query, table: &'a mut SummedArea) -> Self {
        let in_box = |(low, high)| {
            Self::Constant(map.occupied_between(low, high) as f64 / cell_count(low, high))
        };
        match density {
            Density::Box => in_box(spanned(query.start, query.goal)),
            Density::Map => {
                let (width, height) = (map.frame().width() as i32, map.frame().height() as i32);
                in_box((Cell::new(0, 0), Cell::new(width - 1, height - 1)))
            }
            Density::None => Self::Constant(0.0),
            Density::Remaining => {
                table.build(map);
                Self::Remaining { map, occupied: table, goal: query.goal }
            }
        }
    }

    fn at(&self, at: CellIndex) -> f64 {
        match *self {
            Self::Constant(share) => share,
            Self::Remaining { map, occupied, goal } => {
                let (low, high) = spanned(map.cell(at), goal);
                occupied.between(low, high) as f64 / cell_count(low, high)
            }
        }
    }
}

/// The lower left and the upper right cell of the box that two cells span.
fn spanned(a: Cell, b: Cell) -> (Cell, Cell) {
    (Cell::new(a.x.min(b.x), a.y.min(b.y)), Cell::new(a.x.max(b.x), a.y.max(b.y)))
}

fn cell_count(low: Cell, high: Cell) -> f64 {
    f64::from(high.x - low.x + 1) * f64::from(high.y - low.y + 1)
}

/// Section 1.2: the factor 1 + 1 / (1 + (e^(d/D))^2) of the estimate, from 1.5 at the start to
/// 1.119 at the goal and on towards 1.
fn sigmoid_weight(d_over_whole: f64) -> f64 {
    let e = libm::exp(d_over_whole);
    1.0 + 1.0 / (1.0 + e * e)
}

/// Section 1.2: f = (1 + P) g + weight h.
fn evaluation(share: f64, g: f64, weight: f64, h: f64) -> f64 {
    (1.0 + share) * g + weight * h
}

/// f of a node.
struct Evaluation<'a, M> {
    weight: EstimateWeight,
    share: Share<'a>,
    /// d.
    from_start: DistanceTo<Euclidean>,
    /// D.
    whole: f64,
    to_goal: DistanceTo<M>,
}

impl<M: Metric> Evaluation<'_, M> {
    fn key(&self, at: CellIndex, g: u64) -> u64 {
        let weight = match self.weight {
            EstimateWeight::Sigmoid => sigmoid_weight(self.from_start.from(at) as f64 / self.whole),
            EstimateWeight::One => 1.0,
        };
        let h = self.to_goal.from(at) as f64;
        evaluation(self.share.at(at), g as f64, weight, h).round() as u64
    }
}

/// g is the cost of the path.
struct Weighted<'a, M> {
    f: Evaluation<'a, M>,
    closed: Closed,
}

impl<M: Metric> Rule for Weighted<'_, M> {
    fn reopens(&self) -> bool {
        self.closed == Closed::Reopen
    }

    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        self.f.key(at, g)
    }
}

/// g is the straight line from the start, as in [`crate::search::StraightLine`].
struct WeightedLine<'a, M>(Evaluation<'a, M>);

impl<M: Metric> Rule for WeightedLine<'_, M> {
    const TAKES_EQUAL: bool = true;
    const ENDS_AT_GENERATION: bool = true;

    fn value(&self, _: u64, step: GridStep) -> u64 {
        self.0.from_start.from(step.to)
    }

    fn key(&self, at: CellIndex, g: u64) -> u64 {
        self.0.key(at, g)
    }
}

#[cfg(test)]
#[path = "density_astar_tests.rs"]
mod tests;
