//! The sensors of a robot.

use super::{Mount, Robot};
use crate::ConfigError;
use crate::geometry::{Point, wrap_angle};
use serde::{Deserialize, Serialize};

/// A planar range sensor (lidar).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RangeSensor {
    /// Mounting pose on the robot; by default at its centre of rotation, facing ahead.
    #[serde(default, skip_serializing_if = "Mount::is_centre")]
    pub mount: Mount,
    /// Number of beams, spread evenly over the field of view.
    pub beams: u32,
    /// Field of view, centred on `mount.yaw_deg` \[deg\]; 360 is all around. For more than 8 beams,
    /// it is at least 7.
    pub field_of_view_deg: f64,
    /// Range \[m\], from 0.001 to 1000.
    pub range_m: f64,
    /// Smallest valid range \[m\]: a shorter reading carries no information. From 0, the default,
    /// to below `range_m`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub range_min_m: f64,
    /// Scan period \[s\], from 0.001 to 60; by default the control cycle. The controller expects
    /// no scan in the cycles between two scans.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Time without a valid reading of any beam after which the sensor counts as silent \[s\],
    /// from 0.001 to 3600; by default three periods, but at least 0.5 s. The robot stops if all
    /// sensors are silent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timeout_s: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl RangeSensor {
    /// A sensor with this many beams over a field of view \[deg\] and this range \[m\]. It is
    /// mounted at the robot's centre of rotation, faces ahead, has no minimum range, and scans
    /// once in every control cycle.
    pub const fn new(beams: u32, field_of_view_deg: f64, range_m: f64) -> Self {
        let (range_min_m, period_s, timeout_s) = (0.0, None, None);
        let mount = Mount::CENTRE;
        Self { mount, beams, field_of_view_deg, range_m, range_min_m, period_s, timeout_s }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first invalid field, with the values that are valid.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        let Self { beams, field_of_view_deg, range_m, range_min_m, period_s, timeout_s, .. } =
            *self;
        self.mount.validate().map_err(|error| error.within("mount"))?;
        let checks = [
            ("beams", f64::from(beams), 1.0..=1e5, "a number from 1 to 100000"),
            (
                "field_of_view_deg",
                field_of_view_deg,
                f64::MIN_POSITIVE..=360.0,
                "an angle above 0 and up to 360",
            ),
            ("range_m", range_m, 1e-3..=1e3, "a length in metres, from 0.001 to 1000"),
            ("period_s", period_s.unwrap_or(1.0), 1e-3..=60.0, "a time from 0.001 to 60 s"),
            ("timeout_s", timeout_s.unwrap_or(1.0), 1e-3..=3600.0, "a time from 0.001 to 3600 s"),
        ];
        let unusable = checks.into_iter().find(|(_, value, usable, _)| !usable.contains(value));
        if let Some((field, value, _, expected)) = unusable {
            return Err(ConfigError::must_be(field, expected, value));
        }
        if beams > Self::FEW_BEAMS && field_of_view_deg < Self::NARROWEST_FIELD_DEG {
            let reason = format!(
                "is {field_of_view_deg} degrees for {beams} beams; is it in radians? {} beams or fewer may be as narrow",
                Self::FEW_BEAMS
            );
            return Err(ConfigError::new("field_of_view_deg", reason));
        }
        if (0.0..range_m).contains(&range_min_m) {
            return Ok(());
        }
        let expected = "a length from 0 to below `range_m`";
        Err(ConfigError::must_be("range_min_m", expected, range_min_m))
    }
}

impl RangeSensor {
    /// Number of beams of sensors that may have any field of view, such as sonars.
    const FEW_BEAMS: u32 = 8;
    /// Smallest field of view of other sensors \[deg\]: a full turn is 6.3 rad.
    const NARROWEST_FIELD_DEG: f64 = 7.0;

    /// Width of an object that must not be missed between two beams \[m\].
    pub const NARROWEST_M: f64 = 0.06;

    /// Distance up to which its beams miss no object as wide as [`Self::NARROWEST_M`] \[m\]: its
    /// range, or less if the beams are far apart.
    pub fn sees_everything_m(&self) -> f64 {
        // With 360 degrees, the gap between the last beam and the first is a gap like any other.
        let gaps =
            if self.field_of_view_deg >= 360.0 { self.beams } else { self.beams.saturating_sub(1) };
        let step_rad = self.field_of_view_deg.to_radians() / f64::from(gaps);
        self.range_m.min(Self::NARROWEST_M / step_rad)
    }

    /// Scan period \[s\] on a robot with this control cycle: [`Self::period_s`], or the cycle.
    pub fn period_in_s(&self, cycle_s: f64) -> f64 {
        self.period_s.unwrap_or(cycle_s)
    }

    /// Time without a valid reading after which the sensor counts as silent \[s\], on a robot with
    /// this control cycle: [`Self::timeout_s`], or three periods, but at least 0.5 s.
    pub fn timeout_in_s(&self, cycle_s: f64) -> f64 {
        const LEAST_S: f64 = 0.5;
        self.timeout_s.unwrap_or_else(|| (3.0 * self.period_in_s(cycle_s)).max(LEAST_S))
    }

    /// True if a point in the robot's frame lies in the field of view, at any distance.
    pub(crate) fn looks_at(&self, place: Point) -> bool {
        let mount = self.mount.pose();
        let bearing_rad = (place - mount.point()).heading() - mount.theta;
        self.field_of_view_deg >= 360.0
            || wrap_angle(bearing_rad).abs() <= 0.5 * self.field_of_view_deg.to_radians()
    }
}

impl Robot {
    /// Maximum number of sensors of a robot.
    pub const MOST_SENSORS: usize = 8;

    pub(super) fn validate_sensors(&self) -> Result<(), ConfigError> {
        if !(1..=Self::MOST_SENSORS).contains(&self.sensors.len()) {
            let reason = format!("must be one to eight sensors, got {}", self.sensors.len());
            return Err(ConfigError::new("sensors", reason));
        }
        // Far beyond any mast or boom: most likely not in metres.
        let farthest_m = 3.0 * self.footprint.circumscribed_radius_m() + 0.5;
        self.sensors.iter().enumerate().try_for_each(|(i, sensor)| {
            let name = format!("sensors[{i}]");
            sensor.validate().map_err(|error| error.within(&name))?;
            let away_m = sensor.mount.pose().point().distance(Point::default());
            if away_m <= farthest_m {
                return Ok(());
            }
            let reason = format!(
                "is {away_m} m away from the robot's centre of rotation, far outside its footprint; is it in metres?"
            );
            Err(ConfigError::new("mount", reason).within(&name))
        })
    }

    /// Longest scan period of the robot's sensors \[s\].
    pub fn scan_period_s(&self) -> f64 {
        let periods = self.sensors.iter().map(|sensor| sensor.period_in_s(self.cycle_s));
        periods.reduce(f64::max).unwrap_or(self.cycle_s)
    }

    /// True if the fields of view together cover all directions. Occlusion by the robot's own body
    /// is ignored.
    pub(crate) fn sees_all_around(&self) -> bool {
        let turn = |deg: f64| deg.rem_euclid(360.0);
        let starts =
            |sensor: &RangeSensor| turn(sensor.mount.yaw_deg - 0.5 * sensor.field_of_view_deg);
        // Every field of view ends inside another one.
        let goes_on = |end: &RangeSensor| {
            let end_deg = turn(starts(end) + end.field_of_view_deg);
            let covers = |other: &&RangeSensor| {
                !std::ptr::eq(*other, end)
                    && turn(end_deg - starts(other)) < other.field_of_view_deg
            };
            self.sensors.iter().any(|other| covers(&other))
        };
        let all_around = |sensor: &RangeSensor| sensor.field_of_view_deg >= 360.0;
        self.sensors.iter().any(all_around)
            || !self.sensors.is_empty() && self.sensors.iter().all(goes_on)
    }

    /// Distance from the centre of rotation up to which the sensors that face ahead miss nothing
    /// \[m\].
    fn sees_ahead_m(&self) -> f64 {
        let far = Point::new(1e6, 0.0);
        let ahead = self.sensors.iter().filter(|sensor| sensor.looks_at(far));
        ahead.map(|sensor| sensor.mount.x_m + sensor.sees_everything_m()).fold(0.0, f64::max)
    }

    /// Reach of any part of the robot until it stops \[m\]: it drives ahead at full speed,
    /// continues for a delay, two cycles, the smoothing lag and three scan periods (so many scans
    /// may be lost), and then brakes.
    pub(crate) fn looks_ahead_m(&self) -> f64 {
        let reacts_s = self.actuation_delay_s
            + 2.0 * self.cycle_s
            + 3.0 * self.scan_period_s()
            + self.smoothing_lag_s();
        self.footprint.circumscribed_radius_m()
            + self.limits.v_max_mps * reacts_s
            + self.limits.stop_m()
    }

    /// The largest speed from which the robot still stops within the range that its sensors
    /// certainly cover ([`RangeSensor::sees_everything_m`]) \[m/s\]. The foremost point counts,
    /// and braking begins as late as possible: after a scan period, another cycle and a delay. The
    /// speed may be larger than the robot's top speed; it is 0 if no speed is low enough.
    ///
    /// From the speed v the robot needs v² / (2 b) + v t, with the deceleration b and the reaction
    /// time t: the scan period, the delay, one cycle, half of another one, in which it brakes less
    /// because it brakes in whole cycles, and the time by which it lags behind its reference.
    pub fn sight_mps(&self) -> f64 {
        let react_s =
            self.scan_period_s().max(self.cycle_s) + self.actuation_delay_s + 1.5 * self.cycle_s;
        let react_s = react_s + self.smoothing_lag_s();
        let free_m =
            self.sees_ahead_m() - self.footprint.foremost_m() - self.safety_margin_or_default_m();
        let lost_mps = self.limits.deceleration_mps2 * react_s;
        let square = lost_mps * lost_mps + 2.0 * self.limits.deceleration_mps2 * free_m.max(0.0);
        square.sqrt() - lost_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_waits_three_periods_for_a_scan_and_at_least_half_a_second() {
        let mut robot = Robot::small();
        let timeout_s = |robot: &Robot| robot.sensors[0].timeout_in_s(robot.cycle_s);
        assert_eq!((robot.scan_period_s(), timeout_s(&robot)), (0.1, 0.5));
        robot.sensors[0].period_s = Some(1.0);
        assert_eq!((robot.scan_period_s(), timeout_s(&robot)), (1.0, 3.0));
        robot.sensors[0].timeout_s = Some(0.2);
        assert_eq!(timeout_s(&robot), 0.2);
    }

    #[test]
    fn ranges_in_millimetres_and_fields_of_view_in_radians_are_refused() {
        let error = |change: fn(&mut RangeSensor)| {
            let mut robot = Robot::small();
            change(&mut robot.sensors[0]);
            robot.validate().map_or_else(|error| error.to_string(), |()| String::new())
        };
        assert!(error(|sensor| sensor.range_m = 10_000.0).contains("in metres"));
        assert!(error(|sensor| sensor.field_of_view_deg = 4.19).contains("in radians"));
        let sonar = |sensor: &mut RangeSensor| (sensor.beams, sensor.field_of_view_deg) = (3, 4.19);
        assert_eq!(error(sonar), "");
    }

    #[test]
    fn a_mount_in_centimetres_is_refused() {
        let mounted = |x_m: f64| {
            let mut robot = Robot::jackal();
            robot.sensors[0].mount.x_m = x_m;
            robot.validate().map_err(|error| error.to_string())
        };
        assert_eq!(mounted(1.0), Ok(()), "on a boom");
        let error = mounted(12.0).unwrap_err();
        assert!(
            error.contains("sensors[0].mount") && error.contains("is it in metres?"),
            "{error}"
        );
    }

    #[test]
    fn the_speed_of_sight_uses_up_the_range() {
        let mut robot = Robot::small();
        robot.limits.v_max_mps = 2.0;
        robot.sensors[0].beams = 720;
        // 3.5 m - 0.18 m - 0.02 m = v² / (2 * 0.5) + v (0.1 + 0.15).
        let v = robot.sight_mps();
        assert!((v * v + 0.25 * v - 3.3).abs() < 1e-12, "{v}");
        // It drives no farther until it stops, whole cycles included.
        let (mut at_m, mut now) = (2.0 * robot.cycle_s * v, v);
        while now > 0.0 {
            let slower =
                robot.limits.braked(crate::geometry::Velocity::new(now, 0.0), robot.cycle_s).v;
            at_m += 0.5 * (now + slower) * robot.cycle_s;
            now = slower;
        }
        assert!((3.2..=3.3).contains(&at_m), "{at_m}");
        robot.sensors[0].period_s = Some(1.0);
        assert!(robot.sight_mps() < v - 0.3);
        robot.sensors[0].range_m = 0.19;
        assert_eq!(robot.sight_mps(), 0.0);
    }

    /// 36 beams are 6 cm apart at a distance of 0.344 m.
    #[test]
    fn few_beams_see_everything_near_the_robot_only() {
        let mut robot = Robot::small();
        assert_eq!(RangeSensor::new(720, 360.0, 5.0).sees_everything_m(), 5.0);
        robot.sensors = vec![RangeSensor::new(36, 360.0, 5.0)];
        let far_m = robot.sensors[0].sees_everything_m();
        assert!((far_m - 0.06 / 10f64.to_radians()).abs() < 1e-12);
        // The first and the last of few beams bound the field of view; a single beam covers no
        // width.
        let in_a_quarter = |beams| RangeSensor::new(beams, 90.0, 5.0).sees_everything_m();
        assert!((in_a_quarter(10) - far_m).abs() < 1e-12);
        assert_eq!([in_a_quarter(1), in_a_quarter(0)], [0.0, 0.0]);
        let v = robot.sight_mps();
        let (brakes_mps2, react_s) = (robot.limits.deceleration_mps2, 0.25);
        let needs_m = 0.5 * v * v / brakes_mps2 + v * react_s;
        assert!(
            (needs_m - (far_m - 0.18 - robot.safety_margin_or_default_m())).abs() < 1e-12,
            "{v}"
        );
    }

    #[test]
    fn bad_values_are_named() {
        let error = |set: fn(&mut RangeSensor)| {
            let mut robot = Robot::small();
            set(&mut robot.sensors[0]);
            robot.validate().unwrap_err().to_string()
        };
        let text = error(|sensor| sensor.range_min_m = 3.5);
        assert_eq!(
            text,
            "sensors[0].range_min_m must be a length from 0 to below `range_m`, got 3.5"
        );
        assert!(error(|sensor| sensor.range_min_m = f64::NAN).contains("sensors[0].range_min_m"));
        assert!(error(|sensor| sensor.period_s = Some(0.0)).contains("sensors[0].period_s"));
        assert!(error(|sensor| sensor.timeout_s = Some(f64::NAN)).contains("sensors[0].timeout_s"));
    }

    /// A sensor mounted at `mount`.
    fn mounted(mount: (f64, f64, f64), field_of_view_deg: f64) -> RangeSensor {
        let (x_m, y_m, yaw_deg) = mount;
        let mount = Mount { x_m, y_m, yaw_deg };
        RangeSensor { mount, ..RangeSensor::new(1080, field_of_view_deg, 5.0) }
    }

    #[test]
    fn sensors_look_from_where_they_are() {
        let robot = |sensors: Vec<RangeSensor>| Robot { sensors, ..Robot::jackal() };
        let corners =
            |deg| robot(vec![mounted((0.3, 0.2, 45.0), deg), mounted((-0.3, -0.2, -135.0), deg)]);
        assert!(corners(270.0).sees_all_around() && corners(180.1).sees_all_around());
        assert!(!corners(179.9).sees_all_around());
        let thirds =
            |deg| robot([0.0, 120.0, -120.0].map(|yaw| mounted((0.0, 0.0, yaw), deg)).to_vec());
        assert!(thirds(121.0).sees_all_around() && !thirds(119.0).sees_all_around());
        assert!(!Robot::jackal().sees_all_around() && Robot::small().sees_all_around());
        // Two sensors that face the same direction do not see behind the robot.
        let same = robot(vec![mounted((0.0, 0.0, 0.0), 270.0), mounted((0.1, 0.0, 0.0), 270.0)]);
        assert!(!same.sees_all_around());
        // A point beside the sensor, not beside the robot's centre.
        let corner = mounted((0.3, 0.2, 0.0), 180.0);
        assert!(
            corner.looks_at(Point::new(0.31, -0.2)) && !corner.looks_at(Point::new(0.29, -0.2))
        );
        // A sensor that faces backwards does not see ahead.
        let back = robot(vec![mounted((-0.3, 0.0, 180.0), 180.0)]);
        assert_eq!(back.sees_ahead_m(), 0.0);
        assert_eq!(corners(270.0).sees_ahead_m(), 5.3);
    }

    #[test]
    fn the_number_of_sensors_and_their_mounts_are_checked() {
        let error =
            |sensors| Robot { sensors, ..Robot::small() }.validate().unwrap_err().to_string();
        assert_eq!(error(vec![]), "sensors must be one to eight sensors, got 0");
        let nine = vec![RangeSensor::new(9, 90.0, 3.0); 9];
        assert_eq!(error(nine), "sensors must be one to eight sensors, got 9");
        let far = vec![RangeSensor::new(9, 90.0, 3.0), mounted((1001.0, 0.0, 0.0), 90.0)];
        let expected = "sensors[1].mount.x_m must be a length from -1000 to 1000 m, got 1001";
        assert_eq!(error(far), expected);
    }
}
