//! Keyway in your own robot: no simulator, no files. Replace `Hardware` with your drivers.

use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::{Cell, CellState, Edit, GridFrame, OccupancyGrid};
use keyway::navigate::{Navigator, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::{Observation, Scan, SensorScan};

/// A stand-in for your odometry, lidar and motors: it obeys commands at once and meets no
/// obstacle.
struct Hardware {
    pose: Pose,
    velocity: Velocity,
    stamp_s: f64,
}

/// One control cycle; true once the robot has arrived.
fn cycle(navigator: &mut Navigator, robot: &Robot, hardware: &mut Hardware) -> bool {
    let Hardware { pose, velocity, stamp_s } = *hardware;
    let scan = Scan::of_nothing(&robot.sensors[0]);
    let scans = [SensorScan::of(robot, 0, stamp_s, &scan)];
    navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
    let step = navigator.step();
    if let Step::Blocked { why, .. } = &step {
        println!("{stamp_s:.1} s: {why}");
    }
    hardware.velocity = step.command();
    hardware.pose = pose.after_arc(hardware.velocity, robot.cycle_s);
    hardware.stamp_s += robot.cycle_s;
    step == Step::Arrived
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let map = OccupancyGrid::all_free(GridFrame::new(120, 70, 0.1, Pose::default())?);
    let robot = Robot::small();
    let mut navigator = Navigator::new(&map, &Stack::keyway(&robot).fit(&robot)?)?;
    let pose = Pose::new(2.5, 3.5, 0.0);
    let mut hardware = Hardware { pose, velocity: Velocity::ZERO, stamp_s: 0.0 };
    navigator.relocate(pose);
    navigator.set_goal(Point::new(9.5, 3.5))?;
    for _ in 0..50 {
        cycle(&mut navigator, &robot, &mut hardware);
    }
    // A wall appears on the map; then the robot gets another goal, and has to drive slowly.
    let occupied = |y| Edit { cell: Cell::new(70, y), state: CellState::Occupied };
    let wall: Vec<Edit> = (20..60).map(occupied).collect();
    navigator.edit_map(&wall);
    for _ in 0..30 {
        cycle(&mut navigator, &robot, &mut hardware);
    }
    navigator.set_goals(&[Point::new(5.5, 1.0)], Point::new(1.5, 5.5))?;
    navigator.set_speed_limit(Some(0.4))?;
    while !cycle(&mut navigator, &robot, &mut hardware) {}
    println!("arrived after {:.1} s at {:?}", hardware.stamp_s, hardware.pose.point());
    navigator.spin(3.0, 30.0)?;
    while !cycle(&mut navigator, &robot, &mut hardware) {}
    println!("turned to {:.2} rad", hardware.pose.theta);
    Ok(())
}
