//! Data kept during a run for pictures, animations and explanations.

use super::recording::Recording;
use crate::commands::why;
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::local::Explanation;
use keyway::map::{BitGrid, Cell};
use keyway::navigate::{NavigateError, Navigator};
use keyway::route::Route;
use keyway::sense::{Mover, Observation};
use keyway_lab::recording::RecordingError;
use keyway_sim::episode::{Cycle, CycleReport, EpisodeObserver};
use keyway_sim::sim::Run;
use std::sync::Arc;

/// Requested data of a run beyond its report.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted {
    /// An explanation of every cycle.
    pub(crate) explanations: bool,
    /// The candidates at this time \[s\].
    pub(crate) fan_s: Option<f64>,
    /// Moments of an animation.
    pub(crate) film: bool,
    /// A recording of all observations and decisions.
    pub(crate) recording: bool,
}

/// One moment of a run.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) t_s: f64,
    pub(crate) pose: Pose,
    pub(crate) velocity: Velocity,
    pub(crate) guide: Point,
    /// Hit points of the scan.
    pub(crate) hits: Vec<Point>,
    /// Cells sensed so far, in ascending order.
    pub(crate) sensed: Vec<Cell>,
    pub(crate) route: Arc<Polyline>,
    /// Moving obstacles, as estimated by the robot.
    pub(crate) movers: Vec<Mover>,
    /// Obstacles that the robot detours around.
    pub(crate) walked: Vec<Disc>,
    pub(crate) explanation: Explanation,
}

/// Keeps data for pictures that reports lack, and the remedy if there is no route.
#[derive(Default)]
pub(crate) struct Watcher {
    wanted: Wanted,
    pub(crate) route: Option<Route>,
    pub(crate) sensed: Option<BitGrid>,
    pub(crate) why: Option<String>,
    /// JSON Lines.
    pub(crate) explanations: String,
    pub(crate) fan: Option<Moment>,
    pub(crate) film: Film,
    /// All obstacles that were detoured around at some time.
    pub(crate) walked: Vec<Disc>,
    recording: Option<Recording>,
    /// The route with this number as a line, shared by many moments.
    path: Option<(u32, Arc<Polyline>)>,
}

/// Moments at equal intervals, bounded in number although the duration of the run is unknown.
#[derive(Default)]
pub(crate) struct Film {
    pub(crate) moments: Vec<Moment>,
    /// Number of times the interval was doubled: it is two to this power, in cycles.
    halvings: u32,
}

impl Film {
    /// Maximum number of moments.
    const MOST: usize = 120;

    const fn is_due(&self, cycle: u64) -> bool {
        cycle.is_multiple_of(1 << self.halvings)
    }

    /// Adds a moment. If there are too many, every other one is dropped.
    fn push(&mut self, cycle: u64, moment: Moment) {
        if self.moments.len() == Self::MOST {
            self.halvings += 1;
            let mut is_kept = false;
            self.moments.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }
        if self.is_due(cycle) {
            self.moments.push(moment);
        }
    }
}

impl Watcher {
    pub(crate) fn new(wanted: Wanted) -> Self {
        let recording = wanted.recording.then(Recording::default);
        Self { wanted, recording, ..Self::default() }
    }

    /// Returns the recording as a file, if one was requested.
    ///
    /// # Errors
    /// Returns [`RecordingError`] if it could not be written.
    pub(crate) fn recorded(&mut self) -> Result<Option<Vec<u8>>, RecordingError> {
        self.recording.take().map(Recording::finish).transpose()
    }

    fn moment(&mut self, cycle: &Cycle<'_>, explanation: Explanation) -> Moment {
        let Cycle { t_s, observation, navigator, .. } = *cycle;
        let Observation { pose, velocity, scans, .. } = *observation;
        let number = navigator.routes_planned();
        let known = self.path.take().filter(|(of, _)| *of == number);
        let mut sensed: Vec<Cell> = navigator.sensed().ones().collect();
        sensed.sort_unstable();
        let path =
            || navigator.route().map_or_else(Polyline::default, |route| route.smoothed.clone());
        let (_, route) = self.path.insert(known.unwrap_or_else(|| (number, Arc::new(path()))));
        Moment {
            t_s,
            pose,
            velocity,
            guide: navigator.guidance().map_or(pose.point(), |guidance| guidance.point),
            hits: scans.iter().flat_map(|one| one.scan.hits(pose.compose(one.mount))).collect(),
            sensed,
            route: Arc::clone(route),
            movers: navigator.movers().to_vec(),
            walked: navigator.gone_around().to_vec(),
            explanation,
        }
    }

    fn note_walked(&mut self, navigator: &Navigator) {
        for disc in navigator.gone_around() {
            if !self.walked.contains(disc) {
                self.walked.push(*disc);
            }
        }
    }
}

impl EpisodeObserver for Watcher {
    fn no_route(&mut self, error: &NavigateError) {
        if let NavigateError::Plan(error) = error {
            self.why = Some(why(error));
        }
    }

    fn started(&mut self, navigator: &Navigator) {
        self.route = navigator.route().cloned();
        if let Some(recording) = &mut self.recording {
            recording.note(|recorder| recorder.begin(0.0, navigator));
        }
    }

    fn decided(&mut self, cycle: &Cycle<'_>) {
        self.note_walked(cycle.navigator);
        if let Some(recording) = &mut self.recording {
            recording.note(|recorder| {
                recorder.observed(cycle.observation)?;
                recorder.stepped(cycle.step, cycle.navigator)
            });
        }
        let is_fan_due =
            self.fan.is_none() && self.wanted.fan_s.is_some_and(|fan_s| cycle.t_s >= fan_s - 1e-9);
        let is_frame_due = self.wanted.film && self.film.is_due(cycle.index);
        // The explanation costs more than the decision: compute it only if needed.
        if !(self.wanted.explanations || is_fan_due || is_frame_due) {
            return;
        }
        let explanation = cycle.navigator.explain();
        if self.wanted.explanations {
            let report = CycleReport::of(cycle, &explanation);
            // Plain data with string keys: this cannot fail.
            self.explanations += &serde_json::to_string(&report).unwrap_or_default();
            self.explanations.push('\n');
        }
        if is_fan_due || is_frame_due {
            let moment = self.moment(cycle, explanation);
            if is_fan_due {
                self.fan = Some(moment.clone());
            }
            if is_frame_due {
                self.film.push(cycle.index, moment);
            }
        }
    }

    fn ended(&mut self, _run: &Run, navigator: &Navigator) {
        self.sensed = Some(navigator.sensed().clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(cycle: u64) -> Moment {
        Moment {
            t_s: cycle as f64,
            pose: Pose::default(),
            velocity: Velocity::ZERO,
            guide: Point::default(),
            hits: Vec::new(),
            sensed: Vec::new(),
            route: Arc::default(),
            movers: Vec::new(),
            walked: Vec::new(),
            explanation: Explanation::default(),
        }
    }

    #[test]
    fn a_film_has_moments_at_equal_intervals_however_long_it_is() {
        for cycles in [1, 119, 120, 121, 240, 241, 999, 12_345] {
            let mut film = Film::default();
            for cycle in 0..cycles {
                if film.is_due(cycle) {
                    film.push(cycle, moment(cycle));
                }
            }
            let count = film.moments.len();
            assert!(count <= Film::MOST && count as u64 >= cycles.min(60), "{cycles}: {count}");
            let step = f64::from(1 << film.halvings);
            assert!(film.moments.iter().enumerate().all(|(i, one)| one.t_s == i as f64 * step));
            assert!((cycles - 1) as f64 - film.moments[count - 1].t_s < step);
        }
    }
}
