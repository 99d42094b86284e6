//! Jump point search \[Harabor2011\]: a map and two cells -> a shortest 8-connected path, without
//! corner cutting.
//!
//! A* over jump points. Of all shortest paths between two cells, only one canonical order of moves
//! is searched (diagonal first), and straight runs are scanned 64 cells at a time. Only straight
//! jump points become nodes. A node reached at equal cost from another direction adds that
//! direction.
//!
//! # Source
//! \[Harabor2011\]. \[Harabor2014\]: block scanning and pruning, rules without corner cutting.
//!
//! | paper | here |
//! |---|---|
//! | jump(x, d) | `JumpPoints::scan` |
//! | natural and forced neighbours | `JumpPoints::onward` |
//! | g, h | [`Cost::key`], octile |
//!
//! # Where this differs from the papers
//! - The goal does not stop scans. It is tested in the one direction of a node in which it lies:
//!   diagonal until aligned, then straight. A shortest path in this order of moves leaves its last
//!   jump point in exactly this way.
//! - After many queries on the same map, if few cells on its diagonals are events, diagonals are
//!   traversed from one event cell to the next (`DiagonalEvents`), 64 cells at a time. The results
//!   are the same, in the same order.
//! - If a free diagonal and then a free straight line lead from the start to the goal, they are the
//!   answer. No node is touched.
//! - A diagonal is cut off once a jump point seen from it is known to be so near to the start that
//!   the path over that jump point to the diagonal's cell is shorter than the diagonal. Paths that
//!   begin with a longer than known path to a cell are not shortest paths, so none is lost.
//! - Nodes leave the open list in the order of f rounded down to 0.18 cells. So a node may be
//!   expanded before its path cost is final; it is expanded again if a shorter path is found. The
//!   search ends when no node is left whose f is below the cost of the best path so far. As h
//!   never exceeds the true cost, a better path would have such a node: the result is exact.
//!
//! # Errors / cost
//! See [`PlanError`]; a map with penalised cells is refused, as jump points need one cost for all
//! cells. Nodes take 16 bytes per cell, in pages of 32 that are allocated on first touch.

mod bucket_queue;
mod jump_nodes;
mod jump_points;
mod node_pages;

use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanCost, PlanError, Stop, far_query, leg, plan_a_step};
use crate::map::{Cell, CellIndex, Connectivity, SearchMap};
use crate::search::{
    Cost, Observer, Query, SearchStatistics, Side, SideStatistics, Workspace, cells,
};
use jump_nodes::{JumpNode, JumpNodes};
use jump_points::{Arrival, Diagonals, JumpPoints, JumpVisitor, Place, Walked};
use serde::{Deserialize, Serialize};

/// Parameters of [`Jps`]: none, the corner rule is fixed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct JpsConfig {}

/// Jump point search; optimal without corner cutting.
#[derive(Clone, Debug, Default)]
pub struct Jps;

impl Jps {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "jps";
}

impl PlannerParameters for JpsConfig {
    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Jps))
    }

    fn is_optimal(&self) -> bool {
        true
    }
}

impl GlobalPlanner for Jps {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn needs_uniform_cost(&self) -> bool {
        true
    }

    fn warm_up(&self, map: &SearchMap, workspace: &mut Workspace) {
        let nodes = workspace.part::<JumpNodes>();
        nodes.warm_up(map);
        // Not by way of a plan, which would be a single leg on open ground, and would count as
        // walking on the map.
        if let Some(query) = far_query(map, self.connectivity()) {
            let jumps = JumpPoints::new(map, query.goal, Walked);
            _ = search(map, &jumps, &query, nodes, &mut ());
            plan_a_step(self, map, (query.start, workspace));
        }
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        if query.budget != Some(0) && is_a_leg(map, query) {
            take_the_leg(query, seen, plan);
            return Ok(());
        }
        let nodes = workspace.part::<JumpNodes>();
        match seen {
            None => run(map, query, nodes, &mut ()),
            Some(mut seen) => run(map, query, nodes, &mut seen),
        }?;
        unfold_path(map, query, nodes, plan);
        plan.statistics = SearchStatistics::one_sided(nodes.statistics());
        plan.stop = Some(Stop::NothingBetter);
        Ok(())
    }
}

/// True if a single leg leads from the start to the goal, and they are different cells. It is the
/// first shortest path in the order of moves.
fn is_a_leg(map: &SearchMap, query: &Query) -> bool {
    query.start != query.goal && leg::is_free(map, query.start, query.goal)
}

/// Fills in the plan of a path that is a single leg.
fn take_the_leg(query: &Query, seen: Option<&mut dyn Observer>, plan: &mut Plan) {
    let (start, goal) = (query.start, query.goal);
    let cost = Cost::octile(start.x.abs_diff(goal.x), start.y.abs_diff(goal.y));
    if let Some(seen) = seen {
        seen.expanded(Side::Forward, start, 0.0);
        report_leg(seen, (start, goal), cost.key());
    }
    plan.cells.push(start);
    plan.mark_last();
    leg::diagonal_first(start, goal, plan);
    plan.cost = PlanCost::Steps(cost);
    plan.statistics = SearchStatistics::one_sided(SideStatistics { expanded: 1, generated: 2 });
    plan.stop = Some(Stop::NothingBetter);
}

/// Reports a find at the end of a leg, which is diagonal first, then straight.
fn report_leg(seen: &mut (impl Observer + ?Sized), (start, end): (Cell, Cell), g: u64) {
    let turn = leg::turn(start, end);
    for (from, to) in [(start, turn), (turn, end)] {
        if from != to {
            seen.scanned(Side::Forward, from, to);
        }
    }
    seen.generated(Side::Forward, end, start, cells(g));
}

fn run(
    map: &SearchMap,
    query: &Query,
    nodes: &mut JumpNodes,
    seen: &mut impl Observer,
) -> Result<(), PlanError> {
    if let Some(events) = map.diagonals() {
        return search(map, &JumpPoints::new(map, query.goal, events), query, nodes, seen);
    }
    let found = search(map, &JumpPoints::new(map, query.goal, Walked), query, nodes, seen);
    map.note_walked(cells_walked(query, nodes));
    found
}

/// Estimates the number of cells walked along diagonals: counting them would cost more than it is
/// worth.
fn cells_walked(query: &Query, nodes: &JumpNodes) -> u64 {
    let (start, goal) = (query.start, query.goal);
    let apart = start.x.abs_diff(goal.x) + start.y.abs_diff(goal.y);
    4 * (u64::from(apart) + nodes.statistics().expanded)
}

fn search<D: Diagonals>(
    map: &SearchMap,
    jumps: &JumpPoints<'_, D>,
    query: &Query,
    nodes: &mut JumpNodes,
    seen: &mut impl Observer,
) -> Result<(), PlanError> {
    let root = map.index(query.start);
    nodes.start(map, root, estimate(query.start, query.goal));
    if query.start == query.goal {
        nodes.reach_goal(0, root);
        return Ok(());
    }
    loop {
        let statistics = SearchStatistics::one_sided(nodes.statistics());
        let is_used_up = query.budget.is_some_and(|budget| statistics.expanded() >= budget);
        match nodes.expand_best(|at| estimate(jumps.place(at).cell, query.goal)) {
            Some(_) if is_used_up => {
                let budget = statistics.expanded();
                return Err(PlanError::BudgetExhausted { budget, statistics });
            }
            Some(node) => expand(jumps, query.goal, node, nodes, seen),
            None if nodes.last_before_goal().is_some() => return Ok(()),
            None => return Err(PlanError::NoPath { statistics }),
        }
    }
}

/// Generates the successors of a node.
fn expand<D: Diagonals>(
    jumps: &JumpPoints<'_, D>,
    goal: Cell,
    node: JumpNode,
    nodes: &mut JumpNodes,
    seen: &mut impl Observer,
) {
    let from = jumps.place(node.index);
    if seen.is_watching() {
        seen.expanded(Side::Forward, from.cell, cells(node.g));
    }
    let onward = jumps.onward(from, node.arrivals);
    jumps.scan(from, node.g, onward, &mut Successors { goal, from, nodes, seen });
}

/// Receives the finds of the scans from one node.
struct Successors<'s, O> {
    goal: Cell,
    from: Place,
    nodes: &'s mut JumpNodes,
    seen: &'s mut O,
}

impl<O: Observer> JumpVisitor for Successors<'_, O> {
    fn jump_point(&mut self, at: Place, arrival: Arrival, g: u64) -> u64 {
        let index = CellIndex(at.index as u32);
        let h = estimate(at.cell, self.goal);
        let parent = CellIndex(self.from.index as u32);
        let (known, is_open) = self.nodes.generate(index, g, parent, arrival, h);
        if is_open && self.seen.is_watching() {
            report_leg(self.seen, (self.from.cell, at.cell), g);
        }
        known
    }

    fn goal(&mut self, g: u64) {
        let parent = CellIndex(self.from.index as u32);
        if self.nodes.reach_goal(g, parent) && self.seen.is_watching() {
            report_leg(self.seen, (self.from.cell, self.goal), g);
        }
    }
}

/// The octile distance to the goal.
fn estimate(at: Cell, goal: Cell) -> u64 {
    Cost::octile(at.x.abs_diff(goal.x), at.y.abs_diff(goal.y)).key()
}

/// Writes all cells of the path and its cost: each leg is diagonal first, then straight. Jump
/// points are the nodes and the turning cells of the legs.
fn unfold_path(map: &SearchMap, query: &Query, nodes: &JumpNodes, plan: &mut Plan) {
    let mut to = query.goal;
    plan.cells.push(to);
    plan.mark_last();
    let mut cost = Cost::default();
    let mut parent = nodes.last_before_goal();
    while let Some(index) = parent {
        let from = map.cell(index);
        cost = cost + Cost::octile(from.x.abs_diff(to.x), from.y.abs_diff(to.y));
        leg::straight_first(to, from, plan);
        to = from;
        parent = nodes.parent(index);
    }
    plan.reverse_from(0);
    plan.cost = PlanCost::Steps(cost);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{CellState, GridFrame, LayerConfig, OccupancyGrid};
    use crate::random::Random;

    const SIDE: i32 = 200;

    /// Squares on open ground.
    fn blocks(random: &mut Random) -> OccupancyGrid {
        let mut below = |limit: i32| random.below(limit as u32) as i32;
        let blocks: Vec<[i32; 3]> =
            (0..40).map(|_| [below(SIDE), below(SIDE), 3 + below(20)]).collect();
        let frame = GridFrame::new(SIDE as u64, SIDE as u64, 1.0, crate::geometry::Pose::default());
        OccupancyGrid::from_fn(frame.unwrap(), |Cell { x, y }| {
            let is_in = |&[left, low, side]: &[i32; 3]| {
                (left..left + side).contains(&x) && (low..low + side).contains(&y)
            };
            if blocks.iter().any(is_in) { CellState::Occupied } else { CellState::Free }
        })
    }

    /// A path that is a single leg is the one that the search finds.
    #[test]
    fn a_leg_is_what_the_search_finds() {
        let mut random = Random::new(7);
        let map = SearchMap::new(&blocks(&mut random), LayerConfig::default()).unwrap();
        let mut nodes = JumpNodes::default();
        let mut legs = 0;
        for query in 0..4000 {
            let mut below = |limit: i32| random.below(limit as u32) as i32;
            let start = Cell::new(below(SIDE), below(SIDE));
            // Short ones meet the corners of the squares more often.
            let reach = if query % 2 == 0 { SIDE } else { 5 };
            let goal = Cell::new(
                start.x + below(2 * reach + 1) - reach,
                start.y + below(2 * reach + 1) - reach,
            );
            let query = Query::new(start, goal);
            if !map.is_free(start) || !map.is_free(goal) {
                continue;
            }
            let mut searched = Plan::default();
            if run(&map, &query, &mut nodes, &mut ()).is_err() {
                continue;
            }
            unfold_path(&map, &query, &nodes, &mut searched);
            let is_leg = is_a_leg(&map, &query);
            let length = start.x.abs_diff(goal.x).max(start.y.abs_diff(goal.y)) as usize;
            let looks_like_one =
                searched.jump_points.len() <= 3 && searched.cells.len() == length + 1;
            assert!(!is_leg || looks_like_one, "from {start} to {goal}");
            let (mut found, mut workspace) = (Plan::default(), Workspace::default());
            Jps.plan_into(&map, &query, &mut workspace, None, &mut found).unwrap();
            assert_eq!((&found.cells, &found.cost), (&searched.cells, &searched.cost));
            assert_eq!(found.jump_points, searched.jump_points);
            legs += u32::from(is_leg);
        }
        assert!(legs > 100, "{legs}");
    }

    /// Results and statistics do not depend on whether diagonals are walked cell by cell or
    /// traversed by events.
    #[test]
    fn passing_diagonals_changes_nothing() {
        let mut random = Random::new(46);
        let grid = blocks(&mut random);
        let mut below = |limit: i32| random.below(limit as u32) as i32;
        let fresh = || SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let warm = fresh();
        warm.note_walked(u64::from(u32::MAX));
        assert!(warm.diagonals().is_some());
        let mut found = 0;
        for _ in 0..300 {
            let [start, goal] = [(); 2].map(|()| Cell::new(below(SIDE), below(SIDE)));
            let query = Query::new(start, goal);
            let plan = |map: &SearchMap| {
                let mut plan = Plan::default();
                let mut workspace = Workspace::default();
                Jps.plan_into(map, &query, &mut workspace, None, &mut plan).ok()?;
                Some((plan.cells.clone(), plan.statistics))
            };
            let walked = plan(&fresh());
            found += u32::from(walked.is_some());
            assert_eq!(plan(&warm), walked, "from {start} to {goal}");
        }
        assert!(found > 100, "{found}");
    }
}
