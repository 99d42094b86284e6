//! A core at a heading and a position on a grid. All lengths are in cells.

use super::core::Core;
use crate::geometry::{Point, Pose, Segment, outline};
use crate::map::GridFrame;

/// A core rotated to a heading: its vertices relative to the centre of rotation, in the axes of
/// the grid \[cells\].
#[derive(Clone, Debug, Default)]
pub(crate) struct Turned {
    pub(super) vertices: Vec<Point>,
    /// The vertices that are farthest to the left, to the right, down and up; the centre if it is
    /// alone.
    pub(super) left: Point,
    pub(super) right: Point,
    pub(super) lowest: Point,
    pub(super) highest: Point,
}

/// Pose of a core on a grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<'a> {
    /// The centre of rotation \[cells\].
    pub(crate) origin: Point,
    pub(crate) turned: &'a Turned,
}

impl Turned {
    /// Rotates a core so that its x axis points along `ahead`, whose length is one metre
    /// \[cells\].
    pub(crate) fn turn(&mut self, core: &Core<'_>, ahead: Point) {
        let left = Point::new(-ahead.y, ahead.x);
        let turned = |vertex: &Point| ahead * vertex.x + left * vertex.y;
        self.vertices.clear();
        self.vertices.extend(core.vertices().iter().map(turned));
        let first = self.vertices.first().copied().unwrap_or_default();
        (self.left, self.right, self.lowest, self.highest) = (first, first, first, first);
        for &vertex in &self.vertices {
            if vertex.x < self.left.x {
                self.left = vertex;
            }
            if vertex.x > self.right.x {
                self.right = vertex;
            }
            if vertex.y < self.lowest.y {
                self.lowest = vertex;
            }
            if vertex.y > self.highest.y {
                self.highest = vertex;
            }
        }
    }
}

impl Placement<'_> {
    pub(super) fn edges(&self) -> impl Iterator<Item = Segment> {
        outline(self.turned.vertices.iter().map(|&vertex| self.origin + vertex))
    }
}

/// A pose on the grid: its position \[cells\], and the direction of its x axis with a length of
/// one metre.
pub(crate) fn on_grid(pose: Pose, frame: &GridFrame) -> (Point, Point) {
    let (sin, cos) = libm::sincos(pose.theta - frame.origin().theta);
    (frame.grid_from_world(pose.point()), Point::new(cos, sin) * (1.0 / frame.resolution_m()))
}
