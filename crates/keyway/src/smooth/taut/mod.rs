//! The taut path: a line -> the locally shortest path at a clearance, as if the line were a string
//! that is pulled tight around the obstacles.
//!
//! The end of a string is moved along the line, and the string is kept tight: its last leg sweeps
//! over the plane. If the leg hits a corner of an obstacle, the string bends around it from then
//! on; if the string becomes straight at a corner, it leaves the corner. So no obstacle ever
//! changes sides: the path is the shortest one that the line can be pulled into (of its homotopy
//! class). With a clearance the string wraps around discs of that radius: its legs are tangents,
//! its bends are arcs.
//!
//! # Source
//! \[Hershberger1994\], whose funnel needs a triangulation. Here the corners in the triangle that
//! a leg sweeps are found in the map's bits, row by row.
//!
//! # Clearance
//! - Only convex corners of obstacle squares bend a shortest path, so it is enough to keep the
//!   distance from discs around them.
//! - If the line itself is closer to a corner than the clearance, the radius around that corner is
//!   the line's own distance, and the shortfall is reported. A line may begin or end like this.
//! - A segment of the line that enters an obstacle, leaves the map, or passes between two diagonal
//!   squares stays as it is. The parts before and after it are pulled tight.
//!
//! # Idempotence
//! Without clearance the taut path of a taut path is that path. With a clearance this also holds
//! for a line that keeps the clearance, such as tangents around the arcs. Points *on* the arcs
//! joined by straight lines are not such a line: they cut into the discs, so they keep less than
//! the clearance, and that is reported.
//!
//! # Errors / cost
//! None. The result is measured exactly. If it is worse than the line, the line stays as it was,
//! and its corners are reported as sharp. This happens only due to rounding (a line that only
//! touches its discs and comes back by the same path) or with overlapping discs of unequal size.
//! Each point of the line, and each corner that the string hits or leaves, costs one scan of the
//! rows of a triangle.

mod corners;
mod string;

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::smoothed::count_others;
use super::{SharpCorner, Smoothed, Smoother, WhySharp};
use crate::ConfigError;
use crate::geometry::{Arc, Path, PathPiece, PlannedLine, Point, Polyline, Segment};
use crate::map::Clearance;
use corners::Corners;
use serde::{Deserialize, Serialize};
use string::{Contact, pull};

/// Distances below this \[cells\] count as touching: less than the tolerance of
/// [`Clearance::is_clear`].
const TOUCH_CELLS: f64 = 1e-10;

/// Coordinates within this distance of the edge of a cell \[cells\] are moved onto it.
const SNAP_CELLS: f64 = 1e-9;

/// Length and clearance that may be lost to rounding \[cells\].
const ROUNDING_CELLS: f64 = 2e-8;

/// Parameters of [`Taut`]: none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct TautConfig {}

/// Pulls a line tight.
#[derive(Clone, Debug, Default)]
pub struct Taut;

impl Taut {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "taut";
}

impl SmootherParameters for TautConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(Taut))
    }
}

impl Smoother for Taut {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline().merged();
        let required = RequiredClearance::new(clearance, clearance_m, 0.0);
        let mut pieces = Vec::new();
        for part in parts(&line, clearance) {
            match part {
                Part::Kept(segment) => pieces.push(PathPiece::Segment(segment)),
                Part::Free(points) => match pulled(points, clearance, clearance_m) {
                    Some(taut) => pieces.extend(taut),
                    None => return untouched(&line, &required),
                },
            }
        }
        let smoothed = described(&line, pieces).judged(&required);
        if is_as_good(&smoothed, &line, clearance, &required) {
            smoothed
        } else {
            untouched(&line, &required)
        }
    }
}

/// A part of the line.
enum Part<'l> {
    /// In collision: it stays.
    Kept(Segment),
    /// Free: it can be pulled tight.
    Free(&'l [Point]),
}

fn parts<'l>(line: &'l Polyline, clearance: &Clearance<'_>) -> Vec<Part<'l>> {
    let points = line.points();
    let mut parts = Vec::new();
    let mut from = 0;
    for (at, segment) in line.segments().enumerate() {
        if !clearance.is_clear(segment, 0.0) {
            if from < at {
                parts.push(Part::Free(&points[from..=at]));
            }
            parts.push(Part::Kept(segment));
            from = at + 1;
        }
    }
    if from + 1 < points.len() {
        parts.push(Part::Free(&points[from..]));
    }
    parts
}

/// The pieces of the taut path for points that are clear of obstacles.
fn pulled(points: &[Point], clearance: &Clearance<'_>, clearance_m: f64) -> Option<Vec<PathPiece>> {
    let frame = clearance.frame();
    let in_cells: Vec<Point> = points.iter().map(|&p| snapped(frame.grid_from_world(p))).collect();
    let radius = clearance_m / frame.resolution_m();
    let corners = Corners::new(clearance.obstacles(), radius, &in_cells);
    let contacts = pull(&corners, &in_cells)?;
    let (&start, &goal) = (points.first()?, points.last()?);
    let mut pieces = Vec::new();
    let mut at = start;
    let go_to = |at: &mut Point, to: Point, pieces: &mut Vec<PathPiece>| {
        if *at != to {
            pieces.push(PathPiece::Segment(Segment::new(*at, to)));
            *at = to;
        }
    };
    for contact in &contacts[1..] {
        let touch = frame.world_from_grid(contact.touch);
        let leg = at.distance(touch) / frame.resolution_m();
        if contact.turned_rad * leg.max(contact.radius) <= TOUCH_CELLS {
            // Straight on, up to rounding.
            continue;
        }
        go_to(&mut at, touch, &mut pieces);
        if let Some(arc) = bend(contact, clearance) {
            at = arc.end();
            pieces.push(PathPiece::Arc(arc));
        }
    }
    go_to(&mut at, goal, &mut pieces);
    Some(pieces)
}

/// The arc of a path around a contact, in world coordinates; `None` if its length is 0.
fn bend(contact: &Contact, clearance: &Clearance<'_>) -> Option<Arc> {
    let frame = clearance.frame();
    if contact.is_point() || contact.turned_rad * contact.radius <= TOUCH_CELLS {
        return None;
    }
    let from_centre = contact.touch - contact.centre;
    Some(Arc::new(
        frame.world_from_grid(contact.centre),
        contact.radius * frame.resolution_m(),
        from_centre.heading() + frame.origin().theta,
        contact.turned_rad * contact.side,
    ))
}

fn snapped(cells: Point) -> Point {
    let snap = |x: f64| if (x - x.round()).abs() <= SNAP_CELLS { x.round() } else { x };
    Point::new(snap(cells.x), snap(cells.y))
}

/// The path, with its changes from the line.
fn described(line: &Polyline, pieces: Vec<PathPiece>) -> Smoothed {
    let is_straight = pieces.iter().all(|piece| matches!(piece, PathPiece::Segment(_)));
    let mut corners: Vec<Point> = line.points().first().copied().into_iter().collect();
    corners.extend(pieces.iter().map(PathPiece::end));
    let path = if is_straight {
        let merged = Polyline::new(corners).merged();
        corners = merged.points().to_vec();
        Path::from(&merged)
    } else {
        Path::new(pieces).unwrap_or_default()
    };
    Smoothed {
        removed_points: count_others(line.points(), &corners),
        inserted_points: count_others(&corners, line.points()),
        path,
        ..Smoothed::default()
    }
}

/// True if a path is not longer than the line, and no closer to obstacles than permitted.
fn is_as_good(
    smoothed: &Smoothed,
    line: &Polyline,
    clearance: &Clearance<'_>,
    required: &RequiredClearance<'_>,
) -> bool {
    let rounding_m = ROUNDING_CELLS * clearance.frame().resolution_m();
    let is_shorter = smoothed.path.length_m() <= line.length_m() + rounding_m;
    let pieces = smoothed.path.pieces();
    let path_ends = pieces.first().zip(pieces.last()).map(|(a, b)| (a.start(), b.end()));
    let points = line.points();
    let has_ends = path_ends == points.first().copied().zip(points.last().copied());
    // A taut path comes no closer to the border than the line.
    let from_obstacles =
        || required.obstacle_shortfall_m(&smoothed.path, Smoothed::CLEARANCE_TOLERANCE_M);
    let is_clear = smoothed.kept_clearance_m.and_then(|_| from_obstacles()).is_none_or(|kept_m| {
        // A path with a clearance of 0 may touch an obstacle, or be in it.
        let was_in = || !clearance.is_clear_path(&Path::from(line), 0.0);
        let is_no_worse = kept_m > 0.0 || clearance.is_clear_path(&smoothed.path, 0.0) || was_in();
        let before_m = clearance.of_line(line);
        is_no_worse
            && before_m
                .is_none_or(|before_m| kept_m >= before_m.min(required.safe_m()) - rounding_m)
    });
    is_shorter && has_ends && is_clear
}

/// The line as it was, its corners reported as sharp.
fn untouched(line: &Polyline, required: &RequiredClearance<'_>) -> Smoothed {
    let inner = line.points().len().saturating_sub(1).max(1);
    let corners = line.points().get(1..inner).unwrap_or_default();
    let sharp = corners.iter().map(|&at| SharpCorner { at, why: WhySharp::Clearance });
    let sharp_corners = sharp.collect();
    Smoothed { sharp_corners, ..Smoothed::straight(line, line, required) }
}

#[cfg(test)]
mod property_tests;
#[cfg(test)]
mod tests;
