//! The goal of a robot.

use crate::geometry::{Point, Pose, degrees, wrap_angle};
use serde::{Deserialize, Serialize};

/// A goal; in files `[x, y]` \[m\] or `[x, y, yaw_deg]` \[m, m, deg\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "Vec<f64>", extend("minItems" = 2, "maxItems" = 3)))]
pub struct Goal {
    /// Position \[m\].
    pub position: Point,
    /// Goal heading \[rad\], counter-clockwise from the x axis; `None`: any heading.
    pub heading_rad: Option<f64>,
}

impl Goal {
    /// Rotation from the heading of a pose to the goal heading, positive to the left \[rad\];
    /// `None` if any heading will do.
    pub(crate) fn turn_left_rad(&self, pose: Pose) -> Option<f64> {
        self.heading_rad.map(|heading_rad| wrap_angle(heading_rad - pose.theta))
    }
}

impl From<Point> for Goal {
    /// A goal at any heading.
    fn from(position: Point) -> Self {
        Self { position, heading_rad: None }
    }
}

impl TryFrom<Vec<f64>> for Goal {
    type Error = String;

    /// Reads the numbers of a file, with the heading in degrees.
    fn try_from(numbers: Vec<f64>) -> Result<Self, String> {
        match numbers[..] {
            [x, y] => Ok(Point::new(x, y).into()),
            [x, y, yaw_deg] => {
                let heading_rad = Some(yaw_deg.to_radians());
                Ok(Self { position: Point::new(x, y), heading_rad })
            }
            _ => Err(format!("expected [x, y] or [x, y, yaw_deg], got {} numbers", numbers.len())),
        }
    }
}

impl From<Goal> for Vec<f64> {
    /// The numbers for a file, with the heading in degrees.
    fn from(goal: Goal) -> Self {
        let Point { x, y } = goal.position;
        [Some(x), Some(y), goal.heading_rad.map(degrees)].into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn goals_are_written_as_numbers() {
        let read = |text| serde_json::from_str::<Goal>(text);
        assert_eq!(read("[1, 2]").unwrap(), Point::new(1.0, 2.0).into());
        let with_yaw = read("[1, 2, -90]").unwrap();
        assert_eq!((with_yaw.position.y, with_yaw.heading_rad), (2.0, Some(-FRAC_PI_2)));
        assert_eq!(serde_json::to_string(&with_yaw).unwrap(), "[1.0,2.0,-90.0]");
        assert!(
            read("[1]").unwrap_err().to_string().contains("expected [x, y] or [x, y, yaw_deg]")
        );
        let left_rad = with_yaw.turn_left_rad(Pose::new(0.0, 0.0, 3.0 * FRAC_PI_2 - 0.25));
        assert!((left_rad.unwrap() - 0.25).abs() < 1e-12);
        assert_eq!(Goal::from(Point::default()).turn_left_rad(Pose::default()), None);
    }
}
