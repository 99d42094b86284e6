//! When a robot stands.

use super::Robot;
use crate::geometry::Velocity;

impl Robot {
    /// Whether it stands: what its odometry shows then is noise.
    pub(crate) fn stands(&self, velocity: Velocity) -> bool {
        let (limits, cycle_s) = (&self.limits, self.cycle_s);
        let standing_radps = 0.1 * limits.angular_deceleration_radps2 * cycle_s;
        velocity.v.abs() <= limits.standing_mps(cycle_s) && velocity.omega.abs() <= standing_radps
    }

    /// The longest from a scan until it stands, when it then backs up straight for one more cycle, as fast as it can, and brakes \[s\].
    pub(crate) fn backing_s(&self) -> f64 {
        let stop_s = -self.limits.v_min_mps / self.limits.deceleration_mps2;
        self.actuation_delay_s + 2.0 * self.cycle_s + stop_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_no_motion() {
        let robot = Robot::small();
        assert!(robot.stands(Velocity::new(0.004, 0.02)));
        assert!(!robot.stands(Velocity::new(0.006, 0.0)));
        assert!(!robot.stands(Velocity::new(0.0, 0.04)));
    }
}
