//! Unfolds a route into the cells of its path. The jump points are the cells known to the query:
//! its turns, and the nodes of the route.

use super::Prepared;
use super::query::Route;
use crate::map::Cell;
use crate::plan::Plan;
use crate::plan::leg::{diagonal_first, run, straight_first};
use crate::search::{Cost, Query};

impl Prepared {
    /// Writes all cells of a route, and returns its cost.
    pub(super) fn unfold(&self, query: &Query, route: Route, plan: &mut Plan) -> Cost {
        let Query { start, goal, .. } = *query;
        plan.cells.push(start);
        plan.mark_last();
        match route {
            Route::Direct => {
                diagonal_first(start, goal, plan);
                octile(start, goal)
            }
            Route::Turn(at) => {
                diagonal_first(start, at, plan);
                straight_first(at, goal, plan);
                octile(start, at) + octile(at, goal)
            }
            Route::Hub { from, hub, to } => {
                let head = self.unfold_to_hub(start, from, hub, plan);
                let turned = plan.cells.len();
                plan.cells.push(goal);
                plan.mark_last();
                let tail = self.unfold_to_hub(goal, to, hub, plan);
                // Both halves end at the hub.
                plan.cells.pop();
                plan.jump_points.pop();
                plan.reverse_from(turned);
                head + tail
            }
        }
    }

    /// Appends the path over a node in sight to one of its hubs, and returns its cost.
    fn unfold_to_hub(&self, from: Cell, node: u32, hub: u32, plan: &mut Plan) -> Cost {
        let labels = &self.labels;
        let mut at = self.cells[node as usize];
        diagonal_first(from, at, plan);
        // The hub is in the label: it was found there.
        let Some(mut place) = labels.place(node, hub) else { return Cost::default() };
        let cost = octile(from, at) + labels.entries[place].cost();
        plan.cells.reserve((cost.straight + cost.diagonal) as usize);
        loop {
            let (left, hop) = (labels.entries[place].cost(), labels.hops[place]);
            place = hop.next();
            let after = labels.entries[place].cost();
            if after == left {
                return cost;
            }
            let leg = Leg::new(
                hop.octant(),
                (left.straight - after.straight) as i32,
                (left.diagonal - after.diagonal) as i32,
            );
            // The leg was found from the next node, from which it is diagonal first.
            at = run(at, leg.straight, leg.rest, plan);
            at = run(at, leg.diagonal, leg.count, plan);
        }
    }
}

/// An octile path: `count` diagonal steps, and `rest` straight ones.
struct Leg {
    diagonal: (i32, i32),
    count: i32,
    straight: (i32, i32),
    rest: i32,
}

impl Leg {
    fn new(octant: u8, rest: i32, count: i32) -> Self {
        let sign = |is_negative: bool| if is_negative { -1 } else { 1 };
        let diagonal = (sign(octant & 1 == 1), sign(octant & 2 == 2));
        let straight = if octant & 4 == 4 { (0, diagonal.1) } else { (diagonal.0, 0) };
        Self { diagonal, count, straight, rest }
    }
}

fn octile(a: Cell, b: Cell) -> Cost {
    Cost::octile(a.x.abs_diff(b.x), a.y.abs_diff(b.y))
}
