use super::*;
use crate::geometry::{Point, Polyline, Pose, Velocity};
use crate::local::{Detour, OwnMemory};
use crate::map::{DistanceField, FieldConfig, OccupancyGrid};

/// A world on cells of 1 m: `#` is on the known map, `o` was sensed.
struct World {
    field: DistanceField,
    sensed: OccupancyGrid,
}

impl World {
    fn new(rows: &[&str]) -> Self {
        let as_grid = |cell: fn(char) -> char| {
            let rows: Vec<String> =
                rows.iter().map(|row| row.chars().map(cell).collect()).collect();
            OccupancyGrid::from_ascii(&rows.iter().map(String::as_str).collect::<Vec<_>>())
        };
        let all = as_grid(|c| if c == 'o' { '#' } else { c });
        let sensed = as_grid(|c| if c == 'o' { '#' } else { '.' });
        let config = FieldConfig::default();
        Self { field: DistanceField::new(all.frame(), all.occupied(), &config), sensed }
    }

    fn scene<'a>(&'a self, pose: Pose, path: &'a Polyline) -> Scene<'a> {
        let guide = *path.points().last().unwrap();
        let sensed = self.sensed.occupied();
        Scene {
            obstacles: &self.field,
            sensed,
            seen: crate::sense::SeenCells::ANYWHERE,
            movers: &[],
            walked: &[],
            pose,
            velocity: Velocity::ZERO,
            guide,
            path,
            goal_heading_rad: None,
            remaining_m: f64::INFINITY,
            jerk_limited: None,
        }
    }

    /// The target of a cycle of the published planner.
    fn target(&self, pose: Pose, path: &Polyline, memory: &mut DriveMemory) -> Option<[f64; 2]> {
        let scene = self.scene(pose, path);
        let points = GuidePoints { config: &DetourConfig::PAPER, scene: &scene };
        points.target(memory, &mut Cluster::default()).unwrap().map(Into::into)
    }
}

fn line(points: &[[f64; 2]]) -> Polyline {
    Polyline::new(points.iter().map(|&p| p.into()).collect())
}

/// A hall of 20 x 8 m with obstacles in the given cells.
fn hall(sensed: &[(usize, usize)], known: &[(usize, usize)]) -> World {
    let cell = |x: usize, y: usize| {
        if sensed.contains(&(x, y)) {
            'o'
        } else if known.contains(&(x, y)) {
            '#'
        } else {
            '.'
        }
    };
    let rows: Vec<String> = (0..8).rev().map(|y| (0..20).map(|x| cell(x, y)).collect()).collect();
    World::new(&rows.iter().map(String::as_str).collect::<Vec<_>>())
}

fn straight() -> Polyline {
    line(&[[0.5, 2.5], [19.5, 2.5]])
}

/// After 9 m it turns left.
fn bend() -> Polyline {
    line(&[[0.5, 2.5], [9.5, 2.5], [9.5, 7.5]])
}

fn covered(covered_m: f64) -> DriveMemory {
    DriveMemory { covered_m, ..DriveMemory::default() }
}

#[expect(clippy::unnecessary_wraps, reason = "as it is remembered")]
fn behind(from: [f64; 2], point: [f64; 2], rejoin_m: f64) -> Option<Detour> {
    Some(Detour::Behind { from: from.into(), point: point.into(), rejoin_m })
}

#[test]
fn the_whole_way_around_on_a_straight_route() {
    let (world, path, mut memory) = (hall(&[(8, 2)], &[]), straight(), covered(1.9));
    // The first node nearer than 0.8 m to the cell is (7.5, 2.5), 7 m along the route.
    assert_eq!(world.target(Pose::new(2.4, 2.5, 0.0), &path, &mut memory), None);
    memory.covered_m = 2.0;
    // x_j is (3.5, 2.5), so x_ga is at 2 * 8.5 - 3.5; it is a node itself.
    let target = world.target(Pose::new(2.5, 2.5, 0.0), &path, &mut memory);
    assert_eq!(
        (target, memory.detour()),
        (Some([13.5, 2.5]), behind([3.5, 2.5], [13.5, 2.5], 13.0))
    );
    // While it drives there x_j stays.
    assert_eq!(world.target(Pose::new(8.5, 4.5, 0.0), &path, &mut memory), Some([13.5, 2.5]));
    assert_eq!(memory.covered_m, 2.0);
    // In the invalid zone e_gs is 0 and all nodes ahead are in the direction of e_gt: the first one
    // is taken.
    assert_eq!(world.target(Pose::new(13.1, 2.7, 0.0), &path, &mut memory), Some([14.5, 2.5]));
    let back = Detour::Back { point: Point::new(14.5, 2.5), along_m: 14.0 };
    assert_eq!((memory.detour(), memory.covered_m), (Some(back), 13.0));
    assert_eq!(world.target(Pose::new(13.7, 2.7, 0.0), &path, &mut memory), Some([14.5, 2.5]));
    assert_eq!(world.target(Pose::new(14.1, 2.6, 0.0), &path, &mut memory), None);
    assert_eq!(memory, covered(14.0));
}

#[test]
fn a_next_node_beside_the_obstacle_is_not_before_it() {
    let (world, path, mut memory) = (hall(&[(8, 2)], &[]), straight(), covered(6.3));
    assert_eq!(world.target(Pose::new(6.8, 2.5, 0.0), &path, &mut memory), Some([10.2, 2.5]));
    assert_eq!(memory.detour(), behind([6.8, 2.5], [10.2, 2.5], 10.0));
}

#[test]
fn equations_20_and_21_beside_a_bend() {
    let (world, path) = (hall(&[(7, 2)], &[]), bend());
    // x_j (4.5, 2.5), x_ga (10.5, 2.5), x_st (9.5, 2.5): e_gs points back.
    let back = |world: &World, theta: f64| {
        let mut memory = covered(3.0);
        let target = world.target(Pose::new(3.5, 2.5, 0.0), &path, &mut memory);
        assert_eq!(
            (target, memory.detour()),
            (Some([10.5, 2.5]), behind([4.5, 2.5], [10.5, 2.5], 9.0))
        );
        world.target(Pose::new(10.3, 2.5, theta), &path, &mut memory).unwrap()
    };
    // e_gi = 0, so e_gs; of (-1, 1), (-1, 2), (-1, 3), ... the first is closest to it.
    assert_eq!(back(&world, 0.0), [9.5, 3.5]);
    // e_gi = (0.6 - 1, 0.8), the direction of (-1, 2).
    let theta = libm::atan2(0.8, 0.6);
    assert_eq!(back(&world, theta), [9.5, 4.5]);
    // A wall at 0.71 m of (9.5, 3.5) and (9.5, 5.5).
    assert_eq!(back(&hall(&[(7, 2)], &[(8, 4)]), theta), [9.5, 6.5]);
    // With a wall between the detour and the route there is no candidate: x_st.
    let across: Vec<(usize, usize)> = (9..13).map(|x| (x, 4)).collect();
    assert_eq!(back(&hall(&[(7, 2)], &across), theta), [9.5, 2.5]);
}

#[test]
fn a_point_behind_that_is_not_free_moves_to_the_route() {
    let path = bend();
    let target = |world: &World| {
        let mut memory = covered(3.0);
        (world.target(Pose::new(3.5, 2.5, 0.0), &path, &mut memory), memory.detour())
    };
    // (6.5, 2.5) is the first node at the obstacle; (8.5, 2.5) is 0.5 m from it, (9.5, 2.5) free.
    let moved = (Some([9.5, 2.5]), behind([4.5, 2.5], [9.5, 2.5], 9.0));
    assert_eq!(target(&hall(&[(7, 2)], &[(11, 2)])), moved, "covered");
    assert_eq!(target(&hall(&[(7, 2), (11, 2)], &[])), moved, "by something else that was sensed");
    // x_ga (10.5, 2.5) is free, but not the line there from (4.5, 2.5).
    let walled = hall(&[(6, 2)], &[(7, 2)]);
    assert_eq!(target(&walled).0, Some([9.5, 2.5]), "behind a wall");
}

#[test]
fn nothing_free_behind_is_for_the_caller() {
    let robot = Robot::paper();
    let planner = GuidedDwa::new(GuidedDwaConfig::PAPER, robot).unwrap();
    let world = hall(&[(17, 2), (18, 2)], &[]);
    let (path, mut memory) = (straight(), covered(13.0));
    let velocity = Velocity::new(0.5, 0.0);
    let scene = Scene { velocity, ..world.scene(Pose::new(13.5, 2.5, 0.0), &path) };
    let why = planner.decide(&scene, &mut memory, &mut Scratch::default()).unwrap_err();
    // x_ga lies outside; (17.5, 2.5) to (19.5, 2.5) are on the obstacle or 0.5 m from it.
    assert_eq!((why.evaluation.candidates, why.evaluation.rejected.count(COVERED)), (4, 4));
    assert!((why.fallback.v - 0.48).abs() < 1e-12);
    assert!(why.to_string().contains("4 positions behind an obstacle are not free"), "{why}");
}

#[test]
fn every_cycle_sees_where_the_obstacle_is_now() {
    let (path, mut memory) = (straight(), covered(3.0));
    let pose = Pose::new(3.5, 2.5, 0.0);
    let target = |memory: &mut DriveMemory, pose, cells: &[(usize, usize)]| {
        hall(cells, &[]).target(pose, &path, memory)
    };
    assert_eq!(target(&mut memory, pose, &[(7, 2)]), Some([10.5, 2.5]));
    // It has moved half a metre, and a metre farther on: x_ob moves, x_j stays.
    assert_eq!(target(&mut memory, pose, &[(7, 2), (8, 2)]), Some([11.5, 2.5]));
    assert_eq!(target(&mut memory, pose, &[(8, 2)]), Some([12.5, 2.5]));
    // Gone: the robot, which is beside the route by now, continues along it from its present
    // position.
    assert_eq!(target(&mut memory, Pose::new(6.0, 4.0, 0.0), &[]), None);
    assert_eq!(memory, covered(5.5));
    // The same on the way back, if an obstacle appears at the point at which the route is to be
    // joined.
    let point = Point::new(14.5, 2.5);
    let own = OwnMemory::Detour(Detour::Back { point, along_m: 14.0 });
    memory = DriveMemory { covered_m: 13.0, own };
    assert_eq!(target(&mut memory, Pose::new(13.5, 2.5, 0.0), &[(14, 2)]), Some([16.5, 2.5]));
    assert!(matches!(memory.detour(), Some(Detour::Behind { .. })));
}

#[test]
fn the_follower_drives_where_nothing_unknown_is() {
    let robot = Robot::paper();
    let config = GuidedDwaConfig::PAPER;
    let planner = GuidedDwa::new(config.clone(), robot.clone()).unwrap();
    let follower = Follower::new(config.follower, robot).unwrap();
    let path = bend();
    let decide = |planner: &dyn LocalPlanner, world: &World, pose| {
        let scene = world.scene(pose, &path);
        let mut memory = covered(3.0);
        planner.decide(&scene, &mut memory, &mut Scratch::default()).unwrap()
    };
    let pose = Pose::new(3.5, 2.4, 0.1);
    let (open, beside) = (hall(&[], &[]), hall(&[(5, 4)], &[]));
    let expected = decide(&follower, &open, pose);
    assert_eq!(decide(&planner, &open, pose), expected);
    assert_eq!(decide(&planner, &beside, pose), expected, "1.5 m from the route");
}

#[test]
fn the_follower_drives_at_full_speed_in_the_open() {
    let robot = Robot::small();
    let planner = GuidedDwa::new(GuidedDwaConfig::for_robot(&robot), robot).unwrap();
    let (world, path) = (hall(&[], &[]), straight());
    for v in [0.1, 0.2, 0.25, 0.3, 0.45, 0.5] {
        for i in 0..40 {
            let pose = Pose::new(2.5 + 0.213 * f64::from(i), 2.5 + 0.01 * f64::from(i % 7), 0.01);
            let scene = Scene { velocity: Velocity::new(v, 0.0), ..world.scene(pose, &path) };
            let mut memory = covered(pose.x - 0.5);
            let decision = planner.decide(&scene, &mut memory, &mut Scratch::default()).unwrap();
            assert_eq!(decision.evaluation, Evaluation::default(), "{v} m/s at {pose:?}");
            assert!((decision.command.v - (v + 0.05).min(0.5)).abs() < 1e-12);
        }
    }
}

#[test]
fn the_follower_does_not_drive_into_anything() {
    let planner = GuidedDwa::new(GuidedDwaConfig::PAPER, Robot::paper()).unwrap();
    // At 0.4 m/s it needs 0.4 m and a cycle to stop. The route, straight ahead, leads through a
    // known wall.
    let (world, path) = (hall(&[], &[(8, 2)]), straight());
    let evaluated = |x: f64| {
        let velocity = Velocity::new(0.4, 0.0);
        let scene = Scene { velocity, ..world.scene(Pose::new(x, 2.5, 0.0), &path) };
        let decision = planner.decide(&scene, &mut covered(x - 0.5), &mut Scratch::default());
        decision.map_or_else(|why| why.evaluation, |decision| decision.evaluation).candidates
    };
    assert_eq!(evaluated(7.4), 0, "the follower drives");
    assert!(evaluated(7.55) > 0, "a dynamic window decides");
}

/// Drives from a start to the end of the route, among obstacles that are all sensed from the
/// beginning.
fn drive(world: &World, path: &Polyline, robot: &Robot, config: GuidedDwaConfig) -> (Point, f64) {
    let planner = GuidedDwa::new(config, robot.clone()).unwrap();
    let goal = *path.points().last().unwrap();
    let start = path.points()[0];
    let (mut pose, mut velocity) = (Pose::new(start.x, start.y, 0.0), Velocity::ZERO);
    let (mut memory, mut scratch) = (DriveMemory::default(), Scratch::default());
    let mut nearest_m = f64::INFINITY;
    for _ in 0..2000 {
        if pose.point().distance(goal) <= 0.5 {
            break;
        }
        let scene = Scene { velocity, ..world.scene(pose, path) };
        let decision = planner.decide(&scene, &mut memory, &mut scratch);
        let command = decision.map_or_else(|why| why.fallback, |decision| decision.command);
        let next = robot.limits.reached(velocity, command, robot.cycle_s);
        pose = pose.after_ramp(velocity, next, robot.cycle_s);
        velocity = next;
        nearest_m = nearest_m.min(world.field.clearance().of_point(pose.point(), 9.0));
    }
    (pose.point(), nearest_m)
}

#[test]
fn drives_around_what_stands_on_the_route() {
    let weights = GuidedWeights { heading: 0.05, target_distance: 0.1, obstacle_distance: 1.0 };
    let far_from_obstacles = GuidedDwaConfig { weights, ..GuidedDwaConfig::PAPER };
    let path = straight();
    for cells in [&[(8, 2)][..], &[(8, 2), (8, 3)]] {
        let world = hall(cells, &[]);
        let (end, nearest_m) = drive(&world, &path, &Robot::paper(), far_from_obstacles.clone());
        let goal = Point::new(19.5, 2.5);
        assert!(end.distance(goal) <= 0.5 && nearest_m > 0.4, "{end:?} {nearest_m}");
    }
}

#[test]
fn stands_in_front_of_what_it_cannot_drive_around() {
    // The point behind it is straight ahead, so every turn increases the cost: the caller has to
    // plan a new route.
    let (world, path) = (hall(&[(8, 2)], &[]), straight());
    let (end, nearest_m) = drive(&world, &path, &Robot::paper(), GuidedDwaConfig::PAPER);
    assert!(end.x > 7.5 && end.x < 8.0 && nearest_m > 0.0, "{end:?} {nearest_m}");
    let robot = Robot::small();
    let (end, nearest_m) = drive(&world, &path, &robot, GuidedDwaConfig::for_robot(&robot));
    assert!(end.x > 7.5 && end.x < 8.0 && nearest_m > 0.18, "{end:?} {nearest_m}");
}

#[test]
fn what_cannot_be_used_is_named() {
    let base = GuidedDwaConfig::PAPER;
    let field = |config| GuidedDwa::new(config, Robot::paper()).unwrap_err().path;
    let weights = GuidedWeights { target_distance: -1.0, ..base.weights };
    assert_eq!(field(GuidedDwaConfig { weights, ..base.clone() }), "weights.target_distance");
    let detour = DetourConfig { clearance_m: 0.0, ..base.detour };
    assert_eq!(field(GuidedDwaConfig { detour, ..base.clone() }), "detour.clearance_m");
    let follower = FollowerConfig { look_ahead_m: f64::NAN };
    assert_eq!(field(GuidedDwaConfig { follower, ..base.clone() }), "follower.look_ahead_m");
    let window = WindowConfig { horizon_s: -1.0, ..base.window.clone() };
    assert_eq!(field(GuidedDwaConfig { window, ..base }), "window.horizon_s");
}

#[test]
fn explains_what_it_decides_on_a_detour_and_nothing_on_its_route() {
    let planner = GuidedDwa::new(GuidedDwaConfig::PAPER, Robot::paper()).unwrap();
    let path = line(&[[1.5, 4.5], [18.5, 4.5]]);
    let pose = Pose::new(3.5, 4.5, 0.0);
    // x_ga behind the cell, as x_j is (4.5, 4.5) (eq. 19), and the carrot, 1 m ahead.
    for (world, is_asked, target) in
        [(hall(&[(6, 4)], &[]), true, [8.5, 4.5]), (hall(&[], &[]), false, [4.5, 4.5])]
    {
        let scene = Scene { velocity: Velocity::new(0.2, 0.0), ..world.scene(pose, &path) };
        let mut memory = covered(2.0);
        let explanation = planner.explain(&scene, &memory);
        let decision = planner.decide(&scene, &mut memory, &mut Scratch::default()).unwrap();
        let chosen = explanation.chosen.map(|index| explanation.candidates[index].velocity);
        assert_eq!(explanation.target, Some(target.into()));
        assert_eq!(chosen, is_asked.then_some(decision.command));
        let candidates = explanation.candidates.len() as u32;
        assert_eq!(candidates, if is_asked { decision.evaluation.candidates } else { 0 });
    }
}

/// A known wall across the route, which the follower would drive into: the follower decides as
/// long as the robot can still stop after its command, and then the dynamic window.
#[test]
fn a_command_after_which_it_cannot_stop_is_not_followed() {
    let wall: Vec<(usize, usize)> = (0..8).map(|y| (12, y)).collect();
    let (world, path) = (hall(&[], &wall), straight());
    let robot = Robot::small();
    let planner = GuidedDwa::new(GuidedDwaConfig::for_robot(&robot), robot.clone()).unwrap();
    let velocity = Velocity::new(0.5, 0.0);
    let look_ahead_m = FollowerConfig::for_robot(&robot).look_ahead_m;
    let candidates = |x: f64| {
        let scene = Scene { velocity, ..world.scene(Pose::new(x, 2.5, 0.0), &path) };
        let mut memory = DriveMemory { covered_m: x - 0.5, ..DriveMemory::default() };
        let explanation = planner.explain(&scene, &memory);
        let decided = planner.decide(&scene, &mut memory, &mut Scratch::default());
        let evaluation = decided.map_or_else(|why| why.evaluation, |decision| decision.evaluation);
        // The deciding planner drives to the carrot, and the explanation is that planner's.
        assert_eq!(explanation.candidates.len() as u32, evaluation.candidates);
        let off_m = explanation.target.unwrap().distance(Point::new(x + look_ahead_m, 2.5));
        assert!(off_m < 1e-9, "{explanation:?}");
        evaluation.candidates
    };
    // The wall begins at 12 m: 0.18 m of footprint, 5 mm of margin, 0.05 m of the next cycle and
    // 0.25 m to stop.
    assert_eq!(candidates(12.0 - 0.5), 0, "the follower");
    assert!(candidates(12.0 - 0.47) > 0, "the dynamic window");
}
