//! The view from a point: visible corners of obstacles, and a target.

use crate::map::BitGrid;
use crate::search::CornerRule;
use crate::search::bit_scan::{ConvexCorners, convex_corners};

/// Subdivisions of a cell: the resolution of points.
pub(super) const UNITS_PER_CELL: i64 = 1 << 14;

/// A point of the plane, or a vector, in units of 2^-14 cells: every decision is exact. The cross
/// product of vectors within a map of 2^16 cells is less than 2^62.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spot {
    pub(super) x: i64,
    pub(super) y: i64,
}

impl Spot {
    pub(super) const fn new(x: i64, y: i64) -> Self {
        Self { x, y }
    }

    /// The lower left corner of a cell.
    pub(super) const fn lattice(x: i32, y: i32) -> Self {
        Self::new(x as i64 * UNITS_PER_CELL, y as i64 * UNITS_PER_CELL)
    }

    pub(super) const fn from(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }

    /// Positive if `other` points to the left of this vector.
    pub(super) const fn cross(self, other: Self) -> i64 {
        self.x * other.y - self.y * other.x
    }

    const fn flipped(self, flip: bool) -> Self {
        if flip { Self::new(self.x, -self.y) } else { self }
    }
}

/// Receives everything that is visible.
pub(super) trait Viewer {
    /// Reports a corner of an obstacle around which a shortest line may turn; (x, y) is the lower
    /// left corner of that cell. A corner may be reported twice.
    fn corner(&mut self, x: i32, y: i32);
    /// Reports the target.
    fn target(&mut self);
}

/// Scans in all directions from `eye`. Obstacles are the blocked cells' squares without their
/// border: a line of sight may run along an edge and touch a corner, but does not pass between two
/// squares that share a corner.
///
/// The plane is scanned row by row, upwards and then (mirrored) downwards. The visible part of a
/// row is a set of windows between two rays, each limited by the run of free cells that it passes.
/// Windows of zero width are skipped: anything behind a corner that they touch is visible from
/// that corner.
///
/// Cost: a few operations for each run of free cells in view, and for each 64 cells of a row in
/// view.
pub(super) fn look(
    blocked: &BitGrid,
    corners: CornerRule,
    eye: Spot,
    target: Spot,
    viewer: &mut impl Viewer,
) {
    for flip in [false, true] {
        let eye = eye.flipped(flip);
        let target = Some(target.flipped(flip)).filter(|target| target.y >= eye.y);
        UpwardView { blocked, corners, flip, eye, target, viewer }.look();
    }
}

/// A cone of view that reached a line of the lattice: between two directions, the left one first.
#[derive(Clone, Copy)]
struct Window {
    line: i32,
    left: Spot,
    right: Spot,
}

struct UpwardView<'a, V> {
    blocked: &'a BitGrid,
    corners: CornerRule,
    /// True if the plane is mirrored: up is down.
    flip: bool,
    eye: Spot,
    /// The target, if it is not below.
    target: Option<Spot>,
    viewer: &'a mut V,
}

impl<'a, V: Viewer> UpwardView<'a, V> {
    fn look(&mut self) {
        let mut windows = Vec::new();
        self.enter_first_row(&mut windows);
        while let Some(window) = windows.pop() {
            self.pass_row(window, &mut windows);
        }
    }

    /// Scans the row that contains the eye, or the row above it if it lies on a line.
    fn enter_first_row(&mut self, windows: &mut Vec<Window>) {
        let row = self.eye.y.div_euclid(UNITS_PER_CELL) as i32;
        let is_on_line = self.eye.y.rem_euclid(UNITS_PER_CELL) == 0;
        let first = (self.eye.x + UNITS_PER_CELL - 1).div_euclid(UNITS_PER_CELL) as i32 - 1;
        let last = self.eye.x.div_euclid(UNITS_PER_CELL) as i32;
        for_each_run(self.row(row), first, last, |from, to| {
            if is_on_line {
                self.report_corners(row, from, to);
            }
            let (left, right) = (Spot::new(-1, 0), Spot::new(1, 0));
            self.find_target(row, (from, to), (left, right));
            let left = rightmost(left, self.towards(from, row + 1));
            let right = leftmost(right, self.towards(to, row + 1));
            if right.cross(left) > 0 {
                windows.push(Window { line: row + 1, left, right });
            }
        });
    }

    /// Scans through a row; the rest of a window at its upper end is pushed.
    fn pass_row(&mut self, window: Window, windows: &mut Vec<Window>) {
        let Window { line, left, right } = window;
        let (low, high) = (self.crossing(left, line), self.crossing(right, line));
        // Each crossing: column, and true if it is on the lattice.
        self.report_corners(line, low.0 + i32::from(!low.1), high.0);
        let last = high.0 - i32::from(high.1);
        for_each_run(self.row(line), low.0, last, |from, to| {
            let enter = (
                rightmost(left, self.towards(from, line)),
                leftmost(right, self.towards(to, line)),
            );
            self.find_target(line, (from, to), enter);
            let left = rightmost(enter.0, self.towards(from, line + 1));
            let right = leftmost(enter.1, self.towards(to, line + 1));
            if right.cross(left) > 0 {
                windows.push(Window { line: line + 1, left, right });
            }
        });
    }

    /// The direction of a lattice point from the eye.
    fn towards(&self, x: i32, y: i32) -> Spot {
        Spot::lattice(x, y).from(self.eye)
    }

    /// The crossing of a ray and a line: the column, and true if it is at its left edge.
    fn crossing(&self, ray: Spot, line: i32) -> (i32, bool) {
        let rise = i128::from(i64::from(line) * UNITS_PER_CELL - self.eye.y);
        let (x, width) = (i128::from(ray.x), i128::from(ray.y));
        let at = i128::from(self.eye.x) * width + x * rise;
        let cell = width * i128::from(UNITS_PER_CELL);
        (at.div_euclid(cell) as i32, at.rem_euclid(cell) == 0)
    }

    /// Reports the target if it lies in a run of free cells and between two rays that enter it.
    fn find_target(&mut self, row: i32, (from, to): (i32, i32), (left, right): (Spot, Spot)) {
        let Some(target) = self.target else { return };
        let (low, high) = (Spot::lattice(from, row), Spot::lattice(to, row + 1));
        let is_inside =
            (low.x..=high.x).contains(&target.x) && (low.y..=high.y).contains(&target.y);
        let ray = target.from(self.eye);
        if is_inside && ray.cross(left) >= 0 && right.cross(ray) >= 0 && right.cross(left) >= 0 {
            self.viewer.target();
        }
    }

    /// Reports the corners of a line from `first` to `last`, both included.
    fn report_corners(&mut self, line: i32, first: i32, last: i32) {
        let (below, above) = (self.row(line - 1), self.row(line));
        let (first, last) = (first.max(0) as usize, last as usize);
        for word in first / 64..=last / 64 {
            let ConvexCorners { single, between } = convex_corners(below, above, word);
            let turns = match self.corners {
                CornerRule::Forbid => single,
                CornerRule::Allow => single | between,
            };
            let from = if word == first / 64 { u64::MAX << (first % 64) } else { u64::MAX };
            let to = if word == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
            let mut turns = turns & from & to;
            while turns != 0 {
                let x = (word * 64) as i32 + turns.trailing_zeros() as i32;
                turns &= turns - 1;
                self.viewer.corner(x, if self.flip { -line } else { line });
            }
        }
    }

    /// The bits of a row; those beyond the map are blocked.
    fn row(&self, row: i32) -> &'a [u64] {
        let row = if self.flip { -1 - row } else { row };
        self.blocked.row(row.clamp(-1, self.blocked.height() as i32))
    }
}

fn rightmost(a: Spot, b: Spot) -> Spot {
    // The position of the eye itself has no direction.
    if b == Spot::new(0, 0) || a.cross(b) >= 0 { a } else { b }
}

fn leftmost(a: Spot, b: Spot) -> Spot {
    if b == Spot::new(0, 0) || a.cross(b) <= 0 { a } else { b }
}

/// Calls `visit` with both ends of each run of free cells that overlaps the columns from `first`
/// to `last`.
fn for_each_run(row: &[u64], first: i32, last: i32, mut visit: impl FnMut(i32, i32)) {
    let is_blocked = |x: i32| row[(x + 1) as usize / 64] >> ((x + 1) as usize % 64) & 1 == 1;
    let mut x = first.max(-1);
    while x <= last {
        if is_blocked(x) {
            // The next free column.
            let mut word = (x + 1) as usize / 64;
            let mut free = !row[word] & u64::MAX << ((x + 1) as usize % 64);
            while free == 0 {
                word += 1;
                if word == row.len() {
                    return;
                }
                free = !row[word];
            }
            x = (word * 64 + free.trailing_zeros() as usize) as i32 - 1;
            continue;
        }
        let from = crate::search::bit_scan::previous_one(row, (x + 1) as usize) as i32;
        let to = crate::search::bit_scan::next_one(row, (x + 1) as usize) as i32 - 1;
        visit(from, to);
        x = to;
    }
}
