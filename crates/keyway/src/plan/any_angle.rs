//! Shared parts of any-angle planners: the search loop of the Theta* family, and the path that
//! follows from its parents.

use super::best_first::check_budget;
use super::{Plan, PlanCost, PlanError, Stop};
use crate::map::{Cell, CellIndex, SearchMap};
use crate::search::{
    Accumulated, CornerRule, DistanceTo, Euclidean, Expanded, Frontier, GridStep, Metric, Moves,
    Neighbours, Observer, Query, Rule, SearchStatistics, Side, Sides, Sight, Successors, Uniform,
    Workspace, cells,
};

/// The choice of parents in a search of the Theta* family, and the time of the line-of-sight
/// checks.
pub(super) trait Ways {
    /// The best path to a neighbour of an expanded node: the node that it comes from (the expanded
    /// node itself or its parent) and the step. `known` is the value of the known path; `None`
    /// keeps that path.
    fn way(
        &self,
        lines: &Lines<'_>,
        parent: Expanded,
        node: Expanded,
        step: GridStep,
        known: Option<u64>,
    ) -> Option<(Expanded, GridStep)>;

    /// The true parent and value of a node just taken from the open list, if it was inserted with
    /// provisional ones.
    fn corrected(
        &self,
        lines: &Lines<'_>,
        frontier: &Frontier,
        node: Expanded,
    ) -> Option<(CellIndex, u64)> {
        let _ = (lines, frontier, node);
        None
    }
}

/// Lines of sight and grid steps between the cells of a map.
pub(super) struct Lines<'m> {
    map: &'m SearchMap,
    sight: Sight<'m>,
    steps: Neighbours<'m, Uniform>,
}

impl<'m> Lines<'m> {
    fn new(map: &'m SearchMap, corners: CornerRule) -> Self {
        Self {
            map,
            sight: Sight::new(map, corners),
            steps: Neighbours::new(map, Moves::Eight(corners), Uniform),
        }
    }

    /// The straight line between two cells, free or not; its length is rounded down.
    pub(super) fn line(&self, from: CellIndex, to: CellIndex) -> GridStep {
        let (a, b) = (self.map.cell(from), self.map.cell(to));
        GridStep { to, cost: Euclidean.length(a.x.abs_diff(b.x), a.y.abs_diff(b.y)) }
    }

    /// True if the line of sight between two cells is free.
    pub(super) fn is_free(&self, a: CellIndex, b: CellIndex) -> bool {
        self.sight.is_free(self.map.cell(a), self.map.cell(b))
    }

    /// Visits the steps from a cell; they are also the steps to it.
    pub(super) fn for_each_step(&self, at: CellIndex, visit: impl FnMut(GridStep)) {
        self.steps.for_each(at, visit);
    }
}

/// Runs a search of the Theta* family from the query's start to its goal and writes the plan.
pub(super) fn plan(
    ways: &impl Ways,
    map: &SearchMap,
    query: &Query,
    corners: CornerRule,
    workspace: &mut Workspace,
    seen: Option<&mut dyn Observer>,
    plan: &mut Plan,
) -> Result<(), PlanError> {
    let lines = Lines::new(map, corners);
    let frontier = &mut workspace.part::<Sides>().forward;
    match seen {
        None => run(ways, &lines, query, frontier, &mut ()),
        Some(mut seen) => run(ways, &lines, query, frontier, &mut seen),
    }?;
    frontier.path_into(map, map.index(query.goal), &mut plan.cells);
    keep_turns(&mut plan.cells);
    plan.cost = length(&plan.cells);
    plan.statistics = SearchStatistics::one_sided(frontier.statistics());
    plan.stop = Some(Stop::GoalExpanded);
    Ok(())
}

/// Expands nodes until the goal is taken from the open list.
fn run(
    ways: &impl Ways,
    lines: &Lines<'_>,
    query: &Query,
    frontier: &mut Frontier,
    seen: &mut impl Observer,
) -> Result<(), PlanError> {
    let map = lines.map;
    let (start, goal) = (map.index(query.start), map.index(query.goal));
    let rule = Accumulated(DistanceTo::new(map, Euclidean, query.goal));
    frontier.start(map, start, rule.key(start, 0));
    loop {
        let statistics = SearchStatistics::one_sided(frontier.statistics());
        check_budget(query, statistics)?;
        let Some(taken) = frontier.take_best() else {
            return Err(PlanError::NoPath { statistics });
        };
        let node = correct(ways, lines, frontier, taken, seen);
        if node.at == goal {
            return Ok(());
        }
        expand(ways, lines, frontier, node, &rule, seen);
    }
}

/// Gives a node that was just taken from the open list its true parent and value.
fn correct(
    ways: &impl Ways,
    lines: &Lines<'_>,
    frontier: &mut Frontier,
    taken: Expanded,
    seen: &mut impl Observer,
) -> Expanded {
    let correction = ways.corrected(lines, frontier, taken);
    let node = Expanded { g: correction.map_or(taken.g, |(_, g)| g), ..taken };
    let at = lines.map.cell(node.at);
    if seen.is_watching() {
        seen.expanded(Side::Forward, at, cells(node.g));
    }
    if let Some((parent, g)) = correction {
        frontier.reparent(node.at, parent, g);
        if seen.is_watching() {
            seen.reparented(Side::Forward, at, lines.map.cell(parent), cells(g));
        }
    }
    node
}

/// Inserts the neighbours of a node into the open list.
fn expand(
    ways: &impl Ways,
    lines: &Lines<'_>,
    frontier: &mut Frontier,
    node: Expanded,
    rule: &impl Rule,
    seen: &mut impl Observer,
) {
    let parent = frontier.came_from(node.at);
    lines.for_each_step(node.at, |step| {
        if frontier.is_closed(step.to) {
            return;
        }
        let known = frontier.value(step.to);
        let Some((from, step)) = ways.way(lines, parent, node, step, known) else { return };
        if let Some(g) = frontier.offer(from, step, rule)
            && seen.is_watching()
        {
            let (at, from) = (lines.map.cell(step.to), lines.map.cell(from.at));
            seen.generated(Side::Forward, at, from, cells(g));
        }
    });
}

/// Drops the waypoints at which a path does not turn.
pub(super) fn keep_turns(cells: &mut Vec<Cell>) {
    let mut kept = 0;
    for i in 0..cells.len() {
        let goes_straight_on =
            i > 0 && i + 1 < cells.len() && is_straight_on(cells[kept - 1], cells[i], cells[i + 1]);
        if !goes_straight_on {
            cells[kept] = cells[i];
            kept += 1;
        }
    }
    cells.truncate(kept);
}

/// True if the line from `b` to `c` has the direction of that from `a` to `b`.
pub(super) fn is_straight_on(a: Cell, b: Cell, c: Cell) -> bool {
    let difference = |from: Cell, to: Cell| {
        (i128::from(to.x) - i128::from(from.x), i128::from(to.y) - i128::from(from.y))
    };
    let ((x1, y1), (x2, y2)) = (difference(a, b), difference(b, c));
    x1 * y2 == x2 * y1 && x1 * x2 + y1 * y2 > 0
}

/// The length of a path of straight lines.
pub(super) fn length(cells: &[Cell]) -> PlanCost {
    let leg = |pair: &[Cell]| {
        let dx = f64::from(pair[0].x.abs_diff(pair[1].x));
        let dy = f64::from(pair[0].y.abs_diff(pair[1].y));
        (dx * dx + dy * dy).sqrt()
    };
    // An empty floating-point sum would be -0.
    PlanCost::Length(cells.windows(2).map(leg).fold(0.0, |sum, leg| sum + leg))
}

/// Observations for tests of these planners.
#[cfg(test)]
pub(super) mod watched {
    use crate::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
    use crate::plan::{GlobalPlanner, Plan};
    use crate::search::{Observer, Query, Side, Workspace};

    /// One report: the event, the cell (x, y), its parent, and g.
    pub(in crate::plan) type Line = (&'static str, (i32, i32), (i32, i32), f64);

    /// Collects all reports, in order.
    #[derive(Default)]
    pub(in crate::plan) struct Told(pub(in crate::plan) Vec<Line>);

    /// Rounds to 1e-6 cells: the values of the search are exact to 1e-8 cells only.
    pub(in crate::plan) fn rounded(g: f64) -> f64 {
        (g * 1e6).round() / 1e6
    }

    impl Observer for Told {
        fn expanded(&mut self, _: Side, at: Cell, g: f64) {
            self.0.push(("expanded", (at.x, at.y), (at.x, at.y), g));
        }

        fn generated(&mut self, _: Side, at: Cell, parent: Cell, g: f64) {
            self.0.push(("generated", (at.x, at.y), (parent.x, parent.y), g));
        }

        fn reparented(&mut self, _: Side, at: Cell, parent: Cell, g: f64) {
            self.0.push(("reparented", (at.x, at.y), (parent.x, parent.y), g));
        }
    }

    /// A plan, and the reports of its search.
    pub(in crate::plan) fn reported(
        planner: &impl GlobalPlanner,
        rows: &[&str],
        start: (i32, i32),
        goal: (i32, i32),
    ) -> (Plan, Told) {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap();
        let query = Query::new(Cell::new(start.0, start.1), Cell::new(goal.0, goal.1));
        let (mut workspace, mut plan, mut reported) =
            (Workspace::default(), Plan::default(), Told::default());
        planner.plan_into(&map, &query, &mut workspace, Some(&mut reported), &mut plan).unwrap();
        for (_, _, _, g) in &mut reported.0 {
            *g = rounded(*g);
        }
        (plan, reported)
    }

    pub(in crate::plan) fn waypoints(plan: &Plan) -> Vec<(i32, i32)> {
        plan.cells.iter().map(|cell| (cell.x, cell.y)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(path: &[(i32, i32)]) -> Vec<(i32, i32)> {
        let mut cells: Vec<Cell> = path.iter().map(|&(x, y)| Cell::new(x, y)).collect();
        keep_turns(&mut cells);
        cells.iter().map(|cell| (cell.x, cell.y)).collect()
    }

    #[test]
    fn only_turns_are_kept() {
        assert_eq!(kept(&[]), []);
        assert_eq!(kept(&[(3, 4)]), [(3, 4)]);
        assert_eq!(kept(&[(0, 0), (2, 1), (4, 2), (10, 5)]), [(0, 0), (10, 5)]);
        assert_eq!(kept(&[(0, 0), (2, 1), (4, 3), (6, 5)]), [(0, 0), (2, 1), (6, 5)]);
        // A reversal is a turn.
        assert_eq!(kept(&[(0, 0), (2, 0), (1, 0)]), [(0, 0), (2, 0), (1, 0)]);
    }

    #[test]
    fn lengths_by_hand() {
        let cells = [(0, 0), (3, 4), (3, 10), (8, 22)].map(|(x, y)| Cell::new(x, y));
        assert_eq!(length(&cells), PlanCost::Length(5.0 + 6.0 + 13.0));
        assert_eq!(format!("{:?}", length(&cells[..1])), "Length(0.0)");
    }
}
