//! An order of importance of the corner cells for hub labels: the cells on most shortest paths
//! first.
//!
//! Nodes are contracted one by one as for a contraction hierarchy \[Geisberger2008\]: the next one
//! is the one whose neighbours need the fewest shortcuts, spread evenly over the map; the nodes
//! contracted last are the most important. Only the order is used. Labels are exact whatever the
//! order, so the contraction may be wrong by some percent, and that makes it fast. A graph of all
//! corner cells in sight of each other is dense (30 neighbours each in open terrain), and its
//! contraction takes minutes. Without the edges that are nearly a detour over a neighbour, and
//! with shortcuts only where a detour is long, it takes about a second, for labels of the same
//! length.

use super::graph::Edge;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An edge is dropped if a path over a neighbour is at most 1/4 longer.
const DETOUR_PARTS: u64 = 4;

/// No shortcut is made if a witness path at most 1/10 longer is found.
const WITNESS_PARTS: u64 = 10;

/// Nodes settled in one witness search; a witness that is not found costs an unnecessary shortcut.
const WITNESS_SETTLED: u32 = 60;

/// The nodes of a graph, the most important one first. Calls `progress` with the number of ordered
/// nodes; an error of `progress` stops the work.
pub(super) fn order_of_importance<E>(
    graph: &[Vec<Edge>],
    mut progress: impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<u32>, E> {
    let mut contraction = Contraction {
        edges: without_detours(graph),
        level: vec![0; graph.len()],
        witness: Witness::new(graph.len()),
        shortcuts: Vec::new(),
    };
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> =
        (0..graph.len() as u32).map(|node| Reverse((contraction.priority(node), node))).collect();
    let mut order = Vec::with_capacity(graph.len());
    while let Some(Reverse((before, node))) = queue.pop() {
        // The priority may have risen, as neighbours were contracted since.
        let now = contraction.priority(node);
        if now > before && queue.peek().is_some_and(|Reverse(next)| (now, node) > *next) {
            queue.push(Reverse((now, node)));
            continue;
        }
        contraction.contract(node);
        order.push(node);
        progress(order.len())?;
    }
    order.reverse();
    Ok(order)
}

/// The graph without each edge for which there is a path over one node whose two edges are both
/// shorter than it and together hardly longer.
fn without_detours(graph: &[Vec<Edge>]) -> Vec<Vec<Edge>> {
    let mut reached = vec![(u32::MAX, 0); graph.len()];
    let mut sparse = Vec::with_capacity(graph.len());
    for (node, edges) in graph.iter().enumerate() {
        for edge in edges {
            reached[edge.to as usize] = (node as u32, edge.key);
        }
        let is_detour = |edge: &Edge, back: &Edge| {
            let (of, key) = reached[back.to as usize];
            let limit = edge.key + edge.key / DETOUR_PARTS;
            of == node as u32 && key.max(back.key) < edge.key && key + back.key <= limit
        };
        let is_needed =
            |edge: &&Edge| !graph[edge.to as usize].iter().any(|back| is_detour(edge, back));
        sparse.push(edges.iter().filter(is_needed).copied().collect());
    }
    sparse
}

struct Contraction {
    /// Edges among the remaining nodes.
    edges: Vec<Vec<Edge>>,
    /// One more than the highest level of the contracted neighbours.
    level: Vec<u32>,
    witness: Witness,
    /// The shortcuts for the node visited last: from, to, length.
    shortcuts: Vec<(u32, u32, u64)>,
}

impl Contraction {
    /// The contraction priority, small for nodes to be contracted early: low level, few shortcuts
    /// per edge. Also sets `shortcuts` for the node.
    fn priority(&mut self, node: u32) -> u64 {
        self.find_shortcuts(node);
        let removed = self.edges[node as usize].len().max(1) as u64;
        let added = self.shortcuts.len() as u64;
        1000 * u64::from(self.level[node as usize]) + 2000 * added / removed
    }

    fn find_shortcuts(&mut self, node: u32) {
        self.shortcuts.clear();
        let own = &self.edges[node as usize];
        for (i, from) in own.iter().enumerate() {
            let others = &own[i + 1..];
            let Some(longest) = others.iter().map(|to| tolerated(from.key + to.key)).max() else {
                break;
            };
            self.witness.search(&self.edges, from.to, node, others, longest);
            for to in others {
                let key = from.key + to.key;
                if !self.witness.is_within(to.to, tolerated(key)) {
                    self.shortcuts.push((from.to, to.to, key));
                }
            }
        }
    }

    /// Contracts the node last visited by [`Self::priority`].
    fn contract(&mut self, node: u32) {
        let above = self.level[node as usize] + 1;
        for edge in std::mem::take(&mut self.edges[node as usize]) {
            self.edges[edge.to as usize].retain(|back| back.to != node);
            let level = &mut self.level[edge.to as usize];
            *level = above.max(*level);
        }
        for i in 0..self.shortcuts.len() {
            let (from, to, key) = self.shortcuts[i];
            self.join(from, Edge { to, key });
            self.join(to, Edge { to: from, key });
        }
    }

    fn join(&mut self, from: u32, edge: Edge) {
        let edges = &mut self.edges[from as usize];
        match edges.iter_mut().find(|known| known.to == edge.to) {
            Some(known) => known.key = known.key.min(edge.key),
            None => edges.push(edge),
        }
    }
}

const fn tolerated(key: u64) -> u64 {
    key + key / WITNESS_PARTS
}

/// Witness searches: paths around a node.
struct Witness {
    /// The distance, and the search it belongs to.
    reached: Vec<(u64, u32)>,
    /// The last search that asked for the node.
    wanted: Vec<u32>,
    epoch: u32,
    open: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Witness {
    fn new(nodes: usize) -> Self {
        Self {
            reached: vec![(0, 0); nodes],
            wanted: vec![0; nodes],
            epoch: 0,
            open: BinaryHeap::new(),
        }
    }

    /// Computes distances from `from` without `avoided`, up to `longest`, until all `wanted` are
    /// settled or the limit of settled nodes is reached.
    fn search(
        &mut self,
        edges: &[Vec<Edge>],
        from: u32,
        avoided: u32,
        wanted: &[Edge],
        longest: u64,
    ) {
        self.begin(from, wanted);
        let mut left = wanted.len();
        let mut settled = 0;
        while let Some(Reverse((key, at))) = self.open.pop() {
            if key > self.reached[at as usize].0 {
                continue;
            }
            left -= usize::from(self.wanted[at as usize] == self.epoch);
            settled += 1;
            if left == 0 || settled > WITNESS_SETTLED {
                return;
            }
            for edge in edges[at as usize].iter().filter(|edge| edge.to != avoided) {
                let through = key + edge.key;
                let (known, stamp) = &mut self.reached[edge.to as usize];
                if through <= longest && (*stamp != self.epoch || through < *known) {
                    (*known, *stamp) = (through, self.epoch);
                    self.open.push(Reverse((through, edge.to)));
                }
            }
        }
    }

    fn begin(&mut self, from: u32, wanted: &[Edge]) {
        if self.epoch == u32::MAX {
            self.reached.fill((0, 0));
            self.wanted.fill(0);
            self.epoch = 0;
        }
        self.epoch += 1;
        self.open.clear();
        self.open.push(Reverse((0, from)));
        self.reached[from as usize] = (0, self.epoch);
        for edge in wanted {
            self.wanted[edge.to as usize] = self.epoch;
        }
    }

    fn is_within(&self, node: u32, key: u64) -> bool {
        let (known, stamp) = self.reached[node as usize];
        stamp == self.epoch && known <= key
    }
}
