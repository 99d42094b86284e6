//! Robots that hardly touch what is beside them, and what is ahead of them.

use super::tests::{Ground, gate, rule};
use super::*;
use crate::geometry::Point;
use crate::map::GridFrame;
use crate::robot::Footprint;

/// A map of 10 m x 8 m with walls 0.2 m thick below y = 0.2 m and from x = 5 m on.
fn corner() -> Ground {
    let is_wall = |i: usize| i / 100 < 2 || (50..52).contains(&(i % 100));
    let frame = GridFrame::new(100, 80, 0.1, Pose::default()).unwrap();
    Ground::new(&frame, &(0..8000).map(is_wall).collect::<Vec<_>>())
}

/// An obstacle nearer than rounding tells apart is touched: it does not open the way to anything
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
