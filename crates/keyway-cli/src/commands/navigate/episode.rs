//! The episode that arguments or a scene file describe.

use crate::args::{ConfigArgs, NavigateArgs, PoseArg};
use crate::config::{resolve, stack_by_name};
use crate::error::{CliError, Kind};
use crate::inputs::{
    DEFAULT_ROBOT, load_map, position, refuse_a_radius_beyond_the_map, robot, source_of,
    with_radius,
};
use keyway::episode::{Episode, EpisodeRules, Start};
use keyway::geometry::Point;
use keyway::map::formats::LoadedMap;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway::scene::{SceneFile, SceneFileError, read_scene};
use keyway::sim::Circle;
use std::path::{Path, PathBuf};

/// What a scene file says, or what takes its place without one.
struct Setting {
    folder: PathBuf,
    map: PathBuf,
    robot: String,
    stack: String,
    obstacles: Vec<Circle>,
}

pub(crate) fn episode(args: &NavigateArgs) -> Result<Episode, CliError> {
    let blame = |error: SceneFileError| CliError::new(Kind::Input, error).field("--scene");
    let scene = args.scene.as_deref().map(read_scene).transpose().map_err(blame)?;
    let setting = Setting::of(args, scene.as_ref());
    // Robots named on the command line are files of the current folder.
    let robot = match &args.robot {
        Some(name) => robot(name, Path::new(""))?,
        None => robot(&setting.robot, &setting.folder)?,
    };
    let robot = with_radius(robot, args.radius)?;
    let stack = resolve_stack(&setting.stack, &robot, &args.config)?;
    let time_limit_s = check_time_limit(args.time_limit)?;
    let placement = args.place.placement();
    let loaded = load_map(&setting.map, placement)?;
    refuse_a_radius_beyond_the_map(robot.radius_m, loaded.grid.frame(), "--radius")?;
    let (start, goal) = match &scene {
        Some(scene) => (scene.start, scene.goal),
        None => ends_from_args(args, &loaded)?,
    };
    let mut obstacles = setting.obstacles;
    for circle in &args.obstacle {
        let field = "--obstacle";
        let centre = position(loaded.grid.frame(), circle.0.centre, args.cells, field)?;
        obstacles.push(Circle { centre, ..circle.0 });
    }
    Ok(Episode {
        source: source_of(&setting.map, &loaded, placement),
        known: loaded.grid,
        obstacles,
        robot,
        stack,
        stack_name: setting.stack,
        start,
        goal,
        rules: EpisodeRules { time_limit_s, ..EpisodeRules::default() },
    })
}

impl Setting {
    fn of(args: &NavigateArgs, scene: Option<&SceneFile>) -> Self {
        let folder = args.scene.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let map = match (&args.map, scene) {
            (_, Some(scene)) => folder.join(&scene.map),
            (Some(map), None) => map.clone(),
            // Refused by the parser of the arguments.
            (None, None) => PathBuf::new(),
        };
        let in_scene = scene.and_then(|scene| scene.stack.clone());
        let usual = Stack::DEFAULT.to_owned();
        let circles = |scene: &SceneFile| scene.unknown.iter().map(|&c| c.into()).collect();
        Self {
            folder: folder.to_owned(),
            map,
            robot: scene.map_or_else(|| DEFAULT_ROBOT.to_owned(), |scene| scene.robot.clone()),
            stack: args.stack.clone().or(in_scene).unwrap_or(usual),
            obstacles: scene.map(circles).unwrap_or_default(),
        }
    }
}

fn resolve_stack(name: &str, robot: &Robot, args: &ConfigArgs) -> Result<Stack, CliError> {
    resolve(&stack_by_name(name, robot)?, robot, args, [], &[])
}

fn ends_from_args(args: &NavigateArgs, loaded: &LoadedMap) -> Result<(Start, Point), CliError> {
    let (Some(PoseArg { x, y, yaw_deg }), Some(goal)) = (args.start, args.goal) else {
        let message = "--start and --goal are needed, or --scene";
        return Err(CliError::new(Kind::Usage, message));
    };
    let frame = loaded.grid.frame();
    let start = position(frame, Point::new(x, y), args.cells, "--start")?;
    let goal = position(frame, goal.0, args.cells, "--goal")?;
    Ok((Start { position: start, yaw_deg }, goal))
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
