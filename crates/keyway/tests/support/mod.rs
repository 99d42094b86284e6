//! The ground truth for small maps: plain arrays, searched by relaxing all edges until nothing
//! changes. It shares nothing with the planners but the types of the answer.
// Every test program uses its own part of this.
#![allow(dead_code)]

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::search::{CornerRule, Cost, Query};
use proptest::prelude::*;

/// A map as a plain array of cells, the bottom row first.
#[derive(Clone, Debug)]
pub(crate) struct Raw {
    pub(crate) width: i32,
    pub(crate) height: i32,
    pub(crate) states: Vec<CellState>,
}

/// The rules and costs of steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    pub(crate) corners: CornerRule,
    pub(crate) unknown: UnknownPolicy,
    pub(crate) penalty: u32,
    /// True if there are diagonal steps.
    pub(crate) diagonals: bool,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            corners: CornerRule::Forbid,
            unknown: UnknownPolicy::Blocked,
            penalty: 1,
            diagonals: true,
        }
    }
}

impl Rules {
    pub(crate) fn layers(&self) -> LayerConfig {
        LayerConfig {
            unknown: self.unknown,
            unknown_penalty: self.penalty,
            ..LayerConfig::default()
        }
    }
}

impl Raw {
    /// From a function of column and row.
    pub(crate) fn from_fn(width: i32, height: i32, is_free: impl Fn(i32, i32) -> bool) -> Self {
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let state = |(x, y)| if is_free(x, y) { CellState::Free } else { CellState::Occupied };
        Self { width, height, states: cells.map(state).collect() }
    }

    pub(crate) fn cells(&self) -> impl Iterator<Item = Cell> {
        let width = self.width;
        (0..self.height).flat_map(move |y| (0..width).map(move |x| Cell::new(x, y)))
    }

    pub(crate) fn index(&self, cell: Cell) -> usize {
        (cell.y * self.width + cell.x) as usize
    }

    pub(crate) fn state(&self, cell: Cell) -> Option<CellState> {
        let inside = cell.x >= 0 && cell.y >= 0 && cell.x < self.width && cell.y < self.height;
        inside.then(|| self.states[self.index(cell)])
    }

    pub(crate) fn is_free(&self, x: i32, y: i32, unknown: UnknownPolicy) -> bool {
        match self.state(Cell::new(x, y)) {
            None | Some(CellState::Occupied) => false,
            Some(CellState::Unknown) => unknown != UnknownPolicy::Blocked,
            Some(CellState::Free) => true,
        }
    }

    pub(crate) fn grid(&self) -> OccupancyGrid {
        let (width, height) = (self.width as u64, self.height as u64);
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        OccupancyGrid::from_fn(frame, |cell| self.state(cell).unwrap())
    }

    pub(crate) fn search_map(&self, rules: &Rules) -> SearchMap {
        SearchMap::new(&self.grid(), rules.layers()).unwrap()
    }

    /// The map as a drawing, top row first, for messages.
    pub(crate) fn drawing(&self) -> String {
        let row = |y: i32| -> String {
            let states = (0..self.width).map(|x| self.states[(y * self.width + x) as usize]);
            states
                .map(|state| match state {
                    CellState::Free => '.',
                    CellState::Occupied => '#',
                    CellState::Unknown => '?',
                })
                .collect()
        };
        (0..self.height).rev().map(row).collect::<Vec<_>>().join("\n")
    }

    /// The cost of one step, if it is allowed.
    pub(crate) fn step(&self, from: Cell, to: Cell, rules: &Rules) -> Option<Cost> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let free = |x, y| self.is_free(x, y, rules.unknown);
        let beside = free(from.x + dx, from.y) && free(from.x, from.y + dy);
        if (dx, dy) == (0, 0) || dx.abs() > 1 || dy.abs() > 1 || !free(to.x, to.y) {
            return None;
        }
        let is_diagonal = dx != 0 && dy != 0;
        let may_pass = rules.corners == CornerRule::Allow || beside;
        if is_diagonal && !(rules.diagonals && may_pass) {
            return None;
        }
        let penalised =
            rules.unknown == UnknownPolicy::Penalised && self.state(to) == Some(CellState::Unknown);
        let factor = if penalised { u64::from(rules.penalty) } else { 1 };
        Some(if is_diagonal { Cost::new(0, factor) } else { Cost::new(factor, 0) })
    }

    /// All steps from a cell, east first, counter-clockwise.
    pub(crate) fn steps(&self, from: Cell, rules: &Rules) -> Vec<(Cell, Cost)> {
        [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
            .into_iter()
            .map(|(dx, dy)| Cell::new(from.x + dx, from.y + dy))
            .filter_map(|to| self.step(from, to, rules).map(|cost| (to, cost)))
            .collect()
    }

    /// The cost of a path that leads from the start to the goal in allowed steps.
    pub(crate) fn walk(&self, path: &[Cell], query: &Query, rules: &Rules) -> Option<Cost> {
        let has_right_ends = path.first() == Some(&query.start) && path.last() == Some(&query.goal);
        let steps = path.windows(2).map(|pair| self.step(pair[0], pair[1], rules));
        let sum = |sum: Cost, step: Option<Cost>| Some(sum + step?);
        steps.into_iter().try_fold(Cost::default(), sum).filter(|_| has_right_ends)
    }

    /// The cost of the best path, by brute force.
    pub(crate) fn optimum(&self, query: &Query, rules: &Rules) -> Option<Cost> {
        let is_free = |cell: Cell| self.is_free(cell.x, cell.y, rules.unknown);
        if !is_free(query.start) || !is_free(query.goal) {
            return None;
        }
        let mut best: Vec<Option<Cost>> = vec![None; self.states.len()];
        best[self.index(query.start)] = Some(Cost::default());
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for from in self.cells() {
                let Some(cost) = best[self.index(from)] else { continue };
                for (to, step) in self.steps(from, rules) {
                    let through = cost + step;
                    let known = &mut best[self.index(to)];
                    if known.is_none_or(|known| through < known) {
                        *known = Some(through);
                        changed = true;
                    }
                }
            }
        }
        best[self.index(query.goal)]
    }
}

/// Small maps of all densities, with unknown cells.
pub(crate) fn any_raw() -> impl Strategy<Value = Raw> {
    (1i32..14, 1i32..11, 1u32..6).prop_flat_map(|(width, height, density)| {
        let state = prop_oneof![
            8 => Just(CellState::Free),
            density => Just(CellState::Occupied),
            1 => Just(CellState::Unknown)
        ];
        prop::collection::vec(state, (width * height) as usize).prop_map(move |states| Raw {
            width,
            height,
            states,
        })
    })
}

/// All rules with diagonal steps.
pub(crate) fn any_rules() -> impl Strategy<Value = Rules> {
    let corners = prop_oneof![Just(CornerRule::Forbid), Just(CornerRule::Allow)];
    let unknown = prop_oneof![
        Just(UnknownPolicy::Blocked),
        Just(UnknownPolicy::Free),
        Just(UnknownPolicy::Penalised)
    ];
    (corners, unknown, 1u32..5).prop_map(|(corners, unknown, penalty)| Rules {
        corners,
        unknown,
        penalty,
        diagonals: true,
    })
}

/// A query on a map of any size, from four numbers.
pub(crate) fn query_on(raw: &Raw, ends: (u32, u32, u32, u32)) -> Query {
    let (width, height) = (raw.width as u32, raw.height as u32);
    let cell = |x: u32, y: u32| Cell::new((x % width) as i32, (y % height) as i32);
    Query::new(cell(ends.0, ends.1), cell(ends.2, ends.3))
}
