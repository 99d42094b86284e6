//! The velocities that limits allow.

use super::Limits;
use crate::geometry::Velocity;

impl Limits {
    /// The velocity within the limits that is nearest to another one, component by component; 0 for
    /// what is not a number.
    pub fn clamped(&self, velocity: Velocity) -> Velocity {
        let known = |value: f64| if value.is_nan() { 0.0 } else { value };
        Velocity::new(
            known(velocity.v).clamp(self.v_min_mps, self.v_max_mps),
            known(velocity.omega).clamp(-self.omega_max_radps, self.omega_max_radps),
        )
    }
}
