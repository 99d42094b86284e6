//! The parameters declared to other nodes, and those that may change at run time.

use super::Settings;
use toml::Value;

/// A parameter set by another node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    name: String,
    number: f64,
}

impl Change {
    /// Checks a change; an error has the reason for its refusal.
    pub(crate) fn of(name: &str, value: &Value) -> Result<Self, String> {
        let number = super::number(value).ok_or_else(|| format!("must be a number, got {value}"));
        match name {
            "max_pose_age" if !number.as_ref().is_ok_and(super::is_pose_age) => {
                Err(format!("must be {}, got {value}", super::MAX_POSE_AGE))
            }
            "max_pose_age" | "obstacle_max_range" => {
                let number = number?;
                if number <= 0.0 {
                    return Err(format!("must be a positive number, got {number}"));
                }
                Ok(Self { name: name.to_owned(), number })
            }
            "min_obstacle_height" | "max_obstacle_height" => {
                Ok(Self { name: name.to_owned(), number: number? })
            }
            _ => Err("can only be set at the start".to_owned()),
        }
    }
}

impl Settings {
    /// All parameters with their values.
    pub(crate) fn declared(&self) -> Vec<(&'static str, Value)> {
        let texts = |texts: &[String]| texts.iter().cloned().map(Value::String).collect();
        let heights_m = &self.points_taken.heights_m;
        vec![
            ("robot", Value::String(self.robot_name.clone())),
            ("stack", Value::String(self.stack_name.clone())),
            ("safe", Value::Boolean(self.stack.stack().controller.safe.is_some())),
            ("use_sim_time", Value::Boolean(self.use_sim_time)),
            ("controller_frequency", Value::Float(1.0 / self.stack.robot().cycle_s)),
            ("global_frame", Value::String(self.frames.map.clone())),
            ("robot_base_frame", Value::String(self.frames.base.clone())),
            ("scan_topics", Value::Array(texts(&self.scan_topics))),
            ("cloud_topics", Value::Array(texts(&self.cloud_topics))),
            ("min_obstacle_height", Value::Float(*heights_m.start())),
            ("max_obstacle_height", Value::Float(*heights_m.end())),
            ("obstacle_max_range", Value::Float(self.points_taken.range_m)),
            ("cloud_timeout", Value::Float(self.points_taken.timeout_s)),
            ("filter_info_topics", Value::Array(texts(&self.filter_info_topics))),
            ("odom_topic", Value::String(self.odom_topic.clone())),
            ("distribution", Value::String(self.distribution.name().to_owned())),
            ("enable_stamped_cmd_vel", Value::Boolean(self.is_cmd_vel_stamped)),
            ("stands_for", Value::Array(texts(&self.stands_for))),
            ("max_pose_age", Value::Float(self.max_pose_age_s)),
        ]
    }

    /// Applies a change.
    pub(crate) fn change(&mut self, change: &Change) {
        let taken = &mut self.points_taken;
        let (lowest_m, highest_m) = taken.heights_m.clone().into_inner();
        match change.name.as_str() {
            "max_pose_age" => self.max_pose_age_s = change.number,
            "obstacle_max_range" => taken.range_m = change.number,
            // A bound that passes the other one moves it as well.
            "min_obstacle_height" => {
                taken.heights_m = change.number..=highest_m.max(change.number);
            }
            "max_obstacle_height" => {
                taken.heights_m = lowest_m.min(change.number)..=change.number;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Arguments;
    use crate::settings::PARAMETERS;

    fn settings() -> Settings {
        let parameters = vec![("robot".to_owned(), "jackal".to_owned())];
        Settings::of(&Arguments { parameters, ..Arguments::default() }, None).unwrap()
    }

    #[test]
    fn all_are_declared() {
        let settings = settings();
        let declared = settings.declared();
        let names = PARAMETERS.iter().map(|(name, _)| *name);
        assert_eq!(
            declared.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
            names.collect::<Vec<_>>()
        );
        assert_eq!(declared[0].1.as_str(), Some("jackal"));
        let is_safe = |settings: &Settings| settings.declared()[2].1.as_bool();
        assert_eq!(is_safe(&settings), Some(false));
        let parameters = [("robot", "jackal"), ("safe", "true")];
        let parameters = parameters.map(|(name, value)| (name.to_owned(), value.to_owned()));
        let safe = Arguments { parameters: parameters.into(), ..Arguments::default() };
        assert_eq!(is_safe(&Settings::of(&safe, None).unwrap()), Some(true));
    }

    #[test]
    fn some_may_be_changed() {
        let mut settings = settings();
        for (name, value) in
            [("max_pose_age", 0.4), ("max_obstacle_height", 1.1), ("min_obstacle_height", 0.2)]
        {
            settings.change(&Change::of(name, &Value::Float(value)).unwrap());
            let declared = settings.declared();
            let (_, now) = declared.iter().find(|(declared, _)| *declared == name).unwrap();
            assert_eq!(now.as_float(), Some(value));
        }
        for (name, value, why) in [
            ("robot", Value::String("small".to_owned()), "at the start"),
            ("max_pose_age", Value::Float(-1.0), "positive"),
            ("max_pose_age", Value::Float(1e300), "at most 5"),
            ("obstacle_max_range", Value::Boolean(true), "a number"),
        ] {
            assert!(Change::of(name, &value).unwrap_err().contains(why));
        }
    }
}
