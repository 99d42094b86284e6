//! Methods of a comparison, and their outcomes on a map.

use super::clutter_speeds::Part;
use super::driven::{Driving, RunFigures, Vehicle};
use super::planned::{Planned, Planning};
use keyway::local::LocalConfig;
use keyway::map::{Cell, OccupancyGrid};
use keyway::plan::PlannerConfig;
use keyway::search::Workspace;
use keyway::smooth::SmootherConfig;
use keyway_sim::episode::{EpisodeError, RandomMoving, RandomObstacles, RandomUnknown};
use keyway_sim::report::Clock;
use serde::{Deserialize, Serialize};

/// A compared method, under the name that claims use.
#[derive(Debug)]
pub struct Method {
    /// Name within the experiment.
    pub name: &'static str,
    /// Setup of the method.
    pub how: How,
    /// True if a map counts only when this method finds a path on it, and drives it to its end.
    pub must_succeed: bool,
}

/// Kind and setup of a method.
#[derive(Debug)]
pub enum How {
    /// A planning method.
    Plan(Planning),
    /// A driving method.
    Drive(Driving),
}

/// Result of a method on one map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodResult {
    /// A path.
    Planned(Planned),
    /// A run.
    Driven(RunFigures),
}

/// Half of a cell of the papers' maps \[m\].
const HALF_CELL_M: f64 = 0.5;
/// Speeds of walking unknown obstacles \[m/s\]: the papers do not state them.
const WALKING_MPS: [f64; 2] = [0.3, 0.5];
/// Minimum distance of unknown obstacles from the start and the goal \[m\].
const FREE_ENDS_M: f64 = 2.0;

impl Method {
    /// Creates a planning method on the map as it is.
    pub(super) const fn new(
        name: &'static str,
        planner: PlannerConfig,
        smoother: Option<SmootherConfig>,
    ) -> Self {
        Self { name, how: How::Plan(Planning::new(planner, smoother)), must_succeed: true }
    }

    /// Creates a driving method with a stack as published, without unknown obstacles.
    pub(super) const fn driving(name: &'static str, stack: &'static str) -> Self {
        let (vehicle, part) = (Vehicle::Paper, Part::Whole);
        let (planner, local, unknown, is_watching) = (None, None, None, true);
        let how = Driving { stack, vehicle, planner, local, unknown, is_watching, part };
        let how = How::Drive(how);
        Self { name, how, must_succeed: true }
    }

    /// Drives another robot.
    pub(super) const fn on(mut self, vehicle: Vehicle) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.vehicle = vehicle;
        }
        self
    }

    /// Uses another planner.
    pub(super) const fn with_planner(mut self, planner: PlannerConfig) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.planner = Some(planner);
        }
        self
    }

    /// Follows its first route to the end and ignores what it senses.
    pub(super) const fn unwatched(mut self) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.is_watching = false;
        }
        self
    }

    /// Uses another local planner.
    pub(super) const fn with_local(mut self, local: LocalConfig) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.local = Some(local);
        }
        self
    }

    /// Adds unknown obstacles: discs as wide as a cell, the given numbers of static ones and of
    /// ones that walk back and forth. The static ones are at most `near_way_m` from the path
    /// \[m\].
    pub(super) const fn among_unknown(
        mut self,
        [standing, walking]: [u32; 2],
        near_way_m: f64,
    ) -> Self {
        let radius_m = [HALF_CELL_M; 2];
        let moving =
            RandomMoving { count: walking, radius_m, speed_mps: WALKING_MPS, gives_way: false };
        let unknown = RandomObstacles {
            unknown: Some(RandomUnknown { count: standing, radius_m }),
            moving: if walking > 0 { Some(moving) } else { None },
            near_way_m,
            free_ends_m: FREE_ENDS_M,
        };
        match &mut self.how {
            How::Plan(planning) => planning.unknown = Some(unknown),
            How::Drive(driving) => driving.unknown = Some(unknown),
        }
        self
    }

    /// Gives the static unknown obstacles another radius \[m\].
    pub(super) const fn with_radius(mut self, radius_m: f64) -> Self {
        let unknown = match &mut self.how {
            How::Plan(planning) => &mut planning.unknown,
            How::Drive(driving) => &mut driving.unknown,
        };
        if let Some(RandomObstacles { unknown: Some(unknown), .. }) = unknown {
            unknown.radius_m = [radius_m; 2];
        }
        self
    }

    /// Takes the mean speed over a part of the run.
    pub(super) const fn speed_of(mut self, part: Part) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.part = part;
        }
        self
    }

    /// Lets maps count even if this method fails on them.
    #[must_use]
    pub(super) const fn may_fail(mut self) -> Self {
        self.must_succeed = false;
        self
    }

    /// Plans or drives once from the task's start to its goal; `None` without a path. The task's
    /// seed determines the unknown obstacles.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if a parameter of the method is invalid.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        task: ([Cell; 2], u64),
        workspace: &mut Workspace,
        clock: Clock<'_>,
    ) -> Result<Option<MethodResult>, EpisodeError> {
        Ok(match &self.how {
            How::Plan(planning) => {
                planning.run(grid, task, workspace, clock)?.map(MethodResult::Planned)
            }
            How::Drive(driving) => driving.run(grid, task, clock)?.map(MethodResult::Driven),
        })
    }
}

impl MethodResult {
    /// True if there is a path, and a driving robot drove it to its end.
    pub fn succeeded(&self) -> bool {
        match self {
            Self::Planned(_) => true,
            Self::Driven(driven) => driven.reached(),
        }
    }

    /// Returns the path; `None` for a run.
    pub const fn planned(&self) -> Option<&Planned> {
        match self {
            Self::Planned(planned) => Some(planned),
            Self::Driven(_) => None,
        }
    }

    /// Returns the run; `None` for a path.
    pub const fn driven(&self) -> Option<&RunFigures> {
        match self {
            Self::Planned(_) => None,
            Self::Driven(driven) => Some(driven),
        }
    }
}
