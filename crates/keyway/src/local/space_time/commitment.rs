//! Commitment: continues the trajectory of the last cycle, and decides if a new one replaces it.

use super::course::{Acceleration, Cost, Judge, State};
use crate::geometry::{Point, Velocity};
use crate::local::Course;
use crate::robot::Robot;

/// A trajectory on another side of an obstacle has to be better by this \[s\].
const DECIDED_S: f64 = 0.3;

/// Margin by which a new trajectory has to be better than the rest of the last one \[s\].
pub(super) fn reluctance_s(
    rest: &[Velocity],
    new: &[Velocity],
    start: &State,
    judge: &Judge<'_>,
) -> f64 {
    if are_apart(rest, new, start, judge) { DECIDED_S } else { 0.0 }
}

/// True if two trajectories pass an obstacle on different sides: at some instant, the straight
/// line between their positions is blocked.
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

/// True if the inscribed disc fits everywhere on a line.
fn is_open_between(a: Point, b: Point, judge: &Judge<'_>) -> bool {
    let steps = (a.distance(b) / judge.room.spacing_m()).ceil().max(1.0);
    let fits = |step: u32| {
        let at = a.lerp(b, f64::from(step) / steps);
        judge.room.of_point(at) >= judge.outline.inscribed_m
    };
    (0..=steps as u32).all(fits)
}

/// Computes the rest of a `Course` that was begun a cycle ago, as velocities at the ends of a
/// number of stretches from now on. The last velocity continues, and none changes faster than the
/// robot can.
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

/// The acceleration with which a `Course` that was begun a cycle ago continues from a velocity.
pub(super) fn going_on(course: Option<&Course>, from: Velocity, robot: &Robot) -> Acceleration {
    let Some(course) = course else { return Acceleration::default() };
    let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
    let [left_s, whole_s] = [course.stretch_s - cycle_s, course.stretch_s];
    let planned = match *course.velocities {
        [first, ..] if left_s >= cycle_s => Acceleration::of(from, first, left_s, limits),
        [first, second, ..] => Acceleration::of(first, second, whole_s, limits),
        _ => Acceleration::default(),
    };
    Acceleration {
        linear: planned.linear.clamp(-1.0, 1.0),
        angular: planned.angular.clamp(-1.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_goes_on_with_the_acceleration_of_the_stretch_that_it_is_in() {
        let robot = Robot::small();
        let course = |stretch_s, velocities: &[(f64, f64)]| Course {
            stretch_s,
            velocities: velocities.iter().map(|&(v, omega)| Velocity::new(v, omega)).collect(),
        };
        let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
        let parts = |v: f64, omega: f64| Acceleration {
            linear: v / limits.acceleration_mps2,
            angular: omega / limits.angular_acceleration_radps2,
        };
        let is_near = |a: Acceleration, b: Acceleration| {
            (a.linear - b.linear).abs() < 1e-9 && (a.angular - b.angular).abs() < 1e-9
        };
        // In five cycles it changes by 0.1 m/s, in the remaining four by 0.08 m/s.
        let from = Velocity::new(0.12, 0.0);
        let long = course(5.0 * cycle_s, &[(0.2, -0.04), (0.0, 0.0)]);
        let found = going_on(Some(&long), from, &robot);
        assert!(is_near(found, parts(0.08 / (4.0 * cycle_s), -0.04 / (4.0 * cycle_s))));
        // Its first stretch is over: it brakes.
        let short = course(cycle_s, &[(0.12, 0.0), (0.1, 0.0)]);
        let found = going_on(Some(&short), from, &robot);
        assert!(is_near(found, parts(-0.02 / cycle_s, 0.0)));
        // It is far from the `Course`, and limited to what the robot can do.
        let found = going_on(Some(&long), Velocity::new(-9.0, 0.0), &robot);
        assert_eq!(found.linear, 1.0);
        assert_eq!(going_on(None, from, &robot), Acceleration::default());
    }
}
