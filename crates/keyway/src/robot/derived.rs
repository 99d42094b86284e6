//! A robot that is derived from its size and its speed.

use super::{Footprint, Limits, RangeSensor, Robot};
use std::f64::consts::TAU;

impl Robot {
    /// A robot with this footprint and top speed \[m/s\]. All other values are typical of robots
    /// of that kind:
    ///
    /// - a control cycle of 0.1 s, or half of that from 1 m/s on;
    /// - an acceleration and deceleration that take one second to the top speed, between 0.5 and
    ///   2.5 m/s²;
    /// - a turn rate at which its outermost point is as fast as the top speed, between 0.5 and 3
    ///   rad/s, reached within half a second;
    /// - no driving backwards;
    /// - a lidar at its centre with a field of view of 360 degrees. Its range is the distance
    ///   driven in 8 s, between 5 and 20 m. It has one beam per degree, or more if it could miss a
    ///   narrow object within the stopping distance.
    ///
    /// ```
    /// use keyway::robot::{Footprint, Robot};
    ///
    /// let robot = Robot::derived(Footprint::circle(0.25)?, 0.8);
    /// assert!(robot.validate().is_ok());
    /// assert_eq!((robot.limits.acceleration_mps2, robot.limits.omega_max_radps), (0.8, 3.0));
    /// # Ok::<(), keyway::robot::FootprintError>(())
    /// ```
    pub fn derived(footprint: Footprint, v_max_mps: f64) -> Self {
        const CYCLE_S: f64 = 0.1;
        let acceleration_mps2 = (v_max_mps / 1.0).clamp(0.5, 2.5);
        let rim_m = footprint.circumscribed_radius_m();
        let rim_radps = if rim_m > 0.0 { v_max_mps / rim_m } else { f64::INFINITY };
        let omega_max_radps = rim_radps.clamp(0.5, 3.0);
        let angular_acceleration_radps2 = omega_max_radps / 0.5;
        Self {
            footprint,
            cycle_s: if v_max_mps < 1.0 { CYCLE_S } else { 0.5 * CYCLE_S },
            actuation_delay_s: 0.0,
            safety_margin_m: None,
            limits: Limits {
                v_min_mps: 0.0,
                v_max_mps,
                omega_max_radps,
                min_turning_radius_m: 0.0,
                acceleration_mps2,
                deceleration_mps2: acceleration_mps2,
                angular_acceleration_radps2,
                angular_deceleration_radps2: angular_acceleration_radps2,
                jerk_mps3: None,
                angular_jerk_radps3: None,
            },
            sensors: vec![lidar(
                v_max_mps,
                rim_m + 0.5 * v_max_mps * v_max_mps / acceleration_mps2,
            )],
        }
    }
}

/// A 360 degree lidar for a robot that stops within this length \[m\] plus the distance of its
/// reaction time.
fn lidar(v_max_mps: f64, stops_m: f64) -> RangeSensor {
    const REACTS_S: f64 = 0.5;
    let range_m = (8.0 * v_max_mps).clamp(5.0, 20.0);
    let sees_m = (stops_m + REACTS_S * v_max_mps).min(range_m);
    let turns = (sees_m * TAU / RangeSensor::NARROWEST_M / 360.0).ceil().max(1.0);
    RangeSensor::new(360 * turns as u32, 360.0, range_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every size and speed gives a valid robot.
        #[test]
        fn a_derived_robot_is_a_robot(radius_m in 0.0..3.0, v_max_mps in 1e-3..20.0) {
            let robot = Robot::derived(Footprint::circle(radius_m).unwrap(), v_max_mps);
            prop_assert_eq!(robot.validate(), Ok(()));
            // It stops within its sensor's range.
            prop_assert!(v_max_mps > 5.0 || robot.sight_mps() > v_max_mps);
            let long = Footprint::rectangle(2.0 * radius_m + 0.1, radius_m + 0.05).unwrap();
            prop_assert_eq!(Robot::derived(long, v_max_mps).validate(), Ok(()));
        }
    }

    #[test]
    fn slow_and_fast_ones_by_hand() {
        let limits = |radius_m, v| {
            let robot = Robot::derived(Footprint::circle(radius_m).unwrap(), v);
            let Limits { omega_max_radps, acceleration_mps2, .. } = robot.limits;
            (robot.cycle_s, acceleration_mps2, omega_max_radps, robot.sensors[0].range_m)
        };
        assert_eq!(limits(0.25, 0.5), (0.1, 0.5, 2.0, 5.0));
        assert_eq!(limits(0.5, 1.0), (0.05, 1.0, 2.0, 8.0));
        assert_eq!(limits(2.0, 4.0), (0.05, 2.5, 2.0, 20.0));
        assert_eq!(limits(0.0, 0.3), (0.1, 0.5, 3.0, 5.0));
    }
}
