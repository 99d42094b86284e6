//! Smoothing a smoothed path again changes nothing where it should not.

use crate::support::{Raw, Rules, any_raw, query_on};
use crate::taut::{planned, scenes};
use keyway::geometry::{Arc, Path, PathPiece, Point, Polyline};
use keyway::map::formats::read_map;
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::search::Query;
use keyway::smooth::{
    ContinuousCurvature, ContinuousCurvatureConfig, LineOfSight, Smoothed, Smoother, Taut,
};
use proptest::prelude::*;

/// Distance by which a line of tangents lies outside the arcs that it replaces \[m\].
const OUTSIDE_M: f64 = 1e-7;

/// Rounding of lengths \[m\].
const ROUNDING_M: f64 = 1e-8;

/// A line that touches the path from outside: arcs are replaced by tangents, so it keeps their
/// clearance.
fn tangents(path: &Path) -> Polyline {
    let mut points: Vec<Point> = path.pieces().first().map(PathPiece::start).into_iter().collect();
    for piece in path.pieces() {
        if let PathPiece::Arc(arc) = piece {
            points.extend(corners_around(arc));
        }
        points.push(piece.end());
    }
    Polyline::new(points)
}

fn corners_around(arc: &Arc) -> Vec<Point> {
    // A tangent's corner is r / cos(half its part) from the centre: about r half^2 / 2 outside.
    let half_rad = (2.0 * OUTSIDE_M / arc.radius).sqrt().min(0.5);
    let parts = (arc.sweep_rad.abs() / (2.0 * half_rad)).ceil().max(1.0) as u32;
    let half_rad = 0.5 * arc.sweep_rad.abs() / f64::from(parts);
    let around = Arc { radius: arc.radius / half_rad.cos(), ..*arc };
    (0..parts).map(|part| around.at((f64::from(part) + 0.5) / f64::from(parts))).collect()
}

/// Total turning angle of a path \[rad\].
fn turned_rad(path: &Path) -> f64 {
    let of_piece = |piece: &PathPiece| match piece {
        PathPiece::Arc(arc) => arc.sweep_rad.abs(),
        _ => 0.0,
    };
    path.pieces().iter().map(of_piece).sum()
}

/// Checks a line over cells that keep the clearance; false if there is nothing to smooth. Between
/// such cells a line of Theta* may come closer, and then its own distance is kept.
fn check(map: &SearchMap, line: &Polyline) -> bool {
    let (clearance, clearance_m) = (map.clearance(), map.config().clearance_m);
    let smooth = |smoother: &dyn Smoother, line: &Polyline| {
        smoother.smooth(&line.clone().into(), &clearance, clearance_m)
    };
    let once = smooth(&Taut, line);
    let twice = smooth(&Taut, &tangents(&once.path));
    let (before_m, after_m) = (once.path.length_m(), twice.path.length_m());
    let context = || format!("{line:?}\n{once:?}\n{twice:?}");
    // If two obstacles leave exactly the required space, the tangents around one are too close to
    // the other, whose radius is then smaller by as much.
    let may_differ_m = ROUNDING_M + 2.0 * OUTSIDE_M * turned_rad(&once.path);
    assert!((before_m - after_m).abs() <= may_differ_m, "{before_m} {after_m}\n{}", context());
    assert_eq!(twice.sharp_corners, once.sharp_corners, "{}", context());
    let kept_m = |done: &Smoothed| done.kept_clearance_m.unwrap_or(clearance_m);
    assert!(kept_m(&twice) >= kept_m(&once) - 2.0 * OUTSIDE_M, "{}", context());
    if clearance_m == 0.0 {
        assert_eq!(twice.path, once.path);
    }

    // The curve depends on the shortened line alone.
    let config =
        ContinuousCurvatureConfig { min_turning_radius_m: 0.3 * map.frame().resolution_m() };
    let short = smooth(&LineOfSight, line).path.flattened(0.0);
    assert_eq!(smooth(&LineOfSight, &short).path, Path::from(&short), "{line:?}");
    let curves = ContinuousCurvature::new(config).unwrap();
    let (curve, again) = (smooth(&curves, line), smooth(&curves, &short));
    assert_eq!(again.path, curve.path, "{line:?}");
    assert_eq!(again.sharp_corners, curve.sharp_corners);
    once.path.pieces().len() > 1
}

#[test]
fn tangents_by_hand() {
    let quarter = Arc::new(Point::new(0.0, 0.0), 2.0, 0.0, std::f64::consts::FRAC_PI_2);
    let path = Path::new(vec![PathPiece::Arc(quarter)]).unwrap();
    let line = tangents(&path);
    assert!(
        line.points().iter().all(|p| (2.0 - 1e-12..2.0 + 2e-7).contains(&p.norm())),
        "{line:?}"
    );
    assert!(line.length_m() > path.length_m() && line.length_m() < path.length_m() + 1e-5);
}

#[test]
fn on_bundled_maps() {
    for (file, clearance_m) in [
        ("rooms.map", 0.0),
        ("rooms.map", 0.5),
        ("small_house.yaml", 0.0),
        ("small_house.yaml", 0.2),
    ] {
        let grid = read_map(&scenes().join(file), None).unwrap().grid;
        let config = LayerConfig { clearance_m, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
        let mut bent = 0;
        for k in 0..30 {
            let cell = |step: usize| free[(k + 1) * step % free.len()];
            let query = Query::new(cell(7919), cell(104_729));
            let line = planned(["jps", "theta-star"][k % 2], &map, &query);
            bent += line.is_some_and(|line| check(&map, &line)) as u32;
        }
        assert!(bent > 8, "{file}, {clearance_m} m: {bent}");
    }
}

fn inflated(raw: &Raw, clearance_m: f64) -> SearchMap {
    let config = LayerConfig { clearance_m, ..Rules::default().layers() };
    SearchMap::new(&raw.grid(), config).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn on_random_maps(raw in any_raw(), ends: (u32, u32, u32, u32),
                      clearance_m in prop_oneof![Just(0.0), Just(0.5), 0.01..1.3f64]) {
        let map = inflated(&raw, clearance_m);
        let query = query_on(&raw, ends);
        for planner in ["jps", "theta-star"] {
            if let Some(line) = planned(planner, &map, &query).filter(|_| query.start != query.goal) {
                check(&map, &line);
            }
        }
    }
}
