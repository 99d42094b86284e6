//! Drives through a scene.

use crate::error::{Kind, PageError};
use crate::film::Film;
use crate::map::Opened;
use crate::message::{Message, json};
use crate::route::robot;
use keyway::files::robot_in_place;
use keyway::geometry::Point;
use keyway::navigate::Stack;
use keyway::robot::{Footprint, Robot};
use keyway_lab::batch::{Record, Row, RunId};
use keyway_lab::results::digest;
use keyway_sim::episode::{CycleReport, Episode, RobotReport, RunOptions, watch_episode};
use keyway_sim::scene_files::{SceneFile, SceneMap};
use serde::{Deserialize, Serialize};

/// `{"ask": "drive", "scene", ..}`: drives all robots of a scene. A scene without a `[world]`
/// uses the open map.
///
/// The answer is a [`Driven`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// A scene file (TOML).
    pub scene: String,
    /// Its name in rows of tables.
    pub name: String,
    /// Replaces the scene's seed.
    pub seed: Option<u64>,
    /// Name of the stack that replaces those of all robots.
    pub stack: Option<String>,
    /// Use the open map even if the scene has a `[world]`.
    pub on_open_map: bool,
    /// Omit the cycles and return only reports.
    pub reports_only: bool,
    /// Omit the reasons of decisions, which cost several times as much as the drive.
    pub without_reasons: bool,
}

/// A drive. It has these parts for each robot `i`; all numbers have 32 bits unless stated:
///
/// - `poses i`: x, y and heading of each cycle (64 bits).
/// - `hits i`: for each cycle the number of hit points of the scans, then two numbers for each.
/// - `sensed i`: for each cycle the number of newly sensed cells, then column and row of each.
/// - `movers i`: for each cycle the position of each moving obstacle, two numbers.
/// - `fans i`: for each cycle the number of candidate velocities, then
///   [`FAN_NUMBERS`](crate::film::FAN_NUMBERS) numbers for each: its fate (0 admissible, 1
///   chosen, 2 second best, 3 collision, 4 refused by another rule), its score, and points \[m\]
///   of its trajectory.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Driven {
    /// `keyway.navigate/4` of each robot.
    pub reports: Vec<RobotReport>,
    /// The row of the run in the results of a batch.
    pub row: Row,
    /// `keyway.cycle/1` of each robot's cycles.
    pub cycles: Vec<Vec<CycleReport>>,
    /// Routes of each robot: the first cycle on the route, and its points \[m\].
    pub routes: Vec<Vec<(u64, Vec<Point>)>>,
    /// Refusals of the stop rule, for each robot: the cycle, and the reason as text.
    pub refusals: Vec<Vec<(u64, String)>>,
    /// The footprint of each robot.
    pub outlines: Vec<Outline>,
    /// The radius of each moving obstacle \[m\].
    pub mover_radii_m: Vec<f64>,
}

/// The footprint of a robot: a disc, or a polygon in the robot's frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outline {
    /// Radius of the disc \[m\]; `null` for a polygon.
    pub radius_m: Option<f64>,
    /// Vertices of the polygon \[m\]; empty for a disc.
    pub vertices: Vec<Point>,
}

impl From<&Footprint> for Outline {
    fn from(footprint: &Footprint) -> Self {
        match footprint {
            Footprint::Circle(circle) => {
                Self { radius_m: Some(circle.radius_m()), vertices: Vec::new() }
            }
            Footprint::Polygon(polygon) => {
                Self { radius_m: None, vertices: polygon.vertices().to_vec() }
            }
        }
    }
}

/// Drives a scene.
pub(crate) fn drive(ask: &Drive, opened: Option<&Opened>) -> Result<Message, PageError> {
    let mut scene = scene_of(&ask.scene)?;
    scene.seed = ask.seed.unwrap_or(scene.seed);
    if let Some(stack) = &ask.stack {
        scene.stack.clone_from(stack);
        scene.robots.iter_mut().for_each(|robot| robot.stack = Some(stack.clone()));
    }
    let map = match (scene.generated_map().filter(|_| !ask.on_open_map), opened) {
        (Some(map), _) => map.map_err(|error| scene_error(&error))?,
        (None, Some(Opened { grid, source })) => {
            SceneMap { grid: grid.clone(), source: source.clone() }
        }
        (None, None) => return Err(Opened::none()),
    };
    let episode = episode_of(&scene, map)?;
    drive_episode(&episode, ask, &scene)
}

/// Parses a scene.
pub(crate) fn scene_of(text: &str) -> Result<SceneFile, PageError> {
    SceneFile::from_toml(text).map_err(|error| scene_error(&error))
}

pub(crate) fn scene_error(error: &dyn std::fmt::Display) -> PageError {
    PageError::new(Kind::Input, error).field("scene")
}

/// The episode of a scene, with bundled robots and stacks.
pub(crate) fn episode_of(scene: &SceneFile, map: SceneMap) -> Result<Episode, PageError> {
    let episode = scene.episode(map, |robot, stack| {
        let robot = named_robot(robot)?;
        let stack = Stack::by_name(stack, &robot).ok_or_else(|| no_stack(stack))?;
        Ok((robot, stack))
    });
    episode.map_err(|Refused(error)| error)
}

/// Converts the error of a scene into that of the page.
struct Refused(PageError);

impl From<keyway_sim::scene_files::SceneError> for Refused {
    fn from(error: keyway_sim::scene_files::SceneError) -> Self {
        Self(PageError::new(Kind::Input, error).field("scene"))
    }
}

impl From<PageError> for Refused {
    fn from(error: PageError) -> Self {
        Self(error)
    }
}

fn named_robot(name: &str) -> Result<Robot, PageError> {
    if name.trim_start().starts_with('{') {
        let blame = |error| PageError::new(Kind::Config, error).field("robot");
        return robot_in_place(name).map_err(blame);
    }
    robot(name)
}

fn no_stack(name: &str) -> PageError {
    let message =
        format!("there is no stack `{name}`, expected one of {}", Stack::NAMES.join(", "));
    PageError::new(Kind::Config, message).field("stack")
}

fn drive_episode(episode: &Episode, ask: &Drive, scene: &SceneFile) -> Result<Message, PageError> {
    let count = if ask.reports_only { 0 } else { episode.robots.len() };
    let mut films = vec![Film::new(!ask.without_reasons); count];
    let report = watch_episode(episode, RunOptions::default(), &mut films)
        .map_err(|error| PageError::new(Kind::Input, error).field("scene"))?;
    let stack = episode.robots.first().map_or("", |robot| &robot.stack_name);
    let inputs = digest(format!("{} {stack} {}", ask.scene, scene.seed).as_bytes());
    let id = RunId { scene: &ask.name, stack, seed: scene.seed, digest: &inputs };
    // A page has no clock.
    let record = Record::of(id, (episode, &report), 0.0);
    let mut driven = Driven {
        reports: report.robots,
        row: record.run,
        cycles: Vec::new(),
        routes: Vec::new(),
        refusals: Vec::new(),
        outlines: episode.robots.iter().map(|one| Outline::from(&one.robot.footprint)).collect(),
        mover_radii_m: episode.movers.iter().map(|mover| mover.at(0.0).radius_m).collect(),
    };
    let mut parts = Vec::new();
    for (i, film) in films.into_iter().enumerate() {
        let run = driven.reports[i].run.as_ref();
        let movers = run.map_or_else(|| episode.movers.clone(), |run| run.movers(&episode.movers));
        parts.push((format!("movers {i}"), film.places_of(&movers)));
        driven.cycles.push(film.cycles);
        driven.routes.push(film.routes);
        driven.refusals.push(film.refusals);
        let named = [
            ("poses", film.poses),
            ("hits", film.hits),
            ("sensed", film.sensed),
            ("fans", film.fans),
        ];
        parts.extend(named.map(|(name, bytes)| (format!("{name} {i}"), bytes)));
    }
    Ok(Message { head: json(&driven), parts })
}
