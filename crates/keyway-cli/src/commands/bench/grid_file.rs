//! The queries of one scenario file, answered by every planner.
//!
//! Planners take turns round by round: each answers all queries, then the next one does, and so on.
//! So a planner runs on caches that are warm with its own data, as in real use, and what disturbs
//! the machine for a while disturbs all planners alike. For each query the fastest of its rounds
//! counts.

use super::mistakes::Mistake;
use super::raw_map::RawMap;
use super::tally::{Answer, GridRow, PathFound, row};
use crate::args::{BenchGridArgs, SizeArgs};
use crate::commands::build_planner;
use crate::error::{CliError, Kind};
use crate::inputs::{layers, load_map, read_text};
use crate::progress::Progress;
use keyway::map::formats::{MAX_MAP_BYTES, MapFormat, Scenario, read_scenarios_for};
use keyway::map::{Connectivity, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan, PlanError};
use keyway::search::{CornerRule, Query, Workspace};
use keyway_lab::measure::{Times, timed};
use keyway_sim::report::PlanOutcome;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

pub(super) fn bench_file(
    path: &Path,
    args: &BenchGridArgs,
    stacks: &[Stack],
    progress: &Progress,
) -> Result<FileResult, CliError> {
    let map_path = map_of(path, args.map_dir.as_deref())?;
    let grid = load_map(&map_path, &args.limit.reader())?.grid;
    let raw = RawMap::new(&read_text(&map_path, MAX_MAP_BYTES, "FILE.scen")?);
    let scenarios = read_scenarios_for(path, grid.frame())
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?;
    let scenarios: Vec<Scenario> = scenarios.into_iter().step_by(args.every as usize).collect();
    let prepare = |stack| Contender::prepare(stack, &grid);
    let mut contenders = stacks.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    progress.expect(args.repeat as usize * contenders.len() * scenarios.len());
    for round in 0..args.repeat {
        for contender in &mut contenders {
            for (i, scenario) in scenarios.iter().enumerate() {
                if round == 0 {
                    let answer = contender.answer(scenario, &raw);
                    contender.answers.push(answer);
                } else {
                    let times = contender.plan(scenario).1;
                    contender.answers[i].times.keep_faster(times);
                }
                progress.answered();
            }
        }
    }
    progress.finished_file();
    let name = map_path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mistakes = contenders.iter().flat_map(|contender| contender.mistakes(path, &scenarios));
    let mistakes = mistakes.collect();
    let rows = contenders.iter().map(|contender| contender.row(name.clone())).collect();
    let answers = contenders.into_iter().map(|contender| contender.answers).collect();
    Ok(FileResult { rows, mistakes, answers })
}

/// What came of a scenario file.
pub(super) struct FileResult {
    pub(super) rows: Vec<GridRow>,
    pub(super) mistakes: Vec<Mistake>,
    /// Of each planner.
    pub(super) answers: Vec<Vec<Answer>>,
}

/// A planner with everything that it needs on one map.
struct Contender<'a> {
    stack: &'a Stack,
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    map: SearchMap,
    /// How long it took to derive the map's layers.
    preparation: Duration,
    workspace: Workspace,
    plan: Plan,
    answers: Vec<Answer>,
}

impl<'a> Contender<'a> {
    fn prepare(stack: &'a Stack, grid: &OccupancyGrid) -> Result<Self, CliError> {
        let begin = Instant::now();
        let map = layers(grid, stack.map.clone(), &SizeArgs::default())?;
        let planner = build_planner(&stack.planner, &map)?;
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

    fn plan(&mut self, scenario: &Scenario) -> (Result<(), PlanError>, Times) {
        let Self { planner, map, workspace, plan, .. } = self;
        let query = Query::new(scenario.start, scenario.goal);
        timed(|| planner.plan_into(map, &query, workspace, None, plan))
    }

    fn answer(&mut self, scenario: &Scenario, raw: &RawMap) -> Answer {
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
        Answer {
            times,
            expanded: statistics.expanded(),
            generated: statistics.generated(),
            path,
            optimum: match path {
                _ if is_reachable => Some(optimal_length),
                // Published for those who do not cut corners: others may get through.
                PathFound::Legal { length_cells } if self.corners() == CornerRule::Allow => {
                    Some(length_cells)
                }
                _ => None,
            },
            least: self.least(scenario),
        }
    }

    fn corners(&self) -> CornerRule {
        match self.planner.connectivity() {
            Connectivity::Four => CornerRule::Forbid,
            Connectivity::Eight => CornerRule::Allow,
        }
    }

    /// A length that no legal path of the planner is below.
    fn least(&self, scenario: &Scenario) -> f64 {
        let Scenario { start, goal, optimal_length, .. } = *scenario;
        if self.corners() == CornerRule::Forbid && !self.planner.is_any_angle() {
            return optimal_length;
        }
        f64::from(goal.x - start.x).hypot(f64::from(goal.y - start.y))
    }

    /// The answers that are wrong.
    fn mistakes(&self, file: &Path, scenarios: &[Scenario]) -> Vec<Mistake> {
        let config = &self.stack.planner;
        let mistake = |(scenario, answer): (&Scenario, &Answer)| {
            let (expected_cells, got) = answer.mistake(config.is_optimal())?;
            Some(Mistake {
                scenarios: file.display().to_string(),
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

    fn row(&self, map: String) -> GridRow {
        let memory_bytes =
            self.map.memory_bytes() + self.planner.memory_bytes() + self.workspace.memory_bytes();
        let config = &self.stack.planner;
        let given = (self.preparation, memory_bytes);
        row(map, config.name(), config.is_optimal(), &self.answers, given)
    }
}

/// The map of a scenario file: beside it (or in the folder of maps) under the name that the file
/// gives, or under the scenario file's own name without `.scen`.
fn map_of(path: &Path, map_dir: Option<&Path>) -> Result<PathBuf, CliError> {
    let folder = map_dir.or(path.parent()).unwrap_or(Path::new(""));
    let named = keyway::map::formats::read_scenarios(path)
        .map_err(|error| CliError::new(Kind::Input, error).field("FILE.scen"))?
        .first()
        .and_then(|scenario| Path::new(&scenario.map).file_name().map(|name| folder.join(name)));
    let own = folder.join(path.file_stem().unwrap_or_default());
    let candidates: Vec<PathBuf> = named
        .into_iter()
        .chain([own])
        .filter(|map| MapFormat::from_path(map) == Some(MapFormat::MovingAi))
        .collect();
    candidates.iter().find(|map| map.is_file()).cloned().ok_or_else(|| {
        let mut names: Vec<String> =
            candidates.iter().map(|map| map.display().to_string()).collect();
        names.dedup();
        let searched = if names.is_empty() { "a .map file".to_owned() } else { names.join(" or ") };
        let message = format!("{}: there is no map, expected {searched}", path.display());
        CliError::new(Kind::Input, message).field("FILE.scen")
    })
}
