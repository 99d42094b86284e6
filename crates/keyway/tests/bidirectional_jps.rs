//! Bidirectional jump point search on random maps: it never misses a path with its default meeting
//! rule, and its paths are legal for all parameters.
#![allow(clippy::unwrap_used)]

mod support;

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap, UnknownPolicy,
};
use keyway::plan::{
    BidirectionalJps, BidirectionalJpsConfig, BidirectionalJpsFixedConfig, GlobalPlanner,
    Heuristic, JumpMeeting, Miss, OpenKeys, Plan, PlanError, PlannerConfig,
};
use keyway::search::{Observer, Query, SearchStatistics, Side, Workspace};
use proptest::prelude::*;
use support::{Raw, Rules, query_on};

/// Clutter of any density, crossed by walls with few gaps.
fn any_map() -> impl Strategy<Value = Raw> {
    let clutter = prop_oneof![Just(0.0), 0.0..0.6f64];
    (2i32..26, 2i32..20, clutter).prop_flat_map(|(width, height, density)| {
        let cells = prop::collection::vec(prop::bool::weighted(density), (width * height) as usize);
        let wall = (any::<bool>(), 0i32..26, 0i32..26, 0i32..26);
        let walls = prop::collection::vec(wall, 0..5);
        (cells, walls).prop_map(move |(blocked, walls)| {
            Raw::from_fn(width, height, |x, y| {
                let is_wall = |&(upright, at, gap, other_gap): &(bool, i32, i32, i32)| {
                    let (across, along) = if upright { (x, y) } else { (y, x) };
                    across == at && along != gap && along != other_gap
                };
                !blocked[(y * width + x) as usize] && !walls.iter().any(is_wall)
            })
        })
    })
}

/// Rules that miss no path.
fn any_meeting() -> impl Strategy<Value = JumpMeeting> {
    prop_oneof![Just(JumpMeeting::Generated), Just(JumpMeeting::Expanded), Just(JumpMeeting::Best)]
}

fn any_heuristic() -> impl Strategy<Value = Heuristic> {
    prop_oneof![
        Just(Heuristic::Octile),
        Just(Heuristic::Euclidean),
        Just(Heuristic::Manhattan),
        Just(Heuristic::Mean)
    ]
}

/// Both planners, with parameters far from the paper's as well.
fn any_planners(
    meeting: impl Strategy<Value = JumpMeeting>,
) -> impl Strategy<Value = [PlannerConfig; 2]> {
    let keys = prop_oneof![Just(OpenKeys::Kept), Just(OpenKeys::Renewed)];
    let weight = || prop_oneof![Just(0.0), Just(1.0), Just(3.0), 0.0..1e30f64];
    let any = (meeting, keys, any_heuristic(), weight(), weight());
    any.prop_map(|(meeting, keys, heuristic, a, b)| {
        let moving = BidirectionalJpsConfig { meeting, keys, heuristic, a, b };
        let fixed = BidirectionalJpsFixedConfig { meeting, heuristic, a };
        [PlannerConfig::BidirectionalJps(moving), PlannerConfig::BidirectionalJpsFixed(fixed)]
    })
}

/// Counts its events, and checks that scans are lines of free cells.
struct Counter<'m> {
    map: &'m SearchMap,
    reported: SearchStatistics,
    met: Option<Cell>,
}

impl Observer for Counter<'_> {
    fn expanded(&mut self, side: Side, _: Cell, _: f64) {
        self.reported.side_mut(side).expanded += 1;
    }

    fn generated(&mut self, side: Side, at: Cell, _: Cell, _: f64) {
        assert!(self.map.is_free(at));
        self.reported.side_mut(side).generated += 1;
    }

    fn scanned(&mut self, _: Side, from: Cell, to: Cell) {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        assert!(dx == 0 || dy == 0 || dx.abs() == dy.abs());
        for k in 1..=dx.abs().max(dy.abs()) {
            assert!(
                self.map.is_free(Cell::new(from.x + k * dx.signum(), from.y + k * dy.signum()))
            );
        }
    }

    fn met(&mut self, at: Cell) {
        self.met = Some(at);
    }
}

/// Plans; the path is legal and has the reported length, and the observed events agree with the
/// statistics.
fn checked_plan(config: &PlannerConfig, raw: &Raw, query: &Query) -> Result<Plan, PlanError> {
    let rules = Rules::default();
    let map = raw.search_map(&rules);
    let planner = config.build(&map).unwrap();
    let mut seen = Counter { map: &map, reported: SearchStatistics::default(), met: None };
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    planner.plan_into(&map, query, &mut workspace, Some(&mut seen), &mut plan)?;
    let walked = raw.walk(&plan.cells, query, &rules);
    assert!(walked.is_some(), "illegal path\n{}", raw.drawing());
    assert_eq!(plan.cost.steps(), walked);
    assert!(plan.cells.contains(&plan.meeting.unwrap()));
    // The roots count, but are not reported.
    seen.reported.forward.generated += 1;
    seen.reported.backward.generated += 1;
    assert_eq!(seen.reported, plan.statistics);
    assert!(query.start == query.goal || seen.met == plan.meeting);
    Ok(plan)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6000, ..ProptestConfig::default() })]

    #[test]
    fn a_path_that_exists_is_found(raw in any_map(), ends: (u32, u32, u32, u32),
                                   planners in any_planners(any_meeting())) {
        let query = query_on(&raw, ends);
        for planner in planners {
            match checked_plan(&planner, &raw, &query) {
                Ok(plan) => {
                    let optimum = raw.optimum(&query, &Rules::default());
                    prop_assert!(plan.cost.steps() >= optimum && optimum.is_some());
                }
                Err(PlanError::NoPath { .. } | PlanError::Blocked { .. }) => {
                    prop_assert_eq!(raw.optimum(&query, &Rules::default()), None);
                }
                Err(other) => prop_assert!(false, "{} {}\n{}", planner.name(), other, raw.drawing()),
            }
        }
    }

    /// Continuing after the sides have met never makes the path longer, and expands the remaining
    /// nodes, too.
    #[test]
    fn going_on_is_no_worse(raw in any_map(), ends: (u32, u32, u32, u32),
                            of_first in any_planners(Just(JumpMeeting::Generated))) {
        let query = query_on(&raw, ends);
        let of_best = of_first.clone().map(|planner| match planner {
            PlannerConfig::BidirectionalJps(config) => {
                let meeting = JumpMeeting::Best;
                PlannerConfig::BidirectionalJps(BidirectionalJpsConfig { meeting, ..config })
            }
            PlannerConfig::BidirectionalJpsFixed(config) => {
                let meeting = JumpMeeting::Best;
                PlannerConfig::BidirectionalJpsFixed(BidirectionalJpsFixedConfig { meeting, ..config })
            }
            other => other,
        });
        for (first, best) in of_first.iter().zip(&of_best) {
            let Ok(first) = checked_plan(first, &raw, &query) else { continue };
            let best = checked_plan(best, &raw, &query).unwrap();
            prop_assert!(best.cost.steps() <= first.cost.steps(), "{}", raw.drawing());
            prop_assert!(best.statistics.expanded() >= first.statistics.expanded());
        }
    }

    /// The literal rule misses only moving targets.
    #[test]
    fn the_literal_rule_gives_legal_paths(raw in any_map(), ends: (u32, u32, u32, u32),
                                          planners in any_planners(Just(JumpMeeting::Literal))) {
        let query = query_on(&raw, ends);
        let exists = raw.optimum(&query, &Rules::default()).is_some();
        let fixed = checked_plan(&planners[1], &raw, &query);
        prop_assert_eq!(fixed.is_ok(), exists, "{}", raw.drawing());
        match checked_plan(&planners[0], &raw, &query) {
            Ok(_) | Err(PlanError::Missed { miss: Miss::SidesPassed, .. }) => prop_assert!(exists),
            Err(PlanError::NoPath { .. } | PlanError::Blocked { .. }) => prop_assert!(!exists),
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}

/// A side's scans cross words of 64 cells, and one workspace serves maps of several sizes.
#[test]
fn wide_and_high_maps() {
    let mut workspace = Workspace::default();
    for (width, height) in [(130, 9), (9, 130), (64, 64), (63, 65)] {
        // Walls with a gap at alternating ends.
        let raw = Raw::from_fn(width, height, |x, y| {
            let (along, across, end) =
                if width > height { (x, y, height - 1) } else { (y, x, width - 1) };
            along % 4 != 2 || across == if along % 8 == 2 { 0 } else { end }
        });
        let query = Query::new(Cell::new(0, 0), Cell::new(width - 1, height - 1));
        let map = raw.search_map(&Rules::default());
        for name in ["bidirectional-jps", "bidirectional-jps-fixed"] {
            let planner = PlannerConfig::by_name(name).unwrap();
            let mut plan = Plan::default();
            let built = planner.build(&map).unwrap();
            built.plan_into(&map, &query, &mut workspace, None, &mut plan).unwrap();
            assert_eq!(plan, checked_plan(&planner, &raw, &query).unwrap());
        }
    }
}

#[test]
fn penalised_cells_are_refused() {
    let frame = GridFrame::new(3, 1, 1.0, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |_| CellState::Unknown);
    let config = LayerConfig { unknown: UnknownPolicy::Penalised, ..LayerConfig::default() };
    let map = SearchMap::new(&grid, config).unwrap();
    let query = Query::new(Cell::new(0, 0), Cell::new(2, 0));
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let planner = BidirectionalJps::default();
    let error = planner.plan_into(&map, &query, &mut workspace, None, &mut plan).unwrap_err();
    assert_eq!(error, PlanError::NeedsUniformCost { planner: "bidirectional-jps" });
}
