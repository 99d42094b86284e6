//! Parameters applied to a stack, as given by a file, by `--set` and by every other caller.

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

/// Reason why parameters cannot be applied to a stack.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// There is no such field, or its value has another type.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// The value is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// A stack that parameters are applied to.
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

/// Initial values of a planner or smoother that is selected by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Presets {
    /// Distances for the robot.
    Robot,
    /// This safe distance \[m\].
    Keeping(f64),
    /// Default values.
    Usual,
    /// Values of its paper.
    Published,
}

impl<'a> StackBase<'a> {
    /// A stack for a robot: a part that is selected by its name starts with the parameters for the
    /// robot.
    pub const fn for_robot(stack: &'a Stack, robot: &'a Robot) -> Self {
        Self { stack, robot, presets: Presets::Robot }
    }

    /// A stack for paths that keep this radius \[m\], if nothing else is known of the robot. A
    /// smoother with a safe distance of its own starts with the radius, or with its default value
    /// if there is none (`None`).
    pub fn for_radius(stack: &'a Stack, robot: &'a Robot, radius_m: Option<f64>) -> Self {
        Self { stack, robot, presets: radius_m.map_or(Presets::Usual, Presets::Keeping) }
    }

    /// A stack as published: a part that is selected by its name starts with the values of its
    /// paper, if it has one.
    pub const fn as_published(stack: &'a Stack, robot: &'a Robot) -> Self {
        Self { stack, robot, presets: Presets::Published }
    }

    /// The stack with these changes, given as a part of a stack in TOML; every value is checked.
    ///
    /// # Errors
    /// Names the first field that cannot be changed like this, or whose value is invalid.
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

    /// The stack without changes.
    pub const fn stack(&self) -> &'a Stack {
        self.stack
    }

    /// The initial parameters of a part of a stack.
    ///
    /// # Errors
    /// Returns the names that exist if there is no such name.
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

    /// The safe distance of the robot \[m\], if one is known.
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
