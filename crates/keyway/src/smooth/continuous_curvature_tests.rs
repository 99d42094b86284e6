use super::*;
use crate::geometry::{Polyline, Pose};
use crate::map::formats::map_from_bytes;
use crate::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use crate::plan::{Plan, PlannerConfig};
use crate::search::{Query, Workspace};
use proptest::prelude::*;
use std::path::Path as FilePath;

fn polyline(points: &[[f64; 2]]) -> Polyline {
    Polyline::new(points.iter().map(|&p| p.into()).collect())
}

fn continuous_curvature(
    line: &Polyline,
    clearance: &Clearance<'_>,
    clearance_m: f64,
    config: &ContinuousCurvatureConfig,
) -> Smoothed {
    let smoother = ContinuousCurvature::new(config.clone()).unwrap();
    smoother.smooth(&line.clone().into(), clearance, clearance_m)
}

fn smoothed(rows: &[&str], points: &[[f64; 2]], clearance_m: f64, radius_m: f64) -> Smoothed {
    let grid = OccupancyGrid::from_ascii(rows);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let config = ContinuousCurvatureConfig { min_turning_radius_m: radius_m };
    let line = polyline(points);
    let done = continuous_curvature(&line, &clearance, clearance_m, &config);
    check(&line, &done, &clearance, clearance_m, radius_m);
    done
}

/// Invariants for every line and map.
fn check(
    line: &Polyline,
    done: &Smoothed,
    clearance: &Clearance<'_>,
    clearance_m: f64,
    radius_m: f64,
) {
    let ends = |points: &[Point]| (points.first().copied(), points.last().copied());
    let pieces = done.path.pieces();
    let path_ends = (pieces.first().map(PathPiece::start), pieces.last().map(PathPiece::end));
    assert_eq!(path_ends, ends(line.points()), "start and goal");
    assert!(done.path.length_m() <= line.length_m() + 1e-9, "longer");

    // Clearance, by bounds that another function certifies.
    let clear = line.segments().all(|edge| clearance.is_clear(edge, clearance_m))
        && line.points().iter().all(|&point| clearance.is_clear_point(point, clearance_m));
    assert!(!clear || clearance.is_clear_path(&done.path, clearance_m), "too near");
    assert!(!clear || done.kept_clearance_m.is_none());
    let kept = clearance.of_path(&done.path, 1e-6).map(|bounds| bounds.at_most_m);
    if let (Some(kept_m), Some(before_m)) = (kept, clearance.of_line(line)) {
        assert!(kept_m >= before_m.min(clearance_m) - 1e-5, "{kept_m} after {before_m}");
    }

    // Heading and curvature jump only at the corners that are reported.
    let is_reported =
        |at: Point| done.sharp_corners.iter().any(|corner| corner.at.distance(at) < 1e-9);
    let samples = done.path.samples_of_pieces(0.02);
    for pair in samples.windows(2).filter(|pair| pair[0].s_m == pair[1].s_m) {
        let [before, after] = [pair[0], pair[1]];
        let turn_rad = crate::geometry::wrap_angle(after.heading_rad - before.heading_rad).abs();
        assert!(turn_rad < 1e-6 || is_reported(before.position()), "{turn_rad} rad at {before:?}");
        let jump = (after.curvature_per_m - before.curvature_per_m).abs();
        let scale = 1.0 + before.curvature_per_m.abs();
        assert!(jump < 1e-6 * scale || is_reported(before.position()), "{jump} 1/m at {before:?}");
    }
    let largest = samples.iter().map(|s| s.curvature_per_m.abs()).fold(0.0, f64::max);
    assert!(largest * radius_m <= 1.0 + 1e-9, "{largest} 1/m, radius {radius_m}");
}

const FIELD: [&str; 4] = ["........"; 4];

#[test]
fn a_right_angle_takes_both_edges() {
    let done = smoothed(&FIELD, &[[1.0, 1.0], [5.0, 1.0], [5.0, 3.5]], 0.0, 0.0);
    assert_eq!(done.path.pieces().len(), 1, "nothing stands: {done:?}");

    // The block is in the straight path. Its corner (4, 2) is sqrt(2) from the line's corner, on
    // the bisector, where the curve is nearest to it: at cut (289/640) / sqrt(2) from the line's
    // corner, for the longest cut of 0.999 * 2.5 m.
    let rows = ["####....", "####....", "........", "........"];
    // (2, 1) is not a corner, so it does not count as removed.
    let done = smoothed(&rows, &[[1.0, 1.0], [2.0, 1.0], [5.0, 1.0], [5.0, 3.5]], 0.1, 0.0);
    assert!(done.sharp_corners.is_empty());
    let cut_m = 0.999 * 2.5;
    let PathPiece::Cubic(first) = done.path.pieces()[1] else { panic!("{done:?}") };
    assert!((first.start.x - (5.0 - cut_m)).abs() < 1e-12);
    let middle = Point::new(5.0, 1.0) + Point::new(-1.0, 1.0) * (0.5 * cut_m * 289.0 / 640.0);
    assert!(first.end().distance(middle) < 1e-12);
    assert_eq!((done.removed_points, done.inserted_points), (1, 7));
}

#[test]
fn a_cut_stops_at_the_clearance() {
    // The bisector of the corner (5, 1) meets the block at (4, 2), sqrt(2) away, so the curve's
    // middle is at most sqrt(2) - 0.99 from the corner: cut at most (sqrt(2) - 0.99) sqrt(2) 640 /
    // 289 = 1.329 m. It is less, because the curve is nearer to (4, 2) on both sides of the
    // middle.
    let rows = ["####....", "####....", "####....", "####....", "........", "........"];
    let line = [[1.0, 1.0], [5.0, 1.0], [5.0, 3.5]];
    let done = smoothed(&rows, &line, 0.99, 0.0);
    let PathPiece::Cubic(first) = done.path.pieces()[1] else { panic!("{done:?}") };
    let cut_m = 5.0 - first.start.x;
    let expected_m = (2f64.sqrt() - 0.99) * 2f64.sqrt() * 640.0 / 289.0;
    assert!(cut_m <= expected_m && cut_m > 0.9 * expected_m, "{cut_m} {expected_m}");
    // Its peak is 442 sqrt(2) / 250563 * 640 / cut = 1.597 / cut: a radius of at most 0.832 m.
    let why = |radius_m| smoothed(&rows, &line, 0.99, radius_m).sharp_corners;
    assert_eq!(why(0.77), []);
    let at = Point::new(5.0, 1.0);
    assert_eq!(why(0.84), [SharpCorner { at, why: WhySharp::TurningRadius }]);
    // Around the corner of the block without any clearance.
    let touching = smoothed(&rows, &[[1.0, 1.0], [4.0, 2.0], [5.0, 4.5]], 0.0, 0.0);
    let at = Point::new(4.0, 2.0);
    assert_eq!(touching.sharp_corners, [SharpCorner { at, why: WhySharp::Clearance }]);
}

#[test]
fn a_line_that_just_keeps_the_clearance_is_rounded() {
    // The walls, and the map's border, are exactly 0.5 m from both edges. The corner itself is
    // 0.707 m from the inner wall, which leaves space for a radius of at most (0.707 - 0.5) /
    // 0.5098 = 0.406 m.
    let rows = ["######.", "######.", "######.", "......."];
    let line = [[0.5, 0.5], [6.5, 0.5], [6.5, 3.5]];
    assert_eq!(smoothed(&rows, &line, 0.5, 0.3).sharp_corners, []);
    assert_eq!(smoothed(&rows, &line, 0.5, 0.41).sharp_corners.len(), 1);
}

#[test]
fn two_corners_share_an_edge() {
    // The walls leave a Z, whose middle edge is 2 m long: a radius of 2.5 m is too much.
    let rows = ["########", "###.....", "###.###.", "......##", "########"];
    let line = [[0.5, 1.5], [3.5, 1.5], [3.5, 3.5], [7.5, 3.5]];
    assert_eq!(smoothed(&rows, &line, 0.3, 0.1).sharp_corners, []);
    let whys: Vec<WhySharp> =
        smoothed(&rows, &line, 0.3, 2.5).sharp_corners.iter().map(|corner| corner.why).collect();
    assert_eq!(whys, [WhySharp::TurningRadius; 2]);
}

/// The cuts of corners that only edges and turning radius limit.
fn cuts_m(points: &[[f64; 2]], radius_m: f64) -> Vec<f64> {
    let grid = OccupancyGrid::from_ascii(&FIELD);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let config = ContinuousCurvatureConfig { min_turning_radius_m: radius_m };
    Rounding::of(polyline(points).points(), &clearance, 0.0, &config).cuts_m()
}

#[test]
fn edges_are_shared_by_hand() {
    let near = |cuts_m: &[f64], expected_m: &[f64]| {
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        let is_same = cuts_m.iter().zip(expected_m).all(is_near);
        assert!(cuts_m.len() == expected_m.len() && is_same, "{cuts_m:?} {expected_m:?}");
    };
    // Edges of 3.5, 4 and 2.4 m: each corner gets half of the edge between them, regardless of the
    // length of the other edges.
    let z = [[1.0, 0.0], [1.0, 3.5], [5.0, 3.5], [5.0, 1.1]];
    near(&cuts_m(&z, 0.0), &[0.0, 0.999 * 2.0, 0.999 * 2.0, 0.0]);
    // 0.5, 4, 2.9 m: the second corner takes the length that the first one cannot use, and vice
    // versa.
    let uneven = [[1.0, 0.5], [1.0, 1.0], [5.0, 1.0], [5.0, 3.9]];
    near(&cuts_m(&uneven, 0.0), &[0.0, 0.999 * 0.5, 0.999 * 2.9, 0.0]);
    let back = [uneven[3], uneven[2], uneven[1], uneven[0]];
    near(&cuts_m(&back, 0.0), &[0.0, 0.999 * 2.9, 0.999 * 0.5, 0.0]);
    // Right angles with a radius of 1.3 m need 1.597 * 1.3 = 2.08 m, more than half of 4 m. The
    // first corner has no space at all, so the second one gets all that its other edge allows.
    near(&cuts_m(&uneven, 1.3), &[0.0, 0.0, 0.999 * 2.9, 0.0]);
}

#[test]
fn the_turning_radius_comes_first_when_an_edge_is_shared() {
    // A right angle, and a turn by 30 degrees after it, with a radius of 2 m: 3.193 m and 0.626 m.
    let (sin, cos) = libm::sincos(30f64.to_radians());
    let line = |edge_m: f64| {
        let joint = [0.5 + edge_m, 4.0];
        [[0.5, 0.0], [0.5, 4.0], joint, [joint[0] + 3.0 * cos, joint[1] - 3.0 * sin]]
    };
    let least_m = |corner: usize, edge_m: f64| {
        let points = line(edge_m).map(Point::from);
        Corner::new([points[corner - 1], points[corner], points[corner + 1]]).cut_for_radius(2.0)
    };
    // 0.999 * 4 m is 0.177 m more than both need: each gets half of that.
    let half_m = 0.5 * (0.999 * 4.0 - least_m(1, 4.0) - least_m(2, 4.0));
    assert!((half_m - 0.0885).abs() < 1e-3);
    let cuts_m_of_4 = cuts_m(&line(4.0), 2.0);
    assert!((cuts_m_of_4[1] - least_m(1, 4.0) - half_m).abs() < 1e-9, "{cuts_m_of_4:?}");
    assert!((cuts_m_of_4[2] - least_m(2, 4.0) - half_m).abs() < 1e-9, "{cuts_m_of_4:?}");
    // 3.6 m is too short for both: half of it is enough for the second one, which then takes as
    // much as its other edge allows.
    let cuts_m_of_36 = cuts_m(&line(3.6), 2.0);
    assert_eq!(cuts_m_of_36[1], 0.0);
    assert!((cuts_m_of_36[2] - 0.999 * 3.0).abs() < 1e-9, "{cuts_m_of_36:?}");
}

#[test]
fn a_line_that_is_too_near_is_rounded_where_the_curve_is_no_nearer() {
    // 0.5 m above an obstacle, or at first 0.5 m and then farther. The block 1.5 m from both edges
    // keeps line of sight from cutting the corner. The curve rises from the edge as soon as it
    // begins.
    for below in ["...#....", ".#......"] {
        let block = "####....";
        let rows = [block, block, block, "........", "........", below];
        let line = [[1.0, 1.5], [5.5, 1.5], [5.5, 4.5]];
        let back = [line[2], line[1], line[0]];
        for (line, joint) in [(line, 1), (back, 1)] {
            let done = smoothed(&rows, &line, 0.8, 0.0);
            assert_eq!(done.sharp_corners, []);
            let PathPiece::Cubic(first) = done.path.pieces()[joint] else { panic!("{done:?}") };
            let cut_m = first.start.distance(Point::new(5.5, 1.5));
            assert!((cut_m - 0.999 * 3.0).abs() < 1e-9, "all of the shorter edge: {cut_m}");
        }
    }
}

/// The corner of the line is (d, -d) from that of a block, d in cells: the middle of a curve of cut
/// c, on the bisector, is 289/640 c / sqrt(2) from it, so c is at most sqrt(2) d * sqrt(2) *
/// 640/289 = 4.43 d.
#[test]
fn no_cut_is_shorter_than_a_hundredth_of_a_cell() {
    for resolution_m in [0.05, 1.0, 20.0] {
        let frame = GridFrame::new(8, 4, resolution_m, Pose::default()).unwrap();
        let grid = OccupancyGrid::from_fn(frame, |cell| {
            let is_block = cell.x < 4 && cell.y > 1;
            if is_block { CellState::Occupied } else { CellState::Free }
        });
        let clearance = Clearance::new(&frame, grid.occupied());
        let sharp = |d: f64| {
            let line = [[1.0, 2.0 - d], [4.0 + d, 2.0 - d], [4.0 + d, 3.9]];
            let line = line.map(|at| frame.world_from_grid(at.into()));
            let config = ContinuousCurvatureConfig::default();
            let line = Polyline::new(line.to_vec());
            let done = continuous_curvature(&line, &clearance, 0.0, &config);
            done.sharp_corners.iter().map(|corner| corner.why).collect::<Vec<_>>()
        };
        assert_eq!(sharp(0.004), []);
        assert_eq!(sharp(0.002), [WhySharp::Clearance]);
    }
}

#[test]
fn degenerate_lines() {
    let path = |points: &[[f64; 2]]| smoothed(&FIELD, points, 0.1, 0.2);
    assert_eq!(path(&[]), Smoothed::default());
    assert_eq!(path(&[[1.0, 1.0]]).path.length_m(), 0.0);
    assert_eq!(path(&[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]).path.length_m(), 0.0);
    assert_eq!(path(&[[1.0, 1.0], [2.0, 1.0]]).path.length_m(), 1.0);
    let nan = polyline(&[[1.0, 1.0], [f64::NAN, 2.0], [2.0, 1.0]]);
    let grid = OccupancyGrid::from_ascii(&FIELD);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let done = continuous_curvature(&nan, &clearance, 0.1, &ContinuousCurvatureConfig::default());
    assert_eq!(done.path, Path::from(&polyline(&[[1.0, 1.0], [2.0, 1.0]])));
}

#[test]
fn corners_that_are_hardly_any_and_reversals() {
    // A clearance that no line keeps disables line of sight.
    let corners = |points: &[[f64; 2]]| smoothed(&FIELD, points, 9.0, 0.2).sharp_corners;
    let whys = |points: &[[f64; 2]]| corners(points).iter().map(|c| c.why).collect::<Vec<_>>();
    assert_eq!(whys(&[[1.0, 2.0], [5.0, 2.0], [2.0, 2.0]]), [WhySharp::Reversal]);
    assert_eq!(whys(&[[1.0, 2.0], [5.0, 2.0], [2.0, 2.01]]), [WhySharp::Reversal]);
    let any_radius = smoothed(&FIELD, &[[1.0, 2.0], [5.0, 2.0], [2.0, 2.0]], 9.0, 0.0);
    assert_eq!(any_radius.sharp_corners.len(), 1, "not even without a turning limit");
    assert_eq!(whys(&[[1.0, 2.0], [5.0, 2.0], [2.0, 2.3]]), [WhySharp::TurningRadius]);
    assert_eq!(
        whys(&[[1.0, 2.0], [5.0, 2.0], [5.0, 2.001], [7.0, 3.0]]),
        [WhySharp::TurningRadius; 2]
    );
    assert_eq!(whys(&[[1.0, 2.0], [5.0, 2.0], [5.0 + 1e-200, 2.0], [7.0, 3.0]]).len(), 0);
    for turn in [1e-3, 1e-6, 1e-8, 1e-10] {
        assert_eq!(corners(&[[1.0, 2.0], [4.0, 2.0], [7.0, 2.0 + turn]]), [], "{turn}");
    }
}

#[test]
fn radii_are_checked_and_derived() {
    let radius = |min_turning_radius_m| ContinuousCurvatureConfig { min_turning_radius_m };
    for good in [0.0, 3.0] {
        assert!(ContinuousCurvature::new(radius(good)).is_ok());
    }
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        let error = ContinuousCurvature::new(radius(bad)).unwrap_err();
        assert_eq!(error.path, "min_turning_radius_m");
    }
    // 0.3 m/s at 1.5 rad/s; at most 0.5 m/s.
    let small = Robot::small();
    assert_eq!(ContinuousCurvatureConfig::for_robot(&small, 0.3), radius(0.3 / 1.5));
    assert_eq!(ContinuousCurvatureConfig::for_robot(&small, 9.0), radius(0.5 / 1.5));
}

/// Smooths the planner's path between two cells, if there is one.
fn check_plan(
    map: &SearchMap,
    planner: &str,
    [start, goal]: [Cell; 2],
    radius_m: f64,
) -> Option<Smoothed> {
    let planner = PlannerConfig::by_name(planner)?.build(map).ok()?;
    let mut plan = Plan::default();
    let query = Query { budget: Some(200_000), ..Query::new(start, goal) };
    planner.plan_into(map, &query, &mut Workspace::default(), None, &mut plan).ok()?;
    let centre = |cell| map.frame().world_from_cell(cell);
    let line = plan.line(map, centre(start), centre(goal)).into_polyline();
    let clearance_m = map.config().clearance_m;
    let config = ContinuousCurvatureConfig { min_turning_radius_m: radius_m };
    let done = continuous_curvature(&line, &map.clearance(), clearance_m, &config);
    check(&line, &done, &map.clearance(), clearance_m, radius_m);
    assert_eq!(done, continuous_curvature(&line, &map.clearance(), clearance_m, &config));
    Some(done)
}

#[test]
fn paths_of_planners_on_the_bundled_maps() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../keyway-cli/scenes");
    let mut rounded = 0;
    for (file, clearance_m, radius_m) in
        [("small_house.yaml", 0.2, 0.1), ("small_house.yaml", 0.23, 0.33), ("rooms.map", 0.4, 0.5)]
    {
        let (path, read) = (folder.join(file), |path: &FilePath| Ok(std::fs::read(path).unwrap()));
        let grid = map_from_bytes(&path, &std::fs::read(&path).unwrap(), read, None).unwrap().grid;
        let config = LayerConfig { clearance_m, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
        for planner in ["jps", "astar", "theta-star", "bidirectional-24"] {
            for k in 0..6 {
                let ends = [free[k * 7919 % free.len()], free[(k * 104_729 + 31) % free.len()]];
                let done = check_plan(&map, planner, ends, radius_m);
                rounded += done.map_or(0, |done| done.inserted_points / CONTROL_POINTS);
            }
        }
    }
    assert!(rounded > 100, "only {rounded} corners were rounded");
}

fn random_map(occupied: &[bool], yaw: f64, clearance_m: f64) -> SearchMap {
    let frame = GridFrame::new(15, 12, 0.5, Pose::new(-2.0, 1.0, yaw)).unwrap();
    let grid = OccupancyGrid::from_occupied(frame, occupied);
    SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap()
}

proptest! {
    #[test]
    fn planned_lines(occupied in prop::collection::vec(prop::bool::weighted(0.2), 15 * 12), yaw in -3.0..3.0f64,
                     ends in (0i32..15, 0i32..12, 0i32..15, 0i32..12),
                     clearance_m in prop_oneof![Just(0.0), 0.0..0.6f64],
                     radius_m in prop_oneof![Just(0.0), 0.0..1.0f64]) {
        let map = random_map(&occupied, yaw, clearance_m);
        let ends = [Cell::new(ends.0, ends.1), Cell::new(ends.2, ends.3)];
        check_plan(&map, "astar", ends, radius_m);
    }

    #[test]
    fn any_line(occupied in prop::collection::vec(prop::bool::weighted(0.05), 15 * 12), yaw in -3.0..3.0f64,
                points in prop::collection::vec((0.0..15.0f64, 0.0..12.0f64), 0..7),
                clearance_m in prop_oneof![Just(0.0), 0.0..1.0f64],
                radius_m in prop_oneof![Just(0.0), 0.0..1.0f64]) {
        let map = random_map(&occupied, yaw, clearance_m);
        let world = |&(x, y): &(f64, f64)| map.frame().world_from_grid(Point::new(x, y));
        let line = Polyline::new(points.iter().map(world).collect());
        let config = ContinuousCurvatureConfig { min_turning_radius_m: radius_m };
        let done = continuous_curvature(&line, &map.clearance(), clearance_m, &config);
        check(&line, &done, &map.clearance(), clearance_m, radius_m);
    }
}
