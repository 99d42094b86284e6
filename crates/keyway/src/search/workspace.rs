//! Reusable memory of searches.

use super::Frontier;
use std::any::Any;
use std::fmt::Debug;

/// Reusable memory for searches. It holds no result and has no meaning between calls: a second
/// query on the same map allocates nothing and clears next to nothing.
///
/// Each planner keeps its data in a part of its own type ([`Self::part`]), and so can a planner
/// outside this crate. Planners that use the same type share it: those that expand cells in the
/// order of a key all share the same two frontiers.
///
/// Memory of each of these frontiers that is used: 16 bytes per cell of the padded map, reserved
/// by its first query, and its open list: 266 kB and 17 to 300 bytes for each node that it held at
/// once. A bidirectional jump point search has two frontiers of its own, with a quarter of a byte
/// more per cell each. A one-sided jump point search has 1/8 byte per cell, 512 bytes for each
/// page of 32 cells that its largest query touched, and an open list for which 1 byte per cell is
/// reserved. A density of the remaining box takes 4 bytes per cell. A random tree has 4.4 bytes
/// per cell, and 32 bytes for each sample that it may draw. Memory that is reserved but not
/// touched uses no physical memory.
#[derive(Debug, Default)]
pub struct Workspace {
    parts: Vec<Box<dyn SearchMemory>>,
}

/// A part of a [`Workspace`]: the memory that one kind of search keeps between queries, so that it
/// need not be allocated again.
pub trait SearchMemory: Any + Debug + Send {
    /// Memory on the heap \[bytes\].
    fn memory_bytes(&self) -> usize;
}

impl Workspace {
    /// The part of this type: as the last query left it, initially its default.
    ///
    /// ```
    /// use keyway::search::{SearchMemory, Workspace};
    ///
    /// /// Cells that were visited, in order.
    /// #[derive(Debug, Default)]
    /// struct Trail(Vec<u32>);
    ///
    /// impl SearchMemory for Trail {
    ///     fn memory_bytes(&self) -> usize {
    ///         size_of::<u32>() * self.0.capacity()
    ///     }
    /// }
    ///
    /// let mut workspace = Workspace::default();
    /// workspace.part::<Trail>().0.extend([3, 1, 4]);
    /// let Trail(visited) = workspace.part();
    /// assert_eq!(visited.len(), 3);
    /// assert!(workspace.memory_bytes() >= 12);
    /// ```
    #[expect(clippy::missing_panics_doc, reason = "a part is found by its type")]
    pub fn part<T: SearchMemory + Default>(&mut self) -> &mut T {
        let known = self.parts.iter().position(|part| {
            let part: &dyn Any = &**part;
            part.is::<T>()
        });
        let index = known.unwrap_or_else(|| {
            self.parts.push(Box::new(T::default()));
            self.parts.len() - 1
        });
        let part: &mut dyn Any = &mut *self.parts[index];
        part.downcast_mut().expect("the part was found by its type")
    }

    /// Memory on the heap \[bytes\].
    pub fn memory_bytes(&self) -> usize {
        let of_parts = self.parts.iter().map(|part| size_of_val(&**part) + part.memory_bytes());
        size_of::<Box<dyn SearchMemory>>() * self.parts.capacity() + of_parts.sum::<usize>()
    }
}

/// The frontiers of a bidirectional search; a one-sided search uses the forward one.
#[derive(Debug, Default)]
pub(crate) struct Sides {
    pub(crate) forward: Frontier,
    pub(crate) backward: Frontier,
}

impl SearchMemory for Sides {
    fn memory_bytes(&self) -> usize {
        self.forward.memory_bytes() + self.backward.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Default)]
    struct Numbers(Vec<u64>);

    impl SearchMemory for Numbers {
        fn memory_bytes(&self) -> usize {
            size_of::<u64>() * self.0.capacity()
        }
    }

    #[test]
    fn each_type_has_a_part_of_its_own() {
        let mut workspace = Workspace::default();
        assert_eq!(workspace.memory_bytes(), 0);
        workspace.part::<Sides>();
        workspace.part::<Numbers>().0 = Vec::with_capacity(1000);
        let bytes = workspace.memory_bytes();
        let least = 8000 + size_of::<Numbers>() + size_of::<Sides>();
        assert!((least..least + 1000).contains(&bytes), "{bytes}");
        workspace.part::<Numbers>().0.push(7);
        let info = allocation_counter::measure(|| {
            workspace.part::<Sides>();
            workspace.part::<Numbers>().0.push(8);
        });
        assert_eq!((info.count_total, &workspace.part::<Numbers>().0[..]), (0, &[7, 8][..]));
    }
}
