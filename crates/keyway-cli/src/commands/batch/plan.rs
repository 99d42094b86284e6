//! The runs of a batch, in their order.

use super::record::{Measured, Record};
use crate::args::BatchArgs;
use crate::error::{CliError, Kind};
use crate::inputs::{disturbances, load_map, robot, stack};
use crate::measure::wall_clock;
use crate::out_dir::digest;
use keyway::episode::{Episode, watch_episode};
use keyway::files::{SceneFile, SceneMap, read_scene};
use keyway::navigate::Stack;
use keyway::robot::Robot;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A run that is to be made.
pub(super) struct Planned {
    /// Name of the scene: that of its file.
    pub(super) scene: String,
    /// Name of the stack, or the path of its file.
    pub(super) stack: String,
    pub(super) seed: u64,
    /// Of all that the run depends on.
    pub(super) digest: String,
    read: Arc<Read>,
}

/// A scene that was read.
struct Read {
    file: SceneFile,
    robot: Robot,
    /// Where a stack that is a file lies: in the folder of the scene that names it, otherwise in the current one.
    stack_folder: PathBuf,
    /// Its map, unless that is made from the seed.
    map: Option<SceneMap>,
}

/// All runs: scene by scene, for each its stacks, for each stack its seeds.
pub(super) fn planned(args: &BatchArgs) -> Result<Vec<Planned>, CliError> {
    refuse_a_stack_twice(&args.stacks)?;
    let mut planned = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for path in scene_paths(&args.scenes)? {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if names.contains(&name) {
            let message = format!("two scenes are named `{name}`; give their files other names");
            return Err(CliError::new(Kind::Usage, message).field("SCENE.toml"));
        }
        let read = Arc::new(Read::new(&path, args)?);
        if args.seeds > 1 && !read.file.is_random() {
            crate::stdout::warn(format!(
                "{name}: nothing in it is random; every seed is the same run"
            ));
        }
        for stack in stack_names(args, &read.file) {
            for number in 0..u64::from(args.seeds) {
                let seed = read.file.seed.wrapping_add(number);
                planned.push(Planned::new(&name, &stack, seed, &read)?);
            }
        }
        names.push(name);
    }
    if let Some(shard) = args.shard {
        let mut index = 0..;
        planned.retain(|_| index.next().is_some_and(|index| shard.holds(index)));
    }
    Ok(planned)
}

/// The files, and those of the folders in the order of their names.
fn scene_paths(given: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    let mut paths = Vec::new();
    for path in given {
        let blame = |what: String| {
            CliError::new(Kind::Input, format!("{}: {what}", path.display())).field("SCENE.toml")
        };
        if !path.is_dir() {
            paths.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path).map_err(|error| blame(error.to_string()))?;
        let is_scene = |path: &PathBuf| path.extension().is_some_and(|end| end == "toml");
        let mut inside: Vec<PathBuf> =
            entries.flatten().map(|entry| entry.path()).filter(is_scene).collect();
        if inside.is_empty() {
            return Err(blame("there is no scene (*.toml) in this folder".to_owned()));
        }
        inside.sort();
        paths.extend(inside);
    }
    Ok(paths)
}

fn refuse_a_stack_twice(stacks: &[String]) -> Result<(), CliError> {
    let is_repeated = |i: &usize| stacks[..*i].contains(&stacks[*i]);
    let Some(i) = (0..stacks.len()).find(is_repeated) else { return Ok(()) };
    let message = format!("the stack `{}` is given twice", stacks[i]);
    Err(CliError::new(Kind::Usage, message).field("--stacks"))
}

fn stack_names(args: &BatchArgs, scene: &SceneFile) -> Vec<String> {
    match &args.stacks[..] {
        [] => vec![scene.stack.clone()],
        [all] if all == "all" => Stack::NAMES.map(str::to_owned).to_vec(),
        names => names.to_vec(),
    }
}

impl Read {
    fn new(path: &Path, args: &BatchArgs) -> Result<Self, CliError> {
        let blame = |error| CliError::new(Kind::Input, error).field("SCENE.toml");
        let mut file = read_scene(path).map_err(blame)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        if let Some(path) = &args.disturbances {
            file.disturbances = disturbances(path)?;
        }
        let robot = match &args.robot {
            Some(name) => robot(name, Path::new(""))?,
            None => robot(&file.robot, &folder)?,
        };
        let map = match &file.map {
            Some(map) => Some(load_map(&folder.join(map), None)?.into()),
            None => None,
        };
        let names_stacks = !args.stacks.is_empty();
        let stack_folder = if names_stacks { PathBuf::new() } else { folder };
        Ok(Self { file, robot, stack_folder, map })
    }
}

impl Planned {
    fn new(scene: &str, stack: &str, seed: u64, read: &Arc<Read>) -> Result<Self, CliError> {
        let (scene, stack) = (scene.to_owned(), stack.to_owned());
        let mut planned = Self { scene, stack, seed, digest: String::new(), read: read.clone() };
        let episode = planned.episode()?;
        let inputs = episode.inputs(episode.rules.time_limit_s);
        // What a run is compared with is part of its record, too.
        let rules = &read.file.rules;
        planned.digest = digest(crate::json::to_string(&(inputs, seed, rules)).as_bytes());
        Ok(planned)
    }

    fn episode(&self) -> Result<Episode, CliError> {
        let Read { file, robot, stack_folder, map } = &*self.read;
        let blame = |error| {
            CliError::new(Kind::Input, format!("{}: {error}", self.scene)).field("SCENE.toml")
        };
        let scene = SceneFile { seed: self.seed, stack: self.stack.clone(), ..file.clone() };
        let map = match (map, scene.generated_map()) {
            (Some(map), _) => map.clone(),
            (None, Some(made)) => made.map_err(blame)?,
            (None, None) => unreachable!("a scene has a map or a world"),
        };
        let stack = stack(&scene.stack, stack_folder, robot, "--stacks")?;
        let several = |error| {
            let CliError { kind, message, field } = blame(error);
            let message = format!("{message}; `keyway navigate --scene` drives it");
            CliError { kind, message, field }
        };
        scene.episode(map, robot.clone(), stack).map_err(several)
    }

    /// Makes the run.
    pub(super) fn drive(&self) -> Result<Record, CliError> {
        let episode = self.episode()?;
        let clock = wall_clock();
        let name = format!("{}, {}, seed {}", self.scene, self.stack, self.seed);
        let report = watch_episode(&episode, Some(&clock), &mut ())
            .map_err(|error| CliError::new(Kind::Input, format!("{name}: {error}")))?;
        let measured = Measured::of(&report, clock());
        let reference_time_s = self.read.file.rules.reference_time_s;
        Ok(Record::of(self, &report, reference_time_s, measured))
    }
}
