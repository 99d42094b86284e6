//! Files of Nav2 that describe robots.

use super::*;

fn of(text: &str) -> Nav2 {
    Nav2::of(&serde_saphyr::from_str(text).unwrap(), "/")
}

/// Layout of Nav2's own files, with MPPI.
const MPPI: &str = r#"
amcl:
  ros__parameters:
    scan_topic: scan
bt_navigator:
  ros__parameters:
    global_frame: world
    robot_base_frame: base_footprint
    odom_topic: odometry
controller_server:
  ros__parameters:
    controller_frequency: 20.0
    goal_checker_plugins: ["general_goal_checker"]
    controller_plugins: ["FollowPath"]
    general_goal_checker:
      xy_goal_tolerance: 0.25
      yaw_goal_tolerance: 0.3
    FollowPath:
      plugin: "nav2_mppi_controller::MPPIController"
      vx_max: 0.5
      vx_min: -0.35
      wz_max: 1.9
      ax_max: 3.0
      ax_min: -2.0
      az_max: 3.5
local_costmap:
  local_costmap:
    ros__parameters:
      robot_radius: 0.22
      plugins: ["voxel_layer", "inflation_layer"]
      inflation_layer:
        inflation_radius: 0.7
      voxel_layer:
        observation_sources: scan depth
        scan:
          topic: /front/scan
          data_type: "LaserScan"
          obstacle_max_range: 2.5
        depth:
          topic: /depth/points
          data_type: "PointCloud2"
          max_obstacle_height: 1.2
velocity_smoother:
  ros__parameters:
    max_velocity: [0.4, 0.0, 2.5]
    max_accel: [2.5, 0.0, 3.2]
    max_decel: [-2.5, 0.0, -3.2]
"#;

#[test]
fn a_file_of_nav2_describes_a_robot() {
    let nav2 = of(MPPI);
    let robot = nav2.robot.clone().robot().unwrap();
    assert_eq!(robot.footprint, Footprint::circle(0.22).unwrap());
    let limits = &robot.limits;
    assert_eq!((limits.v_max_mps, limits.v_min_mps), (0.4, -0.35), "the smoother is slower");
    assert_eq!((limits.acceleration_mps2, limits.deceleration_mps2), (2.5, 2.0));
    assert_eq!((limits.omega_max_radps, limits.angular_acceleration_radps2), (1.9, 3.2));
    assert_eq!(limits.angular_deceleration_radps2, 3.2);
    assert_eq!((nav2.goal_tolerance_m, nav2.goal_yaw_tolerance_rad), (Some(0.25), Some(0.3)));
    let texts = |name: &str| nav2.own[name].to_string();
    assert_eq!(texts("scan_topics"), r#"["/front/scan"]"#);
    assert_eq!(texts("cloud_topics"), r#"["/depth/points"]"#);
    assert_eq!(texts("max_obstacle_height"), "1.2");
    assert!(!nav2.own.contains_key("obstacle_max_range"), "that was of a lidar");
    assert_eq!(texts("global_frame"), r#""world""#);
    assert_eq!(texts("controller_frequency"), "20.0");
}

#[test]
fn a_car_of_nav2_has_a_turning_radius() {
    let radius_m = |model: &str| {
        let car = format!(
            "      motion_model: \"{model}\"\n      AckermannConstraints:\n        \
             min_turning_r: 0.4\nlocal_costmap:"
        );
        let robot = of(&MPPI.replacen("local_costmap:", &car, 1)).robot.robot().unwrap();
        robot.limits.min_turning_radius_m
    };
    assert_eq!((radius_m("Ackermann"), radius_m("DiffDrive")), (0.4, 0.0));
}

#[test]
fn what_was_taken_is_told() {
    let mut nav2 = of(MPPI);
    let report = nav2.report().join("\n");
    let (taken, left) = report.split_once("unused Nav2 parameters").unwrap();
    for name in ["controller_server: FollowPath.vx_max", "local_costmap: robot_radius"] {
        assert!(taken.contains(name), "{report}");
    }
    assert!(left.contains("  amcl: scan_topic\n"), "{report}");
    assert!(left.contains("inflation_layer.inflation_radius") && left.contains("plugin"));
    nav2.forget_robot();
    let report = nav2.report().join("\n");
    let (taken, left) = report.split_once("unused Nav2 parameters").unwrap();
    assert!(!taken.contains("robot_radius") && left.contains("robot_radius"), "{report}");
    assert!(taken.contains("xy_goal_tolerance"));
    assert!(of("keyway:\n  ros__parameters:\n    robot: jackal\n").report().is_empty());
}

/// A typing error must not make a robot smaller.
#[test]
fn a_footprint_that_cannot_be_is_no_footprint() {
    let with = |footprint: &str| {
        of(&format!(
            "local_costmap:\n  local_costmap:\n    ros__parameters:\n      footprint: \
             \"{footprint}\"\n      robot_radius: 0.1\n"
        ))
    };
    for wrong in ["[[0.3, 0.2], [0.3]]", "[[0.3, 0.2], [-0.3, 0.2]]", "0.3, 0.2"] {
        let nav2 = with(wrong);
        assert!(nav2.fault.unwrap().contains("footprint"), "{wrong}");
        assert_eq!(nav2.robot.radius_m, None);
    }
    let closed = with("[[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2], [0.3, 0.2]]");
    assert!(closed.fault.is_none() && closed.robot.footprint.is_some());
    assert_eq!(with("[]").robot.radius_m, Some(0.1));
}

#[test]
fn what_cannot_be_is_named() {
    for (before, after, named) in [
        ("robot_radius: 0.22", "footprint: [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2]]", "a string"),
        ("robot_radius: 0.22", "robot_radius: 0", "robot_radius: must be a positive number"),
        ("[0.4, 0.0, 2.5]", "[0.4, 0.0]", "max_velocity: must be three numbers"),
        ("[2.5, 0.0, 3.2]", "2.5", "max_accel: must be three numbers"),
        ("[2.5, 0.0, 3.2]", "[a, b, c]", "max_accel: must be three numbers"),
    ] {
        let text = MPPI.replace(before, after);
        assert_ne!(text, MPPI);
        let fault = of(&text).fault.unwrap();
        assert!(fault.contains(named), "{fault}");
    }
    // Sonars are ignored.
    let sonar = of(&MPPI.replace("LaserScan", "Range"));
    assert!(!sonar.own.contains_key("scan_topics") && sonar.own.contains_key("cloud_topics"));
}

#[test]
fn nodes_may_be_in_the_namespace() {
    let inner = MPPI.trim().replace('\n', "\n  ");
    let file = serde_saphyr::from_str(&format!("/r1:\n  {inner}\n")).unwrap();
    let here = Nav2::of(&file, "/r1");
    assert_eq!(here.robot.radius_m, Some(0.22));
    assert_eq!(here.report(), of(MPPI).report());
    assert!(Nav2::of(&file, "/").is_empty() && Nav2::of(&file, "/r2").is_empty());
}

#[test]
fn what_is_switched_off_is_not_there() {
    let text = MPPI.replace("        depth:\n", "        depth:\n          marking: false\n");
    let nav2 = of(&text);
    assert!(!nav2.own.contains_key("cloud_topics") && nav2.own.contains_key("scan_topics"));
    let off = MPPI.replace("      voxel_layer:\n", "      voxel_layer:\n        enabled: false\n");
    assert!(!of(&off).own.contains_key("scan_topics"));
}

#[test]
fn names_may_have_dots_and_footprints_are_texts() {
    let nav2 = of("controller_server:\n  ros__parameters:\n    FollowPath.max_vel_x: 0.3\n\
                   local_costmap:\n  local_costmap:\n    ros__parameters:\n      footprint: \
                   \"[[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]\"\n      robot_radius: 0.1\n");
    let robot = nav2.robot.robot().unwrap();
    assert_eq!((robot.limits.v_max_mps, robot.footprint.inscribed_radius_m()), (0.3, 0.2));
}
