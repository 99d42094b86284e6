//! Space-time trajectories: velocities at a few instants, between which they change linearly; the
//! simulation of a trajectory, and its cost.

use super::cost_to_go::CostToGo;
use super::meeting::Meeting;
use super::pose_cost::PoseCost;
use super::room::{Exact, Outline, Room};
use crate::geometry::{Point, Velocity};
use crate::local::rear::Seen;
use crate::robot::Limits;
use std::f64::consts::PI;

/// State of the robot at an instant of a trajectory. Positions are those of a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) at: Point,
    /// Direction that the robot faces, of length 1.
    pub(super) ahead: Point,
    pub(super) velocity: Velocity,
    /// Time from the beginning of the trajectory \[s\].
    pub(super) after_s: f64,
}

/// Cost of a trajectory so far in addition to its time, by reason \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit is no part of the names")]
pub(super) struct Cost {
    pub(super) clearance_s: f64,
    pub(super) movers_s: f64,
    pub(super) steering_s: f64,
}

impl Cost {
    pub(super) fn sum_s(&self) -> f64 {
        self.clearance_s + self.movers_s + self.steering_s
    }

    /// The part that depends on the surroundings.
    pub(super) fn way_s(&self) -> f64 {
        self.clearance_s + self.movers_s
    }
}

/// The criteria by which trajectories are judged in one cycle.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    pub(super) limits: &'a Limits,
    pub(super) outline: &'a Outline,
    pub(super) room: &'a Room,
    pub(super) exact: Exact<'a>,
    /// Cells over which the robot may drive backwards; `None` if it sees all around.
    pub(super) seen: Option<Seen<'a>>,
    pub(super) cost_to_go: &'a CostToGo,
    pub(super) pose_cost: &'a PoseCost,
    pub(super) meeting: &'a Meeting<'a>,
    /// Remaining length of the route beyond the lattice \[m\].
    pub(super) beyond_m: f64,
    /// Preferred clearance around the footprint \[m\].
    pub(super) comfortable_m: f64,
    /// With less clearance than this the robot touches something: the margin, or its present
    /// clearance if that is less \[m\].
    pub(super) least_m: f64,
    /// `tight_sq` of the clearance that the robot may use now: if it is in a tight
    /// passage, being stationary does not get it out.
    pub(super) tight_now_sq: f64,
    pub(super) discomfort: f64,
    pub(super) steering: f64,
    pub(super) jerk: f64,
    /// Acceleration with which the last trajectory continues.
    pub(super) before: Acceleration,
    /// The duration of a stretch \[s\].
    pub(super) stretch_s: f64,
    /// Distance within which the robot has to stop \[m\].
    pub(super) remaining_m: f64,
}

/// Accelerations as fractions of the robot's limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Acceleration {
    pub(super) linear: f64,
    pub(super) angular: f64,
}

impl Acceleration {
    /// The constant acceleration from one velocity to another.
    pub(super) fn of(from: Velocity, to: Velocity, duration_s: f64, limits: &Limits) -> Self {
        Self {
            linear: (to.v - from.v) / (limits.acceleration_mps2 * duration_s),
            angular: (to.omega - from.omega) / (limits.angular_acceleration_radps2 * duration_s),
        }
    }
}

impl State {
    /// Completes a stretch that ends with a velocity.
    fn end_stretch(&mut self, velocity: Velocity) {
        self.velocity = velocity;
        // Rotating a direction step by step changes its length by rounding.
        self.ahead = self.ahead * (1.0 / self.ahead.norm());
    }
}

impl Judge<'_> {
    /// Least number of steps of a stretch among moving obstacles.
    const STEPS: f64 = 4.0;

    /// No part of the footprint moves farther in a step than this fraction of its inscribed
    /// radius.
    const STEP: f64 = 0.8;

    /// Number of steps in which a stretch is evaluated.
    fn steps(&self, from: Velocity, to: Velocity) -> u32 {
        let v = from.v.abs().max(to.v.abs());
        let omega = from.omega.abs().max(to.omega.abs());
        let moves_m = (v + omega * self.outline.swing_m()) * self.stretch_s;
        let cell_m = self.room.spacing_m();
        let by_way = moves_m / (Self::STEP * self.outline.inscribed_m).max(cell_m);
        let least = if self.meeting.movers.is_empty() { 1.0 } else { Self::STEPS };
        by_way.max(least).ceil() as u32
    }

    /// End state of a stretch from a state until its velocity is `to`, and the cost with that of
    /// steering added. Neither considers the surroundings.
    pub(super) fn leads_to(&self, from: &State, cost: &Cost, to: Velocity) -> (State, Cost) {
        let steps = self.steps(from.velocity, to);
        let (mut state, mut cost) = (*from, *cost);
        for step in 0..steps {
            self.step(&mut state, (from.velocity, to), (step, steps));
        }
        state.end_stretch(to);
        cost.steering_s += self.steering_s(from, to);
        (state, cost)
    }

    /// The same with the cost of the surroundings. `None` if the robot touches something.
    pub(super) fn drive(&self, from: &State, cost: &Cost, to: Velocity) -> Option<(State, Cost)> {
        let steps = self.steps(from.velocity, to);
        let step_s = self.stretch_s / f64::from(steps);
        let (mut state, mut cost) = (*from, *cost);
        let moves = to != Velocity::ZERO || from.velocity != Velocity::ZERO;
        let least_m = if moves { self.least_m } else { f64::NEG_INFINITY };
        for step in 0..steps {
            let v = self.step(&mut state, (from.velocity, to), (step, steps));
            let bounds_m = (least_m, self.comfortable_m);
            let room_m = self.room_m(&state, bounds_m);
            if room_m < least_m || moves && self.is_blind(&state, v) {
                return None;
            }
            let driving = v.abs() / self.limits.v_max_mps;
            cost.clearance_s += self.discomfort * self.missing(room_m) * driving * step_s;
            let velocity_mps = state.ahead * v;
            cost.movers_s += self.meeting.cost_s(state.at, state.after_s, velocity_mps) * step_s;
        }
        state.end_stretch(to);
        cost.steering_s += self.steering_s(from, to);
        Some((state, cost))
    }

    /// Clearance of the robot in a state \[m\]; see [`Outline::room_m`].
    fn room_m(&self, state: &State, bounds_m: (f64, f64)) -> f64 {
        let (least_m, enough_m) = bounds_m;
        let posed = (state.at, state.ahead);
        if least_m.is_finite() {
            self.outline.exact_room_m((self.room, self.exact), posed, (least_m, enough_m))
        } else {
            self.outline.room_m(self.room, posed, bounds_m)
        }
    }

    /// Simulates one of the steps of a stretch between two velocities; returns the speed in it
    /// \[m/s\].
    #[inline]
    fn step(
        &self,
        state: &mut State,
        (from, to): (Velocity, Velocity),
        (step, steps): (u32, u32),
    ) -> f64 {
        let step_s = self.stretch_s / f64::from(steps);
        let velocity = from.lerp(to, (f64::from(step) + 0.5) / f64::from(steps));
        // The chord of a short arc, halfway between both headings.
        let half = direction(0.5 * velocity.omega * step_s);
        let along = turned(state.ahead, half);
        state.at = state.at + along * (velocity.v * step_s);
        state.ahead = turned(along, half);
        state.after_s += step_s;
        velocity.v
    }

    /// Missing clearance for a turn on the spot at a position: 0 if there is enough, 1 if no more
    /// fits than the inscribed circle.
    pub(super) fn short_of_turning(&self, place: Point) -> f64 {
        let swings_m = self.outline.circumscribed_m - self.outline.inscribed_m;
        if swings_m <= 0.0 {
            return 0.0;
        }
        let missing_m = self.outline.circumscribed_m - self.room.of_point(place);
        (missing_m / swings_m).clamp(0.0, 1.0)
    }

    /// The turn rate that leads to the middle of a narrow passage \[rad/s\]; `None` elsewhere.
    ///
    /// In a straight lane, the distances of two points to its walls, one on each side of the
    /// robot, differ by twice its offset from the middle.
    pub(super) fn to_middle_radps(&self, state: &State) -> Option<f64> {
        let v = state.velocity.v;
        let ahead_m = self.outline.inscribed_m + v.abs() * self.stretch_s;
        let at = state.at + state.ahead * ahead_m.copysign(v);
        let aside = Point::new(-state.ahead.y, state.ahead.x);
        let beside_m = 0.5 * self.outline.inscribed_m;
        let room_m = |left_m: f64| self.room.of_point(at + aside * left_m);
        let left_m = 0.5 * (room_m(beside_m) - room_m(-beside_m));
        let narrow_m = self.outline.inscribed_m + Self::NARROW * self.comfortable_m;
        // The turn rate of the arc that leads there.
        (room_m(left_m) < narrow_m).then_some(2.0 * v * left_m / (ahead_m * ahead_m))
    }

    /// A passage is narrow if the clearance to each side is below this fraction of the preferred
    /// one.
    const NARROW: f64 = 0.5;

    /// True if the robot drives backwards over ground that it has not observed: it would touch an
    /// obstacle there before it is seen.
    fn is_blind(&self, state: &State, v_mps: f64) -> bool {
        v_mps < 0.0 && !self.seen.is_none_or(|seen| seen.holds(state.at, state.ahead))
    }

    /// True if the robot could brake along its arc from a state without touching anything, as the
    /// stop rule will require.
    pub(super) fn can_stop(&self, from: &State) -> bool {
        let Velocity { v, omega, .. } = from.velocity;
        let Limits { deceleration_mps2, angular_deceleration_radps2, .. } = *self.limits;
        let stop_s = (v.abs() / deceleration_mps2).max(omega.abs() / angular_deceleration_radps2);
        // Speed and turn rate fall in proportion: the mean of each is half of its initial value.
        let (way_m, turn_rad) = (0.5 * v * stop_s, 0.5 * omega * stop_s);
        let moves_m = way_m.abs() + turn_rad.abs() * self.outline.swing_m();
        let step_m = (Self::STEP * self.outline.inscribed_m).max(self.room.spacing_m());
        let steps = (moves_m / step_m).ceil();
        let half = direction(0.5 * turn_rad / steps);
        // Distances are interpolated: only a certain contact is rejected.
        let least_m = self.least_m.min(0.0);
        let mut state = *from;
        for _ in 0..steps as u32 {
            let along = turned(state.ahead, half);
            state.at = state.at + along * (way_m / steps);
            state.ahead = turned(along, half);
            let bounds_m = (least_m, self.least_m);
            let room_m = self.room_m(&state, bounds_m);
            if room_m < least_m || self.is_blind(&state, v) {
                return false;
            }
        }
        true
    }

    /// Additional weight of a metre, for a discomfort of 1.
    fn missing(&self, room_m: f64) -> f64 {
        let part = |of_m: f64| (1.0 - room_m / of_m).clamp(0.0, 1.0);
        let room = part(self.comfortable_m);
        let tighter_sq = (Self::tight_sq(room_m, self.comfortable_m) - self.tight_now_sq).max(0.0);
        room * room + Self::TIGHTER * tighter_sq
    }

    /// The missing fraction of the clearance in a tight passage, squared; 0 if a passage is not
    /// tight.
    pub(super) fn tight_sq(room_m: f64, comfortable_m: f64) -> f64 {
        let missing = (1.0 - room_m / (Self::TIGHT * comfortable_m)).clamp(0.0, 1.0);
        missing * missing
    }

    /// A passage is tight if its clearance is below this fraction of the comfortable one.
    const TIGHT: f64 = 0.2;

    /// Additional weight of a metre at a clearance of 0.
    const TIGHTER: f64 = 8.0;

    /// Cost of changing the velocity in a stretch \[s\]; in the first stretch, also that of
    /// changing the acceleration.
    fn steering_s(&self, from: &State, to: Velocity) -> f64 {
        let Acceleration { linear, angular } =
            Acceleration::of(from.velocity, to, self.stretch_s, self.limits);
        let mut cost = self.steering * (angular * angular + 0.25 * linear * linear);
        if from.after_s == 0.0 {
            let (linear, angular) = (linear - self.before.linear, angular - self.before.angular);
            cost += self.jerk * (angular * angular + 0.25 * linear * linear);
        }
        self.stretch_s * cost
    }

    /// Estimate of the time from a state to a stop at the end of the route \[s\].
    ///
    /// With the remaining path length D and the angle f between heading and path, it is the time
    /// of the fastest speed profile over D that begins with v cos f, plus (1 - cos f) / 2 times
    /// the time that a robot needs to turn around and to speed up again. The second part grows up
    /// to twofold if the robot is nearly or fully stationary and has no space to turn: it has to
    /// drive away from there first. If headings have a cost of their own ([`PoseCost`]), that
    /// replaces the second part.
    pub(super) fn time_to_go_s(&self, state: &State) -> f64 {
        let (left_m, way) = self.cost_to_go.way(state.at);
        let left_m = left_m + self.beyond_m;
        let norm = way.norm();
        let cos = if norm > 0.0 { way.dot(state.ahead) / norm } else { 1.0 };
        if let Some(heading_s) = self.pose_cost.of(state.at, state.ahead) {
            return profile_s(self.limits, state.velocity.v * cos, left_m) + heading_s;
        }
        let Limits { v_max_mps, acceleration_mps2, .. } = *self.limits;
        let around_s = PI / self.limits.turn_rate_at(v_max_mps) + v_max_mps / acceleration_mps2;
        // At the end there is no direction to turn to.
        let near_m = self.outline.inscribed_m.max(self.room.spacing_m());
        let turning_s = 0.5 * (1.0 - cos) * around_s * (left_m / near_m).min(1.0);
        // The faster it is, the farther it moves while it turns.
        let slowness = (1.0 - state.velocity.v.abs() / v_max_mps).max(0.0);
        let turning_s = turning_s * (1.0 + slowness * self.short_of_turning(state.at));
        profile_s(self.limits, state.velocity.v * cos, left_m) + turning_s
    }

    /// True if a trajectory need not be extended from a state: it reaches the end of the route
    /// within another stretch, or faces the end of the local part of the route across open ground
    /// without moving obstacles. The time to go is exact there, while further stretches would
    /// have the speeds of whole stretches.
    pub(super) fn arrives(&self, state: &State, left_s: f64) -> bool {
        if left_s <= self.stretch_s {
            return true;
        }
        if !self.meeting.movers.is_empty() || self.pose_cost.is_active() {
            return false;
        }
        self.cost_to_go.straight_to_end(state.at).is_some_and(|way| {
            let cos = way.dot(state.ahead) / way.norm();
            cos >= Self::FACING_COS
        })
    }

    /// Cosine of two and a half degrees.
    const FACING_COS: f64 = 0.999;
}

/// Time to drive `left_m` and stop there, with the initial speed `v` (negative: away from it)
/// \[s\]. If that is too fast to stop there, the excess costs twice the time to brake it.
fn profile_s(limits: &Limits, v: f64, left_m: f64) -> f64 {
    let Limits { v_max_mps, acceleration_mps2: a, deceleration_mps2: b, .. } = *limits;
    let stoppable_mps = (2.0 * b * left_m).sqrt();
    if v >= stoppable_mps {
        return (stoppable_mps + 2.0 * (v - stoppable_mps)) / b;
    }
    // The speed at which braking begins, and the distances of acceleration and braking.
    let peak_sq = (2.0 * a * b * left_m + b * v * v) / (a + b);
    let peak_sq = peak_sq.min(v_max_mps * v_max_mps);
    let peak_mps = peak_sq.sqrt();
    let changing_m = (peak_sq - v * v) / (2.0 * a) + peak_sq / (2.0 * b);
    (peak_mps - v) / a + peak_mps / b + (left_m - changing_m).max(0.0) / v_max_mps
}

/// Unit vector of an angle \[rad\]; fast for small angles.
fn direction(angle_rad: f64) -> Point {
    if angle_rad.abs() > 0.5 {
        let (sin, cos) = libm::sincos(angle_rad);
        return Point::new(cos, sin);
    }
    // Taylor series: the remainder is below 1e-9.
    let sq = angle_rad * angle_rad;
    let cos = 1.0 - sq / 2.0 * (1.0 - sq / 12.0 * (1.0 - sq / 30.0 * (1.0 - sq / 56.0)));
    let sin = angle_rad * (1.0 - sq / 6.0 * (1.0 - sq / 20.0 * (1.0 - sq / 42.0)));
    Point::new(cos, sin)
}

fn turned(direction: Point, by: Point) -> Point {
    let x = direction.x * by.x - direction.y * by.y;
    Point::new(x, direction.x * by.y + direction.y * by.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::local::space_time::lattice::Lattice;
    use crate::map::{CellState, DistanceField, FieldConfig, OccupancyGrid};
    use crate::robot::{Footprint, Robot};
    use proptest::prelude::*;

    #[test]
    fn directions_of_small_angles_are_exact() {
        for i in -300..=300 {
            let angle = 0.01 * f64::from(i);
            let (sin, cos) = libm::sincos(angle);
            assert!(direction(angle).distance(Point::new(cos, sin)) < 1e-8, "{angle}");
        }
    }

    #[test]
    fn times_of_profiles_by_hand() {
        let limits = Robot::small().limits;
        let time = |v, left_m| profile_s(&limits, v, left_m);
        // 0.5 m/s, 0.5 m/s²: a second and 0.25 m to speed up, the same to brake.
        assert!((time(0.0, 1.5) - 4.0).abs() < 1e-12);
        assert!((time(0.5, 1.25) - 3.0).abs() < 1e-12);
        assert!((time(0.0, 0.5) - 2.0).abs() < 1e-12);
        // Accelerates over half of it to 0.3536 m/s, and brakes over the other half.
        assert!((time(0.0, 0.25) - 2.0 * 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((time(0.5, 0.25) - 1.0).abs() < 1e-12, "it just stops");
        assert!((time(0.4999, 0.25) - time(0.5001, 0.25)).abs() < 1e-3);
        // Away from it: a second and 0.25 m to stop, and that distance again.
        assert!((time(-0.5, 1.25) - 5.0).abs() < 1e-12);
        assert!(time(0.5, 0.2) > time(0.4, 0.2));
        assert_eq!(time(0.0, 0.0), 0.0);
    }

    /// A lane of 0.6 m with its middle at y = 1.3 m, and open ground from x = 6 m on.
    #[test]
    fn on_a_narrow_way_it_is_led_to_the_middle() {
        let frame = crate::map::GridFrame::new(200, 60, 0.05, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| {
            let is_wall = cell.x < 120 && !(20..32).contains(&cell.y);
            if is_wall { CellState::Occupied } else { CellState::Free }
        });
        let obstacles = DistanceField::new(&frame, map.occupied(), &FieldConfig::default());
        let mut robot = Robot::small();
        robot.footprint = Footprint::circle(0.25).unwrap();
        let (outline, cost_to_go, pose_cost) =
            (Outline::of(&robot), CostToGo::default(), PoseCost::default());
        let meeting = Meeting { movers: &[], comfortable_m: 1.0, contact: 0.0, horizon_s: 1.0 };
        let rate_radps = |(x, y): (f64, f64), v| {
            let at = Point::new(x, y);
            let mut room = Room::default();
            room.fill(Lattice::around(&frame, at, 2.0, 0.05), &obstacles, 1.0);
            let exact = Exact { footprint: &robot.footprint, obstacles: &obstacles };
            let judge = Judge {
                limits: &robot.limits,
                outline: &outline,
                room: &room,
                exact,
                seen: None,
                cost_to_go: &cost_to_go,
                pose_cost: &pose_cost,
                meeting: &meeting,
                beyond_m: 0.0,
                comfortable_m: 0.2,
                least_m: 0.0,
                tight_now_sq: 0.0,
                discomfort: 0.5,
                steering: 0.0,
                jerk: 0.0,
                before: Acceleration::default(),
                stretch_s: 0.5,
                remaining_m: 9.0,
            };
            let velocity = Velocity::new(v, 0.0);
            judge.to_middle_radps(&State { at, ahead: direction(0.0), velocity, after_s: 0.0 })
        };
        // 5 cm beside it, on an arc over 0.25 m and the distance of 0.5 s.
        let radps = 2.0 * 0.4 * 0.05 / (0.45 * 0.45);
        for (y, expected) in [(1.3, 0.0), (1.25, radps), (1.35, -radps)] {
            let found = rate_radps((4.0, y), 0.4).unwrap();
            assert!((found - expected).abs() < 0.1 * radps, "{y} {found}");
        }
        // Backwards, a turn to the left leads to the right.
        let back = rate_radps((4.0, 1.25), -0.4).unwrap();
        assert!((back + radps).abs() < 0.1 * radps, "{back}");
        assert_eq!(rate_radps((8.0, 1.25), 0.4), None, "in the open");
    }

    proptest! {
        /// The positions of a stretch agree with those of many arcs of the same changing
        /// velocity.
        #[test]
        fn stretches_lead_where_the_robot_drives(
            from in (-0.5..2.0_f64, -3.0..3.0_f64), to in (-0.5..2.0_f64, -3.0..3.0_f64), theta in -3.0..3.0_f64,
        ) {
            let robot = Robot::jackal();
            let (room, cost_to_go) = (Room::open(), CostToGo::default());
            let meeting = Meeting { movers: &[], comfortable_m: 1.0, contact: 0.0, horizon_s: 1.0 };
            // No obstacle is near: the field is not queried.
            let map = OccupancyGrid::from_ascii(&["."]);
            let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let exact = Exact { footprint: &robot.footprint, obstacles: &obstacles };
            let judge = Judge {
                limits: &robot.limits, outline: &Outline::of(&robot), room: &room, exact, seen: None, cost_to_go: &cost_to_go, pose_cost: &PoseCost::default(),
                meeting: &meeting, beyond_m: 0.0, comfortable_m: 0.2, least_m: 0.0, tight_now_sq: 0.0, discomfort: 0.5,
                steering: 0.0, jerk: 0.0, before: Acceleration::default(), stretch_s: 0.34, remaining_m: 9.0,
            };
            let (from, to) = (Velocity::new(from.0, from.1), Velocity::new(to.0, to.1));
            let start = State { at: Point::new(0.5, 0.5), ahead: direction(theta), velocity: from, after_s: 0.0 };
            let (state, cost) = judge.drive(&start, &Cost::default(), to).unwrap();
            let mut pose = Pose::new(0.5, 0.5, theta);
            for i in 0..1000 {
                pose = pose.after_arc(from.lerp(to, (f64::from(i) + 0.5) / 1000.0), 0.34e-3);
            }
            prop_assert!(state.at.distance(pose.point()) < 0.02, "{:?} {:?}", state.at, pose);
            prop_assert!(state.ahead.distance(direction(pose.theta)) < 1e-6);
            prop_assert!((state.after_s - 0.34).abs() < 1e-12 && state.velocity == to && cost.sum_s() == 0.0);
        }
    }
}
