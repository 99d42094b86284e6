//! The trait that connects the parameters of a planner to the planner.

use super::{GlobalPlanner, PlanError, PrepareProgress};
use crate::ConfigError;
use crate::map::SearchMap;
use std::ops::ControlFlow;

/// A planner chosen by name.
pub(super) type BoxedPlanner = Box<dyn GlobalPlanner + Send + Sync>;

/// The properties of a planner that follow from its parameters.
pub(super) trait PlannerParameters {
    /// Refuses parameters out of range.
    fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }

    /// Builds the planner with these parameters. Most planners ignore the map.
    fn build(&self, map: &SearchMap) -> Result<BoxedPlanner, PlanError>;

    /// Like `build` for a planner that prepares the map, which takes long: see
    /// [`PlannerConfig::build_with_progress`].
    fn build_with_progress(
        &self,
        map: &SearchMap,
        _progress: &mut dyn FnMut(PrepareProgress) -> ControlFlow<()>,
    ) -> Result<BoxedPlanner, PlanError> {
        self.build(map)
    }

    /// The values of the planner's paper, if it gives any.
    fn as_published() -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Fields whose value is an interpretation, as the paper gives none.
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
