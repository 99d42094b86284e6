//! Planners on the queries of MovingAI scenario files: their times, and their wrong answers.
//!
//! Planners take turns, round by round: each answers all queries, then the next one does, and so
//! on. Each planner thus runs on caches that are warm with its own data, as in real use, and a
//! temporary disturbance of the machine affects all planners alike. For each query, the fastest
//! round counts.
//!
//! A [`ScaleRequest`] instead measures time and memory as functions of the map size.

mod contender;
mod grid_file;
mod grid_table;
mod mistakes;
mod raw_map;
mod scale;
mod tally;

pub use grid_file::{GridFile, GridFileError};
pub use grid_table::grid_table;
pub use mistakes::{Mistake, mistakes_note};
pub use raw_map::RawMap;
pub use scale::{
    ScaleCurve, ScaleCurves, ScaleError, ScaleReport, ScaleRequest, ScaleRow, ScaleTask,
    scale_table,
};
pub use tally::{GridAnswer, GridRow};

use crate::progress::Progress;
use contender::Contender;
use keyway::ConfigError;
use keyway::navigate::Stack;
use keyway::plan::PlanError;
use std::time::Duration;
use tally::row;
use thiserror::Error;

/// Planners that are to answer queries, and the number of rounds.
#[derive(Clone, Copy, Debug)]
pub struct GridRequest<'a> {
    /// The planners, each with its layers.
    pub stacks: &'a [Stack],
    /// Number of times each query is answered; the fastest time counts.
    pub repeat: u64,
}

/// All results of a scenario file.
pub struct FileResult {
    /// A row for each planner.
    pub rows: Vec<GridRow>,
    /// The wrong answers.
    pub mistakes: Vec<Mistake>,
    answers: Vec<Vec<GridAnswer>>,
}

/// Error of planners on a map.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GridError {
    /// A planner's layers cannot be derived.
    #[error(transparent)]
    Map(ConfigError),
    /// A planner cannot be used.
    #[error(transparent)]
    Planner(PlanError),
    /// The observer stopped the measurement.
    #[error("stopped before the end")]
    Stopped,
}

impl GridRequest<'_> {
    /// Answers the queries of a file.
    ///
    /// # Errors
    /// Returns [`GridError`] if a planner cannot be used on the map, or the observer stops the
    /// measurement. Queries without a path are results.
    pub fn on(&self, file: &GridFile, progress: &dyn Progress) -> Result<FileResult, GridError> {
        let GridFile { name, map_name, grid, raw, scenarios } = file;
        let prepare = |stack| Contender::prepare(stack, grid);
        let mut contenders = self.stacks.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
        progress.expect(self.repeat as usize * contenders.len() * scenarios.len());
        for round in 0..self.repeat {
            for contender in &mut contenders {
                for (i, scenario) in scenarios.iter().enumerate() {
                    if round == 0 {
                        let answer = contender.answer(scenario, raw);
                        contender.answers.push(answer);
                    } else {
                        let times = contender.plan(scenario).1;
                        contender.answers[i].times.keep_faster(times);
                    }
                    if progress.answered().is_break() {
                        return Err(GridError::Stopped);
                    }
                }
            }
        }
        let mistakes = contenders.iter().flat_map(|contender| contender.mistakes(name, scenarios));
        let mistakes = mistakes.collect();
        let rows = contenders.iter().map(|contender| contender.row(map_name.clone())).collect();
        let answers = contenders.into_iter().map(|contender| contender.answers).collect();
        Ok(FileResult { rows, mistakes, answers })
    }
}

impl GridRow {
    /// True if no answer contradicts the published one, and every path is legal.
    pub const fn is_sound(&self) -> bool {
        self.mismatches == 0 && self.illegal_paths == 0
    }
}

/// Returns a row for each planner over the answers of all files, which are taken out of them.
pub fn totals(stacks: &[Stack], files: &mut [FileResult]) -> Vec<GridRow> {
    let total = |(i, stack): (usize, &Stack)| {
        let answers: Vec<GridAnswer> =
            files.iter_mut().flat_map(|file| std::mem::take(&mut file.answers[i])).collect();
        let of_planner = files.iter().map(|file| &file.rows[i]);
        let preparation_ms: f64 = of_planner.clone().map(|row| row.preprocessing_ms).sum();
        let memory_bytes = of_planner.map(|row| row.memory_bytes).max().unwrap_or_default();
        let preparation = Duration::from_secs_f64(preparation_ms / 1e3);
        let (name, is_optimal) = (stack.planner.name(), stack.planner.is_optimal());
        row(format!("all {}", files.len()), name, is_optimal, &answers, (preparation, memory_bytes))
    };
    stacks.iter().enumerate().map(total).collect()
}
