//! The goal alone: a smoothed path -> its end, from the beginning on.
//!
//! Without a route to guide it, the dynamic window approach drives straight to the goal
//! \[Fox1997\]: the baseline of fused planners.

use super::parameters::{BoxedGuide, GuideParameters};
use super::{Guidance, Guide, GuideMemory, GuideView};
use crate::ConfigError;
use crate::geometry::{Point, Polyline};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of [`GoalGuide`]: none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GoalConfig {}

/// Guides straight to the goal.
#[derive(Clone, Debug, Default)]
pub struct GoalGuide {}

impl GoalGuide {
    /// Its name in stacks and reports.
    pub const NAME: &'static str = "goal";
}

impl GuideParameters for GoalConfig {
    fn for_robot(_: &Robot) -> Self {
        Self {}
    }

    fn build(&self) -> Result<BoxedGuide, ConfigError> {
        Ok(Box::new(GoalGuide {}))
    }
}

impl Guide for GoalGuide {
    fn guide(&self, view: &GuideView<'_>, _: &mut GuideMemory) -> Option<Guidance> {
        let &point = view.path.points().last()?;
        Some(Guidance { point, remaining_m: view.position.distance(point) })
    }

    fn points(&self, path: &Polyline) -> Vec<Point> {
        path.points().last().copied().into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Clearance, OccupancyGrid};

    #[test]
    fn hands_out_the_end_of_the_path() {
        let map = OccupancyGrid::from_ascii(&["."]);
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        let path = &Polyline::new(points.iter().map(|&p| p.into()).collect());
        let position = Point::new(0.0, 0.0);
        let obstacles = Clearance::new(map.frame(), map.occupied());
        let view = GuideView { path, position, obstacles, clearance_m: 0.1 };
        let guided = GoalGuide {}.guide(&view, &mut GuideMemory::default());
        let point = Point::new(4.0, 3.0);
        assert_eq!(guided, Some(Guidance { point, remaining_m: 5.0 }));
        assert_eq!(GoalGuide {}.points(path), [point]);
    }
}
