//! Robots that are bundled.

use super::{Footprint, FootprintError, Limits, Mount, RangeSensor, Robot};
use crate::geometry::Point;

impl Robot {
    /// Names of the bundled robots, for [`Self::by_name`].
    pub const NAMES: [&'static str; 5] = ["small", "jackal", "paper", "burger", "waffle"];

    /// A bundled robot.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "small" => Some(Self::small()),
            "jackal" => Some(Self::jackal()),
            "paper" => Some(Self::paper()),
            "burger" => Some(Self::burger()),
            "waffle" => Some(Self::waffle()),
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
                acceleration_mps2: 0.5,
                deceleration_mps2: 0.5,
                angular_acceleration_radps2: 3.0,
                angular_deceleration_radps2: 3.0,
            },
            sensors: vec![RangeSensor::new(360, 360.0, 3.5)],
        }
    }

    /// Clearpath Jackal as in the BARN challenge: 0.508 m x 0.430 m, up to 2 m/s, lidar of 270
    /// degrees and 30 m. It backs up at 0.5 m/s at most, as its lidar looks ahead. Its velocity
    /// controller would allow 20 m/s² and 25 rad/s²; the accelerations here are what its tyres
    /// hold.
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
                acceleration_mps2: 3.0,
                deceleration_mps2: 3.0,
                angular_acceleration_radps2: 6.0,
                angular_deceleration_radps2: 6.0,
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
                acceleration_mps2: 0.2,
                deceleration_mps2: 0.2,
                angular_acceleration_radps2: 50.0 * degree,
                angular_deceleration_radps2: 50.0 * degree,
            },
            sensors: vec![RangeSensor::new(360, 360.0, 5.0)],
        }
    }

    /// `TurtleBot3` Burger: 0.14 m x 0.178 m, up to 0.22 m/s, with its lidar LDS-01 of 3.5 m, which
    /// scans five times a second.
    ///
    /// # Source
    /// Width, speeds and lidar: ROBOTIS e-Manual, `TurtleBot3`, Specifications. Length and place of
    /// the base, and the place of the lidar behind the axle: its URDF. Accelerations: those that
    /// Nav2's parameters for it allow.
    pub fn burger() -> Self {
        // The base is a box of 0.14 m behind the axle, between wheels 0.178 m apart outside.
        let footprint = box_around(-0.032, 0.14, 0.178);
        Self::turtlebot3(footprint, -0.032, (0.22, 2.84))
    }

    /// `TurtleBot3` Waffle: 0.281 m x 0.306 m, up to 0.26 m/s, with the lidar LDS-01 of 3.5 m,
    /// which scans five times a second.
    ///
    /// # Source
    /// As for [`Self::burger`]; the length is that of the e-Manual.
    pub fn waffle() -> Self {
        let footprint = box_around(-0.064, 0.281, 0.306);
        Self::turtlebot3(footprint, -0.064, (0.26, 1.82))
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
                acceleration_mps2: 2.5,
                deceleration_mps2: 2.5,
                angular_acceleration_radps2: 3.2,
                angular_deceleration_radps2: 3.2,
            },
            sensors: vec![lidar],
        }
    }
}

/// A box whose middle is ahead of the centre of rotation by so much.
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
