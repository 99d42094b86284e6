//! A method of a comparison, and what it does on a map.

use super::driven::{Driven, Driving};
use super::planned::{Planned, Planning};
use crate::episode::{EpisodeError, RandomObstacles, RandomUnknown};
use crate::map::{Cell, OccupancyGrid};
use crate::plan::PlannerConfig;
use crate::report::Clock;
use crate::search::Workspace;
use crate::smooth::SmootherConfig;

/// What is compared, under the name that claims know it by.
#[derive(Debug)]
pub struct Method {
    /// Its name within the experiment.
    pub name: &'static str,
    /// What it does.
    pub how: How,
    /// Whether a map counts only when this method finds a path on it, and drives it to its end.
    pub must_succeed: bool,
}

/// What a method does.
#[derive(Debug)]
pub enum How {
    /// It plans.
    Plan(Planning),
    /// It drives.
    Drive(Driving),
}

/// What a method did on one map.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A path.
    Planned(Planned),
    /// A run.
    Driven(Driven),
}

/// Half of a cell of the papers' maps \[m\].
const HALF_CELL_M: f64 = 0.5;
/// No unknown obstacle stands nearer to the start or the goal than this \[m\].
const FREE_ENDS_M: f64 = 2.0;

impl Method {
    /// A planner on the map as it is.
    pub(super) const fn new(
        name: &'static str,
        planner: PlannerConfig,
        smoother: Option<SmootherConfig>,
    ) -> Self {
        Self { name, how: How::Plan(Planning::new(planner, smoother)), must_succeed: true }
    }

    /// A stack, without unknown obstacles.
    pub(super) const fn driving(name: &'static str, stack: &'static str) -> Self {
        Self { name, how: How::Drive(Driving { stack, unknown: None }), must_succeed: true }
    }

    /// A stack among discs as wide as a cell that are not on the map: so many, and no farther from the way than this \[m\].
    pub(super) const fn among_unknown(
        name: &'static str,
        stack: &'static str,
        count: u32,
        near_way_m: f64,
    ) -> Self {
        let unknown = RandomObstacles {
            unknown: Some(RandomUnknown { count, radius_m: [HALF_CELL_M; 2] }),
            moving: None,
            near_way_m,
            free_ends_m: FREE_ENDS_M,
        };
        let how = How::Drive(Driving { stack, unknown: Some(unknown) });
        Self { name, how, must_succeed: true }
    }

    /// The same where maps count on which this one fails, too.
    #[must_use]
    pub(super) const fn may_fail(mut self) -> Self {
        self.must_succeed = false;
        self
    }

    /// Plans or drives once; `None` without a path. `seed` is that of what is random in a run.
    ///
    /// # Errors
    /// When a parameter of the method cannot be used.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        (ends, seed): ([Cell; 2], u64),
        workspace: &mut Workspace,
        clock: Clock<'_>,
    ) -> Result<Option<Outcome>, EpisodeError> {
        Ok(match &self.how {
            How::Plan(planning) => {
                planning.run(grid, ends, workspace, clock)?.map(Outcome::Planned)
            }
            How::Drive(driving) => driving.run(grid, ends, seed, clock)?.map(Outcome::Driven),
        })
    }
}

impl Outcome {
    /// Whether there is a path, and the robot drove it to its end if it was to drive.
    pub fn succeeded(&self) -> bool {
        match self {
            Self::Planned(_) => true,
            Self::Driven(driven) => driven.reached(),
        }
    }

    /// The path; `None` for a run.
    pub const fn planned(&self) -> Option<&Planned> {
        match self {
            Self::Planned(planned) => Some(planned),
            Self::Driven(_) => None,
        }
    }

    /// The run; `None` for a path.
    pub const fn driven(&self) -> Option<&Driven> {
        match self {
            Self::Planned(_) => None,
            Self::Driven(driven) => Some(driven),
        }
    }
}
