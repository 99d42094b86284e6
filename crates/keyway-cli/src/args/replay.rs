//! Arguments of `keyway replay`, some of them shared with `keyway navigate`.

use super::groups::{Format, MapLimitArgs};
use super::values::{AnimationFile, seconds};
use clap::Args;
use std::path::{Path, PathBuf};

/// Output files of a drive.
#[derive(Clone, Debug, Args)]
pub(crate) struct DriveFileArgs {
    /// Folder for report, pictures and trajectory
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw the candidate velocities of the local planner at this simulated time, and their
    /// evaluation, into the folder of --out [s]
    #[arg(long, value_name = "S", requires = "out", allow_hyphen_values = true)]
    #[arg(value_parser = seconds)]
    pub(crate) fan: Option<f64>,
    /// Write the reasons for each chosen velocity into this file, and what to change if the robot
    /// cannot drive: one line of JSON per cycle
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) explain: Option<PathBuf>,
    /// Write an animation of the drive into this file: the robot, its scans and its candidates
    #[arg(long, value_name = "FILE.gif|.apng")]
    pub(crate) animate: Option<AnimationFile>,
    /// Record all observations and decisions of the robot in this file; Foxglove, Lichtblick and
    /// rosbag2 can open it, and `keyway replay` recomputes the decisions
    #[arg(long, value_name = "FILE.mcap", value_parser = recording)]
    pub(crate) record: Option<PathBuf>,
}

/// Parses the name of a recording: it must end in `.mcap`.
fn recording(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_one = ReplayArgs::is_recording(&path);
    if is_one { Ok(path) } else { Err("expected a file name that ends in .mcap".to_owned()) }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Each run is recomputed and compared with its record: outcome and trajectory must be the same. With --out, each run gets a
folder in DIR, named like its record. Of a recording, made by `keyway navigate --record` or by a robot, every decision is
recomputed from the recorded observations, and must be the same.

Examples:
  keyway batch keyway-demo/small_house.toml --keep all --out recorded
  keyway replay recorded/records/small_house.keyway.0.json --out replayed --fan 12
  keyway replay recorded/records/small_house.keyway.0.json --explain why.jsonl --animate drive.gif
  keyway navigate --scene keyway-demo/small_house.toml --record run.mcap
  keyway replay run.mcap")]
pub(crate) struct ReplayArgs {
    /// Records stored by `keyway batch --keep`, or recordings
    #[arg(value_name = "RECORD.json|.mcap", required = true)]
    pub(crate) records: Vec<PathBuf>,
    /// Folder of the maps [default: their folders at the time of recording]
    #[arg(long, value_name = "DIR")]
    pub(crate) map_dir: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) limit: MapLimitArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) files: DriveFileArgs,
}

impl ReplayArgs {
    /// True if the file name is that of a recording.
    pub(crate) fn is_recording(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
    }
}
