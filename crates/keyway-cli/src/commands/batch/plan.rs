//! The runs of a batch, in their order.

use super::part::Part;
use super::shared_world::SharedWorld;
use crate::args::BatchArgs;
use crate::commands::replay::RunRecord;
use crate::error::{CliError, Kind};
use crate::inputs::{disturbances, load_map, robot, stack};
use crate::progress::Watcher;
use keyway::file_system::system_error_in_words;
use keyway::map::formats::MapReader;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_lab::batch::RunId;
use keyway_lab::measure::wall_clock;
use keyway_lab::results::digest;
use keyway_sim::episode::{Team, TeamError, TeamReport, watch_team};
use keyway_sim::report::Inputs;
use keyway_sim::scene_files::{
    SceneError, SceneFile, SceneFileError, SceneMap, SceneRobot, read_scene,
};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A run that is to be made.
pub(super) struct Planned {
    /// Name of the scene: that of its file.
    pub(super) scene: String,
    /// Name of the stack, or the path of its file; of robots that have their own, their names.
    pub(super) stack: String,
    pub(super) seed: u64,
    /// Of all that the run depends on.
    pub(super) digest: String,
    read: Arc<Read>,
    /// That of each robot.
    stacks: Arc<[NamedStack]>,
    /// The same for all stacks.
    pub(super) world: Arc<SharedWorld>,
}

/// A stack with the parameters for the robot that it drives.
struct NamedStack {
    name: String,
    config: Stack,
}

/// A scene that was read.
struct Read {
    file: SceneFile,
    folder: PathBuf,
    robots: Vec<Robot>,
    /// Where a stack that is a file lies: in the folder of the scene that names it, otherwise in the current one.
    stack_folder: PathBuf,
    /// Its map, unless that is made from the seed.
    map: Option<Arc<SceneMap>>,
    /// Of all but stack and seed that its runs depend on.
    digest: String,
}

/// The maps that were read: many scenes have the same.
type Maps = HashMap<PathBuf, Arc<SceneMap>>;

/// All runs: scene by scene, for each its stacks, for each stack its seeds. Of a part only its own.
pub(super) fn planned(
    args: &BatchArgs,
    watcher: &dyn Watcher,
) -> Result<(Vec<Planned>, Option<Part>), CliError> {
    refuse_a_stack_twice(&args.stacks)?;
    let mut planned = Vec::new();
    let mut names = HashSet::new();
    let (mut maps, mut world_numbers) = (Maps::new(), 0..);
    for path in scene_paths(&args.scenes)? {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !names.insert(name.clone()) {
            let message = format!("two scenes are named `{name}`; give their files other names");
            return Err(CliError::new(Kind::Usage, message).field("SCENE.toml"));
        }
        let read = Arc::new(Read::new(&path, args, &mut maps)?);
        if args.seeds > 1 && !read.file.is_random() {
            watcher.warned(&format!("{name}: nothing in it is random; every seed is the same run"));
        }
        let worlds = (&mut world_numbers).take(args.seeds as usize);
        let worlds: Vec<_> = worlds.map(|number| Arc::new(SharedWorld::new(number))).collect();
        for stacks in stack_names(args, &read.file) {
            planned.extend(runs_of(&name, &read, &stacks, &worlds)?);
        }
    }
    let Some(shard) = args.shard else { return Ok((planned, None)) };
    let part = Part::new(shard, planned.iter().map(Planned::id));
    let mut index = 0..;
    planned.retain(|_| index.next().is_some_and(|index| shard.holds(index)));
    Ok((planned, Some(part)))
}

/// Those of a scene with the stacks of its robots: one in each of its worlds, whose seeds follow each other.
fn runs_of<'a>(
    scene: &'a str,
    read: &'a Arc<Read>,
    stack_names: &[String],
    worlds: &'a [Arc<SharedWorld>],
) -> Result<impl Iterator<Item = Planned> + use<'a>, CliError> {
    let stacks = read.stacks(stack_names)?;
    let (stack, of_stacks) = (label(stack_names), read.digest_with(&stacks));
    Ok((0..).zip(worlds).map(move |(number, world)| {
        let seed = read.file.seed.wrapping_add(number);
        Planned {
            scene: scene.to_owned(),
            stack: stack.clone(),
            seed,
            digest: digest(format!("{of_stacks} {seed}").as_bytes()),
            read: Arc::clone(read),
            stacks: Arc::clone(&stacks),
            world: Arc::clone(world),
        }
    }))
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
        let entries =
            std::fs::read_dir(path).map_err(|error| blame(system_error_in_words(&error)))?;
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

/// Why a file cannot be driven. Who names a folder has not named the file.
fn no_scene(error: &SceneFileError, path: &Path, args: &BatchArgs) -> CliError {
    let is_other = matches!(error, SceneFileError::Scene { reason: SceneError::NoScene, .. });
    let is_named = args.scenes.iter().any(|named| named == path);
    let message = if is_other && !is_named {
        format!("{error}; move it to another folder, or name the scenes one by one")
    } else {
        error.to_string()
    };
    CliError::new(Kind::Input, message).field("SCENE.toml")
}

fn refuse_a_stack_twice(stacks: &[String]) -> Result<(), CliError> {
    let is_repeated = |i: &usize| stacks[..*i].contains(&stacks[*i]);
    let Some(i) = (0..stacks.len()).find(is_repeated) else { return Ok(()) };
    let message = format!("the stack `{}` is given twice", stacks[i]);
    Err(CliError::new(Kind::Usage, message).field("--stacks"))
}

/// Those of each robot of a scene, once for each stack that drives it: one that is named drives all robots.
fn stack_names(args: &BatchArgs, scene: &SceneFile) -> Vec<Vec<String>> {
    let own = scene.robots_and_stacks();
    let of_all = |name: &str| vec![name.to_owned(); own.len()];
    match &args.stacks[..] {
        [] => vec![own.iter().map(|&(_, stack)| stack.to_owned()).collect()],
        [all] if all == "all" => Stack::NAMES.map(of_all).to_vec(),
        names => names.iter().map(|name| of_all(name)).collect(),
    }
}

/// The name of the stacks of all robots together: each once.
fn label(names: &[String]) -> String {
    let is_new = |i: &usize| !names[..*i].contains(&names[*i]);
    let different: Vec<&str> = (0..names.len()).filter(is_new).map(|i| names[i].as_str()).collect();
    different.join("+")
}

impl Read {
    fn new(path: &Path, args: &BatchArgs, maps: &mut Maps) -> Result<Self, CliError> {
        let mut file = read_scene(path).map_err(|error| no_scene(&error, path, args))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        if let Some(path) = &args.disturbances {
            file.disturbances = disturbances(path)?;
        }
        file.safe |= args.safe;
        let robot_of = |(in_scene, _): (&str, &str)| match &args.robot {
            Some(name) => robot(name, Path::new("")),
            None => robot(in_scene, &folder),
        };
        let robots = file.robots_and_stacks().into_iter().map(robot_of);
        let robots = robots.collect::<Result<_, _>>()?;
        let map = match &file.map {
            Some(map) => {
                let reader = MapReader { max_cells: args.max_cells, ..MapReader::default() };
                Some(map_of(folder.join(map), &reader, maps)?)
            }
            None => None,
        };
        let names_stacks = !args.stacks.is_empty();
        let stack_folder = if names_stacks { PathBuf::new() } else { folder.clone() };
        let mut read = Self { file, folder, robots, stack_folder, map, digest: String::new() };
        read.digest = read.digest_of_all();
        Ok(read)
    }

    /// Where files lie, and what they are called, is no part of a run. What a run is compared with is.
    fn digest_of_all(&self) -> String {
        let (description, map, robot, stack) = (None, None, String::new(), String::new());
        let scene = SceneFile { description, map, robot, stack, seed: 0, ..self.file.clone() };
        let nameless = |one: &SceneRobot| SceneRobot { robot: None, stack: None, ..one.clone() };
        let scene = SceneFile { robots: scene.robots.iter().map(nameless).collect(), ..scene };
        let map = self.map.as_ref().map(|map| &map.source.digest);
        digest(crate::json::to_string(&(Inputs::VERSION, scene, &self.robots, map)).as_bytes())
    }

    /// The same with the stacks of the robots.
    fn digest_with(&self, stacks: &[NamedStack]) -> String {
        let stacks: Vec<_> = stacks.iter().map(|one| (&one.name, &one.config)).collect();
        digest(crate::json::to_string(&(&self.digest, stacks)).as_bytes())
    }

    /// Stacks with the parameters for the robots that they drive.
    fn stacks(&self, names: &[String]) -> Result<Arc<[NamedStack]>, CliError> {
        let named = |(name, robot): (&String, &Robot)| {
            let config = stack(name, &self.stack_folder, robot, "--stacks")?;
            let config = config.safe_if(self.file.safe, robot);
            Ok(NamedStack { name: name.clone(), config })
        };
        names.iter().zip(&self.robots).map(named).collect()
    }
}

fn map_of(path: PathBuf, reader: &MapReader, maps: &mut Maps) -> Result<Arc<SceneMap>, CliError> {
    if let Some(map) = maps.get(&path) {
        return Ok(Arc::clone(map));
    }
    let map = Arc::new(SceneMap::from(load_map(&path, reader)?));
    maps.insert(path, Arc::clone(&map));
    Ok(map)
}

impl Planned {
    pub(super) fn id(&self) -> RunId<'_> {
        let Self { scene, stack, seed, digest, .. } = self;
        RunId { scene, stack, seed: *seed, digest }
    }

    pub(super) fn reference_time_s(&self) -> Option<f64> {
        self.read.file.rules.reference_time_s
    }

    /// The scene with the seed and the stacks of this run.
    fn scene_file(&self) -> SceneFile {
        let mut scene = SceneFile { seed: self.seed, ..self.read.file.clone() };
        if scene.robots.is_empty() {
            scene.stack.clone_from(&self.stack);
        }
        for (robot, stack) in scene.robots.iter_mut().zip(&*self.stacks) {
            robot.stack = Some(stack.name.clone());
        }
        scene
    }

    /// The run to be made; one robot is a team, too.
    fn team(&self) -> Result<Team, CliError> {
        let world = self.world.take(|| self.made_team())?;
        let mut team = Arc::unwrap_or_clone(world);
        for (robot, stack) in team.robots.iter_mut().zip(&*self.stacks) {
            (robot.stack, robot.stack_name) = (stack.config.clone(), stack.name.clone());
        }
        Ok(team)
    }

    /// What the other stacks drive, but for their names and parameters.
    fn made_team(&self) -> Result<Team, CliError> {
        let blame = |error: SceneError| {
            CliError::new(Kind::Input, format!("{}: {error}", self.scene)).field("SCENE.toml")
        };
        let (scene, Read { robots, map, .. }) = (self.scene_file(), &*self.read);
        let map = match (map, scene.generated_map()) {
            (Some(map), _) => SceneMap::clone(map),
            (None, Some(made)) => made.map_err(blame)?,
            (None, None) => unreachable!("a scene has a map or a world"),
        };
        let stacks = self.stacks.iter().map(|stack| stack.config.clone());
        let mut drivers = robots.iter().cloned().zip(stacks);
        // There are as many as the scene has robots.
        let next = |_: &str, _: &str| drivers.next().ok_or(SceneError::SeveralRobots);
        scene.team(map, next).map_err(blame)
    }

    /// Makes the run. Gives what it was made of, all that came of it, and how long it took by the
    /// wall clock \[s\].
    pub(super) fn drive(&self) -> Result<(Team, TeamReport, f64), CliError> {
        let team = self.team()?;
        let clock = wall_clock();
        let (report, _) = watch_team(&team, Some(&clock), 1, |_| ()).map_err(|error| {
            let robot = error.robot.filter(|_| team.robots.len() > 1);
            let error = TeamError { robot, ..error };
            let name = format!("{}, {}, seed {}", self.scene, self.stack, self.seed);
            CliError::new(Kind::Input, format!("{name}: {error}"))
        })?;
        Ok((team, report, clock()))
    }

    /// All that it takes to make the run again.
    pub(super) fn full_record(&self, team: &Team, report: &TeamReport) -> RunRecord {
        let scene = (self.scene_file(), &*self.read.folder);
        RunRecord::new(&self.digest, &self.scene, scene, team, report)
    }
}
