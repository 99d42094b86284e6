//! Legs: the straight and the diagonal part of an octile path. Either may be missing.

use super::Plan;
use crate::map::{Cell, SearchMap};
use crate::search::bit_scan::is_set;

/// True if the leg that is diagonal first, then straight, is free.
///
/// Costs an operation for each diagonal step, and for each 64 cells of the straight part, which is
/// tested first.
pub(super) fn is_free(map: &SearchMap, from: Cell, to: Cell) -> bool {
    let turn = turn(from, to);
    let span = |a: i32, b: i32| (a.min(b), a.max(b));
    let is_obstructed = if turn.y == to.y {
        let (low, high) = span(turn.x, to.x);
        map.blocked().any_in_span(to.y, low, high)
    } else {
        let (low, high) = span(turn.y, to.y);
        map.blocked_transposed().any_in_span(to.x, low, high)
    };
    let (step_x, step_y) = step(from, turn);
    // The 2 x 2 cells that a step needs are indexed by their south-western one.
    let cramped = &map.stops().cramped;
    let first = map.index(Cell::new(from.x + step_x.min(0), from.y + step_y.min(0))).as_usize();
    let per_step = step_y as isize * cramped.stride() as isize + step_x as isize;
    let steps = (turn.x - from.x).abs() as isize;
    let is_cramped = |i| is_set(cramped.words(), first.wrapping_add_signed(i * per_step));
    !is_obstructed && !(0..steps).any(is_cramped)
}

/// The cell at which a leg that is diagonal first turns.
pub(super) fn turn(from: Cell, to: Cell) -> Cell {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let diagonal = dx.abs().min(dy.abs());
    Cell::new(from.x + diagonal * dx.signum(), from.y + diagonal * dy.signum())
}

/// Appends the leg to `to`, without `from`: first the diagonal part, then the straight one. It is
/// free in this order if it was found from `from`.
pub(super) fn diagonal_first(from: Cell, to: Cell, plan: &mut Plan) {
    let turn = turn(from, to);
    part(from, turn, plan);
    part(turn, to, plan);
}

/// Appends the leg to `to`, without `from`: first the straight part, then the diagonal one. It is
/// free in this order if it was found from `to`.
pub(super) fn straight_first(from: Cell, to: Cell, plan: &mut Plan) {
    let turn = turn(to, from);
    part(from, turn, plan);
    part(turn, to, plan);
}

fn part(from: Cell, to: Cell, plan: &mut Plan) {
    run(from, step(from, to), (to.x - from.x).abs().max((to.y - from.y).abs()), plan);
}

fn step(from: Cell, to: Cell) -> (i32, i32) {
    ((to.x - from.x).signum(), (to.y - from.y).signum())
}

/// Appends this many cells beyond `from`, the last one as a jump point, and returns that.
pub(super) fn run(from: Cell, step: (i32, i32), count: i32, plan: &mut Plan) -> Cell {
    let mut at = from;
    plan.cells.extend((0..count).map(|_| {
        at = Cell::new(at.x + step.0, at.y + step.1);
        at
    }));
    plan.mark_last();
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn free_along_a_diagonal_and_then_straight() {
        let rows = [".........", ".#....#..", ".........", "...#....."];
        let map = SearchMap::new(&OccupancyGrid::from_ascii(&rows), LayerConfig::default());
        let map = map.unwrap();
        let is_free = |from: (i32, i32), to: (i32, i32)| {
            is_free(&map, Cell::new(from.0, from.1), Cell::new(to.0, to.1))
        };
        assert!(is_free((0, 0), (0, 0)) && is_free((0, 0), (2, 1)) && is_free((4, 1), (4, 3)));
        assert!(!is_free((0, 0), (4, 0)), "through an obstacle");
        assert!(!is_free((5, 1), (6, 3)), "past its corner");
        assert!(!is_free((2, 0), (3, 1)), "beside it");
        assert!(is_free((8, 3), (8, 0)) && is_free((8, 1), (0, 1)));
    }

    #[test]
    fn legs_by_hand() {
        let (from, to) = (Cell::new(5, 5), Cell::new(2, 7));
        let cells = |append: fn(Cell, Cell, &mut Plan)| {
            let mut plan = Plan::default();
            append(from, to, &mut plan);
            (plan.cells.iter().map(|cell| (cell.x, cell.y)).collect::<Vec<_>>(), plan.jump_points)
        };
        assert_eq!(cells(diagonal_first), (vec![(4, 6), (3, 7), (2, 7)], vec![1, 2]));
        assert_eq!(cells(straight_first), (vec![(4, 5), (3, 6), (2, 7)], vec![0, 2]));
    }
}
