//! Row of a run with several robots, from the rows of its robots.

use super::row::{ContactWhile, Row, score};
use keyway_sim::episode::EpisodeOutcome;

/// Combines the rows of all robots, under the stack of the first one: the gravest outcome, the
/// first contact, the time at which the last robot finished, and sums and minima of the rest.
/// Time averages are left out.
pub(super) fn of_all(robots: &[Row], min_robot_clearance_m: Option<f64>) -> Row {
    let first = &robots[0];
    let touched = first_touched(robots);
    let gravest = robots.iter().rev().max_by_key(|row| gravity(row.outcome));
    let gravest = touched.or(gravest).unwrap_or(first);
    let (outcome, time_s) = (gravest.outcome, most(robots, |row| row.time_s));
    let length_m = sum(robots, |row| row.length_m);
    let driven_s = sum(robots, |row| row.time_s);
    let reason = gravest.reason.as_ref().zip(gravest.robot);
    Row {
        robot: None,
        outcome,
        robots: robots.len() as u32,
        robots_reached: robots.iter().map(|row| row.robots_reached).sum(),
        contact: touched.and_then(|row| row.contact),
        mover_speed_mps: touched.and_then(|row| row.mover_speed_mps),
        jumped_onto: touched.and_then(|row| row.jumped_onto),
        time_s,
        length_m,
        mean_speed_mps: length_m.zip(driven_s.filter(|&s| s > 0.0)).map(|(m, s)| m / s),
        min_clearance_m: least(robots, |row| row.min_clearance_m),
        min_standing_clearance_m: least(robots, |row| row.min_standing_clearance_m),
        min_mover_clearance_m: least(robots, |row| row.min_mover_clearance_m),
        min_robot_clearance_m,
        routes_planned: count(robots, |row| row.routes_planned),
        recoveries: count(robots, |row| row.recoveries),
        unsafe_commands: count(robots, |row| row.unsafe_commands),
        v_variation_mps: sum(robots, |row| row.v_variation_mps),
        omega_variation_radps: sum(robots, |row| row.omega_variation_radps),
        min_distance_m: least(robots, |row| row.min_distance_m),
        share_near: None,
        path_smoothness_m2: None,
        velocity_smoothness_mps2: None,
        score: first.reference_time_s.map(|best_s| score(outcome, time_s, best_s)),
        reason: reason.map(|(reason, robot)| format!("robot {robot}: {reason}")),
        ..first.clone()
    }
}

/// The robot that was touched first; of several at the same time, one that was driving.
fn first_touched(robots: &[Row]) -> Option<&Row> {
    let touched = robots.iter().filter(|row| row.contact.is_some());
    let when =
        |row: &Row| (row.time_s.unwrap_or_default(), row.contact != Some(ContactWhile::Driving));
    touched.min_by(|a, b| {
        let ((a_s, a_stood), (b_s, b_stood)) = (when(a), when(b));
        a_s.total_cmp(&b_s).then(a_stood.cmp(&b_stood))
    })
}

/// Rank of an outcome: all robots have to reach their goals; a contact is the worst outcome.
const fn gravity(outcome: EpisodeOutcome) -> u8 {
    match outcome {
        EpisodeOutcome::Reached => 0,
        EpisodeOutcome::Timeout => 1,
        EpisodeOutcome::Stuck => 2,
        EpisodeOutcome::NoPath => 3,
        _ => 4,
    }
}

fn least(robots: &[Row], get: fn(&Row) -> Option<f64>) -> Option<f64> {
    robots.iter().filter_map(get).reduce(f64::min)
}

fn most(robots: &[Row], get: fn(&Row) -> Option<f64>) -> Option<f64> {
    robots.iter().filter_map(get).reduce(f64::max)
}

fn sum(robots: &[Row], get: fn(&Row) -> Option<f64>) -> Option<f64> {
    robots.iter().filter_map(get).reduce(|sum, one| sum + one)
}

fn count(robots: &[Row], get: fn(&Row) -> Option<u32>) -> Option<u32> {
    robots.iter().filter_map(get).reduce(|sum, one| sum + one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::row::tests::reached;

    #[test]
    fn rows_by_hand() {
        let slow = Row { time_s: Some(30.0), length_m: Some(8.0), ..reached(1) };
        let near = Row { min_clearance_m: Some(0.1), min_mover_clearance_m: Some(0.2), ..slow };
        let all = of_all(&[reached(0), near.clone()], Some(0.15));
        assert_eq!((all.robot, all.robots, all.robots_reached), (None, 2, 2));
        assert_eq!((all.outcome, all.reason.as_deref()), (EpisodeOutcome::Reached, None));
        assert_eq!(
            (all.time_s, all.length_m, all.mean_speed_mps),
            (Some(30.0), Some(12.0), Some(0.3))
        );
        assert_eq!((all.min_clearance_m, all.min_mover_clearance_m), (Some(0.1), Some(0.2)));
        assert_eq!((all.min_robot_clearance_m, all.share_near), (Some(0.15), None));
        assert_eq!(
            (all.routes_planned, all.recoveries, all.unsafe_commands),
            (Some(4), Some(2), None)
        );
        assert_eq!((all.v_variation_mps, all.omega_variation_radps), (Some(2.0), Some(4.0)));
        // 30 s is within eight times 4 s, and more than twice 4 s.
        assert_eq!(all.score, Some(4.0 / 30.0));
        let fails = |robot: u32, outcome, why: &str| Row {
            outcome,
            robots_reached: 0,
            reason: Some(why.to_owned()),
            ..reached(robot)
        };
        let late = fails(0, EpisodeOutcome::Timeout, "late");
        let stuck = fails(1, EpisodeOutcome::Stuck, "stuck");
        let walled =
            Row { time_s: None, length_m: None, ..fails(2, EpisodeOutcome::NoPath, "walled in") };
        let also_stuck = fails(3, EpisodeOutcome::Stuck, "stuck, too");
        let all = of_all(&[late, stuck.clone(), also_stuck.clone(), near.clone()], None);
        assert_eq!(
            (all.outcome, all.reason.as_deref()),
            (EpisodeOutcome::Stuck, Some("robot 1: stuck"))
        );
        assert_eq!((all.robots_reached, all.score), (1, Some(0.0)));
        let all = of_all(&[walled.clone(), also_stuck], None);
        assert_eq!((all.outcome, all.time_s), (EpisodeOutcome::NoPath, Some(10.0)));
        let none = of_all(&[walled.clone(), walled], None);
        assert_eq!((none.time_s, none.length_m, none.mean_speed_mps), (None, None, None));
        let touched = |robot, time_s, contact, speed_mps| Row {
            time_s: Some(time_s),
            contact: Some(contact),
            mover_speed_mps: speed_mps,
            jumped_onto: Some(false),
            ..fails(robot, EpisodeOutcome::Collided, "touched")
        };
        let stood = touched(0, 5.0, ContactWhile::Standing, None);
        let drove = touched(1, 5.0, ContactWhile::Driving, Some(1.5));
        let later = touched(2, 6.0, ContactWhile::Driving, Some(9.0));
        let all = of_all(&[stuck, stood, later, drove, near], Some(0.0));
        assert_eq!((all.contact, all.mover_speed_mps), (Some(ContactWhile::Driving), Some(1.5)));
        assert_eq!(
            (all.jumped_onto, all.reason.as_deref()),
            (Some(false), Some("robot 1: touched"))
        );
        assert_eq!(all.time_s, Some(30.0));
    }
}
