//! Arguments of `keyway bench`.

use super::groups::{ConfigArgs, Format, MapLimitArgs, SizeArgs};
use super::terms::{GRID_TERMS, SCALE_TERMS};
use super::values::whole;
use clap::{Args, Subcommand};
use std::path::PathBuf;

pub(super) const BENCH_EXAMPLES: &str = "\
Examples:
  keyway bench grid keyway-demo/rooms.map.scen
  keyway bench scale keyway-demo/small_house.yaml --unknown free --sides 512,1024";

#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Answers the queries of MovingAI scenario files and checks every answer
    Grid(BenchGridArgs),
    /// Plans from corner to corner of a map, tiled to increasing sizes
    Scale(BenchScaleArgs),
}

const SCALE_EXAMPLES: &str = "\
Examples:
  keyway bench scale keyway-demo/small_house.yaml --unknown free --sides 512,1024 --planner astar --planner jps
  keyway bench scale keyway-demo/small_house.yaml --unknown free --sides 512,1024,2048 --planner jps --out scale";

#[derive(Debug, Args)]
#[command(after_help = format!("{SCALE_TERMS}\n\n{SCALE_EXAMPLES}"))]
pub(crate) struct BenchScaleArgs {
    /// Map: ROS map (.yaml), MovingAI (.map) or image (.png, .pgm)
    #[arg(value_name = "MAP")]
    pub(crate) map: PathBuf,
    #[command(flatten)]
    pub(crate) limit: MapLimitArgs,
    /// Sides of the square maps, tiled from mirror images [cells]
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N,...", value_delimiter = ',')]
    #[arg(default_value = "1024,2048,4096", value_parser = whole::<u32, 2, { u32::MAX as u64 }>)]
    pub(crate) sides: Vec<u32>,
    /// Planners (see `keyway list`)
    #[arg(long, alias = "planner", value_name = "NAME,...", value_delimiter = ',')]
    #[arg(default_value = "jps")]
    pub(crate) planners: Vec<String>,
    #[command(flatten)]
    pub(crate) size: SizeArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
    /// Folder for the report and a chart of time and memory
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Measure the first planner and side in this process
    #[arg(long, hide = true)]
    pub(crate) alone: bool,
}

const GRID_EXAMPLES: &str = "\
Examples:
  keyway bench grid keyway-demo/rooms.map.scen
  keyway bench grid keyway-demo/rooms.map.scen --planner astar --planner jps --repeat 5
  keyway bench grid keyway-demo/rooms.map.scen --every 10 --format json";

#[derive(Debug, Args)]
#[command(after_help = format!("{GRID_TERMS}\n\n{GRID_EXAMPLES}"))]
pub(crate) struct BenchGridArgs {
    /// Scenario files, each with its map in the same folder
    #[arg(value_name = "FILE.scen", required = true)]
    pub(crate) scenarios: Vec<PathBuf>,
    /// Planners (see `keyway list`) [default: jps]
    #[arg(long, alias = "planner", value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) planners: Vec<String>,
    /// Answer every query this many times, alternating between planners, and keep the fastest
    /// time of each
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 1)]
    #[arg(value_parser = whole::<u64, 1, 1000>)]
    pub(crate) repeat: u64,
    /// Answer only every K-th query, starting with the first
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "K", default_value_t = 1)]
    #[arg(value_parser = whole::<u64, 1, 1_000_000>)]
    pub(crate) every: u64,
    /// Number of files processed in parallel; values above 1 distort the times
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 1)]
    #[arg(value_parser = whole::<u64, 1, 1024>)]
    pub(crate) jobs: u64,
    /// Folder of the maps [default: that of the scenario file]
    #[arg(long, value_name = "DIR")]
    pub(crate) map_dir: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) limit: MapLimitArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
