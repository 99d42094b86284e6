//! Robots that barely touch obstacles beside them and ahead of them.

use super::tests::{Ground, commands, every_cycle, gate, instants, robots, rule};
use super::*;
use crate::geometry::Point;
use crate::map::{CellState, FieldConfig, GridFrame, OccupancyGrid};
use crate::robot::Footprint;
use crate::sense::test_scan::scan_among;
use crate::sense::{ProjectedScan, SensedLayer};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A map of 10 m x 8 m with walls 0.2 m thick below y = 0.2 m and from x = 5 m on.
fn corner() -> Ground {
    let is_wall = |i: usize| i / 100 < 2 || (50..52).contains(&(i % 100));
    let frame = GridFrame::new(100, 80, 0.1, Pose::default()).unwrap();
    Ground::new(&frame, &(0..8000).map(is_wall).collect::<Vec<_>>())
}

/// An obstacle within rounding distance is touched: it does not permit contact with anything
/// else.
#[test]
fn what_is_beside_a_robot_by_less_than_rounding_opens_no_way_ahead() {
    let ground = corner();
    let point = Robot { limits: Robot::small().limits, ..Robot::paper() };
    let offset = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]];
    let vertices = offset.map(Point::from).to_vec();
    let plate = Robot { footprint: Footprint::polygon(vertices).unwrap(), ..Robot::small() };
    for (robot, ahead_m, aside_m) in [(point, 0.0, 0.0), (plate, 0.3, 0.2)] {
        let rule = rule(&robot);
        for room_m in [0.0, 1e-16, 1e-12, 5e-10, 1e-9, 2e-9, 1e-6] {
            // 0.02 m before the wall, from which it stops within 0.3 m.
            let pose = Pose::new(5.0 - 0.02 - ahead_m, 0.2 + aside_m + room_m, 0.0);
            let ahead = Velocity::new(0.5, 0.0);
            let gated = gate(&rule, &ground.around(pose, ahead, &[]), ahead);
            assert!(gated.changed(), "{:?} {room_m}", robot.footprint);
            assert_eq!(gated.command, robot.limits.braked(ahead, robot.cycle_s));
        }
    }
}

/// A robot among discs that it senses only by its lidar, cell by cell.
struct AmongDiscs {
    robot: Robot,
    discs: Vec<(Point, f64)>,
    map: OccupancyGrid,
    layer: SensedLayer,
}

impl AmongDiscs {
    fn new(robot: Robot, discs: &[(f64, f64, f64)]) -> Self {
        let frame = GridFrame::new(26, 26, 0.1, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |_| CellState::Free);
        let layer = SensedLayer::new(&frame);
        let discs = discs.iter().map(|&(x, y, radius_m)| (Point::new(x, y), radius_m)).collect();
        Self { robot, discs, map, layer }
    }

    /// Distance to the nearest disc \[m\].
    fn room_m(&self, pose: Pose) -> f64 {
        let (core, radius_m) = self.robot.footprint.core();
        let gap_m = |&(centre, disc_m): &(Point, f64)| core.distance_to_m(pose, centre) - disc_m;
        self.discs.iter().map(gap_m).fold(f64::INFINITY, f64::min) - radius_m
    }

    /// Adds a disc in a direction, a gap away from a robot.
    fn add_beside(&mut self, pose: Pose, &(bearing_rad, gap_m, radius_m): &(f64, f64, f64)) {
        let (core, robot_m) = self.robot.footprint.core();
        let (sin, cos) = libm::sincos(bearing_rad);
        let at = |away_m: f64| pose.point() + Point::new(cos, sin) * away_m;
        let (mut near_m, mut far_m) = (0.0, 1.0);
        for _ in 0..30 {
            let middle_m = 0.5 * (near_m + far_m);
            let is_near = core.distance_to_m(pose, at(middle_m)) - robot_m < gap_m + radius_m;
            *(if is_near { &mut near_m } else { &mut far_m }) = middle_m;
        }
        self.discs.push((at(far_m), radius_m));
    }

    /// A cycle of the stop rule after a scan.
    fn gate(&mut self, pose: Pose, velocity: Velocity, command: Velocity) -> Gated {
        let frame = *self.map.frame();
        let scan = scan_among((&frame, &[]), &self.discs, pose, &self.robot.sensors[0]);
        let scan = ProjectedScan::new(&frame, &self.robot.footprint, pose, &scan);
        self.layer.update(&self.map, &scan, None, &mut Vec::new());
        let field = DistanceField::new(&frame, self.layer.sensed(), &FieldConfig::default());
        let seen = SeenCells { scans: std::slice::from_ref(&scan), ..SeenCells::ANYWHERE };
        let around = Surroundings {
            obstacles: &field,
            seen,
            movers: &[],
            delay_s: 0.0,
            pose,
            velocity,
            jerk_limited: None,
        };
        gate(&rule(&self.robot), &around, command)
    }

    /// The least clearance while a planner requests these commands, until the first contact: from
    /// then on hits inside the footprint would be taken for a part of the robot.
    fn drive(&mut self, mut pose: Pose, commands: &[Velocity]) -> f64 {
        let mut velocity = Velocity::ZERO;
        let mut least_m = self.room_m(pose);
        for &command in commands {
            let gated = self.gate(pose, velocity, command);
            let Robot { limits, cycle_s, .. } = &self.robot;
            let next = limits.reached(velocity, gated.command, *cycle_s);
            for (on_way, ..) in instants(&self.robot, pose, velocity, next) {
                least_m = least_m.min(self.room_m(on_way));
            }
            if least_m < 0.0 {
                break;
            }
            (pose, velocity) = (pose.after_ramp(velocity, next, *cycle_s), next);
        }
        least_m
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// A robot that covers a part of an obstacle's squares may go on, and still overlaps the
    /// obstacle by no more than the distance of two beams there.
    #[test]
    fn what_squares_hide_is_not_touched(
        robot in robots(), (x, y, theta) in (1.2..1.3f64, 1.2..1.3f64, -3.1..3.1f64), commands in commands(),
        beside in prop::collection::vec((-3.1..3.1f64, 0.001..0.03f64, 0.03..0.2f64), 1..3),
        discs in prop::collection::vec((0.2..2.4f64, 0.2..2.4f64, 0.03..0.2f64), 0..6),
    ) {
        // Its sensor covers all directions, from within the footprint.
        prop_assume!(robot.footprint.covers(Point::default()) || robot.footprint.inscribed_radius_m() > 0.0);
        let robot = Robot { sensors: Robot::small().sensors, ..robot };
        let mut among = AmongDiscs::new(robot, &discs);
        let pose = Pose::new(x, y, theta);
        for disc in &beside {
            among.add_beside(pose, disc);
        }
        prop_assume!(among.room_m(pose) >= 0.5e-3);
        let commands = every_cycle(&among.robot, &commands);
        let least_m = among.drive(pose, &commands);
        let Robot { footprint, sensors, .. } = &among.robot;
        let apart_m = footprint.circumscribed_radius_m() * TAU / f64::from(sensors[0].beams);
        prop_assert!(least_m > -apart_m, "{least_m}");
    }
}
