//! The dynamic window: velocities that the robot can have at the end of the cycle.

use crate::geometry::Velocity;
use crate::robot::{Limits, Robot};

/// Vm and Vd of \[You2021, eq. (5), (6)\] together: the velocities within the limits that can be
/// reached within one cycle. The fastest are those from which the robot still stops at its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) slowest: Velocity,
    pub(super) fastest: Velocity,
}

impl Window {
    /// Speeds and turn rates each on their own: a car-like robot does not have all of their pairs.
    pub(super) fn of(robot: &Robot, from: Velocity, remaining_m: f64, backwards: bool) -> Self {
        let Robot { limits, cycle_s, .. } = robot;
        let stoppable_mps = limits.stoppable_mps(from.v, remaining_m, *cycle_s);
        let v_min_mps = if backwards { limits.v_min_mps.max(-stoppable_mps) } else { 0.0 };
        let v_max_mps = limits.v_max_mps.min(stoppable_mps);
        let all_down = Velocity::new(v_min_mps, -limits.omega_max_radps);
        let all_up = Velocity::new(v_max_mps, limits.omega_max_radps);
        Self {
            slowest: limits.reached_apart(from, all_down, *cycle_s),
            fastest: limits.reached_apart(from, all_up, *cycle_s),
        }
    }

    /// Upper limit of the width of any window: the range that can be reached within a cycle to
    /// both sides, within the limits.
    pub(super) fn widest(limits: &Limits, cycle_s: f64) -> Velocity {
        let by_v = limits.acceleration_mps2 + limits.deceleration_mps2;
        let by_omega = limits.angular_acceleration_radps2 + limits.angular_deceleration_radps2;
        Velocity::new(
            (by_v * cycle_s).min(limits.v_max_mps - limits.v_min_mps),
            (by_omega * cycle_s).min(2.0 * limits.omega_max_radps),
        )
    }
}

/// The candidates of a window: all pairs of speeds and turn rates.
#[derive(Clone, Debug, Default)]
pub(super) struct Lattice {
    speeds_mps: Vec<f64>,
    turn_rates_radps: Vec<f64>,
}

impl Lattice {
    /// Fills in the candidates of another window; allocates nothing once it is warm.
    pub(super) fn fill(&mut self, window: &Window, v_step_mps: f64, omega_step_radps: f64) {
        let Window { slowest, fastest } = window;
        multiples(slowest.v, fastest.v, v_step_mps, &mut self.speeds_mps);
        multiples(slowest.omega, fastest.omega, omega_step_radps, &mut self.turn_rates_radps);
    }

    /// A single candidate.
    pub(super) fn fill_with(&mut self, velocity: Velocity) {
        self.speeds_mps.clear();
        self.speeds_mps.push(velocity.v);
        self.turn_rates_radps.clear();
        self.turn_rates_radps.push(velocity.omega);
    }

    /// All speeds, slowest first.
    pub(super) fn speeds_mps(&self) -> &[f64] {
        &self.speeds_mps
    }

    /// All turn rates, from right to left.
    pub(super) fn turn_rates_radps(&self) -> &[f64] {
        &self.turn_rates_radps
    }

    /// Number of candidates.
    pub(super) const fn len(&self) -> usize {
        self.speeds_mps.len() * self.turn_rates_radps.len()
    }

    /// The largest magnitudes.
    pub(super) fn fastest(&self) -> Velocity {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, n| most.max(n.abs()));
        Velocity::new(largest(&self.speeds_mps), largest(&self.turn_rates_radps))
    }

    /// The slowest speed and the fastest, where backwards is slower than standstill; both are 0
    /// if there are none.
    pub(super) fn ends_mps(&self) -> [f64; 2] {
        let end = |end: Option<&f64>| end.copied().unwrap_or_default();
        [end(self.speeds_mps.first()), end(self.speeds_mps.last())]
    }

    /// The candidates, slowest speed first.
    pub(super) fn candidates(&self) -> impl Iterator<Item = Velocity> + '_ {
        self.speeds_mps
            .iter()
            .flat_map(|&v| self.turn_rates_radps.iter().map(move |&omega| Velocity::new(v, omega)))
    }
}

/// The multiples of `step` between both ends, and the ends. Standstill and driving straight are
/// among the candidates whenever they can be reached, and so is the upper end of the window.
fn multiples(low: f64, high: f64, step: f64, values: &mut Vec<f64>) {
    let near = step * 1e-6;
    values.clear();
    values.push(low);
    let between = ((low / step).floor() as i64..=(high / step).ceil() as i64)
        .map(|k| k as f64 * step)
        .filter(|&value| value > low + near && value < high - near);
    values.extend(between);
    if high > low {
        values.push(high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_by_hand() {
        let robot = Robot::small();
        let window = |v, left_m| Window::of(&robot, Velocity::new(v, 0.0), left_m, false);
        let Window { slowest, fastest } = window(0.48, f64::INFINITY);
        assert!((slowest.v - 0.43).abs() < 1e-12 && (fastest.v - 0.5).abs() < 1e-12);
        assert!((slowest.omega + 0.3).abs() < 1e-12);
        // From 0.45 m/s it still stops within 0.0465 m and 0.2025 m; nothing is slower than
        // braking.
        assert!((window(0.48, 0.249).fastest.v - 0.45).abs() < 1e-12);
        assert!((window(0.48, 0.1).fastest.v - 0.43).abs() < 1e-12);
        let limits = Limits { v_min_mps: -0.3, ..robot.limits.clone() };
        let robot = Robot { limits, ..robot.clone() };
        let slowest = |v, backwards| {
            Window::of(&robot, Velocity::new(v, 0.0), f64::INFINITY, backwards).slowest.v
        };
        assert_eq!((slowest(0.0, false), slowest(0.0, true)), (0.0, -0.05));
        // It brakes from backwards, too.
        assert_eq!((slowest(-0.02, false), slowest(-0.3, false)), (0.0, -0.25));
    }

    #[test]
    fn lattice_has_both_ends_and_zero() {
        let mut values = vec![9.0];
        multiples(-0.07, 0.1, 0.05, &mut values);
        let expected = [-0.07, -0.05, 0.0, 0.05, 0.1];
        assert_eq!(values.len(), expected.len());
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        multiples(0.3, 0.3, 0.05, &mut values);
        assert_eq!(values, [0.3]);
    }
}
