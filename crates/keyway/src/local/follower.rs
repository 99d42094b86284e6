//! Pure pursuit \[Coulter1992\]: computes the velocity that follows a route. It ignores
//! obstacles.
//!
//! The robot drives on the arc that leads to the point of the route at the look-ahead distance,
//! as fast as its limits and the rest of the route allow. It is meant for routes that are known
//! to be free, and as a baseline for other local planners.
//!
//! # Source
//! \[Coulter1992\], section 2.
//!
//! | paper | here | unit |
//! |---|---|---|
//! | l | distance from the robot to the carrot | m |
//! | x | the carrot's position to the left of the robot | m |
//! | gamma = 2 x / l² | curvature of the arc | 1/m |
//! | look-ahead distance | [`FollowerConfig::look_ahead_m`] | m |
//!
//! # Where this differs from the paper
//! - The robot turns on the spot while the carrot is more than a right angle off its heading.
//! - The speed is not constant: it is the largest one for which the arc keeps the limit of the
//!   turn rate and from which the robot can stop at the end of the route.
//!
//! # Errors / cost
//! [`ConfigError`]; a decision never fails. Linear in the segments that the robot passes in a
//! cycle.

use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::{
    Decision, DriveMemory, Evaluation, Explanation, LocalPlanner, NoCommand, Scene, Scratch,
};
use crate::ConfigError;
use crate::geometry::{Point, Polyline, Velocity};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Parameters of [`Follower`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FollowerConfig {
    /// Look-ahead distance of the carrot along the route \[m\].
    pub look_ahead_m: f64,
}

impl FollowerConfig {
    /// On cells of 1 m, for the paths of \[ZhuYin2024\]: one cell. The paper does not say how its
    /// robot follows a path.
    pub const PAPER: Self = Self { look_ahead_m: 1.0 };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] = &["look_ahead_m"];

    /// The look-ahead distance is the distance driven in three cycles plus the stopping distance
    /// at full speed, but at least the inscribed radius.
    pub fn for_robot(robot: &Robot) -> Self {
        let limits = &robot.limits;
        let cycles_m = 3.0 * limits.v_max_mps * robot.cycle_s;
        Self {
            look_ahead_m: (cycles_m + limits.stop_m()).max(robot.footprint.inscribed_radius_m()),
        }
    }
}

/// Drives along the route and avoids nothing.
#[derive(Clone, Debug)]
pub struct Follower {
    config: FollowerConfig,
    robot: Arc<Robot>,
}

impl Follower {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "follower";

    /// Creates a follower for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid; the error
    /// names the field.
    pub fn new(config: FollowerConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let robot = robot.into();
        robot.validate().map_err(|error| error.within("robot"))?;
        ConfigError::unless_positive("look_ahead_m", config.look_ahead_m)?;
        Ok(Self { config, robot })
    }

    /// The velocity towards the carrot with `left_m` of the route to go.
    fn towards(&self, scene: &Scene<'_>, carrot: Point, left_m: f64) -> Velocity {
        let limits = &self.robot.limits;
        let bearing_rad = scene.pose.bearing_to(carrot);
        let is_behind = bearing_rad.abs() > FRAC_PI_2;
        if is_behind && limits.turns_in_place() {
            // Limits the turn rate such that the robot can stop at the bearing.
            let fastest = (2.0 * limits.angular_deceleration_radps2 * bearing_rad.abs()).sqrt();
            return Velocity::new(0.0, fastest.copysign(bearing_rad));
        }
        let distance_m = scene.pose.point().distance(carrot);
        // gamma = 2 x / l², with x = l sin(bearing).
        let curvature =
            if distance_m > 0.0 { 2.0 * libm::sin(bearing_rad) / distance_m } else { 0.0 };
        // A car-like robot drives a loop to what lies behind it.
        let sharpest = limits.min_turning_radius_m.abs().recip();
        let sought = if is_behind { sharpest.copysign(bearing_rad) } else { curvature };
        let curvature = sought.clamp(-sharpest, sharpest);
        let stop_mps = limits.stoppable_mps(scene.velocity.v, left_m, self.robot.cycle_s);
        let turn_mps = limits.omega_max_radps / curvature.abs();
        let v = limits.v_max_mps.min(stop_mps).min(turn_mps);
        Velocity::new(v, v * curvature)
    }
}

impl Follower {
    /// The carrot: the target point on the route after an arc length of it was covered.
    pub(super) fn carrot(&self, path: &Polyline, covered_m: f64) -> Option<Point> {
        path.at_length(covered_m + self.config.look_ahead_m)
    }

    /// Covered length of the route \[m\].
    fn covered_m(&self, scene: &Scene<'_>, memory: &DriveMemory) -> f64 {
        let position = scene.pose.point();
        scene.path.nearest_along(position, memory.covered_m, self.config.look_ahead_m)
    }
}

impl LocalParameters for FollowerConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(Follower::new(self.clone(), Arc::clone(robot))?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for Follower {
    fn decide(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        _: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        memory.covered_m = self.covered_m(scene, memory);
        let carrot = self.carrot(scene.path, memory.covered_m);
        let left_m = (scene.path.length_m() - memory.covered_m).min(scene.remaining_m);
        // At the end there is no direction to turn to, either.
        let carrot = carrot.filter(|_| left_m > 0.0);
        let wanted = carrot.map_or(Velocity::ZERO, |carrot| self.towards(scene, carrot, left_m));
        let command = self.robot.limits.reached(scene.velocity, wanted, self.robot.cycle_s);
        Ok(Decision { command, evaluation: Evaluation::default() })
    }

    /// The carrot; there are no candidates.
    fn explain(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Explanation {
        let target = self.carrot(scene.path, self.covered_m(scene, memory));
        Explanation { target, ..Explanation::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{BitGrid, DistanceField, FieldConfig, GridFrame};
    use std::f64::consts::PI;

    fn line(points: &[[f64; 2]]) -> Polyline {
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    fn nothing() -> DistanceField {
        let frame = GridFrame::new(1, 1, 1.0, Pose::default()).unwrap();
        DistanceField::new(&frame, &BitGrid::new(1, 1, false), &FieldConfig::default())
    }

    fn small() -> Follower {
        let robot = Robot::small();
        Follower::new(FollowerConfig::for_robot(&robot), robot).unwrap()
    }

    /// Drives along a line from its beginning; returns the largest distance from it, and the last
    /// pose.
    fn driven(path: &Polyline, heading_rad: f64, cycles: u32) -> (f64, Pose, DriveMemory) {
        let follower = small();
        let obstacles = &nothing();
        let start = path.points()[0];
        let mut pose = Pose::new(start.x, start.y, heading_rad);
        let (mut velocity, mut memory) = (Velocity::ZERO, DriveMemory::default());
        let mut farthest_sq: f64 = 0.0;
        for _ in 0..cycles {
            let guide = *path.points().last().unwrap();
            let sensed = obstacles.clearance().obstacles();
            let scene = Scene {
                obstacles,
                sensed,
                seen: crate::sense::SeenCells::ANYWHERE,
                movers: &[],
                walked: &[],
                pose,
                velocity,
                guide,
                path,
                goal_heading_rad: None,
                remaining_m: f64::INFINITY,
                jerk_limited: None,
            };
            let decision = follower.decide(&scene, &mut memory, &mut Scratch::default()).unwrap();
            let limits = &follower.robot.limits;
            let next = limits.reached(velocity, decision.command, follower.robot.cycle_s);
            pose = pose.after_ramp(velocity, next, follower.robot.cycle_s);
            velocity = next;
            let to =
                |sq: f64, s: crate::geometry::Segment| sq.min(s.distance_sq_to_point(pose.point()));
            farthest_sq = farthest_sq.max(path.segments().fold(f64::INFINITY, to));
        }
        (farthest_sq.sqrt(), pose, memory)
    }

    #[test]
    fn the_arc_by_hand() {
        let path = line(&[[0., 0.], [0., 1.]]);
        let obstacles = &nothing();
        let pose = Pose::new(0.0, 0.0, 0.0);
        let guide = Point::new(0.0, 1.0);
        let sensed = obstacles.clearance().obstacles();
        let velocity = Velocity::ZERO;
        let scene = Scene {
            obstacles,
            sensed,
            seen: crate::sense::SeenCells::ANYWHERE,
            movers: &[],
            walked: &[],
            pose,
            velocity,
            guide,
            path: &path,
            goal_heading_rad: None,
            remaining_m: f64::INFINITY,
            jerk_limited: None,
        };
        // At (0.3, 0.3): gamma = 2 * 0.3 / 0.18 = 10 / 3, so 1.5 rad/s are 0.45 m/s.
        let wanted = small().towards(&scene, Point::new(0.3, 0.3), 9.0);
        assert!((wanted.v - 0.45).abs() < 1e-12 && (wanted.omega - 1.5).abs() < 1e-12);
        // 0.01 m to go from rest: 0.075 m/s takes 3.75 mm in this cycle, 5 mm in the next one,
        // which brakes to 0.025 m/s, and 1.25 mm in the last one.
        let wanted = small().towards(&scene, Point::new(0.3, 0.0), 0.01);
        assert!((wanted.v - 0.075).abs() < 1e-12 && wanted.omega == 0.0);
        // Behind: on the spot, to the left.
        let wanted = small().towards(&scene, Point::new(-0.3, 0.1), 9.0);
        assert!(wanted.v == 0.0 && wanted.omega > 0.0);
    }

    #[test]
    fn follows_a_bend_and_stops_at_the_end() {
        let path = line(&[[0., 0.], [3., 0.], [3., 3.]]);
        let (off_m, pose, memory) = driven(&path, PI, 300);
        assert!(off_m < 0.2, "{off_m}");
        assert!(pose.point().distance(Point::new(3.0, 3.0)) < 0.02, "{pose:?}");
        assert!((memory.covered_m - 6.0).abs() < 0.02);
    }

    #[test]
    fn a_route_that_comes_back_is_driven_in_order() {
        // Out and back with an offset of 0.1 m: the nearest point of all would be on the way
        // back.
        let path = line(&[[0., 0.], [4., 0.], [4., 0.1], [0., 0.1]]);
        let covered = |from_m| path.nearest_along(Point::new(1.0, 0.06), from_m, 0.5);
        assert!((covered(0.9) - 1.0).abs() < 1e-12 && (covered(6.9) - 7.1).abs() < 1e-12);
        let (_, pose, _) = driven(&path, 0.0, 400);
        assert!(pose.point().distance(Point::new(0.0, 0.1)) < 0.05, "{pose:?}");
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Follower::new(FollowerConfig { look_ahead_m: value }, Robot::small());
            assert_eq!(refused.unwrap_err().path, "look_ahead_m", "{value}");
        }
        let mut robot = Robot::small();
        robot.cycle_s = f64::NAN;
        let refused = Follower::new(FollowerConfig { look_ahead_m: 1.0 }, robot);
        assert_eq!(refused.unwrap_err().path, "robot.cycle_s");
    }
}
