//! The dynamic window approach, literally: equations (4) to (12) of You 2021, the evaluation of S1,
//! and equation (18) of Zhu and Yin 2024; with table 2 and 3 of You 2021 and a robot that is a
//! point.

use super::Wanted;
use super::world::{World, meets, to_square};
use std::f64::consts::PI;

const DT: f64 = 0.1;
const V_MIN: f64 = 0.0;
const V_MAX: f64 = 1.0;
const V_A: f64 = 0.2;
const OMEGA_MAX: f64 = 20.0 * PI / 180.0;
const OMEGA_A: f64 = 50.0 * PI / 180.0;
const DV: f64 = 0.01;
const D_OMEGA: f64 = PI / 180.0;
const STEPS: u32 = 30;
const RANGE_M: f64 = 5.0;

/// The planners count a stretch this short that they cannot show to be free as contact (0.1 mm),
/// so a trajectory that passes an obstacle at less than this may be refused.
const DOUBT_M: f64 = 2e-4;

/// Differences of this size are rounding.
const ROUNDING: f64 = 1e-9;

/// A state of the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) theta: f64,
    pub(crate) v: f64,
    pub(crate) omega: f64,
}

/// A candidate and its score.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evaluated {
    pub(crate) v: f64,
    pub(crate) omega: f64,
    pub(crate) score: f64,
}

/// The terms of an admissible candidate before normalisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    pub(crate) v: f64,
    pub(crate) omega: f64,
    pub(crate) heading: f64,
    /// dist of (7).
    pub(crate) stopping: f64,
    /// dist of the evaluation.
    pub(crate) dist: f64,
    pub(crate) target: f64,
}

impl State {
    /// Equation (4).
    pub(crate) fn driven(&self, v: f64, omega: f64) -> Self {
        Self {
            x: self.x + v * self.theta.cos() * DT,
            y: self.y + v * self.theta.sin() * DT,
            theta: self.theta + omega * DT,
            v,
            omega,
        }
    }
}

/// Multiples of a step between two bounds, and the bounds.
fn between(low: f64, high: f64, step: f64) -> Vec<f64> {
    let mut values = vec![low];
    for k in -2000..=2000 {
        let value = f64::from(k) * step;
        if value > low + 1e-6 * step && value < high - 1e-6 * step {
            values.push(value);
        }
    }
    values.push(high);
    values
}

fn angle_difference(a: f64) -> f64 {
    let mut a = a;
    while a > PI {
        a -= 2.0 * PI;
    }
    while a <= -PI {
        a += 2.0 * PI;
    }
    a
}

/// All admissible candidates, (5) to (8), and true if one of them, or a refused one, is in doubt.
/// With `at_end`, dist of (7) and of the evaluation is that of the trajectory's end, otherwise
/// that of its nearest point.
fn admissible(
    world: &World,
    state: State,
    target: (f64, f64),
    at_end: [bool; 2],
) -> (Vec<Terms>, bool) {
    let (mut all, mut has_doubt) = (Vec::new(), false);
    let slowest = (state.v - V_A * DT).max(V_MIN);
    let fastest = (state.v + V_A * DT).min(V_MAX);
    let most_right = (state.omega - OMEGA_A * DT).max(-OMEGA_MAX);
    let most_left = (state.omega + OMEGA_A * DT).min(OMEGA_MAX);
    for &v in &between(slowest, fastest, DV) {
        for &omega in &between(most_right, most_left, D_OMEGA) {
            let rolled_out =
                |doubt_m| rolled_out(world, state, (v, omega), target, at_end, doubt_m);
            let Some((terms, is_tie)) = rolled_out(0.0) else { continue };
            has_doubt |= is_tie || rolled_out(DOUBT_M).is_none();
            all.extend((!is_refused(&terms)).then_some(terms));
        }
    }
    (all, has_doubt)
}

/// True if (7) refuses the candidate.
fn is_refused(Terms { v, omega, stopping, .. }: &Terms) -> bool {
    let slow_enough = |decelerated: f64| (2.0 * stopping * decelerated).sqrt();
    *v > slow_enough(V_A) || (*v != 0.0 && omega.abs() > slow_enough(OMEGA_A))
}

/// The terms of a candidate; contact is a distance below `contact_m`. The second result is true if
/// rounding decides: if (7) refuses it, or in the direction of the target from a position on it.
fn rolled_out(
    world: &World,
    state: State,
    (v, omega): (f64, f64),
    target: (f64, f64),
    at_end: [bool; 2],
    contact_m: f64,
) -> Option<(Terms, bool)> {
    let nearest = |at: &State| {
        world.squares().map(|square| to_square(at.x, at.y, square)).fold(RANGE_M, f64::min)
    };
    let mut at = state;
    let mut dists = [nearest(&at); 2];
    for _ in 0..STEPS {
        let next = at.driven(v, omega);
        let border = next.x.min(next.y).min(world.width - next.x).min(world.height - next.y);
        let is_met = |square| meets((at.x, at.y), (next.x, next.y), square, contact_m);
        if border < contact_m || world.squares().any(is_met) {
            return None;
        }
        at = next;
        for (dist, at_end) in dists.iter_mut().zip(at_end) {
            *dist = if at_end { nearest(&at) } else { dist.min(nearest(&at)) };
        }
    }
    let [stopping, dist] = dists;
    let bearing = (target.1 - at.y).atan2(target.0 - at.x);
    let heading = PI - angle_difference(bearing - at.theta).abs();
    let target = ((target.0 - at.x).powi(2) + (target.1 - at.y).powi(2)).sqrt();
    let is_near = |a: f64, b: f64| (a - b).abs() <= ROUNDING;
    let is_tie = is_near(v, (2.0 * stopping * V_A).sqrt())
        || is_near(omega.abs(), (2.0 * stopping * OMEGA_A).sqrt())
        || is_near(target, 0.0);
    Some((Terms { v, omega, heading, stopping, dist, target }, is_tie))
}

/// The candidates with their scores.
pub(crate) fn best(
    world: &World,
    state: State,
    target: (f64, f64),
    at_end: [bool; 2],
    scores: impl Fn(&[Terms]) -> Vec<f64>,
) -> Wanted {
    let (all, has_doubt) = admissible(world, state, target, at_end);
    if all.is_empty() {
        return Wanted::Nothing;
    }
    let scores = scores(&all);
    let score = |(terms, score): (&Terms, f64)| Evaluated { v: terms.v, omega: terms.omega, score };
    Wanted::BestOf { all: all.iter().zip(scores).map(score).collect(), has_doubt }
}

/// (10): a value over the sum of all.
fn normalised(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let sum: f64 = values.iter().sum();
    values.iter().map(|value| if sum > 0.0 { value / sum } else { 0.0 }).collect()
}

/// (9) and (11), with dist in the evaluation up to a cap.
pub(crate) fn classic(all: &[Terms], [alpha, beta, gamma]: [f64; 3], cap: f64) -> Vec<f64> {
    let heading = normalised(all.iter().map(|one| one.heading));
    let dist = normalised(all.iter().map(|one| one.dist.min(cap)));
    let vel = normalised(all.iter().map(|one| one.v));
    (0..all.len()).map(|i| alpha * heading[i] + beta * dist[i] + gamma * vel[i]).collect()
}

/// (12), with the obstacles of both regions counted.
pub(crate) fn gamma(world: &World, state: State) -> f64 {
    let (mut c, mut d) = (0.0, 0.0);
    for &(left, low) in world.squares() {
        let (dx, dy) = (left + 0.5 - state.x, low + 0.5 - state.y);
        let away = (dx * dx + dy * dy).sqrt();
        if angle_difference(dy.atan2(dx) - state.theta).abs() > PI / 2.0 + 1e-9 {
            continue;
        }
        if away <= 1.5 {
            c += 1.0;
        } else if away <= 3.0 {
            d += 1.0;
        }
    }
    let gamma: f64 = 0.3 / (1.0 * c + 0.5 * d + 0.5);
    gamma.min(0.3)
}

/// The evaluation of S1 with a = 0.5 and R = 0.5 m.
pub(crate) fn adaptive(all: &[Terms]) -> Vec<f64> {
    let (a, r) = (0.5, 0.5);
    let heading = normalised(all.iter().map(|one| one.heading));
    let dist = normalised(all.iter().map(|one| one.dist));
    let vel = normalised(all.iter().map(|one| one.v));
    let mut scores = Vec::new();
    for (i, one) in all.iter().enumerate() {
        let star = f64::max(one.dist - r, r);
        scores.push(
            (a + (1.0 - a) * star / r) * 0.08 * heading[i]
                + 0.2 * dist[i]
                + (a + r / star) * 0.1 * vel[i],
        );
    }
    scores
}

/// (18) of Zhu and Yin.
pub(crate) fn guided(all: &[Terms], [alpha, beta, gamma]: [f64; 3]) -> Vec<f64> {
    let farthest = all.iter().map(|one| one.target).fold(0.0, f64::max);
    let heading = normalised(all.iter().map(|one| one.heading));
    let target = normalised(all.iter().map(|one| farthest - one.target));
    let od = normalised(all.iter().map(|one| one.dist));
    (0..all.len()).map(|i| alpha * heading[i] + beta * target[i] + gamma * od[i]).collect()
}
