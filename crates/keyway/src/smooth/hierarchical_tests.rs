//! Splines by hand, continuity, and corners without space for a bend.

use super::*;
use crate::map::OccupancyGrid;
use proptest::prelude::*;

fn points_of(points: &[[f64; 2]]) -> Vec<Point> {
    points.iter().map(|&p| p.into()).collect()
}

fn empty() -> OccupancyGrid {
    OccupancyGrid::from_ascii(&["........"; 8])
}

fn smooth(grid: &OccupancyGrid, points: &[[f64; 2]], safe_m: f64, control_m: f64) -> Smoothed {
    smooth_with(BendsKeep::SafeDistance, grid, points, safe_m, control_m)
}

fn smooth_with(
    bends_keep: BendsKeep,
    grid: &OccupancyGrid,
    points: &[[f64; 2]],
    safe_distance_m: f64,
    control_distance_m: f64,
) -> Smoothed {
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let config = HierarchicalSmoothingConfig { safe_distance_m, control_distance_m, bends_keep };
    let smoother = HierarchicalSmoothing::new(config).unwrap();
    smoother.smooth(&Polyline::new(points_of(points)).into(), &clearance, 0.0)
}

fn is_near(a: Point, b: [f64; 2]) -> bool {
    a.distance(b.into()) < 1e-12
}

#[test]
fn the_inner_layer_by_hand() {
    // The square from (3, 1) to (4, 2); the path below it is 0.5 m away.
    let grid = OccupancyGrid::from_ascii(&["......", "...#..", "......"]);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let line = Polyline::new(points_of(&[
        [0.5, 1.5],
        [0.5, 0.5],
        [1.5, 0.5],
        [4.5, 0.5],
        [5.5, 1.5],
        [5.5, 2.5],
    ]));
    let kept =
        |safe_m| inner_layer(&line, &clearance, &RequiredClearance::new(&clearance, 0.0, safe_m));
    // (1.5, 0.5) is not a corner. (0.5, 1.5) - (4.5, 0.5) is x + 4 y = 6.5, 0.5 / sqrt(17) = 0.121
    // m from the corner (3, 1). (0.5, 0.5) - (5.5, 1.5) touches it, and the connection to (5.5,
    // 2.5) is blocked. (4.5, 0.5) - (5.5, 2.5): 2 x - y = 8.5, 1.5 / sqrt(5) = 0.671 m from the
    // corner (4, 1).
    assert_eq!(kept(0.5), points_of(&[[0.5, 1.5], [0.5, 0.5], [4.5, 0.5], [5.5, 2.5]]));
    assert_eq!(kept(0.7).len(), 5, "0.5 m is too near, but the next node is always joined");
    for safe_m in [0.1, 0.5, 0.7] {
        let once = Polyline::new(kept(safe_m));
        let required = RequiredClearance::new(&clearance, 0.0, safe_m);
        assert_eq!(
            inner_layer(&once, &clearance, &required),
            once.points(),
            "a second run finds nothing to drop"
        );
    }
    assert_eq!(kept(0.1), points_of(&[[0.5, 1.5], [4.5, 0.5], [5.5, 2.5]]));
    // No safe path leads past the square, so the line only comes back to its start first.
    let line = Polyline::new(points_of(&[[0.5, 0.5], [0.5, 2.5], [0.5, 0.5], [5.5, 0.5]]));
    let required = RequiredClearance::new(&clearance, 0.0, 0.7);
    assert_eq!(inner_layer(&line, &clearance, &required), points_of(&[[0.5, 0.5], [5.5, 0.5]]));
    // The distance that is kept is reported, however small the shortfall.
    let reported_m = smooth(&grid, &[[0.5, 0.5], [5.5, 0.5]], 0.505, 1.0).kept_clearance_m;
    assert!(reported_m.is_some_and(|kept_m| (kept_m - 0.5).abs() < 1e-4), "{reported_m:?}");
}

#[test]
fn a_corner_by_hand() {
    let nodes = points_of(&[[1.0, 1.0], [7.0, 1.0], [7.0, 7.0]]);
    let bends = Bends::new(&nodes, 1.0);
    // Eq. (6), (7): A = (6, 1), B = (7, 2).
    let expected =
        [[1., 1.], [1., 1.], [1., 1.], [6., 1.], [7., 1.], [7., 2.], [7., 7.], [7., 7.], [7., 7.]];
    let control = bends.control_nodes();
    assert!(control.iter().zip(expected).all(|(&node, at)| is_near(node, at)), "{control:?}");
    // Eq. (8) to (10). At u = 0 (1, 4, 1, 0) / 6 of the start, A, corner: x = (1 + 24 + 7) / 6; at
    // u = 1/2 (1, 23, 23, 1) / 48 of the start, A, corner, B: x = (1 + 138 + 161 + 7) / 48,
    // y = (1 + 23 + 23 + 2) / 48; at u = 1 (A + 4 corner + B) / 6 = (41, 7) / 6.
    let [enter, leave] = bend(&control, 0);
    assert!(is_near(enter.at(0.0), [32.0 / 6.0, 1.0]));
    assert!(is_near(enter.at(0.5), [307.0 / 48.0, 49.0 / 48.0]));
    assert!(is_near(enter.at(1.0), [41.0 / 6.0, 7.0 / 6.0]));
    // (corner + 4 B + goal) / 6: y = (1 + 8 + 7) / 6.
    assert!(
        is_near(leave.at(0.0), [41.0 / 6.0, 7.0 / 6.0])
            && is_near(leave.at(1.0), [7.0, 16.0 / 6.0])
    );
    let done = smooth(&empty(), &[[1.0, 1.0], [7.0, 1.0], [7.0, 7.0]], 0.8, 1.0);
    assert_eq!(done.path.pieces().len(), 1, "nothing is in the way of a straight line");
    assert!(bends.path().length_m() < 12.0 && bends.path().length_m() > 11.0);
}

#[test]
fn bends_have_no_heading_jumps() {
    // Two right angles, one of 45 and one of 120 degrees; edges of 4 m and more.
    let nodes = points_of(&[[0., 0.], [6., 0.], [6., 4.], [10., 4.], [14., 8.], [15.55, 2.2]]);
    let path = Bends::new(&nodes, 1.0).path();
    let samples = path.samples(0.01).iter().map(crate::geometry::PathSample::position).collect();
    let jumps = |line: Polyline, degrees: f64| {
        line.turns_rad().iter().filter(|turn| turn.abs() > degrees.to_radians()).count()
    };
    assert_eq!(jumps(Polyline::new(nodes), 5.0), 4);
    assert_eq!(jumps(Polyline::new(samples), 5.0), 0);
}

#[test]
fn the_control_distance_is_at_most_half_an_edge() {
    let nodes = points_of(&[[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [8.0, 1.0]]);
    assert_eq!(Bends::new(&nodes, 1.0).radii, [Ok(0.5), Ok(0.5)]);
    assert_eq!(Bends::new(&nodes, 0.3).radii, [Ok(0.3), Ok(0.3)]);
    // Nothing is rounded if A and B coincide with the corner numerically, and a straight line is
    // not a reversal.
    assert_eq!(Bends::new(&nodes, 1e-17).radii, [Err(WhySharp::TurningRadius); 2]);
    assert_eq!(Bends::new(&points_of(&[[1.0, 1.0], [5.0, 1.0], [9.0, 1.0]]), 1.0).radii, [Ok(1.0)]);
    // B of the first corner and A of the second one are the same point, and the path goes on.
    let path = Bends::new(&nodes, 1.0).path();
    assert!(path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-6));
    assert_eq!(path.pieces().last().map(PathPiece::end), Some(Point::new(8.0, 1.0)));
}

#[test]
fn a_bend_that_comes_too_near_is_halved() {
    // The square (3, 2) - (4, 3); the edges y = 0.5 and x = 5.5 are 1.5 m from its corner (4, 2),
    // nearest at (4, 0.5). The bend begins at x = (0.5 + 4 (5.5 - R) + 5.5) / 6: with R = 2 at
    // 3.33, so at x = 4 it is above the edge and too near; with R = 1 at 4.
    let free = "........";
    let grid = OccupancyGrid::from_ascii(&[free, free, free, free, free, "...#....", free, free]);
    let line = [[0.5, 0.5], [5.5, 0.5], [5.5, 5.5]];
    let done = smooth(&grid, &[line[0], [2.5, 0.5], line[1], line[2]], 1.5, 2.0);
    assert_eq!((done.removed_points, done.inserted_points), (1, 2));
    assert_eq!((done.sharp_corners.len(), done.kept_clearance_m), (0, None));
    assert!(is_near(done.path.pieces()[1].start(), [4.0, 0.5]), "{:?}", done.path);
    // The bend cannot keep more than the edges do, and that is reported.
    let done = smooth(&grid, &line, 1.6, 2.0);
    assert!(is_near(done.path.pieces()[1].start(), [4.0, 0.5]));
    assert!((done.kept_clearance_m.unwrap() - 1.5).abs() < 1e-4, "{:?}", done.kept_clearance_m);
}

/// The bend begins at x = (20 + 5 c - 4 R) / 6 for the corner (c, 20). It is too close to the
/// point (800, 80) if that x is less than 800, except for a few metres, over which it hardly
/// leaves the edge. For c = 972, R has to be 20 m, a 16th of 320 m; for c = 956 that is 13 m too
/// early, and half of it 7 m.
#[test]
fn a_corner_that_needs_less_than_a_16th_stays_sharp() {
    let frame =
        crate::map::GridFrame::new(1000, 840, 1.0, crate::geometry::Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| match (cell.x, cell.y) {
        (799, 80) => crate::map::CellState::Occupied,
        _ => crate::map::CellState::Free,
    });
    let clearance = Clearance::new(&frame, grid.occupied());
    let radii = |c: f64| {
        let nodes = points_of(&[[20.0, 20.0], [c, 20.0], [c, 820.0]]);
        Bends::new(&nodes, 320.0).kept_clear(&clearance, 60.0).radii
    };
    assert_eq!(radii(972.0), [Ok(20.0)]);
    assert_eq!(radii(956.0), [Err(WhySharp::Clearance)]);
}

#[test]
fn a_bend_may_be_as_near_as_either_of_its_edges() {
    // (6, 3) is 1.12 m from (5.5, 2), the point at which the bend with R = 1 m leaves the edge;
    // from there on it is farther away.
    let free = "........";
    let grid = OccupancyGrid::from_ascii(&[free, free, free, free, "......#.", free, free, free]);
    let line = [[0.5, 0.5], [5.5, 0.5], [5.5, 5.5]];
    for (line, first) in [(line, [4.0, 0.5]), ([line[2], line[1], line[0]], [5.5, 2.0])] {
        let done = smooth(&grid, &line, 1.5, 1.0);
        assert!(is_near(done.path.pieces()[1].start(), first), "{:?}", done.path);
    }
}

#[test]
fn a_corner_without_room_stays_sharp() {
    // Everything beyond y = 1 up to x = 5 is a wall: every bend begins before its end, 0.5 m from
    // it.
    let wall = "#####...";
    let grid = OccupancyGrid::from_ascii(&[wall, wall, wall, wall, wall, wall, wall, "........"]);
    let done = smooth(&grid, &[[0.5, 0.5], [5.5, 0.5], [5.5, 5.5]], 0.8, 1.0);
    let sharp = SharpCorner { at: Point::new(5.5, 0.5), why: WhySharp::Clearance };
    assert_eq!(
        (done.sharp_corners, done.inserted_points, done.removed_points),
        (vec![sharp], 0, 0)
    );
    assert_eq!(done.path.length_m(), 10.0);
    assert!((done.kept_clearance_m.unwrap() - 0.5).abs() < 1e-9);
    // It is rounded if bends only keep the clearance, here 0. Its middle is (A + 4 corner + B) / 6
    // = (5.5 - 1/6, 0.5 + 1/6), 1/3 m to the right of and below the wall's corner (5, 1).
    let line = [[0.5, 0.5], [5.5, 0.5], [5.5, 5.5]];
    let done = smooth_with(BendsKeep::Clearance, &grid, &line, 0.8, 1.0);
    assert_eq!((done.sharp_corners.len(), done.inserted_points), (0, 2));
    let kept_m = done.kept_clearance_m.unwrap();
    assert!(kept_m <= 2f64.sqrt() / 3.0 && kept_m > 0.4, "{kept_m}");
}

/// Eq. (6) to (10) give a curvature of 2 sin(t / 2) / (R cos²(t / 2)) in the middle of a turn by t;
/// at most 5 degrees per centimetre, 8.727 / m.
#[test]
fn a_corner_stays_sharp_where_its_bend_would_turn_too_sharply() {
    let why = |points: &[[f64; 2]]| {
        let (nodes, grid) = (points_of(points), empty());
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let bends = Bends::new(&nodes, 1.0).kept_clear(&clearance, 0.0);
        bends.radii[0].err()
    };
    // A right angle: 2.828 / R, so R, half an edge, has to be 0.3241 m.
    assert_eq!(why(&[[1.0, 1.0], [2.0, 1.0], [2.0, 1.66]]), None);
    assert_eq!(why(&[[1.0, 1.0], [2.0, 1.0], [2.0, 1.64]]), Some(WhySharp::TurningRadius));
    // R = 1 m, t = 126 and 128 degrees: 8.65 / m, 9.36 / m.
    let turned = |degrees: f64| {
        let (sine, cosine) = libm::sincos(degrees.to_radians());
        [[1.0, 3.0], [5.0, 3.0], [5.0 + 2.0 * cosine, 3.0 + 2.0 * sine]]
    };
    assert_eq!(why(&turned(126.0)), None);
    assert_eq!(why(&turned(128.0)), Some(WhySharp::TurningRadius));
}

/// With long edges, the curvature peaks beside the middle. For a turn by 120 degrees, R = 1 m and
/// a control node s before A it is 6.93 / m in the middle, but at most 7.44 / m for s = 10 m and
/// 9.48 / m for s = 30 m, evaluated from the quotient of polynomials at 20,000 points.
#[test]
fn long_edges_sharpen_a_bend() {
    let sine = 0.75f64.sqrt();
    for (s, is_within) in [(10.0, true), (30.0, false)] {
        let enter = bend_of([-s - 1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, sine]);
        assert!((enter.curvature_at(1.0) - 6.928).abs() < 1e-3);
        assert_eq!(enter.is_curvature_at_most(MAX_CURVATURE_PER_M), is_within);
        let peak = if is_within { 7.438 } else { 9.484 };
        assert!(enter.is_curvature_at_most(peak + 2e-3));
        assert!(!enter.is_curvature_at_most(peak - 2e-3));
    }
}

/// Control nodes along the x axis, and B after a turn by 120 degrees.
fn bend_of(x: [f64; 4], y: [f64; 4]) -> Cubic {
    let [a, b, c] = [0, 1, 2].map(|i| Point::new(x[i], y[i]));
    Cubic::uniform_b_spline([a, b, c, Point::new(-0.5, y[3])])
}

#[test]
fn a_reversal_stays_sharp() {
    let nodes = points_of(&[[1.0, 1.0], [5.0, 1.0], [3.0, 1.0]]);
    let bends = Bends::new(&nodes, 1.0);
    let sharp = SharpCorner { at: Point::new(5.0, 1.0), why: WhySharp::Reversal };
    assert_eq!(bends.sharp_corners(), [sharp]);
    assert_eq!(bends.control_nodes()[3..6], [nodes[1]; 3]);
    assert_eq!(bends.path().length_m(), 6.0);
}

#[test]
fn next_to_nothing_and_bad_numbers() {
    assert!(smooth(&empty(), &[], 0.8, 1.0).path.pieces().is_empty());
    assert_eq!(smooth(&empty(), &[[1.0, 1.0]], 0.8, 1.0).path.length_m(), 0.0);
    let paper = HierarchicalSmoothingConfig::PAPER;
    assert!(HierarchicalSmoothing::new(paper.clone()).is_ok());
    let config = HierarchicalSmoothingConfig { safe_distance_m: f64::NAN, ..paper.clone() };
    assert_eq!(HierarchicalSmoothing::new(config).unwrap_err().path, "safe_distance_m");
    let config = HierarchicalSmoothingConfig { control_distance_m: 0.0, ..paper };
    assert_eq!(HierarchicalSmoothing::new(config).unwrap_err().path, "control_distance_m");
}

proptest! {
    #[test]
    fn a_second_run_of_the_inner_layer_drops_nothing(occupied in prop::collection::vec(prop::bool::weighted(0.15), 12 * 10),
                                                     corners in prop::collection::vec((0..12u32, 0..10u32), 2..12),
                                                     safe_m in prop_oneof![Just(0.5), 0.0..1.5f64]) {
        let frame = crate::map::GridFrame::new(12, 10, 1.0, crate::geometry::Pose::default()).unwrap();
        let grid = OccupancyGrid::from_occupied(frame, &occupied);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let required = RequiredClearance::new(&clearance, 0.0, safe_m);
        let centre = |&(x, y): &(u32, u32)| Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let line = Polyline::new(corners.iter().map(centre).collect());
        let once = Polyline::new(inner_layer(&line, &clearance, &required)).merged();
        let again = Polyline::new(inner_layer(&once, &clearance, &required)).merged();
        prop_assert_eq!(again, once);
    }

    /// At the joints of the whole spline, straight stretches included.
    #[test]
    fn the_spline_is_c2_and_the_path_lies_on_it(nodes in prop::collection::vec(prop::array::uniform2(-5.0..5.0f64), 2..7),
                                                control_m in 0.1..2.0f64) {
        let nodes = points_of(&nodes);
        let bends = Bends::new(&nodes, control_m);
        let control = bends.control_nodes();
        let spline: Vec<Cubic> = control.windows(4)
            .map(|w| Cubic::uniform_b_spline([w[0], w[1], w[2], w[3]])).collect();
        prop_assert!(spline[0].start == nodes[0]);
        prop_assert!(spline[spline.len() - 1].end().distance(nodes[nodes.len() - 1]) < 1e-12);
        for pair in spline.windows(2) {
            prop_assert!(pair[0].end().distance(pair[1].start) < 1e-9);
            prop_assert!(pair[0].derivative(1.0).distance(pair[1].derivative(0.0)) < 1e-9);
            prop_assert!(pair[0].second_derivative(1.0).distance(pair[1].second_derivative(0.0)) < 1e-9);
        }
        let path = bends.path();
        let length_m: f64 = spline.iter().map(Cubic::length).sum();
        prop_assert!((path.length_m() - length_m).abs() < 1e-6, "{} {length_m}", path.length_m());
        prop_assert!(length_m <= Polyline::new(nodes).length_m() + 1e-9);
        for turn in path.joint_turns_rad() {
            prop_assert!(turn.abs() < 1e-6);
        }
    }
}
