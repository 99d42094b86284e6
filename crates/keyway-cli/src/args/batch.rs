//! Arguments of `keyway batch` and `keyway scene`.

use super::groups::Format;
use super::values::Shard;
use clap::{Args, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

pub(super) const SCENE_EXAMPLES: &str = "\
Examples:
  keyway scene barn barn_cylinders.csv --summary barn_summary.csv --out barn
  keyway navigate --scene barn/world_000.toml";

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway batch keyway-demo/small_house.toml --stacks key-point-fusion,s0-key-point --out batch
  keyway batch barn --out barn-results
  keyway batch barn --disturbances noise.toml --seeds 2 --out disturbed
  keyway batch barn --out part-1 --shard 1/2
  keyway batch barn --out part-2 --shard 2/2
  keyway batch barn --out both --from part-1,part-2")]
pub(crate) struct BatchArgs {
    /// Scene files, and folders of them
    #[arg(value_name = "SCENE.toml|DIR", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// The stacks that drive each scene (see `keyway list`), or files with one; `all` [default: that of the scene]
    #[arg(long, value_name = "NAME|FILE.toml,...", value_delimiter = ',')]
    pub(crate) stacks: Vec<String>,
    /// The robot that drives each scene (see `keyway list`), or a file with one [default: that of the scene]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// What keeps the robot from being ideal: a TOML file with the fields of `[disturbances]` of a scene [default: that of
    /// the scene]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) disturbances: Option<PathBuf>,
    /// How many seeds each scene is driven with: its own, and the numbers that follow
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) seeds: u32,
    /// Runs at the same time [default: as many as there are processors]
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    /// Folder for the results; runs that it holds are not made again
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Make the I-th of N parts of the runs only
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Folders of other batches whose runs are taken over
    #[arg(long, value_name = "DIR,...", value_delimiter = ',')]
    pub(crate) from: Vec<PathBuf>,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SceneCommand {
    /// Makes a scene of each world of BARN: a course of 10 m among cylinders that no map shows
    Barn(BarnArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene barn barn_cylinders.csv --out barn
  keyway scene barn barn_cylinders.csv --summary barn_summary.csv --out barn --format json")]
pub(crate) struct BarnArgs {
    /// The cylinders: CSV with the columns `world`, `x`, `y` and `radius` [m]
    #[arg(value_name = "CYLINDERS.csv")]
    pub(crate) cylinders: PathBuf,
    /// The best times: CSV with the columns `world` and `optimal_time_s`
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) summary: Option<PathBuf>,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
