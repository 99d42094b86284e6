//! Key points of [You2021] chosen from jump points, as in the paper, and from all cells: the
//! share of paths that differ, and of those that keep D. Prints a table of measurements on seeded
//! random maps, for `docs/lab/findings.md`.
//!
//! `cargo run --release -p keyway-lab --example key_point_candidates`

#[path = "support/random.rs"]
mod random;
#[path = "support/range.rs"]
mod range;

use keyway::ConfigError;
use keyway::geometry::Pose;
use keyway::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{BidirectionalJps, GlobalPlanner, Plan};
use keyway::search::{Query, Workspace};
use keyway::smooth::{
    KeyPointCandidates, KeyPointSmoothing, KeyPointSmoothingConfig, Smoothed, Smoother,
};
use random::Random;
use range::mean_and_range;
use std::error::Error;

/// Solvable queries of each kind of map.
const QUERIES: u64 = 4000;
/// Queries with random starts and goals on each map.
const QUERIES_PER_MAP: u64 = 8;
/// Cells along each side of a map, the share of obstacles in percent, and the kind of starts and
/// goals.
const MAPS: [(i32, i32, Ends); 9] = [
    (20, 5, Ends::Corners),
    (20, 10, Ends::Corners),
    (20, 20, Ends::Corners),
    (20, 5, Ends::Random),
    (20, 10, Ends::Random),
    (20, 20, Ends::Random),
    (40, 5, Ends::Random),
    (40, 10, Ends::Random),
    (40, 20, Ends::Random),
];

/// Kind of starts and goals.
#[derive(Clone, Copy)]
enum Ends {
    /// Two opposite corners of the map; one query on each map.
    Corners,
    /// Any two cells.
    Random,
}

impl Ends {
    const fn label(self) -> &'static str {
        match self {
            Self::Corners => "corner to corner",
            Self::Random => "random ends",
        }
    }

    fn queries(self, side: i32, random: &mut Random) -> Vec<Query> {
        match self {
            Self::Corners => vec![Query::new(Cell::new(0, 0), Cell::new(side - 1, side - 1))],
            Self::Random => (0..QUERIES_PER_MAP)
                .map(|_| Query::new(random.cell(side), random.cell(side)))
                .collect(),
        }
    }
}

impl Random {
    fn map(&mut self, side: i32, percent: i32) -> Result<SearchMap, Box<dyn Error>> {
        let mut is_blocked = vec![false; (side * side) as usize];
        is_blocked.fill_with(|| self.below(100) < percent);
        let frame = GridFrame::new(side as u64, side as u64, 1.0, Pose::default())?;
        let grid = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
            if is_blocked[(y * side + x) as usize] { CellState::Occupied } else { CellState::Free }
        });
        Ok(SearchMap::new(&grid, LayerConfig::default())?)
    }
}

/// Results of one variant on all paths of a kind.
#[derive(Default)]
struct Tally {
    keeps_safe_distance: u64,
    /// Length / planned length - 1 of each path, in per cent.
    change: Vec<f64>,
    /// Number of segments of each path.
    segments: Vec<f64>,
}

impl Tally {
    fn add(&mut self, done: &Smoothed, planned_m: f64) {
        self.keeps_safe_distance += u64::from(done.kept_clearance_m.is_none());
        self.change.push(100.0 * (done.path.length_m() / planned_m - 1.0));
        self.segments.push(done.path.pieces().len() as f64);
    }
}

fn smoother(candidates: KeyPointCandidates) -> Result<KeyPointSmoothing, ConfigError> {
    KeyPointSmoothing::new(KeyPointSmoothingConfig { candidates, ..KeyPointSmoothingConfig::PAPER })
}

/// Smooths the same paths with both variants, jump points first. Also returns the number of paths
/// that differ, and the number of all paths.
fn measure(
    (side, percent, ends): (i32, i32, Ends),
    seed: u64,
) -> Result<([Tally; 2], u64, u64), Box<dyn Error>> {
    let (mut random, planner) = (Random(seed), BidirectionalJps::default());
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let smoothers =
        [smoother(KeyPointCandidates::JumpPoints)?, smoother(KeyPointCandidates::Cells)?];
    let (mut tallies, mut differ, mut paths) = ([Tally::default(), Tally::default()], 0, 0);
    while paths < QUERIES {
        let map = random.map(side, percent)?;
        for query in ends.queries(side, &mut random) {
            let result = planner.plan_into(&map, &query, &mut workspace, None, &mut plan);
            if result.is_err() || query.start == query.goal {
                continue;
            }
            let [start, goal] =
                [query.start, query.goal].map(|cell| map.frame().world_from_cell(cell));
            let line = plan.line(&map, start, goal);
            let done = smoothers.each_ref().map(|one| one.smooth(&line, &map.clearance(), 0.0));
            paths += 1;
            differ += u64::from(done[0].path != done[1].path);
            for (tally, done) in tallies.iter_mut().zip(&done) {
                tally.add(done, line.polyline().length_m());
            }
        }
    }
    Ok((tallies, differ, paths))
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| map | paths | differ | D is kept: jump points | cells | length, %: jump points | cells | \
         segments: jump points | cells |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    for (seed, (side, percent, ends)) in (1..).zip(MAPS) {
        let (tallies, differ, paths) = measure((side, percent, ends), seed)?;
        let per_path = |sum: f64| sum / paths as f64;
        let keeps = tallies.each_ref().map(|tally| per_path(tally.keeps_safe_distance as f64));
        let change = tallies.each_ref().map(|tally| mean_and_range(&tally.change, 1));
        let segments = tallies.each_ref().map(|tally| mean_and_range(&tally.segments, 2));
        println!(
            "| {side} x {side}, clutter, {percent} %, {} | {paths} | {:.0} % | {:.2} | {:.2} | {} | {} | \
             {} | {} |",
            ends.label(),
            100.0 * per_path(differ as f64),
            keeps[0],
            keeps[1],
            change[0],
            change[1],
            segments[0],
            segments[1],
        );
    }
    Ok(())
}
