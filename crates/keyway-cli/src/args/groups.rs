//! Options shared by several commands.

use super::values::{PoseArg, radius, resolution, whole};
use clap::{Args, ValueEnum};
use keyway::files::Assignment;
use keyway::geometry::Pose;
use keyway::map::MAX_CELLS;
use keyway::map::formats::{DEFAULT_MAX_CELLS, ImagePlacement, MapReader};
use keyway_sim::sim::ReachedBy;
use std::ffi::OsString;
use std::path::PathBuf;

/// Parameters of planner, smoother and all other parts of a stack.
#[derive(Clone, Debug, Args)]
pub(crate) struct ConfigArgs {
    /// File with parameters of any part of a stack
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) config: Option<PathBuf>,
    /// Change one parameter, such as `map.unknown=free`, or a parameter of one planner or
    /// smoother, such as `hsta.if_no_path=fail`; `navigate` also accepts values of the robot, such
    /// as `robot.limits.v_max_mps=0.3`; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<Assignment>,
    /// Handling of unknown cells [default: blocked]
    #[arg(long, value_enum)]
    pub(crate) unknown: Option<Unknown>,
}

impl ConfigArgs {
    /// Splits the assignments: those of the robot (`robot.limits.v_max_mps=0.3`), by their paths
    /// in a robot file, and the remaining parameters.
    pub(crate) fn split_robot(&self) -> (Vec<Assignment>, Self) {
        let robot = self.set.iter().filter_map(Assignment::of_robot).collect();
        let of_others = self.set.iter().filter(|one| one.of_robot().is_none());
        (robot, Self { set: of_others.cloned().collect(), ..self.clone() })
    }

    /// The same options as words of a command line.
    pub(crate) fn words(&self) -> Vec<OsString> {
        let config = self.config.iter().flat_map(|file| ["--config".into(), file.into()]);
        let set = self.set.iter().flat_map(|set| ["--set".into(), set.to_string().into()]);
        let unknown = self.unknown.iter().flat_map(|it| ["--unknown".into(), it.name().into()]);
        config.chain(set).chain(unknown).collect()
    }
}

/// Handling of unknown cells in a search.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Unknown {
    /// Obstacles
    Blocked,
    /// Free
    Free,
    /// Free at a higher cost
    Penalised,
}

impl Unknown {
    /// Name in a config file.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Blocked => "blocked",
            Self::Free => "free",
            Self::Penalised => "penalised",
        }
    }
}

/// The stack and its parts.
#[derive(Debug, Args)]
pub(crate) struct StackArgs {
    /// Stack (see `keyway list`), or a stack file, as printed by `keyway list NAME` [default:
    /// keyway]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) stack: Option<String>,
    /// Use the parameters of the stack's paper and the paper's robot, a point (`paper`); for maps
    /// with cells of 1 m
    #[arg(long, conflicts_with = "radius")]
    pub(crate) as_published: bool,
    /// Replace the planner of the stack (see `keyway list`)
    #[arg(long, value_name = "NAME")]
    pub(crate) planner: Option<String>,
    /// Replace the smoother
    #[arg(long, value_name = "NAME")]
    pub(crate) smoother: Option<String>,
    /// Replace the guide
    #[arg(long, value_name = "NAME")]
    pub(crate) guide: Option<String>,
    /// Replace the local planner
    #[arg(long, value_name = "NAME")]
    pub(crate) local: Option<String>,
}

/// Size of the robot that a path is planned for.
#[derive(Debug, Default, Args)]
pub(crate) struct SizeArgs {
    /// Robot: paths keep its (inscribed) radius from every obstacle, and the default distances of
    /// smoothers are derived from it (see `keyway list`) [default: none, a point]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// Clearance of paths to every obstacle, overriding the robot's radius; without a robot, also
    /// the safe distance of smoothers that have one [m] [default: 0]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = radius)]
    pub(crate) radius: Option<f64>,
}

impl SizeArgs {
    /// The same options as words of a command line.
    pub(crate) fn words(&self) -> Vec<OsString> {
        let robot = self.robot.iter().flat_map(|name| ["--robot".into(), name.into()]);
        let radius = self.radius.iter().flat_map(|m| ["--radius".into(), m.to_string().into()]);
        robot.chain(radius).collect()
    }
}

/// Placement of a map whose file does not contain it, and the maximum number of cells.
#[derive(Debug, Args)]
pub(crate) struct PlaceArgs {
    /// Cell size of an image or .map file [m] [default: 1]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = resolution)]
    pub(crate) resolution: Option<f64>,
    /// Pose of the lower left corner of an image or .map file [m, m, deg] [default: 0,0]
    #[arg(long, value_name = "X,Y[,YAW_DEG]", allow_hyphen_values = true)]
    pub(crate) origin: Option<PoseArg>,
    #[command(flatten)]
    pub(crate) limit: MapLimitArgs,
}

impl PlaceArgs {
    /// Returns a reader for maps at this placement.
    pub(crate) fn reader(&self) -> MapReader {
        MapReader { placement: self.placement(), ..self.limit.reader() }
    }

    /// Returns the placement; `None` if no option was given.
    pub(crate) fn placement(&self) -> Option<ImagePlacement> {
        if self.resolution.is_none() && self.origin.is_none() {
            return None;
        }
        let usual = ImagePlacement::default();
        let origin = self.origin.map_or(usual.origin, |PoseArg { x, y, yaw_deg }| {
            Pose::new(x, y, yaw_deg.unwrap_or_default().to_radians())
        });
        let resolution_m = self.resolution.unwrap_or(usual.resolution_m);
        Some(ImagePlacement { resolution_m, origin })
    }
}

/// Maximum number of cells of a map.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct MapLimitArgs {
    /// Maximum number of cells of a map; larger maps are refused before memory is allocated
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(default_value_t = DEFAULT_MAX_CELLS, value_parser = whole::<u64, 1, MAX_CELLS>)]
    pub(crate) max_cells: u64,
}

impl MapLimitArgs {
    /// The same options as words of a command line.
    pub(crate) fn words(self) -> [OsString; 2] {
        ["--max-cells".into(), self.max_cells.to_string().into()]
    }

    /// Returns a reader for maps that contain their placement, or lie at the origin.
    pub(crate) fn reader(self) -> MapReader {
        MapReader { max_cells: self.max_cells, ..MapReader::default() }
    }
}

/// The pose that counts as reaching a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReachedByArg {
    /// The true pose
    Truth,
    /// The pose estimated by the robot; differs from the true one if localisation is disturbed
    Belief,
}

impl From<ReachedByArg> for ReachedBy {
    fn from(pose: ReachedByArg) -> Self {
        match pose {
            ReachedByArg::Truth => Self::Truth,
            ReachedByArg::Belief => Self::Belief,
        }
    }
}

/// Output format of the answer on the standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Human-readable text
    #[default]
    Table,
    /// Machine-readable JSON
    Json,
}
