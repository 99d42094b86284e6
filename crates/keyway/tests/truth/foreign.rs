//! Every optimal planner against the crate `pathfinding`, on larger maps of several kinds.

use crate::planners::{ask, checked_cost, optimal};
use crate::support::{Raw, Rules, query_on};
use keyway::map::Cell;
use keyway::search::{CornerRule, Cost, Query, Workspace};
use proptest::prelude::*;

/// Fixed point for the foreign search, with enough digits to distinguish all paths of these maps.
const STRAIGHT: u64 = 1_000_000_000_000_000;
const DIAGONAL: u64 = 1_414_213_562_373_095;

/// The cost of the path that the foreign crate finds, by counting its steps.
fn foreign_cost(raw: &Raw, rules: &Rules, query: &Query, by_astar: bool) -> Option<Cost> {
    let is_free = |cell: Cell| raw.is_free(cell.x, cell.y, rules.unknown);
    if !is_free(query.start) || !is_free(query.goal) {
        return None;
    }
    let successors = |from: &Cell| {
        let cost = |cost: Cost| cost.straight * STRAIGHT + cost.diagonal * DIAGONAL;
        raw.steps(*from, rules).into_iter().map(move |(to, step)| (to, cost(step)))
    };
    let columns_or_rows = |at: &Cell| {
        u64::from(at.x.abs_diff(query.goal.x).max(at.y.abs_diff(query.goal.y))) * STRAIGHT
    };
    let is_goal = |at: &Cell| *at == query.goal;
    let found = if by_astar {
        pathfinding::prelude::astar(&query.start, successors, columns_or_rows, is_goal)
    } else {
        pathfinding::prelude::dijkstra(&query.start, successors, is_goal)
    };
    found.map(|(path, _)| raw.walk(&path, query, rules).unwrap())
}

/// Kinds of maps.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Single blocked cells.
    Noise,
    /// Solid rectangles.
    Blocks,
    /// Walls with doors.
    Rooms,
    /// Diagonal walls, one cell thick.
    Diagonals,
    /// Corridors, one cell wide, with some walls removed.
    Maze,
}

/// A map of a kind, from a seed; `percent` is the blocked share.
fn map_of(shape: Shape, width: i32, height: i32, percent: u32, seed: u64) -> Raw {
    let chance = |x: i32, y: i32, salt: u64| hash(seed, x, y, salt) % 100;
    let percent = u64::from(percent);
    let is_free = |x: i32, y: i32| match shape {
        Shape::Noise => chance(x, y, 0) >= percent,
        Shape::Blocks => (1..6).all(|size| chance(x / size, y / size, size as u64) * 4 >= percent),
        Shape::Rooms => {
            let is_wall = x % 9 == 8 || y % 7 == 6;
            let is_door = chance(x / 9, y / 7, 1) % 8 == (x % 9 + y % 7) as u64 % 8;
            !is_wall || is_door
        }
        Shape::Diagonals => {
            let is_wall = (x + y) % 6 == 5 && chance((x + y) / 6, x / 5, 2) < 3 * percent;
            let crosses = (x - y).rem_euclid(11) == 0 && chance((x - y) / 11, y / 4, 3) < percent;
            !is_wall && !crosses
        }
        Shape::Maze => {
            let is_room = x % 2 == 0 && y % 2 == 0;
            let is_passage = (x + y) % 2 == 1 && chance(x, y, 4) >= percent;
            is_room || is_passage
        }
    };
    Raw::from_fn(width, height, is_free)
}

/// The mixing function of `SplitMix64`, over seed and position.
fn hash(seed: u64, x: i32, y: i32, salt: u64) -> u64 {
    let mut z = seed
        .wrapping_add((x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
        .wrapping_add((y as u64).wrapping_mul(0xd1b5_4a32_d192_ed03))
        .wrapping_add(salt << 32);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

fn any_shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        Just(Shape::Noise),
        Just(Shape::Blocks),
        Just(Shape::Rooms),
        Just(Shape::Diagonals),
        Just(Shape::Maze)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn all_agree(shape in any_shape(), width in 1i32..150, height in 1i32..90, percent in 0u32..45,
                 seed: u64, cuts: bool, ends in prop::array::uniform3(any::<(u32, u32, u32, u32)>())) {
        let corners = if cuts { CornerRule::Allow } else { CornerRule::Forbid };
        let rules = Rules { corners, ..Rules::default() };
        let raw = map_of(shape, width, height, percent, seed);
        let (map, mut workspace) = (raw.search_map(&rules), Workspace::default());
        for (i, ends) in ends.into_iter().enumerate() {
            let query = query_on(&raw, ends);
            let expected = foreign_cost(&raw, &rules, &query, i % 2 == 0);
            for planner in optimal(corners) {
                let Some(answer) = ask(&planner, &map, &query, &mut workspace) else { continue };
                let cost = checked_cost(&planner, &raw, &rules, &query, answer);
                prop_assert_eq!(cost, expected, "{:?} {:?}\n{}", planner, query, raw.drawing());
            }
        }
    }
}

/// The kinds of maps match their names: neither all free nor all blocked, and mostly passable.
#[test]
fn shapes_have_ways_and_walls() {
    for shape in [Shape::Noise, Shape::Blocks, Shape::Rooms, Shape::Diagonals, Shape::Maze] {
        let (mut blocked, mut solved) = (0, 0);
        for seed in 0..20 {
            let raw = map_of(shape, 40, 30, 20, seed);
            blocked += raw.states.iter().filter(|s| **s != keyway::map::CellState::Free).count();
            let query = Query::new(Cell::new(0, 0), Cell::new(36, 28));
            solved += i32::from(foreign_cost(&raw, &Rules::default(), &query, true).is_some());
        }
        assert!((1000..16_000).contains(&blocked), "{shape:?}: {blocked} of 24000 are blocked");
        assert!(solved >= 5, "{shape:?}: {solved} of 20 have a path");
    }
}
