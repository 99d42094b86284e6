//! The report of a comparison, `keyway.compare/1`.

use super::against_first::{AgainstFirst, against_first};
use super::contest::{Answer, ContestEntry, Found, Oracle};
use super::left_out::LeftOut;
use super::pooled::pooled;
use super::row::CompareRow;
use super::unsolved::{Unsolved, unsolved};
use super::{Compared, Comparison};
use keyway::geometry::{Point, Polyline};
use keyway::map::formats::digest;
use keyway::search::CornerRule;
use keyway_sim::report::{PlacementInput, PlanOutcome};
use serde::Serialize;
use serde_json::json;

/// Name and version of the report.
pub const SCHEMA: &str = "keyway.compare/1";

/// The report of a comparison, `keyway.compare/1`.
#[derive(Serialize)]
pub struct CompareReport {
    schema: &'static str,
    version: &'static str,
    /// A row for each map, planner and smoother, then those over all maps.
    pub rows: Vec<CompareRow>,
    /// Comparison of each row with the first row of its map.
    pub against_first: Vec<AgainstFirst>,
    maps: Vec<MapPart>,
    #[serde(flatten)]
    queries: QuerySource,
    repeat: u64,
    placement: Option<PlacementInput>,
    config: serde_json::Value,
    /// Written files.
    pub files: Vec<String>,
}

/// Source of the queries.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct QuerySource {
    /// File with pairs of positions.
    pub pairs: Option<String>,
    /// Scenario file of MovingAI.
    pub scen: Option<String>,
    /// Seed of random queries.
    pub seed: Option<u64>,
}

/// A map and the queries on it.
#[derive(Serialize)]
struct MapPart {
    /// Name, as in the rows.
    name: String,
    /// Path of the map file.
    map: String,
    map_digest: String,
    left_out: Vec<LeftOut>,
    queries: Vec<QueryPart>,
    /// Query in the picture, from 1.
    picture_query: Option<usize>,
}

#[derive(Serialize)]
struct QueryPart {
    start: Point,
    goal: Point,
    shortest_m: Shortest,
    /// Line in the file of the queries, from 1.
    line: Option<usize>,
    compared: bool,
    unsolved: Vec<Unsolved>,
}

/// Length of the shortest line under each corner rule.
#[derive(Serialize)]
struct Shortest {
    forbid: Option<f64>,
    allow: Option<f64>,
}

impl CompareReport {
    /// Returns the report of the results on all maps.
    pub(super) fn new(
        comparison: &Comparison,
        maps: &[Compared],
        placement: Option<PlacementInput>,
    ) -> Self {
        let paths = (0..maps.len()).map(|map| comparison.names.path(map).display().to_string());
        let map_part = |(path, map): (String, &Compared)| MapPart {
            name: map.name.clone(),
            map: path,
            map_digest: digest(&map.grid),
            left_out: map.contest.left_out.clone(),
            queries: (0..map.queries.len()).map(|query| query_part(map, query)).collect(),
            picture_query: map.picture_query().map(|query| query + 1),
        };
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            rows: maps.iter().flat_map(Compared::rows).chain(pooled(maps)).collect(),
            against_first: maps.iter().flat_map(against_first).collect(),
            maps: paths.zip(maps).map(map_part).collect(),
            queries: comparison.queries.source(),
            repeat: comparison.repeat,
            placement,
            config: json!({
                "map": comparison.choice.map,
                "planners": comparison.choice.planners,
                "smoothers": comparison.choice.smoothers,
            }),
            files: Vec::new(),
        }
    }
}

fn query_part(map: &Compared, query: usize) -> QueryPart {
    let shortest_m = |corners| {
        let oracle = map.contest.oracles.iter().find(|oracle: &&Oracle| oracle.corners == corners);
        oracle.and_then(|oracle| oracle.lines[query].as_ref()).map(Polyline::length_m)
    };
    let (start, goal) = (map.queries[query].start, map.queries[query].goal);
    let [forbid, allow] = [CornerRule::Forbid, CornerRule::Allow].map(shortest_m);
    QueryPart {
        start,
        goal,
        shortest_m: Shortest { forbid, allow },
        line: map.queries[query].line,
        compared: map.counts[query],
        unsolved: unsolved(&map.contest.entries, query),
    }
}

/// One answer, for the table of all answers.
#[derive(Serialize)]
pub struct QueryRow<'a> {
    map: &'a str,
    planner: &'static str,
    smoother: &'static str,
    /// Number of the query, from 1.
    query: usize,
    start_x_m: f64,
    start_y_m: f64,
    goal_x_m: f64,
    goal_y_m: f64,
    outcome: PlanOutcome,
    compared: bool,
    length_m: Option<f64>,
    shortest_m: Option<f64>,
    excess: Option<f64>,
    turns: Option<usize>,
    turning_angle_deg: Option<f64>,
    non_smooth_turns: Option<usize>,
    min_clearance_m: Option<f64>,
    kept_clearance_m: Option<f64>,
    expanded: Option<u64>,
    generated: Option<u64>,
    plan_us: Option<f64>,
    plan_cpu_us: Option<f64>,
    smooth_us: Option<f64>,
    smooth_cpu_us: Option<f64>,
    /// Reason why there is no path.
    reason: Option<&'a str>,
    line: Option<usize>,
}

/// All answers on one map.
pub fn query_rows(map: &Compared) -> impl Iterator<Item = QueryRow<'_>> {
    let row = move |entry| (0..map.queries.len()).map(move |query| query_row(map, entry, query));
    map.contest.entries.iter().flat_map(row)
}

fn query_row<'a>(map: &'a Compared, entry: &'a ContestEntry, query: usize) -> QueryRow<'a> {
    let ends = map.queries[query];
    let Answer { outcome, reason, plan, found, .. } = &entry.answers[query];
    let found = found.as_ref();
    QueryRow {
        map: &map.name,
        planner: entry.planner,
        smoother: entry.smoother,
        query: query + 1,
        start_x_m: ends.start.x,
        start_y_m: ends.start.y,
        goal_x_m: ends.goal.x,
        goal_y_m: ends.goal.y,
        outcome: *outcome,
        compared: map.counts[query],
        length_m: found.map(|found| found.metrics.length_m),
        shortest_m: found.and_then(|found| found.shortest_m),
        excess: found.and_then(Found::excess),
        turns: found.map(|found| found.metrics.turns),
        turning_angle_deg: found.map(|found| found.metrics.turning_angle_deg),
        non_smooth_turns: found.map(|found| found.metrics.non_smooth_turns),
        min_clearance_m: found.and_then(|found| found.metrics.min_clearance_m),
        kept_clearance_m: found.and_then(|found| found.done.kept_clearance_m),
        expanded: found.map(|found| found.expanded),
        generated: found.map(|found| found.generated),
        plan_us: plan.map(|plan| plan.wall_us()),
        plan_cpu_us: plan.and_then(|plan| plan.cpu_us()),
        smooth_us: found.and_then(|found| Some(found.smooth?.wall_us())),
        smooth_cpu_us: found.and_then(|found| found.smooth?.cpu_us()),
        reason: reason.as_deref(),
        line: ends.line,
    }
}
