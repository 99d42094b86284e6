//! Paths in any direction, against all straight lines between the cells of a map.

use crate::brute_force::check_observer;
use crate::planners::ask;
use crate::support::{Raw, Rules, any_raw, any_rules, query_on};
use keyway::map::{Cell, UnknownPolicy};
use keyway::plan::{
    LazyThetaStarConfig, Plan, PlanError, PlannerConfig, RrtConfig, ThetaStarConfig,
};
use keyway::search::{CornerRule, Observer, Query, Side, Workspace};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Rounding of sums of lengths \[cells\].
const TOLERANCE: f64 = 1e-6;

fn theta_star(corners: CornerRule) -> PlannerConfig {
    PlannerConfig::ThetaStar(ThetaStarConfig { corners })
}

fn lazy_theta_star(corners: CornerRule) -> PlannerConfig {
    PlannerConfig::LazyThetaStar(LazyThetaStarConfig { corners })
}

/// The distance of two cells' centres.
pub(crate) fn length(a: Cell, b: Cell) -> f64 {
    f64::from(a.x - b.x).hypot(f64::from(a.y - b.y))
}

/// True if the line between two centres meets no blocked cell. It meets a cell unless the cell's
/// open square is all on one side of it. If corners must not be cut, it also meets cells that it
/// touches at a corner.
pub(crate) fn sees(raw: &Raw, rules: &Rules, a: Cell, b: Cell) -> bool {
    let columns = a.x.min(b.x)..=a.x.max(b.x);
    let cells = (a.y.min(b.y)..=a.y.max(b.y)).flat_map(|y| columns.clone().map(move |x| (x, y)));
    // Twice the side of the corner (x + i / 2, y + j / 2).
    let side = |(x, y): (i32, i32), (i, j): (i32, i32)| {
        (b.x - a.x) * (2 * (y - a.y) + j) - (b.y - a.y) * (2 * (x - a.x) + i)
    };
    cells.filter(|&(x, y)| !raw.is_free(x, y, rules.unknown)).all(|cell| {
        let sides = [(-1, -1), (1, -1), (-1, 1), (1, 1)].map(|corner| side(cell, corner));
        let is_beside = sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0);
        let is_touched = rules.corners == CornerRule::Forbid && sides.contains(&0);
        is_beside && !is_touched
    })
}

/// The length of a shortest path of lines between mutually visible cells.
pub(crate) fn optimum(raw: &Raw, rules: &Rules, query: &Query) -> Option<f64> {
    let is_free = |cell: &Cell| raw.is_free(cell.x, cell.y, rules.unknown);
    if !is_free(&query.start) || !is_free(&query.goal) {
        return None;
    }
    let mut open: Vec<(f64, Cell)> =
        raw.cells().filter(is_free).map(|cell| (f64::INFINITY, cell)).collect();
    open.iter_mut().find(|(_, cell)| *cell == query.start).unwrap().0 = 0.0;
    while !open.is_empty() {
        let nearest = (0..open.len()).min_by(|&i, &j| open[i].0.total_cmp(&open[j].0)).unwrap();
        let (g, at) = open.swap_remove(nearest);
        if at == query.goal || g.is_infinite() {
            return g.is_finite().then_some(g);
        }
        for (known, to) in &mut open {
            let through = g + length(at, *to);
            if through < *known && sees(raw, rules, at, *to) {
                *known = through;
            }
        }
    }
    None
}

/// A path's length. Checks that it leads from the start to the goal over lines that are free,
/// turns at every waypoint, and has the reported length.
fn checked_length(raw: &Raw, rules: &Rules, query: &Query, plan: &Plan) -> f64 {
    let cells = &plan.cells;
    assert_eq!((cells.first(), cells.last()), (Some(&query.start), Some(&query.goal)));
    for pair in cells.windows(2) {
        assert!(sees(raw, rules, pair[0], pair[1]), "{cells:?}\n{}", raw.drawing());
    }
    for turn in cells.windows(3) {
        let ((x1, y1), (x2, y2)) = (
            (turn[1].x - turn[0].x, turn[1].y - turn[0].y),
            (turn[2].x - turn[1].x, turn[2].y - turn[1].y),
        );
        let goes_on = x1 * y2 == x2 * y1 && x1 * x2 + y1 * y2 > 0;
        assert!(!goes_on, "{cells:?} goes straight on");
    }
    let walked: f64 = cells.windows(2).map(|pair| length(pair[0], pair[1])).sum();
    assert!(plan.cost.steps().is_none() && (walked - plan.cost.cells()).abs() < TOLERANCE);
    walked
}

/// The tree that is reported to an observer.
#[derive(Default)]
struct Tree {
    parents: BTreeMap<Cell, Cell>,
    expanded: u64,
    generated: u64,
}

impl Observer for Tree {
    fn expanded(&mut self, _: Side, _: Cell, _: f64) {
        self.expanded += 1;
    }

    fn generated(&mut self, _: Side, at: Cell, parent: Cell, _: f64) {
        self.generated += 1;
        self.parents.insert(at, parent);
    }

    fn reparented(&mut self, _: Side, at: Cell, parent: Cell, _: f64) {
        self.parents.insert(at, parent);
    }
}

/// The path is that of the tree reported to an observer, from which only cells on its lines are
/// missing; and the observer changes nothing.
fn check_tree(planner: &PlannerConfig, raw: &Raw, rules: &Rules, query: &Query, silent: &Plan) {
    let map = raw.search_map(rules);
    let (mut tree, mut plan) = (Tree::default(), Plan::default());
    let built = planner.build(&map).unwrap();
    built.plan_into(&map, query, &mut Workspace::default(), Some(&mut tree), &mut plan).unwrap();
    assert_eq!(&plan, silent);
    let statistics = plan.statistics;
    assert_eq!(
        (statistics.expanded(), statistics.generated()),
        (tree.expanded, tree.generated + 1)
    );
    let mut at = query.goal;
    let mut reported = vec![at];
    while at != query.start {
        at = tree.parents[&at];
        reported.push(at);
    }
    reported.reverse();
    let mut rest = reported.iter();
    assert!(
        plan.cells.iter().all(|cell| rest.any(|reported| reported == cell)),
        "{reported:?} {plan:?}"
    );
    let reported_length: f64 = reported.windows(2).map(|pair| length(pair[0], pair[1])).sum();
    assert!((reported_length - plan.cost.cells()).abs() < TOLERANCE);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn theta_star_is_between_the_optima(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        let optimum = optimum(&raw, &rules, &query);
        for planner in [theta_star(rules.corners), lazy_theta_star(rules.corners)] {
            let answer = ask(&planner, &map, &query, &mut workspace);
            if rules.unknown == UnknownPolicy::Penalised {
                // Unless start or goal are first reported as blocked or not connected.
                prop_assert!(answer.is_none_or(|answer| answer.is_err()));
                continue;
            }
            let answer = answer.unwrap();
            prop_assert_eq!(answer.is_ok(), optimum.is_some(), "{:?}\n{}", planner, raw.drawing());
            let Ok(plan) = answer else { continue };
            let length = checked_length(&raw, &rules, &query, &plan);
            prop_assert!(length >= optimum.unwrap() - TOLERANCE, "{:?}\n{}", planner, raw.drawing());
            if planner == theta_star(rules.corners) {
                let by_steps = raw.optimum(&query, &rules).unwrap().cells();
                prop_assert!(length <= by_steps + TOLERANCE, "{:?}\n{}", query, raw.drawing());
            }
            prop_assert_eq!(ask(&planner, &map, &query, &mut workspace), Some(Ok(plan.clone())));
            check_observer(&planner, &raw, &rules, &query);
            check_tree(&planner, &raw, &rules, &query, &plan);
        }
    }

    #[test]
    fn a_random_tree(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32), seed: u64,
                     step_m in prop_oneof![Just(1.0), 0.2..6.0f64], goal_bias in 0.0..0.5f64) {
        let rules = Rules { unknown: UnknownPolicy::Blocked, ..rules };
        let query = query_on(&raw, ends);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        let config = RrtConfig { corners: rules.corners, step_m, goal_bias, seed, samples: 100_000 };
        let planner = PlannerConfig::Rrt(config);
        let answer = ask(&planner, &map, &query, &mut workspace).unwrap();
        let optimum = optimum(&raw, &rules, &query);
        match &answer {
            Ok(plan) => {
                let length = checked_length(&raw, &rules, &query, plan);
                prop_assert!(length >= optimum.unwrap() - TOLERANCE, "{:?}\n{}", planner, raw.drawing());
                check_tree(&planner, &raw, &rules, &query, plan);
            }
            Err(PlanError::Missed { .. }) => prop_assert!(step_m >= 1.5, "{}", raw.drawing()),
            Err(PlanError::NoPath { .. } | PlanError::Blocked { .. }) => prop_assert_eq!(optimum, None),
            Err(other) => prop_assert!(false, "{}", other),
        }
        // The same seed gives the same answer, whatever the memory holds.
        let other = Query::new(query.goal, query.start);
        let _ = ask(&planner, &map, &other, &mut workspace);
        prop_assert_eq!(ask(&planner, &map, &query, &mut workspace), Some(answer));
    }
}

#[test]
fn paths_in_any_direction_refuse_penalised_cells() {
    let raw = Raw::from_fn(4, 3, |_, _| true);
    let rules = Rules { unknown: UnknownPolicy::Penalised, ..Rules::default() };
    let query = Query::new(Cell::new(0, 0), Cell::new(3, 2));
    for name in ["theta-star", "lazy-theta-star", "rrt"] {
        let planner = PlannerConfig::by_name(name).unwrap();
        let built = planner.build(&raw.search_map(&rules)).unwrap();
        assert!(built.is_any_angle());
        let error = built
            .plan_into(
                &raw.search_map(&rules),
                &query,
                &mut Workspace::default(),
                None,
                &mut Plan::default(),
            )
            .unwrap_err();
        assert_eq!(error, PlanError::NeedsUniformCost { planner: name });
    }
}
