//! The straight stretches of a line, in a tree of bounding boxes.

use crate::geometry::Point;
use crate::map::{Clearance, GridFrame};
use std::ops::RangeInclusive;

/// Points within this distance of a straight line \[cells\] lie on it.
const STRAIGHT_CELLS: f64 = 1e-8;

/// A line, its straight stretches, and their bounding boxes.
pub(super) struct Stretches<'l> {
    points: &'l [Point],
    frame: &'l GridFrame,
    /// The last point of each stretch, which is also the first point of the next one. The first
    /// stretch is a single point.
    ends: Vec<usize>,
    /// Bounding boxes of the stretches, of pairs of them, of pairs of these, up to the whole line.
    spans: Vec<Vec<Span>>,
}

/// One stretch (level 0), or the group of 2^level stretches with this index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    level: usize,
    index: usize,
}

impl<'l> Stretches<'l> {
    pub(super) fn new(points: &'l [Point], clearance: &Clearance<'l>) -> Self {
        let frame = clearance.frame();
        let cells: Vec<Point> = points.iter().map(|&point| frame.grid_from_world(point)).collect();
        Self::with_ends(points, ends_of_stretches(&cells), clearance)
    }

    /// As [`Self::new`], for a line whose stretches are known: `ends` are their last points. The
    /// first stretch is a single point.
    pub(super) fn with_ends(
        points: &'l [Point],
        ends: Vec<usize>,
        clearance: &Clearance<'l>,
    ) -> Self {
        let frame = clearance.frame();
        let cell = |at: usize| frame.grid_from_world(points[at]);
        let begins = std::iter::once(0).chain(ends.iter().copied());
        let span = |(begin, &end): (usize, &usize)| Span::of_two(cell(begin), cell(end));
        let mut spans: Vec<Vec<Span>> = vec![begins.zip(&ends).map(span).collect()];
        while let Some(level) = spans.last().filter(|level| level.len() > 1) {
            let pairs = level.chunks(2).map(|pair| pair.iter().fold(pair[0], Span::with));
            spans.push(pairs.collect());
        }
        Self { points, frame, ends, spans }
    }

    /// The points of the line \[m\].
    pub(super) const fn points(&self) -> &'l [Point] {
        self.points
    }

    /// A point of the line \[cells\].
    pub(super) fn cell(&self, at: usize) -> Point {
        self.frame.grid_from_world(self.points[at])
    }

    /// The whole line; `None` if it has no point.
    pub(super) fn whole(&self) -> Option<Part> {
        (!self.points.is_empty()).then_some(Part { level: self.spans.len() - 1, index: 0 })
    }

    /// Both halves of a part, the later one last; `None` for a single stretch.
    pub(super) fn halves(&self, part: Part) -> Option<impl Iterator<Item = Part>> {
        let level = part.level.checked_sub(1)?;
        let count = self.spans[level].len();
        let halves = [2 * part.index, 2 * part.index + 1].into_iter();
        Some(halves.filter(move |&index| index < count).map(move |index| Part { level, index }))
    }

    /// The points of a part. A point shared by two parts belongs to the earlier one.
    pub(super) fn points_of(&self, part: Part) -> RangeInclusive<usize> {
        let first = part.index << part.level;
        let next = ((part.index + 1) << part.level).min(self.ends.len());
        let begin = first.checked_sub(1).map_or(0, |before| self.ends[before] + 1);
        begin..=self.ends[next - 1]
    }

    /// The last point of the straight stretch that point `at` belongs to.
    pub(super) fn end_of_stretch(&self, at: usize) -> usize {
        self.ends[self.ends.partition_point(|&end| end < at)]
    }

    /// The bounding box of a part \[cells\].
    pub(super) fn around(&self, part: Part) -> Span {
        self.spans[part.level][part.index]
    }
}

/// The last points of the straight stretches; the first point is a stretch of its own.
fn ends_of_stretches(cells: &[Point]) -> Vec<usize> {
    let mut ends: Vec<usize> = (0..cells.len().min(1)).collect();
    let (mut from, mut ahead) = (0, Point::default());
    for at in 1..cells.len() {
        let (way, step) = (cells[at] - cells[from], cells[at] - cells[at - 1]);
        // A stretch has the direction of its first two points; repeated points have none.
        if ahead.dot(step) > 0.0 && ahead.cross(way).abs() <= STRAIGHT_CELLS {
            ends.pop();
        } else {
            let length = step.norm();
            from = at - 1;
            ahead = if length > 0.0 { step * (1.0 / length) } else { Point::default() };
        }
        ends.push(at);
    }
    ends
}

/// The bounding box of some points \[cells\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) low: Point,
    pub(super) high: Point,
}

impl Span {
    pub(super) const fn of_two(a: Point, b: Point) -> Self {
        let low = Point::new(a.x.min(b.x), a.y.min(b.y));
        Self { low, high: Point::new(a.x.max(b.x), a.y.max(b.y)) }
    }

    const fn with(self, other: &Self) -> Self {
        let low = Self::of_two(self.low, other.low).low;
        Self { low, high: Self::of_two(self.high, other.high).high }
    }

    /// Squared distance from a point; 0 inside.
    pub(super) const fn distance_sq_to_point(&self, p: Point) -> f64 {
        let dx = (self.low.x - p.x).max(p.x - self.high.x).max(0.0);
        let dy = (self.low.y - p.y).max(p.y - self.high.y).max(0.0);
        dx * dx + dy * dy
    }

    pub(super) const fn corners(&self) -> [Point; 4] {
        let Self { low, high } = *self;
        [low, high, Point::new(low.x, high.y), Point::new(high.x, low.y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Clearance, OccupancyGrid};

    #[test]
    fn stretches_and_their_halves() {
        let grid = OccupancyGrid::from_ascii(&["......"; 4]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        // Right by 3, a repeated point, up by 2, back down by 1.
        let points =
            [[0.5, 0.5], [1.5, 0.5], [3.5, 0.5], [3.5, 0.5], [3.5, 1.5], [3.5, 2.5], [3.5, 1.5]]
                .map(Point::from);
        let line = Stretches::new(&points, &clearance);
        assert_eq!(line.ends, [0, 2, 3, 5, 6]);
        assert_eq!(
            (0..7).map(|at| line.end_of_stretch(at)).collect::<Vec<_>>(),
            [0, 2, 2, 3, 5, 5, 6]
        );
        // Five stretches, three pairs, two pairs of these, and the whole line.
        assert_eq!(line.spans.iter().map(Vec::len).collect::<Vec<_>>(), [5, 3, 2, 1]);
        let whole = line.whole().unwrap();
        assert_eq!(line.points_of(whole), 0..=6);
        assert_eq!(line.around(whole).corners()[..2], [[0.5, 0.5], [3.5, 2.5]].map(Point::from));
        let halves: Vec<Part> = line.halves(whole).unwrap().collect();
        assert_eq!(
            halves.iter().map(|&half| line.points_of(half)).collect::<Vec<_>>(),
            [0..=5, 6..=6]
        );
        // The last pair has no second stretch.
        let last: Vec<Part> = line.halves(halves[1]).unwrap().collect();
        assert_eq!(last.iter().map(|&half| line.points_of(half)).collect::<Vec<_>>(), [6..=6]);
        assert!(Stretches::new(&[], &clearance).whole().is_none());
        // A line that bends only slightly at each point still leaves its straight stretch.
        let ends = |y: [f64; 4]| {
            ends_of_stretches(&[0, 1, 2, 3].map(|k| Point::new(f64::from(k as u8), y[k])))
        };
        assert_eq!(ends([0.0, 0.0, 6e-9, 1.2e-8]), [0, 2, 3]);
        assert_eq!(ends([0.0, 0.0, 1e-3, 2e-3]), [0, 1, 3]);
        let single = line.halves(last[0]).unwrap().next().unwrap();
        assert!(line.halves(single).is_none() && line.points_of(single) == (6..=6));
    }
}
