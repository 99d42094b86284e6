//! Times of work, and summaries of many values.

#[cfg(not(target_family = "wasm"))]
use cpu_time::ThreadTime;
use keyway::route::{Stage, StageObserver};
use keyway_sim::metrics::statistics::Sample;
use std::time::{Duration, Instant};

/// Wall-clock and CPU time of a piece of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// Wall-clock time.
    pub wall: Duration,
    /// CPU time of the thread; `None` if the platform does not report it.
    pub cpu: Option<Duration>,
}

impl Times {
    /// Keeps the faster of two times.
    pub fn keep_faster(&mut self, other: Self) {
        self.wall = self.wall.min(other.wall);
        self.cpu = self.cpu.zip(other.cpu).map(|(a, b)| a.min(b));
    }

    /// Wall-clock time \[us\].
    pub fn wall_us(&self) -> f64 {
        micros(self.wall)
    }

    /// CPU time \[us\].
    pub fn cpu_us(&self) -> Option<f64> {
        self.cpu.map(micros)
    }
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// Start of a piece of work in this thread.
struct Begin {
    wall: Instant,
    #[cfg(not(target_family = "wasm"))]
    cpu: Option<ThreadTime>,
}

#[cfg(not(target_family = "wasm"))]
impl Begin {
    fn now() -> Self {
        Self { wall: Instant::now(), cpu: ThreadTime::try_now().ok() }
    }

    fn elapsed(&self) -> Times {
        let cpu = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
        Times { wall: self.wall.elapsed(), cpu }
    }
}

#[cfg(target_family = "wasm")]
impl Begin {
    fn now() -> Self {
        Self { wall: Instant::now() }
    }

    fn elapsed(&self) -> Times {
        Times { wall: self.wall.elapsed(), cpu: None }
    }
}

/// Runs a piece of work in this thread, and returns its times.
pub fn timed<R>(work: impl FnOnce() -> R) -> (R, Times) {
    let begin = Begin::now();
    let result = work();
    (result, begin.elapsed())
}

/// Like [`timed`] if `has_times`; otherwise no clock is read.
pub fn timed_if<R>(has_times: bool, work: impl FnOnce() -> R) -> (R, Option<Times>) {
    if !has_times {
        return (work(), None);
    }
    let (result, times) = timed(work);
    (result, Some(times))
}

/// Returns a clock that counts the seconds since this call.
pub fn wall_clock() -> impl Fn() -> f64 {
    let begin = Instant::now();
    move || begin.elapsed().as_secs_f64()
}

/// Times of the stages of the last route that was completed in this thread.
pub struct StageTimer {
    has_times: bool,
    begin: Option<Begin>,
    /// Search time; `None` before the first search has ended, and without times.
    pub search: Option<Times>,
    /// Smoothing time; `None` before the first smoothing has ended, and without times.
    pub smoothing: Option<Times>,
}

impl StageTimer {
    /// Returns a timer that has measured nothing; it reads no clock unless `has_times`.
    pub const fn new(has_times: bool) -> Self {
        Self { has_times, begin: None, search: None, smoothing: None }
    }
}

impl StageObserver for StageTimer {
    fn begin(&mut self, _stage: Stage) {
        self.begin = self.has_times.then(Begin::now);
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

/// Mean; `None` without values.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// [`Sample::quantile`] of the values; `None` without values.
pub fn quantile(values: Vec<f64>, share: f64) -> Option<f64> {
    Sample::new(values).ok().map(|sample| sample.quantile(share))
}

/// Mean of values, and the range of most of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: Option<f64>,
    /// Quantile of 0.05.
    pub p5: Option<f64>,
    /// Quantile of 0.95.
    pub p95: Option<f64>,
}

impl Spread {
    /// Returns the spread of a sample.
    pub fn of(sample: &Sample) -> Self {
        let [p5, p95] = [0.05, 0.95].map(|share| Some(sample.quantile(share)));
        Self { mean: Some(sample.mean()), p5, p95 }
    }

    /// Returns the spread of the values; all `None` without values.
    pub fn of_values(values: Vec<f64>) -> Self {
        Sample::new(values).map(|sample| Self::of(&sample)).unwrap_or_default()
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
        assert_eq!(quantile(vec![4.0, 2.0, 1.0, 3.0], 0.5), Some(2.5));
        assert_eq!(quantile(vec![1.0, 5.0, 3.0], 0.5), Some(3.0));
        assert_eq!((quantile(vec![], 0.5), quantile(vec![7.0], 0.99)), (None, Some(7.0)));
        // Of the 21 numbers 0 to 20, the quantile of 0.05 is the second one; of 1 to 4, that of
        // 0.95 is at position 2.85, between 3 and 4.
        let spread = Spread::of_values((0..=20).rev().map(f64::from).collect());
        let expected = Spread { mean: Some(10.0), p5: Some(1.0), p95: Some(19.0) };
        assert_eq!((spread, Spread::of_values(Vec::new())), (expected, Spread::default()));
        let four = Spread::of_values(vec![1.0, 2.0, 3.0, 4.0]);
        let off = [four.p5.unwrap() - 1.15, four.p95.unwrap() - 3.85];
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{four:?}");
    }
}
