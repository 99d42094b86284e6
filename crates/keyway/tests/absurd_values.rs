//! Values that are finite and yet absurd, in every number of every stack: refused by name, or
//! harmless.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::{bound_for, next_step};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::guide::GuideConfig;
use keyway::local::{Explanation, LocalConfig};
use keyway::map::OccupancyGrid;
use keyway::navigate::{NavigateError, Stack};
use keyway::robot::{Footprint, Limits, RangeSensor, Robot};
use keyway::sense::Scan;
use keyway::smooth::SmootherConfig;
use proptest::prelude::*;
use serde_json::Value;

const START: Point = Point::new(1.5, 2.0);

fn hall() -> OccupancyGrid {
    OccupancyGrid::from_ascii(&["..........", "......#...", "..........", ".........."])
}

/// An obstacle 1 m ahead, to the left of the route.
fn scan() -> Scan {
    let range = |beam: i32| if (10..14).contains(&beam) { 1.0 } else { f64::INFINITY };
    Scan {
        angle_min_rad: -1.0,
        angle_increment_rad: 0.1,
        range_min_m: 0.05,
        range_max_m: 3.0,
        ranges_m: (0..20).map(range).collect(),
    }
}

/// The paths of all numbers that are not counts.
fn numbers(json: &Value, path: &str, found: &mut Vec<String>) {
    match json {
        Value::Number(number) if number.is_f64() => found.push(path.to_owned()),
        Value::Object(fields) => {
            fields.iter().for_each(|(name, part)| numbers(part, &format!("{path}/{name}"), found));
        }
        _ => {}
    }
}

fn has_a_number_that_is_none(explanation: &Explanation) -> bool {
    let text = format!("{explanation:?}");
    text.contains("NaN")
}

/// Drives a few cycles, towards the obstacle and around it.
fn drive(stack: &Stack, robot: &Robot, what: &str) -> Result<(), NavigateError> {
    let mut navigator = bound_for(&hall(), &stack.fit(robot)?, START, Point::new(8.5, 1.5))?;
    let mut pose = Pose::new(START.x, START.y, 0.3);
    let mut velocity = Velocity::ZERO;
    for _ in 0..3 {
        velocity = next_step(&mut navigator, pose, velocity, &scan()).command();
        assert!(velocity.v.is_finite() && velocity.omega.is_finite(), "{what}");
        velocity = robot.limits.reached(Velocity::ZERO, velocity, robot.cycle_s);
        pose = pose.after_arc(velocity, robot.cycle_s);
    }
    assert!(!has_a_number_that_is_none(&navigator.explain()), "{what}");
    Ok(())
}

/// Every local planner, guide and smoother, one at a time with the defaults for the rest, and the
/// parts that are its own.
fn stacks(robot: &Robot) -> Vec<(String, &'static [&'static str], Stack)> {
    let usual = Stack::key_point_fusion(robot);
    let mut stacks = Vec::new();
    for name in LocalConfig::NAMES {
        let local = LocalConfig::by_name(name, robot).unwrap();
        stacks.push((name.to_owned(), &["local"][..], Stack { local, ..usual.clone() }));
    }
    for name in GuideConfig::NAMES {
        let guide = GuideConfig::by_name(name, robot).unwrap();
        stacks.push((name.to_owned(), &["guide"][..], Stack { guide, ..usual.clone() }));
    }
    for name in SmootherConfig::NAMES {
        let smoother = SmootherConfig::by_name(name).unwrap();
        stacks.push((name.to_owned(), &["smoother"][..], Stack { smoother, ..usual.clone() }));
    }
    stacks.push(("the rest".to_owned(), &["map", "planner", "controller"], usual));
    stacks
}

#[test]
fn absurd_values_are_refused_by_name_or_harmless() {
    let robot = Robot::small();
    let (mut refused, mut driven, mut wrong) = (0, 0, Vec::new());
    for (name, parts, stack) in stacks(&robot) {
        let json = serde_json::to_value(&stack).unwrap();
        let mut paths = Vec::new();
        for part in parts {
            numbers(&json[part], &format!("/{part}"), &mut paths);
        }
        for path in paths {
            for value in [1e300, f64::MAX, 1e-300, -1e300] {
                let mut changed = json.clone();
                *changed.pointer_mut(&path).unwrap() = value.into();
                let Ok(changed) = serde_json::from_value::<Stack>(changed) else { continue };
                let what = format!("{name}: {path} = {value:e}");
                match drive(&changed, &robot, &what) {
                    Ok(()) => driven += 1,
                    Err(NavigateError::Config(error)) => {
                        let field = path[1..].replace('/', ".");
                        let text = error.to_string();
                        let last = field.rsplit('.').next().unwrap();
                        if error.path != field && !text.contains(last) {
                            wrong.push(format!("{what}: {text}"));
                        }
                        refused += 1;
                    }
                    Err(other) => wrong.push(format!("{what}: {other}")),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(refused > 50 && driven > 50, "{refused} refused, {driven} driven");
}

/// Any valid robot, up to the ends of the permitted ranges.
fn any_robot() -> impl Strategy<Value = Robot> {
    let between = |low: f64, high: f64| (low.ln()..high.ln()).prop_map(f64::exp);
    let footprint = prop_oneof![
        Just(0.0).prop_map(|radius_m| Footprint::circle(radius_m).unwrap()),
        between(1e-4, 100.0).prop_map(|radius_m| Footprint::circle(radius_m).unwrap()),
        (between(0.01, 100.0), between(0.01, 100.0))
            .prop_map(|(length_m, width_m)| Footprint::rectangle(length_m, width_m).unwrap()),
    ];
    let rates = (between(1e-4, 1e4), between(1e-4, 1e4), between(1e-4, 1e4), between(1e-4, 1e4));
    let radii = prop_oneof![Just(0.0), between(1e-4, 100.0)];
    let speeds = (between(1e-4, 100.0), between(1e-4, 100.0), 0.0..=1.0f64, radii);
    let margins = prop_oneof![Just(None), between(1e-4, 10.0).prop_map(Some)];
    let cycles = (between(1e-3, 10.0), 0.0..=10.0f64, margins);
    (footprint, cycles, speeds, rates).prop_map(
        |(footprint, (cycle_s, actuation_delay_s, safety_margin_m), speeds, rates)| {
            let limits = Limits {
                v_min_mps: -speeds.2 * speeds.0,
                v_max_mps: speeds.0,
                omega_max_radps: speeds.1,
                min_turning_radius_m: speeds.3,
                acceleration_mps2: rates.0,
                deceleration_mps2: rates.1,
                angular_acceleration_radps2: rates.2,
                angular_deceleration_radps2: rates.3,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            };
            let sensors = vec![RangeSensor::new(90, 360.0, 5.0)];
            Robot { footprint, cycle_s, actuation_delay_s, safety_margin_m, limits, sensors }
        },
    )
}

proptest! {
    /// So no error ever names a derived parameter that the user has not set.
    #[test]
    fn what_is_derived_from_a_robot_fits_it(robot in any_robot()) {
        prop_assume!(robot.validate().is_ok());
        for (name, _, stack) in stacks(&robot) {
            prop_assert!(stack.fit(&robot).is_ok(), "{}", name);
        }
    }
}
