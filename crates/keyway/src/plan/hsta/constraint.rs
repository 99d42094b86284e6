//! The traversability test of equation (2).

use super::{Hsta, HstaConfig};
use crate::map::{BitGrid, Cell, SearchMap};
use crate::plan::best_first::check_budget;
use crate::plan::{PathEnd, PlanError};
use crate::search::{
    DistanceTo, Frontier, Greedy, Octile, Query, Rule, SearchStatistics, Successors,
};

/// Relative tolerance of comparisons with L: 2 m must be 40 cells of 0.05 m.
const TOLERANCE: f64 = 1e-9;

/// Eq. (2): no obstacle is nearer than L in the L1 norm, except in the discs around start and
/// goal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraint<'m> {
    obstacles: &'m BitGrid,
    /// The largest whole number of cells below L.
    reach: i32,
    /// The value of `reach` for the L of the config.
    asked_reach: i32,
    ends: [Cell; 2],
    /// The radius of the discs, squared \[cells^2\]; `None` without discs.
    free_sq: Option<f64>,
}

impl<'m> Constraint<'m> {
    pub(super) fn new(config: &HstaConfig, map: &'m SearchMap, query: &Query) -> Self {
        let limit = config.l1_constraint * config.cells_per_unit(map) * (1.0 - TOLERANCE);
        // No two cells are farther apart than this.
        let farthest = i64::from(map.frame().width()) + i64::from(map.frame().height());
        let farthest = i32::try_from(farthest).unwrap_or(i32::MAX);
        let radius = config.free_ends_m / map.frame().resolution_m() * (1.0 + TOLERANCE);
        let reach = ((limit.ceil() - 1.0).max(0.0) as i32).min(farthest);
        Self {
            obstacles: map.obstacles(),
            reach,
            asked_reach: reach,
            ends: [query.start, query.goal],
            free_sq: (config.free_ends_m > 0.0).then_some(radius * radius),
        }
    }

    pub(super) const fn is_relaxed(&self) -> bool {
        self.reach < self.asked_reach
    }

    /// The smallest L1 distance that a relaxed constraint allows \[m\].
    pub(super) fn least_m(&self, map: &SearchMap) -> f64 {
        f64::from(self.reach + 1) * map.frame().resolution_m()
    }

    pub(super) fn allows(&self, cell: Cell) -> bool {
        self.is_exempt(cell) || !is_near(self.obstacles, cell, self.reach)
    }

    fn is_exempt(&self, cell: Cell) -> bool {
        let distance_sq = |end: Cell| {
            let (dx, dy) = (f64::from(end.x.abs_diff(cell.x)), f64::from(end.y.abs_diff(cell.y)));
            dx * dx + dy * dy
        };
        self.free_sq.is_some_and(|free| self.ends.iter().any(|&end| distance_sq(end) <= free))
    }

    /// The L1 distance of a cell to the nearest obstacle \[cells\]; `None` if there is none, or in
    /// the discs.
    pub(super) fn distance(&self, cell: Cell) -> Option<i32> {
        if self.is_exempt(cell) { None } else { nearest(self.obstacles, cell) }
    }

    /// Returns an error if start or goal is too near to an obstacle.
    pub(super) fn check_ends(&self, map: &SearchMap, config: &HstaConfig) -> Result<(), PlanError> {
        for (end, cell) in [PathEnd::Start, PathEnd::Goal].into_iter().zip(self.ends) {
            if self.allows(cell) {
                continue;
            }
            let distance = nearest(self.obstacles, cell).map_or(f64::INFINITY, f64::from);
            return Err(PlanError::Constrained {
                planner: Hsta::NAME,
                end,
                cell,
                distance: distance / config.cells_per_unit(map),
                constraint: config.l1_constraint,
            });
        }
        Ok(())
    }

    /// This constraint, or the largest one in whole cells that leaves a path. Without any
    /// constraint a path exists.
    pub(super) fn relaxed(
        self,
        map: &SearchMap,
        query: &Query,
        steps: &impl Successors,
        frontier: &mut Frontier,
    ) -> Result<Self, PlanError> {
        let mut leaves_path = |reach| {
            let constraint = Self { reach, ..self };
            constraint.leaves_path(map, query, steps, frontier)
        };
        if leaves_path(self.reach)? {
            return Ok(self);
        }
        let (mut with_path, mut without) = (0, self.reach);
        while with_path + 1 < without {
            let middle = with_path.midpoint(without);
            if leaves_path(middle)? {
                with_path = middle;
            } else {
                without = middle;
            }
        }
        Ok(Self { reach: with_path, ..self })
    }

    /// True if some path keeps the constraint; decided by the fastest search for any path.
    fn leaves_path(
        &self,
        map: &SearchMap,
        query: &Query,
        steps: &impl Successors,
        frontier: &mut Frontier,
    ) -> Result<bool, PlanError> {
        if !self.ends.iter().all(|&end| self.allows(end)) {
            return Ok(false);
        }
        let rule = Greedy(DistanceTo::new(map, Octile, query.goal));
        let (start, goal) = (map.index(query.start), map.index(query.goal));
        frontier.start(map, start, rule.key(start, 0));
        loop {
            check_budget(query, SearchStatistics::one_sided(frontier.statistics()))?;
            let Some(node) = frontier.take_best() else { return Ok(false) };
            if node.at == goal {
                return Ok(true);
            }
            steps.for_each(node.at, |step| {
                if frontier.value(step.to).is_none() && self.allows(map.cell(step.to)) {
                    frontier.offer(node, step, &rule);
                }
            });
        }
    }
}

/// True if an obstacle lies within an L1 distance of a free cell \[cells\].
fn is_near(obstacles: &BitGrid, cell: Cell, reach: i32) -> bool {
    let last_row = obstacles.height() as i32 - 1;
    let rows = (cell.y - reach).max(0)..=cell.y.saturating_add(reach).min(last_row);
    // Within distance 0 there is only the cell itself, which is free.
    reach > 0 && rows.into_iter().any(|y| has_obstacle(obstacles, cell, y, reach))
}

fn has_obstacle(obstacles: &BitGrid, cell: Cell, y: i32, reach: i32) -> bool {
    let half = reach - (y - cell.y).abs();
    obstacles.any_in_span(y, cell.x - half, cell.x.saturating_add(half))
}

/// The L1 distance to the nearest obstacle \[cells\]; `None` when there is none.
fn nearest(obstacles: &BitGrid, cell: Cell) -> Option<i32> {
    let mut best: Option<i32> = None;
    for rows_off in 0..obstacles.height() as i32 {
        if best.is_some_and(|best| rows_off >= best) {
            break;
        }
        for y in [cell.y - rows_off, cell.y.saturating_add(rows_off)] {
            let left = obstacles.last_one_in_span(y, 0, cell.x).map(|x| cell.x - x);
            let right = obstacles.first_one_in_span(y, cell.x, i32::MAX).map(|x| x - cell.x);
            let columns_off = left.into_iter().chain(right).min();
            let distance = columns_off.map(|columns| columns.saturating_add(rows_off));
            best = best.into_iter().chain(distance).min();
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    /// Eq. (2) with L = 2 and 3 around one obstacle: its L1 distances are
    ///
    /// ```text
    /// 4 3 2 3
    /// 3 2 1 2
    /// 2 1 # 1
    /// ```
    #[test]
    fn equation_2_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["....", "....", "..#."]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let distances = [[2, 1, 0, 1], [3, 2, 1, 2], [4, 3, 2, 3]];
        let query = Query::new(Cell::new(0, 2), Cell::new(3, 2));
        for l1_constraint in [0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0] {
            let config = HstaConfig { l1_constraint, ..HstaConfig::PAPER };
            let constraint = Constraint::new(&config, &map, &query);
            for (y, row) in (0..).zip(distances) {
                for (x, distance) in (0..).zip(row) {
                    let cell = Cell::new(x, y);
                    if distance == 0 {
                        continue;
                    }
                    let expected = f64::from(distance) >= l1_constraint;
                    assert_eq!(constraint.allows(cell), expected, "L {l1_constraint} {cell}");
                    assert_eq!(constraint.distance(cell), Some(distance), "{cell}");
                }
            }
        }
    }
}
