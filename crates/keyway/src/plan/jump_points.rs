//! The jump points of a path.

use super::Plan;
use super::any_angle::is_straight_on;

impl Plan {
    /// Marks the last cell so far as a jump point.
    pub(super) fn mark_last(&mut self) {
        let last = self.cells.len().saturating_sub(1);
        if self.jump_points.last() != Some(&last) {
            self.jump_points.push(last);
        }
    }

    /// Reverses the path from index `from` to its end.
    pub(super) fn reverse_from(&mut self, from: usize) {
        self.cells[from..].reverse();
        let mirror = from + self.cells.len() - 1;
        let first = self.jump_points.partition_point(|&at| at < from);
        let jump_points = &mut self.jump_points[first..];
        jump_points.reverse();
        for at in jump_points.iter_mut() {
            *at = mirror - *at;
        }
    }

    /// Sets the jump points to start, goal and turning cells of the path.
    pub(super) fn mark_turns(&mut self) {
        let cells = &self.cells;
        let is_jump_point = |&i: &usize| {
            let is_end = i == 0 || i + 1 == cells.len();
            is_end || !is_straight_on(cells[i - 1], cells[i], cells[i + 1])
        };
        self.jump_points.clear();
        self.jump_points.extend((0..cells.len()).filter(is_jump_point));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Cell;

    fn plan(cells: &[(i32, i32)], jump_points: &[usize]) -> Plan {
        let cells = cells.iter().map(|&(x, y)| Cell::new(x, y)).collect();
        Plan { cells, jump_points: jump_points.to_vec(), ..Plan::default() }
    }

    #[test]
    fn a_path_turns_where_its_direction_changes() {
        let turns = |cells: &[(i32, i32)]| {
            let mut plan = plan(cells, &[]);
            plan.mark_turns();
            plan.jump_points
        };
        assert_eq!(turns(&[(0, 0), (1, 0), (2, 0), (3, 1), (4, 2), (4, 3)]), [0, 2, 4, 5]);
        // A reversal over its own cells, and a far waypoint in the same direction.
        assert_eq!(turns(&[(0, 0), (1, 0), (2, 0), (1, 0)]), [0, 2, 3]);
        assert_eq!(turns(&[(0, 0), (2, 1), (6, 3), (7, 3)]), [0, 2, 3]);
        assert_eq!((turns(&[(0, 0)]), turns(&[])), (vec![0], vec![]));
    }

    #[test]
    fn reversing_keeps_the_jump_points() {
        let mut turned = plan(&[(0, 0), (9, 9), (8, 9), (7, 9), (6, 9)], &[0, 1, 3]);
        turned.reverse_from(1);
        assert_eq!(turned, plan(&[(0, 0), (6, 9), (7, 9), (8, 9), (9, 9)], &[0, 2, 4]));
    }
}
