//! Whether beams pass where a surface is said to be: what stands is never seen through.

use super::TrackerConfig;
use super::track::{Sight, Track};
use crate::geometry::{Point, Pose, wrap_angle};
use crate::sense::{Reading, Scan};

/// A scan that is remembered, with where it was made.
#[derive(Clone, Debug, Default)]
pub(super) struct OldScan {
    pub(super) pose: Pose,
    pub(super) scan: Scan,
    /// How long ago \[s\].
    pub(super) age_s: f64,
}

impl OldScan {
    /// Takes the place of what was remembered; allocates nothing for a scan that is not longer.
    pub(super) fn replace(&mut self, pose: Pose, scan: &Scan) {
        (self.pose, self.age_s) = (pose, 0.0);
        self.scan.copy_from(scan);
    }
}

/// Hits of one surface are no farther apart than so many times the noise of ranges: the gaps between standing things are
/// wider, as a rule.
const WIDEST_GAP_NOISES: f64 = 3.0;

/// How many beams of one of the remembered scans have seen through what is seen of a track now.
pub(super) fn beams_before(
    track: &Track,
    sight: &Sight<'_>,
    scan: &Scan,
    (old, config): (&[OldScan], &TrackerConfig),
) -> u32 {
    let surface = Surface::of(track, sight.hits, (sight.sensor, scan), config);
    let old = old.iter().filter(|old| !old.scan.ranges_m.is_empty());
    old.map(|old| surface.beams_through(old.pose, &old.scan)).fold(0, u32::max)
}

/// How many beams of this scan see through what was seen of a track at its anchor.
pub(super) fn beams_now(track: &Track, pose: Pose, scan: &Scan, config: &TrackerConfig) -> u32 {
    let hits = &track.anchor.surface;
    Surface::of(track, hits, (pose.point(), scan), config).beams_through(pose, scan)
}

/// A surface that was seen: the line through hits that were made one after the other.
struct Surface<'a> {
    hits: &'a [Point],
    /// Two hits that are farther apart have nothing between them \[m\].
    gap_m: f64,
    /// No hit is farther than this from the truth \[m\].
    noise_m: f64,
}

impl<'a> Surface<'a> {
    fn of(
        track: &Track,
        hits: &'a [Point],
        (sensor, scan): (Point, &Scan),
        config: &TrackerConfig,
    ) -> Self {
        // Hits of neighbouring beams on one surface, seen at up to about 65 degrees. Between two that are far apart there may
        // be a gap that no beam met.
        let far_m = track.centre.distance(sensor) + track.radius_m;
        let noise_m = config.range_noise_m;
        let seen_m = noise_m + 2.5 * far_m * scan.step_rad();
        Self { hits, gap_m: seen_m.min(WIDEST_GAP_NOISES * noise_m), noise_m }
    }

    /// A beam this flat on a surface may miss it: the sine of about 25 degrees.
    const FLATTEST: f64 = 0.4;

    /// How many beams of a scan made at `pose` pass through the surface: between its ends as they are seen from there, not along
    /// it, and by more than errors explain.
    fn beams_through(&self, pose: Pose, scan: &Scan) -> u32 {
        let runs = self.hits.chunk_by(|a, b| a.distance(*b) <= self.gap_m);
        runs.map(|run| self.beams_through_run(run, pose, scan)).sum()
    }

    fn beams_through_run(&self, run: &[Point], pose: Pose, scan: &Scan) -> u32 {
        let (mut count, mut last_beam) = (0, None);
        let mut places = run.iter().map(|&hit| beam_number(hit, pose, scan));
        let mut place = places.next().flatten();
        for (pair, next) in run.windows(2).zip(places) {
            let ends = place.zip(next);
            place = next;
            let Some((low, high)) = ends.and_then(|ends| beams_between(ends, scan)) else {
                continue;
            };
            // No part of the line between two points is nearer than this.
            let least_m = pair[0].distance(pose.point()).min(pair[1].distance(pose.point()))
                - 0.5 * pair[0].distance(pair[1]);
            for beam in (low..=high).filter(|&beam| last_beam != Some(beam)) {
                let Some(free_m) = free_m(beam, scan).filter(|&free_m| free_m > least_m) else {
                    continue;
                };
                let (sin, cos) = libm::sincos(pose.theta + scan.bearing_rad(beam));
                let direction = Point::new(cos, sin);
                let passed = self.passes(free_m, direction, (pair[0], pair[1]), pose.point());
                count += u32::from(passed && self.is_inside(run, pose.point(), direction));
            }
            last_beam = Some(high);
        }
        count
    }

    /// Whether a line has parts of the surface to both sides of it, farther from it than errors explain: of a thing
    /// that stands there, it then meets something.
    fn is_inside(&self, run: &[Point], from: Point, direction: Point) -> bool {
        let aside = run.iter().map(|&hit| direction.cross(hit - from));
        let (low, high) =
            aside.fold((0.0f64, 0.0f64), |(low, high), at| (low.min(at), high.max(at)));
        low.abs().min(high) >= 2.0 * self.noise_m
    }

    /// Whether a beam that is free for so far passes between two hits and goes on.
    fn passes(&self, free_m: f64, direction: Point, (a, b): (Point, Point), from: Point) -> bool {
        let side = b - a;
        let across = direction.cross(side);
        let to_surface_m = (a - from).cross(side) / across;
        across.abs() > Self::FLATTEST * side.norm()
            && to_surface_m > 0.0
            && free_m > to_surface_m + 3.0 * self.noise_m
    }
}

/// The beams that look between two points, which are seen at these fractions of beams, if any.
fn beams_between((at_a, at_b): (f64, f64), scan: &Scan) -> Option<(usize, usize)> {
    let (low, high) = (at_a.min(at_b), at_a.max(at_b));
    let count = scan.ranges_m.len() as f64;
    // Two points to both sides of the seam of a full turn.
    if high - low > 0.5 * count {
        return None;
    }
    let (first, last) = (low.ceil().max(0.0), high.floor().min(count - 1.0));
    (first <= last).then_some((first as usize, last as usize))
}

/// At which beam a point is seen: a fraction between two of them. Outside the field of view it is below 0 or beyond
/// the last one.
pub(super) fn beam_number(point: Point, pose: Pose, scan: &Scan) -> Option<f64> {
    let step_rad = scan.angle_increment_rad;
    let is_usable = step_rad != 0.0 && point.is_finite();
    // A bearing from the middle beam, so that the seam lies opposite to it.
    let half = 0.5 * (scan.ranges_m.len() as f64 - 1.0);
    let middle_rad = scan.angle_min_rad + half * step_rad;
    let from_middle_rad = wrap_angle((point - pose.point()).heading() - pose.theta - middle_rad);
    is_usable.then(|| half + from_middle_rad / step_rad)
}

/// How far a beam reports that nothing stands \[m\]; none when it says nothing.
pub(super) fn free_m(beam: usize, scan: &Scan) -> Option<f64> {
    scan.reading(beam).map(Reading::free_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(ranges_m: &[f64]) -> Scan {
        Scan {
            angle_min_rad: -0.2,
            angle_increment_rad: 0.1,
            range_min_m: 0.0,
            range_max_m: 5.0,
            ranges_m: ranges_m.to_vec(),
        }
    }

    #[test]
    fn beams_through_a_wall_by_hand() {
        // A wall 2 m ahead, 0.5 m to both sides: it fills the bearings up to 0.245.
        let wall: Vec<Point> = (-5..=5).map(|i| Point::new(2.0, f64::from(i) * 0.1)).collect();
        let surface = |hits| Surface { hits, gap_m: 0.2, noise_m: 0.03 };
        let seen_from = |pose, ranges: &[f64]| surface(&wall).beams_through(pose, &scan(ranges));
        let through = |ranges: &[f64]| seen_from(Pose::default(), ranges);
        let inf = f64::INFINITY;
        assert_eq!(through(&[inf; 5]), 5);
        assert_eq!(through(&[2.05, 2.0, 2.0, 2.0, 2.05]), 0);
        assert_eq!(through(&[2.2, 2.0, f64::NAN, 2.15, 1.0]), 2);
        // The outer beams pass 9 cm from the ends.
        let coarse = Surface { noise_m: 0.05, ..surface(&wall) };
        assert_eq!(coarse.beams_through(Pose::default(), &scan(&[inf; 5])), 3);
        let gap = [Point::new(2.0, -0.4), Point::new(2.0, 0.4)];
        assert_eq!(surface(&gap).beams_through(Pose::default(), &scan(&[inf; 5])), 0);
        // From the other side, with the back to it, and along it.
        assert_eq!(seen_from(Pose::new(4.0, 0.0, std::f64::consts::PI), &[inf; 5]), 5);
        assert_eq!(seen_from(Pose::new(4.0, 0.0, 0.0), &[inf; 5]), 0);
        assert_eq!(seen_from(Pose::new(2.05, -2.0, std::f64::consts::FRAC_PI_2), &[inf; 5]), 0);
    }
}
