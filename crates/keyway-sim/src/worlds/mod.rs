//! Maps generated from a seed: reproducible worlds of one kind, in any number.
//!
//! A [`GeneratedMap`] gives the size of a map and its obstacles; with a seed it generates an
//! [`OccupancyGrid`]. Positions are metres from the map's lower left corner, except those of
//! [`Discs`] and [`Boxes`], which are in the world frame. A cell is occupied if its centre lies
//! in an obstacle.
//!
//! ```
//! use keyway::geometry::Point;
//! use keyway_sim::worlds::{Clutter, GeneratedMap, Pattern};
//!
//! let clutter = Clutter { share: 0.2, radius_m: [0.1, 0.4] };
//! let map = GeneratedMap {
//!     obstacles: Pattern::Clutter(clutter),
//!     ..GeneratedMap::empty(10.0, 8.0, 0.05)
//! };
//! let start = Point::new(1.0, 1.0);
//! let grid = map.generate(7, &[start])?;
//! assert_eq!(grid.occupied(), map.generate(7, &[start])?.occupied());
//! # Ok::<(), keyway::ConfigError>(())
//! ```
//!
//! # Errors / cost
//! [`ConfigError`] with the field. Linear in the cells, and for [`Clutter`] in the area of its
//! discs. [`Blocks`] that cover nearly all of a map need many draws.

mod blocks;
mod boxes;
mod canvas;
mod clutter;
mod corridors;
mod discs;
mod maze;
mod mine;
mod rooms;
mod u_traps;

pub use blocks::Blocks;
pub use boxes::Boxes;
pub use clutter::Clutter;
pub use corridors::Corridors;
pub use discs::Discs;
pub use maze::Maze;
pub use mine::Mine;
pub use rooms::Rooms;
pub use u_traps::UTraps;

use canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::{Point, Pose};
use keyway::map::{GridFrame, OccupancyGrid};
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// A kind of map; each seed generates one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GeneratedMap {
    /// Width \[m\]; a whole number of cells, rounded up.
    pub width_m: f64,
    /// Height \[m\]; a whole number of cells, rounded up.
    pub height_m: f64,
    /// Side of a cell \[m\].
    pub resolution_m: f64,
    /// Lower left corner, `[x, y]` \[m\].
    #[serde(default)]
    pub origin: Point,
    /// Radius of the free space around each start, goal and way-point \[m\].
    #[serde(default = "usual_free_ends_m")]
    pub free_ends_m: f64,
    /// Obstacles on the map.
    #[serde(default, skip_serializing_if = "Pattern::is_none")]
    pub obstacles: Pattern,
}

/// Obstacles on a generated map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Pattern {
    /// Nothing.
    #[default]
    None,
    /// Discs at given positions.
    Discs(Discs),
    /// Boxes at given positions.
    Boxes(Boxes),
    /// Randomly placed discs.
    Clutter(Clutter),
    /// Randomly placed blocks of whole cells.
    Blocks(Blocks),
    /// Rooms with doors between them.
    Rooms(Rooms),
    /// A maze.
    Maze(Maze),
    /// Corridors with rooms on both sides.
    Corridors(Corridors),
    /// U-shaped obstacles, open to one side.
    UTraps(UTraps),
    /// Roadways of a mine around pillars of rock with rough sides.
    Mine(Mine),
}

impl Pattern {
    fn is_none(&self) -> bool {
        *self == Self::None
    }

    /// True if another seed gives another map.
    pub const fn is_random(&self) -> bool {
        !matches!(self, Self::None | Self::Discs(_) | Self::Boxes(_))
    }
}

fn usual_free_ends_m() -> f64 {
    GeneratedMap::USUAL_FREE_ENDS_M
}

impl GeneratedMap {
    /// Default of [`Self::free_ends_m`] in a scene \[m\].
    pub const USUAL_FREE_ENDS_M: f64 = 0.5;

    /// Largest supported map \[cells\].
    const MOST_CELLS: f64 = 1e9;

    /// An empty map with its lower left corner at (0, 0).
    pub fn empty(width_m: f64, height_m: f64, resolution_m: f64) -> Self {
        Self {
            width_m,
            height_m,
            resolution_m,
            origin: Point::default(),
            free_ends_m: Self::USUAL_FREE_ENDS_M,
            obstacles: Pattern::None,
        }
    }

    /// Generates the map of a seed, with free space around `ends`: starts, way-points and goals
    /// in the world frame.
    ///
    /// # Errors
    /// Returns an error that names the invalid field.
    pub fn generate(&self, seed: u64, ends: &[Point]) -> Result<OccupancyGrid, ConfigError> {
        self.validate()?;
        let cells = |length_m: f64| (length_m / self.resolution_m - 1e-9).ceil() as u64;
        let origin = Pose::new(self.origin.x, self.origin.y, 0.0);
        let (width, height) = (cells(self.width_m), cells(self.height_m));
        let frame = GridFrame::new(width, height, self.resolution_m, origin)
            .map_err(|error| ConfigError::new("resolution_m", error.to_string()))?;
        let mut canvas = Canvas::new(frame);
        let random = &mut Random::new(seed);
        match &self.obstacles {
            Pattern::None => {}
            Pattern::Discs(discs) => discs.draw(&mut canvas, self.origin),
            Pattern::Boxes(boxes) => boxes.draw(&mut canvas, self.origin),
            Pattern::Clutter(clutter) => clutter.draw(&mut canvas, random),
            Pattern::Blocks(blocks) => blocks.draw(&mut canvas, random),
            Pattern::Rooms(rooms) => rooms.draw(&mut canvas, random),
            Pattern::Maze(maze) => maze.draw(&mut canvas, random),
            Pattern::Corridors(corridors) => corridors.draw(&mut canvas, random),
            Pattern::UTraps(traps) => traps.draw(&mut canvas, random),
            Pattern::Mine(mine) => mine.draw(&mut canvas, random),
        }
        for &end in ends {
            canvas.clear_disc(end - self.origin, self.free_ends_m);
        }
        Ok(canvas.into_grid())
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("width_m", self.width_m)?;
        ConfigError::unless_positive("height_m", self.height_m)?;
        ConfigError::unless_positive("resolution_m", self.resolution_m)?;
        ConfigError::unless_not_negative("free_ends_m", self.free_ends_m)?;
        for (field, value) in [("origin[0]", self.origin.x), ("origin[1]", self.origin.y)] {
            if !value.is_finite() {
                return Err(ConfigError::must_be(field, "finite", value));
            }
        }
        let cells = self.width_m / self.resolution_m * (self.height_m / self.resolution_m);
        if cells > Self::MOST_CELLS {
            let expected = "larger: a map has at most 1000000000 cells";
            return Err(ConfigError::must_be("resolution_m", expected, self.resolution_m));
        }
        let (name, valid) = match &self.obstacles {
            Pattern::None => return Ok(()),
            // The errors name the disc.
            Pattern::Discs(discs) => {
                return discs.validate().map_err(|error| error.within("obstacles"));
            }
            Pattern::Boxes(boxes) => ("boxes", boxes.validate()),
            Pattern::Clutter(clutter) => ("clutter", clutter.validate()),
            Pattern::Blocks(blocks) => ("blocks", blocks.validate()),
            Pattern::Rooms(rooms) => ("rooms", rooms.validate()),
            Pattern::Maze(maze) => ("maze", maze.validate()),
            Pattern::Corridors(corridors) => ("corridors", corridors.validate()),
            Pattern::UTraps(traps) => ("u-traps", traps.validate()),
            Pattern::Mine(mine) => ("mine", mine.validate()),
        };
        valid.map_err(|error| error.within(name).within("obstacles"))
    }
}

#[cfg(test)]
mod tests;
