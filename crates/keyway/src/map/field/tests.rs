use super::*;
use crate::geometry::{Point, Pose};
use crate::map::Cell;
use proptest::prelude::*;

pub(super) fn frame(width: u32, height: u32) -> GridFrame {
    GridFrame::new(u64::from(width), u64::from(height), 1.0, Pose::default()).unwrap()
}

pub(super) fn config(to: DistanceTo, reach_m: f64) -> FieldConfig {
    FieldConfig { to, reach_m, threads: NonZeroUsize::new(1) }
}

/// Squared distances in half cells, by comparing each cell with each obstacle.
fn brute_force(obstacles: &BitGrid, to: DistanceTo, limit_sq: u32) -> Vec<u32> {
    let frame = frame(obstacles.width(), obstacles.height());
    let along = |a: i32, b: i32| match to {
        DistanceTo::Squares => (2 * (a - b).abs() - 1).max(0).pow(2) as u32,
        DistanceTo::Centres => (2 * (a - b)).pow(2) as u32,
    };
    let ones: Vec<Cell> = frame.cells().filter(|&cell| obstacles.get(cell)).collect();
    let nearest = |cell: Cell| {
        ones.iter().map(|one| along(cell.x, one.x) + along(cell.y, one.y)).min().unwrap_or(u32::MAX)
    };
    frame.cells().map(|cell| nearest(cell).min(limit_sq)).collect()
}

fn values(field: &DistanceField) -> Vec<u32> {
    let rows = (0..field.frame().height() as i32).map(|y| field.row_squares(y).unwrap());
    rows.flatten().map(|&value| value as u32).collect()
}

/// Random grids of all shapes, from empty over scattered to full, some with blocks.
pub(super) fn grids() -> impl Strategy<Value = BitGrid> {
    let side = || prop_oneof![1u32..4, 4u32..40, 60u32..70, 100u32..140];
    let density = prop_oneof![Just(0.0), 0.0..0.01, 0.0..0.1, 0.0..1.0, Just(1.0)];
    (side(), side(), density, any::<u64>(), 0usize..3).prop_map(
        |(width, height, density, seed, blocks)| {
            let mut grid = BitGrid::new(width, height, false);
            let mut random = Random(seed | 1);
            for cell in frame(width, height).cells() {
                grid.set(cell, random.fraction() < density);
            }
            for _ in 0..blocks {
                let value = random.fraction() < 0.7;
                random.fill_block(&mut grid, value);
            }
            grid
        },
    )
}

pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn fraction(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: u32) -> i32 {
        (self.fraction() * f64::from(count)) as i32
    }

    pub(super) fn window(&mut self, grid: &BitGrid) -> CellWindow {
        let low = Cell::new(self.below(grid.width()), self.below(grid.height()));
        let (right, up) = (grid.width() - low.x as u32, grid.height() - low.y as u32);
        let high = Cell::new(low.x + self.below(right), low.y + self.below(up));
        CellWindow { low, high }
    }

    pub(super) fn fill_block(&mut self, grid: &mut BitGrid, value: bool) {
        let CellWindow { low, high } = self.window(grid);
        for (x, y) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y))) {
            grid.set(Cell::new(x, y), value);
        }
    }
}

#[test]
fn hand_worked_distances() {
    // Half cells to the square's edges: beside it 1, one further 3, diagonally 1 + 1, then 1 + 9.
    let mut obstacles = BitGrid::new(4, 3, false);
    obstacles.set(Cell::new(1, 0), true);
    let field = DistanceField::new(&frame(4, 3), &obstacles, &FieldConfig::default());
    assert_eq!(values(&field), [1, 0, 1, 9, 2, 1, 2, 10, 10, 9, 10, 18]);
    assert_eq!(field.distance_m(Cell::new(3, 0)), Some(1.5));
    assert_eq!(field.distance_m(Cell::new(4, 0)), None);
    let centres =
        DistanceField::new(&frame(4, 3), &obstacles, &config(DistanceTo::Centres, f64::INFINITY));
    assert_eq!(values(&centres), [4, 0, 4, 16, 8, 4, 8, 20, 20, 16, 20, 32]);
    // A reach of 1.2 cells: 3 half cells after rounding up, squared 9.
    let near = DistanceField::new(&frame(4, 3), &obstacles, &config(DistanceTo::Squares, 1.2));
    assert_eq!(values(&near), [1, 0, 1, 9, 2, 1, 2, 9, 9, 9, 9, 9]);
    assert_eq!((near.reach_m(), near.distance_m(Cell::new(3, 0))), (1.5, Some(f64::INFINITY)));
}

#[test]
fn nothing_and_everything() {
    let empty = BitGrid::new(70, 3, false);
    let field = DistanceField::new(&frame(70, 3), &empty, &FieldConfig::default());
    assert_eq!(field.distance_m(Cell::new(69, 2)), Some(f64::INFINITY));
    assert_eq!(field.upper_bound_m(Point::new(3.0, 2.0)), f64::INFINITY);
    assert!(field.lower_bound_m(Point::new(3.0, 2.0)) > 16_000.0);
    let mut full = BitGrid::new(70, 3, false);
    (0..3).for_each(|y| full.fill_span(y, 0, 69));
    let field = DistanceField::new(&frame(70, 3), &full, &FieldConfig::default());
    assert!(values(&field).iter().all(|&value| value == 0));
    assert_eq!(field.lower_bound_m(Point::new(f64::NAN, 0.0)), 0.0);
}

#[test]
fn distances_beyond_the_reach_are_not_told_apart() {
    for (width, height) in [(40_000, 1), (1, 40_000)] {
        let mut obstacles = BitGrid::new(width, height, false);
        obstacles.set(Cell::new(0, 0), true);
        let field = DistanceField::new(&frame(width, height), &obstacles, &FieldConfig::default());
        let at = |n: i32| {
            field.distance_m(if height == 1 { Cell::new(n, 0) } else { Cell::new(0, n) }).unwrap()
        };
        assert_eq!((at(1), at(16_000), at(16_382)), (0.5, 15_999.5, 16_381.5));
        assert_eq!((at(16_383), at(39_999)), (f64::INFINITY, f64::INFINITY));
        assert_eq!(field.reach_m(), DistanceField::MAX_REACH_CELLS);
    }
}

#[test]
fn several_bands_and_padded_rows_agree_with_brute_force() {
    for seed in 1..6 {
        let (mut random, mut obstacles) = (Random(seed), BitGrid::new(1500, 200, false));
        let frame = frame(1500, 200);
        let mut scatter = |obstacles: &mut BitGrid| {
            for _ in 0..12 {
                let cell = Cell::new(random.below(1500), random.below(200));
                obstacles.fill_span(cell.y, cell.x, cell.x + 3);
            }
        };
        scatter(&mut obstacles);
        let mut field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let limit_sq = field.limit_half_cells_sq();
        assert!(values(&field) == brute_force(&obstacles, DistanceTo::Squares, limit_sq));
        let ones: Vec<Cell> = frame.cells().filter(|&cell| obstacles.get(cell)).collect();
        for &cell in ones.iter().step_by(3) {
            obstacles.set(cell, false);
        }
        scatter(&mut obstacles);
        let all = CellWindow { low: Cell::new(0, 0), high: Cell::new(1499, 199) };
        field.update(&obstacles, all);
        assert!(values(&field) == brute_force(&obstacles, DistanceTo::Squares, limit_sq));
    }
}

proptest! {
    #[test]
    fn agrees_with_brute_force(obstacles in grids(), centres: bool,
                               reach_m in prop_oneof![Just(f64::INFINITY), 0.0..30.0f64]) {
        let to = if centres { DistanceTo::Centres } else { DistanceTo::Squares };
        let frame = frame(obstacles.width(), obstacles.height());
        let field = DistanceField::new(&frame, &obstacles, &config(to, reach_m));
        prop_assert_eq!(values(&field), brute_force(&obstacles, to, field.limit_half_cells_sq()));
    }

    #[test]
    fn clutter_beside_open_ground_agrees_with_brute_force(
        seed: u64, width in 300u32..520, centres: bool,
        reach_m in prop_oneof![Just(f64::INFINITY), 0.0..30.0f64],
        densities in prop::collection::vec(prop_oneof![Just(0.0), 0.0..0.01, 0.0..0.5], 6),
    ) {
        let to = if centres { DistanceTo::Centres } else { DistanceTo::Squares };
        let (frame, mut obstacles) = (frame(width, 12), BitGrid::new(width, 12, false));
        let mut random = Random(seed | 1);
        for cell in frame.cells() {
            obstacles.set(cell, random.fraction() < densities[cell.x as usize / 90]);
        }
        let field = DistanceField::new(&frame, &obstacles, &config(to, reach_m));
        prop_assert!(values(&field) == brute_force(&obstacles, to, field.limit_half_cells_sq()));
    }

    #[test]
    fn threads_do_not_matter(seed: u64, width in 1u32..3000, density in 0.0..0.02f64) {
        let height = 400_000 / width.max(40);
        let mut obstacles = BitGrid::new(width, height, false);
        let mut random = Random(seed | 1);
        for _ in 0..(density * f64::from(width * height)) as usize {
            let cell = Cell::new(random.below(width), random.below(height));
            obstacles.set(cell, true);
        }
        let by = |threads| {
            let config = FieldConfig { threads: NonZeroUsize::new(threads), ..FieldConfig::default() };
            DistanceField::new(&frame(width, height), &obstacles, &config)
        };
        let (one, four) = (by(1), by(4));
        prop_assert!(one == four);
        // Bands agree with each other: every obstacle is at 0, and neighbours differ by at most
        // one cell.
        for cell in one.frame().cells() {
            let here = one.half_cells_sq(cell).unwrap();
            prop_assert_eq!(here == 0, obstacles.get(cell));
            let above = one.half_cells_sq(Cell::new(cell.x, cell.y + 1)).unwrap_or(here);
            prop_assert!((f64::from(here).sqrt() - f64::from(above).sqrt()).abs() <= 2.0 + 1e-9);
        }
    }

    #[test]
    fn bounds_hold_at_any_point(obstacles in grids(), x in -0.2..1.2f64, y in -0.2..1.2f64) {
        let frame = frame(obstacles.width(), obstacles.height());
        let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let point = Point::new(x * f64::from(frame.width()), y * f64::from(frame.height()));
        let exact = crate::map::Clearance::new(&frame, &obstacles).of_point(point, 1e4);
        prop_assert!(field.lower_bound_m(point).min(1e4) <= exact + 1e-9);
        prop_assert!(field.upper_bound_m(point).min(1e4) >= exact - 1e-9);
        if frame.cell_from_world(point).is_some() && exact < 1e4 {
            prop_assert!(exact - field.lower_bound_m(point) <= 2.0 * 0.5_f64.sqrt() + 1e-9);
        }
    }
}
