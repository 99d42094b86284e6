//! Estimation of the actuation delay from the motion of the robot.
//!
//! # Method
//! A bank of models, one for each possible delay, in steps of half a cycle. All are driven by the
//! same commands, within the robot's limits, and predict the velocity of the robot if their delay
//! is the true one. The squared errors of each model are summed up. The estimate is the minimum
//! of these sums, refined by the parabola through its neighbours. Samples at which all models
//! have the same velocity carry no information and are skipped.
//!
//! A first-order lag of the wheels acts like a delay: it follows a steadily changing speed with a
//! delay of its time constant. One number is therefore enough.
//!
//! # Evidence
//! Let s² be the mean squared error of the best model, bounded below by that of a hundredth of
//! full speed. A delay is rejected if its sum of squares exceeds the best one by 2 s²
//! [`DelayFilter::EVIDENCE`]. The best delay is learned once both the described one and the
//! longest one are rejected, so that the robot has been seen to follow its commands. Nothing is
//! learned from a robot that does not.

use super::under_way::UnderWay;
use crate::geometry::Velocity;
use crate::navigate::time::Time;
use serde::{Deserialize, Serialize};

/// The bank of models.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DelayFilter {
    /// Delay of the first model \[s\]; each further model adds one step.
    first_s: f64,
    step_s: f64,
    /// Index of the model that has the described delay.
    described: usize,
    models: Vec<Model>,
    /// Number of samples that counted, with exponential forgetting.
    samples: f64,
    last: Option<Time>,
    learned_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Model {
    /// Velocity at the last observation.
    velocity: Velocity,
    /// Velocity at the observation before.
    before: Velocity,
    /// Sum of its squared errors, as shares of the full speed and the full turn rate.
    off_sq: f64,
}

/// A measured velocity.
#[derive(Clone, Copy, Debug)]
pub(super) enum Measured {
    /// Present velocity.
    Now(Velocity),
    /// Mean velocity since the last observation.
    OnMean(Velocity),
}

impl Measured {
    const fn velocity(self) -> Velocity {
        match self {
            Self::Now(velocity) | Self::OnMean(velocity) => velocity,
        }
    }
}

impl Model {
    /// The corresponding velocity of this model.
    fn expected(&self, measured: Measured) -> Velocity {
        match measured {
            Measured::Now(_) => self.velocity,
            Measured::OnMean(_) => self.before.lerp(self.velocity, 0.5),
        }
    }
}

impl DelayFilter {
    /// Largest delay that is considered, beyond the described one \[s\].
    const LONGER_S: f64 = 1.0;

    /// Maximum number of models.
    const MOST: f64 = 80.0;

    /// Longest time between observations that can be bridged \[s\].
    const GAP_S: f64 = 0.5;

    /// Number of samples after which the weight of a sample has halved.
    const HALF_LIFE: f64 = 200.0;

    /// Smallest spread of the models that carries information, as a share of full speed.
    const SPREAD: f64 = 0.02;

    /// Lower bound on the error of the best model, as a share of full speed.
    const LEAST_OFF: f64 = 0.01;

    /// Largest error of a robot that still follows its commands.
    const MOST_OFF: f64 = 0.15;

    /// Logarithm of the likelihood ratio that rejects a delay.
    const EVIDENCE: f64 = 12.0;

    pub(super) fn new(described_s: f64, cycle_s: f64) -> Self {
        let longest_s = described_s + Self::LONGER_S;
        let step_s = (0.5 * cycle_s).max(longest_s / Self::MOST);
        let described = (described_s / step_s) as usize;
        let first_s = (described_s - described as f64 * step_s).max(0.0);
        let count = described + (Self::LONGER_S / step_s).ceil() as usize + 1;
        let model = Model { velocity: Velocity::ZERO, before: Velocity::ZERO, off_sq: 0.0 };
        let models = vec![model; count];
        Self { first_s, step_s, described, models, samples: 0.0, last: None, learned_s: None }
    }

    /// The delay of a model \[s\].
    fn delay_s(&self, model: usize) -> f64 {
        self.first_s + model as f64 * self.step_s
    }

    /// The longest delay of a model \[s\].
    pub(super) fn longest_s(&self) -> f64 {
        self.delay_s(self.models.len() - 1)
    }

    /// The learned delay, if the described one is wrong \[s\].
    pub(super) const fn learned_s(&self) -> Option<f64> {
        self.learned_s
    }

    /// The velocity that the commands produce in a robot with a delay.
    pub(super) fn velocity(&self, delay_s: f64) -> Velocity {
        let place =
            ((delay_s - self.first_s) / self.step_s).clamp(0.0, self.models.len() as f64 - 1.0);
        let (below, above) = (place.floor() as usize, place.ceil() as usize);
        let [below_v, above_v] = [below, above].map(|at| self.models[at].velocity);
        below_v.lerp(above_v, place - below as f64)
    }

    /// Interrupts the sequence: the next observation does not follow from the last one.
    pub(super) fn pause(&mut self) {
        self.last = None;
    }

    /// True if another bank has the same models, and the learned delay of this one is within
    /// their range.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let of = |it: &Self| (it.first_s, it.step_s, it.described, it.models.len());
        let is_possible = |delay_s: f64| (0.0..=self.longest_s()).contains(&delay_s);
        of(self) == of(other) && self.learned_s.is_none_or(is_possible)
    }

    /// Takes in an observation; without a measurement, the models advance all the same.
    pub(super) fn observe(&mut self, time: Time, measured: Option<Measured>, under_way: &UnderWay) {
        let elapsed_s = self.last.map(|last| time.since_s(last));
        let Some((last, elapsed_s)) = self.last.zip(elapsed_s).filter(|it| it.1 <= Self::GAP_S)
        else {
            let velocity = measured.map_or(Velocity::ZERO, Measured::velocity);
            self.models.iter_mut().for_each(|model| model.velocity = velocity);
            self.last = Some(time);
            return;
        };
        if elapsed_s <= 0.0 {
            return;
        }
        self.last = Some(time);
        for index in 0..self.models.len() {
            let delay_s = self.delay_s(index);
            let model = &mut self.models[index];
            model.before = model.velocity;
            model.velocity = under_way.velocity_after((last, time), delay_s, model.before);
        }
        let Some(measured) = measured else { return };
        let full = under_way.full();
        let parts = |velocity: Velocity| [velocity.v / full.v, velocity.omega / full.omega];
        let spread = self
            .models
            .iter()
            .fold(Spread::default(), |spread, model| spread.with(parts(model.expected(measured))));
        if spread.largest() < Self::SPREAD {
            return;
        }
        let kept = 1.0 - std::f64::consts::LN_2 / Self::HALF_LIFE;
        self.samples = self.samples * kept + 1.0;
        let seen = parts(measured.velocity());
        for model in &mut self.models {
            let expected = parts(model.expected(measured));
            let off = (0..2).map(|axis| bounded_sq(expected[axis] - seen[axis])).sum::<f64>();
            model.off_sq = model.off_sq * kept + off;
        }
        self.learn();
    }

    fn learn(&mut self) {
        const FEWEST: f64 = 3.0;
        if self.samples < FEWEST {
            return;
        }
        let all = self.models.iter().enumerate();
        let best = all.min_by(|a, b| a.1.off_sq.total_cmp(&b.1.off_sq)).map_or(0, |it| it.0);
        let mean_sq = self.models[best].off_sq / self.samples;
        if mean_sq > Self::MOST_OFF * Self::MOST_OFF {
            return;
        }
        let noise_sq = mean_sq.max(Self::LEAST_OFF * Self::LEAST_OFF);
        let against =
            |at: usize| (self.models[at].off_sq - self.models[best].off_sq) / (2.0 * noise_sq);
        if against(self.described) < 0.25 * Self::EVIDENCE {
            self.learned_s = None;
            return;
        }
        let is_possible = |&at: &usize| against(at) < Self::EVIDENCE;
        let last = self.models.len() - 1;
        let (low, high) = (
            (0..=last).find(is_possible).unwrap_or(best),
            (0..=last).rev().find(is_possible).unwrap_or(best),
        );
        if is_possible(&self.described) || high == last {
            return;
        }
        let is_alone = low == best && high == best;
        let beside = if is_alone { 0.0 } else { self.beside(best) };
        self.learned_s = Some(self.delay_s(best) + beside * self.step_s);
    }

    /// The minimum of the parabola through a model and its neighbours, in steps from the model.
    fn beside(&self, best: usize) -> f64 {
        if best == 0 || best + 1 == self.models.len() {
            return 0.0;
        }
        let [below, at, above] = [best - 1, best, best + 1].map(|it| self.models[it].off_sq);
        let bend = below - 2.0 * at + above;
        if bend > 0.0 { (0.5 * (below - above) / bend).clamp(-0.5, 0.5) } else { 0.0 }
    }
}

/// A square, bounded so that a push on the robot has limited weight.
fn bounded_sq(part: f64) -> f64 {
    const MOST_SQ: f64 = 0.09;
    let square = part * part;
    square * MOST_SQ / (square + MOST_SQ)
}

/// The lowest and the highest values of both axes.
#[derive(Clone, Copy, Debug)]
struct Spread {
    low: [f64; 2],
    high: [f64; 2],
}

impl Default for Spread {
    fn default() -> Self {
        Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] }
    }
}

impl Spread {
    fn with(mut self, values: [f64; 2]) -> Self {
        for (axis, value) in values.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
        self
    }

    fn largest(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}
