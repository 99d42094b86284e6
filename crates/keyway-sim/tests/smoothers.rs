//! Guarantees of all smoothers for any line: planned lines on random and bundled maps, and
//! arbitrary lines.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{PathPiece, PlannedLine, Point, Polyline, Pose};
use keyway::map::formats::read_map;
use keyway::map::{
    Cell, CellState, Clearance, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};
use keyway::smooth::{
    BendsKeep, BidirectionalSmoothingConfig, HierarchicalSmoothingConfig, KeyPointCandidates,
    KeyPointSmoothingConfig, Passes, Select, ShortcutConfig, Smoothed, Smoother, SmootherConfig,
    TautConfig, Unsmoothed,
};
use keyway_sim::metrics::PathMetrics;
use proptest::prelude::*;
use std::path::Path;

/// Accuracy of the distances of curves in these tests \[m\].
const TOLERANCE_M: f64 = 1e-4;

fn named() -> impl Iterator<Item = SmootherConfig> {
    SmootherConfig::NAMES.iter().map(|name| SmootherConfig::by_name(name).unwrap())
}

fn all() -> impl Iterator<Item = SmootherConfig> {
    named().chain(others())
}

/// Smoothers without their own safe distance, and with other options.
fn others() -> [SmootherConfig; 6] {
    let hierarchical = |bends_keep| {
        let (safe_distance_m, control_distance_m) = (0.0, 3.0);
        HierarchicalSmoothingConfig { safe_distance_m, control_distance_m, bends_keep }
    };
    let key_points = |candidates, safe_distance_m| {
        SmootherConfig::KeyPoints(KeyPointSmoothingConfig { candidates, safe_distance_m })
    };
    [
        SmootherConfig::Hierarchical(hierarchical(BendsKeep::SafeDistance)),
        SmootherConfig::Hierarchical(hierarchical(BendsKeep::Clearance)),
        key_points(KeyPointCandidates::JumpPoints, 0.0),
        key_points(KeyPointCandidates::Cells, 0.5),
        SmootherConfig::Shortcut(ShortcutConfig { passes: 5, expansion_cells: 0 }),
        SmootherConfig::Bidirectional(BidirectionalSmoothingConfig {
            spacing_cells: 2.0,
            select: Select::LargestClearance,
            safety_distance_cells: 0.0,
            passes: Passes::Backward,
        }),
    ]
}

fn smooth(
    config: &SmootherConfig,
    line: &Polyline,
    clearance: &Clearance<'_>,
    clearance_m: f64,
) -> Smoothed {
    config.build().unwrap().smooth(&line.clone().into(), clearance, clearance_m)
}

/// Smooths a line and checks everything that holds for any line.
fn smoothed(
    config: &SmootherConfig,
    planned: &PlannedLine,
    clearance: &Clearance<'_>,
    asked_m: f64,
) -> Smoothed {
    let smoother = config.build().unwrap();
    let line = planned.polyline();
    let done = smoother.smooth(planned, clearance, asked_m);
    let context = || format!("{smoother:?}, {asked_m} m: {line:?}\n{done:?}");
    assert_eq!(done, smoother.smooth(planned, clearance, asked_m), "another path, {}", context());
    let (first, last) = (done.path.pieces().first(), done.path.pieces().last());
    let finite: Vec<Point> = line.points().iter().copied().filter(|p| p.is_finite()).collect();
    assert_eq!(first.map(PathPiece::start), finite.first().copied(), "{}", context());
    assert_eq!(last.map(PathPiece::end), finite.last().copied(), "{}", context());
    let line = Polyline::new(finite);
    assert!(done.path.length_m() <= line.length_m() + 1e-9, "longer, {}", context());
    if let Some(bounds) = clearance.of_path(&done.path, TOLERANCE_M) {
        // As clear as the line, or as requested.
        let before_m = clearance.of_line(&line).unwrap();
        let kept_m = bounds.at_least_m + 2.0 * TOLERANCE_M;
        assert!(kept_m >= before_m.min(asked_m), "nearer: {bounds:?}, {}", context());
        let reported_m = done.kept_clearance_m.unwrap_or(asked_m);
        assert!(kept_m >= reported_m.min(asked_m), "not reported: {bounds:?}, {}", context());
        assert!(
            reported_m.min(before_m) <= bounds.at_most_m + TOLERANCE_M,
            "{bounds:?}, {}",
            context()
        );
    }
    check_reported(&done, clearance, asked_m, &context);
    match config {
        SmootherConfig::Hierarchical(_) => check_spline(&done, clearance, &context),
        SmootherConfig::Taut(_) if asked_m > 0.0 => {}
        SmootherConfig::Taut(_) => {
            let again = smoother.smooth(&done.path.flattened(0.0).into(), clearance, asked_m).path;
            let change_m = again.length_m() - done.path.length_m();
            assert!(change_m.abs() < 1e-9, "a second run: {again:?}, {}", context());
        }
        SmootherConfig::ContinuousCurvature(_) => {}
        _ => check_second_run(config, &done, clearance, asked_m, &context),
    }
    // A single point is also a path.
    let was_free = clearance.is_clear_path(&keyway::geometry::Path::from(&line), 0.0);
    assert!(!was_free || clearance.is_clear_path(&done.path, 0.0), "in collision, {}", context());
    done
}

/// Checks that no point of the path is nearer to an obstacle or to the map's border than
/// requested, unless that is reported.
fn check_reported(
    done: &Smoothed,
    clearance: &Clearance<'_>,
    asked_m: f64,
    context: &dyn Fn() -> String,
) {
    let reported_m = done.kept_clearance_m.map_or(asked_m, |reported_m| reported_m.min(asked_m));
    let cell_m = clearance.frame().resolution_m();
    for sample in done.path.samples(done.path.length_m() / 200.0) {
        let at = sample.position();
        let kept_m = clearance.of_point(at, f64::INFINITY).min(clearance.to_border(at).max(0.0));
        let message = || format!("{kept_m} m of {reported_m} m at {at:?}, {}", context());
        assert!(kept_m >= reported_m - 1e-4 * cell_m - 1e-9, "{}", message());
    }
}

/// Checks the B-spline: smooth at its joints except at the corners that were left sharp, which
/// are its non-smooth turns.
fn check_spline(done: &Smoothed, clearance: &Clearance<'_>, context: &dyn Fn() -> String) {
    for pair in done.path.pieces().windows(2) {
        match pair {
            // In the spline's own parameter.
            [PathPiece::Cubic(a), PathPiece::Cubic(b)] => {
                let gap = |x: Point, y: Point| x.distance(y) / a.polygon_length();
                assert!(gap(a.end(), b.start) < 1e-9, "{}", context());
                assert!(gap(a.derivative(1.0), b.derivative(0.0)) < 1e-9, "{}", context());
                let (before, after) = (a.second_derivative(1.0), b.second_derivative(0.0));
                assert!(gap(before, after) < 1e-9, "{}", context());
            }
            // Straight on, without a jump of curvature.
            [_, PathPiece::Cubic(b)] => assert!(b.curvature_at(0.0).abs() < 1e-6, "{}", context()),
            [PathPiece::Cubic(a), _] => assert!(a.curvature_at(1.0).abs() < 1e-6, "{}", context()),
            _ => {}
        }
    }
    let turns_rad: Vec<f64> = done.path.joint_turns_rad().iter().map(|turn| turn.abs()).collect();
    let turns = |above_rad: f64| turns_rad.iter().filter(|&&turn| turn > above_rad).count();
    assert_eq!(turns(1e-6), done.sharp_corners.len(), "{}", context());
    // On a path without curves every turn is non-smooth.
    let is_curved = done.inserted_points > 0;
    let expected = turns(if is_curved { 5f64.to_radians() } else { 1e-6 });
    let metrics = PathMetrics::of_path(&done.path, *clearance);
    assert_eq!(metrics.non_smooth_turns, expected, "{metrics:?}, {}", context());
}

/// Smooths straight segments again: the result is not longer, has no more points (except for the
/// smoother that cuts its line into new ones), and is the same for idempotent smoothers.
fn check_second_run(
    smoother: &SmootherConfig,
    done: &Smoothed,
    clearance: &Clearance<'_>,
    asked_m: f64,
    context: &dyn Fn() -> String,
) {
    let once = done.path.flattened(0.0).into();
    let again = smoother.build().unwrap().smooth(&once, clearance, asked_m).path;
    let message = || format!("a second run: {again:?}, {}", context());
    assert!(again.length_m() <= done.path.length_m() + 1e-9, "{}", message());
    if !matches!(smoother, SmootherConfig::Bidirectional(_)) {
        assert!(again.pieces().len() <= done.path.pieces().len(), "{}", message());
    }
    if matches!(smoother, SmootherConfig::None(_) | SmootherConfig::LineOfSight(_)) {
        assert_eq!(again, done.path, "{}", message());
    }
}

/// The line of a plan, if one is found.
fn planned(
    planner: &PlannerConfig,
    map: &SearchMap,
    query: &Query,
    workspace: &mut Workspace,
) -> Option<PlannedLine> {
    let mut plan = Plan::default();
    planner.build(map).unwrap().plan_into(map, query, workspace, None, &mut plan).ok()?;
    let centre = |cell| map.frame().world_from_cell(cell);
    Some(plan.line(map, centre(query.start), centre(query.goal)))
}

fn random_map(occupied: &[bool], resolution_m: f64, yaw: f64) -> OccupancyGrid {
    let frame = GridFrame::new(20, 15, resolution_m, Pose::new(-3.0, 2.0, yaw)).unwrap();
    let state = |cell: Cell| {
        let is_occupied = occupied[(cell.y * 20 + cell.x) as usize];
        if is_occupied { CellState::Occupied } else { CellState::Free }
    };
    OccupancyGrid::from_fn(frame, state)
}

fn any_cells() -> impl Strategy<Value = Vec<bool>> {
    (0.02..0.35f64)
        .prop_flat_map(|share| prop::collection::vec(prop::bool::weighted(share), 20 * 15))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn paths_of_planners(cells in any_cells(), resolution_m in prop_oneof![Just(1.0), Just(0.05), 0.1..2.0f64],
                         yaw in prop_oneof![Just(0.0), -3.0..3.0f64], planner in 0..PlannerConfig::NAMES.len(),
                         ends in (0..20i32, 0..15i32, 0..20i32, 0..15i32),
                         clearance_cells in prop_oneof![Just(0.0), Just(0.5), 0.0..2.0f64]) {
        let grid = random_map(&cells, resolution_m, yaw);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let planner = PlannerConfig::by_name(PlannerConfig::NAMES[planner]).unwrap();
        let query = Query::new(Cell::new(ends.0, ends.1), Cell::new(ends.2, ends.3));
        let line = planned(&planner, &map, &query, &mut Workspace::default());
        prop_assume!(line.is_some());
        for smoother in all() {
            smoothed(&smoother, line.as_ref().unwrap(), &map.clearance(), clearance_cells * resolution_m);
        }
    }

    /// Lines through obstacles, with repeated points and reversals.
    #[test]
    fn lines_that_nobody_has_planned(cells in any_cells(), corners in prop::collection::vec((0..40u32, 0..30u32), 0..9),
                                     resolution_m in 0.1..2.0f64, yaw in -3.0..3.0f64, asked_m in 0.0..1.0f64) {
        let grid = random_map(&cells, resolution_m, yaw);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let halves = |&(x, y): &(u32, u32)| Point::new(0.5 * f64::from(x), 0.5 * f64::from(y));
        let line = Polyline::new(corners.iter().map(|at| grid.frame().world_from_grid(halves(at))).collect());
        for smoother in named() {
            smoothed(&smoother, &line.clone().into(), &clearance, asked_m);
        }
    }

    /// Lines on a half-cell grid, which graze many corners of obstacles.
    #[test]
    fn taut_lines_that_touch(cells in any_cells(), corners in prop::collection::vec((0..40u32, 0..30u32), 2..9),
                             resolution_m in 0.1..2.0f64, yaw in prop_oneof![Just(0.0), -3.0..3.0f64]) {
        let grid = random_map(&cells, resolution_m, yaw);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let halves = |&(x, y): &(u32, u32)| Point::new(0.5 * f64::from(x), 0.5 * f64::from(y));
        let line = Polyline::new(corners.iter().map(|at| grid.frame().world_from_grid(halves(at))).collect());
        smoothed(&SmootherConfig::Taut(TautConfig::default()), &line.into(), &clearance, 0.0);
    }
}

#[test]
fn bundled_maps() {
    for (file, unknown) in
        [("rooms.map", UnknownPolicy::Blocked), ("small_house.yaml", UnknownPolicy::Free)]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../keyway-cli/scenes").join(file);
        let grid = read_map(&path, None).unwrap().grid;
        let map = SearchMap::new(&grid, LayerConfig { unknown, ..LayerConfig::default() }).unwrap();
        let free: Vec<Cell> =
            map.frame().cells().filter(|&c| grid.state(c) == Some(CellState::Free)).collect();
        let mut workspace = Workspace::default();
        for (i, name) in PlannerConfig::NAMES.iter().enumerate() {
            let planner = PlannerConfig::by_name(name).unwrap();
            let cell = |k: usize| free[(i + 1) * k % free.len()];
            let query = Query::new(cell(7919), cell(104_729));
            let Some(line) = planned(&planner, &map, &query, &mut workspace) else { continue };
            for smoother in all() {
                for asked_m in [0.0, 0.3] {
                    smoothed(&smoother, &line, &map.clearance(), asked_m);
                }
            }
        }
    }
}

#[test]
fn the_border_is_reported_and_so_is_an_end_that_is_too_near() {
    // Along the border, 0.3 m from it: without obstacles, and with one that is farther away.
    let line = Polyline::new([[0.3, 0.7], [0.3, 2.7], [1.5, 3.7]].map(Point::from).to_vec());
    let rows = |obstacle| ["....", obstacle, "....", "....", "...."];
    for rows in [rows("...."), rows("...#")] {
        let grid = OccupancyGrid::from_ascii(&rows);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        for smoother in all() {
            let reported_m = smooth(&smoother, &line, &clearance, 0.5).kept_clearance_m;
            assert!(
                reported_m.is_some_and(|m| (m - 0.3).abs() < 1e-3),
                "{smoother:?}: {reported_m:?}"
            );
            let reported_m = smooth(&smoother, &line, &clearance, 0.3).kept_clearance_m;
            assert_eq!(
                reported_m, None,
                "{smoother:?}: its own safe distance is not one from the border"
            );
        }
    }
    // The centre of the start's cell is far enough away.
    let grid = OccupancyGrid::from_ascii(&["....", "@...", "...."]);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let line = Polyline::new(vec![Point::new(1.05, 1.5), Point::new(3.5, 1.5)]);
    for smoother in all() {
        let reported_m = smooth(&smoother, &line, &clearance, 0.4).kept_clearance_m;
        assert!(
            reported_m.is_some_and(|m| (m - 0.05).abs() < 1e-3),
            "{smoother:?}: {reported_m:?}"
        );
    }
    // Outside the map, as in an obstacle, the clearance is 0.
    let line = Polyline::new(vec![Point::new(2.5, 1.5), Point::new(9.5, 1.5)]);
    let reported_m = Unsmoothed.smooth(&line.into(), &clearance, 0.4).kept_clearance_m;
    assert_eq!(reported_m, Some(0.0));
}

#[test]
fn degenerate_lines() {
    let grid = OccupancyGrid::from_ascii(&[".....", "..#..", "....."]);
    let clearance = Clearance::new(grid.frame(), grid.occupied());
    let lost = [f64::NAN, 1.0];
    let lines: [&[[f64; 2]]; 7] = [
        &[],
        &[lost],
        &[[0.5, 0.5]],
        &[[0.5, 0.5], [0.5, 0.5]],
        &[[0.5, 0.5], lost, [4.5, 0.5]],
        &[[0.5, 0.5], [4.5, 0.5], [0.5, 0.5]],
        &[[-9.0, 0.5], [1e9, 1e9], [f64::INFINITY, 0.0], [-9.0, 0.5]],
    ];
    for points in lines {
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        for smoother in all() {
            let done = smoothed(&smoother, &line.clone().into(), &clearance, 0.2);
            assert_eq!(done.path.pieces().is_empty(), points.iter().all(|p| p[0].is_nan()));
        }
    }
}

#[test]
fn bad_configs_are_refused() {
    let config = r#"{"name": "key-points", "safe_distance_m": -0.5}"#;
    let refused = serde_json::from_str::<SmootherConfig>(config).unwrap().build().unwrap_err();
    assert_eq!(refused.to_string(), "safe_distance_m must be a number of at least 0, got -0.5");
    for unknown in ["key-points", "taut", "none"] {
        let config = format!(r#"{{"name": "{unknown}", "d": 1}}"#);
        assert!(serde_json::from_str::<SmootherConfig>(&config).is_err(), "{unknown}");
    }
}
