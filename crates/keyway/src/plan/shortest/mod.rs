//! The exact shortest line, as a reference for any path.
//!
//! A shortest line among obstacles is taut: it goes straight from corner to corner of blocked
//! cells. So it is found by A* over the visibility graph of these corners, without restriction to
//! grid directions \[LozanoPerez1979\]. Only corners that the line can turn around are followed,
//! in the direction in which it bends around the obstacle.
//!
//! # Source
//! \[LozanoPerez1979\]. Visible corners are found row by row, as in \[Harabor2013\].
//!
//! # Free space
//! The line may run along the edges of blocked cells and touch their corners. It passes between
//! two blocked cells that share a corner only if corners may be cut ([`CornerRule::Allow`]).
//!
//! # Cost
//! That of a reference, not of a planner: a query expands all corners nearer than the goal, and
//! each expansion scans everything in view. 24 bytes for each lattice point of the map.

mod view;

use crate::geometry::{Point, Polyline};
use crate::map::{BitGrid, SearchMap};
use crate::search::CornerRule;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use view::{Spot, UNITS_PER_CELL, Viewer, look};

/// The largest number of columns or rows of a map.
const MAX_SIDE: u32 = 1 << 16;

/// The shortest line between two positions that avoids the blocked cells of a map.
///
/// Positions are rounded to 2^-14 cells. `None` if no such line exists, a position lies in a
/// blocked cell or outside the map, or the map has more than 65,536 columns or rows.
pub fn shortest_line(
    map: &SearchMap,
    corners: CornerRule,
    start: Point,
    goal: Point,
) -> Option<Polyline> {
    let frame = map.frame();
    let spot = |point: Point| {
        let grid = frame.grid_from_world(point);
        let unit = |cells: f64| (cells * UNITS_PER_CELL as f64).round() as i64;
        Spot::new(unit(grid.x), unit(grid.y))
    };
    let is_free = |point: Point| frame.cell_from_world(point).is_some_and(|cell| map.is_free(cell));
    if frame.width().max(frame.height()) > MAX_SIDE || !is_free(start) || !is_free(goal) {
        return None;
    }
    let turns = Search::new(map.blocked(), corners, spot(start), spot(goal)).run()?;
    let world = |turn: Spot| {
        let cells = |units: i64| units as f64 / UNITS_PER_CELL as f64;
        frame.world_from_grid(Point::new(cells(turn.x), cells(turn.y)))
    };
    let inner = turns.into_iter().map(world);
    Some(Polyline::new(std::iter::once(start).chain(inner).chain([goal]).collect()))
}

/// A lattice point that was reached.
#[derive(Clone, Copy)]
struct Node {
    g: f64,
    /// Index of the parent.
    parent: u32,
    is_closed: bool,
}

struct Search<'m> {
    blocked: &'m BitGrid,
    corners: CornerRule,
    start: Spot,
    goal: Spot,
    /// Lattice points row by row, then the start.
    nodes: Vec<Node>,
    /// Ordered by f, then larger g (its bits grow with it), then the lower index.
    open: BinaryHeap<Reverse<(u64, Reverse<u64>, u32)>>,
    /// The length of the best path to the goal so far, and the node before the goal.
    best: (f64, Option<u32>),
}

impl<'m> Search<'m> {
    fn new(blocked: &'m BitGrid, corners: CornerRule, start: Spot, goal: Spot) -> Self {
        let points = (blocked.width() as usize + 1) * (blocked.height() as usize + 1);
        let unreached = Node { g: f64::INFINITY, parent: u32::MAX, is_closed: false };
        let nodes = vec![unreached; points + 1];
        let (open, best) = (BinaryHeap::new(), (f64::INFINITY, None));
        Self { blocked, corners, start, goal, nodes, open, best }
    }

    /// Returns the turns of the line; `None` if no line exists.
    fn run(mut self) -> Option<Vec<Spot>> {
        let root = self.nodes.len() as u32 - 1;
        self.nodes[root as usize].g = 0.0;
        self.open.push(Reverse((0, Reverse(0), root)));
        while let Some(Reverse((f, _, at))) = self.open.pop() {
            if f64::from_bits(f) >= self.best.0 {
                break;
            }
            if !std::mem::replace(&mut self.nodes[at as usize].is_closed, true) {
                self.expand(at);
            }
        }
        let mut turns = Vec::new();
        let mut at = self.best.1?;
        while at != root {
            turns.push(self.spot(at));
            at = self.nodes[at as usize].parent;
        }
        turns.reverse();
        Some(turns)
    }

    fn expand(&mut self, at: u32) {
        let from = self.spot(at);
        let mut seen = Seen { corners: Vec::new(), target: false };
        look(self.blocked, self.corners, from, self.goal, &mut seen);
        let g = self.nodes[at as usize].g;
        if seen.target && self.may_turn(at, self.goal) {
            let length = g + length(self.goal.from(from));
            if length < self.best.0 {
                self.best = (length, Some(at));
            }
        }
        for (x, y) in seen.corners {
            let to = Spot::lattice(x, y);
            let ahead = to.from(from);
            if ahead == Spot::new(0, 0) || self.is_head_on(to, ahead) || !self.may_turn(at, to) {
                continue;
            }
            let number = y as u32 * (self.blocked.width() + 1) + x as u32;
            let through = g + length(ahead);
            let node = &mut self.nodes[number as usize];
            if !node.is_closed && through < node.g {
                *node = Node { g: through, parent: at, is_closed: false };
                let f = through + length(self.goal.from(to));
                self.open.push(Reverse((f.to_bits(), Reverse(through.to_bits()), number)));
            }
        }
    }

    /// True if a taut line through a node may continue to `to`: it bends towards the obstacle, or
    /// not at all.
    fn may_turn(&self, at: u32, to: Spot) -> bool {
        let parent = self.nodes[at as usize].parent;
        let Some(inner) = self.obstacle_at(self.spot(at)) else { return true };
        if parent == u32::MAX {
            return true;
        }
        let here = self.spot(at);
        let came = here.from(self.spot(parent));
        let (bend, side) = (came.cross(to.from(here)), came.cross(inner));
        bend == 0 || bend.signum() * side.signum() >= 0
    }

    /// True if a line in this direction runs into the obstacle of a corner, so that it cannot bend
    /// around it.
    fn is_head_on(&self, corner: Spot, ahead: Spot) -> bool {
        self.obstacle_at(corner)
            .is_some_and(|inner| (ahead.x.signum(), ahead.y.signum()) == (inner.x, inner.y))
    }

    /// The direction of the only blocked cell at a lattice point; `None` elsewhere.
    fn obstacle_at(&self, spot: Spot) -> Option<Spot> {
        let is_on_lattice =
            spot.x.rem_euclid(UNITS_PER_CELL) == 0 && spot.y.rem_euclid(UNITS_PER_CELL) == 0;
        if !is_on_lattice {
            return None;
        }
        let (x, y) = ((spot.x / UNITS_PER_CELL) as i32, (spot.y / UNITS_PER_CELL) as i32);
        let mut around = [(-1, -1), (0, -1), (-1, 0), (0, 0)]
            .into_iter()
            .filter(|(dx, dy)| self.blocked.get(crate::map::Cell::new(x + dx, y + dy)));
        let (dx, dy) = around.next()?;
        let is_only = around.next().is_none();
        is_only.then(|| Spot::new(2 * i64::from(dx) + 1, 2 * i64::from(dy) + 1))
    }

    fn spot(&self, number: u32) -> Spot {
        let columns = self.blocked.width() + 1;
        if number as usize + 1 == self.nodes.len() {
            return self.start;
        }
        Spot::lattice((number % columns) as i32, (number / columns) as i32)
    }
}

/// The length of a vector \[cells\].
fn length(vector: Spot) -> f64 {
    let (x, y) = (vector.x as f64, vector.y as f64);
    (x * x + y * y).sqrt() / UNITS_PER_CELL as f64
}

struct Seen {
    corners: Vec<(i32, i32)>,
    target: bool,
}

impl Viewer for Seen {
    fn corner(&mut self, x: i32, y: i32) {
        self.corners.push((x, y));
    }

    fn target(&mut self) {
        self.target = true;
    }
}

#[cfg(test)]
mod tests;
