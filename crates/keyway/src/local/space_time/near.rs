//! The points of a lattice that are near a path.

use super::lattice::Lattice;
use crate::geometry::Point;
use arrayvec::ArrayVec;

/// Points near a path, numbered. Each has a place in a grid with a border, so that a step from it
/// is always on the grid.
#[derive(Debug, Default)]
pub(super) struct Near {
    pub(super) lattice: Lattice,
    /// Number of the point at each place; `NONE` if there is none.
    numbers: Vec<u32>,
    /// Place of each point.
    places: Vec<u32>,
    /// Width of the border: the longest step along an axis.
    border: usize,
}

const NONE: u32 = u32::MAX;

impl Near {
    /// Collects the points that are no farther than this from a path, for steps of at most
    /// `longest_step` points along an axis.
    pub(super) fn collect(
        &mut self,
        lattice: Lattice,
        way: &[Point],
        within_m: f64,
        longest_step: usize,
    ) {
        self.lattice = lattice;
        self.border = longest_step;
        self.numbers.clear();
        self.numbers.resize(self.stride() * self.stride(), NONE);
        self.places.clear();
        let reach = within_m / lattice.spacing_m;
        let mut last: Option<Point> = None;
        for &at in way {
            if last.is_some_and(|last| last.distance(at) < 0.25 * within_m) {
                continue;
            }
            last = Some(at);
            let middle = lattice.place(at);
            let [columns, rows] = lattice.within(middle, reach);
            for y in rows {
                for x in columns.clone() {
                    let place = self.place((x, y));
                    let is_near = Point::new(x as f64, y as f64).distance(middle) <= reach;
                    if is_near && self.numbers[place] == NONE {
                        self.numbers[place] = self.places.len() as u32;
                        self.places.push(place as u32);
                    }
                }
            }
        }
    }

    /// Number of points.
    pub(super) const fn count(&self) -> usize {
        self.places.len()
    }

    /// Places of all points, in the order of their numbers.
    pub(super) fn places(&self) -> &[u32] {
        &self.places
    }

    /// Number of places.
    pub(super) const fn place_count(&self) -> usize {
        self.numbers.len()
    }

    const fn stride(&self) -> usize {
        self.lattice.side + 2 * self.border
    }

    /// The place of a point of the lattice.
    pub(super) const fn place(&self, (x, y): (usize, usize)) -> usize {
        (y + self.border) * self.stride() + x + self.border
    }

    /// Column and row of the point at a place.
    pub(super) const fn point(&self, place: usize) -> (usize, usize) {
        (place % self.stride() - self.border, place / self.stride() - self.border)
    }

    /// Number of the point at a place, if one is near the path.
    #[inline]
    pub(super) fn number(&self, place: usize) -> Option<usize> {
        Some(self.numbers[place]).filter(|&number| number != NONE).map(|number| number as usize)
    }

    /// Offset from a place to the one this many columns and rows away.
    pub(super) const fn step(&self, (columns, rows): (i32, i32)) -> isize {
        rows as isize * self.stride() as isize + columns as isize
    }

    /// Numbers of the points around a position, in or beside whose squares it lies.
    pub(super) fn around(&self, at: Point) -> impl Iterator<Item = usize> + use<> {
        let [columns, rows] = self.lattice.within(self.lattice.place(at), 1.0);
        let places = rows.flat_map(|y| columns.clone().map(move |x| self.place((x, y))));
        let numbers: ArrayVec<usize, 9> =
            places.take(9).filter_map(|place| self.number(place)).collect();
        numbers.into_iter()
    }
}
