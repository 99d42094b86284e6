//! A method of a comparison, and what it does on a map.

use super::clutter_speeds::Part;
use super::driven::{Driven, Driving, Vehicle};
use super::planned::{Planned, Planning};
use keyway::local::LocalConfig;
use keyway::map::{Cell, OccupancyGrid};
use keyway::plan::PlannerConfig;
use keyway::search::Workspace;
use keyway::smooth::SmootherConfig;
use keyway_sim::episode::{EpisodeError, RandomMoving, RandomObstacles, RandomUnknown};
use keyway_sim::report::Clock;
use serde::{Deserialize, Serialize};

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A path.
    Planned(Planned),
    /// A run.
    Driven(Driven),
}

/// Half of a cell of the papers' maps \[m\].
const HALF_CELL_M: f64 = 0.5;
/// How fast unknown obstacles walk \[m/s\]: the papers do not say it.
const WALKING_MPS: [f64; 2] = [0.3, 0.5];
/// No unknown obstacle comes nearer to the start or the goal than this \[m\].
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

    /// A stack as published, without unknown obstacles.
    pub(super) const fn driving(name: &'static str, stack: &'static str) -> Self {
        let (vehicle, part) = (Vehicle::Paper, Part::Whole);
        let how = How::Drive(Driving { stack, vehicle, local: None, unknown: None, part });
        Self { name, how, must_succeed: true }
    }

    /// The same on the robot of a laboratory.
    pub(super) const fn on_small(mut self) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.vehicle = Vehicle::Small;
        }
        self
    }

    /// The same with another local planner.
    pub(super) const fn with_local(mut self, local: LocalConfig) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.local = Some(local);
        }
        self
    }

    /// The same among what the map does not show: discs as wide as a cell, so many that stand and so many that walk to and
    /// fro. None of those that stand is farther from the way than this \[m\].
    pub(super) const fn among_unknown(
        mut self,
        [standing, walking]: [u32; 2],
        near_way_m: f64,
    ) -> Self {
        let radius_m = [HALF_CELL_M; 2];
        let moving = RandomMoving { count: walking, radius_m, speed_mps: WALKING_MPS };
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

    /// The same with the mean speed of a part of the run.
    pub(super) const fn speed_of(mut self, part: Part) -> Self {
        if let How::Drive(driving) = &mut self.how {
            driving.part = part;
        }
        self
    }

    /// The same where maps count on which this one fails, too.
    #[must_use]
    pub(super) const fn may_fail(mut self) -> Self {
        self.must_succeed = false;
        self
    }

    /// Plans or drives once from the first end of the task to the second; `None` without a path. Its seed is that of what is not
    /// on the map.
    ///
    /// # Errors
    /// When a parameter of the method cannot be used.
    pub(super) fn run(
        &self,
        grid: &OccupancyGrid,
        task: ([Cell; 2], u64),
        workspace: &mut Workspace,
        clock: Clock<'_>,
    ) -> Result<Option<Outcome>, EpisodeError> {
        Ok(match &self.how {
            How::Plan(planning) => {
                planning.run(grid, task, workspace, clock)?.map(Outcome::Planned)
            }
            How::Drive(driving) => driving.run(grid, task, clock)?.map(Outcome::Driven),
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
