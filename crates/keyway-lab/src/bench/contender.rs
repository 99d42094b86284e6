//! A planner that answers the queries of a scenario file.

use super::GridError;
use super::mistakes::Mistake;
use super::raw_map::RawMap;
use super::tally::{GridAnswer, GridRow, PathFound, row};
use crate::corner_rule::corner_rule;
use crate::measure::{Times, timed};
use keyway::map::formats::Scenario;
use keyway::map::{OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan, PlanError};
use keyway::search::{CornerRule, Query, Workspace};
use keyway_sim::report::PlanOutcome;
use std::time::{Duration, Instant};

/// A planner with everything that it needs on one map.
pub(super) struct Contender<'a> {
    stack: &'a Stack,
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    map: SearchMap,
    /// Time of deriving the map's layers.
    preparation: Duration,
    workspace: Workspace,
    plan: Plan,
    pub(super) answers: Vec<GridAnswer>,
}

impl<'a> Contender<'a> {
    pub(super) fn prepare(stack: &'a Stack, grid: &OccupancyGrid) -> Result<Self, GridError> {
        let begin = Instant::now();
        let map = SearchMap::new(grid, stack.map.clone()).map_err(GridError::Map)?;
        let planner = stack.planner.build(&map).map_err(GridError::Planner)?;
        map.components(planner.connectivity());
        Ok(Self {
            preparation: begin.elapsed(),
            stack,
            planner,
            map,
            workspace: Workspace::default(),
            plan: Plan::default(),
            answers: Vec::new(),
        })
    }

    pub(super) fn plan(&mut self, scenario: &Scenario) -> (Result<(), PlanError>, Times) {
        let Self { planner, map, workspace, plan, .. } = self;
        let query = Query::new(scenario.start, scenario.goal);
        timed(|| planner.plan_into(map, &query, workspace, None, plan))
    }

    pub(super) fn answer(&mut self, scenario: &Scenario, raw: &RawMap) -> GridAnswer {
        let Scenario { start, goal, optimal_length, .. } = *scenario;
        let (result, times) = self.plan(scenario);
        let statistics = match &result {
            Ok(()) => self.plan.statistics,
            Err(error) => PlanOutcome::of(error).1,
        };
        let path = match &result {
            Ok(()) => match raw.legal_length(&self.plan.cells, (start, goal), self.corners()) {
                Some(length_cells) => PathFound::Legal { length_cells },
                None => PathFound::Illegal,
            },
            Err(PlanError::Missed { .. } | PlanError::Constrained { .. }) => PathFound::Missed,
            Err(_) => PathFound::None,
        };
        let is_reachable = raw.is_passable(start)
            && raw.is_passable(goal)
            && (optimal_length > 0.0 || start == goal);
        GridAnswer {
            times,
            expanded: statistics.expanded(),
            generated: statistics.generated(),
            path,
            optimum: match path {
                _ if is_reachable => Some(optimal_length),
                // Published for planners that do not cut corners; others may find a path.
                PathFound::Legal { length_cells } if self.corners() == CornerRule::Allow => {
                    Some(length_cells)
                }
                _ => None,
            },
            least: self.least(scenario),
        }
    }

    fn corners(&self) -> CornerRule {
        corner_rule(&*self.planner)
    }

    /// Lower bound of the lengths of the planner's legal paths.
    fn least(&self, scenario: &Scenario) -> f64 {
        let Scenario { start, goal, optimal_length, .. } = *scenario;
        if self.corners() == CornerRule::Forbid && !self.planner.is_any_angle() {
            return optimal_length;
        }
        f64::from(goal.x - start.x).hypot(f64::from(goal.y - start.y))
    }

    /// Returns the wrong answers.
    pub(super) fn mistakes(&self, file: &str, scenarios: &[Scenario]) -> Vec<Mistake> {
        let config = &self.stack.planner;
        let mistake = |(scenario, answer): (&Scenario, &GridAnswer)| {
            let (expected_cells, got) = answer.mistake(config.is_optimal())?;
            Some(Mistake {
                scenarios: file.to_owned(),
                line: scenario.line,
                planner: config.name(),
                start: scenario.start,
                goal: scenario.goal,
                expected_cells,
                got,
                got_cells: answer.length_cells(),
            })
        };
        scenarios.iter().zip(&self.answers).filter_map(mistake).collect()
    }

    pub(super) fn row(&self, map: String) -> GridRow {
        let memory_bytes =
            self.map.memory_bytes() + self.planner.memory_bytes() + self.workspace.memory_bytes();
        let config = &self.stack.planner;
        let given = (self.preparation, memory_bytes);
        row(map, config.name(), config.is_optimal(), &self.answers, given)
    }
}
