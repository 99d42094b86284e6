//! Which cells around an obstacle cell are blocked because of it.

use super::{BitGrid, Cell};

/// A comparison of a clearance with a distance forgives this share of the clearance: both are sums
/// and products of decimal fractions, and 0.225 m must equal 4.5 cells of 0.05 m.
pub(crate) const CLEARANCE_TOLERANCE: f64 = 1e-9;

/// The neighbourhood of an obstacle cell that it blocks: symmetric in both axes and in their
/// exchange, and without gaps in a row.
///
/// `half_widths[k]` is the largest |dx| that is blocked in the rows k above and k below.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BlockedNeighbourhood {
    half_widths: Vec<i32>,
}

impl BlockedNeighbourhood {
    /// Cells whose offset (dx, dy >= 0) satisfies `blocked`, which must shrink monotonically in
    /// |dx| and |dy|, and the obstacle cell itself.
    fn new(blocked: impl Fn(i32, i32) -> bool) -> Self {
        let half_width = |dy| (0..i32::MAX).take_while(|&dx| blocked(dx, dy)).last();
        let mut half_widths: Vec<i32> = (0..i32::MAX).map_while(half_width).collect();
        if half_widths.is_empty() {
            half_widths.push(0);
        }
        Self { half_widths }
    }

    /// Cells whose centre is nearer than `clearance_cells` to the obstacle's square.
    pub(crate) fn disc(clearance_cells: f64) -> Self {
        let limit = clearance_cells * (1.0 - CLEARANCE_TOLERANCE);
        let beyond = |offset: i32| (f64::from(offset) - 0.5).max(0.0);
        Self::new(|dx, dy| {
            let (x, y) = (beyond(dx), beyond(dy));
            x * x + y * y < limit * limit
        })
    }

    /// The square of cells at most `cells` columns and rows away (1: the 8 neighbours).
    pub(crate) fn square(cells: u32) -> Self {
        let cells = cells as i32;
        Self { half_widths: vec![cells; cells as usize + 1] }
    }

    /// Cells whose centre is nearer than `distance_cells` to the obstacle's centre in the L1 norm.
    pub(crate) fn diamond(distance_cells: f64) -> Self {
        let limit = distance_cells * (1.0 - CLEARANCE_TOLERANCE);
        Self::new(|dx, dy| f64::from(dx + dy) < limit)
    }

    /// What either neighbourhood blocks.
    #[must_use]
    pub(crate) fn union(mut self, other: &Self) -> Self {
        for (i, &width) in other.half_widths.iter().enumerate() {
            match self.half_widths.get_mut(i) {
                Some(own) => *own = (*own).max(width),
                None => self.half_widths.push(width),
            }
        }
        self
    }

    /// Rows (and columns) that it reaches to either side.
    pub(crate) fn reach(&self) -> i32 {
        self.half_widths.len() as i32 - 1
    }

    /// Row offsets with the half width of each.
    fn rows(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        let reach = self.reach();
        (-reach..=reach).map(|dy| (dy, self.half_widths[dy.unsigned_abs() as usize]))
    }

    /// Sets every bit of `target` that an obstacle in `cell` blocks.
    pub(crate) fn stamp(&self, cell: Cell, target: &mut BitGrid) {
        for (dy, half) in self.rows() {
            target.fill_span(cell.y + dy, cell.x - half, cell.x + half);
        }
    }

    /// True when some obstacle blocks `cell`.
    pub(crate) fn is_blocked(&self, cell: Cell, obstacles: &BitGrid) -> bool {
        self.rows()
            .any(|(dy, half)| obstacles.any_in_span(cell.y + dy, cell.x - half, cell.x + half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disc_is_measured_to_the_square() {
        // The centre of the neighbour is half a cell from the square, of the diagonal one 0.707.
        assert_eq!(BlockedNeighbourhood::disc(0.0).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::disc(0.5).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::disc(0.6).half_widths, [1, 0]);
        assert_eq!(BlockedNeighbourhood::disc(0.8).half_widths, [1, 1]);
        // 0.225 m on 0.05 m cells: exactly 4.5 cells, so the fifth neighbour is free.
        assert_eq!(BlockedNeighbourhood::disc(0.225 / 0.05).half_widths[0], 4);
    }

    #[test]
    fn square_diamond_and_union() {
        assert_eq!(BlockedNeighbourhood::square(1).half_widths, [1, 1]);
        assert_eq!(BlockedNeighbourhood::square(0).half_widths, [0]);
        assert_eq!(BlockedNeighbourhood::diamond(2.0).half_widths, [1, 0]);
        assert_eq!(BlockedNeighbourhood::diamond(0.0).half_widths, [0]);
        let both = BlockedNeighbourhood::square(1).union(&BlockedNeighbourhood::diamond(4.0));
        assert_eq!(both.half_widths, [3, 2, 1, 0]);
    }
}
