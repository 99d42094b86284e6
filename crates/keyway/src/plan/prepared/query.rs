//! A query on a prepared map.
//!
//! Start and goal each scan for the cells at which a path may turn first, or last, initially in
//! the direction of each other. One pair of these turns gives a path, and its length bounds
//! everything that follows. The labels of the turns through which a shorter path may lead are
//! joined: those of the start are entered into a table by hub, those of the goal are looked up
//! there.
//!
//! This finds a shortest path. Let a be the first turn of a shortest path that runs diagonally
//! first wherever it can. Now take, from the goal, a path of the same length to a, made in the
//! same way. Its first turn is one that the goal has found, and the distance of both turns is in
//! the labels; or it has no turn, and the goal sees a.

use super::hubs::{Access, HubMemory};
use super::labels::Entry;
use super::sight::{Sight, Turn, quarter_towards};
use super::{PlanError, Prepared};
use crate::map::{Cell, SearchMap};
use crate::plan::leg;
use crate::search::{Cost, Observer, Query, SearchStatistics, Side};

/// The shape of a path.
#[derive(Clone, Copy, Debug)]
pub(super) enum Route {
    /// Diagonal, then straight.
    Direct,
    /// Over one cell that both start and goal see.
    Turn(Cell),
    /// Over a node in the start's sight, a hub, and a node in the goal's sight.
    Hub { from: u32, hub: u32, to: u32 },
}

/// The state of one query.
pub(super) struct Search<'a, O> {
    pub(super) prepared: &'a Prepared,
    map: &'a SearchMap,
    pub(super) sight: Sight<'a>,
    pub(super) query: &'a Query,
    pub(super) memory: &'a mut HubMemory,
    pub(super) seen: O,
    pub(super) statistics: SearchStatistics,
    /// The shortest known path: its key, `u64::MAX` without a path, and its route.
    best: (u64, Route),
}

/// The number of turns that is enough for a first path.
const FIRST_LOOK: usize = 4;

/// Start and goal, in the order of [`HubMemory::access`].
const SIDES: [Side; 2] = [Side::Forward, Side::Backward];

impl<'a, O: Observer> Search<'a, O> {
    pub(super) fn new(
        prepared: &'a Prepared,
        map: &'a SearchMap,
        query: &'a Query,
        memory: &'a mut HubMemory,
        seen: O,
    ) -> Self {
        let statistics = SearchStatistics::default();
        let (sight, best) = (Sight::new(map, &prepared.diagonals), (u64::MAX, Route::Direct));
        Self { prepared, map, sight, query, memory, seen, statistics, best }
    }

    /// Returns the shortest route.
    pub(super) fn run(&mut self) -> Result<Route, PlanError> {
        let Query { start, goal, .. } = *self.query;
        if leg::is_free(self.map, start, goal) {
            return Ok(Route::Direct);
        }
        self.memory.start(self.prepared.cells.len());
        self.look_around();
        self.try_common_turns();
        self.enter_start_labels()?;
        self.meet_goal_labels()?;
        match self.best {
            (u64::MAX, _) => Err(PlanError::NoPath { statistics: self.statistics }),
            (_, route) => Ok(route),
        }
    }

    /// Finds the turns in sight of start and goal.
    fn look_around(&mut self) {
        let Query { start, goal, .. } = *self.query;
        let ends = [(start, goal), (goal, start)];
        for most in [FIRST_LOOK, usize::MAX] {
            for (i, &(from, to)) in ends.iter().enumerate() {
                self.memory.access[i].clear();
                if self.prepared.corners.contains(from) {
                    let estimate = octile_key(from, to);
                    self.memory.access[i].push(Access { estimate, key: 0, at: from });
                    continue;
                }
                for turn in 0..4 {
                    self.look(i, (quarter_towards(from, to) + turn) % 4, (from, to), most);
                }
            }
            self.try_best_pair();
        }
    }

    /// Finds the turns straight ahead in direction `quarter`, and on both sides of the diagonal
    /// that follows it counter-clockwise.
    fn look(&mut self, i: usize, quarter: usize, (from, to): (Cell, Cell), most: usize) {
        let sight = self.sight;
        sight.along(from, quarter, 0, |turn| self.enter(i, turn, to));
        sight.diagonal(from, quarter, |at, steps| {
            // A path over any turn seen from here costs at least as much as the one over this
            // cell.
            let least = steps * Cost::KEY_DIAGONAL + octile_key(at, to);
            if least >= self.best.0 || self.memory.access[i].len() >= most {
                return false;
            }
            for direction in [quarter, (quarter + 1) % 4] {
                sight.along(at, direction, steps, |turn| self.enter(i, turn, to));
            }
            true
        });
    }

    /// Records a turn, unless no shorter path can lead through it. False if no shorter path can
    /// lead over the cell at all, or over those behind it.
    fn enter(&mut self, i: usize, turn: Turn, to: Cell) -> bool {
        let Turn { at, cost, ahead, opens } = turn;
        let key = cost.key();
        if key + octile_key(at, to) >= self.best.0 {
            return false;
        }
        let estimate = key + least_after_turn(at, ahead, opens, to);
        if estimate < self.best.0 {
            self.memory.access[i].push(Access { estimate, key, at });
            self.statistics.side_mut(SIDES[i]).generated += 1;
            if self.seen.is_watching() {
                let root = [self.query.start, self.query.goal][i];
                self.seen.generated(SIDES[i], at, root, cost.cells());
                self.seen.linked(SIDES[i], at, root);
            }
        }
        true
    }

    /// Tries the path over the most promising turns of start and goal.
    fn try_best_pair(&mut self) {
        let best = |list: &[Access]| list.iter().min_by_key(|access| access.estimate).copied();
        let [Some(a), Some(b)] = self.memory.access.each_ref().map(|list| best(list)) else {
            return;
        };
        let (from, to) = (self.prepared.node(a.at), self.prepared.node(b.at));
        if let Some((between, hub)) = self.prepared.labels.distance(from, to) {
            let key = a.key + between + b.key;
            if key < self.best.0 {
                self.best = (key, Route::Hub { from, hub, to });
            }
        }
    }

    /// Tries the paths with a single turn.
    fn try_common_turns(&mut self) {
        let goal = self.query.goal;
        for access in &self.memory.access[0] {
            let key = access.key + octile_key(access.at, goal);
            if key < self.best.0 && leg::is_free(self.map, goal, access.at) {
                self.best = (key, Route::Turn(access.at));
            }
        }
    }

    fn enter_start_labels(&mut self) -> Result<(), PlanError> {
        for i in 0..self.memory.access[0].len() {
            let access = self.memory.access[0][i];
            if access.estimate < self.best.0 {
                let node = self.prepared.node(access.at);
                for &entry in self.label(0, access, node)? {
                    self.memory.offer(entry.hub(), access.key + entry.key(), node);
                }
            }
        }
        Ok(())
    }

    fn meet_goal_labels(&mut self) -> Result<(), PlanError> {
        for i in 0..self.memory.access[1].len() {
            let access = self.memory.access[1][i];
            if access.estimate < self.best.0 {
                let to = self.prepared.node(access.at);
                for &entry in self.label(1, access, to)? {
                    let Some((key, from)) = self.memory.known(entry.hub()) else { continue };
                    let key = key + entry.key() + access.key;
                    if key < self.best.0 {
                        self.best = (key, Route::Hub { from, hub: entry.hub(), to });
                    }
                }
            }
        }
        Ok(())
    }

    /// Reads the label of an access node; a budget counts these reads.
    fn label(&mut self, i: usize, access: Access, node: u32) -> Result<&'a [Entry], PlanError> {
        let statistics = self.statistics;
        if let Some(budget) = self.query.budget.filter(|&budget| statistics.expanded() >= budget) {
            return Err(PlanError::BudgetExhausted { budget, statistics });
        }
        self.statistics.side_mut(SIDES[i]).expanded += 1;
        if self.seen.is_watching() {
            self.seen.expanded(SIDES[i], access.at, access.key as f64 / Cost::KEY_STRAIGHT as f64);
        }
        Ok(self.prepared.labels.of(node))
    }
}

/// The smallest length of a path that turns at a cell to one of the sides that open, as a key: its
/// next step is diagonally ahead to that side, or straight to that side.
fn least_after_turn(at: Cell, ahead: (i32, i32), opens: [bool; 2], to: Cell) -> u64 {
    let left = (-ahead.1, ahead.0);
    let least = |(x, y): (i32, i32)| {
        let straight = Cell::new(at.x + x, at.y + y);
        let diagonal = Cell::new(straight.x + ahead.0, straight.y + ahead.1);
        let over_straight = Cost::KEY_STRAIGHT + octile_key(straight, to);
        over_straight.min(Cost::KEY_DIAGONAL + octile_key(diagonal, to))
    };
    let sides = [left, (-left.0, -left.1)].into_iter().zip(opens);
    sides.filter(|(_, opens)| *opens).map(|(side, _)| least(side)).min().unwrap_or(u64::MAX)
}

fn octile_key(a: Cell, b: Cell) -> u64 {
    Cost::octile(a.x.abs_diff(b.x), a.y.abs_diff(b.y)).key()
}
