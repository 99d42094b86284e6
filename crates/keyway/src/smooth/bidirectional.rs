//! Bidirectional smoothing \[S1\]: a line -> the same line with its detours cut off, from the
//! start and then from the goal.
//!
//! The line is cut into points at a small spacing, and each kept point is connected with the
//! farthest later one that can be reached safely. A connection may therefore begin and end
//! anywhere on the line, not only at its corners as in [`super::LineOfSight`]. The pass from the
//! goal removes detours that the pass from the start has left.
//!
//! # Source
//! \[S1\]: bidirectional smoothing, steps 1 to 3. There are no equations.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | spacing of the points | [`BidirectionalSmoothingConfig::spacing_cells`] | cells | none is given |
//! | safety distance | [`BidirectionalSmoothingConfig::safety_distance_cells`] | cells | none is given |
//!
//! # Where this differs from the paper
//! - The paper takes "the node that is collision-free and farthest from the obstacle". This is
//!   read as the farthest along the line. [`Select::LargestClearance`] follows the wording of the
//!   paper: of the reachable points it takes the one with the largest distance from obstacles, and
//!   the farthest of several. (Along the line no two points are equally far, so there are no other
//!   ties to break.)
//! - Spacing and safety distance are half a cell, which is a reading.
//! - Each straight stretch is cut into equal parts, none longer than the spacing, and its ends are
//!   points too: otherwise the connection to the next point could cut a corner of the line.
//! - A connection keeps the safety distance, or the required clearance if that is larger. The next
//!   point can always be reached, so the line stays as it was wherever it is closer than that.
//! - The paper smooths once in each direction. A second run cuts the new line into new points, so
//!   it can shorten it further, and may need more points for that.
//! # Errors / cost
//! [`ConfigError`]. At most n tests per kept point for n points at the spacing. Few tests are
//! needed in practice, because whole stretches lie in the shadow of an obstacle that was found
//! before ([`Visibility`]).

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::stretches::Stretches;
use super::visibility::Visibility;
use super::{Smoothed, Smoother};
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline, Segment};
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// The smallest spacing \[cells\].
const LEAST_SPACING_CELLS: f64 = 0.01;

/// A straight stretch is never cut into more parts than this.
const MAX_PARTS: f64 = 1e6;

/// Selects the next point among those that can be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Select {
    /// The farthest along the line.
    Farthest,
    /// The one with the largest distance from obstacles.
    LargestClearance,
}

/// Directions in which the line is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Passes {
    /// From the start, then from the goal.
    Both,
    /// From the start alone.
    Forward,
    /// From the goal alone.
    Backward,
}

/// Parameters of the bidirectional smoothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct BidirectionalSmoothingConfig {
    /// Maximum spacing of the points that the line is cut into; at least 0.01 \[cells\].
    pub spacing_cells: f64,
    /// Selects the next point: the `farthest` reachable one along the line, or the reachable one
    /// with the `largest-clearance`.
    pub select: Select,
    /// Distance that a connection keeps from obstacles \[cells\].
    pub safety_distance_cells: f64,
    /// Directions: `both` as in the paper, `forward` from the start alone, or `backward` from the
    /// goal alone.
    pub passes: Passes,
}

impl BidirectionalSmoothingConfig {
    /// The paper's method, as read above; all values are readings.
    pub const PAPER: Self = Self {
        spacing_cells: 0.5,
        select: Select::Farthest,
        safety_distance_cells: 0.5,
        passes: Passes::Both,
    };
}

impl Default for BidirectionalSmoothingConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Smooths from the start and then from the goal.
#[derive(Clone, Debug)]
pub struct BidirectionalSmoothing {
    config: BidirectionalSmoothingConfig,
}

impl BidirectionalSmoothing {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional";

    /// The smoother with these parameters.
    ///
    /// # Errors
    /// [`ConfigError`] if the spacing or the safety distance is invalid; the error names it.
    pub fn new(config: BidirectionalSmoothingConfig) -> Result<Self, ConfigError> {
        let spacing = config.spacing_cells;
        if !(spacing >= LEAST_SPACING_CELLS && spacing.is_finite()) {
            let expected = "a number of at least 0.01";
            return Err(ConfigError::must_be("spacing_cells", expected, spacing));
        }
        let safety = config.safety_distance_cells;
        ConfigError::unless_not_negative("safety_distance_cells", safety)?;
        Ok(Self { config })
    }
}

impl SmootherParameters for BidirectionalSmoothingConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(BidirectionalSmoothing::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["spacing_cells", "select", "safety_distance_cells"]
    }

    fn safe_distance_m(&self, cell_m: f64) -> f64 {
        self.safety_distance_cells * cell_m
    }
}

impl Smoother for BidirectionalSmoothing {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        let cell_m = clearance.frame().resolution_m();
        let required =
            RequiredClearance::new(clearance, clearance_m, self.config.safe_distance_m(cell_m));
        let one_way = |line: &Polyline| {
            let (points, ends) = cut(line, self.config.spacing_cells * cell_m);
            match self.config.select {
                Select::Farthest => {
                    let stretches = Stretches::with_ends(&points, ends, clearance);
                    let mut visibility = Visibility::new(clearance, required.unsafe_within_m());
                    connected(&points, |at| visibility.farthest_safe(&stretches, at, &required))
                }
                Select::LargestClearance => {
                    let far_m = |&p| clearance.of_point(p, f64::INFINITY);
                    let clearances: Vec<f64> = points.iter().map(far_m).collect();
                    connected(&points, |at| roomiest(&points, &clearances, at, &required))
                }
            }
        };
        let backwards = |line: &Polyline| reversed(&one_way(&reversed(line)));
        // Step 1; then step 2, step 3, or both in sequence.
        let merged = line.merged();
        let smooth = match self.config.passes {
            Passes::Both => backwards(&one_way(&merged)),
            Passes::Forward => one_way(&merged),
            Passes::Backward => backwards(&merged),
        };
        Smoothed::straight(line, &smooth, &required)
    }
}

fn reversed(line: &Polyline) -> Polyline {
    Polyline::new(line.points().iter().rev().copied().collect())
}

/// Step 2, first half: points at a fixed spacing, including the corners, and the indices of the
/// corners and end points among them.
fn cut(line: &Polyline, spacing_m: f64) -> (Vec<Point>, Vec<usize>) {
    // A little less, so that rounding does not add a part.
    let parts_of = |stretch: Segment| {
        (stretch.length() / spacing_m * (1.0 - 1e-9)).ceil().min(MAX_PARTS) as u32
    };
    let mut points: Vec<Point> = line.points().first().copied().into_iter().collect();
    let mut ends: Vec<usize> = points.iter().map(|_| 0).collect();
    for stretch in line.segments() {
        let parts = parts_of(stretch);
        points.reserve(parts as usize + 1);
        let fraction = |part: u32| f64::from(part) / f64::from(parts);
        points.extend((1..parts).map(|part| stretch.a.lerp(stretch.b, fraction(part))));
        ends.push(points.len());
        points.push(stretch.b);
    }
    (points, ends)
}

/// Step 2, second half: from each kept point straight to the `next` one.
fn connected(points: &[Point], mut next: impl FnMut(usize) -> usize) -> Polyline {
    let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
    let mut at = 0;
    while at + 1 < points.len() {
        at = next(at);
        kept.push(points[at]);
    }
    Polyline::new(kept).merged()
}

fn roomiest(
    points: &[Point],
    clearances: &[f64],
    from: usize,
    required: &RequiredClearance<'_>,
) -> usize {
    let next = std::iter::once(from + 1);
    let by_clearance = |a: &usize, b: &usize| clearances[*a].total_cmp(&clearances[*b]);
    next.chain(reachable(points, from, required)).max_by(by_clearance).unwrap_or(from + 1)
}

/// The points beyond the next one that a safe connection leads to, in order.
fn reachable<'a>(
    points: &'a [Point],
    from: usize,
    required: &'a RequiredClearance<'_>,
) -> impl Iterator<Item = usize> + 'a {
    // No connection is safe from a point that is itself too close to an obstacle or the border.
    let beyond = if required.is_safe_point(points[from]) { from + 2..points.len() } else { 0..0 };
    beyond.filter(move |&to| required.is_safe(Segment::new(points[from], points[to])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{GridFrame, OccupancyGrid};
    use proptest::prelude::*;

    /// The square from (2, 1) to (3, 2).
    const ONE: [&str; 3] = [".....", "..#..", "....."];
    const BELOW: [[f64; 2]; 5] = [[0.5, 1.5], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5], [4.5, 1.5]];

    fn line(points: &[[f64; 2]]) -> Polyline {
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    fn run(config: &BidirectionalSmoothingConfig, clearance_m: f64) -> (Vec<[f64; 2]>, Smoothed) {
        run_on(&BELOW, config, clearance_m)
    }

    fn run_on(
        points: &[[f64; 2]],
        config: &BidirectionalSmoothingConfig,
        clearance_m: f64,
    ) -> (Vec<[f64; 2]>, Smoothed) {
        let grid = OccupancyGrid::from_ascii(&ONE);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let smoother = BidirectionalSmoothing::new(config.clone()).unwrap();
        let done = smoother.smooth(&line(points).into(), &clearance, clearance_m);
        let points = done.path.flattened(0.0).points().iter().map(|&p| p.into()).collect();
        (points, done)
    }

    fn config(select: Select, safety_distance_cells: f64) -> BidirectionalSmoothingConfig {
        let passes = Passes::Both;
        BidirectionalSmoothingConfig { spacing_cells: 1.0, select, safety_distance_cells, passes }
    }

    #[test]
    fn points_at_a_spacing() {
        // 1.414 m in two parts, 2 m in two parts, 1.414 m in two parts.
        let (points, ends) = cut(&line(&BELOW).merged(), 1.0);
        assert_eq!(ends, [0, 2, 4, 6]);
        let expected =
            [[0.5, 1.5], [1.0, 1.0], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5], [4.0, 1.0], [4.5, 1.5]];
        assert_eq!(points, expected.map(Point::from));
        assert_eq!(cut(&line(&[[0.0, 0.0], [0.3, 0.0]]), 0.1).0.len(), 4);
        // Three parts, though 2.1 / 0.7 is a little more than 3 when it is computed.
        assert_eq!(cut(&line(&[[0.0, 0.0], [2.1, 0.0]]), 0.7).0.len(), 4);
        assert!(cut(&line(&[]), 1.0).0.is_empty());
    }

    #[test]
    fn points_on_a_straight_stretch_change_nothing() {
        // (1.7, 0.5) is never a candidate: the points of the stretch are 1 m apart, from (1.5,
        // 0.5) on.
        let more = [BELOW[0], BELOW[1], [1.7, 0.5], BELOW[2], BELOW[3], BELOW[4]];
        for select in [Select::Farthest, Select::LargestClearance] {
            let config = config(select, 0.5);
            assert_eq!(run_on(&more, &config, 0.0), run(&config, 0.0));
        }
    }

    #[test]
    fn distances_in_cells_are_those_of_the_map() {
        let grid = OccupancyGrid::from_ascii(&ONE);
        let frame = GridFrame::new(5, 3, 0.1, Pose::default()).unwrap();
        let clearance = Clearance::new(&frame, grid.occupied());
        let small = Polyline::new(BELOW.iter().map(|&at| Point::from(at) * 0.1).collect());
        for (select, safe_cells) in [(Select::Farthest, 0.2), (Select::LargestClearance, 0.0)] {
            let config = config(select, safe_cells);
            let smoother = BidirectionalSmoothing::new(config.clone()).unwrap();
            let small = small.clone().into();
            let done = smoother.smooth(&small, &clearance, 0.0).path.flattened(0.0);
            let expected = run(&config, 0.0).0;
            assert_eq!(done.points().len(), expected.len(), "{done:?}");
            for (at, &large) in done.points().iter().zip(&expected) {
                assert!(at.distance(Point::from(large) * 0.1) < 1e-9, "{at:?} {large:?}");
            }
        }
    }

    #[test]
    fn forward_and_then_backward_by_hand() {
        // Forward, the farthest point visible from (0.5, 1.5) is (3.5, 0.5), along a line that
        // touches the square at (2, 1), and from there the goal.
        let grid = OccupancyGrid::from_ascii(&ONE);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let required = RequiredClearance::new(&clearance, 0.0, 0.0);
        let (points, _) = cut(&line(&BELOW), 1.0);
        let stretches = Stretches::new(&points, &clearance);
        let mut visibility = Visibility::new(&clearance, required.unsafe_within_m());
        let forward = connected(&points, |at| visibility.farthest_safe(&stretches, at, &required));
        assert_eq!(forward, line(&[[0.5, 1.5], [3.5, 0.5], [4.5, 1.5]]));
        // Backward, its points are (4, 1), (3.5, 0.5), (2.75, 0.75), (2, 1), (1.25, 1.25), (0.5,
        // 1.5). From the goal (2.75, 0.75) is visible, at (3, 0.857), but not (2, 1).
        let (points, done) = run(&config(Select::Farthest, 0.0), 0.0);
        assert_eq!(points, [[0.5, 1.5], [2.75, 0.75], [4.5, 1.5]]);
        assert_eq!(
            (done.removed_points, done.inserted_points, done.kept_clearance_m),
            (2, 1, None)
        );
        // Backward alone, the points of the line are 0.707 m and 1 m apart: (1.5, 0.5) is visible
        // from the goal, (1, 1) is not, and from (1.5, 0.5) the start is.
        let one_way = |passes| {
            run(&BidirectionalSmoothingConfig { passes, ..config(Select::Farthest, 0.0) }, 0.0).0
        };
        assert_eq!(one_way(Passes::Forward), [[0.5, 1.5], [3.5, 0.5], [4.5, 1.5]]);
        assert_eq!(one_way(Passes::Backward), [[0.5, 1.5], [1.5, 0.5], [4.5, 1.5]]);
    }

    #[test]
    fn a_second_run_can_shorten_further() {
        // From (0, 0) the square hides (4, 1.5) and the goal. From the goal, the farthest visible
        // of the points 0.806 m apart is (3.2, 0.4); (2.4, 0.3) lies behind the square, at (3,
        // 1.125). The second run cuts the new stretch into three parts. From (0, 0) it sees
        // (3.467, 1.1): the line passes below the square, at (3, 0.952).
        let (once, _) =
            run_on(&[[0.0, 0.0], [4.0, 0.5], [4.0, 2.5]], &config(Select::Farthest, 0.0), 0.0);
        let (twice, _) = run_on(&once, &config(Select::Farthest, 0.0), 0.0);
        let is_near = |a: [f64; 2], b: [f64; 2]| Point::from(a).distance(b.into()) < 1e-9;
        assert!(once.len() == 3 && is_near(once[1], [3.2, 0.4]), "{once:?}");
        assert!(twice.len() == 3 && is_near(twice[1], [3.2 + 0.8 / 3.0, 1.1]), "{twice:?}");
        assert!(line(&twice).length_m() < line(&once).length_m() - 0.3);
    }

    #[test]
    fn the_safety_distance_is_kept() {
        // From (0.5, 1.5) the connection with (1.5, 0.5) is 0.707 m from (2, 1), that with (2.5,
        // 0.5) 0.224 m. From (1.5, 0.5) those with (4, 1) and (4.5, 1.5) are nearer than 0.2 m to
        // (3, 1).
        let expected = [[0.5, 1.5], [1.5, 0.5], [3.5, 0.5], [4.5, 1.5]];
        let (points, done) = run(&config(Select::Farthest, 0.5), 0.0);
        assert_eq!((points, done.kept_clearance_m), (expected.to_vec(), None));
        assert_eq!(run(&config(Select::Farthest, 0.0), 0.5).0, expected, "the larger of both");
        // More than the line itself keeps: the line stays as it was, and the shortfall is
        // reported.
        let (points, done) = run(&config(Select::Farthest, 0.6), 0.0);
        assert_eq!((points, done.kept_clearance_m), (expected.to_vec(), Some(0.5)));
    }

    #[test]
    fn the_largest_clearance_by_hand() {
        // Clearances of the seven points: 1.5, 1, 0.707, 0.5, 0.707, 1, 1.5. Of those visible from
        // the first, (1, 1) has the largest; from there (4, 1), along the square's edge.
        let (points, _) = run(&config(Select::LargestClearance, 0.0), 0.0);
        assert_eq!(points, [[0.5, 1.5], [1.0, 1.0], [4.0, 1.0], [4.5, 1.5]]);
    }

    #[test]
    fn only_usable_numbers_are_accepted() {
        let paper = BidirectionalSmoothingConfig::PAPER;
        assert!(BidirectionalSmoothing::new(paper.clone()).is_ok());
        for spacing_cells in [0.0, 0.009, f64::NAN, f64::INFINITY] {
            let config = BidirectionalSmoothingConfig { spacing_cells, ..paper.clone() };
            assert_eq!(BidirectionalSmoothing::new(config).unwrap_err().path, "spacing_cells");
        }
        let config = BidirectionalSmoothingConfig { safety_distance_cells: -1.0, ..paper };
        assert_eq!(BidirectionalSmoothing::new(config).unwrap_err().path, "safety_distance_cells");
    }

    proptest! {
        #[test]
        fn the_farthest_is_the_last_that_can_be_reached(cells in prop::collection::vec(prop::bool::weighted(0.15), 15 * 12),
                                                        corners in prop::collection::vec((0.0..15.0f64, 0.0..12.0f64), 2..7),
                                                        clearance_m in prop_oneof![Just(0.0), 0.0..1.0f64], safe_m in 0.0..1.0f64) {
            let frame = GridFrame::new(15, 12, 1.0, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            let corners: Vec<[f64; 2]> = corners.into_iter().map(|(x, y)| [x, y]).collect();
            let (points, _) = cut(&line(&corners), 0.5);
            let stretches = Stretches::new(&points, &clearance);
            let required = RequiredClearance::new(&clearance, clearance_m, safe_m);
            let mut visibility = Visibility::new(&clearance, required.unsafe_within_m());
            for from in 0..points.len() - 1 {
                let expected = reachable(&points, from, &required).last().unwrap_or(from + 1);
                prop_assert_eq!(visibility.farthest_safe(&stretches, from, &required), expected);
            }
        }
    }
}
