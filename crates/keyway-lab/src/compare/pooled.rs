//! Rows over all maps of a comparison.

use super::Compared;
use super::contest::ContestEntry;
use super::row::{ALL_MAPS, CompareRow, row};

/// Returns a row for each planner and smoother with answers on every map; none for a single map.
pub(super) fn pooled(maps: &[Compared]) -> Vec<CompareRow> {
    let [first, _, ..] = maps else { return Vec::new() };
    let over_all = |one: &ContestEntry| {
        let parts: Option<Vec<_>> =
            maps.iter().map(|map| Some((of(map, one)?, &map.counts[..]))).collect();
        Some(row(ALL_MAPS, &parts?))
    };
    first.contest.entries.iter().filter_map(over_all).collect()
}

/// Returns the answers of the same planner and smoother on a map.
fn of<'a>(map: &'a Compared, one: &ContestEntry) -> Option<&'a ContestEntry> {
    let names = |entry: &ContestEntry| (entry.planner, entry.smoother);
    map.contest.entries.iter().find(|entry| names(entry) == names(one))
}
