//! Obstacles that give way during a simulation.

use super::social_force::{Body, add_forces};
use super::{KeyFrame, KeyFrames, MoverWay, MovingObstacle, ObstacleMotion, WayPoints, World};
use keyway::geometry::{Disc, Point};
use std::borrow::Cow;

/// An obstacle that gives way, between two cycles. In the simulated world it follows key frames,
/// so scans and contacts do not depend on its decisions.
pub(super) struct GivingWay {
    /// Index among the moving obstacles.
    index: usize,
    course: WayPoints,
    /// Index of the current target way-point, and the direction in which the obstacle continues
    /// from there.
    towards: usize,
    is_going_back: bool,
    body: Body,
}

impl GivingWay {
    /// Distance from a way-point at which an obstacle turns to the next \[m\]; a larger obstacle
    /// turns when it covers the way-point.
    const NEAR_M: f64 = 0.2;

    /// Returns all obstacles of a world that give way, at rest at their first positions.
    pub(super) fn begin(world: &mut Cow<'_, World>) -> Vec<Self> {
        let giving_way = |(index, mover): (usize, &MovingObstacle)| {
            let ObstacleMotion::GivesWay(course) = mover.motion() else { return None };
            let centre = course.points()[0];
            let body = Body { centre, radius_m: mover.radius_m(), velocity_mps: Point::default() };
            let course = course.clone();
            Some(Self { index, course, towards: 1, is_going_back: false, body })
        };
        let all: Vec<Self> = world.movers().iter().enumerate().filter_map(giving_way).collect();
        for Self { index, body, .. } in &all {
            let begin = vec![KeyFrame { t_s: 0.0, position: body.centre }];
            let mover = &mut world.to_mut().movers_mut()[*index];
            *mover = mover.moving(ObstacleMotion::KeyFrames(KeyFrames::in_order(begin)));
        }
        all
    }

    /// Moves all of them straight to the end of a cycle at `end_s`. All decide on the state at
    /// the beginning of the cycle.
    pub(super) fn advance_all(
        all: &mut [Self],
        world: &mut Cow<'_, World>,
        robots: &[Body],
        cycle_s: f64,
        end_s: f64,
    ) {
        if all.is_empty() {
            return;
        }
        let begin_s = end_s - cycle_s;
        let bodies = world.movers().iter().map(|mover| body_of(mover, begin_s, cycle_s));
        let mut bodies: Vec<Body> = bodies.collect();
        bodies.extend(robots);
        let mut forces = vec![None; bodies.len()];
        for one in all.iter() {
            bodies[one.index] = one.body;
            forces[one.index] = Some(one.drive());
        }
        add_forces(&bodies, &mut forces);
        for one in all {
            one.advance(forces[one.index].unwrap_or_default(), cycle_s);
            let frame = KeyFrame { t_s: end_s, position: one.body.centre };
            world.to_mut().movers_mut()[one.index].goes_on(frame);
        }
    }

    /// Returns the positions of all of them so far.
    pub(super) fn ways(all: &[Self], world: &World) -> Vec<MoverWay> {
        let way = |one: &Self| match world.movers()[one.index].motion() {
            ObstacleMotion::KeyFrames(frames) => {
                Some(MoverWay { index: one.index, key_frames: frames.frames().to_vec() })
            }
            _ => None,
        };
        all.iter().filter_map(way).collect()
    }

    /// Current target \[m\].
    fn goal(&self) -> Point {
        self.course.points()[self.towards]
    }

    /// Force towards the target \[m/s²\].
    fn drive(&self) -> Point {
        self.body.drive(self.goal(), self.course.speed_mps())
    }

    /// Moves straight for a cycle, under the force at its beginning \[m/s²\].
    fn advance(&mut self, force: Point, cycle_s: f64) {
        let velocity_mps = self.body.next_velocity(force, self.course.speed_mps(), cycle_s);
        self.body.velocity_mps = velocity_mps;
        self.body.centre = self.body.centre + velocity_mps * cycle_s;
        let near_m = Self::NEAR_M.max(self.body.radius_m);
        if self.body.centre.distance(self.goal()) <= near_m {
            self.turn_to_the_next();
        }
    }

    fn turn_to_the_next(&mut self) {
        let last = self.course.points().len() - 1;
        if !self.course.is_to_and_fro() {
            self.towards = if self.towards == last { 0 } else { self.towards + 1 };
            return;
        }
        self.is_going_back = self.towards == last || (self.is_going_back && self.towards > 0);
        if self.is_going_back {
            self.towards -= 1;
        } else {
            self.towards += 1;
        }
    }
}

/// Returns an obstacle at a time, with its mean velocity over the previous cycle; at rest if it
/// has just jumped.
fn body_of(mover: &MovingObstacle, t_s: f64, cycle_s: f64) -> Body {
    let Disc { centre, radius_m } = mover.at(t_s);
    let before_s = t_s - cycle_s;
    let has_jumped = mover.motion().last_jump_s(t_s).is_some_and(|jump_s| jump_s > before_s);
    let moved_m = centre - mover.motion().position(before_s);
    let velocity_mps = if has_jumped { Point::default() } else { moved_m * cycle_s.recip() };
    Body { centre, radius_m, velocity_mps }
}
