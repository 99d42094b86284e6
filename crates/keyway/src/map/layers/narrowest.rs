//! The bottleneck of the widest path between two cells.

use crate::map::{Cell, Connectivity};
use std::collections::VecDeque;

/// Rooms of all cells, row by row. Cells with a room below `least` are blocked, and those with
/// exactly `least` are narrow.
pub(super) struct Rooms<'a> {
    pub(super) of_cells: &'a [u32],
    pub(super) width: usize,
    pub(super) least: u32,
}

/// Marks cells without a predecessor.
const NOBODY: usize = usize::MAX;

impl Rooms<'_> {
    /// First and last cell of the first bottleneck on a path from the start with the fewest
    /// narrow cells. The two ends must be connected.
    pub(super) fn narrowest(&self, ends: [Cell; 2], connectivity: Connectivity) -> [Cell; 2] {
        let [start, goal] = ends.map(|cell| cell.y as usize * self.width + cell.x as usize);
        let before = self.fewest_narrow(start, connectivity);
        let mut way = vec![goal];
        while let Some(&at) = way.last().filter(|&&at| at != start) {
            if before[at] == NOBODY {
                break;
            }
            way.push(before[at]);
        }
        let is_narrow = |at: &&usize| self.of_cells[**at] == self.least;
        let mut place = way.iter().rev().skip_while(|at| !is_narrow(at)).take_while(is_narrow);
        let first = *place.next().unwrap_or(&start);
        [first, *place.last().unwrap_or(&first)]
            .map(|at| Cell::new((at % self.width) as i32, (at / self.width) as i32))
    }

    /// Predecessor of each cell on a path with the fewest narrow cells.
    fn fewest_narrow(&self, start: usize, connectivity: Connectivity) -> Vec<usize> {
        let mut before = vec![NOBODY; self.of_cells.len()];
        let mut narrow = vec![u32::MAX; self.of_cells.len()];
        narrow[start] = 0;
        let mut open = VecDeque::from([start]);
        while let Some(at) = open.pop_front() {
            for next in
                self.neighbours(at, connectivity).filter(|&to| self.of_cells[to] >= self.least)
            {
                let is_narrow = self.of_cells[next] == self.least;
                let count = narrow[at] + u32::from(is_narrow);
                if count < narrow[next] {
                    (narrow[next], before[next]) = (count, at);
                    if is_narrow {
                        open.push_back(next);
                    } else {
                        open.push_front(next);
                    }
                }
            }
        }
        before
    }

    fn neighbours(&self, at: usize, connectivity: Connectivity) -> impl Iterator<Item = usize> {
        const STEPS: [(i64, i64); 8] =
            [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        let count = match connectivity {
            Connectivity::Four => 4,
            Connectivity::Eight => 8,
        };
        let (width, height) = (self.width as i64, (self.of_cells.len() / self.width) as i64);
        let (x, y) = (at as i64 % width, at as i64 / width);
        let beside = STEPS.into_iter().take(count).map(move |(dx, dy)| (x + dx, y + dy));
        let inside =
            beside.filter(move |&(x, y)| (0..width).contains(&x) && (0..height).contains(&y));
        inside.map(move |(x, y)| (y * width + x) as usize)
    }
}
