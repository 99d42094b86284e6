//! The dynamic window: velocities that the robot can have at the end of the cycle.

use crate::geometry::Velocity;
use crate::robot::Limits;

/// Vm and Vd of \[You2021, eq. (5), (6)\] together: what the limits allow and the accelerations
/// reach within one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) slowest: Velocity,
    pub(super) fastest: Velocity,
}

impl Window {
    pub(super) fn of(limits: &Limits, from: Velocity, cycle_s: f64) -> Self {
        let all_down = Velocity::new(limits.v_min_mps, -limits.omega_max_radps);
        let all_up = Velocity::new(limits.v_max_mps, limits.omega_max_radps);
        Self {
            slowest: limits.reached(from, all_down, cycle_s),
            fastest: limits.reached(from, all_up, cycle_s),
        }
    }

    /// All pairs of speeds and turn rates, slowest speed first.
    pub(super) fn candidates(
        &self,
        v_step_mps: f64,
        omega_step_radps: f64,
    ) -> impl Iterator<Item = Velocity> + use<> {
        let speeds = lattice(self.slowest.v, self.fastest.v, v_step_mps);
        let turn_rates = lattice(self.slowest.omega, self.fastest.omega, omega_step_radps);
        speeds.into_iter().flat_map(move |v| {
            turn_rates.clone().into_iter().map(move |omega| Velocity::new(v, omega))
        })
    }
}

/// The multiples of `step` between both ends, and the ends: standing still and driving straight are
/// among the candidates whenever they can be reached, and so is the upper end of the window.
fn lattice(low: f64, high: f64, step: f64) -> Vec<f64> {
    let near = step * 1e-6;
    let multiples = ((low / step).floor() as i64..=(high / step).ceil() as i64)
        .map(|k| k as f64 * step)
        .filter(|&value| value > low + near && value < high - near);
    let mut values: Vec<f64> = std::iter::once(low).chain(multiples).collect();
    if high > low {
        values.push(high);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn window_by_hand() {
        let limits = Robot::small().limits;
        let window = Window::of(&limits, Velocity::new(0.48, 0.0), 0.1);
        assert!((window.slowest.v - 0.43).abs() < 1e-12 && (window.fastest.v - 0.5).abs() < 1e-12);
        assert!((window.slowest.omega + 0.3).abs() < 1e-12);
        let standing = Window::of(&limits, Velocity::ZERO, 0.1);
        assert_eq!(standing.slowest.v, 0.0);
    }

    #[test]
    fn lattice_has_both_ends_and_zero() {
        let values = lattice(-0.07, 0.1, 0.05);
        let expected = [-0.07, -0.05, 0.0, 0.05, 0.1];
        assert_eq!(values.len(), expected.len());
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_eq!(lattice(0.3, 0.3, 0.05), [0.3]);
    }
}
