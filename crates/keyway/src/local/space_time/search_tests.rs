//! The search evaluates only stretches that may be among the best. It finds the result of a
//! search that evaluates all of them.

use super::super::{Around, Scene, SpaceTime, SpaceTimeConfig};
use super::*;
use crate::geometry::{Point, Polyline, Pose};
use crate::map::{BitGrid, Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use crate::robot::Robot;
use crate::sense::Mover;
use proptest::prelude::*;

/// Evaluates every stretch of a level, then sorts all of them.
fn search_all(
    start: State,
    judge: &Judge<'_>,
    extent: &Extent,
    begins: impl Fn(Velocity) -> bool,
) -> (Vec<Velocity>, Tally) {
    let (mut tally, mut nodes) = (Tally::default(), vec![Node::first(start)]);
    let (mut level, mut arrived): (_, Vec<usize>) = (0..1, Vec::new());
    for stretch in 0..extent.stretches {
        let mut children = Vec::new();
        for parent in level.clone().filter(|&parent| !nodes[parent].arrives) {
            let Node { state: from, cost, .. } = nodes[parent];
            let is_near = stretch < Beam::NEAR;
            for to in Targets::of(&from, judge, extent.lowest_mps, is_near).velocities() {
                let Some((state, cost)) = judge.drive(&from, &cost, to) else { continue };
                let left_s = judge.time_to_go_s(&state);
                let drives = state.at.distance(start.at) > extent.elsewhere_m;
                tally.driving += u32::from(drives);
                tally.meets |= drives && cost.movers_s > Beam::MEETING_S;
                let total_s = rounded_s(state.after_s + cost.sum_s() + left_s);
                let arrives = judge.arrives(&state, left_s);
                let node = Node { state, cost, parent: parent as u32, total_s, arrives };
                children.push((node, drives));
            }
        }
        children.sort_by(|a, b| a.0.total_s.total_cmp(&b.0.total_s));
        let (first, mut bins) = (nodes.len(), Vec::new());
        for (child, drives) in children {
            let bin = bin(&start, &child.state, extent.bin_m);
            if bins.len() == extent.width || bins.contains(&bin) {
                continue;
            }
            let passes = stretch > 0 || begins(child.state.velocity);
            if passes && judge.can_stop(&child.state) {
                bins.push(bin);
                nodes.push(child);
            } else {
                tally.refused += 1;
                tally.driving -= u32::from(drives);
            }
        }
        if nodes.len() == first {
            break;
        }
        level = first..nodes.len();
        arrived.extend(level.clone().find(|&node| nodes[node].arrives));
    }
    arrived.push(level.start);
    let best = arrived.into_iter().min_by(|&a, &b| nodes[a].total_s.total_cmp(&nodes[b].total_s));
    let (mut course, mut index) = (Vec::new(), best.unwrap());
    while index != 0 {
        course.insert(0, nodes[index].state.velocity);
        index = nodes[index].parent as usize;
    }
    (course, tally)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn what_is_not_driven_is_not_missed(
        occupied in proptest::collection::vec((40..120, 40..120), 0..60),
        // If a wall around the start has this radius, nothing leads elsewhere.
        around_m in prop_oneof![Just(f64::INFINITY), 0.36..0.44],
        (x, y, theta) in (3.0..5.0, 3.0..5.0, -3.0..3.0_f64),
        (v, omega) in (prop_oneof![Just(0.0), -0.3..1.5_f64], -1.0..1.0_f64),
        walkers in proptest::collection::vec((2.0..6.0, 2.0..6.0, -1.0..1.0, -1.0..1.0), 0..3),
        width in prop_oneof![Just(1), Just(4), Just(24)],
        fastest_mps in prop_oneof![Just(f64::INFINITY), 0.0..1.0],
    ) {
        let frame = GridFrame::new(160, 160, 0.05, Pose::default()).unwrap();
        let state = |cell: Cell| {
            let off_m = frame.world_from_cell(cell).distance(Point::new(x, y));
            let is_wall = (around_m..around_m + 0.1).contains(&off_m);
            if is_wall || occupied.contains(&(cell.x, cell.y)) { CellState::Occupied } else { CellState::Free }
        };
        let map = OccupancyGrid::from_fn(frame, state);
        let field = DistanceField::new(&frame, map.occupied(), &FieldConfig::default());
        let robot = Robot::jackal();
        let planner = SpaceTime::new(SpaceTimeConfig::for_robot(&robot), robot).unwrap();
        let movers: Vec<Mover> = walkers
            .iter()
            .map(|&(x, y, vx, vy)| Mover {
                id: 0,
                centre: Point::new(x, y),
                velocity_mps: Point::new(vx, vy),
                radius_m: 0.25,
                age_s: 1.0,
                unseen_s: 0.0,
                position_uncertainty_m: 0.05,
                velocity_uncertainty_mps: 0.1,
            })
            .collect();
        let path = Polyline::new(vec![Point::new(x, y), Point::new(7.0, 7.0)]);
        let scene = Scene {
            obstacles: &field,
            sensed: &BitGrid::new(160, 160, false),
            seen: crate::sense::SeenCells::ANYWHERE,
            movers: &movers,
            walked: &[],
            pose: Pose::new(x, y, theta),
            velocity: Velocity::new(v, omega),
            guide: Point::new(7.0, 7.0),
            path: &path,
            goal_heading_rad: None,
            remaining_m: path.length_m(),
            jerk_limited: None,
        };
        let mut around = Around::default();
        let beyond_m = planner.look(&mut around, &scene, 0.0);
        let meeting = planner.meeting(&around);
        let (start, judge) = planner.judge(&scene, &around, (&meeting, None), beyond_m);
        let extent = Extent { width, ..planner.extent(&scene, &judge) };
        let begins = |velocity: Velocity| velocity.v <= fastest_mps;
        let mut beam = Beam::default();
        let tally = beam.search(start, &judge, &extent, begins);
        let (best, all) = search_all(start, &judge, &extent, begins);
        prop_assert_eq!(&beam.best, &best);
        prop_assert!(tally.driving == 0 || all.driving > 0);
        // Of nearly equal ones, only the first is evaluated once something drives: that one may
        // be refused.
        prop_assert!(tally.driving > 0 || all.driving == 0 || tally.refused > 0);
        prop_assert!(all.meets || !tally.meets);
        prop_assert!(tally.tried >= tally.touching + tally.refused + tally.driving);
    }
}
