//! True stationary and moving obstacles of a world.

use super::free_squares::FreeSquares;
use super::sweep::TOLERANCE_M;
use super::{ElusiveObstacle, MovingObstacle, StandingPolygon};
use keyway::geometry::{Disc, Point, Pose};
use keyway::map::{BitGrid, Cell, Clearance, GridFrame, OccupancyGrid};
use keyway::robot::Footprint;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The true obstacles: squares of a grid, unmapped static discs and polygons, and moving
/// obstacles.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    frame: GridFrame,
    squares: BitGrid,
    /// Squares that are not on the map, if any.
    hidden: Option<BitGrid>,
    free: FreeSquares,
    discs: Vec<Disc>,
    polygons: Vec<StandingPolygon>,
    elusive: Vec<ElusiveObstacle>,
    movers: Vec<MovingObstacle>,
}

/// Object that a robot may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Obstacle {
    /// An obstacle cell's square.
    Square,
    /// The square of a cell that is not on the map ([`World::with_hidden`]).
    HiddenSquare,
    /// The circle of this index in [`World::discs`].
    Circle(usize),
    /// The polygon of this index in [`World::polygons`].
    Polygon(usize),
    /// The obstacle of this index in [`World::elusive`].
    Elusive(usize),
    /// The moving obstacle of this index in [`World::movers`].
    Mover(usize),
    /// The border of the map, which no footprint may leave.
    Border,
    /// The robot of this index in the simulation ([`super::simulate`]).
    Robot(usize),
}

/// A world at one instant.
#[derive(Clone, Copy, Debug)]
pub struct WorldAt<'a> {
    world: &'a World,
    t_s: f64,
}

/// Reason why a world is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A grid of obstacles does not have the size of the frame.
    #[error(
        "a grid of {width} x {height} cells does not fit a map of {map_width} x {map_height} cells"
    )]
    Size {
        /// Columns of the grid.
        width: u32,
        /// Rows of the grid.
        height: u32,
        /// Columns of the map.
        map_width: u32,
        /// Rows of the map.
        map_height: u32,
    },
    /// A cell that is not on the map.
    #[error("cell {cell} of an unknown obstacle is not on the map of {width} x {height} cells")]
    Cell {
        /// The cell.
        cell: Cell,
        /// Columns of the map.
        width: u32,
        /// Rows of the map.
        height: u32,
    },
    /// A circle whose centre is not finite, or whose radius is negative or not finite.
    #[error(
        "circle {index} needs a finite centre and a radius of at least 0, got ({}, {}) and {radius_m} m",
        centre.x, centre.y
    )]
    Circle {
        /// Its index.
        index: usize,
        /// Its centre \[m\].
        centre: Point,
        /// Its radius \[m\].
        radius_m: f64,
    },
}

impl World {
    /// A world with the squares of the set cells of `squares` (a grid of `frame`'s size) and
    /// discs. Costs a few operations per cell, and stores a byte for each, with which a sensor's
    /// beams skip free cells.
    ///
    /// # Errors
    /// Returns an error if the grid has a different size, or a circle is not valid.
    pub fn new(frame: GridFrame, squares: BitGrid, discs: Vec<Disc>) -> Result<Self, WorldError> {
        check_size(&frame, &squares)?;
        if let Some(index) = discs.iter().position(|circle| !circle.is_valid()) {
            let Disc { centre, radius_m } = discs[index];
            return Err(WorldError::Circle { index, centre, radius_m });
        }
        let free = FreeSquares::around(&squares);
        let (polygons, elusive, movers) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { frame, squares, hidden: None, free, discs, polygons, elusive, movers })
    }

    /// A world in which a known map is correct: its occupied cells (unknown cells are free), and
    /// unmapped discs.
    ///
    /// # Errors
    /// Returns an error if a circle is not valid.
    pub fn from_known(known: &OccupancyGrid, discs: Vec<Disc>) -> Result<Self, WorldError> {
        Self::new(*known.frame(), known.occupied().clone(), discs)
    }

    /// Adds the set cells of `hidden` as further obstacles.
    ///
    /// # Errors
    /// Returns an error if the grid does not have the size of the map.
    pub fn with_hidden(mut self, hidden: &BitGrid) -> Result<Self, WorldError> {
        check_size(&self.frame, hidden)?;
        let (width, height) = (hidden.width(), hidden.height());
        let own = self.hidden.get_or_insert_with(|| BitGrid::new(width, height, false));
        for y in 0..height as i32 {
            for x in hidden.ones_in_span(y, 0, width as i32 - 1) {
                self.squares.fill_span(y, x, x);
                own.fill_span(y, x, x);
            }
        }
        self.free = FreeSquares::around(&self.squares);
        Ok(self)
    }

    /// Adds further stationary obstacles.
    #[must_use]
    pub fn with_polygons(mut self, polygons: Vec<StandingPolygon>) -> Self {
        self.polygons.extend(polygons);
        self
    }

    /// Adds obstacles that are present for a limited time, or that sensors miss.
    #[must_use]
    pub fn with_elusive(mut self, elusive: Vec<ElusiveObstacle>) -> Self {
        self.elusive.extend(elusive);
        self
    }

    /// Adds further moving obstacles.
    #[must_use]
    pub fn with_movers(mut self, movers: Vec<MovingObstacle>) -> Self {
        self.movers.extend(movers);
        self
    }

    pub(super) fn movers_mut(&mut self) -> &mut [MovingObstacle] {
        &mut self.movers
    }

    /// Frame of the grid of squares; its rectangle is the map that no footprint may leave.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Cells whose squares are obstacles.
    pub const fn squares(&self) -> &BitGrid {
        &self.squares
    }

    pub(super) const fn free(&self) -> &FreeSquares {
        &self.free
    }

    /// Round stationary obstacles.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// Stationary polygons.
    pub fn polygons(&self) -> &[StandingPolygon] {
        &self.polygons
    }

    /// Obstacles that are present for a limited time, or that sensors miss.
    pub fn elusive(&self) -> &[ElusiveObstacle] {
        &self.elusive
    }

    /// Moving obstacles.
    pub fn movers(&self) -> &[MovingObstacle] {
        &self.movers
    }

    fn elusive_at(&self, t_s: f64) -> impl Iterator<Item = &ElusiveObstacle> {
        self.elusive.iter().filter(move |elusive| elusive.stands_at(t_s))
    }

    /// The world at a time.
    pub const fn at(&self, t_s: f64) -> WorldAt<'_> {
        WorldAt { world: self, t_s }
    }

    /// Exact distance from a footprint at a pose to the nearest static obstacle that is present
    /// at a time \[m\]: 0 if it touches one, `reach_m` if none is nearer than that.
    pub(super) fn distance_to_standing(
        &self,
        footprint: &Footprint,
        pose: Pose,
        t_s: f64,
        reach_m: f64,
    ) -> f64 {
        let nearer = |known_m, circle| to_circle(footprint, pose, circle, known_m);
        let nearest_m = self.discs.iter().fold(reach_m, nearer);
        let nearer = |known_m, polygon| to_polygon(footprint, pose, polygon, known_m);
        let nearest_m = self.polygons.iter().fold(nearest_m, nearer);
        let nearer = |known_m, it: &ElusiveObstacle| it.distance_m(footprint, pose, known_m);
        let nearest_m = self.elusive_at(t_s).fold(nearest_m, nearer);
        let (core, radius_m) = footprint.core();
        // The swing and the radius bound the reach of the footprint from its centre of rotation.
        if self.free_around_m(pose.point()) - core.swing_m() - radius_m >= nearest_m {
            return nearest_m;
        }
        footprint.distance_m(pose, &self.clearance(), nearest_m)
    }

    /// Lower bound of the distance from a point to any obstacle square \[m\].
    fn free_around_m(&self, point: Point) -> f64 {
        let cell = self.frame.cell_from_world(point);
        // The nearest obstacle cell begins beyond the free ones. By rounding the point may lie
        // just outside its cell.
        let free = cell.map_or(0.0, |cell| f64::from(self.free.steps(cell) - 1) - 1e-6);
        free * self.frame.resolution_m()
    }

    /// Distance from a footprint at a pose to the map's border \[m\], negative if it leaves the
    /// map.
    pub(super) fn border_distance(&self, footprint: &Footprint, pose: Pose) -> f64 {
        footprint.to_border_m(pose, &self.clearance())
    }

    /// True if an obstacle that is absent before a cycle is present in it and overlaps a
    /// footprint at a pose.
    pub(super) fn appears_onto(
        &self,
        footprint: &Footprint,
        pose: Pose,
        [before_s, t_s]: [f64; 2],
    ) -> bool {
        let mut appeared = self.elusive_at(t_s).filter(|it| !it.stands_at(before_s));
        appeared.any(|it| it.distance_m(footprint, pose, TOLERANCE_M) < TOLERANCE_M)
    }

    /// Static obstacle nearest to a footprint, including the map's border. Ties go to the border,
    /// then to unmapped squares, then to other squares, then to the circle, the polygon and the
    /// elusive obstacle of the lowest index.
    pub(super) fn nearest_standing(&self, footprint: &Footprint, pose: Pose, t_s: f64) -> Obstacle {
        let mut nearest = (self.border_distance(footprint, pose), Obstacle::Border);
        let squares_m = footprint.distance_m(pose, &self.clearance(), f64::INFINITY);
        if squares_m < nearest.0 {
            let hidden = self.hidden.as_ref().map(|hidden| Clearance::new(&self.frame, hidden));
            let to_hidden_m = |hidden| footprint.distance_m(pose, &hidden, f64::INFINITY);
            let is_hidden = hidden.is_some_and(|hidden| to_hidden_m(hidden) <= squares_m);
            let square = if is_hidden { Obstacle::HiddenSquare } else { Obstacle::Square };
            nearest = (squares_m, square);
        }
        for (index, circle) in self.discs.iter().enumerate() {
            let distance_m = to_circle(footprint, pose, circle, nearest.0);
            if distance_m < nearest.0 {
                nearest = (distance_m, Obstacle::Circle(index));
            }
        }
        for (index, polygon) in self.polygons.iter().enumerate() {
            let distance_m = to_polygon(footprint, pose, polygon, nearest.0);
            if distance_m < nearest.0 {
                nearest = (distance_m, Obstacle::Polygon(index));
            }
        }
        for (index, elusive) in self.elusive.iter().enumerate() {
            let distance_m = elusive.distance_m(footprint, pose, nearest.0);
            if elusive.stands_at(t_s) && distance_m < nearest.0 {
                nearest = (distance_m, Obstacle::Elusive(index));
            }
        }
        nearest.1
    }

    fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.squares)
    }
}

impl<'a> WorldAt<'a> {
    /// Obstacles of limited presence or visibility that are present now.
    pub fn elusive(&self) -> impl Iterator<Item = &'a ElusiveObstacle> {
        self.world.elusive_at(self.t_s)
    }

    /// The world itself.
    pub const fn world(&self) -> &'a World {
        self.world
    }

    /// Round obstacles at this time: first the stationary ones, then the moving ones.
    pub fn discs(&self) -> impl Iterator<Item = Disc> + 'a {
        let World { discs, movers, .. } = self.world;
        let t_s = self.t_s;
        discs.iter().copied().chain(movers.iter().map(move |mover| mover.at(t_s)))
    }

    /// Static obstacle nearest to a footprint, including the map's border.
    pub(super) fn nearest_standing(&self, footprint: &Footprint, pose: Pose) -> Obstacle {
        self.world.nearest_standing(footprint, pose, self.t_s)
    }

    /// Exact distance from a footprint at a pose to the nearest obstacle \[m\]: 0 if it touches
    /// one, `reach_m` if none is nearer than that. Costs the rows within reach and one step per
    /// circle.
    pub fn distance(&self, footprint: &Footprint, pose: Pose, reach_m: f64) -> f64 {
        let nearest_m = self.distance_to_movers(footprint, pose, reach_m).0;
        self.world.distance_to_standing(footprint, pose, self.t_s, nearest_m)
    }

    /// Distance from a footprint at a pose to the map's border \[m\], negative if it leaves the
    /// map.
    pub fn border_distance(&self, footprint: &Footprint, pose: Pose) -> f64 {
        self.world.border_distance(footprint, pose)
    }

    /// Distance to the nearest moving obstacle, and its index (ties: the lowest); `reach_m` if none
    /// is nearer than that.
    pub(super) fn distance_to_movers(
        &self,
        footprint: &Footprint,
        pose: Pose,
        reach_m: f64,
    ) -> (f64, Option<usize>) {
        let mut nearest = (reach_m, None);
        for (index, mover) in self.world.movers.iter().enumerate() {
            let distance_m = to_circle(footprint, pose, &mover.at(self.t_s), nearest.0);
            if distance_m < nearest.0 {
                nearest = (distance_m, Some(index));
            }
        }
        nearest
    }
}

/// Distance from a footprint at a pose to a circle: 0 if they touch, `reach_m` if they are at
/// least that far apart.
pub(super) fn to_circle(footprint: &Footprint, pose: Pose, circle: &Disc, reach_m: f64) -> f64 {
    let (core, radius_m) = footprint.core();
    let radii_m = circle.radius_m + radius_m;
    // No part of the core is farther from the centre of rotation than its swing.
    if pose.point().distance(circle.centre) - core.swing_m() - radii_m >= reach_m {
        return reach_m;
    }
    let apart_m = core.distance_to_m(pose, circle.centre) - radii_m;
    apart_m.max(0.0).min(reach_m)
}

/// Distance from a footprint at a pose to a polygon, as for [`to_circle`].
pub(super) fn to_polygon(
    footprint: &Footprint,
    pose: Pose,
    polygon: &StandingPolygon,
    reach_m: f64,
) -> f64 {
    let (other, other_pose) = polygon.placed();
    footprint.distance_to_footprint_m(pose, other, other_pose, reach_m)
}

fn check_size(frame: &GridFrame, grid: &BitGrid) -> Result<(), WorldError> {
    if (grid.width(), grid.height()) == (frame.width(), frame.height()) {
        return Ok(());
    }
    Err(WorldError::Size {
        width: grid.width(),
        height: grid.height(),
        map_width: frame.width(),
        map_height: frame.height(),
    })
}

#[cfg(test)]
mod tests;
