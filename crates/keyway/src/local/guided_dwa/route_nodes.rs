//! The nodes of a route.

use crate::geometry::{Point, Polyline};

/// A node of a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RouteNode {
    /// Position of the node \[m\].
    pub(super) point: Point,
    /// Arc length from the beginning of the route \[m\].
    pub(super) along_m: f64,
}

/// The points of a route at every whole `spacing_m` of arc length that lie after `from_m`, and
/// its end. A route ends with one node, even if rounding puts the last of the others there.
pub(super) fn route_nodes(
    path: &Polyline,
    spacing_m: f64,
    from_m: f64,
) -> impl Iterator<Item = RouteNode> + '_ {
    let near_m = 1e-9 * spacing_m;
    let mut number = ((from_m + near_m) / spacing_m).floor() + 1.0;
    let (mut segments, mut begin_m) = (path.segments(), 0.0);
    let mut segment = segments.next();
    let mut has_end = path.points().last().copied();
    std::iter::from_fn(move || {
        while let Some(current) = segment {
            let (length_m, along_m) = (current.length(), number * spacing_m);
            if along_m < begin_m + length_m - near_m {
                number += 1.0;
                let fraction = ((along_m - begin_m) / length_m).max(0.0);
                return Some(RouteNode { point: current.a.lerp(current.b, fraction), along_m });
            }
            begin_m += length_m;
            segment = segments.next();
        }
        let point = has_end.take()?;
        (begin_m > from_m + near_m).then_some(RouteNode { point, along_m: begin_m })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(points: &[[f64; 2]], from_m: f64) -> Vec<(f64, f64, f64)> {
        let path = Polyline::new(points.iter().map(|&p| p.into()).collect());
        let all = route_nodes(&path, 1.0, from_m);
        all.map(|node| (node.point.x, node.point.y, node.along_m)).collect()
    }

    #[test]
    fn whole_cells_and_the_end() {
        let bend = [[0., 0.], [1.5, 0.], [1.5, 0.], [1.5, 1.2]];
        assert_eq!(nodes(&bend, 0.0), [(1., 0., 1.), (1.5, 0.5, 2.), (1.5, 1.2, 2.7)]);
        assert_eq!(nodes(&bend, 1.0), [(1.5, 0.5, 2.), (1.5, 1.2, 2.7)]);
        assert_eq!(nodes(&bend, 2.5), [(1.5, 1.2, 2.7)]);
        assert_eq!(nodes(&bend, 2.7), []);
        // The end is one node.
        assert_eq!(nodes(&[[0., 0.], [2., 0.]], 0.5), [(1., 0., 1.), (2., 0., 2.)]);
        assert_eq!(nodes(&[[1., 1.]], 0.0), []);
        assert_eq!(nodes(&[], 0.0), []);
    }
}
