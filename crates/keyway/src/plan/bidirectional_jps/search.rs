//! The search of both planners: the two sides take turns until they have a node in common.

use super::JumpMeeting;
use super::jumps::{Direction, Jumps};
use super::marks::Marks;
use crate::map::{Cell, CellIndex, SearchMap};
use crate::plan::best_first::check_budget;
use crate::plan::two_sided::OpenKeys;
use crate::plan::{Miss, Plan, PlanError, Stop, path_cost};
use crate::search::{
    Cost, DistanceTo, Expanded, Frontier, GridStep, Metric, Observer, Octile, Query, Rule,
    SearchMemory, SearchStatistics, Side, Workspace, cells,
};

/// The target of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Targets {
    /// The node that the other side expanded last; initially its root.
    Moving,
    /// The other side's root.
    Fixed,
}

/// A planner of this folder, with its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Method<M> {
    pub(super) planner: &'static str,
    pub(super) targets: Targets,
    pub(super) meeting: JumpMeeting,
    pub(super) keys: OpenKeys,
    pub(super) metric: M,
    pub(super) a: f64,
    pub(super) b: f64,
}

/// The memory of both sides, the forward one first.
#[derive(Debug, Default)]
struct JumpSides([JumpSide; 2]);

#[derive(Debug, Default)]
struct JumpSide {
    frontier: Frontier,
    marks: Marks,
}

impl SearchMemory for JumpSides {
    fn memory_bytes(&self) -> usize {
        let of_side = |side: &JumpSide| side.frontier.memory_bytes() + side.marks.memory_bytes();
        self.0.iter().map(of_side).sum()
    }
}

/// One side of the search.
#[derive(Debug)]
struct Half<'w> {
    side: Side,
    frontier: &'w mut Frontier,
    /// Cells of this side that stop the other side's scans.
    marks: &'w mut Marks,
    /// The other side's target.
    aim: Expanded,
    /// The root of the other side.
    other_root: Cell,
}

/// A node that joins a path from root to root, and the cost of that path.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    at: CellIndex,
    cost: u64,
}

/// Equation (2): a node's key with the current target.
pub(super) struct TowardsTarget<M> {
    pub(super) to_target: DistanceTo<M>,
    pub(super) a: f64,
    /// b G2: the weighted cost of the target from the other side.
    pub(super) rest: u64,
}

impl<M: Metric> Rule for TowardsTarget<M> {
    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    /// Eq. (2): F1(n) = G1(n) + a H1(n) + b G2(n).
    fn key(&self, at: CellIndex, g: u64) -> u64 {
        g.saturating_add(weighted(self.a, self.to_target.from(at))).saturating_add(self.rest)
    }
}

/// A cost times a weight, rounded down; exact for small whole weights.
pub(super) fn weighted(weight: f64, cost: u64) -> u64 {
    (weight * cost as f64) as u64
}

impl<M: Metric> Method<M> {
    /// Searches, and writes the path.
    pub(super) fn plan(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let [forward, backward] = &mut workspace.part::<JumpSides>().0;
        let sides = [
            Half::start(map, Side::Forward, [query.start, query.goal], forward),
            Half::start(map, Side::Backward, [query.goal, query.start], backward),
        ];
        let meeting = match seen {
            None => self.run(map, query, sides, &mut ()),
            Some(mut seen) => self.run(map, query, sides, &mut seen),
        }?;
        let (forward, backward) = (&forward.frontier, &backward.frontier);
        unfold_path(map, (forward, backward), meeting, plan);
        plan.cost = path_cost(map, &plan.cells);
        plan.statistics = crate::plan::two_sided::statistics(forward, backward);
        plan.meeting = Some(map.cell(meeting));
        plan.stop = Some(Stop::SidesMet);
        Ok(())
    }

    /// Lets the sides take turns; returns the node in which they met.
    fn run(
        &self,
        map: &SearchMap,
        query: &Query,
        sides: [Half<'_>; 2],
        seen: &mut impl Observer,
    ) -> Result<CellIndex, PlanError> {
        let [mut active, mut waiting] = sides;
        if query.start == query.goal {
            return Ok(active.aim.at);
        }
        let mut best = None;
        loop {
            if let Some(meeting) =
                self.turn(map, query, [&mut active, &mut waiting], &mut best, seen)?
            {
                return Ok(meeting);
            }
            std::mem::swap(&mut active, &mut waiting);
        }
    }

    /// Expands nodes of one side until it has inserted a node into its list or the search ends. In
    /// the latter case it returns the node in which the sides met. `best` is the cheapest meeting
    /// so far.
    fn turn(
        &self,
        map: &SearchMap,
        query: &Query,
        [active, waiting]: [&mut Half<'_>; 2],
        best: &mut Option<Meeting>,
        seen: &mut impl Observer,
    ) -> Result<Option<CellIndex>, PlanError> {
        let target = map.cell(waiting.aim.at);
        let rule = TowardsTarget {
            to_target: DistanceTo::new(map, self.metric, target),
            a: self.a,
            rest: weighted(self.b, waiting.aim.g),
        };
        if self.keys == OpenKeys::Renewed {
            active.frontier.renew_keys(&rule);
        }
        loop {
            let statistics = statistics(active, waiting);
            check_budget(query, statistics)?;
            let Some(node) = active.frontier.take_best() else {
                // No open node is left that could lead to a better meeting.
                let (planner, miss) = (self.planner, Miss::SidesPassed);
                let missed = PlanError::Missed { planner, miss, statistics };
                return best.map(|meeting| Some(meeting.at)).ok_or(missed);
            };
            if seen.is_watching() {
                seen.expanded(active.side, map.cell(node.at), cells(node.g));
            }
            if self.meeting == JumpMeeting::Expanded && waiting.frontier.is_closed(node.at) {
                if seen.is_watching() {
                    seen.met(map.cell(node.at));
                }
                return Ok(Some(node.at));
            }
            let rest = DistanceTo::new(map, Octile, active.other_root).from(node.at);
            if best.is_some_and(|meeting| node.g + rest >= meeting.cost) {
                continue;
            }
            let before = active.frontier.statistics().generated;
            let met = self.expand(map, node, &rule, [active, waiting], *best, seen);
            if self.targets == Targets::Moving {
                active.aim_at(map, node, self.meeting);
            }
            match (self.meeting, met) {
                (JumpMeeting::Generated | JumpMeeting::Literal, Some(met)) => {
                    return Ok(Some(met.at));
                }
                (JumpMeeting::Best, _) => *best = met,
                _ => {}
            }
            if active.frontier.statistics().generated > before {
                return Ok(None);
            }
        }
    }

    /// Inserts the next nodes in all directions of a node into the open list. Returns the cheapest
    /// meeting: the best one so far, or one over those of the new nodes that the other side has
    /// (in a tie the first one).
    fn expand(
        &self,
        map: &SearchMap,
        node: Expanded,
        rule: &impl Rule,
        [active, waiting]: [&mut Half<'_>; 2],
        mut best: Option<Meeting>,
        seen: &mut impl Observer,
    ) -> Option<Meeting> {
        let from = map.cell(node.at);
        let jumps = Jumps { map, targets: waiting.marks };
        let arrival = Direction::between(map.cell(active.frontier.parent(node.at)), from);
        for direction in jumps.onward(from, arrival) {
            let scan = jumps.scan(from, direction);
            if seen.is_watching() && scan.end != from {
                seen.scanned(active.side, from, scan.end);
            }
            let Some(to) = scan.node else { continue };
            let index = map.index(to);
            let cost = Cost::octile(from.x.abs_diff(to.x), from.y.abs_diff(to.y)).key();
            let step = GridStep { to: index, cost };
            let Some(g) = active.frontier.offer(node, step, rule) else { continue };
            if seen.is_watching() {
                seen.generated(active.side, to, from, cells(g));
            }
            if self.meeting != JumpMeeting::Literal {
                active.marks.mark(to);
            }
            let whole = waiting.frontier.value(index).map(|rest| g + rest);
            let is_met = self.meeting != JumpMeeting::Expanded;
            let is_cheaper = |&cost: &u64| best.is_none_or(|best| cost < best.cost);
            if let Some(cost) = whole.filter(is_cheaper).filter(|_| is_met) {
                best = Some(Meeting { at: index, cost });
                if seen.is_watching() {
                    seen.met(to);
                }
            }
        }
        best
    }
}

impl<'w> Half<'w> {
    fn start(
        map: &SearchMap,
        side: Side,
        [root, other_root]: [Cell; 2],
        JumpSide { frontier, marks }: &'w mut JumpSide,
    ) -> Self {
        let aim = Expanded { at: map.index(root), g: 0 };
        // The root is the only node in the list, so its key does not matter.
        frontier.start(map, aim.at, 0);
        marks.start(map);
        marks.mark(root);
        Self { side, frontier, marks, aim, other_root }
    }

    /// Makes a node that was just expanded the target of the other side.
    fn aim_at(&mut self, map: &SearchMap, node: Expanded, meeting: JumpMeeting) {
        self.aim = node;
        if meeting == JumpMeeting::Literal {
            self.marks.clear();
            self.marks.mark(map.cell(node.at));
        }
    }
}

/// The statistics of both sides.
fn statistics(active: &Half<'_>, waiting: &Half<'_>) -> SearchStatistics {
    let mut both = SearchStatistics::default();
    for half in [active, waiting] {
        *both.side_mut(half.side) = half.frontier.statistics();
    }
    both
}

/// Writes all cells of the path over the node in which the sides met. Jump points are the nodes of
/// both sides, including their roots and the meeting node.
fn unfold_path(
    map: &SearchMap,
    (forward, backward): (&Frontier, &Frontier),
    meeting: CellIndex,
    plan: &mut Plan,
) {
    plan.cells.push(map.cell(meeting));
    plan.mark_last();
    unfold_way_back(map, forward, meeting, plan);
    plan.reverse_from(0);
    unfold_way_back(map, backward, meeting, plan);
}

/// Appends the cells after `from` on the path back to a side's root.
fn unfold_way_back(map: &SearchMap, side: &Frontier, from: CellIndex, plan: &mut Plan) {
    let mut node = from;
    let mut at = map.cell(from);
    loop {
        let parent = side.parent(node);
        let to = map.cell(parent);
        let Some(direction) = Direction::between(at, to) else { return };
        while at != to {
            at = direction.step(at);
            plan.cells.push(at);
        }
        plan.mark_last();
        node = parent;
    }
}
