//! The sensor of a robot.

use super::Robot;
use crate::ConfigError;
use serde::{Deserialize, Serialize};

/// A planar range sensor (lidar) at the robot's centre, looking ahead.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RangeSensor {
    /// Number of beams, spread evenly over the field of view.
    pub beams: u32,
    /// Field of view, centred straight ahead \[deg\]; 360 is all around.
    pub field_of_view_deg: f64,
    /// Range \[m\], from 0.001 to 10000.
    pub range_m: f64,
    /// Shortest range \[m\]: a shorter one says nothing. From 0, the default, to below `range_m`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub range_min_m: f64,
    /// Time from one scan to the next \[s\], from 0.001 to 60; without it the control cycle. In the
    /// cycles between two scans the controller expects none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// The robot stops when no beam has said anything for this long \[s\], from 0.001 to 3600;
    /// without it three periods, but at least 0.5 s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timeout_s: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl RangeSensor {
    /// A sensor with this many beams over a field of view \[deg\] that sees so far \[m\]: from its
    /// centre on, and once in every control cycle.
    pub const fn new(beams: u32, field_of_view_deg: f64, range_m: f64) -> Self {
        let (range_min_m, period_s, timeout_s) = (0.0, None, None);
        Self { beams, field_of_view_deg, range_m, range_min_m, period_s, timeout_s }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used, with the values that can.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        let Self { beams, field_of_view_deg, range_m, range_min_m, period_s, timeout_s } = *self;
        let checks = [
            ("beams", f64::from(beams), 1.0..=1e5, "a number from 1 to 100000"),
            (
                "field_of_view_deg",
                field_of_view_deg,
                f64::MIN_POSITIVE..=360.0,
                "an angle above 0 and up to 360",
            ),
            ("range_m", range_m, 1e-3..=1e4, "a length from 0.001 to 10000 m"),
            ("period_s", period_s.unwrap_or(1.0), 1e-3..=60.0, "a time from 0.001 to 60 s"),
            ("timeout_s", timeout_s.unwrap_or(1.0), 1e-3..=3600.0, "a time from 0.001 to 3600 s"),
        ];
        let unusable = checks.into_iter().find(|(_, value, usable, _)| !usable.contains(value));
        if let Some((field, value, _, expected)) = unusable {
            return Err(ConfigError::must_be(field, expected, value));
        }
        if (0.0..range_m).contains(&range_min_m) {
            return Ok(());
        }
        let expected = "a length from 0 to below sensor.range_m";
        Err(ConfigError::must_be("range_min_m", expected, range_min_m))
    }
}

impl Robot {
    /// Time from one scan to the next \[s\]: [`RangeSensor::period_s`], or the control cycle.
    pub fn scan_period_s(&self) -> f64 {
        self.sensor.period_s.unwrap_or(self.cycle_s)
    }

    /// Time for which the robot drives on without a scan that says anything \[s\]:
    /// [`RangeSensor::timeout_s`], or three periods, but at least 0.5 s.
    pub fn sensor_timeout_s(&self) -> f64 {
        const LEAST_S: f64 = 0.5;
        self.sensor.timeout_s.unwrap_or_else(|| (3.0 * self.scan_period_s()).max(LEAST_S))
    }

    /// As far as any part of the robot comes until it stands, when it drives ahead at full speed,
    /// goes on for two cycles, a delay and three periods of its sensor (so many scans may be lost),
    /// and then brakes \[m\].
    pub(crate) fn looks_ahead_m(&self) -> f64 {
        let reacts_s = self.actuation_delay_s + 2.0 * self.cycle_s + 3.0 * self.scan_period_s();
        self.footprint.circumscribed_radius_m()
            + self.limits.v_max_mps * reacts_s
            + self.limits.stop_m()
    }

    /// The fastest speed from which the robot still stops within its sensor's range \[m/s\]: from a
    /// scan that is as old as it may be, after another cycle and a delay, with its foremost point.
    /// It may be more than the robot drives; 0 where no speed is slow enough.
    ///
    /// From the speed v it needs v² / (2 b) + v t, with the deceleration b and the time t of those:
    /// of the scan's period, the delay, a cycle, and half of one in which it brakes less, as it
    /// brakes in whole cycles.
    pub fn sight_mps(&self) -> f64 {
        let react_s =
            self.scan_period_s().max(self.cycle_s) + self.actuation_delay_s + 1.5 * self.cycle_s;
        let free_m = self.sensor.range_m - self.footprint.foremost_m() - self.safety_margin_m();
        let lost_mps = self.limits.deceleration_mps2 * react_s;
        let square = lost_mps * lost_mps + 2.0 * self.limits.deceleration_mps2 * free_m.max(0.0);
        square.sqrt() - lost_mps
    }

    /// True if the sensor makes a scan in a cycle of this number: in the first one, and then once
    /// in every period.
    pub fn scans_in(&self, cycle: u64) -> bool {
        // A period that ends where a cycle begins has ended, rounded or not.
        let periods =
            |cycle: u64| (cycle as f64 * self.cycle_s / self.scan_period_s() + 1e-9).floor();
        cycle == 0 || periods(cycle) > periods(cycle - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_comes_once_in_every_period() {
        let mut robot = Robot::small();
        let scans =
            |robot: &Robot| (0..=12).filter(|&cycle| robot.scans_in(cycle)).collect::<Vec<_>>();
        assert_eq!(scans(&robot), (0..=12).collect::<Vec<_>>());
        robot.sensor.period_s = Some(0.05);
        assert_eq!(scans(&robot), (0..=12).collect::<Vec<_>>());
        robot.sensor.period_s = Some(0.3);
        assert_eq!(scans(&robot), [0, 3, 6, 9, 12]);
        robot.sensor.period_s = Some(0.25);
        assert_eq!(scans(&robot), [0, 3, 5, 8, 10]);
    }

    #[test]
    fn a_robot_waits_three_periods_for_a_scan_and_at_least_half_a_second() {
        let mut robot = Robot::small();
        assert_eq!((robot.scan_period_s(), robot.sensor_timeout_s()), (0.1, 0.5));
        robot.sensor.period_s = Some(1.0);
        assert_eq!((robot.scan_period_s(), robot.sensor_timeout_s()), (1.0, 3.0));
        robot.sensor.timeout_s = Some(0.2);
        assert_eq!(robot.sensor_timeout_s(), 0.2);
    }

    #[test]
    fn the_speed_of_sight_uses_up_the_range() {
        let mut robot = Robot::small();
        robot.limits.v_max_mps = 2.0;
        // 3.5 m - 0.18 m - 0.02 m = v² / (2 * 0.5) + v (0.1 + 0.15).
        let v = robot.sight_mps();
        assert!((v * v + 0.25 * v - 3.3).abs() < 1e-12, "{v}");
        // Until it stands it comes no farther, whole cycles included.
        let (mut at_m, mut now) = (2.0 * robot.cycle_s * v, v);
        while now > 0.0 {
            let slower =
                robot.limits.braked(crate::geometry::Velocity::new(now, 0.0), robot.cycle_s).v;
            at_m += 0.5 * (now + slower) * robot.cycle_s;
            now = slower;
        }
        assert!((3.2..=3.3).contains(&at_m), "{at_m}");
        robot.sensor.period_s = Some(1.0);
        assert!(robot.sight_mps() < v - 0.3);
        robot.sensor.range_m = 0.19;
        assert_eq!(robot.sight_mps(), 0.0);
    }

    #[test]
    fn bad_values_are_named() {
        let error = |set: fn(&mut RangeSensor)| {
            let mut robot = Robot::small();
            set(&mut robot.sensor);
            robot.validate().unwrap_err().to_string()
        };
        let text = error(|sensor| sensor.range_min_m = 3.5);
        assert_eq!(
            text,
            "sensor.range_min_m must be a length from 0 to below sensor.range_m, got 3.5"
        );
        assert!(error(|sensor| sensor.range_min_m = f64::NAN).contains("sensor.range_min_m"));
        assert!(error(|sensor| sensor.period_s = Some(0.0)).contains("sensor.period_s"));
        assert!(error(|sensor| sensor.timeout_s = Some(f64::NAN)).contains("sensor.timeout_s"));
    }
}
