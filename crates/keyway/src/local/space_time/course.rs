//! A course: velocities at a few instants, between which they change linearly. What it leads to, and what it costs.

use super::cost_to_go::CostToGo;
use super::meeting::Meeting;
use super::room::{Outline, Room};
use crate::geometry::{Point, Velocity};
use crate::robot::Limits;
use std::f64::consts::PI;

/// The state of a robot at an instant of a course. Positions are those of a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) at: Point,
    /// The direction that it faces, of length 1.
    pub(super) ahead: Point,
    pub(super) velocity: Velocity,
    /// From the beginning of the course \[s\].
    pub(super) after_s: f64,
}

/// What a course has cost so far \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cost {
    pub(super) clearance_s: f64,
    pub(super) movers_s: f64,
    pub(super) steering_s: f64,
}

impl Cost {
    pub(super) fn sum_s(&self) -> f64 {
        self.clearance_s + self.movers_s + self.steering_s
    }
}

/// What courses are judged by.
pub(super) struct Judge<'a> {
    pub(super) limits: &'a Limits,
    pub(super) outline: &'a Outline,
    pub(super) room: &'a Room,
    pub(super) cost_to_go: &'a CostToGo,
    pub(super) meeting: &'a Meeting<'a>,
    /// From the end of the lattice's route to where the robot is to stop \[m\].
    pub(super) beyond_m: f64,
    /// Room that the robot likes to have around its footprint \[m\].
    pub(super) comfortable_m: f64,
    pub(super) discomfort: f64,
    /// What the robot has at its beginning, where that is less than it needs \[m\].
    pub(super) least_m: f64,
    pub(super) steering: f64,
    /// Time from one instant to the next \[s\].
    pub(super) knot_s: f64,
    pub(super) steps: u32,
}

impl Judge<'_> {
    /// Where a stretch of a course leads: from a state, until its velocity is `to`. `None` where it touches something.
    pub(super) fn drive(&self, from: &State, cost: &Cost, to: Velocity) -> Option<(State, Cost)> {
        let step_s = self.knot_s / f64::from(self.steps);
        let (mut state, mut cost) = (*from, *cost);
        for step in 0..self.steps {
            let middle = (f64::from(step) + 0.5) / f64::from(self.steps);
            let velocity = from.velocity.lerp(to, middle);
            let half = rotation(0.5 * velocity.omega * step_s);
            let way = turned(state.ahead, half);
            state.at = state.at + way * (velocity.v * step_s);
            state.ahead = turned(way, half);
            state.after_s += step_s;
            let driven_m = velocity.v.abs() * step_s;
            let room_m =
                self.outline.room_m(self.room, state.at, state.ahead, self.comfortable_m);
            if room_m < self.least_m && (driven_m > 0.0 || velocity.omega != 0.0) {
                return None;
            }
            let missing = (1.0 - room_m / self.comfortable_m).clamp(0.0, 1.0);
            cost.clearance_s += self.discomfort * missing * missing * driven_m / self.limits.v_max_mps;
            cost.movers_s += self.meeting.cost_s(&state, velocity.v) * step_s;
        }
        state.velocity = to;
        // Rounding makes it longer or shorter by some.
        state.ahead = state.ahead * (1.0 / state.ahead.norm());
        let changed = (to.omega - from.velocity.omega)
            / (self.limits.angular_acceleration_radps2 * self.knot_s);
        let sped = (to.v - from.velocity.v) / (self.limits.acceleration_mps2 * self.knot_s);
        cost.steering_s += self.steering * self.knot_s * (changed * changed + 0.25 * sped * sped);
        Some((state, cost))
    }

    /// An estimate of the time that is needed from a state to the end of the route \[s\].
    pub(super) fn time_to_go_s(&self, state: &State) -> f64 {
        let left_m = self.cost_to_go.at(state.at) + self.beyond_m;
        let Limits { v_max_mps, acceleration_mps2: a, deceleration_mps2: b, .. } = *self.limits;
        let direction = self.cost_to_go.direction(state.at);
        let norm = direction.norm();
        let cos = if norm > 0.0 { direction.dot(state.ahead) / norm } else { 1.0 };
        let v = state.velocity.v;
        let around_s = PI / self.limits.omega_max_radps + v_max_mps / a;
        // Near the end there is nothing to turn to.
        let facing = (left_m / self.outline.inscribed_m.max(1e-3)).min(1.0);
        let turning_s = facing * 0.5 * (1.0 - cos) * around_s;
        // What the speed brings, it brings in the direction of the way.
        let v = v * cos;
        let stoppable_sq = 2.0 * b * left_m;
        let straight_s = if v > 0.0 && v * v >= stoppable_sq {
            left_m / v_max_mps + 2.0 * (v - stoppable_sq.sqrt()) / b
        } else {
            let peak_sq = ((2.0 * a * b * left_m + b * v * v) / (a + b)).min(v_max_mps * v_max_mps);
            let peak = peak_sq.sqrt();
            let changing_m = (peak_sq - v * v.abs()) / (2.0 * a) + peak_sq / (2.0 * b);
            (peak - v) / a + peak / b + (left_m - changing_m).max(0.0) / v_max_mps
        };
        straight_s + turning_s
    }
}

/// Cosine and sine of a small angle \[rad\].
fn rotation(angle_rad: f64) -> Point {
    if angle_rad.abs() > 0.5 {
        let (sin, cos) = libm::sincos(angle_rad);
        return Point::new(cos, sin);
    }
    let sq = angle_rad * angle_rad;
    let cos = 1.0 - sq * (0.5 - sq * (1.0 / 24.0 - sq * (1.0 / 720.0)));
    let sin = angle_rad * (1.0 - sq * (1.0 / 6.0 - sq * (1.0 / 120.0 - sq * (1.0 / 5040.0))));
    Point::new(cos, sin)
}

fn turned(direction: Point, by: Point) -> Point {
    Point::new(
        direction.x * by.x - direction.y * by.y,
        direction.x * by.y + direction.y * by.x,
    )
}
