//! Distances between cells, in the fixed point of [`Cost::key`].

use super::Cost;
use crate::map::{Cell, CellIndex, SearchMap};

/// A distance between two cells: the heuristic of a search.
///
/// A search that never reopens closed nodes finds shortest paths if the metric is *consistent*: no
/// step reduces the distance to the goal by more than the step costs. Costs and distances are
/// compared as integers, so this must hold after rounding, too.
pub(crate) trait Metric: Copy {
    /// The distance over `dx` columns and `dy` rows, as a [`Cost::key`].
    fn length(self, dx: u32, dy: u32) -> u64;
}

/// The zero estimate: A* becomes Dijkstra's algorithm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Zero;

/// The cost of the shortest path without obstacles; consistent for 8 and for 4 neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Octile;

/// The straight-line distance, rounded down; consistent for 8 and for 4 neighbours.
///
/// Proof: a straight step costs q = [`Cost::KEY_STRAIGHT`], a diagonal one p > q sqrt(2). By the
/// triangle inequality the unrounded distances e (in units of 1/q cell) satisfy e(n) <= c + e(m)
/// for a step of cost c from n to m. As c is an integer, floor(e(n)) <= floor(c + e(m)) = c +
/// floor(e(m)).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Euclidean;

/// The sum of column and row distances; consistent for 4 neighbours, inadmissible for 8.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Manhattan;

/// The mean of [`Euclidean`] and [`Manhattan`], rounded down \[You2021, eq. (3)\]; consistent for
/// 4 neighbours, inadmissible for 8 (a diagonal step: 1.707 for 1.414).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mean;

impl Metric for Zero {
    fn length(self, _: u32, _: u32) -> u64 {
        0
    }
}

impl Metric for Octile {
    fn length(self, dx: u32, dy: u32) -> u64 {
        Cost::octile(dx, dy).key()
    }
}

impl Metric for Euclidean {
    fn length(self, dx: u32, dy: u32) -> u64 {
        let sum_of_squares = u64::from(dx).pow(2) + u64::from(dy).pow(2);
        // floor(q sqrt(n)) = floor(sqrt(q^2 n)): floating point gives it up to a rounding error,
        // which exact squares then correct.
        let exact = u128::from(Cost::KEY_STRAIGHT).pow(2) * u128::from(sum_of_squares);
        let square = |root: u64| u128::from(root) * u128::from(root);
        let mut root = ((sum_of_squares as f64).sqrt() * Cost::KEY_STRAIGHT as f64) as u64;
        while square(root) > exact {
            root -= 1;
        }
        while square(root + 1) <= exact {
            root += 1;
        }
        root
    }
}

impl Metric for Manhattan {
    fn length(self, dx: u32, dy: u32) -> u64 {
        (u64::from(dx) + u64::from(dy)) * Cost::KEY_STRAIGHT
    }
}

impl Metric for Mean {
    fn length(self, dx: u32, dy: u32) -> u64 {
        u64::midpoint(Euclidean.length(dx, dy), Manhattan.length(dx, dy))
    }
}

/// Distances from any cell to one target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DistanceTo<M> {
    metric: M,
    target: Cell,
    stride: u32,
    /// 2^64 / stride, rounded up: division by multiplication, exact as long as the product of
    /// dividend and divisor is below 2^64.
    reciprocal: u64,
}

impl<M: Metric> DistanceTo<M> {
    /// Distances to `target` for the cells of `map`.
    pub(crate) fn new(map: &SearchMap, metric: M, target: Cell) -> Self {
        let stride = map.blocked().stride() as u32;
        Self { metric, target, stride, reciprocal: u64::MAX / u64::from(stride) + 1 }
    }

    /// The distance from a cell, as a [`Cost::key`].
    pub(crate) fn from(&self, at: CellIndex) -> u64 {
        let row = ((u128::from(self.reciprocal) * u128::from(at.0)) >> 64) as u32;
        // One row and one column of padding precede the cells.
        let (x, y) = ((at.0 - row * self.stride) as i32 - 1, row as i32 - 1);
        self.metric.length(x.abs_diff(self.target.x), y.abs_diff(self.target.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};
    use proptest::prelude::*;

    const Q: u64 = Cost::KEY_STRAIGHT;

    #[test]
    fn by_hand() {
        assert_eq!(Zero.length(3, 4), 0);
        assert_eq!(Octile.length(3, 4), Cost::new(1, 3).key());
        assert_eq!(Euclidean.length(3, 4), 5 * Q);
        assert_eq!(Manhattan.length(3, 4), 7 * Q);
        assert_eq!(Mean.length(3, 4), 6 * Q);
        // Equation (3) of \[You2021\] for a diagonal step.
        assert!((Mean.length(1, 1) as f64 / Q as f64 - 1.707).abs() < 1e-3);
        // q sqrt(2) lies between two integers; p is the upper one.
        assert_eq!(Euclidean.length(1, 1), Cost::KEY_DIAGONAL - 1);
    }

    #[test]
    fn the_target_may_lie_anywhere() {
        let rows = [".".repeat(200), ".".repeat(200), ".".repeat(200)];
        let map = OccupancyGrid::from_ascii(&rows.each_ref().map(String::as_str));
        let map = SearchMap::new(&map, LayerConfig::default()).unwrap();
        let target = Cell::new(150, 1);
        let distance = DistanceTo::new(&map, Octile, target);
        for (x, y) in (0..200).flat_map(|x| (0..3).map(move |y| (x, y))) {
            let expected = Octile.length((x - 150i32).unsigned_abs(), (y - 1i32).unsigned_abs());
            assert_eq!(distance.from(map.index(Cell::new(x, y))), expected);
        }
    }

    /// True if a step reduces the distance by no more than it costs.
    fn is_consistent(metric: impl Metric, x: i32, y: i32, dx: i32, dy: i32) -> bool {
        let cost = if dx != 0 && dy != 0 { Cost::KEY_DIAGONAL } else { Cost::KEY_STRAIGHT };
        let here = metric.length(x.unsigned_abs(), y.unsigned_abs());
        here <= cost + metric.length((x + dx).unsigned_abs(), (y + dy).unsigned_abs())
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

        #[test]
        fn no_step_takes_off_more_than_it_costs(x in -90_000i32..90_000, y in -90_000i32..90_000,
                                                near in 0i32..4, direction in 0usize..8) {
            // Three of four cases are near the target or on an axis or diagonal, where distances
            // are tight.
            let (x, y) = match near { 0 => (x % 8, y % 8), 1 => (x, 0), 2 => (x, x), _ => (x, y) };
            let (dx, dy) = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)][direction];
            prop_assert!(is_consistent(Zero, x, y, dx, dy));
            prop_assert!(is_consistent(Octile, x, y, dx, dy));
            prop_assert!(is_consistent(Euclidean, x, y, dx, dy));
            if dx == 0 || dy == 0 {
                prop_assert!(is_consistent(Manhattan, x, y, dx, dy));
                prop_assert!(is_consistent(Mean, x, y, dx, dy));
            }
        }

        #[test]
        fn the_straight_line_is_rounded_down(dx in 0u32..2_000_000_000, dy in 0u32..2_000_000_000) {
            let exact = u128::from(Q) * u128::from(Q)
                * (u128::from(dx) * u128::from(dx) + u128::from(dy) * u128::from(dy));
            prop_assert_eq!(u128::from(Euclidean.length(dx, dy)), exact.isqrt());
        }
    }
}
