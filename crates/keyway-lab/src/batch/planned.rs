//! The runs of a batch, in their order.

use super::part::Part;
use super::scene::{BatchScene, NamedStack, SceneReader};
use super::scene_list::listed_scenes;
use super::shared_world::SharedWorld;
use super::{BatchError, BatchRequest, BatchWarning, Record, RunId};
use crate::measure::wall_clock;
use crate::progress::Progress;
use crate::replay::{RecordedInputs, RunRecord};
use crate::results::digest;
use keyway_sim::episode::{Episode, EpisodeReport, RunOptions, watch_episode};
use keyway_sim::scene_files::{SceneError, SceneFile, SceneMap};
use std::sync::Arc;

/// All runs of a request, or those of a part of it.
pub(super) struct PlannedBatch {
    /// The runs in order: scene by scene, then stack by stack, then seed by seed.
    pub(super) runs: Vec<Planned>,
    /// The part; `None` for a whole batch.
    pub(super) part: Option<Part>,
}

/// A run that is to be executed.
pub(super) struct Planned {
    scene: Arc<BatchScene>,
    /// Name of the stack, or the path of its file; for robots with different stacks, their names.
    stack: String,
    seed: u64,
    /// Digest of all inputs.
    digest: String,
    /// Stack of each robot.
    stacks: Arc<[NamedStack]>,
    /// World of the run, shared by all stacks.
    pub(super) world: Arc<SharedWorld>,
}

/// An executed run.
pub(super) struct DrivenRun<'a> {
    planned: &'a Planned,
    episode: Episode,
    report: EpisodeReport,
    /// Wall-clock time \[s\].
    wall_s: f64,
}

impl PlannedBatch {
    /// Reads all scenes, and the files that they name.
    pub(super) fn new(request: &BatchRequest, progress: &dyn Progress) -> Result<Self, BatchError> {
        let mut runs = Vec::new();
        let mut reader = SceneReader::new(request, progress);
        let mut world_numbers = 0..;
        for listed in listed_scenes(request)? {
            let scene = Arc::new(reader.read(listed)?);
            if request.seeds > 1 && !scene.file.is_random() {
                progress.warned(&BatchWarning::NotRandom { scene: scene.name.clone() });
            }
            let worlds = (&mut world_numbers).take(request.seeds as usize);
            let worlds: Vec<_> = worlds.map(|number| Arc::new(SharedWorld::new(number))).collect();
            for stacks in scene.stack_names(request) {
                runs.extend(runs_of(&scene, &stacks, &worlds)?);
            }
        }
        let Some(shard) = request.shard else { return Ok(Self { runs, part: None }) };
        let part = Part::new(shard, runs.iter().map(Planned::id));
        let mut index = 0..;
        runs.retain(|_| index.next().is_some_and(|index| shard.holds(index)));
        Ok(Self { runs, part: Some(part) })
    }
}

/// Returns the runs of a scene with the stacks of its robots: one in each of its worlds, which
/// have consecutive seeds.
fn runs_of<'a>(
    scene: &'a Arc<BatchScene>,
    stack_names: &[String],
    worlds: &'a [Arc<SharedWorld>],
) -> Result<impl Iterator<Item = Planned> + use<'a>, BatchError> {
    let stacks = scene.stacks(stack_names)?;
    let (stack, of_stacks) = (label(stack_names), scene.digest_with(&stacks));
    Ok((0..).zip(worlds).map(move |(number, world)| {
        let seed = scene.file.seed.wrapping_add(number);
        Planned {
            scene: Arc::clone(scene),
            stack: stack.clone(),
            seed,
            digest: digest(format!("{of_stacks} {seed}").as_bytes()),
            stacks: Arc::clone(&stacks),
            world: Arc::clone(world),
        }
    }))
}

/// Returns the joint name of the stacks of all robots: each distinct one once.
fn label(names: &[String]) -> String {
    let is_new = |i: &usize| !names[..*i].contains(&names[*i]);
    let different: Vec<&str> = (0..names.len()).filter(is_new).map(|i| names[i].as_str()).collect();
    different.join("+")
}

impl Planned {
    pub(super) fn id(&self) -> RunId<'_> {
        let Self { scene, stack, seed, digest, .. } = self;
        RunId { scene: &scene.name, stack, seed: *seed, digest }
    }

    /// Returns the scene with the seed and the stacks of this run.
    fn scene_file(&self) -> SceneFile {
        let mut scene = SceneFile { seed: self.seed, ..self.scene.file.clone() };
        if scene.robots.is_empty() {
            scene.stack.clone_from(&self.stack);
        }
        for (robot, stack) in scene.robots.iter_mut().zip(&*self.stacks) {
            robot.stack = Some(stack.name.clone());
        }
        scene
    }

    /// Returns the run with its stacks.
    fn episode(&self) -> Result<Episode, BatchError> {
        let world = self.world.take(|| self.made_episode()).map_err(|reason| {
            let scene = self.scene.name.clone();
            BatchError::World { scene, reason }
        })?;
        let mut episode = Arc::unwrap_or_clone(world);
        for (robot, stack) in episode.robots.iter_mut().zip(&*self.stacks) {
            (robot.stack, robot.stack_name) = (stack.config.clone(), stack.name.clone());
        }
        Ok(episode)
    }

    /// Creates the episode that all stacks share, apart from their names and parameters.
    fn made_episode(&self) -> Result<Episode, SceneError> {
        let (scene, BatchScene { robots, map, .. }) = (self.scene_file(), &*self.scene);
        let map = match (map, scene.generated_map()) {
            (Some(map), _) => SceneMap::clone(map),
            (None, Some(made)) => made?,
            (None, None) => unreachable!("a scene has a map or a world"),
        };
        let stacks = self.stacks.iter().map(|stack| stack.config.clone());
        let mut drivers = robots.iter().cloned().zip(stacks);
        // There are as many drivers as robots in the scene.
        let next = |_: &str, _: &str| drivers.next().ok_or(SceneError::SeveralRobots);
        scene.episode(map, next)
    }

    /// Executes the run.
    pub(super) fn drive(&self) -> Result<DrivenRun<'_>, BatchError> {
        let episode = self.episode()?;
        let clock = wall_clock();
        let options = RunOptions { clock: Some(&clock), ..RunOptions::default() };
        let report = watch_episode(&episode, options, &mut [(); 0]).map_err(|reason| {
            let RunId { scene, stack, seed, .. } = self.id();
            let (scene, stack) = (scene.to_owned(), stack.to_owned());
            BatchError::Run { scene, stack, seed, reason }
        })?;
        Ok(DrivenRun { planned: self, episode, report, wall_s: clock() })
    }
}

impl DrivenRun<'_> {
    /// Returns the results.
    pub(super) fn record(&self) -> Record {
        let Self { planned, episode, report, wall_s } = self;
        Record::of(planned.id(), (episode, report), *wall_s)
    }

    /// Returns everything that is needed to repeat the run.
    pub(super) fn full_record(&self) -> RunRecord {
        let Planned { scene, digest, .. } = self.planned;
        let inputs = RecordedInputs {
            digest,
            scene: &scene.name,
            scene_file: self.planned.scene_file(),
            folder: &scene.folder,
        };
        RunRecord::new(inputs, &self.episode, &self.report)
    }
}
