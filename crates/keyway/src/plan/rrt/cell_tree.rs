//! A tree of cells that grows from a root cell.

use super::nearest_node::NearestNode;
use crate::map::{Cell, SearchMap};
use crate::search::SearchMemory;

/// A node of a [`CellTree`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TreeNode {
    /// Index of the node in insertion order.
    pub(super) number: u32,
    /// Its cell.
    pub(super) cell: Cell,
    /// Path length from the root, as a [`Cost::key`](crate::search::Cost::key).
    pub(super) g: u64,
}

/// Cells with their parents, each cell at most once.
///
/// A new query removes the nodes of the last one, and touches only the memory that these used.
#[derive(Clone, Debug, Default)]
pub(super) struct CellTree {
    /// Each node, and the number of its parent; the root is its own parent.
    nodes: Vec<(TreeNode, u32)>,
    by_place: NearestNode,
}

impl CellTree {
    /// Clears the last tree and starts a new one, with capacity for `most` nodes.
    pub(super) fn start(&mut self, map: &SearchMap, root: Cell, most: usize) -> TreeNode {
        let is_new = self.by_place.resize(map.frame().width(), map.frame().height());
        if !is_new {
            for (node, _) in &self.nodes {
                self.by_place.forget(node.cell);
            }
        }
        self.nodes.clear();
        self.nodes.reserve(most);
        self.push(root, 0, 0)
    }

    /// Adds a cell that is not in the tree, joined to its parent by a line of length `length`.
    pub(super) fn add(&mut self, cell: Cell, parent: TreeNode, length: u64) -> TreeNode {
        self.push(cell, parent.number, parent.g + length)
    }

    fn push(&mut self, cell: Cell, parent: u32, g: u64) -> TreeNode {
        let node = TreeNode { number: self.nodes.len() as u32, cell, g };
        self.nodes.push((node, parent));
        self.by_place.insert(cell, node.number);
        node
    }

    /// The number of nodes.
    pub(super) const fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True if a cell of the map is in the tree.
    pub(super) fn contains(&self, cell: Cell) -> bool {
        self.by_place.contains(cell)
    }

    /// The node whose centre is nearest to that of a cell, in a tie the oldest one; `None` before
    /// the first [`Self::start`].
    pub(super) fn nearest(&self, to: Cell) -> Option<TreeNode> {
        let number = self.by_place.nearest(to)?;
        Some(self.nodes[number as usize].0)
    }

    /// The cells from the root to a node, both included, in `path` (which is cleared first).
    pub(super) fn path_into(&self, node: TreeNode, path: &mut Vec<Cell>) {
        path.clear();
        let mut at = node.number;
        loop {
            let (node, parent) = self.nodes[at as usize];
            path.push(node.cell);
            if parent == at {
                break;
            }
            at = parent;
        }
        path.reverse();
    }
}

impl SearchMemory for CellTree {
    fn memory_bytes(&self) -> usize {
        size_of::<(TreeNode, u32)>() * self.nodes.capacity() + self.by_place.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn grows_and_begins_anew() {
        let grid = OccupancyGrid::from_ascii(&["....", "....", "...."]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let cell = Cell::new;
        let (mut tree, mut path) = (CellTree::default(), Vec::new());
        for _ in 0..2 {
            let root = tree.start(&map, cell(0, 0), 4);
            let east = tree.add(cell(1, 0), root, 10);
            tree.add(cell(0, 1), root, 10);
            let far = tree.add(cell(3, 1), east, 22);
            assert_eq!((far.g, tree.len()), (32, 4));
            tree.path_into(far, &mut path);
            assert_eq!(path, [cell(0, 0), cell(1, 0), cell(3, 1)]);
            // (0, 1) and (1, 0) are equally near to (1, 1): the older one is taken.
            assert_eq!(tree.nearest(cell(1, 1)), Some(east));
            assert_eq!(tree.nearest(cell(3, 2)), Some(far));
        }
        let root = tree.start(&map, cell(2, 2), 4);
        assert_eq!(tree.nearest(cell(0, 0)), Some(root));
        assert!(tree.contains(cell(2, 2)) && !tree.contains(cell(0, 0)));
    }

    /// The size stated in the documentation of the workspace and of the planner.
    #[test]
    fn a_node_takes_32_bytes() {
        assert_eq!(size_of::<(TreeNode, u32)>(), 32);
    }
}
