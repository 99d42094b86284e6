//! A simulated robot in the world of a scene, in place of a real one: it publishes map, scans,
//! odometry, transforms and the clock, and executes `cmd_vel`. Nodes, viewers and programs can be
//! tried without a robot.

use crate::arguments::{Arguments, Network};
use crate::error::StartError;
use crate::messages::builtin_interfaces::Time;
use crate::messages::geometry_msgs::{
    Pose as PoseMessage, PoseWithCovariance, PoseWithCovarianceStamped, Transform,
    TransformStamped, Twist, TwistStamped, TwistWithCovariance,
};
use crate::messages::nav_msgs::{OccupancyGrid, Odometry};
use crate::messages::rosgraph_msgs::Clock;
use crate::messages::sensor_msgs::LaserScan;
use crate::messages::std_msgs::Header;
use crate::messages::tf2_msgs::TFMessage;
use crate::settings::SimulatorSettings;
use crate::wire::{Delivery, Inbox, Outbox, Wire};
use keyway::files::{find_robot, find_stack};
use keyway::geometry::{Pose, Velocity};
use keyway::map::formats::read_map;
use keyway::sense::SensorScan;
use keyway_sim::episode::Episode;
use keyway_sim::scene_files::{SceneError, SceneMap, read_scene};
use keyway_sim::sim::{Action, Control, Outcome, Stepper};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// A simulated robot on the network.
pub(crate) struct Simulator {
    wire: Wire,
    settings: SimulatorSettings,
    episode: Episode,
    run: Stepper,
    commands: Commands,
    map: Outbox<OccupancyGrid>,
    scans: Vec<Outbox<LaserScan>>,
    odometry: Outbox<Odometry>,
    transforms: Outbox<TFMessage>,
    fixed: Outbox<TFMessage>,
    clock: Outbox<Clock>,
    /// Answered with the actual pose of the robot.
    initial_pose: Inbox<PoseWithCovarianceStamped>,
    amcl_pose: Outbox<PoseWithCovarianceStamped>,
    /// Offset from the time of the run to that of the network \[s\].
    began_s: f64,
    /// Cycles since the start, over all runs.
    cycles: u64,
    /// The last command, and the cycle of its arrival.
    commanded: (Velocity, u64),
}

enum Commands {
    Plain(Inbox<Twist>),
    Stamped(Inbox<TwistStamped>),
}

impl Simulator {
    /// The base stops if no command has arrived for this time \[s\].
    const WATCHDOG_S: f64 = 0.5;

    /// Delay above which cycles are not made up for, as the process was halted.
    const HALT: Duration = Duration::from_millis(500);

    /// Joins the network, with the robot of a scene at its start.
    pub(crate) fn new(
        scene: &Path,
        arguments: &Arguments,
        network: Network,
        settings: SimulatorSettings,
    ) -> Result<Self, StartError> {
        let episode = episode(scene).map_err(StartError::Scene)?;
        let fault = |why| StartError::Scene(format!("{}: {why}", scene.display()));
        let run = stepper(&episode).map_err(fault)?;
        let mut wire = Wire::open(arguments, network, &[])?;
        let sensors = episode.robots[0].robot.sensors.len();
        let scan = |sensor| wire.outbox(&numbered("scan", sensor), Delivery::BestEffort, 4);
        let scans = (0..sensors).map(scan).collect::<Result<_, _>>()?;
        let commands = if settings.is_cmd_vel_stamped {
            Commands::Stamped(wire.inbox("cmd_vel", Delivery::Reliable, 1)?)
        } else {
            Commands::Plain(wire.inbox("cmd_vel", Delivery::Reliable, 1)?)
        };
        let mut simulator = Self {
            settings,
            commands,
            map: wire.outbox("map", Delivery::Latched, 1)?,
            scans,
            odometry: wire.outbox("odom", Delivery::Reliable, 4)?,
            transforms: wire.outbox("/tf", Delivery::Reliable, 100)?,
            fixed: wire.outbox("/tf_static", Delivery::Latched, 1)?,
            clock: wire.outbox("/clock", Delivery::Reliable, 1)?,
            initial_pose: wire.inbox("initialpose", Delivery::Reliable, 1)?,
            amcl_pose: wire.outbox("amcl_pose", Delivery::Latched, 1)?,
            wire,
            episode,
            run,
            began_s: 0.0,
            cycles: 0,
            commanded: (Velocity::ZERO, 0),
        };
        simulator.set_out();
        Ok(simulator)
    }

    /// Publishes the static messages.
    fn set_out(&mut self) {
        // The first cycle ends now.
        let cycle_s = self.episode.robots[0].robot.cycle_s;
        self.began_s = if self.settings.use_sim_time { 0.0 } else { machine_s() - cycle_s };
        let header = Header::new(self.began_s, "map");
        self.map.publish(OccupancyGrid::of(&self.episode.known, header));
        let mounts = self.episode.robots[0].robot.sensors.iter().map(|sensor| sensor.mount.pose());
        let mount = |(sensor, pose)| {
            transform(Header::new(self.began_s, "base_link"), &numbered("base_scan", sensor), pose)
        };
        let transforms = mounts.enumerate().map(mount).collect();
        self.fixed.publish(TFMessage { transforms });
    }

    /// Runs until it is stopped, cycle by cycle.
    pub(crate) fn run(&mut self, is_over: &Arc<AtomicBool>) -> Result<(), StartError> {
        let cycle_s = self.episode.robots[0].robot.cycle_s;
        let period = Duration::from_secs_f64(cycle_s / self.settings.rate);
        let mut next = Instant::now();
        while !is_over.load(Ordering::Relaxed) {
            self.wire.wait(next.saturating_duration_since(Instant::now()));
            self.receive();
            let now = Instant::now();
            if now >= next {
                let late = now - next;
                if late > Self::HALT {
                    // The world was halted meanwhile, unlike the system clock.
                    next = now;
                    if !self.settings.use_sim_time {
                        self.began_s += late.as_secs_f64();
                    }
                }
                next += period;
                self.cycle(cycle_s)?;
            }
        }
        Ok(())
    }

    fn receive(&mut self) {
        let twist = match &self.commands {
            Commands::Plain(inbox) => inbox.take_all().pop(),
            Commands::Stamped(inbox) => inbox.take_all().pop().map(|stamped| stamped.twist),
        };
        let command = twist.map(Velocity::from);
        if let Some(command) = command.filter(|it| it.v.is_finite() && it.omega.is_finite()) {
            self.commanded = (command, self.cycles);
        }
        for mut message in self.initial_pose.take_all() {
            message.pose.pose = self.run.told().pose.into();
            self.amcl_pose.publish(message);
        }
    }

    /// Runs one cycle of the world.
    fn cycle(&mut self, cycle_s: f64) -> Result<(), StartError> {
        let (command, since) = self.commanded;
        let silent_s = cycle_s * (self.cycles - since) as f64;
        let is_obeyed = silent_s <= Self::WATCHDOG_S;
        let action = if is_obeyed { Action::Drive(command) } else { Action::Stop };
        let control = Control { action, remaining_m: f64::NAN, turn_left_rad: 0.0, route: 0 };
        let fault = |why: String| StartError::Network { what: "simulate".to_owned(), why };
        let outcome = self.run.step(&control).map_err(|error| fault(error.to_string()))?;
        self.cycles += 1;
        if self.cycles.is_multiple_of((1.0 / cycle_s).ceil() as u64) {
            // Reports publishers of commands of another type, which are never received.
            self.wire.misfits();
        }
        if matches!(outcome, Some(Outcome::Collided { .. })) {
            self.wire.say("the robot had a contact; it is reset to its start");
            self.run = stepper(&self.episode).map_err(fault)?;
            // Time continues.
            self.began_s += cycle_s * self.cycles as f64 - self.run.told().stamp_s;
            self.cycles = 0;
            self.commanded = (Velocity::ZERO, 0);
        }
        self.tell();
        Ok(())
    }

    /// Publishes the measurements of the robot.
    fn tell(&self) {
        let told = self.run.told();
        let stamp_s = self.began_s + told.stamp_s;
        let now_s = self.began_s + self.run.state().stamp_s;
        self.clock.publish(Clock { clock: Time::of(now_s) });
        self.transforms.publish(TFMessage {
            transforms: vec![
                transform(Header::new(stamp_s, "map"), "odom", Pose::default()),
                transform(Header::new(stamp_s, "odom"), "base_link", told.pose),
            ],
        });
        self.odometry.publish(Odometry {
            header: Header::new(stamp_s, "odom"),
            child_frame_id: "base_link".to_owned(),
            pose: PoseWithCovariance { pose: told.pose.into(), ..PoseWithCovariance::default() },
            twist: TwistWithCovariance {
                twist: told.velocity.into(),
                ..TwistWithCovariance::default()
            },
        });
        for scan in self.run.scans() {
            self.scans[scan.sensor].publish(self.scan(&scan));
        }
    }

    fn scan(&self, scan: &SensorScan<'_>) -> LaserScan {
        let beams = scan.scan.ranges_m.len();
        let (first_rad, step_rad) = (scan.scan.angle_min_rad, scan.scan.angle_increment_rad);
        let last_rad = first_rad + step_rad * beams.saturating_sub(1) as f64;
        LaserScan {
            header: Header::new(self.began_s + scan.stamp_s, &numbered("base_scan", scan.sensor)),
            angle_min: first_rad as f32,
            angle_max: last_rad as f32,
            angle_increment: step_rad as f32,
            range_min: scan.scan.range_min_m as f32,
            range_max: scan.scan.range_max_m as f32,
            ranges: scan.scan.ranges_m.iter().map(|range_m| range_m as f32).collect(),
            ..LaserScan::default()
        }
    }
}

/// The world and the robot of a scene; its runs end only by a contact.
fn episode(path: &Path) -> Result<Episode, String> {
    const EVER_S: f64 = 1e9;
    let folder = path.parent().unwrap_or(Path::new(""));
    // Errors of files already name their file.
    let in_scene = |why: String| format!("{}: {why}", path.display());
    let scene = read_scene(path).map_err(|error| error.to_string())?;
    let map = match (scene.generated_map(), &scene.map) {
        (Some(map), _) => map.map_err(|error| in_scene(error.to_string()))?,
        (None, Some(map)) => {
            SceneMap::from(read_map(&folder.join(map), None).map_err(|error| error.to_string())?)
        }
        (None, None) => return Err(in_scene("the scene has no map".to_owned())),
    };
    let find = |robot: &str, stack: &str| {
        let robot = find_robot(robot, folder).map_err(|error| error.to_string())?;
        let stack = find_stack(stack, folder, &robot).map_err(|error| error.to_string())?;
        Ok::<_, Fault>((robot, stack))
    };
    let mut episode = scene.episode(map, find).map_err(|Fault(why)| in_scene(why))?;
    episode.rules.time_limit_s = Some(EVER_S);
    episode.rules.stuck_window_s = EVER_S;
    Ok(episode)
}

/// A fault of a scene, as text.
struct Fault(String);

impl From<String> for Fault {
    fn from(why: String) -> Self {
        Self(why)
    }
}

impl From<SceneError> for Fault {
    fn from(error: SceneError) -> Self {
        Self(error.to_string())
    }
}

/// The robot of a scene at its start.
fn stepper(episode: &Episode) -> Result<Stepper, String> {
    episode.stepper().map_err(|error| error.to_string())
}

/// The name with a number, except for the first lidar.
fn numbered(name: &str, sensor: usize) -> String {
    if sensor == 0 { name.to_owned() } else { format!("{name}_{sensor}") }
}

fn transform(header: Header, child: &str, pose: Pose) -> TransformStamped {
    let PoseMessage { position, orientation } = pose.into();
    let transform = Transform { translation: position, rotation: orientation };
    TransformStamped { header, child_frame_id: child.to_owned(), transform }
}

/// The system time \[s\].
fn machine_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scenes of the repository, with maps from files and from seeds.
    #[test]
    fn scenes_have_a_robot_at_their_start() {
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for name in ["keyway-cli/scenes/small_house.toml", "../scenes/complaints/pacing.toml"] {
            let mut run = stepper(&episode(&crates.join(name)).unwrap()).unwrap();
            let before = run.told().pose;
            let action = Action::Drive(Velocity::new(0.3, 0.0));
            let control = Control { action, remaining_m: f64::NAN, turn_left_rad: 0.0, route: 0 };
            for _ in 0..10 {
                assert_eq!(run.step(&control).unwrap(), None);
            }
            assert!(run.told().pose.point().distance(before.point()) > 0.1);
        }
    }

    #[test]
    fn what_is_wrong_with_a_scene_is_told() {
        let missing = episode(Path::new("/nowhere.toml")).unwrap_err();
        assert!(missing.contains("nowhere.toml"), "{missing}");
        let file = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
        let text = "version = 1\nmap = \"none.yaml\"\nstart = [1, 1]\ngoal = [2, 2]\n";
        std::fs::write(file.path(), text).unwrap();
        let without = episode(file.path()).unwrap_err();
        assert!(without.contains("none.yaml"), "{without}");
    }
}
