//! Obstacles that give way, while a simulation runs.

use super::social_force::{Body, add_forces};
use super::{Circle, KeyFrame, KeyFrames, Motion, Mover, MoverWay, WayPoints, World};
use keyway::geometry::Point;
use std::borrow::Cow;

/// An obstacle that gives way, between two cycles. Its mover in the world of the simulation goes from place to place at
/// given times, so scans and contacts need not know that it decides.
pub(super) struct GivingWay {
    /// Its place among the obstacles that move.
    index: usize,
    course: WayPoints,
    /// Number of the way-point that it goes to, and which way it goes on from there.
    towards: usize,
    is_going_back: bool,
    body: Body,
}

impl GivingWay {
    /// At this distance from a way-point it turns to the next \[m\]; an obstacle that is larger does when it covers it.
    const NEAR_M: f64 = 0.2;

    /// Those of a world, at rest where they begin.
    pub(super) fn begin(world: &mut Cow<'_, World>) -> Vec<Self> {
        let giving_way = |(index, mover): (usize, &Mover)| {
            let Motion::GivesWay(course) = mover.motion() else { return None };
            let centre = course.points()[0];
            let body = Body { centre, radius_m: mover.radius_m(), velocity_mps: Point::default() };
            let course = course.clone();
            Some(Self { index, course, towards: 1, is_going_back: false, body })
        };
        let all: Vec<Self> = world.movers().iter().enumerate().filter_map(giving_way).collect();
        for Self { index, body, .. } in &all {
            let begin = vec![KeyFrame { t_s: 0.0, position: body.centre }];
            let mover = &mut world.to_mut().movers_mut()[*index];
            *mover = mover.moving(Motion::KeyFrames(KeyFrames::in_order(begin)));
        }
        all
    }

    /// Takes all of them to the end of a cycle at `end_s`, each on a straight line. All decide on the state at its beginning.
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

    /// Where all of them were.
    pub(super) fn ways(all: &[Self], world: &World) -> Vec<MoverWay> {
        let way = |one: &Self| match world.movers()[one.index].motion() {
            Motion::KeyFrames(frames) => {
                Some(MoverWay { index: one.index, key_frames: frames.frames().to_vec() })
            }
            _ => None,
        };
        all.iter().filter_map(way).collect()
    }

    /// The place that it goes to now.
    fn goal(&self) -> Point {
        self.course.points()[self.towards]
    }

    /// The force that draws it there \[m/s²\].
    fn drive(&self) -> Point {
        self.body.drive(self.goal(), self.course.speed_mps())
    }

    /// Goes straight on for a cycle, under the force at its beginning \[m/s²\].
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

/// An obstacle at a time, with the velocity at which it came there; at rest where it has just jumped.
fn body_of(mover: &Mover, t_s: f64, cycle_s: f64) -> Body {
    let Circle { centre, radius_m } = mover.at(t_s);
    let before_s = t_s - cycle_s;
    let has_jumped = mover.motion().last_jump_s(t_s).is_some_and(|jump_s| jump_s > before_s);
    let moved_m = centre - mover.motion().position(before_s);
    let velocity_mps = if has_jumped { Point::default() } else { moved_m * cycle_s.recip() };
    Body { centre, radius_m, velocity_mps }
}
