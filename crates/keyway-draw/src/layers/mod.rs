//! What can be put on a map. A new kind of picture is a new file here with a type that implements
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
pub use points::{GoalMark, Hits, NumberedEnds, OtherGoals, Points, StartMark};
pub use polygons::Polygons;
pub use search::{Meeting, SearchNodes, SearchTrace, TraceStyle};
pub use sensors::Sensors;
pub use walked::WalkedGround;

use crate::canvas::Canvas;
use crate::view::Extent;

/// How far in front something is drawn. Layers of one depth are drawn in the order in which they
/// were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Depth {
    /// The map itself.
    Ground,
    /// Tints of free cells.
    Tint,
    /// What a search did.
    Search,
    /// Cells that something was measured in.
    Cells,
    /// Paths.
    Paths,
    /// Points of interest along paths.
    Points,
    /// What was driven.
    Driven,
    /// Outlines of the robot.
    Robot,
    /// Obstacles that the map does not show; what is below them shines through.
    Obstacles,
    /// Start, goal and other markers.
    Markers,
}

/// Something that can be drawn on a map.
pub trait Layer {
    /// How far in front it is drawn.
    fn depth(&self) -> Depth;

    /// Grows the shown part of the world so that the layer is in it. Layers of cells need not: they
    /// lie in the map.
    fn extend(&self, _extent: &mut Extent) {}

    /// Draws it, and explains it in the legend when there was something to draw.
    fn draw(&self, canvas: &mut Canvas<'_>);
}
