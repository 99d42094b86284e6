//! Request for the replay of a record.

use super::record::{MapFile, RunRecord};
use super::{Difference, ReplayError};
use crate::progress::Progress;
use keyway::map::formats::MapReader;
use keyway_sim::episode::{Episode, EpisodeReport, RobotReport};
use keyway_sim::report::MapSource;
use keyway_sim::scene_files::{SceneError, SceneMap};
use serde_json::Value;
use std::path::PathBuf;

/// A record to replay.
#[derive(Clone, Debug)]
pub struct ReplayRequest {
    /// The record.
    pub record: PathBuf,
    /// Folder of the map; `None`: the folder that it was in at the time of the recording.
    pub map_dir: Option<PathBuf>,
    /// Maximum number of cells of the map; larger maps are refused before memory is allocated.
    pub max_cells: u64,
}

/// A recorded run that is to be repeated.
#[derive(Debug)]
pub struct Replay {
    /// The run.
    pub episode: Episode,
    /// True if the scene has `[[robots]]`. In that case the report is that of an episode
    /// ([`Self::check_episode`]), otherwise that of its one robot ([`Self::check`]).
    pub has_robots: bool,
    /// The files that were read: the record and its map.
    pub sources: Vec<PathBuf>,
    path: PathBuf,
    /// The results in the record.
    report: Value,
}

impl ReplayRequest {
    /// Reads a record and its map. Likely mistakes in the map are warnings.
    ///
    /// # Errors
    /// Returns [`ReplayError`] if the record or its map cannot be read or used, or the map has
    /// changed since.
    pub fn read(&self, progress: &dyn Progress) -> Result<Replay, ReplayError> {
        let path = &self.record;
        let record = RunRecord::read(path)?;
        let mut sources = vec![path.clone()];
        let blame = |reason| ReplayError::Scene { path: path.clone(), reason };
        let scene = &record.scene_file;
        let map = match (&record.map, scene.generated_map()) {
            (Some(file), _) => self.map(file, &mut sources, progress)?,
            (None, Some(map)) => map.map_err(blame)?,
            (None, None) => return Err(ReplayError::NoMap { path: path.clone() }),
        };
        let mut drivers = record.drivers().into_iter().map(|one| (one.robot, one.config));
        // There are as many drivers as robots in the scene.
        let next = |_: &str, _: &str| drivers.next().ok_or(SceneError::SeveralRobots);
        let episode = scene.episode(map, next).map_err(blame)?;
        let has_robots = !scene.robots.is_empty();
        Ok(Replay { episode, has_robots, sources, path: path.clone(), report: record.report })
    }

    /// Reads the map, which must not have changed.
    fn map(
        &self,
        file: &MapFile,
        sources: &mut Vec<PathBuf>,
        progress: &dyn Progress,
    ) -> Result<SceneMap, ReplayError> {
        let recorded = PathBuf::from(&file.path);
        let map = match (&self.map_dir, recorded.file_name()) {
            (Some(folder), Some(name)) => folder.join(name),
            _ => recorded,
        };
        let reader = MapReader { max_cells: self.max_cells, ..MapReader::default() };
        let mut loaded = reader.read(&map)?;
        loaded.warnings.iter().for_each(|warning| progress.warned(warning));
        if loaded.digest != file.digest {
            let (path, recorded) = (self.record.clone(), file.digest.clone());
            return Err(ReplayError::OtherMap { path, map, recorded, found: loaded.digest });
        }
        sources.append(&mut loaded.sources);
        let source = MapSource { name: file.name.clone(), digest: loaded.digest, placement: None };
        Ok(SceneMap { grid: loaded.grid, source })
    }
}

impl Replay {
    /// Checks that a run of one robot is the recorded one.
    ///
    /// # Errors
    /// Returns [`ReplayError`] with the first difference.
    pub fn check(&self, made: &RobotReport) -> Result<(), ReplayError> {
        self.compare(&self.report, made, None)
    }

    /// Checks that the run of a scene with `[[robots]]` is the recorded one.
    ///
    /// # Errors
    /// Returns [`ReplayError`] with the first difference of the first robot whose run differs.
    pub fn check_episode(&self, made: &EpisodeReport) -> Result<(), ReplayError> {
        let mut robots = made.robots.iter().enumerate();
        robots.try_for_each(|(index, made)| {
            self.compare(&self.report["robots"][index], made, Some(index))
        })
    }

    fn compare(
        &self,
        recorded: &Value,
        made: &RobotReport,
        robot: Option<usize>,
    ) -> Result<(), ReplayError> {
        let Some(difference) = Difference::between(recorded, made) else { return Ok(()) };
        let recorded_by = recorded.pointer("/inputs/version").and_then(Value::as_str);
        let recorded_by = recorded_by.unwrap_or("of an unknown version").to_owned();
        Err(ReplayError::OtherRun { path: self.path.clone(), robot, difference, recorded_by })
    }
}
