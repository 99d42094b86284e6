//! Placement of maps.

use crate::geometry::Pose;
use serde::{Deserialize, Serialize};

/// Placement of a map whose file does not contain one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImagePlacement {
    /// Side of a cell \[m\].
    pub resolution_m: f64,
    /// World pose of the lower-left corner of the map.
    pub origin: Pose,
}

impl Default for ImagePlacement {
    /// Cells of 1 m, the lower-left corner at the origin of the world.
    fn default() -> Self {
        Self { resolution_m: 1.0, origin: Pose::default() }
    }
}
