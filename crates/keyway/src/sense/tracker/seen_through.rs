//! Contradictions between scans: beams that pass through an observed surface. A stationary
//! obstacle is never seen through.

use super::TrackerConfig;
use super::track::{Sight, Track};
use crate::geometry::{Point, Shift};
use crate::map::GridFrame;
use crate::sense::ProjectedScan;
use serde::{Deserialize, Serialize};

/// Number of remembered scans of one sensor, and the time between them \[s\].
const OLD_SCANS: usize = 4;
const OLD_SCAN_STEP_S: f64 = 0.25;

/// Remembered scans of one sensor.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct OldScans {
    scans: [OldScan; OLD_SCANS],
    remembered: usize,
}

/// A remembered scan.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct OldScan {
    scan: ProjectedScan,
    /// Age \[s\].
    age_s: f64,
}

impl OldScans {
    /// Advances the time.
    pub(super) fn age(&mut self, elapsed_s: f64) {
        self.scans.iter_mut().for_each(|old| old.age_s += elapsed_s);
    }

    /// Moves all remembered scans.
    pub(super) fn shift(&mut self, frame: &GridFrame, shift: &Shift) {
        self.scans.iter_mut().for_each(|old| old.scan.shift(frame, shift));
    }

    fn used(&self) -> impl Iterator<Item = &OldScan> {
        self.scans.iter().filter(|old| !old.scan.is_empty())
    }

    /// Remembers a scan from time to time, in place of the oldest one. Does not allocate unless
    /// the new scan is longer.
    pub(super) fn remember(&mut self, scan: &ProjectedScan) {
        if scan.is_empty() {
            return;
        }
        let youngest_s = self.used().map(|old| old.age_s).fold(f64::INFINITY, f64::min);
        // Ages are sums of cycle times, hence the tolerance.
        if youngest_s >= OLD_SCAN_STEP_S * (1.0 - 1e-9) {
            let oldest = &mut self.scans[self.remembered % OLD_SCANS];
            oldest.age_s = 0.0;
            oldest.scan.copy_from(scan);
            self.remembered = self.remembered.wrapping_add(1);
        }
    }
}

/// Largest gap between hits of one surface, in multiples of the range noise: gaps between
/// stationary objects are usually wider.
const WIDEST_GAP_NOISES: f64 = 3.0;

/// Largest number of beams of one remembered scan that have seen through the present surface of a
/// track.
pub(super) fn beams_before(
    track: &Track,
    sight: &Sight<'_>,
    scan: &ProjectedScan,
    (old, config): (&[OldScans], &TrackerConfig),
) -> u32 {
    let surface = Surface::of(track, sight.hits, scan, config);
    let old = old.iter().flat_map(OldScans::used);
    old.map(|old| surface.beams_through(&old.scan)).fold(0, u32::max)
}

/// Number of beams of this scan that see through the surface of a track at its anchor.
pub(super) fn beams_now(track: &Track, scan: &ProjectedScan, config: &TrackerConfig) -> u32 {
    Surface::of(track, &track.anchor.surface, scan, config).beams_through(scan)
}

/// An observed surface: the line through successive hits.
struct Surface<'a> {
    hits: &'a [Point],
    /// Largest distance between two hits with a surface between them \[m\].
    gap_m: f64,
    /// Largest error of a hit \[m\].
    noise_m: f64,
}

impl<'a> Surface<'a> {
    fn of(track: &Track, hits: &'a [Point], scan: &ProjectedScan, config: &TrackerConfig) -> Self {
        // Hits of neighbouring beams on one surface, seen at up to about 65 degrees. Between two
        // that are far apart there may be a gap that no beam hit.
        let far_m = track.centre.distance(scan.pose().point()) + track.radius_m;
        let noise_m = config.range_noise_m;
        let seen_m = noise_m + 2.5 * far_m * scan.step_rad();
        Self { hits, gap_m: seen_m.min(WIDEST_GAP_NOISES * noise_m), noise_m }
    }

    /// Sine of the flattest angle of a beam on a surface that it cannot miss: about 25 degrees.
    const FLATTEST: f64 = 0.4;

    /// Number of beams of a scan that pass through the surface: between its ends as seen from the
    /// sensor, not along it, and by more than errors explain.
    fn beams_through(&self, scan: &ProjectedScan) -> u32 {
        let runs = self.hits.chunk_by(|a, b| a.distance(*b) <= self.gap_m);
        runs.map(|run| self.beams_through_run(run, scan)).sum()
    }

    fn beams_through_run(&self, run: &[Point], scan: &ProjectedScan) -> u32 {
        let from = scan.pose().point();
        let (mut count, mut last_beam) = (0, None);
        let mut places = run.iter().map(|&hit| scan.beam_towards(hit));
        let mut place = places.next().flatten();
        for (pair, next) in run.windows(2).zip(places) {
            let ends = place.zip(next);
            place = next;
            let Some((low, high)) = ends.and_then(|ends| beams_between(ends, scan)) else {
                continue;
            };
            // Lower bound on the distance of the line between the two points.
            let least_m = pair[0].distance(from).min(pair[1].distance(from))
                - 0.5 * pair[0].distance(pair[1]);
            for beam in (low..=high).filter(|&beam| last_beam != Some(beam)) {
                let Some(free_m) = scan.free_m(beam).filter(|&free_m| free_m > least_m) else {
                    continue;
                };
                let direction = scan.direction(beam);
                let passed = self.passes(free_m, direction, (pair[0], pair[1]), from);
                count += u32::from(passed && self.is_inside(run, from, direction));
            }
            last_beam = Some(high);
        }
        count
    }

    /// True if parts of the surface lie to both sides of a ray, farther from it than errors
    /// explain: a ray through a stationary object of this surface would hit it.
    fn is_inside(&self, run: &[Point], from: Point, direction: Point) -> bool {
        let aside = run.iter().map(|&hit| direction.cross(hit - from));
        let (low, high) =
            aside.fold((0.0f64, 0.0f64), |(low, high), at| (low.min(at), high.max(at)));
        low.abs().min(high) >= 2.0 * self.noise_m
    }

    /// True if a beam that is free for `free_m` passes between two hits and continues.
    fn passes(&self, free_m: f64, direction: Point, (a, b): (Point, Point), from: Point) -> bool {
        let side = b - a;
        let across = direction.cross(side);
        let to_surface_m = (a - from).cross(side) / across;
        across.abs() > Self::FLATTEST * side.norm()
            && to_surface_m > 0.0
            && free_m > to_surface_m + 3.0 * self.noise_m
    }
}

/// The beams between two points, given by their fractional beam indices; `None` if there are
/// none.
fn beams_between((at_a, at_b): (f64, f64), scan: &ProjectedScan) -> Option<(usize, usize)> {
    let (low, high) = (at_a.min(at_b), at_a.max(at_b));
    let count = scan.len() as f64;
    // The points are on either side of the seam of a full turn.
    if high - low > 0.5 * count {
        return None;
    }
    let (first, last) = (low.ceil().max(0.0), high.floor().min(count - 1.0));
    (first <= last).then_some((first as usize, last as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::GridFrame;
    use crate::robot::Footprint;
    use crate::sense::Scan;

    fn scan(pose: Pose, ranges_m: &[f64]) -> ProjectedScan {
        let frame = GridFrame::new(9, 9, 1.0, Pose::default()).unwrap();
        let scan = Scan {
            angle_min_rad: -0.2,
            angle_increment_rad: 0.1,
            range_min_m: 0.0,
            range_max_m: 5.0,
            ranges_m: ranges_m.to_vec(),
        };
        ProjectedScan::new(&frame, &Footprint::POINT, pose, &scan)
    }

    #[test]
    fn beams_through_a_wall_by_hand() {
        // A wall 2 m ahead, 0.5 m to both sides: it covers the bearings up to 0.245.
        let wall: Vec<Point> = (-5..=5).map(|i| Point::new(2.0, f64::from(i) * 0.1)).collect();
        let surface = |hits| Surface { hits, gap_m: 0.2, noise_m: 0.03 };
        let seen_from = |pose, ranges: &[f64]| surface(&wall).beams_through(&scan(pose, ranges));
        let through = |ranges: &[f64]| seen_from(Pose::default(), ranges);
        let inf = f64::INFINITY;
        assert_eq!(through(&[inf; 5]), 5);
        assert_eq!(through(&[2.05, 2.0, 2.0, 2.0, 2.05]), 0);
        assert_eq!(through(&[2.2, 2.0, f64::NAN, 2.15, 1.0]), 2);
        // The outer beams pass 9 cm from the ends.
        let coarse = Surface { noise_m: 0.05, ..surface(&wall) };
        assert_eq!(coarse.beams_through(&scan(Pose::default(), &[inf; 5])), 3);
        let gap = [Point::new(2.0, -0.4), Point::new(2.0, 0.4)];
        assert_eq!(surface(&gap).beams_through(&scan(Pose::default(), &[inf; 5])), 0);
        // From the other side, facing away from it, and along it.
        assert_eq!(seen_from(Pose::new(4.0, 0.0, std::f64::consts::PI), &[inf; 5]), 5);
        assert_eq!(seen_from(Pose::new(4.0, 0.0, 0.0), &[inf; 5]), 0);
        assert_eq!(seen_from(Pose::new(2.05, -2.0, std::f64::consts::FRAC_PI_2), &[inf; 5]), 0);
    }

    /// A sensor that scans every half second, in cycles of 0.05 s: the cycles between are not
    /// remembered.
    #[test]
    fn cycles_without_a_scan_leave_what_is_remembered() {
        let mut old = OldScans::default();
        let (made, nothing) = (scan(Pose::default(), &[1.0; 5]), ProjectedScan::default());
        for cycle in 0..60 {
            old.age(0.05);
            old.remember(if cycle % 10 == 0 { &made } else { &nothing });
        }
        assert_eq!(old.used().count(), OLD_SCANS);
        assert!(old.used().all(|old| old.scan.len() == 5));
    }
}
