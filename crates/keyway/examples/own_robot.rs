//! Keyway in your own robot: a whole control loop. Replace `Hardware` with your drivers.
//!
//! ```sh
//! cargo run --release --example own_robot
//! cargo run --release --example own_robot -- house.yaml my_robot.toml -8,-2.8 8.7,0.9
//! ```

use keyway::files::read_robot;
use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::formats::read_map;
use keyway::map::{GridFrame, OccupancyGrid};
use keyway::navigate::{Navigator, Stack, Step};
use keyway::robot::Robot;
use keyway::sense::{Observation, Scan, SensorScan};
use std::collections::VecDeque;
use std::error::Error;
use std::mem::discriminant;
use std::path::Path;

/// A stand-in for your odometry, lidar, motors and clock: it obeys commands as the robot's file
/// says, and meets no obstacle.
struct Hardware {
    robot: Robot,
    now_s: f64,
    cycles: u64,
    is_held: bool,
    pose: Pose,
    velocity: Velocity,
    /// Commands with the times at which they take effect \[s\].
    commands: VecDeque<(f64, Velocity)>,
}

impl Hardware {
    /// Time now \[s\]. All stamps are by this clock, which must not be set while the robot drives.
    const fn now_s(&self) -> f64 {
        self.now_s
    }

    /// The newest pose in the frame of the map and the velocity, with the time at which they were
    /// measured.
    const fn odometry(&self) -> (f64, Pose, Velocity) {
        (self.now_s, self.pose, self.velocity)
    }

    /// The newest scan of the lidar with the time at which it was measured; `None` if none has come
    /// since the last call. Bearings are in radians, ranges in metres, infinity means no return.
    fn scan(&mut self) -> Option<(f64, Scan)> {
        let scan =
            Scan { ranges_m: vec![f64::INFINITY; 540], ..Scan::of_nothing(&self.robot.sensors[0]) };
        let step_rad = 270_f64.to_radians() / 539.0;
        let scan =
            Scan { angle_min_rad: -135_f64.to_radians(), angle_increment_rad: step_rad, ..scan };
        let is_new = self.cycles.is_multiple_of(2);
        is_new.then_some((self.now_s, scan))
    }

    /// True if a person or a bumper holds the motors.
    const fn is_held(&self) -> bool {
        self.is_held
    }

    /// Commands the motors, and waits for the end of the cycle.
    fn drive(&mut self, command: Velocity) {
        const STEPS: u32 = 20;
        self.cycles += 1;
        let Robot { limits, cycle_s, actuation_delay_s, .. } = &self.robot;
        self.commands.push_back((self.now_s + actuation_delay_s, command));
        let step_s = cycle_s / f64::from(STEPS);
        for _ in 0..STEPS {
            self.now_s += step_s;
            while self.commands.get(1).is_some_and(|&(from_s, _)| from_s < self.now_s) {
                self.commands.pop_front();
            }
            let acting = self.commands.front().filter(|&&(from_s, _)| from_s < self.now_s);
            let command = acting.map_or(Velocity::ZERO, |&(_, command)| command);
            let velocity = limits.reached(self.velocity, command, step_s);
            self.pose = self.pose.after_ramp(self.velocity, velocity, step_s);
            self.velocity = velocity;
        }
    }
}

/// A goal is given up after so long without a command that drives \[s\].
const PATIENCE_S: f64 = 30.0;

/// Drives to the present goal; true if the robot has arrived, false if it was given up.
fn drive(navigator: &mut Navigator, hardware: &mut Hardware, most_cycles: usize) -> bool {
    let (mut drove_s, mut told) = (hardware.now_s(), (None, Vec::new()));
    for _ in 0..most_cycles {
        // Of a cycle without a new scan, no scan is given. Data that is too old stops the robot.
        let new_scan = hardware.scan();
        let scans = new_scan.iter();
        let scans: Vec<SensorScan<'_>> = scans
            .map(|(stamp_s, scan)| SensorScan::of(&hardware.robot, 0, *stamp_s, scan))
            .collect();
        let (stamp_s, pose, velocity) = hardware.odometry();
        navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let step = navigator.step_at(hardware.now_s());
        // The numbers of a reason change in every cycle: only another kind is told.
        let doubts = navigator.doubts().iter().map(discriminant).collect();
        let kinds = (step.why().map(discriminant), doubts);
        if kinds != told {
            let why = step.why().map(ToString::to_string).unwrap_or_default();
            println!("{:.1} s: {} {why}", hardware.now_s(), step.name());
            navigator.doubts().iter().for_each(|doubt| println!("    {doubt}"));
            told = kinds;
        }
        if step == Step::Arrived {
            return true;
        }
        // A blocked robot may still drive, as far as is safe.
        if step.command() != Velocity::ZERO {
            drove_s = hardware.now_s();
        }
        if hardware.now_s() - drove_s > PATIENCE_S {
            navigator.cancel();
            return false;
        }
        if hardware.is_held() {
            navigator.note_override(hardware.now_s(), Velocity::ZERO);
            hardware.drive(Velocity::ZERO);
        } else {
            hardware.drive(step.command());
        }
    }
    false
}

fn point(text: &str) -> Result<Point, Box<dyn Error>> {
    let (x, y) = text.split_once(',').ok_or("a position is x,y in metres")?;
    Ok(Point::new(x.parse()?, y.parse()?))
}

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (map, robot, start, goal) = if let [map, robot, start, goal] = &arguments[..] {
        let (map, robot) = (read_map(Path::new(map), None)?.grid, read_robot(Path::new(robot))?);
        (map, robot, point(start)?, point(goal)?)
    } else {
        let map = OccupancyGrid::all_free(GridFrame::new(120, 70, 0.1, Pose::default())?);
        (map, Robot::small(), Point::new(2.5, 3.5), Point::new(9.5, 3.5))
    };
    let mut navigator = Navigator::new(&map, &Stack::keyway(&robot).fit(&robot)?)?;
    let pose = Pose::new(start.x, start.y, 0.0);
    let (velocity, commands) = (Velocity::ZERO, VecDeque::new());
    let mut hardware =
        Hardware { robot, now_s: 1.7e9, cycles: 0, is_held: false, pose, velocity, commands };
    navigator.relocate(pose);
    // A goal in an obstacle, or without a path, is an error that says why and what to do.
    navigator.set_goal(goal)?;
    drive(&mut navigator, &mut hardware, 30);
    // After 30 cycles, the robot is to come back, slowly.
    // A goal that is refused leaves the old one: this robot stops instead.
    if let Err(error) = navigator.set_goal(start) {
        hardware.drive(Velocity::ZERO);
        return Err(error.into());
    }
    navigator.set_speed_limit(Some(0.4))?;
    let has_arrived = drive(&mut navigator, &mut hardware, 10_000);
    println!("{} at {:?}", if has_arrived { "arrived" } else { "given up" }, hardware.pose.point());
    navigator.spin(3.0, 30.0)?;
    drive(&mut navigator, &mut hardware, 1000);
    println!("turned to {:.2} rad", hardware.pose.theta);
    Ok(())
}
