//! Random obstacles near the path, different for each seed.
//!
//! The same map, robots, starts, way-points, goals and seed give the same obstacles, whatever
//! stack drives among them. The *path* of a robot is a short line for its inscribed radius, from
//! the start via the way-points to the goal, around the obstacles of the map (unknown cells are
//! obstacles): the line of [`LazyThetaStar`](keyway::plan::LazyThetaStar), pulled taut.
//!
//! A static disc has its centre on a free cell within [`RandomObstacles::near_way_m`] of a path.
//! It is placed only if every robot still has a path between its successive stops (start,
//! way-points and goal), for its inscribed radius, around all static discs enlarged by
//! [`RandomObstacles::MARGIN_M`]; this check ignores other robots. A moving disc goes to and fro
//! at right angles to a path, between the obstacles of the map and the discs on both sides, at
//! most [`RandomObstacles::FARTHEST_WALK_M`] to each side; its walk is long enough for the robot
//! to pass behind it. No obstacle comes closer than [`RandomObstacles::free_ends_m`] to the
//! footprint of any robot at its stops, in any orientation. Of several robots, those without a
//! path on the map keep only their stops free.
//!
//! A position that does not fit is drawn again, [`RandomObstacles::TRIES`] times for each
//! obstacle. An obstacle without a valid position is left out, and [`Placed`] counts it.
//!
//! # Cost
//! For each robot, an any-angle search of the map, and a grid search for each attempt to place a
//! disc.

mod lane;

use super::{Episode, EpisodeRobot, Start};
use crate::report::Placed;
use crate::sim::{MovingObstacle, ObstacleMotion, WayPoints};
use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::map::{BitGrid, Cell, CellState, Clearance, GridFrame, OccupancyGrid};
use keyway::navigate::Goal;
use keyway::random::Random;
use keyway::robot::Robot;
use lane::Lane;
use serde::{Deserialize, Serialize};

/// Numbers and kinds of the obstacles that a seed gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomObstacles {
    /// Static obstacles that are not on the map; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unknown: Option<RandomUnknown>,
    /// Moving obstacles; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<RandomMoving>,
    /// Largest distance of the centre of a static disc from the path \[m\].
    #[serde(default = "usual_near_way_m")]
    pub near_way_m: f64,
    /// Smallest distance of an obstacle from the footprint at start, way-points and goal \[m\].
    #[serde(default = "usual_free_ends_m")]
    pub free_ends_m: f64,
}

/// Random static discs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomUnknown {
    /// Number of discs.
    pub count: u32,
    /// Smallest and largest radius \[m\].
    pub radius_m: [f64; 2],
}

/// Random moving discs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomMoving {
    /// Number of discs.
    pub count: u32,
    /// Smallest and largest radius \[m\].
    pub radius_m: [f64; 2],
    /// Lowest and highest speed \[m/s\].
    pub speed_mps: [f64; 2],
    /// True if they give way to robots and to each other.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub gives_way: bool,
}

fn usual_near_way_m() -> f64 {
    RandomObstacles::USUAL_NEAR_WAY_M
}

fn usual_free_ends_m() -> f64 {
    RandomObstacles::USUAL_FREE_ENDS_M
}

impl RandomObstacles {
    /// Value of [`Self::near_way_m`] if a scene does not give it \[m\].
    pub const USUAL_NEAR_WAY_M: f64 = 0.5;
    /// Value of [`Self::free_ends_m`] if a scene does not give it \[m\].
    pub const USUAL_FREE_ENDS_M: f64 = 0.5;
    /// Minimum margin of the robot as it passes a static disc \[m\]: more than a cell of most
    /// maps.
    pub const MARGIN_M: f64 = 0.1;
    /// Maximum distance of a walking obstacle from the path \[m\].
    pub const FARTHEST_WALK_M: f64 = 5.0;
    /// Number of positions that are drawn for an obstacle before it is left out.
    pub const TRIES: u32 = 100;
    /// Maximum number of obstacles of a kind.
    pub const MOST: u32 = 1000;

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        if let Some(RandomUnknown { count, radius_m }) = self.unknown {
            unless_few("unknown.count", count)?;
            ConfigError::unless_range("unknown.radius_m", radius_m)?;
        }
        if let Some(RandomMoving { count, radius_m, speed_mps, .. }) = self.moving {
            unless_few("moving.count", count)?;
            ConfigError::unless_range("moving.radius_m", radius_m)?;
            ConfigError::unless_range("moving.speed_mps", speed_mps)?;
            if speed_mps[1] > MovingObstacle::FASTEST_MPS {
                let expected = format!("no faster than {} m/s", MovingObstacle::FASTEST_MPS);
                return Err(ConfigError::must_be("moving.speed_mps[1]", &expected, speed_mps[1]));
            }
        }
        ConfigError::unless_not_negative("near_way_m", self.near_way_m)?;
        ConfigError::unless_not_negative("free_ends_m", self.free_ends_m)
    }

    /// True if another seed gives other obstacles.
    pub fn is_random(&self) -> bool {
        self.unknown.is_some_and(|kind| kind.count > 0)
            || self.moving.is_some_and(|kind| kind.count > 0)
    }

    /// Adds the obstacles of a seed to the world of an episode, and records their number there.
    ///
    /// # Errors
    /// Returns an error if a value is invalid, or a robot is too large for any map.
    pub fn put_into(&self, episode: &mut Episode, seed: u64) -> Result<(), ConfigError> {
        let ways: Vec<Way<'_>> = episode.robots.iter().map(Way::of).collect();
        let drawn = self.drawn(&episode.known, &ways, seed)?;
        episode.obstacles.extend(drawn.discs);
        episode.movers.extend(drawn.movers);
        episode.random = Some(drawn.placed);
        Ok(())
    }

    fn drawn(
        &self,
        known: &OccupancyGrid,
        ways: &[Way<'_>],
        seed: u64,
    ) -> Result<Drawn, ConfigError> {
        self.validate()?;
        let lanes = ways.iter().map(|way| way.lane(known, self.free_ends_m));
        let lanes = lanes.collect::<Result<_, ConfigError>>()?;
        let unknown_asked = self.unknown.map_or(0, |unknown| unknown.count);
        let moving_asked = self.moving.map_or(0, |moving| moving.count);
        let placed = Placed { unknown_asked, moving_asked, ..Placed::default() };
        let Some(mut ground) = Ground::of(known, lanes, self.near_way_m) else {
            return Ok(Drawn { placed, ..Drawn::default() });
        };
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
        let discs = ground.discs;
        let (unknown_placed, moving_placed) = (discs.len() as u32, movers.len() as u32);
        Ok(Drawn { discs, movers, placed: Placed { unknown_placed, moving_placed, ..placed } })
    }
}

/// Obstacles of a seed.
#[derive(Default)]
struct Drawn {
    discs: Vec<Disc>,
    movers: Vec<MovingObstacle>,
    placed: Placed,
}

/// Stops of a robot: start, way-points and goal.
struct Way<'a> {
    robot: &'a Robot,
    start: Start,
    via: &'a [Point],
    goal: Goal,
}

impl<'a> Way<'a> {
    fn of(robot: &'a EpisodeRobot) -> Self {
        let EpisodeRobot { robot, start, via, goal, .. } = robot;
        Self { robot, start: *start, via, goal: *goal }
    }

    fn lane(&self, known: &OccupancyGrid, free_ends_m: f64) -> Result<Lane, ConfigError> {
        let (start, goal) = (self.start.position, self.goal.position);
        let ends = [start].into_iter().chain(self.via.iter().copied()).chain([goal]);
        Lane::of(known, &self.robot.footprint, ends.collect(), free_ends_m)
    }
}

/// Names of random number streams: of this file, and of the kinds of obstacles.
const NAME: u64 = 0x6f62_7374_6163_6c65;
const STANDING: u64 = 0;
const MOVING: u64 = 1;

/// Map on which obstacles are placed.
struct Ground {
    frame: GridFrame,
    /// Obstacles of the map.
    known: BitGrid,
    /// Obstacles of the map and the cells of the discs, enlarged by the margin.
    obstacles: BitGrid,
    /// Paths, one for each robot.
    lanes: Vec<Lane>,
    near_way_m: f64,
    discs: Vec<Disc>,
}

impl Ground {
    /// Returns the map; `None` if no robot has a path on it.
    fn of(known: &OccupancyGrid, lanes: Vec<Lane>, near_way_m: f64) -> Option<Self> {
        let mut obstacles = known.occupied().clone();
        obstacles.merge(known.unknown());
        let (frame, discs) = (*known.frame(), Vec::new());
        let has_way = lanes.iter().any(Lane::has_way);
        has_way.then(|| Self {
            frame,
            known: obstacles.clone(),
            obstacles,
            lanes,
            near_way_m,
            discs,
        })
    }

    /// Places the first of [`RandomObstacles::TRIES`] drawn discs that leaves every robot a path,
    /// if any does.
    fn place(&mut self, mut draw: impl FnMut(&Self) -> Option<Disc>) {
        for _ in 0..RandomObstacles::TRIES {
            let Some(disc) = draw(self) else { continue };
            let larger = Disc { radius_m: disc.radius_m + RandomObstacles::MARGIN_M, ..disc };
            let covered = self.free_cells_of(&larger);
            self.lanes.iter_mut().for_each(|lane| lane.set(&covered, CellState::Occupied));
            if self.lanes.iter_mut().all(Lane::still_has_way) {
                for &cell in &covered {
                    self.obstacles.set(cell, true);
                }
                self.discs.push(disc);
                return;
            }
            self.lanes.iter_mut().for_each(|lane| lane.set(&covered, CellState::Free));
        }
    }

    /// Draws a static disc near the path; `None` if its position is not allowed.
    fn standing(&self, kind: &RandomUnknown, random: &mut Random) -> Option<Disc> {
        let radius_m = random.between(kind.radius_m);
        let (_, at, across) = self.on_way(random)?;
        let aside_m = random.between([-self.near_way_m, self.near_way_m]);
        let disc = Disc::new(at + across * aside_m, radius_m);
        let is_free = |cell| !self.known.get(cell);
        let is_on_ground = self.frame.cell_from_world(disc.centre).is_some_and(is_free);
        let leaves_ends = self.leave_ends(radius_m, |end| end.distance(disc.centre));
        (is_on_ground && leaves_ends).then_some(disc)
    }

    /// Draws a disc that moves across the path; `None` if its position is not allowed.
    fn moving(&self, kind: &RandomMoving, random: &mut Random) -> Option<MovingObstacle> {
        let radius_m = random.between(kind.radius_m);
        let speed_mps = random.between(kind.speed_mps);
        let (lane, at, across) = self.on_way(random)?;
        let first = if random.is_chosen(0.5) { across } else { across * -1.0 };
        let to = self.walk(at, first, radius_m)?;
        let fro = self.walk(at, first * -1.0, radius_m)?;
        // Minimum length of the walk: the robot can pass behind the disc at either end.
        let least_m = 2.0 * (lane.inscribed_m + RandomObstacles::MARGIN_M);
        let middle = to.lerp(fro, 0.5);
        let length_m = to.distance(fro);
        let leaves_ends = self.leave_ends(radius_m, |end| {
            let along_m = (end - middle).dot(first).clamp(-0.5 * length_m, 0.5 * length_m);
            end.distance(middle + first * along_m)
        });
        if !(leaves_ends && length_m >= least_m) {
            return None;
        }
        // A closed walk along a line: to one end, back past its start to the other end, and back.
        let motion = WayPoints::around(vec![at, to, fro], speed_mps).ok()?;
        let motion =
            if kind.gives_way { ObstacleMotion::GivesWay } else { ObstacleMotion::WayPoints }(
                motion,
            );
        MovingObstacle::new(radius_m, motion).ok()
    }

    /// Farthest position from `at` in a direction that a disc reaches without contact; `None` if it
    /// does not fit at `at`.
    fn walk(&self, at: Point, direction: Point, radius_m: f64) -> Option<Point> {
        let step_m = 0.5 * self.frame.resolution_m();
        let steps = (RandomObstacles::FARTHEST_WALK_M / step_m) as u32;
        let place = |i: u32| at + direction * (f64::from(i) * step_m);
        let places = (0..=steps).map(place);
        places.take_while(|&place| self.has_room(place, radius_m)).last()
    }

    /// True if a disc at a position touches neither the obstacles of the map nor another disc.
    fn has_room(&self, place: Point, radius_m: f64) -> bool {
        let is_beside = |disc: &Disc| disc.centre.distance(place) >= disc.radius_m + radius_m;
        Clearance::new(&self.frame, &self.known).is_clear_point(place, radius_m)
            && self.discs.iter().all(is_beside)
    }

    /// Draws a position on a robot's path, uniformly over all paths, with the direction across the
    /// path there.
    fn on_way(&self, random: &mut Random) -> Option<(&Lane, Point, Point)> {
        let all_m: f64 = self.lanes.iter().map(|lane| lane.way.length_m()).sum();
        let mut s_m = random.unit() * all_m;
        let is_on = |lane: &&Lane| {
            let is_on = lane.has_way() && s_m <= lane.way.length_m();
            if !is_on {
                s_m -= lane.way.length_m();
            }
            is_on
        };
        let lane = self.lanes.iter().find(is_on)?;
        let at = lane.way.at_length(s_m)?;
        let mut from_m = 0.0;
        let segment = lane.way.segments().find(|segment| {
            from_m += segment.length();
            from_m >= s_m && segment.length() > 0.0
        })?;
        let along = (segment.b - segment.a) * (1.0 / segment.length());
        Some((lane, at, Point::new(-along.y, along.x)))
    }

    /// True if a disc leaves the stops of all robots free; `apart_m` returns the smallest
    /// distance of a stop from the disc's centre.
    fn leave_ends(&self, radius_m: f64, apart_m: impl Fn(Point) -> f64) -> bool {
        self.lanes.iter().all(|lane| lane.leaves_ends(radius_m, &apart_m))
    }

    /// Returns the cells that a disc touches and that contain no obstacle yet.
    fn free_cells_of(&self, disc: &Disc) -> Vec<Cell> {
        let frame = &self.frame;
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
        let is_free = |cell: &Cell| frame.contains(*cell) && !self.obstacles.get(*cell);
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
