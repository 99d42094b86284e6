//! How long work takes, and what many numbers say together.

use cpu_time::ThreadTime;
use keyway::route::{Stage, StageObserver};
use std::time::{Duration, Instant};

/// Wall clock and CPU time of a piece of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Times {
    pub(crate) wall: Duration,
    /// `None` where the platform does not report it.
    pub(crate) cpu: Option<Duration>,
}

impl Times {
    /// The fastest time of repeated work counts.
    pub(crate) fn keep_faster(&mut self, other: Self) {
        self.wall = self.wall.min(other.wall);
        self.cpu = self.cpu.zip(other.cpu).map(|(a, b)| a.min(b));
    }

    pub(crate) fn wall_us(&self) -> f64 {
        micros(self.wall)
    }

    pub(crate) fn cpu_us(&self) -> Option<f64> {
        self.cpu.map(micros)
    }
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The beginning of a piece of work in this thread.
struct Begin {
    wall: Instant,
    cpu: Option<ThreadTime>,
}

impl Begin {
    fn now() -> Self {
        Self { wall: Instant::now(), cpu: ThreadTime::try_now().ok() }
    }

    fn elapsed(&self) -> Times {
        let cpu = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
        Times { wall: self.wall.elapsed(), cpu }
    }
}

/// Does a piece of work in this thread.
pub(crate) fn timed<R>(work: impl FnOnce() -> R) -> (R, Times) {
    let begin = Begin::now();
    let result = work();
    (result, begin.elapsed())
}

/// Seconds since this call.
pub(crate) fn wall_clock() -> impl Fn() -> f64 {
    let begin = Instant::now();
    move || begin.elapsed().as_secs_f64()
}

/// How long the last stage of a route took that ended in this thread.
#[derive(Default)]
pub(crate) struct StageTimer {
    begin: Option<Begin>,
    /// `None` before the first search has ended.
    pub(crate) search: Option<Times>,
    /// `None` before the first smoothing has ended.
    pub(crate) smoothing: Option<Times>,
}

impl StageObserver for StageTimer {
    fn begin(&mut self, _stage: Stage) {
        self.begin = Some(Begin::now());
    }

    fn end(&mut self, stage: Stage) {
        let times = self.begin.take().map(|begin| begin.elapsed());
        match stage {
            Stage::Search => self.search = times,
            Stage::Smoothing => self.smoothing = times,
            _ => {}
        }
    }
}

pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The smallest of the sorted values that at least this share of them does not exceed.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

/// Mean of values, and between what most of them lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    pub(crate) mean: Option<f64>,
    /// 5 % of the values are this or less, 95 % the other one or less.
    pub(crate) p5: Option<f64>,
    pub(crate) p95: Option<f64>,
}

impl Spread {
    pub(crate) fn of(mut values: Vec<f64>) -> Self {
        let mean = mean(&values);
        values.sort_by(f64::total_cmp);
        Self { mean, p5: quantile(&values, 0.05), p95: quantile(&values, 0.95) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_repetition_counts() {
        let micros = Duration::from_micros;
        let mut times = Times { wall: micros(5), cpu: Some(micros(4)) };
        times.keep_faster(Times { wall: micros(3), cpu: Some(micros(9)) });
        times.keep_faster(Times { wall: micros(8), cpu: Some(micros(2)) });
        assert_eq!((times.wall_us(), times.cpu_us()), (3.0, Some(2.0)));
    }

    #[test]
    fn means_and_quantiles_by_hand() {
        assert_eq!((mean(&[1.0, 2.0, 6.0]), mean(&[])), (Some(3.0), None));
        assert_eq!(quantile(&[1.0, 2.0, 3.0, 4.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[1.0, 2.0, 3.0, 4.0], 0.99), Some(4.0));
        assert_eq!((quantile(&[], 0.5), quantile(&[7.0], 0.5)), (None, Some(7.0)));
        let spread = Spread::of((1..=100).rev().map(f64::from).collect());
        let expected = Spread { mean: Some(50.5), p5: Some(5.0), p95: Some(95.0) };
        assert_eq!((spread, Spread::of(Vec::new())), (expected, Spread::default()));
    }
}
