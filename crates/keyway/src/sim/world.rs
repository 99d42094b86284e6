//! What really stands and moves in the world.

use crate::geometry::{Point, Pose};
use crate::map::{BitGrid, Clearance, GridFrame, OccupancyGrid};
use crate::robot::Footprint;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A round obstacle that stands, or moves in a straight line at a constant speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Centre at time 0 in the world frame \[m\].
    pub centre: Point,
    /// Radius \[m\].
    pub radius_m: f64,
    /// Velocity in the world frame \[m/s\].
    #[serde(default)]
    pub velocity_mps: Point,
}

/// The true obstacles: squares of a grid, which stand, and circles that no map has.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    frame: GridFrame,
    squares: BitGrid,
    circles: Vec<Circle>,
}

/// What a robot may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Obstacle {
    /// An obstacle cell's square.
    Square,
    /// The circle of this index in [`World::circles`].
    Circle(usize),
    /// The border of the map, which no footprint may leave.
    Border,
    /// The robot of this index among those that drive ([`super::simulate`]).
    Robot(usize),
}

/// A world at one instant.
#[derive(Clone, Copy, Debug)]
pub struct WorldAt<'a> {
    world: &'a World,
    t_s: f64,
}

/// Why a world cannot be made.
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
    /// A circle without a finite centre or velocity, or whose radius is negative or not finite.
    #[error(
        "circle {index} needs a finite centre, a finite velocity and a radius of at least 0, got ({}, {}), \
         ({}, {}) m/s and {radius_m} m", centre.x, centre.y, velocity_mps.x, velocity_mps.y
    )]
    Circle {
        /// Its index.
        index: usize,
        /// Its centre \[m\].
        centre: Point,
        /// Its radius \[m\].
        radius_m: f64,
        /// Its velocity \[m/s\].
        velocity_mps: Point,
    },
}

impl Circle {
    /// A circle that stands.
    pub const fn standing(centre: Point, radius_m: f64) -> Self {
        Self { centre, radius_m, velocity_mps: Point::new(0.0, 0.0) }
    }

    /// Where it is at a time: standing there.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Self {
        Self::standing(self.centre + self.velocity_mps * t_s, self.radius_m)
    }

    /// Distance from a point to the circle at time 0 \[m\]; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        (self.centre.distance(point) - self.radius_m).max(0.0)
    }

    fn is_usable(&self) -> bool {
        let has_radius = self.radius_m >= 0.0 && self.radius_m.is_finite();
        has_radius && self.centre.is_finite() && self.velocity_mps.is_finite()
    }
}

impl World {
    /// The squares of the set cells of `squares` (a grid of `frame`'s size), and circles.
    ///
    /// # Errors
    /// When the grid has a different size, or a circle is not valid.
    pub fn new(
        frame: GridFrame,
        squares: BitGrid,
        circles: Vec<Circle>,
    ) -> Result<Self, WorldError> {
        check_size(&frame, &squares)?;
        if let Some(index) = circles.iter().position(|circle| !circle.is_usable()) {
            let Circle { centre, radius_m, velocity_mps } = circles[index];
            return Err(WorldError::Circle { index, centre, radius_m, velocity_mps });
        }
        Ok(Self { frame, squares, circles })
    }

    /// A world in which a known map is right: its occupied cells (unknown ones hold nothing), and
    /// circles that it does not have.
    ///
    /// # Errors
    /// When a circle is not valid.
    pub fn from_known(known: &OccupancyGrid, circles: Vec<Circle>) -> Result<Self, WorldError> {
        Self::new(*known.frame(), known.occupied().clone(), circles)
    }

    /// The same world with the set cells of `hidden` as further obstacles.
    ///
    /// # Errors
    /// When the grid does not have the size of the map.
    pub fn with_hidden(mut self, hidden: &BitGrid) -> Result<Self, WorldError> {
        check_size(&self.frame, hidden)?;
        let last = hidden.width() as i32 - 1;
        for y in 0..hidden.height() as i32 {
            for x in hidden.ones_in_span(y, 0, last) {
                self.squares.fill_span(y, x, x);
            }
        }
        Ok(self)
    }

    /// Where the grid of squares lies; its rectangle is the map that no footprint may leave.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Cells whose squares are obstacles.
    pub const fn squares(&self) -> &BitGrid {
        &self.squares
    }

    /// Round obstacles.
    pub fn circles(&self) -> &[Circle] {
        &self.circles
    }

    /// The world at a time.
    pub const fn at(&self, t_s: f64) -> WorldAt<'_> {
        WorldAt { world: self, t_s }
    }

    /// No obstacle moves faster than this \[m/s\].
    pub fn fastest_mps(&self) -> f64 {
        self.circles.iter().map(|circle| circle.velocity_mps.norm()).fold(0.0, f64::max)
    }

    fn clearance(&self) -> Clearance<'_> {
        Clearance::new(&self.frame, &self.squares)
    }
}

impl<'a> WorldAt<'a> {
    /// What stands and moves there.
    pub const fn world(&self) -> &'a World {
        self.world
    }

    /// The round obstacles, where they are.
    pub fn circles(&self) -> impl Iterator<Item = Circle> + 'a {
        let t_s = self.t_s;
        self.world.circles.iter().map(move |circle| circle.at(t_s))
    }

    /// Exact distance from a footprint at a pose to the nearest obstacle \[m\], 0 when it touches one;
    /// `reach_m` when nothing is nearer than that. Costs the rows within reach and one step per circle.
    pub fn distance(&self, footprint: &Footprint, pose: Pose, reach_m: f64) -> f64 {
        let to_circles = self.circles().map(|circle| to_circle(footprint, pose, &circle));
        let nearest_m = to_circles.fold(reach_m, f64::min);
        footprint.distance_m(pose, &self.world.clearance(), nearest_m)
    }

    /// Distance from a footprint at a pose to the map's border \[m\], negative when it leaves the map.
    pub fn border_distance(&self, footprint: &Footprint, pose: Pose) -> f64 {
        footprint.to_border_m(pose, &self.world.clearance())
    }

    /// What is nearest to a footprint, the map's border included (ties: the border, then squares, then
    /// the circle of the lowest index).
    pub(super) fn nearest(&self, footprint: &Footprint, pose: Pose) -> Obstacle {
        let border = (self.border_distance(footprint, pose), Obstacle::Border);
        let squares = footprint.distance_m(pose, &self.world.clearance(), f64::INFINITY);
        let circles = self.circles().enumerate();
        let circles = circles.map(|(i, c)| (to_circle(footprint, pose, &c), Obstacle::Circle(i)));
        let others = std::iter::once((squares, Obstacle::Square)).chain(circles);
        others.fold(border, |best, next| if next.0 < best.0 { next } else { best }).1
    }
}

/// Distance from a footprint at a pose to a circle at time 0; 0 when they meet.
fn to_circle(footprint: &Footprint, pose: Pose, circle: &Circle) -> f64 {
    let (core, radius_m) = footprint.core();
    (core.distance_to_m(pose, circle.centre) - circle.radius_m - radius_m).max(0.0)
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
mod tests {
    use super::*;
    use crate::map::Cell;

    fn circle(x: f64, y: f64, radius_m: f64) -> Circle {
        Circle::standing(Point::new(x, y), radius_m)
    }

    fn point() -> Footprint {
        Footprint::circle(0.0).unwrap()
    }

    #[test]
    fn distances_by_hand() {
        let known = OccupancyGrid::from_ascii(&["?....", ".....", "#...."]);
        let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
        let within = |world: &World, x, y, reach_m| {
            world.at(0.0).distance(&point(), Pose::new(x, y, 0.0), reach_m)
        };
        let at = |x, y| within(&world, x, y, 10.0);
        assert_eq!(at(2.0, 0.5), 1.0);
        assert_eq!(at(3.0, 2.0), 0.5);
        assert_eq!(at(4.2, 2.0), 0.0);
        assert_eq!(within(&world, 3.0, 2.0, 0.2), 0.2);
        // Unknown is not occupied: the nearest is the square (0, 0), 1.5 m below.
        assert_eq!(at(0.5, 2.5), 1.5);
        let mut hidden = BitGrid::new(5, 3, true);
        hidden.set(Cell::new(0, 2), true);
        let world = world.with_hidden(&hidden).unwrap();
        assert_eq!(within(&world, 0.5, 2.5, 10.0), 0.0);
        assert_eq!(world.squares().count_ones(), 2);
    }

    #[test]
    fn the_border_and_the_nearest() {
        let known = OccupancyGrid::from_ascii(&[".....", ".....", "#...."]);
        let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
        let border = |x, y| world.at(0.0).border_distance(&point(), Pose::new(x, y, 0.0));
        assert_eq!((border(2.0, 2.25), border(5.5, 1.0)), (0.75, -0.5));
        let nearest = |x, y| world.at(0.0).nearest(&point(), Pose::new(x, y, 0.0));
        assert_eq!(nearest(2.5, 2.9), Obstacle::Border);
        assert_eq!(nearest(3.4, 1.9), Obstacle::Circle(0));
        assert_eq!(nearest(1.2, 0.9), Obstacle::Square);
        // A box 1.2 m ahead of its centre is nearest to what stands there.
        let ahead = [[0.0, 0.1], [0.0, -0.1], [1.2, -0.1], [1.2, 0.1]];
        let ahead = Footprint::polygon(ahead.map(Point::from).to_vec()).unwrap();
        assert_eq!(world.at(0.0).nearest(&ahead, Pose::new(2.2, 2.0, 0.0)), Obstacle::Circle(0));
        let gap_m = world.at(0.0).distance(&ahead, Pose::new(2.2, 2.0, 0.0), 9.0);
        assert!((gap_m - 0.1).abs() < 1e-12);
    }

    #[test]
    fn circles_move_with_time() {
        let known = OccupancyGrid::from_ascii(&[".....", ".....", "....."]);
        let mover = Circle { velocity_mps: Point::new(0.5, -0.25), ..circle(1.0, 2.0, 0.5) };
        let world = World::from_known(&known, vec![mover, circle(4.5, 0.5, 0.1)]).unwrap();
        assert!((world.fastest_mps() - 0.3125_f64.sqrt()).abs() < 1e-15);
        let gap = |t_s| world.at(t_s).distance(&point(), Pose::new(3.0, 2.0, 0.0), 9.0);
        assert_eq!(gap(0.0), 1.5);
        // At (2, 1.5) after 2 s, and at (3, 1) after 4 s.
        assert!((gap(2.0) - (1.25_f64.sqrt() - 0.5)).abs() < 1e-15);
        assert_eq!(gap(4.0), 0.5);
        assert_eq!(world.at(4.0).nearest(&point(), Pose::new(3.0, 1.7, 0.0)), Obstacle::Circle(0));
    }

    #[test]
    fn refuses_what_cannot_be() {
        let frame = *OccupancyGrid::from_ascii(&["....."]).frame();
        let other = BitGrid::new(4, 1, false);
        let size = World::new(frame, other.clone(), vec![]).unwrap_err();
        assert!(size.to_string().starts_with("a grid of 4 x 1 cells"));
        let world = World::new(frame, BitGrid::new(5, 1, false), vec![]).unwrap();
        assert_eq!(world.with_hidden(&other), Err(size));
        let endless =
            Circle { velocity_mps: Point::new(0.0, f64::INFINITY), ..circle(0.0, 0.0, 1.0) };
        for bad in [circle(f64::NAN, 0.0, 1.0), circle(0.0, 0.0, -1.0), endless] {
            let circles = vec![circle(0.0, 0.0, 0.0), bad];
            let error = World::new(frame, BitGrid::new(5, 1, false), circles).unwrap_err();
            assert!(matches!(error, WorldError::Circle { index: 1, .. }), "{error}");
        }
    }
}
