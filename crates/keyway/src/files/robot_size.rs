//! The size of the robot that paths are planned for, and the values derived from it.

use super::parameter_layers::{FieldValue, LayerError, ParameterLayers};
use super::stack_base::StackBase;
use crate::ConfigError;
use crate::map::{GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use crate::navigate::Stack;
use crate::robot::{Footprint, FootprintError, Robot};
use thiserror::Error;

/// Size of the robot that paths are planned for: a robot, a radius, or a robot with another
/// radius. Without either, paths are for a point.
///
/// ```
/// use keyway::files::{ParameterLayers, RobotSize, StartingValues};
/// use keyway::robot::Robot;
///
/// let size = RobotSize::new(Some(Robot::small()), Some(0.25))?;
/// let layers = ParameterLayers::default();
/// let stack = size.plan_stack(StartingValues::ForSize, &layers, &[])?;
/// assert_eq!(stack.map.clearance_m, 0.25);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotSize {
    robot: Option<Robot>,
    radius_m: Option<f64>,
}

/// Initial values of a planner or smoother that is selected by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartingValues {
    /// Distances for the size of the robot.
    #[default]
    ForSize,
    /// Values of its paper, for maps with cells of 1 m.
    AsPublished,
}

impl StartingValues {
    /// The values of papers if requested, otherwise those for the size.
    pub const fn published_if(is_asked: bool) -> Self {
        if is_asked { Self::AsPublished } else { Self::ForSize }
    }
}

impl RobotSize {
    /// Size of a robot, or of a radius \[m\] only. With both, the robot becomes a disc of that
    /// radius.
    ///
    /// # Errors
    /// Returns [`FootprintError`] if no robot can have the radius.
    pub fn new(robot: Option<Robot>, radius_m: Option<f64>) -> Result<Self, FootprintError> {
        if let Some(radius_m) = radius_m.filter(|it| !it.is_finite() || *it < 0.0) {
            return Err(FootprintError::Radius(radius_m));
        }
        let resized = |robot: Robot| match radius_m {
            Some(radius_m) => Ok(Robot { footprint: Footprint::circle(radius_m)?, ..robot }),
            None => Ok(robot),
        };
        Ok(Self { robot: robot.map(resized).transpose()?, radius_m })
    }

    /// The robot with its radius; `None` if only a radius is known, or nothing.
    pub const fn robot(&self) -> Option<&Robot> {
        self.robot.as_ref()
    }

    /// The robot that parameters are checked for; `small` if none is known.
    pub fn robot_or_small(&self) -> Robot {
        self.robot.clone().unwrap_or_else(Robot::small)
    }

    /// Clearance required by the size, as a field of a stack. The field is called `radius` or
    /// `robot`, after its source.
    pub fn clearance(&self) -> Option<FieldValue> {
        let of_robot = || self.robot().map(|robot| robot.footprint.inscribed_radius_m());
        let field = if self.radius_m.is_some() { "radius" } else { "robot" };
        let radius_m = self.radius_m.or_else(of_robot)?;
        Some(FieldValue::new(field, "map.clearance_m", radius_m))
    }

    /// The stack for planning with this clearance and all layers ([`ParameterLayers::over`]).
    ///
    /// # Errors
    /// Names the layer and the path of the first invalid parameter.
    pub fn plan_stack(
        &self,
        values: StartingValues,
        layers: &ParameterLayers,
        others: &[String],
    ) -> Result<Stack, LayerError> {
        let robot = self.robot_or_small();
        let stack = Stack::for_plans(&robot);
        let base = match (values, &self.robot) {
            (StartingValues::AsPublished, _) => StackBase::as_published(&stack, &robot),
            (StartingValues::ForSize, Some(_)) => StackBase::for_robot(&stack, &robot),
            (StartingValues::ForSize, None) => StackBase::for_radius(&stack, &robot, self.radius_m),
        };
        let mut layers = layers.clone();
        layers.fields.extend(self.clearance());
        layers.over(base, others)
    }

    /// Layers of a map for paths of this size.
    ///
    /// # Errors
    /// Returns [`RobotLayersError`] if a radius leaves no cell free, or if a value of the config
    /// is invalid.
    pub fn layers(
        &self,
        grid: &OccupancyGrid,
        config: LayerConfig,
    ) -> Result<SearchMap, RobotLayersError> {
        if let Some(radius_m) = self.radius_m {
            RadiusBeyondMap::check(radius_m, grid.frame()).map_err(RobotLayersError::Radius)?;
        }
        let map = SearchMap::new(grid, config)
            .map_err(|error| RobotLayersError::Config(error.within("map")))?;
        RadiusBeyondMap::check(map.config().clearance_m, map.frame())
            .map_err(RobotLayersError::Clearance)?;
        Ok(map)
    }
}

/// Reason why a map has no layers for a robot size.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotLayersError {
    /// The requested radius is too large.
    #[error(transparent)]
    Radius(RadiusBeyondMap),
    /// The clearance of the config is too large.
    #[error(transparent)]
    Clearance(RadiusBeyondMap),
    /// A value of the config is invalid.
    #[error(transparent)]
    Config(ConfigError),
}

/// Radius for which no cell of a map can be free: more than half of the map's shorter side.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "a radius of {} m leaves no cell free on this map of {width_m:.3} x {height_m:.3} m; lengths are \
     in metres, not in millimetres",
    radius_text(*radius_m)
)]
#[non_exhaustive]
pub struct RadiusBeyondMap {
    /// The radius \[m\].
    pub radius_m: f64,
    /// Width of the map \[m\].
    pub width_m: f64,
    /// Height of the map \[m\].
    pub height_m: f64,
}

impl RadiusBeyondMap {
    /// Refuses a radius \[m\] that leaves no cell free.
    ///
    /// # Errors
    /// Returns [`RadiusBeyondMap`] if the disc is larger than the map.
    pub fn check(radius_m: f64, frame: &GridFrame) -> Result<(), Self> {
        let [width_m, height_m] =
            [frame.width(), frame.height()].map(|cells| f64::from(cells) * frame.resolution_m());
        let is_too_large = 2.0 * radius_m > width_m.min(height_m) * (1.0 + 1e-9);
        if is_too_large { Err(Self { radius_m, width_m, height_m }) } else { Ok(()) }
    }
}

fn radius_text(radius_m: f64) -> String {
    if radius_m < 1e9 { format!("{radius_m}") } else { format!("{radius_m:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth::SmootherConfig;

    fn safe_m(size: &RobotSize, values: StartingValues) -> f64 {
        let fields = vec![FieldValue::new("smoother", "smoother.name", "hierarchical")];
        let layers = ParameterLayers { fields, ..ParameterLayers::default() };
        let stack = size.plan_stack(values, &layers, &[]).unwrap();
        let SmootherConfig::Hierarchical(config) = stack.smoother else { unreachable!() };
        config.safe_distance_m
    }

    #[test]
    fn parts_begin_with_distances_for_the_size() {
        let robot = Robot::small();
        let of_robot = RobotSize::new(Some(robot.clone()), None).unwrap();
        assert_eq!(safe_m(&of_robot, StartingValues::ForSize), robot.preferred_clearance_m());
        let of_radius = RobotSize::new(None, Some(0.25)).unwrap();
        assert_eq!(safe_m(&of_radius, StartingValues::ForSize), 0.25);
        for size in [of_robot, of_radius, RobotSize::default()] {
            assert_eq!(safe_m(&size, StartingValues::AsPublished), 0.8);
        }
    }

    #[test]
    fn a_clearance_follows_from_radius_or_robot() {
        let robot = Robot::small();
        let own_m = robot.footprint.inscribed_radius_m();
        for (robot, radius_m, expected) in [
            (None, None, None),
            (Some(&robot), None, Some(("robot", own_m))),
            (None, Some(0.5), Some(("radius", 0.5))),
            (Some(&robot), Some(0.5), Some(("radius", 0.5))),
        ] {
            let size = RobotSize::new(robot.cloned(), radius_m).unwrap();
            let clearance = size.clearance();
            let found = clearance.as_ref().map(|it| (it.field, it.value.as_float().unwrap()));
            assert_eq!(found, expected);
            assert_eq!(size.robot().is_some(), robot.is_some());
        }
        assert!(RobotSize::new(Some(robot), Some(1e4)).is_err());
        for radius_m in [-1.0, -1e-300, f64::NAN, f64::INFINITY] {
            let refused = RobotSize::new(None, Some(radius_m));
            assert!(matches!(refused, Err(FootprintError::Radius(_))), "{radius_m}");
        }
    }

    #[test]
    fn a_radius_beyond_the_map_is_refused() {
        let grid = OccupancyGrid::from_ascii(&["....", "...."]);
        let config = |clearance_m| LayerConfig { clearance_m, ..LayerConfig::default() };
        let layers = |radius_m, clearance_m| {
            RobotSize::new(None, radius_m).unwrap().layers(&grid, config(clearance_m)).map(drop)
        };
        assert_eq!(layers(None, 0.0), Ok(()));
        assert_eq!(layers(Some(1.0), 1.0), Ok(()));
        let beyond = RadiusBeyondMap { radius_m: 1.5, width_m: 4.0, height_m: 2.0 };
        assert_eq!(layers(Some(1.5), 0.0), Err(RobotLayersError::Radius(beyond)));
        assert_eq!(layers(None, 1.5), Err(RobotLayersError::Clearance(beyond)));
        let error = layers(None, -1.0).unwrap_err();
        assert!(error.to_string().starts_with("map.clearance_m must be"), "{error}");
        let start = "a radius of 1.5 m leaves no cell free on this map of 4.000 x 2.000 m; ";
        assert!(beyond.to_string().starts_with(start), "{beyond}");
    }
}
