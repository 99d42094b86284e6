//! Improves a trajectory by small changes of one velocity after the other.

use super::course::{Cost, Judge, State};
use crate::geometry::Velocity;

/// Cost of a whole trajectory, by reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Total {
    pub(super) cost: Cost,
    /// Duration, including the time to go after it \[s\].
    pub(super) time_s: f64,
}

impl Total {
    pub(super) fn sum_s(&self) -> f64 {
        self.time_s + self.cost.sum_s()
    }

    /// Cost of a trajectory from a state, up to its arrival; `None` if it touches something.
    pub(super) fn of(start: &State, course: &[Velocity], judge: &Judge<'_>) -> Option<Self> {
        Self::below(f64::INFINITY, &Begun::at(start), course, judge)
    }

    /// Cost of a trajectory that continues; also `None` if it is `most_s` or more. That mostly
    /// follows from its end state, without checking the surroundings.
    fn below(most_s: f64, begun: &Begun, rest: &[Velocity], judge: &Judge<'_>) -> Option<Self> {
        let (least, stretches) = Self::least(begun, rest, judge);
        let spare_s = most_s - least.sum_s();
        if spare_s <= 0.0 {
            return None;
        }
        let Begun { mut state, mut cost } = *begun;
        let most_way_s = cost.way_s() + spare_s + ROUNDING_S;
        for &to in &rest[..stretches] {
            (state, cost) = judge.drive(&state, &cost, to)?;
            if cost.way_s() > most_way_s {
                return None;
            }
        }
        let total = Self { cost, time_s: least.time_s };
        (total.sum_s() < most_s).then_some(total)
    }

    /// Cost of a trajectory that continues, without the cost of the surroundings, and its number
    /// of stretches up to its arrival.
    fn least(begun: &Begun, rest: &[Velocity], judge: &Judge<'_>) -> (Self, usize) {
        let Begun { mut state, mut cost } = *begun;
        let (mut left_s, mut stretches) = (judge.time_to_go_s(&state), 0);
        for &to in rest {
            (state, cost) = judge.leads_to(&state, &cost, to);
            left_s = judge.time_to_go_s(&state);
            stretches += 1;
            if judge.arrives(&state, left_s) {
                break;
            }
        }
        (Self { cost, time_s: state.after_s + left_s }, stretches)
    }
}

/// A trajectory up to the beginning of one of its stretches.
#[derive(Clone, Copy, Debug)]
struct Begun {
    state: State,
    cost: Cost,
}

impl Begun {
    fn at(start: &State) -> Self {
        Self { state: *start, cost: Cost::default() }
    }
}

/// Steps of the changes, as fractions of the largest velocity change in a stretch.
pub(super) const STEPS: [f64; 3] = [0.25, 0.1, 0.04];

/// Steps for a trajectory that has been polished before.
pub(super) const FINEST: [f64; 1] = [STEPS[2]];

/// Upper bound of the rounding of a sum of the same costs in another order \[s\].
const ROUNDING_S: f64 = 1e-9;

/// A smaller gain does not count \[s\].
const LEAST_GAIN_S: f64 = 1e-9;

/// Changes the velocities of a trajectory, by smaller and smaller steps, if that improves it.
/// Returns its final cost \[s\]; infinite if it touches something, or is empty.
pub(super) fn polish(
    course: &mut [Velocity],
    start: &State,
    judge: &Judge<'_>,
    (steps, lowest_mps): (&[f64], f64),
) -> f64 {
    let total = if course.is_empty() { None } else { Total::of(start, course, judge) };
    let Some(mut best_s) = total.map(|total| total.sum_s()) else { return f64::INFINITY };
    for &part in steps {
        let mut begun = Begun::at(start);
        for index in 0..course.len() {
            polish_at(&mut course[index..], &begun, judge, (part, lowest_mps), &mut best_s);
            let Begun { state, cost } = begun;
            let Some((state, cost)) = judge.drive(&state, &cost, course[index]) else { break };
            if judge.arrives(&state, judge.time_to_go_s(&state)) {
                break;
            }
            begun = Begun { state, cost };
        }
    }
    best_s
}

/// Changes the first of the remaining velocities by a fraction of its largest change, to the
/// better of two opposite sides.
fn polish_at(
    rest: &mut [Velocity],
    begun: &Begun,
    judge: &Judge<'_>,
    (part, lowest_mps): (f64, f64),
    best_s: &mut f64,
) {
    let (limits, stretch_s) = (judge.limits, judge.stretch_s);
    let omega = part * limits.angular_acceleration_radps2 * stretch_s;
    let v = part * limits.acceleration_mps2 * stretch_s;
    for (v, omega) in [(0.0, omega), (v, 0.0)] {
        let old = rest[0];
        let mut best = old;
        // The first of two equal sides is taken. The sharper turn comes first, also in a mirror.
        let omega = omega.copysign(old.omega);
        for (v, omega) in [(v, omega), (-v, -omega)] {
            let wanted = Velocity::new((old.v + v).max(lowest_mps), old.omega + omega);
            rest[0] = limits.reached(begun.state.velocity, wanted, stretch_s);
            let reaches = |next: &Velocity| can_follow(*next, rest[0], judge);
            let is_one = rest[0] != old && rest.get(1).is_none_or(reaches);
            let most_s = *best_s - LEAST_GAIN_S;
            let total = if is_one { Total::below(most_s, begun, rest, judge) } else { None };
            if let Some(total) = total.filter(|_| can_stop(&begun.state, rest, judge)) {
                (best, *best_s) = (rest[0], total.sum_s());
            }
        }
        rest[0] = best;
    }
}

/// True if the robot could stop at the end of each stretch of a free trajectory, up to its
/// arrival.
pub(super) fn can_stop(start: &State, course: &[Velocity], judge: &Judge<'_>) -> bool {
    let mut state = *start;
    for &to in course {
        let Some((next, _)) = judge.drive(&state, &Cost::default(), to) else { return false };
        if !judge.can_stop(&next) {
            return false;
        }
        if judge.arrives(&next, judge.time_to_go_s(&next)) {
            return true;
        }
        state = next;
    }
    true
}

/// True if a velocity can be reached within a stretch.
fn can_follow(velocity: Velocity, from: Velocity, judge: &Judge<'_>) -> bool {
    let reached = judge.limits.reached(from, velocity, judge.stretch_s);
    (reached.v - velocity.v).abs() < 1e-9 && (reached.omega - velocity.omega).abs() < 1e-9
}
