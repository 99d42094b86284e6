//! Shared parts of all bidirectional planners.

use super::best_first::check_budget;
use super::{Plan, PlanError, Stop, path_cost};
use crate::map::{CellIndex, SearchMap};
use crate::search::{
    Expanded, Frontier, Observer, Query, Rule, SearchStatistics, Side, Successors, cells,
};
use serde::{Deserialize, Serialize};

/// The statistics of both sides.
pub(super) const fn statistics(forward: &Frontier, backward: &Frontier) -> SearchStatistics {
    SearchStatistics { forward: forward.statistics(), backward: backward.statistics() }
}

/// Writes the path over a cell that both sides reached, the meeting cell and the statistics. The
/// path's waypoints are the nodes of the two searches.
pub(super) fn join(
    map: &SearchMap,
    (forward, backward): (&Frontier, &Frontier),
    meeting: CellIndex,
    plan: &mut Plan,
) {
    forward.path_into(map, meeting, &mut plan.cells);
    // The meeting cell ends the first half and begins the second one.
    plan.cells.pop();
    backward.append_path_back(map, meeting, &mut plan.cells);
    plan.statistics = statistics(forward, backward);
    plan.meeting = Some(map.cell(meeting));
}

/// Like `join` for a path of neighbouring cells; adds its cost and the reason for the stop.
pub(super) fn finish(
    map: &SearchMap,
    sides: (&Frontier, &Frontier),
    meeting: CellIndex,
    stop: Stop,
    plan: &mut Plan,
) {
    join(map, sides, meeting, plan);
    plan.cost = path_cost(map, &plan.cells);
    plan.stop = Some(stop);
}

/// The treatment of the keys of open nodes when they become outdated because the other side's
/// target or a weight changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum OpenKeys {
    /// They keep the values from the time of insertion or improvement.
    #[default]
    Kept,
    /// All are recomputed before each turn of their side: O(n log n) for n open nodes.
    Renewed,
}

/// The current nodes of both sides: the nodes that they expanded last, initially their roots.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurrentNodes {
    /// The current node of the side whose turn it is.
    pub(super) own: CellIndex,
    /// The current node of the other side.
    pub(super) other: CellIndex,
}

/// The condition under which two alternating sides have met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    /// They meet when one side inserts a node into its open list that the other has reached. If
    /// one expansion finds several such nodes, the one with the cheapest path counts, the first of
    /// equal ones.
    Generated,
    /// They meet when one side takes a node from its open list that the other has expanded.
    Expanded,
}

/// One side of a search whose two sides take turns.
pub(super) struct Half<'a, N, A> {
    side: Side,
    frontier: &'a mut Frontier,
    steps: N,
    /// True if a step into a cell is allowed; asked until the cell is reached.
    allows: A,
    /// Its current node: the node that it expanded last, initially its root.
    current: CellIndex,
}

/// Lets the sides expand one node each in turn, the forward one first, until they meet; returns
/// the meeting cell. `rule` gives the rule of a side from the current nodes. It is used for the
/// successors of the side's node, which is then its current one, and, if keys are renewed, before
/// that node is taken.
///
/// If a path exists, the sides meet: a side that runs out of open nodes has expanded every
/// reachable cell, including the root of the other one.
///
/// # Errors
/// [`PlanError::NoPath`] if a side runs out of open nodes.
pub(super) fn take_turns<R: Rule>(
    map: &SearchMap,
    query: &Query,
    mut forward: Half<'_, impl Successors, impl Fn(CellIndex) -> bool>,
    mut backward: Half<'_, impl Successors, impl Fn(CellIndex) -> bool>,
    rule: impl Fn(Side, CurrentNodes) -> R,
    (keys, meeting): (OpenKeys, Meeting),
    seen: &mut impl Observer,
) -> Result<CellIndex, PlanError> {
    let (start, goal) = (map.index(query.start), map.index(query.goal));
    let of = |side, [own, other]: [CellIndex; 2]| rule(side, CurrentNodes { own, other });
    forward.start(map, start, &of(Side::Forward, [start, goal]));
    backward.start(map, goal, &of(Side::Backward, [goal, start]));
    if start == goal {
        return Ok(start);
    }
    let how = (keys, meeting);
    loop {
        if let Some(met) = forward.turn(map, query, &backward, &rule, how, seen)? {
            return Ok(met);
        }
        if let Some(met) = backward.turn(map, query, &forward, &rule, how, seen)? {
            return Ok(met);
        }
    }
}

impl<'a, N: Successors, A: Fn(CellIndex) -> bool> Half<'a, N, A> {
    pub(super) const fn new(side: Side, frontier: &'a mut Frontier, steps: N, allows: A) -> Self {
        Self { side, frontier, steps, allows, current: CellIndex(0) }
    }

    fn start(&mut self, map: &SearchMap, root: CellIndex, rule: &impl Rule) {
        self.frontier.start(map, root, rule.key(root, 0));
        self.current = root;
    }

    /// Takes the best node from the open list, and expands it unless the sides have met there.
    /// Returns the meeting cell, if any.
    fn turn<R: Rule>(
        &mut self,
        map: &SearchMap,
        query: &Query,
        other: &Half<'_, impl Successors, impl Fn(CellIndex) -> bool>,
        rule: &impl Fn(Side, CurrentNodes) -> R,
        (keys, meeting): (OpenKeys, Meeting),
        seen: &mut impl Observer,
    ) -> Result<Option<CellIndex>, PlanError> {
        let mut statistics = SearchStatistics::default();
        *statistics.side_mut(self.side) = self.frontier.statistics();
        *statistics.side_mut(other.side) = other.frontier.statistics();
        check_budget(query, statistics)?;
        let rule = |own| rule(self.side, CurrentNodes { own, other: other.current });
        if keys == OpenKeys::Renewed {
            self.frontier.renew_keys(&rule(self.current));
        }
        let Some(node) = self.frontier.take_best() else {
            return Err(PlanError::NoPath { statistics });
        };
        let rule = &rule(node.at);
        self.current = node.at;
        if seen.is_watching() {
            seen.expanded(self.side, map.cell(node.at), cells(node.g));
        }
        let met = match meeting {
            Meeting::Expanded if other.frontier.is_closed(node.at) => Some(node.at),
            Meeting::Expanded => {
                self.expand(map, node, rule, |_, _| (), seen);
                None
            }
            Meeting::Generated => {
                let mut cheapest: Option<(u64, CellIndex)> = None;
                let compare = |at, g| {
                    let Some(rest) = other.frontier.value(at) else { return };
                    if cheapest.is_none_or(|(cost, _)| g + rest < cost) {
                        cheapest = Some((g + rest, at));
                    }
                };
                self.expand(map, node, rule, compare, seen);
                cheapest.map(|(_, at)| at)
            }
        };
        if let Some(at) = met
            && seen.is_watching()
        {
            seen.met(map.cell(at));
        }
        Ok(met)
    }

    /// Inserts the successors of a node into the open list, and reports each of them with its g.
    fn expand(
        &mut self,
        map: &SearchMap,
        node: Expanded,
        rule: &impl Rule,
        mut report: impl FnMut(CellIndex, u64),
        seen: &mut impl Observer,
    ) {
        self.steps.for_each(node.at, |step| {
            if self.frontier.value(step.to).is_none() && !(self.allows)(step.to) {
                return;
            }
            let Some(g) = self.frontier.offer(node, step, rule) else { return };
            if seen.is_watching() {
                seen.generated(self.side, map.cell(step.to), map.cell(node.at), cells(g));
            }
            report(step.to, g);
        });
    }
}

/// Runs planners on drawn maps, for tests.
#[cfg(test)]
pub(super) mod drawn {
    use super::Side;
    use crate::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
    use crate::plan::{GlobalPlanner, Plan, PlanError};
    use crate::search::{Observer, Query, Workspace};

    /// The cells that the forward and the backward side expand, each in order of expansion.
    pub(in crate::plan) type Sides = [Vec<(i32, i32)>; 2];

    #[derive(Default)]
    struct Expansions(Vec<(Side, (i32, i32))>);

    impl Observer for Expansions {
        fn expanded(&mut self, side: Side, at: Cell, _: f64) {
            self.0.push((side, (at.x, at.y)));
        }
    }

    /// A map with one metre per cell, top row first.
    pub(in crate::plan) fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    /// Plans from `S` to `G`; returns the plan and the expanded cells.
    pub(in crate::plan) fn plan(
        planner: &impl GlobalPlanner,
        rows: &[&str],
    ) -> Result<(Plan, Sides), PlanError> {
        let end = |letter| {
            let places = rows.iter().rev().zip(0..);
            let mut found =
                places.filter_map(|(row, y)| Some(Cell::new(row.find(letter)? as i32, y)));
            found.next().unwrap()
        };
        let query = Query::new(end('S'), end('G'));
        let free: Vec<String> = rows.iter().map(|row| row.replace(['S', 'G'], ".")).collect();
        let map = map(&free.iter().map(String::as_str).collect::<Vec<_>>());
        let (mut log, mut plan) = (Expansions::default(), Plan::default());
        planner.plan_into(&map, &query, &mut Workspace::default(), Some(&mut log), &mut plan)?;
        let sides = [Side::Forward, Side::Backward];
        // One expansion each, the forward side first.
        for ((side, _), expected) in log.0.iter().zip(sides.into_iter().cycle()) {
            assert_eq!(*side, expected);
        }
        let of = |side| log.0.iter().filter(|(s, _)| *s == side).map(|(_, at)| *at).collect();
        Ok((plan, sides.map(of)))
    }
}
