//! Closed polygons as lists of vertices.

use super::{Point, Segment};

/// The edges of a polygon; the closing one comes last.
pub fn outline<V>(vertices: V) -> impl Iterator<Item = Segment>
where
    V: Iterator<Item = Point> + Clone,
{
    let next = vertices.clone().skip(1).chain(vertices.clone().take(1));
    vertices.zip(next).map(|(a, b)| Segment::new(a, b))
}

/// True if a polygon contains a point: a ray to the right crosses its edges an odd number of
/// times.
pub fn holds_point(edges: impl Iterator<Item = Segment>, point: Point) -> bool {
    let crossings = edges.filter(|edge| {
        let (above_a, above_b) = (edge.a.y > point.y, edge.b.y > point.y);
        let rise = (point.y - edge.a.y) / (edge.b.y - edge.a.y);
        above_a != above_b && point.x < edge.a.x + rise * (edge.b.x - edge.a.x)
    });
    crossings.count() % 2 == 1
}
