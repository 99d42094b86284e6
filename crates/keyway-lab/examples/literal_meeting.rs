//! Cost of the literal reading of \[You2021\]'s meeting rule, and gain of its moving targets: two
//! tables of measurements on seeded random maps, for `docs/lab/findings.md`.
//!
//! `cargo run --release -p keyway-lab --example literal_meeting`

#[path = "support/random.rs"]
mod random;
#[path = "support/range.rs"]
mod range;

use keyway::geometry::Pose;
use keyway::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{
    AStar, BidirectionalJps, BidirectionalJpsConfig, BidirectionalJpsFixed, GlobalPlanner,
    JumpMeeting, Plan, PlanError,
};
use keyway::search::{Query, Workspace};
use random::Random;
use range::mean_and_range;
use std::error::Error;

/// Solvable queries of each kind of map.
const QUERIES: u64 = 4000;
/// Queries on each map.
const QUERIES_PER_MAP: u64 = 8;
/// Kinds of maps, and the cells along each side of one.
const MAPS: [(Kind, i32); 11] = [
    (Kind::Clutter(15), 5),
    (Kind::Clutter(20), 12),
    (Kind::Clutter(40), 12),
    (Kind::Walls(2), 12),
    (Kind::Clutter(5), 40),
    (Kind::Clutter(10), 40),
    (Kind::Clutter(20), 40),
    (Kind::Clutter(30), 40),
    (Kind::Clutter(40), 40),
    (Kind::Walls(8), 40),
    (Kind::Rooms, 40),
];

/// Kind of a random map.
#[derive(Clone, Copy)]
enum Kind {
    /// Each cell is an obstacle with this probability, in percent.
    Clutter(i32),
    /// This many walls across the whole map, each with two gaps of one cell.
    Walls(i32),
    /// Rooms of 7 x 7 cells, with a door of one cell in each wall between two.
    Rooms,
}

impl Kind {
    fn label(self) -> String {
        match self {
            Self::Clutter(percent) => format!("clutter, {percent} %"),
            Self::Walls(count) => format!("{count} walls with gaps"),
            Self::Rooms => "rooms with doors".to_owned(),
        }
    }

    fn map(self, side: i32, random: &mut Random) -> Result<SearchMap, Box<dyn Error>> {
        let mut is_blocked = vec![false; (side * side) as usize];
        let index = |x: i32, y: i32| (y * side + x) as usize;
        match self {
            Self::Clutter(percent) => {
                is_blocked.fill_with(|| random.below(100) < percent);
            }
            Self::Walls(count) => {
                for _ in 0..count {
                    let (at, gaps) = (random.below(side), [random.below(side), random.below(side)]);
                    let is_upright = random.below(2) == 0;
                    for along in (0..side).filter(|along| !gaps.contains(along)) {
                        let (x, y) = if is_upright { (at, along) } else { (along, at) };
                        is_blocked[index(x, y)] = true;
                    }
                }
            }
            Self::Rooms => {
                for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
                    is_blocked[index(x, y)] = x % 8 == 7 || y % 8 == 7;
                }
                for (room, wall) in (0..5).flat_map(|room| (0..4).map(move |wall| (room, wall))) {
                    let (east, north) = (random.below(7), random.below(7));
                    is_blocked[index(8 * wall + 7, 8 * room + east)] = false;
                    is_blocked[index(8 * room + north, 8 * wall + 7)] = false;
                }
            }
        }
        let frame = GridFrame::new(side as u64, side as u64, 1.0, Pose::default())?;
        let grid = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
            if is_blocked[index(x, y)] { CellState::Occupied } else { CellState::Free }
        });
        Ok(SearchMap::new(&grid, LayerConfig::default())?)
    }
}

/// Results of one planner on all queries of a kind; one value for each query that it answered.
#[derive(Default)]
struct Tally {
    missed: u64,
    expanded: Vec<f64>,
    /// Length / shortest length - 1, in per cent.
    excess: Vec<f64>,
    not_shortest: u64,
}

impl Tally {
    fn add(&mut self, result: Result<(), PlanError>, plan: &Plan, shortest: &Plan) {
        match result {
            Ok(()) => {
                self.expanded.push(plan.statistics.expanded() as f64);
                self.excess.push(100.0 * (plan.cost.cells() / shortest.cost.cells() - 1.0));
                self.not_shortest += u64::from(plan.cost > shortest.cost);
            }
            Err(PlanError::Missed { .. }) => self.missed += 1,
            Err(other) => unreachable!("{other}"),
        }
    }

    fn join(&mut self, other: &Self) {
        self.missed += other.missed;
        self.expanded.extend(&other.expanded);
        self.excess.extend(&other.excess);
        self.not_shortest += other.not_shortest;
    }

    fn asked(&self) -> u64 {
        self.missed + self.expanded.len() as u64
    }

    fn not_shortest_percent(&self) -> f64 {
        100.0 * self.not_shortest as f64 / self.expanded.len() as f64
    }
}

/// Moving targets with the literal and the default rule, fixed targets.
fn planners() -> Result<[Box<dyn GlobalPlanner>; 3], PlanError> {
    let meeting = JumpMeeting::Literal;
    let literal = BidirectionalJpsConfig { meeting, ..BidirectionalJpsConfig::PAPER };
    Ok([
        Box::new(BidirectionalJps::new(literal)?),
        Box::new(BidirectionalJps::default()),
        Box::new(BidirectionalJpsFixed::default()),
    ])
}

/// Gives all planners the same solvable queries, with different starts and goals.
fn measure(kind: Kind, side: i32, seed: u64) -> Result<[Tally; 3], Box<dyn Error>> {
    let (mut random, planners) = (Random(seed), planners()?);
    let (mut workspace, mut plan, mut shortest) =
        (Workspace::default(), Plan::default(), Plan::default());
    let mut tallies = [Tally::default(), Tally::default(), Tally::default()];
    let mut asked = 0;
    while asked < QUERIES {
        let map = kind.map(side, &mut random)?;
        for _ in 0..QUERIES_PER_MAP {
            let query = Query::new(random.cell(side), random.cell(side));
            let optimum =
                AStar::default().plan_into(&map, &query, &mut workspace, None, &mut shortest);
            if optimum.is_err() || query.start == query.goal {
                continue;
            }
            asked += 1;
            for (planner, tally) in planners.iter().zip(&mut tallies) {
                let result = planner.plan_into(&map, &query, &mut workspace, None, &mut plan);
                tally.add(result, &plan, &shortest);
            }
        }
    }
    Ok(tallies)
}

/// The cells of three planners.
fn cells(tallies: &[Tally; 3], values: fn(&Tally) -> &[f64]) -> String {
    tallies.each_ref().map(|tally| mean_and_range(values(tally), 2)).join(" | ")
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut rows: Vec<(String, [Tally; 3])> = Vec::new();
    let mut all = [Tally::default(), Tally::default(), Tally::default()];
    for (seed, (kind, side)) in (1..).zip(MAPS) {
        let tallies = measure(kind, side, seed)?;
        all.iter_mut().zip(&tallies).for_each(|(all, tally)| all.join(tally));
        rows.push((format!("{side} x {side}, {}", kind.label()), tallies));
    }
    rows.push(("all".to_owned(), all));
    println!(
        "| map | queries | missed: literal | generated | expanded: literal | generated | fixed targets |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for (label, tallies) in &rows {
        let [literal, generated, _] = tallies;
        let percent = 100.0 * literal.missed as f64 / literal.asked() as f64;
        let expanded = cells(tallies, |tally| &tally.expanded);
        println!(
            "| {label} | {} | {} ({percent:.2} %) | {} | {expanded} |",
            literal.asked(),
            literal.missed,
            generated.missed
        );
    }
    println!(
        "\n| map | excess, %: literal | generated | fixed targets | not shortest: generated |"
    );
    println!("|---|--:|--:|--:|--:|");
    for (label, tallies) in &rows {
        let excess = cells(tallies, |tally| &tally.excess);
        println!("| {label} | {excess} | {:.0} % |", tallies[1].not_shortest_percent());
    }
    Ok(())
}
