//! Moves the points of a path, in grid coordinates, until they keep a clearance.

use super::pinch::Pinch;
use crate::geometry::{Point, Segment};
use crate::map::{Cell, Clearance};

/// Largest distance of chords from the bends that they cut off \[cells\].
pub(super) const CHORD_CELLS: f64 = 1.0 / 128.0;

/// Largest spacing of the points along a path of cells \[cells\].
const SPACING_CELLS: f64 = 0.25;

/// Largest number of moves of a point, after which it is given up.
const MOVES: u32 = 64;

/// Largest distance that a point is moved \[cells\].
const FAR_CELLS: f64 = 2.0;

/// Largest number of halvings of a connection that comes too close to an obstacle.
const SPLITS: u32 = 3;

/// Number of first points of the path that an end may be joined to.
const FIRST_POINTS: usize = 8;

/// Margin for rounding: a point that is moved to a distance keeps it.
const MORE: f64 = 1.0 + 1e-9;

/// Finds points that keep a distance to all obstacles.
pub(super) struct Room<'a> {
    clearance: Clearance<'a>,
    /// Clearance of the path between its points \[m\].
    kept_m: f64,
    /// Clearance of the points themselves \[cells\].
    reach: f64,
}

/// An end of a path, and the clearance that the connection to it must keep \[m\].
type End = (Point, f64);

impl<'a> Room<'a> {
    pub(super) fn new(clearance: Clearance<'a>, kept_m: f64) -> Self {
        let reach = kept_m / clearance.frame().resolution_m() + 0.5 * CHORD_CELLS;
        Self { clearance, kept_m, reach }
    }

    /// A line that keeps the clearance near a path of cells, from one end to the other; the
    /// points of too little clearance if none exists.
    pub(super) fn line(&self, cells: &[Cell], ends: [End; 2]) -> Result<Vec<Point>, Vec<Pinch>> {
        let mut pinches = Vec::new();
        let mut points: Vec<Point> = Vec::new();
        for at in spaced(cells) {
            match self.moved(at).and_then(|to| self.join(&mut points, to, SPLITS)) {
                Ok(()) => {}
                Err(pinch) => {
                    pinches.push(pinch);
                    points.clear();
                }
            }
        }
        if !pinches.is_empty() {
            return Err(pinches);
        }
        let frame = self.clearance.frame();
        let mut line: Vec<Point> = points.iter().map(|&at| frame.world_from_grid(at)).collect();
        for end in ends {
            line.reverse();
            self.join_end(&mut line, end)?;
        }
        Ok(line)
    }

    /// Joins an end to one of the last points of the line and drops the points after that one.
    fn join_end(&self, line: &mut Vec<Point>, (end, room_m): End) -> Result<(), Vec<Pinch>> {
        let many = line.len().min(FIRST_POINTS);
        let is_joined = |&at: &Point| self.clearance.is_clear(Segment::new(end, at), room_m);
        let tail = line[line.len() - many..].iter().rposition(is_joined);
        let Some(keep) = tail else {
            let at = line.last().map_or(end, |&last| last);
            return Err(vec![Pinch { at: self.clearance.frame().grid_from_world(at), gap: None }]);
        };
        line.truncate(line.len() - many + keep + 1);
        line.push(end);
        Ok(())
    }

    /// Appends a point, preceded by others if the straight connection comes too close to an
    /// obstacle.
    fn join(&self, points: &mut Vec<Point>, to: Point, splits: u32) -> Result<(), Pinch> {
        let Some(&from) = points.last() else {
            points.push(to);
            return Ok(());
        };
        let frame = self.clearance.frame();
        let way = Segment::new(frame.world_from_grid(from), frame.world_from_grid(to));
        if self.clearance.is_clear(way, self.kept_m) {
            points.push(to);
            return Ok(());
        }
        let middle = from.lerp(to, 0.5);
        if splits == 0 {
            return Err(Pinch { at: middle, gap: None });
        }
        let middle = self.moved(middle)?;
        self.join(points, middle, splits - 1)?;
        self.join(points, to, splits - 1)
    }

    /// Moves a point away from its nearest obstacle until it keeps the clearance.
    fn moved(&self, from: Point) -> Result<Point, Pinch> {
        let mut at = self.inside(from);
        let mut touched: [Option<Point>; 2] = [None; 2];
        for _ in 0..MOVES {
            let Some(square) = self.clearance.nearest_square(at, self.reach) else {
                return Ok(at);
            };
            let touch = square.nearest_to(at);
            touched = [touched[1], Some(touch)];
            let away = at - touch;
            let is_near = at.distance(from) <= FAR_CELLS;
            if away.norm_sq() == 0.0 || !is_near {
                break;
            }
            at = self.inside(touch + away * (self.reach * MORE / away.norm()));
        }
        let [one, other] = touched;
        let is_closed = |gap: &(Point, Point)| gap.0.distance(gap.1) < 2.0 * self.reach;
        let gap = one.zip(other).filter(is_closed).map(|(one, other)| [one, other]);
        Err(Pinch { at: from, gap })
    }

    /// The nearest point that keeps the clearance to the map's border.
    fn inside(&self, at: Point) -> Point {
        let frame = self.clearance.frame();
        let within = |x: f64, size: u32| {
            let most = f64::from(size) - self.reach * MORE;
            x.max(self.reach * MORE).min(most)
        };
        Point::new(within(at.x, frame.width()), within(at.y, frame.height()))
    }
}

/// Points along a path of cells, from centre to centre.
fn spaced(cells: &[Cell]) -> impl Iterator<Item = Point> {
    let centre = |cell: Cell| Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
    let first = cells.first().map(|&cell| centre(cell));
    let between = cells.windows(2).flat_map(move |pair| {
        let (from, to) = (centre(pair[0]), centre(pair[1]));
        let parts = (from.distance(to) / SPACING_CELLS).ceil().max(1.0);
        (1..=parts as u32).map(move |part| from.lerp(to, f64::from(part) / parts))
    });
    first.into_iter().chain(between)
}
