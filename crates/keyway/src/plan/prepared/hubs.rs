//! Memory of queries that are answered from hub labels.

use crate::map::Cell;
use crate::search::SearchMemory;

/// A cell at which a path from the start, or to the goal, enters the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Access {
    /// A lower bound of the cost of a path through it, as a key.
    pub(super) estimate: u64,
    /// The cost between it and the start or goal, as a key.
    pub(super) key: u64,
    pub(super) at: Cell,
}

/// The cells at which paths from the start and paths to the goal enter the graph, and the shortest
/// known path from the start to each hub. Nothing is cleared between queries.
#[derive(Clone, Debug, Default)]
pub(super) struct HubMemory {
    /// Access cells of the start, then of the goal.
    pub(super) access: [Vec<Access>; 2],
    hubs: Vec<Hub>,
    epoch: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Hub {
    key: u64,
    access: u32,
    epoch: u32,
}

impl HubMemory {
    /// Clears the last query.
    pub(super) fn start(&mut self, nodes: usize) {
        if self.hubs.len() < nodes || self.epoch == u32::MAX {
            self.hubs = vec![Hub::default(); nodes];
            self.epoch = 0;
        }
        self.epoch += 1;
        for access in &mut self.access {
            access.clear();
            // No corner cell is seen twice: each is reached by one diagonal-then-straight path
            // only.
            access.reserve(nodes);
        }
    }

    /// Records a path from the start to a hub, over an access node.
    pub(super) fn offer(&mut self, hub: u32, key: u64, access: u32) {
        let known = &mut self.hubs[hub as usize];
        if known.epoch != self.epoch || key < known.key {
            *known = Hub { key, access, epoch: self.epoch };
        }
    }

    /// The cost of the shortest recorded path to a hub, and its access node.
    pub(super) fn known(&self, hub: u32) -> Option<(u64, u32)> {
        let known = self.hubs[hub as usize];
        (known.epoch == self.epoch).then_some((known.key, known.access))
    }
}

impl SearchMemory for HubMemory {
    fn memory_bytes(&self) -> usize {
        let access = self.access.iter().map(Vec::capacity).sum::<usize>() * size_of::<Access>();
        access + self.hubs.capacity() * size_of::<Hub>()
    }
}
