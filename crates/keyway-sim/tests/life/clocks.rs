//! Stamps: clocks with any origin, late and repeated cycles, late scans.

use super::robot_in_a_world::{RobotInAWorld, hall, wall_with_doors};
use keyway::geometry::{Disc, Point, Pose, Velocity};
use keyway::navigate::{Blocked, Step};
use keyway::sense::{Observation, Scan, SensorScan};

fn begun(stamp_s: f64) -> RobotInAWorld {
    let map = hall(wall_with_doors(&[2.0, 6.0]));
    let mut life = RobotInAWorld::new(&map, Pose::new(2.0, 4.0, 0.0));
    life.stamp_s = stamp_s;
    life.posts = vec![Disc::new(Point::new(4.0, 3.0), 0.25)];
    life.navigator.set_goal(Point::new(10.0, 4.0)).unwrap();
    life
}

fn poses(mut life: RobotInAWorld, mut cycle: impl FnMut(&mut RobotInAWorld)) -> Vec<Pose> {
    (0..150).map(|_| (cycle(&mut life), life.pose).1).collect()
}

/// The runs are bitwise the same.
#[test]
fn it_does_not_matter_when_the_clock_began() {
    let drive = |stamp_s| poses(begun(stamp_s), |life| drop(life.cycle()));
    let expected = drive(0.0);
    assert_eq!(drive(1.764e9), expected);
    assert_eq!(drive(-7.3), expected);
}

/// A step that is requested twice counts once.
#[test]
fn a_doubled_cycle_changes_nothing() {
    let once = poses(begun(0.0), |life| drop(life.cycle()));
    let twice = poses(begun(0.0), |life| {
        life.observe();
        let first = life.navigator.step();
        let second = life.navigator.step();
        assert_eq!(first, second);
        life.obey(second.command());
    });
    assert_eq!(once, twice);
}

/// An observation in pieces, as from separate topics, is equivalent to a complete one.
#[test]
fn observations_may_come_in_pieces() {
    let whole = poses(begun(0.0), |life| drop(life.cycle()));
    let in_pieces = poses(begun(0.0), |life| {
        let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
        life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &[]));
        let step = life.cycle();
        assert_ne!(step, Step::Idle);
    });
    assert_eq!(whole, in_pieces);
}

/// Cycles of alternately two and three times the robot's cycle time.
#[test]
fn late_cycles_drive_as_far() {
    let mut life = begun(0.0);
    let mut cycle = 0;
    loop {
        life.observe();
        let step = life.navigator.step();
        if step == Step::Arrived {
            break;
        }
        (0..=cycle % 3).for_each(|_| life.obey(step.command()));
        cycle += 1;
        assert!(life.stamp_s < 90.0);
    }
}

#[test]
fn time_does_not_run_back() {
    let mut life = begun(100.0);
    life.drive_for(1.0);
    let before = life.stamp_s;
    life.stamp_s = 50.0;
    life.observe();
    let step = life.navigator.step();
    let why = Blocked::TimeRunsBack { stamp_s: 50.0, last_s: 100.9 };
    assert_eq!(step, Step::Blocked { command: Velocity::ZERO, why: why.clone() });
    assert!(
        why.to_string().contains("the observation of 50 s is older than the last one"),
        "{why}"
    );
    life.obey(Velocity::ZERO);
    // When the clock is correct again, the robot continues as before.
    life.stamp_s = before + 0.2;
    assert!(matches!(life.cycle(), Step::Drive(_)));
    // A clock restart is announced.
    life.navigator.restart_clock();
    life.stamp_s = 0.0;
    assert!(matches!(life.cycle(), Step::Drive(_)));
    life.stamp_s = f64::NAN;
    life.observe();
    let step = life.navigator.step();
    assert_eq!(step, Step::Blocked { command: Velocity::ZERO, why: Blocked::BadInput("stamp_s") });
}

/// No more observations while commands are still requested; or scans, but no pose; or the last
/// observation repeatedly.
#[test]
fn a_robot_that_is_not_told_where_it_is_stops() {
    for told in ["nothing", "scans", "the same again"] {
        let mut life = begun(0.0);
        let mut last_command = Velocity::ZERO;
        life.drive_for(3.0);
        let (last_s, last, velocity) = (life.stamp_s, life.pose, life.velocity);
        let mut stopped = None;
        for cycle in 0..20 {
            if told != "nothing" {
                let scan = Scan::of_nothing(&life.robot.sensors[0]);
                let is_new = told == "scans";
                let stamp_s = if is_new { last_s + 0.1 * f64::from(cycle) } else { last_s };
                let scans = [SensorScan::of(&life.robot, 0, stamp_s, &scan)];
                let observation = Observation::new(last_s, last, velocity, &scans);
                life.navigator.observe(&observation);
            }
            let step = life.navigator.step();
            if matches!(step, Step::Blocked { why: Blocked::PoseStale { .. }, .. }) {
                stopped = stopped.or(Some(cycle));
            }
            last_command = step.command();
        }
        assert!(stopped.is_some_and(|cycle| (4..8).contains(&cycle)), "{told} {stopped:?}");
        assert_eq!(last_command, Velocity::ZERO, "{told}");
        life.stamp_s += 2.0;
        assert!(matches!(life.cycle(), Step::Drive(_)), "until it is told again");
    }
}

/// A time at the step makes the pose older; a time without new information changes nothing.
#[test]
fn the_time_may_be_told_at_the_step() {
    let expected = poses(begun(0.0), |life| drop(life.cycle()));
    for told_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let told = poses(begun(0.0), |life| {
            life.observe();
            let step = life.navigator.step_at(life.stamp_s + told_s);
            life.obey(step.command());
        });
        assert_eq!(told, expected, "{told_s}");
    }
    let mut life = begun(0.0);
    life.drive_for(3.0);
    life.observe();
    assert!(matches!(life.navigator.step_at(life.stamp_s + 0.1), Step::Drive(_)));
    let now_s = life.navigator.now_s().unwrap();
    assert!((now_s - life.stamp_s - 0.1).abs() < 1e-6, "{now_s}");
    let step = life.navigator.step_at(life.stamp_s + 0.6);
    let Some(&Blocked::PoseStale { age_s }) = step.why() else { panic!("{step:?}") };
    assert!((age_s - 0.6).abs() < 1e-6, "{age_s}");
}

/// A scan that is 0.2 s late, taken while the robot turned, is placed by the robot's pose at that
/// time.
#[test]
fn a_late_scan_is_put_where_it_was_made() {
    let sensed = |late_cycles: usize| {
        let mut life = RobotInAWorld::new(&hall(|_| false), Pose::new(4.0, 4.0, 0.0));
        life.posts =
            vec![Disc::new(Point::new(6.0, 4.5), 0.2), Disc::new(Point::new(3.0, 2.5), 0.2)];
        let world = keyway_sim::sim::World::from_known(&life.truth, life.posts.clone()).unwrap();
        let mut made: Vec<(f64, Scan)> = Vec::new();
        for _ in 0..25 {
            let scan = world.at(0.0).cast(life.pose, &life.robot.sensors[0]);
            made.push((life.stamp_s, scan));
            let scans: Vec<SensorScan<'_>> = made
                .len()
                .checked_sub(1 + late_cycles)
                .map(|index| SensorScan::of(&life.robot, 0, made[index].0, &made[index].1))
                .into_iter()
                .collect();
            let (stamp_s, pose, velocity) = (life.stamp_s, life.pose, life.velocity);
            life.navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
            life.navigator.step();
            life.obey(Velocity::new(0.3, 0.9));
        }
        life.navigator.sensed().clone()
    };
    let (in_time, late) = (sensed(0), sensed(2));
    let frame = *hall(|_| false).frame();
    let is_post = |cell| {
        let place = frame.world_from_cell(cell);
        let near = |x, y| place.distance(Point::new(x, y)) < 0.25;
        near(6.0, 4.5) || near(3.0, 2.5)
    };
    let strays = |grid: &keyway::map::BitGrid| {
        frame.cells().filter(|&cell| grid.get(cell) && !is_post(cell)).count()
    };
    assert_eq!((strays(&in_time), strays(&late)), (0, 0));
    assert!(late.count_ones() > 8, "{}", late.count_ones());
}
