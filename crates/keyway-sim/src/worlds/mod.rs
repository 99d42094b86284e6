//! Maps from a seed: as many worlds of one kind as wanted, the same for everybody.
//!
//! A [`GeneratedMap`] says how large a map is and what stands on it; with a seed it gives an [`OccupancyGrid`]. All lengths
//! are metres from the map's lower left corner; what stands is drawn by the centres of cells.
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
//! [`ConfigError`] with the field. Linear in the cells, and for [`Clutter`] in the ground that its discs cover. [`Blocks`] that are to cover
//! nearly all of a map are drawn many times over.

mod blocks;
mod canvas;
mod clutter;
mod corridors;
mod discs;
mod maze;
mod mine;
mod rooms;
mod u_traps;

pub use blocks::Blocks;
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

/// A kind of map, from which a seed makes one.
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
    /// Where the lower left corner lies, `[x, y]` \[m\].
    #[serde(default)]
    pub origin: Point,
    /// Within this distance of a start, a goal and a way-point nothing stands \[m\].
    #[serde(default = "usual_free_ends_m")]
    pub free_ends_m: f64,
    /// What stands on it.
    #[serde(default, skip_serializing_if = "Pattern::is_none")]
    pub obstacles: Pattern,
}

/// What stands on a generated map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Pattern {
    /// Nothing.
    #[default]
    None,
    /// Discs at given places.
    Discs(Discs),
    /// Discs anywhere.
    Clutter(Clutter),
    /// Blocks of whole cells anywhere.
    Blocks(Blocks),
    /// Rooms with doors between them.
    Rooms(Rooms),
    /// A maze.
    Maze(Maze),
    /// Corridors with rooms to both sides.
    Corridors(Corridors),
    /// Obstacles like a U, open to one side.
    UTraps(UTraps),
    /// Roadways of a mine around pillars of rock with rough sides.
    Mine(Mine),
}

impl Pattern {
    fn is_none(&self) -> bool {
        *self == Self::None
    }

    /// Whether another seed gives another map.
    pub const fn is_random(&self) -> bool {
        !matches!(self, Self::None | Self::Discs(_))
    }
}

fn usual_free_ends_m() -> f64 {
    GeneratedMap::USUAL_FREE_ENDS_M
}

impl GeneratedMap {
    /// [`Self::free_ends_m`] where a scene does not say it \[m\].
    pub const USUAL_FREE_ENDS_M: f64 = 0.5;

    /// Larger maps are a mistake \[cells\].
    const MOST_CELLS: f64 = 1e9;

    /// A map on which nothing stands, with its lower left corner at (0, 0).
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

    /// The map of a seed, with room around the `ends` of ways (in the world's frame).
    ///
    /// # Errors
    /// When a value cannot be used; the error names the field.
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
    /// Names the first field that cannot be used.
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
            // Its errors name the disc.
            Pattern::Discs(discs) => {
                return discs.validate().map_err(|error| error.within("obstacles"));
            }
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
