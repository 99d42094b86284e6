//! Goals, paths and single acts, and questions about ways.

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
    /// Drives to a goal from now on, in the place of the last one.
    ///
    /// # Errors
    /// As for [`Self::set_goals`].
    pub fn set_goal(&mut self, goal: impl Into<Goal>) -> Result<(), NavigateError> {
        self.set_goals(&[], goal)
    }

    /// The same by way of some points, in their order. Each is passed within the goal tolerance.
    ///
    /// A goal must be within reach on the known map. Where only what was sensed is in
    /// the way, the robot sets out, and tries to find a way as it does for every route that turns
    /// out to be obstructed.
    ///
    /// # Errors
    /// When nobody has said where the robot is, it does not fit there or at the goal, or not with
    /// the goal's heading, or touches something, or when there is no route;
    /// [`NavigateError::WayPoint`] for a way-point that cannot be reached. Then it goes on as
    /// before. A place that is too near to something by no more than [`start_error_m`] is none
    /// ([`Self::too_near`]).
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

    /// The search of [`Self::set_goals`] as a value: the robot drives on while it runs. Its result
    /// is for [`Self::accept`].
    ///
    /// Costs a copy of the layers of the map.
    ///
    /// # Errors
    /// When nobody has said where the robot is.
    pub fn plan_job(
        &self,
        way_points: &[Point],
        goal: impl Into<Goal>,
    ) -> Result<PlanJob, NavigateError> {
        let start = self.place.ok_or(NavigateError::PlaceUnknown)?.point();
        Ok(PlanJob::new(&self.world, &self.parts, start, (way_points, goal.into())))
    }

    /// Drives to the goal for which a route was searched, in the place of the last goal. Where the
    /// robot has driven on meanwhile, it plans again from where it is; where the map was changed,
    /// it searches again on that.
    ///
    /// # Errors
    /// The error that the search has found, as for [`Self::set_goals`]. Then it goes on as before.
    pub fn accept(&mut self, planned: Planned) -> Result<(), NavigateError> {
        let Planned { start, changes, inserted_m, is_between_cells, task } = planned;
        let place = self.place.ok_or(NavigateError::PlaceUnknown)?;
        let task = task?;
        if changes != self.world.changes {
            // The route is one of another map.
            let way_points = &task.asked[..task.asked.len() - 1];
            return self.set_goals(way_points, task.goal);
        }
        self.world.add_layer(inserted_m);
        self.world.router.layers.is_between_cells |= is_between_cells;
        self.ask_for(Some(Errand::Drive(Box::new(task))));
        self.record.counts.routes_planned += 1;
        self.record.counts.ways_taken += 1;
        let has_moved = place.point() != start;
        if has_moved || self.world.sensed.count() > 0 {
            self.plan_again();
        }
        Ok(())
    }

    /// Drives along a path from elsewhere, which begins near the robot, to its end, as closely as
    /// along a route of its own. Where something is in the way, such a route to the end takes its
    /// place.
    ///
    /// # Errors
    /// When nobody has said where the robot is; for a path without two points or with one that is
    /// not finite; and where the map shows that the robot does not fit along it
    /// ([`NavigateError::Misfit`]). Then it goes on as before.
    pub fn follow(&mut self, path: Polyline) -> Result<(), NavigateError> {
        let start = self.place.ok_or(NavigateError::PlaceUnknown)?.point();
        let parts = &self.parts;
        let task = self.world.on_known(|router, _| Task::along(router, parts, start, path))?;
        self.ask_for(Some(Errand::Drive(Box::new(task))));
        self.record.counts.ways_taken += 1;
        Ok(())
    }

    /// Gives up what it was asked to do: the robot brakes, and stands.
    pub fn cancel(&mut self) {
        self.ask_for(None);
    }

    /// Turns on the spot by an angle \[rad\], positive to the left, within a time \[s\]. The robot
    /// brakes first, and has arrived when it stands again. Nothing is touched: where there is no
    /// room it waits, until its time is over.
    ///
    /// # Errors
    /// For an angle that is not finite, and a time that is not positive. Then it goes on as before.
    pub fn spin(&mut self, angle_rad: f64, allowance_s: f64) -> Result<(), ConfigError> {
        if !angle_rad.is_finite() {
            return Err(ConfigError::must_be("angle_rad", "a finite angle", angle_rad));
        }
        self.begin(Motion::Turn(angle_rad), allowance_s)
    }

    /// Drives straight back by a distance \[m\], in the same way.
    ///
    /// # Errors
    /// For a distance that is negative or not finite, a robot that cannot drive backwards, and a
    /// time that is not positive. Then it goes on as before.
    pub fn back_up(&mut self, distance_m: f64, allowance_s: f64) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("distance_m", distance_m)?;
        if self.parts.robot.limits.v_min_mps >= 0.0 {
            let reason = "cannot be driven: the robot does not drive backwards (`v_min_mps`)";
            return Err(ConfigError::new("distance_m", reason));
        }
        self.begin(Motion::Drive(-distance_m), allowance_s)
    }

    /// Drives straight ahead by a distance \[m\], in the same way.
    ///
    /// # Errors
    /// For a distance that is negative or not finite, and a time that is not positive. Then it goes
    /// on as before.
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

    /// A route between two positions on what is known and sensed. Nothing changes by it.
    ///
    /// # Errors
    /// When there is none, or the robot touches something at the start, by more than
    /// [`start_error_m`](crate::navigate::ControllerConfig::start_error_m).
    pub fn plan(&mut self, start: Point, goal: Point) -> Result<Route, NavigateError> {
        let FittedStack { robot, stack, .. } = &self.parts;
        let router = &mut self.world.router;
        router.check_start(start, &robot.footprint, stack.controller.start_error_m)?;
        router.again(start, goal, u64::MAX)
    }

    /// The place nearest to a goal that can be reached from a start, on what is known and sensed:
    /// the goal itself, where there is a route to it; `None` where nothing can be reached.
    pub fn nearest_reachable(&mut self, start: Point, goal: Point) -> Option<Point> {
        let router = &mut self.world.router;
        if router.again(start, goal, u64::MAX).is_ok() {
            return Some(goal);
        }
        router.nearest_reachable(start, goal)
    }

    /// A line of positions, smoothed as its routes are: where it is clear it stays so, by the same
    /// clearance, among what is known and sensed.
    pub fn smooth(&self, line: &PlannedLine) -> Polyline {
        let map = self.world.router.layers.obstacles();
        let (smoother, clearance_m) = (&*self.parts.smoother, map.config().clearance_m);
        let smoothed = smooth_line(map, smoother, line, clearance_m, &mut ());
        smoothed.path.flattened(crate::route::CHORD_CELLS * map.frame().resolution_m())
    }

    /// The first place of a path at which the robot does not fit among what is known and sensed,
    /// turning on the spot at its corners; `None` for one that it can drive.
    pub fn misfit_along(&self, path: &Polyline) -> Option<Misfit> {
        Misfit::first_along(path, &self.parts.robot.footprint, &self.world.obstacles)
    }

    /// True if the robot fits along all of a path ([`Self::misfit_along`]).
    pub fn is_path_valid(&self, path: &Polyline) -> bool {
        self.misfit_along(path).is_none()
    }
}
