//! Every one-sided planner against best-first search as written by the textbooks and \[Wang2019\]:
//! two lists, searched from end to end. The same cells and the same counts must result, so ties,
//! the improved node, the treatment of closed nodes and the end of the search are all as
//! documented.

use crate::planners::ask;
use crate::support::{Raw, Rules, any_raw, any_rules, query_on};
use keyway::map::Cell;
use keyway::plan::{
    AStar4Config, AStarConfig, DijkstraConfig, GreedyConfig, Heuristic, PathCost, PlanError,
    PlannerConfig,
};
use keyway::search::{Cost, Query, SideStatistics, Workspace};
use proptest::prelude::*;
use std::cmp::Reverse;

/// A line of the open or the closed list.
#[derive(Clone, Copy)]
struct Line {
    at: Cell,
    parent: Cell,
    g: u64,
    f: u64,
}

impl Line {
    /// f, then larger g (in 89ths of a cell), then lower row and column.
    fn order(&self) -> (u64, Reverse<u64>, (i32, i32)) {
        (self.f, Reverse(self.g >> 20), (self.at.y, self.at.x))
    }
}

/// The properties that distinguish the planners.
#[derive(Clone, Copy)]
struct Kind {
    g_is_straight: bool,
    f_has_g: bool,
    heuristic: Option<Heuristic>,
}

/// A distance as documented: rounded down to fixed point.
fn distance(heuristic: Heuristic, a: Cell, b: Cell) -> u64 {
    let (dx, dy) = (u64::from(a.x.abs_diff(b.x)), u64::from(a.y.abs_diff(b.y)));
    let unit = u128::from(Cost::KEY_STRAIGHT);
    let euclidean = (unit * unit * u128::from(dx * dx + dy * dy)).isqrt() as u64;
    let manhattan = (dx + dy) * Cost::KEY_STRAIGHT;
    match heuristic {
        Heuristic::Octile => dx.abs_diff(dy) * Cost::KEY_STRAIGHT + dx.min(dy) * Cost::KEY_DIAGONAL,
        Heuristic::Euclidean => euclidean,
        Heuristic::Manhattan => manhattan,
        Heuristic::Mean => u64::midpoint(euclidean, manhattan),
        other => panic!("no distance is known here for {other:?}"),
    }
}

/// Steps 1 to 8 of \[Wang2019\]; with accumulated g the goal must be taken out of the open list.
fn search(
    raw: &Raw,
    rules: &Rules,
    query: &Query,
    kind: Kind,
) -> (Option<Vec<Cell>>, SideStatistics) {
    let line = |at, parent, g| {
        let h = kind.heuristic.map_or(0, |heuristic| distance(heuristic, at, query.goal));
        Line { at, parent, g, f: if kind.f_has_g { g + h } else { h } }
    };
    let mut open = vec![line(query.start, query.start, 0)];
    let mut closed: Vec<Line> = Vec::new();
    let mut statistics = SideStatistics { expanded: 0, generated: 1 };
    loop {
        if kind.g_is_straight && open.iter().any(|line| line.at == query.goal) {
            return (Some(path(&open, &closed, query.goal)), statistics);
        }
        let Some(best) = (0..open.len()).min_by_key(|&i| open[i].order()) else {
            return (None, statistics);
        };
        let from = open.swap_remove(best);
        closed.push(from);
        statistics.expanded += 1;
        if from.at == query.goal {
            return (Some(path(&open, &closed, query.goal)), statistics);
        }
        for (to, cost) in raw.steps(from.at, rules) {
            if closed.iter().any(|line| line.at == to) {
                continue;
            }
            let g = if kind.g_is_straight {
                distance(Heuristic::Euclidean, query.start, to)
            } else {
                from.g + cost.key()
            };
            match open.iter_mut().find(|line| line.at == to) {
                None => open.push(line(to, from.at, g)),
                Some(known) if g < known.g || (kind.g_is_straight && g == known.g) => {
                    *known = line(to, from.at, g);
                }
                Some(_) => continue,
            }
            statistics.generated += 1;
        }
    }
}

/// Back from the goal over the parents.
fn path(open: &[Line], closed: &[Line], goal: Cell) -> Vec<Cell> {
    let lines: Vec<&Line> = open.iter().chain(closed).collect();
    let mut path = vec![goal];
    loop {
        let at = path[path.len() - 1];
        let line = lines.iter().find(|line| line.at == at).unwrap();
        if line.parent == at {
            path.reverse();
            return path;
        }
        path.push(line.parent);
    }
}

/// All one-sided planners of a corner rule, with their properties.
fn planners(rules: &Rules) -> Vec<(PlannerConfig, Kind, Rules)> {
    let corners = rules.corners;
    let kind = |g_is_straight, f_has_g, heuristic| Kind { g_is_straight, f_has_g, heuristic };
    let dijkstra = PlannerConfig::Dijkstra(DijkstraConfig { corners });
    let mut all = vec![(dijkstra, kind(false, true, None), *rules)];
    for heuristic in
        [Heuristic::Octile, Heuristic::Euclidean, Heuristic::Manhattan, Heuristic::Mean]
    {
        let some = Some(heuristic);
        let astar = |g| PlannerConfig::AStar(AStarConfig { corners, heuristic, g });
        let greedy = PlannerConfig::Greedy(GreedyConfig { corners, heuristic });
        let astar4 = PlannerConfig::AStar4(AStar4Config { heuristic });
        let without_diagonals = Rules { diagonals: false, ..*rules };
        all.push((astar(PathCost::Accumulated), kind(false, true, some), *rules));
        all.push((astar(PathCost::StraightLine), kind(true, true, some), *rules));
        all.push((greedy, kind(false, false, some), *rules));
        all.push((astar4, kind(false, true, some), without_diagonals));
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn planners_are_what_the_textbooks_say(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let query = query_on(&raw, ends);
        let free = |cell: Cell| raw.is_free(cell.x, cell.y, rules.unknown);
        prop_assume!(free(query.start) && free(query.goal));
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        for (planner, kind, rules) in planners(&rules) {
            // A missing path is reported without a search.
            let (path, statistics) = match search(&raw, &rules, &query, kind) {
                (Some(path), statistics) => (Some(path), statistics),
                (None, _) => (None, SideStatistics::default()),
            };
            let answer = match ask(&planner, &map, &query, &mut workspace).unwrap() {
                Ok(plan) => (Some(plan.cells), plan.statistics.forward),
                Err(PlanError::NoPath { statistics }) => (None, statistics.forward),
                Err(error) => panic!("{error}"),
            };
            prop_assert_eq!(answer, (path, statistics), "{:?}\n{}", planner, raw.drawing());
        }
    }
}

/// In the traditional A* of \[Wang2019\] the parent of an open cell is always the neighbour
/// expanded last, so its path is not a shortest one even in open space.
#[test]
fn the_traditional_g_makes_detours() {
    let raw = Raw::from_fn(9, 7, |x, y| !(x == 4 && (1..=5).contains(&y)));
    let traditional = AStarConfig {
        heuristic: Heuristic::Euclidean,
        g: PathCost::StraightLine,
        ..AStarConfig::default()
    };
    let query = Query::new(Cell::new(1, 3), Cell::new(7, 3));
    let map = raw.search_map(&Rules::default());
    let cost = |config| {
        let planner = PlannerConfig::AStar(config);
        ask(&planner, &map, &query, &mut Workspace::default()).unwrap().unwrap().cost
    };
    assert!(cost(traditional) > cost(AStarConfig::default()));
}
