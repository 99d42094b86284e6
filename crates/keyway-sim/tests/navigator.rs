//! The navigation loop in simulated worlds, and without one.
#![allow(clippy::unwrap_used)]

#[path = "../../keyway/tests/support/building.rs"]
mod building;
#[path = "../../keyway/tests/support/driving.rs"]
mod driving;

use building::{GOAL, START, blocks, building};
use driving::{bound_for, next_step};
use keyway::geometry::{Disc, Point, Pose, Segment, Velocity};
use keyway::map::{CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::{Blocked, NavigateError, Navigator, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::{Observation, Scan};
use keyway_sim::sim::{
    Action, Control, Disturbances, Outcome, Participant, Run, RunRules, World, simulate,
};

/// The stack `key-point-fusion` on the small robot, from [`START`] to [`GOAL`].
fn small_navigator(map: &OccupancyGrid) -> Navigator {
    let robot = Robot::small();
    bound_for(map, &Stack::key_point_fusion(&robot).fit(&robot).unwrap(), START, GOAL).unwrap()
}

/// Inputs and decisions of a navigator in a run.
type Record = Vec<(Pose, Velocity, Scan, Step)>;

fn drive(map: &OccupancyGrid, unknown: Vec<Disc>, record: &mut Record) -> Run {
    let (robot, mut navigator) = (Robot::small(), small_navigator(map));
    let goal_tolerance_m = Stack::key_point_fusion(&robot).controller.goal_tolerance_m;
    let world = World::from_known(map, unknown).unwrap();
    let rules = RunRules { goal_tolerance_m, time_limit_s: 120.0, ..RunRules::default() };
    let start = Pose::new(START.x, START.y, 0.0);
    let mut decide = |&Observation { pose, velocity, scans, .. }: &Observation<'_>| {
        let scan = scans[0].scan.owned();
        let step = next_step(&mut navigator, pose, velocity, &scan);
        record.push((pose, velocity, scan, step.clone()));
        let action = match step {
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let remaining_m = navigator.guidance().unwrap().remaining_m;
        Control { action, remaining_m, route: navigator.routes_planned(), turn_left_rad: 0.0 }
    };
    let participant = Participant {
        robot: &robot,
        start,
        goal: GOAL,
        disturbances: Disturbances::default(),
        rules,
        controller: &mut decide,
    };
    simulate(&world, &mut [participant]).unwrap().remove(0)
}

/// A scan without hits.
fn nothing() -> Scan {
    Scan::of_nothing(&Robot::small().sensors[0])
}

fn circle(x: f64, y: f64, radius_m: f64) -> Disc {
    Disc::new(Point::new(x, y), radius_m)
}

#[test]
fn drives_around_what_no_map_shows() {
    let map = building();
    let clear = drive(&map, vec![], &mut Record::new());
    assert_eq!(clear.outcome, Outcome::Reached);
    // In the middle of the path of the first run.
    let middle = clear.samples[clear.samples.len() / 2].pose;
    let unknown = vec![circle(middle.x, middle.y, 0.15)];
    let run = drive(&map, unknown, &mut Record::new());
    assert_eq!(run.outcome, Outcome::Reached);
    assert!(run.min_clearance_m.unwrap() > 0.0);
}

#[test]
fn commands_do_not_depend_on_what_is_hidden() {
    let map = building();
    let (mut open, mut haunted) = (Record::new(), Record::new());
    let run = drive(&map, vec![], &mut open);
    let other = drive(&map, vec![circle(8.5, 3.0, 0.4)], &mut haunted);
    assert_eq!(run, other);
    assert!(open == haunted, "the closed room changed what was seen or commanded");
}

#[test]
fn the_same_inputs_give_the_same_commands() {
    let map = building();
    let mut record = Record::new();
    drive(&map, vec![circle(3.4, 0.8, 0.15)], &mut record);
    let mut again = small_navigator(&map);
    for (pose, velocity, scan, step) in record {
        assert_eq!(next_step(&mut again, pose, velocity, &scan), step);
    }
}

/// After warm-up, unless a scan changes the map or a route is planned.
#[test]
fn a_cycle_allocates_nothing() {
    let map = building();
    let mut record = Record::new();
    drive(&map, vec![circle(3.4, 0.8, 0.15)], &mut record);
    let mut again = small_navigator(&map);
    let (mut quiet, mut planned) = (0, 0);
    for (index, (pose, velocity, scan, _)) in record.iter().enumerate() {
        let (routes, sensed) = (again.routes_planned(), again.sensed().clone());
        let info = allocation_counter::measure(|| {
            next_step(&mut again, *pose, *velocity, scan);
        });
        if again.routes_planned() != routes {
            planned += 1;
        } else if index > 50 && *again.sensed() == sensed {
            assert_eq!(info.count_total, 0, "cycle {index}");
            quiet += 1;
        }
    }
    assert!(quiet > 30 && planned > 0 && again.sensed().count_ones() > 0, "{quiet} {planned}");
}

#[test]
fn says_when_what_it_sees_leaves_no_route() {
    let map = blocks(&["############", "#..........#", "#..........#", "############"]);
    let robot = Robot::small();
    let stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(1.0, 1.0), Point::new(5.0, 1.0));
    let mut navigator = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    // A fence from wall to wall, 1 m ahead.
    let scan = Scan {
        angle_min_rad: -1.0,
        angle_increment_rad: 0.01,
        range_min_m: 0.0,
        range_max_m: 3.0,
        ranges_m: (0..200).map(|i| 1.0 / (-1.0 + 0.01 * f64::from(i)).cos()).collect(),
    };
    let pose = Pose::new(start.x, start.y, 0.0);
    let steps: Vec<Step> =
        (0..40).map(|_| next_step(&mut navigator, pose, Velocity::ZERO, &scan)).collect();
    assert!(navigator.sensed().count_ones() > 0);
    let no_route = |step: &Step| {
        matches!(step, Step::Blocked { why: Blocked::NoRoute(NavigateError::Plan(_)), .. })
    };
    assert!(steps.iter().any(no_route));
}

/// An obstacle on the route causes immediate replanning, at any distance, and only once while it
/// stays.
#[test]
fn plans_again_when_and_only_when_something_new_is_in_the_way() {
    let rows = ["############", "#..........#", "#..........#", "#..........#", "############"];
    let (map, robot) = (blocks(&rows), Robot::small());
    let mut stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(1.0, 1.0), Point::new(5.0, 1.0));
    let pose = Pose::new(start.x, start.y, 0.0);
    // A wall of 0.6 m across, 2.5 m ahead.
    let range = |i: i32| {
        let bearing: f64 = -0.12 + 0.01 * f64::from(i);
        if i < 24 { 2.5 / bearing.cos() } else { f64::INFINITY }
    };
    let scan = |first: i32| Scan {
        angle_min_rad: -0.12,
        angle_increment_rad: 0.01,
        range_min_m: 0.0,
        range_max_m: 3.0,
        ranges_m: (0..40).map(|i| if i < first { f64::NAN } else { range(i) }).collect(),
    };
    let mut navigator = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    next_step(&mut navigator, pose, Velocity::ZERO, &scan(0));
    assert_eq!((navigator.routes_planned(), navigator.ways_taken()), (2, 2));
    for _ in 0..25 {
        next_step(&mut navigator, pose, Velocity::ZERO, &scan(0));
    }
    assert_eq!(navigator.routes_planned(), 2, "nothing new");
    // Beams that only hit what the first ones have hit, or nothing.
    next_step(&mut navigator, pose, Velocity::ZERO, &scan(12));
    assert_eq!(navigator.routes_planned(), 2);
    // The published stack does not watch its route.
    stack.controller.watch_route = false;
    let mut unwatched = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    next_step(&mut unwatched, pose, Velocity::ZERO, &scan(0));
    assert_eq!(unwatched.routes_planned(), 1);
}

/// A scan of a wall of 7 m, 2 m ahead of a jackal at (2, 2), and of a post beside its end if
/// `is_cut`. If it is open, it has a passage of 0.6 m straight ahead: wide enough to drive through,
/// too narrow to turn in.
fn wall(is_open: bool, is_cut: bool) -> Scan {
    wall_with_passage(is_open.then_some(2.0), is_cut)
}

/// The same with a passage at another place.
fn wall_with_passage(passage_y_m: Option<f64>, is_cut: bool) -> Scan {
    let bearing_rad = |i: i32| -1.4 + 0.005 * f64::from(i);
    let range = |i: i32| {
        let y = 2.0 + 2.0 * bearing_rad(i).tan();
        let is_passage = passage_y_m.is_some_and(|middle_m| (y - middle_m).abs() < 0.3);
        let is_wall = (0.0..7.0).contains(&y) && !is_passage;
        let is_post = is_cut && (1.2..1.3).contains(&bearing_rad(i));
        if is_wall {
            2.0 / bearing_rad(i).cos()
        } else if is_post {
            3.0
        } else {
            f64::INFINITY
        }
    };
    Scan {
        angle_min_rad: bearing_rad(0),
        angle_increment_rad: 0.005,
        range_min_m: 0.0,
        range_max_m: 30.0,
        ranges_m: (0..=560).map(range).collect(),
    }
}

/// A jackal at (2, 2) that is to drive to (6, 2).
fn before_a_wall(detour_m: f64) -> Navigator {
    let frame = GridFrame::new(240, 200, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
    let (robot, start) = (Robot::jackal(), Point::new(2.0, 2.0));
    let mut stack = Stack::keyway(&robot);
    stack.controller.detour_for_clearance_m = detour_m;
    bound_for(&map, &stack.fit(&robot).unwrap(), start, Point::new(6.0, 2.0)).unwrap()
}

fn length_m(navigator: &Navigator) -> f64 {
    navigator.route().unwrap().smoothed.length_m()
}

/// The lengths of the routes of that robot, which stays where it is, cycle by cycle.
fn lengths_m(navigator: &mut Navigator, scans: impl IntoIterator<Item = Scan>) -> Vec<f64> {
    let pose = Pose::new(2.0, 2.0, 0.0);
    let steps = scans.into_iter().map(|scan| {
        next_step(navigator, pose, Velocity::ZERO, &scan);
        length_m(navigator)
    });
    steps.collect()
}

/// Around the wall it is at least 2 sqrt(2^2 + 5^2) = 10.8 m, through the passage about 4 m.
const AROUND_M: f64 = 10.7;

#[test]
fn a_new_route_takes_no_long_detour_for_more_clearance() {
    let length_m = |detour_m| lengths_m(&mut before_a_wall(detour_m), [wall(true, false)])[0];
    for detour_m in [0.0, 2.0, 6.0] {
        assert!((4.0..5.0).contains(&length_m(detour_m)), "{}", length_m(detour_m));
    }
    assert!(length_m(8.0) > AROUND_M, "{}", length_m(8.0));
}

#[test]
fn a_robot_without_progress_takes_any_detour() {
    let lengths_m = lengths_m(&mut before_a_wall(2.0), vec![wall(true, false); 200]);
    let around = lengths_m.iter().position(|length_m| *length_m > AROUND_M).unwrap();
    assert!(around > 10 && lengths_m[around..].iter().all(|length_m| *length_m > AROUND_M));
}

#[test]
fn a_gap_that_has_closed_is_not_trusted_again() {
    let scans = [wall(true, false), wall(false, false), wall(true, false), wall(true, true)];
    let mut navigator = before_a_wall(2.0);
    let lengths_m = lengths_m(&mut navigator, scans);
    assert!(lengths_m[0] < 5.0 && lengths_m[1] > AROUND_M, "{lengths_m:?}");
    // The post cuts the way around.
    assert!(lengths_m[3] != lengths_m[2] && lengths_m[3] > AROUND_M, "{lengths_m:?}");
    // The same goal once more is no reason to trust it; another one is.
    navigator.set_goal(Point::new(6.0, 2.0)).unwrap();
    assert!(length_m(&navigator) > AROUND_M);
    navigator.set_goal(Point::new(6.0, 2.1)).unwrap();
    assert!(length_m(&navigator) < 5.0, "{}", length_m(&navigator));
}

/// From the passage at 2 m to the one at 4 m it is 1.7 m more, again and again.
#[test]
fn detours_add_up() {
    let at = |passage_y_m| wall_with_passage(Some(passage_y_m), false);
    let scans = [2.0, 4.0, 2.0, 4.0, 2.0, 4.0].map(at);
    let lengths_m = lengths_m(&mut before_a_wall(2.0), scans);
    assert!(lengths_m[..3].iter().all(|length_m| *length_m < 6.5), "{lengths_m:?}");
    assert!(lengths_m[5] > AROUND_M, "{lengths_m:?}");
}

/// The message uses metres and the radius of the robot, because cells and the clearance of a layer
/// are not user settings.
#[test]
fn says_that_something_stands_on_the_goal() {
    let map = blocks(&["############", "#..........#", "#..........#", "############"]);
    let robot = Robot::small();
    let stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(1.0, 1.0), Point::new(2.0, 1.0));
    let mut navigator = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    let range = |i: i32| if (90..110).contains(&i) { 1.0 } else { f64::INFINITY };
    let scan = Scan {
        angle_min_rad: -1.0,
        angle_increment_rad: 0.01,
        range_min_m: 0.0,
        range_max_m: 3.0,
        ranges_m: (0..200).map(range).collect(),
    };
    let pose = Pose::new(start.x, start.y, 0.0);
    let steps: Vec<Step> =
        (0..100).map(|_| next_step(&mut navigator, pose, Velocity::ZERO, &scan)).collect();
    let no_route = |step: &Step| match step {
        Step::Blocked { why: Blocked::NoRoute(why), .. } => Some(why.to_string()),
        _ => None,
    };
    let text = steps.iter().find_map(no_route).unwrap();
    let expected = "goal (2, 1) has too little clearance for a radius of 0.18 m: ";
    assert!(text.starts_with(expected), "{text}");
    assert!(text.contains("nearest position with enough clearance is ("), "{text}");
}

/// If the guide required less clearance than the robot needs to turn, it would lead the robot
/// along impassable corners.
#[test]
fn the_guide_leaves_a_rectangle_room_to_turn() {
    let (map, robot) = (building(), Robot::jackal());
    let stack = Stack::key_point_fusion(&robot);
    let layers = SearchMap::new(&map, LayerConfig::default()).unwrap();
    let turning_m = robot.footprint.circumscribed_radius_m();
    let first = bound_for(&map, &stack.fit(&robot).unwrap(), START, GOAL).unwrap();
    assert!(first.route().unwrap().clearance_m > turning_m && first.misfit().is_none());
    let path = first.route().unwrap().smoothed.clone();
    let mut guides = Vec::new();
    for step in 0..60 {
        let Some(place) = path.at_length(0.1 * f64::from(step)) else { break };
        let mut navigator = bound_for(&map, &stack.fit(&robot).unwrap(), START, GOAL).unwrap();
        next_step(&mut navigator, Pose::new(place.x, place.y, 0.0), Velocity::ZERO, &nothing());
        let guide = navigator.guidance().unwrap().point;
        let way = Segment::new(place, guide);
        assert!(layers.clearance().is_clear(way, turning_m), "from {place:?} to {guide:?}");
        guides.push(guide);
    }
    guides.dedup();
    assert!(guides.len() > 1, "there is a corner");
}

/// In a passage that is too narrow to turn, the route of a rectangle keeps to the middle, not to
/// one side.
#[test]
fn a_route_through_a_narrow_place_keeps_to_its_middle() {
    // A wall with a passage of 0.65 m, from y = 1.2 to 1.85 m; to turn, the robot needs 0.686 m.
    let frame = GridFrame::new(80, 60, 0.05, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |cell| {
        let is_wall = (30..50).contains(&cell.x) && !(24..37).contains(&cell.y);
        if is_wall { CellState::Occupied } else { CellState::Free }
    });
    let robot = Robot::jackal();
    let stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(0.6, 0.6), Point::new(3.4, 0.6));
    let navigator = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    let route = navigator.route().unwrap();
    assert!((0.3..0.325).contains(&route.clearance_m), "{}", route.clearance_m);
    let inside = (0..100).filter_map(|i| route.smoothed.at_length(0.05 * f64::from(i)));
    let inside: Vec<Point> = inside.filter(|point| (1.5..2.5).contains(&point.x)).collect();
    assert!(inside.len() > 10 && inside.iter().all(|point| (point.y - 1.525).abs() < 0.03));
    assert_eq!(navigator.misfit(), None);
}

#[test]
fn a_pose_off_the_map_is_no_place_to_drive_from() {
    let mut navigator = small_navigator(&building());
    let away = Pose::new(-2.0, 1.0, 0.0);
    let step = next_step(&mut navigator, away, Velocity::new(0.5, 0.0), &nothing());
    let Step::Blocked { command, why } = step else { panic!("{step:?}") };
    assert!(command.v < 0.5 && why == Blocked::OffTheMap(away.point()));
    assert!(why.to_string().starts_with("the pose (-2, 1) is outside the map: "), "{why}");
    // Back on the map, it drives.
    let here = Pose::new(START.x, START.y, 0.0);
    assert!(matches!(next_step(&mut navigator, here, Velocity::ZERO, &nothing()), Step::Drive(_)));
}

#[test]
fn stops_when_it_cannot_know_where_it_is() {
    let map = building();
    let mut navigator = small_navigator(&map);
    let here = Pose::new(START.x, START.y, 0.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let inputs = [
            (Pose { x: bad, ..here }, Velocity::ZERO, "pose.x"),
            (Pose { y: bad, ..here }, Velocity::ZERO, "pose.y"),
            (Pose { theta: bad, ..here }, Velocity::ZERO, "pose.theta"),
            (here, Velocity::new(bad, 0.0), "velocity.v"),
            (here, Velocity::new(0.0, bad), "velocity.omega"),
        ];
        for (pose, velocity, field) in inputs {
            let step = next_step(&mut navigator, pose, velocity, &nothing());
            let why = Blocked::BadInput(field);
            assert_eq!(step, Step::Blocked { command: Velocity::ZERO, why });
        }
    }
    let absurd = next_step(&mut navigator, here, Velocity::new(1e9, 0.0), &nothing());
    let Step::Blocked { why, .. } = absurd else { panic!("{absurd:?}") };
    assert_eq!(why, Blocked::BadInput("velocity.v"));
    assert_eq!(
        why.to_string(),
        "velocity.v is implausible: not finite, or far beyond the robot's limits"
    );
    let nonsense = Scan {
        angle_min_rad: f64::NAN,
        angle_increment_rad: f64::INFINITY,
        range_min_m: 0.0,
        range_max_m: f64::NAN,
        ranges_m: vec![f64::NAN, -1.0, 0.0, f64::INFINITY, 1e300],
    };
    let step = next_step(&mut navigator, here, Velocity::ZERO, &nonsense);
    assert!(matches!(step, Step::Blocked { why: Blocked::SensorSilent { .. }, .. }), "{step:?}");
    assert_eq!(step.command(), Velocity::ZERO);
    assert!(matches!(next_step(&mut navigator, here, Velocity::ZERO, &nothing()), Step::Drive(_)));
}

#[test]
fn says_so_as_long_as_there_is_no_route() {
    let map = blocks(&["############", "#..........#", "#..........#", "############"]);
    let robot = Robot::small();
    let stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(1.0, 1.0), Point::new(5.0, 1.0));
    let mut navigator = bound_for(&map, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    let fence = |range: f64| Scan {
        angle_min_rad: -1.2,
        angle_increment_rad: 0.01,
        range_min_m: 0.0,
        range_max_m: 3.0,
        ranges_m: (0..240).map(|i| range / (-1.2 + 0.01 * f64::from(i)).cos()).collect(),
    };
    let pose = Pose::new(start.x, start.y, 0.0);
    let mut blocked = 0;
    for _ in 0..300 {
        let step = next_step(&mut navigator, pose, Velocity::ZERO, &fence(1.0));
        let waits = matches!(step, Step::Blocked { why: Blocked::NoRoute(_), .. });
        assert!(blocked == 0 || waits, "says that there is a route although nothing has changed");
        blocked += i32::from(waits);
    }
    assert!(blocked > 250);
    // 1 + 2 + 4 + 8 + 8 s of waiting.
    assert!(navigator.routes_planned() <= 8, "{}", navigator.routes_planned());
    // The fence is removed.
    let gone =
        (0..100).map(|_| next_step(&mut navigator, pose, Velocity::ZERO, &fence(f64::INFINITY)));
    assert!(gone.into_iter().any(|step| matches!(step, Step::Drive(_))));
}

#[test]
fn arrives_within_the_tolerance() {
    let map = building();
    let mut navigator = small_navigator(&map);
    let near = Pose::new(GOAL.x + 0.149, GOAL.y, 1.0);
    assert_eq!(next_step(&mut navigator, near, Velocity::ZERO, &nothing()), Step::Arrived);
    let far = Pose::new(GOAL.x + 0.151, GOAL.y, 1.0);
    assert_ne!(next_step(&mut navigator, far, Velocity::ZERO, &nothing()), Step::Arrived);
}
