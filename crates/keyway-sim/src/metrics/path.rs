//! Metrics of a planned path.

use keyway::geometry::{Path, PathPiece, PathSample, Polyline, wrap_angle};
use keyway::map::Clearance;
use serde::{Deserialize, Serialize};

/// Distance between two samples of a curve \[m\].
pub(super) const SAMPLE_M: f64 = 0.01;
/// Heading change between two samples above which the heading jumps \[deg\].
pub(super) const JUMP_DEG: f64 = 5.0;
/// Tolerance of a curve's distance to obstacles \[m\]; the distance of lines is exact.
const CLEARANCE_TOLERANCE_M: f64 = 1e-4;
/// Heading changes up to this are rounding errors \[rad\].
const STRAIGHT_RAD: f64 = 1e-9;

/// Metrics of a path: a chain of straight segments, or a path with curves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathMetrics {
    /// Sum of the segments' lengths \[m\].
    pub length_m: f64,
    /// Points of the path as planned, before collinear ones are merged; for a path of cells, its
    /// cells; for a path with curves, the ends of its pieces.
    pub points: usize,
    /// Redundant points among them: repeated points, and points inside a straight section.
    pub redundant_points: usize,
    /// Interior points at which the heading changes. On a curve, each section that bends to one
    /// side counts once.
    pub turns: usize,
    /// Sum of the absolute heading changes \[deg\].
    pub turning_angle_deg: f64,
    /// Points at which the heading jumps: every turn between straight segments; on a path with
    /// curves, changes of more than 5 degrees between samples 1 cm apart.
    pub non_smooth_turns: usize,
    /// Smallest distance from the line to an obstacle cell's square \[m\], 0 if it touches one;
    /// for a curve, a certified lower bound within 0.1 mm. `None` without obstacles or without
    /// points.
    pub min_clearance_m: Option<f64>,
}

impl PathMetrics {
    /// Measures a line on a map (world frame). Costs a few operations per point, and a scan of the
    /// cells near the line.
    pub fn of_polyline(line: &Polyline, clearance: Clearance<'_>) -> Self {
        let turns_rad = line.turns_rad();
        Self {
            length_m: line.length_m(),
            points: line.points().len(),
            redundant_points: line.points().len() - line.merged().points().len(),
            turns: turns_rad.len(),
            turning_angle_deg: turns_rad
                .iter()
                .fold(0.0, |sum, turn| sum + turn.abs().to_degrees()),
            non_smooth_turns: count_heading_jumps(line, 0.0),
            min_clearance_m: clearance.of_line(line),
        }
    }

    /// Measures a path on a map (world frame); a path of straight segments like
    /// [`Self::of_polyline`].
    ///
    /// A curve is sampled every centimetre for its turns, and measured by certified bounds for its
    /// clearance.
    pub fn of_path(path: &Path, clearance: Clearance<'_>) -> Self {
        let is_straight = |piece: &PathPiece| matches!(piece, PathPiece::Segment(_));
        let ends = path.flattened(0.0);
        if path.pieces().iter().all(is_straight) {
            return Self::of_polyline(&ends, clearance);
        }
        let samples = path.samples_of_pieces(SAMPLE_M);
        let jumps = heading_changes(&path.samples(SAMPLE_M));
        Self {
            length_m: path.length_m(),
            points: ends.points().len(),
            redundant_points: path
                .pieces()
                .windows(2)
                .filter(|pair| goes_straight_on(pair))
                .count(),
            turns: count_bends(&samples),
            turning_angle_deg: heading_changes(&samples)
                .iter()
                .map(|change| change.abs().to_degrees())
                .sum(),
            non_smooth_turns: jumps
                .iter()
                .filter(|jump| jump.abs() > JUMP_DEG.to_radians())
                .count(),
            min_clearance_m: clearance
                .of_path(path, CLEARANCE_TOLERANCE_M)
                .map(|bounds| bounds.at_least_m.max(0.0)),
        }
    }
}

/// Heading changes from each sample to the next \[rad\].
fn heading_changes(samples: &[PathSample]) -> Vec<f64> {
    samples.windows(2).map(heading_change).collect()
}

fn heading_change(pair: &[PathSample]) -> f64 {
    wrap_angle(pair[1].heading_rad - pair[0].heading_rad)
}

/// Number of sections of samples that turn to the same side. The two samples at a joint of pieces
/// coincide: if the heading does not jump there, the bend continues.
fn count_bends(samples: &[PathSample]) -> usize {
    let is_driven_or_jump = |pair: &&[PathSample]| {
        pair[1].s_m > pair[0].s_m || heading_change(pair).abs() > STRAIGHT_RAD
    };
    let changes_rad: Vec<f64> =
        samples.windows(2).filter(is_driven_or_jump).map(heading_change).collect();
    let side = |change: &f64| if change.abs() <= STRAIGHT_RAD { 0.0 } else { change.signum() };
    let sides: Vec<f64> = changes_rad.iter().map(side).collect();
    let begins = |i: &usize| sides[*i] != 0.0 && (*i == 0 || sides[i - 1] != sides[*i]);
    (0..sides.len()).filter(begins).count()
}

/// True if two segments form one straight segment.
fn goes_straight_on(pair: &[PathPiece]) -> bool {
    match pair {
        [PathPiece::Segment(before), PathPiece::Segment(after)] => {
            Polyline::new(vec![before.a, after.a, after.b]).turns_rad().is_empty()
        }
        _ => false,
    }
}

/// Number of points at which a line's heading changes by more than `threshold_rad`.
///
/// For straight segments, every change is a jump (threshold 0). A curve is given by its samples, 1
/// cm apart, and a jump is a change of more than 5 degrees.
fn count_heading_jumps(line: &Polyline, threshold_rad: f64) -> usize {
    line.turns_rad().iter().filter(|turn| turn.abs() > threshold_rad).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::{Arc, Cubic, Point, Segment};
    use keyway::map::OccupancyGrid;
    use std::f64::consts::FRAC_PI_2;

    fn measure(points: &[[f64; 2]], rows: &[&str]) -> PathMetrics {
        let grid = OccupancyGrid::from_ascii(rows);
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        PathMetrics::of_polyline(&line, Clearance::new(grid.frame(), grid.occupied()))
    }

    #[test]
    fn a_path_of_cells_by_hand() {
        // Two steps to the right, two diagonal ones, one up; the line touches the obstacle's
        // corner (3, 1).
        let cells = [[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [3.5, 1.5], [4.5, 2.5], [4.5, 3.5]];
        let metrics = measure(&cells, &[".....", ".....", "..#..", "....."]);
        assert!((metrics.length_m - (3.0 + 2.0 * 2f64.sqrt())).abs() < 1e-12);
        assert_eq!((metrics.points, metrics.redundant_points), (6, 2));
        assert_eq!((metrics.turns, metrics.non_smooth_turns), (2, 2));
        assert!((metrics.turning_angle_deg - 90.0).abs() < 1e-9);
        // The diagonal x - y = 2 touches the corner (3, 1) of the obstacle (2, 1).
        assert!(metrics.min_clearance_m.unwrap().abs() < 1e-12);
    }

    #[test]
    fn left_and_right_add_up_and_a_reversal_is_a_turn() {
        let zigzag = [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [2.5, 1.5], [1.5, 1.5]];
        let metrics = measure(&zigzag, &["....", "...#", "...."]);
        assert_eq!((metrics.turns, metrics.redundant_points), (3, 0));
        assert!((metrics.turning_angle_deg - 360.0).abs() < 1e-9);
        assert_eq!(metrics.min_clearance_m, Some(0.5));
    }

    #[test]
    fn next_to_nothing() {
        let empty = measure(&[], &["..#"]);
        assert_eq!((empty.length_m, empty.points, empty.min_clearance_m), (0.0, 0, None));
        let repeated = measure(&[[0.5, 0.5], [0.5, 0.5]], &["..#"]);
        assert_eq!((repeated.points, repeated.redundant_points, repeated.turns), (2, 1, 0));
        assert_eq!(repeated.min_clearance_m, Some(1.5));
        assert_eq!(measure(&[[0.5, 0.5], [1.5, 0.5]], &["..."]).min_clearance_m, None);
    }

    /// One metre ahead, a left turn of 1 m radius, a right turn of a third of that angle, and a
    /// corner of 90 degrees to the left, followed by 2 m in two parts.
    #[test]
    fn a_path_with_curves_by_hand() {
        let (quarter, twelfth) = (FRAC_PI_2, FRAC_PI_2 / 3.0);
        // Two pieces that form one turn.
        let left = |from| Arc::new(Point::new(2.0, 2.0), 1.0, from, 0.5 * quarter);
        let right = Arc::new(Point::new(4.0, 2.0), 1.0, std::f64::consts::PI, -twelfth);
        let end = right.end();
        let heading = right.heading_at(1.0) + quarter;
        let away = Point::new(libm::cos(heading), libm::sin(heading));
        let path = Path::new(vec![
            PathPiece::Segment(Segment::new(Point::new(1.0, 1.0), Point::new(2.0, 1.0))),
            PathPiece::Arc(left(-quarter)),
            PathPiece::Arc(left(-0.5 * quarter)),
            PathPiece::Arc(right),
            PathPiece::Segment(Segment::new(end, end + away)),
            PathPiece::Segment(Segment::new(end + away, end + away * 2.0)),
        ])
        .unwrap();
        // The corner (4, 1) of the obstacle is sqrt(5) from the left arc's centre (2, 2), and the
        // arc crosses the line between them.
        let rows = ["......", "......", "......", "......", "....#."];
        let grid = OccupancyGrid::from_ascii(&rows);
        let metrics = PathMetrics::of_path(&path, Clearance::new(grid.frame(), grid.occupied()));
        assert!((metrics.length_m - (1.0 + quarter + twelfth + 2.0)).abs() < 1e-12);
        assert_eq!((metrics.points, metrics.redundant_points), (7, 1));
        assert_eq!((metrics.turns, metrics.non_smooth_turns), (3, 1));
        assert!((metrics.turning_angle_deg - 210.0).abs() < 1e-9, "{metrics:?}");
        let clearance_m = metrics.min_clearance_m.unwrap();
        assert!((clearance_m - (5f64.sqrt() - 1.0)).abs() < 1e-4, "{clearance_m}");
    }

    /// Measures a path with a curve in an empty map.
    fn measure_path(pieces: Vec<PathPiece>) -> PathMetrics {
        let grid = OccupancyGrid::from_ascii(&["...."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        PathMetrics::of_path(&Path::new(pieces).unwrap(), clearance)
    }

    #[test]
    fn a_heading_beyond_half_a_turn_is_no_jump() {
        // From up, over left (pi, then -pi), to down.
        let half = Arc::new(Point::new(2.0, 2.0), 1.0, 0.0, std::f64::consts::PI);
        let metrics = measure_path(vec![PathPiece::Arc(half)]);
        assert_eq!((metrics.turns, metrics.non_smooth_turns), (1, 0));
        assert!((metrics.turning_angle_deg - 180.0).abs() < 1e-9, "{metrics:?}");
    }

    #[test]
    fn rounded_headings_are_no_turns() {
        // A cubic along (1, 3) whose control legs differ by rounding.
        let at = |k: f64| Point::new(k * 0.1, k * 0.3);
        let straight = Cubic::bezier([at(0.0), at(0.7), at(1.9), at(3.1)]);
        let metrics = measure_path(vec![PathPiece::Cubic(straight)]);
        assert_eq!((metrics.turns, metrics.non_smooth_turns), (0, 0));
        assert!(metrics.turning_angle_deg < 1e-9);
    }

    #[test]
    fn no_place_of_a_curve_is_nearer_than_what_it_keeps() {
        let grid = OccupancyGrid::from_ascii(&["......", "......", "..#...", "......", "......"]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let points = [[0.3, 0.4], [3.1, 0.9], [4.7, 2.9], [2.2, 4.6]].map(Point::from);
        let cubic = Cubic::bezier(points);
        let path = Path::new(vec![PathPiece::Cubic(cubic)]).unwrap();
        let kept_m = PathMetrics::of_path(&path, clearance).min_clearance_m.unwrap();
        let sampled_m = (0..=10_000)
            .map(|k| clearance.of_point(cubic.at(f64::from(k) * 1e-4), 9.0))
            .fold(f64::INFINITY, f64::min);
        assert!(kept_m <= sampled_m && kept_m > sampled_m - 1e-3, "{kept_m} {sampled_m}");
    }

    #[test]
    fn two_small_jumps_within_a_centimetre_are_one() {
        // Two changes of 3 degrees, 1 mm apart, between two samples.
        let ahead = |degrees: f64, metres: f64| {
            let angle = degrees.to_radians();
            Point::new(libm::cos(angle), libm::sin(angle)) * metres
        };
        let mut at = Point::new(0.0, 0.0);
        let mut step = |by: Point| {
            let from = at;
            at = at + by;
            PathPiece::Segment(Segment::new(from, at))
        };
        let mut pieces =
            vec![step(ahead(0.0, 0.103)), step(ahead(3.0, 0.001)), step(ahead(6.0, 0.1))];
        // A path with a curve is sampled.
        let arc = Arc::new(Point::new(0.0, -1.0), 1.0, FRAC_PI_2, 1e-6);
        pieces.insert(0, PathPiece::Arc(arc.reversed()));
        assert_eq!(measure_path(pieces).non_smooth_turns, 1);
    }

    #[test]
    fn straight_segments_are_a_line() {
        let rows = ["....", "..#.", "....", "...."];
        let grid = OccupancyGrid::from_ascii(&rows);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        // A corner of 3 degrees is a turn of a line, but no jump of a curve.
        let points = [[0.5, 0.5], [1.5, 0.5], [2.5, 0.55], [3.5, 2.5]];
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        let expected = PathMetrics::of_polyline(&line, clearance);
        assert_eq!(PathMetrics::of_path(&Path::from(&line), clearance), expected);
        assert_eq!(expected.non_smooth_turns, 2);
        let nothing = PathMetrics::of_path(&Path::default(), clearance);
        assert_eq!((nothing.points, nothing.turns, nothing.min_clearance_m), (0, 0, None));
    }

    #[test]
    fn jumps_of_a_sampled_curve() {
        // A quarter circle of 1 m radius turns 0.6 degrees per centimetre; a corner follows.
        let arc = (0..=157).map(|i| {
            let angle = f64::from(i) * 0.01;
            Point::new(libm::sin(angle), 1.0 - libm::cos(angle))
        });
        let mut points: Vec<Point> = arc.collect();
        let degrees_5 = 5f64.to_radians();
        assert_eq!(count_heading_jumps(&Polyline::new(points.clone()), degrees_5), 0);
        points.push(points[157] + Point::new(0.01, 0.0));
        let cornered = Polyline::new(points);
        assert_eq!(count_heading_jumps(&cornered, degrees_5), 1);
        assert_eq!(count_heading_jumps(&cornered, FRAC_PI_2), 0);
    }
}
