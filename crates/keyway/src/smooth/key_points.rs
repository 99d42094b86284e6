//! Key-point optimisation \[You2021\]: a line -> its turning points, and points that keep it away
//! from obstacles.
//!
//! Jump points are dropped one after another while the connection past them is free. If the result
//! passes an obstacle too closely, the jump point with the shortest safe detour is put back.
//! Unlike [`super::LineOfSight`], it does not search for the farthest visible point, but stops at
//! the first point that is not visible.
//!
//! # Source
//! \[You2021\]: section 1.4, steps 1 to 4. Its distances have no equation numbers.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | Q = `q_1`, `q_2`, ... | [`KeyPointSmoothingConfig::candidates`] | m | the jump points |
//! | U = `u_1`, `u_2`, ... | the points that are kept | m | |
//! | d | the distance of a connection from the obstacles' squares | m | |
//! | D | [`KeyPointSmoothingConfig::safe_distance_m`] | m | 0.5 |
//! | L | the length of the path over a point that is put back | m | |
//!
//! # Where this differs from the paper
//! - Jump points are those of [`Plan::jump_points`](crate::plan::Plan::jump_points): for the
//!   paper's planner, the nodes of both searches, straight and diagonal jump points and the node
//!   at which the two sides met. For a planner without jump points, the turning points of its path
//!   are used. If start and goal are not cell centres, the centres of their cells are jump points,
//!   too.
//! - [`KeyPointCandidates::Cells`] is not in the paper: Q then holds every cell of the path, even
//!   those between jump points. `docs/lab/findings.md` compares the two.
//! - A connection is free if it keeps the required clearance. If D is smaller than that, the
//!   clearance replaces D.
//! - d >= D allows for 1e-9 m: beside a wall of 1 m cells d is 0.5 m = D, so a strict test would
//!   refuse every point there. D is kept from obstacles, not from the map's border.
//! - If no point of Q satisfies step 3, the pair stays as it is, and [`Smoothed::kept_clearance_m`]
//!   reports the distance that is kept. Of several points with the same L, the first is taken.
//! - A second run can shorten the line further, because it has fewer points to stop at.
//!
//! # Errors / cost
//! [`ConfigError`] for a distance that is not a number of at least 0. Step 2 tests the connections
//! with a straight stretch together, as a triangle, and halves the stretch if an obstacle is
//! close. Step 3 skips candidates that are not shorter than the best so far, or that lie behind an
//! obstacle that was found before ([`Visibility`]).

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::stretches::Stretches;
use super::visibility::Visibility;
use super::{Smoothed, Smoother};
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline, Segment};
use crate::map::Clearance;
use serde::{Deserialize, Serialize};

/// The points of a path that key points are chosen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum KeyPointCandidates {
    /// Its jump points; for a planner without jump points, those at which the path turns.
    JumpPoints,
    /// All its cells.
    Cells,
}

/// Parameters of the key-point optimisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct KeyPointSmoothingConfig {
    /// Q, the points that key points are chosen from: the `jump-points` of the path (its turning
    /// points for a planner without jump points), or all its `cells`.
    pub candidates: KeyPointCandidates,
    /// Safe distance D \[m\]: if a connection is closer to an obstacle, a point of Q is put back,
    /// provided one gives a safe detour.
    pub safe_distance_m: f64,
}

impl KeyPointSmoothingConfig {
    /// The paper's values.
    pub const PAPER: Self =
        Self { candidates: KeyPointCandidates::JumpPoints, safe_distance_m: 0.5 };
}

impl Default for KeyPointSmoothingConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Smooths by key points.
#[derive(Clone, Debug)]
pub struct KeyPointSmoothing {
    config: KeyPointSmoothingConfig,
}

impl KeyPointSmoothing {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "key-points";

    /// The smoother with these parameters.
    ///
    /// # Errors
    /// [`ConfigError`] if the safe distance is not a number of at least 0.
    pub fn new(config: KeyPointSmoothingConfig) -> Result<Self, ConfigError> {
        ConfigError::unless_not_negative("safe_distance_m", config.safe_distance_m)?;
        Ok(Self { config })
    }
}

impl SmootherParameters for KeyPointSmoothingConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(KeyPointSmoothing::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn safe_distance_m(&self, _: f64) -> f64 {
        self.safe_distance_m
    }
}

impl Smoother for KeyPointSmoothing {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let required = RequiredClearance::new(clearance, clearance_m, self.config.safe_distance_m);
        // Step 1.
        let q: Vec<Point> = match self.config.candidates {
            KeyPointCandidates::JumpPoints => line.jump_points().collect(),
            KeyPointCandidates::Cells => line.polyline().points().to_vec(),
        };
        let stretches = Stretches::new(&q, clearance);
        let u = turning_points(&stretches, &required);
        let visibility = Visibility::new(clearance, required.unsafe_within_m());
        let u = with_safe_detours(&stretches, &u, &required, visibility);
        // Step 4.
        let smooth = Polyline::new(u.into_iter().map(|i| q[i]).collect());
        Smoothed::straight(line.polyline(), &smooth, &required)
    }
}

/// Step 2: the indices of the points that cannot be skipped because the connection past them is
/// not free, and of both ends.
fn turning_points(q: &Stretches<'_>, required: &RequiredClearance<'_>) -> Vec<usize> {
    let count = q.points().len();
    let mut u: Vec<usize> = (0..count.min(1)).collect();
    let mut from = 0;
    while from + 1 < count {
        let end = first_not_free(q, from, required).unwrap_or(count);
        from = end - 1;
        u.push(from);
    }
    u
}

/// The first point after the next one that has no free connection.
fn first_not_free(
    q: &Stretches<'_>,
    from: usize,
    required: &RequiredClearance<'_>,
) -> Option<usize> {
    let count = q.points().len();
    let mut at = from + 2;
    while at < count {
        let end = q.end_of_stretch(at);
        let found = first_not_free_of(q, from, (at, end), required);
        if found.is_some() {
            return found;
        }
        at = end + 1;
    }
    None
}

/// As [`first_not_free`], for points on a straight stretch. All connections to them lie in a
/// triangle.
fn first_not_free_of(
    q: &Stretches<'_>,
    from: usize,
    (first, last): (usize, usize),
    required: &RequiredClearance<'_>,
) -> Option<usize> {
    let points = q.points();
    if first == last {
        return (!required.is_free(Segment::new(points[from], points[first]))).then_some(first);
    }
    if required.is_free_triangle([points[from], points[first], points[last]]) {
        return None;
    }
    let middle = first.midpoint(last);
    first_not_free_of(q, from, (first, middle), required)
        .or_else(|| first_not_free_of(q, from, (middle + 1, last), required))
}

/// Step 3: between each pair whose connection is too close to an obstacle, the point of the best
/// safe detour.
fn with_safe_detours(
    q: &Stretches<'_>,
    u: &[usize],
    required: &RequiredClearance<'_>,
    mut visibility: Visibility<'_>,
) -> Vec<usize> {
    let mut kept: Vec<usize> = u.first().copied().into_iter().collect();
    for pair in u.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if !required.keeps_safe_distance(Segment::new(q.points()[from], q.points()[to])) {
            kept.extend(shortest_safe_detour(q, from, to, required, &mut visibility));
        }
        kept.push(to);
    }
    kept
}

/// The point `q_i` between `u_j` and `u_j+1` over which the path is safe and its length L
/// smallest; the first one of several.
fn shortest_safe_detour(
    q: &Stretches<'_>,
    from: usize,
    to: usize,
    required: &RequiredClearance<'_>,
    visibility: &mut Visibility<'_>,
) -> Option<usize> {
    let points = q.points();
    if ![from, to].iter().all(|&end| required.is_safe_point(points[end])) {
        return None;
    }
    let mut best: Option<(f64, usize)> = None;
    for i in from + 1..to {
        let length_m = points[from].distance(points[i]) + points[i].distance(points[to]);
        let is_shorter = best.is_none_or(|(least_m, _)| length_m < least_m);
        if is_shorter && [from, to].iter().all(|&end| visibility.is_safe(q, end, i, required)) {
            best = Some((length_m, i));
        }
    }
    best.map(|(_, i)| i)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Path, Point, Pose};
    use crate::map::{GridFrame, OccupancyGrid};
    use proptest::prelude::*;

    /// The square from (2, 1) to (3, 2).
    const ONE: [&str; 3] = [".....", "..#..", "....."];

    fn run(points: &[[f64; 2]], safe_distance_m: f64) -> (Vec<[f64; 2]>, Smoothed) {
        let grid = OccupancyGrid::from_ascii(&ONE);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let line = Polyline::new(points.iter().map(|&p| p.into()).collect());
        let config = KeyPointSmoothingConfig { safe_distance_m, ..KeyPointSmoothingConfig::PAPER };
        let done = KeyPointSmoothing::new(config).unwrap().smooth(&line.into(), &clearance, 0.0);
        let points = done.path.flattened(0.0).points().iter().map(|&p| p.into()).collect();
        (points, done)
    }

    #[test]
    fn step_2_drops_points_past_which_the_line_is_free() {
        let line = [[0.5, 1.5], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5], [4.5, 1.5]];
        // From (0.5, 1.5) the connection to (2.5, 0.5) is free, and so is that to (3.5, 0.5),
        // which touches the square at (2, 1), but not that to (4.5, 1.5), along y = 1.5.
        let (points, done) = run(&line, 0.0);
        assert_eq!(points, [[0.5, 1.5], [3.5, 0.5], [4.5, 1.5]]);
        // (2.5, 0.5) is not a corner.
        assert_eq!(
            (done.removed_points, done.inserted_points, done.kept_clearance_m),
            (1, 0, None)
        );
    }

    #[test]
    fn step_3_puts_the_shortest_safe_detour_back() {
        // (0.5, 1.5) - (3.5, 0.5) touches the square. Over (1.5, 0.5): the first leg is x + y = 2,
        // at a distance of 1 / sqrt(2) from (2, 1); the second is y = 0.5, 0.5 m away; L = 3.414
        // m. Over (2.5, 0.5): x + 2 y = 3.5, 0.5 / sqrt(5) = 0.224 m.
        let line = [[0.5, 1.5], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5], [4.5, 1.5]];
        let (points, done) = run(&line, 0.5);
        assert_eq!(points, [[0.5, 1.5], [1.5, 0.5], [3.5, 0.5], [4.5, 1.5]]);
        assert_eq!((done.removed_points, done.kept_clearance_m), (0, None), "0.5 m is enough");
        // Over (1.75, 0.5): x + 1.25 y = 2.375, 0.875 / 1.601 = 0.547 m; L = 1.601 + 1.75 = 3.351
        // m.
        let line = [[0.5, 1.5], [1.5, 0.5], [1.75, 0.5], [2.5, 0.5], [3.5, 0.5], [4.5, 1.5]];
        assert_eq!(run(&line, 0.5).0, [[0.5, 1.5], [1.75, 0.5], [3.5, 0.5], [4.5, 1.5]]);
    }

    #[test]
    fn step_2_stops_at_the_first_point_that_is_hidden() {
        // Both ends of the last stretch are visible from (0.5, 1.5), past the square on either
        // side, but (4.5, 1.5) between them is not.
        let line = [[0.5, 1.5], [2.5, 0.1], [4.5, 0.1], [4.5, 1.5], [4.5, 2.9]];
        assert_eq!(run(&line, 0.0).0, [line[0], line[2], line[4]]);
    }

    #[test]
    fn of_detours_of_the_same_length_the_first_is_taken() {
        // y = 0.5 is 0.5 m below the square. Over (1.5, 0.2) the second leg is 0.65 m below (3,
        // 1). Over (3.5, 0.2) the first leg is as far below (2, 1), and both detours are equally
        // long.
        let line = [[0.5, 0.5], [1.5, 0.2], [3.5, 0.2], [4.5, 0.5]];
        assert_eq!(run(&line, 0.6).0, [line[0], line[1], line[3]]);
        let back = [line[3], line[2], line[1], line[0]];
        assert_eq!(run(&back, 0.6).0, [line[3], line[2], line[0]]);
    }

    #[test]
    fn a_pair_without_a_safe_detour_stays_and_is_reported() {
        // The path below the square is 0.5 m from it.
        let line = [[0.5, 1.5], [1.5, 0.5], [2.5, 0.5], [3.5, 0.5], [4.5, 1.5]];
        let (points, done) = run(&line, 0.6);
        assert_eq!(points, [[0.5, 1.5], [3.5, 0.5], [4.5, 1.5]]);
        assert_eq!(done.kept_clearance_m, Some(0.0));
    }

    #[test]
    fn a_second_run_can_drop_more() {
        // (3.5, 1.5) is not visible from the start, so (3.5, 0.5) is kept, although the goal is
        // visible: the connection is at y = 0.5 + (x - 0.5) / 8, below the square. (3.5, 1.5)
        // itself is dropped.
        let (once, _) = run(&[[0.5, 0.5], [3.5, 0.5], [3.5, 1.5], [4.5, 1.0]], 0.0);
        assert_eq!(once, [[0.5, 0.5], [3.5, 0.5], [4.5, 1.0]]);
        assert_eq!(run(&once, 0.0).0, [[0.5, 0.5], [4.5, 1.0]]);
    }

    #[test]
    fn only_distances_are_accepted() {
        let check = |safe_distance_m| {
            let paper = KeyPointSmoothingConfig::PAPER;
            KeyPointSmoothing::new(KeyPointSmoothingConfig { safe_distance_m, ..paper })
        };
        assert!(check(0.0).is_ok());
        for value in [-0.1, f64::NAN, f64::INFINITY] {
            assert_eq!(check(value).unwrap_err().path, "safe_distance_m");
        }
    }

    /// Steps 2 and 3, with every connection tried.
    fn by_trying(points: &[Point], required: &RequiredClearance<'_>) -> Vec<usize> {
        let way = |i: usize, k: usize| Segment::new(points[i], points[k]);
        let mut u = vec![0];
        while u[u.len() - 1] + 1 < points.len() {
            let from = u[u.len() - 1];
            let hidden = (from + 2..points.len()).find(|&k| !required.is_free(way(from, k)));
            u.push(hidden.unwrap_or(points.len()) - 1);
        }
        let mut kept = vec![0];
        for pair in u.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length_m = |i: usize| way(from, i).length() + way(i, to).length();
            let safe = (from + 1..to)
                .filter(|&i| required.is_safe(way(from, i)) && required.is_safe(way(to, i)));
            if !required.keeps_safe_distance(way(from, to)) {
                // The first of equal ones.
                kept.extend(safe.min_by(|&a, &b| length_m(a).total_cmp(&length_m(b))));
            }
            kept.push(to);
        }
        kept
    }

    proptest! {
        #[test]
        fn triangles_and_shadows_change_nothing(cells in prop::collection::vec(prop::bool::weighted(0.08), 15 * 12),
                                                corners in prop::collection::vec((0..30u32, 0..24u32), 2..7),
                                                clearance_m in prop_oneof![Just(0.0), 0.0..0.5f64],
                                                safe_m in prop_oneof![Just(0.5), 0.0..1.2f64]) {
            let frame = GridFrame::new(15, 12, 1.0, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            let required = RequiredClearance::new(&clearance, clearance_m, safe_m);
            // Straight stretches with points all along.
            let halves = |(x, y): (u32, u32)| Point::new(0.5 * f64::from(x), 0.5 * f64::from(y));
            let mut points = vec![halves(corners[0])];
            for pair in corners.windows(2).filter(|pair| pair[0] != pair[1]) {
                let (a, b) = (halves(pair[0]), halves(pair[1]));
                points.extend((1..=6).map(|k| a.lerp(b, f64::from(k) / 6.0)));
            }
            let config = KeyPointSmoothingConfig { safe_distance_m: safe_m, ..KeyPointSmoothingConfig::PAPER };
            let smoother = KeyPointSmoothing::new(config.clone()).unwrap();
            let path = smoother.smooth(&Polyline::new(points.clone()).into(), &clearance, clearance_m).path;
            let kept = by_trying(&points, &required).into_iter().map(|i| points[i]).collect();
            prop_assert_eq!(path, Path::from(&Polyline::new(kept).merged()));
        }
    }
}
