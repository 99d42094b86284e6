//! Parameters laid over a stack, as a file of them, `--set` and every other caller give them.

use super::overlay::{NamedDefault, Overlay, OverlayError};
use crate::ConfigError;
use crate::guide::GuideConfig;
use crate::local::LocalConfig;
use crate::navigate::Stack;
use crate::plan::PlannerConfig;
use crate::robot::Robot;
use crate::smooth::SmootherConfig;
use serde::Serialize;
use thiserror::Error;
use toml::Table;

/// Why parameters cannot be laid over a stack.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// There is no such field, or it holds another kind of value.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// The value cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// A stack that parameters are laid over.
///
/// ```
/// use keyway::files::{StackBase, from_toml};
/// use keyway::navigate::Stack;
/// use keyway::robot::Robot;
///
/// let robot = Robot::small();
/// let stack = Stack::keyway(&robot);
/// let base = StackBase::for_robot(&stack, &robot);
/// let changed = base.with(&from_toml("planner.name = \"astar\"\nplanner.corners = \"allow\"")?)?;
/// assert_eq!(changed.planner.name(), "astar");
/// // Names choose parts for the robot, whose distances are not those of papers with cells of 1 m.
/// let named = base.with(&from_toml("smoother.name = \"hierarchical\"")?)?;
/// assert_eq!(named.smoother.safe_distance_m(0.05), robot.preferred_clearance_m());
/// let named = base.with(&from_toml("planner.name = \"hsta\"")?)?;
/// let keyway::plan::PlannerConfig::Hsta(hsta) = named.planner else { unreachable!() };
/// assert_eq!(hsta.l1_constraint, 2.0 * robot.preferred_clearance_m());
/// let wrong = base.with(&from_toml("map.clearance = 0.3")?).unwrap_err().to_string();
/// assert!(wrong.starts_with("there is no field `map.clearance`; `map` has: "), "{wrong}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct StackBase<'a> {
    stack: &'a Stack,
    robot: &'a Robot,
    presets: Presets,
}

/// With which values a planner or smoother that is chosen by its name begins.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Presets {
    /// With distances for the robot.
    Robot,
    /// With this as the safe distance \[m\].
    Keeping(f64),
    /// With the usual ones.
    Usual,
    /// With those of its paper.
    Published,
}

impl<'a> StackBase<'a> {
    /// A stack for a robot: a part that is chosen by its name begins with the parameters for the
    /// robot.
    pub const fn for_robot(stack: &'a Stack, robot: &'a Robot) -> Self {
        Self { stack, robot, presets: Presets::Robot }
    }

    /// A stack for paths that keep this radius \[m\], of a robot of which no more is known: a
    /// smoother with a safe distance of its own begins with the radius. Without one (`None`) it
    /// begins with its usual value.
    pub fn for_radius(stack: &'a Stack, robot: &'a Robot, radius_m: Option<f64>) -> Self {
        Self { stack, robot, presets: radius_m.map_or(Presets::Usual, Presets::Keeping) }
    }

    /// A stack as published: a part that is chosen by its name begins with the values of its paper,
    /// where it has one.
    pub const fn as_published(stack: &'a Stack, robot: &'a Robot) -> Self {
        Self { stack, robot, presets: Presets::Published }
    }

    /// The stack with these changes, a part of a stack as TOML; every value is checked.
    ///
    /// # Errors
    /// Names the first field that cannot be changed so, or whose value cannot be used.
    pub fn with(&self, changes: &Table) -> Result<Stack, ParameterError> {
        let stack = if changes.is_empty() { self.stack.clone() } else { self.laid_over(changes)? };
        stack.check_parameters(self.robot)?;
        Ok(stack)
    }

    fn laid_over(&self, changes: &Table) -> Result<Stack, OverlayError> {
        let named: NamedDefault<'_> = &|path, name| self.part(path, name);
        let mut overlay = Overlay::of(self.stack, named)?;
        overlay.merge(changes)?;
        overlay.finish()
    }

    /// The robot that the stack is for.
    pub const fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// The stack as it is without changes.
    pub const fn stack(&self) -> &'a Stack {
        self.stack
    }

    /// The parameters with which a part of a stack begins.
    ///
    /// # Errors
    /// The names that there are where there is no such name.
    pub fn part(&self, path: &str, name: &str) -> Result<Table, Vec<&'static str>> {
        match path {
            "planner" => {
                let planner = PlannerConfig::by_name(name).map(|planner| match self.safe_m() {
                    Some(safe_distance_m) => planner.keeping(safe_distance_m),
                    None => planner,
                });
                self.table(planner, PlannerConfig::as_published, &PlannerConfig::NAMES)
            }
            "smoother" => {
                let smoother = SmootherConfig::by_name(name).map(|smoother| match self.safe_m() {
                    Some(safe_distance_m) => smoother.keeping(safe_distance_m),
                    None => smoother,
                });
                self.table(smoother, SmootherConfig::as_published, &SmootherConfig::NAMES)
            }
            "guide" => {
                let guide = GuideConfig::by_name(name, self.robot);
                self.table(guide, GuideConfig::as_published, &GuideConfig::NAMES)
            }
            "local" => {
                let local = LocalConfig::by_name(name, self.robot);
                self.table(local, LocalConfig::as_published, &LocalConfig::NAMES)
            }
            _ => Err(Vec::new()),
        }
    }

    /// The safe distance of the robot, where one is known \[m\].
    fn safe_m(&self) -> Option<f64> {
        match self.presets {
            Presets::Robot => Some(self.robot.preferred_clearance_m()),
            Presets::Keeping(radius_m) => Some(radius_m),
            Presets::Usual | Presets::Published => None,
        }
    }

    fn table<P: Serialize>(
        &self,
        part: Option<P>,
        published: fn(&P) -> Option<P>,
        names: &[&'static str],
    ) -> Result<Table, Vec<&'static str>> {
        let part = part.map(|part| {
            published(&part).filter(|_| self.presets == Presets::Published).unwrap_or(part)
        });
        part.and_then(|part| Table::try_from(part).ok()).ok_or_else(|| names.to_vec())
    }
}
