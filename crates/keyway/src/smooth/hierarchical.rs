//! Hierarchical smoothing \[ZhuYin2024\]: a line -> few straight stretches that keep a safe
//! distance, joined by the bends of a cubic B-spline.
//!
//! The inner layer drops points that no obstacle requires. The outer layer puts a control node on
//! either side of each remaining corner. The B-spline over the nodes is straight between corners,
//! and its curvature is continuous. The distance of the nodes from a corner determines the
//! roundness of its bend.
//!
//! # Source
//! \[ZhuYin2024\]: section 1.3, equations (6) to (10).
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | d | [`HierarchicalSmoothingConfig::safe_distance_m`] | m | none is given |
//! | R | [`HierarchicalSmoothingConfig::control_distance_m`] | m | none is given |
//! | `x_c`, `x_A`, `x_B`, eq. (6), (7) | a corner and the control nodes before and after it | m | |
//! | `e_sc`, `e_nc` | unit vectors from a corner towards the points before and after it | 1 | |
//! | the matrix of eq. (8) to (10) | [`Cubic::uniform_b_spline`] | | |
//!
//! # Where this differs from the paper
//! - d = 0.8 m, because the published clearances are 0.81 to 0.83 m; R = 1 m. A connection keeps d
//!   if its distance is d or more (to 1e-9 m), from obstacles, not from the map's border. If d is
//!   smaller than the required clearance, the clearance replaces it.
//! - Of the nodes that one node can be joined with, the farthest is taken, and the search goes on
//!   from there. The next node can always be joined, so the line stays as it was wherever it is
//!   closer to an obstacle than d.
//! - The control nodes are the start three times, A, corner and B of each corner, and the goal
//!   three times, so the curve begins at the start and ends at the goal. (If repeated twice, it
//!   would begin at (5 P0 + P1) / 6.)
//! - The paper does not give the distance that the curve keeps from obstacles. Here R is at most
//!   half of the corner's shorter edge, so that bends do not overlap. If a bend is closer to an
//!   obstacle than both d and the corner's edges there, R is halved until it is not. A corner that
//!   would need less than a 16th of R stays sharp, and so does a reversal.
//! - As a consequence, a corner that an obstacle holds at its distance, d or less, cannot be
//!   rounded: every bend cuts it. A line that keeps more than d, as that of the paper's planner
//!   nearly does, has no such corners. For other lines, [`BendsKeep::Clearance`] rounds them.
//! - The paper's paths have no non-smooth turns, heading changes of over 5 degrees within a
//!   centimetre. A spline can still have them: a bend between edges at an angle of phi has a
//!   curvature of 2 cos(phi / 2) / (R sin²(phi / 2)) at its middle, and up to several times as
//!   much before and after it if the edges are many times longer than R. A bend that would exceed
//!   5 degrees per centimetre anywhere is not made: the corner stays sharp and is reported. So the
//!   non-smooth turns of a path are its sharp corners.
//! - Stretches of the spline whose nodes lie on one edge are returned as a straight segment.
//!
//! # Errors / cost
//! [`ConfigError`]. At most n tests per kept point for a line of n corners, most of them saved by
//! [`Visibility`], and a few certified distances of cubic curves per corner and halving. Distances
//! of bends are certain to within 4e-5 cells.

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::smoothed::count_others;
use super::stretches::Stretches;
use super::visibility::Visibility;
use super::{SharpCorner, Smoothed, Smoother, WhySharp};
use crate::ConfigError;
use crate::geometry::{Cubic, Path, PathPiece, PlannedLine, Point, Polyline, Segment};
use crate::map::Clearance;
use serde::{Deserialize, Serialize};
use std::iter::repeat_n;

/// No bend has a larger curvature \[1/m\]: 5 degrees within a centimetre, beyond which a turn
/// counts as non-smooth.
const MAX_CURVATURE_PER_M: f64 = 5.0 * std::f64::consts::PI / 180.0 / 0.01;

/// Maximum number of halvings of R before a corner stays sharp.
const HALVINGS: u32 = 4;

/// A bend that is too close to an obstacle by less than this \[cells\] counts as clear: a curve
/// that touches the distance cannot be certified more precisely.
const CERTIFIED_CELLS: f64 = 1e-5;

/// A turn backwards whose sine is smaller than this is a reversal.
const REVERSAL_SINE: f64 = 1e-9;

/// Distance that a bend keeps from obstacles, provided the corner's edges keep it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum BendsKeep {
    /// The safe distance, as straight connections do.
    SafeDistance,
    /// The required clearance: bends may cut corners that are held at the safe distance.
    Clearance,
}

/// Parameters of the hierarchical smoothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct HierarchicalSmoothingConfig {
    /// Safe distance d \[m\]: kept from obstacles by connections and bends wherever the line keeps
    /// it.
    pub safe_distance_m: f64,
    /// R \[m\]: distance of the control nodes from their corner. At most half of its shorter edge,
    /// and halved if the bend would come too close to an obstacle.
    pub control_distance_m: f64,
    /// Distance that bends keep: the `safe-distance`, or only the required `clearance`, which
    /// rounds more corners.
    pub bends_keep: BendsKeep,
}

impl HierarchicalSmoothingConfig {
    /// The paper's method, as read above; every value is a reading.
    pub const PAPER: Self =
        Self { safe_distance_m: 0.8, control_distance_m: 1.0, bends_keep: BendsKeep::SafeDistance };
}

impl Default for HierarchicalSmoothingConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Smooths by straight stretches and a B-spline.
#[derive(Clone, Debug)]
pub struct HierarchicalSmoothing {
    config: HierarchicalSmoothingConfig,
}

impl HierarchicalSmoothing {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "hierarchical";

    /// The smoother with these parameters.
    ///
    /// # Errors
    /// [`ConfigError`] if a distance is invalid; the error names it.
    pub fn new(config: HierarchicalSmoothingConfig) -> Result<Self, ConfigError> {
        ConfigError::unless_not_negative("safe_distance_m", config.safe_distance_m)?;
        ConfigError::unless_positive("control_distance_m", config.control_distance_m)?;
        Ok(Self { config })
    }
}

impl SmootherParameters for HierarchicalSmoothingConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(HierarchicalSmoothing::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["safe_distance_m", "control_distance_m", "bends_keep"]
    }

    fn safe_distance_m(&self, _: f64) -> f64 {
        self.safe_distance_m
    }
}

impl Smoother for HierarchicalSmoothing {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        let required = RequiredClearance::new(clearance, clearance_m, self.config.safe_distance_m);
        let nodes = inner_layer(line, clearance, &required);
        if nodes.len() < 2 {
            return Smoothed::straight(line, &Polyline::new(nodes), &required);
        }
        let bends_m = match self.config.bends_keep {
            BendsKeep::SafeDistance => required.safe_m(),
            BendsKeep::Clearance => clearance_m,
        };
        let bends = Bends::new(&nodes, self.config.control_distance_m);
        let bends = bends.kept_clear(clearance, bends_m);
        let path = bends.path();
        Smoothed {
            removed_points: count_others(line.merged().points(), &bends.passed()),
            inserted_points: 2 * bends.radii.iter().filter(|radius| radius.is_ok()).count(),
            sharp_corners: bends.sharp_corners(),
            kept_clearance_m: kept_clearance_m(&path, clearance, &required),
            path,
        }
    }
}

/// The points at which the direction changes, reduced to those that the safe distance needs.
fn inner_layer(
    line: &Polyline,
    clearance: &Clearance<'_>,
    required: &RequiredClearance<'_>,
) -> Vec<Point> {
    let merged = line.merged();
    let points = merged.points();
    let stretches = Stretches::new(points, clearance);
    let mut visibility = Visibility::new(clearance, required.unsafe_within_m());
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let mut at = 0;
    while at + 1 < points.len() {
        at = visibility.farthest_safe(&stretches, at, required);
        kept.push(points[at]);
    }
    // If a line passes through a point twice, the result can repeat a point, or have one on a
    // straight stretch.
    Polyline::new(kept).merged().points().to_vec()
}

/// The distance that is certainly kept, if it falls short of the required one by more than the
/// certification tolerance.
fn kept_clearance_m(
    path: &Path,
    clearance: &Clearance<'_>,
    required: &RequiredClearance<'_>,
) -> Option<f64> {
    let slack_m = CERTIFIED_CELLS * clearance.frame().resolution_m();
    required.kept_clearance_m(path.pieces(), slack_m, 4.0 * slack_m)
}

/// The outer layer: start, corners and goal, and the distance of each corner's control nodes.
struct Bends<'a> {
    nodes: &'a [Point],
    /// R of each corner \[m\], or the reason why it stays sharp.
    radii: Vec<Result<f64, WhySharp>>,
}

impl<'a> Bends<'a> {
    fn new(nodes: &'a [Point], control_distance_m: f64) -> Self {
        let radius = |node: &[Point]| {
            if is_reversal(node) {
                return Err(WhySharp::Reversal);
            }
            let shorter_m = node[0].distance(node[1]).min(node[1].distance(node[2]));
            let radius_m = control_distance_m.min(0.5 * shorter_m);
            // Control nodes that coincide with the corner numerically round nothing.
            let is_corner = |to: Point| towards(node[1], to, radius_m) == node[1];
            if is_corner(node[0]) || is_corner(node[2]) {
                return Err(WhySharp::TurningRadius);
            }
            Ok(radius_m)
        };
        Self { nodes, radii: nodes.windows(3).map(radius).collect() }
    }

    /// Removes bends that turn too sharply, and halves R of the bends that are closer to obstacles
    /// than both their edges and `kept_m`, until none is left. All bends are changed at once,
    /// because each depends on the nodes of its neighbours too.
    fn kept_clear(mut self, clearance: &Clearance<'_>, kept_m: f64) -> Self {
        let widest = self.radii.clone();
        // A bend depends on its own nodes and those of the corners next to it.
        let mut is_open = vec![true; widest.len()];
        loop {
            let control = self.control_nodes();
            let open = (0..widest.len()).filter(|&i| is_open[i]);
            let changes: Vec<_> = open
                .filter_map(|i| {
                    let changed = self.changed(&control, i, widest[i].ok()?, clearance, kept_m)?;
                    Some((i, changed))
                })
                .collect();
            if changes.is_empty() {
                return self;
            }
            is_open.fill(false);
            for (i, radius) in changes {
                self.radii[i] = radius;
                is_open[i.saturating_sub(1)..widest.len().min(i + 2)].fill(true);
            }
        }
    }

    /// The new R of a corner; `None` if it need not change.
    fn changed(
        &self,
        control: &[Point],
        corner: usize,
        widest_m: f64,
        clearance: &Clearance<'_>,
        kept_m: f64,
    ) -> Option<Result<f64, WhySharp>> {
        let radius_m = self.radii[corner].ok()?;
        let bend = bend(control, corner);
        if !bend.iter().all(|one| one.is_curvature_at_most(MAX_CURVATURE_PER_M)) {
            let is_widest = radius_m >= widest_m;
            return Some(Err(if is_widest {
                WhySharp::TurningRadius
            } else {
                WhySharp::Clearance
            }));
        }
        if self.is_clear_bend(bend, corner, clearance, kept_m) {
            return None;
        }
        let half_m = 0.5 * radius_m;
        let is_least = half_m < widest_m * 0.5f64.powi(HALVINGS as i32);
        Some(if is_least { Err(WhySharp::Clearance) } else { Ok(half_m) })
    }

    /// The start three times, then A, the corner and B for each corner, then the goal three times.
    fn control_nodes(&self) -> Vec<Point> {
        let (start, goal) = (self.nodes[0], self.nodes[self.nodes.len() - 1]);
        let corners = self.nodes.windows(3).zip(&self.radii).flat_map(|(node, &radius)| {
            let &[before, corner, after] = node else { return [node[0]; 3] };
            let radius = radius.unwrap_or(0.0);
            // Eq. (6), (7).
            [towards(corner, before, radius), corner, towards(corner, after, radius)]
        });
        repeat_n(start, 3).chain(corners).chain(repeat_n(goal, 3)).collect()
    }

    fn is_clear_bend(
        &self,
        bend: [Cubic; 2],
        corner: usize,
        clearance: &Clearance<'_>,
        kept_m: f64,
    ) -> bool {
        let at = self.nodes[corner + 1];
        // The edges that the bend replaces.
        let edges = [Segment::new(bend[0].start, at), Segment::new(at, bend[1].end())];
        let slack_m = CERTIFIED_CELLS * clearance.frame().resolution_m();
        clearance.keep_distance_of(bend, edges, kept_m, slack_m)
    }

    /// The B-spline, as straight segments between bends.
    fn path(&self) -> Path {
        let control = self.control_nodes();
        let mut pieces = Vec::new();
        let mut at = self.nodes[0];
        for (i, radius) in self.radii.iter().enumerate() {
            if radius.is_ok() {
                let [enter, leave] = bend(&control, i);
                pieces.push(PathPiece::Segment(Segment::new(at, enter.start)));
                pieces.extend([enter, leave].map(PathPiece::Cubic));
                at = leave.end();
            } else {
                pieces.push(PathPiece::Segment(Segment::new(at, self.nodes[i + 1])));
                at = self.nodes[i + 1];
            }
        }
        pieces.push(PathPiece::Segment(Segment::new(at, self.nodes[self.nodes.len() - 1])));
        // Gaps occur only if the coordinates are too large to resolve a micrometre.
        Path::new(pieces).unwrap_or_else(|_| Path::from(&Polyline::new(self.nodes.to_vec())))
    }

    /// Start, sharp corners and goal.
    fn passed(&self) -> Vec<Point> {
        let is_bent = |i: usize| i > 0 && self.radii.get(i - 1).is_some_and(Result::is_ok);
        (0..self.nodes.len()).filter(|&i| !is_bent(i)).map(|i| self.nodes[i]).collect()
    }

    fn sharp_corners(&self) -> Vec<SharpCorner> {
        let sharp = |(node, radius): (&[Point], &Result<f64, WhySharp>)| {
            Some(SharpCorner { at: node[1], why: radius.err()? })
        };
        self.nodes.windows(3).zip(&self.radii).filter_map(sharp).collect()
    }
}

/// The two curved pieces of the spline: those whose four control nodes include A, corner and B of
/// a corner. Eq. (8) to (10).
fn bend(control: &[Point], corner: usize) -> [Cubic; 2] {
    // A of the first corner is preceded by the start, three times.
    let piece = |first: usize| {
        let four = [0, 1, 2, 3].map(|k| control[first + k]);
        Cubic::uniform_b_spline(four)
    };
    [piece(3 * corner + 2), piece(3 * corner + 3)]
}

/// The point at a distance from `from` in the direction of `to`.
fn towards(from: Point, to: Point, distance_m: f64) -> Point {
    from.lerp(to, distance_m / from.distance(to))
}

fn is_reversal(node: &[Point]) -> bool {
    let (before, after) = (node[1] - node[0], node[2] - node[1]);
    let sine = before.cross(after).abs() / (before.norm() * after.norm());
    before.dot(after) < 0.0 && sine < REVERSAL_SINE
}

#[cfg(test)]
#[path = "hierarchical_tests.rs"]
mod tests;
