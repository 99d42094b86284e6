//! At which headings a footprint is free: sets of headings as bits, a look-up for each occupied cell
//! near a place.

use crate::geometry::Point;
use crate::map::DistanceField;
use crate::robot::Footprint;
use std::f64::consts::TAU;

/// A bit for each of so many headings, `TAU / HEADINGS` apart, from the x axis of the cells on.
pub(super) type Headings = u64;

pub(super) const HEADINGS: usize = 64;

/// Between two headings \[rad\].
pub(super) const HEADING_RAD: f64 = TAU / HEADINGS as f64;

/// A footprint that comes no nearer than this to a cell does not touch it \[cells\].
const ROUNDING: f64 = 1e-9;

/// The headings that an occupied cell blocks, by where it is from the robot. The robot is in the
/// middle of a cell, or on the line or the corner between cells: places are those of a grid of half
/// cells.
#[derive(Debug, Default)]
pub(super) struct BlockedHeadings {
    /// They are made for this footprint, its margin and the side of a cell \[m\].
    made_for: Option<(Footprint, f64, f64)>,
    /// Cells to each side that matter.
    reach: i32,
    /// For both parities of a place along both axes, row by row.
    tables: [Vec<Headings>; 4],
    /// The reach of the footprint to the left, down, to the right and up \[cells\], by heading.
    reaches: Vec<[f64; 4]>,
}

impl BlockedHeadings {
    /// A footprint that reaches over more cells has no tables: they would be too large.
    const MOST_REACH: f64 = 100.0;

    /// Makes the tables of a footprint with a margin around it \[m\], unless they are there. A
    /// footprint that is not convex counts as if gaps along the rows of cells were filled.
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
        let side = (2 * self.reach + 1) as usize;
        self.tables = std::array::from_fn(|_| vec![0; side * side]);
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
        let (reach, side) = (self.reach, (2 * self.reach + 1) as usize);
        // Of the lower left corner of a cell, from the robot: it is in the middle of its own one, or
        // on its left or lower line.
        let corner =
            |cells: i32, is_between: bool| f64::from(cells) - if is_between { 0.0 } else { 0.5 };
        for row in -reach..=reach {
            let low = corner(row, parity & 2 != 0) - margin;
            let high = low + 1.0 + 2.0 * margin;
            let Some([left, right]) = span(outline, [low, high]) else { continue };
            for column in -reach..=reach {
                let from = corner(column, parity & 1 != 0);
                if from + 1.0 > left - margin + ROUNDING && from < right + margin - ROUNDING {
                    let index = (row + reach) as usize * side + (column + reach) as usize;
                    self.tables[parity][index] |= 1 << heading;
                }
            }
        }
    }

    /// The free headings at a place, in half cells from the lower left corner of the map: 2 x + 1 is
    /// the middle of column x.
    pub(super) fn free_at(&self, (x, y): (i32, i32), obstacles: &DistanceField) -> Headings {
        let parity = usize::from(x & 1 == 0) | usize::from(y & 1 == 0) << 1;
        let table = &self.tables[parity];
        let (column, row) = (x.div_euclid(2), y.div_euclid(2));
        let (reach, side) = (self.reach, (2 * self.reach + 1) as usize);
        let mut blocked = self.beyond_border((x, y), obstacles);
        let occupied = obstacles.clearance().obstacles();
        for dy in -reach..=reach {
            let entries = &table[(dy + reach) as usize * side..][..side];
            for at in occupied.ones_in_span(row + dy, column - reach, column + reach) {
                blocked |= entries[(at - column + reach) as usize];
            }
            if blocked == Headings::MAX {
                break;
            }
        }
        !blocked
    }

    /// The headings at which it would be on the border of the map, or beyond.
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

    proptest! {
        /// Free headings are free, and blocked ones come near to something: the footprint is a
        /// rectangle off its centre.
        #[test]
        fn headings_are_those_of_the_footprint(
            cells in proptest::collection::vec((0..24, 0..24), 0..8),
            (x, y) in (6..42i32, 6..42i32), (rear, ahead, half) in (0.5..3.0f64, 0.5..5.0f64, 0.4..2.0f64),
            margin in 0.0..0.3f64,
        ) {
            let mut map = OccupancyGrid::from_ascii(&["........................"; 24]);
            let edit = |&(x, y): &(i32, i32)| Edit { cell: crate::map::Cell::new(x, y), state: CellState::Occupied };
            map.apply(&cells.iter().map(edit).collect::<Vec<_>>());
            let field = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let corners = [[ahead, half], [-rear, half], [-rear, -half], [ahead, -half]];
            let footprint = Footprint::polygon(corners.map(Point::from).to_vec()).unwrap();
            let mut blocked = BlockedHeadings::default();
            blocked.fit(&footprint, margin, 1.0);
            let free = blocked.free_at((x, y), &field);
            for heading in 0..HEADINGS {
                let pose = Pose::new(0.5 * f64::from(x), 0.5 * f64::from(y), HEADING_RAD * heading as f64);
                let clearance = field.clearance();
                let room = footprint.distance_m(pose, &clearance, 2.0).min(footprint.to_border_m(pose, &clearance));
                let is_free = free >> heading & 1 == 1;
                // The margin has square corners.
                prop_assert!(!is_free || room > margin - 1e-9, "{heading} {room}");
                prop_assert!(is_free || room <= margin * std::f64::consts::SQRT_2 + 1e-9, "{heading} {room}");
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
            blocked.free_at((5, 2), &field) & 1 == 1
        };
        assert!(free_ahead(&footprint(1.8), 0.0));
        assert!(!free_ahead(&footprint(1.8), 0.2), "another margin");
        assert!(free_ahead(&footprint(1.5), 0.2), "another footprint");
    }

    #[test]
    fn discs_need_none() {
        let mut blocked = BlockedHeadings::default();
        blocked.fit(&Footprint::circle(0.3).unwrap(), 0.0, 0.05);
        assert!(!blocked.is_useful());
    }
}
