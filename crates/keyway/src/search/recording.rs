//! A recording of a search, event by event, for later inspection.

use super::{Observer, SearchStatistics, Side};
use crate::map::Cell;

/// One event that a search reported to its [`Observer`]; path costs are left out. 20 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchEvent {
    /// A node was taken from the open list.
    Expanded {
        /// The side of the open list.
        side: Side,
        /// The node.
        at: Cell,
    },
    /// A node was inserted into the open list, or improved there.
    Generated {
        /// The side of the open list.
        side: Side,
        /// The node.
        at: Cell,
        /// The parent of the node.
        parent: Cell,
    },
    /// A node that is being expanded got another parent.
    Reparented {
        /// The side of the node.
        side: Side,
        /// The node.
        at: Cell,
        /// Its new parent.
        parent: Cell,
    },
    /// A jump point search scanned a line.
    Scanned {
        /// The side that scanned.
        side: Side,
        /// The first cell of the line.
        from: Cell,
        /// The last cell of the line.
        to: Cell,
    },
    /// A node was linked to a distant one.
    Linked {
        /// The side of the node.
        side: Side,
        /// The node.
        at: Cell,
        /// The node that it was linked to.
        parent: Cell,
    },
    /// The two sides met.
    Met {
        /// The meeting cell.
        at: Cell,
    },
}

/// Records all reports of a search, in order: for visualisation, animation and inspection.
///
/// Memory: 20 bytes per event. A search of half a million expanded nodes with 8 neighbours reports
/// about a million events.
///
/// ```
/// use keyway::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
/// use keyway::plan::{AStar, GlobalPlanner, Plan};
/// use keyway::search::{Query, Recording, SearchEvent, Side, Workspace};
///
/// let grid = OccupancyGrid::from_ascii(&["...."]);
/// let map = SearchMap::new(&grid, LayerConfig::default())?;
/// let query = Query::new(Cell::new(0, 0), Cell::new(3, 0));
/// let mut recording = Recording::default();
/// let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
/// AStar::default().plan_into(&map, &query, &mut workspace, Some(&mut recording), &mut plan)?;
/// let first = recording.events()[0];
/// assert_eq!(first, SearchEvent::Expanded { side: Side::Forward, at: Cell::new(0, 0) });
/// // Along a corridor each cell is expanded, and its neighbour generated.
/// assert_eq!(recording.first(3).len(), 3);
/// assert_eq!(recording.statistics().expanded(), plan.statistics.expanded());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    events: Vec<SearchEvent>,
}

impl Recording {
    /// All events in the order in which they were reported.
    pub fn events(&self) -> &[SearchEvent] {
        &self.events
    }

    /// The first `count` events, or all if there are fewer: the state of the search at that time.
    pub fn first(&self, count: usize) -> &[SearchEvent] {
        &self.events[..count.min(self.events.len())]
    }

    /// Counts the reported nodes. A search counts its roots as generated, too, but does not report
    /// them: its own statistics have one more generated node on each side that began.
    pub fn statistics(&self) -> SearchStatistics {
        let mut counted = SearchStatistics::default();
        for event in &self.events {
            match *event {
                SearchEvent::Expanded { side, .. } => counted.side_mut(side).expanded += 1,
                SearchEvent::Generated { side, .. } => counted.side_mut(side).generated += 1,
                _ => {}
            }
        }
        counted
    }

    /// Clears all events and keeps the memory.
    pub fn clear(&mut self) {
        self.events.clear();
    }
}

impl Observer for Recording {
    fn expanded(&mut self, side: Side, at: Cell, _g_cells: f64) {
        self.events.push(SearchEvent::Expanded { side, at });
    }

    fn generated(&mut self, side: Side, at: Cell, parent: Cell, _g_cells: f64) {
        self.events.push(SearchEvent::Generated { side, at, parent });
    }

    fn reparented(&mut self, side: Side, at: Cell, parent: Cell, _g_cells: f64) {
        self.events.push(SearchEvent::Reparented { side, at, parent });
    }

    fn scanned(&mut self, side: Side, from: Cell, to: Cell) {
        self.events.push(SearchEvent::Scanned { side, from, to });
    }

    fn linked(&mut self, side: Side, at: Cell, parent: Cell) {
        self.events.push(SearchEvent::Linked { side, at, parent });
    }

    fn met(&mut self, at: Cell) {
        self.events.push(SearchEvent::Met { at });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid, SearchMap};
    use crate::plan::{HstaConfig, Plan, PlannerConfig};
    use crate::search::{Query, Workspace};

    #[test]
    fn an_event_takes_20_bytes() {
        assert_eq!(size_of::<SearchEvent>(), 20);
    }

    #[test]
    fn events_keep_their_order() {
        let mut seen = Recording::default();
        let (a, b) = (Cell::new(1, 2), Cell::new(3, 4));
        seen.expanded(Side::Forward, a, 0.0);
        seen.scanned(Side::Forward, a, b);
        seen.generated(Side::Backward, b, a, 2.0);
        seen.reparented(Side::Backward, b, b, 1.0);
        seen.met(b);
        let reported = [
            SearchEvent::Expanded { side: Side::Forward, at: a },
            SearchEvent::Scanned { side: Side::Forward, from: a, to: b },
            SearchEvent::Generated { side: Side::Backward, at: b, parent: a },
            SearchEvent::Reparented { side: Side::Backward, at: b, parent: b },
            SearchEvent::Met { at: b },
        ];
        assert_eq!(seen.events(), reported);
        assert_eq!(seen.first(2), &reported[..2]);
        assert_eq!(seen.first(99), reported);
        seen.clear();
        assert!(seen.events().is_empty());
    }

    #[test]
    fn what_is_recorded_is_what_is_counted() {
        let grid =
            OccupancyGrid::from_ascii(&[".......", "..###..", "....#..", "....#..", "......."]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let query = Query::new(Cell::new(2, 1), Cell::new(6, 2));
        for name in PlannerConfig::NAMES {
            let config = match PlannerConfig::by_name(name).unwrap() {
                // Its constraint leaves no path on so small a map.
                PlannerConfig::Hsta(hsta) => {
                    PlannerConfig::Hsta(HstaConfig { l1_constraint: 0.0, ..hsta })
                }
                other => other,
            };
            let planner = config.build(&map).unwrap();
            let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
            planner.plan_into(&map, &query, &mut workspace, None, &mut plan).unwrap();
            let silent = plan.clone();
            let mut seen = Recording::default();
            planner.plan_into(&map, &query, &mut workspace, Some(&mut seen), &mut plan).unwrap();
            assert_eq!(plan, silent, "{name}: watching changes nothing");
            let (reported, counted) = (seen.statistics(), plan.statistics);
            for (reported, counted) in
                [(reported.forward, counted.forward), (reported.backward, counted.backward)]
            {
                assert_eq!(reported.expanded, counted.expanded, "{name}");
                let roots = counted.generated - reported.generated;
                assert!(roots <= 1, "{name}: reported {reported:?}, counted {counted:?}");
            }
        }
    }
}
