//! A robot file: a complete robot, or its differences from another one.

use super::{Assignment, Overlay, OverlayError};
use crate::ConfigError;
use crate::robot::{Footprint, Limits, RangeSensor, Robot};
use serde::Deserialize;
use thiserror::Error;

/// A robot as described by a file. Missing values are those of the robot it is `like`, or are
/// derived from its size and its top speed ([`Robot::derived`]).
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct RobotFile {
    /// Name of the bundled robot that it is based on.
    pub like: Option<String>,
    /// Radius of a round robot \[m\], instead of `footprint`.
    pub radius_m: Option<f64>,
    /// Largest forward speed \[m/s\], instead of `limits.v_max_mps`.
    pub v_max_mps: Option<f64>,
    /// The ground area that it covers.
    pub footprint: Option<Footprint>,
    /// Control cycle \[s\].
    pub cycle_s: Option<f64>,
    /// Time from a command to its effect \[s\].
    pub actuation_delay_s: Option<f64>,
    /// Distance kept from obstacles in addition to the footprint \[m\].
    pub safety_margin_m: Option<f64>,
    /// The velocity and acceleration limits that are known.
    pub limits: LimitsPart,
    /// The range sensors; they replace all others.
    pub sensors: Option<Vec<RangeSensor>>,
}

/// Some of the velocity and acceleration limits of a robot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct LimitsPart {
    /// See [`Limits::v_min_mps`].
    pub v_min_mps: Option<f64>,
    /// See [`Limits::v_max_mps`].
    pub v_max_mps: Option<f64>,
    /// See [`Limits::omega_max_radps`].
    pub omega_max_radps: Option<f64>,
    /// See [`Limits::min_turning_radius_m`].
    pub min_turning_radius_m: Option<f64>,
    /// See [`Limits::acceleration_mps2`].
    pub acceleration_mps2: Option<f64>,
    /// See [`Limits::deceleration_mps2`].
    pub deceleration_mps2: Option<f64>,
    /// See [`Limits::angular_acceleration_radps2`].
    pub angular_acceleration_radps2: Option<f64>,
    /// See [`Limits::angular_deceleration_radps2`].
    pub angular_deceleration_radps2: Option<f64>,
    /// See [`Limits::jerk_mps3`].
    pub jerk_mps3: Option<f64>,
    /// See [`Limits::angular_jerk_radps3`].
    pub angular_jerk_radps3: Option<f64>,
}

impl RobotFile {
    /// The robot, validated.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if there is no bundled robot of the name in `like`; if the size or
    /// the top speed is missing and `like` is, too; if one of them is given twice; or if a value
    /// is invalid.
    pub fn robot(self) -> Result<Robot, ConfigError> {
        let footprint = self.own_footprint()?;
        let v_max_mps =
            either(("v_max_mps", self.v_max_mps), ("limits.v_max_mps", self.limits.v_max_mps))?;
        let base = match &self.like {
            Some(name) => {
                let base = Robot::by_name(name).ok_or_else(|| no_such_robot(name))?;
                Robot { footprint: footprint.unwrap_or(base.footprint), ..base }
            }
            None => match (footprint, v_max_mps) {
                (Some(footprint), Some(v_max_mps)) => Robot::derived(footprint, v_max_mps),
                (None, None) => return Err(missing(&format!("{SIZE}, and {SPEED}"))),
                (None, Some(_)) => return Err(missing(SIZE)),
                (Some(_), None) => return Err(missing(SPEED)),
            },
        };
        let v_max_mps = v_max_mps.unwrap_or(base.limits.v_max_mps);
        let limits = Limits { v_max_mps, ..self.limits.over(&base.limits) };
        let robot = Robot {
            footprint: base.footprint,
            cycle_s: self.cycle_s.unwrap_or(base.cycle_s),
            actuation_delay_s: self.actuation_delay_s.unwrap_or(base.actuation_delay_s),
            safety_margin_m: self.safety_margin_m.or(base.safety_margin_m),
            limits,
            sensors: self.sensors.unwrap_or(base.sensors),
        };
        robot.validate()?;
        Ok(robot)
    }

    fn own_footprint(&self) -> Result<Option<Footprint>, ConfigError> {
        let disc = |radius_m: f64| {
            let disc = Footprint::circle(radius_m);
            disc.map_err(|error| ConfigError::new("radius_m", error.to_string()))
        };
        let round = self.radius_m.map(disc).transpose()?;
        either(("radius_m", round), ("footprint", self.footprint.clone()))
    }
}

impl LimitsPart {
    /// These limits over those of a base, except for the top speed.
    fn over(&self, base: &Limits) -> Limits {
        Limits {
            v_min_mps: self.v_min_mps.unwrap_or(base.v_min_mps),
            omega_max_radps: self.omega_max_radps.unwrap_or(base.omega_max_radps),
            min_turning_radius_m: self.min_turning_radius_m.unwrap_or(base.min_turning_radius_m),
            acceleration_mps2: self.acceleration_mps2.unwrap_or(base.acceleration_mps2),
            deceleration_mps2: braking(
                self.deceleration_mps2,
                self.acceleration_mps2,
                base.deceleration_mps2,
            ),
            angular_acceleration_radps2: self
                .angular_acceleration_radps2
                .unwrap_or(base.angular_acceleration_radps2),
            angular_deceleration_radps2: braking(
                self.angular_deceleration_radps2,
                self.angular_acceleration_radps2,
                base.angular_deceleration_radps2,
            ),
            jerk_mps3: self.jerk_mps3.or(base.jerk_mps3),
            angular_jerk_radps3: self.angular_jerk_radps3.or(base.angular_jerk_radps3),
            ..base.clone()
        }
    }
}

/// The deceleration, or that of the base if it is missing, but then no more than a given
/// acceleration: a robot that is weaker than its base does not brake as hard either.
fn braking(deceleration: Option<f64>, acceleration: Option<f64>, of_base: f64) -> f64 {
    deceleration.unwrap_or_else(|| acceleration.map_or(of_base, |given| given.min(of_base)))
}

/// A robot with some of its values changed, each by its path in a robot file, such as
/// `limits.v_max_mps`.
///
/// # Errors
/// Names the value that does not exist, or that is invalid.
pub fn robot_with(robot: &Robot, changes: &[Assignment]) -> Result<Robot, RobotChangeError> {
    let no_parts = |_: &str, _: &str| Err(Vec::new());
    let mut overlay = Overlay::of(robot, &no_parts)?;
    for Assignment { path, value } in changes {
        overlay.set(path, value.clone())?;
    }
    let robot = overlay.finish()?;
    robot.validate()?;
    Ok(robot)
}

/// A change of a robot that cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotChangeError {
    /// No such field, or a value of another type.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// An invalid value for a robot.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

const SIZE: &str = "`footprint`, or the `radius_m` of a round robot";
const SPEED: &str = "`v_max_mps`, the top speed";

/// The given one of two alternative fields for the same value.
fn either<T>(
    (short, one): (&str, Option<T>),
    (long, other): (&str, Option<T>),
) -> Result<Option<T>, ConfigError> {
    if one.is_some() && other.is_some() {
        let reason = format!("is the same value as `{long}`; give only one of them");
        return Err(ConfigError::new(short, reason));
    }
    Ok(one.or(other))
}

fn no_such_robot(name: &str) -> ConfigError {
    let names = Robot::NAMES.join(", ");
    ConfigError::new("like", format!("must be a bundled robot ({names}), got `{name}`"))
}

fn missing(what: &str) -> ConfigError {
    let reason = format!("needs {what}; or start with `like = \"small\"` and list the differences");
    ConfigError::new("the robot", reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::from_toml;

    fn robot(text: &str) -> Result<Robot, String> {
        let file: RobotFile = from_toml(text).map_err(|error| error.to_string())?;
        file.robot().map_err(|error| error.to_string())
    }

    #[test]
    fn a_weaker_robot_does_not_brake_harder_than_it_accelerates() {
        let of = |text: &str| {
            let limits = robot(&format!("like = \"small\"\n[limits]\n{text}")).unwrap().limits;
            [limits.deceleration_mps2, limits.angular_deceleration_radps2]
        };
        let small = Robot::small().limits;
        let [usual, angular] = [small.deceleration_mps2, small.angular_deceleration_radps2];
        assert_eq!(of("acceleration_mps2 = 0.1"), [0.1, angular]);
        assert_eq!(of("angular_acceleration_radps2 = 0.2"), [usual, 0.2]);
        assert_eq!(of("acceleration_mps2 = 99"), [usual, angular]);
        assert_eq!(of("acceleration_mps2 = 0.1\ndeceleration_mps2 = 2"), [2.0, angular]);
    }

    #[test]
    fn size_and_speed_are_enough() {
        let derived = Robot::derived(Footprint::circle(0.3).unwrap(), 0.7);
        assert_eq!(robot("radius_m = 0.3\nv_max_mps = 0.7"), Ok(derived.clone()));
        assert_eq!(robot("footprint = { radius_m = 0.3 }\nlimits.v_max_mps = 0.7"), Ok(derived));
        let more = robot("radius_m = 0.3\nv_max_mps = 0.7\nlimits.omega_max_radps = 1").unwrap();
        assert_eq!((more.limits.omega_max_radps, more.limits.v_max_mps), (1.0, 0.7));
    }

    #[test]
    fn what_differs_from_another_is_enough() {
        let slow = robot("like = \"jackal\"\nlimits = { v_max_mps = 0.5 }").unwrap();
        let jackal = Robot::jackal();
        let limits = Limits { v_max_mps: 0.5, ..jackal.limits.clone() };
        assert_eq!(slow, Robot { limits, ..jackal.clone() });
        let round = robot("like = \"jackal\"\nradius_m = 0.4\ncycle_s = 0.1").unwrap();
        let footprint = Footprint::circle(0.4).unwrap();
        assert_eq!(round, Robot { footprint, cycle_s: 0.1, ..jackal.clone() });
        let sensors = "[[sensors]]\nbeams = 9\nfield_of_view_deg = 90\nrange_m = 3\n";
        let seeing = robot(&format!("like = \"jackal\"\n{sensors}")).unwrap();
        assert_eq!(seeing, Robot { sensors: vec![RangeSensor::new(9, 90.0, 3.0)], ..jackal });
    }

    /// A robot that is written to a file is read back unchanged.
    #[test]
    fn a_whole_robot_is_itself() {
        for name in Robot::NAMES {
            let whole = Robot::by_name(name).unwrap();
            assert_eq!(robot(&toml::to_string(&whole).unwrap()), Ok(whole), "{name}");
        }
    }

    #[test]
    fn errors_say_what_is_missing_or_given_twice() {
        let error = |text: &str| robot(text).unwrap_err();
        assert_eq!(
            error("v_max_mps = 1"),
            "the robot needs `footprint`, or the `radius_m` of a round robot; or start with `like = \
             \"small\"` and list the differences"
        );
        assert!(error("cycle_s = 1").contains("of a round robot, and `v_max_mps`, the top speed;"));
        assert!(error("radius_m = 1").starts_with("the robot needs `v_max_mps`, the top speed;"));
        assert_eq!(
            error("radius_m = 1\nv_max_mps = 1\nlimits.v_max_mps = 1"),
            "v_max_mps is the same value as `limits.v_max_mps`; give only one of them"
        );
        assert_eq!(
            error("radius_m = 1\nfootprint = { radius_m = 1 }"),
            "radius_m is the same value as `footprint`; give only one of them"
        );
        let other = error("like = \"jackel\"");
        assert!(other.starts_with("like must be a bundled robot (small, "), "{other}");
        assert!(other.ends_with(", got `jackel`"), "{other}");
        assert!(error("radius_m = -1\nv_max_mps = 1").starts_with("radius_m "));
        assert!(error("radius_m = 1\nv_max_mps = 1000").starts_with("limits.v_max_mps must be"));
        assert!(error("radius_m = 1\nv_max = 1").contains("unknown field `v_max`"));
    }

    #[test]
    fn values_are_changed_by_their_paths() {
        let change = |text: &str| robot_with(&Robot::small(), &[text.parse().unwrap()]);
        let slow = change("limits.v_max_mps=0.3").unwrap();
        assert_eq!(slow.limits.v_max_mps, 0.3);
        assert_eq!(change("safety_margin_m=0.1").unwrap().safety_margin_m, Some(0.1));
        let near = change("sensors[0].range_m=2").unwrap();
        assert_eq!(near.sensors, [RangeSensor::new(360, 360.0, 2.0)]);
        let ahead = change("sensors[0].mount.x_m=0.1").unwrap();
        assert_eq!((ahead.sensors[0].mount.x_m, ahead.sensors[0].period_s), (0.1, None));
        assert_eq!(change("sensors[0].period_s=0.2").unwrap().sensors[0].period_s, Some(0.2));
        let error = |text: &str| change(text).unwrap_err().to_string();
        assert!(error("limits.v_max=0.3").contains("there is no field `limits.v_max`"));
        assert!(error("limits.v_max_mps=fast").contains("`limits.v_max_mps`: "));
        assert_eq!(
            error("sensors[1].range_m=2"),
            "`sensors[1]`: the list has 1 items, numbered from 0"
        );
        assert!(
            error("sensors.range_m=2").contains("is a list; give an index, such as `sensors[0]`")
        );
        assert!(error("sensors[0].range=2").contains("there is no field `sensors[0].range`"));
        assert!(error("sensors[0].range_m=0").starts_with("sensors[0].range_m must be a length"));
        assert!(error("limits[0].v_max_mps=1").contains("`limits[0]`: is not a list"));
        assert!(error("cycle_s=0").starts_with("cycle_s must be a time"), "{}", error("cycle_s=0"));
    }
}
