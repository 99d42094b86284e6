//! Where a candidate velocity would lead, and how near to obstacles.

use super::Scene;
use crate::geometry::{Point, Pose, Velocity};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// How a trajectory is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
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
    /// Nearer than this to the robot's centre is contact \[m\].
    pub(super) contact_m: f64,
    /// Distance of the centre to the nearest obstacle now \[m\], up to the cap.
    pub(super) centre_distance_m: f64,
}

impl Roller<'_> {
    /// A stretch this short between two poses \[m\] that cannot be shown to be free counts as
    /// contact.
    const CONTACT_RESOLUTION_M: f64 = 1e-4;

    /// The trajectory of a candidate; `None` when the footprint would touch something on the way
    /// or leave the map.
    pub(super) fn roll(&self, candidate: Velocity) -> Option<Rollout> {
        let mut track = Track {
            roller: self,
            at: self.scene.pose,
            at_distance_m: self.centre_distance_m,
            travelled_m: 0.0,
            nearest_m: self.centre_distance_m,
        };
        let mut pose = self.scene.pose;
        let mut left_s = self.horizon_s;
        if self.prediction == Prediction::Arcs {
            let cycle_s = self.robot.cycle_s.min(left_s);
            let from = self.scene.velocity;
            let to = from.lerp(candidate, cycle_s / self.robot.cycle_s);
            let end = pose.after_ramp(from, to, cycle_s);
            // The mean of the speeds is the length as long as the robot does not reverse within
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
    at: Pose,
    /// Distance at the last pose that was looked up \[m\].
    at_distance_m: f64,
    /// Length driven since then \[m\].
    travelled_m: f64,
    nearest_m: f64,
}

impl Track<'_, '_> {
    /// Follows one more stretch of at most `length_m` to `end`; `between` gives the pose at a
    /// fraction of it. `None` on contact.
    fn extend(&mut self, end: Pose, length_m: f64, between: impl Fn(f64) -> Pose) -> Option<()> {
        if !self.roller.scene.obstacles.is_inside_map(end.point(), self.roller.robot.radius_m) {
            return None;
        }
        self.travelled_m += length_m;
        let bound = self.at_distance_m - self.travelled_m;
        if bound >= self.nearest_m && bound > self.roller.contact_m {
            self.at = end;
            return Some(());
        }
        let end_distance = self.roller.centre_distance(end.point());
        self.nearest_m = self.nearest_m.min(end_distance);
        if end_distance < self.roller.contact_m {
            return None;
        }
        // Up to the last pose the way was shown to be free; of the stretch since then both ends
        // are known.
        let begin_distance =
            if self.travelled_m > length_m { bound + length_m } else { self.at_distance_m };
        self.check(&between, (0.0, begin_distance), (1.0, end_distance), length_m)?;
        (self.at, self.at_distance_m, self.travelled_m) = (end, end_distance, 0.0);
        Some(())
    }

    /// Shows that the stretch between two fractions is free of contact. A point at length s of a
    /// stretch of length l is at least d1 - s and d2 - (l - s) from everything, so with
    /// d1 + d2 - l >= 2 c nothing comes nearer than c; otherwise each half is looked at.
    fn check(
        &mut self,
        between: &impl Fn(f64) -> Pose,
        (from, from_m): (f64, f64),
        (to, to_m): (f64, f64),
        length_m: f64,
    ) -> Option<()> {
        if from_m + to_m - length_m >= 2.0 * self.roller.contact_m {
            return Some(());
        }
        if length_m < Roller::CONTACT_RESOLUTION_M {
            return None;
        }
        let middle = 0.5 * (from + to);
        let distance = self.roller.centre_distance(between(middle).point());
        self.nearest_m = self.nearest_m.min(distance);
        if distance < self.roller.contact_m {
            return None;
        }
        self.check(between, (from, from_m), (middle, distance), 0.5 * length_m)?;
        self.check(between, (middle, distance), (to, to_m), 0.5 * length_m)
    }
}
