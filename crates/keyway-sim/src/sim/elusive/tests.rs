use super::*;
use crate::sim::{
    Action, Control, Disturbances, Obstacle, Outcome, Participant, Run, RunRules, World, simulate,
};
use keyway::geometry::Velocity;
use keyway::map::{BitGrid, GridFrame};
use keyway::robot::{RangeSensor, Robot};
use keyway::sense::Observation;

/// A hall of 10 m x 4 m without walls.
fn hall() -> World {
    let frame = GridFrame::new(100, 40, 0.1, Pose::default()).unwrap();
    World::new(frame, BitGrid::new(100, 40, false), Vec::new()).unwrap()
}

fn disc(x: f64, presence: Presence) -> ElusiveObstacle {
    let shape = ElusiveShape::Disc(Disc::new(Point::new(x, 2.0), 0.3));
    ElusiveObstacle::new(shape, presence).unwrap()
}

/// A wall across the hall at x = 4 m.
fn gate(presence: Presence) -> ElusiveObstacle {
    let corners = [[4.0, 0.1], [4.1, 0.1], [4.1, 3.9], [4.0, 3.9]].map(Point::from);
    let shape = ElusiveShape::Polygon(StandingPolygon::new(corners.to_vec()).unwrap());
    ElusiveObstacle::new(shape, presence).unwrap()
}

const fn from(from_s: f64) -> Presence {
    Presence { from_s, ..Presence::ALWAYS }
}

const fn until(until_s: f64) -> Presence {
    Presence { until_s: Some(until_s), ..Presence::ALWAYS }
}

/// Drives straight ahead from x = 1 m at a speed, for 10 s; returns the run and the number of
/// hits in each cycle.
fn driven(elusive: ElusiveObstacle, v_mps: f64) -> (Run, Vec<usize>) {
    let world = hall().with_elusive(vec![elusive]);
    let mut robot = Robot::small();
    robot.limits.acceleration_mps2 = 1e4;
    let mut hits = Vec::new();
    let mut controller = |&Observation { pose, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        hits.push(scan.ranges_m.iter().filter(|range_m| range_m.is_finite()).count());
        let action = Action::Drive(Velocity::new(v_mps, 0.0));
        Control {
            action,
            remaining_m: -pose.x - 100.0 * hits.len() as f64,
            route: 0,
            turn_left_rad: 0.0,
        }
    };
    let participant = Participant {
        robot: &robot,
        start: Pose::new(1.0, 2.0, 0.0),
        goal: Point::new(9.0, 3.5),
        disturbances: Disturbances::default(),
        rules: RunRules { time_limit_s: 10.0, ..RunRules::default() },
        controller: &mut controller,
    };
    let run = simulate(&world, &mut [participant]).unwrap().remove(0);
    (run, hits)
}

fn time_s(run: &Run) -> f64 {
    run.samples.last().unwrap().t_s
}

#[test]
fn what_appears_is_seen_and_touched_from_then_on() {
    let (run, hits) = driven(disc(3.0, from(2.0)), 0.5);
    assert!(hits[..20].iter().all(|&hits| hits == 0) && hits[20..].iter().all(|&hits| hits > 0));
    // The near side of the disc is 2.7 m from the origin; the robot's front is 0.18 m ahead of
    // its centre.
    let way_m = 2.7 - 0.18 - 1.0;
    assert!((run.length_m - way_m).abs() < 2e-4, "{}", run.length_m);
    let Outcome::Collided { with: Obstacle::Elusive(0), jumped_onto: false, .. } = run.outcome
    else {
        panic!("{:?}", run.outcome)
    };
    // The clearance counts from the time at which the obstacle appears.
    assert_eq!(run.min_clearance_m, Some(0.0));
    let (late, _) = driven(disc(3.0, from(9.0)), 0.5);
    assert_eq!(late.outcome, Outcome::Timeout);
    // The far side is at 3.3 m. The robot accelerates within the first cycle.
    let back_m = 1.0 + (9.0 - 0.05) * 0.5 - 0.18;
    assert!((late.min_clearance_m.unwrap() - (back_m - 3.3)).abs() < 1e-3, "{late:?}");
}

#[test]
fn what_goes_lets_pass() {
    // The front reaches the gate after (4 - 1.18) m / 0.5 m/s = 5.64 s, plus 0.05 s of
    // acceleration.
    let (run, hits) = driven(gate(until(5.0)), 0.5);
    assert_eq!(run.outcome, Outcome::Timeout);
    assert!(hits[49] > 0 && hits[50..].iter().all(|&hits| hits == 0));
    let (run, _) = driven(gate(until(6.0)), 0.5);
    assert!(matches!(run.outcome, Outcome::Collided { with: Obstacle::Elusive(0), .. }));
    assert!((time_s(&run) - 5.69).abs() < 1e-3, "{}", time_s(&run));
}

#[test]
fn what_appears_on_the_robot_is_a_contact_at_once_and_told_apart() {
    for (v_mps, at_m) in [(0.0, 1.0), (0.5, 2.0)] {
        let (run, _) = driven(disc(at_m, from(2.0)), v_mps);
        let Outcome::Collided { with: Obstacle::Elusive(0), jumped_onto, robot_stood, .. } =
            run.outcome
        else {
            panic!("{:?}", run.outcome)
        };
        assert!(jumped_onto && robot_stood == (v_mps == 0.0), "{:?}", run.outcome);
        assert!((time_s(&run) - 2.0).abs() < 1e-9, "{}", time_s(&run));
    }
}

#[test]
fn a_sensor_sees_the_share_that_is_told() {
    let share = |seen| Presence { seen, ..Presence::ALWAYS };
    let (_, all) = driven(disc(3.0, Presence::ALWAYS), 0.0);
    let (_, some) = driven(disc(3.0, share(0.3)), 0.0);
    let (_, none) = driven(disc(3.0, share(0.0)), 0.0);
    assert!(none.iter().all(|&hits| hits == 0));
    // At 2 m with a radius of 0.3 m: 17 of 360 beams, in 100 scans.
    assert!(all.iter().all(|&hits| hits == 17), "{all:?}");
    let hits: usize = some.iter().sum();
    // Expected are 510 with a standard deviation of 19.
    assert!((434..=586).contains(&hits), "{hits}");
    assert!(some.windows(2).any(|pair| pair[0] != pair[1]), "drawn anew in every scan");
    // Contact nevertheless.
    let (run, _) = driven(disc(3.0, share(0.0)), 0.5);
    assert!(matches!(run.outcome, Outcome::Collided { with: Obstacle::Elusive(0), .. }));
}

#[test]
fn beams_that_miss_it_see_what_is_behind() {
    let glass = gate(Presence { seen: 0.5, ..Presence::ALWAYS });
    let mut world = hall().with_elusive(vec![glass]);
    world = world.with_polygons(vec![
        StandingPolygon::new(
            [[6.0, 0.1], [6.1, 0.1], [6.1, 3.9], [6.0, 3.9]].map(Point::from).to_vec(),
        )
        .unwrap(),
    ]);
    let sensor = RangeSensor::new(101, 20.0, 8.0);
    let scan = world.at(0.0).cast(Pose::new(1.0, 2.0, 0.0), &sensor);
    let mut counts = [0; 2];
    for (beam, range_m) in scan.ranges_m.iter().enumerate() {
        let x = 1.0 + range_m * libm::cos(scan.bearing_rad(beam));
        let wall = usize::from(x > 5.0);
        assert!((x - [4.0, 6.0][wall]).abs() < 1e-9, "{x}");
        counts[wall] += 1;
    }
    // Expected are 50 each with a standard deviation of 5.
    assert!(counts[0] > 30 && counts[1] > 30, "{counts:?}");
}

#[test]
fn bad_values_are_named() {
    let error = |presence: Presence| presence.validate().unwrap_err().to_string();
    assert_eq!(error(from(-1.0)), "from_s must be a time from 0 to 1000000000 s, got -1");
    let never = Presence { from_s: 3.0, ..until(3.0) };
    assert_eq!(error(never), "until_s must be a time after `from_s`, got 3");
    assert!(until(f64::NAN).validate().is_err());
    let seen = Presence { seen: 1.5, ..Presence::ALWAYS };
    assert_eq!(error(seen), "seen must be a share from 0 to 1, got 1.5");
    let shape = ElusiveShape::Disc(Disc::new(Point::new(f64::NAN, 0.0), 0.3));
    assert!(ElusiveObstacle::new(shape, Presence::ALWAYS).is_err());
}

#[test]
fn a_report_shows_shape_and_times() {
    let row = |elusive: ElusiveObstacle| serde_json::to_value(elusive).unwrap();
    assert_eq!(
        row(disc(3.0, from(2.0))),
        serde_json::json!({
            "position": [3.0, 2.0], "radius_m": 0.3, "from_s": 2.0, "until_s": null, "seen": 1.0,
        })
    );
    assert_eq!(row(gate(until(2.0)))["vertices_m"][2], serde_json::json!([4.1, 3.9]));
}
