//! A map of 1 m cells, the unknown obstacles on it, and those that were seen.

use keyway::geometry::Point;
use keyway::map::{BitGrid, Cell, CellState, DistanceField, FieldConfig, OccupancyGrid};

/// The map.
pub(crate) struct World {
    known: OccupancyGrid,
    /// Squares, by their lower left corners.
    pub(crate) known_squares: Vec<(f64, f64)>,
    unknown: Vec<(f64, f64)>,
    /// A moving obstacle: at the first position until its time is up, then at the second.
    mover: Option<[(f64, f64); 2]>,
    /// Seen squares that are not on the map.
    pub(crate) seen: Vec<(f64, f64)>,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl World {
    /// Range of the sensor [m].
    const RANGE_M: f64 = 5.0;

    /// Time at which the moving obstacle has moved [s].
    const MOVES_AT_S: f64 = 12.0;

    pub(crate) fn new(rows: &[&str], unknown: &[(u8, u8)]) -> Self {
        let known = OccupancyGrid::from_ascii(rows);
        let mut known_squares = Vec::new();
        for (from_top, row) in rows.iter().enumerate() {
            for (x, letter) in row.chars().enumerate() {
                if letter == '#' {
                    known_squares.push((x as f64, (rows.len() - 1 - from_top) as f64));
                }
            }
        }
        let unknown = unknown.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
        let (width, height) = (rows[0].len() as f64, rows.len() as f64);
        Self { known, known_squares, unknown, mover: None, seen: Vec::new(), width, height }
    }

    pub(crate) fn with_mover(mut self, from: (f64, f64), to: (f64, f64)) -> Self {
        self.mover = Some([from, to]);
        self
    }

    /// Sees all squares within range, and forgets those that moved away.
    pub(crate) fn sense(&mut self, position: Point, time_s: f64) {
        if let Some([first, second]) = self.mover {
            let (now, other) =
                if time_s < Self::MOVES_AT_S { (first, second) } else { (second, first) };
            self.unknown.retain(|&square| square != other);
            self.seen.retain(|&square| square != other);
            if !self.unknown.contains(&now) {
                self.unknown.push(now);
            }
        }
        for &square in &self.unknown {
            let centre = Point::new(square.0 + 0.5, square.1 + 0.5);
            if centre.distance(position) <= Self::RANGE_M && !self.seen.contains(&square) {
                self.seen.push(square);
            }
        }
    }

    /// All squares that are on the map or were seen.
    pub(crate) fn squares(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.known_squares.iter().chain(&self.seen)
    }

    /// The input of the planner.
    pub(crate) fn sensed(&self) -> BitGrid {
        let mut sensed =
            BitGrid::new(self.known.frame().width(), self.known.frame().height(), false);
        for &(x, y) in &self.seen {
            sensed.set(Cell::new(x as i32, y as i32), true);
        }
        sensed
    }

    /// The input of the planner.
    pub(crate) fn field(&self) -> DistanceField {
        let sensed = self.sensed();
        let all = OccupancyGrid::from_fn(*self.known.frame(), |cell| {
            let is_occupied = self.known.occupied().get(cell) || sensed.get(cell);
            if is_occupied { CellState::Occupied } else { CellState::Free }
        });
        DistanceField::new(all.frame(), all.occupied(), &FieldConfig::default())
    }
}

/// Distance of a point to a square.
pub(crate) fn to_square(x: f64, y: f64, &(left, low): &(f64, f64)) -> f64 {
    let dx = (left - x).max(x - left - 1.0).max(0.0);
    let dy = (low - y).max(y - low - 1.0).max(0.0);
    (dx * dx + dy * dy).sqrt()
}

/// True if a straight line meets a square that is enlarged by this on each side: tested by the
/// part of the line between its sides.
pub(crate) fn meets(
    (x0, y0): (f64, f64),
    (x1, y1): (f64, f64),
    &(left, low): &(f64, f64),
    larger: f64,
) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (start, along, side) in [(x0, x1 - x0, left - larger), (y0, y1 - y0, low - larger)] {
        let opposite = side + 1.0 + 2.0 * larger;
        if along == 0.0 {
            if start < side || start > opposite {
                return false;
            }
            continue;
        }
        let (one, other) = ((side - start) / along, (opposite - start) / along);
        from = from.max(one.min(other));
        to = to.min(one.max(other));
    }
    from <= to
}
