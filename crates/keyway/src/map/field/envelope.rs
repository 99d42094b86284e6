//! Distances along one row: from the distances within the columns to the distances in the plane.

use serde::{Deserialize, Serialize};

/// Number of rows to the nearest obstacle in a column that has none, or none near enough.
///
/// Twice this still fits, so squares are those of 16-bit numbers, eight of which are multiplied
/// by one instruction, and the sum of two squares fits 31 bits.
pub(super) const FAR_ROWS: i16 = i16::MAX / 2;

/// Definition of the distance from a cell's centre to an obstacle cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DistanceTo {
    /// The distance to the obstacle's square: the clearance of a robot's centre there.
    #[default]
    Squares,
    /// The distance between the two centres, as in ROS costmaps.
    Centres,
}

impl DistanceTo {
    /// Squared distance, in half cells, to an obstacle cell that is `rows` rows (or columns) away.
    pub(super) fn half_cells_sq(self, rows: i16) -> i32 {
        match self {
            Self::Squares => square((2 * rows - 1).max(0)),
            Self::Centres => square(2 * rows),
        }
    }

    /// Squared distance, in half cells, along a row or column: from the cell at `at` to the
    /// nearest of those from `low` to `high`.
    pub(super) fn away_sq(self, low: i32, high: i32, at: i32) -> i32 {
        let cells = (low - at).max(at - high).max(0);
        self.half_cells_sq(cells.min(i32::from(FAR_ROWS)) as i16)
    }

    /// Apex of the parabola of the step between columns `step - 1` and `step`, in half cells from
    /// the left end of the row (column p's centre is at 2 p + 1), given the two columns' rows. It
    /// is on the nearer column's edge or centre.
    fn apex(self, step: usize, left: i16, right: i16) -> i64 {
        let edge = 2 * step as i64;
        match self {
            Self::Squares => edge,
            Self::Centres => edge + if right < left { 1 } else { -1 },
        }
    }
}

fn square(half_cells: i16) -> i32 {
    i32::from(half_cells) * i32::from(half_cells)
}

/// Computes the distances of a row from those within its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Envelope {
    pub(super) to: DistanceTo,
    /// Upper limit of stored squared distances.
    pub(super) limit_sq: i32,
}

/// A parabola of the lower envelope: squared distances, in half cells, to an obstacle that is at
/// its apex along the row and `height` across.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola {
    /// Half cells from the left end of the row.
    apex: i64,
    height: i32,
    /// The first column in which it is the lowest one.
    from: i64,
}

impl Parabola {
    /// The first column in which `right`, a parabola with its apex further right, is at least as
    /// low: the smallest p with height' + (2 p + 1 - apex')² <= height + (2 p + 1 - apex)².
    fn crossing(&self, right: &Self) -> i64 {
        let apart = right.apex - self.apex;
        let rise = i64::from(right.height - self.height);
        let half_cells = (rise + apart * apart + 2 * apart - 1).div_euclid(2 * apart);
        (self.apex + half_cells) >> 1
    }

    /// Value of the parabola in a column.
    const fn at(&self, column: i64) -> i64 {
        let half_cells = 2 * column + 1 - self.apex;
        self.height as i64 + half_cells * half_cells
    }

    /// Lowers the values of columns `from..to` to this parabola, and of some columns beyond,
    /// which only brings them nearer to their final values: whole runs of cells take fewer
    /// branches than an exact end.
    fn lower(&self, out: &mut [i32], from: i64, to: i64) {
        const RUN: usize = 8;
        // Farther columns are beyond every limit, and their squares would not fit.
        let reach = i64::from(2 * (FAR_ROWS - 1));
        let from = from.max((self.apex - reach) >> 1);
        let to = to.min((self.apex + reach) >> 1);
        if from >= to {
            return;
        }
        let mut half_cells = (2 * from + 1 - self.apex) as i16;
        let (from, to) = (from as usize, to as usize);
        let whole = (to - from).next_multiple_of(RUN);
        let end = if from + whole <= out.len() { from + whole } else { to };
        let (runs, rest) = out[from..end].as_chunks_mut::<RUN>();
        for run in runs {
            for (value, i) in run.iter_mut().zip(0..) {
                *value = (*value).min(self.height + square(half_cells.saturating_add(2 * i)));
            }
            half_cells = half_cells.saturating_add(2 * RUN as i16);
        }
        for value in rest {
            *value = (*value).min(self.height + square(half_cells));
            half_cells = half_cells.saturating_add(2);
        }
    }
}

impl Envelope {
    /// Lowers squared distances along a row to those to the obstacles of some columns. `rows`
    /// holds the distance across the row to each column's obstacle. It starts with column
    /// `offset` of `out`, which may lie before its start. `hull` is scratch memory.
    ///
    /// Every column contributes its own distance. Along the row it lowers others only at a step:
    /// an equally near neighbour is nearer to all cells on its side.
    pub(super) fn lower(
        &self,
        rows: &[i16],
        offset: i64,
        out: &mut [i32],
        hull: &mut Vec<Parabola>,
    ) {
        let own = &rows[(-offset).clamp(0, rows.len() as i64) as usize..];
        for (value, &rows) in out.iter_mut().skip(offset.max(0) as usize).zip(own) {
            *value = self.to.half_cells_sq(rows).min(*value);
        }
        self.lower_beside(rows, offset, out, hull);
    }

    /// Like [`Self::lower`], without the columns' own distances.
    pub(super) fn lower_beside(
        &self,
        rows: &[i16],
        offset: i64,
        out: &mut [i32],
        hull: &mut Vec<Parabola>,
    ) {
        hull.clear();
        let end = out.len() as i64;
        for_each_step(rows, |step| {
            let (left, right) = (rows[step - 1], rows[step]);
            let height = self.to.half_cells_sq(left.min(right));
            let apex = 2 * offset + self.to.apex(step, left, right);
            push(hull, Parabola { apex, height, from: 0 }, end);
        });
        let ends = hull.iter().skip(1).map(|next| next.from).chain([end]);
        for (parabola, to) in hull.iter().zip(ends) {
            parabola.lower(out, parabola.from, to);
        }
    }
}

/// Adds a parabola whose apex lies right of (or at) all others' to the lower envelope up to
/// `end`.
fn push(hull: &mut Vec<Parabola>, mut new: Parabola, end: i64) {
    while let Some(last) = hull.last() {
        if last.apex == new.apex {
            // A column nearer than both of its neighbours.
            return;
        }
        if last.at(last.from) < new.at(last.from) {
            new.from = last.crossing(&new);
            break;
        }
        new.from = last.from;
        hull.pop();
    }
    if new.from < end {
        hull.push(new);
    }
}

/// Calls `visit` with every index at which the values change, in order.
fn for_each_step(rows: &[i16], mut visit: impl FnMut(usize)) {
    const BLOCK: usize = 8;
    let mut start = 1;
    while start < rows.len() {
        let end = (start + BLOCK).min(rows.len());
        // Compared as a whole, because most blocks have no step.
        if end - start < BLOCK || rows[start - 1..start - 1 + BLOCK] != rows[start..start + BLOCK] {
            // Collected without branches, which would be unpredictable.
            let mut steps = [0; BLOCK];
            let mut count = 0;
            for step in start..end {
                steps[count % BLOCK] = step;
                count += usize::from(rows[step - 1] != rows[step]);
            }
            steps[..count].iter().for_each(|&step| visit(step));
        }
        start = end;
    }
}
