//! The path sampled by arc length, with the fastest speeds along it, as a table.

use crate::args::{CurveFormat, PlanArgs};
use crate::error::{CliError, Kind};
use keyway::geometry::Path;
use keyway::robot::Robot;
use keyway::smooth::{SpeedProfile, SpeedProfileConfig, SpeedProfileError};
use keyway_sim::report::{CurveReport, Inputs};

pub(super) const CURVE: &str = "--curve";

/// Settings of the requested curve.
pub(super) struct Curve {
    format: CurveFormat,
    robot: Robot,
    config: SpeedProfileConfig,
}

impl Curve {
    /// Uses the limits of the named robot, or else of the default robot. `None` if no curve is
    /// requested.
    pub(super) fn from_args(args: &PlanArgs, robot: Option<&Robot>) -> Option<Self> {
        let file = args.curve.as_ref()?;
        let usual = SpeedProfileConfig::default();
        let spacing_m = args.spacing.unwrap_or(usual.spacing_m);
        Some(Self {
            format: file.format,
            robot: robot.cloned().unwrap_or_else(Robot::small),
            config: SpeedProfileConfig { spacing_m, ..usual },
        })
    }

    /// Returns the content of the file.
    pub(super) fn bytes(&self, path: &Path, inputs: &Inputs) -> Result<Vec<u8>, CliError> {
        let checked = self.config.check_spacing(path);
        let profile = checked
            .and_then(|()| SpeedProfile::of_path(path, &self.robot.limits, &self.config))
            .map_err(|error| self.refused(&error))?;
        let text = match self.format {
            CurveFormat::Csv => profile.to_csv(),
            CurveFormat::Json => {
                let inputs = Inputs { robot: Some(self.robot.clone()), ..inputs.clone() };
                crate::json::to_string(&CurveReport::new(path, &profile, &self.config, inputs))
            }
        };
        Ok(text.into_bytes())
    }

    fn refused(&self, error: &SpeedProfileError) -> CliError {
        if let SpeedProfileError::TooFine { .. } = error {
            let message = format!("--spacing {:?}: {error}", self.config.spacing_m);
            return CliError::new(Kind::Usage, message).field("--spacing");
        }
        CliError::new(Kind::Config, error).field("--robot")
    }
}
