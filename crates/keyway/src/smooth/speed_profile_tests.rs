//! Closed forms, a brute-force search, convergence.

use super::*;
use crate::geometry::{Arc, Cubic, PathPiece, Point, Polyline, Segment};
use crate::robot::Robot;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// 0.5 m/s, 1.5 rad/s, 0.5 m/s² up and down, 3 rad/s² up and down.
fn limits() -> Limits {
    Robot::small().limits
}

fn line(points: &[[f64; 2]]) -> Path {
    Path::from(&Polyline::new(points.iter().map(|&p| p.into()).collect()))
}

fn spaced(spacing_m: f64) -> SpeedProfileConfig {
    SpeedProfileConfig { spacing_m, ..SpeedProfileConfig::default() }
}

fn profile(path: &Path, config: &SpeedProfileConfig) -> SpeedProfile {
    SpeedProfile::of_path(path, &limits(), config).unwrap()
}

/// An S over control points, from rest to rest at its ends.
fn spline(control: &[[f64; 2]]) -> Path {
    let points: Vec<Point> = control.iter().map(|&p| p.into()).collect();
    let (first, last) = (points[0], points[points.len() - 1]);
    let padded = [vec![first; 2], points, vec![last; 2]].concat();
    let piece = |w: &[Point]| PathPiece::Cubic(Cubic::uniform_b_spline([w[0], w[1], w[2], w[3]]));
    Path::new(padded.windows(4).map(piece).collect()).unwrap()
}

#[test]
fn a_straight_line_by_hand() {
    // 1 s and 0.25 m up to 0.5 m/s, the same for slowing down, 1.5 m in between: 1 + 3 + 1 s, at
    // any spacing.
    for spacing_m in [0.001, 0.3, 0.7, 9.0] {
        let driven = profile(&line(&[[0., 0.], [2., 0.]]), &spaced(spacing_m));
        assert!((driven.time_s - 5.0).abs() < 1e-9, "{spacing_m}: {}", driven.time_s);
    }
    // At 0.05, 1 and 1.95 m.
    let driven = profile(&line(&[[0., 0.], [2., 0.]]), &spaced(0.05));
    let at = |i: usize| (driven.samples[i].v_mps, driven.samples[i].limit);
    assert_eq!(
        (at(0).1, at(1).1, at(20)),
        (SpeedLimit::Start, SpeedLimit::Acceleration, (0.5, SpeedLimit::Speed))
    );
    assert_eq!((at(39).1, at(40)), (SpeedLimit::Deceleration, (0.0, SpeedLimit::End)));
    assert!((at(1).0 - 0.05f64.sqrt()).abs() < 1e-12);
    // Too short for that: with 1 up and 0.5 down over 0.12 m the peak is sqrt(2 * 0.12 / 3) =
    // 0.2828.
    let uneven = Limits { acceleration_mps2: 1.0, deceleration_mps2: 0.5, ..limits() };
    let peak = 0.08f64.sqrt();
    for spacing_m in [0.001, 0.05, 1.0] {
        let short =
            SpeedProfile::of_path(&line(&[[0., 0.], [0.12, 0.]]), &uneven, &spaced(spacing_m));
        assert!((short.unwrap().time_s - (peak + peak / 0.5)).abs() < 1e-9, "{spacing_m}");
    }
}

#[test]
fn circles_by_hand() {
    // Radius 0.25 m: 1.5 rad/s is 0.375 m/s. With a lateral acceleration of 0.04 m/s², sqrt(0.01)
    // = 0.1 m/s.
    let path =
        Path::new(vec![PathPiece::Arc(Arc::new(Point::default(), 0.25, 0.0, -TAU))]).unwrap();
    let rolling = |v, lateral| SpeedProfileConfig {
        lateral_acceleration_mps2: lateral,
        start_mps: v,
        end_mps: v,
        ..SpeedProfileConfig::default()
    };
    for (v, lateral, limit) in
        [(0.375, None, SpeedLimit::TurnRate), (0.1, Some(0.04), SpeedLimit::LateralAcceleration)]
    {
        let driven = profile(&path, &rolling(v, lateral));
        assert!((driven.time_s - 0.25 * TAU / v).abs() < 1e-9);
        assert_eq!(driven.samples[50].limit, limit);
    }
    let too_fast = SpeedProfile::of_path(&path, &limits(), &rolling(0.4, None));
    assert_eq!(
        too_fast,
        Err(SpeedProfileError::StartTooFast { start_mps: 0.4, at_most_mps: 0.375 })
    );
    assert!(SpeedProfile::of_path(&path, &limits(), &rolling(0.375 + 1e-9, None)).is_err());
}

#[test]
fn corners_by_hand() {
    // Twice the straight line, and a turn by 90 degrees: 0.5 s and 0.375 rad up to 1.5 rad/s, the
    // same down, the rest at 1.5 rad/s.
    let driven = profile(&line(&[[0., 0.], [2., 0.], [2., 2.]]), &spaced(0.05));
    let turn_s = 1.0 + (FRAC_PI_2 - 0.75) / 1.5;
    assert!((driven.turning_s - turn_s).abs() < 1e-12);
    assert!((driven.time_s - 10.0 - turn_s).abs() < 1e-9);
    let (arrives, leaves) = (driven.samples[40], driven.samples[41]);
    assert_eq!((arrives.limit, arrives.v_mps, leaves.v_mps), (SpeedLimit::Corner, 0.0, 0.0));
    assert_eq!(leaves.limit, SpeedLimit::Corner);
    assert!((arrives.t_s - 5.0).abs() < 1e-9 && (leaves.t_s - 5.0 - turn_s).abs() < 1e-9);
    // A turn by 0.12 rad never gets to 1.5 rad/s: 2 sqrt(0.12 / 3) = 0.4 s.
    assert!((turning_time_s(0.12, &limits()) - 0.4).abs() < 1e-12);
    // Straight back is a turn by pi; a jump that counts as smooth takes no time.
    let back = profile(&line(&[[0., 0.], [2., 0.], [0., 0.]]), &spaced(0.05));
    assert!((back.turning_s - 1.0 - (PI - 0.75) / 1.5).abs() < 1e-12);
    let through = SpeedProfileConfig { smooth_turn_rad: 1.6, ..spaced(0.05) };
    let driven = profile(&line(&[[0., 0.], [2., 0.], [2., 2.]]), &through);
    assert!(driven.turning_s == 0.0 && (driven.time_s - 9.0).abs() < 1e-9);
    // A jump of exactly the smooth limit counts as smooth; with a slightly smaller limit it does
    // not.
    for (smooth_turn_rad, is_stop) in [(FRAC_PI_2, false), (FRAC_PI_2 - 1e-9, true), (1.0, true)] {
        let config = SpeedProfileConfig { smooth_turn_rad, ..spaced(0.05) };
        let turning_s = profile(&line(&[[0., 0.], [2., 0.], [2., 2.]]), &config).turning_s;
        assert_eq!(turning_s > 0.0, is_stop, "{smooth_turn_rad}");
    }
}

#[test]
fn speeds_at_both_ends_by_hand() {
    // 0.6 s and 0.21 m from 0.2 to 0.5 m/s, 0.4 s and 0.16 m down to 0.3 m/s, 1.63 m in between.
    let config = SpeedProfileConfig { start_mps: 0.2, end_mps: 0.3, ..spaced(0.05) };
    let driven = profile(&line(&[[0., 0.], [2., 0.]]), &config);
    assert!((driven.time_s - 0.6 - 0.4 - 1.63 / 0.5).abs() < 1e-9, "{}", driven.time_s);
    let [first, last] = [driven.samples[0], driven.samples[40]];
    assert!((first.v_mps - 0.2).abs() < 1e-12 && (last.v_mps - 0.3).abs() < 1e-12);
    assert_eq!((first.limit, last.limit), (SpeedLimit::Start, SpeedLimit::End));
}

#[test]
fn turns_that_slow_down_differently_from_how_they_speed_up() {
    let uneven =
        Limits { angular_acceleration_radps2: 4.0, angular_deceleration_radps2: 2.0, ..limits() };
    // 0.12 rad: the peak w has w²/8 + w²/4 = 0.12, so w = sqrt(0.32), for w/4 + w/2 seconds.
    assert!((turning_time_s(0.12, &uneven) - 0.75 * 0.32f64.sqrt()).abs() < 1e-12);
    // To 1.5 rad/s and back: 1.125 s, 0.84375 rad.
    let expected_s = 1.125 + (FRAC_PI_2 - 0.84375) / 1.5;
    assert!((turning_time_s(FRAC_PI_2, &uneven) - expected_s).abs() < 1e-12);
}

#[test]
fn numbers_that_are_refused() {
    type Set = fn(&mut Limits, &mut SpeedProfileConfig, f64);
    let positive: [(&str, Set); 8] = [
        ("limits.v_max_mps", |l, _, x| l.v_max_mps = x),
        ("limits.omega_max_radps", |l, _, x| l.omega_max_radps = x),
        ("limits.acceleration_mps2", |l, _, x| l.acceleration_mps2 = x),
        ("limits.deceleration_mps2", |l, _, x| l.deceleration_mps2 = x),
        ("limits.angular_acceleration_radps2", |l, _, x| l.angular_acceleration_radps2 = x),
        ("limits.angular_deceleration_radps2", |l, _, x| l.angular_deceleration_radps2 = x),
        ("lateral_acceleration_mps2", |_, c, x| c.lateral_acceleration_mps2 = Some(x)),
        ("spacing_m", |_, c, x| c.spacing_m = x),
    ];
    let not_negative: [(&str, Set); 3] = [
        ("start_mps", |_, c, x| c.start_mps = x),
        ("end_mps", |_, c, x| c.end_mps = x),
        ("smooth_turn_rad", |_, c, x| c.smooth_turn_rad = x),
    ];
    let path = line(&[[0., 0.], [2., 0.]]);
    let refused = |set: Set, value: f64| {
        let (mut limits, mut config) = (limits(), SpeedProfileConfig::default());
        set(&mut limits, &mut config, value);
        match SpeedProfile::of_path(&path, &limits, &config) {
            Err(SpeedProfileError::Config(error)) => Some(error.path),
            _ => None,
        }
    };
    for (field, set) in positive.into_iter().chain(not_negative) {
        for value in [-1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(refused(set, value).as_deref(), Some(field), "{value}");
        }
        let is_positive = positive.iter().any(|(name, _)| *name == field);
        assert_eq!(refused(set, 0.0).as_deref(), is_positive.then_some(field));
    }
}

#[test]
fn a_smooth_joint_is_there_once() {
    // A metre ahead, a quarter circle of 0.25 m, a metre on: 0.375 m/s on the arc.
    let pieces = vec![
        PathPiece::Segment(Segment::new(Point::default(), Point::new(1.0, 0.0))),
        PathPiece::Arc(Arc::new(Point::new(1.0, 0.25), 0.25, -FRAC_PI_2, FRAC_PI_2)),
        PathPiece::Segment(Segment::new(Point::new(1.25, 0.25), Point::new(1.25, 1.25))),
    ];
    let driven = profile(&Path::new(pieces).unwrap(), &spaced(0.3));
    let places: Vec<f64> = driven.samples.iter().map(|sample| sample.at.s_m).collect();
    assert!(places.windows(2).all(|pair| pair[1] > pair[0]), "{places:?}");
    // 0, 0.3, 0.6, 0.9, 1 (a joint), 1.2, 1.3927 (a joint), 1.5, 1.8, 2.1, 2.3927 m.
    assert_eq!(places.len(), 11);
    for (joint, curvature_per_m) in [(4, 4.0), (6, 0.0)] {
        let SpeedSample { at, v_mps, limit, .. } = driven.samples[joint];
        assert!((v_mps - 0.375).abs() < 1e-12 && limit == SpeedLimit::TurnRate, "{limit:?}");
        assert!((at.curvature_per_m - curvature_per_m).abs() < 1e-12);
    }
}

#[test]
fn next_to_nothing() {
    assert_eq!(profile(&Path::default(), &spaced(0.1)).time_s, 0.0);
    let point = profile(&line(&[[1., 1.]]), &spaced(0.1));
    assert_eq!((point.samples.len(), point.time_s), (1, 0.0));
    let speck =
        Path::new(vec![PathPiece::Arc(Arc::new(Point::default(), 1e-200, 0.0, 1.0))]).unwrap();
    assert!(profile(&speck, &spaced(0.1)).time_s.is_finite());
    let refused = SpeedProfile::of_path(&speck, &limits(), &spaced(f64::NAN)).unwrap_err();
    assert!(matches!(refused, SpeedProfileError::Config(error) if error.path == "spacing_m"));
    let endless = Limits { v_max_mps: f64::INFINITY, ..limits() };
    assert!(SpeedProfile::of_path(&speck, &endless, &spaced(0.1)).is_err());
}

#[test]
fn the_time_converges_with_the_square_of_the_spacing() {
    let path = spline(&[[0., 0.], [1., 0.], [1., 1.], [2., 1.], [2., 0.2], [3., 0.]]);
    let time_s = |spacing_m| profile(&path, &spaced(spacing_m)).time_s;
    let exact_s = time_s(2e-4);
    let errors = [0.08, 0.04, 0.02, 0.01].map(|h| (time_s(h) - exact_s).abs() / (h * h));
    assert!(exact_s > path.length_m() / 0.5 + 1.0 && errors.iter().all(|&e| e < 1.5), "{errors:?}");
    // The default spacing is accurate to about a millisecond, and the finest is not the slowest.
    assert!((time_s(0.01) - exact_s).abs() < 1e-3, "{} {exact_s}", time_s(0.01));
    assert!(time_s(1e-3) <= time_s(0.01) + 1e-3);
}

#[test]
fn a_cusp_between_two_samples_is_not_missed() {
    // The curve goes 5/3 m ahead, turns around in place, 1/3 m back, turns around again: its
    // curvature is 0 at every sample.
    let control = [[0., 0.], [4., 0.], [-1., 0.], [3., 0.]].map(Point::from);
    let path = Path::new(vec![PathPiece::Cubic(Cubic::bezier(control))]).unwrap();
    let driven = profile(&path, &spaced(0.01));
    // Two turns by pi at 1.5 rad/s.
    assert!(driven.time_s > path.length_m() / 0.5 + 2.0 * PI / 1.5, "{}", driven.time_s);
    // Both samples around a cusp are as slow as a turn by pi within a centimetre requires.
    let slowest_mps = 1.5 * 0.01 / PI;
    let slow = |sample: &&SpeedSample| sample.v_mps > 0.0 && sample.v_mps < 1.01 * slowest_mps;
    assert_eq!(driven.samples.iter().filter(slow).count(), 4);
}

#[test]
fn a_gentle_bend_between_two_samples_is_not_missed() {
    // 0.2 mm, to the left by 0.06 or 0.005 rad; sampled at both ends, where the curvature is 0. At
    // 1.5 rad/s that is 5 mm/s or 60 mm/s.
    for (turn_rad, expected_mps) in [(0.06, 0.005), (0.005, 0.06)] {
        let way = |points: [[f64; 2]; 4]| PathPiece::Cubic(Cubic::bezier(points.map(Point::from)));
        let bend = way([[0.0, 0.0], [1e-4, 0.0], [1e-4, 0.0], [2e-4, 1e-4 * turn_rad]]);
        let end = [2e-4, 1e-4 * turn_rad].into();
        let away = PathPiece::Segment(Segment::new(end, [1.0, turn_rad].into()));
        let path = Path::new(vec![bend, away]).unwrap();
        let config = SpeedProfileConfig { smooth_turn_rad: 0.01, start_mps: 0.4, ..spaced(0.01) };
        let error = SpeedProfile::of_path(&path, &limits(), &config).unwrap_err();
        let SpeedProfileError::StartTooFast { at_most_mps, .. } = error else { panic!("{error}") };
        assert!((at_most_mps / expected_mps - 1.0).abs() < 0.01, "{at_most_mps}");
    }
}

#[test]
fn a_circle_can_begin_at_its_largest_speed() {
    for radius_mm in 1..300 {
        let radius_m = 1e-3 * f64::from(radius_mm);
        let circle =
            Path::new(vec![PathPiece::Arc(Arc::new(Point::default(), radius_m, 0.0, TAU))]);
        let start_mps = 1.5 * radius_m;
        let config = SpeedProfileConfig { start_mps, end_mps: start_mps, ..spaced(0.1) };
        let driven = SpeedProfile::of_path(&circle.unwrap(), &limits(), &config);
        assert!((driven.unwrap().time_s - TAU / 1.5).abs() < 1e-9, "{radius_mm} mm");
    }
}

/// A bend half a millimetre long: both of its samples are known, and its peak is one of them.
#[test]
fn a_bend_shorter_than_the_spacing_takes_the_time_of_its_turn() {
    let way = |points: [[f64; 2]; 4]| PathPiece::Cubic(Cubic::bezier(points.map(Point::from)));
    let (into, out) = (
        way([[0.9995, 0.0], [0.9996, 0.0], [0.9998, 0.0], [0.9999, 0.0001]]),
        way([[0.9999, 0.0001], [1.0, 0.0002], [1.0, 0.0004], [1.0, 0.0005]]),
    );
    let leg = |a: [f64; 2], b: [f64; 2]| PathPiece::Segment(Segment::new(a.into(), b.into()));
    let pieces = vec![leg([0., 0.], [0.9995, 0.]), into, out, leg([1.0, 0.0005], [1.0, 1.0])];
    let path = Path::new(pieces).unwrap();
    let fine_s = profile(&path, &spaced(1e-6)).time_s;
    for spacing_m in [0.01, 0.001, 1e-4] {
        let driven = profile(&path, &spaced(spacing_m));
        for pair in driven.samples.windows(2) {
            let turned_rad = (pair[1].at.heading_rad - pair[0].at.heading_rad).abs();
            let at_most_rad = limits().omega_max_radps * (pair[1].t_s - pair[0].t_s);
            assert!(turned_rad <= at_most_rad + 1e-9, "{spacing_m}: {pair:?}");
        }
        assert!((driven.time_s / fine_s - 1.0).abs() < 0.02, "{} {fine_s}", driven.time_s);
    }
}

/// The least time over intervals of equal length, each with its own largest speed, from rest to
/// rest. Tries all constant accelerations between squared speeds on a grid.
fn brute_force_s(step_m: f64, v_max: &[f64], limits: &Limits) -> f64 {
    let changes = 8;
    let grid = 2.0 * limits.acceleration_mps2 * step_m / changes as f64;
    let states = (limits.v_max_mps.powi(2) / grid).floor() as usize + 1;
    let v = |k: usize| (k as f64 * grid).sqrt();
    let mut best = vec![f64::INFINITY; states];
    best[0] = 0.0;
    for v_max in v_max {
        let time_to = |k: usize| {
            (k.saturating_sub(changes)..=(k + changes).min(states - 1))
                .filter(|&j| v(j) <= v_max + 1e-12 && v(k) <= v_max + 1e-12)
                .map(|j| best[j] + 2.0 * step_m / (v(j) + v(k)))
                .fold(f64::INFINITY, f64::min)
        };
        best = (0..states).map(time_to).collect();
    }
    best[0]
}

#[test]
fn tables_read_back_the_same() {
    let driven = profile(&spline(&[[0., 0.], [1., 0.3], [1., 1.]]), &spaced(0.1));
    let json = serde_json::to_string(&driven).unwrap();
    assert!(json.contains("\"limit\":\"turn-rate\"") || json.contains("\"limit\":\"speed\""));
    let read: SpeedProfile = serde_json::from_str(&json).unwrap();
    // The text is exact, but this JSON reader rounds the last bit of some numbers.
    assert_eq!(read.samples.len(), driven.samples.len());
    for (read, sample) in read.samples.iter().zip(&driven.samples) {
        assert_eq!(read.limit, sample.limit);
        assert!(read.at.position().distance(sample.at.position()) < 1e-12);
        assert!((read.t_s - sample.t_s).abs() + (read.v_mps - sample.v_mps).abs() < 1e-12);
    }
    let csv = driven.to_csv();
    let mut rows = csv.lines();
    assert_eq!(
        rows.next(),
        Some("s_m,x_m,y_m,heading_rad,curvature_per_m,t_s,v_mps,omega_radps,limit")
    );
    assert_eq!(csv.lines().count(), driven.samples.len() + 1);
    for (row, sample) in rows.zip(&driven.samples) {
        let fields: Vec<&str> = row.split(',').collect();
        let n: Vec<f64> = fields[..8].iter().map(|n| n.parse().unwrap()).collect();
        let PathSample { s_m, x_m, y_m, heading_rad, curvature_per_m } = sample.at;
        let omega = curvature_per_m * sample.v_mps;
        assert_eq!(
            n,
            [s_m, x_m, y_m, heading_rad, curvature_per_m, sample.t_s, sample.v_mps, omega]
        );
        let limit: SpeedLimit = serde_json::from_str(&format!("\"{}\"", fields[8])).unwrap();
        assert_eq!(limit, sample.limit);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn no_way_on_a_grid_of_speeds_is_faster(before in 1..15usize, curved in 1..12usize, after in 1..15usize,
                                            radius in 0.15..0.5f64) {
        // A straight stretch, an arc, a straight stretch, each a whole number of steps long.
        let step = 0.05;
        let (l0, l1, l2) = (before as f64 * step, curved as f64 * step, after as f64 * step);
        let arc = Arc::new(Point::new(l0, radius), radius, -FRAC_PI_2, (l1 / radius).min(TAU));
        prop_assume!(l1 / radius < TAU);
        let (end, heading) = (arc.end(), arc.heading_at(1.0));
        let (sin, cos) = libm::sincos(heading);
        let pieces = vec![
            PathPiece::Segment(Segment::new(Point::default(), Point::new(l0, 0.0))),
            PathPiece::Arc(arc),
            PathPiece::Segment(Segment::new(end, end + Point::new(cos, sin) * l2)),
        ];
        let driven = profile(&Path::new(pieces).unwrap(), &spaced(step));
        let v_max: Vec<f64> = [(before, 0.5), (curved, 1.5 * radius), (after, 0.5)].iter()
            .flat_map(|&(count, v)| vec![f64::min(v, 0.5); 16 * count]).collect();
        let brute_s = brute_force_s(step / 16.0, &v_max, &limits());
        prop_assert!(driven.time_s <= brute_s + 1e-9, "{} > {brute_s}", driven.time_s);
        prop_assert!(brute_s <= driven.time_s * 1.01, "{} << {brute_s}", driven.time_s);
    }

    #[test]
    fn every_limit_is_kept(control in prop::collection::vec(prop::array::uniform2(-2.0..2.0f64), 2..6),
                           lateral in 0.05..1.0f64) {
        let path = spline(&control);
        let config = SpeedProfileConfig { lateral_acceleration_mps2: Some(lateral), ..SpeedProfileConfig::default() };
        let driven = profile(&path, &config);
        for SpeedSample { at, v_mps, .. } in &driven.samples {
            let k = at.curvature_per_m.abs();
            prop_assert!(*v_mps <= 0.5 && k * v_mps <= 1.5 + 1e-9 && k * v_mps * v_mps <= lateral + 1e-9);
        }
        for pair in driven.samples.windows(2) {
            let driven_m = pair[1].at.s_m - pair[0].at.s_m;
            let change = pair[1].v_mps.powi(2) - pair[0].v_mps.powi(2);
            prop_assert!(change.abs() <= 2.0 * 0.5 * driven_m + 1e-9, "faster than the accelerations");
            prop_assert!(pair[1].t_s >= pair[0].t_s);
        }
        prop_assert!(driven.time_s.is_finite() && driven.time_s >= path.length_m() / 0.5);
        let free = profile(&path, &SpeedProfileConfig::default()).time_s;
        prop_assert!(free <= driven.time_s + 1e-9, "fewer limits took longer");
        prop_assert!((driven.samples.last().unwrap().t_s - driven.time_s).abs() < 1e-12);
    }
}
