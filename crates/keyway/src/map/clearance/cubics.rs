//! Certified distances from cubic curves to the nearest obstacle square.
//!
//! The distance from a cubic curve has no closed form, so the curve is halved until its bounds
//! are tight enough. The curve and its chord deviate from each other by no more than the control
//! polygon from the chord ([`Cubic::deviation`]), and the chord's distance is exact. No result
//! depends on samples alone.

use crate::geometry::{Cubic, Point, Segment, Square};
use crate::map::clearance::scan::{Around, CERTAIN_CELLS};
use crate::map::clearance::{TOUCH_TOLERANCE_CELLS, enters};
use crate::map::layers::dilation::CLEARANCE_TOLERANCE;
use crate::map::{Clearance, ClearanceBounds};
use std::ops::Range;

/// Smallest tolerance of distances from a curve \[cells\].
const CURVE_TOLERANCE_CELLS: f64 = 1e-6;

/// Number of halvings after which a curve is given up: only coordinates too large to be
/// distinguished need as many.
const MAX_HALVINGS: u32 = 20;

/// Initial capacity for the squares near a curve.
const NEAR_SQUARES: usize = 64;

impl Clearance<'_> {
    /// Bounds of the distance from a cubic to the nearest obstacle square.
    pub(in crate::map) fn of_cubic(
        &self,
        cubic: Cubic,
        reach_m: f64,
        tolerance_m: f64,
    ) -> ClearanceBounds {
        let tolerance_m = tolerance_m.max(CURVE_TOLERANCE_CELLS * self.frame.resolution_m());
        let mut at_most_m = self.of_point(cubic.end(), self.of_point(cubic.start, reach_m));
        let mut at_least_m = at_most_m;
        let resolution = self.frame.resolution_m();
        // The squares that may be near; those of a part come after those of its parent curve. All
        // others are farther from the parent than the nearest so far.
        let mut near = Vec::with_capacity(NEAR_SQUARES);
        let reach = (at_most_m + rounded_up_deviation(&cubic)) / resolution;
        self.scan(self.to_grid(cubic.chord()), reach, |square| {
            near.push(square);
            true
        });
        let mut parts = vec![(cubic, 0, 0..near.len())];
        while let Some((part, halvings, around)) = parts.pop() {
            near.truncate(around.end);
            let deviation = rounded_up_deviation(&part);
            // Squares beyond this reach cannot be nearer to the part than the nearest so far.
            let reach = (at_most_m + deviation) / resolution;
            let chord = self.to_grid(part.chord());
            let nearest_sq = push_near(&mut near, around.clone(), chord, reach);
            let around = around.end..near.len();
            if around.is_empty() {
                continue;
            }
            let from_chord = nearest_sq.sqrt() * resolution;
            at_most_m = at_most_m.min(from_chord + deviation);
            let part_at_least_m = (from_chord - deviation).max(0.0);
            if part_at_least_m >= at_most_m - tolerance_m || halvings == MAX_HALVINGS {
                at_least_m = at_least_m.min(part_at_least_m);
                continue;
            }
            let [before, after] = part.split(0.5);
            parts.extend([after, before].map(|half| (half, halvings + 1, around.clone())));
        }
        ClearanceBounds { at_least_m: at_least_m.min(at_most_m), at_most_m }
    }

    /// Certified lower bound of the distance from a cubic to the map's border. The distance is
    /// concave, so over the hull of the control polygon it is smallest at a corner.
    pub(in crate::map) fn cubic_to_border(
        &self,
        cubic: Cubic,
        tolerance_m: f64,
        halvings: u32,
    ) -> f64 {
        let second = cubic.start + cubic.legs[0];
        let [start, second, third, end] =
            [cubic.start, second, second + cubic.legs[1], cubic.end()].map(|at| self.to_border(at));
        let (of_ends, of_hull) = (start.min(end), second.min(third));
        if of_hull >= of_ends - tolerance_m || halvings == MAX_HALVINGS {
            return of_ends.min(of_hull);
        }
        let [before, after] = cubic.split(0.5);
        self.cubic_to_border(before, tolerance_m, halvings + 1).min(self.cubic_to_border(
            after,
            tolerance_m,
            halvings + 1,
        ))
    }

    /// True if two successive cubics in the triangle of two segments are certainly clear, and
    /// nowhere nearer to obstacles than these segments, or than `kept_m`, by more than twice a
    /// tolerance. False only if one is nearer by more than the tolerance.
    pub(crate) fn keep_distance_of(
        &self,
        cubics: [Cubic; 2],
        edges: [Segment; 2],
        kept_m: f64,
        tolerance_m: f64,
    ) -> bool {
        let resolution = self.frame.resolution_m();
        // Squares farther than the nearest one to the corner do not matter.
        let reach = self.of_point(edges[1].a, kept_m) / resolution;
        let edges = edges.map(|edge| self.to_grid(edge));
        let base = Segment::new(edges[0].a, edges[1].b);
        let height = base.distance_sq_to_point(edges[1].a).sqrt();
        let mut near = Vec::with_capacity(NEAR_SQUARES);
        self.scan(base, reach + height, |square| {
            near.push(square);
            true
        });
        let mut nearest_sq = reach * reach;
        for edge in edges {
            // Squares along a wall are all equally far.
            let nearer = |nearest_sq: f64| {
                Around::new(edge, nearest_sq.sqrt() * (1.0 - CLEARANCE_TOLERANCE))
            };
            let mut around = nearer(nearest_sq);
            for &square in &near {
                if !around.excludes(square) {
                    nearest_sq = nearest_sq.min(edge.distance_sq_to_square(square));
                    around = nearer(nearest_sq);
                }
            }
        }
        let tolerance = tolerance_m / resolution;
        let distance = nearest_sq.sqrt() - 2.0 * tolerance;
        let all = 0..near.len();
        let mut judge = Judge {
            clearance: self,
            distance,
            is_border_kept: false,
            is_hull_judged: false,
            known: 0.5 * tolerance,
            near,
        };
        cubics.into_iter().all(|cubic| {
            let keeps =
                distance <= 0.0 || judge.is_clear(&self.cubic_to_grid(cubic), all.clone(), 0);
            // A curve that keeps a positive distance touches no obstacle.
            let is_clear = distance > tolerance && self.is_hull_on_map(cubic);
            keeps && (is_clear || self.is_clear_cubic(cubic, 0.0))
        })
    }

    /// True if a cubic certainly stays inside the map, because its control points do.
    fn is_hull_on_map(&self, cubic: Cubic) -> bool {
        let second = cubic.start + cubic.legs[0];
        let corners = [cubic.start, second, second + cubic.legs[1], cubic.end()];
        corners.iter().all(|&at| self.is_inside(self.frame.grid_from_world(at), 0.0))
    }

    /// True if a cubic is certainly clear, see [`Self::is_clear_curve`].
    pub(in crate::map) fn is_clear_cubic(&self, cubic: Cubic, clearance_m: f64) -> bool {
        Judge {
            clearance: self,
            distance: self.margin(clearance_m).max(0.0),
            is_border_kept: true,
            is_hull_judged: true,
            known: CURVE_TOLERANCE_CELLS,
            near: Vec::with_capacity(NEAR_SQUARES),
        }
        .judges_clear(self.cubic_to_grid(cubic))
    }

    /// The cubic in grid coordinates \[cells\].
    fn cubic_to_grid(&self, cubic: Cubic) -> Cubic {
        let start = self.frame.grid_from_world(cubic.start);
        let to_grid = |leg: Point| self.frame.grid_from_world(cubic.start + leg) - start;
        Cubic { start, legs: cubic.legs.map(to_grid) }
    }
}

/// Test of a curve's distance from obstacles \[cells\].
struct Judge<'a> {
    clearance: &'a Clearance<'a>,
    /// Required distance; for 0 squares may be touched, as in [`Clearance::is_clear`].
    distance: f64,
    /// True if the distance is also required from the map's border.
    is_border_kept: bool,
    /// Selects the test of a part known well enough: by its control polygon's hull if true, else
    /// it counts as not clear.
    is_hull_judged: bool,
    /// Largest deviation of a part from its chord at which it counts as known well enough.
    known: f64,
    /// The squares that may be too near to a part; those of a part come after those of its
    /// parent.
    near: Vec<Square>,
}

/// Appends the squares of the range `some` that are nearer to a segment than a distance
/// \[cells\]; returns the smallest squared distance of all.
fn push_near(near: &mut Vec<Square>, some: Range<usize>, segment: Segment, distance: f64) -> f64 {
    let around = Around::new(segment, distance + CERTAIN_CELLS);
    let limit_sq = distance * distance;
    let mut nearest_sq = limit_sq;
    for k in some {
        let square = near[k];
        if around.excludes(square) {
            continue;
        }
        let distance_sq = segment.distance_sq_to_square(square);
        if distance_sq < limit_sq {
            near.push(square);
            nearest_sq = nearest_sq.min(distance_sq);
        }
    }
    nearest_sq
}

impl Judge<'_> {
    fn judges_clear(mut self, cubic: Cubic) -> bool {
        let reach = self.distance + rounded_up_deviation(&cubic).max(TOUCH_TOLERANCE_CELLS);
        let (clearance, near) = (self.clearance, &mut self.near);
        clearance.scan(cubic.chord(), reach, |square| {
            near.push(square);
            true
        });
        let all = 0..self.near.len();
        self.is_clear(&cubic, all, 0)
    }

    /// True if a part is clear of the squares that are near its parent curve.
    fn is_clear(&mut self, part: &Cubic, near: Range<usize>, halvings: u32) -> bool {
        let (chord, deviation) = (part.chord(), rounded_up_deviation(part));
        let is_straight = deviation <= TOUCH_TOLERANCE_CELLS;
        let needed = self.distance + if is_straight { 0.0 } else { deviation };
        let reach = needed.max(TOUCH_TOLERANCE_CELLS);
        let begin = self.near.len();
        push_near(&mut self.near, near, chord, reach);
        let near = begin..self.near.len();
        let is_clear = (self.is_on_map(&chord, needed)
            && (near.is_empty() || is_straight && self.is_clear_of(near.clone(), &[chord])))
            || self.is_clear_in_parts(part, near, deviation, halvings);
        self.near.truncate(begin);
        is_clear
    }

    fn is_clear_in_parts(
        &mut self,
        part: &Cubic,
        near: Range<usize>,
        deviation: f64,
        halvings: u32,
    ) -> bool {
        if deviation <= self.known {
            return self.is_hull_judged && self.is_clear_hull(part, near);
        }
        if halvings == MAX_HALVINGS || !self.is_clear_point(part.end(), near.clone()) {
            return false;
        }
        let [before, after] = part.split(0.5);
        self.is_clear(&before, near.clone(), halvings + 1)
            && self.is_clear(&after, near, halvings + 1)
    }

    /// True if the hull of a thin curve's control polygon keeps the distance. It decides for a
    /// curve that leaves a line which only just keeps the distance.
    ///
    /// The hull is thinner than any square, so its point nearest to a square lies on its border,
    /// and that border consists of lines between the corners.
    fn is_clear_hull(&self, part: &Cubic, near: Range<usize>) -> bool {
        let [a, b, c] = part.legs;
        let corners = [part.start, part.start + a, part.start + a + b, part.start + a + b + c];
        let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
        let connections = pairs.map(|(i, j)| Segment::new(corners[i], corners[j]));
        connections.iter().all(|connection| self.is_on_map(connection, self.distance))
            && self.is_clear_of(near, &connections)
    }

    fn is_clear_point(&self, point: Point, mut near: Range<usize>) -> bool {
        let (segment, distance_sq) = (Segment::new(point, point), self.distance * self.distance);
        let stops = |square: Square| {
            if distance_sq > 0.0 {
                square.distance_sq_to_point(point) < distance_sq
            } else {
                self.stops(square, &segment)
            }
        };
        self.is_on_map(&segment, self.distance) && !near.any(|k| stops(self.near[k]))
    }

    fn is_clear_of(&self, mut near: Range<usize>, segments: &[Segment]) -> bool {
        near.all(|k| !segments.iter().any(|segment| self.stops(self.near[k], segment)))
    }

    fn stops(&self, square: Square, segment: &Segment) -> bool {
        let distance_sq = self.distance * self.distance;
        if distance_sq > 0.0 {
            segment.distance_sq_to_square(square) < distance_sq
        } else {
            enters(*segment, square) || self.clearance.slips_past(*segment, square)
        }
    }

    fn is_on_map(&self, segment: &Segment, margin: f64) -> bool {
        let is_inside = |point| self.clearance.is_inside(point, margin);
        !self.is_border_kept || (is_inside(segment.a) && is_inside(segment.b))
    }
}

/// The deviation with slack for rounding: certified results must not depend on rounding.
fn rounded_up_deviation(cubic: &Cubic) -> f64 {
    cubic.deviation() * (1.0 + 10.0 * CLEARANCE_TOLERANCE)
}
