//! An estimate of the cost of a preparation, from patches of the graph of corner cells.

use super::graph::{Edge, Scanner};
use super::labels::{Entry, Hop, Labels};
use super::order::order_of_importance;
use super::{PrepareError, Prepared, inverse, renamed};
use crate::map::{Cell, SearchMap};
use crate::plan::{GlobalPlanner, Jps, Plan};
use crate::random::Random;
use crate::search::{Query, Workspace};
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// The largest number of corner cells of a patch, and of the edges from them: a corner cell with
/// many edges takes long.
const PATCH_CORNERS: usize = 4000;
const PATCH_EDGES: usize = 160_000;

/// A smaller patch within a patch has one corner cell in this many.
const SMALLER: usize = 4;

/// The largest number of patches, and the number of edges after which no further patch begins.
const PATCHES: usize = 3;
const EDGES: usize = 300_000;

/// Bytes per entry while labels are built: two parts of 8 bytes that grow by doubling.
const GROWING_ENTRY_BYTES: f64 = 24.0;

/// Number of paths in the timing of jump point search, and the time after which no further one
/// begins \[s\].
const PATHS: usize = 64;
const PATHS_TIME_S: f64 = 0.2;

/// An estimate of the cost of a preparation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PreparationEstimate {
    /// Cells at which shortest paths may turn: an exact count.
    pub corner_cells: u64,
    /// Entries of all labels.
    pub label_entries: u64,
    /// Memory on the heap after the preparation \[bytes\].
    pub memory_bytes: u64,
    /// Peak memory on the heap during the preparation \[bytes\].
    pub peak_bytes: u64,
    /// Time of the preparation \[s\].
    pub time_s: f64,
    /// Mean time of a path between corner cells by jump point search \[s\]; `None` if no path was
    /// found.
    pub jps_s: Option<f64>,
}

impl PreparationEstimate {
    /// The number of paths that jump point search finds in the time of the preparation: for fewer
    /// paths, preparation does not pay. `None` if no path was found.
    pub fn pays_from_paths(&self) -> Option<f64> {
        self.jps_s.map(|jps_s| self.time_s / jps_s)
    }
}

impl Prepared {
    /// Estimates the cost of [`Self::build`], in about a second at most, whatever the map.
    ///
    /// Patches of the map are prepared at two sizes. Their cost per corner cell is extrapolated to
    /// the number of all corner cells by a power law. `clock` returns the time \[s\] since an
    /// arbitrary moment.
    ///
    /// # Errors
    /// Returns an error if the map cannot be prepared, as far as the patches show.
    pub fn estimate(
        map: &SearchMap,
        clock: impl Fn() -> f64,
    ) -> Result<PreparationEstimate, PrepareError> {
        let corners = Self::corners_of(map)?;
        let cells: Vec<Cell> = corners.iter().collect();
        let mut random = Random::new(0);
        let each = mean_cost(&Scanner::new(map, &corners), &cells, &mut random, &clock)?;
        let count = cells.len() as f64;
        let (entries, edges) = (each.entries * count, each.edges * count);
        let bits = corners.memory_bytes() + map.diagonal_events().memory_bytes();
        let tables = (size_of::<Cell>() + 2 * size_of::<u32>()) * cells.len();
        let entry_bytes = (size_of::<Entry>() + size_of::<Hop>()) as f64;
        let memory_bytes = (bits + tables) as f64 + entry_bytes * entries;
        let growing = GROWING_ENTRY_BYTES * entries + 2.0 * size_of::<Edge>() as f64 * edges;
        Ok(PreparationEstimate {
            corner_cells: cells.len() as u64,
            label_entries: entries.round() as u64,
            memory_bytes: memory_bytes.round() as u64,
            peak_bytes: (memory_bytes + growing).round() as u64,
            time_s: each.time_s * count,
            jps_s: jps_time_s(map, &cells, &mut random, &clock),
        })
    }
}

/// The mean costs per corner cell of the map, from patches around random corner cells.
fn mean_cost(
    scanner: &Scanner<'_>,
    cells: &[Cell],
    random: &mut Random,
    clock: impl Fn() -> f64,
) -> Result<Cost, PrepareError> {
    let (mut sum, mut patches, mut edges) = (Cost::default(), 0, 0);
    while !cells.is_empty() && patches < PATCHES && edges < EDGES {
        let begin = clock();
        let patch = Patch::new(scanner, cells, random.below(cells.len() as u32));
        let size = patch.corners.len();
        let scan_s = (clock() - begin) / size as f64;
        let mut own = patch.cost(cells, size, &clock)?;
        if patch.goes_on {
            let small = patch.cost(cells, size.div_ceil(SMALLER), &clock)?;
            own = own.carried_on(&small, cells.len() as f64);
        }
        own.time_s += scan_s;
        if size == cells.len() {
            return Ok(own);
        }
        sum = sum.plus(&own);
        patches += 1;
        edges += patch.edges.iter().map(Vec::len).sum::<usize>();
    }
    Ok(sum.times(1.0 / patches.max(1) as f64))
}

/// The costs of preparing some corner cells, per corner cell.
#[derive(Clone, Copy, Default)]
struct Cost {
    /// The number of corner cells.
    corners: f64,
    entries: f64,
    /// Edges, each counted from both of its ends.
    edges: f64,
    time_s: f64,
}

impl Cost {
    fn plus(&self, other: &Self) -> Self {
        Self {
            corners: self.corners + other.corners,
            entries: self.entries + other.entries,
            edges: self.edges + other.edges,
            time_s: self.time_s + other.time_s,
        }
    }

    fn times(&self, factor: f64) -> Self {
        Self {
            corners: self.corners * factor,
            entries: self.entries * factor,
            edges: self.edges * factor,
            time_s: self.time_s * factor,
        }
    }

    /// Extrapolates the costs per corner cell to `corners` corner cells, from a patch and a
    /// smaller one.
    fn carried_on(&self, small: &Self, corners: f64) -> Self {
        let carried = |at: f64, before: f64| {
            let power = (at / before).ln() / (self.corners / small.corners).ln();
            let power = if power.is_finite() { power.clamp(0.0, 2.0) } else { 0.0 };
            at * (corners / self.corners).powf(power)
        };
        Self {
            corners,
            entries: carried(self.entries, small.entries),
            edges: self.edges,
            time_s: carried(self.time_s, small.time_s),
        }
    }
}

/// The corner cells nearest to one of them.
struct Patch {
    corners: Vec<u32>,
    places: HashMap<u32, u32>,
    edges: Vec<Vec<Edge>>,
    /// True if there are corner cells beyond the patch.
    goes_on: bool,
}

impl Patch {
    fn new(scanner: &Scanner<'_>, cells: &[Cell], from: u32) -> Self {
        let (mut corners, mut edges, mut edge_count) = (Vec::new(), Vec::new(), 0);
        let mut places = HashMap::new();
        let mut open = BinaryHeap::from([Reverse((0, from))]);
        while corners.len() < PATCH_CORNERS && edge_count < PATCH_EDGES {
            let Some(Reverse((key, corner))) = open.pop() else { break };
            if places.contains_key(&corner) {
                continue;
            }
            places.insert(corner, corners.len() as u32);
            corners.push(corner);
            let own = scanner.edges(cells[corner as usize]);
            let beyond = own.iter().filter(|edge| !places.contains_key(&edge.to));
            open.extend(beyond.map(|edge| Reverse((key + edge.key, edge.to))));
            edge_count += own.len();
            edges.push(own);
        }
        let goes_on = open.iter().any(|Reverse((_, corner))| !places.contains_key(corner));
        Self { corners, places, edges, goes_on }
    }

    /// The costs of preparing the first corner cells of the patch alone.
    fn cost(
        &self,
        cells: &[Cell],
        count: usize,
        clock: impl Fn() -> f64,
    ) -> Result<Cost, PrepareError> {
        let graph: Vec<Vec<Edge>> =
            self.edges[..count].iter().map(|edges| self.kept(edges, count)).collect();
        let begin = clock();
        let order = order_of_importance(&graph, |_| Ok(()))?;
        let cells: Vec<Cell> =
            order.iter().map(|&place| cells[self.corners[place as usize] as usize]).collect();
        let labels = Labels::new(&renamed(&graph, &order, &inverse(&order)), &cells, |_| Ok(()))?;
        let each = |sum: usize| sum as f64 / count as f64;
        Ok(Cost {
            corners: count as f64,
            entries: each(labels.entries.len()),
            edges: each(self.edges[..count].iter().map(Vec::len).sum()),
            time_s: (clock() - begin) / count as f64,
        })
    }

    /// The edges among the first corner cells.
    fn kept(&self, edges: &[Edge], count: usize) -> Vec<Edge> {
        let place = |edge: &Edge| self.places.get(&edge.to).filter(|&&to| (to as usize) < count);
        edges.iter().filter_map(|edge| place(edge).map(|&to| Edge { to, key: edge.key })).collect()
    }
}

/// The mean time of a path between random corner cells by jump point search \[s\].
fn jps_time_s(
    map: &SearchMap,
    cells: &[Cell],
    random: &mut Random,
    clock: impl Fn() -> f64,
) -> Option<f64> {
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let (mut found, mut sum_s, begin) = (0_u32, 0.0, clock());
    for _ in 0..PATHS {
        let [start, goal] =
            [0; 2].map(|_| cells.get(random.below(cells.len() as u32) as usize).copied());
        let query = Query::new(start?, goal?);
        let before = clock();
        if Jps.plan_into(map, &query, &mut workspace, None, &mut plan).is_ok() {
            found += 1;
            sum_s += clock() - before;
        }
        if clock() - begin > PATHS_TIME_S {
            break;
        }
    }
    (found > 0).then(|| sum_s / f64::from(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid, UnknownPolicy};
    use std::cell::Cell as Counter;

    /// A map on which this share of the cells is blocked, at random.
    fn clutter(size: usize, share: f64) -> SearchMap {
        let mut random = Random::new(3);
        let mut row =
            || (0..size).map(|_| if random.is_chosen(share) { '#' } else { '.' }).collect();
        let rows: Vec<String> = (0..size).map(|_| row()).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        SearchMap::new(&OccupancyGrid::from_ascii(&rows), LayerConfig::default()).unwrap()
    }

    /// A clock that advances by a second at each reading.
    fn ticks() -> impl Fn() -> f64 {
        let time = Counter::new(0.0);
        move || time.replace(time.get() + 1.0)
    }

    fn expect_about(estimated: u64, found: u64, tolerance: f64) {
        let ratio = estimated as f64 / found as f64;
        assert!((1.0 / tolerance..tolerance).contains(&ratio), "{estimated} for {found}");
    }

    #[test]
    fn the_whole_of_a_small_map() {
        let map = clutter(60, 0.1);
        let made = Prepared::build(&map).unwrap().preparation();
        let estimate = Prepared::estimate(&map, ticks()).unwrap();
        assert_eq!(estimate.corner_cells, made.corner_cells);
        expect_about(estimate.label_entries, made.label_entries, 1.1);
        expect_about(estimate.memory_bytes, made.memory_bytes as u64, 1.1);
        assert!(estimate.peak_bytes > estimate.memory_bytes);
        // One tick to scan the map and one to prepare it; one per path.
        assert!((estimate.time_s - 2.0).abs() < 1e-9 && estimate.jps_s == Some(1.0));
        assert!((estimate.pays_from_paths().unwrap() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn carried_on_to_a_large_map() {
        let map = clutter(190, 0.35);
        let made = Prepared::build(&map).unwrap().preparation();
        assert!(made.corner_cells > 2 * PATCH_CORNERS as u64, "{made:?}");
        let estimate = Prepared::estimate(&map, ticks()).unwrap();
        assert_eq!(estimate, Prepared::estimate(&map, ticks()).unwrap());
        expect_about(estimate.label_entries, made.label_entries, 1.3);
        expect_about(estimate.memory_bytes, made.memory_bytes as u64, 1.3);
    }

    #[test]
    fn costs_grow_as_between_two_sizes() {
        let cost =
            |corners: f64, entries: f64, time_s: f64| Cost { corners, entries, edges: 7.0, time_s };
        let carried = cost(4000.0, 60.0, 0.3).carried_on(&cost(1000.0, 30.0, 0.3), 64_000.0);
        assert!((carried.entries - 240.0).abs() < 1e-9 && (carried.time_s - 0.3).abs() < 1e-12);
        assert!((carried.edges - 7.0).abs() < 1e-12);
        // The cost per corner cell does not fall on a larger map, and a time of 0 is not
        // extrapolated.
        let carried = cost(4000.0, 30.0, 0.0).carried_on(&cost(1000.0, 40.0, 0.0), 64_000.0);
        assert!((carried.entries - 30.0).abs() < 1e-9 && carried.time_s.abs() < 1e-12);
    }

    #[test]
    fn maps_without_corners_or_with_penalties() {
        let open =
            SearchMap::new(&OccupancyGrid::from_ascii(&["..", ".."]), LayerConfig::default());
        let estimate = Prepared::estimate(&open.unwrap(), ticks()).unwrap();
        assert_eq!((estimate.corner_cells, estimate.label_entries), (0, 0));
        assert_eq!((estimate.jps_s, estimate.pays_from_paths()), (None, None));
        let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
        let map = SearchMap::new(&OccupancyGrid::from_ascii(&[".?", ".."]), config).unwrap();
        assert_eq!(Prepared::estimate(&map, ticks()), Err(PrepareError::NeedsUniformCost));
    }
}
