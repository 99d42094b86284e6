//! Where a candidate velocity would lead, and how near to obstacles.

use super::Scene;
use crate::geometry::{Point, Pose, Velocity};
use crate::robot::Robot;
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
pub(super) struct Rollout {
    /// The last pose.
    pub(super) end: Pose,
    /// Distance of the footprint to the nearest obstacle \[m\], up to the cap.
    pub(super) distance_m: f64,
}

/// What all rollouts of a cycle share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roller<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) robot: &'a Robot,
    pub(super) prediction: Prediction,
    pub(super) step_s: f64,
    pub(super) horizon_s: f64,
    pub(super) distance_at: DistanceAt,
    pub(super) distance_cap_m: f64,
    /// Anything nearer than this to the robot's centre is contact \[m\].
    pub(super) contact_m: f64,
}

impl Roller<'_> {
    /// A stretch this short between two poses \[m\] that cannot be shown to be free counts as
    /// contact.
    const CONTACT_RESOLUTION_M: f64 = 1e-4;

    /// The trajectory of a candidate; `None` when the footprint would touch something on the way
    /// or leave the map.
    pub(super) fn roll(&self, candidate: Velocity) -> Option<Rollout> {
        let mut track = Track::from_here(self);
        let mut pose = self.scene.pose;
        let mut left_s = self.horizon_s;
        if self.prediction == Prediction::Arcs {
            let cycle_s = self.robot.cycle_s.min(left_s);
            let from = self.scene.velocity;
            let to = from.lerp(candidate, cycle_s / self.robot.cycle_s);
            let end = pose.after_ramp(from, to, cycle_s);
            // The mean of the speeds is the length provided that the robot does not reverse within
            // the cycle; the larger one always covers it.
            track.extend(end, from.v.abs().max(to.v.abs()) * cycle_s, |fraction| {
                pose.after_ramp(from, from.lerp(to, fraction), cycle_s * fraction)
            })?;
            pose = end;
            left_s -= cycle_s;
        }
        let steps = (left_s / self.step_s - 1e-9).ceil().max(0.0) as u32;
        let step_s = if steps > 0 { left_s / f64::from(steps) } else { 0.0 };
        for _ in 0..steps {
            let end = self.step(pose, candidate, step_s);
            track.extend(end, candidate.v.abs() * step_s, |fraction| {
                self.step(pose, candidate, step_s * fraction)
            })?;
            pose = end;
        }
        let distance_m = match self.distance_at {
            DistanceAt::Trajectory => track.nearest_m,
            DistanceAt::End => self.centre_distance(pose.point()),
        };
        Some(Rollout { end: pose, distance_m: distance_m - self.robot.radius_m })
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

    fn centre_distance(&self, point: Point) -> f64 {
        self.scene.obstacles.of_point(point, self.distance_cap_m + self.robot.radius_m)
    }
}

/// A trajectory while it is followed. Distances change by at most the length driven, so most poses
/// need no look-up: they can be neither in contact nor the nearest.
struct Track<'r, 'a> {
    roller: &'r Roller<'a>,
    /// Room at the last pose that was looked up: distance to obstacles or the map's border \[m\].
    room_m: f64,
    /// Length driven since then \[m\].
    travelled_m: f64,
    /// Smallest distance to an obstacle so far \[m\]. The map's border does not count as one: it
    /// only bounds where the footprint may be.
    nearest_m: f64,
}

impl<'r, 'a> Track<'r, 'a> {
    fn from_here(roller: &'r Roller<'a>) -> Self {
        let mut track = Self { roller, room_m: 0.0, travelled_m: 0.0, nearest_m: f64::INFINITY };
        track.room_m = track.look_up(roller.scene.pose.point());
        track
    }

    /// The room at a point.
    fn look_up(&mut self, point: Point) -> f64 {
        let distance = self.roller.centre_distance(point);
        self.nearest_m = self.nearest_m.min(distance);
        distance.min(self.roller.scene.obstacles.to_border(point))
    }

    /// Follows one more stretch of at most `length_m` to `end`; `between` gives the pose at a
    /// fraction of it. `None` on contact.
    fn extend(&mut self, end: Pose, length_m: f64, between: impl Fn(f64) -> Pose) -> Option<()> {
        // What is left of the last look-up at the beginning of this stretch, and at its end.
        let begin_m = self.room_m - self.travelled_m;
        if begin_m - length_m >= self.nearest_m.max(self.roller.contact_m) {
            self.travelled_m += length_m;
            return Some(());
        }
        let end_m = self.look_up(end.point());
        self.check(&between, (0.0, begin_m), (1.0, end_m), length_m)?;
        (self.room_m, self.travelled_m) = (end_m, 0.0);
        Some(())
    }

    /// Shows that the stretch between two fractions is free of contact. A point at length s of a
    /// stretch of length l has at least the room r1 - s and r2 - (l - s), so with r1 + r2 - l >= 2 c
    /// it has at least c everywhere; otherwise each half is looked at.
    fn check(
        &mut self,
        between: &impl Fn(f64) -> Pose,
        (from, from_m): (f64, f64),
        (to, to_m): (f64, f64),
        length_m: f64,
    ) -> Option<()> {
        let contact_m = self.roller.contact_m;
        if to_m < contact_m {
            return None;
        }
        if from_m + to_m - length_m >= 2.0 * contact_m {
            return Some(());
        }
        if length_m < Roller::CONTACT_RESOLUTION_M {
            return None;
        }
        let middle = 0.5 * (from + to);
        let middle_m = self.look_up(between(middle).point());
        self.check(between, (from, from_m), (middle, middle_m), 0.5 * length_m)?;
        self.check(between, (middle, middle_m), (to, to_m), 0.5 * length_m)
    }
}
