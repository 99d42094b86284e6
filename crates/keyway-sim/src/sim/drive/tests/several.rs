//! Several robots in one simulation.

use super::*;
use keyway::robot::Footprint;
use std::f64::consts::PI;

/// A robot, its start, its goal and its command in every cycle.
type Task<'a> = (&'a Robot, Pose, Point, Velocity);

fn drive_all(world: &World, rules: &RunRules, tasks: &[Task<'_>]) -> Vec<Run> {
    let controller = |command: Velocity| {
        let mut left = 1e6;
        move |_: &Observation<'_>| {
            left -= 1.0;
            Control {
                action: Action::Drive(command),
                remaining_m: left,
                route: 1,
                turn_left_rad: 0.0,
            }
        }
    };
    let mut controllers: Vec<_> = tasks.iter().map(|task| controller(task.3)).collect();
    let participant = |(task, controller)| {
        let &(robot, start, goal, _): &Task<'_> = task;
        let (disturbances, rules) = (Disturbances::default(), rules.clone());
        Participant { robot, start, goal, disturbances, rules, controller }
    };
    let mut participants: Vec<Participant<'_>> = tasks
        .iter()
        .zip(controllers.iter_mut().map(|controller| controller as _))
        .map(participant)
        .collect();
    simulate(world, &mut participants).unwrap()
}

fn ahead(v: f64) -> Velocity {
    Velocity::new(v, 0.0)
}

fn touched(run: &Run) -> Obstacle {
    match run.outcome {
        Outcome::Collided { with, .. } => with,
        other => panic!("{other:?}"),
    }
}

fn boxy(length_m: f64, width_m: f64) -> Robot {
    Robot { footprint: Footprint::rectangle(length_m, width_m).unwrap(), ..robot() }
}

#[test]
fn two_robots_that_drive_towards_each_other_meet_at_the_computed_time() {
    let start = Pose::new(-2.0, 0.0, 0.0);
    let opposite = Pose::new(2.0, 0.0, PI);
    let (round, long) = (robot(), boxy(0.5, 0.3));
    for (one, other, reach_m) in
        [(&round, &round, 0.36), (&round, &long, 0.18 + 0.25), (&long, &long, 0.5)]
    {
        let tasks = [(one, start, FAR, ahead(0.5)), (other, opposite, FAR, ahead(0.5))];
        let runs = drive_all(&world(&[]), &limit(20.0), &tasks);
        // Each robot is 0.25 + 0.5 (t - 1) ahead after t > 1 s; together they drive 4 m minus
        // both radii.
        let expected_s = 1.0 + (0.5 * (4.0 - reach_m) - 0.25) / 0.5;
        for (index, run) in runs.iter().enumerate() {
            assert_eq!(touched(run), Obstacle::Robot(1 - index));
            let last = run.samples.last().unwrap();
            assert!((last.t_s - expected_s).abs() < 1e-3, "{} {expected_s}", last.t_s);
            assert!((run.length_m - 0.5 * (4.0 - reach_m)).abs() < 1e-4);
            assert_eq!(
                (run.min_clearance_m, run.cycles),
                (Some(0.0), expected_s.div_euclid(0.1) as u64 + 1)
            );
        }
        assert_eq!(runs[0].samples.last().unwrap().t_s, runs[1].samples.last().unwrap().t_s);
    }
}

#[test]
fn robots_see_each_other_where_they_are() {
    let (round, long) = (robot(), boxy(0.6, 0.3));
    let mut gaps = Vec::new();
    let mut look = |&Observation { pose, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        // Beam 4 of 8 points straight ahead, beam 6 to the left.
        gaps.push((pose.x, scan.ranges_m.get(4).unwrap(), scan.ranges_m.get(6).unwrap()));
        Control {
            action: Action::Drive(ahead(0.5)),
            remaining_m: 9.0,
            route: 1,
            turn_left_rad: 0.0,
        }
    };
    let mut positions = Vec::new();
    let mut back = |&Observation { pose, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan;
        positions.push((pose.x, scan.ranges_m.get(4).unwrap()));
        Control {
            action: Action::Drive(ahead(0.5)),
            remaining_m: 9.0,
            route: 1,
            turn_left_rad: 0.0,
        }
    };
    let mut stand = |_: &Observation<'_>| Control {
        action: Action::Stop,
        remaining_m: 9.0,
        route: 1,
        turn_left_rad: 0.0,
    };
    let mut participants = [
        Participant {
            robot: &round,
            start: Pose::default(),
            goal: FAR,
            disturbances: Disturbances::default(),
            rules: limit(2.0),
            controller: &mut look,
        },
        Participant {
            robot: &long,
            start: Pose::new(3.0, 0.0, PI),
            goal: FAR,
            disturbances: Disturbances::default(),
            rules: limit(2.0),
            controller: &mut back,
        },
        // 2 m to the left, long enough to stay beside the other one.
        Participant {
            robot: &boxy(4.0, 0.5),
            start: Pose::new(0.0, 2.0, 0.0),
            goal: FAR,
            disturbances: Disturbances::default(),
            rules: limit(2.0),
            controller: &mut stand,
        },
    ];
    simulate(&world(&[]), &mut participants).unwrap();
    assert_eq!((gaps.len(), positions.len()), (20, 20));
    for (&(x, front_m, left_m), &(other_x, back_m)) in gaps.iter().zip(&positions) {
        assert!((front_m - (other_x - 0.3 - x)).abs() < 1e-9, "a polygon: {front_m} {x} {other_x}");
        assert!((back_m - (other_x - x - 0.18)).abs() < 1e-9, "a disc: {back_m} {x} {other_x}");
        assert!((left_m - 1.75).abs() < 1e-9, "{left_m}");
    }
}

#[test]
fn out_of_reach_of_each_other_they_drive_as_if_alone() {
    let mut short_sighted = robot();
    short_sighted.sensors[0].range_m = 0.5;
    let world = world(&[(1.0, 0.5, 0.1), (0.5, 5.0, 0.3)]);
    let tasks = [
        (&short_sighted, Pose::new(0.0, -5.0, 0.3), FAR, Velocity::new(0.4, 0.1)),
        (&short_sighted, Pose::new(-1.0, 5.0, 0.0), FAR, ahead(0.5)),
        (&short_sighted, Pose::new(-5.0, 0.0, 0.0), Point::new(-4.0, 0.0), ahead(0.3)),
    ];
    let together = drive_all(&world, &limit(9.0), &tasks);
    for (task, run) in tasks.iter().zip(together) {
        let alone = drive_all(&world, &limit(9.0), &[*task]).remove(0);
        let nearest_m = run.min_clearance_m.unwrap();
        assert!(nearest_m <= alone.min_clearance_m.unwrap());
        assert!(run.min_robot_clearance_m.unwrap() >= nearest_m);
        let Run { min_clearance_m, min_robot_clearance_m, .. } = alone;
        assert_eq!(Run { min_clearance_m, min_robot_clearance_m, ..run }, alone);
    }
}

#[test]
fn the_order_of_the_participants_does_not_matter() {
    let (round, long) = (robot(), boxy(0.6, 0.3));
    let tasks = [
        (&round, Pose::new(0.0, 0.0, 0.0), FAR, ahead(0.5)),
        (&long, Pose::new(2.0, -0.9, 2.0), FAR, Velocity::new(0.4, 0.2)),
        (&round, Pose::new(1.0, 3.0, -1.5), FAR, ahead(0.45)),
    ];
    let world = world(&[(4.0, 0.3, 0.2)]);
    let runs = drive_all(&world, &limit(20.0), &tasks);
    assert!(runs.iter().any(|run| matches!(run.outcome, Outcome::Collided { .. })));
    let turned = drive_all(&world, &limit(20.0), &[tasks[2], tasks[0], tasks[1]]);
    for (index, run) in runs.iter().enumerate() {
        let same = &turned[(index + 1) % 3];
        assert_eq!(run.samples, same.samples);
        match (run.outcome, same.outcome) {
            (
                Outcome::Collided { with: Obstacle::Robot(one), .. },
                Outcome::Collided { with: Obstacle::Robot(other), .. },
            ) => assert_eq!((one + 1) % 3, other),
            (one, other) => assert_eq!(one, other),
        }
        assert!((run.min_clearance_m.unwrap() - same.min_clearance_m.unwrap()).abs() < 1e-4);
    }
}

#[test]
fn who_has_ended_stands_in_the_way() {
    // The first robot has arrived immediately, and the second one runs into it.
    let (robot, rules) = (robot(), limit(20.0));
    let there = (&robot, Pose::new(1.0, 0.0, 0.0), Point::new(1.0, 0.1), ahead(0.5));
    let comes = (&robot, Pose::new(-1.0, 0.0, 0.0), FAR, ahead(0.5));
    let runs = drive_all(&world(&[]), &rules, &[there, comes]);
    assert_eq!((runs[0].outcome, runs[0].cycles), (Outcome::Reached, 0));
    assert!(
        (runs[0].min_clearance_m.unwrap() - (2.0 - 0.36)).abs() < 1e-9,
        "as it was when it ended"
    );
    assert_eq!(touched(&runs[1]), Obstacle::Robot(0));
    assert!((runs[1].length_m - (2.0 - 0.36)).abs() < 1e-4);
    // One robot is stuck, and another one has its goal beyond it. The run of the latter ends
    // after 20 s without motion.
    let mut cycles = 0;
    let mut stays = |_: &Observation<'_>| {
        cycles += 1;
        Control { action: Action::Stop, remaining_m: 5.0, route: 1, turn_left_rad: 0.0 }
    };
    let mut waits = |&Observation { pose, .. }: &Observation<'_>| Control {
        action: Action::Drive(ahead(0.05)),
        remaining_m: 9.0 - pose.x,
        route: 1,
        turn_left_rad: 0.0,
    };
    let mut participants = [
        Participant {
            robot: &robot,
            start: Pose::default(),
            goal: FAR,
            disturbances: Disturbances::default(),
            rules: limit(60.0),
            controller: &mut stays,
        },
        Participant {
            robot: &robot,
            start: Pose::new(-2.0, 0.0, 0.0),
            goal: FAR,
            disturbances: Disturbances::default(),
            rules: limit(60.0),
            controller: &mut waits,
        },
    ];
    let runs = simulate(&world(&[]), &mut participants).unwrap();
    assert_eq!((runs[0].outcome, runs[0].cycles, cycles), (Outcome::Stuck, 200, 201));
    assert_eq!(touched(&runs[1]), Obstacle::Robot(0));
    assert!(runs[1].samples.last().unwrap().t_s > 30.0);
}

#[test]
fn contacts_in_one_cycle_happen_in_their_order() {
    // The first cycle lasts a second. Robot 0 touches the post 0.32 m ahead after 0.38 s and
    // stops. Robot 1 crosses its line at 0.75 s, when robot 0 would be 1 m farther on, and runs
    // into it.
    let mut fast = brisk(1.0);
    fast.sensors[0].beams = 1;
    let world = world(&[(0.6, 0.0, 0.1)]);
    let tasks = [
        (&fast, Pose::new(0.0, 0.0, 0.0), FAR, ahead(4.0)),
        (&fast, Pose::new(0.1, -2.0, FRAC_PI_2), FAR, ahead(6.0)),
        (&fast, Pose::new(-3.0, 0.5, 0.0), FAR, ahead(4.0)),
    ];
    let runs = drive_all(&world, &limit(2.0), &tasks);
    assert_eq!((touched(&runs[0]), touched(&runs[1])), (Obstacle::Circle(0), Obstacle::Robot(0)));
    assert_eq!((runs[0].cycles, runs[1].cycles), (1, 1));
    let end = |run: &Run| *run.samples.last().unwrap();
    assert!((end(&runs[0]).pose.x - 0.32).abs() < 1e-4);
    let beside_m = (0.36_f64 * 0.36 - 0.22 * 0.22).sqrt();
    assert!((end(&runs[1]).pose.y + beside_m).abs() < 2e-4, "{:?}", end(&runs[1]));
    assert!(end(&runs[0]).t_s < end(&runs[1]).t_s);
    // The last robot passes the first at 0.14 m.
    assert_eq!(runs[2].outcome, Outcome::Timeout);
    assert!(
        (runs[2].min_clearance_m.unwrap() - 0.14).abs() < 1e-4,
        "{:?}",
        runs[2].min_clearance_m
    );
}

#[test]
fn clearances_are_those_of_one_instant() {
    // Robot 0 touches the post 0.42 m ahead. Robot 1 is initially nearer to that position than it
    // ever is to robot 0, because it drives away at the same speed.
    let fast = brisk(1.0);
    let tasks = [
        (&fast, Pose::new(0.0, 0.0, 0.0), FAR, ahead(4.0)),
        (&fast, Pose::new(0.3, 0.5, FRAC_PI_2), FAR, ahead(4.0)),
    ];
    let runs = drive_all(&world(&[(0.7, 0.0, 0.1)]), &limit(1.0), &tasks);
    assert_eq!(touched(&runs[0]), Obstacle::Circle(0));
    let least_m = runs[1].min_clearance_m.unwrap();
    assert!((least_m - (0.34_f64.sqrt() - 0.36)).abs() < 1e-4, "{least_m}");
}

#[test]
fn two_that_touched_stand_in_the_way_of_a_third() {
    let robot = robot();
    let towards_the_middle = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        (&robot, Pose::new(-2.0 * cos, -2.0 * sin, angle), FAR, ahead(0.5))
    };
    // Robots 1 and 2 touch beside the x axis. Robot 0 comes along the axis and touches both; by
    // the tie rule, the first one counts.
    let tasks = [0.0, 2.3, -2.3].map(towards_the_middle);
    let runs = drive_all(&world(&[]), &limit(20.0), &tasks);
    let with: Vec<Obstacle> = runs.iter().map(touched).collect();
    assert_eq!(with, [Obstacle::Robot(1), Obstacle::Robot(2), Obstacle::Robot(1)]);
    let end_s: Vec<f64> = runs.iter().map(|run| run.samples.last().unwrap().t_s).collect();
    assert!(end_s[1] == end_s[2] && end_s[0] > end_s[1]);
}

#[test]
fn robots_in_one_place_are_in_contact_at_the_start() {
    let robot = robot();
    let heap = [(); 3].map(|()| (&robot, Pose::default(), FAR, ahead(0.5)));
    let runs = drive_all(&world(&[]), &limit(20.0), &heap);
    let with: Vec<Obstacle> = runs.iter().map(touched).collect();
    assert_eq!(with, [Obstacle::Robot(1), Obstacle::Robot(0), Obstacle::Robot(0)]);
    assert!(runs.iter().all(|run| run.cycles == 0 && run.min_clearance_m == Some(0.0)));
}

#[test]
fn what_is_wrong_with_whom() {
    let (good, slow) = (robot(), Robot { cycle_s: 0.2, ..robot() });
    let error = |robots: [&Robot; 2], start: Pose, v: f64| {
        let mut stop = |_: &Observation<'_>| Control {
            action: Action::Stop,
            remaining_m: 1.0,
            route: 1,
            turn_left_rad: 0.0,
        };
        let mut drive = |_: &Observation<'_>| Control {
            action: Action::Drive(ahead(v)),
            remaining_m: 1.0,
            route: 1,
            turn_left_rad: 0.0,
        };
        let [robot, other] = robots;
        let mut participants = [
            Participant {
                robot,
                start: Pose::default(),
                goal: FAR,
                disturbances: Disturbances::default(),
                rules: limit(1.0),
                controller: &mut stop,
            },
            Participant {
                robot: other,
                start,
                goal: FAR,
                disturbances: Disturbances::default(),
                rules: limit(1.0),
                controller: &mut drive,
            },
        ];
        simulate(&world(&[]), &mut participants).unwrap_err().to_string()
    };
    let start = Pose::new(2.0, 0.0, 0.0);
    assert_eq!(
        error([&good, &slow], start, 0.0),
        "participants[1].robot.cycle_s must be 0.1, the cycle of the first robot, got 0.2"
    );
    let bad = Robot { cycle_s: f64::NAN, ..robot() };
    assert!(
        error([&bad, &good], start, 0.0).starts_with("participants[0].robot.cycle_s must be a")
    );
    let nowhere = Pose { y: f64::INFINITY, ..start };
    assert!(
        error([&good, &good], nowhere, 0.0).starts_with("participants[1].start.y must be finite")
    );
    let text = error([&good, &good], start, f64::NAN);
    assert!(text.starts_with("the command of cycle 0 for robot 1 is not a number"), "{text}");
    assert_eq!(simulate(&world(&[]), &mut []), Ok(vec![]));
}
