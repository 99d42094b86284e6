//! Goals, paths and single acts, and path queries.

use super::{Errand, Navigator};
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline};
use crate::navigate::act::Act;
use crate::navigate::plan_job::{PlanJob, Planned};
use crate::navigate::recovery::Motion;
use crate::navigate::task::Task;
use crate::navigate::{FittedStack, Goal, Misfit, NavigateError};
use crate::route::{Route, smooth_line};

impl Navigator {
    /// Sets a new goal in place of the last one.
    ///
    /// # Errors
    /// As for [`Self::set_goals`].
    pub fn set_goal(&mut self, goal: impl Into<Goal>) -> Result<(), NavigateError> {
        self.set_goals(&[], goal)
    }

    /// Sets a new goal with way-points, in their order. Each is passed within the goal tolerance.
    ///
    /// The goal must be reachable on the known map. If only sensed obstacles block the route, the
    /// robot sets out and handles them as on every route that turns out to be obstructed.
    ///
    /// # Errors
    /// Returns [`NavigateError`] if the pose of the robot is unknown, if the robot does not fit
    /// there, at the goal or with the goal heading, if it touches an obstacle, or if no route
    /// exists; [`NavigateError::WayPoint`] for a way-point that cannot be reached. The robot then
    /// continues as before. A start that is too close to an obstacle by at most [`start_error_m`]
    /// is no error ([`Self::too_near`]).
    ///
    /// [`start_error_m`]: crate::navigate::ControllerConfig::start_error_m
    pub fn set_goals(
        &mut self,
        way_points: &[Point],
        goal: impl Into<Goal>,
    ) -> Result<(), NavigateError> {
        let start = self.place.ok_or(NavigateError::PlaceUnknown)?.point();
        let (parts, wanted) = (&self.parts, (way_points, goal.into()));
        let plan = |router: &mut _, known: &_| Task::plan(router, known, parts, start, wanted);
        let task = self.world.on_known(plan);
        let layers = &self.world.router.layers;
        let (inserted_m, is_between_cells) = (layers.inserted_m(), layers.is_between_cells);
        let changes = self.world.changes;
        self.accept(Planned { start, changes, inserted_m, is_between_cells, task })
    }

    /// The search of [`Self::set_goals`] as a value: the robot drives on while it runs. Its
    /// result is passed to [`Self::accept`].
    ///
    /// Costs a copy of the layers of the map.
    ///
    /// # Errors
    /// Returns [`NavigateError::PlaceUnknown`] if the pose of the robot is unknown.
    pub fn plan_job(
        &self,
        way_points: &[Point],
        goal: impl Into<Goal>,
    ) -> Result<PlanJob, NavigateError> {
        let start = self.place.ok_or(NavigateError::PlaceUnknown)?.point();
        Ok(PlanJob::new(&self.world, &self.parts, start, (way_points, goal.into())))
    }

    /// Accepts the result of a search: its goal replaces the last one. If the robot has moved
    /// meanwhile, the route is replanned from its present pose; if the map was changed, the
    /// search is repeated on the new map.
    ///
    /// # Errors
    /// The error of the search, as for [`Self::set_goals`]. The robot then continues as before.
    pub fn accept(&mut self, planned: Planned) -> Result<(), NavigateError> {
        let Planned { start, changes, inserted_m, is_between_cells, task } = planned;
        let place = self.place.ok_or(NavigateError::PlaceUnknown)?;
        let mut task = task?;
        if changes != self.world.changes {
            // The route belongs to another map.
            let way_points = &task.asked[..task.asked.len() - 1];
            return self.set_goals(way_points, task.goal);
        }
        self.world.add_layer(inserted_m);
        self.world.router.layers.is_between_cells |= is_between_cells;
        if let Some(earlier) = self.task() {
            task.go_on_from(earlier);
        }
        self.ask_for(Some(Errand::Drive(Box::new(task))));
        self.record.counts.routes_planned += 1;
        self.record.counts.ways_taken += 1;
        let has_moved = place.point() != start;
        if has_moved || self.world.sensed.count() > 0 {
            self.plan_again();
        }
        Ok(())
    }

    /// Follows an external path, which starts near the robot, to its end, as closely as a planned
    /// route. If it is obstructed, a planned route to its end replaces it.
    ///
    /// # Errors
    /// Returns [`NavigateError`] if the pose of the robot is unknown, for a path with fewer than
    /// two points or with one that is not finite, and if the robot does not fit along it on the
    /// map ([`NavigateError::Misfit`]). The robot then continues as before.
    pub fn follow(&mut self, path: Polyline) -> Result<(), NavigateError> {
        let start = self.place.ok_or(NavigateError::PlaceUnknown)?.point();
        let parts = &self.parts;
        let task = self.world.on_known(|router, _| Task::along(router, parts, start, path))?;
        self.ask_for(Some(Errand::Drive(Box::new(task))));
        self.record.counts.ways_taken += 1;
        Ok(())
    }

    /// Cancels the present errand: the robot brakes, and stays stationary.
    pub fn cancel(&mut self) {
        self.ask_for(None);
    }

    /// Rotates on the spot by an angle \[rad\], positive to the left, within a time \[s\]. The
    /// robot brakes first, and has arrived when it is stationary again. It touches nothing: if
    /// there is no space, it waits until its time is over.
    ///
    /// # Errors
    /// Returns [`ConfigError`] for an angle that is not finite, for a robot that cannot turn in
    /// place, and for a time that is not positive. The robot then continues as before.
    pub fn spin(&mut self, angle_rad: f64, allowance_s: f64) -> Result<(), ConfigError> {
        if !angle_rad.is_finite() {
            return Err(ConfigError::must_be("angle_rad", "a finite angle", angle_rad));
        }
        if !self.parts.robot.limits.turns_in_place() {
            let reason =
                "cannot be turned: the robot does not turn in place (`min_turning_radius_m`)";
            return Err(ConfigError::new("angle_rad", reason));
        }
        self.begin(Motion::Turn(angle_rad), allowance_s)
    }

    /// Drives straight back by a distance \[m\] within a time \[s\], under the rules of
    /// [`Self::spin`].
    ///
    /// # Errors
    /// Returns [`ConfigError`] for a distance that is negative or not finite, for a robot that
    /// cannot drive backwards, and for a time that is not positive. The robot then continues as
    /// before.
    pub fn back_up(&mut self, distance_m: f64, allowance_s: f64) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("distance_m", distance_m)?;
        if self.parts.robot.limits.v_min_mps >= 0.0 {
            let reason = "cannot be driven: the robot does not drive backwards (`v_min_mps`)";
            return Err(ConfigError::new("distance_m", reason));
        }
        self.begin(Motion::Drive(-distance_m), allowance_s)
    }

    /// Drives straight ahead by a distance \[m\] within a time \[s\], under the rules of
    /// [`Self::spin`].
    ///
    /// # Errors
    /// Returns [`ConfigError`] for a distance that is negative or not finite, and for a time that
    /// is not positive. The robot then continues as before.
    pub fn drive_on_heading(
        &mut self,
        distance_m: f64,
        allowance_s: f64,
    ) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("distance_m", distance_m)?;
        self.begin(Motion::Drive(distance_m), allowance_s)
    }

    fn begin(&mut self, motion: Motion, allowance_s: f64) -> Result<(), ConfigError> {
        ConfigError::unless_positive("allowance_s", allowance_s)?;
        self.ask_for(Some(Errand::Act(Act::new(motion, allowance_s))));
        Ok(())
    }

    fn ask_for(&mut self, errand: Option<Errand>) {
        (self.errand, self.stepped) = (errand, None);
        self.forget_last();
    }

    /// Plans a route between two positions with the known and the sensed obstacles. Does not
    /// change the errand.
    ///
    /// # Errors
    /// Returns [`NavigateError`] if no route exists, or if the robot touches an obstacle at the
    /// start by more than [`start_error_m`](crate::navigate::ControllerConfig::start_error_m).
    pub fn plan(&mut self, start: Point, goal: Point) -> Result<Route, NavigateError> {
        let FittedStack { robot, stack, .. } = &self.parts;
        let router = &mut self.world.router;
        router.check_start(start, &robot.footprint, stack.controller.start_error_m)?;
        router.again(start, goal, u64::MAX)
    }

    /// The position nearest to a goal that can be reached from a start, with the known and the
    /// sensed obstacles: the goal itself if a route to it exists; `None` if nothing can be
    /// reached.
    pub fn nearest_reachable(&mut self, start: Point, goal: Point) -> Option<Point> {
        let router = &mut self.world.router;
        if router.again(start, goal, u64::MAX).is_ok() {
            return Some(goal);
        }
        router.nearest_reachable(start, goal)
    }

    /// Smooths a line of positions as routes are smoothed: where it keeps the clearance among the
    /// known and the sensed obstacles, it still does so afterwards.
    pub fn smooth(&self, line: &PlannedLine) -> Polyline {
        let map = self.world.router.layers.obstacles();
        let (smoother, clearance_m) = (&*self.parts.smoother, map.config().clearance_m);
        let smoothed = smooth_line(map, smoother, line, clearance_m, &mut ());
        smoothed.path.flattened(crate::route::CHORD_CELLS * map.frame().resolution_m())
    }

    /// The first misfit of the robot along a path among the known and the sensed obstacles, with
    /// rotations on the spot at its corners; `None` for a path that it can drive.
    pub fn misfit_along(&self, path: &Polyline) -> Option<Misfit> {
        Misfit::first_along(path, &self.parts.robot.footprint, &self.world.obstacles)
    }

    /// True if the robot fits along all of a path ([`Self::misfit_along`]).
    pub fn is_path_valid(&self, path: &Polyline) -> bool {
        self.misfit_along(path).is_none()
    }
}
