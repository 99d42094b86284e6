//! The episode that arguments or a scene file describe.

use crate::args::{ConfigArgs, NavigateArgs, PoseArg, PositionArg};
use crate::config::{resolve, stack_by_name};
use crate::error::{CliError, Kind};
use crate::inputs::{
    DEFAULT_ROBOT, load_map, position, refuse_a_radius_beyond_the_map, robot, source_of,
    with_radius,
};
use keyway::episode::{Episode, EpisodeRules, Start};
use keyway::files::{SceneFile, SceneFileError, read_scene};
use keyway::geometry::Point;
use keyway::map::GridFrame;
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;
use keyway::sim::Circle;
use std::path::{Path, PathBuf};

/// An episode, and the files from which it was read.
pub(crate) struct Given {
    pub(crate) episode: Episode,
    pub(crate) sources: Vec<PathBuf>,
}

pub(crate) fn given(args: &NavigateArgs) -> Result<Given, CliError> {
    let blame = |error: SceneFileError| CliError::new(Kind::Input, error).field("--scene");
    let scene = args.scene.as_deref().map(read_scene).transpose().map_err(blame)?;
    let folder = args.scene.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    // Robots named on the command line are files of the current folder.
    let robot = match (&args.robot, &scene) {
        (Some(name), _) => robot(name, Path::new(""))?,
        (None, Some(scene)) => robot(&scene.robot, folder)?,
        (None, None) => robot(DEFAULT_ROBOT, folder)?,
    };
    let robot = with_radius(robot, args.radius)?;
    let in_scene = scene.as_ref().and_then(|scene| scene.stack.clone());
    let stack_name = args.stack.clone().or(in_scene).unwrap_or_else(|| Stack::DEFAULT.to_owned());
    let stack = resolve_stack(&stack_name, &robot, &args.config)?;
    let time_limit_s = check_time_limit(args.time_limit)?;
    let placement = args.place.placement();
    let loaded = load_map(&map_path(args, scene.as_ref(), folder), placement)?;
    let named = args.scene.iter().chain(&args.config.config).cloned();
    let sources = loaded.sources.iter().cloned().chain(named);
    let sources = sources.chain(args.robot.iter().map(PathBuf::from)).collect();
    let frame = *loaded.grid.frame();
    refuse_a_radius_beyond_the_map(robot.footprint.inscribed_radius_m(), &frame, "--radius")?;
    let source = source_of(&loaded, placement);
    let episode = if let Some(scene) = scene {
        SceneFile { stack: Some(stack_name.clone()), ..scene }
            .episode(loaded, robot)
            .map_err(|error| CliError::new(Kind::Config, error).field("--stack"))?
    } else {
        let (start, goal) = ends_from_args(args, &frame)?;
        let to_point = |via: &PositionArg| position(&frame, via.0, args.cells, "--via");
        let via = args.via.iter().map(to_point).collect::<Result<_, _>>()?;
        Episode { start, via, ..Episode::new(loaded.grid, robot, start.position, goal) }
    };
    let mut obstacles = episode.obstacles;
    for circle in &args.obstacle {
        let centre = position(&frame, circle.0.centre, args.cells, "--obstacle")?;
        obstacles.push(Circle { centre, ..circle.0 });
    }
    let mut movers = episode.movers;
    for moving in &args.moving {
        let place = |&point: &Point| position(&frame, point, args.cells, "--moving");
        let points = moving.points().iter().map(place).collect::<Result<_, _>>()?;
        let blame = |error| CliError::new(Kind::Usage, error).field("--moving");
        movers.push(moving.mover(points).map_err(blame)?);
    }
    let rules = EpisodeRules { time_limit_s, ..EpisodeRules::default() };
    let episode = Episode { source, obstacles, movers, stack, stack_name, rules, ..episode };
    Ok(Given { episode, sources })
}

/// The map of a scene lies in the scene's folder.
fn map_path(args: &NavigateArgs, scene: Option<&SceneFile>, folder: &Path) -> PathBuf {
    let in_scene = scene.map(|scene| folder.join(&scene.map));
    // Without a scene, the parser of the arguments refuses a run without a map.
    in_scene.or_else(|| args.map.clone()).unwrap_or_default()
}

fn resolve_stack(name: &str, robot: &Robot, args: &ConfigArgs) -> Result<Stack, CliError> {
    resolve(&stack_by_name(name, robot)?, robot, args, [], &[])
}

fn ends_from_args(args: &NavigateArgs, frame: &GridFrame) -> Result<(Start, Goal), CliError> {
    let (Some(start), Some(goal)) = (args.start, args.goal) else {
        let message = "--start and --goal are needed, or --scene";
        return Err(CliError::new(Kind::Usage, message));
    };
    let place = |PoseArg { x, y, .. }, flag| position(frame, Point::new(x, y), args.cells, flag);
    let (from, to) = (place(start, "--start")?, place(goal, "--goal")?);
    let start = Start { position: from, yaw_deg: start.yaw_deg };
    Ok((start, Goal { position: to, yaw_deg: goal.yaw_deg }))
}

fn check_time_limit(limit_s: Option<f64>) -> Result<Option<f64>, CliError> {
    match limit_s {
        Some(limit) if !(limit > 0.0 && limit.is_finite()) => {
            let message =
                format!("--time-limit must be a positive number of seconds, got {limit:?}");
            Err(CliError::new(Kind::Usage, message).field("--time-limit"))
        }
        limit => Ok(limit),
    }
}
