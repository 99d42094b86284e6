//! The whole search on drawn maps, and what is reported about ends and parameters.

use super::*;
use crate::plan::PathEnd;
use crate::plan::two_sided::drawn;

fn hsta(config: HstaConfig) -> Hsta {
    Hsta::new(config).unwrap()
}

/// Constrained to a corridor: (3, 2) is beside the obstacle. l + m = 13, so k = 1 + d^2 / 52.
/// Forward:
/// - S = (0, 2), other side at (6, 2): (1, 2) has f = 1 + 1.019 * 5 + 5 = 11.10, the best.
/// - (1, 2), other still (6, 2): (2, 2) has 2 + 1.077 * 4 + 4 = 10.31, (2, 1) 2.41 + 1.173 * 4.12 +
///   4.12 = 11.37.
/// - (2, 2), other now (5, 2): (3, 1) has 3.41 + 1.308 * 2.24 + 3.16 = 9.50.
///
/// The backward side mirrors it: (5, 2), (4, 2); from there with the other at (2, 2) it reaches
/// (3, 1) with 3.41 + 1.308 * 1.41 + 3.16 = 8.43. Both best nodes are (3, 1), which the backward side
/// then takes second.
#[test]
fn an_expansion_sequence_by_hand() {
    let rows = [".......", ".......", "...#...", "S.....G", ".......", "......."];
    let (plan, [forward, backward]) = drawn::plan(&Hsta::default(), &rows).unwrap();
    assert_eq!(forward, [(0, 2), (1, 2), (2, 2), (3, 1)]);
    assert_eq!(backward, [(6, 2), (5, 2), (4, 2), (3, 1)]);
    assert_eq!((plan.meeting, plan.stop), (Some(Cell::new(3, 1)), Some(Stop::SidesMet)));
    // Two diagonal steps around the corridor's middle; straight on would be 6.
    assert!((plan.cost.cells() - 6.828).abs() < 1e-3);
    let map = drawn::map(&[".......", ".......", "...#...", ".......", ".......", "......."]);
    assert_eq!(Hsta::default().distance_kept(&map, &plan.cells), Some(2.0));
}

/// Far enough from the obstacle there is a way.
const AROUND: [&str; 5] = [".......", "...#...", "S.....G", ".......", "......."];

#[test]
fn the_constraint_is_to_blame() {
    let rows = ["...#...", "...#...", "S.....G", "...#...", "...#..."];
    let published = hsta(HstaConfig::PAPER);
    let error = drawn::plan(&published, &rows).unwrap_err();
    let miss = Miss::Constraint { constraint: 2.0 };
    assert!(matches!(error, PlanError::Missed { planner: "hsta", miss: m, .. } if m == miss));
    assert!(error.to_string().contains("constraint of 2 "), "{error}");
    // One cell is the largest that the gap leaves.
    let advice = error.advice().unwrap();
    assert_eq!((advice.planner, advice.parameter), ("hsta", "if_no_path"));
    assert_eq!(advice.value, "relax");
    let relaxing = Hsta::default();
    let (plan, _) = drawn::plan(&relaxing, &rows).unwrap();
    assert_eq!(plan.note, Some(PlanNote::Relaxed(Relaxed { asked_m: 2.0, used_m: 1.0 })));
    let open: Vec<String> = rows.iter().map(|row| row.replace(['S', 'G'], ".")).collect();
    let map = drawn::map(&open.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(relaxing.distance_kept(&map, &plan.cells), Some(1.0));
    // Where the way is free anyway, nothing is relaxed.
    let around = drawn::plan(&relaxing, &AROUND).map(|(plan, _)| plan);
    assert_eq!(around.as_ref().unwrap().note, None);
    assert_eq!(around, drawn::plan(&published, &AROUND).map(|(plan, _)| plan));
}

#[test]
fn ends_beside_obstacles() {
    let rows = ["......", ".S#..G", "......"];
    let error = drawn::plan(&hsta(HstaConfig::PAPER), &rows).unwrap_err();
    let cell = Cell::new(1, 1);
    let expected = PlanError::Constrained {
        planner: "hsta",
        end: PathEnd::Start,
        cell,
        distance: 1.0,
        constraint: 2.0,
    };
    assert_eq!(error, expected);
    let text = error.to_string();
    assert!(text.starts_with("start (1, 1) is 1 from an obstacle"), "{text}");
    // A disc of one cell around each end reaches (1, 2), which is 2 from the obstacle.
    let freed = hsta(HstaConfig { free_ends_m: 1.0, ..HstaConfig::PAPER });
    let (plan, _) = drawn::plan(&freed, &["......", "......", ".S#..G", "......"]).unwrap();
    assert!(plan.cells[1] == Cell::new(1, 2) || plan.cells[1] == Cell::new(0, 1), "{plan:?}");
    // Relaxed, an end bounds the constraint.
    let advice = error.advice().unwrap();
    assert_eq!((advice.planner, advice.parameter), ("hsta", "if_no_path"));
    assert_eq!(advice.value, "relax");
    let (plan, _) = drawn::plan(&Hsta::default(), &rows).unwrap();
    assert_eq!(plan.note, Some(PlanNote::Relaxed(Relaxed { asked_m: 2.0, used_m: 1.0 })));
}

#[test]
fn without_weight_and_correction_it_is_plain() {
    let plain = HstaConfig {
        weight: Weight::One,
        correction: Correction::None,
        l1_constraint: 0.0,
        ..HstaConfig::PAPER
    };
    let (plan, [forward, backward]) = drawn::plan(&hsta(plain), &["S...G"]).unwrap();
    // Forward takes the middle, then the backward side takes it as well.
    assert_eq!((forward, backward), (vec![(0, 0), (1, 0), (2, 0)], vec![(4, 0), (3, 0), (2, 0)]));
    assert_eq!(plan.meeting, Some(Cell::new(2, 0)));
}

#[test]
fn parameters_are_checked() {
    let field = |config| Hsta::new(config).unwrap_err().path;
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(field(HstaConfig { l1_constraint: bad, ..HstaConfig::PAPER }), "l1_constraint");
        assert_eq!(field(HstaConfig { free_ends_m: bad, ..HstaConfig::PAPER }), "free_ends_m");
        let reference_cell_m = bad;
        assert_eq!(field(HstaConfig { reference_cell_m, ..HstaConfig::PAPER }), "reference_cell_m");
    }
    let none = HstaConfig { reference_cell_m: 0.0, ..HstaConfig::PAPER };
    assert_eq!(field(none), "reference_cell_m");
    let default = HstaConfig { if_no_path: IfNoPath::Relax, ..HstaConfig::PAPER };
    assert_eq!(HstaConfig::default(), default, "all but this is as published");
}

/// Longer than any map: every cell within it counts, and nothing overflows.
#[test]
fn a_huge_constraint() {
    let huge = HstaConfig { l1_constraint: 1e300, ..HstaConfig::PAPER };
    assert!(drawn::plan(&hsta(huge.clone()), &["S..G"]).is_ok());
    let error = drawn::plan(&hsta(huge.clone()), &["S..G#"]).unwrap_err();
    assert!(matches!(error, PlanError::Constrained { end: PathEnd::Start, .. }), "{error}");
    let relaxing = HstaConfig { if_no_path: IfNoPath::Relax, ..huge };
    assert!(drawn::plan(&hsta(relaxing), &["S..G#"]).is_ok());
}
