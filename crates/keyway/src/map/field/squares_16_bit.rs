//! Squared distances in 16-bit numbers, eight of which are added or compared by one instruction.

use super::DistanceTo;

/// Largest number of rows or columns whose quarters fit 16 bits.
pub(super) const NEAR_ROWS: i16 = 181;
/// Value for anything farther.
pub(super) const FAR: i16 = i16::MAX;
/// Number of cells that are lowered together.
pub(super) const RUN: usize = 16;
/// Number of runs beside an obstacle after which everything is far.
const RUNS: usize = NEAR_ROWS as usize / RUN + 1;

/// Quarters: squared distances scaled by a fourth, whose sums represent the sums of the squares.
///
/// Between centres a square in half cells is 4 r². To a square's edge it is (2 r - 1)² = 4 q - 3
/// with the odd q = r² - r + 1, and 0 with q = 0. In a sum of two, the parity of q shows if the 3
/// is subtracted once or twice: 4 q - 3, or 4 q - 6 and never less than 0.
impl DistanceTo {
    /// The quarter of a distance along a row or column.
    pub(super) const fn quarter(self, rows: i32) -> i16 {
        let quarter = match self {
            Self::Squares if rows == 0 => 0,
            Self::Squares => rows * rows - rows + 1,
            Self::Centres => rows * rows,
        };
        if quarter < FAR as i32 { quarter as i16 } else { FAR }
    }

    /// The squared distance, in half cells, that a quarter or a sum of two represents.
    pub(super) fn half_cells_sq_of_quarter(self, quarter: i16) -> i32 {
        // Never negative: without a sign, the conversion is faster.
        let quarter = u32::from(quarter as u16) as i32;
        match self {
            Self::Squares => (4 * quarter - 6 + 3 * (quarter & 1)).max(0),
            Self::Centres => 4 * quarter,
        }
    }

    pub(super) const fn along(self) -> &'static Along {
        static TO_SQUARES: Along = Along::new(DistanceTo::Squares);
        static TO_CENTRES: Along = Along::new(DistanceTo::Centres);
        match self {
            Self::Squares => &TO_SQUARES,
            Self::Centres => &TO_CENTRES,
        }
    }
}

/// Quarters along a row from an obstacle to the columns beside it, run by run away from it.
pub(super) struct Along {
    pub(super) right: [[i16; RUN]; RUNS],
    pub(super) left: [[i16; RUN]; RUNS],
}

impl Along {
    const fn new(to: DistanceTo) -> Self {
        let mut along = Self { right: [[0; RUN]; RUNS], left: [[0; RUN]; RUNS] };
        let mut column = 0;
        while column < RUN * RUNS {
            let quarter = to.quarter(column as i32 + 1);
            along.right[column / RUN][column % RUN] = quarter;
            along.left[column / RUN][RUN - 1 - column % RUN] = quarter;
            column += 1;
        }
        along
    }
}

/// Lowers runs of cells, one after the other, to an obstacle with the quarter `across` from their
/// row, up to the first run whose `last` cell is as low already.
pub(super) fn lower<'a>(
    runs: impl Iterator<Item = (&'a mut [i16; RUN], &'a [i16; RUN])>,
    last: usize,
    across: i16,
) {
    for (run, along) in runs {
        let away = along.map(|along| across.saturating_add(along));
        let before = *run;
        for ((value, before), away) in run.iter_mut().zip(before).zip(away) {
            *value = before.min(away);
        }
        if before[last] <= away[last] {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_quarters_stand_for_sums_of_squares() {
        for to in [DistanceTo::Squares, DistanceTo::Centres] {
            for (rows, columns) in
                (0..=NEAR_ROWS).flat_map(|r| (0..=NEAR_ROWS).map(move |c| (r, c)))
            {
                let quarter = |rows: i16| i32::from(to.quarter(i32::from(rows)));
                let sum = quarter(rows) + quarter(columns);
                let square = to.half_cells_sq(rows) + to.half_cells_sq(columns);
                if let Ok(sum) = i16::try_from(sum) {
                    assert_eq!(to.half_cells_sq_of_quarter(sum), square, "{to:?} {rows} {columns}");
                } else {
                    assert!(square >= to.half_cells_sq_of_quarter(FAR));
                }
            }
            assert!(to.quarter(i32::from(NEAR_ROWS)) < FAR);
            assert_eq!(to.quarter(i32::from(NEAR_ROWS) + 1), FAR);
        }
    }
}
