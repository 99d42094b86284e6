//! All planners and smoothers on one map.
//!
//! The planners take turns, round by round. For each query, the fastest round of each planner
//! counts. Smoothers run after the planner whose paths they smooth.

use super::choice::Choice;
use super::ends::Ends;
use super::left_out::LeftOut;
use super::{CompareError, Comparison};
use crate::corner_rule::corner_rule;
use crate::measure::{StageTimer, Times, timed_if};
use crate::progress::Progress;
use keyway::geometry::{PlannedLine, Polyline};
use keyway::map::{Connectivity, SearchMap};
use keyway::plan::{GlobalPlanner, Plan, PlanError, PlanNote, PlannerConfig, shortest_line};
use keyway::route::{RouteQuery, smooth_line};
use keyway::search::{CornerRule, Workspace};
use keyway::smooth::{Smoothed, SmootherConfig};
use keyway_sim::metrics::PathMetrics;
use keyway_sim::report::PlanOutcome;

/// Answers of one planner with one smoother to each query.
pub struct ContestEntry {
    /// Name of the planner.
    pub planner: &'static str,
    /// Name of the smoother.
    pub smoother: &'static str,
    /// Corner rule of the planner.
    pub corners: CornerRule,
    /// Preparation time of the planner; `None` if times are left out.
    pub preparation: Option<Times>,
    /// Answers to all queries, in their order.
    pub answers: Vec<Answer>,
}

/// Answer to one query.
pub struct Answer {
    /// Result of the search.
    pub outcome: PlanOutcome,
    /// Reason why no path was found, as [`CompareRequest::why`](super::CompareRequest::why) words
    /// it.
    pub reason: Option<String>,
    /// Search time; `None` if times are left out.
    pub plan: Option<Times>,
    /// The planner's note on its plan.
    pub note: Option<PlanNote>,
    /// The path, if one was found.
    pub found: Option<Found>,
}

/// A smoothed and measured path.
pub struct Found {
    /// Smoothing time; `None` if nothing is smoothed, or times are left out.
    pub smooth: Option<Times>,
    /// The smoothed path.
    pub done: Smoothed,
    /// Metrics of the smoothed path.
    pub metrics: PathMetrics,
    /// Length of the shortest line between the same start and goal \[m\].
    pub shortest_m: Option<f64>,
    /// Nodes that the search expanded.
    pub expanded: u64,
    /// Nodes that the search generated.
    pub generated: u64,
}

impl Found {
    /// Relative excess of the path's length over the shortest line.
    pub fn excess(&self) -> Option<f64> {
        let shortest_m = self.shortest_m?;
        // Lines of length 0 have no excess.
        let is_same = self.metrics.length_m == shortest_m;
        Some(if is_same { 0.0 } else { self.metrics.length_m / shortest_m - 1.0 })
    }
}

/// The shortest lines of all queries under one corner rule; `None` for a query without one.
pub struct Oracle {
    /// The corner rule.
    pub corners: CornerRule,
    /// The line of each query.
    pub lines: Vec<Option<Polyline>>,
}

/// Results of a comparison on one map.
pub struct Contest {
    /// All pairs of a planner and a smoother.
    pub entries: Vec<ContestEntry>,
    /// Planners of `all` that cannot plan on this map.
    pub left_out: Vec<LeftOut>,
    /// The shortest lines, for each corner rule of the planners.
    pub oracles: Vec<Oracle>,
}

pub(super) fn compete(
    map: &SearchMap,
    comparison: &Comparison,
    queries: &[Ends],
    progress: &dyn Progress,
) -> Result<Contest, CompareError> {
    let Choice { planners, smoothers, leaves_out_unfit, .. } = &comparison.choice;
    for connectivity in [Connectivity::Four, Connectivity::Eight] {
        map.components(connectivity);
    }
    let (mut contenders, mut left_out) = (Vec::new(), Vec::new());
    for planner in planners {
        match Contender::prepare(planner, (smoothers.len(), comparison.has_times), map) {
            Ok(contender) => contenders.push(contender),
            Err(error) if *leaves_out_unfit && LeftOut::is_for(&error) => {
                left_out.push(LeftOut::new(planner.name(), &error));
            }
            Err(error) => {
                return Err(CompareError::Planner { name: planner.name(), error: in_stack(error) });
            }
        }
    }
    progress.expect(comparison.repeat as usize * contenders.len() * queries.len());
    for _ in 0..comparison.repeat {
        for contender in &mut contenders {
            contender.plan_all(map, queries, (comparison.why, progress))?;
            contender.smooth_all(map, smoothers)?;
        }
    }
    let oracles = oracles(map, &contenders, queries);
    let entries = contenders.iter().flat_map(|one| one.entries(map, smoothers, &oracles)).collect();
    Ok(Contest { entries, left_out, oracles })
}

/// Returns an oracle for each corner rule of the planners.
fn oracles(map: &SearchMap, contenders: &[Contender], queries: &[Ends]) -> Vec<Oracle> {
    let rules = [CornerRule::Forbid, CornerRule::Allow];
    let is_wanted = |rule: &CornerRule| contenders.iter().any(|one| one.corners() == *rule);
    let oracle = |corners| {
        let line = |ends: &Ends| shortest_line(map, corners, ends.start, ends.goal);
        Oracle { corners, lines: queries.iter().map(line).collect() }
    };
    rules.into_iter().filter(is_wanted).map(oracle).collect()
}

/// A smoothed path, and the smoothing time if anything was smoothed.
type TimedSmoothed = (Smoothed, Option<Times>);

/// A planner with its memory, its results so far, and those of each smoother.
struct Contender {
    planner: Box<dyn GlobalPlanner + Send + Sync>,
    name: &'static str,
    has_times: bool,
    preparation: Option<Times>,
    workspace: Workspace,
    plan: Plan,
    /// Plans, one for each query.
    planned: Vec<Planned>,
    /// Smoothed paths, for each smoother and then for each query.
    smoothed: Vec<Vec<Option<TimedSmoothed>>>,
}

struct Planned {
    outcome: PlanOutcome,
    reason: Option<String>,
    times: Option<Times>,
    note: Option<PlanNote>,
    expanded: u64,
    generated: u64,
    line: Option<PlannedLine>,
}

impl Contender {
    fn prepare(
        config: &PlannerConfig,
        (smoothers, has_times): (usize, bool),
        map: &SearchMap,
    ) -> Result<Self, PlanError> {
        let (planner, preparation) = timed_if(has_times, || config.build(map));
        let planner = planner?;
        if planner.needs_uniform_cost() && map.penalised().is_some() {
            return Err(PlanError::NeedsUniformCost { planner: config.name() });
        }
        Ok(Self {
            planner,
            name: config.name(),
            has_times,
            preparation,
            workspace: Workspace::default(),
            plan: Plan::default(),
            planned: Vec::new(),
            smoothed: std::iter::repeat_with(Vec::new).take(smoothers).collect(),
        })
    }

    fn corners(&self) -> CornerRule {
        corner_rule(&*self.planner)
    }

    /// Plans all queries: the first round keeps the answers, later rounds keep faster times.
    fn plan_all(
        &mut self,
        map: &SearchMap,
        queries: &[Ends],
        (why, progress): (fn(&PlanError) -> String, &dyn Progress),
    ) -> Result<(), CompareError> {
        for (i, ends) in queries.iter().enumerate() {
            let query = RouteQuery::new(ends.start, ends.goal);
            let Self { planner, workspace, plan, has_times, .. } = self;
            let mut timer = StageTimer::new(*has_times);
            let result = query.search(map, &**planner, workspace, plan, &mut timer);
            let times = timer.search;
            if let Some(planned) = self.planned.get_mut(i) {
                if let (Some(best), Some(times)) = (&mut planned.times, times) {
                    best.keep_faster(times);
                }
            } else {
                let line = result.is_ok().then(|| query.line(map, &self.plan));
                let outcome = match &result {
                    Ok(()) => PlanOutcome::Found,
                    Err(error) => outcome(error)?,
                };
                let reason = result.err().map(|error| why(&error));
                let note = self.plan.note;
                let [expanded, generated] =
                    [self.plan.statistics.expanded(), self.plan.statistics.generated()];
                let planned = Planned { outcome, reason, times, note, expanded, generated, line };
                self.planned.push(planned);
            }
            if progress.answered().is_break() {
                return Err(CompareError::Stopped);
            }
        }
        Ok(())
    }

    fn smooth_all(
        &mut self,
        map: &SearchMap,
        smoothers: &[SmootherConfig],
    ) -> Result<(), CompareError> {
        let clearance_m = map.config().clearance_m;
        for (config, results) in smoothers.iter().zip(&mut self.smoothed) {
            let smoother =
                config.build().map_err(|error| CompareError::Smoother(error.within("smoother")))?;
            // Without a smoother, the planned line is also measured and checked, but that is not
            // smoothing.
            let is_smoother = !matches!(config, SmootherConfig::None(_));
            for (i, planned) in self.planned.iter().enumerate() {
                let smooth = |line| {
                    let mut timer = StageTimer::new(self.has_times);
                    let done = smooth_line(map, &*smoother, line, clearance_m, &mut timer);
                    (done, timer.smoothing.filter(|_| is_smoother))
                };
                let result = planned.line.as_ref().map(smooth);
                match (results.get_mut(i), result) {
                    (None, result) => results.push(result),
                    (Some(Some((_, Some(best)))), Some((_, Some(times)))) => {
                        best.keep_faster(times);
                    }
                    (Some(_), _) => {}
                }
            }
        }
        Ok(())
    }

    fn entries<'a>(
        &'a self,
        map: &'a SearchMap,
        smoothers: &'a [SmootherConfig],
        oracles: &'a [Oracle],
    ) -> impl Iterator<Item = ContestEntry> + 'a {
        let corners = self.corners();
        let oracle = oracles.iter().find(move |oracle| oracle.corners == corners);
        let shortest_m = move |i: usize| {
            oracle.and_then(|oracle| oracle.lines[i].as_ref()).map(Polyline::length_m)
        };
        smoothers.iter().zip(&self.smoothed).map(move |(smoother, smoothed)| ContestEntry {
            planner: self.name,
            smoother: smoother.name(),
            corners,
            preparation: self.preparation,
            answers: (self.planned.iter().zip(smoothed).enumerate())
                .map(|(i, (planned, smoothed))| {
                    planned.answer(smoothed.as_ref(), map, shortest_m(i))
                })
                .collect(),
        })
    }
}

impl Planned {
    fn answer(
        &self,
        smoothed: Option<&TimedSmoothed>,
        map: &SearchMap,
        shortest_m: Option<f64>,
    ) -> Answer {
        let found = smoothed.map(|(done, smooth)| Found {
            smooth: *smooth,
            metrics: PathMetrics::of_path(&done.path, map.clearance()),
            done: done.clone(),
            shortest_m,
            expanded: self.expanded,
            generated: self.generated,
        });
        let (outcome, reason) = (self.outcome, self.reason.clone());
        Answer { outcome, reason, plan: self.times, note: self.note, found }
    }
}

/// Renames the field of an invalid config to that of a stack.
fn in_stack(error: PlanError) -> PlanError {
    match error {
        PlanError::Config(error) => PlanError::Config(error.within("planner")),
        error => error,
    }
}

/// Returns the outcome of a search without a path; an error if the planner cannot plan on such a
/// map at all.
fn outcome(error: &PlanError) -> Result<PlanOutcome, CompareError> {
    if let PlanError::Constrained { .. } = error {
        return Ok(PlanOutcome::Missed);
    }
    match PlanOutcome::of(error).0 {
        PlanOutcome::Refused => Err(CompareError::Query(error.clone())),
        outcome => Ok(outcome),
    }
}
