//! `keyway.record/1`: a run with everything that it takes to make it again.

use super::difference::Difference;
use crate::args::ReplayArgs;
use crate::error::{CliError, Kind};
use crate::inputs::load_map;
use keyway::ConfigError;
use keyway::file_system::{ReadError, read_file};
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeReport, Team, TeamReport, TeamRobot};
use keyway_sim::report::MapSource;
use keyway_sim::scene_files::{SceneError, SceneFile, SceneMap};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf, absolute};
use thiserror::Error;

/// A run of a batch.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunRecord {
    schema: String,
    /// Of all that the run depends on.
    digest: String,
    /// Name of the scene.
    scene: String,
    /// The map file; `None` where the map is made from the seed.
    map: Option<MapFile>,
    /// The scene, with the seed of the run and the name of its stack.
    scene_file: SceneFile,
    /// As `config`: `None` where several robots drove.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    robot: Option<Robot>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    config: Option<Stack>,
    /// Where several drove, each of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    robots: Vec<Driver>,
    /// What came of it, without measured times: `keyway.navigate/4`, of several robots `keyway.team/1`.
    report: Value,
}

/// A robot and its stack.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Driver {
    robot: Robot,
    config: Stack,
}

/// What a record is of.
pub(super) enum Recorded {
    One(Episode),
    Several(Team),
}

/// Where a map was.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    /// As the batch named it.
    name: String,
    /// Its absolute path.
    path: String,
    digest: String,
}

/// Why a record cannot be replayed.
#[derive(Debug, Error)]
pub(crate) enum RecordError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(
        "{}: this is not a record of a run, as `keyway batch --keep` stores it: {reason}",
        path.display()
    )]
    Content { path: PathBuf, reason: serde_json::Error },
    #[error("{}: its schema is {found}; this program replays {}", path.display(), RunRecord::SCHEMA)]
    Schema { path: PathBuf, found: String },
    #[error("{}: {reason}", path.display())]
    Scene { path: PathBuf, reason: SceneError },
    #[error("{}: `{}` {}", path.display(), reason.path, reason.reason)]
    Robot { path: PathBuf, reason: ConfigError },
    #[error(
        "{}: it must say who drove: {}",
        path.display(),
        if *expected == 0 {
            "`robot` and `config`, as the scene has one robot".to_owned()
        } else {
            format!("`robots`, as many as the scene has, {expected}, and neither `robot` nor `config`")
        }
    )]
    Drivers { path: PathBuf, expected: usize },
    #[error(
        "{}: the map {} has changed since: its digest was {recorded} and is {found} now; --map-dir names a folder that has \
         the map as it was",
        path.display(),
        map.display()
    )]
    Map { path: PathBuf, map: PathBuf, recorded: String, found: String },
    #[error(
        "{}: this program makes another run of it: {}{difference}; it was recorded by keyway {recorded_by}, this is keyway {}",
        path.display(),
        robot.map_or_else(String::new, |index| format!("robot {index}: ")),
        keyway_sim::report::Inputs::VERSION
    )]
    Other { path: PathBuf, robot: Option<usize>, difference: Difference, recorded_by: String },
}

impl From<RecordError> for CliError {
    fn from(error: RecordError) -> Self {
        Self::new(Kind::Input, error).field("RECORD.json")
    }
}

impl RunRecord {
    /// More than the record of the longest run has.
    pub(crate) const MAX_BYTES: u64 = 1 << 30;
    /// Name and version of this form.
    pub(crate) const SCHEMA: &'static str = "keyway.record/1";

    /// With which the text of a record of this digest begins; of any record without one.
    pub(crate) fn head(digest: Option<&str>) -> String {
        let schema = format!("{{\n  \"schema\": \"{}\",\n", Self::SCHEMA);
        digest.map_or(schema.clone(), |digest| schema + &format!("  \"digest\": \"{digest}\",\n"))
    }

    /// `digest` is that of all that the run depends on; `folder` is that of the scene file.
    pub(crate) fn new(
        digest: &str,
        scene: &str,
        (scene_file, folder): (SceneFile, &Path),
        team: &Team,
        report: &TeamReport,
    ) -> Self {
        let map = scene_file.map.as_ref().map(|map| {
            let path = folder.join(map);
            let path = absolute(&path).unwrap_or(path).display().to_string();
            let MapSource { name, digest, .. } = team.source.clone();
            MapFile { name, path, digest }
        });
        let driver =
            |one: &TeamRobot| Driver { robot: one.robot.clone(), config: one.stack.clone() };
        let mut robots: Vec<Driver> = team.robots.iter().map(driver).collect();
        let alone = if scene_file.robots.is_empty() { robots.pop() } else { None };
        let (robot, config) = alone.map(|one| (one.robot, one.config)).unzip();
        let mut reports: Vec<EpisodeReport> = report.robots.iter().map(without_times).collect();
        // A report is plain data with string keys: this cannot fail.
        let report = match reports.pop_if(|_| robot.is_some()) {
            Some(one) => serde_json::to_value(one),
            None => serde_json::to_value(TeamReport { robots: reports, ..report.clone() }),
        };
        Self {
            schema: Self::SCHEMA.to_owned(),
            digest: digest.to_owned(),
            scene: scene.to_owned(),
            map,
            scene_file,
            robot,
            config,
            robots,
            report: report.unwrap_or_default(),
        }
    }

    pub(crate) fn read(path: &Path) -> Result<Self, RecordError> {
        let blame = |reason| RecordError::Content { path: path.to_owned(), reason };
        let value: Value =
            serde_json::from_slice(&read_file(path, Self::MAX_BYTES)?).map_err(blame)?;
        // That of a later form may hold anything else.
        if let Some(schema) = value.get("schema").filter(|schema| *schema != Self::SCHEMA) {
            return Err(RecordError::Schema { path: path.to_owned(), found: schema.to_string() });
        }
        let record: Self = serde_json::from_value(value).map_err(blame)?;
        let of_scene = |reason| RecordError::Scene { path: path.to_owned(), reason };
        record.scene_file.validate().map_err(of_scene)?;
        let expected = record.scene_file.robots.len();
        let are_given = [record.robot.is_some(), record.config.is_some()];
        if are_given != [expected == 0; 2] || record.robots.len() != expected {
            return Err(RecordError::Drivers { path: path.to_owned(), expected });
        }
        let drivers = record.drivers();
        for (index, Driver { robot, .. }) in drivers.iter().enumerate() {
            let of =
                if record.robots.is_empty() { String::new() } else { format!("robots[{index}].") };
            robot.validate().map_err(|reason| {
                let reason = reason.within(&format!("{of}robot"));
                RecordError::Robot { path: path.to_owned(), reason }
            })?;
        }
        Ok(record)
    }

    /// Each robot with its stack.
    fn drivers(&self) -> Vec<Driver> {
        let alone = self.robot.clone().zip(self.config.clone());
        let alone = alone.map(|(robot, config)| Driver { robot, config });
        alone.into_iter().chain(self.robots.iter().cloned()).collect()
    }

    /// The run to be made, and the files that it was read from. `path` is that of the record.
    pub(super) fn recorded(
        &self,
        path: &Path,
        args: &ReplayArgs,
    ) -> Result<(Recorded, Vec<PathBuf>), CliError> {
        let mut sources = vec![path.to_owned()];
        let blame = |reason| RecordError::Scene { path: path.to_owned(), reason };
        let map = match (&self.map, self.scene_file.generated_map()) {
            (Some(file), _) => map_of(file, path, args, &mut sources)?,
            (None, Some(map)) => map.map_err(blame)?,
            (None, None) => {
                let message = format!("{}: it does not say where its map is", path.display());
                return Err(CliError::new(Kind::Input, message).field("RECORD.json"));
            }
        };
        let mut drivers = self.drivers().into_iter().map(|one| (one.robot, one.config));
        if self.scene_file.robots.is_empty()
            && let Some((robot, stack)) = drivers.next()
        {
            let episode = self.scene_file.episode(map, robot, stack).map_err(blame)?;
            return Ok((Recorded::One(episode), sources));
        }
        // There are as many as the scene has robots.
        let next = |_: &str, _: &str| drivers.next().ok_or(SceneError::SeveralRobots);
        let team = self.scene_file.team(map, next).map_err(blame)?;
        Ok((Recorded::Several(team), sources))
    }

    /// Whether the run that was made of it is the recorded one.
    pub(super) fn check(&self, path: &Path, report: &EpisodeReport) -> Result<(), RecordError> {
        Self::compare(path, &self.report, report, None)
    }

    /// The same of several robots.
    pub(super) fn check_team(&self, path: &Path, report: &TeamReport) -> Result<(), RecordError> {
        let mut robots = report.robots.iter().enumerate();
        robots.try_for_each(|(index, made)| {
            Self::compare(path, &self.report["robots"][index], made, Some(index))
        })
    }

    fn compare(
        path: &Path,
        recorded: &Value,
        made: &EpisodeReport,
        robot: Option<usize>,
    ) -> Result<(), RecordError> {
        let Some(difference) = Difference::between(recorded, made) else { return Ok(()) };
        let recorded_by = recorded.pointer("/inputs/version").and_then(Value::as_str);
        let recorded_by = recorded_by.unwrap_or("of an unknown version").to_owned();
        Err(RecordError::Other { path: path.to_owned(), robot, difference, recorded_by })
    }
}

/// The map as it was, or an error. `path` is that of the record.
fn map_of(
    file: &MapFile,
    path: &Path,
    args: &ReplayArgs,
    sources: &mut Vec<PathBuf>,
) -> Result<SceneMap, CliError> {
    let recorded = PathBuf::from(&file.path);
    let map = match (&args.map_dir, recorded.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => recorded,
    };
    let mut loaded =
        load_map(&map, &args.limit.reader()).map_err(|error| error.field("RECORD.json"))?;
    if loaded.digest != file.digest {
        let (path, recorded) = (path.to_owned(), file.digest.clone());
        return Err(RecordError::Map { path, map, recorded, found: loaded.digest }.into());
    }
    sources.append(&mut loaded.sources);
    let source = MapSource { name: file.name.clone(), digest: loaded.digest, placement: None };
    Ok(SceneMap { grid: loaded.grid, source })
}

/// Measured times are never the same twice.
fn without_times(report: &EpisodeReport) -> EpisodeReport {
    let mut report = report.clone();
    report.plan.time_s = None;
    if let Some(smoothed) = &mut report.smoothed {
        smoothed.time_s = None;
    }
    if let Some(run) = &mut report.run {
        run.mean_cycle_us = None;
    }
    report
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::robot::Footprint;

    /// Every number comes back as it was: otherwise a run could not be the same.
    #[test]
    fn all_stacks_and_robots_come_back_as_they_were() {
        for robot in [Robot::small(), Robot::jackal(), Robot::paper()] {
            let text = crate::json::to_string(&robot);
            assert_eq!(serde_json::from_str::<Robot>(&text).unwrap(), robot);
            let third = Footprint::circle(1.0 / 3.0).unwrap();
            let robot = Robot { footprint: third, ..robot };
            for name in Stack::NAMES {
                let stacks = [Stack::by_name(name, &robot), Stack::published_by_name(name)];
                for stack in stacks.into_iter().flatten() {
                    let text = crate::json::to_string(&stack);
                    assert_eq!(serde_json::from_str::<Stack>(&text).unwrap(), stack, "{name}");
                }
            }
        }
    }
}
