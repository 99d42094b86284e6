//! A navigator between two cycles, as a value.

use super::Stack;
use super::navigator::{Errand, StoredRecord};
use super::restore_error::FORM;
use super::time::Time;
use super::world::StoredWorld;
use crate::geometry::{Pose, Velocity};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// All of a navigator between two cycles: stored, opened on another machine and restored
/// ([`Navigator::restore`](super::Navigator::restore)), it gives the same commands for the same
/// observations.
///
/// It can be written in every format of serde that describes itself and has numbers that are not
/// finite, such as CBOR. What follows from the rest is not stored, but made again: layers of the
/// map and distances. Nor is the planner's path of the route, and why the last attempt at a route
/// failed. Its form may change with every version of this library.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snapshot {
    /// [`Self::FORM`].
    pub(super) form: u32,
    pub(super) robot: Robot,
    pub(super) stack: Stack,
    pub(super) world: StoredWorld,
    pub(super) errand: Option<Errand>,
    pub(super) record: StoredRecord,
    pub(super) speed_limit_mps: Option<f64>,
    pub(super) place: Option<Pose>,
    pub(super) stepped: Option<Time>,
    pub(super) unobserved: u32,
    pub(super) issued: Velocity,
}

impl Snapshot {
    /// Number of the form in which snapshots are stored.
    pub const FORM: u32 = FORM;
}
