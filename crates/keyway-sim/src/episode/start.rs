//! Start of a robot.

use keyway::geometry::{Point, Pose};
use keyway::navigate::Goal;
use keyway::route::Route;
use serde::{Deserialize, Serialize};

/// A start; in files `[x, y]` \[m\] or `[x, y, yaw_deg]` \[m, m, deg\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "Vec<f64>", extend("minItems" = 2, "maxItems" = 3)))]
pub struct Start {
    /// Position \[m\].
    pub position: Point,
    /// Heading \[rad\], counter-clockwise from the x axis; `None`: along the planned path, or as
    /// close to it as clearance allows.
    pub heading_rad: Option<f64>,
}

impl Start {
    /// Step between two headings that are tried \[deg\].
    const STEP_DEG: u32 = 5;

    /// Returns the pose at the beginning of a route. Without a given heading the robot faces
    /// along its path, or as close to it as clearance allows.
    pub(super) fn pose(&self, route: &Route, has_room: impl Fn(Pose) -> bool) -> Pose {
        let Point { x, y } = self.position;
        if let Some(heading_rad) = self.heading_rad {
            return Pose::new(x, y, heading_rad);
        }
        let along = route.smoothed.segments().next().map_or(0.0, |s| (s.b - s.a).heading());
        let turns = (0..=180 / Self::STEP_DEG).map(|step| f64::from(step * Self::STEP_DEG));
        let mut poses = turns
            .flat_map(|turn_deg: f64| [turn_deg, -turn_deg])
            .map(|turn_deg| Pose::new(x, y, along + turn_deg.to_radians()));
        poses.find(|&pose| has_room(pose)).unwrap_or(Pose::new(x, y, along))
    }
}

impl TryFrom<Vec<f64>> for Start {
    type Error = String;

    fn try_from(numbers: Vec<f64>) -> Result<Self, String> {
        let Goal { position, heading_rad } = Goal::try_from(numbers)?;
        Ok(Self { position, heading_rad })
    }
}

impl From<Start> for Vec<f64> {
    fn from(start: Start) -> Self {
        let Start { position, heading_rad } = start;
        Goal { position, heading_rad }.into()
    }
}
