//! What is kept of a run.

use super::clutter::occupied_share;
use super::plan::Planned;
use super::row::{Row, World};
use super::team_row::of_all;
use crate::journal::Entry;
use keyway_sim::episode::{Team, TeamReport};
use serde::{Deserialize, Serialize};

/// A finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) run: Row,
    /// Where there are several, each by itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) robots: Vec<Row>,
    pub(super) measured: Measured,
}

/// What is never the same twice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Measured {
    /// Wall clock of the whole run \[s\].
    pub(super) wall_s: f64,
    /// Mean wall clock of a decision \[us\].
    pub(super) mean_cycle_us: Option<f64>,
}

impl Measured {
    pub(super) fn of(report: &TeamReport, wall_s: f64) -> Self {
        let runs = || report.robots.iter().filter_map(|robot| robot.run.as_ref());
        let cycles: f64 = runs().map(|run| run.cycles as f64).sum();
        let all_us = runs().filter_map(|run| Some(run.mean_cycle_us? * run.cycles as f64));
        let all_us = all_us.reduce(|sum, one| sum + one);
        Self { wall_s, mean_cycle_us: all_us.map(|all_us| all_us / cycles) }
    }
}

impl Entry for Record {
    const NOT_ONE: &'static str =
        "it is not the journal of a batch of this version; move it away, or choose another folder";
    const BEGIN: &'static [u8] = b"{\"run\":{";
}

impl Record {
    pub(super) fn of(planned: &Planned, team: &Team, report: &TeamReport, wall_s: f64) -> Self {
        let measured = Measured::of(report, wall_s);
        let world = World {
            occupied_share: occupied_share(team),
            reference_time_s: planned.reference_time_s(),
        };
        let rows = report.robots.iter().map(|robot| Row::of(planned.id(), robot, &world));
        let mut robots: Vec<Row> = rows.collect();
        if let [_] = robots[..] {
            return Self { run: robots.swap_remove(0), robots: Vec::new(), measured };
        }
        for (index, row) in (0..).zip(&mut robots) {
            row.robot = Some(index);
        }
        let stack = planned.stack.clone();
        let run = Row { stack, ..of_all(&robots, report.min_robot_clearance_m) };
        Self { run, robots, measured }
    }
}
