//! Legs between two jump points: a diagonal, then a straight line. Either may be missing.

use super::jump_points::{JumpPoints, Walked};
use crate::map::{Cell, SearchMap};
use crate::plan::{Plan, PlanCost, Stop};
use crate::search::{Cost, Observer, Query, SearchStatistics, Side, SideStatistics, cells};

/// True if a free leg leads from the start to the goal, and they are different cells. That leg is
/// the first shortest path in the order of moves. Reads nothing but the map.
pub(super) fn leads_to_goal(map: &SearchMap, query: &Query) -> bool {
    let (start, goal) = (query.start, query.goal);
    match (start.x <= goal.x, start.y <= goal.y) {
        _ if start == goal => false,
        (true, true) => is_free::<true, true>(map, query),
        (true, false) => is_free::<true, false>(map, query),
        (false, true) => is_free::<false, true>(map, query),
        (false, false) => is_free::<false, false>(map, query),
    }
}

/// The straight line is tested first: 64 cells at a time.
fn is_free<const TO_EAST: bool, const TO_NORTH: bool>(map: &SearchMap, query: &Query) -> bool {
    let (start, goal) = (query.start, query.goal);
    let jumps = JumpPoints::new(map, goal, Walked);
    let from = jumps.place(map.index(start));
    let at = |steps| jumps.moved::<TO_EAST, TO_NORTH>(from, steps);
    let diagonal = start.x.abs_diff(goal.x).min(start.y.abs_diff(goal.y)) as usize;
    jumps.sees_goal(at(diagonal))
        && (0..diagonal).all(|steps| jumps.may_step::<TO_EAST, TO_NORTH>(at(steps)))
}

/// Fills in the plan of a path that is a single leg.
pub(super) fn take(query: &Query, seen: Option<&mut dyn Observer>, plan: &mut Plan) {
    let (start, goal) = (query.start, query.goal);
    let cost = Cost::octile(start.x.abs_diff(goal.x), start.y.abs_diff(goal.y));
    if let Some(seen) = seen {
        seen.expanded(Side::Forward, start, 0.0);
        report(seen, (start, goal), cost.key());
    }
    plan.cells.push(goal);
    plan.mark_last();
    unfold_backwards(goal, start, plan);
    plan.reverse_from(0);
    plan.cost = PlanCost::Steps(cost);
    plan.statistics = SearchStatistics::one_sided(SideStatistics { expanded: 1, generated: 2 });
    plan.stop = Some(Stop::NothingBetter);
}

/// Reports a find at the end of a leg, which is diagonal first, then straight.
pub(super) fn report(seen: &mut (impl Observer + ?Sized), (start, end): (Cell, Cell), g: u64) {
    let turn = turn_of(start, end);
    for (from, to) in [(start, turn), (turn, end)] {
        if from != to {
            seen.scanned(Side::Forward, from, to);
        }
    }
    seen.generated(Side::Forward, end, start, cells(g));
}

/// The cell at which a leg turns from diagonal to straight.
fn turn_of(from: Cell, to: Cell) -> Cell {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let diagonal = dx.abs().min(dy.abs());
    Cell::new(from.x + diagonal * dx.signum(), from.y + diagonal * dy.signum())
}

/// Appends the cells before `to`; seen from its end, the leg is straight, then diagonal.
pub(super) fn unfold_backwards(to: Cell, from: Cell, plan: &mut Plan) {
    let turn = turn_of(from, to);
    for (to, from) in [(to, turn), (turn, from)] {
        let (dx, dy) = (from.x - to.x, from.y - to.y);
        let (step_x, step_y) = (dx.signum(), dy.signum());
        let mut at = to;
        plan.cells.extend((0..dx.abs().max(dy.abs())).map(|_| {
            at = Cell::new(at.x + step_x, at.y + step_y);
            at
        }));
        plan.mark_last();
    }
}
