//! Description of a robot: its size, its limits, its sensors.

mod bundled;
mod command_window;
mod derived;
mod drive_model;
mod footprint;
mod mount;
mod sensor;
mod turning;

use crate::ConfigError;
use serde::{Deserialize, Serialize};

pub use command_window::CommandWindow;
pub use drive_model::{CycleCount, Ramp};
#[cfg(test)]
pub(crate) use footprint::star;
pub use footprint::{Circle, Footprint, FootprintError, Polygon};
pub use mount::Mount;
pub use sensor::RangeSensor;

/// A wheeled robot with planar range sensors: with a differential drive, or car-like.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// The ground area that it covers: `radius_m` of a disc, or `vertices_m` of a polygon.
    pub footprint: Footprint,
    /// Control cycle \[s\]: time between two commands, from 0.001 to 10.
    pub cycle_s: f64,
    /// Time from a command to its effect \[s\], up to 10. The controller decides for the instant
    /// at which its command takes effect, and simulated motors have the same delay. If the value
    /// is wrong, the robot estimates the delay while it drives.
    #[serde(default)]
    pub actuation_delay_s: f64,
    /// Safety margin: the distance kept from obstacles in addition to the footprint \[m\], from
    /// 0.0001 to 10. Routes, the stop rule and a stack's parameters for a robot are derived from
    /// it. Default: a tenth of the distance driven in a cycle at full speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safety_margin_m: Option<f64>,
    /// Velocity and acceleration limits.
    pub limits: Limits,
    /// The range sensors: one to eight.
    #[cfg_attr(feature = "schema", schemars(length(min = 1, max = 8)))]
    pub sensors: Vec<RangeSensor>,
}

/// Velocity and acceleration limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Smallest forward speed \[m/s\], at least -100; 0: no driving backwards.
    pub v_min_mps: f64,
    /// Largest forward speed \[m/s\], from 0.0001 to 100.
    pub v_max_mps: f64,
    /// Largest turn rate to either side \[rad/s\], from 0.0001 to 100.
    pub omega_max_radps: f64,
    /// Smallest turning radius \[m\], from 0.0001 to 100: that of a car-like robot, which turns
    /// only while it drives. Default: 0, for a robot that turns in place.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub min_turning_radius_m: f64,
    /// Acceleration \[m/s²\], from 0.0001 to 10000 like those below.
    pub acceleration_mps2: f64,
    /// Deceleration \[m/s²\], positive; the robot stops from full speed within a minute.
    pub deceleration_mps2: f64,
    /// Angular acceleration \[rad/s²\].
    pub angular_acceleration_radps2: f64,
    /// Angular deceleration \[rad/s²\], positive; the robot stops from the full turn rate within a
    /// minute, too.
    pub angular_deceleration_radps2: f64,
    /// Largest jerk of the commands \[m/s³\]; by default unlimited. With a limit, commands are the
    /// mean over some cycles ([`CommandWindow`]), at most 2 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jerk_mps3: Option<f64>,
    /// Largest angular jerk \[rad/s³\], in the same way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_jerk_radps3: Option<f64>,
}

impl Robot {
    /// Checks every value. A footprint was checked on construction.
    ///
    /// # Errors
    /// Names the first invalid field, with the values that are valid. The ranges are wider than
    /// any wheeled robot needs; beyond them a simulation would take minutes per second, or lose
    /// numerical accuracy.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let Limits { v_min_mps, v_max_mps, omega_max_radps, .. } = self.limits;
        let Limits { acceleration_mps2, deceleration_mps2, .. } = self.limits;
        let Limits { angular_acceleration_radps2, angular_deceleration_radps2, .. } = self.limits;
        let (speeds, rates) = (1e-4..=100.0, 1e-4..=1e4);
        let (speed, rate) = ("a number from 0.0001 to 100", "a number from 0.0001 to 10000");
        let checks = [
            ("cycle_s", self.cycle_s, 1e-3..=10.0, "a time from 0.001 to 10 s"),
            ("actuation_delay_s", self.actuation_delay_s, 0.0..=10.0, "a time from 0 to 10 s"),
            (
                "safety_margin_m",
                self.safety_margin_m.unwrap_or(1.0),
                1e-4..=10.0,
                "a length from 0.0001 to 10 m",
            ),
            ("limits.v_max_mps", v_max_mps, speeds.clone(), speed),
            (
                "limits.v_min_mps",
                v_min_mps,
                -100.0..=0.0,
                "0, or negative for a robot that backs up, and at least -100",
            ),
            ("limits.omega_max_radps", omega_max_radps, speeds, speed),
            ("limits.acceleration_mps2", acceleration_mps2, rates.clone(), rate),
            ("limits.deceleration_mps2", deceleration_mps2, rates.clone(), rate),
            (
                "limits.angular_acceleration_radps2",
                angular_acceleration_radps2,
                rates.clone(),
                rate,
            ),
            ("limits.angular_deceleration_radps2", angular_deceleration_radps2, rates, rate),
        ];
        if let Some((field, value, _, expected)) =
            checks.into_iter().find(|(_, value, usable, _)| !usable.contains(value))
        {
            return Err(ConfigError::must_be(field, expected, value));
        }
        self.validate_sensors()?;
        self.limits.check_turning()?;
        self.limits.check_jerks(self.cycle_s)?;
        self.limits.check_stopping()
    }
}

/// True for 0, the default of a value that is left out of files.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Robot {
    /// The distance that routes keep from obstacles if possible \[m\]: the circumscribed radius,
    /// which lets the robot turn in place anywhere, plus the distance of a cycle at full speed, or
    /// the safety margin if that is larger.
    pub fn preferred_clearance_m(&self) -> f64 {
        let cycle_m = self.limits.v_max_mps * self.cycle_s;
        self.footprint.circumscribed_radius_m() + cycle_m.max(self.safety_margin_or_default_m())
    }

    /// The safety margin \[m\]: that of the robot, or a tenth of the distance driven in a cycle at
    /// full speed.
    pub fn safety_margin_or_default_m(&self) -> f64 {
        self.safety_margin_m.unwrap_or(0.1 * self.limits.v_max_mps * self.cycle_s)
    }

    /// Distance beyond which obstacles hardly matter within one cycle \[m\]: the reach of any part
    /// of the robot at full speed in a cycle plus twice the time to stop.
    pub fn decision_reach_m(&self) -> f64 {
        let drive_s = self.cycle_s + 2.0 * self.limits.stop_s();
        self.footprint.circumscribed_radius_m() + self.limits.v_max_mps * drive_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundled_robots_are_valid() {
        for name in Robot::NAMES {
            let robot = Robot::by_name(name).unwrap();
            assert_eq!(robot.validate(), Ok(()));
            assert!(robot.sight_mps() > robot.limits.v_max_mps, "{name}");
            let text = toml::to_string(&robot).unwrap();
            assert_eq!(toml::from_str::<Robot>(&text).unwrap(), robot);
        }
        assert_eq!(Robot::by_name("large"), None);
    }

    #[test]
    fn a_bad_value_is_named() {
        let mut robot = Robot::small();
        robot.limits.deceleration_mps2 = f64::NAN;
        assert_eq!(robot.validate().unwrap_err().path, "limits.deceleration_mps2");
        robot = Robot::small();
        robot.sensors[0].beams = 0;
        assert_eq!(robot.validate().unwrap_err().path, "sensors[0].beams");
    }

    #[test]
    fn what_no_robot_can_do_is_refused_with_field_and_value() {
        type Set = fn(&mut Robot, f64);
        let cases: [(Set, f64, &str); 10] = [
            (
                |r, x| r.cycle_s = x,
                1e9,
                "cycle_s must be a time from 0.001 to 10 s, got 1000000000",
            ),
            (|r, x| r.cycle_s = x, 1e-9, "cycle_s must be a time from 0.001 to 10 s, got 1e-9"),
            (
                |r, x| r.limits.v_max_mps = x,
                101.0,
                "v_max_mps must be a number from 0.0001 to 100, got 101",
            ),
            (|r, x| r.limits.v_min_mps = x, -1e30, "and at least -100, got -1e30"),
            (|r, x| r.limits.v_min_mps = x, -90.0, "to stop from limits.v_min_mps within a minute"),
            (
                |r, x| r.limits.omega_max_radps = x,
                1e6,
                "omega_max_radps must be a number from 0.0001 to 100, got 1000000",
            ),
            (
                |r, x| r.limits.acceleration_mps2 = x,
                1e5,
                "acceleration_mps2 must be a number from 0.0001 to 10000, got 100000",
            ),
            (
                |r, x| r.limits.deceleration_mps2 = x,
                0.001,
                "deceleration_mps2 must be at least 0.008334, to stop from limits.v_max_mps within a minute, got 0.001",
            ),
            (
                |r, x| r.limits.angular_deceleration_radps2 = x,
                0.02,
                "to stop from limits.omega_max_radps within a minute, got 0.02",
            ),
            (
                |r, x| r.sensors[0].range_m = x,
                1e300,
                "sensors[0].range_m must be a length in metres, from 0.001 to 1000, got 1e300",
            ),
        ];
        for (set, value, expected) in cases {
            let mut robot = Robot::small();
            set(&mut robot, value);
            let text = robot.validate().unwrap_err().to_string();
            assert!(text.contains(expected), "{text}");
        }
    }
}
