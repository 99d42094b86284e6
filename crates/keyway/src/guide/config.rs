//! Registry of all guides by name; a new one is entered here.

use super::parameters::GuideParameters;
use super::{
    Carrot, CarrotConfig, GoalConfig, GoalGuide, Guide, KeyPoints, KeyPointsConfig, LocalGoals,
    LocalGoalsConfig,
};
use crate::ConfigError;
use crate::registry::registry;
use crate::robot::Robot;

registry! {
    /// A guide and its parameters, as data.
    GuideConfig by GuideParameters for Robot;
    /// Turning points of the smoothed route, one after the other.
    KeyPoints(KeyPointsConfig) => KeyPoints;
    /// Point of the route a look-ahead distance ahead.
    Carrot(CarrotConfig) => Carrot;
    /// Points of the smoothed route at a fixed spacing, one after the other.
    LocalGoals(LocalGoalsConfig) => LocalGoals;
    /// End of the route, from the beginning on.
    Goal(GoalConfig) => GoalGuide;
}

impl GuideConfig {
    /// Builds the guide.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a parameter cannot be used; the error names it.
    pub fn build(&self) -> Result<Box<dyn Guide + Send + Sync>, ConfigError> {
        self.parameters().build()
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
