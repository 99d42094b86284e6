//! Parameters of the node, from files and the command line as in ROS: converted to a robot, a
//! stack, and names of frames and topics.

mod declared;
mod file;
mod nav2;
mod simulator;

pub(crate) use declared::Change;
pub(crate) use simulator::SimulatorSettings;

use crate::arguments::Arguments;
use crate::error::StartError;
use crate::served::Distribution;
use keyway::Robot;
use keyway::files::{find_robot, find_stack};
use keyway::navigate::FittedStack;
use keyway::sense::SensorPoints;
use nav2::Nav2;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use toml::Value;

/// All settings at the start of the node.
#[derive(Clone)]
pub(crate) struct Settings {
    pub(crate) stack: Arc<FittedStack>,
    /// As requested; empty if the robot is described by a Nav2 file.
    robot_name: String,
    stack_name: String,
    pub(crate) frames: Frames,
    /// Topics of the lidars, in the order of the robot's sensors.
    pub(crate) scan_topics: Vec<String>,
    /// Topics of point clouds.
    pub(crate) cloud_topics: Vec<String>,
    pub(crate) points_taken: PointsTaken,
    /// Topics of filter metadata (masks).
    pub(crate) filter_info_topics: Vec<String>,
    pub(crate) odom_topic: String,
    pub(crate) distribution: Distribution,
    /// Names of Nav2 nodes for which this one answers lifecycle queries.
    pub(crate) stands_for: Vec<String>,
    /// True if commands are stamped.
    pub(crate) is_cmd_vel_stamped: bool,
    /// True if the clock is that of a simulation.
    pub(crate) use_sim_time: bool,
    /// Maximum age of a pose for computing a command \[s\].
    pub(crate) max_pose_age_s: f64,
}

/// Names of frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Frames {
    /// Frame of the map and the goals.
    pub(crate) map: String,
    /// Frame of the robot.
    pub(crate) base: String,
}

/// Selection of obstacle points in clouds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PointsTaken {
    /// Heights above the ground \[m\].
    pub(crate) heights_m: RangeInclusive<f64>,
    /// Maximum distance from the sensor \[m\].
    pub(crate) range_m: f64,
    /// The robot stops if a sensor is silent for longer than this \[s\]; 0: never.
    pub(crate) timeout_s: f64,
}

/// The distribution, from the parameter or `ROS_DISTRO`.
fn distribution_of(given: &mut Given, distro: Option<&str>) -> Result<Distribution, StartError> {
    match given.text("distribution")?.as_deref().or(distro) {
        Some("jazzy") => Ok(Distribution::Jazzy),
        Some("kilted") | None => Ok(Distribution::Kilted),
        Some(other) => {
            let why = format!("must be jazzy or kilted, got {other} (or ROS_DISTRO says so)");
            Err(wrong("distribution", why))
        }
    }
}

/// Given parameters, by name.
type Parameters = BTreeMap<String, Value>;

/// Parameters and their descriptions; defaults are set in [`Settings::of`].
const PARAMETERS: [(&str, &str); 19] = [
    (
        "robot",
        "name of a bundled robot, or a robot file (TOML); required without a Nav2 parameter file",
    ),
    ("stack", "name of a stack, or a stack file (TOML); `keyway`"),
    ("safe", "only commands after which the robot stands before anybody can run into it; false"),
    ("use_sim_time", "take the time from /clock; false"),
    ("controller_frequency", "commands per second; that of the robot's cycle"),
    ("global_frame", "frame of the map; map"),
    ("robot_base_frame", "frame of the robot; base_link"),
    ("scan_topics", "topics of the lidars, in the order of the robot's sensors; [scan]"),
    ("cloud_topics", "topics of other sensors, as PointCloud2; []"),
    ("min_obstacle_height", "cloud points below this height are ground [m]; 0.05"),
    ("max_obstacle_height", "cloud points above this height are overhead [m]; 2.0"),
    ("obstacle_max_range", "cloud points beyond this range are ignored [m]; 2.5"),
    (
        "cloud_timeout",
        "the robot stops if a cloud topic is silent for longer [s]; 1.0 (0: no limit)",
    ),
    (
        "filter_info_topics",
        "topics of Nav2's costmap filters; costmap_filter_info, also with a prefix",
    ),
    ("odom_topic", "topic of the odometry; odom"),
    ("distribution", "ROS distribution of the messages: jazzy or kilted; ROS_DISTRO, or kilted"),
    ("enable_stamped_cmd_vel", "commands as TwistStamped; true, except for jazzy"),
    ("stands_for", "Nav2 nodes that this node replaces, such as map_server; [bt_navigator]"),
    ("max_pose_age", "maximum age of the pose for computing commands [s]; 0.2"),
];

/// The parameters of the node and of the simulator, one per line, for the help.
pub(crate) fn help() -> [String; 2] {
    [&PARAMETERS[..], &simulator::PARAMETERS].map(|parameters| {
        let line = |(name, what): &(&str, &str)| format!("  {name:24}{what}");
        parameters.iter().map(line).collect::<Vec<_>>().join("\n")
    })
}

impl Settings {
    /// Derives the settings from the arguments and `ROS_DISTRO`.
    pub(crate) fn of(arguments: &Arguments, distro: Option<&str>) -> Result<Self, StartError> {
        let mut given = Given::read(arguments)?;
        let distribution = distribution_of(&mut given, distro)?;
        let unusable =
            |parameter, error: &dyn std::error::Error| wrong(parameter, error.to_string());
        let folder = Path::new("");
        let robot_name = given.text("robot")?;
        let mut robot = match &robot_name {
            Some(name) => {
                given.nav2.forget_robot();
                find_robot(name, folder).map_err(|error| unusable("robot", &error))?
            }
            None => given.nav2_robot()?,
        };
        if let Some(frequency_hz) = given.positive("controller_frequency")? {
            robot.cycle_s = 1.0 / frequency_hz;
        }
        let stack_name = given.text("stack")?.unwrap_or_else(|| "keyway".to_owned());
        let mut stack =
            find_stack(&stack_name, folder, &robot).map_err(|error| unusable("stack", &error))?;
        stack = stack.safe_if(given.truth("safe")?.unwrap_or(false), &robot);
        let controller = &mut stack.controller;
        if let Some(tolerance_m) = given.nav2.goal_tolerance_m {
            controller.goal_tolerance_m = tolerance_m;
        }
        if let Some(tolerance_rad) = given.nav2.goal_yaw_tolerance_rad {
            controller.goal_yaw_tolerance_rad = tolerance_rad;
        }
        let stack = stack.fit(&robot).map_err(|error| unusable("robot", &error))?;
        let scan_topics = given.texts("scan_topics")?.unwrap_or_else(|| vec!["scan".to_owned()]);
        let sensors = stack.robot().sensors.len();
        if scan_topics.len() != sensors {
            let topics = scan_topics.len();
            let why = format!("has {topics} topics, but the robot has {sensors} lidars");
            return Err(wrong("scan_topics", why));
        }
        let cloud_topics = given.texts("cloud_topics")?.unwrap_or_default();
        if let Some(topic) = cloud_topics.iter().find(|topic| scan_topics.contains(topic)) {
            let why = format!(
                "has `{topic}`, which is also in scan_topics: a topic has only one type of message"
            );
            return Err(wrong("cloud_topics", why));
        }
        if cloud_topics.len() > SensorPoints::MOST_SENSORS {
            let why = format!("has more topics than {}", SensorPoints::MOST_SENSORS);
            return Err(wrong("cloud_topics", why));
        }
        let text =
            |value: Option<String>, default: &str| value.unwrap_or_else(|| default.to_owned());
        let settings = Self {
            stack: Arc::new(stack),
            robot_name: robot_name.unwrap_or_default(),
            stack_name,
            frames: Frames {
                map: text(given.text("global_frame")?, "map"),
                base: text(given.text("robot_base_frame")?, "base_link"),
            },
            scan_topics,
            cloud_topics,
            points_taken: given.points_taken()?,
            filter_info_topics: given.texts("filter_info_topics")?.unwrap_or_else(|| {
                ["", "keepout_", "speed_"].map(|kind| format!("{kind}costmap_filter_info")).to_vec()
            }),
            distribution,
            stands_for: given
                .texts("stands_for")?
                .unwrap_or_else(|| vec!["bt_navigator".to_owned()]),
            odom_topic: text(given.text("odom_topic")?, "odom"),
            is_cmd_vel_stamped: given
                .truth("enable_stamped_cmd_vel")?
                .unwrap_or(distribution == Distribution::Kilted),
            use_sim_time: given.truth("use_sim_time")?.unwrap_or(false),
            max_pose_age_s: given
                .take("max_pose_age", MAX_POSE_AGE, |value| number(value).filter(is_pose_age))?
                .unwrap_or(0.2),
        };
        for line in given.nav2.report() {
            crate::say(line);
        }
        given.all_known(&PARAMETERS)?;
        Ok(settings)
    }
}

/// Given parameters that are not processed yet.
struct Given {
    own: Parameters,
    /// Names given only to all nodes (`/**`): they may be for other nodes.
    of_all: BTreeSet<String>,
    nav2: Nav2,
}

impl Given {
    /// Reads all files in order, then the command line; the last value has priority.
    fn read(arguments: &Arguments) -> Result<Self, StartError> {
        let (mut given, mut nav2) = (Parameters::new(), Nav2::default());
        let mut of_all = BTreeSet::new();
        for path in &arguments.parameter_files {
            let fault = |why: String| StartError::File { path: path.clone(), why };
            let nodes = file::read(path).map_err(fault)?;
            // Parameters given to this node have priority over those of Nav2 nodes, whatever
            // their order.
            let of_file = Nav2::of(&nodes, arguments.namespace());
            if !of_file.is_empty() {
                nav2 = of_file;
            }
            for (name, parameters) in file::nodes(&nodes) {
                if name == ALL {
                    of_all.extend(parameters.keys().cloned());
                } else if !is_for(&name, arguments) {
                    continue;
                } else {
                    of_all.retain(|name| !parameters.contains_key(name));
                }
                given.extend(parameters.clone());
            }
        }
        for (name, text) in &arguments.parameters {
            let value = serde_saphyr::from_str(text)
                .map_err(|error| wrong(name, format!("`{text}` is not YAML: {error}")))?;
            of_all.remove(name);
            given.insert(name.clone(), value);
        }
        let mut own = nav2.own.clone();
        own.extend(given);
        Ok(Self { own, of_all, nav2 })
    }

    /// Selection of obstacle points in clouds.
    fn points_taken(&mut self) -> Result<PointsTaken, StartError> {
        let lowest_m = self.number("min_obstacle_height")?.unwrap_or(0.05);
        let highest_m = self.number("max_obstacle_height")?.unwrap_or(2.0);
        if lowest_m > highest_m {
            let why = format!("must not be above max_obstacle_height, {highest_m}, got {lowest_m}");
            return Err(wrong("min_obstacle_height", why));
        }
        let range_m = self.positive("obstacle_max_range")?.unwrap_or(2.5);
        let no_less = |value: &Value| number(value).filter(|&timeout_s| timeout_s >= 0.0);
        let timeout_s = self.take("cloud_timeout", "0 or a positive number", no_less)?;
        let timeout_s = timeout_s.unwrap_or(1.0);
        Ok(PointsTaken { heights_m: lowest_m..=highest_m, range_m, timeout_s })
    }

    /// The robot described by Nav2 files.
    fn nav2_robot(&mut self) -> Result<Robot, StartError> {
        let names = Robot::NAMES.join(", ");
        if self.nav2.is_empty() {
            return Err(wrong(
                "robot",
                format!("is required: {names}, a robot file, or a Nav2 parameter file"),
            ));
        }
        if let Some(why) = self.nav2.fault.take() {
            return Err(wrong(
                "robot",
                format!("is not given, and Nav2's parameters are invalid: {why}"),
            ));
        }
        let described = std::mem::take(&mut self.nav2.robot).robot();
        let mut robot = described.map_err(|error| {
            let why = format!(
                "is not given, and Nav2's parameters do not describe it completely: {error}"
            );
            wrong("robot", why)
        })?;
        // The file contains only the topics of the lidars.
        let lidar = robot.sensors[0].clone();
        let scans = self.own.get("scan_topics").and_then(Value::as_array).map_or(1, Vec::len);
        robot.sensors = vec![lidar; scans.clamp(1, Robot::MOST_SENSORS)];
        Ok(robot)
    }

    /// Takes and converts a parameter.
    fn take<T>(
        &mut self,
        name: &str,
        expected: &str,
        convert: impl FnOnce(&Value) -> Option<T>,
    ) -> Result<Option<T>, StartError> {
        let Some(value) = self.own.remove(name) else { return Ok(None) };
        let converted = convert(&value);
        let why = || wrong(name, format!("must be {expected}, got {value}"));
        converted.ok_or_else(why).map(Some)
    }

    fn text(&mut self, name: &str) -> Result<Option<String>, StartError> {
        self.take(name, "a string", |value| Some(value.as_str()?.to_owned()))
    }

    fn texts(&mut self, name: &str) -> Result<Option<Vec<String>>, StartError> {
        self.take(name, "a list of strings", |value| {
            let text = |value: &Value| Some(value.as_str()?.to_owned());
            value.as_array()?.iter().map(text).collect()
        })
    }

    fn truth(&mut self, name: &str) -> Result<Option<bool>, StartError> {
        self.take(name, "true or false", Value::as_bool)
    }

    fn positive(&mut self, name: &str) -> Result<Option<f64>, StartError> {
        self.take(name, "a positive number", |value| number(value).filter(|&number| number > 0.0))
    }

    fn number(&mut self, name: &str) -> Result<Option<f64>, StartError> {
        self.take(name, "a number", number)
    }

    /// Refuses the remaining parameters, unless they may be for other nodes.
    fn all_known(self, known: &[(&str, &str)]) -> Result<(), StartError> {
        let known = known.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        for name in self.own.keys() {
            if !self.of_all.contains(name) {
                return Err(wrong(
                    name,
                    format!("is not a parameter of this node; expected one of {known}"),
                ));
            }
            crate::say(format_args!(
                "parameter `{name}`, given to all nodes (`{ALL}`), is not a parameter of this node"
            ));
        }
        Ok(())
    }
}

/// Range of the maximum pose age; older poses are useless.
const MAX_POSE_AGE: &str = "a positive number, at most 5";

fn is_pose_age(age_s: &f64) -> bool {
    *age_s > 0.0 && *age_s <= 5.0
}

/// A finite number.
fn number(value: &Value) -> Option<f64> {
    let whole = value.as_integer().map(|whole| whole as f64);
    whole.or(value.as_float()).filter(|number| number.is_finite())
}

/// The name for parameters of all nodes in a file.
const ALL: &str = "/**";

/// True if a name in a file refers to this node alone: its name, with or without its namespace.
fn is_for(name: &str, arguments: &Arguments) -> bool {
    let node = arguments.node_name();
    let full = crate::arguments::full_name(node, arguments.namespace());
    let any_namespace = format!("/**/{node}");
    [node, &full, &full[1..], &any_namespace].contains(&name)
}

fn wrong(name: &str, why: impl Into<String>) -> StartError {
    StartError::Parameter { name: name.to_owned(), why: why.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(parameters: &[(&str, &str)]) -> Result<Settings, StartError> {
        let parameters =
            parameters.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
        let arguments = Arguments { parameters: parameters.collect(), ..Arguments::default() };
        Settings::of(&arguments, None)
    }

    #[test]
    fn a_robot_is_enough() {
        let settings = settings(&[("robot", "jackal")]).unwrap();
        assert_eq!(settings.frames, Frames { map: "map".to_owned(), base: "base_link".to_owned() });
        assert_eq!((settings.odom_topic.as_str(), settings.max_pose_age_s), ("odom", 0.2));
        assert!(settings.is_cmd_vel_stamped && !settings.use_sim_time);
    }

    #[test]
    fn what_is_given_counts() {
        let settings = settings(&[
            ("robot", "waffle"),
            ("controller_frequency", "10"),
            ("scan_topics", "[front]"),
            ("use_sim_time", "true"),
            ("max_pose_age", "0.5"),
        ])
        .unwrap();
        assert_eq!((settings.stack.robot().cycle_s, settings.max_pose_age_s), (0.1, 0.5));
        assert!(settings.use_sim_time && settings.scan_topics == ["front"]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (parameters, said) in [
            (vec![], "robot"),
            (vec![("robot", "jackl")], "jackl"),
            (vec![("robot", "jackal"), ("speed", "1")], "`speed`: is not a parameter of this node"),
            (
                vec![("robot", "jackal"), ("max_pose_age", "-1")],
                "a positive number, at most 5, got -1",
            ),
            (vec![("robot", "jackal"), ("max_pose_age", "1e300")], "at most 5"),
            (vec![("robot", "jackal"), ("cloud_timeout", "-1")], "0 or a positive number"),
            (vec![("robot", "jackal"), ("use_sim_time", "perhaps")], "true or false"),
            (vec![("robot", "jackal"), ("scan_topics", "[a, b]")], "2 topics"),
            (vec![("robot", "jackal"), ("cloud_topics", "[scan]")], "has `scan`, which is also in"),
            (vec![("robot", "jackal"), ("min_obstacle_height", "3")], "above max_obstacle_height"),
            (vec![("robot", "[")], "YAML"),
            (vec![("robot", "jackal"), ("distribution", "foxy")], "jazzy or kilted, got foxy"),
        ] {
            let message = settings(&parameters).err().unwrap().to_string();
            assert!(message.contains(said), "{message}");
        }
    }

    #[test]
    fn a_file_of_nav2_is_enough() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let text = "controller_server:\n  ros__parameters:\n    controller_frequency: 10.0\n    \
                    FollowPath:\n      max_vel_x: 0.3\n";
        let with_size = format!(
            "{text}local_costmap:\n  local_costmap:\n    ros__parameters:\n      robot_radius: 0.2\n"
        );
        let read = |text: &str, parameters: &[(&str, &str)]| {
            std::fs::write(file.path(), text).unwrap();
            let parameters = parameters.iter().map(|&(name, value)| (name.into(), value.into()));
            let parameter_files = vec![file.path().to_owned()];
            let parameters = parameters.collect();
            let arguments = Arguments { parameters, parameter_files, ..Arguments::default() };
            Settings::of(&arguments, None)
        };
        let settings = read(&with_size, &[]).unwrap();
        let robot = settings.stack.robot();
        assert_eq!((robot.limits.v_max_mps, robot.cycle_s), (0.3, 0.1));
        // Parameters given to this node have priority.
        let given = [("robot", "jackal"), ("controller_frequency", "20")];
        let settings = read(&with_size, &given).unwrap();
        let robot = settings.stack.robot();
        assert_eq!((robot.limits.v_max_mps, robot.cycle_s), (2.0, 0.05));
        let message = read(text, &[]).err().unwrap().to_string();
        assert!(message.contains("do not describe it completely"), "{message}");
    }

    #[test]
    fn files_are_for_nodes() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let text = "/**:\n  ros__parameters:\n    robot: jackal\nkeyway:\n  ros__parameters:\n    odom_topic: odometry\n\
                    other:\n  ros__parameters:\n    odom_topic: wrong\n";
        std::fs::write(file.path(), text).unwrap();
        let parameter_files = vec![file.path().to_owned()];
        let arguments = Arguments { parameter_files, ..Arguments::default() };
        let settings = Settings::of(&arguments, Some("jazzy")).unwrap();
        assert_eq!(settings.odom_topic, "odometry");
        assert!(!settings.is_cmd_vel_stamped);
        // Parameters for all nodes may be for other nodes; parameters for this node must be
        // known.
        let with = |name: &str| format!("{text}{name}:\n  ros__parameters:\n    speed: 1\n");
        std::fs::write(file.path(), with("/**/keyway")).unwrap();
        assert!(Settings::of(&arguments, None).is_err());
        std::fs::write(file.path(), text.replace("robot: jackal", "robot: jackal\n    speed: 1"))
            .unwrap();
        assert!(Settings::of(&arguments, None).is_ok());
        std::fs::write(file.path(), "- 1\n").unwrap();
        let message = Settings::of(&arguments, None).err().unwrap().to_string();
        assert!(message.contains("node names"), "{message}");
    }
}
