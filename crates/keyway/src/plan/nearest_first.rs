//! Plans to several goals, in the order of their path cost.
//!
//! A path is never cheaper than the octile distance between start and goal. So goals wait in a
//! queue by that bound, and once planned, by the cost of their path. A goal whose path cost comes
//! first in the queue is the next nearest one, and no paths to the goals behind it need to be
//! planned.
//!
//! # Cost
//! One search for each goal whose bound is smaller than the cost of the last goal requested, and
//! no other. Memory: the paths that were found and not yet requested.

use super::{GlobalPlanner, Plan, PlanCost, PlanError};
use crate::map::{Cell, SearchMap};
use crate::search::{Cost, IfUnreachable, Query, Workspace};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// A goal and the path to it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GoalPlan {
    /// Index of the goal in the given list.
    pub index: usize,
    /// The goal.
    pub goal: Cell,
    /// The path, or the reason why there is none.
    pub result: Result<Plan, PlanError>,
}

/// Plans from one start to several goals, nearest first by path cost (ties: the order of the
/// list). Each call of `next` plans only as far as necessary; goals without a path come last, in
/// the order of the list.
///
/// The order is by the cost of the planner's own paths, which are shortest ones only if the
/// planner is optimal.
///
/// ```
/// use keyway::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
/// use keyway::plan::{AStar, NearestFirst};
/// use keyway::search::{Query, Workspace};
///
/// let grid = OccupancyGrid::from_ascii(&["....", ".##.", "...."]);
/// let map = SearchMap::new(&grid, LayerConfig::default())?;
/// let goals = [Cell::new(3, 2), Cell::new(0, 2), Cell::new(1, 1)];
/// let mut workspace = Workspace::default();
/// let query = Query::new(Cell::new(0, 0), Cell::new(0, 0));
/// let planner = AStar::default();
/// let order: Vec<(usize, bool)> = NearestFirst::new(&planner, &map, &query, &goals, &mut workspace)
///     .map(|goal| (goal.index, goal.result.is_ok()))
///     .collect();
/// assert_eq!(order, [(1, true), (0, true), (2, false)]);
/// # Ok::<(), keyway::ConfigError>(())
/// ```
pub struct NearestFirst<'a> {
    planner: &'a dyn GlobalPlanner,
    map: &'a SearchMap,
    query: Query,
    goals: &'a [Cell],
    workspace: &'a mut Workspace,
    /// A lower bound of the path cost, or the cost itself, and the goal's index.
    queue: BinaryHeap<Reverse<(PlanCost, usize)>>,
    /// Paths of goals that are in the queue with their costs.
    found: Vec<Option<Plan>>,
    failed: VecDeque<(usize, PlanError)>,
}

impl<'a> NearestFirst<'a> {
    /// `query` gives the start and the budget of each search; its goal is ignored, and unreachable
    /// goals are never replaced by others.
    pub fn new(
        planner: &'a dyn GlobalPlanner,
        map: &'a SearchMap,
        query: &Query,
        goals: &'a [Cell],
        workspace: &'a mut Workspace,
    ) -> Self {
        let start = query.start;
        // A lower bound of the cost of any path to the goal.
        let bound = |goal: &Cell| {
            let (dx, dy) = (start.x.abs_diff(goal.x), start.y.abs_diff(goal.y));
            if planner.is_any_angle() {
                PlanCost::Length(libm::hypot(f64::from(dx), f64::from(dy)))
            } else {
                PlanCost::Steps(Cost::octile(dx, dy))
            }
        };
        let queue = goals.iter().enumerate().map(|(i, goal)| Reverse((bound(goal), i))).collect();
        Self {
            planner,
            map,
            query: Query { if_unreachable: IfUnreachable::Fail, ..*query },
            goals,
            workspace,
            queue,
            found: vec![None; goals.len()],
            failed: VecDeque::new(),
        }
    }

    /// Plans to a goal and returns it to the queue with the cost of its path.
    fn plan_to(&mut self, index: usize) {
        let query = Query { goal: self.goals[index], ..self.query };
        let mut plan = Plan::default();
        match self.planner.plan_into(self.map, &query, self.workspace, None, &mut plan) {
            Ok(()) => {
                self.queue.push(Reverse((plan.cost, index)));
                self.found[index] = Some(plan);
            }
            Err(error) => {
                // Sorted by the order of the list.
                let place = self.failed.partition_point(|(other, _)| *other < index);
                self.failed.insert(place, (index, error));
            }
        }
    }
}

impl Iterator for NearestFirst<'_> {
    type Item = GoalPlan;

    fn next(&mut self) -> Option<GoalPlan> {
        while let Some(Reverse((_, index))) = self.queue.pop() {
            if let Some(plan) = self.found[index].take() {
                return Some(GoalPlan { index, goal: self.goals[index], result: Ok(plan) });
            }
            self.plan_to(index);
        }
        let (index, error) = self.failed.pop_front()?;
        Some(GoalPlan { index, goal: self.goals[index], result: Err(error) })
    }
}
