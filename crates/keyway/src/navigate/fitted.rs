//! A stack fitted to a robot, with its parts built: the input of a controller.

use super::Stack;
use crate::ConfigError;
use crate::given::Given;
use crate::guide::Guide;
use crate::local::{LocalPlanner, StopRule};
use crate::plan::GlobalPlanner;
use crate::robot::Robot;
use crate::sense::Tracker;
use crate::smooth::Smoother;
use std::sync::Arc;

/// A stack whose values have been checked for a robot. Its parts are built once; clones share
/// them. Its planner, smoother, guide and local planner can be replaced by custom ones.
///
/// ```
/// use keyway::guide::{Carrot, CarrotConfig};
/// use keyway::navigate::Stack;
/// use keyway::robot::Robot;
/// use std::sync::Arc;
///
/// let robot = Robot::small();
/// // Stands for a guide of your own.
/// let carrot = Carrot::new(CarrotConfig { look_ahead_m: 0.5 })?;
/// let stack = Stack::keyway(&robot).fit(&robot)?.with_guide(Arc::new(carrot));
/// assert_eq!(stack.robot(), &robot);
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FittedStack {
    pub(super) robot: Arc<Robot>,
    pub(super) stack: Arc<Stack>,
    /// Custom planner in place of the stack's, which is built with the map.
    pub(super) planner: Option<Arc<dyn GlobalPlanner + Send + Sync>>,
    pub(super) smoother: Arc<dyn Smoother + Send + Sync>,
    pub(super) guide: Arc<dyn Guide + Send + Sync>,
    pub(super) local: Arc<dyn LocalPlanner + Send + Sync>,
    /// True if the local planner is a custom one.
    has_own_local: bool,
    pub(super) tracker: Option<Tracker>,
    pub(super) stop_rule: Option<StopRule>,
}

impl Stack {
    /// Fits the stack to a robot, ready to drive. The needs of the map layers are checked with
    /// the map.
    ///
    /// # Errors
    /// Returns [`ConfigError`] for the first field that cannot be used: a value that is out of
    /// range, a clearance that is too small for the robot, or a planner that needs a static map.
    pub fn fit(&self, robot: &Robot) -> Result<FittedStack, ConfigError> {
        let fitted = self.build(robot)?;
        self.check_room(robot)?;
        self.check_planner()?;
        self.check_free_ends()?;
        Ok(fitted)
    }

    /// Checks every value on its own. Planning with parts of a stack needs no clearance that fits
    /// a robot.
    ///
    /// # Errors
    /// Returns [`ConfigError`] for the first field that cannot be used.
    pub fn check_parameters(&self, robot: &Robot) -> Result<(), ConfigError> {
        self.build(robot).map(drop)
    }

    fn build(&self, robot: &Robot) -> Result<FittedStack, ConfigError> {
        let within = |parent| move |error: ConfigError| error.within(parent);
        robot.validate().map_err(within("robot"))?;
        self.planner.check().map_err(within("planner"))?;
        let smoother = self.smoother.build().map_err(within("smoother"))?;
        let guide = self.guide.build().map_err(within("guide"))?;
        let robot = Arc::new(robot.clone());
        let local = self.local.build_for(&robot).map_err(within("local"))?;
        self.controller.check().map_err(within("controller"))?;
        Ok(FittedStack {
            planner: None,
            smoother: smoother.into(),
            guide: guide.into(),
            local: local.into(),
            has_own_local: false,
            tracker: self.controller.build_tracker().map_err(within("controller"))?,
            stop_rule: self.controller.build_stop_rule(&robot).map_err(within("controller"))?,
            stack: Arc::new(self.clone()),
            robot,
        })
    }

    /// Rejects clearances below the inscribed radius of the robot: its routes would lead through
    /// gaps in which the local planner finds nothing but contact.
    fn check_room(&self, robot: &Robot) -> Result<(), ConfigError> {
        let radius_m = robot.footprint.inscribed_radius_m();
        let clearances = [
            ("map.clearance_m", self.map.clearance_m),
            ("controller.least_clearance_m", self.controller.least_clearance_m),
        ];
        match clearances.into_iter().find(|(_, clearance_m)| *clearance_m < radius_m) {
            Some((field, clearance_m)) => {
                let expected = format!(
                    "at least {}, the inscribed radius of the robot ({}): a route must leave space for it",
                    Given(radius_m),
                    robot.footprint
                );
                Err(ConfigError::must_be(field, &expected, clearance_m))
            }
            None => Ok(()),
        }
    }

    /// Rejects planners that cannot plan on a changing map.
    fn check_planner(&self) -> Result<(), ConfigError> {
        if self.planner.needs_static_map() {
            let name = self.planner.name();
            let reason = format!(
                "cannot be `{name}`: it needs a static map, but the robot's sensors change the map; use jps"
            );
            return Err(ConfigError::new("planner.name", reason));
        }
        Ok(())
    }

    /// Rejects lifted clearances: a route would lead to where the footprint does not fit.
    fn check_free_ends(&self) -> Result<(), ConfigError> {
        if self.map.free_ends_m == 0.0 {
            return Ok(());
        }
        let expected = "0 for a robot: its route goes straight from the start to the nearest free \
                        cell, and from there to the goal, as far as its footprint fits";
        Err(ConfigError::must_be("map.free_ends_m", expected, self.map.free_ends_m))
    }
}

impl FittedStack {
    /// The robot with its speed limited \[m/s\], and a local planner for it; a custom one stays
    /// as it is.
    pub(super) fn slowed(
        &self,
        speed_mps: f64,
    ) -> (Arc<Robot>, Arc<dyn LocalPlanner + Send + Sync>) {
        let mut robot = (*self.robot).clone();
        robot.limits.v_max_mps = robot.limits.v_max_mps.min(speed_mps);
        robot.limits.v_min_mps = robot.limits.v_min_mps.max(-speed_mps);
        let robot = Arc::new(robot);
        if self.has_own_local {
            return (robot, Arc::clone(&self.local));
        }
        let local = self.stack.local.build_for(&robot);
        // A planner that can be built for a robot can be built for a slower one.
        let local = local.map_or_else(|_| Arc::clone(&self.local), Arc::from);
        (robot, local)
    }

    /// The robot that the stack is fitted to.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The stack as data.
    pub fn stack(&self) -> &Stack {
        &self.stack
    }

    /// Replaces the global planner of the stack by a custom one.
    #[must_use]
    pub fn with_planner(self, planner: Arc<dyn GlobalPlanner + Send + Sync>) -> Self {
        Self { planner: Some(planner), ..self }
    }

    /// Replaces the smoother of the stack by a custom one.
    #[must_use]
    pub fn with_smoother(self, smoother: Arc<dyn Smoother + Send + Sync>) -> Self {
        Self { smoother, ..self }
    }

    /// Replaces the local planner of the stack by a custom one.
    #[must_use]
    pub fn with_local(self, local: Arc<dyn LocalPlanner + Send + Sync>) -> Self {
        Self { local, has_own_local: true, ..self }
    }

    /// Replaces the guide of the stack by a custom one.
    #[must_use]
    pub fn with_guide(self, guide: Arc<dyn Guide + Send + Sync>) -> Self {
        Self { guide, ..self }
    }
}
