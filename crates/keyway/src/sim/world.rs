//! What really stands in the world.

use crate::geometry::Point;
use crate::map::{BitGrid, Clearance, GridFrame, OccupancyGrid};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A round obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Centre in the world frame \[m\].
    pub centre: Point,
    /// Radius \[m\].
    pub radius_m: f64,
}

/// The true obstacles: squares of a grid, and circles that no map has. They do not move.
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
    /// A circle without a finite centre, or whose radius is negative or not finite.
    #[error(
        "circle {index} needs a finite centre and a radius of at least 0, got ({}, {}) and \
         {radius_m} m", centre.x, centre.y
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

impl Circle {
    /// Distance from a point \[m\]; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        (self.centre.distance(point) - self.radius_m).max(0.0)
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
        let unusable = |circle: &Circle| {
            !(circle.centre.is_finite() && circle.radius_m >= 0.0 && circle.radius_m.is_finite())
        };
        if let Some(index) = circles.iter().position(unusable) {
            let Circle { centre, radius_m } = circles[index];
            return Err(WorldError::Circle { index, centre, radius_m });
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

    /// Exact distance from a point to the nearest obstacle \[m\], 0 inside one; `reach_m` when
    /// nothing is nearer than that. Costs the rows within reach and one step per circle.
    pub fn distance(&self, point: Point, reach_m: f64) -> f64 {
        let nearest = self.circles.iter().map(|c| c.distance(point)).fold(reach_m, f64::min);
        Clearance::new(&self.frame, &self.squares).of_point(point, nearest)
    }

    /// Distance from a point to the map's border \[m\], negative outside: at least what a footprint
    /// of that radius needs.
    pub fn border_distance(&self, point: Point) -> f64 {
        let grid = self.frame.grid_from_world(point);
        let (width, height) = (f64::from(self.frame.width()), f64::from(self.frame.height()));
        let cells = grid.x.min(width - grid.x).min(grid.y).min(height - grid.y);
        cells * self.frame.resolution_m()
    }

    /// What is nearest to a point, the map's border included (ties: the border, then squares, then
    /// the circle of the lowest index).
    pub(super) fn nearest(&self, point: Point) -> Obstacle {
        let border = (self.border_distance(point), Obstacle::Border);
        let squares = Clearance::new(&self.frame, &self.squares).of_point(point, f64::INFINITY);
        let circles =
            self.circles.iter().enumerate().map(|(i, c)| (c.distance(point), Obstacle::Circle(i)));
        let others = std::iter::once((squares, Obstacle::Square)).chain(circles);
        others.fold(border, |best, next| if next.0 < best.0 { next } else { best }).1
    }
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
        Circle { centre: Point::new(x, y), radius_m }
    }

    #[test]
    fn distances_by_hand() {
        let known = OccupancyGrid::from_ascii(&["?....", ".....", "#...."]);
        let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
        let at = |x, y| world.distance(Point::new(x, y), 10.0);
        assert_eq!(at(2.0, 0.5), 1.0);
        assert_eq!(at(3.0, 2.0), 0.5);
        assert_eq!(at(4.2, 2.0), 0.0);
        assert_eq!(world.distance(Point::new(3.0, 2.0), 0.2), 0.2);
        // Unknown is not occupied: the nearest is the square (0, 0), 1.5 m below.
        assert_eq!(at(0.5, 2.5), 1.5);
        let mut hidden = BitGrid::new(5, 3, true);
        hidden.set(Cell::new(0, 2), true);
        let world = world.with_hidden(&hidden).unwrap();
        assert_eq!(world.distance(Point::new(0.5, 2.5), 10.0), 0.0);
        assert_eq!(world.squares().count_ones(), 2);
    }

    #[test]
    fn the_border_and_the_nearest() {
        let known = OccupancyGrid::from_ascii(&[".....", ".....", "#...."]);
        let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
        assert_eq!(world.border_distance(Point::new(2.0, 2.25)), 0.75);
        assert_eq!(world.border_distance(Point::new(5.5, 1.0)), -0.5);
        assert_eq!(world.nearest(Point::new(2.5, 2.9)), Obstacle::Border);
        assert_eq!(world.nearest(Point::new(3.4, 1.9)), Obstacle::Circle(0));
        assert_eq!(world.nearest(Point::new(1.2, 0.9)), Obstacle::Square);
    }

    #[test]
    fn refuses_what_cannot_be() {
        let frame = *OccupancyGrid::from_ascii(&["....."]).frame();
        let other = BitGrid::new(4, 1, false);
        let size = World::new(frame, other.clone(), vec![]).unwrap_err();
        assert!(size.to_string().starts_with("a grid of 4 x 1 cells"));
        let world = World::new(frame, BitGrid::new(5, 1, false), vec![]).unwrap();
        assert_eq!(world.with_hidden(&other), Err(size));
        for bad in [circle(f64::NAN, 0.0, 1.0), circle(0.0, 0.0, -1.0)] {
            let circles = vec![circle(0.0, 0.0, 0.0), bad];
            let error = World::new(frame, BitGrid::new(5, 1, false), circles).unwrap_err();
            assert!(matches!(error, WorldError::Circle { index: 1, .. }), "{error}");
        }
    }
}
