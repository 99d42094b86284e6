//! Steps of a navigator.

use keyway::geometry::Velocity;
use keyway::navigate::Blocked;
use pyo3::prelude::*;

/// Command until the next cycle, and its reason.
///
/// >>> import keyway, numpy as np
/// >>> grid = keyway.Map.from_array(np.zeros((40, 40), dtype=bool), resolution=0.1)
/// >>> navigator = keyway.Navigator(grid)
/// >>> navigator.observe(0.0, pose=(1, 1, 0), velocity=(0, 0), scan=navigator.clear_scan)
/// >>> navigator.set_goal((3, 1))
/// >>> navigator.step()
/// <keyway.Step drive: 0.050 m/s, 0.000 rad/s>
#[pyclass(frozen, get_all, module = "keyway")]
pub(crate) struct Step {
    /// Forward speed [m/s].
    v: f64,
    /// Turn rate, positive to the left [rad/s].
    omega: f64,
    /// `drive`, `blocked` (there is no acceptable command at the moment; the given one is safe),
    /// `arrived`, or `idle` (there is no goal).
    status: &'static str,
    /// Message with the reason for `blocked`; otherwise `None`.
    why: Option<String>,
    /// Number of the reason for `blocked`, which never changes; otherwise `None`.
    kind: Option<u16>,
    /// Message that the robot started with less clearance than it needs, and is leaving the
    /// obstacle; otherwise `None`.
    notice: Option<String>,
}

#[pymethods]
impl Step {
    fn __repr__(&self) -> String {
        let Self { v, omega, status, why, .. } = self;
        let why = why.as_ref().map_or_else(String::new, |why| format!(" ({why})"));
        format!("<keyway.Step {status}: {v:.3} m/s, {omega:.3} rad/s{why}>")
    }
}

impl Step {
    pub(crate) fn new(step: keyway::navigate::Step, notice: Option<String>) -> Self {
        let Velocity { v, omega, .. } = step.command();
        let (why, kind) = (step.why().map(ToString::to_string), step.why().map(Blocked::kind));
        Self { v, omega, status: step.name(), why, kind, notice }
    }
}
