//! Parameters of Nav2 nodes, as far as they apply here: Nav2 files can describe the robot.

use super::Parameters;
use keyway::files::RobotFile;
use keyway::geometry::Point;
use keyway::robot::Footprint;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Nav2's own default of `min_turning_r` \[m\].
const NAV2_TURNING_RADIUS_M: f64 = 0.2;

/// The applicable parameters of a Nav2 file.
#[derive(Debug, Default)]
pub(super) struct Nav2 {
    /// The robot, as far as the file describes it.
    pub(super) robot: RobotFile,
    pub(super) goal_tolerance_m: Option<f64>,
    pub(super) goal_yaw_tolerance_rad: Option<f64>,
    /// Parameters of this node, derived from those of others.
    pub(super) own: Parameters,
    /// The reason why the described robot is invalid.
    pub(super) fault: Option<String>,
    /// Names of used parameters, and of all parameters, each after its node.
    taken: BTreeSet<String>,
    all: BTreeSet<String>,
    /// The used parameters that describe the robot.
    of_robot: BTreeSet<String>,
}

/// Nodes of a file, by name.
struct Nodes<'a> {
    parameters: BTreeMap<&'a str, &'a Table>,
    taken: BTreeSet<String>,
}

impl Nav2 {
    /// Reads the Nav2 nodes of a file that are in a namespace, or in none. The result is empty
    /// without any of them.
    pub(super) fn of(file: &Table, namespace: &str) -> Self {
        let mut nodes = Nodes::of(file, namespace);
        let mut found = Self { all: nodes.names(), ..Self::default() };
        found.take_size(&mut nodes);
        found.take_limits(&mut nodes);
        found.of_robot = nodes.taken.clone();
        found.take_tolerances(&mut nodes);
        found.take_names(&mut nodes);
        found.take_sources(&mut nodes);
        found.taken = nodes.taken;
        found
    }

    /// Ignores the robot, as it is described elsewhere.
    pub(super) fn forget_robot(&mut self) {
        self.taken.retain(|name| !self.of_robot.contains(name));
    }

    /// True if nothing was used.
    pub(super) fn is_empty(&self) -> bool {
        self.taken.is_empty()
    }

    /// Report of used and unused parameters, for the user who starts the node; empty without a
    /// Nav2 file.
    pub(super) fn report(&self) -> Vec<String> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut lines = vec!["Nav2 parameters in use:".to_owned()];
        lines.extend(self.taken.iter().map(|name| format!("  {name}")));
        let mut left: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (node, name) in
            self.all.difference(&self.taken).filter_map(|name| name.split_once(": "))
        {
            left.entry(node).or_default().push(name);
        }
        lines.push("unused Nav2 parameters:".to_owned());
        lines.extend(left.iter().map(|(node, names)| format!("  {node}: {}", names.join(", "))));
        lines
    }

    fn take_size(&mut self, nodes: &mut Nodes<'_>) {
        for costmap in ["local_costmap", "global_costmap"] {
            let given = nodes.take(costmap, "footprint");
            if let Some(other) = given.filter(|value| !value.is_str()) {
                let expected =
                    "a string, such as \"[[0.2, 0.1], [-0.2, 0.1], [-0.2, -0.1], [0.2, -0.1]]\"";
                self.fault = Some(format!("{costmap}: footprint: must be {expected}, got {other}"));
                return;
            }
            // Without corners, the radius is used, as in Nav2.
            let text = given.and_then(Value::as_str);
            if let Some(text) = text.filter(|text| text.contains(char::is_numeric)) {
                match polygon(text) {
                    Ok(footprint) => self.robot.footprint = Some(footprint),
                    Err(why) => self.fault = Some(format!("{costmap}: footprint: {why}")),
                }
                return;
            }
            if let Some(value) = nodes.take(costmap, "robot_radius") {
                self.robot.radius_m = super::number(value).filter(|&radius_m| radius_m > 0.0);
                if self.robot.radius_m.is_none() {
                    let why = format!("must be a positive number, got {value}");
                    self.fault = Some(format!("{costmap}: robot_radius: {why}"));
                }
                return;
            }
        }
    }

    /// Limits of the first controller, of any type, and of the velocity smoother. The lower one
    /// of both has priority.
    fn take_limits(&mut self, nodes: &mut Nodes<'_>) {
        const CONTROLLER: &str = "controller_server";
        const SMOOTHER: &str = "velocity_smoother";
        let plugin = nodes.first_text(CONTROLLER, "controller_plugins");
        let plugin = plugin.unwrap_or_else(|| "FollowPath".to_owned());
        let mut of_controller = |names: &[&str]| {
            let mut number = |name: &&str| nodes.number(CONTROLLER, &format!("{plugin}.{name}"));
            names.iter().find_map(&mut number)
        };
        // DWB, MPPI, regulated pure pursuit, graceful controller.
        let speed = of_controller(&[
            "max_vel_x",
            "vx_max",
            "desired_linear_vel",
            "max_linear_vel",
            "v_linear_max",
        ]);
        let slowest = of_controller(&["min_vel_x", "vx_min"]);
        let turn = of_controller(&[
            "max_vel_theta",
            "wz_max",
            "rotate_to_heading_angular_vel",
            "v_angular_max",
        ]);
        let faster = of_controller(&["acc_lim_x", "ax_max"]);
        let slower = of_controller(&["decel_lim_x", "ax_min"]);
        let turn_faster = of_controller(&["acc_lim_theta", "az_max", "max_angular_accel"]);
        let turn_slower = of_controller(&["decel_lim_theta"]);
        let model = nodes.text(CONTROLLER, &format!("{plugin}.motion_model"));
        let is_car = model.is_some_and(|model| model == "Ackermann");
        let radius = is_car.then(|| {
            let name = format!("{plugin}.AckermannConstraints.min_turning_r");
            nodes.number(CONTROLLER, &name).unwrap_or(NAV2_TURNING_RADIUS_M)
        });
        let fault = &mut self.fault;
        let mut of_smoother = |name: &str| {
            let list = nodes.numbers(SMOOTHER, name).filter(|list| list.len() == 3);
            if let (None, Some(value)) = (&list, nodes.take(SMOOTHER, name)) {
                let why = format!("must be three numbers, for x, y and theta, got {value}");
                *fault = Some(format!("{SMOOTHER}: {name}: {why}"));
            }
            let at = |index: usize| list.as_ref().map(|list| list[index].abs());
            [at(0), at(2)]
        };
        let [top, top_turn] = of_smoother("max_velocity");
        let [gain, turn_gain] = of_smoother("max_accel");
        let [brake, turn_brake] = of_smoother("max_decel");
        let [back, _] = of_smoother("min_velocity");
        let lower = |a: Option<f64>, b: Option<f64>| match (a.map(f64::abs), b) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        self.robot.v_max_mps = lower(speed, top);
        let limits = &mut self.robot.limits;
        // The reverse speed is that of the controller if it has one, otherwise that of the
        // smoother.
        limits.v_min_mps = slowest.filter(|&v_mps| v_mps < 0.0).or(back.map(|back_mps| -back_mps));
        limits.omega_max_radps = lower(turn, top_turn);
        limits.min_turning_radius_m = radius;
        limits.acceleration_mps2 = lower(faster, gain);
        limits.deceleration_mps2 = lower(slower, brake).or(limits.acceleration_mps2);
        limits.angular_acceleration_radps2 = lower(turn_faster, turn_gain);
        limits.angular_deceleration_radps2 =
            lower(turn_slower, turn_brake).or(limits.angular_acceleration_radps2);
    }

    fn take_tolerances(&mut self, nodes: &mut Nodes<'_>) {
        let server = "controller_server";
        let checker = nodes.first_text(server, "goal_checker_plugins");
        let checker = checker.unwrap_or_else(|| "goal_checker".to_owned());
        self.goal_tolerance_m = nodes.number(server, &format!("{checker}.xy_goal_tolerance"));
        self.goal_yaw_tolerance_rad =
            nodes.number(server, &format!("{checker}.yaw_goal_tolerance"));
    }

    /// Names of frames and topics, and the frequency. Simulated time is left to the launch file,
    /// as Nav2's launch files override this value.
    fn take_names(&mut self, nodes: &mut Nodes<'_>) {
        for (own, places) in [
            ("controller_frequency", &["controller_server"][..]),
            ("odom_topic", &["controller_server", "bt_navigator"]),
            ("global_frame", &["bt_navigator", "global_costmap"]),
            ("robot_base_frame", &["bt_navigator", "local_costmap"]),
            ("enable_stamped_cmd_vel", &["controller_server"]),
        ] {
            let value = places.iter().find_map(|node| nodes.take(node, own).cloned());
            self.own.extend(value.map(|value| (own.to_owned(), value)));
        }
    }

    /// Topics of the lidars and point clouds in the local costmap.
    fn take_sources(&mut self, nodes: &mut Nodes<'_>) {
        let costmap = "local_costmap";
        let (mut scans, mut clouds) = (Vec::new(), Vec::new());
        for layer in nodes.texts(costmap, "plugins").unwrap_or_default() {
            let is_off = |nodes: &mut Nodes<'_>, name: &str| {
                nodes.take(costmap, &format!("{layer}.{name}")).and_then(Value::as_bool)
                    == Some(false)
            };
            if is_off(nodes, "enabled") {
                continue;
            }
            let Some(sources) = nodes.text(costmap, &format!("{layer}.observation_sources")) else {
                continue;
            };
            for source in sources.split_whitespace() {
                if is_off(nodes, &format!("{source}.marking")) {
                    continue;
                }
                let mut of = |name: &str| nodes.take(costmap, &format!("{layer}.{source}.{name}"));
                let kind = of("data_type").and_then(Value::as_str).unwrap_or("LaserScan");
                // Sonars and others have other message types, which are not supported.
                if !["LaserScan", "PointCloud2"].contains(&kind) {
                    continue;
                }
                let is_cloud = kind == "PointCloud2";
                let topic = of("topic").and_then(Value::as_str).unwrap_or(source).to_owned();
                let topics = if is_cloud { &mut clouds } else { &mut scans };
                topics.push(topic);
                for name in ["min_obstacle_height", "max_obstacle_height", "obstacle_max_range"] {
                    let value = is_cloud.then(|| of(name).cloned()).flatten();
                    self.own.extend(value.map(|value| (name.to_owned(), value)));
                }
            }
        }
        for (own, topics) in [("scan_topics", scans), ("cloud_topics", clouds)] {
            if !topics.is_empty() {
                let topics = topics.into_iter().map(Value::String).collect();
                self.own.insert(own.to_owned(), Value::Array(topics));
            }
        }
    }
}

impl<'a> Nodes<'a> {
    /// Names of Nav2 nodes.
    const NAMES: [&'static str; 12] = [
        "amcl",
        "behavior_server",
        "bt_navigator",
        "collision_monitor",
        "controller_server",
        "docking_server",
        "global_costmap",
        "local_costmap",
        "planner_server",
        "smoother_server",
        "velocity_smoother",
        "waypoint_follower",
    ];

    fn of(file: &'a Table, namespace: &str) -> Self {
        let mut parameters = BTreeMap::new();
        for (path, of_node) in super::file::nodes(file) {
            let full = format!("/{}", path.trim_start_matches('/'));
            let inside = full.strip_prefix(namespace).or_else(|| full.strip_prefix("/**"));
            let path = inside.unwrap_or(&full).trim_start_matches('/');
            // Costmap nodes are in a namespace with their own name.
            let is_it = |name: &&str| path == *name || path == format!("{name}/{name}");
            parameters.extend(Self::NAMES.into_iter().find(is_it).map(|name| (name, of_node)));
        }
        Self { parameters, taken: BTreeSet::new() }
    }

    /// Names of all parameters, each after its node.
    fn names(&self) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        for (node, parameters) in &self.parameters {
            add_names(&mut names, &format!("{node}: "), parameters);
        }
        names
    }

    /// Takes a parameter by its dotted name, which a file may have as nested tables or as one
    /// key.
    fn take(&mut self, node: &str, name: &str) -> Option<&'a Value> {
        let parameters = *self.parameters.get(node)?;
        let nested = || {
            let (parts, last) = name.rsplit_once('.').unwrap_or(("", name));
            let mut parts = parts.split('.').filter(|part| !part.is_empty());
            let into = |table: &'a Table, part: &str| table.get(part)?.as_table();
            parts.try_fold(parameters, into)?.get(last)
        };
        let value = parameters.get(name).or_else(nested).filter(|value| !value.is_table())?;
        self.taken.insert(format!("{node}: {name}"));
        Some(value)
    }

    fn number(&mut self, node: &str, name: &str) -> Option<f64> {
        super::number(self.take(node, name)?)
    }

    fn numbers(&mut self, node: &str, name: &str) -> Option<Vec<f64>> {
        self.take(node, name)?.as_array()?.iter().map(super::number).collect()
    }

    fn text(&mut self, node: &str, name: &str) -> Option<String> {
        Some(self.take(node, name)?.as_str()?.to_owned())
    }

    fn texts(&mut self, node: &str, name: &str) -> Option<Vec<String>> {
        let list = self.take(node, name)?.as_array()?;
        list.iter().map(|text| Some(text.as_str()?.to_owned())).collect()
    }

    fn first_text(&mut self, node: &str, name: &str) -> Option<String> {
        self.texts(node, name)?.into_iter().next()
    }
}

fn add_names(names: &mut BTreeSet<String>, before: &str, parameters: &Table) {
    for (name, value) in parameters {
        match value {
            Value::Table(inner) => add_names(names, &format!("{before}{name}."), inner),
            _ => drop(names.insert(format!("{before}{name}"))),
        }
    }
}

/// A footprint in Nav2's format: a text such as `[[0.2, 0.1], [-0.2, 0.1], [0.0, -0.1]]`. The
/// first corner may be repeated at the end.
fn polygon(text: &str) -> Result<Footprint, String> {
    let corners: Vec<[f64; 2]> = serde_saphyr::from_str(text).map_err(|error| error.to_string())?;
    let mut corners: Vec<Point> = corners.into_iter().map(Point::from).collect();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    Footprint::polygon(corners).map_err(|error| error.to_string())
}

#[cfg(test)]
#[path = "nav2_tests.rs"]
mod tests;
