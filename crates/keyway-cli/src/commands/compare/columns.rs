//! The table for people: in the terminal and in LaTeX.

use super::row::CompareRow;
use crate::table::number;
use keyway::search::CornerRule;

/// The first columns are names.
pub(super) const FIRST_NUMBER: usize = 4;
/// Means, but the worst excess, the least clearance and the medians of the times.
const HEADER: [&str; 16] = [
    "map",
    "planner",
    "smoother",
    "corners",
    "solved",
    "missed",
    "compared",
    "length m",
    "excess %",
    "worst %",
    "turns",
    "angle deg",
    "non-smooth",
    "least clearance m",
    "plan us",
    "smooth us",
];
const CLEARANCE: &str = "least clearance m";
/// A column that is only there where a path falls short of what was asked for.
const SHORTFALLS: &str = "shortfalls";

/// Header and rows.
pub(super) fn columns(rows: &[CompareRow]) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let mut header = HEADER.to_vec();
    let mut lines: Vec<Vec<String>> = rows.iter().map(cells).collect();
    let place = HEADER.iter().position(|name| *name == CLEARANCE).map(|place| place + 1);
    if let Some(place) = place.filter(|_| rows.iter().any(|row| row.shortfalls > 0)) {
        header.insert(place, SHORTFALLS);
        for (line, row) in lines.iter_mut().zip(rows) {
            let of = |all: usize| format!("{}/{all}", row.shortfalls);
            line.insert(
                place,
                Some(row.compared).filter(|&all| all > 0).map_or("-".to_owned(), of),
            );
        }
    }
    (header, lines)
}

fn cells(row: &CompareRow) -> Vec<String> {
    let corners = match row.corners {
        CornerRule::Forbid => "forbid",
        CornerRule::Allow => "allow",
    };
    vec![
        row.map.clone(),
        row.planner.to_owned(),
        row.smoother.to_owned(),
        corners.to_owned(),
        format!("{}/{}", row.solved, row.queries),
        row.missed.to_string(),
        row.compared.to_string(),
        number(row.mean_length_m, 3),
        percent(row.mean_excess),
        percent(row.max_excess),
        number(row.mean_turns, 1),
        number(row.mean_turning_angle_deg, 1),
        number(row.mean_non_smooth_turns, 1),
        number(row.min_clearance_m, 3),
        number(row.median_plan_us, 1),
        number(row.median_smooth_us, 1),
    ]
}

/// A share, without a sign where it is nothing after rounding.
fn percent(share: Option<f64>) -> String {
    number(share.map(|share| (share * 1e5).round() / 1e3 + 0.0), 3)
}
