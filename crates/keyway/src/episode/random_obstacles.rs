//! Obstacles near the way, other ones for each seed.
//!
//! The same map, robot, ends and seed give the same obstacles, whatever drives among them. The *way* is a short line for the robot's
//! inscribed radius, from the start by the way-points to the goal, around what the map shows (unknown cells are obstacles): that of
//! [`LazyThetaStar`], pulled tight.
//!
//! A disc that stands has its centre on a free cell within [`RandomObstacles::near_way_m`] of the way. It is only placed where the robot still has a
//! way from each end to the next, by its inscribed radius around all discs that stand, these larger by
//! [`RandomObstacles::MARGIN_M`]. One that moves walks to and fro across the way, at right angles to it, between what the map shows and the
//! discs to both sides, at most [`RandomObstacles::FARTHEST_WALK_M`] to each; its walk is so long that the robot can pass
//! behind it. Nothing comes nearer to the ends than [`RandomObstacles::free_ends_m`] from the footprint, however it is turned.
//!
//! A place that does not fit is drawn again, [`RandomObstacles::TRIES`] times for each obstacle; what finds none is left out, and [`Placed`] says so.
//!
//! # Cost
//! A search of the map in any direction, and one from cell to cell for each try of a disc.

use super::Episode;
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline};
use crate::map::{Cell, CellState, Edit, LayerConfig, SearchMap};
use crate::plan::{GlobalPlanner, Jps, LazyThetaStar, Plan};
use crate::random::Random;
use crate::report::Placed;
use crate::search::{Query, Workspace};
use crate::sim::{Circle, Motion, Mover, WayPoints};
use crate::smooth::{Smoother, Taut};
use serde::{Deserialize, Serialize};

/// How many obstacles of which kind a seed gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomObstacles {
    /// Those that stand and are not on the map; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknown: Option<RandomUnknown>,
    /// Those that move; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<RandomMoving>,
    /// No centre of a disc that stands is farther from the way \[m\].
    #[serde(default = "usual_near_way_m")]
    pub near_way_m: f64,
    /// Nothing comes nearer to the footprint at start, way-points and goal \[m\].
    #[serde(default = "usual_free_ends_m")]
    pub free_ends_m: f64,
}

/// Random discs that stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomUnknown {
    /// How many.
    pub count: u32,
    /// Least and largest radius \[m\].
    pub radius_m: [f64; 2],
}

/// Random discs that move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomMoving {
    /// How many.
    pub count: u32,
    /// Least and largest radius \[m\].
    pub radius_m: [f64; 2],
    /// Lowest and highest speed \[m/s\].
    pub speed_mps: [f64; 2],
}

fn usual_near_way_m() -> f64 {
    RandomObstacles::USUAL_NEAR_WAY_M
}

fn usual_free_ends_m() -> f64 {
    RandomObstacles::USUAL_FREE_ENDS_M
}

impl RandomObstacles {
    /// [`Self::near_way_m`] where a scene does not say it \[m\].
    pub const USUAL_NEAR_WAY_M: f64 = 0.5;
    /// [`Self::free_ends_m`] where a scene does not say it \[m\].
    pub const USUAL_FREE_ENDS_M: f64 = 0.5;
    /// What the robot has beside it where it passes a disc that stands, at least \[m\]: more than a cell of most maps.
    pub const MARGIN_M: f64 = 0.1;
    /// No obstacle walks farther from the way \[m\].
    pub const FARTHEST_WALK_M: f64 = 5.0;
    /// Places that are drawn for an obstacle until it is left out.
    pub const TRIES: u32 = 100;
    /// More obstacles of a kind are a mistake.
    pub const MOST: u32 = 1000;

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        if let Some(RandomUnknown { count, radius_m }) = self.unknown {
            unless_few("unknown.count", count)?;
            ConfigError::unless_range("unknown.radius_m", radius_m)?;
        }
        if let Some(RandomMoving { count, radius_m, speed_mps }) = self.moving {
            unless_few("moving.count", count)?;
            ConfigError::unless_range("moving.radius_m", radius_m)?;
            ConfigError::unless_range("moving.speed_mps", speed_mps)?;
            if speed_mps[1] > Mover::FASTEST_MPS {
                let expected = format!("no faster than {} m/s", Mover::FASTEST_MPS);
                return Err(ConfigError::must_be("moving.speed_mps[1]", &expected, speed_mps[1]));
            }
        }
        ConfigError::unless_not_negative("near_way_m", self.near_way_m)?;
        ConfigError::unless_not_negative("free_ends_m", self.free_ends_m)
    }

    /// Puts the obstacles of a seed into an episode, and says in it how many there are.
    ///
    /// # Errors
    /// When a value cannot be used, or the robot is too large for any map.
    pub fn put_into(&self, episode: &mut Episode, seed: u64) -> Result<(), ConfigError> {
        self.validate()?;
        let unknown_asked = self.unknown.map_or(0, |unknown| unknown.count);
        let moving_asked = self.moving.map_or(0, |moving| moving.count);
        let mut placed = Placed { unknown_asked, moving_asked, ..Placed::default() };
        if let Some(mut ground) = Ground::of(episode, self)? {
            let unknown = self.unknown.iter().flat_map(|kind| (0..kind.count).map(move |_| kind));
            for (i, kind) in (0..).zip(unknown) {
                let random = &mut Random::stream(seed, &[NAME, STANDING, i]);
                ground.place(|ground| ground.standing(kind, random));
            }
            let moving = self.moving.iter().flat_map(|kind| (0..kind.count).map(move |_| kind));
            let mut movers = Vec::new();
            for (i, kind) in (0..).zip(moving) {
                let random = &mut Random::stream(seed, &[NAME, MOVING, i]);
                movers.extend((0..Self::TRIES).find_map(|_| ground.moving(kind, random)));
            }
            placed.unknown_placed = ground.discs.len() as u32;
            placed.moving_placed = movers.len() as u32;
            episode.obstacles.append(&mut ground.discs);
            episode.movers.append(&mut movers);
        }
        episode.random = Some(placed);
        Ok(())
    }
}

/// Names of streams of random numbers: that of this file, and those of the kinds of obstacles.
const NAME: u64 = 0x6f62_7374_6163_6c65;
const STANDING: u64 = 0;
const MOVING: u64 = 1;

/// How exactly the bends of the way are followed \[m\].
const FLAT_M: f64 = 0.01;

/// Where obstacles are placed.
struct Ground {
    /// Around what the map shows and, larger by the margin, the discs.
    map: SearchMap,
    /// What the map shows alone.
    known: SearchMap,
    ends: Vec<Point>,
    way: Polyline,
    /// From the ends to the rim of any obstacle \[m\].
    free_ends_m: f64,
    near_way_m: f64,
    inscribed_m: f64,
    discs: Vec<Circle>,
    workspace: Workspace,
}

impl Ground {
    /// `None` where there is no way on the map.
    fn of(episode: &Episode, config: &RandomObstacles) -> Result<Option<Self>, ConfigError> {
        let footprint = &episode.robot.footprint;
        let inscribed_m = footprint.inscribed_radius_m();
        // The robot stands at its ends, however near they are to something.
        let layers = LayerConfig {
            clearance_m: inscribed_m,
            free_ends_m: inscribed_m,
            ..LayerConfig::default()
        };
        let mut map =
            SearchMap::new(&episode.known, layers).map_err(|error| error.within("robot"))?;
        let inner = episode.via.iter().copied();
        let ends: Vec<Point> = std::iter::once(episode.start.position)
            .chain(inner)
            .chain([episode.goal.position])
            .collect();
        let cells: Vec<Cell> = ends.iter().map(|&end| map.frame().cell_near(end)).collect();
        map.free_ends(&cells);
        let mut ground = Self {
            known: map.clone(),
            map,
            ends,
            way: Polyline::default(),
            free_ends_m: config.free_ends_m + footprint.circumscribed_radius_m(),
            near_way_m: config.near_way_m,
            inscribed_m,
            discs: Vec::new(),
            workspace: Workspace::default(),
        };
        let Some(legs) = ground.legs(&LazyThetaStar::default()) else { return Ok(None) };
        let clearance = ground.map.clearance();
        let taut = |leg| Taut.smooth(leg, &clearance, inscribed_m).path.flattened(FLAT_M);
        let points = legs.iter().flat_map(|leg| taut(leg).points().to_vec()).collect();
        ground.way = Polyline::new(points).merged();
        Ok((ground.way.length_m() > 0.0).then_some(ground))
    }

    /// A line from each end to the next; `None` where there is none.
    fn legs(&mut self, planner: &dyn GlobalPlanner) -> Option<Vec<PlannedLine>> {
        let mut plan = Plan::default();
        let mut leg = |pair: &[Point]| {
            let [from, to] = [pair[0], pair[1]].map(|end| self.map.frame().cell_from_world(end));
            let query = Query::new(from?, to?);
            planner.plan_into(&self.map, &query, &mut self.workspace, None, &mut plan).ok()?;
            Some(plan.line(&self.map, pair[0], pair[1]))
        };
        self.ends.windows(2).map(&mut leg).collect()
    }

    /// Places the first disc of [`RandomObstacles::TRIES`] that leaves a way, if any.
    fn place(&mut self, mut draw: impl FnMut(&Self) -> Option<Circle>) {
        for _ in 0..RandomObstacles::TRIES {
            let Some(disc) = draw(self) else { continue };
            let larger = Circle { radius_m: disc.radius_m + RandomObstacles::MARGIN_M, ..disc };
            let covered = self.free_cells_of(&larger);
            let edits =
                |state| covered.iter().map(|&cell| Edit { cell, state }).collect::<Vec<_>>();
            self.map.apply(&edits(CellState::Occupied));
            if self.legs(&Jps).is_some() {
                self.discs.push(disc);
                return;
            }
            self.map.apply(&edits(CellState::Free));
        }
    }

    /// A disc near the way, if it is where it may be.
    fn standing(&self, kind: &RandomUnknown, random: &mut Random) -> Option<Circle> {
        let radius_m = random.between(kind.radius_m);
        let (at, across) = self.on_way(random)?;
        let aside_m = random.between([-self.near_way_m, self.near_way_m]);
        let disc = Circle::standing(at + across * aside_m, radius_m);
        let is_free = |cell| !self.known.obstacles().get(cell);
        let is_on_ground = self.map.frame().cell_from_world(disc.centre).is_some_and(is_free);
        (is_on_ground && self.leaves_ends(disc.centre, radius_m)).then_some(disc)
    }

    /// A disc that walks across the way, if it may.
    fn moving(&self, kind: &RandomMoving, random: &mut Random) -> Option<Mover> {
        let radius_m = random.between(kind.radius_m);
        let speed_mps = random.between(kind.speed_mps);
        let (at, across) = self.on_way(random)?;
        let first = if random.is_chosen(0.5) { across } else { across * -1.0 };
        let to = self.walk(at, first, radius_m)?;
        let fro = self.walk(at, first * -1.0, radius_m)?;
        // As much is free behind it when it is at one end.
        let least_m = 2.0 * (self.inscribed_m + RandomObstacles::MARGIN_M);
        let middle = to.lerp(fro, 0.5);
        let length_m = to.distance(fro);
        let is_free = self.ends.iter().all(|&end| {
            let along_m = (end - middle).dot(first).clamp(-0.5 * length_m, 0.5 * length_m);
            end.distance(middle + first * along_m) >= self.free_ends_m + radius_m
        });
        if !(is_free && length_m >= least_m) {
            return None;
        }
        // A closed course along a line: to one end, past where it began to the other, and back.
        let motion = WayPoints::around(vec![at, to, fro], speed_mps).ok()?;
        Mover::new(radius_m, Motion::WayPoints(motion)).ok()
    }

    /// The farthest place from `at` in a direction to which a disc walks through nothing; `None` where it cannot be at `at`.
    fn walk(&self, at: Point, direction: Point, radius_m: f64) -> Option<Point> {
        let step_m = 0.5 * self.map.frame().resolution_m();
        let steps = (RandomObstacles::FARTHEST_WALK_M / step_m) as u32;
        let place = |i: u32| at + direction * (f64::from(i) * step_m);
        let places = (0..=steps).map(place);
        places.take_while(|&place| self.has_room(place, radius_m)).last()
    }

    /// Whether a disc at a place touches neither what the map shows nor another disc.
    fn has_room(&self, place: Point, radius_m: f64) -> bool {
        let is_beside = |disc: &Circle| disc.centre.distance(place) >= disc.radius_m + radius_m;
        self.known.clearance().is_clear_point(place, radius_m) && self.discs.iter().all(is_beside)
    }

    /// A place on the way, all equally likely, and the direction across the way there.
    fn on_way(&self, random: &mut Random) -> Option<(Point, Point)> {
        let s_m = random.unit() * self.way.length_m();
        let at = self.way.at_length(s_m)?;
        let mut from_m = 0.0;
        let segment = self.way.segments().find(|segment| {
            from_m += segment.length();
            from_m >= s_m && segment.length() > 0.0
        })?;
        let along = (segment.b - segment.a) * (1.0 / segment.length());
        Some((at, Point::new(-along.y, along.x)))
    }

    fn leaves_ends(&self, centre: Point, radius_m: f64) -> bool {
        let reach_m = radius_m + self.free_ends_m;
        self.ends.iter().all(|end| end.distance(centre) >= reach_m)
    }

    /// Cells that a disc touches and that hold no obstacle yet.
    fn free_cells_of(&self, disc: &Circle) -> Vec<Cell> {
        let frame = self.map.frame();
        let centre = frame.grid_from_world(disc.centre);
        let reach = disc.radius_m / frame.resolution_m();
        let span = |at: f64| (at - reach).floor() as i32..=(at + reach).floor() as i32;
        let touches = |cell: &Cell| {
            let aside =
                |at: f64, low: i32| (f64::from(low) - at).max(at - f64::from(low + 1)).max(0.0);
            let (x, y) = (aside(centre.x, cell.x), aside(centre.y, cell.y));
            x * x + y * y <= reach * reach
        };
        let cells = span(centre.y).flat_map(|y| span(centre.x).map(move |x| Cell::new(x, y)));
        let is_free = |cell: &Cell| frame.contains(*cell) && !self.map.obstacles().get(*cell);
        cells.filter(|cell| touches(cell) && is_free(cell)).collect()
    }
}

fn unless_few(path: &str, count: u32) -> Result<(), ConfigError> {
    if count <= RandomObstacles::MOST {
        return Ok(());
    }
    let expected = format!("at most {}", RandomObstacles::MOST);
    Err(ConfigError::must_be(path, &expected, f64::from(count)))
}

#[cfg(test)]
mod tests;
