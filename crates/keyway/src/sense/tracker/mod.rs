//! Movers from scans: hits that no map explains are followed from scan to scan, and what is shown
//! to move is listed.
//!
//! # Source
//! Detection: what stands is never seen through, and never stands where a beam has passed; the
//! contradiction between scans as evidence of motion is that of \[Wang2007\], here between the
//! beams of scans, without a grid. Filter: constant velocity, \[BarShalom2001, section 6.3\].
//! Circles through hits: \[Kasa1976\].
//!
//! # What happens with a scan
//! 1. Hits within `explained_m` of a known occupied cell are explained by the map.
//! 2. Every track is predicted, and takes those of the other hits that lie on its disc, within its
//!    uncertainty; a hit goes to the track whose border it is nearest to. Where beams see through
//!    between its hits, a track keeps the larger group: what has split becomes two.
//! 3. A circle through the hits of a track measures its centre: unlike their mean it does not
//!    wander along the surface while the robot passes, or while a part is hidden. Where the hits
//!    show too little of a circle, the radius known from before places it. Things that are not
//!    round are measured by the middle of what is seen, which is only as certain as the thing is
//!    large.
//! 4. A track *moves* when it is farther from where it was first seen than the uncertainties of
//!    both places, **and** two scans show it by at least two beams each: they pass through the
//!    surface that was seen there, or a remembered scan (of up to a second ago) has seen through
//!    the surface that is seen now. A part of a standing thing that comes into view does neither,
//!    so it is no mover, however its middle wanders. Of a thing that comes out from behind another
//!    one, the place is long uncertain: two scans that follow each other, by at least five beams
//!    each, show its motion alone. A surface is what beams hit no farther apart than three times
//!    `range_noise_m`: from so far away that beams are farther apart, nothing is seen to move.
//!
//!    Until then it *may move* for half a second whenever at least two beams of a remembered scan,
//!    and at least one for every eight that hit it now, have seen through the surface that is seen
//!    now. That is no proof, as errors do the same, but the stop rule waits for none: who comes out
//!    from behind something may be near.
//! 5. A mover that is not known to have left its place for `standing_s` stands again. One that was
//!    out of view may have left it, unless its place is known to within `gap_m`. A track ends when
//!    it has grown wider than `largest_diameter_m`, when three scans in a row see through it, or
//!    when it has been out of view for `forget_s`.
//! 6. What is left of the hits is grouped into new tracks, if it is not too large for a mover.
//!    Tracks that do not move are kept, too: they count as standing, and the sensed layer marks
//!    them.
//!
//! Two tracks that come near each other stay two, because each hit goes to one of them.
//!
//! # How certain it is
//! `position_uncertainty_m` and `velocity_uncertainty_mps` are three standard deviations of the
//! filter; its acceleration noise is half of `acceleration_mps2`. A surprise beyond three standard
//! deviations makes any velocity possible again.
//!
//! # What it does not see
//! Whatever is as near to a known wall as `explained_m`; things larger than `largest_diameter_m`;
//! what only one beam meets, or is narrower than four times the noise of ranges (a table leg that
//! is carried). What is hidden of a thing counts only when it was seen before. A thing that moves
//! exactly along a beam, away from the sensor, is seen by what it leaves; one that rotates is not
//! seen to.
//!
//! # Errors / cost
//! [`ConfigError`]. Linear in the beams and in the hits that the map does not explain. Allocates
//! nothing once it is warm. Nothing is random.

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

/// Follows what moves.
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
    /// What moves, and after that what may move.
    movers: Vec<Mover>,
    /// How many of them move.
    moving: usize,
    /// Cells marked by what only now is known to move.
    left: Vec<Cell>,
    #[serde(skip)]
    hits: Hits,
    /// Hits of the track that is looked at.
    #[serde(skip)]
    own: Vec<Point>,
    #[serde(skip)]
    own_beams: Vec<usize>,
    /// Remembered scans, sensor by sensor.
    old: Vec<OldScans>,
}

/// Beams that show in one scan that something moves, and such scans that it takes.
const EVIDENCE_BEAMS: u32 = 2;
const EVIDENCE_SCANS: u32 = 2;

/// So many beams show it of something whose place is known too roughly to see it leave, as of a
/// thing that comes out from behind another.
const CLEAR_EVIDENCE_BEAMS: u32 = 5;

/// What may move does so for this long, unless it is doubted again that it stands \[s\].
const MAY_MOVE_S: f64 = 0.5;

/// Room is made for so many tracks at once: then new ones allocate nothing.
const USUAL_TRACKS: usize = 32;

/// Scans in a row that see through a track until it ends.
const EMPTY_SCANS: u32 = 3;

/// Fewer hits are no thing.
const LEAST_HITS: usize = 2;

impl Tracker {
    /// One that knows of nothing yet.
    ///
    /// # Errors
    /// When a value of the config cannot be used; the error names it.
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

    /// What moves, as of the last scan; the longest followed first.
    pub fn movers(&self) -> &[Mover] {
        &self.movers[..self.moving]
    }

    /// What moves, and after that what may move: that is not known, but up to half a second ago it
    /// was where the robot had seen through no more than a second before.
    pub fn possible_movers(&self) -> &[Mover] {
        &self.movers
    }

    /// Points seen on the surfaces of movers that may as well stand, in a while: once as of movers
    /// that go on, and once as of what stands.
    pub(crate) fn surfaces_after(&self, after_s: f64) -> impl Iterator<Item = MovingPoint> + '_ {
        let movers = self.tracks.iter().filter(|track| track.is_mover && track.may_stand());
        movers.flat_map(move |track| track.surface_after(after_s))
    }

    /// True if a beam of the last scan, which ended at `place`, hit a mover: one that is followed,
    /// or something that is not followed itself on ground that a mover in view may cover. What is
    /// seen where a mover is only expected is not that mover.
    pub fn hits_mover(&self, beam: usize, place: Point) -> bool {
        if let Some(Owner::Track(track)) = self.hits.owner(beam) {
            return self.tracks.get(track as usize).is_some_and(|track| track.is_mover);
        }
        self.may_be_mover(place)
    }

    /// True if a mover in view may cover a place.
    pub(super) fn may_be_mover(&self, place: Point) -> bool {
        let may_be = |mover: &Mover| place.distance(mover.centre) <= mover.now().radius_m;
        self.movers().iter().any(|mover| mover.unseen_s == 0.0 && may_be(mover))
    }

    /// Cells that held hits on something standing, until the last scan showed that it moves.
    pub fn left(&self) -> &[Cell] {
        &self.left
    }

    /// Takes in the scan of a robot's only sensor on the `known` map, `elapsed_s` after the last
    /// one. A scan at a pose that is not finite shows nothing; a time that is negative or not
    /// finite counts as 0.
    pub fn update(&mut self, known: &OccupancyGrid, scan: &ProjectedScan, elapsed_s: f64) {
        self.update_from(known, 0, scan, elapsed_s);
    }

    /// The same of the sensor of this index, `elapsed_s` after the last scan of any sensor: 0 for
    /// two of the same time.
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

    /// Moves all that it knows with the robot, to where that turns out to be: nothing becomes fast
    /// by that.
    pub(crate) fn shift(&mut self, frame: &GridFrame, shift: &Shift) {
        self.tracks.iter_mut().for_each(|track| track.shift(shift));
        self.old.iter_mut().for_each(|old| old.shift(frame, shift));
        self.left.clear();
        self.list_movers();
    }

    /// True if one that was stored can be used.
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

    /// Each hit goes to the track whose border it is nearest to, of those that it may belong to.
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

    /// What a scan shows of a track.
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
        // Who has not been seen to leave has to be contradicted in scans that follow each other.
        let before = if is_shown || has_left { track.evidence } else { 0 };
        track.evidence = before + u32::from(is_shown);
        if track.evidence >= EVIDENCE_SCANS {
            track.start_moving(&mut self.left);
        }
    }

    /// Gathers the hits of a track, and gives those back that belong to something else.
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

    /// Groups what is left of the hits into new tracks.
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

    /// A new track of the collected hits.
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

    /// Standing tracks note the cells that they mark.
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

/// Notes whether beams see through a track that none of them hit.
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
