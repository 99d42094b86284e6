//! All local planners by name: the only place at which a new one is registered.

use super::parameters::LocalParameters;
use super::{
    AdaptiveDwa, AdaptiveDwaConfig, Dwa, DwaConfig, Follower, FollowerConfig, GuidedDwa,
    GuidedDwaConfig, KeyPointDwa, KeyPointDwaConfig, LocalPlanner, SpaceTime, SpaceTimeConfig,
};
use crate::ConfigError;
use crate::registry::registry;
use crate::robot::Robot;
use std::sync::Arc;

registry! {
    /// A local planner and its parameters, as data.
    LocalConfig by LocalParameters for Robot;
    /// The classic dynamic window approach.
    Dwa(DwaConfig) => Dwa;
    /// Dynamic window approach towards key points; the weight of speed falls with the number of
    /// obstacles ahead.
    KeyPointDwa(KeyPointDwaConfig) => KeyPointDwa;
    /// Dynamic window approach whose weights depend on the distance at a trajectory's end.
    AdaptiveDwa(AdaptiveDwaConfig) => AdaptiveDwa;
    /// Follows the route, and avoids unknown obstacles by guide points and a dynamic window
    /// approach.
    GuidedDwa(GuidedDwaConfig) => GuidedDwa;
    /// Searches for the space-time trajectory that ends soonest.
    SpaceTime(SpaceTimeConfig) => SpaceTime;
    /// Pure pursuit: drives along the route and avoids nothing.
    Follower(FollowerConfig) => Follower;
}

impl LocalConfig {
    /// Builds the local planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid; the error
    /// names it.
    pub fn build(&self, robot: &Robot) -> Result<Box<dyn LocalPlanner + Send + Sync>, ConfigError> {
        self.build_for(&Arc::new(robot.clone()))
    }

    /// The same for a shared robot.
    pub(crate) fn build_for(
        &self,
        robot: &Arc<Robot>,
    ) -> Result<Box<dyn LocalPlanner + Send + Sync>, ConfigError> {
        self.parameters().build(robot)
    }

    /// True if the planner uses the observed space ahead.
    pub(crate) fn stops_within_sight(&self) -> bool {
        self.parameters().stops_within_sight()
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
