//! Prepared maps: preprocessing once per map -> shortest paths in a few microseconds, whatever the
//! map.
//!
//! Without corner cutting a shortest path turns only beside corners of obstacles. The preparation
//! finds these corner cells, connects those that see each other (a subgoal graph \[Uras2013\]),
//! and stores for each a hub label \[Abraham2012\]: a short list of nodes with exact distances, so
//! that the distance of any two corner cells is the smallest sum over the nodes in both lists. A
//! query scans from start and goal for the cells at which a path may turn first \[Harabor2011\],
//! and joins their lists. There is no graph search, and the paths are exactly as short as those of
//! A*.
//!
//! # Source
//! \[Uras2013\]: simple subgoal graphs, and algorithm 1 to find the directly reachable cells.
//! \[Harabor2011\]: the cells at which a path may turn. \[Geisberger2008\]: the order of the
//! nodes. \[Abraham2012\], \[Akiba2013\]: the labels and their construction.
//!
//! | papers | here |
//! |---|---|
//! | subgoals | corner cells, `Corners` |
//! | direct-h-reachable | in sight, `corner_graph` |
//! | jump points | `Sight::along`, `Turn` |
//! | label L(v), hub w, dist(v, w) | `Labels::of`, `Entry` |
//!
//! # Where this differs from the papers
//! - The order of the nodes comes from an approximate contraction of a sparse part of the graph.
//!   Labels are exact for any order, and hardly longer for this one.
//! - Start and goal are connected by jump points, not by subgoals: far fewer are useful. That this
//!   is enough is shown at `query`.
//! - Scans pass jump points; each is a separate turn, which gives a lower bound of the length of a
//!   path through it.
//!
//! # Errors / cost
//! A preparation is valid only for the blocked cells that it was made for: on any other map, and
//! after an edit, the result is [`PlanError::OtherMap`]. Memory and time of the preparation grow
//! with the number of corner cells times the length of their labels, which is 10 to 30 on mazes
//! and most game maps, 80 on a city map with 10,000 corner cells, and near 300 on a field of
//! single obstacle cells with 67,000. A query costs its scans, the labels that it reads and the
//! cells that it writes; it allocates nothing once warm. A budget counts the labels read.

mod corners;
mod estimate;
#[cfg(feature = "files")]
mod file;
#[cfg(feature = "formats")]
mod format;
mod graph;
mod hubs;
mod labels;
mod order;
mod prepare_error;
mod query;
mod sight;
mod unfold;

use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Plan, PlanCost, PlanError, PrepareProgress, Stop};
use crate::map::{Cell, Connectivity, DiagonalEvents, SearchMap};
use crate::search::{Observer, Query, Workspace};
pub use estimate::PreparationEstimate;
#[cfg(feature = "files")]
pub use file::PreparedFileError;
#[cfg(feature = "formats")]
pub use format::PreparedFormatError;
pub use prepare_error::PrepareError;

use corners::Corners;
use graph::{Edge, corner_graph};
use hubs::HubMemory;
use labels::Labels;
use order::order_of_importance;
use query::Search;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Parameters of [`Prepared`]: none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct PreparedConfig {}

/// A prepared map: a planner for this map alone; optimal without corner cutting.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// [`SearchMap::fingerprint`] of the prepared map.
    fingerprint: u64,
    corners: Corners,
    diagonals: DiagonalEvents,
    edges: u64,
    /// The node of each corner cell, by the cell's number.
    nodes: Vec<u32>,
    /// The cell of each node. Nodes are numbered by importance.
    cells: Vec<Cell>,
    labels: Labels,
}

/// Statistics of a preparation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Preparation {
    /// Cells at which shortest paths may turn.
    pub corner_cells: u64,
    /// Pairs of corner cells in sight of each other.
    pub edges: u64,
    /// Entries of all labels.
    pub label_entries: u64,
    /// Memory on the heap \[bytes\].
    pub memory_bytes: usize,
}

impl Prepared {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "prepared";

    /// Prepares a map.
    ///
    /// # Errors
    /// Returns an error if the map has penalised cells, or more corner cells or longer paths than
    /// labels can hold.
    pub fn build(map: &SearchMap) -> Result<Self, PrepareError> {
        Self::build_with_progress(map, |_| ControlFlow::Continue(()))
    }

    /// Like [`Self::build`], and reports progress from time to time; `progress` may stop it.
    ///
    /// # Errors
    /// As for [`Self::build`]; and [`PrepareError::Stopped`] if `progress` stopped it.
    pub fn build_with_progress(
        map: &SearchMap,
        mut progress: impl FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> Result<Self, PrepareError> {
        let corners = Self::corners_of(map)?;
        let corner_cells = corners.count() as u64;
        let mut report = |done: usize| match progress(PrepareProgress {
            done: done as u64,
            total: 2 * corner_cells,
        }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(PrepareError::Stopped),
        };
        let graph = corner_graph(map, &corners);
        let order = order_of_importance(&graph, &mut report)?;
        let all: Vec<Cell> = corners.iter().collect();
        let cells: Vec<Cell> = order.iter().map(|&corner| all[corner as usize]).collect();
        let nodes = inverse(&order);
        let graph = renamed(&graph, &order, &nodes);
        let labels = Labels::new(&graph, &cells, |done| report(order.len() + done))?;
        let edges = graph.iter().map(Vec::len).sum::<usize>() as u64 / 2;
        let (fingerprint, diagonals) = (map.fingerprint(), map.diagonal_events());
        Ok(Self { fingerprint, corners, diagonals, edges, nodes, cells, labels })
    }

    /// The corner cells of a map, unless they or penalised cells rule out a preparation.
    fn corners_of(map: &SearchMap) -> Result<Corners, PrepareError> {
        if map.penalised().is_some() {
            return Err(PrepareError::NeedsUniformCost);
        }
        let corners = Corners::new(map);
        let corner_cells = corners.count() as u64;
        if corner_cells > labels::MAX_HUBS {
            return Err(PrepareError::TooManyCorners { corner_cells, limit: labels::MAX_HUBS });
        }
        Ok(corners)
    }

    /// The statistics of the preparation.
    pub fn preparation(&self) -> Preparation {
        let tables =
            self.nodes.capacity() * size_of::<u32>() + self.cells.capacity() * size_of::<Cell>();
        Preparation {
            corner_cells: self.cells.len() as u64,
            edges: self.edges,
            label_entries: self.labels.entries.len() as u64,
            memory_bytes: self.corners.memory_bytes()
                + self.diagonals.memory_bytes()
                + tables
                + self.labels.memory_bytes(),
        }
    }

    fn node(&self, corner: Cell) -> u32 {
        self.nodes[self.corners.number(corner)]
    }

    fn run(
        &self,
        map: &SearchMap,
        query: &Query,
        memory: &mut HubMemory,
        seen: impl Observer,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let mut search = Search::new(self, map, query, memory, seen);
        let route = search.run()?;
        plan.statistics = search.statistics;
        plan.cost = PlanCost::Steps(self.unfold(query, route, plan));
        plan.stop = Some(Stop::LookedUp);
        Ok(())
    }
}

impl From<PrepareError> for PlanError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::NeedsUniformCost => Self::NeedsUniformCost { planner: Prepared::NAME },
            error => Self::Preparation(error),
        }
    }
}

impl PlannerParameters for PreparedConfig {
    fn build(&self, map: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Prepared::build(map)?))
    }

    fn build_with_progress(
        &self,
        map: &SearchMap,
        progress: &mut dyn FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Prepared::build_with_progress(map, progress)?))
    }

    fn is_optimal(&self) -> bool {
        true
    }

    fn needs_static_map(&self) -> bool {
        true
    }
}

impl GlobalPlanner for Prepared {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn memory_bytes(&self) -> usize {
        self.preparation().memory_bytes
    }

    fn needs_uniform_cost(&self) -> bool {
        true
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        if map.fingerprint() != self.fingerprint {
            return Err(PlanError::OtherMap);
        }
        let memory = workspace.part::<HubMemory>();
        match seen {
            None => self.run(map, query, memory, (), plan),
            Some(seen) => self.run(map, query, memory, seen, plan),
        }
    }
}

/// The inverse of an order: the position of each number.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    for (place, &number) in order.iter().enumerate() {
        places[number as usize] = place as u32;
    }
    places
}

/// Renumbers the nodes of a graph by an order.
fn renamed(graph: &[Vec<Edge>], order: &[u32], places: &[u32]) -> Vec<Vec<Edge>> {
    let rename = |edge: &Edge| Edge { to: places[edge.to as usize], key: edge.key };
    order.iter().map(|&node| graph[node as usize].iter().map(rename).collect()).collect()
}
