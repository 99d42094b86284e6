//! The course of the last cycle, gone on with from now; and when another one is taken.

use super::course::{Cost, Judge, State};
use crate::geometry::{Point, Velocity};
use crate::local::Course;

/// A course by another side of an obstacle is taken when it is so much better \[s\].
const DECIDED_S: f64 = 0.3;

/// How much better than what is left of the last course a new one has to be \[s\].
pub(super) fn reluctance_s(
    rest: &[Velocity],
    new: &[Velocity],
    start: &State,
    judge: &Judge<'_>,
) -> f64 {
    if are_apart(rest, new, start, judge) { DECIDED_S } else { 0.0 }
}

/// Whether two courses pass something on different sides: where the robot would be at some instant
/// on the one, it could not come straight from where it would be on the other.
fn are_apart(one: &[Velocity], other: &[Velocity], start: &State, judge: &Judge<'_>) -> bool {
    let (mut a, mut b) = (*start, *start);
    for (&to_a, &to_b) in one.iter().zip(other) {
        let next = |from: &State, to| judge.drive(from, &Cost::default(), to);
        let (Some((next_a, _)), Some((next_b, _))) = (next(&a, to_a), next(&b, to_b)) else {
            return false;
        };
        (a, b) = (next_a, next_b);
        if !is_open_between(a.at, b.at, judge) {
            return true;
        }
    }
    false
}

/// Whether the inscribed disc fits everywhere on a line.
fn is_open_between(a: Point, b: Point, judge: &Judge<'_>) -> bool {
    let steps = (a.distance(b) / judge.room.spacing_m()).ceil().max(1.0);
    let fits = |step: u32| {
        let at = a.lerp(b, f64::from(step) / steps);
        judge.room.of_point(at) >= judge.outline.inscribed_m
    };
    (0..=steps as u32).all(fits)
}

/// What is left of a course that was begun a cycle ago, as velocities at the ends of so many
/// stretches from now on. The last one goes on, and none changes faster than the robot can.
pub(super) fn go_on(
    rest: &mut Vec<Velocity>,
    course: Option<&Course>,
    start: &State,
    judge: &Judge<'_>,
    (stretches, cycle_s): (u32, f64),
) {
    rest.clear();
    let Some(course) = course else { return };
    let mut before = start.velocity;
    for stretch in 1..=stretches {
        let after_s = cycle_s + f64::from(stretch) * judge.stretch_s;
        let wanted = course.velocity(start.velocity, after_s);
        before = judge.limits.reached(before, wanted, judge.stretch_s);
        rest.push(before);
    }
}
