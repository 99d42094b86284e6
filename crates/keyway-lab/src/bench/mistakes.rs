//! Wrong answers: the line of each query, the expected answer and the given one.

use keyway::map::Cell;
use serde::Serialize;

/// Maximum number of mistakes listed below the table.
const LINES: usize = 10;

/// An answer that is counted as a mismatch or as an illegal path.
#[derive(Clone, Debug, Serialize)]
pub struct Mistake {
    /// Path of the scenario file.
    pub(super) scenarios: String,
    /// Line of the query there, from 1.
    pub(super) line: usize,
    pub(super) planner: &'static str,
    pub(super) start: Cell,
    pub(super) goal: Cell,
    /// Published length of the best path; `None` if no path exists.
    pub(super) expected_cells: Option<f64>,
    pub(super) got: Got,
    /// Length of the path that was found, if it is legal.
    pub(super) got_cells: Option<f64>,
}

/// Answer that differs from the expected one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Got {
    /// A path of a wrong length, or for a query without a path.
    Path,
    IllegalPath,
    NoPath,
    /// The planner reports that a path exists that it did not find.
    Missed,
}

/// Text below the table; `None` without mistakes.
pub fn mistakes_note(mistakes: &[Mistake]) -> Option<String> {
    let mut lines: Vec<String> = mistakes.iter().take(LINES).map(line).collect();
    if let Some(more) = mistakes.len().checked_sub(LINES).filter(|&more| more > 0) {
        lines.push(format!("and {more} more; `--format json` lists all of them"));
    }
    let head = "\nWrong answers (cells are counted from the lower left):";
    (!lines.is_empty()).then(|| format!("{head}\n  {}", lines.join("\n  ")))
}

fn line(mistake: &Mistake) -> String {
    let Mistake { scenarios, line, planner, start, goal, .. } = mistake;
    let cells =
        |length: Option<f64>| length.map_or_else(String::new, |l| format!(" of {l:.3} cells"));
    let expected = match mistake.expected_cells {
        None => "no path".to_owned(),
        length => format!("a path{}", cells(length)),
    };
    let got = match mistake.got {
        Got::Path => format!("one{}", cells(mistake.got_cells)),
        Got::IllegalPath => "an illegal one".to_owned(),
        Got::NoPath => "none".to_owned(),
        Got::Missed => "a report that it missed the path".to_owned(),
    };
    format!(
        "{scenarios}, line {line}: {planner}, {start} to {goal}: expected {expected}, got {got}"
    )
}
