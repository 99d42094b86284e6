//! Report of a path with speeds along it: `keyway.curve/3`.

use super::Inputs;
use keyway::geometry::Path;
use keyway::smooth::{SpeedProfile, SpeedProfileConfig, SpeedSample};
use serde::Serialize;

/// `keyway.curve/3`: a path with speeds along it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveReport {
    /// Name and version of this format.
    pub schema: &'static str,
    /// Arc length of the path \[m\].
    pub length_m: f64,
    /// Time for the whole path \[s\].
    pub time_s: f64,
    /// Part of this time that is spent turning on the spot \[s\].
    pub turning_s: f64,
    /// Distance between two samples \[m\].
    pub spacing_m: f64,
    /// The path, sampled by arc length.
    pub samples: Vec<CurveSample>,
    /// All inputs of the result; `robot` is the robot whose limits apply.
    pub inputs: Inputs,
}

/// A sample of the path with its turn rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurveSample {
    /// Position, time and speed.
    #[serde(flatten)]
    pub sample: SpeedSample,
    /// Turn rate along the curve, positive to the left \[rad/s\].
    pub omega_radps: f64,
}

impl CurveReport {
    /// Name and version of this format.
    pub const SCHEMA: &'static str = "keyway.curve/3";

    /// Returns the report of a speed profile along `path`, computed with `config`.
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
