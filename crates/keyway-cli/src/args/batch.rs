//! Arguments of `keyway batch` and `keyway scene`.

use super::groups::{Format, ReachedByArg};
use super::values::{shard, whole};
use clap::{Args, Subcommand, ValueEnum};
use keyway::files::Assignment;
use keyway::map::MAX_CELLS;
use keyway::map::formats::DEFAULT_MAX_CELLS;
use keyway_lab::batch::{BatchRequest, Shard};
use std::path::PathBuf;

const LEAST_SEEDS: u64 = *BatchRequest::SEEDS.start();
const MOST_SEEDS: u64 = *BatchRequest::SEEDS.end();

pub(super) const SCENE_EXAMPLES: &str = "\
Examples:
  keyway scene barn barn_cylinders.csv --summary barn_summary.csv --out barn
  keyway navigate --scene barn/barn_000.toml
  keyway scene dynabarn dynabarn_keyframes.csv --worlds dynabarn_worlds.csv --out dynabarn
  keyway scene pairs pairs.csv --unknown 3 --moving 2 --out pairs
  keyway scene schema";

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "\
Examples:
  keyway batch keyway-demo/small_house.toml --stacks keyway,s0-key-point --out batch
  keyway batch barn --keep failures --out barn-results
  keyway batch barn --disturbances noise.toml --seeds 2 --out disturbed
  keyway batch barn --out part-1 --shard 1/2
  keyway batch barn --out part-2 --shard 2/2
  keyway batch merge part-1 part-2 --out both")]
pub(crate) struct BatchCli {
    #[command(subcommand)]
    pub(crate) command: Option<BatchCommand>,
    #[command(flatten)]
    pub(crate) run: Option<BatchArgs>,
}

impl BatchCli {
    /// Output format of the answer on the standard output.
    pub(crate) fn format(&self) -> Format {
        let merge = self.command.as_ref().map(|BatchCommand::Merge(args)| args.format);
        merge.or(self.run.as_ref().map(|args| args.format)).unwrap_or_default()
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum BatchCommand {
    /// Merges result folders, such as those of the parts of one batch (`--shard`)
    Merge(MergeArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "\
All parts of a batch must be given. The results of several batches are concatenated in the given order. Scenes are not needed,
and no run is repeated.

Examples:
  keyway batch merge part-1 part-2 --out merged")]
pub(crate) struct MergeArgs {
    /// Result folders
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,
    /// Folder for the merged results
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct BatchArgs {
    /// Scene files, or folders with scene files in them or in their subfolders
    #[arg(value_name = "SCENE.toml|DIR", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// Stacks (see `keyway list`) or stack files to drive each scene with, for all its robots; or
    /// `all` [default: that of the scene]
    #[arg(long, alias = "stack", value_name = "NAME|FILE.toml,...", value_delimiter = ',')]
    pub(crate) stacks: Vec<String>,
    /// Robot (see `keyway list`) or robot file that replaces all robots of each scene [default:
    /// those of the scene]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// Change one value of all robots, such as `robot.cycle_s=0.2`, or one parameter of all
    /// stacks, such as `controller.blocked_s=5`; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<Assignment>,
    /// Issue only commands after which the robot can still stop before a contact, in all scenes
    /// and whatever the stack says (`controller.safe`)
    #[arg(long)]
    pub(crate) safe: bool,
    /// Disturbances of actuation, sensing and localisation: a TOML file with the fields of
    /// `[disturbances]` of a scene [default: that of the scene]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) disturbances: Option<PathBuf>,
    /// Pose that counts as reaching the goal: the true one or the estimated one [default: as the
    /// scene says, or truth]
    #[arg(long, value_enum, value_name = "POSE")]
    pub(crate) reached_by: Option<ReachedByArg>,
    /// Number of seeds for each scene, counted up from its own
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 1)]
    #[arg(value_parser = whole::<u64, LEAST_SEEDS, MOST_SEEDS>)]
    pub(crate) seeds: u64,
    /// Number of parallel runs [default: one per processor]
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", value_parser = whole::<usize, 1, { u64::MAX }>)]
    pub(crate) jobs: Option<usize>,
    /// Folder for the results; its finished runs are kept, and not repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Compute only the I-th of N parts of the runs; `keyway batch merge` merges the parts
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Runs to record in full, for `keyway replay`, in the folder `records` of --out
    #[arg(long, value_enum, default_value_t)]
    pub(crate) keep: Keep,
    /// Maximum number of cells of a map; larger maps are refused before memory is allocated
    // Same as [`MapLimitArgs`](super::groups::MapLimitArgs): optional groups cannot be nested.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(default_value_t = DEFAULT_MAX_CELLS, value_parser = whole::<u64, 1, MAX_CELLS>)]
    pub(crate) max_cells: u64,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Runs of a batch that get a full record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Keep {
    /// No runs
    #[default]
    None,
    /// Runs that did not reach their goal
    Failures,
    /// All runs
    All,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SceneCommand {
    /// Generates a scene for each BARN world: 10 m among cylinders that are not on the map
    Barn(BarnArgs),
    // This help text is an attribute: as a doc comment, the name would need backticks.
    #[command(about = "Generates a scene for each DynaBARN world: 20 m among moving cylinders")]
    Dynabarn(DynabarnArgs),
    /// Generates a scene for each row of a table of starts and goals, with random obstacles near
    /// the path
    Pairs(PairsArgs),
    /// Generates scenes on maps reconstructed from the papers, on which the baselines have the
    /// published results
    Papers(PapersArgs),
    /// Generates narrow scenes for robots of any shape: tunnels, doors, bays, corners, lanes,
    /// furnished rooms, and walls to drive along
    Narrow(NarrowArgs),
    /// Prints the JSON schema of scene files, for completion and checks in editors
    #[command(after_help = "\
Examples:
  keyway scene schema > scene.schema.json")]
    Schema,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene barn barn_cylinders.csv --out barn
  keyway scene barn barn_cylinders.csv --summary barn_summary.csv --out barn --format json
  keyway scene barn barn_cylinders.csv --known --out barn-known")]
pub(crate) struct BarnArgs {
    /// Cylinders: CSV with the columns `world`, `x`, `y` and `radius` [m]
    #[arg(value_name = "CYLINDERS.csv")]
    pub(crate) cylinders: PathBuf,
    /// Optimal times: CSV with the columns `world` and `optimal_time_s`
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) summary: Option<PathBuf>,
    /// Put the cylinders on the map; the obstacles are then exactly the 5 cm cells whose centres
    /// lie in a cylinder
    #[arg(long)]
    pub(crate) known: bool,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene papers --out reconstructed
  keyway scene papers you2021 --count 5 --out reconstructed --format json")]
pub(crate) struct PapersArgs {
    /// Reconstructions, such as you2021 [default: all of them]
    #[arg(value_name = "NAME")]
    pub(crate) names: Vec<String>,
    /// Number of scenes of each reconstruction: the first maps that fit, with seeds from 1
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 30, value_parser = whole::<usize, 1, 1000>)]
    pub(crate) count: usize,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene narrow --out narrow
  keyway scene narrow tunnel bay --seed 1000 --count 2 --out tunnels-and-bays
  keyway batch tunnels-and-bays --out tunnels-and-bays-results")]
pub(crate) struct NarrowArgs {
    /// Kinds: tunnel, door, bay, corner, lane, room, wall [default: all of them]
    #[arg(value_name = "KIND")]
    pub(crate) names: Vec<String>,
    /// Seed of the first scene of each kind; the others have the following seeds
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of scenes of each kind
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 20, value_parser = whole::<usize, 1, 10000>)]
    pub(crate) count: usize,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene dynabarn dynabarn_keyframes.csv --worlds dynabarn_worlds.csv --out dynabarn")]
pub(crate) struct DynabarnArgs {
    /// Trajectories of the cylinders: CSV with the columns `plugin`, `duration_s`, `t`, `x` and
    /// `y` [s, m]
    #[arg(value_name = "KEYFRAMES.csv")]
    pub(crate) key_frames: PathBuf,
    /// Cylinders of each world: CSV with the columns `world`, `plugin` and `radius` [m]
    #[arg(long, value_name = "WORLDS.csv")]
    pub(crate) worlds: PathBuf,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway scene pairs pairs.csv --robot jackal --out pairs
  keyway scene pairs pairs.csv --unknown 3 --moving 2 --out pairs
  keyway batch pairs --seeds 2 --out pairs-results")]
pub(crate) struct PairsArgs {
    /// Starts and goals: CSV with the columns `map`, `start_x_m`, `start_y_m`, `goal_x_m` and
    /// `goal_y_m`; map paths are relative to the table's folder
    #[arg(value_name = "PAIRS.csv")]
    pub(crate) pairs: PathBuf,
    /// Robot (see `keyway list`), or a robot file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "small")]
    pub(crate) robot: String,
    /// Number of static unknown obstacles near the path, of 0.1 to 0.3 m radius, different for
    /// each seed
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 0, value_parser = whole::<u32, 0, 1000>)]
    pub(crate) unknown: u32,
    /// Number of moving obstacles that cross the path back and forth, of 0.2 to 0.35 m radius, at
    /// 0.3 to 1 m/s, different for each seed
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 0, value_parser = whole::<u32, 0, 1000>)]
    pub(crate) moving: u32,
    /// Moving obstacles give way to robots and to each other, as people do, instead of to nothing
    #[arg(long, requires = "moving")]
    pub(crate) gives_way: bool,
    /// Folder for the scenes
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
