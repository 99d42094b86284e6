//! Largest squares of free cells around each cell.

use keyway::map::{BitGrid, Cell};

/// Largest square of free cells around every cell, which a ray may skip.
///
/// Stores the distance to the nearest obstacle cell in steps to any of the 8 neighbours (the
/// Chebyshev distance): all cells fewer steps away are free. Cells outside the grid do not count.
/// Takes one byte per cell, and two passes over the grid, each with the four neighbours that it
/// has already visited.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FreeSquares {
    width: usize,
    steps: Vec<u8>,
}

impl FreeSquares {
    /// Returns the free squares of a grid of obstacles.
    pub(super) fn around(obstacles: &BitGrid) -> Self {
        let (width, height) = (obstacles.width() as usize, obstacles.height() as usize);
        let mut steps = vec![u8::MAX; width * height];
        for y in 0..height {
            for x in obstacles.ones_in_span(y as i32, 0, width as i32 - 1) {
                steps[y * width + x as usize] = 0;
            }
        }
        for y in 0..height {
            let (passed, rest) = steps.split_at_mut(y * width);
            let below = passed.chunks(width).next_back();
            lower_row(&mut rest[..width], below, |i| i);
        }
        for y in (0..height).rev() {
            let (rest, passed) = steps.split_at_mut((y + 1) * width);
            let above = passed.chunks(width).next();
            lower_row(&mut rest[y * width..], above, |i| width - 1 - i);
        }
        Self { width, steps }
    }

    /// Returns the steps from a cell of the grid to the nearest obstacle cell, at most 255.
    pub(super) fn steps(&self, cell: Cell) -> i32 {
        i32::from(self.steps[cell.y as usize * self.width + cell.x as usize])
    }
}

/// Reduces each cell of a row to at most one more than its neighbours in the previous row and the
/// previous cell of the row in the given order.
fn lower_row(row: &mut [u8], before: Option<&[u8]>, order: impl Fn(usize) -> usize) {
    let last = row.len() - 1;
    let mut beside = u8::MAX;
    for at in (0..row.len()).map(order) {
        let mut least = beside;
        if let Some(before) = before {
            let near = &before[at.saturating_sub(1)..=(at + 1).min(last)];
            least = near.iter().fold(least, |least, &steps| least.min(steps));
        }
        beside = row[at].min(least.saturating_add(1));
        row[at] = beside;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_are_the_least_to_any_obstacle(
            (width, occupied) in (1..20u32).prop_flat_map(|width| {
                let cells = prop::collection::vec(prop::bool::weighted(0.02), width as usize * 17);
                (Just(width), cells)
            }),
        ) {
            let mut obstacles = BitGrid::new(width, 17, false);
            let cells = || (0..17).flat_map(|y| (0..width as i32).map(move |x| Cell::new(x, y)));
            for (cell, &is_occupied) in cells().zip(&occupied) {
                obstacles.set(cell, is_occupied);
            }
            let free = FreeSquares::around(&obstacles);
            for cell in cells() {
                let steps = |other: Cell| (cell.x - other.x).abs().max((cell.y - other.y).abs());
                let nearest = cells().filter(|&other| obstacles.get(other)).map(steps).min();
                prop_assert_eq!(free.steps(cell), nearest.unwrap_or(255));
            }
        }
    }
}
