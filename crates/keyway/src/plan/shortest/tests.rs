use super::shortest_line;
use crate::geometry::{Point, Pose};
use crate::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use crate::search::CornerRule;
use proptest::prelude::*;

fn map(rows: &[&str]) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
}

fn points(rows: &[&str], start: [f64; 2], goal: [f64; 2]) -> Option<Vec<[f64; 2]>> {
    let line = shortest_line(&map(rows), CornerRule::Forbid, start.into(), goal.into())?;
    Some(line.points().iter().map(|&point| point.into()).collect())
}

#[test]
fn straight_where_nothing_stands() {
    let rows = ["....", "....", "...."];
    let ends = ([0.5, 0.5], [3.5, 2.0]);
    assert_eq!(points(&rows, ends.0, ends.1).unwrap(), [ends.0, ends.1]);
    assert_eq!(points(&rows, ends.0, ends.0).unwrap(), [ends.0, ends.0]);
}

#[test]
fn around_the_nearer_corner() {
    let rows = [".....", "..#..", "..#..", "....."];
    let (start, goal) = ([0.5, 1.5], [4.5, 1.5]);
    assert_eq!(points(&rows, start, goal).unwrap(), [start, [2.0, 1.0], [3.0, 1.0], goal]);
}

#[test]
fn along_a_wall_and_not_between_two_blocked_cells() {
    let rows = ["..#", ".#.", "..."];
    let (start, goal) = ([1.5, 2.5], [2.5, 1.5]);
    let around = points(&rows, start, goal).unwrap();
    assert_eq!(around, [start, [1.0, 2.0], [1.0, 1.0], [2.0, 1.0], goal]);
    let cut = shortest_line(&map(&rows), CornerRule::Allow, start.into(), goal.into()).unwrap();
    assert!((cut.length_m() - 2.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn no_way() {
    assert_eq!(points(&["..#..", "..#.."], [0.5, 0.5], [4.5, 0.5]), None);
    assert_eq!(points(&["..#.."], [0.5, 0.5], [2.5, 0.5]), None);
    assert_eq!(points(&["..#.."], [0.5, 0.5], [9.0, 0.5]), None);
}

/// True if the segment enters no blocked square and does not pass between two that share a corner.
/// Coordinates are in quarters of a cell.
fn is_clear(grid: &OccupancyGrid, corners: CornerRule, from: [i64; 2], to: [i64; 2]) -> bool {
    let blocked =
        |x: i64, y: i64| grid.state(Cell::new(x as i32, y as i32)) != Some(CellState::Free);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let side = |x: i64, y: i64| dx * (4 * y - from[1]) - dy * (4 * x - from[0]);
    let overlaps = |a: i64, b: i64, low: i64, high: i64| a.min(b) < high && a.max(b) > low;
    let (width, height) = (i64::from(grid.frame().width()), i64::from(grid.frame().height()));
    for (x, y) in (-1..=width).flat_map(|x| (-1..=height).map(move |y| (x, y))) {
        let sides = [side(x, y), side(x + 1, y), side(x, y + 1), side(x + 1, y + 1)];
        let crosses_line = sides.iter().any(|&s| s < 0) && sides.iter().any(|&s| s > 0);
        // A segment along an axis has no extent across it.
        let reach = |a: i64, b: i64, low: i64| {
            if a == b { low < a && a < low + 4 } else { overlaps(a, b, low, low + 4) }
        };
        let in_box = reach(from[0], to[0], 4 * x) && reach(from[1], to[1], 4 * y);
        if blocked(x, y) && crosses_line && in_box {
            return false;
        }
    }
    // Squeezed through a lattice point, or along an edge between two blocked cells.
    let inside =
        |x: i64, y: i64| (x - from[0]) * (x - to[0]) <= 0 && (y - from[1]) * (y - to[1]) <= 0;
    let on = |x: i64, y: i64| dx * (y - from[1]) == dy * (x - from[0]) && inside(x, y);
    for (x, y) in (0..=width).flat_map(|x| (0..=height).map(move |y| (x, y))) {
        let strictly = [4 * x, 4 * y] != from && [4 * x, 4 * y] != to;
        let [sw, se, nw, ne] =
            [blocked(x - 1, y - 1), blocked(x, y - 1), blocked(x - 1, y), blocked(x, y)];
        let diagonal = (sw && ne && !se && !nw) || (se && nw && !sw && !ne);
        if corners == CornerRule::Forbid && strictly && diagonal && on(4 * x, 4 * y) {
            return false;
        }
        // The midpoint to the next lattice point on the right, then above.
        if dy == 0 && blocked(x, y) && blocked(x, y - 1) && on(4 * x + 2, 4 * y) {
            return false;
        }
        if dx == 0 && blocked(x, y) && blocked(x - 1, y) && on(4 * x, 4 * y + 2) {
            return false;
        }
    }
    true
}

/// Dijkstra's algorithm over all lattice points, start and goal. The line may turn at a lattice
/// point between two blocked cells only if corners may be cut.
fn brute_force(grid: &OccupancyGrid, corners: CornerRule, ends: [Cell; 2]) -> Option<f64> {
    let (width, height) = (i64::from(grid.frame().width()), i64::from(grid.frame().height()));
    let blocked =
        |x: i64, y: i64| grid.state(Cell::new(x as i32, y as i32)) != Some(CellState::Free);
    let can_turn = |&[x, y]: &[i64; 2]| {
        let [sw, se, nw, ne] =
            [blocked(x - 1, y - 1), blocked(x, y - 1), blocked(x - 1, y), blocked(x, y)];
        let diagonal = (sw && ne && !se && !nw) || (se && nw && !sw && !ne);
        !(sw && se && nw && ne) && (corners == CornerRule::Allow || !diagonal)
    };
    let lattice = (0..=width).flat_map(|x| (0..=height).map(move |y| [x, y]));
    let mut spots: Vec<[i64; 2]> =
        ends.iter().map(|c| [4 * i64::from(c.x) + 2, 4 * i64::from(c.y) + 2]).collect();
    spots.extend(lattice.filter(can_turn).map(|[x, y]| [4 * x, 4 * y]));
    let mut best = vec![f64::INFINITY; spots.len()];
    let mut done = vec![false; spots.len()];
    best[0] = 0.0;
    loop {
        let open = (0..spots.len()).filter(|&i| !done[i] && best[i].is_finite());
        let at = open.min_by(|&i, &j| best[i].total_cmp(&best[j]))?;
        if at == 1 {
            return Some(best[1]);
        }
        done[at] = true;
        for to in 0..spots.len() {
            let (a, b) = (spots[at], spots[to]);
            let length = ((a[0] - b[0]) as f64).hypot((a[1] - b[1]) as f64) / 4.0;
            if best[at] + length < best[to] && is_clear(grid, corners, a, b) {
                best[to] = best[at] + length;
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn as_short_as_brute_force_finds(
        (width, height, bits) in (1u64..9, 1u64..8).prop_flat_map(|(width, height)| (
            Just(width), Just(height),
            prop::collection::vec(prop::bool::weighted(0.3), (width * height) as usize),
        )),
        ends: (u64, u64), allow: bool,
    ) {
        let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        let grid = OccupancyGrid::from_fn(frame, |cell| {
            let is_blocked = bits[(cell.y as u64 * width + cell.x as u64) as usize];
            if is_blocked { CellState::Occupied } else { CellState::Free }
        });
        let free: Vec<Cell> =
            frame.cells().filter(|&c| grid.state(c) == Some(CellState::Free)).collect();
        prop_assume!(!free.is_empty());
        let pick = |n: u64| free[(n % free.len() as u64) as usize];
        let ends = [pick(ends.0), pick(ends.1)];
        let corners = if allow { CornerRule::Allow } else { CornerRule::Forbid };
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let centre = |cell: Cell| frame.world_from_cell(cell);
        let line = shortest_line(&map, corners, centre(ends[0]), centre(ends[1]));
        let expected = brute_force(&grid, corners, ends);
        let length = line.as_ref().map(crate::geometry::Polyline::length_m);
        match (length, expected) {
            (Some(length), Some(expected)) => prop_assert!(
                (length - expected).abs() < 1e-9, "{} {} {:?}", length, expected, line),
            (length, expected) => prop_assert_eq!(length, expected),
        }
        // Every leg must be clear.
        let quarters = |p: Point| [(p.x * 4.0).round() as i64, (p.y * 4.0).round() as i64];
        for leg in line.iter().flat_map(|line| line.points().windows(2)) {
            prop_assert!(is_clear(&grid, corners, quarters(leg[0]), quarters(leg[1])), "{:?}", line);
        }
    }
}
