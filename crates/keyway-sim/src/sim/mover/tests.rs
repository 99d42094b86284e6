use super::*;
use proptest::prelude::*;
use serde_json::json;

/// A position near the origin.
fn place() -> impl Strategy<Value = Point> {
    (-1.5..1.5f64, -1.5..1.5f64).prop_map(|(x, y)| Point::new(x, y))
}

/// A spline near the origin at up to 6 m/s; its lap may end at its first position, or later than
/// its last key frame.
fn spline() -> impl Strategy<Value = ObstacleMotion> {
    let frames = prop::collection::vec((0.1..1.2f64, place()), 2..7);
    (frames, 0.0..0.5f64, any::<bool>(), prop_oneof![Just(0.0), 0.0..0.5f64]).prop_map(
        |(steps, first_s, is_closed, rest_s)| {
            let mut t_s = first_s;
            let mut frames: Vec<KeyFrame> = Vec::new();
            for (step_s, position) in steps {
                frames.push(KeyFrame { t_s, position });
                t_s += step_s;
            }
            let last = frames.len() - 1;
            if is_closed {
                frames[last].position = frames[0].position;
            }
            // Speeds are proportional to the lengths, whose derivatives are at most four steps
            // per segment.
            let leg = |pair: &[KeyFrame]| pair[0].position.distance(pair[1].position);
            let longest_m = frames.windows(2).map(leg).fold(0.0, f64::max);
            let gaps = frames.windows(2).map(|pair| pair[1].t_s - pair[0].t_s);
            let scale = (gaps.fold(1.0, f64::min) * 1.2 / longest_m).min(1.0);
            for frame in &mut frames {
                frame.position = frame.position * scale;
            }
            let duration_s = (frames[last].t_s + rest_s).max(Spline::SHORTEST_S);
            ObstacleMotion::Spline(Spline::new(frames, duration_s).unwrap())
        },
    )
}

fn random_walk() -> impl Strategy<Value = ObstacleMotion> {
    let area = (prop::array::uniform2((-1.5..1.4f64, 0.001..1.0f64)), (0.0..=1.0f64, 0.0..=1.0f64));
    let speeds = (0.0..1.0f64, 0.0..5.0f64);
    (area, speeds, (0.1..0.5f64, 0.0..0.5f64), 0..u64::from(u32::MAX)).prop_map(
        |(([x, y], part), speed, leg, seed)| {
            let area = [Point::new(x.0, y.0), Point::new(x.0 + x.1, y.0 + y.1)];
            let position = Point::new(x.0 + x.1 * part.0, y.0 + y.1 * part.1);
            let position = Point::new(position.x.min(area[1].x), position.y.min(area[1].y));
            let (speed_mps, leg_s) = ([speed.0, speed.0 + speed.1], [leg.0, leg.0 + leg.1]);
            let config = RandomWalkConfig { position, area, speed_mps, leg_s, seed: Some(seed) };
            ObstacleMotion::RandomWalk(RandomWalk::new(config).unwrap())
        },
    )
}

/// An obstacle of any motion near the origin, at up to 6 m/s.
pub(in crate::sim) fn moving_obstacle() -> impl Strategy<Value = MovingObstacle> {
    let straight = (place(), place())
        .prop_map(|(from, velocity_mps)| ObstacleMotion::Straight { from, velocity_mps });
    let frames = (prop::collection::vec((0.5..1.2f64, place()), 1..7), 0.0..1.0f64);
    let key_frames = frames.prop_map(|(steps, first_s)| {
        let mut t_s = first_s;
        let frames = steps.into_iter().map(|(step_s, position)| {
            t_s += step_s;
            KeyFrame { t_s, position }
        });
        ObstacleMotion::KeyFrames(KeyFrames::new(frames.collect()).unwrap())
    });
    let way_points = (prop::collection::vec(place(), 2..6), 0.1..6.0f64, any::<bool>()).prop_map(
        |(points, speed_mps, to_and_fro)| {
            ObstacleMotion::WayPoints(WayPoints::new(points, speed_mps, to_and_fro).unwrap())
        },
    );
    let motion = prop_oneof![straight, key_frames, spline(), way_points, random_walk()];
    (motion, 0.0..0.3f64)
        .prop_map(|(motion, radius_m)| MovingObstacle::new(radius_m, motion).unwrap())
}

/// Position of an obstacle, found by following its motion from the beginning.
pub(in crate::sim) fn place_of(mover: &MovingObstacle, t_s: f64) -> Point {
    match mover.motion() {
        ObstacleMotion::Straight { from, velocity_mps } => {
            Point::new(from.x + velocity_mps.x * t_s, from.y + velocity_mps.y * t_s)
        }
        ObstacleMotion::KeyFrames(frames) => {
            let frames = frames.frames();
            let mut at = frames[0].position;
            for pair in frames.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let part = ((t_s - from.t_s) / (to.t_s - from.t_s)).clamp(0.0, 1.0);
                at = at + (to.position - from.position) * part;
            }
            at
        }
        ObstacleMotion::GivesWay(way) => way.points()[0],
        ObstacleMotion::Spline(spline) => place_on_spline(spline, t_s),
        ObstacleMotion::RandomWalk(walk) => place_on_walk(walk.config(), t_s),
        ObstacleMotion::WayPoints(way) => {
            let points = way.points();
            let last = points.len() - 1;
            let (mut at, mut ahead, mut left_m) = (0, true, way.speed_mps() * t_s);
            loop {
                if way.is_to_and_fro() {
                    ahead = if ahead { at < last } else { at == 0 };
                }
                let next = if ahead { (at + 1) % points.len() } else { at - 1 };
                let leg = points[next] - points[at];
                if left_m <= leg.norm() {
                    return points[at] + leg * (left_m / leg.norm());
                }
                left_m -= leg.norm();
                at = next;
            }
        }
    }
}

/// `Spline::RecalcTangents` and `Spline::Interpolate` of the simulator Gazebo 2 to 9, transcribed
/// with powers and a matrix.
fn place_on_spline(spline: &Spline, t_s: f64) -> Point {
    let points: Vec<Point> = spline.frames().iter().map(|frame| frame.position).collect();
    let (n, is_closed) = (points.len(), points[0] == points[points.len() - 1]);
    let tension = 0.0;
    let mut tangents = vec![Point::default(); n];
    for i in 0..n {
        let twice = if i == 0 {
            if is_closed { points[1] - points[n - 2] } else { points[1] - points[0] }
        } else if i == n - 1 {
            if is_closed { tangents[0] * 2.0 } else { points[i] - points[i - 1] }
        } else {
            points[i + 1] - points[i - 1]
        };
        tangents[i] = twice * 0.5 * (1.0 - tension);
    }
    let mut laps = 0;
    while f64::from(laps + 1) * spline.duration_s() <= t_s {
        laps += 1;
    }
    let t_s = t_s - f64::from(laps) * spline.duration_s();
    let times: Vec<f64> = spline.frames().iter().map(|frame| frame.t_s).collect();
    if t_s <= times[0] {
        return points[0];
    }
    let Some(next) = times.iter().position(|&time_s| time_s > t_s) else { return points[n - 1] };
    let from = next - 1;
    let t = (t_s - times[from]) / (times[next] - times[from]);
    let powers = [t * t * t, t * t, t, 1.0];
    let coefficients = [
        [2.0, -2.0, 1.0, 1.0],
        [-3.0, 3.0, -2.0, -1.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
    ];
    let ends = [points[from], points[next], tangents[from], tangents[next]];
    let mut place = Point::default();
    for (power, row) in powers.iter().zip(coefficients) {
        for (coefficient, end) in row.into_iter().zip(ends) {
            place = place + end * (power * coefficient);
        }
    }
    place
}

/// Position on a random walk, found leg by leg and wall by wall.
fn place_on_walk(config: &RandomWalkConfig, t_s: f64) -> Point {
    let RandomWalkConfig { position, area: [low, high], speed_mps, leg_s, seed } = *config;
    let mut random = keyway::random::Random::new(seed.unwrap());
    let mut between = |bounds: [f64; 2]| {
        bounds[0] + (bounds[1] - bounds[0]) * (random.bits() >> 11) as f64 / 2.0_f64.powi(53)
    };
    let (mut at, mut left_s) = ([position.x, position.y], t_s);
    let walls = [[low.x, high.x], [low.y, high.y]];
    // A wall also reflects the later choices.
    let mut turned = [false; 2];
    while left_s > 0.0 {
        let heading = between([0.0, 2.0 * std::f64::consts::PI]);
        let speed = between(speed_mps);
        let drive_s = between(leg_s).min(left_s);
        left_s -= drive_s;
        for (axis, direction) in [libm::cos(heading), libm::sin(heading)].into_iter().enumerate() {
            let mut to_go = (speed * direction).abs() * drive_s;
            loop {
                let ahead = (direction > 0.0) != turned[axis];
                let to_wall = (walls[axis][usize::from(ahead)] - at[axis]).abs();
                let step = to_go.min(to_wall);
                at[axis] += if ahead { step } else { -step };
                to_go -= step;
                if to_go <= 0.0 {
                    break;
                }
                turned[axis] = !turned[axis];
            }
        }
    }
    Point::new(at[0], at[1])
}

proptest! {
    #[test]
    fn places_are_those_of_walking_along(mover in moving_obstacle(), t_s in 0.0..30.0f64) {
        let (at, walked) = (mover.at(t_s).centre, place_of(&mover, t_s));
        prop_assert!(at.distance(walked) < 1e-9, "{at:?} {walked:?}");
    }

    /// The speed never exceeds the bound, and reaches it somewhere; a part of an interval has no
    /// higher bound.
    #[test]
    fn speed_bounds_hold_and_are_reached(
        mover in moving_obstacle(), from_s in -1.0..6.0f64, long_s in 0.001..3.0f64, part in (0.0..1.0f64, 0.0..1.0f64),
    ) {
        let bound_mps = mover.motion().speed_bound_mps(from_s, from_s + long_s);
        let step_s = long_s / 2000.0;
        let time_s = |i: u32| from_s + f64::from(i) * step_s;
        let at = |i: u32| mover.motion().position(time_s(i));
        let jumps = |i: u32| mover.motion().next_jump_s(time_s(i)).is_some_and(|jump_s| jump_s <= time_s(i + 1));
        let moved = (0..2000).filter(|&i| !jumps(i)).map(|i| at(i).distance(at(i + 1)) / step_s);
        let fastest_mps = moved.fold(0.0, f64::max);
        prop_assert!(fastest_mps <= bound_mps + 1e-6, "{fastest_mps} {bound_mps}");
        // Sampling may miss a segment with less than a step inside the interval, or a round of
        // few steps.
        let (a, b) = (from_s + long_s * part.0.min(part.1), from_s + long_s * part.0.max(part.1));
        prop_assert!(mover.motion().speed_bound_mps(a, b) <= bound_mps * (1.0 + 1e-9) + 1e-12);
        if let ObstacleMotion::KeyFrames(frames) = mover.motion() {
            let is_inside = |t_s: f64| t_s > from_s - step_s && t_s < from_s + long_s + step_s;
            if !frames.frames().iter().any(|frame| is_inside(frame.t_s)) {
                prop_assert!(fastest_mps >= bound_mps - 1e-6, "{fastest_mps} {bound_mps}");
            }
        }
    }

    #[test]
    fn files_keep_every_motion(mover in moving_obstacle()) {
        let text = toml::to_string(&mover).unwrap();
        prop_assert_eq!(toml::from_str::<MovingObstacle>(&text).unwrap(), mover);
    }
}

#[test]
fn key_frames_by_hand() {
    let frame = |t_s, x| KeyFrame { t_s, position: Point::new(x, 1.0) };
    let frames =
        KeyFrames::new(vec![frame(1.0, 0.0), frame(3.0, 4.0), frame(7.0, 4.0), frame(8.0, 3.0)]);
    let frames = frames.unwrap();
    let x = |t_s| frames.position(t_s).x;
    assert_eq!(
        [x(-5.0), x(1.0), x(2.0), x(3.0), x(5.0), x(7.5), x(99.0)],
        [0.0, 0.0, 2.0, 4.0, 4.0, 3.5, 3.0]
    );
    let bound = |from_s, to_s| frames.speed_bound_mps(from_s, to_s);
    assert_eq!(
        [bound(0.0, 0.5), bound(0.5, 1.5), bound(4.0, 5.0), bound(4.0, 7.1), bound(9.0, 10.0)],
        [0.0, 2.0, 0.0, 1.0, 0.0]
    );
    // A key frame belongs to the segments on both sides.
    assert_eq!(
        [bound(3.0, 4.0), bound(2.5, 8.5), bound(8.0, 9.0), bound(0.0, 1.0)],
        [2.0, 2.0, 1.0, 2.0]
    );
    let alone = KeyFrames::new(vec![frame(1.0, 2.0)]).unwrap();
    assert_eq!((alone.position(0.0).x, alone.position(2.0).x), (2.0, 2.0));
    assert_eq!(alone.speed_bound_mps(0.0, 2.0), 0.0);
}

#[test]
fn way_points_by_hand() {
    let corners = || [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]].map(Point::from).to_vec();
    let around = WayPoints::around(corners(), 2.0).unwrap();
    let at = |t_s| around.position(t_s);
    assert_eq!([at(0.0), at(1.5), at(2.5)], [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0]].map(Point::from));
    // Back along the diagonal of 5 m, then from the beginning.
    assert!(at(4.75).distance(Point::new(1.5, 2.0)) < 1e-12);
    assert_eq!((at(6.0), at(7.0), at(60.5)), (at(0.0), at(1.0), at(0.5)));
    let back = WayPoints::to_and_fro(corners(), 1.0).unwrap();
    let at = |t_s| back.position(t_s);
    assert_eq!((at(7.0), at(8.0), at(12.0)), (Point::new(3.0, 4.0), at(6.0), at(2.0)));
    assert_eq!((at(14.0), at(15.0)), (at(0.0), at(1.0)));
}

#[test]
fn refuses_what_cannot_be() {
    let error = |value: serde_json::Value| {
        serde_json::from_value::<MovingObstacle>(value).unwrap_err().to_string()
    };
    let cases = [
        (
            json!({"radius_m": -1, "position": [0, 0], "velocity_mps": [1, 0]}),
            "radius_m must be a number of at least 0, got -1",
        ),
        (
            json!({"radius_m": 1, "position": [0, 0]}),
            "the motion must be `position` and `velocity_mps`, or",
        ),
        (json!({"radius_m": 1}), "got none of them"),
        (
            json!({"radius_m": 1, "key_frames": [[0, 1, 1]], "speed_mps": 1}),
            "got `key_frames`, `speed_mps`",
        ),
        (json!({"radius_m": 1, "key_frames": []}), "key_frames must hold at least 1 key frame"),
        (
            json!({"radius_m": 1, "key_frames": [[1, 0, 0], [1, 1, 0]]}),
            "key_frames[1].t_s must be later than the one before it, at 1 s, got 1",
        ),
        (
            json!({"radius_m": 1, "way_points": [[1, 0], [1, 0]], "speed_mps": 1}),
            "way_points must hold at least two different points",
        ),
        (
            json!({"radius_m": 1, "way_points": [], "speed_mps": 1}),
            "way_points must hold at least two",
        ),
        (
            json!({"radius_m": 1, "way_points": [[1, 0], [2, 0]], "speed_mps": 0}),
            "speed_mps must be a positive number, got 0",
        ),
        (
            json!({"radius_m": 1, "position": [0, 0], "velocity_mps": [0, 0], "to_and_fro": true}),
            "to_and_fro is a field of a motion along `way_points`",
        ),
        (
            json!({"radius_m": 1, "position": [0, 0], "velocity_mps": [0, 0], "speed": 1}),
            "unknown field `speed`",
        ),
    ];
    for (value, expected) in cases {
        let error = error(value);
        assert!(error.contains(expected), "{error}");
    }
    let nan = Point::new(0.0, f64::NAN);
    let of =
        |from, velocity_mps| MovingObstacle::straight(from, 0.1, velocity_mps).unwrap_err().path;
    assert_eq!(of(nan, Point::default()), "position[1]");
    assert_eq!(of(Point::default(), nan), "velocity_mps[1]");
    assert_eq!(of(Point::default(), Point::new(f64::MAX, f64::MAX)), "velocity_mps");
    let frame = |t_s, position| KeyFrame { t_s, position };
    let frames = |frames| KeyFrames::new(frames).unwrap_err().path;
    assert_eq!(frames(vec![frame(0.0, nan)]), "key_frames[0].position[1]");
    assert_eq!(frames(vec![frame(f64::INFINITY, Point::default())]), "key_frames[0].t_s");
    let far = vec![frame(0.0, Point::new(-1e308, 0.0)), frame(1.0, Point::new(1e308, 0.0))];
    assert_eq!(frames(far), "key_frames[1]");
    let course = |points, speed_mps| WayPoints::around(points, speed_mps).unwrap_err().path;
    assert_eq!(course(vec![Point::default(), nan], 1.0), "way_points[1][1]");
    let fast = |x: f64| MovingObstacle::straight(Point::default(), 0.1, Point::new(x, 0.0));
    assert!(fast(100.0).is_ok());
    let text = fast(101.0).unwrap_err().to_string();
    assert_eq!(text, "velocity_mps must be no faster than 100 m/s, got 101 m/s");
    assert_eq!(course(vec![Point::default(), Point::new(1.0, 0.0)], 1e9), "speed_mps");
    let jump = vec![frame(0.0, Point::default()), frame(1e-3, Point::new(1.0, 0.0))];
    assert_eq!(frames(jump), "key_frames[1]");
    assert_eq!(course(vec![Point::new(-1e308, 0.0), Point::new(1e308, 0.0)], 1.0), "way_points");
}
