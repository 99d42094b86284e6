//! A global planner of your own, with its own memory: a wavefront that spreads from the start,
//! cell by cell, until it reaches the goal. Smoothers, pictures and measurements accept its plans
//! like those of any other planner.
//!
//! `cargo run --example own_planner`

use keyway::map::{CellIndex, Connectivity, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{GlobalPlanner, Plan, PlanCost, PlanError, Stop};
use keyway::search::{
    Cost, Moves, Neighbours, Observer, Query, SearchMemory, SearchStatistics, Side, SideStatistics,
    Successors, Uniform, Workspace,
};
use keyway::smooth::{Smoother, Taut};
use std::error::Error;

/// Rooms with two doors, in cells of 1 m.
const ROOMS: [&str; 7] = [
    "....#.......", //
    "....#.......",
    "..........#.",
    "....#.....#.",
    "....#.....#.",
    "#.###.....#.",
    "..........#.",
];

/// Shortest paths with 4 neighbours: every step costs the same, so first in, first out is the
/// right order.
#[derive(Debug)]
struct Wavefront;

/// Memory of a [`Wavefront`]. Nothing is cleared between queries: a cell belongs to the wave whose
/// number it carries.
#[derive(Debug, Default)]
struct Wave {
    /// By cell.
    reached: Vec<Reached>,
    /// The cells in the order in which they were reached.
    order: Vec<CellIndex>,
    number: u32,
}

#[derive(Clone, Copy, Debug)]
struct Reached {
    /// The number of the wave.
    wave: u32,
    /// Steps from the start.
    steps: u32,
    /// The cell that the wave came from; the start is its own.
    from: CellIndex,
}

impl SearchMemory for Wave {
    fn memory_bytes(&self) -> usize {
        size_of::<Reached>() * self.reached.capacity()
            + size_of::<CellIndex>() * self.order.capacity()
    }
}

impl Wave {
    /// Forgets the last wave and begins one.
    fn start(&mut self, map: &SearchMap, root: CellIndex) {
        if self.reached.len() != map.index_count() || self.number == u32::MAX {
            let never = Reached { wave: 0, steps: 0, from: root };
            self.reached = vec![never; map.index_count()];
            self.order.reserve(map.index_count());
            self.number = 0;
        }
        self.number += 1;
        self.order.clear();
        self.reach(root, root, 0);
    }

    /// True if a cell is reached for the first time.
    fn reach(&mut self, at: CellIndex, from: CellIndex, steps: u32) -> bool {
        let known = &mut self.reached[at.as_usize()];
        let is_new = known.wave != self.number;
        if is_new {
            *known = Reached { wave: self.number, steps, from };
            self.order.push(at);
        }
        is_new
    }

    fn steps(&self, at: CellIndex) -> u32 {
        self.reached[at.as_usize()].steps
    }

    /// The cells of the path that led to one, back to the root.
    fn way_back(&self, at: CellIndex) -> impl Iterator<Item = CellIndex> {
        let parent = |at: &CellIndex| self.reached[at.as_usize()].from;
        std::iter::successors(Some(at), move |at| Some(parent(at)).filter(|before| before != at))
    }
}

impl GlobalPlanner for Wavefront {
    fn name(&self) -> &'static str {
        "wavefront"
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        mut seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        if map.penalised().is_some() {
            return Err(PlanError::NeedsUniformCost { planner: self.name() });
        }
        // Looked up once per query, not once per cell.
        let wave = workspace.part::<Wave>();
        let neighbours = Neighbours::new(map, Moves::Four, Uniform);
        let goal = map.index(query.goal);
        wave.start(map, map.index(query.start));
        for expanded in 0.. {
            let generated = wave.order.len() as u64;
            let statistics = SearchStatistics::one_sided(SideStatistics { expanded, generated });
            if let Some(budget) = query.budget.filter(|&budget| expanded >= budget) {
                return Err(PlanError::BudgetExhausted { budget, statistics });
            }
            let Some(&at) = wave.order.get(expanded as usize) else {
                return Err(PlanError::NoPath { statistics });
            };
            let cell = map.cell(at);
            if let Some(seen) = &mut seen {
                seen.expanded(Side::Forward, cell, f64::from(wave.steps(at)));
            }
            if at == goal {
                plan.statistics = statistics;
                break;
            }
            let steps = wave.steps(at) + 1;
            neighbours.for_each(at, |step| {
                if wave.reach(step.to, at, steps)
                    && let Some(seen) = &mut seen
                {
                    seen.generated(Side::Forward, map.cell(step.to), cell, f64::from(steps));
                }
            });
        }
        plan.cells.extend(wave.way_back(goal).map(|at| map.cell(at)));
        plan.cells.reverse();
        plan.cost = PlanCost::Steps(Cost::new(u64::from(wave.steps(goal)), 0));
        plan.stop = Some(Stop::GoalExpanded);
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let map = SearchMap::new(&OccupancyGrid::from_ascii(&ROOMS), LayerConfig::default())?;
    let (start, goal) = ([0.5, 0.5].into(), [11.5, 0.5].into());
    let query = Query::new(map.frame().cell_near(start), map.frame().cell_near(goal));
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    Wavefront.plan_into(&map, &query, &mut workspace, None, &mut plan)?;
    println!("{} steps, {} cells expanded", plan.cells.len() - 1, plan.statistics.expanded());
    println!("memory: {} bytes", workspace.memory_bytes());
    let line = plan.line(&map, start, goal);
    let smooth = Taut.smooth(&line, &map.clearance(), 0.2);
    println!(
        "{:.3} m, {:.3} m when pulled tight",
        line.polyline().length_m(),
        smooth.path.length_m()
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::map::Cell;
    use keyway::plan::{AStar4, AStar4Config};

    /// As short as the paths of the library's planner, from each free cell to each other one.
    #[test]
    fn paths_are_shortest_ones() -> Result<(), Box<dyn Error>> {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(&ROOMS), LayerConfig::default())?;
        let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
        let astar = AStar4::new(AStar4Config::default());
        let (mut workspace, mut plan, mut expected) =
            (Workspace::default(), Plan::default(), Plan::default());
        for &start in &free {
            for &goal in &free {
                let query = Query::new(start, goal);
                Wavefront.plan_into(&map, &query, &mut workspace, None, &mut plan)?;
                astar.plan_into(&map, &query, &mut workspace, None, &mut expected)?;
                assert_eq!(plan.cost, expected.cost, "{start} to {goal}");
                assert_eq!((plan.cells[0], plan.reached()), (start, Some(goal)));
                let is_step = |pair: &[Cell]| {
                    pair[0].x.abs_diff(pair[1].x) + pair[0].y.abs_diff(pair[1].y) == 1
                };
                assert!(plan.cells.windows(2).all(is_step), "{:?}", plan.cells);
            }
        }
        let few = Query { budget: Some(3), ..Query::new(free[0], free[free.len() - 1]) };
        let error = Wavefront.plan_into(&map, &few, &mut workspace, None, &mut plan);
        assert!(matches!(error, Err(PlanError::BudgetExhausted { budget: 3, .. })));
        Ok(())
    }
}
