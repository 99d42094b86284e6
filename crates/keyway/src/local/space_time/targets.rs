//! The velocities that a trajectory may have at the end of its next stretch.

use super::course::{Judge, State};
use crate::geometry::Velocity;
use arrayvec::ArrayVec;

/// Pairs of a few speeds and turn rates.
#[derive(Debug, Default)]
pub(super) struct Targets {
    velocities: ArrayVec<Velocity, 60>,
}

impl Targets {
    /// Half a degree.
    const FACING_RAD: f64 = 0.0087;

    /// Fraction of the possible acceleration for a gentle start in a tight space.
    const GENTLY: f64 = 0.25;

    /// Fractions of the reachable turn rate on wide arcs.
    const WIDELY: [f64; 2] = [1.0 / 16.0, 1.0 / 64.0];

    /// Targets of a state. Speeds: the fastest and the slowest that can be reached, and the
    /// present one. Turn rates: the largest to the left and to the right, straight on, the one
    /// that turns towards the path, and in a narrow passage the one that leads to its middle. At
    /// the beginning of a trajectory (`is_near`), also those halfway to the slowest and to the
    /// sides. Near rest, also a gentle acceleration, and wide arcs if there is no space to turn
    /// on the spot: on them a polygon gets away from a wall. A car-like robot has in place of each
    /// pair the velocity that it reaches instead.
    pub(super) fn of(state: &State, judge: &Judge<'_>, lowest_mps: f64, is_near: bool) -> Self {
        let (limits, stretch_s) = (judge.limits, judge.stretch_s);
        let Velocity { v, omega, .. } = state.velocity;
        let reached =
            |v, omega| limits.reached_apart(state.velocity, Velocity::new(v, omega), stretch_s);
        let speed = |wanted_mps: f64| reached(wanted_mps, omega).v;
        let rate = |wanted_radps: f64| reached(v, wanted_radps).omega;
        let (fastest, slowest) = (speed(limits.v_max_mps), speed(lowest_mps));
        let most = limits.omega_max_radps;
        let (left, right) = (rate(most), rate(-most));
        let (_, way) = judge.cost_to_go.way(state.at);
        let bearing_rad = libm::atan2(state.ahead.cross(way), state.ahead.dot(way));
        let mut speeds_mps = ArrayVec::<f64, 5>::new();
        let mut rates_radps = ArrayVec::<f64, 12>::new();
        for speed_mps in [fastest, v.max(lowest_mps), slowest] {
            add(&mut speeds_mps, speed_mps);
        }
        // The first of two equal trajectories is taken. The side of the path comes first, which a
        // mirror exchanges as well.
        let sides = if bearing_rad < 0.0 { [right, left] } else { [left, right] };
        // A smaller angle is not worth a turn.
        let bearing_rad = if bearing_rad.abs() < Self::FACING_RAD { 0.0 } else { bearing_rad };
        let [inner, outer] = sides;
        for rate_radps in [inner, outer, rate(0.0), rate(bearing_rad / stretch_s)] {
            add(&mut rates_radps, rate_radps);
        }
        if let Some(rate_radps) = judge.to_middle_radps(state) {
            add(&mut rates_radps, rate(rate_radps));
        }
        if is_near {
            add(&mut speeds_mps, 0.5 * (v + slowest));
            let gently = Self::GENTLY * (fastest - v);
            if v < gently {
                add(&mut speeds_mps, v + gently);
                if judge.short_of_turning(state.at) > 0.0 {
                    for part in Self::WIDELY {
                        for side in sides {
                            add(&mut rates_radps, omega + part * (side - omega));
                        }
                    }
                }
            }
            for rate_radps in [omega, 0.5 * (omega + inner), 0.5 * (omega + outer)] {
                add(&mut rates_radps, rate_radps);
            }
        }
        let mut targets = Self::default();
        for &v in &speeds_mps {
            targets.add(rates_radps.iter().map(|&omega| Velocity::new(v, omega)), state, judge);
        }
        targets
    }

    fn add(&mut self, pairs: impl Iterator<Item = Velocity>, state: &State, judge: &Judge<'_>) {
        if judge.limits.turns_in_place() {
            self.velocities.extend(pairs);
            return;
        }
        for pair in pairs {
            let reached = judge.limits.reached(state.velocity, pair, judge.stretch_s);
            if !self.velocities.contains(&reached) {
                self.velocities.push(reached);
            }
        }
    }

    pub(super) fn velocities(&self) -> impl Iterator<Item = Velocity> + '_ {
        self.velocities.iter().copied()
    }
}

/// Adds a value unless it is there already.
fn add<const MOST: usize>(values: &mut ArrayVec<f64, MOST>, value: f64) {
    if values.iter().all(|known| (known - value).abs() > 1e-6) {
        values.push(value);
    }
}
