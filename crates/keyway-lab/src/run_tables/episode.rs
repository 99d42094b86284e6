//! Table of an episode.

use super::path_facts::{lowered, smoothed_facts};
use super::smoothing_targets::SmoothingTargets;
use crate::table::{facts, quantity};
use keyway::local::RefusalCounts;
use keyway::navigate::RecoveryCounts;
use keyway_sim::episode::RobotReport;
use keyway_sim::report::{RunPart, WayPointPart};

/// Table of an episode for the terminal; `targets` are those of the first route, if there is one.
pub fn episode_table(report: &RobotReport, targets: Option<SmoothingTargets>) -> String {
    let inputs = &report.inputs;
    let mut rows = vec![("outcome", report.outcome.name().to_owned())];
    rows.extend(report.reason.iter().map(|reason| ("reason", reason.clone())));
    rows.push(("stack", inputs.stack.clone().unwrap_or_default()));
    if let Some(via) = &inputs.via {
        let legs = via.len() + 1;
        let text =
            format!("in {legs} legs; the plan and the smoothed path are those of the first one");
        rows.push(("route", text));
    }
    rows.push(("planned length", quantity(report.plan.length_m, 3, "m")));
    rows.extend(lowered(&report.plan));
    if let Some((smoothed, targets)) = report.smoothed.as_ref().zip(targets) {
        rows.extend(smoothed_facts(smoothed, targets));
    }
    rows.extend(report.misfit.map(|misfit| ("on the route", format!("the robot {misfit}"))));
    let noticed = report.noticed.iter().flatten();
    rows.extend(noticed.map(|doubt| ("noticed", doubt.clone())));
    if let Some(run) = &report.run {
        rows.extend(run_facts(run));
        rows.extend(run.way_points.as_ref().map(|it| ("waypoints passed", passed(it))));
    }
    facts(rows)
}

/// Facts about a run, each with its name.
fn run_facts(run: &RunPart) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("driven length", quantity(Some(run.length_m), 3, "m")),
        ("time", quantity(Some(run.time_s), 1, "s")),
        ("mean speed", quantity(run.mean_speed_mps, 3, "m/s")),
        ("clearance of the robot", quantity(run.min_clearance_m, 3, "m")),
    ];
    if let Some(clearance_m) = run.min_mover_clearance_m {
        rows.push(("clearance from moving obstacles", quantity(Some(clearance_m), 3, "m")));
    }
    rows.extend([
        ("routes planned", run.routes_planned.to_string()),
        ("recoveries", recoveries(run.recoveries)),
    ]);
    rows.extend(run.unsafe_commands.map(|counts| ("commands changed", refusals(counts))));
    rows.extend([
        ("cycles", run.cycles.to_string()),
        ("time per cycle", quantity(run.mean_cycle_us, 0, "us")),
    ]);
    rows
}

/// Text of the recoveries that were tried, with their numbers.
fn recoveries(counts: RecoveryCounts) -> String {
    let RecoveryCounts { replan, turn, manoeuvre, back_up, wait, go_around, make_way } = counts;
    let kinds = [
        (replan, "replan"),
        (turn, "turn"),
        (manoeuvre, "manoeuvre"),
        (back_up, "back-up"),
        (wait, "wait"),
        (go_around, "detour around moving obstacles"),
        (make_way, "making way for moving obstacles"),
    ];
    counted(&kinds)
}

/// Text of the commands that the stop rule changed, with the reasons.
fn refusals(counts: RefusalCounts) -> String {
    let RefusalCounts { standing, mover, unseen, out_of_sight, covered, not_a_number } = counts;
    counted(&[
        (standing, "near a static obstacle"),
        (mover, "near a moving obstacle"),
        (unseen, "outside the field of view"),
        (out_of_sight, "in unobserved space"),
        (covered, "inside an obstacle"),
        (not_a_number, "not a number"),
    ])
}

/// Text of the kinds with a positive count.
fn counted(kinds: &[(u32, &str)]) -> String {
    let some = kinds.iter().filter(|(count, _)| *count > 0);
    let some: Vec<String> = some.map(|(count, kind)| format!("{count} {kind}")).collect();
    if some.is_empty() { "none".to_owned() } else { some.join(", ") }
}

/// Text of the times at which the waypoints were passed.
fn passed(way_points: &[WayPointPart]) -> String {
    let time = |part: &WayPointPart| quantity(part.passed_s, 1, "s");
    way_points.iter().map(time).collect::<Vec<_>>().join(", ")
}
