//! A string that is kept tight while its end is moved along a line.

use super::TOUCH_CELLS;
use super::corners::{Corner, Corners, position};
use crate::geometry::{Point, Segment};

/// Maximum number of steps for each point of the line before the string is given up. Every map
/// that was tried needed far fewer.
const STEPS_PER_POINT: usize = 10_000;

/// A circle that the path is tangent to. Its radius is positive if the path turns left around it,
/// negative if it turns right, and 0 for a point.
#[derive(Clone, Copy, Debug)]
struct Disc {
    centre: Point,
    bend: f64,
}

/// A straight part of a path.
#[derive(Clone, Copy, Debug)]
struct Leg {
    from: Point,
    /// Unit vector.
    direction: Point,
    length: f64,
}

impl Leg {
    fn end(&self) -> Point {
        self.from + self.direction * self.length
    }
}

/// A corner that the string bends around, or its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// The corner; `None` at the start.
    corner: Option<Corner>,
    /// Its position \[cells\].
    pub(super) centre: Point,
    /// The radius around it \[cells\].
    pub(super) radius: f64,
    /// 1 if the string turns left around it, -1 to the right, 0 at the start.
    pub(super) side: f64,
    /// The point at which the string arrives \[cells\].
    pub(super) touch: Point,
    /// The direction in which it arrives, a unit vector.
    arrival: Point,
    /// The angle by which it turns here, at least 0 \[rad\].
    pub(super) turned_rad: f64,
}

impl Contact {
    fn start(at: Point) -> Self {
        Self {
            corner: None,
            centre: at,
            radius: 0.0,
            side: 0.0,
            touch: at,
            arrival: Point::default(),
            turned_rad: 0.0,
        }
    }

    fn disc(&self) -> Disc {
        Disc { centre: self.centre, bend: self.side * self.radius }
    }

    /// True if its radius is 0, up to rounding.
    pub(super) fn is_point(&self) -> bool {
        self.radius <= TOUCH_CELLS
    }
}

/// The corner that a leg hits first, and the position of the string's end at that moment.
struct Hit {
    corner: Corner,
    radius: f64,
    leg: Leg,
    angle_rad: f64,
    end: Point,
}

/// A movement of the string's end, and of the last leg with it.
struct Sweep {
    leg: Leg,
    /// 1 if the leg turns to the left, -1 to the right.
    side: f64,
    from: Point,
    to: Point,
    /// The leg at the end of the movement.
    last: Leg,
    /// The angle by which the leg turns, at least 0 \[rad\].
    angle_rad: f64,
}

/// The contacts of the taut string that a line \[cells\] can be pulled into, including the first
/// point. `None` if the line has no point, or if the string did not reach its end.
pub(super) fn pull(corners: &Corners<'_>, line: &[Point]) -> Option<Vec<Contact>> {
    let (&start, rest) = line.split_first()?;
    let mut string = TautString { corners, contacts: vec![Contact::start(start)], end: start };
    for &point in rest {
        string.lead_to(point)?;
    }
    Some(string.contacts)
}

struct TautString<'c, 'm> {
    corners: &'c Corners<'m>,
    /// The start, then the contacts in order; never empty.
    contacts: Vec<Contact>,
    end: Point,
}

impl TautString<'_, '_> {
    /// Moves the end straight to a point.
    fn lead_to(&mut self, goal: Point) -> Option<()> {
        for _ in 0..STEPS_PER_POINT {
            if self.end == goal {
                return Some(());
            }
            self.step(goal)?;
        }
        None
    }

    /// Moves the end on until the string hits or leaves a corner.
    fn step(&mut self, goal: Point) -> Option<()> {
        let pivot = *self.contacts.last()?;
        if pivot.is_point() {
            if self.end.distance(pivot.centre) <= TOUCH_CELLS {
                self.leave(goal);
                return Some(());
            }
            let way = Segment::new(self.end, goal);
            if way.distance_sq_to_point(pivot.centre) <= TOUCH_CELLS * TOUCH_CELLS {
                self.come_back_to(pivot, goal);
                return Some(());
            }
        }
        let leg = leg_to(&pivot, self.end)?;
        let side = turning_side(&pivot, &leg, goal);
        let whole = sweep(&pivot, leg, side, self.end, goal)?;
        // The start has no side and is never left.
        let unwinds = pivot.corner.is_some() && pivot.side == -side;
        let is_released = unwinds && whole.angle_rad > pivot.turned_rad;
        let sweep = if is_released {
            sweep(&pivot, leg, side, self.end, straightening(&pivot, self.end, goal))?
        } else {
            whole
        };
        if let Some(hit) = self.first_hit(&pivot, &sweep) {
            self.bend_around(&hit, side);
        } else if is_released {
            self.contacts.pop();
            self.end = sweep.to;
        } else {
            self.turn_last(side * sweep.angle_rad);
            self.end = goal;
        }
        Some(())
    }

    /// Leaves a pivot without extent whose position the end is at: the leg begins in the direction
    /// of the goal.
    fn leave(&mut self, goal: Point) {
        if let Some(pivot) = self.contacts.last_mut() {
            let turned = signed_angle(pivot.arrival, goal - pivot.centre);
            pivot.turned_rad = (pivot.side * turned).max(0.0);
        }
        self.end = goal;
    }

    /// Moves the end onto the pivot, which is then no longer a contact.
    fn come_back_to(&mut self, pivot: Contact, goal: Point) {
        let is_there = goal.distance(pivot.centre) <= TOUCH_CELLS;
        self.end = if is_there { goal } else { pivot.centre };
        if pivot.corner.is_some() {
            self.contacts.pop();
        }
    }

    fn turn_last(&mut self, angle_rad: f64) {
        if let Some(pivot) = self.contacts.last_mut() {
            pivot.turned_rad = (pivot.turned_rad + pivot.side * angle_rad).max(0.0);
        }
    }

    fn bend_around(&mut self, hit: &Hit, side: f64) {
        self.turn_last(side * hit.angle_rad);
        let centre = position(hit.corner);
        let is_point = hit.radius <= TOUCH_CELLS;
        self.contacts.push(Contact {
            corner: Some(hit.corner),
            centre,
            radius: hit.radius,
            side,
            touch: if is_point { centre } else { hit.leg.end() },
            arrival: hit.leg.direction,
            turned_rad: 0.0,
        });
        self.end = hit.end;
    }

    /// The corner that the leg hits first; the nearest of several.
    fn first_hit(&self, pivot: &Contact, sweep: &Sweep) -> Option<Hit> {
        if sweep.side == 0.0 {
            return None;
        }
        let hull = [
            Segment::new(sweep.leg.from, sweep.from),
            Segment::new(sweep.from, sweep.to),
            Segment::new(sweep.to, sweep.last.from),
            Segment::new(sweep.last.from, sweep.leg.from),
        ];
        let mut first: Option<Hit> = None;
        self.corners.for_each_near(hull, |corner| {
            if let Some(hit) = self.hit(pivot, sweep, corner) {
                let is_earlier = |first: &Hit| {
                    (hit.angle_rad, hit.leg.length) < (first.angle_rad, first.leg.length)
                };
                if first.as_ref().is_none_or(is_earlier) {
                    first = Some(hit);
                }
            }
        });
        first
    }

    /// The hit of the sweeping leg on a corner; `None` if it misses the corner.
    fn hit(&self, pivot: &Contact, sweep: &Sweep, corner: Corner) -> Option<Hit> {
        let Sweep { leg, side, .. } = sweep;
        let (centre, radius) = (position(corner), self.corners.radius(corner));
        let tangent = tangent(pivot.disc(), Disc { centre, bend: side * radius })?;
        let off_first = side * leg.direction.cross(tangent.direction) * tangent.length;
        let off_last = side * tangent.direction.cross(sweep.last.direction) * tangent.length;
        if off_first < -TOUCH_CELLS || off_last <= TOUCH_CELLS {
            return None;
        }
        let is_touched = off_first <= TOUCH_CELLS;
        if is_touched && leg.direction.dot(tangent.direction) <= 0.0 {
            return None;
        }
        let angle_rad = (side * signed_angle(leg.direction, tangent.direction)).max(0.0);
        let end = meeting(tangent.from, tangent.direction, sweep.from, sweep.to);
        let reach = (end - tangent.from).dot(tangent.direction);
        if tangent.length > reach + TOUCH_CELLS {
            return None;
        }
        let hit = Hit { corner, radius, leg: tangent, angle_rad, end };
        // The end itself may pass over a corner whose obstacle is on the other side.
        let is_at_end =
            centre.distance(sweep.from) <= TOUCH_CELLS || reach <= tangent.length + TOUCH_CELLS;
        let is_grazed = radius <= TOUCH_CELLS && (is_touched || is_at_end);
        (!is_grazed || self.turns_inwards(sweep, &hit, is_at_end)).then_some(hit)
    }

    /// True if a corner that the leg or its end grazes has an obstacle on the side that the leg
    /// turns to.
    fn turns_inwards(&self, sweep: &Sweep, hit: &Hit, is_at_end: bool) -> bool {
        let ahead = hit.leg.direction;
        let next = if is_at_end { sweep.to - sweep.from } else { ahead };
        self.corners.has_obstacle_beside(hit.corner, &[ahead, next], sweep.side)
    }
}

/// The leg that leaves one disc as its tangent and arrives at another as its tangent: with the
/// vector v between the centres, J v (v turned left by 90 degrees), and r the difference of the
/// bends,
/// |v|^2 direction = length v + r J v. `None` if one disc lies in the other.
fn tangent(from: Disc, to: Disc) -> Option<Leg> {
    let v = to.centre - from.centre;
    let distance = v.norm();
    let r = from.bend - to.bend;
    if distance <= TOUCH_CELLS || r.abs() > distance {
        return None;
    }
    let length = (distance - r).sqrt() * (distance + r).sqrt();
    let left = Point::new(-v.y, v.x);
    let direction = (v * length + left * r) * (1.0 / (distance * distance));
    let right = Point::new(direction.y, -direction.x);
    Some(Leg { from: from.centre + right * from.bend, direction, length })
}

/// The last leg of a string that ends at a point. If rounding puts the point into the disc, the
/// disc is shrunk to touch it.
fn leg_to(pivot: &Contact, end: Point) -> Option<Leg> {
    let bend = pivot.disc().bend;
    let limit = end.distance(pivot.centre);
    let disc = Disc { bend: bend.clamp(-limit, limit), ..pivot.disc() };
    tangent(disc, Disc { centre: end, bend: 0.0 })
}

/// The side that the last leg turns to if its end goes straight to `goal`; 0 if it does not turn.
fn turning_side(pivot: &Contact, leg: &Leg, goal: Point) -> f64 {
    let ahead = goal - leg.from;
    let off = leg.direction.cross(ahead);
    if off.abs() > TOUCH_CELLS {
        return off.signum();
    }
    // Back over the start of the leg: a disc is unwound.
    let is_behind = leg.direction.dot(ahead) < 0.0 && !pivot.is_point();
    if is_behind { -pivot.side } else { 0.0 }
}

fn sweep(pivot: &Contact, leg: Leg, side: f64, from: Point, to: Point) -> Option<Sweep> {
    let last = if from == to { leg } else { leg_to(pivot, to)? };
    let angle_rad = signed_angle(leg.direction, last.direction).abs();
    Some(Sweep { leg, side, from, to, last, angle_rad })
}

/// The end position at which the string is straight at the pivot.
fn straightening(pivot: &Contact, from: Point, to: Point) -> Point {
    meeting(pivot.touch, pivot.arrival, from, to)
}

/// The intersection of the ray from a point with the segment from `from` to `to`.
fn meeting(origin: Point, direction: Point, from: Point, to: Point) -> Point {
    let way = to - from;
    let across = direction.cross(way);
    let fraction = direction.cross(origin - from) / across;
    if fraction.is_finite() { from.lerp(to, fraction.clamp(0.0, 1.0)) } else { from }
}

/// The angle from one vector to another, positive to the left \[rad\].
fn signed_angle(from: Point, to: Point) -> f64 {
    libm::atan2(from.cross(to), from.dot(to))
}
