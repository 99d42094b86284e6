use super::*;
use crate::sim::MovingObstacle;
use serde_json::json;

fn config(seed: u64) -> RandomWalkConfig {
    let area = [Point::new(-1.0, 2.0), Point::new(3.0, 5.0)];
    RandomWalkConfig {
        position: Point::new(0.0, 3.0),
        area,
        speed_mps: [0.5, 1.5],
        leg_s: [1.0, 4.0],
        seed: Some(seed),
    }
}

#[test]
fn reflects_at_both_sides() {
    let at = [0.0, 0.5, 1.0, 1.25, 2.0, 2.5, 4.25, -0.25, -1.5, -2.25];
    let expected = [0.0, 0.5, 1.0, 0.75, 0.0, 0.5, 0.25, 0.25, 0.5, 0.25];
    assert_eq!(at.map(|at| 7.0 + at).map(|at| reflected(at, 7.0, 8.0) - 7.0), expected);
}

#[test]
fn stays_in_its_area_for_ever_without_a_leap() {
    let walk = RandomWalk::new(config(3)).unwrap();
    let [low, high] = walk.config().area;
    let round_s = walk.last().t_s;
    assert!((2400.0..2600.0).contains(&round_s), "{round_s}");
    assert_eq!((walk.position(0.0), walk.position(-9.0)), (config(3).position, config(3).position));
    let mut mean = Point::default();
    for i in 0..100_000 {
        // Over four rounds of choices.
        let t_s = f64::from(i) * 0.1;
        let (at, next) = (walk.position(t_s), walk.position(t_s + 0.1));
        assert!((low.x..=high.x).contains(&at.x) && (low.y..=high.y).contains(&at.y), "{t_s}");
        let bound_m = 0.1 * walk.speed_bound_mps(t_s, t_s + 0.1);
        assert!(bound_m <= 0.15 + 1e-9 && at.distance(next) <= bound_m + 1e-9, "{t_s}");
        mean = mean + at * 1e-5;
    }
    // All positions are about equally frequent.
    assert!(mean.distance((low + high) * 0.5) < 0.2, "{mean:?}");
    // The same choices lead to another position.
    assert!(walk.position(round_s + 9.0).distance(walk.position(9.0)) > 0.1);
    for t_s in [f64::MAX, 1e18] {
        let at = walk.position(t_s);
        assert!((low.x..=high.x).contains(&at.x), "{at:?}");
    }
}

#[test]
fn choices_are_spread_over_their_bounds_and_follow_from_the_seed() {
    let walk = RandomWalk::new(config(11)).unwrap();
    let legs: Vec<(Point, f64)> = walk
        .unbounded
        .frames()
        .windows(2)
        .map(|pair| (pair[1].position - pair[0].position, pair[1].t_s - pair[0].t_s))
        .collect();
    assert_eq!(legs.len(), RandomWalkConfig::LEGS);
    let mean = |of: &dyn Fn(&(Point, f64)) -> f64| legs.iter().map(of).sum::<f64>() / 1000.0;
    // Standard deviations of the means: 0.009 m/s, 0.027 s and 0.022.
    assert!((mean(&|(way, leg_s)| way.norm() / leg_s) - 1.0).abs() < 0.05);
    assert!((mean(&|(_, leg_s)| *leg_s) - 2.5).abs() < 0.15);
    assert!(mean(&|(way, _)| libm::cos(way.heading())).abs() < 0.12);
    assert!(mean(&|(way, _)| libm::sin(way.heading())).abs() < 0.12);
    assert!(
        legs.iter().all(|(way, leg_s)| (0.5 - 1e-9..1.5 + 1e-9).contains(&(way.norm() / leg_s)))
    );
    assert_eq!(walk, RandomWalk::new(config(11)).unwrap());
    assert_ne!(walk.position(50.0), RandomWalk::new(config(12)).unwrap().position(50.0));
}

#[test]
fn a_walk_may_be_as_fast_as_anything() {
    let fastest =
        RandomWalkConfig { speed_mps: [100.0, 100.0], leg_s: [3600.0, 3600.0], ..config(1) };
    let walk = RandomWalk::new(fastest).unwrap();
    let bound_mps = walk.speed_bound_mps(0.0, 1e9);
    assert!((bound_mps - 100.0).abs() < 1e-6, "{bound_mps}");
}

#[test]
fn tables_are_refused_with_the_field() {
    let walk = |field: &str, value: serde_json::Value| {
        let mut walk = json!({"position": [1, 1], "area": [[0, 0], [4, 2]], "speed_mps": [0.5, 1],
                              "leg_s": [1, 2], "seed": 1});
        walk[field] = value;
        let table = json!({"radius_m": 1, "random_walk": walk});
        serde_json::from_value::<MovingObstacle>(table).unwrap_err().to_string()
    };
    for (field, value, expected) in [
        (
            "position",
            json!([1, 3]),
            "random_walk.position[1] must be within the area, from 0 to 2, got 3",
        ),
        (
            "area",
            json!([[0, 0], [0, 2]]),
            "random_walk.area[1][0] must be more than that of the other corner, 0, got 0",
        ),
        (
            "speed_mps",
            json!([-1, 1]),
            "random_walk.speed_mps[0] must be a number of at least 0, got -1",
        ),
        (
            "speed_mps",
            json!([1, 0.5]),
            "random_walk.speed_mps[1] must be at least the first one, 1, got 0.5",
        ),
        (
            "speed_mps",
            json!([1, 101]),
            "random_walk.speed_mps[1] must be no faster than 100 m/s, got 101 m/s",
        ),
        ("leg_s", json!([0, 1]), "random_walk.leg_s[0] must be from 0.1 to 3600 s, got 0"),
        ("leg_s", json!([2, 1]), "random_walk.leg_s[1] must be at least the first one, 2, got 1"),
        ("seed", json!(-1), "invalid value: integer `-1`"),
        ("seeds", json!(1), "unknown field `seeds`"),
    ] {
        let error = walk(field, value);
        assert!(error.contains(expected), "{error}");
    }
}
