//! A scene for each pair of start and goal in a table.

use super::rows::rows;
use super::{Named, unless_empty};
use crate::args::PairsArgs;
use crate::error::{CliError, Kind};
use crate::inputs::robot;
use keyway::geometry::Point;
use keyway::robot::Robot;
use keyway_sim::episode::{RandomMoving, RandomObstacles, RandomUnknown, Start};
use keyway_sim::scene_files::SceneFile;
use serde::Deserialize;
use std::path::{Component, Path, PathBuf};

/// Sizes of posts and boxes on the floor \[m\].
const UNKNOWN_RADIUS_M: [f64; 2] = [0.1, 0.3];
/// Sizes \[m\] and speeds \[m/s\] of people who walk about.
const MOVING_RADIUS_M: [f64; 2] = [0.2, 0.35];
const MOVING_SPEED_MPS: [f64; 2] = [0.3, 1.0];

#[derive(Deserialize)]
struct Pair {
    map: PathBuf,
    start_x_m: f64,
    start_y_m: f64,
    goal_x_m: f64,
    goal_y_m: f64,
}

/// A scene for each line, in their order.
pub(super) fn scenes(args: &PairsArgs) -> Result<Vec<Named>, CliError> {
    let pairs: Vec<Pair> = rows(&args.pairs, "PAIRS.csv")?;
    unless_empty(&pairs, &args.pairs, "PAIRS.csv")?;
    let folder = resolved(&args.out, "--out")?;
    let robot = robot_in(args, &folder)?;
    let beside = args.pairs.parent().unwrap_or(Path::new(""));
    let named = |(index, pair): (usize, &Pair)| {
        let map = resolved(&beside.join(&pair.map), "PAIRS.csv")?;
        if !map.is_file() {
            let message = format!(
                "{}: pair {index}: there is no map {}",
                args.pairs.display(),
                beside.join(&pair.map).display()
            );
            return Err(CliError::new(Kind::Input, message).field("PAIRS.csv"));
        }
        let stem = map.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let start = Point::new(pair.start_x_m, pair.start_y_m);
        let goal = Point::new(pair.goal_x_m, pair.goal_y_m);
        let scene = SceneFile {
            description: Some(format!("{stem}, pair {index}")),
            map: Some(from_folder(&folder, &map)?),
            robot: robot.clone(),
            random: random(args),
            ..SceneFile::new(Start { position: start, heading_rad: None }, goal.into())
        };
        let blame = |error| CliError::new(Kind::Input, format!("pair {index}: {error}"));
        scene.validate().map_err(|error| blame(error).field("PAIRS.csv"))?;
        Ok(Named { file: format!("{index:03}_{stem}.toml"), scene })
    };
    pairs.iter().enumerate().map(named).collect()
}

fn random(args: &PairsArgs) -> Option<RandomObstacles> {
    let unknown = RandomUnknown { count: args.unknown, radius_m: UNKNOWN_RADIUS_M };
    let moving =
        RandomMoving { count: args.moving, radius_m: MOVING_RADIUS_M, speed_mps: MOVING_SPEED_MPS };
    (args.unknown + args.moving > 0).then(|| RandomObstacles {
        unknown: (args.unknown > 0).then_some(unknown),
        moving: (args.moving > 0).then_some(moving),
        near_way_m: RandomObstacles::USUAL_NEAR_WAY_M,
        free_ends_m: RandomObstacles::USUAL_FREE_ENDS_M,
    })
}

/// The robot as the scenes name it: a file by its path from their folder.
fn robot_in(args: &PairsArgs, folder: &Path) -> Result<String, CliError> {
    robot(&args.robot, Path::new(""))?;
    if Robot::by_name(&args.robot).is_some() {
        return Ok(args.robot.clone());
    }
    let path = from_folder(folder, &resolved(Path::new(&args.robot), "--robot")?)?;
    Ok(path.to_string_lossy().into_owned())
}

/// The absolute path without links and steps upwards; what does not exist yet is below what does.
fn resolved(path: &Path, field: &str) -> Result<PathBuf, CliError> {
    let blame = |error: std::io::Error| {
        CliError::new(Kind::Input, format!("{}: {error}", path.display())).field(field)
    };
    let absolute = std::path::absolute(path).map_err(blame)?;
    for ancestor in absolute.ancestors() {
        if let Ok(found) = ancestor.canonicalize() {
            let rest = absolute.strip_prefix(ancestor).unwrap_or(Path::new(""));
            return Ok(if rest.as_os_str().is_empty() { found } else { found.join(rest) });
        }
    }
    Ok(absolute)
}

/// The way from a folder to a file; both are resolved.
fn from_folder(folder: &Path, file: &Path) -> Result<PathBuf, CliError> {
    if file.to_str().is_none() {
        let message = format!("{}: a scene cannot name this file", file.display());
        return Err(CliError::new(Kind::Input, message).field("PAIRS.csv"));
    }
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    // On another drive.
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
