//! Parameters of the space-time planner.

use crate::ConfigError;
use crate::local::Course;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

const MOST_STRETCHES: u32 = Course::MOST_STRETCHES as u32;

/// Parameters of [`SpaceTime`](super::SpaceTime).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpaceTimeConfig {
    /// H: planning horizon of a trajectory \[s\]; at least a cycle for each stretch.
    pub horizon_s: f64,
    /// K: number of stretches of a trajectory, from 1 to 32.
    pub stretches: u32,
    /// W: number of most promising trajectories that are extended from stretch to stretch if
    /// something moves, from 1 to 1000; half as many if nothing does.
    pub width: u32,
    /// m: preferred clearance around the footprint \[m\]; positive.
    pub comfortable_m: f64,
    /// q: penalty of low clearance. At a fifth of the preferred clearance, a metre counts as 0.64
    /// q more, close to contact as 9 q more; a tight clearance at the present pose is not
    /// penalized.
    pub discomfort: f64,
    /// u: additional cost of a second in which the velocity changes as fast as it can.
    pub steering: f64,
    /// j: cost of a change of the acceleration from that of the last trajectory, in stretches for
    /// a change by the whole limit; defaults to 0 in stack files without it.
    #[serde(default)]
    pub jerk: f64,
    /// n: preferred clearance from moving obstacles \[m\]; positive.
    pub mover_room_m: f64,
    /// p: additional cost of a second in contact with a moving obstacle.
    pub contact: f64,
    /// a: standard deviation of the acceleration of moving obstacles \[m/s²\].
    pub mover_acceleration_mps2: f64,
    /// True if trajectories may lead backwards, if the robot can, over observed ground.
    pub backwards: bool,
}

impl SpaceTimeConfig {
    /// Derived from the robot, one rule for all maps:
    ///
    /// - `horizon_s`: a cycle and three times the time to stop;
    /// - `stretches`: 6, or more if needed for stretches of at most a second, up to 32: with
    ///   longer ones the robot gives way too late;
    /// - `comfortable_m`: the distance driven in four cycles at full speed, but at least the
    ///   inscribed radius;
    /// - `mover_room_m`: the distance driven in two cycles, but at least the inscribed radius, as
    ///   estimates of moving obstacles are rough;
    /// - `mover_acceleration_mps2`: the value of the tracker's filter
    ///   ([`TrackerConfig::acceleration_mps2`](crate::sense::TrackerConfig), two standard
    ///   deviations).
    pub fn for_robot(robot: &Robot) -> Self {
        let limits = &robot.limits;
        let inscribed_m = robot.footprint.inscribed_radius_m();
        let two_cycles_m = 2.0 * limits.v_max_mps * robot.cycle_s;
        let horizon_s = robot.cycle_s + 3.0 * limits.stop_s();
        let most_s = robot.cycle_s.max(1.0);
        let stretches = (horizon_s / most_s).ceil().clamp(6.0, f64::from(MOST_STRETCHES)) as u32;
        Self {
            // Rounding must not make a stretch shorter than a cycle.
            horizon_s: horizon_s.max(1.000_001 * f64::from(stretches) * robot.cycle_s),
            stretches,
            width: 24,
            comfortable_m: (2.0 * two_cycles_m).max(inscribed_m),
            discomfort: 0.5,
            steering: 0.03,
            jerk: 0.0,
            mover_room_m: two_cycles_m.max(inscribed_m),
            contact: 30.0,
            mover_acceleration_mps2: 1.0,
            backwards: true,
        }
    }

    /// The duration of a stretch \[s\].
    pub(super) fn stretch_s(&self) -> f64 {
        self.horizon_s / f64::from(self.stretches)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let positive = [
            ("horizon_s", self.horizon_s),
            ("comfortable_m", self.comfortable_m),
            ("mover_room_m", self.mover_room_m),
        ];
        let mut positive = positive.into_iter();
        positive.try_for_each(|(field, value)| ConfigError::unless_positive(field, value))?;
        let weights = [
            ("discomfort", self.discomfort),
            ("steering", self.steering),
            ("jerk", self.jerk),
            ("contact", self.contact),
        ];
        let mut weights = weights.into_iter();
        weights.try_for_each(|(field, value)| ConfigError::unless_weight(field, value))?;
        let acceleration_mps2 = self.mover_acceleration_mps2;
        ConfigError::unless_not_negative("mover_acceleration_mps2", acceleration_mps2)?;
        let counts = [("stretches", self.stretches, MOST_STRETCHES), ("width", self.width, 1000)];
        for (field, count, most) in counts {
            if !(1..=most).contains(&count) {
                let expected = format!("a whole number from 1 to {most}");
                return Err(ConfigError::must_be(field, &expected, f64::from(count)));
            }
        }
        Ok(())
    }

    /// Checks that the parameters fit a robot.
    pub(super) fn check(&self, robot: &Robot) -> Result<(), ConfigError> {
        self.validate()?;
        let (least_s, most_s) =
            (f64::from(self.stretches) * robot.cycle_s, Self::LONGEST_HORIZON_S);
        if self.stretch_s() < robot.cycle_s || self.horizon_s > most_s {
            let expected = format!("from {least_s}, a cycle for each stretch, to {most_s}");
            return Err(ConfigError::must_be("horizon_s", &expected, self.horizon_s));
        }
        Ok(())
    }

    /// Upper limit of the horizon: no robot needs more than a minute to stop \[s\].
    const LONGEST_HORIZON_S: f64 = 1000.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derived_parameters_by_hand() {
        let small = SpaceTimeConfig::for_robot(&Robot::small());
        assert!((small.horizon_s - 3.1).abs() < 1e-12);
        assert!((small.comfortable_m - 0.2).abs() < 1e-12);
        assert!((small.mover_room_m - 0.18).abs() < 1e-12);
        let jackal = SpaceTimeConfig::for_robot(&Robot::jackal());
        assert!((jackal.horizon_s - 2.05).abs() < 1e-12);
        // It needs 5 s to stop.
        let paper = SpaceTimeConfig::for_robot(&Robot::paper());
        assert!((paper.horizon_s - 15.1).abs() < 1e-12);
        assert_eq!([small, jackal.clone(), paper].map(|config| config.stretches), [6, 6, 16]);
        assert!((jackal.comfortable_m - 0.4).abs() < 1e-12);
        for name in Robot::NAMES {
            let robot = Robot::by_name(name).unwrap();
            assert_eq!(SpaceTimeConfig::for_robot(&robot).check(&robot), Ok(()), "{name}");
        }
        // A robot that stops at once gets a command once per cycle.
        let mut quick = Robot::small();
        (quick.limits.deceleration_mps2, quick.limits.angular_deceleration_radps2) = (1e3, 1e3);
        assert_eq!(SpaceTimeConfig::for_robot(&quick).check(&quick), Ok(()));
    }

    #[test]
    fn a_bad_value_is_named() {
        let robot = Robot::small();
        let good = SpaceTimeConfig::for_robot(&robot);
        let path = |config: SpaceTimeConfig| config.check(&robot).unwrap_err().path;
        assert_eq!(path(SpaceTimeConfig { horizon_s: f64::NAN, ..good.clone() }), "horizon_s");
        assert_eq!(path(SpaceTimeConfig { horizon_s: 0.5, ..good.clone() }), "horizon_s");
        assert_eq!(path(SpaceTimeConfig { horizon_s: 1e9, ..good.clone() }), "horizon_s");
        assert_eq!(path(SpaceTimeConfig { stretches: 0, ..good.clone() }), "stretches");
        assert_eq!(path(SpaceTimeConfig { width: 1001, ..good.clone() }), "width");
        assert_eq!(path(SpaceTimeConfig { comfortable_m: 0.0, ..good.clone() }), "comfortable_m");
        assert_eq!(path(SpaceTimeConfig { discomfort: -1.0, ..good.clone() }), "discomfort");
        let negative = SpaceTimeConfig { mover_acceleration_mps2: -1.0, ..good };
        assert_eq!(path(negative), "mover_acceleration_mps2");
    }
}
