//! Which starts and goals are compared: random ones, those of a file of pairs, or those of a scenario
//! file.

use super::names::MapNames;
use super::pairs::ends_of_pairs;
use crate::args::CompareArgs;
use crate::error::{CliError, Kind};
use crate::inputs::read_text;
use keyway::map::formats::{Scenario, read_scenarios_for};
use keyway::map::{Connectivity, GridFrame, SearchMap};
use keyway::search::{Query, random_queries};
use keyway_lab::compare::Ends;
use std::path::Path;

/// Queries on each map where no file gives any.
const RANDOM_QUERIES: usize = 10;
/// Millions of pairs.
const PAIRS_BYTES: u64 = 1 << 30;

/// The queries on one map: all those of a file, or this many of them, evenly spread.
pub(super) fn queries(
    args: &CompareArgs,
    (names, index): (&MapNames, usize),
    map: &SearchMap,
) -> Result<Vec<Ends>, CliError> {
    let (file, frame) = (names.path(index), map.frame());
    let all = if let Some(path) = &args.pairs {
        let text = read_text(path, PAIRS_BYTES, "--pairs")?;
        let blame = |line: usize, message: String| {
            let message = format!("{}: line {line}: {message}", path.display());
            CliError::new(Kind::Input, message).field("--pairs")
        };
        ends_of_pairs(&text, (names, index), frame)
            .map_err(|(line, message)| blame(line, message))?
    } else if let Some(path) = &args.scen {
        ends_of_scenarios(path, file, frame)?
    } else {
        return random_ends(args, file, map);
    };
    Ok(spread(all, args.queries))
}

/// Connected for every planner, even for those that do not cut corners.
fn random_ends(args: &CompareArgs, file: &Path, map: &SearchMap) -> Result<Vec<Ends>, CliError> {
    let count = args.queries.unwrap_or(RANDOM_QUERIES);
    let queries = random_queries(map, Connectivity::Four, count, args.seed);
    if queries.is_empty() {
        let clearance_m = map.config().clearance_m;
        let why = if clearance_m > 0.0 {
            format!("; the clearance of {clearance_m} m may be too large for it")
        } else {
            String::new()
        };
        let message = format!("{} has no two free cells that are connected{why}", file.display());
        return Err(CliError::new(Kind::Input, message).field("MAP"));
    }
    let ends = |query: &Query| Ends::of_cells(map.frame(), [query.start, query.goal], None);
    Ok(queries.iter().map(ends).collect())
}

fn ends_of_scenarios(path: &Path, map: &Path, frame: &GridFrame) -> Result<Vec<Ends>, CliError> {
    let blame = |message: String| CliError::new(Kind::Input, message).field("--scen");
    let scenarios = read_scenarios_for(path, frame).map_err(|error| blame(error.to_string()))?;
    // Many maps have the same size: without the name, those of another map would pass for this one's.
    let is_other = |one: &&Scenario| Path::new(&one.map).file_stem() != map.file_stem();
    if let Some(Scenario { line, map: other, .. }) = scenarios.iter().find(is_other) {
        let (path, map) = (path.display(), map.display());
        return Err(blame(format!("{path}: line {line}: for the map {other}, not for {map}")));
    }
    if scenarios.is_empty() {
        return Err(blame(format!("{}: there is no scenario", path.display())));
    }
    let ends = |one: &Scenario| Ends::of_cells(frame, [one.start, one.goal], Some(one.line));
    Ok(scenarios.iter().map(ends).collect())
}

/// This many of them, evenly spread, the first one among them; all of them where no number is
/// given.
fn spread<T>(all: Vec<T>, count: Option<usize>) -> Vec<T> {
    let total = all.len();
    let Some(count) = count.filter(|&count| count < total) else { return all };
    let is_kept = |i: usize| (i * count).div_ceil(total) != ((i + 1) * count).div_ceil(total);
    all.into_iter().enumerate().filter(|&(i, _)| is_kept(i)).map(|(_, item)| item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evenly_spread() {
        let all = |count| spread((0..10).collect(), count);
        assert_eq!(all(None), (0..10).collect::<Vec<i32>>());
        assert_eq!(all(Some(99)).len(), 10);
        assert_eq!((all(Some(2)), all(Some(1))), (vec![0, 5], vec![0]));
        for count in 1..=10 {
            assert_eq!((all(Some(count)).len(), all(Some(count))[0]), (count, 0));
        }
    }
}
