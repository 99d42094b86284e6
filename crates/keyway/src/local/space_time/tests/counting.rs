//! Counters of the candidates of a decision.

use super::*;

fn refused(evaluation: &Evaluation) -> u32 {
    evaluation.rejected.as_slice().iter().map(|one| one.count).sum()
}

/// A corridor along y = 5 m, 1 m wide.
fn corridor() -> DistanceField {
    world(200, |_, y| !(90..110).contains(&y))
}

/// It slows down behind a pedestrian who walks ahead of it, and drives all the time.
#[test]
fn who_drives_beside_a_mover_is_said_to_drive() {
    let corridor = corridor();
    let robot = Robot::small();
    let start = Pose::new(2.0, 5.0, 0.0);
    let mut drive = Drive::new(&robot, &corridor, start, &[[2.0, 5.0], [9.0, 5.0]]);
    drive.velocity = Velocity::new(robot.limits.v_max_mps, 0.0);
    drive.movers = vec![walker([2.9, 5.0], [0.25, 0.0])];
    let mut near = 0;
    for _ in 0..20 {
        let Evaluation { driving, candidates, rejected, chosen, .. } =
            drive.decide().unwrap().evaluation;
        assert!(driving > 0 && driving <= candidates, "{driving} of {candidates}, {rejected:?}");
        assert_eq!(rejected.count(Rejections::MOVER), 0);
        assert_eq!(drive.explain().remedies, []);
        near += u32::from(chosen.term("movers").unwrap().raw > Beam::MEETING_S);
        drive.cycle();
        assert!(!robot.stands(drive.velocity));
    }
    assert!(near > 5, "{near}");
}

/// A pedestrian walks to and fro across the corridor; the robot approaches and stops.
#[test]
fn who_waits_for_a_mover_says_so() {
    let corridor = corridor();
    let robot = Robot::small();
    let start = Pose::new(8.0, 5.0, 0.0);
    let mut drive = Drive::new(&robot, &corridor, start, &[[7.0, 5.0], [9.9, 5.0]]);
    drive.planner.config.backwards = false;
    let mut waiting = 0;
    for cycle in 0..200 {
        let speed_mps = if cycle % 2 == 0 { 0.3 } else { -0.3 };
        drive.movers = vec![walker([9.0, 5.0], [0.0, speed_mps])];
        let Decision { command, evaluation } = drive.decide().unwrap();
        if cycle > 20 && robot.stands(command) {
            waiting += 1;
            assert!(evaluation.driving == 0 && evaluation.waits_for_mover());
            assert!(evaluation.rejected.count(Rejections::MOVER) > 0, "{evaluation:?}");
            assert!(refused(&evaluation) <= evaluation.candidates, "{evaluation:?}");
        }
        drive.cycle();
    }
    assert!(waiting > 0, "{:?} {:?}", drive.pose, drive.velocity);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// With any stationary and moving obstacles: a candidate is refused for one reason, no
    /// refused one drives, and remedies are given if none drives.
    #[test]
    fn every_candidate_is_counted_once(
        world in blocks(), heading in -3.0..3.0_f64, end in (0.1..3.9_f64, 0.1..3.9_f64), v_mps in 0.0..2.0_f64,
        walkers in prop::collection::vec((1.0..3.0_f64, 1.0..3.0_f64, -1.0..1.0_f64, -1.0..1.0_f64), 0..3), shape in 0..2_usize,
    ) {
        let robot = shaped(shape);
        let start = Pose::new(2.0, 2.0, heading);
        let mut drive = Drive::new(&robot, &world, start, &[[2.0, 2.0], [end.0, end.1]]);
        drive.velocity = Velocity::new(v_mps.min(robot.limits.v_max_mps), 0.0);
        drive.movers = walkers.iter().map(|&(x, y, vx, vy)| walker([x, y], [vx, vy])).collect();
        let decision = drive.decide();
        let is_ok = decision.is_ok();
        let evaluation = decision.map_or_else(|why| why.evaluation, |decision| decision.evaluation);
        let all = refused(&evaluation) + evaluation.driving;
        prop_assert!(all <= evaluation.candidates, "{evaluation:?}");
        prop_assert!(is_ok || refused(&evaluation) == evaluation.candidates, "{evaluation:?}");
        drive.memory = DriveMemory::default();
        prop_assert_eq!(drive.explain().remedies.is_empty(), evaluation.driving > 0);
    }
}
