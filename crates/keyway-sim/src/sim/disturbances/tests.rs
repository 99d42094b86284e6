use super::*;
use keyway::geometry::{Pose, Velocity};
use keyway::robot::Robot;
use keyway::sense::Scan;
use serde_json::{Value, json};

/// Every field except the seed, with a valid value that disturbs and an invalid one.
const FIELDS: [(&str, &str, f64, f64); 29] = [
    ("sensor", "range_m", 0.01, 101.0),
    ("sensor", "range_relative", 0.01, 0.31),
    ("sensor", "dropped_beams", 1.0, 1.1),
    ("sensor", "dropped_scans", 0.5, 1.1),
    ("sensor", "repeated_scans", 0.5, 1.1),
    ("sensor", "delay_s", 0.2, 10.1),
    ("sensor", "stamp_late_s", 0.3, 0.31),
    ("sensor", "period_s", 0.2, 60.1),
    ("actuation", "delay_s", 0.1, 10.1),
    ("actuation", "v_relative", 0.05, 0.31),
    ("actuation", "omega_relative", 0.05, 0.31),
    ("actuation", "lag_s", 0.2, 10.1),
    ("actuation", "dead_band_mps", 0.02, 100.1),
    ("actuation", "dead_band_radps", 0.02, 100.1),
    ("actuation", "v_slip", 0.1, 0.91),
    ("actuation", "omega_slip", 0.1, 0.91),
    ("localisation", "position_m", 0.02, 101.0),
    ("localisation", "heading_rad", 0.02, 3.2),
    ("localisation", "correlation_s", 10.0, 1.1e6),
    ("localisation", "v_relative", 0.05, 0.31),
    ("localisation", "omega_relative", 0.05, 0.31),
    ("localisation", "drift", 0.02, 0.31),
    ("localisation", "heading_drift_radpm", 0.02, 1.1),
    ("localisation", "jump_m", 0.3, 101.0),
    ("localisation", "jump_rad", 0.3, 3.2),
    ("localisation", "jump_every_s", 20.0, 1.1e6),
    ("localisation", "jump_for_s", 20.0, 1.1e6),
    ("localisation", "delay_s", 0.2, 10.1),
    ("localisation", "stamp_late_s", 0.3, 0.31),
];

fn with(part: &str, field: &str, value: f64) -> Disturbances {
    let mut fields = json!({ field: value });
    if field.starts_with("jump_") && field != "jump_every_s" {
        fields["jump_every_s"] = json!(20.0);
    }
    if field == "stamp_late_s" {
        fields["delay_s"] = json!(0.3);
    }
    serde_json::from_value(json!({ part: fields })).unwrap()
}

#[test]
fn every_field_is_there_disturbs_and_is_checked() {
    let Value::Object(all) = serde_json::to_value(Disturbances::default()).unwrap() else {
        panic!()
    };
    // Their order depends on which other crates use the JSON crate.
    let mut names: Vec<&String> = all.keys().collect();
    names.sort();
    assert_eq!(names, ["actuation", "localisation", "seed", "sensor"]);
    let parts = ["sensor", "actuation", "localisation"].map(|part| all[part].as_object().unwrap());
    assert_eq!(parts.map(serde_json::Map::len).iter().sum::<usize>(), FIELDS.len() + 4);
    let silent = ["correlation_s", "jump_every_s", "jump_for_s"];
    for (part, field, usable, unusable) in FIELDS {
        let disturbances = with(part, field, usable);
        assert_eq!(disturbances.validate(), Ok(()));
        assert_eq!(disturbances.is_none(), silent.contains(&field), "{part}.{field}");
        for value in [unusable, -0.001] {
            let error = with(part, field, value).validate().unwrap_err();
            assert_eq!(error.path, format!("{part}.{field}"));
            assert!(error.reason.starts_with("must be "), "{error}");
            assert!(error.reason.ends_with(&format!(", got {value}")), "{error}");
        }
    }
    let mut none = Disturbances { seed: 9, ..Disturbances::default() };
    assert!(none.is_none() && none.validate().is_ok());
    none.actuation.delay_s = f64::NAN;
    assert_eq!(none.validate().unwrap_err().path, "actuation.delay_s");
}

#[test]
fn sectors_flags_and_jumps_are_checked() {
    let read = |text: &str| serde_json::from_str::<Disturbances>(text).unwrap();
    let error = |text: &str| read(text).validate().unwrap_err().to_string();
    let blind = read(r#"{"sensor": {"blind_deg": [[-30, 30], [170, -170]]}}"#);
    assert!(!blind.is_none() && blind.validate().is_ok());
    assert_eq!(
        error(r#"{"sensor": {"blind_deg": [[0, 10], [0, 361]]}}"#),
        "sensor.blind_deg must be angles from -360 to 360, got 361"
    );
    let lost = read(r#"{"sensor": {"lost": [1]}}"#);
    assert!(!lost.is_none() && lost.validate().is_ok());
    let held = read(r#"{"sensor": {"held_scans": true}}"#);
    assert!(!held.is_none() && held.validate().is_ok());
    let zero = read(r#"{"localisation": {"velocity_is_zero": true}}"#);
    assert!(!zero.is_none() && zero.validate().is_ok());
    assert_eq!(
        error(r#"{"localisation": {"jump_m": 0.3}}"#),
        "localisation.jump_every_s must be a time of at least 0.001 s if the pose jumps \
         (`jump_m`, `jump_rad`), got 0"
    );
    assert_eq!(
        error(r#"{"localisation": {"jump_every_s": 2, "jump_for_s": 3}}"#),
        "localisation.jump_for_s must be a time from 0 to `jump_every_s`, got 3"
    );
}

#[test]
fn what_depends_on_the_robot_is_checked_with_it() {
    let robot = Robot::small();
    let of = |text: &str| serde_json::from_str::<Disturbances>(text).unwrap();
    assert_eq!(of(r#"{"sensor": {"lost": [0], "delay_s": 10}}"#).validate_for(&robot), Ok(()));
    let error = |text: &str, robot: &Robot| of(text).validate_for(robot).unwrap_err().to_string();
    let lost = error(r#"{"sensor": {"lost": [0, 1]}}"#, &robot);
    assert_eq!(
        lost,
        "sensor.lost must be indices below 1, the number of the robot's sensors, got 1"
    );
    let mut fine = Robot { cycle_s: 0.001, ..robot.clone() };
    fine.sensors[0].beams = 100_000;
    let late = error(r#"{"sensor": {"delay_s": 10}}"#, &fine);
    assert!(late.starts_with("sensor.delay_s must be a time in which at most"), "{late}");
    assert_eq!(
        error(r#"{"sensor": {"delay_s": 11}}"#, &robot).split(' ').next(),
        Some("sensor.delay_s")
    );
}

#[test]
fn unknown_fields_are_refused() {
    for text in [r#"{"noise": 1}"#, r#"{"sensor": {"range": 1}}"#, r#"{"seed": -1}"#] {
        assert!(serde_json::from_str::<Disturbances>(text).is_err(), "{text}");
    }
    let text = r#"{"seed": 18446744073709551615, "sensor": {"range_m": 0.5}}"#;
    let disturbances: Disturbances = serde_json::from_str(text).unwrap();
    let range_m = disturbances.sensor.range_m;
    assert_eq!((disturbances.seed, range_m), (u64::MAX, 0.5));
    let again = serde_json::to_string(&disturbances).unwrap();
    assert_eq!(serde_json::from_str::<Disturbances>(&again).unwrap(), disturbances);
}

/// Draws of every kind in some cycles for a constant state: ranges, dropped beams, motions,
/// poses, velocities.
fn drawn(disturbances: Disturbances, robot: usize) -> [Vec<f64>; 5] {
    let source = Source { seed: disturbances.seed, robot, sensor: 0 };
    let exact = Scan { range_max_m: 4.0, ranges_m: vec![2.0; 20], ..Scan::default() };
    let robot = Robot { cycle_s: 0.1, ..Robot::jackal() };
    let (pose, velocity) = (Pose::new(1.0, 2.0, 0.5), Velocity::new(1.0, 0.5));
    let [mut ranges, mut dropped, mut driven, mut poses, mut velocities] =
        std::array::from_fn(|_| vec![]);
    let mut sensing = Sensing::new(disturbances.sensor, source, (&robot.sensors[0], robot.cycle_s));
    let mut actuation = Actuation::new(disturbances.actuation, source, &robot);
    let mut localisation = Localisation::new(disturbances.localisation, source, 0.1);
    for cycle in 0..40 {
        let mut scan = exact.clone();
        sensing.give(cycle, &mut scan);
        // Ranges of beams that are not dropped; the dropped ones are recorded separately.
        ranges.extend(scan.ranges_m.iter().copied().filter(|range_m| !range_m.is_nan()));
        dropped.extend(scan.ranges_m.iter().map(|range_m| f64::from(range_m.is_nan())));
        if let Some(actuation) = &mut actuation {
            let motion = actuation.motion(pose, velocity, velocity, &robot.limits);
            let reached = motion.velocity(4.0);
            driven.extend([reached.v, reached.omega]);
        }
        if let Some(localisation) = &mut localisation {
            let (pose, velocity) =
                localisation.told(TrueState { t_s: 0.0, pose, odometry: velocity, driven_m: 1.0 });
            poses.extend([pose.x, pose.y, pose.theta]);
            velocities.extend([velocity.v, velocity.omega]);
        }
    }
    [ranges, dropped, driven, poses, velocities]
}

#[test]
fn streams_are_independent() {
    let all = |seed| Disturbances {
        seed,
        sensor: SensorFaults { range_m: 0.01, dropped_beams: 0.1, ..SensorFaults::default() },
        actuation: ActuationFaults {
            v_relative: 0.05,
            omega_relative: 0.05,
            ..ActuationFaults::default()
        },
        localisation: LocalisationFaults {
            position_m: 0.1,
            heading_rad: 0.1,
            correlation_s: 1.0,
            v_relative: 0.05,
            omega_relative: 0.05,
            drift: 0.02,
            ..LocalisationFaults::default()
        },
    };
    let usual = drawn(all(1), 0);
    assert_eq!(usual, drawn(all(1), 0), "the same seed");
    for (what, other) in [("seed", drawn(all(2), 0)), ("robot", drawn(all(1), 1))] {
        for (kind, (a, b)) in usual.iter().zip(&other).enumerate() {
            assert_ne!(a, b, "another {what}, kind {kind}");
        }
    }
    // A change of one kind leaves the draws of the others unchanged.
    let same = |changed: Disturbances| {
        let other = drawn(changed, 0);
        std::array::from_fn::<bool, 5, _>(|kind| usual[kind] == other[kind])
    };
    let mut other = all(1);
    other.sensor.range_m = 0.02;
    assert_eq!(same(other), [false, true, true, true, true]);
    other = all(1);
    other.sensor.dropped_beams = 0.2;
    assert_eq!(same(other), [false, false, true, true, true]);
    other = all(1);
    other.actuation.v_relative = 0.1;
    assert_eq!(same(other), [true, true, false, true, true]);
    other = all(1);
    other.localisation.position_m = 0.2;
    assert_eq!(same(other), [true, true, true, false, true]);
    other = all(1);
    other.localisation.omega_relative = 0.1;
    assert_eq!(same(other), [true, true, true, true, false]);
}

#[test]
fn a_beam_has_the_same_error_whether_others_are_dropped_or_not() {
    let scan = |dropped_beams| {
        let noise = SensorFaults { range_m: 0.01, dropped_beams, ..SensorFaults::default() };
        let mut sensing = Sensing::new(
            noise,
            Source { seed: 3, robot: 0, sensor: 0 },
            (&Robot::small().sensors[0], 0.1),
        );
        let mut scan = Scan { range_max_m: 4.0, ranges_m: vec![2.0; 100], ..Scan::default() };
        sensing.give(0, &mut scan);
        scan.ranges_m
    };
    let (all, some) = (scan(0.0), scan(0.3));
    let kept: Vec<_> = all.iter().zip(&some).filter(|(_, range_m)| !range_m.is_nan()).collect();
    assert!(kept.len() > 50 && kept.len() < 90, "{}", kept.len());
    assert!(kept.iter().all(|(a, b)| a == b));
}
