//! Drives through a scene.

use crate::error::{Kind, PageError};
use crate::map::Opened;
use crate::message::{Message, json};
use crate::route::robot;
use keyway::files::robot_in_place;
use keyway::geometry::{Point, Pose};
use keyway::map::Cell;
use keyway::navigate::{Navigator, Stack};
use keyway::robot::{Footprint, Robot};
use keyway_sim::episode::{
    Cycle, CycleReport, Episode, EpisodeObserver, RobotReport, RunOptions, watch_episode,
};
use keyway_sim::scene_files::{SceneFile, SceneMap};
use keyway_sim::sim::MovingObstacle;
use serde::{Deserialize, Serialize};

/// `{"ask": "drive", "scene", "seed"}`: drives all robots of a scene. A scene without a world of
/// its own is on the map that is open.
///
/// The answer is a [`Driven`].
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// A scene file (TOML).
    pub scene: String,
    /// In the place of the scene's seed.
    pub seed: Option<u64>,
    /// Leave out the cycles: only reports.
    pub reports_only: bool,
}

/// A drive. The parts hold, for each robot `i` in turn: `poses i`, of each cycle x, y, heading
/// (three numbers of 64 bits); `hits i`, of each cycle the number of points where its scans met
/// something, then two numbers each (all of 32 bits); `sensed i`, of each cycle the number of cells
/// that were sensed first in it, then column and row of each (32 bits); `movers i`, of each cycle
/// the place of each moving obstacle (two numbers of 32 bits).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Driven {
    /// `keyway.navigate/4` of each robot.
    pub reports: Vec<RobotReport>,
    /// `keyway.cycle/1` of each robot's cycles.
    pub cycles: Vec<Vec<CycleReport>>,
    /// Routes of each robot: the number of the cycle from which on it drives along it, and its
    /// points \[m\].
    pub routes: Vec<Vec<(u64, Vec<Point>)>>,
    /// The outline of each robot.
    pub outlines: Vec<Outline>,
    /// The radius of each moving obstacle \[m\].
    pub mover_radii_m: Vec<f64>,
}

/// The outline of a robot: a disc, or a polygon in the robot's frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outline {
    /// Radius of the disc \[m\]; `null` for a polygon.
    pub radius_m: Option<f64>,
    /// Vertices of the polygon \[m\]; none for a disc.
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
    let scene_error =
        |error: &dyn std::fmt::Display| PageError::new(Kind::Input, error).field("scene");
    let mut scene = SceneFile::from_toml(&ask.scene).map_err(|error| scene_error(&error))?;
    scene.seed = ask.seed.unwrap_or(scene.seed);
    let map = match (scene.generated_map(), opened) {
        (Some(map), _) => map.map_err(|error| scene_error(&error))?,
        (None, Some(Opened { grid, source })) => {
            SceneMap { grid: grid.clone(), source: source.clone() }
        }
        (None, None) => return Err(Opened::none()),
    };
    let episode = scene.episode(map, |robot, stack| {
        let robot = named_robot(robot)?;
        let stack = Stack::by_name(stack, &robot).ok_or_else(|| no_stack(stack))?;
        Ok((robot, stack))
    });
    drive_episode(&episode.map_err(|Refused(error)| error)?, ask)
}

/// A scene's error as one of the page.
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

fn drive_episode(episode: &Episode, ask: &Drive) -> Result<Message, PageError> {
    let count = if ask.reports_only { 0 } else { episode.robots.len() };
    let mut films = vec![Film::default(); count];
    let report = watch_episode(episode, RunOptions::default(), &mut films)
        .map_err(|error| PageError::new(Kind::Input, error).field("scene"))?;
    let mut driven = Driven {
        reports: report.robots,
        cycles: Vec::new(),
        routes: Vec::new(),
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
        let named = [("poses", film.poses), ("hits", film.hits), ("sensed", film.sensed)];
        parts.extend(named.map(|(name, bytes)| (format!("{name} {i}"), bytes)));
    }
    Ok(Message { head: json(&driven), parts })
}

/// The cycles of a robot, to be looked at.
#[derive(Clone, Default)]
struct Film {
    cycles: Vec<CycleReport>,
    routes: Vec<(u64, Vec<Point>)>,
    poses: Vec<u8>,
    hits: Vec<u8>,
    sensed: Vec<u8>,
    known: Vec<Cell>,
    /// [`Navigator::routes_planned`] at the last cycle.
    planned: Option<u32>,
}

impl Film {
    fn note_route(&mut self, cycle: u64, navigator: &Navigator) {
        let planned = navigator.routes_planned();
        if self.planned.replace(planned) != Some(planned) {
            let points = navigator.route().map(|route| route.smoothed.points().to_vec());
            self.routes.push((cycle, points.unwrap_or_default()));
        }
    }

    /// The places of all movers in each cycle.
    fn places_of(&self, movers: &[MovingObstacle]) -> Vec<u8> {
        let places = |cycle: &CycleReport| {
            let t_s = cycle.t_s;
            movers.iter().map(move |mover| mover.at(t_s).centre)
        };
        let numbers = self.cycles.iter().flat_map(places).flat_map(|at| [at.x as f32, at.y as f32]);
        numbers.flat_map(f32::to_le_bytes).collect()
    }

    fn note_hits(&mut self, cycle: &Cycle<'_>) {
        let observation = cycle.observation;
        let scans = observation.scans.iter();
        let points: Vec<Point> =
            scans.flat_map(|one| one.scan.hits(observation.pose.compose(one.mount))).collect();
        self.hits.extend((points.len() as u32).to_le_bytes());
        let numbers = points.iter().flat_map(|point| [point.x as f32, point.y as f32]);
        self.hits.extend(numbers.flat_map(f32::to_le_bytes));
    }

    fn note_sensed(&mut self, navigator: &Navigator) {
        let now: Vec<Cell> = navigator.sensed().ones().collect();
        let is_new =
            |cell: &&Cell| self.known.binary_search_by_key(&key(**cell), |c| key(*c)).is_err();
        let new: Vec<Cell> = now.iter().filter(is_new).copied().collect();
        self.sensed.extend((new.len() as u32).to_le_bytes());
        self.sensed.extend(new.iter().flat_map(|cell| [cell.x, cell.y]).flat_map(i32::to_le_bytes));
        self.known = now;
    }
}

/// The order of the cells of a grid, row by row.
const fn key(cell: Cell) -> (i32, i32) {
    (cell.y, cell.x)
}

impl EpisodeObserver for Film {
    fn started(&mut self, navigator: &Navigator) {
        self.note_route(0, navigator);
    }

    fn decided(&mut self, cycle: &Cycle<'_>) {
        let Pose { x, y, theta } = cycle.observation.pose;
        self.poses.extend([x, y, theta].into_iter().flat_map(f64::to_le_bytes));
        self.note_hits(cycle);
        self.note_sensed(cycle.navigator);
        self.note_route(cycle.index, cycle.navigator);
        self.cycles.push(CycleReport::of(cycle, &cycle.navigator.explain()));
    }
}
