//! HSTA* \[ZhuYin2024\]: a map and two cells -> some 8-connected path that keeps a distance from
//! obstacles, through the meeting of a search from the start and one from the goal.
//!
//! The two searches take turns and expand one node at a time. Each aims at the node that the other
//! has just expanded (h), with a weight k that grows with the distance from its own root. It is
//! also attracted by the other's root (the correction factor c), so that the two do not miss each
//! other. Nodes nearer to an obstacle than a constraint are excluded. Initially all weights are 1;
//! later h dominates, and the two searches run into each other. Paths are not shortest ones.
//!
//! # Source
//! \[ZhuYin2024\]: section 1.2, equations (1) to (5), steps 1 to 5 of section 2.3. Smoothing and
//! local planning are separate stages.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | f(x1), eq. (1) | key of `Evaluation` | | |
//! | g(x1) | cost from this side's root, a [`Cost::key`](crate::search::Cost::key) | | |
//! | h(x1), eq. (4) | `straight_line` to `other` | | |
//! | k1, eq. (3) | `dynamic_weight`: [`HstaConfig::weight`], [`HstaConfig::weight_at`] | | |
//! | c(x1), eq. (5) | `straight_line` to `goal`, switched by [`HstaConfig::correction`] | | |
//! | L, eq. (2) | [`HstaConfig::l1_constraint`] | reference cells | 2 |
//! | `o_J` | cells of [`SearchMap::obstacles`] | | |
//! | first1, goal1 | the root of this side, of the other one | | |
//! | x2 | the node that the other side expanded last, at first its root | | |
//! | l, m | the map's width and height | reference cells | 42, 42 |
//! | open1, close1, open2, close2 | the open lists; a bit of each node | | |
//!
//! # Where this differs from the paper
//! - Distances of (2) and (3) are in reference cells of 1 m, so that they are the same lengths on
//!   a finer grid: counted in cells, k would reach 420 on an 840 x 840 map, and the search would
//!   be a greedy one. To count the map's own cells: `distances = cells`. (The unit of g, h and c
//!   does not change their order.)
//! - L is measured between the centres of cells, as in (2). So the distance to an obstacle's
//!   *square* depends on the side s of the map's cells: L - s / 2 straight ahead and (L - s) /
//!   sqrt(2) past a corner. With L = 2 m that is 1.5 and 0.71 m on the paper's cells of 1 m, 1.98
//!   and 1.38 m on cells of 0.05 m. No other L keeps both of the paper's distances on a finer
//!   grid.
//! - The map's border is not an obstacle.
//! - x2 moves, and the paper contradicts itself on the keys of open nodes. Its step 4 computes f
//!   of a node when that node is inserted into the open list: then f is kept, and k is that of the
//!   node ([`OpenKeys::Kept`], [`WeightAt::Node`]). Its definitions make x1 the *current* node of
//!   the side, of which k is a function: then one k weighs the whole open list, and changes with
//!   every turn ([`OpenKeys::Renewed`], [`WeightAt::Current`]). Here, "as published" means the
//!   former; `docs/lab/findings.md` has the results of both.
//! - The sides have met if their best nodes are the same (step 5), and also if one takes a node
//!   that the other has expanded before: otherwise they might never meet. The first is a case of
//!   the second: the forward side expands the common best node, then the backward side takes it.
//!   That node counts as expanded by both.
//! - Closed nodes are not reopened.
//! - The paper does not say what to do if the constraint leaves no path. L = 2 in cells of 1 m
//!   keeps up to 2 m from every wall: indoors hardly any start, goal or door has that much
//!   clearance, and every query would fail. So by default ([`IfNoPath::Relax`]) L becomes the
//!   largest whole number of the map's cells that leaves a path, at most the configured L (start
//!   and goal included, whose distances bound it), and a [`PlanNote::Relaxed`] reports it. A
//!   smaller L leaves every path that a larger one leaves, so it is found by bisection. Statistics
//!   and observer then report the search with that L, not those of the bisection, and a budget
//!   holds for each of them. [`HstaConfig::PAPER`] keeps L as configured: the error then says that
//!   the constraint leaves no path ([`IfNoPath::Fail`]).
//! - An unreachable goal is replaced on request by the nearest reachable cell, whether the
//!   constraint allows that cell or not.
//! - Equation (3) makes k grow with the distance from the side's own root, even if h is still
//!   large. On open maps much larger than the paper's the search then wanders: see
//!   `docs/lab/findings.md`.
//! - A start or goal nearer than L to an obstacle lowers L likewise (with [`IfNoPath::Fail`] it is
//!   an error), unless L is lifted in discs around start and goal with `free_ends_m`.
//! - The corner rule only matters for L of at most one cell: all side neighbours of an obstacle
//!   are nearer than any larger L.
//! - Order within a side: f, then larger g, then lower cell index. Costs are directed where
//!   unknown cells are penalised, as in [`super::BidirectionalAStar`].
//!
//! # Errors / cost
//! See [`PlanError`]; the planner is complete under its constraint. O(n log n) in the number n of
//! reached cells, and for each of them a scan of every row within L of it; 32 bytes per cell of
//! the padded map, of which only the pages of reached cells are touched. Relaxing adds up to 1 +
//! log2(L in cells) searches.

mod constraint;
mod evaluation;

use super::best_first::with_costs;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::two_sided::{self, CurrentNodes, Half, Meeting, OpenKeys};
use super::{GlobalPlanner, Miss, Plan, PlanError, PlanNote, Relaxed, Stop};
use crate::ConfigError;
use crate::map::{Cell, CellIndex, Connectivity, SearchMap};
use crate::search::{
    CornerRule, Moves, Neighbours, Observer, Query, Reversed, Side, Sides, StepCost, Uniform,
    Workspace,
};
use constraint::Constraint;
use evaluation::{Evaluation, Terms};
use serde::{Deserialize, Serialize};

/// Parameters of [`Hsta`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct HstaConfig {
    /// Collision constraint L, eq. (2): no node is nearer than this to an obstacle's centre in the
    /// L1 norm, in reference cells; 0 for none. On cells of 1 m, 2 keeps 1.5 m from an obstacle's
    /// square straight ahead and 0.71 m past its corner. On cells of 0.05 m it keeps 1.98 and 1.38
    /// m, for which hardly any building has space: see `if_no_path`.
    pub l1_constraint: f64,
    /// Side of a reference cell \[m\].
    pub reference_cell_m: f64,
    /// The unit of the distances in eqs. (2) and (3): `reference` cells, or the map's own `cells`.
    pub distances: DistanceUnit,
    /// The weight k of h, eq. (3): `dynamic`, or `one`.
    pub weight: Weight,
    /// The node x1 of eq. (3): each `node` has its own k, or all share the k of the side's
    /// `current` node.
    pub weight_at: WeightAt,
    /// The treatment of the keys of open nodes when a current node moves: `kept` or `renewed`.
    pub keys: OpenKeys,
    /// The correction factor c, eq. (5): the `distance` to the other side's root, or `none`.
    pub correction: Correction,
    /// The behaviour if the constraint leaves no path: `relax` it as little as possible and report
    /// that, or `fail`.
    pub if_no_path: IfNoPath,
    /// Radius of the discs around start and goal in which there is no constraint \[m\]; 0 for none.
    pub free_ends_m: f64,
    /// Diagonal steps past blocked side neighbours: `forbid` or `allow`; matters only if the
    /// constraint is at most one cell.
    pub corners: CornerRule,
}

/// The unit of distances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DistanceUnit {
    /// Cells of a given side, independent of the map's resolution.
    #[default]
    Reference,
    /// The map's own cells.
    Cells,
}

/// The weight k of h in [`Hsta`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Weight {
    /// Grows with the distance from the side's root \[ZhuYin2024, eq. (3)\].
    #[default]
    Dynamic,
    /// Always 1.
    One,
}

/// The node whose distance from the side's root determines the weight k of [`Hsta`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum WeightAt {
    /// The node whose key is computed.
    #[default]
    Node,
    /// The node that the side expands, or expanded last. With [`OpenKeys::Renewed`], one weight
    /// applies to all open nodes.
    Current,
}

/// The correction factor c of [`Hsta`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Correction {
    /// The distance to the other side's root \[ZhuYin2024, eq. (5)\].
    #[default]
    Distance,
    /// Always 0.
    None,
}

/// The behaviour of [`Hsta`] if its constraint leaves no path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum IfNoPath {
    /// Fails, and names the constraint as the reason.
    Fail,
    /// Uses the largest constraint, in whole cells, that leaves a path.
    #[default]
    Relax,
}

impl HstaConfig {
    /// As published: a constraint that leaves no path is an error. Its L rules out corner cutting.
    pub const PAPER: Self = Self {
        l1_constraint: 2.0,
        reference_cell_m: 1.0,
        distances: DistanceUnit::Reference,
        weight: Weight::Dynamic,
        weight_at: WeightAt::Node,
        keys: OpenKeys::Kept,
        correction: Correction::Distance,
        if_no_path: IfNoPath::Fail,
        free_ends_m: 0.0,
        corners: CornerRule::Forbid,
    };

    /// Replaces the constraint by as many safe distances \[m\] as the paper's has cells: the
    /// paper's robot occupies one cell. The weight k is unchanged.
    #[must_use]
    pub fn keeping(self, safe_distance_m: f64) -> Self {
        let l1_constraint = Self::PAPER.l1_constraint * safe_distance_m / self.reference_cell_m;
        Self { l1_constraint, ..self }
    }

    /// The number of the map's cells per unit of distance.
    fn cells_per_unit(&self, map: &SearchMap) -> f64 {
        match self.distances {
            DistanceUnit::Reference => self.reference_cell_m / map.frame().resolution_m(),
            DistanceUnit::Cells => 1.0,
        }
    }
}

/// As published, but a constraint that leaves no path is relaxed.
impl Default for HstaConfig {
    fn default() -> Self {
        Self { if_no_path: IfNoPath::Relax, ..Self::PAPER }
    }
}

/// Bidirectional A* with a dynamic weight, a correction factor and a collision constraint; not
/// optimal.
#[derive(Clone, Debug, Default)]
pub struct Hsta {
    config: HstaConfig,
}

impl Hsta {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "hsta";

    /// Creates a planner with these parameters.
    ///
    /// # Errors
    /// Returns an error if a parameter is out of range; the error names it.
    pub fn new(config: HstaConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config })
    }

    /// The smallest L1 distance of a path's nodes to an obstacle, in the unit of the constraint;
    /// nodes in the free discs around start and goal do not count. `None` if no node counts, or
    /// there is no obstacle. A path of this planner keeps at least the constraint that it was
    /// searched with; it keeps a relaxed one exactly.
    pub fn distance_kept(&self, map: &SearchMap, path: &[Cell]) -> Option<f64> {
        let query = Query::new(*path.first()?, *path.last()?);
        let constraint = Constraint::new(&self.config, map, &query);
        let distances = path.iter().filter_map(|&cell| constraint.distance(cell));
        distances.min().map(|cells| f64::from(cells) / self.config.cells_per_unit(map))
    }

    /// The constraint of the search, which start and goal satisfy as well.
    fn settle_constraint<'m>(
        &self,
        map: &'m SearchMap,
        query: &Query,
        sides: &mut Sides,
    ) -> Result<Constraint<'m>, PlanError> {
        let constraint = Constraint::new(&self.config, map, query);
        if query.start == query.goal {
            // Start and goal coincide, so there is no search.
            return Ok(constraint);
        }
        match self.config.if_no_path {
            IfNoPath::Fail => constraint.check_ends(map, &self.config).map(|()| constraint),
            IfNoPath::Relax => {
                let steps = Neighbours::new(map, Moves::Eight(self.config.corners), Uniform);
                constraint.relaxed(map, query, &steps, &mut sides.forward)
            }
        }
    }

    fn search(
        &self,
        map: &SearchMap,
        query: &Query,
        cost: impl StepCost + Copy,
        sides: &mut Sides,
        seen: &mut impl Observer,
    ) -> Result<(CellIndex, Option<Relaxed>), PlanError> {
        let constraint = self.settle_constraint(map, query, sides)?;
        let moves = Moves::Eight(self.config.corners);
        let there = Neighbours::new(map, moves, cost);
        let back = Neighbours::new(map, moves, Reversed(cost));
        let allows = |at| constraint.allows(map.cell(at));
        let forward = Half::new(Side::Forward, &mut sides.forward, there, allows);
        let backward = Half::new(Side::Backward, &mut sides.backward, back, allows);
        let terms = Terms::new(&self.config, map);
        let rule = |side, CurrentNodes { own, other }| {
            let (first, goal) = match side {
                Side::Forward => (query.start, query.goal),
                Side::Backward => (query.goal, query.start),
            };
            Evaluation { map, terms, first, goal, own: map.cell(own), other: map.cell(other) }
        };
        let how = (self.config.keys, Meeting::Expanded);
        let met = two_sided::take_turns(map, query, forward, backward, rule, how, seen)?;
        Ok((met, self.relaxed(map, &constraint)))
    }

    /// The constraint of a search, if it is below that of the config.
    fn relaxed(&self, map: &SearchMap, constraint: &Constraint<'_>) -> Option<Relaxed> {
        let HstaConfig { l1_constraint, .. } = self.config;
        let used_m = constraint.least_m(map);
        let asked_m = l1_constraint * self.config.cells_per_unit(map) * map.frame().resolution_m();
        constraint.is_relaxed().then_some(Relaxed { asked_m, used_m })
    }

    /// Attributes a missing path to the constraint: a path without it exists.
    fn blame(&self, error: PlanError) -> PlanError {
        match error {
            PlanError::NoPath { statistics } => PlanError::Missed {
                planner: Self::NAME,
                miss: Miss::Constraint { constraint: self.config.l1_constraint },
                statistics,
            },
            error => error,
        }
    }
}

impl PlannerParameters for HstaConfig {
    fn check(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("l1_constraint", self.l1_constraint)?;
        ConfigError::unless_not_negative("free_ends_m", self.free_ends_m)?;
        ConfigError::unless_positive("reference_cell_m", self.reference_cell_m)
    }

    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Hsta::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["reference_cell_m", "distances", "weight_at", "keys", "if_no_path", "corners"]
    }
}

impl GlobalPlanner for Hsta {
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
        let sides = workspace.part::<Sides>();
        let met = with_costs!(map, seen, cost, seen => {
            self.search(map, query, cost, sides, seen)
        });
        let (meeting, relaxed) = met.map_err(|error| self.blame(error))?;
        let Sides { forward, backward } = sides;
        two_sided::finish(map, (forward, backward), meeting, Stop::SidesMet, plan);
        plan.note = relaxed.map(PlanNote::Relaxed);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
