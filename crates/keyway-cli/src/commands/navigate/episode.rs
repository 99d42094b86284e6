//! The episode described by the arguments or by a scene file.

use super::drive::bad_input;
use crate::args::{DiscArg, MovingArg, NavigateArgs, PoseArg, PositionArg, StackArgs};
use crate::config::resolve;
use crate::error::{CliError, Kind};
use crate::inputs::{
    DEFAULT_ROBOT, PAPER_ROBOT, disturbances, load_map, position, published_stack,
    refuse_a_radius_beyond_the_map, robot, source_of, stack, with_radius, with_values,
};
use keyway::files::{FieldValue, StackBase};
use keyway::geometry::{Disc, Point};
use keyway::map::GridFrame;
use keyway::navigate::{Goal, Stack};
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeRobot, NearestGoal, Start};
use keyway_sim::scene_files::{SceneError, SceneFile, SceneFileError, SceneMap, read_scene};
use keyway_sim::sim::{Disturbances, MovingObstacle};
use std::path::{Path, PathBuf};

/// An episode, and the files it was read from.
pub(crate) struct Given {
    pub(crate) episode: Episode,
    pub(crate) sources: Vec<PathBuf>,
}

/// Blames the scene.
impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self::new(Kind::Input, error).field("--scene")
    }
}

/// Refuses arguments that only a scene file may set.
fn refuse_ends_beside_a_scene(args: &NavigateArgs) -> Result<(), CliError> {
    let given = [
        (args.map.is_some(), "[MAP]", "map = \"FILE\""),
        (args.start.is_some(), "--start", "start = [x, y]"),
        (args.goal.is_some(), "--goal", "goal = [x, y]"),
        (!args.via.is_empty(), "--via", "via = [[x, y]]"),
    ];
    let given = given.into_iter().find(|(is_given, ..)| *is_given && args.scene.is_some());
    let Some((_, argument, line)) = given else { return Ok(()) };
    let message = format!(
        "{argument} cannot be combined with --scene; write `{line}` in the scene file instead"
    );
    Err(CliError::new(Kind::Usage, message).field(argument))
}

/// Reads the scene file, if there is one, and applies the requested seed.
pub(crate) fn given_scene(args: &NavigateArgs) -> Result<Option<SceneFile>, CliError> {
    refuse_ends_beside_a_scene(args)?;
    let blame = |error: SceneFileError| CliError::new(Kind::Input, error).field("--scene");
    let mut scene = args.scene.as_deref().map(read_scene).transpose().map_err(blame)?;
    if let (Some(scene), Some(seed)) = (&mut scene, args.seed) {
        scene.seed = seed;
    }
    Ok(scene)
}

/// Builds the episode of a scene or of the arguments. Arguments about the robot and its stack
/// apply to each robot of a scene.
pub(crate) fn given(args: &NavigateArgs, scene: Option<&SceneFile>) -> Result<Given, CliError> {
    let folder = scene_folder(args);
    let time_limit_s = check_time_limit(args.time_limit)?;
    let is_safe = scene.is_some_and(|scene| scene.safe);
    let (map, map_files) = given_map(args, scene, folder)?;
    let (frame, source) = (*map.grid.frame(), map.source.clone());
    let mut stack_names = Vec::new();
    let mut find = |robot: Option<&str>, stack: Option<&str>| {
        let robot = given_robot(args, robot, folder)?;
        refuse_a_radius_beyond_the_map(robot.footprint.inscribed_radius_m(), &frame, "--radius")?;
        let (stack_name, stack) = given_stack(args, (stack, is_safe), folder, &robot)?;
        stack_names.push(stack_name);
        Ok::<_, CliError>((robot, stack))
    };
    let mut episode = if let Some(scene) = scene {
        scene.episode(map, |robot, stack| find(Some(robot), Some(stack)))?
    } else {
        let (robot, stack) = find(None, None)?;
        let (start, goal) = ends_from_args(args, &frame)?;
        let to_point = |via: &PositionArg| position(&frame, via.0, args.cells, "--via");
        let via = args.via.iter().map(to_point).collect::<Result<_, _>>()?;
        let robot = EpisodeRobot::new(robot, start.position, goal);
        Episode::of_robots(map.grid, vec![EpisodeRobot { stack, start, via, ..robot }])
    };
    for (robot, stack_name) in episode.robots.iter_mut().zip(stack_names) {
        robot.stack_name = stack_name;
        robot.disturbances = given_disturbances(args, &robot.disturbances)?;
    }
    episode.source = source;
    episode.obstacles.extend(added_obstacles(args, &frame)?);
    episode.movers.extend(added_movers(args, &frame)?);
    episode.rules.time_limit_s = time_limit_s.or(episode.rules.time_limit_s);
    if let Some(reached_by) = args.reached_by {
        episode.rules.reached_by = reached_by.into();
    }
    if args.nearest_reachable {
        reach_nearest(&mut episode)?;
    }
    Ok(Given { episode, sources: sources(args, map_files) })
}

/// Replaces unreachable goals by the nearest reachable positions, with a warning.
fn reach_nearest(episode: &mut Episode) -> Result<(), CliError> {
    let replaced = episode.reach_nearest().map_err(|error| bad_input(&error.why))?;
    for NearestGoal { asked, goal, .. } in replaced {
        crate::stdout::warn(format!(
            "the goal ({:.3}, {:.3}) cannot be reached; the robot drives to the nearest reachable position, ({:.3}, {:.3})",
            asked.x, asked.y, goal.x, goal.y
        ));
    }
    Ok(())
}

fn scene_folder(args: &NavigateArgs) -> &Path {
    args.scene.as_deref().and_then(Path::parent).unwrap_or(Path::new(""))
}

/// All input files.
fn sources(args: &NavigateArgs, map_files: Vec<PathBuf>) -> Vec<PathBuf> {
    let named = args.scene.iter().chain(&args.config.config).chain(&args.disturbances).cloned();
    let files = map_files.into_iter().chain(named);
    files.chain(args.robot.iter().chain(&args.stack.stack).map(PathBuf::from)).collect()
}

fn added_obstacles(args: &NavigateArgs, frame: &GridFrame) -> Result<Vec<Disc>, CliError> {
    let added = |DiscArg(circle): &DiscArg| {
        let centre = position(frame, circle.centre, args.cells, "--obstacle")?;
        Ok(Disc { centre, ..*circle })
    };
    args.obstacle.iter().map(added).collect()
}

fn added_movers(args: &NavigateArgs, frame: &GridFrame) -> Result<Vec<MovingObstacle>, CliError> {
    let added = |moving: &MovingArg| {
        let place = |&point: &Point| position(frame, point, args.cells, "--moving");
        let points = moving.points().iter().map(place).collect::<Result<_, _>>()?;
        let blame = |error| CliError::new(Kind::Usage, error).field("--moving");
        moving.mover(points).map_err(blame)
    };
    args.moving.iter().map(added).collect()
}

/// The disturbances of the scene, or of the named file.
fn given_disturbances(
    args: &NavigateArgs,
    of_scene: &Disturbances,
) -> Result<Disturbances, CliError> {
    let given = args.disturbances.as_deref().map(disturbances).transpose()?;
    let seed = args.seed.unwrap_or(of_scene.seed);
    Ok(Disturbances { seed, ..given.unwrap_or_else(|| of_scene.clone()) })
}

/// The map, and the files it was read from. The map of a scene is in the scene's folder, or is
/// generated from its seed.
fn given_map(
    args: &NavigateArgs,
    scene: Option<&SceneFile>,
    folder: &Path,
) -> Result<(SceneMap, Vec<PathBuf>), CliError> {
    let placement = args.place.placement();
    if let Some(map) = scene.and_then(SceneFile::generated_map) {
        if placement.is_some() {
            let message = "the placement of a generated map is set by the scene's `[world]`; remove --resolution and --origin";
            return Err(CliError::new(Kind::Usage, message).field("--resolution"));
        }
        let map = map.map_err(|error| CliError::new(Kind::Input, error).field("--scene"))?;
        return Ok((map, Vec::new()));
    }
    let in_scene = scene.and_then(|scene| scene.map.as_ref()).map(|map| folder.join(map));
    // Without a scene, the argument parser requires a map.
    let path = in_scene.or_else(|| args.map.clone()).unwrap_or_default();
    let loaded = load_map(&path, &args.place.reader())?;
    let source = source_of(&loaded, placement);
    Ok((SceneMap { grid: loaded.grid, source }, loaded.sources))
}

/// The robot, which a scene may name, with the requested radius. Robot files named on the command
/// line are relative to the current folder.
fn given_robot(
    args: &NavigateArgs,
    in_scene: Option<&str>,
    folder: &Path,
) -> Result<Robot, CliError> {
    let (changes, _) = args.config.split_robot();
    if args.stack.as_published && !changes.is_empty() {
        let message = format!(
            "--as-published needs the robot `{PAPER_ROBOT}` without changes; remove --as-published to set values of the robot"
        );
        return Err(CliError::new(Kind::Usage, message).field("--set"));
    }
    let robot = with_values(named_robot(args, in_scene, folder)?, &changes)?;
    with_radius(robot, args.radius)
}

fn named_robot(
    args: &NavigateArgs,
    in_scene: Option<&str>,
    folder: &Path,
) -> Result<Robot, CliError> {
    match (&args.robot, in_scene) {
        _ if args.stack.as_published => {
            let other = args.robot.as_ref().filter(|name| name.as_str() != PAPER_ROBOT);
            if let Some(other) = other {
                let message = format!(
                    "--as-published needs the robot `{PAPER_ROBOT}`, got --robot {other}; remove --as-published to derive \
                     the parameters of the stack from your robot"
                );
                return Err(CliError::new(Kind::Usage, message).field("--robot"));
            }
            Ok(Robot::paper())
        }
        (Some(name), _) => robot(name, Path::new("")),
        (None, Some(name)) => robot(name, folder),
        (None, None) => robot(DEFAULT_ROBOT, folder),
    }
}

/// The stack with all changes applied, and its name in reports. Stack files named on the command
/// line are relative to the current folder.
fn given_stack(
    args: &NavigateArgs,
    (in_scene, safe_in_scene): (Option<&str>, bool),
    folder: &Path,
    robot: &Robot,
) -> Result<(String, Stack), CliError> {
    let StackArgs { stack: named, as_published, planner, smoother, guide, local } = &args.stack;
    let (name, folder) = match (named, in_scene) {
        (Some(name), _) => (name.as_str(), Path::new("")),
        (None, in_scene) => (in_scene.unwrap_or(Stack::DEFAULT), folder),
    };
    let parts = [
        FieldValue::if_given("planner", "planner.name", planner.clone()),
        FieldValue::if_given("smoother", "smoother.name", smoother.clone()),
        FieldValue::if_given("guide", "guide.name", guide.clone()),
        FieldValue::if_given("local", "local.name", local.clone()),
    ];
    let (_, config) = args.config.split_robot();
    let guarded = |stack: Stack| stack.safe_if(args.safe || safe_in_scene, robot);
    if *as_published {
        let base = guarded(published_stack(name)?);
        let stack = resolve(StackBase::as_published(&base, robot), &config, parts, &[])?;
        return Ok((format!("{name}, as published"), stack));
    }
    let base = guarded(stack(name, folder, robot, "--stack")?);
    let stack = resolve(StackBase::for_robot(&base, robot), &config, parts, &[])?;
    Ok((name.to_owned(), stack))
}

fn ends_from_args(args: &NavigateArgs, frame: &GridFrame) -> Result<(Start, Goal), CliError> {
    let (Some(start), Some(goal)) = (args.start, args.goal) else {
        let message = "--start and --goal, or --scene, are required";
        return Err(CliError::new(Kind::Usage, message));
    };
    let place = |PoseArg { x, y, .. }, flag| position(frame, Point::new(x, y), args.cells, flag);
    let (from, to) = (place(start, "--start")?, place(goal, "--goal")?);
    let heading_rad = |at: PoseArg| at.yaw_deg.map(f64::to_radians);
    let start = Start { position: from, heading_rad: heading_rad(start) };
    Ok((start, Goal { position: to, heading_rad: heading_rad(goal) }))
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
