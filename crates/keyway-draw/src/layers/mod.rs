//! Layers of map pictures. To add a new kind, add a file here with a type that implements
//! [`Layer`].

mod caption;
mod cells;
mod discs;
mod driven;
mod elusive;
mod estimated;
mod fan;
mod lines;
mod movers;
mod points;
mod polygons;
mod search;
mod sensors;
mod walked;

pub use caption::Caption;
pub use cells::CellTint;
pub use discs::HatchedDiscs;
pub(crate) use driven::{DRIVEN_WIDTH_PX, casing};
pub use driven::{DrivenPath, Footprints};
pub use elusive::ElusiveObstacles;
pub use estimated::EstimatedMovers;
pub use fan::Fan;
pub use lines::PathLine;
pub use movers::Movers;
pub use points::{EndMark, GoalMark, Hits, NumberedEnds, OtherGoals, Points, StartMark};
pub use polygons::Polygons;
pub use search::{Meeting, SearchNodes, SearchTrace, TraceStyle};
pub use sensors::Sensors;
pub use walked::WalkedGround;

use crate::canvas::Canvas;
use crate::view::Extent;

/// Drawing order of a layer, from back to front. Layers of one depth are drawn in the order in
/// which they were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Depth {
    /// The map itself.
    Ground,
    /// Tints of free cells.
    Tint,
    /// Expanded and open nodes of a search.
    Search,
    /// Cells with measurements.
    Cells,
    /// Paths.
    Paths,
    /// Points of interest along paths.
    Points,
    /// Driven trajectories.
    Driven,
    /// Outlines of the robot.
    Robot,
    /// Obstacles that are not on the map; they are translucent.
    Obstacles,
    /// Start, goal and other markers.
    Markers,
}

/// A layer that can be drawn on a map.
pub trait Layer {
    /// Returns its position in the drawing order.
    fn depth(&self) -> Depth;

    /// Enlarges the shown part of the world so that it contains the layer. Layers of cells need
    /// not do this: they are within the map.
    fn extend(&self, _extent: &mut Extent) {}

    /// Draws the layer, and adds it to the legend if something was drawn.
    fn draw(&self, canvas: &mut Canvas<'_>);
}
