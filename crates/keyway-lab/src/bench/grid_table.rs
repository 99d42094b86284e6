//! The table for display.

use super::tally::GridRow;
use crate::table::{number, percent, range, rows};

/// Range of a mean, as a line below it.
fn below(low: Option<f64>, high: Option<f64>, shown: fn(Option<f64>) -> String) -> String {
    let range = range(low, high, shown);
    if range.is_empty() { range } else { format!("\n{range}") }
}

/// Table of rows for the terminal.
pub fn grid_table(grid_rows: &[GridRow]) -> String {
    let header = [
        "map",
        "planner",
        "solved",
        "mis-\nmatches",
        "illegal",
        "missed",
        "median\nus",
        "p99\nus",
        "cpu\nus",
        "ex-\npanded",
        "excess\n%",
        "prep\nms",
        "MB",
    ];
    let cells = |row: &GridRow| {
        vec![
            row.map.clone(),
            row.planner.to_owned(),
            format!("{}/{}", row.solved, row.queries),
            row.mismatches.to_string(),
            row.illegal_paths.to_string(),
            row.missed.to_string(),
            number(row.median_us, 1),
            number(row.p99_us, 1),
            number(row.mean_cpu_us, 1) + &below(row.p5_cpu_us, row.p95_cpu_us, |us| number(us, 0)),
            number(row.mean_expanded, 0)
                + &below(row.p5_expanded, row.p95_expanded, |count| number(count, 0)),
            percent(row.mean_excess, 3)
                + &below(row.p5_excess, row.p95_excess, |share| percent(share, 1)),
            number(Some(row.preprocessing_ms), 2),
            number(Some(row.memory_bytes as f64 / 1e6), 1),
        ]
    };
    rows(&header, grid_rows.iter().map(cells).collect(), 2)
}
