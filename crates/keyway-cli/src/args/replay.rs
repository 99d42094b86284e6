//! Arguments of `keyway replay`, and those that it shares with `keyway navigate`.

use super::groups::{Format, MapLimitArgs};
use super::values::{AnimationFile, seconds};
use clap::Args;
use std::path::{Path, PathBuf};

/// What a drive leaves.
#[derive(Clone, Debug, Args)]
pub(crate) struct DriveFileArgs {
    /// Folder for report, pictures and trajectory
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Draw, into the folder of --out, the velocities that the local planner tried at this
    /// simulated time, and what became of them [s]
    #[arg(long, value_name = "S", requires = "out", allow_hyphen_values = true)]
    #[arg(value_parser = seconds)]
    pub(crate) fan: Option<f64>,
    /// Write into this file why each velocity was chosen, and what would free a robot that cannot
    /// drive: JSON, a line for every cycle
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) explain: Option<PathBuf>,
    /// Play the drive into this file: the robot, what it sees, and what it tries
    #[arg(long, value_name = "FILE.gif|.apng")]
    pub(crate) animate: Option<AnimationFile>,
    /// Record everything that the robot observes and decides into this file, which Foxglove,
    /// Lichtblick and rosbag2 open, and `keyway replay` decides again
    #[arg(long, value_name = "FILE.mcap", value_parser = recording)]
    pub(crate) record: Option<PathBuf>,
}

/// A name by which a recording is known as one.
fn recording(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_one = ReplayArgs::is_recording(&path);
    if is_one { Ok(path) } else { Err("expected the name of a file that ends in .mcap".to_owned()) }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Each run is made again and compared with its record: outcome and trajectory must be the same. With --out, each has a folder
of its own in DIR, named like its record. Of a recording that `keyway navigate --record` or a robot made, every decision is
made again from what was observed, and must be the same.

Examples:
  keyway batch keyway-demo/small_house.toml --keep all --out recorded
  keyway replay recorded/records/small_house.keyway.0.json --out replayed --fan 12
  keyway replay recorded/records/small_house.keyway.0.json --explain why.jsonl --animate drive.gif
  keyway navigate --scene keyway-demo/small_house.toml --record run.mcap
  keyway replay run.mcap")]
pub(crate) struct ReplayArgs {
    /// Records that `keyway batch --keep` stored, or recordings
    #[arg(value_name = "RECORD.json|.mcap", required = true)]
    pub(crate) records: Vec<PathBuf>,
    /// Folder of the maps, instead of those where they were when the runs were recorded
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
    /// True for the name of a recording.
    pub(crate) fn is_recording(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
    }
}
