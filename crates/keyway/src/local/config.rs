//! All local planners by name: the one place where a new one is entered.

use super::{Dwa, DwaConfig, Follower, FollowerConfig, LocalPlanner};
use crate::ConfigError;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// A local planner and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum LocalConfig {
    /// The classic dynamic window approach.
    Dwa(DwaConfig),
    /// Pure pursuit: drives along the route and avoids nothing.
    Follower(FollowerConfig),
}

impl LocalConfig {
    /// Names of all local planners, for [`Self::by_name`].
    pub const NAMES: [&'static str; 2] = [Dwa::NAME, Follower::NAME];

    /// A local planner with the parameters for a robot.
    pub fn by_name(name: &str, robot: &Robot) -> Option<Self> {
        match name {
            Dwa::NAME => Some(Self::Dwa(DwaConfig::for_robot(robot))),
            Follower::NAME => Some(Self::Follower(FollowerConfig::for_robot(robot))),
            _ => None,
        }
    }

    /// The local planner's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Dwa(_) => Dwa::NAME,
            Self::Follower(_) => Follower::NAME,
        }
    }

    /// The local planner for a robot.
    ///
    /// # Errors
    /// When a value of the robot or the config cannot be used; the error names it.
    pub fn build(&self, robot: &Robot) -> Result<Box<dyn LocalPlanner + Send + Sync>, ConfigError> {
        Ok(match self {
            Self::Dwa(config) => Box::new(Dwa::new(config.clone(), robot.clone())?),
            Self::Follower(config) => Box::new(Follower::new(config.clone(), robot.clone())?),
        })
    }

    /// The parameters as the local planner's paper has them; `None` for those without such a paper.
    pub const fn as_published(&self) -> Option<Self> {
        match self {
            Self::Dwa(_) => Some(Self::Dwa(DwaConfig::PAPER)),
            Self::Follower(_) => None,
        }
    }

    /// The fields of [`Self::as_published`] of which the paper gives no value: they are readings.
    pub const fn readings(&self) -> &'static [&'static str] {
        match self {
            Self::Dwa(_) => DwaConfig::READINGS,
            Self::Follower(_) => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_data() {
        let robot = Robot::small();
        for name in LocalConfig::NAMES {
            let config = LocalConfig::by_name(name, &robot).unwrap();
            assert_eq!((config.name(), config.build(&robot).is_ok()), (name, true));
            assert_eq!(serde_json::to_value(&config).unwrap()["name"], name);
        }
        assert_eq!(LocalConfig::by_name("none", &robot), None);
        let bad = LocalConfig::Follower(FollowerConfig { look_ahead_m: 0.0 });
        assert_eq!(bad.build(&robot).unwrap_err().path, "look_ahead_m");
        let mut no_robot = Robot::small();
        no_robot.cycle_s = -1.0;
        let good = LocalConfig::by_name("dwa", &robot).unwrap();
        assert_eq!(good.build(&no_robot).unwrap_err().path, "robot.cycle_s");
    }
}
