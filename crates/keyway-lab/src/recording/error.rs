//! Errors of recordings.

use super::flight::RecordedStep;
use keyway::file_error::ReadError;
use keyway::navigate::RestoreError;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a recording cannot be written, read, or replayed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The recording cannot be written.
    #[error("the recording cannot be written: {0}")]
    Write(#[from] mcap::McapError),
    /// A message cannot be encoded.
    #[error("a message of {topic} cannot be encoded: {reason}")]
    Encode {
        /// Topic of the message.
        topic: String,
        /// Error of the encoder.
        reason: String,
    },
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is no MCAP file.
    #[error("{}: this is not an MCAP file: {reason}", path.display())]
    NoMcap {
        /// The file.
        path: PathBuf,
        /// Error of the reader.
        reason: mcap::McapError,
    },
    /// The file holds no flight.
    #[error(
        "{}: it contains no navigator (topic {}); make recordings for replay with `keyway navigate --record`",
        path.display(), super::flight::SNAPSHOT
    )]
    NoFlight {
        /// The file.
        path: PathBuf,
    },
    /// A message has invalid content.
    #[error("{}: message {index} of {topic}: {reason}", path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// Topic of the message.
        topic: &'static str,
        /// Number of the message among those of its topic, from 0.
        index: u64,
        /// Error of its content.
        reason: String,
    },
    /// The navigator cannot be restored.
    #[error("{}: its navigator cannot be restored: {reason}", path.display())]
    Restore {
        /// The file.
        path: PathBuf,
        /// Error of the restoration.
        reason: RestoreError,
    },
    /// A decision differs from the recorded one.
    #[error(
        "{}: at {stamp_s:.3} s (cycle {cycle}) the decision differs: {recorded} in the recording, {made} now",
        path.display()
    )]
    Differs {
        /// The file.
        path: PathBuf,
        /// Stamp of the last observation before the decision \[s\].
        stamp_s: f64,
        /// Number of the cycle, from 0.
        cycle: u64,
        /// The decision in the recording.
        recorded: RecordedStep,
        /// The decision of this program.
        made: RecordedStep,
    },
}
