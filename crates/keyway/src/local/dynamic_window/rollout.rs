//! The predicted trajectory of a candidate velocity, and the options of the prediction.

use crate::geometry::Pose;
use serde::{Deserialize, Serialize};

/// Method by which a trajectory is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Prediction {
    /// \[You2021, eq. (4)\]: Euler steps at the candidate velocity.
    Euler,
    /// The motion of the robot: one cycle in which the velocity changes linearly to the
    /// candidate, then the exact circular arc.
    Arcs,
}

/// Point of a trajectory at which its distance to obstacles is measured.
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

/// Admissibility of the velocities whose trajectory touches nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Admissible {
    /// \[You2021, eq. (7)\]: those that could stop within dist, the distance to obstacles beside
    /// the trajectory as well as ahead.
    StoppingDistance,
    /// All of them. With [`Prediction::Arcs`] the braking motion is part of the trajectory.
    Rollout,
}

/// The predicted trajectory of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rollout {
    /// Pose after [`judged_s`](crate::local::WindowConfig::judged_s), which is compared with the
    /// guide point.
    pub judged: Pose,
    /// Pi less the absolute bearing of the guide point from there \[rad\].
    pub heading: f64,
    /// Distance of the footprint to the nearest obstacle \[m\], up to
    /// [`distance_cap_m`](crate::local::WindowConfig::distance_cap_m).
    pub distance_m: f64,
}
