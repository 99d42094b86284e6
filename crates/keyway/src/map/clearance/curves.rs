//! Exact distances from arcs to the nearest obstacle square, and all clearance queries on the
//! pieces of a path. Arcs are measured square by square in closed form.

use crate::geometry::{Arc, Path, PathPiece, Point, Segment, Square};
use crate::map::Clearance;
use crate::map::clearance::TOUCH_TOLERANCE_CELLS;
use crate::map::layers::dilation::CLEARANCE_TOLERANCE;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_8, TAU};

/// Lower and upper bound of the smallest distance of a curve from the obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ClearanceBounds {
    /// No point of the curve is nearer than this \[m\].
    pub at_least_m: f64,
    /// At least one point of the curve is as near as this \[m\].
    pub at_most_m: f64,
}

impl ClearanceBounds {
    const fn exactly(distance_m: f64) -> Self {
        Self { at_least_m: distance_m, at_most_m: distance_m }
    }
}

impl Clearance<'_> {
    /// Distance from an arc to the nearest obstacle square \[m\]; `reach_m` if none is nearer
    /// than that. Exact up to rounding. Costs a scan of the cells near the arc.
    pub fn of_arc(&self, arc: Arc, reach_m: f64) -> f64 {
        let near_m = self.of_point(arc.start(), reach_m);
        let reach = near_m / self.frame.resolution_m();
        let mut nearest = reach;
        for part in short_parts(self.arc_to_grid(arc)) {
            let part = ShortArc::new(part);
            self.scan(part.chord, nearest + part.sagitta, |square| {
                if !part.is_beyond(square, nearest) {
                    nearest = nearest.min(part.arc.distance_to_square(square));
                }
                nearest > 0.0
            });
        }
        self.within_m(nearest, (reach, near_m))
    }

    /// True when the arc stays inside the map and keeps `clearance_m` from every obstacle square.
    /// For a clearance of 0 the same holds as in [`Self::is_clear`]: the arc may touch a square,
    /// but neither enter one nor slip between two that share a corner.
    pub fn is_clear_arc(&self, arc: Arc, clearance_m: f64) -> bool {
        let grid = self.arc_to_grid(arc);
        let margin = self.margin(clearance_m).max(0.0);
        if grid.sagitta() <= TOUCH_TOLERANCE_CELLS {
            let is_clear = self.is_clear(chord(&arc), clearance_m);
            // The chord is nearer to the obstacle inside the bend, which matters for a tiny
            // clearance.
            if is_clear || margin == 0.0 {
                return is_clear;
            }
        }
        if !grid.extremes().all(|point| self.is_inside(point, margin)) {
            return false;
        }
        short_parts(grid).all(|part| {
            let part = ShortArc::new(part);
            let is_clear_of = |square: Square| {
                if part.is_beyond(square, margin) {
                    true
                } else if margin > 0.0 {
                    part.arc.distance_to_square(square) >= margin
                } else {
                    !enters(&part.arc, square) && !self.arc_slips_past(&part.arc, square)
                }
            };
            self.scan(part.chord, margin + part.sagitta, is_clear_of)
        })
    }

    /// Bounds of the distance from a piece of a path to the nearest obstacle square, at most
    /// `tolerance_m` apart (but not less than a millionth of a cell). Both are capped at
    /// `reach_m`, and equal it if no obstacle is nearer than `reach_m` + `tolerance_m`. Segments
    /// and arcs are exact.
    ///
    /// A cubic of size h costs up to about sqrt(h / tolerance) exact segment distances if all of
    /// it is equally far from obstacles, and about ten if a single point is the nearest.
    pub fn of_curve(&self, piece: &PathPiece, reach_m: f64, tolerance_m: f64) -> ClearanceBounds {
        match piece {
            PathPiece::Segment(segment) => {
                ClearanceBounds::exactly(self.of_segment(*segment, reach_m))
            }
            PathPiece::Arc(arc) => ClearanceBounds::exactly(self.of_arc(*arc, reach_m)),
            PathPiece::Cubic(cubic) => self.of_cubic(*cubic, reach_m, tolerance_m),
        }
    }

    /// Bounds of the distance from a path to the nearest obstacle square, as for
    /// [`Self::of_curve`]; `None` if the map has no obstacle or the path no piece.
    pub fn of_path(&self, path: &Path, tolerance_m: f64) -> Option<ClearanceBounds> {
        let first = path.pieces().first()?;
        let mut bounds = ClearanceBounds::exactly(self.of_point(first.start(), f64::INFINITY));
        for piece in path.pieces() {
            let next = self.of_curve(piece, bounds.at_most_m, tolerance_m);
            bounds.at_least_m = bounds.at_least_m.min(next.at_least_m);
            bounds.at_most_m = next.at_most_m;
        }
        bounds.at_most_m.is_finite().then_some(bounds)
    }

    /// True if a piece of a path certainly stays inside the map and keeps `clearance_m` from
    /// every obstacle square; see [`Self::is_clear`] and [`Self::is_clear_arc`] for segments and
    /// arcs.
    ///
    /// A cubic may be refused if it keeps the clearance by less than a millionth of a cell, or if
    /// it is bent and touches an obstacle at a clearance of 0. A cubic that violates the
    /// clearance is never accepted.
    pub fn is_clear_curve(&self, piece: &PathPiece, clearance_m: f64) -> bool {
        match piece {
            PathPiece::Segment(segment) => self.is_clear(*segment, clearance_m),
            PathPiece::Arc(arc) => self.is_clear_arc(*arc, clearance_m),
            PathPiece::Cubic(cubic) => self.is_clear_cubic(*cubic, clearance_m),
        }
    }

    /// True if a piece of a path is certainly nowhere nearer to an obstacle than a distance;
    /// false does not mean that it is nearer. Costs one scan of the cells near it.
    pub(crate) fn certainly_keeps(&self, piece: &PathPiece, distance_m: f64) -> bool {
        let (chord, deviation_m) = match piece {
            PathPiece::Segment(segment) => (*segment, 0.0),
            PathPiece::Arc(arc) => (chord(arc), arc.sagitta()),
            PathPiece::Cubic(cubic) => (cubic.chord(), cubic.deviation()),
        };
        // With slack for rounding.
        let within_m = distance_m + deviation_m * (1.0 + CLEARANCE_TOLERANCE);
        self.obstacle_within(chord, within_m).is_none()
    }

    /// True if [`Self::is_clear_curve`] holds for all pieces of a path.
    pub fn is_clear_path(&self, path: &Path, clearance_m: f64) -> bool {
        path.pieces().iter().all(|piece| self.is_clear_curve(piece, clearance_m))
    }

    /// Distance from a piece of a path to the map's border \[m\]; negative outside the map. For a
    /// cubic it is a certified lower bound, at most `tolerance_m` less than the true distance.
    pub(crate) fn curve_to_border(&self, piece: &PathPiece, tolerance_m: f64) -> f64 {
        match piece {
            PathPiece::Segment(segment) => self.to_border(segment.a).min(self.to_border(segment.b)),
            PathPiece::Arc(arc) => {
                let arc = self.arc_to_grid(*arc);
                let each = arc.extremes().map(|at| self.grid_to_border(at));
                each.fold(f64::INFINITY, f64::min) * self.frame.resolution_m()
            }
            PathPiece::Cubic(cubic) => self.cubic_to_border(*cubic, tolerance_m, 0),
        }
    }

    /// The arc in grid coordinates \[cells\], of no more than a whole turn.
    fn arc_to_grid(&self, arc: Arc) -> Arc {
        Arc {
            centre: self.frame.grid_from_world(arc.centre),
            radius: arc.radius / self.frame.resolution_m(),
            start_rad: arc.start_rad - self.frame.origin().theta,
            sweep_rad: arc.sweep_rad.clamp(-TAU, TAU),
        }
    }

    /// True if an arc that touches a corner of `touched` runs between it and the obstacle square
    /// diagonally across. (Between two squares that share an edge no arc fits: it is straight or
    /// enters one of them.)
    fn arc_slips_past(&self, arc: &Arc, touched: Square) -> bool {
        let centre = touched.corner + Point::new(0.5, 0.5);
        touched.corners().into_iter().any(|corner| {
            // The point opposite the centre, at the same distance beyond the corner.
            let across = corner + (corner - centre);
            arc.distance_to_point(corner) <= TOUCH_TOLERANCE_CELLS && self.is_obstacle(across)
        })
    }
}

/// Part of an arc, with its chord and its sagitta.
struct ShortArc {
    arc: Arc,
    chord: Segment,
    sagitta: f64,
}

impl ShortArc {
    fn new(arc: Arc) -> Self {
        Self { arc, chord: chord(&arc), sagitta: arc.sagitta() }
    }

    /// True if a square is certainly farther than `distance`. The distance from the chord, which
    /// needs no trigonometry, decides this for most squares.
    fn is_beyond(&self, square: Square, distance: f64) -> bool {
        let limit = distance + self.sagitta + TOUCH_TOLERANCE_CELLS;
        self.chord.distance_sq_to_square(square) > limit * limit
    }
}

/// Splits the arc into parts of at most an eighth of a half turn: each is close to its chord,
/// along which the scan runs.
fn short_parts(arc: Arc) -> impl Iterator<Item = Arc> {
    let parts = (arc.sweep_rad.abs() / FRAC_PI_8).ceil().max(1.0) as u32;
    let fraction = move |part: u32| f64::from(part) / f64::from(parts);
    (0..parts).map(move |part| arc.part(fraction(part), fraction(part + 1)))
}

fn chord(arc: &Arc) -> Segment {
    Segment::new(arc.start(), arc.end())
}

/// True if the arc enters the square's interior by more than the tolerance.
fn enters(arc: &Arc, square: Square) -> bool {
    // The test of the unit square, on coordinates scaled to map the shrunk square onto it.
    let shrunk = 1.0 - 2.0 * TOUCH_TOLERANCE_CELLS;
    let inner = square.corner + Point::new(TOUCH_TOLERANCE_CELLS, TOUCH_TOLERANCE_CELLS);
    let centre = (arc.centre - inner) * (1.0 / shrunk);
    Arc { centre, radius: arc.radius / shrunk, ..*arc }.meets(Square { corner: Point::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cubic, Pose};
    use crate::map::{GridFrame, OccupancyGrid};
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn grid(rows: &[&str]) -> OccupancyGrid {
        OccupancyGrid::from_ascii(rows)
    }

    fn clearance(grid: &OccupancyGrid) -> Clearance<'_> {
        Clearance::new(grid.frame(), grid.occupied())
    }

    fn is_clear_arc(grid: &OccupancyGrid, arc: Arc, clearance_m: f64) -> bool {
        let clear = clearance(grid).is_clear_arc(arc, clearance_m);
        assert_eq!(
            clear,
            clearance(grid).is_clear_arc(arc.reversed(), clearance_m),
            "direction matters"
        );
        clear
    }

    #[test]
    fn a_short_arc_keeps_a_tiny_radius() {
        // Around the corner (1, 1) of an obstacle, its chord nearer to it by 2e-10.
        let grid = grid(&["...", "...", "#.."]);
        let arc = Arc::new(Point::new(1.0, 1.0), 6e-4, 0.8, 1.7e-3);
        assert!(arc.sagitta() > 1e-10 && arc.sagitta() < 1e-9);
        assert!(is_clear_arc(&grid, arc, 6e-4) && !is_clear_arc(&grid, arc, 6.1e-4));
    }

    #[test]
    fn arcs_by_hand() {
        // The square (2, 2) - (3, 3). A quarter circle of radius 1 around (1, 1), from (2, 1) to
        // (1, 2), is nearest to the corner (2, 2): sqrt(2) - 1. The half circle on the other side,
        // from (1, 2) over (0, 1) to (1, 0), is nearest at its beginning, 1 m away.
        let grid = grid(&[".....", ".....", "..#..", ".....", "....."]);
        let near = Arc::new(Point::new(1.0, 1.0), 1.0, 0.0, FRAC_PI_2);
        assert!((clearance(&grid).of_arc(near, 9.0) - (2f64.sqrt() - 1.0)).abs() < 1e-12);
        assert!(is_clear_arc(&grid, near, 0.414) && !is_clear_arc(&grid, near, 0.415));
        let far = Arc::new(Point::new(1.0, 1.0), 1.0, FRAC_PI_2, PI);
        assert!((clearance(&grid).of_arc(far, f64::INFINITY) - 1.0).abs() < 1e-12);
        assert_eq!(clearance(&grid).of_arc(far, 0.25), 0.25, "nothing within reach");
        // It touches the map's border at (0, 1).
        assert!(is_clear_arc(&grid, far, 0.0) && !is_clear_arc(&grid, far, 0.1));
        let around = Arc::new(Point::new(2.5, 2.5), 2.0, 0.0, TAU);
        assert!((clearance(&grid).of_arc(around, 9.0) - (2.0 - 0.5f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn an_arc_may_touch_but_not_enter_nor_slip_between() {
        let one = grid(&["...", ".#.", "..."]);
        // Around the square's corners, through them, and with the square's edge as a tangent.
        let circumscribed = Arc::new(Point::new(1.5, 1.5), 0.5f64.sqrt(), 0.0, TAU);
        assert!(is_clear_arc(&one, circumscribed, 0.0));
        assert!(!is_clear_arc(&one, Arc { radius: 0.7, ..circumscribed }, 0.0));
        let touching = Arc::new(Point::new(1.5, 2.5), 0.5, 0.0, TAU);
        assert!(is_clear_arc(&one, touching, 0.0) && !is_clear_arc(&one, touching, 0.01));
        let two = grid(&["..#", ".#.", "..."]);
        assert!(!is_clear_arc(&two, circumscribed, 0.0), "between them at (2, 2)");
        // Almost straight, along the joint of a wall, and a point.
        let wall = grid(&["...", ".#.", ".#."]);
        let straight = Arc::new(Point::new(1.5, 1.0 - 1e12), 1e12, FRAC_PI_2 - 5e-13, 1e-12);
        assert!(!is_clear_arc(&wall, straight, 0.0));
        assert!(is_clear_arc(&wall, Arc::new(Point::new(0.5, 0.5), 0.0, 0.0, 1.0), 0.5));
    }

    #[test]
    fn a_spline_around_a_corner_by_hand() {
        // Control points (0, 1), (6, 1), (6, 7), (0, 7): from (5, 2) to (5, 6), over (5.75, 4). The
        // wall begins at x = 7: 1.25 m from there.
        let free = "........";
        let grid = grid(&[free, free, free, ".......#", ".......#", free, free, free]);
        let points = [[0.0, 1.0], [6.0, 1.0], [6.0, 7.0], [0.0, 7.0]].map(Point::from);
        let piece = PathPiece::Cubic(Cubic::uniform_b_spline(points));
        for tolerance_m in [0.5, 0.01, 1e-6] {
            let bounds = clearance(&grid).of_curve(&piece, f64::INFINITY, tolerance_m);
            assert!(bounds.at_least_m <= 1.25 + 1e-9 && bounds.at_most_m >= 1.25 - 1e-9);
            assert!(bounds.at_most_m - bounds.at_least_m <= tolerance_m);
        }
        assert!(clearance(&grid).is_clear_curve(&piece, 1.2499));
        assert!(!clearance(&grid).is_clear_curve(&piece, 1.2501), "nearer than that");
        assert!(!clearance(&grid).is_clear_curve(&piece, 1.25 + 1e-6), "by a little");
        // Split at its nearest point, so that a leg of either half lies along the limit.
        assert!(clearance(&grid).is_clear_curve(&piece, 1.25));
    }

    #[test]
    fn straight_cubics_are_judged_as_segments() {
        let one = grid(&["...", ".#.", "..."]);
        let along = |y: f64| {
            let at = |x: f64| Point::new(x, y);
            PathPiece::Cubic(Cubic::bezier([at(0.5), at(1.0), at(2.0), at(2.5)]))
        };
        assert!(clearance(&one).is_clear_curve(&along(2.0), 0.0), "along the edge");
        assert!(!clearance(&one).is_clear_curve(&along(1.9), 0.0));
        assert!(clearance(&one).is_clear_curve(&along(2.5), 0.5));
        let bounds = clearance(&one).of_curve(&along(2.5), 9.0, 0.0);
        assert!(bounds.at_most_m - bounds.at_least_m < 1e-6 && bounds.at_most_m == 0.5);
    }

    #[test]
    fn nothing_to_measure() {
        let (empty, one) = (grid(&["...", "..."]), grid(&["#..", "..."]));
        let path = Path::new(vec![PathPiece::Segment(Segment::new(
            Point::new(0.5, 0.5),
            Point::new(2.5, 0.5),
        ))]);
        assert_eq!(clearance(&empty).of_path(&path.unwrap(), 0.01), None);
        assert_eq!(clearance(&one).of_path(&Path::default(), 0.01), None);
        let lost = Point::new(f64::NAN, 0.5);
        let arc = Arc::new(lost, f64::INFINITY, f64::NAN, f64::INFINITY);
        let cubic = PathPiece::Cubic(Cubic::bezier([lost; 4]));
        assert!(clearance(&one).of_arc(arc, 1.0) == 0.0 && !clearance(&one).is_clear_arc(arc, 0.1));
        assert_eq!(clearance(&one).of_curve(&cubic, 1.0, 0.1).at_least_m, 0.0);
        assert!(!clearance(&one).is_clear_curve(&cubic, 0.1));
    }

    /// Random obstacles on a turned grid of 0.1 m cells, and the smallest distance of world points.
    fn scattered(occupied: &[bool], yaw: f64) -> (OccupancyGrid, impl Fn(Point) -> f64) {
        let frame = GridFrame::new(30, 20, 0.1, Pose::new(1.0, -2.0, yaw)).unwrap();
        let grid = OccupancyGrid::from_occupied(frame, occupied);
        let corners = frame.cells().filter(|&c| grid.occupied().get(c));
        let squares: Vec<Square> = corners
            .map(|c| Square { corner: Point::new(f64::from(c.x), f64::from(c.y)) })
            .collect();
        let nearest = move |at: Point| {
            let at = frame.grid_from_world(at);
            squares.iter().map(|s| s.distance_sq_to_point(at)).fold(f64::INFINITY, f64::min).sqrt()
                * 0.1
        };
        (grid, nearest)
    }

    prop_compose! {
        fn world()(x in -1.0..4.0f64, y in -1.0..3.0f64) -> [f64; 2] { [x, y] }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn arcs_agree_with_dense_sampling(occupied in prop::collection::vec(prop::bool::weighted(0.03), 600),
                                          yaw in -3.0..3.0f64, centre in world(), radius in 0.0..2.0f64,
                                          start in -4.0..4.0f64, sweep in -TAU..TAU, keep in 0.001..0.3f64) {
            let (grid, nearest) = scattered(&occupied, yaw);
            let arc = Arc::new(grid.frame().world_from_grid(Point::from(centre) * 10.0), radius, start, sweep);
            let points: Vec<Point> = (0..=500).map(|i| arc.at(f64::from(i) / 500.0)).collect();
            let sampled = points.iter().map(|&p| nearest(p)).fold(f64::INFINITY, f64::min);
            let exact = clearance(&grid).of_arc(arc, f64::INFINITY);
            let error = arc.length() / 1000.0;
            prop_assert!(exact <= sampled + 1e-12 && (sampled - exact <= error + 1e-12 || exact == sampled));
            prop_assert!((clearance(&grid).of_arc(arc, keep) - exact.min(keep)).abs() < 1e-12);
            let to_border = points.iter().map(|&p| clearance(&grid).to_border(p)).fold(f64::INFINITY, f64::min);
            let bound = clearance(&grid).curve_to_border(&PathPiece::Arc(arc), 0.0);
            prop_assert!(bound <= to_border + 1e-12 && bound >= to_border - error - 1e-12);
            let is_clear = clearance(&grid).is_clear_arc(arc, keep);
            if is_clear {
                prop_assert!(exact >= keep - 1e-9 && to_border >= keep - 1e-9);
            } else {
                prop_assert!(exact < keep || to_border < keep + error);
            }
        }

        #[test]
        fn bounds_of_curves_are_certain(occupied in prop::collection::vec(prop::bool::weighted(0.03), 600),
                                        yaw in -3.0..3.0f64, control in prop::array::uniform4(world()),
                                        tolerance in 1e-5..0.1f64, reach in 0.0..1.0f64, keep in 0.0..0.3f64) {
            let (grid, nearest) = scattered(&occupied, yaw);
            let control = control.map(|p| grid.frame().world_from_grid(Point::from(p) * 10.0));
            let cubic = Cubic::uniform_b_spline(control);
            let piece = PathPiece::Cubic(cubic);
            let points: Vec<Point> = (0..=500).map(|i| cubic.at(f64::from(i) / 500.0)).collect();
            let sampled = points.iter().map(|&p| nearest(p)).fold(f64::INFINITY, f64::min);
            // Between two samples the curve turns away by half a step of at most the largest speed.
            let fastest = cubic.legs.iter().map(|l| l.norm()).fold(0.0, f64::max) * 3.0;
            let error = fastest / 1000.0;
            let bounds = clearance(&grid).of_curve(&piece, f64::INFINITY, tolerance);
            prop_assert!(bounds.at_least_m <= sampled + 1e-12, "the lower bound lies above a sample");
            prop_assert!(bounds.at_most_m >= sampled - error - 1e-12, "the upper bound lies below the curve");
            prop_assert!(bounds.at_most_m <= bounds.at_least_m + tolerance + 1e-12);
            let near = clearance(&grid).of_curve(&piece, reach, tolerance);
            prop_assert!(near.at_least_m <= sampled.min(reach) + 1e-12 && near.at_most_m <= reach + 1e-12);
            prop_assert!(near.at_most_m >= (sampled - error).min(reach) - 1e-12);
            let to_border = points.iter().map(|&p| clearance(&grid).to_border(p)).fold(f64::INFINITY, f64::min);
            let bound = clearance(&grid).curve_to_border(&piece, tolerance);
            prop_assert!(bound <= to_border + 1e-12 && bound >= to_border - error - tolerance - 1e-12);
            let room = sampled.min(to_border);
            let is_clear = clearance(&grid).is_clear_curve(&piece, keep);
            prop_assert!(!is_clear || room >= keep - 1e-9, "certified, but only {room} from something");
            prop_assert!(is_clear || room < keep + error + 1e-6, "refused, with room");
        }
    }
}
