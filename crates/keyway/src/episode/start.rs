//! Where a robot stands at the beginning.

use crate::geometry::{Point, Pose};
use crate::route::Route;
use serde::{Deserialize, Serialize};

/// A start: `[x, y]` \[m\] or `[x, y, yaw]` \[m, m, deg\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Start {
    /// Where \[m\].
    pub position: Point,
    /// Heading \[deg\], counter-clockwise from the x axis; `None`: along the planned path.
    pub yaw_deg: Option<f64>,
}

impl Start {
    /// The pose at the beginning of a route.
    pub(super) fn pose(&self, route: &Route) -> Pose {
        let Point { x, y } = self.position;
        let along_path = || route.smoothed.segments().next().map_or(0.0, |s| (s.b - s.a).heading());
        Pose::new(x, y, self.yaw_deg.map_or_else(along_path, f64::to_radians))
    }
}

impl TryFrom<Vec<f64>> for Start {
    type Error = String;

    fn try_from(numbers: Vec<f64>) -> Result<Self, String> {
        match numbers[..] {
            [x, y] => Ok(Self { position: Point::new(x, y), yaw_deg: None }),
            [x, y, yaw] => Ok(Self { position: Point::new(x, y), yaw_deg: Some(yaw) }),
            _ => Err(format!("expected [x, y] or [x, y, yaw], got {} numbers", numbers.len())),
        }
    }
}

impl From<Start> for Vec<f64> {
    fn from(start: Start) -> Self {
        let Point { x, y } = start.position;
        [Some(x), Some(y), start.yaw_deg].into_iter().flatten().collect()
    }
}
