//! Goals, paths and questions about ways, as messages ask for them.

use super::Pilot;
use super::codes::{Code, Ended};
use super::errand::{Errand, Wanted};
use super::waits::Waits;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use crate::messages::nav2_msgs::SpeedLimit;
use keyway::geometry::{Point, Polyline, Pose};
use keyway::navigate::{Goal, Navigator};

impl Pilot {
    /// Sets out, in the place of what it was asked before.
    pub(crate) fn begin(&mut self, wanted: &Wanted, now_s: f64) -> Result<(), Ended> {
        // It may be the first thing that happens.
        let _ = self.look(now_s);
        match wanted {
            Wanted::Pose(goal) => {
                let pose = self.in_map(goal)?;
                let goal = Goal { position: pose.point(), heading_rad: Some(pose.theta) };
                self.navigate(|navigator| navigator.set_goal(goal))?;
            }
            Wanted::Path(path) => {
                let points = self.points(path)?;
                self.navigate(|navigator| navigator.follow(points))?;
            }
        }
        self.errand = Some(Errand::new(now_s));
        Ok(())
    }

    /// Gives up what it was asked to do: the robot brakes, and stands.
    pub(crate) fn stop(&mut self) {
        self.errand = None;
        if let Some(navigator) = &mut self.navigator {
            navigator.cancel();
        }
    }

    /// Since it set out \[s\]; 0 without an errand.
    pub(crate) fn under_way_s(&self, now_s: f64) -> f64 {
        self.errand.as_ref().map_or(0.0, |errand| errand.under_way_s(now_s))
    }

    /// The rest of the way \[m\], and how long it takes at the present speed \[s\].
    pub(crate) fn remaining(&self) -> (f64, f64) {
        const SLOW_MPS: f64 = 0.01;
        let guidance = self.navigator.as_ref().and_then(Navigator::guidance);
        let way_m = guidance.map_or(0.0, |guidance| guidance.remaining_m);
        let speed_mps = self.speed_mps().abs();
        (way_m, if speed_mps > SLOW_MPS { way_m / speed_mps } else { 0.0 })
    }

    /// Speed by the odometry \[m/s\]; 0 before there is some.
    pub(crate) fn speed_mps(&self) -> f64 {
        self.sensing.velocity().map_or(0.0, |velocity| velocity.v)
    }

    /// Takes in a limit of the speed. One that means nothing changes nothing.
    pub(crate) fn limit_speed(&mut self, limit: &SpeedLimit) {
        let Some(navigator) = &mut self.navigator else { return };
        let most_mps = navigator.stack().robot().limits.v_max_mps;
        let share = if limit.percentage { 0.01 * most_mps } else { 1.0 };
        // 0 means that there is none.
        let speed_mps = (limit.most != 0.0).then_some(share * limit.most);
        drop(navigator.set_speed_limit(speed_mps));
    }

    /// A way between two poses, or from where the robot is, on what is known and sensed.
    pub(crate) fn path(
        &mut self,
        start: Option<&PoseStamped>,
        goal: &PoseStamped,
        now_s: f64,
    ) -> Result<(Vec<Point>, f64), Ended> {
        let _ = self.look(now_s);
        let start = match start {
            Some(start) => self.in_map(start)?,
            None => self.pose.ok_or_else(|| {
                let why = "nobody has said where the robot is";
                Ended::failed(Code::PlannerTransform, why)
            })?,
        };
        let goal = self.in_map(goal)?;
        let route = self.navigate(|navigator| navigator.plan(start.point(), goal.point()))?;
        Ok((route.smoothed.points().to_vec(), goal.theta))
    }

    /// A pose in the frame of the map. One without a frame is there already.
    fn in_map(&self, stamped: &PoseStamped) -> Result<Pose, Ended> {
        let frame = &self.settings.frames.map;
        let pose = stamped.pose.on_ground().ok_or_else(|| {
            let why = "the pose is not finite, or its orientation is no rotation";
            Ended::failed(Code::PlannerTransform, why)
        })?;
        let own = &stamped.header.frame_id;
        if own.is_empty() || own == frame {
            return Ok(pose);
        }
        // As RViz does: a goal in another frame is meant where that frame is now.
        let at_s = self.transforms.latest_s(frame, own);
        let placement = at_s.and_then(|at_s| self.transforms.at(frame, own, at_s));
        let placement =
            placement.map_err(|error| Ended::failed(Code::PlannerTransform, error.to_string()))?;
        Ok(placement.pose.compose(pose))
    }

    /// The points of a path in the frame of the map. Poses without a frame are in that of the path.
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
        ask: impl FnOnce(&mut Navigator) -> Result<T, keyway::navigate::NavigateError>,
    ) -> Result<T, Ended> {
        let navigator = self
            .navigator
            .as_mut()
            .ok_or_else(|| Ended::failed(Code::PlannerUnknown, Waits::Map.to_string()))?;
        ask(navigator).map_err(|error| Ended::failed(Code::of(&error), error.to_string()))
    }
}
