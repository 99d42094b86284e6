use super::*;
use crate::geometry::Pose;
use crate::map::{GridFrame, OccupancyGrid};
use std::f64::consts::FRAC_PI_2;

fn line(points: &[[f64; 2]]) -> Polyline {
    Polyline::new(points.iter().map(|&p| p.into()).collect())
}

pub(super) fn taut(line: &Polyline, clearance: &Clearance<'_>, clearance_m: f64) -> Smoothed {
    Taut.smooth(&line.clone().into(), clearance, clearance_m)
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
    // There and back again.
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
    // The line goes above the obstacle, (2, 1) - (3, 2), although the path below is equally long.
    let above = [[0.5, 1.5], [1.5, 2.5], [3.5, 2.5], [4.5, 1.5]];
    assert_eq!(corners(&rows, &above), [[0.5, 1.5], [2.0, 2.0], [3.0, 2.0], [4.5, 1.5]]);
    let below = above.map(|[x, y]| [x, 3.0 - y]);
    assert_eq!(corners(&rows, &below), [[0.5, 1.5], [2.0, 1.0], [3.0, 1.0], [4.5, 1.5]]);
    // Once around it, and on: the loop is pulled tight and stays.
    let around = [[0.5, 0.5], [3.5, 0.5], [3.5, 2.5], [1.5, 2.5], [1.5, 0.5], [4.5, 0.5]];
    let expected = [[0.5, 0.5], [3.0, 1.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [4.5, 0.5]];
    assert_eq!(corners(&rows, &around), expected);
    // There and back on different sides is a loop around it; on the same side nothing remains.
    let there = [[0.5, 0.5], [3.5, 0.5], [3.5, 2.5], [3.5, 0.5], [0.5, 0.5], [0.5, 2.5]];
    assert_eq!(corners(&rows, &there), [[0.5, 0.5], [0.5, 2.5]]);
}

#[test]
fn a_corner_that_the_line_grazes_on_its_other_side_bends_nothing() {
    // The line x = 3 y - 13 touches the corner (5, 6) of the obstacle below it, and (2, 5) of the
    // one above it. From (9, 7.5) the string passes 0.07 m above (5, 6) and bends only around (2,
    // 5).
    let free = "...........";
    let rows = [free, free, ".#...#.....", free, free, free, free, free];
    let grazing = [[9.0, 7.5], [8.0, 7.0], [0.5, 4.5]];
    assert_eq!(corners(&rows, &grazing), [grazing[0], [2.0, 5.0], grazing[2]]);
}

#[test]
fn through_a_maze() {
    let rows = ["......", ".####.", "....#.", ".##.#.", "....#."];
    // From inside the hook at (2.5, 2.5) around it to its outside (5.5, 2.5). The string cannot go
    // over the top: the line leaves the hook at the left and goes over (1, 4) and (5, 4).
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
    assert_eq!(smoothed.kept_clearance_m, None);
    assert!(smoothed.path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-6));
    assert!(smoothed.sharp_corners.is_empty());
}

#[test]
fn bends_also_where_the_border_is_nearer_than_the_clearance() {
    // The line is 0.5 m from the map's border, which nothing can be pulled away from, and 0.7 m is
    // required. Around the corner (3, 2) the clearance is kept; the distance to the border is
    // reported.
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
            let reported_cells = smoothed.kept_clearance_m.map(|kept_m| kept_m / resolution_m);
            assert!(reported_cells.is_some_and(|kept| (kept - 0.5).abs() < 1e-9), "{smoothed:?}");
            assert_eq!(smoothed.path.pieces().len(), 3, "two tangents and an arc: {smoothed:?}");
        }
    }
}

#[test]
fn a_line_that_comes_back_unwinds_the_disc() {
    // Up and left around the corner (1, 2), and back to below it: a straight line remains. The
    // legs touch the disc on the return.
    let rows = ["....", "....", "#...", "#..."];
    for r in [0.01, 0.1, 0.25, 0.5] {
        let (x, y) = (1.0 + r, 2.0 + r);
        let line = [[x, 0.5], [x, y], [0.5, y], [x, y], [x, 0.5], [3.5, 0.5]];
        let length_m = |points: &[[f64; 2]]| pulled_on(&rows, points, r).path.length_m();
        assert!((length_m(&line) - (3.5 - x)).abs() < 1e-9, "{r}");
        assert!((length_m(&line[..4]) - (y - 0.5)).abs() < 1e-9, "{r}");
    }
    // Along the edges of a square, and in free space: a line there and back leaves nothing.
    let along = [[1.5, 2.5], [3.5, 2.5], [3.5, 1.5], [3.5, 2.5], [1.5, 2.5]];
    let slanted = [[0.149, 0.761], [2.192, 0.584], [0.149, 0.761]];
    for (line, clearance_m) in [(&along[..], 0.5), (&slanted[..], 0.0)] {
        let done = pulled_on(&["....", "..#.", "...."], line, clearance_m);
        assert!(done.path.length_m() < 1e-9 && done.sharp_corners.is_empty(), "{done:?}");
    }
    // Through the corner (2, 2), around (2, 1) and back: at the largest possible distance from
    // both, nothing remains.
    let line = [[1.0, 3.0], [3.0, 1.0], [1.0, 0.0], [3.0, 1.0]];
    let done = pulled_on(&["....", ".#..", "...."], &line, 1.0);
    assert!((done.path.length_m() - 8f64.sqrt()).abs() < 1e-9, "{done:?}");
}

#[test]
fn where_the_line_is_too_near_its_own_distance_is_kept() {
    // The line passes (1, 2) at 0.5 m on both sides of the corner; 0.8 m is required.
    let rows = ["....", "....", "#...", "#..."];
    let smoothed = pulled_on(&rows, &[[1.5, 0.5], [1.5, 2.5], [0.5, 2.5]], 0.8);
    assert!((smoothed.kept_clearance_m.unwrap() - 0.5).abs() < 1e-6, "{smoothed:?}");
    assert!((smoothed.path.length_m() - 2.0 - FRAC_PI_2 * 0.5).abs() < 1e-6);
    // At 1.5 m, far to the right of the corner.
    let rows = ["......", "......", "......", "......", "#.....", "#....."];
    let smoothed = pulled_on(&rows, &[[2.5, 0.5], [2.5, 3.5], [0.5, 3.5]], 2.0);
    assert!((smoothed.path.length_m() - 2.0 - FRAC_PI_2 * 1.5).abs() < 1e-6, "{smoothed:?}");
    // From (6, 2) a quarter of a circle around the corner (5, 2), and on along the lower edge.
    let rows = ["........", "....#...", "........"];
    let smoothed = pulled_on(&rows, &[[6.0, 2.0], [7.0, 1.0], [2.0, 1.0]], 1.4);
    assert!((smoothed.path.length_m() - 3.0 - FRAC_PI_2).abs() < 1e-4, "{smoothed:?}");
}

#[test]
fn what_is_in_collision_stays() {
    let rows = ["..#..", ".#...", "....."];
    // Between the two squares at (2, 2), a point that no clear line can pass.
    let slip = [[0.5, 0.5], [0.5, 2.5], [1.5, 2.5], [2.5, 1.5], [4.5, 1.5], [4.5, 0.5]];
    let path = corners(&rows, &slip);
    assert_eq!(path, [[0.5, 0.5], [1.0, 2.0], [1.5, 2.5], [2.5, 1.5], [4.5, 0.5]]);
    // An arc, a segment through the square, and from its end there and back, which leaves no
    // piece.
    let rows = ["....", ".#..", "...."];
    let line = [[2.5, 2.5], [2.5, 0.5], [1.5, 0.5], [2.5, 2.5], [2.5, 1.5], [2.5, 2.5]];
    let path = pulled_on(&rows, &line, 1.0).path;
    assert!(path.pieces().iter().any(|piece| matches!(piece, PathPiece::Arc(_))));
    assert!(path.pieces().iter().all(|piece| piece.length_m() > 0.0), "{path:?}");
}

#[test]
fn nothing_is_asked_for_by_numbers_that_are_no_distance() {
    let rows = [".....", "..#..", "....."];
    let above = [[0.5, 1.5], [1.5, 2.5], [3.5, 2.5], [4.5, 1.5]];
    for asked_m in [-1.0, f64::NEG_INFINITY, f64::NAN] {
        assert_eq!(pulled_on(&rows, &above, asked_m), pulled_on(&rows, &above, 0.0));
    }
}

#[test]
fn points_are_counted() {
    let counts = |rows: &[&str], points: &[[f64; 2]], clearance_m| {
        let done = pulled_on(rows, points, clearance_m);
        (done.removed_points, done.inserted_points)
    };
    // (2.5, 0.5) is not a corner of the line.
    assert_eq!(counts(&["...."], &[[0.5, 0.5], [2.5, 0.5], [3.5, 0.5]], 0.0), (0, 0));
    let rows = [".....", "..#..", "....."];
    let above = [[0.5, 1.5], [1.5, 2.5], [2.5, 2.5], [3.5, 2.5], [4.5, 1.5]];
    assert_eq!(counts(&rows, &above, 0.0), (2, 2));
    // The three corners below are gone; the two above them stay in place.
    let both = [[0.5, 1.5], [2.0, 2.0], [2.5, 2.5], [3.0, 2.0], [4.5, 1.5]];
    assert_eq!(counts(&rows, &both, 0.0), (1, 0));
    // Both ends of an arc.
    let rows = ["....", "....", "#...", "#..."];
    assert_eq!(counts(&rows, &[[1.5, 0.5], [1.5, 2.5], [0.5, 2.5]], 0.5), (1, 2));
}

#[test]
fn a_slight_bend_is_an_arc_too() {
    // Around the corner (1, 2) at 0.5 m: up to (1.5, 2), to the left by the angle, and 1 m on.
    let rows = ["......", "......", "......", "#.....", "#....."];
    for angle_rad in [4e-5, 1e-3, 0.1] {
        let (sin, cos) = libm::sincos(angle_rad);
        let goal = [1.0 + 0.5 * cos - sin, 2.0 + 0.5 * sin + cos];
        let path = pulled_on(&rows, &[[1.5, 0.5], [1.9, 2.2], goal], 0.5).path;
        let [_, PathPiece::Arc(arc), _] = path.pieces() else { panic!("{path:?}") };
        assert!((arc.sweep_rad - angle_rad).abs() < 1e-9, "{arc:?}");
    }
}

#[test]
fn a_disc_that_is_entered_by_a_hair_bends_the_path() {
    // The straight line between both ends passes the corner (1, 2) at less than 0.5 m, by less
    // than a micrometre, at right angles to the diagonal.
    let rows = ["......", "......", "......", "#.....", "#....."];
    let diagonal = Point::new(0.5f64.sqrt(), 0.5f64.sqrt());
    let at = |far: f64, along: f64| {
        let place =
            Point::new(1.0, 2.0) + diagonal * far + Point::new(-diagonal.y, diagonal.x) * along;
        [place.x, place.y]
    };
    for inside in [1e-8, 3e-7] {
        let far = 0.5 - inside;
        let done = pulled_on(&rows, &[at(far, -1.0), at(1.2, 0.0), at(far, 1.0)], 0.5);
        assert_eq!((done.path.pieces().len(), done.kept_clearance_m), (3, None), "{done:?}");
    }
}

#[test]
fn what_is_only_touched_is_no_corner() {
    // Down the left edges of two squares, which the line touches, and to the left around (3, 1) at
    // 0.5 m: between them the path is straight.
    let rows = ["....", ".#..", "....", "...."];
    let line = [[1.0, 3.5], [1.0, 0.5], [3.5, 0.5], [3.5, 2.5]];
    let done = pulled_on(&rows, &line, 0.5);
    let turns = done.path.joint_turns_rad();
    let straight = done.path.pieces().windows(2).zip(turns).filter(|(pair, turn)| {
        matches!(pair, [PathPiece::Segment(_), PathPiece::Segment(_)]) && turn.abs() < 1e-6
    });
    assert_eq!(straight.count(), 0, "{done:?}");
}

#[test]
fn the_least_distance_of_the_line_is_kept_around_a_corner() {
    // The line passes (1, 2) at 0.25 m, and later at 0.35 m; the smaller distance counts. Straight
    // up to (1.25, 2), around to the point at which the tangent to (0.5, 3) leaves, and on.
    let rows = ["....", "....", "#...", "#..."];
    let line = [[1.25, 0.5], [1.25, 2.25], [0.5, 3.0]];
    let to_goal = 1.25f64.sqrt();
    let arc_rad = FRAC_PI_2 + 0.5f64.atan() - (0.25 / to_goal).acos();
    let expected = 1.5 + 0.25 * arc_rad + (1.25f64 - 0.0625).sqrt();
    let done = pulled_on(&rows, &line, 1.0);
    assert!((done.path.length_m() - expected).abs() < 1e-6, "{expected}: {done:?}");
    // At (4, 3) the line is 0.5 m away, at (4, 2) 1 m: 60 degrees around the first, 30 around the
    // second.
    let rows = ["......", "....#.", "......", "......"];
    let done = pulled_on(&rows, &[[5.5, 3.5], [3.0, 3.5], [3.0, 1.0]], 1.3);
    let third = std::f64::consts::FRAC_PI_3;
    let expected = 1.5 + 0.5 * third + 0.75f64.sqrt() + 0.5 * third + 1.0;
    assert!((done.path.length_m() - expected).abs() < 1e-6, "{expected}: {done:?}");
    assert_eq!(done.path.pieces().len(), 5, "{done:?}");
    // Along an upper edge from (2, 4) to (1, 4), a quarter of a circle of 1 m around (1, 3),
    // straight down.
    let rows = ["...", "...", "...", ".#.", "...", "...", "..."];
    let done = pulled_on(&rows, &[[2.0, 4.0], [0.0, 4.0], [0.0, 1.0]], 1.8);
    assert!((done.path.length_m() - 3.0 - FRAC_PI_2).abs() < 1e-4, "{done:?}");
    // Both ends are at the line's least distance from (1, 2), sqrt(1/2): a quarter of a circle.
    let rows = ["...", "...", "...", "...", ".#.", "..."];
    let done = pulled_on(&rows, &[[0.5, 2.5], [2.5, 4.5], [1.5, 2.5]], 1.5);
    assert!((done.path.length_m() - 0.5f64.sqrt() * FRAC_PI_2).abs() < 1e-4, "{done:?}");
}

#[test]
fn an_end_that_slides_along_an_obstacle() {
    // Along its upper edge from beyond its corner (2, 1), which stays on the other side.
    let rows = ["....", "....", ".#.."];
    let line = [[2.5, 2.5], [2.5, 1.0], [1.5, 1.0]];
    assert_eq!(corners(&rows, &line), [line[0], line[2]]);
    // Along its lower edge, and on down from there.
    let rows = ["........", "......#.", "........"];
    let line = [[2.0, 1.0], [7.0, 1.0], [7.0, 0.0]];
    assert_eq!(corners(&rows, &line), [line[0], line[2]]);
    // The end comes back through the corner (2, 2), which the string was bent around until then.
    let rows = ["..#.", "....", "...."];
    let line = [[1.5, 2.5], [0.5, 0.5], [3.5, 1.5], [0.5, 2.5]];
    assert_eq!(corners(&rows, &line), [line[0], line[3]]);
    // Nothing remains of a corner that was left, whatever comes after it.
    let rows = ["....", ".#..", "...."];
    let line = [[0.5, 0.5], [2.5, 0.5], [2.5, 1.5], [1.5, 0.5], [3.5, 0.2]];
    assert_eq!(corners(&rows, &line), [line[0], line[4]]);
    assert!((pulled_on(&rows, &line[..4], 1.0).path.length_m() - 1.0).abs() < 1e-9);
    // To a point on the edge, and back from it: (0, 2) is to the left of the initial line from (1,
    // 4).
    let rows = ["...", ".#.", "...", "..."];
    assert_eq!(
        corners(&rows, &[[1.0, 4.0], [0.0, 2.0], [3.0, 2.0], [0.0, 2.0]]),
        [[1.0, 4.0], [0.0, 2.0]]
    );
}

#[test]
fn bends_around_a_corner_on_turned_maps() {
    // At x = 3 the straight line would be 0.25 cells inside the square from (2, 4) to (3, 5).
    let rows = ["....", "..#.", "....", "....", "....", "...."];
    let grid = OccupancyGrid::from_ascii(&rows);
    let line = [[3.5, 4.5], [2.5, 5.5], [1.5, 5.5]].map(Point::from);
    for turn in 0..300 {
        let yaw = 0.021 * f64::from(turn);
        let frame = GridFrame::new(4, 6, 0.3, Pose::new(0.0, 0.0, yaw)).unwrap();
        let world = Polyline::new(line.map(|at| frame.world_from_grid(at)).to_vec());
        let done = taut(&world, &Clearance::new(&frame, grid.occupied()), 0.0);
        let expected_m = 0.3 * (0.5f64.sqrt() + 2.5f64.sqrt());
        assert!((done.path.length_m() - expected_m).abs() < 1e-9, "{yaw}: {done:?}");
    }
}

#[test]
fn what_touches_and_what_is_in_collision_is_not_reported_as_sharp() {
    let touching =
        pulled_on(&["....", "...#", "...."], &[[3.25, 1.0], [3.75, 0.0], [3.5, 1.0]], 1.0);
    assert!((touching.path.length_m() - 0.25).abs() < 1e-9, "{touching:?}");
    let through = [[2.5, 2.5], [1.0, 1.3], [2.5, 0.5]];
    let done = pulled_on(&["...", ".#.", "..."], &through, 0.5);
    assert_eq!((done.path, done.sharp_corners.len()), (Path::from(&line(&through)), 0));
}

/// The effect of rounding on a path cannot be predicted, so the path is made by hand here.
#[test]
fn a_path_that_is_not_as_good_as_the_line_is_refused() {
    // The line is 0.8 m below the square from (2, 1) to (3, 2).
    let grid = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let way = |y: f64| [[0.5, 0.5], [0.5, y], [4.5, y], [4.5, 0.5]];
    let judge = |before: &[[f64; 2]], after: &[[f64; 2]], asked_m| {
        let required = RequiredClearance::new(&clearance, asked_m, 0.0);
        let smoothed = Smoothed::straight(&line(before), &line(after), &required);
        is_as_good(&smoothed, &line(before), &clearance, &required)
    };
    let before = way(0.2);
    assert!(judge(&before, &before, 1.0) && judge(&before, &way(0.5), 0.5));
    assert!(!judge(&before, &way(0.2005), 1.0), "nearer than the line and than what is asked for");
    assert!(judge(&before, &way(0.2 + 1e-8), 1.0) && judge(&before, &way(0.3), 0.7 + 1e-8));
    assert!(!judge(&before, &way(0.1995), 0.1) && judge(&before, &way(0.2 - 5e-9), 0.1), "longer");
    assert!(!judge(&before, &[[0.5, 0.5], [4.4, 0.5]], 0.1), "another end");
    // Along the lower edge, and through the square instead.
    let along = [[1.5, 1.5], [1.5, 1.0], [3.5, 1.0], [3.5, 1.5]];
    assert!(judge(&along, &along, 0.5) && !judge(&along, &[along[0], along[3]], 0.5));
    let required = RequiredClearance::new(&clearance, 0.5, 0.0);
    let stays = untouched(&line(&before), &required);
    assert_eq!(stays.path, Path::from(&line(&before)));
    let sharp =
        [before[1], before[2]].map(|at| SharpCorner { at: at.into(), why: WhySharp::Clearance });
    assert_eq!(stays.sharp_corners, sharp);
    assert!((0..3).all(|k| untouched(&line(&before[..k]), &required).sharp_corners.is_empty()));
}

/// Rounding defeats the string if a line passes two corners at the same distance there and back.
#[test]
fn where_rounding_defeats_the_string_the_path_is_as_good_as_the_line() {
    let rows = ["......", "......", "......", "..#...", "......", "......", "......", "......"];
    let there_and_back = [[1.5, 1.5], [1.5, 7.5], [3.5, 5.5], [2.5, 5.5], [1.5, 7.5], [1.5, 1.5]];
    let done = pulled_on(&rows, &there_and_back, 0.574_264_274_202_788_1);
    assert!(done.path.length_m() <= line(&there_and_back).length_m() + 1e-9);
    assert!(done.kept_clearance_m.is_none_or(|kept_m| kept_m > 0.5 - 1e-6), "{done:?}");
}
