//! The course of the last cycle, gone on with from now.

use super::course::{Judge, State};
use crate::geometry::Velocity;
use crate::local::Course;

/// What is left of a course that was begun a cycle ago, as velocities at the ends of so many stretches from now on. The last one
/// goes on, and none changes faster than the robot can.
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
