//! Headings at which a footprint fits at the points of a lattice, computed on demand.

use super::free_headings::{BlockedHeadings, Headings, Places};
use super::lattice::Lattice;
use super::near::Near;
use crate::geometry::Point;
use crate::map::DistanceField;
use arrayvec::ArrayVec;
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

/// A set of headings, one bit each; a bit stands for the headings up to the next ones.
pub(super) type Sectors = u32;

/// The ground, and the clearance that a robot needs there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground<'a> {
    pub(super) obstacles: &'a DistanceField,
    pub(super) blocked: &'a BlockedHeadings,
    /// Below the first clearance no heading is free, from the second on all are \[m\].
    pub(super) inscribed_m: f64,
    pub(super) turning_m: f64,
}

/// The headings that fit at the points near a path, by the numbers of the points.
#[derive(Debug, Default)]
pub(super) struct Fitting {
    is_known: Vec<bool>,
    /// Headings at which the footprint fits, and those from which it can turn to the next one.
    free: Vec<Sectors>,
    turning: Vec<Sectors>,
    /// Columns and rows at which the footprint is tried for a tile of points, in half cells.
    xs: Vec<i32>,
    ys: Vec<i32>,
    places: Places,
}

impl Fitting {
    /// Forgets all results.
    pub(super) fn begin(&mut self, near: &Near) {
        self.is_known.clear();
        self.is_known.resize(near.count(), false);
        self.free.clear();
        self.free.resize(near.count(), 0);
        self.turning.clear();
        self.turning.resize(near.count(), 0);
    }

    /// Results for all points, without a footprint.
    #[cfg(test)]
    pub(super) fn of(free: Vec<Sectors>, turning: Vec<Sectors>) -> Self {
        Self { is_known: vec![true; free.len()], free, turning, ..Self::default() }
    }

    /// The headings at which the footprint fits somewhere in the square around a point. The point
    /// must have been [evaluated](Self::look).
    pub(super) fn free(&self, number: usize) -> Sectors {
        self.free[number]
    }

    /// The free headings from which the robot can turn to the next one there.
    pub(super) fn turning(&self, number: usize) -> Sectors {
        self.turning[number]
    }

    /// Evaluates a point, unless that was done, and those beside it, which share most of the
    /// work.
    #[inline]
    pub(super) fn look(
        &mut self,
        number: usize,
        near: &Near,
        room_m: impl Fn(Point) -> f64,
        ground: &Ground<'_>,
    ) {
        if !self.is_known[number] {
            let place = near.places()[number] as usize;
            self.look_at_tile(near.point(place), near, room_m, ground);
        }
    }

    fn look_at_tile(
        &mut self,
        (x, y): (usize, usize),
        near: &Near,
        room_m: impl Fn(Point) -> f64,
        ground: &Ground<'_>,
    ) {
        let lattice = &near.lattice;
        let tries = Tries::new(lattice, ground.obstacles);
        let tile = |along: usize| {
            let first = along - along % tries.tile;
            first..(first + tries.tile).min(lattice.side)
        };
        let (columns, rows) = (tile(x), tile(y));
        let half_m = FRAC_1_SQRT_2 * lattice.spacing_m;
        let mut is_tried = false;
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let Some(number) = near.number(near.place((x, y))) else { continue };
            self.is_known[number] = true;
            let at_m = room_m(lattice.position(x, y));
            let is_free = at_m + half_m >= ground.inscribed_m;
            if at_m >= ground.turning_m || is_free && !ground.blocked.is_useful() {
                (self.free[number], self.turning[number]) = (Sectors::MAX, Sectors::MAX);
            } else if is_free {
                if !is_tried {
                    tries.collect(lattice, (tile(x), tile(y)), (&mut self.xs, &mut self.ys));
                    self.places.fill((&self.xs, &self.ys), ground.blocked, ground.obstacles);
                    is_tried = true;
                }
                let free = tries.free_at(lattice.position(x, y), &self.places);
                let beside = free.rotate_left(1) | free.rotate_right(1);
                self.free[number] = every_other(free | beside);
                self.turning[number] = every_other(free.rotate_right(1));
            }
        }
    }
}

/// The positions in the squares around points at which a footprint is tried.
struct Tries {
    halves_per_m: f64,
    /// Half cells from one point to the next, and number of intervals along them.
    side: i32,
    parts: i32,
    /// Number of points in a row of a tile.
    tile: usize,
}

impl Tries {
    fn new(lattice: &Lattice, obstacles: &DistanceField) -> Self {
        let halves_per_m = 2.0 / obstacles.frame().resolution_m();
        let side = (lattice.spacing_m * halves_per_m).round() as i32;
        let parts = side.clamp(1, 4);
        let tile = ((2 * Places::COLUMNS - 1) / side.max(1) as usize).max(1);
        Self { halves_per_m, side, parts, tile }
    }

    /// Positions around the middle of a square, along an axis: symmetric to it.
    fn along(&self, middle_m: f64) -> impl Iterator<Item = i32> + use<> {
        let Self { side, parts, .. } = *self;
        let middle = middle_m * self.halves_per_m;
        (0..=parts).map(move |part| {
            let off = 0.5 * f64::from(side * (2 * part - parts)) / f64::from(parts);
            (middle + off.round()).round() as i32
        })
    }

    /// Collects the positions of a tile.
    fn collect(
        &self,
        lattice: &Lattice,
        (columns, rows): (Range<usize>, Range<usize>),
        (xs, ys): (&mut Vec<i32>, &mut Vec<i32>),
    ) {
        xs.clear();
        xs.extend(columns.flat_map(|x| self.along(lattice.position(x, 0).x)));
        ys.clear();
        ys.extend(rows.flat_map(|y| self.along(lattice.position(0, y).y)));
        for along in [xs, ys] {
            along.sort_unstable();
            along.dedup();
        }
    }

    /// The headings that are free somewhere around a point.
    fn free_at(&self, middle: Point, places: &Places) -> Headings {
        let columns: ArrayVec<usize, 5> =
            self.along(middle.x).filter_map(|x| places.column(x)).collect();
        let rows = self.along(middle.y).filter_map(|y| places.row(y));
        let free_in =
            |row: usize| columns.iter().fold(0, |free, &column| free | places.free(column, row));
        rows.fold(0, |free, row| free | free_in(row))
    }
}

/// The bits with even numbers.
fn every_other(bits: u64) -> u32 {
    let mut even = bits & 0x5555_5555_5555_5555;
    even = (even | even >> 1) & 0x3333_3333_3333_3333;
    even = (even | even >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    even = (even | even >> 4) & 0x00ff_00ff_00ff_00ff;
    even = (even | even >> 8) & 0x0000_ffff_0000_ffff;
    (even | even >> 16) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_other_bit() {
        assert_eq!(every_other(u64::MAX), u32::MAX);
        assert_eq!(every_other(0x5555_5555_5555_5555), u32::MAX);
        assert_eq!(every_other(0xaaaa_aaaa_aaaa_aaaa), 0);
        for bit in 0..32 {
            assert_eq!(every_other(1 << (2 * bit)), 1 << bit);
        }
    }
}
