use super::*;
use crate::geometry::Pose;
use crate::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use crate::metrics::shortest_line;
use crate::search::CornerRule;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn line(points: &[[f64; 2]]) -> Polyline {
    Polyline::new(points.iter().map(|&p| p.into()).collect())
}

fn pulled_on(rows: &[&str], points: &[[f64; 2]], clearance_m: f64) -> Smoothed {
    let grid = OccupancyGrid::from_ascii(rows);
    taut(&line(points), &Clearance::new(grid.frame(), grid.occupied()), clearance_m)
}

fn corners(rows: &[&str], points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let path = pulled_on(rows, points, 0.0).path;
    path.flattened(0.0).points().iter().map(|&p| p.into()).collect()
}

#[test]
fn straight_where_nothing_stands() {
    let rows = ["....", "....", "...."];
    let zigzag = [[0.5, 0.5], [1.5, 2.5], [2.5, 0.5], [3.5, 1.5]];
    assert_eq!(corners(&rows, &zigzag), [[0.5, 0.5], [3.5, 1.5]]);
    assert_eq!(pulled_on(&rows, &zigzag, 0.3).path.length_m(), 10f64.sqrt());
    // Out and back again.
    assert_eq!(pulled_on(&rows, &[[0.5, 0.5], [3.5, 0.5], [0.5, 0.5]], 0.0).path.length_m(), 0.0);
    assert!(corners(&rows, &[]).is_empty());
    assert!(pulled_on(&rows, &[[0.5, 0.5]], 0.0).path.length_m() == 0.0);
    assert!(pulled_on(&rows, &[[0.5, 0.5], [0.5, 0.5]], 0.2).path.length_m() == 0.0);
    assert_eq!(
        corners(&rows, &[[0.5, 0.5], [f64::NAN, 1.0], [3.5, 0.5]]),
        [[0.5, 0.5], [3.5, 0.5]]
    );
}

#[test]
fn stays_on_its_side_of_an_obstacle() {
    let rows = [".....", "..#..", "....."];
    // The line goes above the obstacle, (2, 1) - (3, 2), although below is as long.
    let above = [[0.5, 1.5], [1.5, 2.5], [3.5, 2.5], [4.5, 1.5]];
    assert_eq!(corners(&rows, &above), [[0.5, 1.5], [2.0, 2.0], [3.0, 2.0], [4.5, 1.5]]);
    let below = above.map(|[x, y]| [x, 3.0 - y]);
    assert_eq!(corners(&rows, &below), [[0.5, 1.5], [2.0, 1.0], [3.0, 1.0], [4.5, 1.5]]);
    // Once around it, and on: the loop is pulled tight and stays.
    let around = [[0.5, 0.5], [3.5, 0.5], [3.5, 2.5], [1.5, 2.5], [1.5, 0.5], [4.5, 0.5]];
    let expected = [[0.5, 0.5], [3.0, 1.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [4.5, 0.5]];
    assert_eq!(corners(&rows, &around), expected);
    // There and back by another way is a loop around it; by the same way it is nothing.
    let there = [[0.5, 0.5], [3.5, 0.5], [3.5, 2.5], [3.5, 0.5], [0.5, 0.5], [0.5, 2.5]];
    assert_eq!(corners(&rows, &there), [[0.5, 0.5], [0.5, 2.5]]);
}

#[test]
fn a_corner_that_the_line_grazes_on_its_other_side_bends_nothing() {
    // The line x = 3 y - 13 touches the corner (5, 6) of the obstacle below it, and (2, 5) of the one above
    // it. From (9, 7.5) the string passes 0.07 m above (5, 6), and bends around (2, 5) only.
    let free = "...........";
    let rows = [free, free, ".#...#.....", free, free, free, free, free];
    let grazing = [[9.0, 7.5], [8.0, 7.0], [0.5, 4.5]];
    assert_eq!(corners(&rows, &grazing), [grazing[0], [2.0, 5.0], grazing[2]]);
}

#[test]
fn through_a_maze() {
    let rows = ["......", ".####.", "....#.", ".##.#.", "....#."];
    // From inside the hook at (2.5, 2.5) around it to its outside (5.5, 2.5): over the top is not its way in,
    // the line leaves the hook at the left and goes over (1, 4) and (5, 4).
    let way = [[2.5, 2.5], [0.5, 2.5], [0.5, 4.5], [5.5, 4.5], [5.5, 2.5]];
    let expected = [[2.5, 2.5], [1.0, 3.0], [1.0, 4.0], [5.0, 4.0], [5.5, 2.5]];
    assert_eq!(corners(&rows, &way), expected);
}

#[test]
fn bends_are_arcs_of_the_clearance() {
    // From (1.5, 0.5) up and left around the corner (1, 2) of the wall, 0.5 m away: straight up to
    // (1.5, 2), a quarter turn to (1, 2.5), straight on to (0.5, 2.5).
    let rows = ["....", "....", "#...", "#..."];
    let smoothed = pulled_on(&rows, &[[1.5, 0.5], [1.5, 2.5], [0.5, 2.5]], 0.5);
    let expected = 1.5 + FRAC_PI_2 * 0.5 + 0.5;
    assert!((smoothed.path.length_m() - expected).abs() < 1e-9, "{smoothed:?}");
    assert_eq!(smoothed.path.pieces().len(), 3);
    assert_eq!(smoothed.shortfall_m, None);
    assert!(smoothed.path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-6));
    assert!(smoothed.sharp_corners.is_empty());
}

#[test]
fn bends_also_where_the_border_is_nearer_than_the_clearance() {
    // The line is 0.5 m from the map's border, where nothing can be pulled away from it, and 0.7 m are asked
    // for. Around the corner (3, 2) the clearance is kept; what is told is the distance to the border.
    let rows = [".......", ".......", "..#....", ".......", "......."];
    let grid = OccupancyGrid::from_ascii(&rows);
    for resolution_m in [0.05, 1.0, 100.0] {
        for yaw in [0.0, 0.3, 1.1, 2.2] {
            let frame = GridFrame::new(7, 5, resolution_m, Pose::new(1.0, 2.0, yaw)).unwrap();
            let clearance = Clearance::new(&frame, grid.occupied());
            let points = [[0.5, 0.5], [6.5, 0.5], [6.5, 4.5], [5.5, 4.5]].map(Point::from);
            let world = points.map(|at| frame.world_from_grid(at));
            let smoothed = taut(&Polyline::new(world.to_vec()), &clearance, 0.7 * resolution_m);
            assert!(smoothed.sharp_corners.is_empty(), "{smoothed:?}");
            let told_cells = smoothed.shortfall_m.map(|kept_m| kept_m / resolution_m);
            assert!(told_cells.is_some_and(|kept| (kept - 0.5).abs() < 1e-9), "{smoothed:?}");
            assert_eq!(smoothed.path.pieces().len(), 3, "two tangents and an arc: {smoothed:?}");
        }
    }
}

#[test]
fn a_line_that_comes_back_unwinds_the_disc() {
    // Up and left around the corner (1, 2), and back to below it: what is left is straight.
    let rows = ["....", "....", "#...", "#..."];
    let line = [[1.5, 0.5], [1.5, 2.5], [0.5, 2.5], [1.5, 2.5], [1.5, 0.5], [3.5, 0.5]];
    let smoothed = pulled_on(&rows, &line, 0.5);
    assert!((smoothed.path.length_m() - 2.0).abs() < 1e-9, "{smoothed:?}");
    let half = [[1.5, 0.5], [1.5, 2.5], [0.5, 2.5], [1.5, 2.5]];
    assert!((pulled_on(&rows, &half, 0.5).path.length_m() - 2.0).abs() < 1e-9);
}

#[test]
fn where_the_line_is_too_near_its_own_distance_is_kept() {
    // The line passes (1, 2) at 0.5 m on both sides of the corner; 0.8 m are asked for.
    let rows = ["....", "....", "#...", "#..."];
    let smoothed = pulled_on(&rows, &[[1.5, 0.5], [1.5, 2.5], [0.5, 2.5]], 0.8);
    assert!((smoothed.shortfall_m.unwrap() - 0.5).abs() < 1e-6, "{smoothed:?}");
    assert!((smoothed.path.length_m() - 2.0 - FRAC_PI_2 * 0.5).abs() < 1e-6);
}

#[test]
fn what_is_in_collision_stays() {
    let rows = ["..#..", ".#...", "....."];
    // Between the two squares at (2, 2), where no line is clear.
    let slip = [[0.5, 0.5], [0.5, 2.5], [1.5, 2.5], [2.5, 1.5], [4.5, 1.5], [4.5, 0.5]];
    let path = corners(&rows, &slip);
    assert_eq!(path, [[0.5, 0.5], [1.0, 2.0], [1.5, 2.5], [2.5, 1.5], [4.5, 0.5]]);
}

/// For each group of obstacles that touch, also in a corner, one of its cells.
fn groups(grid: &OccupancyGrid) -> Vec<Cell> {
    let mut left: Vec<Cell> =
        grid.frame().cells().filter(|&c| grid.state(c) == Some(CellState::Occupied)).collect();
    let mut groups = Vec::new();
    while let Some(first) = left.pop() {
        groups.push(first);
        let mut open = vec![first];
        while let Some(at) = open.pop() {
            let is_near = |c: &Cell| (c.x - at.x).abs() <= 1 && (c.y - at.y).abs() <= 1;
            open.extend(left.iter().copied().filter(is_near));
            left.retain(|c| !is_near(c));
        }
    }
    groups
}

/// How a line passes the groups: the rays upwards from each that it crosses, with the direction, and
/// crossings there and back again cancelled. Two lines with the same ends can be pulled into each
/// other if and only if these are the same.
fn word(line: &Polyline, groups: &[Cell]) -> Vec<(usize, bool)> {
    let ray = |number: usize| {
        let shift = 1e-3 * (number as f64 + 0.37);
        Point::new(f64::from(groups[number].x) + 0.5 + shift, f64::from(groups[number].y) + 0.5)
    };
    let mut word = Vec::new();
    for Segment { a, b } in line.segments() {
        let mut crossed: Vec<(f64, usize)> = Vec::new();
        for number in 0..groups.len() {
            let from = ray(number);
            let fraction = (from.x - a.x) / (b.x - a.x);
            if (a.x < from.x) != (b.x < from.x) && a.lerp(b, fraction).y > from.y {
                crossed.push((fraction, number));
            }
        }
        crossed.sort_by(|x, y| x.0.total_cmp(&y.0));
        for (_, number) in crossed {
            let letter = (number, b.x > a.x);
            if word.last() == Some(&(number, b.x <= a.x)) {
                word.pop();
            } else {
                word.push(letter);
            }
        }
    }
    word
}

fn random_grid((width, height): (u64, u64), bits: &[bool]) -> OccupancyGrid {
    let frame = GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let is_blocked = bits[(cell.y as u64 * width + cell.x as u64) as usize];
        if is_blocked { CellState::Occupied } else { CellState::Free }
    })
}

/// A walk over cells whose steps cut no corner, from a free cell on.
fn walk(map: &SearchMap, first: usize, steps: &[u8]) -> Option<Polyline> {
    let free: Vec<Cell> = map.frame().cells().filter(|&c| map.is_free(c)).collect();
    let mut at = *free.get(first % free.len().max(1))?;
    let mut points = vec![map.frame().world_from_cell(at)];
    let mut ahead = 0;
    for step in steps {
        // Mostly straight on, so that the walk comes around.
        ahead = if *step < 8 { i32::from(*step) } else { ahead };
        let (dx, dy) =
            [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)][ahead as usize];
        let is_open = [(dx, dy), (dx, 0), (0, dy)]
            .iter()
            .all(|&(x, y)| map.is_free(Cell::new(at.x + x, at.y + y)));
        if is_open {
            at = Cell::new(at.x + dx, at.y + dy);
            points.push(map.frame().world_from_cell(at));
        }
    }
    Some(Polyline::new(points))
}

/// Whether each corner of a line is a lattice point, around which it turns towards a blocked cell.
fn is_taut(line: &Polyline, map: &SearchMap) -> bool {
    line.points().windows(3).all(|p| {
        let (came, goes) = (p[1] - p[0], p[2] - p[1]);
        let side = came.cross(goes).signum();
        (-1..=0).flat_map(|x| [(x, -1), (x, 0)]).any(|(dx, dy)| {
            let inner = Point::new(f64::from(2 * dx + 1), f64::from(2 * dy + 1));
            let is_blocked =
                !map.is_free(Cell::new(p[1].x.round() as i32 + dx, p[1].y.round() as i32 + dy));
            is_blocked
                && p[1].distance(Point::new(p[1].x.round(), p[1].y.round())) < 1e-9
                && side * came.cross(inner) > 0.0
                && side * goes.cross(inner) > 0.0
        })
    })
}

fn grids(density: f64) -> impl Strategy<Value = ((u64, u64), Vec<bool>)> {
    (3u64..18, 3u64..14).prop_flat_map(move |(width, height)| {
        let bits = prop::collection::vec(prop::bool::weighted(density), (width * height) as usize);
        (Just((width, height)), bits)
    })
}

fn map_of(grid: &OccupancyGrid, clearance_m: f64) -> SearchMap {
    SearchMap::new(grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn the_shortest_line_of_its_class((size, bits) in grids(0.2), first: usize,
                                      steps in prop::collection::vec(0u8..30, 0..150)) {
        let grid = random_grid(size, &bits);
        let map = map_of(&grid, 0.0);
        let Some(line) = walk(&map, first, &steps) else { return Ok(()) };
        let smoothed = taut(&line, &map.clearance(), 0.0);
        let path = smoothed.path.flattened(0.0);
        // Where the walk comes back to where it began, nothing may be left of it.
        prop_assume!(!path.points().is_empty());
        let groups = groups(&grid);
        prop_assert!(smoothed.sharp_corners.is_empty() && smoothed.shortfall_m.is_none());
        prop_assert!(map.clearance().is_clear_path(&smoothed.path, 0.0));
        prop_assert!(path.length_m() <= line.length_m() + 1e-9);
        prop_assert!(is_taut(&path, &map), "{:?}", path);
        prop_assert_eq!(word(&path, &groups), word(&line, &groups), "{:?}", path);
        prop_assert_eq!(&taut(&path, &map.clearance(), 0.0).path, &smoothed.path, "again");
        let back = Polyline::new(line.points().iter().rev().copied().collect());
        let back = taut(&back, &map.clearance(), 0.0);
        prop_assert!((back.path.length_m() - path.length_m()).abs() < 1e-9, "{:?}", back);
        // Against an independent search, where the class is the best one.
        let (a, b) = (line.points()[0], line.points()[line.points().len() - 1]);
        let shortest = shortest_line(&map, CornerRule::Forbid, a, b).unwrap();
        prop_assert!(path.length_m() >= shortest.length_m() - 1e-9);
        if word(&shortest, &groups) == word(&line, &groups) {
            prop_assert!((path.length_m() - shortest.length_m()).abs() < 1e-9);
        }
    }

    #[test]
    fn with_a_clearance((size, bits) in grids(0.06), first: usize, planned in 0.0..1.6f64, asked in 0.0..1.6f64,
                        steps in prop::collection::vec(0u8..30, 0..150)) {
        let grid = random_grid(size, &bits);
        let map = map_of(&grid, planned);
        let Some(line) = walk(&map, first, &steps) else { return Ok(()) };
        let smoothed = taut(&line, &map.clearance(), asked);
        let length_m = smoothed.path.length_m();
        prop_assert!(length_m <= line.length_m() + 1e-9);
        let is_kept = map.clearance().is_clear_path(&smoothed.path, asked);
        prop_assert_eq!(smoothed.shortfall_m.is_none() || !is_kept, true);
        if planned >= asked {
            prop_assert!(is_kept);
            prop_assert!(smoothed.sharp_corners.is_empty(), "{:?}", smoothed);
        } else {
            // Neither nearer to obstacles than the line nor to the border.
            let to_border = |&at: &Point| map.clearance().to_border(at);
            let border_m = line.points().iter().map(to_border).fold(asked, f64::min);
            let before_m = map.clearance().of_line(&line).map_or(border_m, |m| m.min(border_m));
            prop_assert!(smoothed.shortfall_m.unwrap_or(asked) >= before_m - 1e-8);
        }
        if smoothed.sharp_corners.is_empty() {
            // Between discs of unequal size that overlap there may be a corner.
            let is_smooth = smoothed.path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-4);
            prop_assert!(is_smooth || asked < 1e-6 || asked > planned);
            let path = smoothed.path.flattened(1e-3);
            let groups = groups(&grid);
            prop_assert_eq!(word(&path, &groups), word(&line, &groups), "{:?}", path);
            let without = taut(&line, &map.clearance(), 0.0);
            prop_assert!(without.path.length_m() <= length_m + 1e-9);
        }
    }
}
