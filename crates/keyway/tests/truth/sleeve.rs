//! The shortest line of a homotopy class, from the whole line at once: no string is moved along
//! it, and nothing is known about corners or the sides that they bend to.
//!
//! The free plane is cut into runs, the longest rows of free cells, which meet at gates, the edges
//! that two runs share. Runs are convex and gates are straight, so two lines with the same ends
//! can be pulled into each other if and only if they pass the same gates, where passages there and
//! back again cancel. The shortest such line stays in the sleeve of these gates, and the funnel of
//! Lee and Preparata \[Lee1984\] finds it there. Exact, except for the sum of lengths.

use crate::homotopy::Half;
use keyway::geometry::Polyline;
use keyway::map::Cell;

/// The runs of a map, and the gates between them. Coordinates are half cells.
pub(crate) struct Sleeves {
    runs: Vec<Run>,
    /// The run of each cell, row by row; `None` for blocked ones.
    run_of: Vec<Option<usize>>,
    width: i64,
    /// The gates on each line between two rows, the lower border first.
    gates: Vec<Vec<Gate>>,
}

struct Run {
    left: i64,
    right: i64,
    bottom: i64,
}

/// The edge that two runs share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gate {
    y: i64,
    left: i64,
    right: i64,
    below: usize,
    above: usize,
}

/// A gate, and true if it is passed upwards.
type Passage = (Gate, bool);

impl Sleeves {
    pub(crate) fn new(width: i32, height: i32, is_blocked: impl Fn(Cell) -> bool) -> Self {
        let (mut runs, mut run_of) = (Vec::<Run>::new(), Vec::new());
        for y in 0..height {
            let mut is_open = false;
            for x in 0..width {
                let is_free = !is_blocked(Cell::new(x, y));
                let (left, right) = (2 * i64::from(x), 2 * i64::from(x) + 2);
                match runs.last_mut() {
                    Some(run) if is_free && is_open => run.right = right,
                    _ if is_free => runs.push(Run { left, right, bottom: 2 * i64::from(y) }),
                    _ => {}
                }
                is_open = is_free;
                run_of.push(is_free.then(|| runs.len() - 1));
            }
        }
        let mut sleeves = Self { runs, run_of, width: width.into(), gates: Vec::new() };
        sleeves.gates = (0..=i64::from(height)).map(|y| sleeves.gates_at(y)).collect();
        sleeves
    }

    /// The gates between the rows `y - 1` and `y`.
    fn gates_at(&self, y: i64) -> Vec<Gate> {
        let mut gates: Vec<Gate> = Vec::new();
        for x in 0..self.width {
            let cells = [(y - 1) * self.width + x, y * self.width + x];
            let [below, above] =
                cells.map(|at| self.run_of.get(usize::try_from(at).ok()?).copied()?);
            let (Some(below), Some(above)) = (below, above) else { continue };
            let left = self.runs[below].left.max(self.runs[above].left);
            let right = self.runs[below].right.min(self.runs[above].right);
            let gate = Gate { y: 2 * y, left, right, below, above };
            if gates.last() != Some(&gate) {
                gates.push(gate);
            }
        }
        gates
    }

    /// The gates that a line \[cells\] between centres of cells passes; passages there and back
    /// again cancel. `None` if it enters an obstacle, or slips between two cells that touch at a
    /// corner.
    pub(crate) fn passages(&self, line: &Polyline) -> Option<Vec<Passage>> {
        let points: Vec<Half> =
            line.points().iter().map(|&point| Half::new(point)).collect::<Option<_>>()?;
        let start = points.first()?;
        let mut run = self.run_of[(start.y / 2 * self.width + start.x / 2) as usize]?;
        let mut passages: Vec<Passage> = Vec::new();
        for pair in points.windows(2) {
            let (a, way) = (pair[0], pair[1].from(pair[0]));
            let mut last = None;
            while let Some((share, of)) = self.runs[run].leaves(a, way) {
                // Through a gate and back in one point leads out of neither run.
                if last.replace((share, of)).is_some_and(|(n, d)| n * of >= share * d) {
                    return None;
                }
                let (gate, is_up) = self.way_out(run, a, way, (share, of))?;
                run = if is_up { gate.above } else { gate.below };
                if passages.last() == Some(&(gate, !is_up)) {
                    passages.pop();
                } else {
                    passages.push((gate, is_up));
                }
            }
        }
        Some(passages)
    }

    /// The gate through which a line leaves a run after a fraction of its length.
    fn way_out(&self, run: usize, a: Half, way: Half, (share, of): (i64, i64)) -> Option<Passage> {
        let bottom = self.runs[run].bottom;
        // A line along the run's edge can only continue in the run on the other side of it.
        let is_up = if way.y == 0 { a.y > bottom } else { way.y > 0 };
        let y = if is_up { bottom + 2 } else { bottom };
        let at = (a.x * of + way.x * share, a.y * of + way.y * share);
        if at.1 != y * of {
            return None;
        }
        let is_it = |gate: &&Gate| {
            let from = if is_up { gate.below } else { gate.above };
            from == run && (gate.left * of..=gate.right * of).contains(&at.0)
        };
        self.gates[(y / 2) as usize].iter().find(is_it).map(|&gate| (gate, is_up))
    }

    /// Length \[cells\] of the shortest line that a line can be pulled into; `None` as for
    /// [`Self::passages`].
    pub(crate) fn shortest(&self, line: &Polyline) -> Option<f64> {
        let (start, goal) =
            (Half::new(*line.points().first()?)?, Half::new(*line.points().last()?)?);
        // Left and right in the direction of travel.
        let ends = |&(gate, is_up): &Passage| {
            let (left, right) =
                (Half { x: gate.left, y: gate.y }, Half { x: gate.right, y: gate.y });
            if is_up { [left, right] } else { [right, left] }
        };
        let passages = self.passages(line)?;
        let inner = passages.iter().map(ends);
        let gates: Vec<[Half; 2]> =
            std::iter::once([start; 2]).chain(inner).chain([[goal; 2]]).collect();
        let turns = funnel(&gates);
        let length = |pair: &[Half]| {
            let way = pair[1].from(pair[0]);
            (way.x as f64).hypot(way.y as f64) / 2.0
        };
        Some(turns.windows(2).map(length).sum())
    }
}

impl Run {
    /// The fraction of its length after which a line that is in the run leaves it.
    fn leaves(&self, a: Half, way: Half) -> Option<(i64, i64)> {
        let until = |from: i64, way: i64, low: i64, high: i64| match way.signum() {
            1 => Some((high - from, way)),
            -1 => Some((from - low, -way)),
            _ => None,
        };
        let sides = [
            until(a.x, way.x, self.left, self.right),
            until(a.y, way.y, self.bottom, self.bottom + 2),
        ];
        let shares = sides.into_iter().flatten().filter(|(share, of)| share < of);
        shares.min_by(|p, q| (p.0 * q.1).cmp(&(q.0 * p.1)))
    }
}

/// The turns of the shortest line through gates, each with its left and its right end.
fn funnel(gates: &[[Half; 2]]) -> Vec<Half> {
    let side_of = |apex: Half, end: Half, point: Half| end.from(apex).cross(point.from(apex));
    let mut turns = vec![gates[0][0]];
    let mut apex = gates[0][0];
    // The end points of the funnel's sides, each with its gate.
    let mut sides = [(apex, 0); 2];
    let mut next = 1;
    'gates: while next < gates.len() {
        for (side, sign) in [(0, 1), (1, -1)] {
            let (own, other) = (sides[side], sides[1 - side]);
            let end = gates[next][side];
            if sign * side_of(apex, own.0, end) > 0 {
                continue;
            }
            if own.0 != apex && sign * side_of(apex, other.0, end) <= 0 {
                // Past the other side: the line turns there, and a funnel opens behind it.
                apex = other.0;
                turns.push(apex);
                sides = [other; 2];
                next = other.1 + 1;
                continue 'gates;
            }
            sides[side] = (end, next);
        }
        next += 1;
    }
    turns.extend(gates[gates.len() - 1].first());
    turns
}

#[test]
fn shortest_lines_by_hand() {
    // A ring of cells that touch at corners, and one cell.
    let drawing = ["........", "..#.....", ".#.#..#.", "..#.....", "........"];
    let is_blocked = |cell: Cell| drawing[4 - cell.y as usize].as_bytes()[cell.x as usize] == b'#';
    let sleeves = Sleeves::new(8, 5, is_blocked);
    let shortest = |points: &[[f64; 2]]| {
        sleeves.shortest(&Polyline::new(points.iter().map(|&p| p.into()).collect()))
    };
    let is = |points: &[[f64; 2]], expected: f64| {
        let length = shortest(points).unwrap();
        assert!((length - expected).abs() < 1e-12, "{points:?}: {length}");
    };
    let root = 2f64.sqrt();
    // Both ways around the ring.
    is(&[[0.5, 2.5], [2.5, 4.5], [4.5, 2.5]], 3.0 * root + 1.0);
    is(&[[0.5, 2.5], [2.5, 0.5], [4.5, 2.5]], 3.0 * root + 1.0);
    // Over both and back; there and back.
    is(&[[0.5, 2.5], [1.0, 4.5], [7.5, 4.5], [4.5, 2.5]], 3.0 * root + 1.0);
    let over_one_corner = 6.5f64.sqrt() + 2.5f64.sqrt();
    is(&[[0.5, 4.5], [7.5, 4.5], [7.5, 0.5], [7.5, 4.5], [4.5, 3.5]], over_one_corner);
    let once_around = [
        [0.5, 2.5],
        [0.5, 4.5],
        [4.5, 4.5],
        [4.5, 0.5],
        [0.5, 0.5],
        [0.5, 4.5],
        [4.5, 4.5],
        [4.5, 2.5],
    ];
    is(&once_around, 7.0 * root + 5.0);
    is(&[[0.5, 0.5], [2.0, 1.0], [3.0, 1.0], [4.5, 0.5]], 4.0);
    // Through a gap, one between two edges, a cell, and the ring.
    for blocked in [
        &[[1.5, 1.5], [2.5, 2.5]][..],
        &[[0.5, 1.5], [1.0, 2.0], [3.0, 2.0], [4.5, 1.5]],
        &[[0.5, 1.5], [5.5, 1.5]],
        &[[0.5, 2.5], [4.5, 2.5]],
    ] {
        assert_eq!(shortest(blocked), None, "{blocked:?}");
    }
}
