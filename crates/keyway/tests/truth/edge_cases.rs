//! Extreme maps and queries.

use crate::planners::{ask, checked_cost, optimal};
use crate::support::{Raw, Rules};
use keyway::geometry::Point;
use keyway::map::{BlockedBy, Cell};
use keyway::plan::{HstaConfig, PathEnd, PlanError, PlannerConfig};
use keyway::search::{CornerRule, Cost, Query, Workspace};
use keyway::smooth::SmootherConfig;

fn raw(rows: &[&str]) -> Raw {
    let height = rows.len() as i32;
    Raw::from_fn(rows[0].len() as i32, height, |x, y| {
        rows[(height - 1 - y) as usize].as_bytes()[x as usize] == b'.'
    })
}

fn query(start: (i32, i32), goal: (i32, i32)) -> Query {
    Query::new(Cell::new(start.0, start.1), Cell::new(goal.0, goal.1))
}

/// Every planner there is.
fn all() -> Vec<PlannerConfig> {
    PlannerConfig::NAMES.iter().filter_map(|name| PlannerConfig::by_name(name)).collect()
}

/// The planner without a distance to obstacles, which would close a gap of one cell.
fn without_distance(planner: PlannerConfig) -> PlannerConfig {
    match planner {
        PlannerConfig::Hsta(config) => {
            PlannerConfig::Hsta(HstaConfig { l1_constraint: 0.0, ..config })
        }
        other => other,
    }
}

/// Every optimal planner must give this cost, or no path.
fn expect(raw: &Raw, query: &Query, expected: Option<Cost>) {
    let rules = Rules::default();
    let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
    for planner in optimal(CornerRule::Forbid) {
        let answer = ask(&planner, &map, query, &mut workspace).unwrap();
        let cost = checked_cost(&planner, raw, &rules, query, answer);
        assert_eq!(cost, expected, "{planner:?} {query:?}\n{}", raw.drawing());
    }
}

#[test]
fn from_a_cell_to_itself() {
    for raw in [raw(&["."]), raw(&["...", "...", "..."]), raw(&["###", "#.#", "###"])] {
        let centre = (raw.width / 2, raw.height / 2);
        let map = raw.search_map(&Rules::default());
        for planner in all() {
            let answer = ask(&planner, &map, &query(centre, centre), &mut Workspace::default());
            let plan = answer.unwrap().unwrap();
            assert_eq!(plan.cells, [Cell::new(centre.0, centre.1)], "{planner:?}");
            // Not -0.
            assert_eq!(plan.cost.cells().to_bits(), 0, "{planner:?}");
        }
    }
}

/// Both positions in one cell: a straight line, for every planner and smoother.
#[test]
fn from_a_position_to_another_in_the_same_cell() {
    let raw = raw(&["...", "...", "..."]);
    let map = raw.search_map(&Rules::default());
    for planner in all() {
        let answer = ask(&planner, &map, &query((1, 1), (1, 1)), &mut Workspace::default());
        let plan = answer.unwrap().unwrap();
        let (start, goal) = (Point::new(1.05, 1.05), Point::new(1.2, 1.9));
        assert_eq!(plan.line(&map, start, goal).polyline().points(), [start, goal], "{planner:?}");
        assert_eq!(plan.line(&map, start, start).polyline().points(), [start], "{planner:?}");
        // A route may begin in a cell beside that of the position; the cell's centre is on the
        // path.
        let (beside, centre) = (Point::new(0.9, 1.2), Point::new(1.5, 1.5));
        assert_eq!(
            plan.line(&map, beside, goal).polyline().points(),
            [beside, centre, goal],
            "{planner:?}"
        );
        for smoother in
            SmootherConfig::NAMES.iter().filter_map(|name| SmootherConfig::by_name(name))
        {
            let length_m = |goal| {
                let line = plan.line(&map, start, goal);
                smoother.build().unwrap().smooth(&line, &map.clearance(), 0.0).path.length_m()
            };
            assert_eq!(length_m(goal), start.distance(goal), "{smoother:?}");
            assert_eq!(length_m(start).to_bits(), 0, "{smoother:?}");
        }
    }
}

#[test]
fn an_enclosed_end() {
    let raw = raw(&["......", ".###..", ".#.#..", ".###..", "......"]);
    for ends in [query((2, 2), (5, 4)), query((5, 4), (2, 2))] {
        expect(&raw, &ends, None);
        let map = raw.search_map(&Rules::default());
        for planner in all() {
            let error = ask(&planner, &map, &ends, &mut Workspace::default()).unwrap().unwrap_err();
            assert!(matches!(error, PlanError::NoPath { .. }), "{planner:?}: {error}");
        }
    }
    // A diagonal gap is closed without cutting and open with it.
    let gap = self::raw(&["..#", ".#.", "#.."]);
    expect(&gap, &query((0, 2), (2, 0)), None);
    let rules = Rules { corners: CornerRule::Allow, ..Rules::default() };
    let map = gap.search_map(&rules);
    for planner in optimal(CornerRule::Allow) {
        let ends = query((0, 1), (1, 0));
        let cost = ask(&planner, &map, &ends, &mut Workspace::default()).unwrap().unwrap().cost;
        assert_eq!(cost.steps(), Some(Cost::new(0, 1)), "{planner:?}");
    }
}

#[test]
fn corridors_of_one_cell() {
    expect(&raw(&["......."]), &query((6, 0), (0, 0)), Some(Cost::new(6, 0)));
    expect(&raw(&[".", ".", ".", "."]), &query((0, 0), (0, 3)), Some(Cost::new(3, 0)));
    let bends = raw(&["....#", "###.#", "#....", "#.###", "#...."]);
    expect(&bends, &query((0, 4), (4, 0)), Some(Cost::new(12, 0)));
    let wide = Raw::from_fn(200, 1, |_, _| true);
    expect(&wide, &query((0, 0), (199, 0)), Some(Cost::new(199, 0)));
}

#[test]
fn without_obstacles_the_cost_is_the_octile_distance() {
    for (width, height) in [(1, 1), (2, 2), (62, 3), (63, 2), (64, 5), (65, 65), (130, 7)] {
        let raw = Raw::from_fn(width, height, |_, _| true);
        let corners = [(0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)];
        let middle = (width / 2, height / 3);
        for start in corners {
            for goal in corners.into_iter().chain([middle]) {
                let (dx, dy) = (start.0.abs_diff(goal.0), start.1.abs_diff(goal.1));
                expect(&raw, &query(start, goal), Some(Cost::octile(dx, dy)));
            }
        }
    }
}

#[test]
fn along_the_border_of_the_map() {
    // The path leads once around; no corner of it can be cut.
    let ring = Raw::from_fn(70, 66, |x, y| x == 0 || y == 0 || x == 69 || y == 65);
    expect(&ring, &query((0, 0), (69, 65)), Some(Cost::new(69 + 65, 0)));
    expect(&ring, &query((0, 1), (0, 65)), Some(Cost::new(64, 0)));
    expect(&ring, &query((69, 40), (0, 40)), Some(Cost::new(69 + 2 * 25, 0)));
}

#[test]
fn blocked_everywhere_and_outside() {
    let raw = raw(&["##", "##"]);
    let map = raw.search_map(&Rules::default());
    for planner in all() {
        let answer = |ends| ask(&planner, &map, &ends, &mut Workspace::default()).unwrap();
        let blocked = answer(query((0, 1), (1, 1))).unwrap_err();
        let expected = PlanError::Blocked {
            end: PathEnd::Start,
            cell: Cell::new(0, 1),
            by: BlockedBy::Obstacle,
            nearest: None,
        };
        assert_eq!(blocked, expected, "{planner:?}");
        let outside = answer(query((0, 2), (1, 1))).unwrap_err();
        assert!(matches!(outside, PlanError::OutsideMap { end: PathEnd::Start, .. }));
    }
}

/// A budget that is just enough changes nothing; one less ends the search, and is reported.
#[test]
fn budgets() {
    let raw = Raw::from_fn(30, 20, |x, y| x != 15 || y == 0);
    let map = raw.search_map(&Rules::default());
    let asked = query((2, 15), (27, 12));
    for planner in all().into_iter().map(without_distance) {
        let mut workspace = Workspace::default();
        let plan = ask(&planner, &map, &asked, &mut workspace).unwrap().unwrap();
        let enough = Query { budget: Some(plan.statistics.expanded()), ..asked };
        let again = ask(&planner, &map, &enough, &mut workspace).unwrap();
        assert_eq!(again, Ok(plan.clone()), "{planner:?}");
        let budget = plan.statistics.expanded() - 1;
        let short = Query { budget: Some(budget), ..asked };
        let error = ask(&planner, &map, &short, &mut workspace).unwrap().unwrap_err();
        match error {
            PlanError::BudgetExhausted { budget: named, statistics } => {
                assert_eq!((named, statistics.expanded()), (budget, budget), "{planner:?}");
            }
            other => panic!("{planner:?}: {other}"),
        }
    }
}
