//! What is reported of a path with speeds along it: `keyway.curve/3`.

use super::Inputs;
use keyway::geometry::Path;
use keyway::smooth::{SpeedProfile, SpeedProfileConfig, SpeedSample};
use serde::Serialize;

/// `keyway.curve/3`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveReport {
    /// Name and version of this form.
    pub schema: &'static str,
    /// Arc length of the path \[m\].
    pub length_m: f64,
    /// Time for the whole path \[s\].
    pub time_s: f64,
    /// The part of it that is spent turning on the spot \[s\].
    pub turning_s: f64,
    /// Distance between two samples \[m\].
    pub spacing_m: f64,
    /// The path, sampled by arc length.
    pub samples: Vec<CurveSample>,
    /// All that the result depends on; `robot` is the one whose limits were kept.
    pub inputs: Inputs,
}

/// A sample of the path, and the turn rate there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurveSample {
    /// Place, time and speed.
    #[serde(flatten)]
    pub sample: SpeedSample,
    /// Turn rate along the curve, positive to the left \[rad/s\].
    pub omega_radps: f64,
}

impl CurveReport {
    /// Name and version of this form.
    pub const SCHEMA: &'static str = "keyway.curve/3";

    /// The report of a profile that was made of `path` with `config`.
    pub fn new(
        path: &Path,
        profile: &SpeedProfile,
        config: &SpeedProfileConfig,
        inputs: Inputs,
    ) -> Self {
        Self {
            schema: Self::SCHEMA,
            length_m: path.length_m(),
            time_s: profile.time_s,
            turning_s: profile.turning_s,
            spacing_m: config.spacing_m,
            samples: profile.samples.iter().map(|&sample| sample.into()).collect(),
            inputs,
        }
    }
}

impl From<SpeedSample> for CurveSample {
    fn from(sample: SpeedSample) -> Self {
        Self { sample, omega_radps: sample.omega_radps() }
    }
}
