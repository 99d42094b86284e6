//! Table of a team.

use crate::table::{facts, number, paragraph, quantity, rows};
use keyway_sim::episode::{EpisodeOutcome, EpisodeReport, RobotReport};
use std::fmt::Write as _;

const HEADER: [&str; 9] = [
    "robot",
    "stack",
    "outcome",
    "time\n[s]",
    "planned\n[m]",
    "driven\n[m]",
    "speed\n[m/s]",
    "clearance\n[m]",
    "routes",
];

/// Table of the robots of a team for the terminal.
pub fn team_table(report: &EpisodeReport) -> String {
    let reached = report.outcomes.iter().filter(|&&one| one == EpisodeOutcome::Reached).count();
    let of_all = facts([
        ("reached", format!("{reached} of {}", report.outcomes.len())),
        ("all reached after", quantity(report.makespan_s, 1, "s")),
        ("clearance between robots", quantity(report.min_robot_clearance_m, 3, "m")),
    ]);
    let of_each = report.robots.iter().enumerate().map(|(index, robot)| row(index, robot));
    let mut text = format!("{of_all}\n\n{}", rows(&HEADER, of_each.collect(), 3));
    let reasons = report.robots.iter().enumerate();
    let reasons = reasons.filter_map(|(index, robot)| Some((index, robot.reason.as_ref()?)));
    for (place, (index, reason)) in reasons.enumerate() {
        let gap = if place == 0 { "\n\n" } else { "\n" };
        let _ = write!(text, "{gap}{}", paragraph(&format!("robot {index}: {reason}")));
    }
    text
}

fn row(index: usize, robot: &RobotReport) -> Vec<String> {
    let run = robot.run.as_ref();
    vec![
        index.to_string(),
        robot.inputs.stack.clone().unwrap_or_default(),
        robot.outcome.name().to_owned(),
        number(run.map(|run| run.time_s), 1),
        number(robot.plan.length_m, 2),
        number(run.map(|run| run.length_m), 2),
        number(run.and_then(|run| run.mean_speed_mps), 2),
        number(run.and_then(|run| run.min_clearance_m), 3),
        run.map_or_else(|| "-".to_owned(), |run| run.routes_planned.to_string()),
    ]
}
