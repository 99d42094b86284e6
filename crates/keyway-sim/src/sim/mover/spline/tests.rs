use super::super::{MovingObstacle, ObstacleMotion};
use super::*;
use proptest::prelude::*;
use serde_json::json;

fn frame(t_s: f64, x: f64, y: f64) -> KeyFrame {
    KeyFrame { t_s, position: Point::new(x, y) }
}

fn spline(frames: &[[f64; 3]], duration_s: f64) -> Spline {
    Spline::new(frames.iter().map(|&[t_s, x, y]| frame(t_s, x, y)).collect(), duration_s).unwrap()
}

#[test]
fn equal_steps_on_a_line_are_uniform_between_the_first_and_the_last() {
    let line = spline(&[[0.0, 0.0, 3.0], [2.0, 1.0, 3.0], [4.0, 2.0, 3.0], [6.0, 3.0, 3.0]], 6.0);
    for i in 0..=100 {
        let t_s = 2.0 + f64::from(i) * 0.02;
        assert!(line.position(t_s).distance(Point::new(t_s * 0.5, 3.0)) < 1e-12, "{t_s}");
        assert!((line.speed_bound_mps(t_s, 4.0) - 0.5).abs() < 1e-12 || t_s == 4.0);
        // It begins and ends at half the speed: u / 2 + u² - u³ / 2.
        let part = f64::from(i) * 0.01;
        let x = part * (0.5 + part * (1.0 - 0.5 * part));
        assert!((line.position(part * 2.0).x - x).abs() < 1e-12);
        assert!((line.position_before(6.0 - part * 2.0).x - (3.0 - x)).abs() < 1e-12);
    }
    assert!((line.speed_bound_mps(0.0, 0.0) - 0.25).abs() < 1e-12);
}

#[test]
fn a_lap_ends_with_a_jump_at_its_instant() {
    // 0.3 is rounded, and so are its multiples.
    let jumping = ObstacleMotion::Spline(spline(&[[0.05, 1.0, 0.0], [0.2, 2.0, 0.0]], 0.3));
    let (first, last) = (Point::new(1.0, 0.0), Point::new(2.0, 0.0));
    assert_eq!([-1.0, 0.0, 0.05].map(|t_s| jumping.position(t_s)), [first; 3]);
    assert_eq!([0.2, 0.25].map(|t_s| jumping.position(t_s)), [last; 2]);
    assert_eq!((jumping.last_jump_s(0.29), jumping.position_before(0.0)), (None, first));
    assert_eq!(jumping.next_jump_s(-7.0), Some(0.3));
    let mut before_s = 0.0;
    for lap in 1..2000 {
        let jump_s = f64::from(lap) * 0.3;
        let sooner_s = jump_s.next_down();
        assert_eq!(jumping.next_jump_s(before_s), Some(jump_s));
        assert_eq!(jumping.next_jump_s(sooner_s), Some(jump_s));
        assert_eq!([jump_s, jump_s + 0.1].map(|t_s| jumping.last_jump_s(t_s)), [Some(jump_s); 2]);
        assert_eq!(jumping.last_jump_s(sooner_s), (lap > 1).then_some(before_s));
        assert_eq!((jumping.position(sooner_s), jumping.position_before(sooner_s)), (last, last));
        assert_eq!((jumping.position(jump_s), jumping.position_before(jump_s)), (first, last));
        before_s = jump_s;
    }
    // The obstacle is stationary before and after, and is fast only while it moves. The jump does
    // not count.
    assert_eq!(jumping.speed_bound_mps(0.21, 0.34), 0.0);
    assert!(jumping.speed_bound_mps(0.2, 0.36) > 1.0);
    assert!(jumping.position(1e300).is_finite());
    assert_eq!(jumping.next_jump_s(1e300), None);
}

#[test]
fn a_closed_course_goes_on_without_a_jump() {
    let square =
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 1.0, 1.0], [3.0, 0.0, 1.0], [4.0, 0.0, 0.0]];
    let around = ObstacleMotion::Spline(spline(&square, 4.0));
    assert_eq!((around.next_jump_s(3.5), around.last_jump_s(9.0)), (None, None));
    // Along the diagonal at the first corner, as at all others.
    let step = (around.position(4.0 + 1e-6) - around.position(4.0 - 1e-6)) * 5e5;
    assert!(step.distance(Point::new(0.5, -0.5)) < 1e-5, "{step:?}");
    assert!(around.position(4.5).distance(around.position(0.5)) < 1e-12);
    // The velocity at the middle of a side: 1.5 (b - a) - (m_a + m_b) / 4.
    let step = (around.position(0.5 + 1e-6) - around.position(0.5 - 1e-6)) * 5e5;
    assert!(step.distance(Point::new(1.25, 0.0)) < 1e-5, "{step:?}");
    assert!((around.speed_bound_mps(0.5, 0.5) - 1.25).abs() < 1e-12);
}

/// Key frames within some metres, from 0.2 to 5 s apart.
fn frames() -> impl Strategy<Value = Vec<KeyFrame>> {
    prop::collection::vec((0.2..5.0f64, -4.0..4.0f64, -4.0..4.0f64), 2..9).prop_map(|steps| {
        let mut next_s = 0.0;
        let frames = steps.into_iter().map(|(step_s, x, y)| {
            next_s += step_s;
            frame(next_s - step_s, x, y)
        });
        frames.collect()
    })
}

proptest! {
    /// Checks that it passes through all key frames at their times with a continuous direction.
    /// The speed is continuous if the adjacent segments have equal durations.
    #[test]
    fn passes_through_its_key_frames(frames in frames(), rest_s in 0.1..1.0f64) {
        let duration_s = frames[frames.len() - 1].t_s + rest_s;
        let moves = Spline::new(frames.clone(), duration_s);
        prop_assume!(moves.is_ok());
        let moves = moves.unwrap();
        for frame in &frames {
            prop_assert_eq!(moves.position(frame.t_s), frame.position);
        }
        for window in frames.windows(3) {
            let step_s = 1e-6;
            let at = |t_s: f64| moves.position(window[1].t_s + t_s);
            let ways = [at(0.0) - at(-step_s), at(step_s) - at(0.0)];
            let stretches_s = [window[1].t_s - window[0].t_s, window[2].t_s - window[1].t_s];
            for (way, stretch_s) in ways.into_iter().zip(stretches_s) {
                let velocity_mps = way * (1.0 / step_s);
                let expected_mps = (window[2].position - window[0].position) * (0.5 / stretch_s);
                prop_assert!(velocity_mps.distance(expected_mps) < 1e-2, "{velocity_mps:?} {expected_mps:?}");
            }
        }
    }

    /// A bound for a short interval is close to the highest of many sampled speeds, and never
    /// below it.
    #[test]
    fn speed_bounds_are_tight(frames in frames(), from in 0.0..3.0f64, long_s in 0.001..0.2f64) {
        let duration_s = frames[frames.len() - 1].t_s.max(Spline::SHORTEST_S);
        let moves = Spline::new(frames, duration_s);
        prop_assume!(moves.is_ok());
        let moves = moves.unwrap();
        let from_s = from * duration_s;
        let bound_mps = moves.speed_bound_mps(from_s, from_s + long_s);
        // Long enough for the last digits of positions.
        let step_s = long_s / 100.0;
        let speed_mps = |i: u32| {
            let [a, b] = [i, i + 1].map(|i| from_s + f64::from(i) * step_s);
            let is_within = moves.next_jump_s(a).is_none_or(|jump_s| jump_s > b);
            let way = |a: f64, b: f64| moves.position(a).distance(moves.position(b)) / (b - a);
            if is_within { way(a, b) } else { 0.0 }
        };
        let fastest_mps = (0..100).map(speed_mps).fold(0.0, f64::max);
        prop_assert!(fastest_mps <= bound_mps + 1e-9, "{fastest_mps} {bound_mps}");
        // Within a segment; a key frame near an end of the interval may bring another speed.
        let is_near = |frame: &KeyFrame| {
            let [a, b] = [-2.0 * step_s, long_s + 2.0 * step_s].map(|off_s| from_s + off_s);
            (0..5).any(|lap| (a..=b).contains(&(frame.t_s + f64::from(lap) * duration_s)))
        };
        if !moves.frames().iter().any(is_near) {
            // The hull of the velocity curve is wider by at most half of the change of the second
            // derivative.
            let jerk = |stretch: &Stretch| {
                let [a, b, c] = stretch.velocities_mps();
                (a - b * 2.0 + c).norm() / (stretch.to_s - stretch.from_s).powi(2)
            };
            let widest = moves.stretches.iter().map(jerk).fold(0.0, f64::max);
            let turn = |stretch: &Stretch| {
                let [a, b, c] = stretch.velocities_mps();
                2.0 * (b - a).norm().max((c - b).norm()) / (stretch.to_s - stretch.from_s)
            };
            let steepest = moves.stretches.iter().map(turn).fold(0.0, f64::max);
            let slack_mps = widest * long_s * long_s + steepest * step_s;
            prop_assert!(bound_mps <= fastest_mps + slack_mps + 1e-9, "{bound_mps} {fastest_mps} {slack_mps}");
        }
    }
}

#[test]
fn numbers_beyond_measure_are_refused() {
    let path = |frames: &[[f64; 3]], duration_s| {
        let frames = frames.iter().map(|&[t_s, x, y]| frame(t_s, x, y)).collect();
        Spline::new(frames, duration_s).unwrap_err().path
    };
    assert_eq!(path(&[[0.0, -1e308, 0.0], [1.0, 1e308, 0.0]], 1.0), "spline[1]");
    assert_eq!(path(&[[0.0, 0.0, 0.0], [1.0, f64::NAN, 0.0]], 1.0), "spline[1].position[0]");
    assert_eq!(path(&[[0.0, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]], 1.0), "spline[1].t_s");
    let still = &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    assert_eq!(path(still, f64::INFINITY), "duration_s");
    assert_eq!(path(still, f64::NAN), "duration_s");
    assert!(MovingObstacle::new(-1.0, ObstacleMotion::Spline(spline(still, 1.0))).is_err());
}

#[test]
fn tables_are_refused_with_the_field() {
    let cases = [
        (
            json!({"radius_m": 1, "spline": [[0, 1, 1]], "duration_s": 2}),
            "spline must hold at least 2 key frames",
        ),
        (
            json!({"radius_m": 1, "spline": [[0, 1, 1], [1, 2, 2]]}),
            "the motion must be `position` and `velocity_mps`, or `key_frames`, or `spline` and `duration_s`, or \
             `way_points` and `speed_mps`, or `random_walk`, got `spline`",
        ),
        (
            json!({"radius_m": 1, "spline": [[2, 1, 1], [1, 2, 2]], "duration_s": 9}),
            "spline[1].t_s must be later than the one before it, at 2 s, got 1",
        ),
        (
            json!({"radius_m": 1, "spline": [[-1, 1, 1], [1, 2, 2]], "duration_s": 9}),
            "spline[0].t_s must be a number of at least 0, got -1",
        ),
        (
            json!({"radius_m": 1, "spline": [[0, 1, 1], [1, 2, 2]], "duration_s": 0.5}),
            "duration_s must be at least 0.1 s, and not less than the last time, 1 s, got 0.5",
        ),
        (
            json!({"radius_m": 1, "spline": [[0, 1, 1], [0.01, 1, 1]], "duration_s": 0.05}),
            "duration_s must be at least 0.1 s",
        ),
        (
            json!({"radius_m": 1, "spline": [[0, 0, 0], [1, 2000, 0]], "duration_s": 1}),
            "spline[1] must be no faster than 1000 m/s, got 4000",
        ),
    ];
    for (value, expected) in cases {
        let error = serde_json::from_value::<MovingObstacle>(value).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
