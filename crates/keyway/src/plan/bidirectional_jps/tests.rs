//! Equations and searches computed by hand.

use super::search::{TowardsTarget, weighted};
use super::*;
use crate::map::{Cell, LayerConfig, OccupancyGrid};
use crate::plan::Miss;
use crate::search::{Cost, DistanceTo, Mean, Rule, Side};

const FORWARD: Side = Side::Forward;
const BACKWARD: Side = Side::Backward;

/// An event reported to an observer: a side expands a node, a node is generated from it, or the
/// sides meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    Expanded(Side, i32, i32),
    Generated(i32, i32),
    Met(i32, i32),
}
use Event::{Expanded, Generated, Met};

#[derive(Default)]
struct Log(Vec<Event>);

impl Observer for Log {
    fn expanded(&mut self, side: Side, at: Cell, _: f64) {
        self.0.push(Expanded(side, at.x, at.y));
    }

    fn generated(&mut self, _: Side, at: Cell, parent: Cell, _: f64) {
        let last = self.0.iter().rev().find(|event| matches!(event, Expanded(..)));
        assert!(matches!(last, Some(&Expanded(_, x, y)) if Cell::new(x, y) == parent));
        self.0.push(Generated(at.x, at.y));
    }

    fn met(&mut self, at: Cell) {
        self.0.push(Met(at.x, at.y));
    }
}

fn map(rows: &[&str]) -> SearchMap {
    SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap()
}

fn plan(
    planner: &impl GlobalPlanner,
    rows: &[&str],
    start: (i32, i32),
    goal: (i32, i32),
) -> (Result<Plan, PlanError>, Vec<Event>) {
    let query = Query::new(Cell::new(start.0, start.1), Cell::new(goal.0, goal.1));
    let (mut log, mut plan) = (Log::default(), Plan::default());
    let result =
        planner.plan_into(&map(rows), &query, &mut Workspace::default(), Some(&mut log), &mut plan);
    (result.map(|()| plan), log.0)
}

fn literal() -> BidirectionalJps {
    let meeting = JumpMeeting::Literal;
    BidirectionalJps::new(BidirectionalJpsConfig { meeting, ..BidirectionalJpsConfig::PAPER })
        .unwrap()
}

/// A wall in the middle.
const WALL: [&str; 5] = [
    ".......", //
    "...#...", //
    "...#...", //
    "...#...", //
    ".......",
];

#[test]
fn equations_2_and_3_by_hand() {
    let map = map(&["......"; 6]);
    let target = Cell::new(4, 5);
    let rest = weighted(1.0, Cost::new(2, 0).key());
    let rule = TowardsTarget { to_target: DistanceTo::new(&map, Mean, target), a: 3.0, rest };
    // 3 columns and 4 rows to the target: O = 5, M = 7, so H = (5 + 7) / 2 = 6.
    // G1 = 10 and G2 = 2: F1 = 10 + 3.0 * 6 + 1.0 * 2 = 30.
    let at = map.index(Cell::new(1, 1));
    assert_eq!(rule.key(at, Cost::new(10, 0).key()), Cost::new(30, 0).key());
    // a = 0.5 and b = 0.25: F1 = 10 + 3 + 0.5 = 13.5.
    let rule = TowardsTarget { a: 0.5, rest: weighted(0.25, Cost::new(2, 0).key()), ..rule };
    assert_eq!(2 * rule.key(at, Cost::new(10, 0).key()), Cost::new(27, 0).key());
}

#[test]
fn around_a_wall_step_by_step() {
    // The start sees both ends of the wall from the diagonals' cells (2, 4) and (2, 0): the scan
    // eastwards from there finds the cell behind the wall's corner. The goal likewise: the scan
    // westwards from (4, 4) ends at the node (2, 4), which the start has. With the goal as target,
    // both nodes of the start have F = 2.83 + 3 (4.47 + 6) / 2 + 0; the lower cell index goes
    // first. Its scan to the east reaches (4, 0), which the goal has.
    let expected = [
        Expanded(FORWARD, 0, 2),
        Generated(2, 4),
        Generated(2, 0),
        Expanded(BACKWARD, 6, 2),
        Generated(4, 4),
        Generated(4, 0),
        Expanded(FORWARD, 2, 0),
        Generated(4, 0),
        Met(4, 0),
    ];
    for literal in [false, true] {
        let planner = if literal { self::literal() } else { BidirectionalJps::default() };
        let (result, events) = plan(&planner, &WALL, (0, 2), (6, 2));
        assert_eq!(events, expected);
        let result = result.unwrap();
        let cells = [(0, 2), (1, 1), (2, 0), (3, 0), (4, 0), (5, 1), (6, 2)];
        assert_eq!(result.cells, cells.map(|(x, y)| Cell::new(x, y)));
        assert_eq!(result.cost.steps(), Some(Cost::new(2, 4)));
        assert_eq!(result.meeting, Some(Cell::new(4, 0)));
    }
    let (result, events) = plan(&BidirectionalJpsFixed::default(), &WALL, (0, 2), (6, 2));
    assert_eq!(events, expected);
    assert_eq!(result.unwrap().cost.steps(), Some(Cost::new(2, 4)));
}

#[test]
fn the_literal_rule_passes_by() {
    let rows = [
        "...", //
        "...", //
        "..#", //
        "...",
    ];
    let (start, goal) = ((0, 0), (1, 3));
    // The forward side turns at (1, 1), from which (1, 2) is seen, behind the obstacle's corner.
    // The backward side aims at (0, 0): it sees it from (0, 2), and scans southwards over (1, 1),
    // which is not its target, to (1, 0). Then its target is (1, 1), which it has passed: (1, 0)
    // with F = 3 + 3 * 1 and (0, 2) with F = 1.41 + 3 * 2 no longer lead anywhere.
    let (result, events) = plan(&literal(), &rows, start, goal);
    let expected = [
        Expanded(FORWARD, 0, 0),
        Generated(1, 1),
        Expanded(BACKWARD, 1, 3),
        Generated(0, 2),
        Generated(1, 0),
        Expanded(FORWARD, 1, 1),
        Generated(1, 2),
        Expanded(BACKWARD, 1, 0),
        Expanded(BACKWARD, 0, 2),
    ];
    assert_eq!(events, expected);
    match result {
        Err(PlanError::Missed { planner, miss: Miss::SidesPassed, statistics }) => {
            assert_eq!((planner, statistics.expanded()), (BidirectionalJps::NAME, 5));
        }
        other => panic!("{other:?}"),
    }
    // Any node of the other side stops a scan: the goal's side reaches (1, 1).
    let (result, events) = plan(&BidirectionalJps::default(), &rows, start, goal);
    assert_eq!(
        events[2..],
        [Expanded(BACKWARD, 1, 3), Generated(0, 2), Generated(1, 1), Met(1, 1)]
    );
    assert_eq!(result.unwrap().cost.steps(), Some(Cost::new(2, 1)));
}

#[test]
fn moving_targets_draw_the_sides_together() {
    let rows = [
        ".#..", //
        "...#", //
        "..#.", //
        "#...", //
        "....",
    ];
    let (start, goal) = ((3, 4), (0, 0));
    // Forward: around (2, 4) down to (2, 3). Backward: around (1, 0) to (2, 1) with G2 = 2.41 and
    // to (1, 2) with G2 = 3, inserted while the target is (2, 4) with G1 = 1, or, if fixed,
    // (3, 4). The keys for each target:
    // - (2, 4): F2(2, 1) = 2.41 + 3 (3 + 3) / 2 + 1 = 12.41, F2(1, 2) = 3 + 3 (2.24 + 3) / 2 + 1 =
    //   11.85.
    // - (3, 4): F2(2, 1) = 2.41 + 3 (3.16 + 4) / 2 = 13.16, F2(1, 2) = 3 + 3 (2.83 + 4) / 2 =
    //   13.24.
    let both = [
        Expanded(FORWARD, 3, 4),
        Generated(2, 4),
        Expanded(BACKWARD, 0, 0),
        Generated(1, 0),
        Expanded(FORWARD, 2, 4),
        Generated(2, 3),
        Expanded(BACKWARD, 1, 0),
        Generated(2, 1),
        Generated(1, 2),
        Expanded(FORWARD, 2, 3),
        Generated(1, 3),
    ];
    let (moving, events) = plan(&BidirectionalJps::default(), &rows, start, goal);
    assert_eq!(events[..11], both);
    assert_eq!(events[11..], [Expanded(BACKWARD, 1, 2), Generated(1, 3), Met(1, 3)]);
    let (fixed, events) = plan(&BidirectionalJpsFixed::default(), &rows, start, goal);
    assert_eq!(events[..11], both);
    let rest = [
        Expanded(BACKWARD, 2, 1),
        Generated(3, 1),
        Expanded(FORWARD, 1, 3),
        Generated(0, 3),
        Generated(1, 2),
        Met(1, 2),
    ];
    assert_eq!(events[11..], rest);
    assert_eq!(moving.unwrap().cost, fixed.unwrap().cost);
}

#[test]
fn renewed_keys_follow_the_target() {
    // The two nodes of the backward side above, inserted with G2 = 2.41 and 3. With the target
    // (3, 4), (2, 1) is the better one, with the target (2, 4) the other is, whatever b.
    let map = map(&["...."; 5]);
    let (low, high) = (map.index(Cell::new(2, 1)), map.index(Cell::new(1, 2)));
    let rule = |x, y, rest| TowardsTarget {
        to_target: DistanceTo::new(&map, Mean, Cell::new(x, y)),
        a: 3.0,
        rest,
    };
    let mut frontier = crate::search::Frontier::default();
    let root = map.index(Cell::new(1, 0));
    for b_g2 in [0, Cost::new(9, 0).key()] {
        frontier.start(&map, root, 0);
        let from = frontier.take_best().unwrap();
        for (to, cost) in [(low, Cost::new(1, 1)), (high, Cost::new(2, 0))] {
            let step = crate::search::GridStep { to, cost: cost.key() };
            frontier.offer(from, step, &rule(3, 4, 0));
        }
        frontier.renew_keys(&rule(2, 4, b_g2));
        assert_eq!(frontier.take_best().unwrap().at, high);
        frontier.renew_keys(&rule(3, 4, b_g2));
        assert_eq!(frontier.take_best().unwrap().at, low);
        assert!(frontier.take_best().is_none());
    }
}

#[test]
fn weights_are_checked() {
    let weights = |a, b| BidirectionalJpsConfig { a, b, ..BidirectionalJpsConfig::PAPER };
    for (config, name) in [
        (weights(f64::NAN, 1.0), "a"),
        (weights(-0.5, 1.0), "a"),
        (weights(1.0, f64::INFINITY), "b"),
    ] {
        let error = BidirectionalJps::new(config).unwrap_err();
        assert_eq!(error.path, name);
    }
    assert!(BidirectionalJps::new(weights(0.0, 0.0)).is_ok());
    let config = BidirectionalJpsFixedConfig { a: -1.0, ..BidirectionalJpsFixedConfig::PAPER };
    assert!(BidirectionalJpsFixed::new(config).is_err());
}
