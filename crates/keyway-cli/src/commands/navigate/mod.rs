//! `keyway navigate`: a map, a robot and a goal -> a drive.

mod drive;
mod episode;
mod result_files;
pub(super) mod team;
mod watch;

use super::Done;
use crate::args::{Format, NavigateArgs};
use crate::error::CliError;
use crate::report_text::{WithFiles, lowered, smoothed_facts};
use crate::smoothing_targets::SmoothingTargets;
use crate::stdout::print_files;
pub(super) use drive::{Driven, drive};
use episode::Given;
pub(super) use episode::{given, given_scene};
use keyway::local::RefusalCounts;
use keyway::navigate::RecoveryCounts;
use keyway_lab::table::{facts, quantity};
use keyway_sim::episode::{Episode, EpisodeOutcome};
use keyway_sim::report::{Placed, WayPointPart};
pub(super) use result_files::{FILES, prepared, wanted, write_all, write_files, written};
pub(crate) use watch::{Moment, Wanted};

pub(crate) fn run(args: &NavigateArgs) -> Result<Done, CliError> {
    let scene = given_scene(args)?;
    if let Some(scene) = scene.as_ref().filter(|scene| !scene.robots.is_empty()) {
        return team::run(args, scene);
    }
    let Given { episode, sources } = given(args, scene)?;
    warn_of_those_left_out(episode.random);
    // Before the run, which may take long, not after it.
    let out = prepared(&args.files, &sources)?;
    let driven = drive(&episode, wanted(&args.files))?;
    let files = write_all(&args.files, &episode, &driven, out)?;
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &driven.report, files: &files })?,
        Format::Table => {
            super::print(&table(&episode, &driven))?;
            print_files(&files)?;
        }
    }
    Ok(Done::when(driven.report.outcome == EpisodeOutcome::Reached))
}

/// A world with fewer random obstacles than were asked for is another one.
fn warn_of_those_left_out(random: Option<Placed>) {
    if let Some(left_out) = random.map(|placed| placed.left_out()).filter(|&n| n > 0) {
        let message =
            format!("{left_out} of the random obstacles found no place and were left out");
        crate::stdout::warn(message);
    }
}

pub(super) fn table(episode: &Episode, driven: &Driven) -> String {
    let report = &driven.report;
    let mut rows = vec![("outcome", report.outcome.name().to_owned())];
    rows.extend(report.reason.iter().map(|reason| ("reason", reason.clone())));
    rows.push(("stack", episode.stack_name.clone()));
    if !episode.via.is_empty() {
        let text = format!(
            "in {} legs; plan and smoothed path are those of the first",
            episode.via.len() + 1
        );
        rows.push(("route", text));
    }
    rows.push(("planned length", quantity(report.plan.length_m, 3, "m")));
    rows.extend(lowered(&report.plan));
    if let Some((smoothed, drive)) = report.smoothed.as_ref().zip(driven.drive.as_ref()) {
        let (clearance_m, cell_m) = (drive.route.clearance_m, episode.known.frame().resolution_m());
        let smoother = &episode.stack.smoother;
        let targets = SmoothingTargets::new(smoother, clearance_m, cell_m);
        rows.extend(smoothed_facts(smoothed, targets));
    }
    rows.extend(report.misfit.map(|misfit| ("on the route", format!("the robot {misfit}"))));
    if let Some(run) = &report.run {
        rows.extend([
            ("driven length", quantity(Some(run.length_m), 3, "m")),
            ("time", quantity(Some(run.time_s), 1, "s")),
            ("mean speed", quantity(run.mean_speed_mps, 3, "m/s")),
            ("clearance of the robot", quantity(run.min_clearance_m, 3, "m")),
        ]);
        if let Some(clearance_m) = run.min_mover_clearance_m {
            rows.push(("clearance from movers", quantity(Some(clearance_m), 3, "m")));
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
    }
    if let Some(way_points) = report.run.as_ref().and_then(|run| run.way_points.as_ref()) {
        rows.push(("way-points passed", passed(way_points)));
    }
    facts(rows)
}

/// What was tried, and how often.
fn recoveries(counts: RecoveryCounts) -> String {
    let RecoveryCounts { replan, turn, manoeuvre, back_up, wait, go_around } = counts;
    let kinds = [
        (replan, "replan"),
        (turn, "turn"),
        (manoeuvre, "manoeuvre"),
        (back_up, "back-up"),
        (wait, "wait"),
        (go_around, "way around movers"),
    ];
    counted(&kinds)
}

/// How many commands the stop rule has changed, and why.
fn refusals(counts: RefusalCounts) -> String {
    let RefusalCounts { standing, mover, unseen, out_of_sight, covered, not_a_number } = counts;
    counted(&[
        (standing, "before something standing"),
        (mover, "before a mover"),
        (unseen, "where it does not look"),
        (out_of_sight, "where it has not seen yet"),
        (covered, "inside an obstacle"),
        (not_a_number, "not a number"),
    ])
}

/// What there is some of.
fn counted(kinds: &[(u32, &str)]) -> String {
    let some = kinds.iter().filter(|(count, _)| *count > 0);
    let some: Vec<String> = some.map(|(count, kind)| format!("{count} {kind}")).collect();
    if some.is_empty() { "none".to_owned() } else { some.join(", ") }
}

/// When each way-point was passed.
fn passed(way_points: &[WayPointPart]) -> String {
    let time = |part: &WayPointPart| quantity(part.passed_s, 1, "s");
    way_points.iter().map(time).collect::<Vec<_>>().join(", ")
}
