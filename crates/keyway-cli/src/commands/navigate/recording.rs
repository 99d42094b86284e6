//! A flight recorder in memory.

use keyway_lab::recording::{FlightRecorder, RecordingError};
use std::io::Cursor;

type Recorder = FlightRecorder<Cursor<Vec<u8>>>;

/// A recording, or the error that ended it.
pub(super) struct Recording(Result<Recorder, RecordingError>);

impl Default for Recording {
    fn default() -> Self {
        Self(FlightRecorder::new(Cursor::default()))
    }
}

impl Recording {
    /// Records something; after the first error, all calls are ignored.
    pub(super) fn note(&mut self, note: impl FnOnce(&mut Recorder) -> Result<(), RecordingError>) {
        if let Ok(recorder) = &mut self.0
            && let Err(error) = note(recorder)
        {
            self.0 = Err(error);
        }
    }

    /// Returns the bytes of the file.
    pub(super) fn finish(self) -> Result<Vec<u8>, RecordingError> {
        Ok(self.0?.finish()?.into_inner())
    }
}
