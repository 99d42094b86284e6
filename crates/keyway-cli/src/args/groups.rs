//! Options that several commands share.

use super::values::{PoseArg, radius, resolution, whole};
use clap::{Args, ValueEnum};
use keyway::files::Assignment;
use keyway::geometry::Pose;
use keyway::map::MAX_CELLS;
use keyway::map::formats::{DEFAULT_MAX_CELLS, ImagePlacement, MapReader};
use keyway_sim::sim::ReachedBy;
use std::ffi::OsString;
use std::path::PathBuf;

/// Parameters of planner, smoother and everything else.
#[derive(Clone, Debug, Args)]
pub(crate) struct ConfigArgs {
    /// Parameters from a file: any part of a stack
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) config: Option<PathBuf>,
    /// Change one parameter, such as map.unknown=free, or that of a planner or smoother by its
    /// name: `hsta.if_no_path=fail`; `navigate` takes those of the robot, too:
    /// `robot.limits.v_max_mps=0.3`; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<Assignment>,
    /// What unknown cells count as [default: blocked]
    #[arg(long, value_enum)]
    pub(crate) unknown: Option<Unknown>,
}

impl ConfigArgs {
    /// The assignments to values of the robot (`robot.limits.v_max_mps=0.3`), by their paths in a
    /// robot file, and all other parameters.
    pub(crate) fn split_robot(&self) -> (Vec<Assignment>, Self) {
        let robot = self.set.iter().filter_map(Assignment::of_robot).collect();
        let of_others = self.set.iter().filter(|one| one.of_robot().is_none());
        (robot, Self { set: of_others.cloned().collect(), ..self.clone() })
    }

    /// The same as words of a command line.
    pub(crate) fn words(&self) -> Vec<OsString> {
        let config = self.config.iter().flat_map(|file| ["--config".into(), file.into()]);
        let set = self.set.iter().flat_map(|set| ["--set".into(), set.to_string().into()]);
        let unknown = self.unknown.iter().flat_map(|it| ["--unknown".into(), it.name().into()]);
        config.chain(set).chain(unknown).collect()
    }
}

/// What a search makes of unknown cells.
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
    /// As in a config file.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Blocked => "blocked",
            Self::Free => "free",
            Self::Penalised => "penalised",
        }
    }
}

/// How a robot plans and drives.
#[derive(Debug, Args)]
pub(crate) struct StackArgs {
    /// The stack (see `keyway list`), or a file with one, as `keyway list NAME` prints it [default:
    /// keyway]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) stack: Option<String>,
    /// The stack with the values of its paper, on the paper's robot, a point named `paper`: for
    /// maps with cells of 1 m
    #[arg(long, conflicts_with = "radius")]
    pub(crate) as_published: bool,
    /// Another planner in this stack (see `keyway list`)
    #[arg(long, value_name = "NAME")]
    pub(crate) planner: Option<String>,
    /// Another smoother
    #[arg(long, value_name = "NAME")]
    pub(crate) smoother: Option<String>,
    /// Another guide
    #[arg(long, value_name = "NAME")]
    pub(crate) guide: Option<String>,
    /// Another local planner
    #[arg(long, value_name = "NAME")]
    pub(crate) local: Option<String>,
}

/// The size of the robot that a path is for.
#[derive(Debug, Default, Args)]
pub(crate) struct SizeArgs {
    /// The robot: paths keep its (inscribed) radius from every obstacle, and smoothers begin with
    /// distances for it (see `keyway list`) [default: none, a point]
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) robot: Option<String>,
    /// Radius that paths keep from every obstacle, instead of the robot's own; without a robot also
    /// the safe distance of smoothers that have one [m] [default: 0]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = radius)]
    pub(crate) radius: Option<f64>,
}

impl SizeArgs {
    /// The same as words of a command line.
    pub(crate) fn words(&self) -> Vec<OsString> {
        let robot = self.robot.iter().flat_map(|name| ["--robot".into(), name.into()]);
        let radius = self.radius.iter().flat_map(|m| ["--radius".into(), m.to_string().into()]);
        robot.chain(radius).collect()
    }
}

/// Placement of a map whose file does not say where it lies, and the largest number of cells.
#[derive(Debug, Args)]
pub(crate) struct PlaceArgs {
    /// Side of a cell of an image or .map file [m] [default: 1]
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = resolution)]
    pub(crate) resolution: Option<f64>,
    /// Where the lower left corner of an image or .map file lies [m, m, deg] [default: 0,0]
    #[arg(long, value_name = "X,Y[,YAW_DEG]", allow_hyphen_values = true)]
    pub(crate) origin: Option<PoseArg>,
    #[command(flatten)]
    pub(crate) limit: MapLimitArgs,
}

impl PlaceArgs {
    /// Reads maps that lie there.
    pub(crate) fn reader(&self) -> MapReader {
        MapReader { placement: self.placement(), ..self.limit.reader() }
    }

    /// `None` when nothing was given.
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

/// Largest number of cells of a map that is read.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct MapLimitArgs {
    /// Refuse a map of more cells, before memory is taken for it
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(default_value_t = DEFAULT_MAX_CELLS, value_parser = whole::<u64, 1, MAX_CELLS>)]
    pub(crate) max_cells: u64,
}

impl MapLimitArgs {
    /// The same as words of a command line.
    pub(crate) fn words(self) -> [OsString; 2] {
        ["--max-cells".into(), self.max_cells.to_string().into()]
    }

    /// Reads maps that say themselves where they lie, or lie at the origin.
    pub(crate) fn reader(self) -> MapReader {
        MapReader { max_cells: self.max_cells, ..MapReader::default() }
    }
}

/// Pose by which a goal is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReachedByArg {
    /// The true one
    Truth,
    /// The one that the robot believes, as where its localisation is disturbed
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

/// Form of the answer on the standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    #[default]
    Table,
    /// For programs
    Json,
}
