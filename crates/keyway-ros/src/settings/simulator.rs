//! Parameters of the simulator.

use super::{Given, distribution_of};
use crate::arguments::Arguments;
use crate::error::StartError;
use crate::served::Distribution;

/// All settings at the start of the simulator.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SimulatorSettings {
    /// Factor of the simulation speed relative to real time.
    pub(crate) rate: f64,
    /// Stamps start at 0; otherwise they are system time.
    pub(crate) use_sim_time: bool,
    /// True if commands are stamped.
    pub(crate) is_cmd_vel_stamped: bool,
}

/// Parameters and their descriptions; defaults are set in [`SimulatorSettings::of`].
pub(super) const PARAMETERS: [(&str, &str); 4] = [
    ("rate", "simulation speed relative to real time; 1"),
    ("use_sim_time", "stamps begin at 0, and /clock is published; false"),
    ("distribution", "ROS distribution of the messages: jazzy or kilted; ROS_DISTRO, or kilted"),
    ("enable_stamped_cmd_vel", "commands as TwistStamped; true, except for jazzy"),
];

impl SimulatorSettings {
    /// Derives the settings from the arguments and `ROS_DISTRO`.
    pub(crate) fn of(arguments: &Arguments, distro: Option<&str>) -> Result<Self, StartError> {
        let mut given = Given::read(arguments)?;
        let distribution = distribution_of(&mut given, distro)?;
        let use_sim_time = given.truth("use_sim_time")?.unwrap_or(false);
        let is_rate = |rate: &f64| (0.01..=100.0).contains(rate);
        let rate = given.take("rate", "a number from 0.01 to 100", |value| {
            super::number(value).filter(is_rate)
        })?;
        let rate = rate.unwrap_or(1.0);
        if rate != 1.0 && !use_sim_time {
            let why = "needs use_sim_time: the speed of the system clock cannot be changed";
            return Err(super::wrong("rate", why));
        }
        let stamped = given.truth("enable_stamped_cmd_vel")?;
        let is_cmd_vel_stamped = stamped.unwrap_or(distribution == Distribution::Kilted);
        given.all_known(&PARAMETERS)?;
        Ok(Self { rate, use_sim_time, is_cmd_vel_stamped })
    }
}
