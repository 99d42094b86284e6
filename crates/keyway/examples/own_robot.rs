//! Keyway in your own robot: no simulator, no files. Replace `Hardware` with your drivers.
//!
//! `cargo run --example own_robot`

use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway::navigate::{Controller, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::Scan;

/// A hall of 12 m x 7 m with a wall in the middle, in cells of 1 m.
const HALL: [&str; 7] = [
    "############",
    "#..........#",
    "#....##....#",
    "#....##....#",
    "#....##....#",
    "#..........#",
    "############",
];

/// Stands for your drivers: odometry, lidar, motors.
struct Hardware {
    pose: Pose,
    velocity: Velocity,
    /// A post of 0.2 m radius that is on no map.
    post: Point,
}

impl Hardware {
    const BEAMS: usize = 360;

    /// The lidar sees only the post here; a real one sees the walls, too.
    fn scan(&self, range_max_m: f64) -> Scan {
        let increment = std::f64::consts::TAU / Self::BEAMS as f64;
        let beam = |i: usize| {
            let angle = self.pose.theta - std::f64::consts::PI + increment * i as f64;
            let towards = Point::new(angle.cos(), angle.sin());
            let to_post = self.post - self.pose.point();
            let along = to_post.dot(towards);
            let beside = to_post.cross(towards).abs();
            if along > 0.0 && beside < 0.2 {
                along - (0.04 - beside * beside).sqrt()
            } else {
                f64::INFINITY
            }
        };
        Scan {
            angle_min_rad: -std::f64::consts::PI,
            angle_increment_rad: increment,
            range_min_m: 0.1,
            range_max_m,
            ranges_m: (0..Self::BEAMS).map(beam).collect(),
        }
    }

    /// The motors follow the command at once here.
    fn drive(&mut self, command: Velocity, cycle_s: f64) {
        self.velocity = command;
        self.pose = self.pose.after_arc(command, cycle_s);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let map = OccupancyGrid::from_ascii(&HALL);
    let robot = Robot::small();
    let stack = Stack::keyway(&robot).fit(&robot)?;
    let (start, goal) = (Point::new(2.5, 3.5), Point::new(9.5, 3.5));
    let mut controller = Controller::new(&map, &stack, start, goal)?;
    println!("route of {:.2} m", controller.route().smoothed.length_m());

    let mut hardware = Hardware {
        pose: Pose::new(start.x, start.y, 0.0),
        velocity: Velocity::ZERO,
        post: Point::new(5.5, 1.2),
    };
    for cycle in 0..1000 {
        let scan = hardware.scan(robot.sensor.range_m);
        match controller.step(hardware.pose, hardware.velocity, &scan) {
            Step::Drive(command) => hardware.drive(command, robot.cycle_s),
            Step::Blocked { command, why } => {
                println!("blocked: {why:?}");
                hardware.drive(command, robot.cycle_s);
            }
            Step::Arrived => {
                println!("arrived after {:.1} s", cycle as f64 * robot.cycle_s);
                return Ok(());
            }
        }
    }
    Err("did not arrive".into())
}
