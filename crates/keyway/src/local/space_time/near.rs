//! The points of a lattice that are near a way.

use super::lattice::Lattice;
use crate::geometry::Point;
use arrayvec::ArrayVec;

/// Points near a way, numbered.
#[derive(Debug, Default)]
pub(super) struct Near {
    pub(super) lattice: Lattice,
    /// The number of each point of the lattice; `NONE` for those that are not near.
    numbers: Vec<u32>,
    /// Column and row of each.
    points: Vec<(u16, u16)>,
}

const NONE: u32 = u32::MAX;

impl Near {
    /// Collects the points that are no farther than this from a way.
    pub(super) fn collect(&mut self, lattice: Lattice, way: &[Point], within_m: f64) {
        self.lattice = lattice;
        self.numbers.clear();
        self.numbers.resize(lattice.count(), NONE);
        self.points.clear();
        let reach = within_m / lattice.spacing_m;
        let mut last: Option<Point> = None;
        for &at in way {
            if last.is_some_and(|last| last.distance(at) < 0.25 * within_m) {
                continue;
            }
            last = Some(at);
            let place = lattice.place(at);
            let [columns, rows] = lattice.within(place, reach);
            for y in rows {
                for x in columns.clone() {
                    let number = &mut self.numbers[y * lattice.side + x];
                    let is_near = Point::new(x as f64, y as f64).distance(place) <= reach;
                    if is_near && *number == NONE {
                        *number = self.points.len() as u32;
                        self.points.push((x as u16, y as u16));
                    }
                }
            }
        }
    }

    /// How many there are.
    pub(super) const fn count(&self) -> usize {
        self.points.len()
    }

    /// The number of a point of the lattice by its index, if it is near.
    pub(super) fn number_of(&self, index: usize) -> Option<usize> {
        self.numbers.get(index).filter(|&&number| number != NONE).map(|&number| number as usize)
    }

    /// Column and row of one.
    pub(super) fn point(&self, number: usize) -> (usize, usize) {
        let (x, y) = self.points[number];
        (usize::from(x), usize::from(y))
    }

    /// The one that is a step away from a point, if that is near.
    #[inline]
    pub(super) fn beside(&self, (x, y): (usize, usize), (dx, dy): (i32, i32)) -> Option<usize> {
        let side = self.lattice.side;
        let (x, y) = (x.wrapping_add_signed(dx as isize), y.wrapping_add_signed(dy as isize));
        if x >= side || y >= side {
            return None;
        }
        let number = self.numbers[y * side + x];
        (number != NONE).then_some(number as usize)
    }

    /// Those around a place, whose squares it lies in or beside.
    pub(super) fn around(&self, at: Point) -> impl Iterator<Item = usize> + use<> {
        let [columns, rows] = self.lattice.within(self.lattice.place(at), 1.0);
        let indices = rows.flat_map(|y| columns.clone().map(move |x| y * self.lattice.side + x));
        let numbers: ArrayVec<usize, 9> =
            indices.take(9).filter_map(|index| self.number_of(index)).collect();
        numbers.into_iter()
    }
}
