//! Free headings of a footprint: sets of headings as bits, by a look-up for each occupied cell
//! near a position.

use crate::geometry::Point;
use crate::map::{BitGrid, Cell, DistanceField};
use crate::robot::Footprint;
use std::f64::consts::TAU;
use std::ops::Range;

/// A set of headings, one bit each, `TAU / HEADINGS` apart, beginning at the x axis of the cells.
pub(super) type Headings = u64;

pub(super) const HEADINGS: usize = 64;

/// Angle between two headings \[rad\].
pub(super) const HEADING_RAD: f64 = TAU / HEADINGS as f64;

/// A footprint that comes no nearer than this to a cell does not touch it \[cells\].
const ROUNDING: f64 = 1e-9;

/// The headings that an occupied cell blocks, by its position relative to the robot. The robot is
/// in the middle of a cell, or on the line or the corner between cells: places are those of a
/// grid of half cells.
#[derive(Debug, Default)]
pub(super) struct BlockedHeadings {
    /// The footprint, its margin and the side of a cell \[m\] for which the tables were made.
    made_for: Option<(Footprint, f64, f64)>,
    /// Number of cells to each side that matter.
    reach: i32,
    /// For both parities of a place along both axes, by row and column of the place as seen from
    /// the cell, with columns without entries to both sides.
    tables: [Vec<Headings>; 4],
    /// The reach of the footprint to the left, down, to the right and up \[cells\], by heading.
    reaches: Vec<[f64; 4]>,
}

impl BlockedHeadings {
    /// A footprint that extends over more cells has no tables: they would be too large.
    const MOST_REACH: f64 = 100.0;

    /// Builds the tables of a footprint with a margin around it \[m\], unless they exist. A
    /// footprint that is not convex is treated as if gaps along the rows of cells were filled.
    pub(super) fn fit(&mut self, footprint: &Footprint, margin_m: f64, cell_m: f64) {
        let is_that = |(of, its_margin_m, its_cell_m): &(Footprint, f64, f64)| {
            of == footprint && *its_margin_m == margin_m && *its_cell_m == cell_m
        };
        if self.made_for.as_ref().is_some_and(is_that) {
            return;
        }
        self.made_for = Some((footprint.clone(), margin_m, cell_m));
        self.reaches.clear();
        self.tables = Default::default();
        let Footprint::Polygon(polygon) = footprint else { return };
        let reach = (polygon.circumscribed_radius_m() + margin_m) / cell_m;
        if reach > Self::MOST_REACH {
            return;
        }
        self.reach = reach.ceil() as i32 + 1;
        let rows = (2 * self.reach + 1) as usize;
        self.tables = std::array::from_fn(|_| vec![0; rows * self.columns()]);
        let margin = margin_m / cell_m;
        for heading in 0..HEADINGS {
            let (sin, cos) = libm::sincos(HEADING_RAD * heading as f64);
            let turned = polygon.vertices().iter().map(|at| {
                Point::new(at.x * cos - at.y * sin, at.x * sin + at.y * cos) * cell_m.recip()
            });
            let outline: Vec<Point> = turned.collect();
            let most = |of: fn(&Point) -> f64| outline.iter().map(of).fold(0.0, f64::max);
            self.reaches.push(
                [most(|at| -at.x), most(|at| -at.y), most(|at| at.x), most(|at| at.y)]
                    .map(|far| far + margin),
            );
            for parity in 0..4 {
                self.block(&outline, margin, (parity, heading));
            }
        }
    }

    /// True if there are tables: a disc needs none.
    pub(super) const fn is_useful(&self) -> bool {
        !self.reaches.is_empty()
    }

    /// Marks the cells that an outline \[cells\] touches, row by row.
    fn block(&mut self, outline: &[Point], margin: f64, (parity, heading): (usize, usize)) {
        let (reach, columns) = (self.reach, self.columns());
        // Lower left corner of a cell, relative to the robot, which is in the middle of its own
        // cell, or on its left or lower line.
        let corner =
            |cells: i32, is_between: bool| f64::from(cells) - if is_between { 0.0 } else { 0.5 };
        for row in -reach..=reach {
            let low = corner(row, parity & 2 != 0) - margin;
            let high = low + 1.0 + 2.0 * margin;
            let Some([left, right]) = span(outline, [low, high]) else { continue };
            for column in -reach..=reach {
                let from = corner(column, parity & 1 != 0);
                if from + 1.0 > left - margin + ROUNDING && from < right + margin - ROUNDING {
                    let index = (row + reach) as usize * columns + self.column(-column);
                    self.tables[parity][index] |= 1 << heading;
                }
            }
        }
    }

    /// The columns of a table.
    const fn columns(&self) -> usize {
        2 * (self.reach as usize + Places::COLUMNS) + 1
    }

    /// The column of a table for a place that is this many columns from a cell.
    const fn column(&self, off: i32) -> usize {
        (off + self.reach + Places::COLUMNS as i32) as usize
    }

    /// Adds the blocked headings at all places of [`Places::COLUMNS`] columns of cells from
    /// `first` on, for either parity of their column: `rows` are in half cells, and few cells
    /// apart.
    fn add_to(
        &self,
        blocked: &mut [Block],
        (first, rows): (i32, &[i32]),
        occupied: &BitGrid,
        cells: &mut Vec<i32>,
    ) {
        let reach = self.reach;
        let (Some(lowest), Some(highest)) = (rows.first(), rows.last()) else { return };
        let last = first + Places::COLUMNS as i32 - 1;
        for cell_row in lowest.div_euclid(2) - reach..=highest.div_euclid(2) + reach {
            collect_edge(occupied, cell_row, (first - reach, last + reach), cells);
            if cells.is_empty() {
                continue;
            }
            for (&y, blocked) in rows.iter().zip(&mut *blocked) {
                let row = cell_row - y.div_euclid(2);
                if row.abs() > reach {
                    continue;
                }
                let entries = (row + reach) as usize * self.columns()..;
                let between_rows = usize::from(y & 1 == 0) << 1;
                for (parity, blocked) in blocked.iter_mut().enumerate() {
                    let entries = &self.tables[parity | between_rows][entries.clone()];
                    let mut all = *blocked;
                    for &cell in &*cells {
                        let entries = &entries[self.column(first - cell)..][..Places::COLUMNS];
                        all.iter_mut().zip(entries).for_each(|(all, entry)| *all |= entry);
                    }
                    *blocked = all;
                }
            }
        }
    }

    /// The headings at which the footprint would be on the border of the map, or beyond.
    fn beyond_border(&self, (x, y): (i32, i32), obstacles: &DistanceField) -> Headings {
        let frame = obstacles.frame();
        let at = [x, y].map(|halves| 0.5 * f64::from(halves));
        let room =
            [at[0], at[1], f64::from(frame.width()) - at[0], f64::from(frame.height()) - at[1]];
        if room.iter().all(|&room| room >= f64::from(self.reach)) {
            return 0;
        }
        let is_beyond =
            |reaches: &[f64; 4]| reaches.iter().zip(room).any(|(far, room)| *far > room + ROUNDING);
        let beyond = self.reaches.iter().enumerate().filter(|(_, reaches)| is_beyond(reaches));
        beyond.fold(0, |all, (heading, _)| all | 1 << heading)
    }
}

/// The blocked headings of a row of places, by the parity of the column in half cells, and by
/// column of cells.
type Block = [[Headings; Places::COLUMNS]; 2];

/// Places at which a footprint is tried, in half cells from the lower left corner of the map: 2
/// x + 1 is the middle of column x.
#[derive(Debug, Default)]
pub(super) struct Places {
    xs: Vec<i32>,
    ys: Vec<i32>,
    /// The blocked headings, row by row.
    blocked: Vec<Headings>,
    /// Working memory.
    block: Vec<Block>,
    cells: Vec<i32>,
}

impl Places {
    /// Number of columns of cells that are processed at once.
    pub(super) const COLUMNS: usize = 8;

    /// Tries a footprint at all places of these columns and rows, each in ascending order.
    pub(super) fn fill(
        &mut self,
        (xs, ys): (&[i32], &[i32]),
        footprint: &BlockedHeadings,
        obstacles: &DistanceField,
    ) {
        self.xs.clear();
        self.xs.extend(xs);
        self.ys.clear();
        self.ys.extend(ys);
        self.blocked.clear();
        self.blocked.resize(xs.len() * ys.len(), 0);
        for rows in near_each_other(ys) {
            for columns in near_each_other(xs) {
                self.fill_block((columns, rows.clone()), footprint, obstacles);
            }
        }
    }

    fn fill_block(
        &mut self,
        (columns, rows): (Range<usize>, Range<usize>),
        footprint: &BlockedHeadings,
        obstacles: &DistanceField,
    ) {
        let Self { xs, ys, blocked, block, cells } = self;
        let occupied = obstacles.clearance().obstacles();
        let first = xs[columns.start].div_euclid(2);
        block.clear();
        block.resize(rows.len(), Block::default());
        footprint.add_to(block, (first, &ys[rows.clone()]), occupied, cells);
        for (row, found) in rows.zip(block) {
            for column in columns.clone() {
                let (x, y) = (xs[column], ys[row]);
                let cell = Cell::new(x.div_euclid(2), y.div_euclid(2));
                // Only cells at the edges of obstacles were checked.
                let is_inside = occupied.contains(cell) && occupied.get(cell);
                blocked[row * xs.len() + column] = if is_inside {
                    Headings::MAX
                } else {
                    let of_cells = found[usize::from(x & 1 == 0)][(cell.x - first) as usize];
                    of_cells | footprint.beyond_border((x, y), obstacles)
                };
            }
        }
    }

    /// The index of a column.
    pub(super) fn column(&self, x: i32) -> Option<usize> {
        self.xs.binary_search(&x).ok()
    }

    /// The index of a row.
    pub(super) fn row(&self, y: i32) -> Option<usize> {
        self.ys.binary_search(&y).ok()
    }

    /// The free headings at a place.
    pub(super) fn free(&self, column: usize, row: usize) -> Headings {
        !self.blocked[row * self.xs.len() + column]
    }
}

/// Ranges of ascending numbers of half cells, each within [`Places::COLUMNS`] cells.
fn near_each_other(halves: &[i32]) -> impl Iterator<Item = Range<usize>> {
    let mut from = 0;
    std::iter::from_fn(move || {
        let first = halves.get(from)?.div_euclid(2);
        let is_near = |half: &i32| half.div_euclid(2) - first < Places::COLUMNS as i32;
        let part = from..from + halves[from..].partition_point(is_near);
        from = part.end;
        Some(part)
    })
}

/// Collects the columns of those occupied cells of a row that have a free neighbour, of eight: a
/// footprint around a free place touches one of them before it touches any other one.
fn collect_edge(occupied: &BitGrid, row: i32, (from, to): (i32, i32), columns: &mut Vec<i32>) {
    columns.clear();
    let (from, to) = (from.max(0), to.min(occupied.width() as i32 - 1));
    let is_row = |row: i32| row >= 0 && row < occupied.height() as i32;
    if !is_row(row) || from > to {
        return;
    }
    let own = occupied.row(row);
    let beside = [row - 1, row + 1].map(|row| if is_row(row) { occupied.row(row) } else { &[] });
    // Set if a cell and both beside it are.
    let inside = |row: &[u64], word: usize| {
        let Some(&here) = row.get(word) else { return 0 };
        let before = if word > 0 { row[word - 1] } else { 0 };
        let after = row.get(word + 1).copied().unwrap_or_default();
        here & (here << 1 | before >> 63) & (here >> 1 | after << 63)
    };
    // Bit 0 of a row is before its first column.
    for word in (from + 1) as usize / 64..=(to + 1) as usize / 64 {
        if own[word] == 0 {
            continue;
        }
        let all_inside = inside(own, word) & inside(beside[0], word) & inside(beside[1], word);
        let mut edge = own[word] & !all_inside;
        while edge != 0 {
            let column = (word * 64) as i32 + edge.trailing_zeros() as i32 - 1;
            if (from..=to).contains(&column) {
                columns.push(column);
            }
            edge &= edge - 1;
        }
    }
}

/// The columns that an outline covers between two rows.
fn span(outline: &[Point], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let mut span: Option<[f64; 2]> = None;
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        let (from, to) = if a.y < b.y { (a, b) } else { (b, a) };
        if to.y < low + ROUNDING || from.y > high - ROUNDING {
            continue;
        }
        let at = |y: f64| {
            let rise = to.y - from.y;
            if rise <= 0.0 { from } else { from.lerp(to, ((y - from.y) / rise).clamp(0.0, 1.0)) }
        };
        let (first, last) = (at(low).x, at(high).x);
        let ends = if to.y > from.y {
            [first.min(last), first.max(last)]
        } else {
            [from.x.min(to.x), from.x.max(to.x)]
        };
        span = Some(span.map_or(ends, |[left, right]| [left.min(ends[0]), right.max(ends[1])]));
    }
    span
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{CellState, Edit, FieldConfig, OccupancyGrid};
    use proptest::prelude::*;

    /// Free headings at a place.
    fn free_at(blocked: &BlockedHeadings, (x, y): (i32, i32), field: &DistanceField) -> Headings {
        let mut places = Places::default();
        places.fill((&[x], &[y]), blocked, field);
        places.free(0, 0)
    }

    proptest! {
        /// Free headings are free, and blocked ones come near to something: the footprint is a
        /// rectangle off its centre.
        #[test]
        fn headings_are_those_of_the_footprint(
            cells in proptest::collection::vec((0..24, 0..24), 0..8),
            (left, low, wide, high) in (0..24i32, 0..24i32, 0..9i32, 0..9i32),
            (x, y) in (6..42i32, 6..42i32), (rear, ahead, half) in (0.5..3.0f64, 0.5..5.0f64, 0.4..2.0f64),
            margin in 0.0..0.3f64,
        ) {
            let mut map = OccupancyGrid::from_ascii(&["........................"; 24]);
            let edit = |(x, y): (i32, i32)| Edit { cell: Cell::new(x, y), state: CellState::Occupied };
            let block = (0..wide * high).map(|i| (left + i % wide, low + i / wide));
            let block = block.filter(|&(x, y)| x < 24 && y < 24);
            map.apply(&cells.into_iter().chain(block).map(edit).collect::<Vec<_>>());
            let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let corners = [[ahead, half], [-rear, half], [-rear, -half], [ahead, -half]];
            let footprint = Footprint::polygon(corners.map(Point::from).to_vec()).unwrap();
            let mut blocked = BlockedHeadings::default();
            blocked.fit(&footprint, margin, 1.0);
            let free = free_at(&blocked, (x, y), &field);
            for heading in 0..HEADINGS {
                let pose = Pose::new(0.5 * f64::from(x), 0.5 * f64::from(y), HEADING_RAD * heading as f64);
                let clearance = field.clearance();
                let room = footprint.distance_m(pose, &clearance, 2.0).min(footprint.to_border_m(pose, &clearance));
                let is_free = free >> heading & 1 == 1;
                // The margin has square corners.
                prop_assert!(!is_free || room > margin - 1e-9, "{heading} {room}");
                prop_assert!(is_free || room <= margin * std::f64::consts::SQRT_2 + 1e-9, "{heading} {room}");
            }
            // Together with others, far and near.
            let (xs, ys) = ([x - 4, x, x + 1, x + 13, x + 14, x + 90], [y - 5, y - 1, y, y + 17, y + 70]);
            let mut places = Places::default();
            places.fill((&xs, &ys), &blocked, &field);
            for (column, row) in xs.iter().flat_map(|&x| ys.iter().map(move |&y| (x, y))) {
                let index = (places.column(column).unwrap(), places.row(row).unwrap());
                prop_assert_eq!(places.free(index.0, index.1), free_at(&blocked, (column, row), &field));
            }
        }
    }

    /// The same memory may serve another robot, or the same one with another margin.
    #[test]
    fn tables_are_those_of_the_last_footprint_and_margin() {
        let map = OccupancyGrid::from_ascii(&[".....", "....."]);
        let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
        let footprint = |width_m| Footprint::rectangle(2.0, width_m).unwrap();
        let mut blocked = BlockedHeadings::default();
        let mut free_ahead = |footprint: &Footprint, margin_m| {
            blocked.fit(footprint, margin_m, 1.0);
            free_at(&blocked, (5, 2), &field) & 1 == 1
        };
        assert!(free_ahead(&footprint(1.8), 0.0));
        assert!(!free_ahead(&footprint(1.8), 0.2), "another margin");
        assert!(free_ahead(&footprint(1.5), 0.2), "another footprint");
    }

    /// Far from the edge of the obstacle.
    #[test]
    fn inside_of_what_stands_nothing_is_free() {
        let map = OccupancyGrid::from_ascii(&["####################"; 20]);
        let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
        let mut blocked = BlockedHeadings::default();
        blocked.fit(&Footprint::rectangle(1.0, 0.8).unwrap(), 0.0, 1.0);
        for place in [(20, 20), (21, 20), (20, 21), (21, 21)] {
            assert_eq!(free_at(&blocked, place, &field), 0);
        }
    }

    #[test]
    fn discs_need_none() {
        let mut blocked = BlockedHeadings::default();
        blocked.fit(&Footprint::circle(0.3).unwrap(), 0.0, 0.05);
        assert!(!blocked.is_useful());
    }
}
