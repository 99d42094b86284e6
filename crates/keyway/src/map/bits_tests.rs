use super::*;
use proptest::prelude::*;

#[test]
fn padding_surrounds_the_cells() {
    for (width, height) in [(1, 1), (62, 3), (63, 2), (64, 2), (200, 1)] {
        let grid = BitGrid::new(width, height, true);
        assert_eq!(grid.count_ones(), 0);
        assert!(grid.get(Cell::new(-1, 0)) && grid.get(Cell::new(width as i32, 0)));
        assert!(grid.row(-1).iter().all(|&w| w == u64::MAX));
        assert!(grid.row(height as i32).iter().all(|&w| w == u64::MAX));
        assert_eq!(grid.row(0)[0] & 1, 1);
    }
}

#[test]
fn columns_far_outside() {
    let grid = BitGrid::new(70, 1, false);
    let (least, most) = (i32::MIN, i32::MAX);
    for (from, to) in [(most, most), (least, least), (most, least), (70, most), (least, -1)] {
        assert!(grid.columns(from, to).is_none(), "{from} to {to}");
    }
    assert!(grid.columns(least, most).is_some());
}

proptest! {
    #[test]
    fn spans_agree_with_single_bits(width in 1u32..150, y in 0i32..3, from in -5i32..160,
                                    len in 0i32..150, padding: bool) {
        let mut by_span = BitGrid::new(width, 3, padding);
        let mut by_bit = by_span.clone();
        by_span.fill_span(y, from, from + len);
        for x in from..=from + len {
            by_bit.set(Cell::new(x, y), true);
        }
        prop_assert_eq!(&by_span, &by_bit);
        let expected: Vec<i32> = (0..width as i32)
            .filter(|&x| x >= from && x <= from + len).collect();
        prop_assert_eq!(by_span.ones_in_span(y, -3, 1000).collect::<Vec<_>>(), expected.clone());
        let mut kept = BitGrid::new(width, 3, padding);
        kept.fill_span(y, 0, 200);
        kept.keep_span(y, from, from + len);
        prop_assert_eq!(&kept, &by_span);
        kept.keep_span(y, from, i32::MAX);
        prop_assert_eq!(&kept, &by_span);
        let part: Vec<i32> = expected.iter().copied().filter(|&x| (7..=90).contains(&x)).collect();
        prop_assert_eq!(by_span.any_in_span(y, 7, 90), !part.is_empty());
        let mut visited = Vec::new();
        let mut visit = |x: i32| { visited.push(x); x < 60 };
        let all = by_span.all_ones_in_span(y, 7, 90, &mut visit);
        prop_assert_eq!(all, part.iter().all(|&x| x < 60));
        let until = part.iter().position(|&x| x >= 60).map_or(part.len(), |last| last + 1);
        prop_assert_eq!(&visited, &part[..until]);
        for x in 0..width as i32 {
            let run = |step: i32| (1..200).take_while(|k| expected.contains(&(x + k * step))).count() as i32;
            prop_assert_eq!(by_span.ones_beside(Cell::new(x, y)), (run(-1), run(1)), "{} of {}", x, width);
        }
        if let Some(columns) = by_span.columns(7, 90) {
            prop_assert_eq!(by_span.any_in_columns(y, &columns), !part.is_empty());
        }
        if let Some(columns) = by_span.columns(from - 9, from) {
            let near = by_span.any_in_span(y, from - 9, from);
            prop_assert_eq!(by_span.any_in_columns(y, &columns), near);
        }
        prop_assert_eq!(by_span.count_in_span(y, 7, 90) as usize, part.len());
        prop_assert_eq!(by_span.count_in_span(y, -9, 1000) as usize, expected.len());
        prop_assert_eq!(by_span.first_one_in_span(y, 7, 90), part.first().copied());
        prop_assert_eq!(by_span.last_one_in_span(y, 7, 90), part.last().copied());
        prop_assert_eq!(by_span.ones_in_span(y, 7, 90).collect::<Vec<_>>(), part);
    }

    #[test]
    fn transposing_twice_changes_nothing(width in 1u32..130, height in 1u32..90,
                                         cells in prop::collection::vec((0i32..130, 0i32..90), 0..40)) {
        let mut grid = BitGrid::new(width, height, true);
        for (x, y) in cells {
            grid.set(Cell::new(x, y), true);
        }
        let turned = grid.transposed();
        for y in -1..=height as i32 {
            for x in -1..=width as i32 {
                prop_assert_eq!(grid.get(Cell::new(x, y)), turned.get(Cell::new(y, x)));
            }
        }
        prop_assert_eq!(turned.transposed(), grid);
    }

    #[test]
    fn transposing_is_done_bit_by_bit(width in 1u32..200, height in 1u32..200, padding: bool, seed: u64) {
        let mut grid = BitGrid::new(width, height, padding);
        let mut turned = BitGrid::new(height, width, padding);
        let mut state = seed | 1;
        for (x, y) in (0..width as i32).flat_map(|x| (0..height as i32).map(move |y| (x, y))) {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            grid.set(Cell::new(x, y), state & 1 == 1);
            turned.set(Cell::new(y, x), state & 1 == 1);
        }
        prop_assert_eq!(grid.transposed(), turned);
        let ones = (0..height as i32).map(|y| grid.ones_in_span(y, 0, i32::MAX).count() as u64);
        prop_assert_eq!(grid.count_ones(), ones.sum::<u64>());
    }
}

/// Each row takes a whole word, so narrow grids of few cells could take much memory.
#[test]
fn only_sizes_of_maps_are_taken_up() {
    let stored = |width: u64, height: u64| {
        serde_json::json!({
            "width": width, "height": height, "padding": false, "runs": [width * height]
        })
    };
    for (width, height) in [(3, 2), (1000, 900)] {
        assert!(serde_json::from_value::<BitGrid>(stored(width, height)).is_ok());
    }
    for (width, height) in [(0, 5), (1, 500_000_000), (500_000_000, 1 << 31), (1 << 31, 2)] {
        assert!(serde_json::from_value::<BitGrid>(stored(width, height)).is_err());
    }
}
