//! Navigators are stored and restored.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use ciborium::Value;
use keyway::geometry::{Disc, Point, Pose};
use keyway::map::OccupancyGrid;
use keyway::navigate::{Navigator, RestoreError, Snapshot, Stack, Step};
use keyway::robot::{RangeSensor, Robot};
use keyway::sense::Observation;
use keyway_sim::sim::{
    Action, Control, Disturbances, MovingObstacle, Outcome, Participant, Run, RunRules, World,
    simulate,
};

/// Restores a navigator from the bytes of another one.
fn taken_up(navigator: &Navigator) -> Navigator {
    let mut bytes = Vec::new();
    ciborium::into_writer(&navigator.snapshot(), &mut bytes).unwrap();
    let snapshot: Snapshot = ciborium::from_reader(&bytes[..]).unwrap();
    Navigator::restore(snapshot).unwrap()
}

struct Case {
    robot: Robot,
    stack: Stack,
    disturbances: Disturbances,
    goal: Point,
}

/// Drives with obstacles on the route in every case: unmapped posts, walkers, a door.
fn drive(case: &Case, map: &OccupancyGrid, is_stored: bool) -> Run {
    let Case { robot, stack, disturbances, goal } = case;
    let walker = |from: [f64; 2], velocity: [f64; 2]| {
        MovingObstacle::straight(Point::from(from), 0.25, Point::from(velocity)).unwrap()
    };
    let posts = vec![Disc::new(Point::new(3.5, 3.8), 0.25), Disc::new(Point::new(8.0, 3.0), 0.3)];
    let world = World::from_known(map, posts).unwrap();
    let world =
        world.with_movers(vec![walker([5.0, 1.0], [-0.1, 0.4]), walker([9.0, 6.0], [-0.3, -0.2])]);
    let start = Pose::new(1.5, 4.0, 0.4);
    let mut navigator = Navigator::new(map, &stack.fit(robot).unwrap()).unwrap();
    navigator.relocate(start);
    navigator.set_goals(&[Point::new(4.0, 5.5)], *goal).unwrap();
    let mut decide = |observation: &Observation<'_>| {
        if is_stored {
            navigator = taken_up(&navigator);
        }
        navigator.observe(observation);
        let action = match navigator.step() {
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let remaining_m = navigator.guidance().unwrap().remaining_m;
        Control { action, remaining_m, route: navigator.ways_taken(), turn_left_rad: 0.0 }
    };
    let participant = Participant {
        robot,
        start,
        goal: *goal,
        disturbances: disturbances.clone(),
        rules: RunRules { time_limit_s: 12.0, ..RunRules::default() },
        controller: &mut decide,
    };
    simulate(&world, &mut [participant]).unwrap().remove(0)
}

/// Stored and restored in every cycle, twenty runs are bitwise the same.
#[test]
fn a_run_that_is_stored_in_every_cycle_is_the_same() {
    let map = hall(wall_with_doors(&[2.0, 6.0]));
    let late = Robot { actuation_delay_s: 0.25, ..Robot::small() };
    let half = |yaw_deg| {
        let mut sensor = RangeSensor::new(181, 180.0, 6.0);
        sensor.mount.yaw_deg = yaw_deg;
        sensor
    };
    let two = Robot { sensors: vec![half(60.0), half(-120.0)], ..Robot::jackal() };
    let mut noisy = Disturbances { seed: 5, ..Disturbances::default() };
    noisy.sensor.range_m = 0.01;
    noisy.sensor.dropped_scans = 0.2;
    noisy.sensor.delay_s = 0.1;
    noisy.localisation.position_m = 0.02;
    noisy.localisation.jump_m = 0.2;
    (noisy.localisation.jump_every_s, noisy.localisation.jump_for_s) = (6.0, 2.0);
    let (mut runs, mut reached) = (0, 0);
    for robot in [Robot::small(), Robot::jackal(), late, two] {
        for name in ["keyway", "key-point-fusion", "s4-guided"] {
            let usual = Stack::by_name(name, &robot).unwrap();
            for disturbances in [Disturbances::default(), noisy.clone()] {
                // The last stack has the stop rule.
                let stack = if name == "s4-guided" {
                    usual.clone().with_stop_rule(&robot)
                } else {
                    usual.clone()
                };
                let goal = Point::new(5.0, 6.0);
                let case = Case { robot: robot.clone(), stack, disturbances, goal };
                let whole = drive(&case, &map, false);
                assert_eq!(drive(&case, &map, true), whole, "{name} {:?}", case.disturbances);
                runs += 1;
                reached += u32::from(whole.outcome == Outcome::Reached);
            }
        }
    }
    assert!(runs >= 20 && reached > 0, "{runs} {reached}");
}

/// Acts, limits, masks and waiting are also stored.
#[test]
fn whatever_it_does_goes_on() {
    let map = hall(wall_with_doors(&[2.0]));
    let prepare: [fn(&mut RobotInAWorld); 5] = [
        |life| life.navigator.spin(2.5, 30.0).unwrap(),
        |life| {
            life.navigator.set_speed_limit(Some(0.2)).unwrap();
            life.navigator.set_goal(Point::new(10.0, 3.0)).unwrap();
        },
        |life| {
            let keep_out = Some(std::sync::Arc::new(hall(wall_with_doors(&[6.0]))));
            let masks = keyway::navigate::Masks { keep_out, speed: None };
            life.navigator.set_masks(masks);
            life.navigator.set_goal(Point::new(4.0, 6.0)).unwrap();
        },
        |life| {
            life.posts = vec![Disc::new(Point::new(4.0, 4.0), 0.2)];
            life.drive_for(0.5);
            life.navigator.set_goal(Point::new(4.0, 4.0)).unwrap();
            life.drive_for(3.0);
        },
        |life| life.navigator.cancel(),
    ];
    for (number, prepare) in prepare.into_iter().enumerate() {
        let drive = |is_stored: bool| {
            let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
            prepare(&mut life);
            let cycle = |life: &mut RobotInAWorld| {
                if is_stored {
                    life.navigator = taken_up(&life.navigator);
                }
                (life.cycle().command(), life.pose)
            };
            (0..80).map(|_| cycle(&mut life)).collect::<Vec<_>>()
        };
        assert_eq!(drive(true), drive(false), "{number}");
    }
}

#[test]
fn what_is_no_snapshot_is_refused() {
    let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(2.0, 4.0, 0.0));
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life.drive_for(1.0);
    let stored = Value::serialized(&life.navigator.snapshot()).unwrap();
    let restored = |path: &str, value: Value| {
        let mut changed = stored.clone();
        *part_of(&mut changed, path) = value;
        let snapshot = changed.deserialized::<Snapshot>();
        snapshot.map(|snapshot| Navigator::restore(snapshot).err().map(|error| error.to_string()))
    };
    assert_eq!(restored("form", 1.into()).unwrap(), None);
    assert_eq!(restored("form", 2.into()).unwrap(), Some(RestoreError::Form(2).to_string()));
    let refused = restored("robot.cycle_s", 0.0.into()).unwrap().unwrap();
    assert!(refused.contains("cycle_s"), "{refused}");
    for (path, part) in
        [("world.scans", "scans"), ("world.times", "times"), ("world.ranges_m", "ranges_m")]
    {
        let refused = restored(path, Value::Array(vec![])).unwrap().unwrap();
        assert!(refused.starts_with(&format!("`{part}` of the snapshot contradicts")), "{refused}");
    }
    let refused = restored("errand.Drive.passed", 7.into()).unwrap().unwrap();
    assert!(refused.starts_with("`errand` of the snapshot contradicts"), "{refused}");
    // A map with fewer cells than its frame has.
    assert!(restored("world.map.frame.width", 100.into()).is_err());
    let runs = Value::Array(vec![1.into(), 2.into()]);
    assert!(restored("world.map.occupied.runs", runs).is_err());
}

/// Returns the part of a stored value at a path of names.
fn part_of<'a>(value: &'a mut Value, path: &str) -> &'a mut Value {
    path.split('.').fold(value, |value, name| {
        let entries = value.as_map_mut().unwrap();
        &mut entries.iter_mut().find(|(key, _)| key.as_text() == Some(name)).unwrap().1
    })
}
