//! Makes a course better by small changes of one velocity after the other.

use super::course::{Cost, Judge, State};
use crate::geometry::Velocity;

/// What a whole course costs, by reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Total {
    pub(super) cost: Cost,
    /// Its time, and the time to go after it \[s\].
    pub(super) time_s: f64,
}

impl Total {
    pub(super) fn sum_s(&self) -> f64 {
        self.time_s + self.cost.sum_s()
    }

    /// That of a course from a state, up to where it arrives; `None` where it touches something.
    pub(super) fn of(start: &State, course: &[Velocity], judge: &Judge<'_>) -> Option<Self> {
        let (mut state, mut cost) = (*start, Cost::default());
        let mut left_s = judge.time_to_go_s(&state);
        for &to in course {
            (state, cost) = judge.drive(&state, &cost, to)?;
            left_s = judge.time_to_go_s(&state);
            if judge.arrives(&state, left_s) {
                break;
            }
        }
        Some(Self { cost, time_s: state.after_s + left_s })
    }
}

/// Steps of the changes, as parts of what the velocity can change in a stretch.
const STEPS: [f64; 3] = [0.25, 0.1, 0.04];

/// Changes the velocities of a course as long as that makes it better.
pub(super) fn polish(course: &mut [Velocity], start: &State, judge: &Judge<'_>, lowest_mps: f64) {
    let Some(total) = Total::of(start, course, judge) else { return };
    let mut best_s = total.sum_s();
    let (limits, stretch_s) = (judge.limits, judge.stretch_s);
    for part in STEPS {
        let omega = part * limits.angular_acceleration_radps2 * stretch_s;
        let v = part * limits.acceleration_mps2 * stretch_s;
        let changes = [(0.0, omega), (0.0, -omega), (v, 0.0), (-v, 0.0)];
        for index in 0..course.len() {
            for (v, omega) in changes {
                let old = course[index];
                let before = if index == 0 { start.velocity } else { course[index - 1] };
                let wanted = Velocity::new((old.v + v).max(lowest_mps), old.omega + omega);
                course[index] = limits.reached(before, wanted, stretch_s);
                let reaches = |next: &Velocity| can_follow(*next, course[index], judge);
                let is_one = course.get(index + 1).is_none_or(reaches);
                let total = if is_one { Total::of(start, course, judge) } else { None };
                match total.map(|total| total.sum_s()) {
                    Some(total_s) if total_s < best_s - 1e-9 && can_stop(start, course, judge) => {
                        best_s = total_s;
                    }
                    _ => course[index] = old,
                }
            }
        }
    }
}

/// Whether the robot could stop at the end of each stretch of a free course, up to where it arrives.
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

/// Whether a velocity can be reached within a stretch.
fn can_follow(velocity: Velocity, from: Velocity, judge: &Judge<'_>) -> bool {
    let reached = judge.limits.reached(from, velocity, judge.stretch_s);
    (reached.v - velocity.v).abs() < 1e-9 && (reached.omega - velocity.omega).abs() < 1e-9
}
