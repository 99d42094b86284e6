//! Where a candidate velocity would lead, and how near to obstacles.

use crate::geometry::{Pose, Velocity};
use crate::local::Scene;
use crate::map::{Bounds, Core, DistanceField};
use serde::{Deserialize, Serialize};

/// How a trajectory is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Prediction {
    /// \[You2021, eq. (4)\]: Euler steps at the candidate velocity.
    Euler,
    /// As the robot really moves: one cycle in which the velocity changes linearly to the candidate,
    /// then the exact circular arc.
    Arcs,
}

/// Where on a trajectory its distance to obstacles is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DistanceAt {
    /// The nearest of all points \[You2021\].
    Trajectory,
    /// The end (the MATLAB sample behind much of this literature).
    End,
}

/// A predicted trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::local) struct Rollout {
    /// The last pose.
    pub(in crate::local) end: Pose,
    /// Distance of the footprint to the nearest obstacle \[m\], up to the cap.
    pub(in crate::local) distance_m: f64,
}

impl Rollout {
    /// The same where there is so much room to what moves; `None` when a mover is met.
    pub(super) fn beside_movers(self, room_m: Option<f64>) -> Option<Self> {
        let distance_m = self.distance_m.min(room_m?);
        Some(Self { distance_m, ..self })
    }
}

/// What must touch nothing on a rollout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<'a> {
    pub(super) core: Core<'a>,
    /// The footprint's distance to something is the core's less this \[m\].
    pub(super) offset_m: f64,
    /// Anything nearer than this to the core is contact \[m\].
    pub(super) contact_m: f64,
}

/// What all rollouts of a cycle share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roller<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) body: Body<'a>,
    pub(super) cycle_s: f64,
    pub(super) prediction: Prediction,
    pub(super) step_s: f64,
    pub(super) horizon_s: f64,
    pub(super) distance_at: DistanceAt,
    pub(super) distance_cap_m: f64,
    /// What is known of the present pose.
    pub(super) start: Seen,
}

/// A pose that was looked up in the field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) pose: Pose,
    /// Bounds of the core's distance to obstacles.
    pub(super) distance: Bounds,
    /// A lower bound of the core's distance to obstacles and to the map's border \[m\].
    pub(super) room_m: f64,
}

impl Seen {
    pub(super) fn new(
        pose: Pose,
        core: &Core<'_>,
        obstacles: &DistanceField,
        enough_m: f64,
    ) -> Self {
        let distance = core.bounds(pose, obstacles, enough_m);
        let border_m = core.to_border_within_m(pose, &obstacles.clearance(), enough_m);
        Self { pose, distance, room_m: distance.lower_m.min(border_m) }
    }
}

impl Roller<'_> {
    /// A stretch this short between two poses \[m\] that cannot be shown to be free counts as
    /// contact.
    const CONTACT_RESOLUTION_M: f64 = 1e-4;

    /// The trajectory of a candidate; `None` when the footprint would touch something on the way
    /// or leave the map. `near` is memory to work in.
    pub(super) fn roll(&self, candidate: Velocity, near: &mut Vec<Seen>) -> Option<Rollout> {
        let mut track = Track::new(self, near);
        let mut pose = self.scene.pose;
        let mut left_s = self.horizon_s;
        if self.prediction == Prediction::Arcs {
            let cycle_s = self.cycle_s.min(left_s);
            let from = self.scene.velocity;
            let to = from.lerp(candidate, cycle_s / self.cycle_s);
            let end = pose.after_ramp(from, to, cycle_s);
            // The mean of the speeds is the length provided that the robot does not reverse within
            // the cycle; the larger one always covers it.
            let driven_m = from.v.abs().max(to.v.abs()) * cycle_s;
            let turned_rad = from.omega.abs().max(to.omega.abs()) * cycle_s;
            track.extend(end, self.body.core.moves_m(driven_m, turned_rad), |fraction| {
                pose.after_ramp(from, from.lerp(to, fraction), cycle_s * fraction)
            })?;
            pose = end;
            left_s -= cycle_s;
        }
        let steps = (left_s / self.step_s - 1e-9).ceil().max(0.0) as u32;
        let step_s = if steps > 0 { left_s / f64::from(steps) } else { 0.0 };
        let moves_m = self.body.core.moves_m(candidate.v * step_s, candidate.omega * step_s);
        for _ in 0..steps {
            let end = self.step(pose, candidate, step_s);
            track.extend(end, moves_m, |fraction| self.step(pose, candidate, step_s * fraction))?;
            pose = end;
        }
        let nearest_m = match self.distance_at {
            DistanceAt::Trajectory => track.nearest_m(),
            DistanceAt::End => self.distance_m(pose, self.farthest_m()),
        };
        Some(Rollout { end: pose, distance_m: nearest_m - self.body.offset_m })
    }

    fn step(&self, pose: Pose, velocity: Velocity, duration_s: f64) -> Pose {
        match self.prediction {
            Prediction::Arcs => pose.after_arc(velocity, duration_s),
            Prediction::Euler => {
                // Eq. (4)
                let (sin, cos) = libm::sincos(pose.theta);
                let length = velocity.v * duration_s;
                Pose::new(
                    pose.x + length * cos,
                    pose.y + length * sin,
                    pose.theta + velocity.omega * duration_s,
                )
            }
        }
    }

    /// Distances of the core that are at least this count as this \[m\].
    fn farthest_m(&self) -> f64 {
        self.distance_cap_m + self.body.offset_m
    }

    /// Room of more than `enough_m` is not told apart.
    fn look_up(&self, pose: Pose, enough_m: f64) -> Seen {
        Seen::new(pose, &self.body.core, self.scene.obstacles, enough_m)
    }

    /// The core's exact distance to obstacles, up to a reach.
    fn distance_m(&self, pose: Pose, reach_m: f64) -> f64 {
        self.body.core.distance_on_way_m(pose, self.scene.obstacles, reach_m)
    }

    /// The core's exact distance to obstacles and to the map's border, up to what contact needs.
    fn room_m(&self, pose: Pose, reach_m: f64) -> f64 {
        let border_m = self.body.core.to_border_m(pose, &self.scene.obstacles.clearance());
        self.distance_m(pose, reach_m).min(border_m)
    }
}

/// A trajectory while it is followed. Distances change by no more than any part of the footprint moves,
/// so most poses need no look-up: they can be neither in contact nor the nearest. The field gives bounds
/// of the others, and only where those leave a doubt are distances measured.
struct Track<'r, 'a> {
    roller: &'r Roller<'a>,
    /// A lower bound of the room at the last pose that was looked up \[m\].
    room_m: f64,
    /// Length moved since then \[m\].
    moved_m: f64,
    /// Poses that may be the nearest to an obstacle. The map's border does not count as one: it only
    /// bounds where the footprint may be.
    near: &'r mut Vec<Seen>,
    /// An upper bound of the smallest distance so far \[m\].
    nearest_m: f64,
}

/// A place on a stretch, from 0 to 1, and the room there.
#[derive(Clone, Copy)]
struct Probe {
    fraction: f64,
    room_m: f64,
    /// Otherwise it is a lower bound.
    is_exact: bool,
}

impl<'r, 'a> Track<'r, 'a> {
    fn new(roller: &'r Roller<'a>, near: &'r mut Vec<Seen>) -> Self {
        near.clear();
        let Seen { room_m, .. } = roller.start;
        let mut track = Self { roller, room_m, moved_m: 0.0, near, nearest_m: roller.farthest_m() };
        track.note(roller.start);
        track
    }

    fn note(&mut self, seen: Seen) {
        if seen.distance.lower_m < self.nearest_m {
            self.near.push(seen);
            self.nearest_m = self.nearest_m.min(seen.distance.upper_m);
        }
    }

    /// Follows one more stretch to `end`, on which no part of the footprint moves farther than
    /// `moves_m`; `between` gives the pose at a fraction of it. `None` on contact.
    fn extend(&mut self, end: Pose, moves_m: f64, between: impl Fn(f64) -> Pose) -> Option<()> {
        // What is left of the last look-up at the beginning of this stretch, and at its end.
        let begin_m = self.room_m - self.moved_m;
        if begin_m - moves_m >= self.nearest_m.max(self.roller.body.contact_m) {
            self.moved_m += moves_m;
            return Some(());
        }
        // With so much room the pose is neither the nearest nor in contact, nor is the next one.
        let enough_m = self.nearest_m.max(2.0 * self.roller.body.contact_m) + 2.0 * moves_m;
        let seen = self.roller.look_up(end, enough_m);
        self.note(seen);
        let mut from = Probe { fraction: 0.0, room_m: begin_m, is_exact: false };
        let mut to = Probe { fraction: 1.0, room_m: seen.room_m, is_exact: false };
        self.check(&between, &mut from, &mut to, moves_m)?;
        (self.room_m, self.moved_m) = (to.room_m, 0.0);
        Some(())
    }

    /// Shows that the stretch between two places is free of contact. After a move by s, of l in all, there
    /// is at least the room r1 - s and r2 - (l - s), so with r1 + r2 - l >= 2 c it is at least c
    /// everywhere; otherwise each half is looked at.
    fn check(
        &self,
        between: &impl Fn(f64) -> Pose,
        from: &mut Probe,
        to: &mut Probe,
        moves_m: f64,
    ) -> Option<()> {
        let contact_m = self.roller.body.contact_m;
        let is_shown =
            |from: &Probe, to: &Probe| from.room_m + to.room_m - moves_m >= 2.0 * contact_m;
        if to.room_m >= contact_m && is_shown(from, to) {
            return Some(());
        }
        // More room than this at one end is not needed.
        let reach_m = 2.0 * contact_m.abs() + moves_m;
        for probe in [&mut *to, &mut *from] {
            if !probe.is_exact {
                let room_m = self.roller.room_m(between(probe.fraction), reach_m);
                (probe.room_m, probe.is_exact) = (room_m.max(probe.room_m), true);
            }
            if probe.room_m < contact_m {
                return None;
            }
        }
        if is_shown(from, to) {
            return Some(());
        }
        if moves_m < Roller::CONTACT_RESOLUTION_M {
            return None;
        }
        let fraction = 0.5 * (from.fraction + to.fraction);
        let Seen { room_m, .. } = self.roller.look_up(between(fraction), reach_m);
        let mut middle = Probe { fraction, room_m, is_exact: false };
        self.check(between, from, &mut middle, 0.5 * moves_m)?;
        self.check(between, &mut middle, to, 0.5 * moves_m)
    }

    /// The smallest distance of the core at the poses, up to what counts \[m\].
    fn nearest_m(self) -> f64 {
        self.near.sort_unstable_by(|a, b| a.distance.lower_m.total_cmp(&b.distance.lower_m));
        let mut nearest_m = self.roller.farthest_m();
        for seen in self.near.iter() {
            if seen.distance.lower_m >= nearest_m {
                break;
            }
            nearest_m = self.roller.distance_m(seen.pose, nearest_m);
        }
        nearest_m
    }
}
