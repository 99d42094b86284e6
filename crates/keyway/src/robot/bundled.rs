//! The bundled robots.

use super::{Footprint, FootprintError, Limits, Mount, RangeSensor, Robot};
use crate::geometry::Point;

impl Robot {
    /// Names of the bundled robots, for [`Self::by_name`].
    pub const NAMES: [&'static str; 10] = [
        "small",
        "jackal",
        "paper",
        "burger",
        "waffle",
        "turtlebot4",
        "husky",
        "mir100",
        "wheelchair",
        "pallet-truck",
    ];

    /// A bundled robot.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "small" => Some(Self::small()),
            "jackal" => Some(Self::jackal()),
            "paper" => Some(Self::paper()),
            "burger" => Some(Self::burger()),
            "waffle" => Some(Self::waffle()),
            "turtlebot4" => Some(Self::turtlebot4()),
            "husky" => Some(Self::husky()),
            "mir100" => Some(Self::mir100()),
            "wheelchair" => Some(Self::wheelchair()),
            "pallet-truck" => Some(Self::pallet_truck()),
            _ => None,
        }
    }

    /// A small round indoor robot of `TurtleBot` size: radius 0.18 m, up to 0.5 m/s.
    pub fn small() -> Self {
        Self {
            footprint: bundled(Footprint::circle(0.18)),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps: 0.5,
                omega_max_radps: 1.5,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 0.5,
                deceleration_mps2: 0.5,
                angular_acceleration_radps2: 3.0,
                angular_deceleration_radps2: 3.0,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![RangeSensor::new(360, 360.0, 3.5)],
        }
    }

    /// Clearpath Jackal as in the BARN challenge: 0.508 m x 0.430 m, up to 2 m/s, lidar of 270
    /// degrees and 30 m. It backs up at 0.5 m/s at most, because its lidar faces forward. Its
    /// velocity controller would allow 20 m/s² and 25 rad/s²; the accelerations here are limited
    /// by the grip of its tyres.
    pub fn jackal() -> Self {
        Self {
            footprint: bundled(Footprint::rectangle(0.508, 0.430)),
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: -0.5,
                v_max_mps: 2.0,
                omega_max_radps: 3.0,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 3.0,
                deceleration_mps2: 3.0,
                angular_acceleration_radps2: 6.0,
                angular_deceleration_radps2: 6.0,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![RangeSensor::new(720, 270.0, 30.0)],
        }
    }

    /// The robot of \[You2021\], table 2: a point that drives at up to 1 m/s on a map of 1 m cells.
    pub fn paper() -> Self {
        let degree = std::f64::consts::PI / 180.0;
        Self {
            footprint: bundled(Footprint::circle(0.0)),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps: 1.0,
                omega_max_radps: 20.0 * degree,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 0.2,
                deceleration_mps2: 0.2,
                angular_acceleration_radps2: 50.0 * degree,
                angular_deceleration_radps2: 50.0 * degree,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![RangeSensor::new(360, 360.0, 5.0)],
        }
    }

    /// `TurtleBot3` Burger: 0.14 m x 0.178 m, up to 0.22 m/s, with the lidar LDS-01 of 3.5 m at
    /// five scans per second.
    ///
    /// # Source
    /// Width, speeds and lidar: ROBOTIS e-Manual, `TurtleBot3`, Specifications. Length and
    /// position of the base, and position of the lidar behind the axle: its URDF. Accelerations:
    /// those allowed by Nav2's parameters for it.
    pub fn burger() -> Self {
        // The base is a box of 0.14 m behind the axle, between wheels whose outer sides are 0.178
        // m apart.
        let footprint = box_around(-0.032, 0.14, 0.178);
        Self::turtlebot3(footprint, -0.032, (0.22, 2.84))
    }

    /// `TurtleBot3` Waffle: 0.281 m x 0.306 m, up to 0.26 m/s, with the lidar LDS-01 of 3.5 m at
    /// five scans per second.
    ///
    /// # Source
    /// As for [`Self::burger`]; the length is that of the e-Manual.
    pub fn waffle() -> Self {
        let footprint = box_around(-0.064, 0.281, 0.306);
        Self::turtlebot3(footprint, -0.064, (0.26, 1.82))
    }

    /// `TurtleBot` 4: radius 0.175 m, up to 0.306 m/s with its safety features on, which do not
    /// let it back up; lidar RPLIDAR A1M8 of 12 m at about eight scans per second.
    ///
    /// # Source
    /// Radius: Nav2's parameters of `turtlebot4_navigation`. Speeds and accelerations: iRobot
    /// Create 3, documentation and simulation. Mount and beams of the lidar:
    /// `turtlebot4_description`; its shortest range and its period: scans of real robots.
    pub fn turtlebot4() -> Self {
        let lidar = RangeSensor {
            mount: Mount { x_m: -0.04, y_m: 0.0, yaw_deg: 90.0 },
            range_min_m: 0.15,
            period_s: Some(0.13),
            ..RangeSensor::new(640, 360.0, 12.0)
        };
        Self {
            footprint: bundled(Footprint::circle(0.175)),
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps: 0.306,
                omega_max_radps: 1.9,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 0.9,
                deceleration_mps2: 0.9,
                angular_acceleration_radps2: 7.725,
                angular_deceleration_radps2: 7.725,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![lidar],
        }
    }

    /// Clearpath Husky A200: 0.99 m x 0.67 m, up to 1 m/s, with a lidar of 270 degrees and 30 m on
    /// its front. It backs up at 0.1 m/s, because its lidar faces forward.
    ///
    /// # Source
    /// Size and speed: its user manual. Limits: `clearpath_control` (ROS 2); reverse speed: those
    /// of `husky_navigation`. Mount and beams of the lidar: `husky_description`, `lms1xx`.
    pub fn husky() -> Self {
        let lidar = RangeSensor {
            mount: Mount { x_m: 0.337, ..Mount::CENTRE },
            range_min_m: 0.1,
            ..RangeSensor::new(720, 270.0, 30.0)
        };
        Self {
            footprint: bundled(Footprint::rectangle(0.99, 0.67)),
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: -0.1,
                v_max_mps: 1.0,
                omega_max_radps: 1.0,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 1.0,
                deceleration_mps2: 1.0,
                angular_acceleration_radps2: 1.0,
                angular_deceleration_radps2: 1.0,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![lidar],
        }
    }

    /// `MiR100`, a transport robot: 0.9 m x 0.586 m, up to 0.8 m/s, with two safety scanners SICK
    /// S300 at opposite corners, of 270 degrees and 29 m each.
    ///
    /// # Source
    /// `mir_robot` (DFKI): footprint and limits of `mir_navigation`, mounts and beams of the
    /// scanners of `mir_description`.
    pub fn mir100() -> Self {
        let scanner = |x_m, y_m, yaw_deg| RangeSensor {
            mount: Mount { x_m, y_m, yaw_deg },
            range_min_m: 0.05,
            period_s: Some(0.08),
            ..RangeSensor::new(541, 270.0, 29.0)
        };
        Self {
            footprint: box_around(0.038, 0.9, 0.586),
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: -0.2,
                v_max_mps: 0.8,
                omega_max_radps: 1.0,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 1.5,
                deceleration_mps2: 1.5,
                angular_acceleration_radps2: 2.0,
                angular_deceleration_radps2: 2.0,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![scanner(0.43, 0.236, 45.0), scanner(-0.354, -0.236, -135.0)],
        }
    }

    /// A wheelchair that turns about its rear axle, like WHILL Model C: 0.878 m x 0.54 m, up to
    /// 0.567 m/s, with a lidar of 200 degrees and 30 m at its feet. It backs up at 0.2 m/s,
    /// because its lidar faces forward.
    ///
    /// # Source
    /// Size, and mount and beams of the lidar: URDF of `ros_whill` and `ros2_whill`, which does
    /// not include the overhang behind the wheels. Limits: the indoor speed profile of
    /// `ros_whill`, except for the reverse speed.
    pub fn wheelchair() -> Self {
        let lidar = RangeSensor {
            mount: Mount { x_m: 0.5, ..Mount::CENTRE },
            range_min_m: 0.1,
            ..RangeSensor::new(720, 200.0, 30.0)
        };
        Self {
            footprint: box_around(0.306, 0.878, 0.54),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: -0.2,
                v_max_mps: 0.567,
                omega_max_radps: 0.8,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 0.23,
                deceleration_mps2: 1.25,
                angular_acceleration_radps2: 0.79,
                angular_deceleration_radps2: 1.8,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![lidar],
        }
    }

    /// A pallet truck that turns about the wheels of its forks, like HR-Recycler of Robotnik: 1.95
    /// m x 0.8 m, up to 0.6 m/s, with a safety scanner SICK S300 of 270 degrees and 30 m on its
    /// front. Its steered wheel turns by 90 degrees to either side, so it can turn in place.
    ///
    /// # Source
    /// `pallet_truck` (Robotnik): footprint, speeds and accelerations of its navigation,
    /// decelerations of its controller, scanner mount of its description; the turn rate is that at
    /// which the wheel drives at 1 m/s.
    pub fn pallet_truck() -> Self {
        let scanner = RangeSensor {
            mount: Mount { x_m: 1.689, ..Mount::CENTRE },
            range_min_m: 0.1,
            period_s: Some(0.08),
            ..RangeSensor::new(541, 270.0, 30.0)
        };
        Self {
            footprint: box_around(0.775, 1.95, 0.8),
            cycle_s: 0.1,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: -0.15,
                v_max_mps: 0.6,
                omega_max_radps: 0.73,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 0.2,
                deceleration_mps2: 1.0,
                angular_acceleration_radps2: 0.2,
                angular_deceleration_radps2: 2.0,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![scanner],
        }
    }

    fn turtlebot3(
        footprint: Footprint,
        lidar_x_m: f64,
        (v_max_mps, omega_max_radps): (f64, f64),
    ) -> Self {
        let lidar = RangeSensor {
            mount: Mount { x_m: lidar_x_m, ..Mount::CENTRE },
            range_min_m: 0.12,
            period_s: Some(0.2),
            ..RangeSensor::new(360, 360.0, 3.5)
        };
        Self {
            footprint,
            cycle_s: 0.05,
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps,
                omega_max_radps,
                min_turning_radius_m: 0.0,
                acceleration_mps2: 2.5,
                deceleration_mps2: 2.5,
                angular_acceleration_radps2: 3.2,
                angular_deceleration_radps2: 3.2,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![lidar],
        }
    }
}

/// A box whose centre is this far ahead of the centre of rotation \[m\].
fn box_around(middle_x_m: f64, length_m: f64, width_m: f64) -> Footprint {
    let (half_length_m, half_width_m) = (0.5 * length_m, 0.5 * width_m);
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let corner = |(x, y)| Point::new(middle_x_m + half_length_m * x, half_width_m * y);
    bundled(Footprint::polygon(corners.map(corner).to_vec()))
}

/// The footprint of a bundled robot.
#[expect(clippy::expect_used, reason = "its numbers stand above")]
fn bundled(footprint: Result<Footprint, FootprintError>) -> Footprint {
    footprint.expect("a bundled robot covers some ground")
}
