//! Results of a run.

use super::clutter::occupied_share;
use super::row::{Row, RunId, World};
use super::team_row::of_all;
use crate::results::JournalEntry;
use keyway_sim::episode::{Episode, EpisodeReport};
use serde::{Deserialize, Serialize};

/// A finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The run as a whole.
    pub run: Row,
    /// The individual robots, if there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<Row>,
    /// Times of the run.
    pub measured: RunTimes,
}

/// Times of a run; they differ from run to run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunTimes {
    /// Wall-clock time of the whole run \[s\].
    pub wall_s: f64,
    /// Mean wall-clock time of a decision \[us\].
    pub mean_cycle_us: Option<f64>,
}

impl RunTimes {
    fn of(report: &EpisodeReport, wall_s: f64) -> Self {
        let runs = || report.robots.iter().filter_map(|robot| robot.run.as_ref());
        let cycles: f64 = runs().map(|run| run.cycles as f64).sum();
        let all_us = runs().filter_map(|run| Some(run.mean_cycle_us? * run.cycles as f64));
        let all_us = all_us.reduce(|sum, one| sum + one);
        Self { wall_s, mean_cycle_us: all_us.map(|all_us| all_us / cycles) }
    }
}

impl Record {
    /// Collects the results of a run with its report; `wall_s` is the wall-clock time.
    pub fn of(id: RunId<'_>, (episode, report): (&Episode, &EpisodeReport), wall_s: f64) -> Self {
        let measured = RunTimes::of(report, wall_s);
        let reference_time_s = episode.rules.reference_time_s;
        let world = World { occupied_share: occupied_share(episode), reference_time_s };
        let rows = report.robots.iter().map(|robot| Row::of(id, robot, &world));
        let mut robots: Vec<Row> = rows.collect();
        if let [_] = robots[..] {
            return Self { run: robots.swap_remove(0), robots: Vec::new(), measured };
        }
        for (index, row) in (0..).zip(&mut robots) {
            row.robot = Some(index);
        }
        let stack = id.stack.to_owned();
        let run = Row { stack, ..of_all(&robots, report.min_robot_clearance_m) };
        Self { run, robots, measured }
    }
}

impl JournalEntry for Record {
    const NOT_ONE: &'static str = "it is not the journal of a batch of this version of Keyway; move it away, or choose another folder";
    const BEGIN: &'static [u8] = b"{\"run\":{";
}
