//! Defining properties of the taut path, on random maps.

use super::tests::taut;
use super::*;
use crate::geometry::Pose;
use crate::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use crate::plan::shortest_line;
use crate::search::CornerRule;
use proptest::prelude::*;

/// One cell of each group of obstacles that touch, even if only in a corner.
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

/// The sequence in which a line passes the groups: the rays upwards from each group that it
/// crosses, with the direction; crossings there and back again cancel. Two lines with the same
/// ends can be pulled into each other if and only if their words are equal.
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
        // Mostly straight on, so that the walk gets around.
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

/// True if each corner of a line is a lattice point, around which it turns towards a blocked cell.
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

/// The line through given points, as shares of the map's size; a point is used only if the segment
/// to it is clear of obstacles.
fn clear_line(
    clearance: &Clearance<'_>,
    (width, height): (u64, u64),
    places: &[(f64, f64)],
) -> Option<Polyline> {
    let mut points: Vec<Point> = Vec::new();
    for &(x, y) in places {
        let at = Point::new(x * width as f64, y * height as f64);
        let from = points.last().copied().unwrap_or(at);
        if points.len() < 8 && clearance.is_clear(Segment::new(from, at), 0.0) {
            points.push(at);
        }
    }
    (points.len() > 1).then(|| Polyline::new(points))
}

/// No piece has a length of 0, and successive segments are not collinear.
fn check_pieces(path: &Path) -> Result<(), TestCaseError> {
    let has_length = |piece: &PathPiece| piece.length_m() > 0.0;
    prop_assert!(path.pieces().iter().all(has_length) || path.length_m() == 0.0, "{:?}", path);
    for (pair, turn_rad) in path.pieces().windows(2).zip(path.joint_turns_rad()) {
        let is_straight = matches!(pair, [PathPiece::Segment(_), PathPiece::Segment(_)]);
        prop_assert!(!is_straight || turn_rad.abs() > 1e-12, "{:?}", path);
    }
    Ok(())
}

/// The path keeps the required distance, or the line's own distance if that is smaller, from each
/// obstacle corner that is not on the border.
fn check_corners(
    grid: &OccupancyGrid,
    line: &Polyline,
    path: &Path,
    asked_m: f64,
) -> Result<(), TestCaseError> {
    let path = path.flattened(1e-6);
    let (width, height) = (grid.frame().width() as i32, grid.frame().height() as i32);
    let is_inside = |low: &Cell| low.x + 1 < width && low.y + 1 < height;
    for low in grid.frame().cells().filter(is_inside) {
        let around =
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| Cell::new(low.x + dx, low.y + dy));
        let blocked = around.map(|cell| grid.occupied().get(cell));
        let is_between =
            blocked == [true, false, false, true] || blocked == [false, true, true, false];
        if is_between || blocked.iter().filter(|&&is_blocked| is_blocked).count() == 1 {
            let corner = Point::new(f64::from(low.x + 1), f64::from(low.y + 1));
            let distance = |line: &Polyline| {
                line.segments()
                    .map(|s| s.distance_sq_to_point(corner).sqrt())
                    .fold(f64::INFINITY, f64::min)
            };
            let (before_m, after_m) = (distance(line), distance(&path));
            let is_kept = line.points().len() < 2 || after_m >= before_m.min(asked_m) - 3e-6;
            prop_assert!(is_kept, "{before_m} {after_m} {corner:?}");
        }
    }
    Ok(())
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
        // If the walk returns to its start, the whole line may disappear.
        prop_assume!(!path.points().is_empty());
        let groups = groups(&grid);
        prop_assert!(smoothed.sharp_corners.is_empty() && smoothed.kept_clearance_m.is_none());
        prop_assert!(map.clearance().is_clear_path(&smoothed.path, 0.0));
        prop_assert!(path.length_m() <= line.length_m() + 1e-9);
        prop_assert!(is_taut(&path, &map), "{:?}", path);
        prop_assert_eq!(word(&path, &groups), word(&line, &groups), "{:?}", path);
        prop_assert_eq!(&taut(&path, &map.clearance(), 0.0).path, &smoothed.path, "again");
        let back = Polyline::new(line.points().iter().rev().copied().collect());
        let back = taut(&back, &map.clearance(), 0.0);
        prop_assert!((back.path.length_m() - path.length_m()).abs() < 1e-9, "{:?}", back);
        // Compares with an independent search if this class is the best one.
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
        prop_assert_eq!(smoothed.kept_clearance_m.is_none() || !is_kept, true);
        if planned >= asked {
            prop_assert!(is_kept);
            prop_assert!(smoothed.sharp_corners.is_empty(), "{:?}", smoothed);
            check_pieces(&smoothed.path)?;
        } else {
            // The path is no closer to obstacles or to the border than the line.
            let to_border = |&at: &Point| map.clearance().to_border(at);
            let border_m = line.points().iter().map(to_border).fold(asked, f64::min);
            let before_m = map.clearance().of_line(&line).map_or(border_m, |m| m.min(border_m));
            prop_assert!(smoothed.kept_clearance_m.unwrap_or(asked) >= before_m - 1e-8);
        }
        check_corners(&grid, &line, &smoothed.path, asked)?;
        if smoothed.sharp_corners.is_empty() {
            // Overlapping discs of unequal size may leave a corner between them.
            let is_smooth = smoothed.path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-4);
            prop_assert!(is_smooth || asked < 1e-6 || asked > planned);
            let path = smoothed.path.flattened(1e-3);
            let groups = groups(&grid);
            prop_assert_eq!(word(&path, &groups), word(&line, &groups), "{:?}", path);
            let without = taut(&line, &map.clearance(), 0.0);
            prop_assert!(without.path.length_m() <= length_m + 1e-9);
        }
    }

    /// Lines of any direction; up to a share of 1 they keep the required distance.
    #[test]
    fn any_clear_line((size, bits) in grids(0.08), corners in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 2..20),
                      share in prop_oneof![Just(0.0), Just(0.999), 0.0..0.999f64, 1.0..4.0f64]) {
        let grid = random_grid(size, &bits);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let Some(line) = clear_line(&clearance, size, &corners) else { return Ok(()) };
        let border_m = line.points().iter().map(|&at| clearance.to_border(at)).fold(9.0, f64::min);
        let asked_m = share * clearance.of_line(&line).map_or(border_m, |m| m.min(border_m));
        let smoothed = taut(&line, &clearance, asked_m);
        prop_assert!(smoothed.path.length_m() <= line.length_m() + 1e-9);
        check_corners(&grid, &line, &smoothed.path, asked_m)?;
        let groups = groups(&grid);
        let path = smoothed.path.flattened(1e-4);
        prop_assert_eq!(word(&path, &groups), word(&line, &groups), "{:?}", path);
        if share < 1.0 {
            prop_assert!(smoothed.sharp_corners.is_empty() && smoothed.kept_clearance_m.is_none(), "{:?}", smoothed);
            prop_assert!(clearance.is_clear_path(&smoothed.path, asked_m));
            check_pieces(&smoothed.path)?;
            let is_smooth = smoothed.path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-4);
            prop_assert!(is_smooth || asked_m < 1e-6, "{:?}", smoothed);
            let back = Polyline::new(line.points().iter().rev().copied().collect());
            let back_m = taut(&back, &clearance, asked_m).path.length_m();
            prop_assert!((back_m - smoothed.path.length_m()).abs() < 1e-6, "{:?}", smoothed);
        }
    }

    /// A detour there and back along the same path leaves nothing.
    #[test]
    fn a_detour_there_and_back_changes_nothing((size, bits) in grids(0.06), first: usize,
                                               asked in prop_oneof![Just(0.0), 0.0..1.0f64],
                                               steps in prop::collection::vec(0u8..30, 0..80),
                                               detour in prop::collection::vec(0u8..30, 0..80)) {
        let grid = random_grid(size, &bits);
        // More than required: the line touches no disc.
        let map = map_of(&grid, asked + 1e-3);
        let Some(line) = walk(&map, first, &steps) else { return Ok(()) };
        let Some(detour) = walk(&map, first, &detour) else { return Ok(()) };
        let mut points = detour.points().to_vec();
        points.extend(detour.points().iter().rev());
        points.extend(line.points());
        let longer = taut(&Polyline::new(points), &map.clearance(), asked);
        let smoothed = taut(&line, &map.clearance(), asked);
        prop_assert!((longer.path.length_m() - smoothed.path.length_m()).abs() < 1e-6, "{:?}", longer);
        prop_assert!(longer.sharp_corners.is_empty() && longer.kept_clearance_m.is_none());
    }

    /// Points on edges, corners and centres of cells, which rounding moves on a turned map.
    #[test]
    fn what_touches_is_the_same_on_a_turned_map((size, bits) in grids(0.15), yaw in -3.0..3.0f64,
                                                resolution_m in prop_oneof![Just(0.05), 0.1..2.0f64],
                                                corners in prop::collection::vec((0u8..=36, 0u8..=28), 2..20)) {
        let grid = random_grid(size, &bits);
        let halves = |&(x, y): &(u8, u8)| {
            let share = |k: u8, cells: u64| f64::from(k % (2 * cells as u8 + 1)) / (2 * cells) as f64;
            (share(x, size.0), share(y, size.1))
        };
        let places: Vec<(f64, f64)> = corners.iter().map(halves).collect();
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let Some(line) = clear_line(&clearance, size, &places) else { return Ok(()) };
        let frame = GridFrame::new(size.0, size.1, resolution_m, Pose::new(-1.0, 2.0, yaw)).unwrap();
        let turned = Polyline::new(line.points().iter().map(|&at| frame.world_from_grid(at)).collect());
        let path = taut(&line, &clearance, 0.0).path;
        let turned = taut(&turned, &Clearance::new(&frame, grid.occupied()), 0.0).path;
        prop_assert!((turned.length_m() / resolution_m - path.length_m()).abs() < 1e-6, "{:?} {:?}", path, turned);
        prop_assert_eq!(turned.pieces().len(), path.pieces().len(), "{:?} {:?}", path, turned);
    }
}
