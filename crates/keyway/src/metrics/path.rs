//! What is measured of a planned line.

use crate::geometry::Polyline;
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// Measures of a chain of straight segments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathMetrics {
    /// Sum of the segments' lengths \[m\].
    pub length_m: f64,
    /// Points of the path as planned, before collinear ones are merged; for a path of cells, its
    /// cells.
    pub points: usize,
    /// Points among them that change nothing: repeated, or inside a straight stretch.
    pub redundant_points: usize,
    /// Interior points at which the heading changes.
    pub turns: usize,
    /// Sum of the absolute heading changes \[deg\].
    pub turning_angle_deg: f64,
    /// Points at which the heading jumps: on straight segments, every turn.
    pub non_smooth_turns: usize,
    /// Smallest distance from the line to an obstacle cell's square \[m\], 0 where it touches one;
    /// `None` without obstacles or without points.
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
}

/// Number of points at which a line's heading changes by more than `threshold_rad`.
///
/// For straight segments every change is a jump (threshold 0). A curve is given by its samples, 1 cm
/// apart, and a jump is a change of more than 5 degrees.
pub fn count_heading_jumps(line: &Polyline, threshold_rad: f64) -> usize {
    line.turns_rad().iter().filter(|turn| turn.abs() > threshold_rad).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::map::OccupancyGrid;
    use std::f64::consts::FRAC_PI_2;

    fn measure(points: &[[f64; 2]], rows: &[&str]) -> PathMetrics {
        let grid = OccupancyGrid::from_ascii(rows);
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        PathMetrics::of_polyline(&line, Clearance::new(grid.frame(), grid.occupied()))
    }

    #[test]
    fn a_path_of_cells_by_hand() {
        // Right twice, diagonally twice, up once; the obstacle's corner (2, 1) is touched.
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
