//! Paths of straight, circular and cubic pieces.

use super::{Arc, Cubic, PathSample, Point, Polyline, Segment, wrap_angle};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Largest gap between pieces that still join \[m\].
const JOIN_TOLERANCE_M: f64 = 1e-6;

/// Largest heading jump \[rad\] that counts as rounding; a larger one is a corner.
const CORNER_RAD: f64 = 1e-6;

/// Largest number of samples of a path.
const MAX_SAMPLES: f64 = 1e7;

/// One piece of a [`Path`] \[m, world frame\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PathPiece {
    /// A straight segment.
    Segment(Segment),
    /// A circular arc.
    Arc(Arc),
    /// A cubic curve: a Bézier curve or a piece of a B-spline.
    Cubic(Cubic),
}

impl PathPiece {
    /// Length \[m\]: exact except for a cubic, see [`Cubic::length`].
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Segment(segment) => segment.length(),
            Self::Arc(arc) => arc.length(),
            Self::Cubic(cubic) => cubic.length(),
        }
    }

    /// First point.
    pub fn start(&self) -> Point {
        match self {
            Self::Segment(segment) => segment.a,
            Self::Arc(arc) => arc.start(),
            Self::Cubic(cubic) => cubic.start,
        }
    }

    /// Last point.
    pub fn end(&self) -> Point {
        match self {
            Self::Segment(segment) => segment.b,
            Self::Arc(arc) => arc.end(),
            Self::Cubic(cubic) => cubic.end(),
        }
    }

    /// Position, heading and curvature at arc length `s_m` along the piece, clamped to its ends.
    pub fn at_length(&self, s_m: f64) -> PathSample {
        let fraction =
            |length: f64| if length > 0.0 { (s_m / length).clamp(0.0, 1.0) } else { 0.0 };
        match self {
            Self::Segment(segment) => {
                let at = segment.a.lerp(segment.b, fraction(segment.length()));
                PathSample::new(s_m, at, (segment.b - segment.a).heading(), 0.0)
            }
            Self::Arc(arc) => {
                let along = fraction(arc.length());
                PathSample::new(s_m, arc.at(along), arc.heading_at(along), arc.curvature())
            }
            Self::Cubic(cubic) => {
                let u = cubic.parameter_at(s_m);
                PathSample::new(s_m, cubic.at(u), cubic.heading_at(u), cubic.curvature_at(u))
            }
        }
    }

    fn numbers_are_finite(&self) -> bool {
        match self {
            Self::Segment(Segment { a, b }) => a.is_finite() && b.is_finite(),
            Self::Arc(arc) => {
                let numbers = [arc.radius, arc.start_rad, arc.sweep_rad];
                arc.centre.is_finite() && numbers.iter().all(|n| n.is_finite())
            }
            Self::Cubic(cubic) => {
                cubic.start.is_finite() && cubic.legs.iter().all(|l| l.is_finite())
            }
        }
    }

    fn is_overwound(&self) -> bool {
        // A full turn may exceed 2 pi by a rounding error.
        let whole_turn = std::f64::consts::TAU * (1.0 + 1e-12);
        matches!(self, Self::Arc(arc) if arc.radius < 0.0 || arc.sweep_rad.abs() > whole_turn)
    }
}

/// Error of pieces that do not form a path.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// A coordinate, radius or angle is NaN or infinite.
    #[error("piece {piece} of the path has a number that is not finite")]
    NotFinite {
        /// The piece, counted from 0.
        piece: usize,
    },
    /// An arc with a negative radius or more than a whole turn.
    #[error(
        "piece {piece} of the path must be an arc of at most one full turn, with a radius of at least 0"
    )]
    NoArc {
        /// The piece, counted from 0.
        piece: usize,
    },
    /// A piece does not begin at the end of the one before.
    #[error("piece {piece} of the path begins {gap_m} m from the end of the piece before it")]
    Gap {
        /// The later piece, counted from 0.
        piece: usize,
        /// Distance between the ends \[m\].
        gap_m: f64,
    },
}

/// A connected chain of straight, circular and cubic pieces \[m, world frame\]. May be empty.
///
/// Headings may jump between pieces (a corner). There is no clothoid: a curve of continuous
/// curvature is a chain of B-spline pieces, whose curvature is continuous already, and no published
/// smoother of this crate needs one.
///
/// ```
/// use keyway::geometry::{Arc, Path, PathPiece, Point, Segment};
/// use std::f64::consts::FRAC_PI_2;
/// // One metre ahead, then a left turn of 1 m radius.
/// let path = Path::new(vec![
///     PathPiece::Segment(Segment::new(Point::new(0.0, 0.0), Point::new(1.0, 0.0))),
///     PathPiece::Arc(Arc::new(Point::new(1.0, 1.0), 1.0, -FRAC_PI_2, FRAC_PI_2)),
/// ])?;
/// assert_eq!(path.length_m(), 1.0 + FRAC_PI_2);
/// let samples = path.samples(0.5); // at 0, 0.5, ..., 2.5 m, and at the end
/// assert_eq!(samples.len(), 7);
/// assert_eq!((samples[1].curvature_per_m, samples[2].curvature_per_m), (0.0, 1.0));
/// # Ok::<(), keyway::geometry::PathError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<PathPiece>", into = "Vec<PathPiece>")]
pub struct Path {
    pieces: Vec<PathPiece>,
}

/// Treatment of the joints between pieces: passed, or sampled themselves.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Joints {
    Passed,
    Sampled,
}

impl Path {
    /// The path over these pieces, in order.
    ///
    /// # Errors
    /// Returns [`PathError`] if a piece has an unusable number, or does not begin within 1 µm of
    /// the end of the one before.
    pub fn new(pieces: Vec<PathPiece>) -> Result<Self, PathError> {
        for (piece, one) in pieces.iter().enumerate() {
            if !one.numbers_are_finite() {
                return Err(PathError::NotFinite { piece });
            }
            if one.is_overwound() {
                return Err(PathError::NoArc { piece });
            }
        }
        for (before, pair) in pieces.windows(2).enumerate() {
            let gap_m = pair[0].end().distance(pair[1].start());
            if gap_m > JOIN_TOLERANCE_M {
                return Err(PathError::Gap { piece: before + 1, gap_m });
            }
        }
        Ok(Self { pieces })
    }

    /// The pieces in order.
    pub fn pieces(&self) -> &[PathPiece] {
        &self.pieces
    }

    /// Sum of the pieces' lengths \[m\].
    pub fn length_m(&self) -> f64 {
        self.pieces.iter().fold(0.0, |sum, piece| sum + piece.length_m())
    }

    /// Heading jumps between pieces, positive to the left \[rad\]: one number per joint, 0 where
    /// the path is smooth. Pieces of no length have no heading and are left out; a cusp inside a
    /// cubic is not a joint.
    pub fn joint_turns_rad(&self) -> Vec<f64> {
        let driven = self.pieces.iter().filter(|piece| piece.length_m() > 0.0);
        let headings: Vec<[f64; 2]> =
            driven.map(|p| [0.0, f64::INFINITY].map(|s| p.at_length(s).heading_rad)).collect();
        headings.windows(2).map(|pair| wrap_angle(pair[1][0] - pair[0][1])).collect()
    }

    /// A polyline along the path that deviates from it by at most `deviation_m`; segments are
    /// kept. A deviation that is not positive returns the ends of the pieces.
    pub fn flattened(&self, deviation_m: f64) -> Polyline {
        let mut points: Vec<Point> =
            self.pieces.first().map(PathPiece::start).into_iter().collect();
        for piece in &self.pieces {
            match piece {
                PathPiece::Segment(_) => points.push(piece.end()),
                PathPiece::Arc(arc) => {
                    let parts = parts_of_arc(arc, deviation_m);
                    points.extend((1..=parts).map(|k| arc.at(f64::from(k) / f64::from(parts))));
                }
                PathPiece::Cubic(cubic) => flatten(cubic, deviation_m, 0, &mut points),
            }
        }
        Polyline::new(points)
    }

    /// Samples of the path at the arc lengths 0, `spacing_m`, 2 `spacing_m`, ..., and at its end.
    /// A joint takes the heading and curvature of the piece that begins there.
    ///
    /// A path of zero length (or one too long for a number) returns one sample, an empty path
    /// none. A spacing that is not a positive number returns the two ends; no spacing returns
    /// more than ten million samples.
    pub fn samples(&self, spacing_m: f64) -> Vec<PathSample> {
        self.sampled(spacing_m, Joints::Passed)
    }

    /// Like [`Self::samples`], plus the joints of the pieces: between two samples the path is a
    /// single piece. The arc length increases from each sample to the next, except at a corner (a
    /// heading jump of more than 1e-6 rad). A corner is sampled twice, as the end of one piece
    /// and as the beginning of the next; in between, a robot turns on the spot.
    pub fn samples_and_joints(&self, spacing_m: f64) -> Vec<PathSample> {
        let mut samples: Vec<PathSample> = Vec::new();
        for sample in self.samples_of_pieces(spacing_m) {
            let is_joint = |last: &mut PathSample| {
                let turn_rad = wrap_angle(sample.heading_rad - last.heading_rad).abs();
                last.s_m == sample.s_m && turn_rad <= CORNER_RAD
            };
            samples.pop_if(is_joint);
            samples.push(sample);
        }
        samples
    }

    /// Like [`Self::samples`], plus two samples at every joint: one with the heading and
    /// curvature of each piece.
    pub fn samples_of_pieces(&self, spacing_m: f64) -> Vec<PathSample> {
        self.sampled(spacing_m, Joints::Sampled)
    }

    fn sampled(&self, spacing_m: f64, joints: Joints) -> Vec<PathSample> {
        let total_m = self.length_m();
        let Some(first) = self.pieces.first() else { return Vec::new() };
        if total_m == 0.0 || !total_m.is_finite() {
            return vec![first.at_length(0.0)];
        }
        let spacing_m = if spacing_m > 0.0 { spacing_m } else { total_m };
        let spacing_m = spacing_m.clamp(total_m / MAX_SAMPLES, total_m);
        // A sample nearer than this to a joint counts as the joint's sample.
        let slack = 1e-9 * spacing_m;
        let mut samples = Vec::new();
        let (mut begin, mut index) = (0.0, 0.0);
        let mut last = *first;
        for piece in &self.pieces {
            let length = piece.length_m();
            if length <= 0.0 {
                continue;
            }
            let mut add = |along: f64, s_m: f64| samples.push(piece.at_length(along).moved_to(s_m));
            if joints == Joints::Sampled {
                add(0.0, begin);
            }
            while index * spacing_m < begin + length - slack {
                let s_m = index * spacing_m;
                index += 1.0;
                if joints == Joints::Passed || s_m > begin + slack {
                    add(s_m - begin, s_m);
                }
            }
            if joints == Joints::Sampled {
                add(f64::INFINITY, begin + length);
            }
            begin += length;
            last = *piece;
        }
        if joints == Joints::Passed {
            samples.push(last.at_length(f64::INFINITY).moved_to(total_m));
        }
        samples
    }
}

/// Largest number of chords of a piece.
const MAX_CHORDS: u32 = 1 << MAX_HALVINGS;
const MAX_HALVINGS: u32 = 12;

/// Number of equal parts into which an arc is split to keep its chords within the deviation: a
/// part's sagitta is r (1 - cos(sweep / 2)) < r sweep^2 / 8.
fn parts_of_arc(arc: &Arc, deviation_m: f64) -> u32 {
    if deviation_m.is_nan() || deviation_m <= 0.0 {
        return 1;
    }
    let parts = arc.sweep_rad.abs() * (arc.radius / (8.0 * deviation_m)).sqrt();
    (parts.ceil() as u32).clamp(1, MAX_CHORDS)
}

/// Appends the ends of chords, halving the curve until they are close enough.
fn flatten(cubic: &Cubic, deviation_m: f64, halvings: u32, points: &mut Vec<Point>) {
    if cubic.deviation() <= deviation_m
        || halvings == MAX_HALVINGS
        || deviation_m.is_nan()
        || deviation_m <= 0.0
    {
        points.push(cubic.end());
        return;
    }
    let [first, second] = cubic.split(0.5);
    flatten(&first, deviation_m, halvings + 1, points);
    flatten(&second, deviation_m, halvings + 1, points);
}

impl TryFrom<Vec<PathPiece>> for Path {
    type Error = PathError;
    fn try_from(pieces: Vec<PathPiece>) -> Result<Self, PathError> {
        Self::new(pieces)
    }
}

impl From<Path> for Vec<PathPiece> {
    fn from(path: Path) -> Self {
        path.pieces
    }
}

/// The segments of the line, without repeated points; a line of a single point becomes a path of
/// zero length. Non-finite points are left out.
impl From<&Polyline> for Path {
    fn from(line: &Polyline) -> Self {
        let mut points: Vec<Point> = line.points().to_vec();
        points.retain(|point| point.is_finite());
        points.dedup();
        if let [only] = points[..] {
            points.push(only);
        }
        let segment = |pair: &[Point]| PathPiece::Segment(Segment::new(pair[0], pair[1]));
        Self { pieces: points.windows(2).map(segment).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn line(points: &[[f64; 2]]) -> Path {
        Path::from(&Polyline::new(points.iter().map(|&p| p.into()).collect()))
    }

    fn segment(a: [f64; 2], b: [f64; 2]) -> PathPiece {
        PathPiece::Segment(Segment::new(a.into(), b.into()))
    }

    /// One metre right, a left turn of 1 m radius, one metre up.
    fn left_turn() -> Path {
        let turn = Arc::new(Point::new(1.0, 1.0), 1.0, -FRAC_PI_2, FRAC_PI_2);
        let pieces =
            vec![segment([0., 0.], [1., 0.]), PathPiece::Arc(turn), segment([2., 1.], [2., 2.])];
        Path::new(pieces).unwrap()
    }

    #[test]
    fn a_turn_by_hand() {
        let path = left_turn();
        assert!((path.length_m() - 2.0 - FRAC_PI_2).abs() < 1e-12);
        assert!(path.joint_turns_rad().iter().all(|turn| turn.abs() < 1e-12));
        // 3.57 m: samples at 0, 1, 2, 3 m and the end; at 2 m the turn has gone on for 1 rad.
        let samples = path.samples(1.0);
        assert_eq!(samples.len(), 5);
        let at = samples[2];
        assert!(at.position().distance(Point::new(1.0 + 1f64.sin(), 1.0 - 1f64.cos())) < 1e-12);
        assert!((at.heading_rad - 1.0).abs() < 1e-12 && at.curvature_per_m == 1.0);
        assert_eq!((samples[1].curvature_per_m, samples[3].curvature_per_m), (1.0, 0.0));
        assert!((samples[4].s_m - path.length_m()).abs() < 1e-12);
        assert_eq!(samples[4].position(), Point::new(2.0, 2.0));
        let curvatures = |samples: Vec<PathSample>| {
            samples.iter().map(|s| s.curvature_per_m).collect::<Vec<_>>()
        };
        let of_pieces = path.samples_of_pieces(1.0);
        assert_eq!(curvatures(of_pieces), [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        // At 0, 1, 2, 2.57, 3 and 3.57 m: without corners, no position is sampled twice.
        assert_eq!(curvatures(path.samples_and_joints(1.0)), [0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn flattened_paths_stay_near() {
        // A quarter of a circle of 1 m: parts of 2 acos(1 - 0.01) = 0.283 rad would do, 6 of them.
        let chords = left_turn().flattened(0.01);
        assert_eq!(chords.points().len(), 1 + 1 + 6 + 1);
        assert!(left_turn().length_m() - chords.length_m() < 0.02);
        let bent = Cubic::bezier([[0., 0.], [1., 1.], [2., 1.], [3., 0.]].map(Point::from));
        let path = Path::new(vec![PathPiece::Cubic(bent)]).unwrap();
        let chords = path.flattened(1e-4);
        let off = |k: u32| {
            let at = bent.at(f64::from(k) / 1000.0);
            chords
                .segments()
                .map(|s| s.distance_sq_to_point(at).sqrt())
                .fold(f64::INFINITY, f64::min)
        };
        assert!((0..=1000).all(|k| off(k) < 1e-4));
        assert_eq!(path.flattened(0.0).points().len(), 2);
        assert_eq!(path.flattened(f64::NAN).points().len(), 2);
        assert!(Path::default().flattened(0.1).points().is_empty());
    }

    #[test]
    fn corners_and_reversals() {
        let path = line(&[[0., 0.], [1., 0.], [1., 0.], [1., 1.], [1., 0.]]);
        assert_eq!(path.pieces().len(), 3, "repeated points are dropped");
        let turns = path.joint_turns_rad();
        assert!((turns[0] - FRAC_PI_2).abs() < 1e-12 && (turns[1].abs() - PI).abs() < 1e-12);
        let headings: Vec<f64> = path.samples(0.5).iter().map(|s| s.heading_rad).collect();
        assert_eq!(headings, [0.0, 0.0, FRAC_PI_2, FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2, -FRAC_PI_2]);
        let twice = path.samples_and_joints(9.0);
        let places: Vec<f64> = twice.iter().map(|sample| sample.s_m).collect();
        assert_eq!(places, [0.0, 1.0, 1.0, 2.0, 2.0, 3.0], "arrives and leaves");
        // Two legs of one direction have no corner between them.
        let straight = line(&[[0., 0.], [1., 0.], [3., 0.]]);
        assert_eq!(straight.samples_and_joints(9.0).len(), 3);
    }

    #[test]
    fn next_to_nothing() {
        assert!(line(&[]).samples(0.1).is_empty());
        assert_eq!(
            line(&[[1., 2.], [1., 2.]]).samples(0.1),
            [PathSample::new(0.0, Point::new(1.0, 2.0), 0.0, 0.0)]
        );
        let metre = line(&[[0., 0.], [1., 0.]]);
        for spacing in [f64::NAN, 0.0, -1.0, f64::INFINITY, 5.0] {
            assert_eq!(metre.samples(spacing).len(), 2, "{spacing}");
        }
        // Ten tenths are a metre: the end is not sampled twice.
        assert_eq!(metre.samples(0.1).len(), 11);
        // A joint that lies a rounding error from a sample.
        let thirds = line(&[[0., 0.], [0.1 + 0.2, 0.], [1., 0.]]);
        assert_eq!(thirds.samples_and_joints(0.1).len(), 11);
        // Pieces of zero length anywhere.
        let point = segment([2., 2.], [2., 2.]);
        let pieces = [vec![segment([0., 0.], [0., 0.])], left_turn().pieces, vec![point]].concat();
        let padded = Path::new(pieces).unwrap();
        assert_eq!(padded.samples(0.25), left_turn().samples(0.25));
        assert_eq!(padded.joint_turns_rad().len(), 2);
    }

    #[test]
    fn refuses_what_is_no_path() {
        let gap = Path::new(vec![segment([0., 0.], [1., 0.]), segment([1., 0.5], [2., 0.])]);
        assert_eq!(gap, Err(PathError::Gap { piece: 1, gap_m: 0.5 }));
        assert_eq!(
            Path::new(vec![segment([0., 0.], [f64::NAN, 0.])]),
            Err(PathError::NotFinite { piece: 0 })
        );
        let wound = PathPiece::Arc(Arc::new(Point::default(), 1.0, 0.0, 7.0));
        assert_eq!(Path::new(vec![wound]), Err(PathError::NoArc { piece: 0 }));
        let text = serde_json::to_string(&left_turn()).unwrap();
        assert_eq!(serde_json::from_str::<Path>(&text).unwrap(), left_turn());
        assert!(serde_json::from_str::<Path>(&text.replace("[1.0,0.0]", "[1.0,0.1]")).is_err());
    }

    proptest! {
        #[test]
        fn samples_lie_on_the_path_at_equal_arc_lengths(c in prop::array::uniform7(prop::array::uniform2(-3.0..3.0f64)),
                                                        spacing in 0.01..1.0f64) {
            let control = c.map(Point::from);
            let spline = |w: &[Point]| PathPiece::Cubic(Cubic::uniform_b_spline([w[0], w[1], w[2], w[3]]));
            let path = Path::new(control.windows(4).map(spline).collect()).unwrap();
            let samples = path.samples(spacing);
            prop_assert!((samples.last().unwrap().s_m - path.length_m()).abs() < 1e-12);
            for pair in samples.windows(2) {
                let step = pair[1].s_m - pair[0].s_m;
                prop_assert!(step > 0.0 && step <= spacing * (1.0 + 1e-9));
                prop_assert!(pair[0].position().distance(pair[1].position()) <= step + 1e-8);
            }
            let joints = path.samples_and_joints(spacing);
            prop_assert!(joints.windows(2).all(|pair| pair[1].s_m > pair[0].s_m), "a joint twice");
            prop_assert!(joints.len() >= samples.len() && joints.len() <= samples.len() + 3);
            // The finer the samples, the nearer their chords come to the length.
            let chords: f64 = path.samples(1e-3).windows(2).map(|p| p[0].position().distance(p[1].position())).sum();
            prop_assert!(chords <= path.length_m() + 1e-6);
            prop_assert!(chords >= path.length_m() * 0.99);
        }
    }
}
