//! Arguments of the command line.

mod batch;
mod bench;
mod groups;
mod replay;
mod reproduce;
mod terms;
mod values;

use batch::SCENE_EXAMPLES;
pub(crate) use batch::{BatchArgs, BatchCli, BatchCommand, Keep, MergeArgs, SceneCommand};
use bench::BENCH_EXAMPLES;
pub(crate) use bench::{BenchCommand, BenchGridArgs, BenchScaleArgs};
pub(crate) use groups::{
    ConfigArgs, Format, PlaceArgs, ReachedByArg, SizeArgs, StackArgs, Unknown,
};
pub(crate) use replay::{DriveFileArgs, ReplayArgs};
pub(crate) use reproduce::ReproduceArgs;
pub(crate) use terms::{COMPARE_TERMS, GRID_TERMS, PLAN_TERMS, SCALE_TERMS};
pub(crate) use values::{
    AnimationFile, AnimationFormat, CurveFile, CurveFormat, DiscArg, MovingArg, PictureFile,
    PoseArg, PositionArg,
};

use clap::{Args, Parser, Subcommand};
use keyway_lab::compare::CompareRequest;
use std::path::PathBuf;
use values::{positive_length, radius, whole};

/// Plans paths for mobile robots, drives the robots in simulation, and evaluates both.
#[derive(Debug, Parser)]
#[command(name = "keyway", version, after_help = ROOT_EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

const ROOT_EXAMPLES: &str = "\
Examples:
  keyway demo
  keyway plan keyway-demo/small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875
  keyway navigate --scene keyway-demo/small_house.toml
  keyway list";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drives a bundled robot across a bundled house, around an obstacle that is not on the map
    Demo(DemoArgs),
    /// Plans a path on a map
    Plan(PlanArgs),
    /// Prepares a static map, on which paths are then found in microseconds
    Prepare(PrepareArgs),
    /// Plans a path and drives it among obstacles that are not on the map
    Navigate(NavigateArgs),
    /// Drives many scenes with many stacks and seeds, and evaluates the runs
    Batch(BatchCli),
    /// Recomputes recorded runs of a batch and shows them
    Replay(ReplayArgs),
    /// Reproduces the papers' claims and reports a verdict on each
    Reproduce(ReproduceArgs),
    /// Compares the paths of planners and smoothers with each other and with shortest lines
    Compare(CompareArgs),
    /// Benchmarks planners
    #[command(after_help = BENCH_EXAMPLES)]
    Bench {
        #[command(subcommand)]
        command: BenchCommand,
    },
    /// Inspects map files and converts them
    #[command(after_help = MAP_EXAMPLES)]
    Map {
        #[command(subcommand)]
        command: MapCommand,
    },
    /// Generates scene files from published benchmarks and from tables of starts and goals
    #[command(after_help = SCENE_EXAMPLES)]
    Scene {
        #[command(subcommand)]
        command: SceneCommand,
    },
    /// Lists planners, smoothers, guides, local planners, stacks and robots, or the parameters of
    /// one of them
    List(ListArgs),
    /// Drives a robot with ROS 2: the program `keyway-ros`, with the same arguments
    #[cfg(feature = "ros")]
    #[command(disable_help_flag = true)]
    Ros {
        /// Arguments of `keyway-ros`
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Converts pictures from SVG to PDF, for LaTeX
    #[cfg(feature = "pdf")]
    Pdf(PdfArgs),
    /// Writes manual pages of all commands
    Man(ManArgs),
    /// Prints shell completions
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
}

const MAP_EXAMPLES: &str = "\
Examples:
  keyway map info keyway-demo/small_house.yaml
  keyway map convert keyway-demo/small_house.yaml small_house.map";

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  keyway completions bash
  keyway completions zsh";

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway demo
  keyway demo --out my-first-run")]
pub(crate) struct DemoArgs {
    /// Folder for the scene, its map and all result files
    #[arg(long, value_name = "DIR", default_value = "keyway-demo")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[cfg(feature = "pdf")]
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway pdf keyway-demo/map.svg keyway-demo/speed.svg")]
pub(crate) struct PdfArgs {
    /// Pictures; each PDF is written beside its picture
    #[arg(value_name = "FILE.svg", required = true)]
    pub(crate) pictures: Vec<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway man --out man")]
pub(crate) struct ManArgs {
    /// Folder for the pages
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

const PLAN_EXAMPLES: &str = "\
Examples:
  keyway plan keyway-demo/small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875
  keyway plan keyway-demo/small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 \
--radius 0.2 --smoother line-of-sight --picture plan.svg
  keyway plan keyway-demo/small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 \
--planner bidirectional-optimal --animate search.gif
  keyway plan keyway-demo/small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 \
--robot small --smoother continuous-curvature --curve curve.csv --spacing 0.05
  keyway plan keyway-demo/rooms.map --cells --start 1,1 --goal 30,30 --format json
  keyway plan keyway-demo/rooms.map --start 1.5,1.5 --goal 30.5,30.5 --planner astar --set planner.corners=allow
  keyway plan keyway-demo/rooms.map --cells --start 1,1 --goal 30,30 --goal 1,30 --goal 14,7";

#[derive(Debug, Args)]
#[command(after_help = format!("{PLAN_TERMS}\n\n{PLAN_EXAMPLES}"))]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub(crate) struct PlanArgs {
    #[command(flatten)]
    pub(crate) map: MapFileArgs,
    /// Start position [m]
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) start: PositionArg,
    /// Goal position [m]; may be repeated: the goal with the cheapest path comes first
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, required = true)]
    pub(crate) goal: Vec<PositionArg>,
    /// If the goal cannot be reached, plan to the nearest reachable cell
    #[arg(long)]
    pub(crate) nearest_reachable: bool,
    /// Positions are cells: column and row, from the lower left
    #[arg(long)]
    pub(crate) cells: bool,
    /// Planner (see `keyway list`) [default: jps]
    #[arg(long, value_name = "NAME")]
    pub(crate) planner: Option<String>,
    /// Plan with this prepared map, a file written by `keyway prepare`
    #[arg(long, value_name = "FILE", conflicts_with = "planner")]
    pub(crate) prepared: Option<PathBuf>,
    /// Smoother (see `keyway list`) [default: none]
    #[arg(long, value_name = "NAME")]
    pub(crate) smoother: Option<String>,
    /// Use the parameters of the papers for planners and smoothers, regardless of the robot; for
    /// maps with cells of 1 m
    #[arg(long)]
    pub(crate) as_published: bool,
    #[command(flatten)]
    pub(crate) size: SizeArgs,
    /// Stop the search after this many expanded nodes
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "NODES", value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub(crate) budget: Option<u64>,
    /// Report the path's excess cost over a shortest path of straight and diagonal steps
    #[arg(long)]
    pub(crate) excess: bool,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
    /// Draw the map, the search and the path into this file
    #[arg(long, value_name = "FILE.svg|.png")]
    pub(crate) picture: Option<PictureFile>,
    /// Write an animation of the search into this file; it ends with the path
    #[arg(long, value_name = "FILE.gif|.apng")]
    pub(crate) animate: Option<AnimationFile>,
    /// Write the (smoothed) path into this file, sampled by arc length: positions, headings,
    /// curvatures, and the highest speeds within the speed, turn rate and acceleration limits of
    /// --robot [default: small]; angular acceleration along curves is not limited
    #[arg(long, value_name = "FILE.csv|.json")]
    pub(crate) curve: Option<CurveFile>,
    /// Distance between two samples of --curve [m] [default: 0.01]
    #[arg(long, value_name = "M", requires = "curve", allow_hyphen_values = true)]
    #[arg(value_parser = positive_length)]
    pub(crate) spacing: Option<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway prepare keyway-demo/small_house.yaml --out small_house.prepared
  keyway plan keyway-demo/small_house.yaml --prepared small_house.prepared \
--start -8.175,-2.825 --goal 8.725,0.875
  keyway prepare keyway-demo/small_house.yaml --robot small --out inflated.prepared --format json
  keyway prepare keyway-demo/rooms.map --out rooms.prepared --if-it-pays=20000")]
pub(crate) struct PrepareArgs {
    #[command(flatten)]
    pub(crate) map: MapFileArgs,
    /// Output file
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Prepare only if that takes less time than jps needs for this many paths [default: 100000]
    #[arg(long, value_name = "PATHS", num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "100000", value_parser = whole::<u64, 1, { u64::MAX }>)]
    pub(crate) if_it_pays: Option<u64>,
    #[command(flatten)]
    pub(crate) size: SizeArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct MapFileArgs {
    /// Map: ROS map (.yaml), MovingAI (.map) or image (.png, .pgm)
    #[arg(value_name = "MAP")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
}

#[derive(Debug, Args)]
#[command(
    override_usage = "keyway navigate [OPTIONS] MAP --start X,Y[,YAW_DEG] --goal X,Y[,YAW_DEG]\n       \
                      keyway navigate [OPTIONS] --scene FILE",
    after_help = "\
Examples:
  keyway navigate --scene keyway-demo/small_house.toml
  keyway navigate --scene keyway-demo/small_house.toml --set local.comfortable_m=0.3 --format json
  keyway navigate --scene keyway-demo/small_house.toml --stack s1-adaptive --planner jps
  keyway navigate keyway-demo/rooms.map --cells --start 1,1 --goal 30,30 --stack s0-key-point --as-published
  keyway navigate keyway-demo/small_house.yaml --start -8.175,-2.825,0 --goal -3.6,-0.6 --out run
  keyway navigate keyway-demo/small_house.yaml --start -8.175,-2.825 --goal -3.6,-0.6 \
--obstacle -5.5,-0.9,0.15 --robot jackal --radius 0.2
  keyway navigate keyway-demo/small_house.yaml --start -8.175,-2.825 --via -6,-2.6 --goal -3.6,-0.6,90
  keyway navigate keyway-demo/small_house.yaml --start -8.175,-2.825 --goal -3.6,-0.6 \
--moving -6,-3,0.2,0,0.3 --moving -5,-2,0.2,0.4:-5,0 --safe
  keyway navigate --scene keyway-demo/small_house.toml --out run --fan 16.5 --explain why.jsonl --animate drive.gif"
)]
pub(crate) struct NavigateArgs {
    /// Map: ROS map (.yaml), MovingAI (.map) or image (.png, .pgm)
    #[arg(value_name = "MAP", required_unless_present = "scene")]
    pub(crate) map: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
    /// Start pose [m, m, deg]; without a yaw, the robot faces along its path, as closely as its
    /// clearance allows
    #[arg(long, value_name = "X,Y[,YAW_DEG]", allow_hyphen_values = true)]
    #[arg(required_unless_present = "scene")]
    pub(crate) start: Option<PoseArg>,
    /// Goal pose [m, m, deg]; without a yaw, any heading is accepted
    #[arg(long, value_name = "X,Y[,YAW_DEG]", allow_hyphen_values = true)]
    #[arg(required_unless_present = "scene")]
    pub(crate) goal: Option<PoseArg>,
    /// If the goal cannot be reached on the map, drive to the nearest reachable position
    #[arg(long)]
    pub(crate) nearest_reachable: bool,
    /// Waypoint before the goal [m]; may be repeated, in driving order
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(crate) via: Vec<PositionArg>,
    /// Scene file with map, robot, start, goal and unknown and moving obstacles
    #[arg(long, value_name = "FILE")]
    pub(crate) scene: Option<PathBuf>,
    /// Positions are cells: column and row, from the lower left
    #[arg(long)]
    pub(crate) cells: bool,
    #[command(flatten)]
    pub(crate) stack: StackArgs,
    /// Robot (see `keyway list`) [default: small]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// Replace the footprint by a disc of this radius [m]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = radius)]
    pub(crate) radius: Option<f64>,
    /// Obstacle that is not on the map: centre and radius [m]; may be repeated
    #[arg(long, value_name = "X,Y,RADIUS", allow_hyphen_values = true)]
    pub(crate) obstacle: Vec<DiscArg>,
    /// Moving obstacle: centre, radius and constant velocity [m, m/s]; or centre, radius, speed
    /// and the waypoints of a closed loop; may be repeated
    #[arg(long, value_name = "X,Y,RADIUS,VX,VY | X,Y,RADIUS,SPEED:X,Y[:X,Y...]")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) moving: Vec<MovingArg>,
    /// Issue only commands after which the robot can still stop before a contact, whatever the
    /// stack says (`controller.safe`)
    #[arg(long)]
    pub(crate) safe: bool,
    /// Disturbances of actuation, sensing and localisation: a TOML file with the fields of
    /// `[disturbances]` of a scene [default: those of the scene]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) disturbances: Option<PathBuf>,
    /// Pose that counts as reaching the goal: the true one or the estimated one [default: as the
    /// scene says, or truth]
    #[arg(long, value_enum, value_name = "POSE")]
    pub(crate) reached_by: Option<ReachedByArg>,
    /// Seed of all random values [default: that of the scene, or 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub(crate) seed: Option<u64>,
    /// Stop after this simulated time [s] [default: 60 + 4 x path length / top speed]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    pub(crate) time_limit: Option<f64>,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) files: DriveFileArgs,
}

const COMPARE_EXAMPLES: &str = "\
Examples:
  keyway compare keyway-demo/small_house.yaml --robot small
  keyway compare keyway-demo/small_house.yaml --robot small --planners jps,theta-star --smoothers none,line-of-sight
  keyway compare keyway-demo/small_house.yaml --smoothers key-points,hierarchical \
--set key-points.safe_distance_m=0.3 --set hierarchical.safe_distance_m=0.2
  keyway compare keyway-demo/rooms.map --scen keyway-demo/rooms.map.scen --planners astar,theta-star --out comparison
  keyway compare keyway-demo/rooms.map --planners all --columns solved,length,excess --no-times
  keyway compare keyway-demo/small_house.yaml keyway-demo/rooms.map --radius 0.2 --queries 20 --seed 7 --format json";

#[derive(Debug, Args)]
#[command(after_help = format!("{COMPARE_TERMS}\n\n{COMPARE_EXAMPLES}"))]
pub(crate) struct CompareArgs {
    /// Maps: ROS maps (.yaml), MovingAI (.map) or images (.png, .pgm)
    #[arg(value_name = "MAP", required = true)]
    pub(crate) maps: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
    /// Planners (see `keyway list`), or `all` for all that support the map [default:
    /// jps,theta-star; with --smoothers only jps; with --config the one in the file]
    #[arg(long, alias = "planner", value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) planners: Vec<String>,
    /// Smoothers for the paths of each planner (see `keyway list`), or `all` [default:
    /// none,taut,continuous-curvature; with --planners only none; with --config the one in the
    /// file]. A parameter is set for one smoother by its name, such as
    /// `--set hierarchical.safe_distance_m=0.2`, and for all smoothers by
    /// `--set smoother.safe_distance_m=0.2`; the same holds for planners (`planner...`)
    #[arg(long, alias = "smoother", value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) smoothers: Vec<String>,
    /// Starts and goals: lines of `start_x_m,start_y_m,goal_x_m,goal_y_m`, or in the order given
    /// by a header with these names; with a column `map`, each line applies only to that map
    #[arg(long, value_name = "FILE.csv", conflicts_with = "scen")]
    pub(crate) pairs: Option<PathBuf>,
    /// Starts and goals: a MovingAI scenario file
    #[arg(long, value_name = "FILE.scen")]
    pub(crate) scen: Option<PathBuf>,
    /// Number of queries on each map: spread evenly over the scenario file of --scen, otherwise
    /// random between connected cells [default: 10; with --scen all]
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", conflicts_with = "pairs")]
    #[arg(value_parser = whole::<usize, 1, { CompareRequest::MOST_QUERIES as u64 }>)]
    pub(crate) queries: Option<usize>,
    /// Seed of the random queries
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 0, conflicts_with_all = ["pairs", "scen"])]
    #[arg(value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub(crate) seed: u64,
    /// Answer every query this many times, alternating between planners, and keep the fastest
    /// time of each
    #[arg(long, allow_negative_numbers = true)]
    #[arg(value_name = "N", default_value_t = 1)]
    #[arg(value_parser = whole::<u64, 1, { CompareRequest::MOST_REPEATS }>)]
    pub(crate) repeat: u64,
    /// Use the parameters of the papers for planners and smoothers, regardless of the robot; for
    /// maps with cells of 1 m
    #[arg(long)]
    pub(crate) as_published: bool,
    #[command(flatten)]
    pub(crate) size: SizeArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    /// Columns of the table in the terminal and in LaTeX, in the given order, after the names:
    /// corners, solved, missed, compared, length, excess, worst, turns, angle, non-smooth,
    /// clearance, shortfalls, expanded, generated, plan, smooth [default: all but corners, missed,
    /// compared, worst, angle, expanded, generated]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) columns: Vec<String>,
    /// Omit all times; the output is then deterministic
    #[arg(long)]
    pub(crate) no_times: bool,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
    /// Folder for the report, tables (CSV, LaTeX) and a picture of each map
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum MapCommand {
    /// Shows the size, placement and cell counts of a map
    Info(MapInfoArgs),
    /// Converts a map to another format
    Convert(MapConvertArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway map info keyway-demo/small_house.yaml
  keyway map info keyway-demo/small_house.png --resolution 0.05 --origin -12.5,-12.5 --format json")]
pub(crate) struct MapInfoArgs {
    #[command(flatten)]
    pub(crate) map: MapFileArgs,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway map convert keyway-demo/small_house.yaml small_house.map
  keyway map convert keyway-demo/rooms.map rooms.yaml --resolution 0.5 --origin -2,-3,90")]
pub(crate) struct MapConvertArgs {
    #[command(flatten)]
    pub(crate) map: MapFileArgs,
    /// Output file; its extension selects the format (.yaml with a .pgm image beside it, .map,
    /// .png, .pgm). Information that the format cannot store is reported
    #[arg(value_name = "OUT")]
    pub(crate) out: PathBuf,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  keyway list
  keyway list dwa
  keyway list keyway --robot jackal > jackal.toml
  keyway list s0-key-point --as-published")]
pub(crate) struct ListArgs {
    /// Print the parameters of this entry, or of a robot's file; those of a stack or a robot in the
    /// form of a file for `--stack` or `--robot`
    #[arg(value_name = "NAME|ROBOT.toml")]
    pub(crate) name: Option<String>,
    /// Robot from which defaults are derived [default: small]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// Print a stack with the parameters of its paper
    #[arg(long, requires = "name", conflicts_with = "robot")]
    pub(crate) as_published: bool,
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}
