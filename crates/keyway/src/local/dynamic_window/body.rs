//! The part of a robot that must touch nothing in the next cycle.

use crate::geometry::Point;
use crate::local::Scene;
use crate::map::Core;
use crate::robot::Robot;

/// The part that must touch nothing on a rollout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<'a> {
    pub(super) core: Core<'a>,
    /// The footprint's distance to something is the core's less this \[m\].
    pub(super) offset_m: f64,
    /// Anything nearer than this to the core is contact \[m\].
    pub(super) contact_m: f64,
}

/// A robot at its present pose.
pub(super) struct Standing<'a> {
    pub(super) robot: &'a Robot,
    pub(super) scene: &'a Scene<'a>,
    /// Distances of more than this from the footprint are not distinguished \[m\].
    pub(super) reach_m: f64,
}

impl<'a> Standing<'a> {
    /// Halvings after which a shrunk footprint is exact enough: a part in 65536.
    const HALVINGS: u32 = 16;

    /// The footprint and the margin around it. If the robot is inside the margin already (or over
    /// a cell that was sensed too near), it must keep at least its present distance: a polygon
    /// that covers an obstacle is shrunk into `shrunk` until it covers none.
    pub(super) fn body(self, margin_m: f64, shrunk: &'a mut Vec<Point>) -> Body<'a> {
        let (core, radius_m) = self.robot.footprint.core();
        let room_m = self.room_m(&core, radius_m);
        let is_covering = room_m <= 0.0 && !core.vertices().is_empty();
        if !is_covering {
            let contact_m = self.kept_m(room_m, radius_m).min(radius_m + margin_m);
            return Body { core, offset_m: radius_m, contact_m };
        }
        let core = self.shrink(core, shrunk);
        let offset_m = self.robot.footprint.circumscribed_radius_m() - core.swing_m();
        let contact_m = self.kept_m(self.room_m(&core, offset_m), offset_m).min(0.0);
        Body { core, offset_m, contact_m }
    }

    /// Clearance at the present pose, from obstacles and border \[m\].
    fn room_m(&self, core: &Core<'_>, offset_m: f64) -> f64 {
        let (pose, clearance) = (self.scene.pose, self.scene.obstacles.clearance());
        let distance_m = core.distance_m(pose, &clearance, self.reach_m + offset_m);
        distance_m.min(core.to_border_m(pose, &clearance))
    }

    /// The present clearance, less the distance by which odometry noise seems to move a
    /// stationary robot \[m\].
    fn kept_m(&self, room_m: f64, offset_m: f64) -> f64 {
        let speed = self.scene.velocity.v.abs();
        let cycle_s = self.robot.cycle_s;
        let is_standing = speed <= self.robot.limits.standing_mps(cycle_s);
        let drift_m = if is_standing { speed * cycle_s } else { 0.0 };
        let kept_m = room_m - room_m.abs() * 1e-6;
        (kept_m - drift_m).max(kept_m.min(offset_m))
    }

    /// The polygon, scaled around the centre of rotation to the largest size that covers nothing.
    fn shrink(&self, core: Core<'_>, shrunk: &'a mut Vec<Point>) -> Core<'a> {
        let mut fill = |scale: f64| {
            shrunk.clear();
            shrunk.extend(core.vertices().iter().map(|&vertex| vertex * scale));
            self.room_m(&Core::polygon(shrunk), 0.0) > 0.0
        };
        let (mut free, mut covering) = (0.0, 1.0);
        for _ in 0..Self::HALVINGS {
            let middle = 0.5 * (free + covering);
            *(if fill(middle) { &mut free } else { &mut covering }) = middle;
        }
        fill(free);
        Core::polygon(shrunk)
    }
}
