//! Random queries for testing planners.

use super::Query;
use crate::map::{Cell, Connectivity, SearchMap};
use crate::random::Random;

/// Random queries on a map, the same for the same seed. The start is any free cell from which
/// another free cell is reachable, the goal any other free cell reachable from it. Empty if no
/// such cell exists.
///
/// Every eligible cell is equally likely as a start, so most queries are in the largest component,
/// and all of them have a path. Lists these cells: 12 bytes each.
pub fn random_queries(
    map: &SearchMap,
    connectivity: Connectivity,
    count: usize,
    seed: u64,
) -> Vec<Query> {
    let components = map.components(connectivity);
    let free = map.frame().cells().filter(|&cell| map.is_free(cell));
    let component = |cell| (components.of_free(cell), cell);
    let is_joined = |&(component, _): &(u32, Cell)| components.sizes()[component as usize] > 1;
    let mut cells: Vec<(u32, Cell)> = free.map(component).filter(is_joined).collect();
    // A stable sort: the cells of a component stay in the order of the map.
    cells.sort_by_key(|&(component, _)| component);
    if cells.is_empty() {
        return Vec::new();
    }
    let mut random = Random::new(seed);
    let mut query = || {
        let start = random.below(cells.len() as u32) as usize;
        let component = cells[start].0;
        let first = cells.partition_point(|&(other, _)| other < component);
        let size = components.sizes()[component as usize];
        // Chosen among the other cells: the last one substitutes for the start.
        let mut goal = first + random.below(size - 1) as usize;
        if goal == start {
            goal = first + size as usize - 1;
        }
        Query::new(cells[start].1, cells[goal].1)
    };
    (0..count).map(|_| query()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    fn map(rows: &[&str]) -> SearchMap {
        SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
    }

    #[test]
    fn ends_are_free_different_and_connected() {
        // Two rooms, and an isolated cell between them in the corner.
        let map = map(&["..#.", "..##", "##..", "...."]);
        let queries = random_queries(&map, Connectivity::Four, 600, 7);
        let room = |cell: Cell| u8::from(cell.y >= 2);
        let mut starts: Vec<Cell> = Vec::new();
        for &Query { start, goal, .. } in &queries {
            assert!(map.is_free(start) && map.is_free(goal) && start != goal);
            assert!(start != Cell::new(3, 3) && room(start) == room(goal), "{start} {goal}");
            starts.push(start);
        }
        let count = |cell: &Cell| starts.iter().filter(|start| *start == cell).count();
        // Ten cells, 60 times each, with a standard deviation of 7.
        let free = map.frame().cells().filter(|&c| map.is_free(c) && c != Cell::new(3, 3));
        assert!(free.map(|cell| count(&cell)).all(|count| (30..90).contains(&count)));
        assert_eq!(queries, random_queries(&map, Connectivity::Four, 600, 7));
        assert_eq!(queries[..5], random_queries(&map, Connectivity::Four, 5, 7));
        assert_ne!(queries, random_queries(&map, Connectivity::Four, 600, 8));
    }

    #[test]
    fn nothing_to_connect() {
        assert_eq!(random_queries(&map(&["#.", ".#"]), Connectivity::Four, 5, 0), []);
        assert_eq!(random_queries(&map(&["#"]), Connectivity::Eight, 5, 0), []);
        assert_eq!(random_queries(&map(&["#.", ".#"]), Connectivity::Eight, 5, 0).len(), 5);
    }
}
