//! Costs of headings, compared with closed forms.

use super::*;
use crate::geometry::Pose;
use crate::local::rear::Rear;
use crate::local::space_time::cost_to_go::{WayAhead, Weighing};
use crate::local::space_time::free_headings::BlockedHeadings;
use crate::local::space_time::pose_times::Facing;
use crate::local::space_time::room::Room;
use crate::map::{BitGrid, Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use crate::robot::{Footprint, Robot};
use std::f64::consts::PI;

const CELL_M: f64 = 0.05;

/// A hall to the left of x = 3 m, and a lane from there on, 0.6 m wide, whose middle is at y = 3 m.
fn hall_and_lane() -> DistanceField {
    let frame = GridFrame::new(120, 120, CELL_M, Pose::default()).unwrap();
    let map = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
        let is_wall = x >= 60 && !(54..66).contains(&y);
        if is_wall { CellState::Occupied } else { CellState::Free }
    });
    DistanceField::new(&frame, map.occupied(), &FieldConfig::default())
}

/// Cost of headings for a robot of 0.8 m x 0.4 m at a position, for a path to another one.
fn pose_cost(robot: &Robot, from: Point, end: WayEnd) -> PoseCost {
    pose_cost_over(robot, from, end, None)
}

/// The same if the robot may drive backwards over some cells only.
fn pose_cost_over(robot: &Robot, from: Point, end: WayEnd, seen: Option<&BitGrid>) -> PoseCost {
    let field = hall_and_lane();
    let lattice = Lattice::around(field.frame(), from, 3.0, CELL_M);
    let mut room = Room::default();
    room.fill(lattice, &field, 1.0);
    let weighing = Weighing {
        blocked_m: 0.2,
        turning_m: 0.45,
        comfortable_m: 0.6,
        discomfort: 0.5,
        tight: 0.0,
    };
    let room_m = |at: Point| room.of_point(at);
    let mut cost_to_go = CostToGo::default();
    let route = [from, end.at];
    let way = WayAhead { robot: from, route: &route, walked: &[] };
    cost_to_go.fill(lattice, &weighing, room_m, &way, 9.0);
    let mut blocked = BlockedHeadings::default();
    blocked.fit(&robot.footprint, 0.0, CELL_M);
    let ground = Ground { obstacles: &field, blocked: &blocked, inscribed_m: 0.2, turning_m: 0.45 };
    let (rear, can_reverse) = (Rear::of(&robot.footprint, 0.5), robot.limits.v_min_mps < 0.0);
    let seen = seen.map(|cells| rear.over(cells, field.frame()));
    let driven = Driven { limits: &robot.limits, can_reverse, seen };
    let mut pose_cost = PoseCost::default();
    pose_cost.fill((lattice, &cost_to_go), room_m, (&ground, driven), (from, AHEAD), &end);
    pose_cost
}

/// 1 m/s ahead, a turn around in 3 s.
fn robot(v_min_mps: f64) -> Robot {
    let mut robot = Robot::small();
    robot.footprint = Footprint::rectangle(0.8, 0.4).unwrap();
    (robot.limits.v_max_mps, robot.limits.v_min_mps) = (1.0, v_min_mps);
    robot.limits.omega_max_radps = PI / 3.0;
    robot
}

const AHEAD: Point = Point::new(1.0, 0.0);
const BACK: Point = Point::new(-1.0, 0.0);

/// Along the lane to its right end, where any heading is right: 1.5 s ahead, 3 s back at half the
/// speed.
#[test]
fn backwards_through_a_lane_takes_as_long_as_the_drive_back() {
    let (from, end) = (Point::new(3.5, 3.0), Point::new(5.0, 3.0));
    let end = WayEnd { at: end, facing: Facing::Any };
    let cost = pose_cost(&robot(-0.5), from, end);
    assert!(cost.is_active());
    assert!(cost.of(from, AHEAD).unwrap() < 0.05);
    let back_s = cost.of(from, BACK).unwrap();
    assert!((back_s - 1.5).abs() < 0.15, "{back_s}");
    // A robot that cannot reverse has to leave the lane, to turn, and to come back.
    let cost = pose_cost(&robot(0.0), from, end);
    let around_s = cost.of(from, BACK).unwrap();
    assert!(around_s > 3.0 + 2.0 * 0.5, "{around_s}");
}

/// Its goal is 1 m inside of the lane, where it is to face out.
#[test]
fn who_is_to_face_out_turns_before_the_lane() {
    let goal = WayEnd { at: Point::new(4.5, 3.0), facing: Facing::At(PI) };
    let hall = Point::new(2.0, 3.0);
    let cost = pose_cost(&robot(-0.5), hall, goal);
    let [ahead_s, back_s] = [AHEAD, BACK].map(|ahead| cost.of(hall, ahead).unwrap());
    // Both drive the lane back, 1.7 m of it: the one that faces ahead turns before.
    assert!((back_s - 2.5).abs() < 0.3, "{back_s}");
    assert!((1.5..3.5).contains(&(ahead_s - back_s + 1.0)), "{ahead_s} {back_s}");
    // Nose first in the lane, it has to come out again.
    let inside = Point::new(4.3, 3.0);
    let [ahead_s, back_s] = [AHEAD, BACK].map(|ahead| cost.of(inside, ahead).unwrap());
    assert!(back_s < 0.5 && ahead_s > 3.0 + 2.0, "{ahead_s} {back_s}");
}

#[test]
fn in_the_open_and_for_a_disc_headings_do_not_matter() {
    let end = WayEnd { at: Point::new(1.0, 1.0), facing: Facing::At(PI) };
    assert!(!pose_cost(&robot(0.0), Point::new(1.8, 3.0), end).is_active());
    let disc = Robot { footprint: Footprint::circle(0.2).unwrap(), ..robot(0.0) };
    let end = WayEnd { at: Point::new(5.0, 3.0), facing: Facing::At(PI) };
    assert!(!pose_cost(&disc, Point::new(3.5, 3.0), end).is_active());
}

/// For the slowest turner, too, the headings at the end are those in which the path continues.
#[test]
fn a_slow_turner_is_not_lost_at_the_end_of_the_way() {
    let mut slow = robot(0.0);
    slow.limits.omega_max_radps = 0.02;
    let (from, end) = (Point::new(2.0, 3.0), Point::new(4.0, 3.0));
    let cost = pose_cost(&slow, from, WayEnd { at: end, facing: Facing::On(0.0) });
    assert!(cost.of(from, AHEAD).unwrap() < 0.05);
    assert!(cost.of(from, BACK).unwrap() > 5.0);
    // Backwards to the end: the cost is that of turning there, and of the drive back.
    slow.limits.v_min_mps = -0.5;
    let (from, end) = (Point::new(3.6, 3.0), Point::new(4.6, 3.0));
    let cost = pose_cost(&slow, from, WayEnd { at: end, facing: Facing::On(0.0) });
    let back_s = cost.of(from, BACK).unwrap();
    assert!((5.0..10.0).contains(&back_s), "{back_s}");
}

/// The same with a turning radius of 0.5 m.
fn car(v_min_mps: f64) -> Robot {
    let mut car = robot(v_min_mps);
    car.limits.min_turning_radius_m = 0.5;
    car
}

#[test]
fn on_a_gentle_path_the_headings_of_a_car_do_not_matter() {
    let is_active = |x, y, facing| {
        let end = WayEnd { at: Point::new(x, y), facing };
        pose_cost(&car(-0.5), Point::new(0.8, 3.0), end).is_active()
    };
    assert!(!is_active(2.2, 3.0, Facing::Any));
    assert!(!is_active(2.2, 3.6, Facing::Any));
    assert!(is_active(2.2, 3.0, Facing::At(0.0)), "a heading at the end");
    assert!(is_active(1.2, 4.2, Facing::Any), "to the left");
    assert!(is_active(0.8, 3.3, Facing::Any), "nearer than an arc leads");
}

/// An arc ahead and one back, each half of the angle, or a loop.
#[test]
fn a_wrong_heading_at_the_end_costs_a_car_a_manoeuvre() {
    let end = WayEnd { at: Point::new(2.0, 3.0), facing: Facing::At(0.0) };
    let at_end = |robot: &Robot| pose_cost(robot, Point::new(1.0, 3.0), end);
    let turned = |angle_rad: f64| Point::new(angle_rad.cos(), angle_rad.sin());
    let (car, forward_only) = (car(-0.5), car(0.0));
    let cost = at_end(&car);
    let start_s = 1.0 / car.limits.acceleration_mps2;
    for off_rad in [0.2_f64, -0.5, 2.0] {
        // 0.5 s for a radian ahead, and 1 s for one back.
        let expected_s = start_s + 0.75 * off_rad.abs();
        let cost_s = cost.of(end.at, turned(off_rad)).unwrap();
        assert!((cost_s - expected_s).abs() < 1e-5, "{off_rad}: {cost_s} {expected_s}");
        assert!(cost.turns_elsewhere(end.at, turned(off_rad)));
    }
    assert!(cost.of(end.at, AHEAD).unwrap() < 1e-9 && !cost.turns_elsewhere(end.at, AHEAD));
    let loop_s = at_end(&forward_only).of(end.at, turned(0.5)).unwrap();
    assert!((loop_s - PI).abs() < 1e-5, "{loop_s}");
}

/// Backwards through the lane as above, which takes 1.5 s more than ahead.
#[test]
fn a_car_does_not_back_up_over_unobserved_ground() {
    let (from, end) = (Point::new(3.5, 3.0), Point::new(5.0, 3.0));
    let end = WayEnd { at: end, facing: Facing::Any };
    let back_s = |cells: &BitGrid| {
        pose_cost_over(&car(-0.5), from, end, Some(cells)).of(from, BACK).unwrap()
    };
    let mut cells = BitGrid::new(120, 120, false);
    let none_s = back_s(&cells);
    (0..120).for_each(|y| cells.fill_span(y, 0, 119));
    let all_s = back_s(&cells);
    assert!((all_s - 1.5).abs() < 0.15, "{all_s}");
    assert!(none_s > 3.0, "{none_s}");
}
