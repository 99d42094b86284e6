//! Scene files.

use crate::drive::{episode_of, scene_error};
use crate::error::{Kind, PageError};
use crate::map::{MapFacts, Opened, cells_of, facts, open_file, part};
use crate::message::{Message, json};
use keyway::geometry::{Disc, Point};
use keyway_lab::scenes::{BarnRequest, NamedScene};
use keyway_sim::episode::{Episode, EpisodeRules};
use keyway_sim::scene_files::{GroundShape, SceneFile, SceneMap, UnknownDisc, scene_from_bytes};
use keyway_sim::worlds::GeneratedMap;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// `{"ask": "open_scene", "name", "seed"}`: opens a scene and its map. The parts are the scene
/// file by its name, and the files of its map, unless the scene has a `[world]`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpenScene {
    /// The scene file (TOML).
    pub name: String,
    /// Replaces the scene's seed.
    pub seed: Option<u64>,
}

/// `{"ask": "barn_scenes", "name"}`: the scenes of a table of BARN cylinders, which is the part
/// of that name. The answer is a list of [`SceneText`].
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarnScenes {
    /// The table (CSV) with the columns `world`, `x`, `y` and `radius` \[m\].
    pub name: String,
}

/// A scene as a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SceneText {
    /// Its name.
    pub name: String,
    /// The scene (TOML).
    pub text: String,
}

/// Facts about an open scene. The part `cells` is as for a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneFacts {
    /// The map.
    pub map: MapFacts,
    /// True if the map is generated from the seed.
    pub is_generated: bool,
    /// True if the drive depends on the seed.
    pub is_random: bool,
    /// The seed.
    pub seed: u64,
    /// Its description.
    pub description: Option<String>,
    /// The robots.
    pub robots: Vec<SceneRobot>,
    /// Discs that are not on the map, `[x, y, radius]` \[m\].
    pub discs: Vec<[f64; 3]>,
    /// Polygons that are not on the map \[m\].
    pub polygons: Vec<Vec<Point>>,
    /// Occupied cells that are not on the map: column, row.
    pub hidden_cells: Vec<[i32; 2]>,
    /// Moving obstacles at the start, `[x, y, radius]` \[m\].
    pub movers: Vec<[f64; 3]>,
}

/// A robot of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneRobot {
    /// Its start \[m\].
    pub start: Point,
    /// Its waypoints, in order \[m\].
    pub via: Vec<Point>,
    /// Its goal \[m\].
    pub goal: Point,
    /// Name of its stack.
    pub stack: String,
}

/// Generates the scenes of a BARN table.
pub(crate) fn barn_scenes(ask: &BarnScenes, message: &Message) -> Result<Message, PageError> {
    let blame = |error: &dyn std::fmt::Display| PageError::new(Kind::Input, error).field("name");
    let path = Path::new(&ask.name);
    let bytes = part(message, path).map_err(|error| blame(&error))?;
    let scenes =
        BarnRequest::scenes_from_bytes(path, bytes, false).map_err(|error| blame(&error))?;
    let text =
        |NamedScene { file, scene }: NamedScene| SceneText { name: file, text: text(&scene) };
    Ok(Message::new(json(&scenes.into_iter().map(text).collect::<Vec<_>>())))
}

/// Serialises a BARN scene. A general TOML writer would make the module 5 % larger.
fn text(scene: &SceneFile) -> String {
    let description = scene.description.as_deref().unwrap_or_default();
    let mut lines = vec![
        "version = 2".to_owned(),
        format!("description = {description:?}"),
        format!("robot = {:?}", scene.robot),
    ];
    if let (Some(start), Some(goal)) = (scene.start, scene.goal) {
        let (at, heading) = (start.position, start.heading_rad.unwrap_or_default());
        lines.push(format!("start = [{:?}, {:?}, {:?}]", at.x, at.y, heading.to_degrees()));
        lines.push(format!("goal = [{:?}, {:?}]", goal.position.x, goal.position.y));
    }
    lines.push("\n[rules]\narrival = \"passing\"".to_owned());
    let EpisodeRules { goal_tolerance_m, time_limit_s, .. } = scene.rules;
    let values = [("goal_tolerance_m", goal_tolerance_m), ("time_limit_s", time_limit_s)];
    let given = values.into_iter().filter_map(|(name, value)| Some((name, value?)));
    lines.extend(given.map(|(name, value)| format!("{name} = {value:?}")));
    if let Some(GeneratedMap { width_m, height_m, resolution_m, origin, .. }) = &scene.world {
        lines.push(format!("\n[world]\nwidth_m = {width_m:?}\nheight_m = {height_m:?}"));
        lines.push(format!("resolution_m = {resolution_m:?}"));
        lines.push(format!("origin = [{:?}, {:?}]", origin.x, origin.y));
    }
    for unknown in &scene.unknown {
        if let GroundShape::Disc(UnknownDisc { position: Point { x, y }, radius_m }) = unknown.shape
        {
            lines.push(format!("\n[[unknown]]\nposition = [{x:?}, {y:?}]"));
            lines.push(format!("radius_m = {radius_m:?}"));
        }
    }
    lines.join("\n") + "\n"
}

/// Opens a scene.
pub(crate) fn open_scene(
    ask: &OpenScene,
    message: &Message,
) -> Result<(Opened, Message), PageError> {
    let path = Path::new(&ask.name);
    let bytes = part(message, path).map_err(|error| scene_error(&error))?;
    let mut scene = scene_from_bytes(path, bytes).map_err(|error| scene_error(&error))?;
    scene.seed = ask.seed.unwrap_or(scene.seed);
    let (opened, warnings) = map_of(&scene, message)?;
    let map = SceneMap { grid: opened.grid.clone(), source: opened.source.clone() };
    let episode = episode_of(&scene, map)?;
    let scene_facts = scene_facts(&scene, facts(&opened, warnings), &episode);
    Ok((opened.clone(), Message::new(json(&scene_facts)).with("cells", cells_of(&opened))))
}

/// The map of a scene: generated, or read from files.
fn map_of(scene: &SceneFile, message: &Message) -> Result<(Opened, Vec<String>), PageError> {
    if let Some(made) = scene.generated_map() {
        let SceneMap { grid, source } = made.map_err(|error| scene_error(&error))?;
        return Ok((Opened { grid, source }, Vec::new()));
    }
    let path = scene.map.as_deref().unwrap_or(Path::new(""));
    let name = path.file_name().map_or(path, Path::new);
    if part(message, name).is_err() {
        let name = name.display();
        let message = format!("its map `{name}` is missing: open both files at once");
        return Err(PageError::new(Kind::Input, message).field("scene"));
    }
    open_file(name, None, message)
}

fn scene_facts(scene: &SceneFile, map: MapFacts, episode: &Episode) -> SceneFacts {
    let disc = |disc: &Disc| [disc.centre.x, disc.centre.y, disc.radius_m];
    let robots = episode.robots.iter().map(|robot| SceneRobot {
        start: robot.start.position,
        via: robot.via.clone(),
        goal: robot.goal.position,
        stack: robot.stack_name.clone(),
    });
    SceneFacts {
        map,
        is_generated: scene.world.is_some(),
        is_random: scene.is_random(),
        seed: scene.seed,
        description: scene.description.clone(),
        robots: robots.collect(),
        discs: episode.obstacles.iter().map(disc).collect(),
        polygons: episode.polygons.iter().map(|polygon| polygon.vertices().to_vec()).collect(),
        hidden_cells: episode.hidden_cells.iter().map(|cell| [cell.x, cell.y]).collect(),
        movers: episode.movers.iter().map(|mover| disc(&mover.at(0.0))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worlds as published, with arbitrary digits.
    #[test]
    fn scenes_of_barn_are_the_same_after_writing_and_reading() {
        let table =
            b"world,x,y,radius\n0,-0.075,0.075,0.075\n0,1e-7,12.3456789012345,0.123456789\n\
            3,-2.1000000000000001,8.0,0.3\n";
        let scenes = BarnRequest::scenes_from_bytes(Path::new("worlds.csv"), table, false).unwrap();
        assert_eq!(scenes.len(), 2);
        for NamedScene { file, scene } in scenes {
            assert_eq!(SceneFile::from_toml(&text(&scene)).unwrap(), scene, "{file}");
        }
    }
}
