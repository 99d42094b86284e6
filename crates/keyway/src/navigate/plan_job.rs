//! The search for a route to a goal, as a value that another thread may run.

use super::route::Router;
use super::task::Task;
use super::world::World;
use super::{FittedStack, Goal, NavigateError};
use crate::geometry::Point;
use crate::map::OccupancyGrid;
use std::sync::Arc;

/// A search for the route to a goal, with all its inputs
/// ([`Navigator::plan_job`](super::Navigator::plan_job)). The robot drives on while it runs, in
/// another thread if available.
pub struct PlanJob {
    router: Router,
    known: Arc<OccupancyGrid>,
    parts: FittedStack,
    changes: u64,
    start: Point,
    way_points: Vec<Point>,
    goal: Goal,
}

/// The result of a [`PlanJob`], for [`Navigator::accept`](super::Navigator::accept).
pub struct Planned {
    pub(super) start: Point,
    /// Number of changes of the map when the job was created.
    pub(super) changes: u64,
    /// Clearance of the map that was added for the route, if any \[m\].
    pub(super) inserted_m: Option<f64>,
    /// True if a route had to lead between the centres of cells.
    pub(super) is_between_cells: bool,
    pub(super) task: Result<Task, NavigateError>,
}

impl PlanJob {
    pub(super) fn new(
        world: &World,
        parts: &FittedStack,
        start: Point,
        (way_points, goal): (&[Point], Goal),
    ) -> Self {
        let (router, known) = (world.known_router(), Arc::clone(&world.known));
        let way_points = way_points.to_vec();
        let (parts, changes) = (parts.clone(), world.changes);
        Self { router, known, parts, changes, start, way_points, goal }
    }

    /// Runs the search.
    pub fn run(self) -> Planned {
        let Self { mut router, known, parts, changes, start, way_points, goal } = self;
        let task = Task::plan(&mut router, &known, &parts, start, (&way_points, goal));
        let (inserted_m, is_between_cells) =
            (router.layers.inserted_m(), router.layers.is_between_cells);
        Planned { start, changes, inserted_m, is_between_cells, task }
    }
}

impl Planned {
    /// The reason why no route exists, if there is none.
    pub fn error(&self) -> Option<&NavigateError> {
        self.task.as_ref().err()
    }
}
