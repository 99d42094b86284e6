//! The track of one object, followed from scan to scan.

use super::disc_fit::{Fit, fit, fit_of_radius};
use super::{EVIDENCE_BEAMS, TrackerConfig};
use crate::geometry::{Disc, Point, Shift};
use crate::map::Cell;
use crate::sense::{Mover, MovingPoint};
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

/// An unmapped object: its state, and the evidence for its motion.
///
/// Position and velocity are estimated by a Kalman filter of constant velocity \[BarShalom2001,
/// section 6.3\], with the same covariance along both axes, so that three numbers are enough.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Track {
    pub(super) id: u64,
    /// Sensor that last hit it; another one may see over it.
    pub(super) sensor: usize,
    pub(super) centre: Point,
    velocity_mps: Point,
    /// Variances of position \[m²\] and velocity \[m²/s²\], and their covariance \[m²/s\].
    spread: Spread,
    pub(super) radius_m: f64,
    radius_variance: f64,
    pub(super) is_round: bool,
    age_s: f64,
    pub(super) unseen_s: f64,
    pub(super) is_mover: bool,
    /// Scans in which the surface at the anchor was seen through, or in which its present surface
    /// had been seen through before.
    pub(super) evidence: u32,
    /// Time since the last evidence against its being stationary \[s\]; infinite without any.
    pub(super) since_doubted_s: f64,
    /// Hits of the last scan, moved along with its velocity; empty while it is out of view.
    pub(super) surface: Surface,
    /// Position at which it was first seen, or since which it has been at rest.
    pub(super) anchor: Anchor,
    /// Number of consecutive scans that see through it.
    pub(super) empty_scans: u32,
    /// Cells that its hits marked while it counted as stationary.
    pub(super) marked: ArrayVec<Cell, { Track::MOST_CELLS }>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Spread {
    position: f64,
    both: f64,
    velocity: f64,
}

/// Hits on one object.
type Surface = ArrayVec<Point, { Track::MOST_HITS }>;

/// A position, with the surface that was seen there.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Anchor {
    pub(super) surface: Surface,
    centre: Point,
    off_m: f64,
    age_s: f64,
    /// Longest time out of view since then \[s\].
    unseen_s: f64,
}

/// The view of a track in one scan.
pub(super) struct Sight<'a> {
    /// Hits in the order of the beams; at least one.
    pub(super) hits: &'a [Point],
    pub(super) sensor: Point,
    /// Index of the sensor.
    pub(super) index: usize,
}

impl Track {
    /// Maximum number of remembered hits of a surface; of more, every n-th one is kept.
    pub(super) const MOST_HITS: usize = 48;

    /// Time out of view up to which the search radius allows for a reversal; after a longer one,
    /// its rest starts over \[s\].
    const TURNED_S: f64 = 0.3;

    /// Maximum number of remembered cells of a trail; the oldest ones are dropped first.
    const MOST_CELLS: usize = 96;

    /// Number of hits per beam of evidence against being stationary: larger errors than expected
    /// make single beams contradict.
    const HITS_PER_BEAM_AGAINST: usize = 8;

    /// Number of standard deviations that bound an error.
    const SIGMAS: f64 = 3.0;

    /// Starts a track at the given hits. Its speed may be anything within the config's bounds.
    pub(super) fn new(id: u64, sight: &Sight<'_>, config: &TrackerConfig) -> Option<Self> {
        let fit = fit(sight.hits, sight.sensor, config.range_noise_m, config.largest_diameter_m)?;
        let mut track = Self {
            id,
            sensor: sight.index,
            centre: fit.disc.centre,
            velocity_mps: Point::default(),
            spread: Spread { position: 0.0, both: 0.0, velocity: 0.0 },
            radius_m: fit.disc.radius_m,
            radius_variance: 0.0,
            is_round: fit.is_round,
            age_s: 0.0,
            unseen_s: 0.0,
            is_mover: false,
            evidence: 0,
            since_doubted_s: f64::INFINITY,
            surface: Surface::default(),
            anchor: Anchor::default(),
            empty_scans: 0,
            marked: ArrayVec::new(),
        };
        track.restart(&fit, config);
        note_surface(&mut track.surface, sight.hits);
        track.set_anchor(sight.hits, fit.off_m);
        Some(track)
    }

    /// Predicts the state over a time.
    pub(super) fn predict(&mut self, elapsed_s: f64, config: &TrackerConfig) {
        let moved = self.velocity_mps * elapsed_s;
        self.centre = self.centre + moved;
        self.surface.iter_mut().for_each(|place| *place = *place + moved);
        // White acceleration: its standard deviation is half of the maximum acceleration.
        let pushed = 0.5 * config.acceleration_mps2 * elapsed_s;
        let noise = pushed * pushed;
        let Spread { position, both, velocity } = self.spread;
        self.spread = Spread {
            position: position
                + elapsed_s * (2.0 * both + elapsed_s * velocity)
                + 0.25 * noise * elapsed_s * elapsed_s,
            both: both + elapsed_s * velocity + 0.5 * noise * elapsed_s,
            velocity: velocity + noise,
        };
        self.age_s += elapsed_s;
        self.anchor.age_s += elapsed_s;
        self.unseen_s += elapsed_s;
        self.since_doubted_s += elapsed_s;
    }

    /// Moves the track along with a correction of the robot's pose. Its marked cells are
    /// forgotten.
    pub(super) fn shift(&mut self, shift: &Shift) {
        self.centre = shift.point(self.centre);
        self.velocity_mps = shift.vector(self.velocity_mps);
        self.surface.iter_mut().for_each(|place| *place = shift.point(*place));
        self.anchor.centre = shift.point(self.anchor.centre);
        self.anchor.surface.iter_mut().for_each(|place| *place = shift.point(*place));
        self.marked.clear();
    }

    /// The area that it may cover now.
    pub(super) fn now(&self) -> Disc {
        Disc { centre: self.centre, radius_m: self.radius_m + self.off_m() }
    }

    /// Bound on the error of the estimated centre \[m\].
    pub(super) fn off_m(&self) -> f64 {
        Self::SIGMAS * self.spread.position.sqrt()
    }

    /// Bound on the distance of its hits from the predicted centre \[m\]. A moving obstacle may
    /// have reversed since it was last seen.
    pub(super) fn reach_m(&self, noise_m: f64) -> f64 {
        let seen_s = if self.is_mover { self.unseen_s.min(Self::TURNED_S) } else { 0.0 };
        self.radius_m + self.off_m() + 2.0 * (noise_m + self.velocity_mps.norm() * seen_s)
    }

    /// Takes in a scan without hits on it; `is_empty` if the scan sees through it.
    pub(super) fn miss(&mut self, is_empty: bool) {
        self.surface.clear();
        self.anchor.unseen_s = self.anchor.unseen_s.max(self.unseen_s);
        self.empty_scans = if is_empty { self.empty_scans + 1 } else { 0 };
    }

    /// Takes in the hits of a scan.
    pub(super) fn see(&mut self, sight: &Sight<'_>, config: &TrackerConfig) {
        (self.unseen_s, self.empty_scans) = (0.0, 0);
        note_surface(&mut self.surface, sight.hits);
        let noise_m = config.range_noise_m;
        let Some(fit) = fit(sight.hits, sight.sensor, noise_m, config.largest_diameter_m) else {
            return;
        };
        if fit.is_round && !self.is_round {
            // Seen as a whole for the first time: its position so far was that of a part.
            self.is_round = true;
            self.restart(&fit, config);
        } else if fit.is_round {
            self.note_radius(&fit);
            self.correct(fit.disc.centre, fit.off_m, config);
        } else if self.is_round {
            let weight = 0.25 * noise_m * noise_m / self.spread.position.max(1e-12);
            let expected = Disc { centre: self.centre, radius_m: self.radius_m };
            let placed = fit_of_radius(sight.hits, expected, weight);
            self.correct(placed.centre, noise_m.max(self.off_m()), config);
        } else {
            self.radius_m = self.radius_m.max(fit.disc.radius_m);
            self.correct(fit.disc.centre, fit.off_m, config);
        }
    }

    /// True if it is farther from its anchor than the errors of both positions explain.
    pub(super) fn has_left_its_anchor(&self) -> bool {
        let shape_m = if self.is_round { 0.0 } else { self.radius_m };
        let off_m = self.off_m() + shape_m + self.anchor.off_m;
        self.centre.distance(self.anchor.centre) > off_m
    }

    /// Takes in that `beams` beams of a remembered scan have seen through its present surface of
    /// `hits` hits.
    pub(super) const fn note_seen_through(&mut self, beams: u32, hits: usize) {
        if beams >= EVIDENCE_BEAMS && beams as usize * Self::HITS_PER_BEAM_AGAINST >= hits {
            self.since_doubted_s = 0.0;
        }
    }

    /// Starts to move: the cells that it marked as stationary are to be cleared.
    pub(super) fn start_moving(&mut self, left: &mut Vec<Cell>) {
        self.is_mover = true;
        left.extend(self.marked.drain(..));
    }

    /// Checks if a moving obstacle stays at its position and has become stationary; `hits` are
    /// those of this scan.
    pub(super) fn watch_rest(&mut self, hits: &[Point], config: &TrackerConfig) {
        let speed_mps = self.velocity_mps.norm();
        // An obstacle that was out of view may have been elsewhere, and one with a much less
        // certain anchor may have come from elsewhere: neither shows rest.
        let is_in_view =
            self.anchor.unseen_s <= Self::TURNED_S && self.anchor.off_m <= 2.0 * self.off_m();
        let is_known = is_in_view || self.off_m() + self.anchor.off_m <= config.gap_m;
        let stays = is_known
            && !self.has_left_its_anchor()
            && speed_mps <= Self::SIGMAS * self.spread.velocity.sqrt();
        if !stays {
            self.set_anchor(hits, self.off_m());
        } else if self.anchor.age_s >= config.standing_s {
            self.is_mover = false;
            self.set_anchor(hits, self.off_m());
        }
    }

    /// Records a cell that one of its hits marks.
    pub(super) fn note_cell(&mut self, cell: Cell) {
        if self.marked.contains(&cell) {
            return;
        }
        if self.marked.is_full() {
            self.marked.remove(0);
        }
        self.marked.push(cell);
    }

    /// True if it may as well be stationary: its speed is at most one standard deviation, or it
    /// is not round. The visible middle of an object that is not round moves as more of it comes
    /// into view.
    pub(super) fn may_stand(&self) -> bool {
        !self.is_round || self.velocity_mps.norm_sq() <= self.spread.velocity
    }

    /// Its predicted hits: once as if it continues, and once as if it is stationary.
    pub(super) fn surface_after(&self, after_s: f64) -> impl Iterator<Item = MovingPoint> + '_ {
        let velocities = [self.velocity_mps, Point::default()].into_iter();
        velocities.flat_map(move |velocity_mps| {
            let place = move |&hit: &Point| hit + velocity_mps * after_s;
            self.surface.iter().map(move |hit| MovingPoint { place: place(hit), velocity_mps })
        })
    }

    pub(super) fn mover(&self) -> Mover {
        Mover {
            id: self.id,
            centre: self.centre,
            velocity_mps: self.velocity_mps,
            radius_m: self.radius_m,
            age_s: self.age_s,
            unseen_s: self.unseen_s,
            position_uncertainty_m: self.off_m(),
            velocity_uncertainty_mps: Self::SIGMAS * self.spread.velocity.sqrt(),
        }
    }

    /// Sets the anchor to its present position and surface.
    fn set_anchor(&mut self, hits: &[Point], off_m: f64) {
        note_surface(&mut self.anchor.surface, hits);
        (self.anchor.centre, self.anchor.off_m) = (self.centre, off_m);
        (self.anchor.age_s, self.anchor.unseen_s) = (0.0, 0.0);
        self.evidence = 0;
    }

    /// Resets the position to that of a fit, and allows any velocity.
    fn restart(&mut self, fit: &Fit, config: &TrackerConfig) {
        self.centre = fit.disc.centre;
        self.velocity_mps = Point::default();
        let (deviation_m, deviation_mps) = (0.5 * fit.off_m, 0.5 * config.speed_mps);
        self.spread = Spread {
            position: deviation_m * deviation_m,
            both: 0.0,
            velocity: deviation_mps * deviation_mps,
        };
        self.radius_m = fit.disc.radius_m;
        self.radius_variance = deviation_m * deviation_m;
    }

    fn note_radius(&mut self, fit: &Fit) {
        let variance = 0.25 * fit.off_m * fit.off_m;
        let gain = self.radius_variance / (self.radius_variance + variance);
        self.radius_m += gain * (fit.disc.radius_m - self.radius_m);
        // Objects are never exactly round: later fits still count.
        self.radius_variance = ((1.0 - gain) * self.radius_variance).max(1e-2 * variance);
    }

    /// Correction of the filter by a measured centre.
    fn correct(&mut self, measured: Point, off_m: f64, config: &TrackerConfig) {
        let variance = 0.25 * off_m * off_m;
        let innovation = measured - self.centre;
        let expected = self.spread.position + variance;
        if innovation.norm_sq() > Self::SIGMAS * Self::SIGMAS * expected {
            // It has turned or stopped: any velocity is possible again.
            let deviation_mps = 0.5 * config.speed_mps;
            self.spread.velocity = self.spread.velocity.max(deviation_mps * deviation_mps);
            self.spread.position = self.spread.position.max(innovation.norm_sq());
        }
        let Spread { position, both, velocity } = self.spread;
        let total = position + variance;
        let (to_position, to_velocity) = (position / total, both / total);
        self.centre = self.centre + innovation * to_position;
        self.velocity_mps = self.velocity_mps + innovation * to_velocity;
        self.spread = Spread {
            position: (1.0 - to_position) * position,
            both: (1.0 - to_position) * both,
            velocity: velocity - to_velocity * both,
        };
    }
}

/// Stores a surface; of too many hits, every n-th one.
fn note_surface(surface: &mut Surface, hits: &[Point]) {
    surface.clear();
    let step = hits.len().div_ceil(Track::MOST_HITS).max(1);
    surface.extend(hits.iter().step_by(step).copied());
}
