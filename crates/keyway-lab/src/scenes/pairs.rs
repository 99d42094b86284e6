//! A scene for each pair of start and goal in a table.

use super::table::some_rows;
use super::{NamedScene, ScenesError};
use keyway::files::find_robot;
use keyway::geometry::Point;
use keyway::robot::Robot;
use keyway_sim::episode::{RandomMoving, RandomObstacles, RandomUnknown, Start};
use keyway_sim::scene_files::SceneFile;
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

/// Sizes of posts and boxes on the floor \[m\].
const UNKNOWN_RADIUS_M: [f64; 2] = [0.1, 0.3];
/// Sizes of walking pedestrians \[m\].
const MOVING_RADIUS_M: [f64; 2] = [0.2, 0.35];
/// Speeds of walking pedestrians \[m/s\].
const MOVING_SPEED_MPS: [f64; 2] = [0.3, 1.0];

/// Request for scenes of pairs of start and goal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairsRequest {
    /// Table of the pairs: CSV with the columns `map`, `start_x_m`, `start_y_m`, `goal_x_m` and
    /// `goal_y_m`. Paths of maps are relative to the table's folder.
    pub pairs: PathBuf,
    /// Name of a bundled robot, or the path of a file with one.
    pub robot: String,
    /// Number of random static unknown obstacles near the path.
    pub unknown: u32,
    /// Number of random moving obstacles.
    pub moving: u32,
    /// True if the moving obstacles give way to robots and to each other.
    pub gives_way: bool,
    /// Folder of the scenes: their paths of maps and robots are relative to it.
    pub folder: PathBuf,
}

#[derive(Deserialize)]
struct Pair {
    map: PathBuf,
    #[serde(alias = "start_x")]
    start_x_m: f64,
    #[serde(alias = "start_y")]
    start_y_m: f64,
    #[serde(alias = "goal_x")]
    goal_x_m: f64,
    #[serde(alias = "goal_y")]
    goal_y_m: f64,
}

/// Parts that all scenes share.
struct Common {
    /// Folder of the scenes, resolved.
    folder: PathBuf,
    /// Robot as the scenes name it.
    robot: String,
}

impl PairsRequest {
    /// Returns a scene for each line, in their order.
    ///
    /// # Errors
    /// Returns [`ScenesError`] if the table, a map in it or the robot cannot be used.
    pub fn scenes(&self) -> Result<Vec<NamedScene>, ScenesError> {
        let pairs: Vec<Pair> = some_rows(&self.pairs).map_err(ScenesError::of_table("pairs"))?;
        self.refuse_the_same(&pairs)?;
        let folder = resolved(&self.folder, "folder")?;
        let robot = self.robot_in(&folder)?;
        let common = Common { folder, robot };
        let named = |(index, pair): (usize, &Pair)| self.scene(index, pair, &common);
        pairs.iter().enumerate().map(named).collect()
    }

    fn refuse_the_same(&self, pairs: &[Pair]) -> Result<(), ScenesError> {
        let mut firsts = HashMap::new();
        for (pair, own) in pairs.iter().enumerate() {
            let ends = [own.start_x_m, own.start_y_m, own.goal_x_m, own.goal_y_m];
            let first = *firsts.entry((&own.map, ends.map(f64::to_bits))).or_insert(pair);
            if first < pair {
                return Err(ScenesError::SamePair { pairs: self.pairs.clone(), pair, first });
            }
        }
        Ok(())
    }

    fn scene(&self, index: usize, pair: &Pair, common: &Common) -> Result<NamedScene, ScenesError> {
        let beside = self.pairs.parent().unwrap_or(Path::new("")).join(&pair.map);
        let map = resolved(&beside, "pairs")?;
        if !map.is_file() {
            return Err(ScenesError::NoMap { pairs: self.pairs.clone(), pair: index, map: beside });
        }
        let stem = map.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let start = Point::new(pair.start_x_m, pair.start_y_m);
        let goal = Point::new(pair.goal_x_m, pair.goal_y_m);
        let scene = SceneFile {
            description: Some(format!("{stem}, pair {index}")),
            map: Some(from_folder(&common.folder, &map)?),
            robot: common.robot.clone(),
            random: self.random(),
            ..SceneFile::new(Start { position: start, heading_rad: None }, goal.into())
        };
        scene.validate().map_err(|reason| ScenesError::Pair { pair: index, reason })?;
        Ok(NamedScene { file: format!("{index:03}_{stem}.toml"), scene })
    }

    fn random(&self) -> Option<RandomObstacles> {
        let unknown = RandomUnknown { count: self.unknown, radius_m: UNKNOWN_RADIUS_M };
        let moving = RandomMoving {
            count: self.moving,
            radius_m: MOVING_RADIUS_M,
            speed_mps: MOVING_SPEED_MPS,
            gives_way: self.gives_way,
        };
        (self.unknown + self.moving > 0).then(|| RandomObstacles {
            unknown: (self.unknown > 0).then_some(unknown),
            moving: (self.moving > 0).then_some(moving),
            near_way_m: RandomObstacles::USUAL_NEAR_WAY_M,
            free_ends_m: RandomObstacles::USUAL_FREE_ENDS_M,
        })
    }

    /// Returns the robot as the scenes name it: a file by its path from their folder.
    fn robot_in(&self, folder: &Path) -> Result<String, ScenesError> {
        find_robot(&self.robot, Path::new("")).map_err(ScenesError::Robot)?;
        if Robot::by_name(&self.robot).is_some() {
            return Ok(self.robot.clone());
        }
        let path = from_folder(folder, &resolved(Path::new(&self.robot), "robot")?)?;
        Ok(path.to_string_lossy().into_owned())
    }
}

/// Returns the absolute path without links and `..`. The part that does not exist yet stays as it
/// is.
fn resolved(path: &Path, field: &'static str) -> Result<PathBuf, ScenesError> {
    let absolute = std::path::absolute(path).map_err(|reason| ScenesError::Path {
        field,
        path: path.to_owned(),
        reason,
    })?;
    for ancestor in absolute.ancestors() {
        if let Ok(found) = ancestor.canonicalize() {
            let rest = absolute.strip_prefix(ancestor).unwrap_or(Path::new(""));
            return Ok(if rest.as_os_str().is_empty() { found } else { found.join(rest) });
        }
    }
    Ok(absolute)
}

/// Returns the path from a folder to a file; both are resolved.
fn from_folder(folder: &Path, file: &Path) -> Result<PathBuf, ScenesError> {
    if file.to_str().is_none() {
        return Err(ScenesError::Unnameable { path: file.to_owned() });
    }
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    // The file is on another drive.
    if common == 0 {
        return Ok(file.to_owned());
    }
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    Ok(up.chain(file.components().skip(common)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_between_folders() {
        let way = |folder: &str, file: &str| {
            from_folder(Path::new(folder), Path::new(file)).unwrap().display().to_string()
        };
        assert_eq!(way("/a/b", "/a/b/c.yaml"), "c.yaml");
        assert_eq!(way("/a/b/d/e", "/a/b/c/c.yaml"), "../../c/c.yaml");
        assert_eq!(way("/x", "/a/c.yaml"), "../a/c.yaml");
    }
}
