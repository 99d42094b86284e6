//! Jump point search \[Harabor2011\]: a map and two cells -> a shortest 8-connected path, without
//! corner cutting.
//!
//! A* over jump points: of all shortest paths between two cells only one order of moves is searched
//! (diagonal first), and whole straight runs are passed 64 cells at a time. Nodes are straight jump
//! points only; a node reached at equal cost from another direction takes on that direction, too.
//! Each expansion tries one shot at the goal, diagonal then straight, in place of goal tests inside
//! the scans.
//!
//! # Source
//! \[Harabor2011\] D. Harabor, A. Grastien, "Online graph pruning for pathfinding on grid maps", AAAI
//! 2011. \[Harabor2014\] D. Harabor, A. Grastien, "Improving jump point search", ICAPS 2014 (block
//! scanning and pruning; rules without corner cutting).
//!
//! | paper | here |
//! |---|---|
//! | jump(x, d) | `JumpPoints::scan` |
//! | natural and forced neighbours | `JumpPoints::onward` |
//! | g, h | [`Cost::key`], octile |
//!
//! # Errors / cost
//! See [`PlanError`]; a map with penalised cells is refused, as jump points need one cost for all
//! cells. 16 bytes per cell of the padded map, of which only the pages of reached cells are touched.

use super::{GlobalPlanner, Plan, PlanError, path_cost};
use crate::map::{Cell, Connectivity, SearchMap};
use crate::search::{
    Arrival, Cost, Directions, Jump, JumpNodes, JumpPoints, Observer, Query, Side, Workspace,
};
use serde::{Deserialize, Serialize};

/// Parameters of [`Jps`]: none, the rule is fixed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct JpsConfig {}

/// Jump point search; optimal without corner cutting.
#[derive(Clone, Debug, Default)]
pub struct Jps;

impl Jps {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "jps";
}

impl GlobalPlanner for Jps {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        if map.penalised().is_some() {
            return Err(PlanError::NeedsUniformCost { planner: Self::NAME });
        }
        let nodes = &mut workspace.jumps;
        match seen {
            None => run(map, query, nodes, &mut ()),
            Some(mut seen) => run(map, query, nodes, &mut seen),
        }?;
        unfold_path(map, query, nodes, &mut plan.cells);
        plan.cost = path_cost(map, &plan.cells);
        plan.statistics = nodes.statistics();
        Ok(())
    }
}

fn run(
    map: &SearchMap,
    query: &Query,
    nodes: &mut JumpNodes,
    seen: &mut impl Observer,
) -> Result<(), PlanError> {
    let jumps = JumpPoints::new(map);
    let goal = map.index(query.goal);
    let estimate =
        |at: Cell| Cost::octile(at.x.abs_diff(query.goal.x), at.y.abs_diff(query.goal.y)).key();
    nodes.start(map, map.index(query.start), estimate(query.start));
    loop {
        match query.budget {
            Some(budget) if nodes.statistics().expanded >= budget => {
                return Err(PlanError::BudgetExhausted { budget, statistics: nodes.statistics() });
            }
            _ => {}
        }
        let Some((index, g, arrivals)) = nodes.expand_best() else {
            return Err(PlanError::NoPath { statistics: nodes.statistics() });
        };
        let at = map.cell(index);
        if seen.is_watching() {
            seen.expanded(Side::Forward, at, g as f64 / Cost::KEY_STRAIGHT as f64);
        }
        if index == goal {
            return Ok(());
        }
        let mut generate = |Jump { to, arrival, cost }: Jump| {
            let to_index = map.index(to);
            let g = g + cost;
            if nodes.generate(to_index, g, index, arrival, estimate(to)) && seen.is_watching() {
                seen.generated(Side::Forward, to, g as f64 / Cost::KEY_STRAIGHT as f64);
            }
        };
        if let Some(cost) = jumps.shot(at, query.goal) {
            generate(Jump { to: query.goal, arrival: 0, cost });
        }
        jumps.scan(at, directions(&jumps, at, arrivals), generate);
    }
}

/// Where to go on from a node that was reached from the given directions; everywhere from the start,
/// which was reached from none.
fn directions(jumps: &JumpPoints<'_>, at: Cell, arrivals: u8) -> Directions {
    if arrivals == 0 {
        return Directions::ALL;
    }
    let each = (0..4 as Arrival).filter(|&arrival| arrivals >> arrival & 1 == 1);
    Directions(each.fold(0, |all, arrival| all | jumps.onward(at, arrival).0))
}

/// All cells of the path: each leg is diagonal first, then straight.
fn unfold_path(map: &SearchMap, query: &Query, nodes: &JumpNodes, cells: &mut Vec<Cell>) {
    let mut at = map.index(query.goal);
    cells.push(query.goal);
    while let Some(parent) = nodes.parent(at) {
        unfold_leg_backwards(map.cell(at), map.cell(parent), cells);
        at = parent;
    }
    cells.reverse();
}

fn unfold_leg_backwards(to: Cell, from: Cell, cells: &mut Vec<Cell>) {
    let (mut x, mut y) = (to.x, to.y);
    while (x, y) != (from.x, from.y) {
        let (dx, dy) = (from.x - x, from.y - y);
        // Seen from its end, the leg is straight until both distances are equal.
        if dx.abs() >= dy.abs() {
            x += dx.signum();
        }
        if dy.abs() > dx.abs() || dx.abs() == dy.abs() {
            y += dy.signum();
        }
        cells.push(Cell::new(x, y));
    }
}
