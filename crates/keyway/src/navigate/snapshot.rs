//! Snapshot of a navigator between two cycles.

use super::Stack;
use super::navigator::{Errand, StoredRecord};
use super::restore_error::FORM;
use super::time::Time;
use super::world::StoredWorld;
use crate::geometry::{Pose, Velocity};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// The complete state of a navigator between two cycles. Restored
/// ([`Navigator::restore`](super::Navigator::restore)), also on another machine, it gives the
/// same commands for the same observations.
///
/// It can be written in any self-describing serde format that supports non-finite numbers, such
/// as CBOR. Derived data is recomputed instead of stored: map layers and distances. The planner's
/// path of the route and the reason of the last failed route attempt are not stored. The format
/// may change with every version of this library.
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
    /// Version of the snapshot format.
    pub const FORM: u32 = FORM;
}
