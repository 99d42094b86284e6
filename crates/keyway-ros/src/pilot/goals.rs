//! Goals, paths and path queries, as requested by messages.

use super::Pilot;
use super::codes::{Ended, Fault};
use super::errand::{Act, Errand, Motion, Wanted};
use super::waits::Waits;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use crate::messages::nav2_msgs::SpeedLimit;
use keyway::geometry::{PlannedLine, Point, Polyline, Pose};
use keyway::navigate::{Goal, NavigateError, Navigator};

impl Pilot {
    /// Starts a task, in place of the previous one.
    pub(crate) fn begin(&mut self, wanted: Wanted, now_s: f64) -> Result<(), Ended> {
        if !self.is_active {
            return Err(Ended::failed(Fault::Unknown, super::INACTIVE));
        }
        // The request may come before the first cycle.
        let looked = self.look(now_s).err();
        let is_lost = self.navigator.as_ref().is_some_and(|navigator| navigator.now_s().is_none());
        if let Some(why) = looked.filter(|_| is_lost) {
            return Err(Ended::failed(Fault::Transform, why.to_string()));
        }
        self.limit_act(None);
        let mut errand = Errand::new(now_s, self.recoveries());
        match wanted {
            Wanted::Poses(poses) => {
                self.set_goals(&poses)?;
                errand.poses = poses.len();
            }
            Wanted::Stops { poses, first, again } => {
                errand.stop_at(&poses, first, again);
                if !self.begin_stop(&mut errand, now_s) {
                    let missed = errand.made.missed.into_iter().next();
                    return Err(missed.map_or_else(no_goals, |missed| missed.ended));
                }
            }
            Wanted::Path(path) => {
                let points = self.points(&path)?;
                self.navigate(|navigator| navigator.follow(points))?;
            }
            Wanted::Act(act) => {
                self.act(act)?;
                errand.deadline_s = Some(now_s + act.allowed_s() + Self::GRACE_S);
                errand.most_mps = act.most_mps;
            }
            Wanted::Wait(time_s) => {
                self.navigate(|navigator| {
                    navigator.cancel();
                    Ok(())
                })?;
                errand.until_s = Some(now_s + time_s);
            }
        }
        self.errand = Some(errand);
        Ok(())
    }

    /// Time after its allowance at which a single motion is aborted \[s\].
    const GRACE_S: f64 = 1.0;

    fn set_goals(&mut self, poses: &[PoseStamped]) -> Result<(), Ended> {
        let in_map = |pose| self.in_map(pose);
        let mut poses: Vec<Pose> = poses.iter().map(in_map).collect::<Result<_, Ended>>()?;
        let last = poses.pop().ok_or_else(no_goals)?;
        let way_points: Vec<Point> = poses.iter().map(Pose::point).collect();
        let goal = Goal { position: last.point(), heading_rad: Some(last.theta) };
        self.navigate(|navigator| navigator.set_goals(&way_points, goal))
    }

    /// Starts driving to the first remaining stop that is reachable; false if there is none. The
    /// stops before it are missed.
    fn begin_stop(&mut self, errand: &mut Errand, now_s: f64) -> bool {
        // If no stop of a whole round is reachable, another round is pointless.
        for _ in 0..errand.poses {
            let Some(pose) = errand.next_stop() else { return false };
            let Err(ended) = self.set_goals(std::slice::from_ref(&pose)) else {
                errand.present_stop = Some(pose);
                return true;
            };
            errand.miss(pose, ended);
            errand.leave_stop(now_s);
        }
        false
    }

    /// Advances to the next stop, if the task has one; otherwise returns the outcome.
    pub(super) fn next_stop(&mut self, ended: Ended, now_s: f64) -> Option<Ended> {
        let Some(mut errand) = self.errand.take_if(|errand| errand.present_stop.is_some()) else {
            return Some(ended);
        };
        if let Some(pose) = errand.present_stop.take()
            && ended != Ended::Succeeded
        {
            errand.miss(pose, ended);
        }
        errand.leave_stop(now_s);
        let goes_on = self.begin_stop(&mut errand, now_s);
        self.errand = Some(errand);
        (!goes_on).then_some(Ended::Succeeded)
    }

    /// Starts a single motion.
    fn act(&mut self, act: Act) -> Result<(), Ended> {
        let Act { motion, most_mps, fault, .. } = act;
        let allowance_s = act.allowed_s();
        if let Some(why) = fault {
            return Err(Ended::failed(Fault::InvalidInput, why));
        }
        let begun = self.navigate(|navigator| {
            Ok(match motion {
                Motion::Turn(angle_rad) => navigator.spin(angle_rad, allowance_s),
                Motion::Ahead(way_m) => navigator.drive_on_heading(way_m, allowance_s),
                Motion::Back(way_m) => navigator.back_up(way_m, allowance_s),
            })
        })?;
        begun.map_err(|error| Ended::failed(Fault::InvalidInput, error.to_string()))?;
        self.limit_act(most_mps);
        Ok(())
    }

    /// Cancels the task: the robot brakes to a stop.
    pub(crate) fn stop(&mut self) {
        self.errand = None;
        self.limit_act(None);
        if let Some(navigator) = &mut self.navigator {
            navigator.cancel();
        }
    }

    /// Sets the speed limit. An invalid one is ignored.
    pub(crate) fn limit_speed(&mut self, limit: &SpeedLimit) {
        let most_mps = self.settings.stack.robot().limits.v_max_mps;
        let share = if limit.percentage { 0.01 * most_mps } else { 1.0 };
        let speed_mps = share * limit.most;
        if speed_mps >= 0.0 && speed_mps.is_finite() {
            // 0 removes the limit.
            self.limit_mps = (speed_mps > 0.0).then_some(speed_mps);
            self.limit_act(self.errand.as_ref().and_then(|errand| errand.most_mps));
        }
    }

    /// Applies the speed limit, and that of a single motion \[m/s\].
    fn limit_act(&mut self, most_mps: Option<f64>) {
        let most_mps = most_mps.filter(|speed_mps| *speed_mps > 0.0);
        let limits = [self.limit_mps, most_mps].into_iter().flatten();
        let limit_mps = limits.min_by(f64::total_cmp);
        if let Some(navigator) = &mut self.navigator {
            // A positive number is always valid.
            drop(navigator.set_speed_limit(limit_mps));
        }
    }

    /// Plans a path via some poses, from a start or from the robot, on the map and the sensed
    /// obstacles.
    pub(crate) fn path(
        &mut self,
        start: Option<&PoseStamped>,
        goals: &[PoseStamped],
        now_s: f64,
    ) -> Result<(Vec<Point>, f64), Ended> {
        if let Err(why @ Waits::Map) = self.look(now_s) {
            return Err(Ended::failed(Fault::Unknown, why.to_string()));
        }
        let start = match start {
            Some(start) => self.in_map(start)?,
            None => self.pose.ok_or_else(|| {
                Ended::failed(Fault::Transform, "the pose of the robot is unknown")
            })?,
        };
        let in_map = |goal| self.in_map(goal);
        let goals: Vec<Pose> = goals.iter().map(in_map).collect::<Result<_, Ended>>()?;
        let heading_rad = goals.last().ok_or_else(no_goals)?.theta;
        let mut points = Vec::new();
        let mut from = start.point();
        for goal in goals {
            let route = self.navigate(|navigator| navigator.plan(from, goal.point()))?;
            // Each leg starts at the end of the one before.
            let known = usize::from(!points.is_empty());
            points.extend(route.smoothed.points().iter().skip(known));
            from = goal.point();
        }
        Ok((points, heading_rad))
    }

    /// Smooths a path, and checks if the robot fits along it.
    pub(crate) fn smoothed(&mut self, path: &Path) -> Result<(Vec<Point>, bool), Ended> {
        let points = self.points(path)?;
        if points.points().len() < 2 {
            let why = "a path to smooth needs at least two poses";
            return Err(Ended::failed(Fault::InvalidPath, why));
        }
        self.navigate(|navigator| {
            let smoothed = navigator.smooth(&PlannedLine::from(points));
            let fits = navigator.is_path_valid(&smoothed);
            Ok((smoothed.points().to_vec(), fits))
        })
    }

    /// Converts a pose to the map frame. A pose without a frame is already in it.
    fn in_map(&self, stamped: &PoseStamped) -> Result<Pose, Ended> {
        let frame = &self.settings.frames.map;
        let pose = stamped.pose.on_ground().ok_or_else(|| {
            let why = "the pose is not finite, or its orientation is not a rotation";
            Ended::failed(Fault::Transform, why)
        })?;
        let own = &stamped.header.frame_id;
        if own.is_empty() || own == frame {
            return Ok(pose);
        }
        // As in RViz, a goal in another frame refers to the current position of that frame.
        let at_s = self.transforms.latest_s(frame, own);
        let placement = at_s.and_then(|at_s| self.transforms.at(frame, own, at_s));
        let placement =
            placement.map_err(|error| Ended::failed(Fault::Transform, error.to_string()))?;
        Ok(placement.on_ground().compose(pose))
    }

    /// Points of a path in the map frame. Poses without a frame are in that of the path.
    fn points(&self, path: &Path) -> Result<Polyline, Ended> {
        let point = |pose: &PoseStamped| {
            let mut pose = pose.clone();
            if pose.header.frame_id.is_empty() {
                pose.header.frame_id.clone_from(&path.header.frame_id);
            }
            Ok(self.in_map(&pose)?.point())
        };
        let points: Vec<Point> = path.poses.iter().map(point).collect::<Result<_, Ended>>()?;
        Ok(Polyline::new(points))
    }

    fn navigate<T>(
        &mut self,
        ask: impl FnOnce(&mut Navigator) -> Result<T, NavigateError>,
    ) -> Result<T, Ended> {
        let no_map = || Ended::failed(Fault::Unknown, Waits::Map.to_string());
        let navigator = self.navigator.as_mut().ok_or_else(no_map)?;
        ask(navigator).map_err(|error| Ended::refused(&error))
    }
}

fn no_goals() -> Ended {
    Ended::failed(Fault::NoGoals, "the list of goals is empty")
}
