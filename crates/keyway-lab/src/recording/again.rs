//! Reads a flight recording and repeats its decisions.

use super::RecordingError;
use super::flight::{OBSERVATION, RecordedObservation, RecordedStep, SNAPSHOT, STEP};
use super::messages::for_each_message;
use keyway::file_system::read_file;
use keyway::navigate::{Navigator, Snapshot};
use keyway_sim::episode::Cycle;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Summary of a replayed flight, in which every decision was as recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Flight {
    /// Number of decisions.
    pub cycles: u64,
    /// Number of snapshots from which the navigator was restored: at the beginning, and after
    /// changes.
    pub snapshots: u64,
    /// False if the recording was not finished, or is truncated.
    pub is_complete: bool,
}

/// Upper bound of the size of a recording: more than a day.
const MAX_BYTES: u64 = 1 << 36;

/// Repeats the decisions of a recording, and passes each to `watch`. The whole file is held in
/// memory.
///
/// # Errors
/// Returns [`RecordingError`] if the file cannot be read or holds no flight, or at the first
/// decision that differs.
pub fn decide_again(
    path: &Path,
    watch: &mut dyn FnMut(&Cycle<'_>),
) -> Result<Flight, RecordingError> {
    let bytes = read_file(path, MAX_BYTES)?;
    let no_mcap = |reason| RecordingError::NoMcap { path: path.to_owned(), reason };
    let mut pilot = Pilot::new(path);
    let is_complete = for_each_message(&bytes, no_mcap, |topic, data| match topic {
        SNAPSHOT => pilot.take_up(data),
        OBSERVATION => pilot.observe(data),
        STEP => pilot.step(data, watch),
        _ => Ok(()),
    })?;
    if pilot.navigator.is_none() {
        return Err(RecordingError::NoFlight { path: path.to_owned() });
    }
    Ok(Flight { is_complete, ..pilot.flight })
}

/// A navigator that is fed with a recording.
struct Pilot<'a> {
    path: &'a Path,
    navigator: Option<Navigator>,
    flight: Flight,
    observations: u64,
    /// The last observation.
    observed: Option<RecordedObservation>,
    /// Stamp of the first observation \[s\].
    begin_s: Option<f64>,
}

impl<'a> Pilot<'a> {
    fn new(path: &'a Path) -> Self {
        let flight = Flight::default();
        Self { path, navigator: None, flight, observations: 0, observed: None, begin_s: None }
    }

    fn take_up(&mut self, bytes: &[u8]) -> Result<(), RecordingError> {
        let snapshot: Snapshot = self.cbor((SNAPSHOT, self.flight.snapshots), bytes)?;
        let restored = Navigator::restore(snapshot);
        let path = || self.path.to_owned();
        let restored =
            restored.map_err(|reason| RecordingError::Restore { path: path(), reason })?;
        self.navigator = Some(restored);
        self.flight.snapshots += 1;
        Ok(())
    }

    fn observe(&mut self, bytes: &[u8]) -> Result<(), RecordingError> {
        let observation: RecordedObservation =
            self.cbor((OBSERVATION, self.observations), bytes)?;
        self.observations += 1;
        if let Some(navigator) = &mut self.navigator {
            observation.with(|observation| navigator.observe(observation));
        }
        self.begin_s = self.begin_s.or(Some(observation.stamp_s));
        self.observed = Some(observation);
        Ok(())
    }

    fn step(
        &mut self,
        bytes: &[u8],
        watch: &mut dyn FnMut(&Cycle<'_>),
    ) -> Result<(), RecordingError> {
        let index = self.flight.cycles;
        let fault = |reason: serde_json::Error| RecordingError::Message {
            path: self.path.to_owned(),
            topic: STEP,
            index,
            reason: reason.to_string(),
        };
        let recorded: RecordedStep = serde_json::from_slice(bytes).map_err(fault)?;
        let Some(navigator) = &mut self.navigator else { return Ok(()) };
        let step = navigator.step();
        let made = RecordedStep::of(&step);
        let stamp_s = self.observed.as_ref().map_or(0.0, |observed| observed.stamp_s);
        if !made.is_same(&recorded) {
            let path = self.path.to_owned();
            return Err(RecordingError::Differs { path, stamp_s, cycle: index, recorded, made });
        }
        self.flight.cycles += 1;
        let t_s = stamp_s - self.begin_s.unwrap_or(stamp_s);
        if let Some(observed) = &self.observed {
            observed.with(|observation| {
                watch(&Cycle { index, t_s, observation, step: &step, navigator });
            });
        }
        Ok(())
    }

    fn cbor<T: DeserializeOwned>(
        &self,
        (topic, index): (&'static str, u64),
        bytes: &[u8],
    ) -> Result<T, RecordingError> {
        ciborium::from_reader(bytes).map_err(|reason| {
            let path = self.path.to_owned();
            RecordingError::Message { path, topic, index, reason: reason.to_string() }
        })
    }
}
