//! All guides by name: the one place where a new one is entered.

use super::{Carrot, CarrotConfig, Guide, KeyPoints, KeyPointsConfig};
use crate::ConfigError;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// A guide and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum GuideConfig {
    /// The turning points of the smoothed route, one after the other.
    KeyPoints(KeyPointsConfig),
    /// The point of the route a look-ahead distance farther on.
    Carrot(CarrotConfig),
}

impl GuideConfig {
    /// Names of all guides, for [`Self::by_name`].
    pub const NAMES: [&'static str; 2] = [KeyPoints::NAME, Carrot::NAME];

    /// A guide with the parameters for a robot.
    pub fn by_name(name: &str, robot: &Robot) -> Option<Self> {
        match name {
            KeyPoints::NAME => Some(Self::KeyPoints(KeyPointsConfig::for_robot(robot))),
            Carrot::NAME => Some(Self::Carrot(CarrotConfig::for_robot(robot))),
            _ => None,
        }
    }

    /// The guide's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::KeyPoints(_) => KeyPoints::NAME,
            Self::Carrot(_) => Carrot::NAME,
        }
    }

    /// The guide.
    ///
    /// # Errors
    /// When a parameter cannot be used, which the error names.
    pub fn build(&self) -> Result<Box<dyn Guide + Send + Sync>, ConfigError> {
        Ok(match self {
            Self::KeyPoints(config) => Box::new(KeyPoints::new(config.clone())?),
            Self::Carrot(config) => Box::new(Carrot::new(config.clone())?),
        })
    }

    /// The parameters as the guide's paper has them; `None` for those without such a paper.
    pub const fn as_published(&self) -> Option<Self> {
        match self {
            Self::KeyPoints(_) => Some(Self::KeyPoints(KeyPointsConfig::PAPER)),
            Self::Carrot(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_data() {
        let robot = Robot::small();
        for name in GuideConfig::NAMES {
            let config = GuideConfig::by_name(name, &robot).unwrap();
            assert_eq!((config.name(), config.build().is_ok()), (name, true));
            assert_eq!(serde_json::to_value(&config).unwrap()["name"], name);
        }
        assert_eq!(GuideConfig::by_name("none", &robot), None);
        for value in [0.0, f64::NAN, f64::INFINITY] {
            let carrot = GuideConfig::Carrot(CarrotConfig { look_ahead_m: value });
            assert_eq!(carrot.build().unwrap_err().path, "look_ahead_m");
        }
    }
}
