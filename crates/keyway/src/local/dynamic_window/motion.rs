//! Predicted poses of the candidates of one turn rate, as functions of the speed.
//!
//! The heading depends on the turn rate alone, and every length driven is linear in the speed v,
//! in the ramp and in the steps after it. So the positions of all speeds are A + B v, with the
//! same A and B, and all sines and cosines are computed once per turn rate.

use super::rollout::Prediction;
use crate::geometry::{Point, Pose, Velocity};
use crate::map::{Core, GridFrame, Placement, Sweep, Turned};
use std::ops::Range;

/// The times of a prediction, and its initial state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    pub(super) prediction: Prediction,
    pub(super) start: Pose,
    /// Initial velocity.
    pub(super) from: Velocity,
    /// The robot's control cycle \[s\].
    pub(super) cycle_s: f64,
    /// Duration of the first stretch, in which the velocity changes \[s\]; 0 for none.
    pub(super) ramp_s: f64,
    /// Steps at the candidate velocity.
    pub(super) steps: usize,
    /// Duration of each \[s\].
    pub(super) step_s: f64,
    /// Time at which a candidate is compared with the guide point \[s\], not before the end of
    /// the ramp.
    pub(super) judged_s: f64,
}

/// The predicted position of all speeds \[cells\].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Position at speed 0.
    at_rest: Point,
    /// Displacement per speed of 1 m/s, and its length.
    per_speed: Point,
    per_speed_length: f64,
    /// Direction of the robot's x axis, as long as a metre \[cells\].
    ahead: Point,
}

/// The poses of all speeds that are compared with the guide point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Judged {
    at_rest: Point,
    per_speed: Point,
    theta: f64,
}

impl Judged {
    pub(super) fn at(&self, v_mps: f64) -> Pose {
        let place = self.at_rest + self.per_speed * v_mps;
        Pose::new(place.x, place.y, self.theta)
    }
}

/// The poses of one turn rate, beginning with the present one.
#[derive(Clone, Debug, Default)]
pub(super) struct TurnRatePoses {
    places: Vec<Place>,
    /// The core at each of them.
    turned: Vec<Turned>,
    /// Position that is compared with the guide point.
    judged: Place,
    /// The angle turned by then \[rad\].
    judged_turned_rad: f64,
    omega_radps: f64,
}

impl Timing {
    pub(super) fn new(
        prediction: Prediction,
        (start, from): (Pose, Velocity),
        cycle_s: f64,
        [horizon_s, judged_s, longest_step_s]: [f64; 3],
    ) -> Self {
        let ramp_s = if prediction == Prediction::Arcs { cycle_s.min(horizon_s) } else { 0.0 };
        let left_s = horizon_s - ramp_s;
        // A remainder takes at least one step, however long a step may be; a rounding remainder
        // does not.
        let least = if left_s > 1e-12 { 1.0 } else { 0.0 };
        let steps = (left_s / longest_step_s - 1e-9).ceil().max(least);
        let step_s = if steps > 0.0 { left_s / steps } else { 0.0 };
        Self { prediction, start, from, cycle_s, ramp_s, steps: steps as usize, step_s, judged_s }
    }

    pub(super) fn has_ramp(&self) -> bool {
        self.prediction == Prediction::Arcs
    }

    /// Fraction of the cycle that the ramp takes.
    fn ramp_part(&self) -> f64 {
        self.ramp_s / self.cycle_s
    }

    /// The velocity at the end of the ramp.
    pub(super) fn after_ramp(&self, candidate: Velocity) -> Velocity {
        self.from.lerp(candidate, self.ramp_part())
    }

    /// The last predicted pose before a candidate is judged, and the time from there \[s\].
    fn to_judged(self) -> (usize, f64) {
        let after_ramp_s = (self.judged_s - self.ramp_s).max(0.0);
        // At the end of a step no time remains, rounded or not. Without steps, their length is 0,
        // and the quotient is not a number.
        let whole = (after_ramp_s / self.step_s + 1e-9).floor().min(self.steps as f64);
        let steps = if self.steps > 0 { whole } else { 0.0 };
        let left_s = (after_ramp_s - self.step_s * steps).max(0.0);
        (usize::from(self.has_ramp()) + steps as usize, left_s)
    }

    /// The angle turned by the end of a stretch \[rad\].
    fn turned_rad(&self, omega_radps: f64, stretches: usize) -> f64 {
        if !self.has_ramp() {
            return omega_radps * self.step_s * stretches as f64;
        }
        if stretches == 0 {
            return 0.0;
        }
        let reached = self.after_ramp(Velocity::new(0.0, omega_radps)).omega;
        let in_ramp = 0.5 * (self.from.omega + reached) * self.ramp_s;
        in_ramp + omega_radps * self.step_s * (stretches - 1) as f64
    }

    /// Displacement per speed of 1 m/s after the ramp in a time of at most a step.
    fn along(&self, from: Place, omega_radps: f64, duration_s: f64) -> Point {
        let turn_rad = omega_radps * duration_s;
        match self.prediction {
            Prediction::Arcs => {
                turned(from.ahead, unit(0.5 * turn_rad)) * (duration_s * chord(turn_rad))
            }
            Prediction::Euler => from.ahead * duration_s,
        }
    }

    /// The last pose of a candidate.
    pub(super) fn end(&self, candidate: Velocity) -> Pose {
        let ramped = self.start.after_ramp(self.from, self.after_ramp(candidate), self.ramp_s);
        match self.prediction {
            Prediction::Arcs => ramped.after_arc(candidate, self.step_s * self.steps as f64),
            Prediction::Euler => {
                (0..self.steps).fold(ramped, |pose, _| euler_step(pose, candidate, self.step_s))
            }
        }
    }

    /// The pose at a fraction of a stretch that begins at `begin`.
    pub(super) fn between(
        &self,
        stretch: usize,
        begin: Pose,
        candidate: Velocity,
        fraction: f64,
    ) -> Pose {
        if stretch == 0 && self.has_ramp() {
            let to = self.from.lerp(self.after_ramp(candidate), fraction);
            return begin.after_ramp(self.from, to, self.ramp_s * fraction);
        }
        let duration_s = self.step_s * fraction;
        match self.prediction {
            Prediction::Arcs => begin.after_arc(candidate, duration_s),
            Prediction::Euler => euler_step(begin, candidate, duration_s),
        }
    }
}

/// \[You2021, eq. (4)\].
pub(super) fn euler_step(pose: Pose, velocity: Velocity, duration_s: f64) -> Pose {
    let (sin, cos) = libm::sincos(pose.theta);
    let length_m = velocity.v * duration_s;
    let theta = pose.theta + velocity.omega * duration_s;
    Pose::new(pose.x + length_m * cos, pose.y + length_m * sin, theta)
}

impl Place {
    fn at(&self, v_mps: f64) -> Point {
        self.at_rest + self.per_speed * v_mps
    }

    fn measured(self) -> Self {
        Self { per_speed_length: self.per_speed.norm(), ..self }
    }
}

/// Rotates a direction by an angle given as (cosine, sine).
fn turned(direction: Point, by: Point) -> Point {
    Point::new(direction.x * by.x - direction.y * by.y, direction.x * by.y + direction.y * by.x)
}

fn unit(angle_rad: f64) -> Point {
    let (sin, cos) = libm::sincos(angle_rad);
    Point::new(cos, sin)
}

/// The chord of an arc that turns by an angle, as a fraction of its length.
fn chord(turned_rad: f64) -> f64 {
    let half = 0.5 * turned_rad;
    if half.abs() < 1e-6 { 1.0 - half * half / 6.0 } else { libm::sin(half) / half }
}

impl TurnRatePoses {
    /// Fills in the poses of another turn rate, from a position on the grid with the direction
    /// ahead; allocates nothing once it is warm. If nothing is near, only the poses up to the
    /// comparison with the guide point are needed.
    pub(super) fn fill(
        &mut self,
        timing: &Timing,
        start: (Point, Point),
        omega_radps: f64,
        needs_all: bool,
    ) {
        let (judged, left_s) = timing.to_judged();
        let steps_to_judged = judged - usize::from(timing.has_ramp());
        let steps = if needs_all { timing.steps } else { steps_to_judged };
        self.fill_places(timing, start, omega_radps, steps);
        self.fill_judged(timing, judged, left_s);
    }

    /// Rotates the core for some poses and for those before and after them; it is undefined at
    /// all others.
    pub(super) fn turn(&mut self, core: &Core<'_>, poses: &Range<usize>) {
        let count = self.places.len();
        self.turned.resize_with(count, Turned::default);
        let poses = poses.start.saturating_sub(1)..(poses.end + 1).min(count);
        for (turned, place) in self.turned[poses.clone()].iter_mut().zip(&self.places[poses]) {
            turned.turn(core, place.ahead);
        }
    }

    fn fill_places(
        &mut self,
        timing: &Timing,
        (origin, ahead): (Point, Point),
        omega_radps: f64,
        steps: usize,
    ) {
        self.omega_radps = omega_radps;
        self.places.clear();
        let mut place =
            Place { at_rest: origin, per_speed: Point::default(), per_speed_length: 0.0, ahead };
        self.places.push(place);
        if timing.has_ramp() {
            place = after_ramp(place, timing, omega_radps);
            self.places.push(place.measured());
        }
        let turn = unit(omega_radps * timing.step_s);
        let mut along = timing.along(place, omega_radps, timing.step_s);
        self.places.extend((0..steps).map(|_| {
            place.per_speed = place.per_speed + along;
            place.ahead = turned(place.ahead, turn);
            along = turned(along, turn);
            place.measured()
        }));
    }

    fn fill_judged(&mut self, timing: &Timing, index: usize, left_s: f64) {
        let last = self.places[index];
        let along = timing.along(last, self.omega_radps, left_s);
        self.judged = Place { per_speed: last.per_speed + along, ..last };
        self.judged_turned_rad =
            timing.turned_rad(self.omega_radps, index) + self.omega_radps * left_s;
    }

    /// Number of predicted poses.
    pub(super) const fn poses(&self) -> usize {
        self.places.len()
    }

    /// A predicted pose on the grid.
    pub(super) fn placement(&self, index: usize, v_mps: f64) -> Placement<'_> {
        Placement { origin: self.places[index].at(v_mps), turned: &self.turned[index] }
    }

    /// The middle of the positions of all speeds between two at a pose, and the largest distance
    /// of the others from it \[cells\].
    #[inline]
    pub(super) fn line(&self, index: usize, [low_mps, high_mps]: [f64; 2]) -> (Point, f64) {
        let place = &self.places[index];
        let half_mps = 0.5 * (high_mps - low_mps);
        (place.at(0.5 * (low_mps + high_mps)), place.per_speed_length * half_mps)
    }

    /// Vector from this middle to the end \[cells\].
    #[inline]
    pub(super) fn half(&self, index: usize, [low_mps, high_mps]: [f64; 2]) -> Point {
        self.places[index].per_speed * (0.5 * (high_mps - low_mps))
    }

    /// Direction of the robot's x axis at a pose, as long as a metre \[cells\].
    pub(super) fn ahead(&self, index: usize) -> Point {
        self.places[index].ahead
    }

    /// The positions of all speeds between two at a pose \[cells\].
    #[inline]
    pub(super) fn sweep(&self, index: usize, ends_mps: [f64; 2]) -> Sweep<'_> {
        let (origin, half_length) = self.line(index, ends_mps);
        let middle = Placement { origin, turned: &self.turned[index] };
        Sweep { middle, half: self.half(index, ends_mps), half_length }
    }

    /// A predicted pose in the world.
    pub(super) fn pose(
        &self,
        timing: &Timing,
        index: usize,
        v_mps: f64,
        frame: &GridFrame,
    ) -> Pose {
        let world = frame.world_from_grid(self.places[index].at(v_mps));
        let turned_rad = timing.turned_rad(self.omega_radps, index);
        Pose::new(world.x, world.y, timing.start.theta + turned_rad)
    }

    /// The poses at which all speeds are compared with the guide point, in the world.
    pub(super) fn judged(&self, timing: &Timing, frame: &GridFrame) -> Judged {
        let Place { at_rest, per_speed, .. } = self.judged;
        let origin = frame.world_from_grid(at_rest);
        Judged {
            at_rest: origin,
            per_speed: frame.world_from_grid(at_rest + per_speed) - origin,
            theta: timing.start.theta + self.judged_turned_rad,
        }
    }
}

/// The end of the ramp: [`Pose::after_ramp`] for all speeds.
fn after_ramp(mut place: Place, timing: &Timing, omega_radps: f64) -> Place {
    let arcs = f64::from(Pose::RAMP_ARCS);
    let arc_s = timing.ramp_s / arcs;
    let start = place.ahead;
    let mut turned_rad = 0.0;
    for arc in 0..Pose::RAMP_ARCS {
        // Fraction of the candidate in the mean velocity of the arc.
        let share = timing.ramp_part() * (f64::from(arc) + 0.5) / arcs;
        let turn_rad = (timing.from.omega + (omega_radps - timing.from.omega) * share) * arc_s;
        let along = turned(start, unit(turned_rad + 0.5 * turn_rad)) * (arc_s * chord(turn_rad));
        place.at_rest = place.at_rest + along * (timing.from.v * (1.0 - share));
        place.per_speed = place.per_speed + along * share;
        turned_rad += turn_rad;
    }
    place.ahead = turned(start, unit(turned_rad));
    place
}
