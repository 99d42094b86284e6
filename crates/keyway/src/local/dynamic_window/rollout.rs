//! What is known of where a candidate velocity would lead.

use crate::geometry::Pose;
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

/// Which velocities are admissible, of those whose trajectory touches nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Admissible {
    /// \[You2021, eq. (7)\]: those that could stop within dist, the distance to what is beside the trajectory as well as
    /// ahead.
    StoppingDistance,
    /// All of them. With [`Prediction::Arcs`] the way to stop is part of the trajectory.
    Rollout,
}

/// A predicted trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::local) struct Rollout {
    /// The pose that is compared with the guide point.
    pub(in crate::local) judged: Pose,
    /// How well the robot looks at the guide point there ([`raw`](crate::local::terms::heading::raw)).
    pub(in crate::local) heading: f64,
    /// Distance of the footprint to the nearest obstacle \[m\], up to the cap.
    pub(in crate::local) distance_m: f64,
}
