//! Tracking of moving obstacles: hits that the map does not explain are tracked from scan to
//! scan, and tracks with evidence of motion are listed.
//!
//! # Source
//! Detection: a stationary obstacle is never seen through, and never appears where a beam has
//! passed. Such contradictions between scans as evidence of motion are from \[Wang2007\], here
//! between the beams of scans, without a grid. Filter: constant velocity, \[BarShalom2001,
//! section 6.3\]. Circles through hits: \[Kasa1976\].
//!
//! # Processing of a scan
//! 1. Hits within `explained_m` of a known occupied cell are explained by the map.
//! 2. Every track is predicted, and takes those of the other hits that lie on its disc, within
//!    its uncertainty. A hit goes to the track with the nearest border. If beams see through
//!    between the hits of a track, it keeps the larger group: an object that has split becomes
//!    two tracks.
//! 3. A circle through the hits of a track measures its centre. Unlike the mean of the hits, this
//!    centre does not wander along the surface while the robot passes, or while a part is
//!    occluded. If the hits show too little of a circle, the radius known from before is used. An
//!    object that is not round is measured by the middle of its visible part, with an uncertainty
//!    as large as the object.
//! 4. A track *moves* if its distance from where it was first seen exceeds the uncertainties of
//!    both positions, **and** two scans show it by at least two beams each: the beams pass
//!    through the surface that was seen there, or a remembered scan (up to a second old) has seen
//!    through the surface that is seen now. A part of a stationary object that comes into view
//!    does neither, so the object is not taken for a moving one, however its centre wanders. The
//!    position of an object that emerges from behind another one stays uncertain for long; for
//!    it, two consecutive scans, by at least five beams each, are sufficient evidence. A
//!    surface consists of hits at most three times `range_noise_m` apart: at distances at which
//!    beams are farther apart, no motion is detected.
//!
//!    Until then it *may move* for half a second whenever at least two beams of a remembered
//!    scan, and at least one for every eight that hit it now, have seen through the surface that
//!    is seen now. That is no proof, since errors have the same effect, but the stop rule does
//!    not wait for proof: an obstacle that emerges from behind another one may be near.
//! 5. A moving obstacle that is not known to have left its position for `standing_s` becomes
//!    stationary again. One that was out of view may have left it, unless its position is known
//!    to within `gap_m`. A track ends when it has grown wider than `largest_diameter_m`, when
//!    three scans in a row see through it, or when it has been out of view for `forget_s`.
//! 6. The remaining hits are grouped into new tracks, unless a group is too large for a moving
//!    obstacle. Tracks that do not move are kept, too: they count as stationary, and the sensed
//!    layer marks them.
//!
//! Two tracks that approach each other stay separate, because each hit goes to one of them.
//!
//! # Uncertainty
//! `position_uncertainty_m` and `velocity_uncertainty_mps` are three standard deviations of the
//! filter; its acceleration noise is half of `acceleration_mps2`. An innovation beyond three
//! standard deviations makes any velocity possible again.
//!
//! # Limitations
//! The tracker does not detect obstacles within `explained_m` of a known wall, obstacles larger
//! than `largest_diameter_m`, or obstacles that a single beam hits or that are narrower than
//! four times the range noise (a table leg that is carried). An occluded part of an object counts
//! only if it was seen before. An object that moves exactly along a beam, away from the sensor,
//! is detected by the space that it leaves; rotation is not detected.
//!
//! # Errors / cost
//! [`ConfigError`]. Linear in the beams and in the hits that the map does not explain. Allocates
//! nothing after warm-up. Deterministic.

mod config;
mod disc_fit;
mod hits;
mod seen_through;
mod track;

pub use config::TrackerConfig;

use super::{Mover, MovingPoint, ProjectedScan};
use crate::ConfigError;
use crate::geometry::{Point, Shift};
use crate::map::{Cell, GridFrame, OccupancyGrid};
use crate::robot::Robot;
use hits::{Hits, Owner};
use seen_through::{OldScans, beams_before, beams_now};
use serde::{Deserialize, Serialize};
use track::{Sight, Track};

/// Tracks moving obstacles.
///
/// ```
/// use keyway::robot::Footprint;
/// use keyway::sense::{ProjectedScan, Tracker, TrackerConfig};
/// use keyway::{OccupancyGrid, Point, Pose, Robot, Scan};
///
/// let known = OccupancyGrid::from_ascii(&["......", "......", "......", "......"]);
/// let mut tracker = Tracker::new(TrackerConfig::default())?;
/// let (pose, velocity_mps) = (Pose::new(1.0, 2.0, 0.0), Point::new(0.0, 0.5));
/// for cycle in 0..20 {
///     // A disc of 0.25 m walks by.
///     let to_disc = Point::new(2.0, -1.0) + velocity_mps * (0.1 * f64::from(cycle));
///     let mut scan = Scan::of_nothing(&Robot::small().sensors[0]);
///     for beam in 0..scan.ranges_m.len() {
///         let bearing_rad = scan.bearing_rad(beam);
///         let along = Point::new(bearing_rad.cos(), bearing_rad.sin());
///         let (ahead_m, aside_m) = (to_disc.dot(along), to_disc.cross(along));
///         if ahead_m > 0.0 && aside_m.abs() < 0.25 {
///             scan.ranges_m[beam] = ahead_m - (0.25 * 0.25 - aside_m * aside_m).sqrt();
///         }
///     }
///     let scan = ProjectedScan::new(known.frame(), &Footprint::POINT, pose, &scan);
///     tracker.update(&known, &scan, 0.1);
/// }
/// let mover = tracker.movers()[0];
/// assert!(mover.centre.distance(Point::new(3.0, 1.95)) < 0.02);
/// assert!((mover.velocity_mps - velocity_mps).norm() < 0.05);
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tracker {
    config: TrackerConfig,
    tracks: Vec<Track>,
    next_id: u64,
    /// Tracks that move, followed by those that may move.
    movers: Vec<Mover>,
    /// Number of those that move.
    moving: usize,
    /// Cells marked by an obstacle that turned out to move only in the last scan.
    left: Vec<Cell>,
    #[serde(skip)]
    hits: Hits,
    /// Hits of the track that is being updated.
    #[serde(skip)]
    own: Vec<Point>,
    #[serde(skip)]
    own_beams: Vec<usize>,
    /// Remembered scans of each sensor.
    old: Vec<OldScans>,
}

/// Beams of one scan that show motion, and the number of such scans needed.
const EVIDENCE_BEAMS: u32 = 2;
const EVIDENCE_SCANS: u32 = 2;

/// Number of beams needed if the position of a track is too uncertain to show that it has left,
/// as for an object that emerges from behind another one.
const CLEAR_EVIDENCE_BEAMS: u32 = 5;

/// Duration for which a track may move after evidence against its being stationary \[s\].
const MAY_MOVE_S: f64 = 0.5;

/// Initial capacity for tracks; up to it, new tracks do not allocate.
const USUAL_TRACKS: usize = 32;

/// Scans in a row that see through a track until it ends.
const EMPTY_SCANS: u32 = 3;

/// Minimum number of hits of a track.
const LEAST_HITS: usize = 2;

impl Tracker {
    /// Creates a tracker without tracks.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a value of the config cannot be used; the error names it.
    pub fn new(config: TrackerConfig) -> Result<Self, ConfigError> {
        config.validate()?;
        Ok(Self {
            config,
            tracks: Vec::with_capacity(USUAL_TRACKS),
            next_id: 0,
            movers: Vec::with_capacity(USUAL_TRACKS),
            moving: 0,
            left: Vec::new(),
            hits: Hits::default(),
            own: Vec::new(),
            own_beams: Vec::new(),
            old: Vec::new(),
        })
    }

    /// Moving obstacles as of the last scan, the oldest track first.
    pub fn movers(&self) -> &[Mover] {
        &self.movers[..self.moving]
    }

    /// Moving obstacles, followed by those that may move. The latter are not confirmed, but at
    /// most half a second ago they were in space that a scan of the second before had seen
    /// through.
    pub fn possible_movers(&self) -> &[Mover] {
        &self.movers
    }

    /// Predicted points on the surfaces of moving obstacles that may as well have stopped: once
    /// as if the obstacle continues, and once as if it is stationary.
    pub(crate) fn surfaces_after(&self, after_s: f64) -> impl Iterator<Item = MovingPoint> + '_ {
        let movers = self.tracks.iter().filter(|track| track.is_mover && track.may_stand());
        movers.flat_map(move |track| track.surface_after(after_s))
    }

    /// True if a beam of the last scan, which ended at `place`, hit a moving obstacle: a tracked
    /// one, or an untracked hit in the area that a moving obstacle in view may cover. A hit in
    /// the area of an obstacle that is only predicted does not count.
    pub fn hits_mover(&self, beam: usize, place: Point) -> bool {
        if let Some(Owner::Track(track)) = self.hits.owner(beam) {
            return self.tracks.get(track as usize).is_some_and(|track| track.is_mover);
        }
        self.may_be_mover(place)
    }

    /// True if a moving obstacle in view may cover a point.
    pub(super) fn may_be_mover(&self, place: Point) -> bool {
        let may_be = |mover: &Mover| place.distance(mover.centre) <= mover.now().radius_m;
        self.movers().iter().any(|mover| mover.unseen_s == 0.0 && may_be(mover))
    }

    /// Cells with hits on an obstacle that counted as stationary until the last scan showed that
    /// it moves.
    pub fn left(&self) -> &[Cell] {
        &self.left
    }

    /// Takes in the scan of a robot's only sensor on the `known` map, `elapsed_s` after the last
    /// one. A scan at a pose that is not finite shows nothing; a time that is negative or not
    /// finite counts as 0.
    pub fn update(&mut self, known: &OccupancyGrid, scan: &ProjectedScan, elapsed_s: f64) {
        self.update_from(known, 0, scan, elapsed_s);
    }

    /// Like [`Self::update`], for the sensor of this index, `elapsed_s` after the last scan of
    /// any sensor: 0 for two scans of the same time.
    pub fn update_from(
        &mut self,
        known: &OccupancyGrid,
        sensor: usize,
        scan: &ProjectedScan,
        elapsed_s: f64,
    ) {
        let sensor = sensor.min(Robot::MOST_SENSORS - 1);
        self.old.resize_with(self.old.len().max(sensor + 1), OldScans::default);
        let pose = scan.pose();
        let elapsed_s = if elapsed_s.is_finite() { elapsed_s.max(0.0) } else { 0.0 };
        self.left.clear();
        self.own.clear();
        self.own.reserve(scan.len());
        self.own_beams.clear();
        self.own_beams.reserve(scan.len());
        let config = &self.config;
        self.tracks.iter_mut().for_each(|track| track.predict(elapsed_s, config));
        self.old.iter_mut().for_each(|old| old.age(elapsed_s));
        self.hits.take_in(known, scan, config.explained_m);
        if pose.point().is_finite() && pose.theta.is_finite() {
            self.offer_hits(scan);
            for track in 0..self.tracks.len() {
                self.see(track, sensor, scan);
            }
            self.end_tracks();
            self.begin_tracks(sensor, scan);
            self.note_cells();
            self.old[sensor].remember(scan);
        }
        self.list_movers();
    }

    /// Moves the whole state along with a correction of the robot's pose. The correction adds no
    /// velocity.
    pub(crate) fn shift(&mut self, frame: &GridFrame, shift: &Shift) {
        self.tracks.iter_mut().for_each(|track| track.shift(shift));
        self.old.iter_mut().for_each(|old| old.shift(frame, shift));
        self.left.clear();
        self.list_movers();
    }

    /// True if a restored tracker is valid.
    pub(crate) fn is_sound(&self) -> bool {
        self.config.validate().is_ok() && self.moving <= self.movers.len()
    }

    fn list_movers(&mut self) {
        let Self { tracks, movers, .. } = self;
        movers.clear();
        movers.extend(tracks.iter().filter(|track| track.is_mover).map(Track::mover));
        self.moving = movers.len();
        let may_move = |track: &&Track| !track.is_mover && track.since_doubted_s <= MAY_MOVE_S;
        movers.extend(tracks.iter().filter(may_move).map(Track::mover));
    }

    /// Assigns each hit to the track with the nearest border, of those that it may belong to.
    fn offer_hits(&mut self, scan: &ProjectedScan) {
        let noise_m = self.config.range_noise_m;
        for (index, track) in self.tracks.iter().enumerate() {
            let reach_m = track.reach_m(noise_m);
            for beam in scan.beams_towards(track.centre, reach_m) {
                let Some(hit) = self.hits.point(beam) else { continue };
                let distance_m = hit.distance(track.centre);
                let off_m = distance_m - track.radius_m;
                let score_m = if track.is_round { off_m.abs() } else { off_m.max(0.0) };
                if distance_m <= reach_m {
                    self.hits.offer(beam, index as u32, score_m);
                }
            }
        }
    }

    /// Updates a track with a scan.
    fn see(&mut self, index: usize, sensor: usize, scan: &ProjectedScan) {
        self.collect(index, scan);
        let track = &mut self.tracks[index];
        if self.own.is_empty() {
            if track.sensor == sensor {
                note_unseen(track, scan);
            }
            return;
        }
        track.sensor = sensor;
        let sight = Sight { hits: &self.own, sensor: scan.pose().point(), index: sensor };
        track.see(&sight, &self.config);
        if track.is_mover {
            track.watch_rest(&self.own, &self.config);
            return;
        }
        let has_left = track.has_left_its_anchor();
        let needed = if has_left { EVIDENCE_BEAMS } else { CLEAR_EVIDENCE_BEAMS };
        let before = beams_before(track, &sight, scan, (&self.old[sensor..=sensor], &self.config));
        track.note_seen_through(before, self.own.len());
        let is_shown = before.max(beams_now(track, scan, &self.config)) >= needed;
        // A track that has not left its first position needs contradictions in consecutive scans.
        let before = if is_shown || has_left { track.evidence } else { 0 };
        track.evidence = before + u32::from(is_shown);
        if track.evidence >= EVIDENCE_SCANS {
            track.start_moving(&mut self.left);
        }
    }

    /// Collects the hits of a track, and releases those that belong to another object.
    fn collect(&mut self, index: usize, scan: &ProjectedScan) {
        self.own.clear();
        self.own_beams.clear();
        let track = &self.tracks[index];
        let reach_m = track.reach_m(self.config.range_noise_m);
        for beam in scan.beams_towards(track.centre, reach_m) {
            if self.hits.owner(beam) == Some(Owner::Track(index as u32))
                && let Some(hit) = self.hits.point(beam)
            {
                self.own.push(hit);
                self.own_beams.push(beam);
            }
        }
        let (mut best, mut start) = (0..0, 0);
        for at in 1..=self.own.len() {
            if at == self.own.len() || self.is_split(at, scan) {
                best = if at - start > best.len() { start..at } else { best };
                start = at;
            }
        }
        for (at, &beam) in self.own_beams.iter().enumerate() {
            if !best.contains(&at) {
                self.hits.release(beam);
            }
        }
        self.own.truncate(best.end);
        self.own.drain(..best.start);
    }

    /// True if beams see through between two successive hits of a track that are far apart.
    fn is_split(&self, at: usize, scan: &ProjectedScan) -> bool {
        let (a, b) = (self.own[at - 1], self.own[at]);
        let far_m = a.distance(scan.pose().point()).max(b.distance(scan.pose().point()));
        if a.distance(b) <= self.config.gap_m.max(2.0 * far_m * scan.step_rad()) {
            return false;
        }
        let count = scan.len();
        let (from, to) = (self.own_beams[at - 1], self.own_beams[at]);
        let between = (1..(to + count - from) % count).map(|step| (from + step) % count);
        let sees_through = |beam| scan.free_m(beam).is_some_and(|free_m| free_m > far_m);
        between.into_iter().any(sees_through)
    }

    fn end_tracks(&mut self) {
        let Self { tracks, hits, config, .. } = self;
        let has_ended = |track: &Track| {
            track.empty_scans >= EMPTY_SCANS
                || track.unseen_s > config.forget_s
                || !track.now().radius_m.is_finite()
                || 2.0 * track.radius_m > config.largest_diameter_m
        };
        let mut kept = 0;
        let mut at = 0;
        tracks.retain(|track| {
            let is_kept = !has_ended(track);
            hits.renumber(at, is_kept.then_some(kept));
            at += 1;
            kept += u32::from(is_kept);
            is_kept
        });
    }

    /// Groups the remaining hits into new tracks.
    fn begin_tracks(&mut self, index: usize, scan: &ProjectedScan) {
        let sensor = scan.pose().point();
        let gap_m = self.config.gap_m;
        let step_rad = scan.step_rad();
        let is_near =
            |a: Point, b: Point| a.distance(b) <= gap_m.max(2.0 * step_rad * b.distance(sensor));
        let mut beam = 0;
        while beam < scan.len() {
            self.own.clear();
            self.own_beams.clear();
            while let Some(hit) = self.hits.unexplained(beam) {
                if self.own.last().is_some_and(|&last| !is_near(last, hit)) {
                    break;
                }
                self.own.push(hit);
                self.own_beams.push(beam);
                beam += 1;
            }
            if self.own.is_empty() {
                beam += 1;
                continue;
            }
            self.begin_track(index, scan);
        }
    }

    /// Starts a track from the collected hits.
    fn begin_track(&mut self, sensor: usize, scan: &ProjectedScan) {
        let (Some(&first), Some(&last)) = (self.own.first(), self.own.last()) else { return };
        let is_large = first.distance(last) > self.config.largest_diameter_m;
        if self.own.len() < LEAST_HITS || is_large {
            return;
        }
        let sight = Sight { hits: &self.own, sensor: scan.pose().point(), index: sensor };
        let Some(mut track) = Track::new(self.next_id, &sight, &self.config) else { return };
        if 2.0 * track.radius_m > self.config.largest_diameter_m {
            return;
        }
        let before = beams_before(&track, &sight, scan, (&self.old[sensor..=sensor], &self.config));
        track.note_seen_through(before, self.own.len());
        let index = self.tracks.len() as u32;
        self.own_beams.iter().for_each(|&beam| self.hits.give(beam, index));
        self.tracks.push(track);
        self.next_id += 1;
    }

    /// Records the cells that stationary tracks mark.
    fn note_cells(&mut self) {
        for (owner, cell) in self.hits.cells() {
            let Owner::Track(index) = owner else { continue };
            let track = &mut self.tracks[index as usize];
            if !track.is_mover {
                track.note_cell(cell);
            }
        }
    }
}

/// Updates a track that no beam hit: notes if beams see through it.
fn note_unseen(track: &mut Track, scan: &ProjectedScan) {
    let disc = Track::now(track);
    let far_m = track.centre.distance(scan.pose().point()) + disc.radius_m;
    let beams = scan.beams_towards(track.centre, track.radius_m);
    let (mut looking, mut through) = (0, 0);
    for beam in beams {
        looking += 1;
        through += u32::from(scan.free_m(beam).is_some_and(|free_m| free_m > far_m));
    }
    let is_empty = looking > 0 && through == looking;
    track.miss(is_empty);
}

#[cfg(test)]
mod tests;
