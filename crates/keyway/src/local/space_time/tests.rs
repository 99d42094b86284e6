//! Decisions and whole drives.

mod counting;
mod narrow;

use super::*;
use crate::geometry::{Polyline, Pose};
use crate::local::{Change, Fate, ScoredCandidate};
use crate::map::{BitGrid, Cell, CellState, DistanceField, FieldConfig, OccupancyGrid};
use crate::robot::Footprint;
use crate::sense::Mover;
use proptest::prelude::*;

/// A square world of cells of 0.05 m.
fn world(cells: u64, is_occupied: impl Fn(i32, i32) -> bool) -> DistanceField {
    world_of(0.05, cells, is_occupied)
}

fn world_of(cell_m: f64, cells: u64, is_occupied: impl Fn(i32, i32) -> bool) -> DistanceField {
    let frame = GridFrame::new(cells, cells, cell_m, Pose::default()).unwrap();
    let state = |cell: Cell| {
        if is_occupied(cell.x, cell.y) { CellState::Occupied } else { CellState::Free }
    };
    let map = OccupancyGrid::from_fn(frame, state);
    DistanceField::new(&frame, map.occupied(), &FieldConfig::default())
}

/// A robot in a world, with a route and moving obstacles.
struct Drive<'a> {
    planner: SpaceTime,
    world: &'a DistanceField,
    path: Polyline,
    movers: Vec<Mover>,
    seen: Option<BitGrid>,
    pose: Pose,
    velocity: Velocity,
    memory: DriveMemory,
    scratch: Scratch,
}

impl<'a> Drive<'a> {
    fn new(robot: &Robot, world: &'a DistanceField, pose: Pose, route: &[[f64; 2]]) -> Self {
        let planner = SpaceTime::new(SpaceTimeConfig::for_robot(robot), robot.clone()).unwrap();
        let path = Polyline::new(route.iter().map(|&point| point.into()).collect());
        let (memory, scratch) = (DriveMemory::default(), Scratch::default());
        Self {
            planner,
            world,
            path,
            movers: Vec::new(),
            seen: None,
            pose,
            velocity: Velocity::ZERO,
            memory,
            scratch,
        }
    }

    fn decide(&mut self) -> Result<Decision, NoCommand> {
        let (mut memory, mut scratch) = (self.memory.clone(), std::mem::take(&mut self.scratch));
        let decide = |scene: &Scene<'_>| self.planner.decide(scene, &mut memory, &mut scratch);
        let decision = self.in_scene(decide);
        (self.memory, self.scratch) = (memory, scratch);
        decision
    }

    fn explain(&self) -> Explanation {
        self.in_scene(|scene| self.planner.explain(scene, &self.memory))
    }

    fn in_scene<R>(&self, look: impl FnOnce(&Scene<'_>) -> R) -> R {
        let Self { path, movers, pose, velocity, world, seen, .. } = self;
        let (frame, end) = (world.frame(), *path.points().last().unwrap());
        look(&Scene {
            obstacles: world,
            sensed: &BitGrid::new(frame.width(), frame.height(), false),
            seen: SeenCells { behind: seen.as_ref(), ..SeenCells::ANYWHERE },
            movers,
            walked: &[],
            pose: *pose,
            velocity: *velocity,
            guide: end,
            path,
            goal_heading_rad: None,
            remaining_m: pose.point().distance(end).max(0.01),
            jerk_limited: None,
        })
    }

    /// Simulates a cycle of ideal motion, and returns the poses of its fiftieths.
    fn cycle(&mut self) -> Vec<Pose> {
        let command = self.decide().map_or_else(|why| why.fallback, |decision| decision.command);
        let Robot { limits, cycle_s, .. } = self.planner.robot().clone();
        let (from, to) = (self.velocity, limits.reached(self.velocity, command, cycle_s));
        let start = self.pose;
        let part = |i: i32| f64::from(i) / 50.0;
        let poses =
            (1..=50).map(|i| start.after_ramp(from, from.lerp(to, part(i)), cycle_s * part(i)));
        let poses = poses.collect();
        (self.pose, self.velocity) = (start.after_ramp(from, to, cycle_s), to);
        for mover in &mut self.movers {
            mover.centre = mover.centre + mover.velocity_mps * cycle_s;
        }
        poses
    }

    fn left_m(&self) -> f64 {
        self.pose.point().distance(*self.path.points().last().unwrap())
    }

    /// Drives until it is at the end of the route, for at most `longest_s` \[s\]; returns the
    /// time that it took.
    fn arrive(&mut self, longest_s: f64) -> Option<f64> {
        let cycle_s = self.planner.robot().cycle_s;
        let cycles = (longest_s / cycle_s) as usize;
        (0..cycles).find_map(|cycle| {
            self.cycle();
            (self.left_m() < 0.15).then(|| cycle_s * (cycle + 1) as f64)
        })
    }
}

fn walker(centre: [f64; 2], velocity_mps: [f64; 2]) -> Mover {
    let (centre, velocity_mps) = (centre.into(), velocity_mps.into());
    Mover { velocity_mps, ..Mover::standing(0, centre, 0.25) }
}

#[test]
fn on_an_empty_straight_it_drives_the_fastest_profile_and_hardly_turns() {
    let open = world(400, |_, _| false);
    for robot in [Robot::small(), Robot::jackal()] {
        let mut drive =
            Drive::new(&robot, &open, Pose::new(3.0, 10.0, 0.0), &[[3.0, 10.0], [15.0, 10.0]]);
        let limits = &robot.limits;
        let fastest_s = 12.0 / limits.v_max_mps + limits.v_max_mps / limits.acceleration_mps2;
        let mut turned = 0.0_f64;
        let mut after_s = 0.0;
        while drive.left_m() > 0.15 && after_s < 60.0 {
            drive.cycle();
            after_s += robot.cycle_s;
            turned = turned.max(drive.velocity.omega.abs());
        }
        assert!(after_s < 1.01 * fastest_s, "{after_s} of {fastest_s}");
        assert!(turned < 0.02, "{turned}");
    }
}

#[test]
fn it_turns_around_where_it_faces_away() {
    let open = world(200, |_, _| false);
    let robot = Robot::small();
    let mut drive = Drive::new(&robot, &open, Pose::new(5.0, 5.0, 3.0), &[[5.0, 5.0], [8.0, 5.0]]);
    // 3 m take 7 s, half a turn takes 2.1 s, and half a second more to begin and to end it.
    assert!(drive.arrive(12.0).is_some());
}

/// Out of a dead end that is too narrow to turn in.
#[test]
fn it_backs_out_of_a_dead_end() {
    // 0.55 m wide: the robot needs 0.67 m to turn.
    let dead_end = world(200, |x, y| {
        (40..100).contains(&x) && !(95..106).contains(&y) && (90..112).contains(&y) || x == 100
    });
    let robot = Robot::jackal();
    let route = [[4.5, 5.025], [1.5, 5.025], [1.5, 2.0]];
    let mut drive = Drive::new(&robot, &dead_end, Pose::new(4.5, 5.025, 0.0), &route);
    assert!(drive.arrive(20.0).is_some(), "{:?}", drive.pose);
}

/// It would touch an obstacle behind itself before it sees it.
#[test]
fn it_backs_up_only_where_it_has_looked() {
    let open = world(200, |_, _| false);
    let robot = Robot::jackal();
    let backwards = |seen: Option<BitGrid>| {
        let route = [[5.0, 5.0], [3.5, 5.0]];
        let mut drive = Drive::new(&robot, &open, Pose::new(5.0, 5.0, 0.0), &route);
        drive.seen = seen;
        let mut least_mps = f64::INFINITY;
        for _ in 0..200 {
            drive.cycle();
            least_mps = drive.velocity.v.min(least_mps);
        }
        assert!(drive.left_m() < 0.15, "{:?}", drive.pose);
        least_mps < -0.1
    };
    let mut seen = BitGrid::new(200, 200, false);
    assert!(backwards(None) && !backwards(Some(seen.clone())));
    // To 0.3 m behind its rear.
    for y in 90..110 {
        seen.fill_span(y, 89, 120);
    }
    assert!(backwards(Some(seen)));
}

#[test]
fn it_lets_pass_what_crosses_its_way() {
    let open = world(300, |_, _| false);
    let robot = Robot::small();
    for (centre, velocity) in
        [([7.0, 4.5], [0.0, 0.6]), ([7.0, 10.5], [0.0, -0.6]), ([10.0, 7.3], [-0.5, 0.0])]
    {
        let mut drive =
            Drive::new(&robot, &open, Pose::new(4.0, 7.5, 0.0), &[[4.0, 7.5], [11.0, 7.5]]);
        drive.movers.push(walker(centre, velocity));
        let mut least_m = f64::INFINITY;
        let mut after_s = 0.0;
        while drive.left_m() > 0.15 && after_s < 40.0 {
            drive.cycle();
            after_s += robot.cycle_s;
            let gap_m = drive.pose.point().distance(drive.movers[0].centre) - 0.25 - 0.18;
            least_m = least_m.min(gap_m);
        }
        assert!(least_m > 0.05, "{centre:?}: {least_m}");
        assert!(after_s < 19.0, "{centre:?}: {after_s}, 15 without it");
    }
}

#[test]
fn a_walker_in_the_way_is_waited_for() {
    // A corridor of 0.8 m: there is no space to pass.
    let corridor = world(200, |_, y| !(92..108).contains(&y));
    let robot = Robot::small();
    let mut drive =
        Drive::new(&robot, &corridor, Pose::new(4.0, 5.0, 0.0), &[[4.0, 5.0], [9.0, 5.0]]);
    drive.movers.push(walker([4.9, 5.0], [-0.05, 0.0]));
    for _ in 0..20 {
        drive.cycle();
    }
    let evaluation = drive.decide().unwrap().evaluation;
    assert!(evaluation.waits_for_mover(), "{evaluation:?}");
    assert!(evaluation.chosen.term("movers").unwrap().raw > 0.0);
    drive.movers.clear();
    assert!(!drive.decide().unwrap().evaluation.waits_for_mover());
}

#[test]
fn the_same_scene_gives_the_same_command_with_a_warm_scratch_and_allocates_nothing() {
    let pillars = world(200, |x, y| (x - 110).abs() < 3 && (y - 101).abs() < 3);
    let robot = Robot::jackal();
    let mut drive =
        Drive::new(&robot, &pillars, Pose::new(3.0, 5.0, 0.2), &[[3.0, 5.0], [9.0, 5.0]]);
    drive.movers.push(walker([6.0, 3.0], [-0.3, 0.6]));
    for _ in 0..30 {
        drive.cycle();
    }
    let (pose, velocity, memory) = (drive.pose, drive.velocity, drive.memory.clone());
    let warm = drive.decide().unwrap();
    (drive.scratch, drive.memory) = (Scratch::default(), memory.clone());
    assert_eq!(drive.decide().unwrap(), warm);
    drive.memory = memory;
    let scene = Scene {
        obstacles: drive.world,
        sensed: &BitGrid::new(200, 200, false),
        seen: SeenCells::ANYWHERE,
        movers: &drive.movers,
        walked: &[],
        pose,
        velocity,
        guide: Point::new(9.0, 5.0),
        path: &drive.path,
        goal_heading_rad: None,
        remaining_m: 3.0,
        jerk_limited: None,
    };
    let (planner, memory, scratch) = (&drive.planner, &mut drive.memory, &mut drive.scratch);
    let _ = planner.decide(&scene, memory, scratch);
    let info = allocation_counter::measure(|| {
        let _ = planner.decide(&scene, memory, scratch);
    });
    assert_eq!(info.count_total, 0);
}

/// The side of the pillar at the middle of the world on which the trajectory passes; none if it
/// does not reach that far.
fn side(drive: &Drive<'_>, middle_m: f64) -> Option<bool> {
    let course = drive.memory.course().cloned()?;
    let step_s = 0.05;
    let end_s = course.stretch_s * course.velocities.len() as f64;
    let velocity = |after_s: f64| course.velocity(drive.velocity, after_s);
    let (mut pose, mut after_s) = (drive.pose, 0.0);
    while pose.x < middle_m && after_s < end_s {
        pose = pose.after_ramp(velocity(after_s), velocity(after_s + step_s), step_s);
        after_s += step_s;
    }
    (pose.x >= middle_m).then_some(pose.y > middle_m)
}

/// A pillar on the straight line to the goal: either side is as good, and one is kept, although
/// the estimated pose is off to the left and to the right in turns.
#[test]
fn a_side_that_is_taken_is_kept() {
    const MIDDLE_M: f64 = 10.025;
    for robot in [Robot::small(), Robot::jackal()] {
        for (half, off_m) in [2, 4, 6, 8]
            .into_iter()
            .flat_map(|half| [0.003, 0.01, 0.02, 0.04].map(|off_m| (half, off_m)))
        {
            let pillar = world(400, |x, y| (x - 200).abs() <= 4 && (y - 200).abs() <= half);
            for y in [0.0, 0.013, 0.025].map(|shift_m| MIDDLE_M + shift_m) {
                let start = Pose::new(5.5, y, 0.0);
                let mut drive = Drive::new(&robot, &pillar, start, &[[5.5, y], [14.0, y]]);
                let mut sides = Vec::new();
                for cycle in 0..200 {
                    drive.cycle();
                    drive.pose.y += if cycle / 3 % 2 == 0 { off_m } else { -off_m };
                    sides.extend(side(&drive, MIDDLE_M));
                    if drive.pose.x > 9.5 {
                        break;
                    }
                }
                let is_kept = sides.windows(2).all(|pair| pair[0] == pair[1]);
                assert!(sides.len() > 10 && is_kept, "{half} {off_m} {y}: {sides:?}");
            }
        }
    }
}

#[test]
fn the_chosen_course_is_that_of_the_decision() {
    let pillars = world(200, |x, y| (x - 80).abs() < 4 && (y - 104).abs() < 4);
    for robot in [Robot::small(), Robot::jackal()] {
        let mut drive =
            Drive::new(&robot, &pillars, Pose::new(2.7, 4.8, 0.0), &[[2.7, 4.8], [8.0, 4.8]]);
        drive.velocity = Velocity::new(robot.limits.v_max_mps, 0.0);
        let mut admissible = 0;
        for _ in 0..3 {
            let explanation = drive.explain();
            let decision = drive.decide().unwrap();
            let ScoredCandidate { velocity, shares } = explanation.chosen().unwrap();
            assert_eq!((velocity, shares), (decision.command, &decision.evaluation.chosen));
            let second = explanation.runner_up().unwrap().velocity;
            assert!(explanation.remedies.is_empty() && second != velocity);
            for candidate in &explanation.candidates {
                assert_eq!(candidate.poses.len(), 10);
                if let Fate::Admissible { shares, score } = &candidate.fate {
                    admissible += 1;
                    assert!((shares.total() - score).abs() < 1e-12 && *score < 0.0);
                }
            }
            drive.velocity = decision.command;
            drive.pose = drive.pose.after_ramp(drive.velocity, decision.command, robot.cycle_s);
        }
        assert!(admissible > 20, "{admissible}");
    }
}

/// With 7.5 cm of clearance: at full acceleration it drives 6.7 cm in the first stretch, and as
/// far again until it is stationary.
#[test]
fn from_rest_it_may_begin_gently() {
    let walled = world(100, |x, y| (x - 50).abs().max((y - 50).abs()) == 5);
    let robot = Robot { footprint: Footprint::circle(0.15).unwrap(), ..Robot::small() };
    let route = [[2.525, 2.525], [4.0, 2.525]];
    let drive = Drive::new(&robot, &walled, Pose::new(2.525, 2.525, 0.0), &route);
    let explanation = drive.explain();
    let others = explanation.candidates.iter().skip(1);
    let mut ahead = others.filter(|candidate| candidate.velocity.v > 0.0);
    assert!(ahead.any(|candidate| matches!(candidate.fate, Fate::Admissible { .. })));
}

/// In an enclosure in which it can turn, but not drive: waiting does not help, and neither does
/// turning. A smaller footprint does.
#[test]
fn what_would_free_a_robot_that_is_walled_in() {
    let walled = world(100, |x, y| (x - 50).abs().max((y - 50).abs()) == 4);
    let robot = Robot { footprint: Footprint::circle(0.174).unwrap(), ..Robot::small() };
    let drive =
        Drive::new(&robot, &walled, Pose::new(2.525, 2.525, 0.0), &[[2.525, 2.525], [4.0, 2.525]]);
    let explanation = drive.explain();
    let mut touching = 0;
    for candidate in &explanation.candidates {
        if let Fate::Refused { rule, free_for_s: Some(_), .. } = &candidate.fate {
            touching += 1;
            let end = *candidate.poses.last().unwrap();
            assert!(rule == CONTACT && robot.footprint.is_free(end, &walled), "{end:?}");
        }
    }
    assert!(touching > 2, "{touching}");
    let names: Vec<_> = explanation.remedies.iter().map(ToString::to_string).collect();
    let frees: Vec<_> = explanation.remedies.iter().map(|remedy| remedy.frees).collect();
    assert_eq!(frees, [false, false, false, true], "{names:?}");
    let Change::Footprint { smaller_by_m } = explanation.remedies[3].change else { panic!() };
    let footprint = robot.footprint.smaller_by(smaller_by_m).unwrap();
    let mut freed = Drive::new(
        &Robot { footprint, ..robot },
        &walled,
        drive.pose,
        &[[2.525, 2.525], [4.0, 2.525]],
    );
    assert!(freed.decide().unwrap().evaluation.driving > 0);
}

fn shaped(shape: usize) -> Robot {
    match shape {
        0 => Robot::small(),
        1 => Robot::jackal(),
        _ => {
            // It turns around its back.
            let vertices = [[0.5, 0.1], [-0.05, 0.1], [-0.05, -0.1], [0.5, -0.1]];
            let vertices = vertices.iter().map(|&vertex| vertex.into()).collect();
            Robot { footprint: Footprint::polygon(vertices).unwrap(), ..Robot::small() }
        }
    }
}

fn blocks() -> impl Strategy<Value = DistanceField> {
    prop::collection::vec((0i32..80, 0i32..80), 0..60).prop_map(|blocks| {
        let is_block = |x: i32, y: i32| {
            blocks.iter().any(|&(bx, by)| (bx - x).abs() < 2 && (by - y).abs() < 2)
        };
        world(80, is_block)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// For any route, also through obstacles: a robot that starts free never touches stationary
    /// obstacles.
    #[test]
    fn never_touches_what_stands_still(
        world in blocks(), heading in -3.0..3.0f64, end in (0.1..3.9f64, 0.1..3.9f64), shape in 0..3usize,
    ) {
        let robot = shaped(shape);
        let start = Pose::new(2.0, 2.0, heading);
        prop_assume!(
            robot.footprint.is_free(start, &world)
                && robot.footprint.distance_m(start, &world.clearance(), 1.0) > robot.safety_margin_or_default_m()
        );
        let mut drive = Drive::new(&robot, &world, start, &[[2.0, 2.0], [end.0, end.1]]);
        for _ in 0..60 {
            for pose in drive.cycle() {
                prop_assert!(robot.footprint.is_free(pose, &world), "touched at {pose:?}");
            }
        }
    }

    /// At the end of any stretch of the chosen trajectory, braking along the arc touches nothing,
    /// to less than a cell.
    #[test]
    fn it_could_stop_at_the_end_of_every_stretch(
        world in blocks(), heading in -3.0..3.0f64, end in (0.1..3.9f64, 0.1..3.9f64), v_mps in 0.5..2.0f64,
    ) {
        let robot = Robot::jackal();
        let start = Pose::new(2.0, 2.0, heading);
        prop_assume!(robot.footprint.is_free(start, &world));
        let mut drive = Drive::new(&robot, &world, start, &[[2.0, 2.0], [end.0, end.1]]);
        drive.velocity = Velocity::new(v_mps, 0.0);
        prop_assume!(drive.decide().is_ok());
        let course = drive.memory.course().cloned().unwrap();
        let body = robot.footprint.smaller_by(0.05).unwrap();
        let (stretch_s, limits) = (course.stretch_s, &robot.limits);
        let (mut pose, mut velocity) = (start, drive.velocity);
        for &next in &course.velocities {
            pose = (0..20).fold(pose, |pose, part| {
                let at = |part: i32| velocity.lerp(next, f64::from(part) / 20.0);
                pose.after_ramp(at(part), at(part + 1), stretch_s / 20.0)
            });
            velocity = next;
            if pose.point().distance(Point::new(end.0, end.1)) < velocity.v * stretch_s + 0.3 {
                break;
            }
            let stop_s = (velocity.v.abs() / limits.deceleration_mps2)
                .max(velocity.omega.abs() / limits.angular_deceleration_radps2);
            let mut at = pose;
            for part in 0..20 {
                let now = |part: i32| velocity.lerp(Velocity::ZERO, f64::from(part) / 20.0);
                at = at.after_ramp(now(part), now(part + 1), stop_s / 20.0);
                prop_assert!(body.is_free(at, &world), "at {at:?}, braking from {pose:?} {velocity:?}");
            }
        }
    }

    /// Unless something moves, a mirrored world gives a mirrored drive: no two random
    /// trajectories are equally good. The cells are a sixteenth of a metre, so that their
    /// mirrored centres are exact.
    #[test]
    fn left_and_right_are_alike(
        blocks in prop::collection::vec((0i32..80, 0i32..80), 0..50), (x, y, heading) in (1.0..4.0f64, 1.0..4.0f64, -3.0..3.0f64),
        (v, omega) in (0.0..0.5f64, -0.4..0.4f64), end in (0.2..4.8f64, 0.2..4.8f64), shape in 0..3usize,
    ) {
        const SIDE_M: f64 = 5.0;
        let is_block = |x: i32, y: i32| blocks.iter().any(|&(bx, by)| (bx - x).abs() < 2 && (by - y).abs() < 3);
        let robot = shaped(shape);
        let worlds = [world_of(0.0625, 80, is_block), world_of(0.0625, 80, |x, y| is_block(x, 79 - y))];
        let [mut left, mut right] = [(&worlds[0], 0.0, 1.0), (&worlds[1], SIDE_M, -1.0)].map(|(world, axis_m, side)| {
            let at = |x: f64, y: f64| [x, axis_m + side * y];
            let start = Pose::new(x, axis_m + side * y, side * heading);
            let mut drive = Drive::new(&robot, world, start, &[at(x, y), at(end.0, end.1)]);
            drive.velocity = Velocity::new(v, side * omega);
            drive
        });
        for cycle in 0..5 {
            left.cycle();
            right.cycle();
            let (a, b) = (left.velocity, right.velocity);
            prop_assert!((a.v - b.v).abs() < 1e-9 && (a.omega + b.omega).abs() < 1e-9, "{cycle}: {a:?} {b:?}");
        }
    }
}
