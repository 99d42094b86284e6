//! Continuous curvature: a line -> a path without corners that a robot can drive at speed.
//!
//! The line is shortened by line of sight, then each corner is cut by two cubic curves
//! (`corner_blend`). Their curvature rises from 0 on one edge to a peak that is known in closed
//! form, and falls back to 0 on the other. Each cut is as long as edges, neighbours and clearance
//! allow. If no curve within the turning limit fits a corner, it stays sharp and is reported: a
//! differential drive turns in place there.
//!
//! Two corners share the edge between them. Each gets the length that the turning limit requires
//! and half of the rest, or half of the edge if it is too short for both. Then, in the order of
//! the line, each corner that no obstacle limits takes what its neighbours left over. The curve
//! itself is certified, not samples of it: [`Clearance::is_clear_curve`]. `docs/smoothers.md`
//! gives the reasons for this method and its proofs.
//!
//! # Idempotence
//! The path depends on the shortened line alone, and that cannot be shortened further: smoothing
//! it gives the same path. Points on the curves are another line: line of sight reaches farther
//! from them than from the corners, so smoothing them gives a shorter path, not the same one.
//!
//! # Errors / cost
//! [`ConfigError`]. At most 14 curve tests per corner, each a few scans of the cells near it.

use super::corner_blend::Corner;
use super::line_of_sight::line_of_sight;
use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::smoothed::count_others;
use super::{SharpCorner, Smoothed, Smoother, WhySharp};
use crate::ConfigError;
use crate::geometry::{Path, PathPiece, PlannedLine, Point, Segment};
use crate::map::Clearance;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Minimum cut \[cells\].
const SHORTEST_CUT_CELLS: f64 = 0.01;

/// Maximum share of an edge that curves use: a little stays straight between two curves, and at
/// the ends of the line.
const CURVED_SHARE: f64 = 0.999;

/// Tolerance of a cut, as a share of its range.
const CUT_TOLERANCE: f64 = 1e-3;

/// Tolerance \[cells\] of the distance that a line keeps if it does not keep the clearance.
const DISTANCE_TOLERANCE_CELLS: f64 = 1e-5;

/// Number of control points of a corner's two curves: none of them is a point of the line.
const CONTROL_POINTS: usize = 7;

/// Parameters of [`ContinuousCurvature`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ContinuousCurvatureConfig {
    /// Radius of the tightest permitted curve \[m\]; 0: no limit.
    pub min_turning_radius_m: f64,
}

impl ContinuousCurvatureConfig {
    /// The limit for a robot that need not slow down below `speed_mps` on curves, turning at its
    /// largest turn rate, and that has no larger turning radius. Its largest speed is used if that
    /// is less than `speed_mps`.
    pub fn for_robot(robot: &Robot, speed_mps: f64) -> Self {
        let speed_mps = speed_mps.min(robot.limits.v_max_mps);
        let slower_m = speed_mps / robot.limits.omega_max_radps;
        Self { min_turning_radius_m: slower_m.max(robot.limits.min_turning_radius_m) }
    }
}

/// Rounds the corners that remain after line of sight.
#[derive(Clone, Debug, Default)]
pub struct ContinuousCurvature {
    config: ContinuousCurvatureConfig,
}

impl ContinuousCurvature {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "continuous-curvature";

    /// The smoother with these parameters.
    ///
    /// # Errors
    /// [`ConfigError`] if the turning radius is not a number of at least 0.
    pub fn new(config: ContinuousCurvatureConfig) -> Result<Self, ConfigError> {
        let radius_m = config.min_turning_radius_m;
        ConfigError::unless_not_negative("min_turning_radius_m", radius_m)?;
        Ok(Self { config })
    }
}

impl SmootherParameters for ContinuousCurvatureConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(ContinuousCurvature::new(self.clone())?))
    }

    fn has_turning_limit(&self) -> bool {
        true
    }
}

impl Smoother for ContinuousCurvature {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        let short = line_of_sight(line, clearance, clearance_m).merged();
        let points = short.points();
        let rounding = Rounding::of(points, clearance, clearance_m, &self.config);
        let cuts_m = rounding.cuts_m();
        let sharp = |index: &usize| cuts_m[*index] == 0.0;
        let sharp_corners: Vec<SharpCorner> = (1..points.len().saturating_sub(1))
            .filter(sharp)
            .map(|i| rounding.why_sharp(i, &cuts_m))
            .collect();
        let passed: Vec<Point> = (0..points.len()).filter(sharp).map(|i| points[i]).collect();
        let pieces = rounding.pieces(points, &cuts_m);
        // Pieces that were certified for the clearance need no second measurement.
        let judged = pieces.iter().filter(|(_, is_certain)| !is_certain).map(|(piece, _)| piece);
        let required = RequiredClearance::new(clearance, clearance_m, 0.0);
        let kept_clearance_m =
            required.kept_clearance_m(judged, Smoothed::CLEARANCE_TOLERANCE_M, 0.0);
        // There is no path only if the coordinates are so large that rounding tears the pieces
        // apart.
        let path = Path::new(pieces.into_iter().map(|(piece, _)| piece).collect())
            .unwrap_or_else(|_| Path::from(&short));
        Smoothed {
            path,
            removed_points: count_others(line.merged().points(), &passed),
            inserted_points: CONTROL_POINTS * (points.len() - passed.len()),
            sharp_corners,
            kept_clearance_m,
        }
    }
}

/// A line whose corners are to be rounded. Each point of the line has a cut; it is 0 for the ends
/// and for a corner that stays sharp.
struct Rounding<'a> {
    clearance: &'a Clearance<'a>,
    clearance_m: f64,
    /// The corners at the inner points, from the second point on.
    corners: Vec<Corner>,
    /// True for each edge that keeps the clearance.
    is_clear: Vec<bool>,
    /// Length of each edge that curves may use.
    room_m: Vec<f64>,
    /// The shortest cut of each point within the turning limit.
    least_m: Vec<f64>,
    /// The shortest cut that is worth making.
    shortest_m: f64,
}

impl<'a> Rounding<'a> {
    fn of(
        points: &[Point],
        clearance: &'a Clearance<'a>,
        clearance_m: f64,
        config: &ContinuousCurvatureConfig,
    ) -> Self {
        let corners: Vec<Corner> =
            points.windows(3).map(|p| Corner::new([p[0], p[1], p[2]])).collect();
        let is_clear = |p: &[Point]| clearance.is_clear(Segment::new(p[0], p[1]), clearance_m);
        let is_clear = points.windows(2).map(is_clear).collect();
        let room_m = points.windows(2).map(|p| CURVED_SHARE * p[0].distance(p[1])).collect();
        let shortest_m = SHORTEST_CUT_CELLS * clearance.frame().resolution_m();
        let least =
            |corner: &Corner| corner.cut_for_radius(config.min_turning_radius_m).max(shortest_m);
        let mut least_m = vec![0.0; points.len()];
        for (least_m, corner) in least_m.iter_mut().skip(1).zip(&corners) {
            *least_m = least(corner);
        }
        Self { clearance, clearance_m, corners, is_clear, room_m, least_m, shortest_m }
    }

    /// The cut of each point.
    fn cuts_m(&self) -> Vec<f64> {
        let mut cuts_m = vec![0.0; self.least_m.len()];
        let mut has_room = vec![false; self.least_m.len()];
        for index in 1..=self.corners.len() {
            let limit_m = self.share_m(index, index - 1).min(self.share_m(index, index + 1));
            let longest_m = self.longest_cut_m(index, limit_m);
            cuts_m[index] = longest_m.unwrap_or(0.0);
            // A longer edge does not help if an obstacle limits the cut.
            has_room[index] = limit_m < self.least_m[index] || longest_m == Some(limit_m);
        }
        for index in (1..=self.corners.len()).filter(|&index| has_room[index]) {
            let limit_m = self.left_m(index, &cuts_m);
            if limit_m > cuts_m[index] * (1.0 + CUT_TOLERANCE) {
                let longer_m = self.longest_cut_m(index, limit_m).unwrap_or(0.0);
                cuts_m[index] = cuts_m[index].max(longer_m);
            }
        }
        cuts_m
    }

    /// The share of the edge to a neighbour that the corner at `index` may use at first.
    fn share_m(&self, index: usize, neighbour: usize) -> f64 {
        let room_m = self.room_m[index.min(neighbour)];
        let left_m = room_m - self.least_m[index] - self.least_m[neighbour];
        // The ends of the line use none of it.
        if self.least_m[neighbour] == 0.0 {
            room_m
        } else if left_m >= 0.0 {
            self.least_m[index] + 0.5 * left_m
        } else {
            0.5 * room_m
        }
    }

    /// The length that the cuts of both neighbours leave.
    fn left_m(&self, index: usize, cuts_m: &[f64]) -> f64 {
        let before_m = self.room_m[index - 1] - cuts_m[index - 1];
        before_m.min(self.room_m[index] - cuts_m[index + 1])
    }

    /// The longest cut of a corner up to a limit, by bisection between a cut that fits and one
    /// that does not. `None` if not even the shortest fits.
    fn longest_cut_m(&self, index: usize, limit_m: f64) -> Option<f64> {
        let corner = &self.corners[index - 1];
        let least_m = self.least_m[index];
        if corner.is_reversal() || limit_m < least_m {
            return None;
        }
        if self.fits(index, limit_m) {
            return Some(limit_m);
        }
        if !self.fits(index, least_m) {
            return None;
        }
        let (mut fits_m, mut fails_m) = (least_m, limit_m);
        while fails_m - fits_m > CUT_TOLERANCE * limit_m {
            let middle_m = 0.5 * (fits_m + fails_m);
            if self.fits(index, middle_m) {
                fits_m = middle_m;
            } else {
                fails_m = middle_m;
            }
        }
        Some(fits_m)
    }

    /// True if the curves of a cut keep the clearance. If the line does not keep it: true if the
    /// curves are no closer to obstacles than the part of the line that they replace.
    fn fits(&self, index: usize, cut_m: f64) -> bool {
        let corner = &self.corners[index - 1];
        let [from, to] = corner.ends(cut_m);
        let replaced = [Segment::new(from, corner.at), Segment::new(corner.at, to)];
        let curves = corner.curves(cut_m);
        let joint = curves[1].start;
        let mut curves = curves.into_iter().map(PathPiece::Cubic);
        let is_clear = |&edge: &Segment| self.clearance.is_clear(edge, self.clearance_m);
        if self.is_clear_corner(index) || replaced.iter().all(is_clear) {
            // Most cuts that are too long fail at the point where the curves meet.
            return self.clearance.is_clear_point(joint, self.clearance_m)
                && curves.all(|curve| self.clearance.is_clear_curve(&curve, self.clearance_m));
        }
        // The map's border needs no check: the curves lie between the edges.
        let of_edge = |&edge: &Segment| self.clearance.of_segment(edge, self.clearance_m);
        let kept_m = replaced.iter().map(of_edge).fold(f64::INFINITY, f64::min);
        let slack_m = DISTANCE_TOLERANCE_CELLS * self.clearance.frame().resolution_m();
        let mut at_least_m =
            curves.map(|curve| self.clearance.of_curve(&curve, kept_m, 0.5 * slack_m).at_least_m);
        kept_m > slack_m && at_least_m.all(|distance_m| distance_m >= kept_m - slack_m)
    }

    /// True if both edges of the corner at a point keep the clearance.
    fn is_clear_corner(&self, index: usize) -> bool {
        self.is_clear[index - 1] && self.is_clear[index]
    }

    fn why_sharp(&self, index: usize, cuts_m: &[f64]) -> SharpCorner {
        let corner = &self.corners[index - 1];
        let fits_sharper =
            || self.left_m(index, cuts_m) < self.shortest_m || self.fits(index, self.shortest_m);
        let why = if corner.is_reversal() {
            WhySharp::Reversal
        } else if fits_sharper() {
            WhySharp::TurningRadius
        } else {
            WhySharp::Clearance
        };
        SharpCorner { at: corner.at, why }
    }

    /// The remaining edges and the curves between them, each with a flag: true if it certainly
    /// keeps the clearance because the edges that it comes from do.
    fn pieces(&self, points: &[Point], cuts_m: &[f64]) -> Vec<(PathPiece, bool)> {
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            return Vec::new();
        };
        let straight = |from, to| PathPiece::Segment(Segment::new(from, to));
        let mut at = first;
        let mut pieces = Vec::new();
        for (index, corner) in (1..).zip(&self.corners) {
            let [from, to] = corner.ends(cuts_m[index]);
            pieces.push((straight(at, from), self.is_clear[index - 1]));
            if cuts_m[index] > 0.0 {
                let curves = corner.curves(cuts_m[index]).map(PathPiece::Cubic);
                pieces.extend(curves.map(|curve| (curve, self.is_clear_corner(index))));
            }
            at = to;
        }
        pieces.push((straight(at, last), self.is_clear.last() == Some(&true)));
        pieces
    }
}

#[cfg(test)]
#[path = "continuous_curvature_tests.rs"]
mod tests;
