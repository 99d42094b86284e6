//! A map that is mirrored, turned or walked backwards has paths of the same cost.

use crate::planners::{ask, optimal};
use crate::support::{Raw, any_raw, any_rules, query_on};
use keyway::map::{Cell, UnknownPolicy};
use keyway::search::{Cost, Query, Workspace};
use proptest::prelude::*;

/// A map and a query, mirrored and turned: bit 0 of `symmetry` mirrors columns, bit 1 rows, bit 2
/// exchanges both.
fn transformed(raw: &Raw, query: &Query, symmetry: u32) -> (Raw, Query) {
    let (width, height) = (raw.width, raw.height);
    let image = |cell: Cell| {
        let x = if symmetry & 1 != 0 { width - 1 - cell.x } else { cell.x };
        let y = if symmetry & 2 != 0 { height - 1 - cell.y } else { cell.y };
        if symmetry & 4 != 0 { Cell::new(y, x) } else { Cell::new(x, y) }
    };
    let (width, height) = if symmetry & 4 != 0 { (height, width) } else { (width, height) };
    let mut other = Raw { width, height, states: raw.states.clone() };
    for cell in raw.cells() {
        let to = other.index(image(cell));
        other.states[to] = raw.states[raw.index(cell)];
    }
    (other, Query::new(image(query.start), image(query.goal)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn eight_symmetries(raw in any_raw(), rules in any_rules(), ends: (u32, u32, u32, u32)) {
        let query = query_on(&raw, ends);
        for planner in optimal(rules.corners) {
            let mut workspace = Workspace::default();
            let mut cost = |raw: &Raw, query: &Query| -> Option<Option<Cost>> {
                let answer = ask(&planner, &raw.search_map(&rules), query, &mut workspace)?;
                Some(answer.ok().and_then(|plan| plan.cost.steps()))
            };
            let expected = cost(&raw, &query);
            for symmetry in 1..8 {
                let (raw, query) = transformed(&raw, &query, symmetry);
                prop_assert_eq!(cost(&raw, &query), expected, "{:?} {}\n{}", planner, symmetry, raw.drawing());
            }
            if rules.unknown != UnknownPolicy::Penalised {
                let back = Query::new(query.goal, query.start);
                prop_assert_eq!(cost(&raw, &back), expected, "{:?} back\n{}", planner, raw.drawing());
            }
        }
    }
}

#[test]
fn a_transformed_map_by_hand() {
    let raw = Raw::from_fn(3, 2, |x, y| (x, y) != (2, 0));
    let query = Query::new(Cell::new(0, 0), Cell::new(2, 1));
    let (turned, to) = transformed(&raw, &query, 4 | 1);
    assert_eq!(turned.drawing(), "..\n..\n#.");
    assert_eq!((to.start, to.goal), (Cell::new(0, 2), Cell::new(1, 0)));
}
