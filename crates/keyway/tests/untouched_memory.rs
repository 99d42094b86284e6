//! Memory that is reserved for a large map is not used before a search gets there.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use keyway::geometry::Pose;
use keyway::map::{Cell, Connectivity, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};

/// Resident memory of this process \[bytes\].
fn resident_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() * 1024
}

#[test]
fn a_short_query_on_a_large_map_touches_little() {
    const SIDE: u64 = 6000;
    let frame = GridFrame::new(SIDE, SIDE, 1.0, Pose::default()).unwrap();
    let map = SearchMap::new(&OccupancyGrid::all_free(frame), LayerConfig::default()).unwrap();
    map.components(Connectivity::Four);
    let middle = SIDE as i32 / 2;
    let query = Query::new(Cell::new(middle, middle), Cell::new(middle + 30, middle + 10));
    let mut most_reserved = 0;
    for name in PlannerConfig::NAMES {
        let planner = PlannerConfig::by_name(name).unwrap().build(&map).unwrap();
        let before = resident_bytes();
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        planner.plan_into(&map, &query, &mut workspace, None, &mut plan).unwrap();
        let touched = resident_bytes().saturating_sub(before);
        let reserved = workspace.memory_bytes() as u64;
        // Half a byte per cell (18 MB here) may be touched: bits that the allocator clears if it
        // reuses memory of an earlier query.
        assert!(touched < 24 << 20, "{name} touched {touched} of {reserved} bytes");
        most_reserved = reserved.max(most_reserved);
    }
    assert!(most_reserved >= 16 * SIDE * SIDE, "the map is large");
}
