//! Facts about every planner by its parameters.

use super::{GlobalPlanner, PlanError, PrepareProgress};
use crate::ConfigError;
use crate::map::SearchMap;
use std::ops::ControlFlow;

/// A planner chosen by name.
pub(super) type BoxedPlanner = Box<dyn GlobalPlanner + Send + Sync>;

/// Facts about a planner by its parameters.
pub(super) trait PlannerParameters {
    /// Refuses parameters that cannot be used.
    fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }

    /// The planner with these parameters. Most do not look at the map.
    fn build(&self, map: &SearchMap) -> Result<BoxedPlanner, PlanError>;

    /// The same for one that prepares the map, which takes long: see
    /// [`PlannerConfig::build_with_progress`].
    fn build_with_progress(
        &self,
        map: &SearchMap,
        _progress: &mut dyn FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> Result<BoxedPlanner, PlanError> {
        self.build(map)
    }

    /// The values of the planner's paper.
    fn as_published() -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Fields for which the paper gives no value.
    fn readings(&self) -> &'static [&'static str] {
        &[]
    }

    /// See [`PlannerConfig::is_optimal`].
    fn is_optimal(&self) -> bool {
        false
    }

    /// See [`PlannerConfig::needs_static_map`].
    fn needs_static_map(&self) -> bool {
        false
    }
}
