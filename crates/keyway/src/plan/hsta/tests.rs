//! The whole search on drawn maps, and the messages about start, goal and parameters.

use super::*;
use crate::plan::PathEnd;
use crate::plan::two_sided::drawn;
use crate::search::Cost;

fn hsta(config: HstaConfig) -> Hsta {
    Hsta::new(config).unwrap()
}

/// Constrained to a corridor: (3, 2) is beside the obstacle. l + m = 13, so k = 1 + d^2 / 52.
/// Forward:
/// - S = (0, 2), other side at (6, 2): (1, 2) has f = 1 + 1.019 * 5 + 5 = 11.10, the best.
/// - (1, 2), other still (6, 2): (2, 2) has 2 + 1.077 * 4 + 4 = 10.31,
///   and (2, 1) has 2.41 + 1.173 * 4.12 + 4.12 = 11.37.
/// - (2, 2), other now (5, 2): (3, 1) has 3.41 + 1.308 * 2.24 + 3.16 = 9.50.
///
/// The backward side mirrors it: (5, 2), (4, 2). From there, with the other side at (2, 2), it
/// reaches (3, 1) with 3.41 + 1.308 * 1.41 + 3.16 = 8.43. The best node of both sides is (3, 1);
/// the backward side is the second to take it.
#[test]
fn an_expansion_sequence_by_hand() {
    let rows = [".......", ".......", "...#...", "S.....G", ".......", "......."];
    let (plan, [forward, backward]) = drawn::plan(&Hsta::default(), &rows).unwrap();
    assert_eq!(forward, [(0, 2), (1, 2), (2, 2), (3, 1)]);
    assert_eq!(backward, [(6, 2), (5, 2), (4, 2), (3, 1)]);
    assert_eq!((plan.meeting, plan.stop), (Some(Cell::new(3, 1)), Some(Stop::SidesMet)));
    // Two diagonal steps around the middle of the corridor; the straight path would cost 6.
    assert!((plan.cost.cells() - 6.828).abs() < 1e-3);
    let map = drawn::map(&[".......", ".......", "...#...", ".......", ".......", "......."]);
    assert_eq!(Hsta::default().distance_kept(&map, &plan.cells), Some(2.0));
}

/// A path exists at a sufficient distance from the obstacle.
const AROUND: [&str; 5] = [".......", "...#...", "S.....G", ".......", "......."];

#[test]
fn the_constraint_is_to_blame() {
    let rows = ["...#...", "...#...", "S.....G", "...#...", "...#..."];
    let published = hsta(HstaConfig::PAPER);
    let error = drawn::plan(&published, &rows).unwrap_err();
    let miss = Miss::Constraint { constraint: 2.0 };
    assert!(matches!(error, PlanError::Missed { planner: "hsta", miss: m, .. } if m == miss));
    assert!(error.to_string().contains("constraint of 2 "), "{error}");
    // One cell is the largest constraint that the gap allows.
    let advice = error.advice().unwrap();
    assert_eq!((advice.planner, advice.parameter), ("hsta", "if_no_path"));
    assert_eq!(advice.value, "relax");
    let relaxing = Hsta::default();
    let (plan, _) = drawn::plan(&relaxing, &rows).unwrap();
    assert_eq!(plan.note, Some(PlanNote::Relaxed(Relaxed { asked_m: 2.0, used_m: 1.0 })));
    let open: Vec<String> = rows.iter().map(|row| row.replace(['S', 'G'], ".")).collect();
    let map = drawn::map(&open.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(relaxing.distance_kept(&map, &plan.cells), Some(1.0));
    // If a path keeps the constraint, nothing is relaxed.
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
    assert!(text.starts_with("start (1, 1) is 1 from the nearest obstacle"), "{text}");
    // A disc of one cell around start and goal reaches (1, 2), which is 2 from the obstacle.
    let freed = hsta(HstaConfig { free_ends_m: 1.0, ..HstaConfig::PAPER });
    let (plan, _) = drawn::plan(&freed, &["......", "......", ".S#..G", "......"]).unwrap();
    assert!(plan.cells[1] == Cell::new(1, 2) || plan.cells[1] == Cell::new(0, 1), "{plan:?}");
    // Relaxed, the start bounds the constraint.
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
    // The forward side takes the middle, then the backward side does.
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

/// The definitions of the paper, transcribed without optimisations: every turn computes f of all
/// open nodes with k and h of the current nodes, and takes the smallest (among equal ones that
/// with the larger g, then the lower index).
struct ByDefinition<'m> {
    map: &'m SearchMap,
    roots: [Cell; 2],
    open: [Vec<(Cell, u64)>; 2],
    closed: [Vec<Cell>; 2],
    current: [Cell; 2],
}

impl ByDefinition<'_> {
    /// The length in units of 2^-26.5 cells, as for step costs.
    fn length(a: Cell, b: Cell) -> u64 {
        let (dx, dy) = (f64::from(a.x - b.x), f64::from(a.y - b.y));
        (dx.hypot(dy) * Cost::KEY_STRAIGHT as f64).round() as u64
    }

    fn f(&self, side: usize, (at, g): (Cell, u64)) -> f64 {
        let l1 = |a: Cell, b: Cell| f64::from((a.x - b.x).abs() + (a.y - b.y).abs());
        let sides = f64::from(self.map.frame().width() + self.map.frame().height());
        let k = 1.0 + l1(self.current[side], self.roots[side]).powi(2) / (4.0 * sides);
        let h = Self::length(at, self.current[1 - side]) as f64;
        g as f64 + k * h + Self::length(at, self.roots[1 - side]) as f64
    }

    /// The cells that both sides expand until one takes a node that the other has expanded; `None`
    /// if two open nodes are so nearly equal that rounding decides.
    fn run(mut self) -> Option<[Vec<Cell>; 2]> {
        for side in [0, 1].into_iter().cycle() {
            let order = |&(at, g): &(Cell, u64)| (self.f(side, (at, g)), u64::MAX - g, at.y, at.x);
            let mut keys: Vec<_> = self.open[side].iter().map(order).collect();
            keys.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let first = *keys.first()?;
            let near = |f: f64| f - first.0 < 1e3;
            if keys[1..].iter().any(|key| near(key.0) && key.1 != first.1) {
                return None;
            }
            let equal = keys.iter().filter(|key| near(key.0));
            let (y, x) = equal.map(|&(_, _, y, x)| (y, x)).min()?;
            let at = Cell::new(x, y);
            let place = self.open[side].iter().position(|node| node.0 == at)?;
            let (_, g) = self.open[side].swap_remove(place);
            self.current[side] = at;
            let is_met = self.closed[1 - side].contains(&at);
            self.closed[side].push(at);
            if is_met {
                return Some(self.closed);
            }
            self.expand(side, at, g);
        }
        None
    }

    fn expand(&mut self, side: usize, at: Cell, g: u64) {
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let to = Cell::new(at.x + dx, at.y + dy);
            let is_free = |x, y| self.map.is_free(Cell::new(x, y));
            let is_legal = is_free(to.x, to.y) && is_free(at.x, to.y) && is_free(to.x, at.y);
            if (dx, dy) == (0, 0) || !is_legal || self.closed[side].contains(&to) {
                continue;
            }
            let g = g + Cost::octile(dx.unsigned_abs(), dy.unsigned_abs()).key();
            match self.open[side].iter_mut().find(|node| node.0 == to) {
                Some(known) => known.1 = known.1.min(g),
                None => self.open[side].push((to, g)),
            }
        }
    }
}

#[test]
fn renewed_keys_with_the_current_weight_are_the_definitions() {
    let config = HstaConfig {
        weight_at: WeightAt::Current,
        keys: OpenKeys::Renewed,
        l1_constraint: 0.0,
        ..HstaConfig::PAPER
    };
    let mut random = 1_u64;
    let mut next = |n: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 33) % n
    };
    let mut compared = 0;
    for _ in 0..400 {
        let mut rows: Vec<Vec<u8>> = (0..9)
            .map(|_| (0..11).map(|_| if next(4) == 0 { b'#' } else { b'.' }).collect())
            .collect();
        let ends = [(next(4) as usize, 8), (10 - next(4) as usize, 0)];
        (rows[ends[0].1][ends[0].0], rows[ends[1].1][ends[1].0]) = (b'S', b'G');
        let rows: Vec<String> =
            rows.into_iter().map(|row| String::from_utf8(row).unwrap()).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let Ok((_, sides)) = drawn::plan(&hsta(config.clone()), &rows) else { continue };
        let free: Vec<String> = rows.iter().map(|row| row.replace(['S', 'G'], ".")).collect();
        let map = drawn::map(&free.iter().map(String::as_str).collect::<Vec<_>>());
        let roots = ends.map(|(x, row)| Cell::new(x as i32, 8 - row as i32));
        let open = roots.map(|root| vec![(root, 0)]);
        let (closed, current) = ([vec![], vec![]], roots);
        let Some(expected) = (ByDefinition { map: &map, roots, open, closed, current }).run()
        else {
            continue;
        };
        let expected =
            expected.map(|cells| cells.iter().map(|at| (at.x, at.y)).collect::<Vec<_>>());
        assert_eq!(sides, expected, "{rows:#?}");
        compared += usize::from(expected.iter().all(|cells| cells.len() > 4));
    }
    assert!(compared > 50, "{compared}");
}
