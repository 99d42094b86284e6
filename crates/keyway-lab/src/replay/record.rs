//! `keyway.record/1`: a run with everything that is needed to repeat it.

use super::{ReplayError, SCHEMA};
use keyway::file_system::read_file;
use keyway::navigate::Stack;
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, EpisodeReport, EpisodeRobot, RobotReport};
use keyway_sim::report::MapSource;
use keyway_sim::scene_files::SceneFile;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, absolute};

/// A run of a batch.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunRecord {
    schema: String,
    /// Digest of all inputs of the run.
    digest: String,
    /// Name of the scene.
    scene: String,
    /// The map file; `None` if the map is generated from the seed.
    pub(super) map: Option<MapFile>,
    /// The scene, with the seed of the run and the name of its stack.
    pub(super) scene_file: SceneFile,
    /// The robot; `None`, as `config`, if several robots drove.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    robot: Option<Robot>,
    /// Its stack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    config: Option<Stack>,
    /// All robots, if several drove.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    robots: Vec<Driver>,
    /// The results without measured times: `keyway.navigate/4`, for several robots
    /// `keyway.team/1`.
    pub(super) report: Value,
}

/// A robot and its stack.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Driver {
    pub(super) robot: Robot,
    pub(super) config: Stack,
}

/// Path and digest of a map.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapFile {
    /// Its name in the batch.
    pub(super) name: String,
    /// Its absolute path.
    pub(super) path: String,
    pub(super) digest: String,
}

/// The inputs of a run that a record stores besides the robots and stacks.
pub(crate) struct RecordedInputs<'a> {
    /// Digest of all inputs of the run.
    pub(crate) digest: &'a str,
    /// Name of the scene.
    pub(crate) scene: &'a str,
    /// The scene, with the seed of the run and the name of its stack.
    pub(crate) scene_file: SceneFile,
    /// Folder of the scene file.
    pub(crate) folder: &'a Path,
}

impl RunRecord {
    /// Upper bound of the size of a record: more than the longest run takes.
    pub(crate) const MAX_BYTES: u64 = 1 << 30;

    /// Returns the beginning of the text of a record with this digest; without a digest, that of
    /// any record.
    pub(crate) fn head(digest: Option<&str>) -> String {
        let schema = format!("{{\n  \"schema\": \"{SCHEMA}\",\n");
        digest.map_or(schema.clone(), |digest| schema + &format!("  \"digest\": \"{digest}\",\n"))
    }

    pub(crate) fn new(
        inputs: RecordedInputs<'_>,
        episode: &Episode,
        report: &EpisodeReport,
    ) -> Self {
        let RecordedInputs { digest, scene, scene_file, folder } = inputs;
        let map = scene_file.map.as_ref().map(|map| {
            let path = folder.join(map);
            let path = absolute(&path).unwrap_or(path).display().to_string();
            let MapSource { name, digest, .. } = episode.source.clone();
            MapFile { name, path, digest }
        });
        let driver =
            |one: &EpisodeRobot| Driver { robot: one.robot.clone(), config: one.stack.clone() };
        let mut robots: Vec<Driver> = episode.robots.iter().map(driver).collect();
        let alone = if scene_file.robots.is_empty() { robots.pop() } else { None };
        let (robot, config) = alone.map(|one| (one.robot, one.config)).unzip();
        let mut reports: Vec<RobotReport> = report.robots.iter().map(without_times).collect();
        // A report is plain data with string keys, so this cannot fail.
        let report = match reports.pop_if(|_| robot.is_some()) {
            Some(one) => serde_json::to_value(one),
            None => serde_json::to_value(EpisodeReport { robots: reports, ..report.clone() }),
        };
        Self {
            schema: SCHEMA.to_owned(),
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

    /// Reads and checks a record.
    pub(super) fn read(path: &Path) -> Result<Self, ReplayError> {
        let blame = |reason| ReplayError::Content { path: path.to_owned(), reason };
        let value: Value =
            serde_json::from_slice(&read_file(path, Self::MAX_BYTES)?).map_err(blame)?;
        // A later format may have any other content.
        if let Some(schema) = value.get("schema").filter(|schema| *schema != SCHEMA) {
            return Err(ReplayError::Schema { path: path.to_owned(), found: schema.to_string() });
        }
        let record: Self = serde_json::from_value(value).map_err(blame)?;
        let of_scene = |reason| ReplayError::Scene { path: path.to_owned(), reason };
        record.scene_file.validate().map_err(of_scene)?;
        record.check_drivers(path)?;
        Ok(record)
    }

    /// Checks that the record has the robots of its scene, and that they are valid.
    fn check_drivers(&self, path: &Path) -> Result<(), ReplayError> {
        let robots = self.scene_file.robots.len();
        let are_given = [self.robot.is_some(), self.config.is_some()];
        if are_given != [robots == 0; 2] || self.robots.len() != robots {
            return Err(ReplayError::Drivers { path: path.to_owned(), robots });
        }
        for (index, Driver { robot, .. }) in self.drivers().iter().enumerate() {
            let of =
                if self.robots.is_empty() { String::new() } else { format!("robots[{index}].") };
            robot.validate().map_err(|reason| {
                let reason = reason.within(&format!("{of}robot"));
                ReplayError::Robot { path: path.to_owned(), reason }
            })?;
        }
        Ok(())
    }

    /// Returns each robot with its stack.
    pub(super) fn drivers(&self) -> Vec<Driver> {
        let alone = self.robot.clone().zip(self.config.clone());
        let alone = alone.map(|(robot, config)| Driver { robot, config });
        alone.into_iter().chain(self.robots.iter().cloned()).collect()
    }
}

/// Removes the measured times, which differ from run to run.
fn without_times(report: &RobotReport) -> RobotReport {
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
    use crate::results::json_text;
    use keyway::robot::Footprint;

    /// Every number must be restored exactly: otherwise a run could not be repeated.
    #[test]
    fn all_stacks_and_robots_come_back_as_they_were() {
        for robot in [Robot::small(), Robot::jackal(), Robot::paper()] {
            let text = json_text(&robot);
            assert_eq!(serde_json::from_str::<Robot>(&text).unwrap(), robot);
            let third = Footprint::circle(1.0 / 3.0).unwrap();
            let robot = Robot { footprint: third, ..robot };
            for name in Stack::NAMES {
                let stacks = [Stack::by_name(name, &robot), Stack::published_by_name(name)];
                for stack in stacks.into_iter().flatten() {
                    let text = json_text(&stack);
                    assert_eq!(serde_json::from_str::<Stack>(&text).unwrap(), stack, "{name}");
                }
            }
        }
    }
}
