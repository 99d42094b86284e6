//! The part of a route that lies around the robot.

use super::local;
use crate::geometry::Point;
use crate::local::Scene;

/// Collects the route from an arc length on, until it leaves the square of this half-width around
/// the robot, in the positions of a lattice. Returns the length of the route beyond \[m\].
pub(super) fn collect(
    route: &mut Vec<Point>,
    scene: &Scene<'_>,
    covered_m: f64,
    half_m: f64,
) -> f64 {
    let frame = scene.obstacles.frame();
    let robot = local(frame, scene.pose.point());
    let is_inside = |point: Point| {
        let off = point - robot;
        off.x.abs().max(off.y.abs()) < half_m
    };
    route.clear();
    let Some(first) = scene.path.at_length(covered_m) else { return 0.0 };
    let mut from = local(frame, first);
    route.push(from);
    let mut along_m = 0.0;
    let mut left_m = scene.path.length_m() - covered_m;
    for segment in scene.path.segments() {
        along_m += segment.a.distance(segment.b);
        if along_m <= covered_m {
            continue;
        }
        let to = local(frame, segment.b);
        // A route that begins outside is followed until it enters.
        if is_inside(from) && !is_inside(to) {
            let end = last_inside(from, to, is_inside);
            route.push(end);
            return left_m - from.distance(end);
        }
        route.push(to);
        left_m -= from.distance(to);
        from = to;
    }
    0.0
}

/// The last point inside on the line from one that is inside to one that is not.
fn last_inside(inside: Point, outside: Point, is_inside: impl Fn(Point) -> bool) -> Point {
    let (mut near, mut far) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (near + far);
        *(if is_inside(inside.lerp(outside, middle)) { &mut near } else { &mut far }) = middle;
    }
    inside.lerp(outside, near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polyline, Pose, Velocity};
    use crate::map::{BitGrid, DistanceField, FieldConfig, OccupancyGrid};

    #[test]
    fn a_route_ends_where_it_leaves() {
        let map = OccupancyGrid::from_ascii(&["...................."; 20]);
        let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
        let point = |x, y| Point::new(x, y);
        let path = Polyline::new(vec![
            point(2.0, 5.0),
            point(6.0, 5.0),
            point(6.0, 18.0),
            point(2.0, 18.0),
        ]);
        let scene = Scene {
            obstacles: &obstacles,
            sensed: &BitGrid::new(20, 20, false),
            seen: crate::sense::SeenCells::ANYWHERE,
            movers: &[],
            walked: &[],
            pose: Pose::new(5.0, 5.5, 0.0),
            velocity: Velocity::ZERO,
            guide: point(6.0, 5.0),
            path: &path,
            goal_heading_rad: None,
            remaining_m: 18.0,
            jerk_limited: None,
        };
        let mut route = Vec::new();
        let beyond_m = collect(&mut route, &scene, 3.0, 4.0);
        assert!(route[0].distance(point(5.0, 5.0)) < 1e-9 && route[1] == point(6.0, 5.0));
        assert!(route[2].distance(point(6.0, 9.5)) < 1e-6 && route.len() == 3);
        assert!((beyond_m - 12.5).abs() < 1e-6, "8.5 m up and 4 m to the left");
        let beyond_m = collect(&mut route, &scene, 3.0, 30.0);
        assert_eq!((route.last(), beyond_m), (Some(&point(2.0, 18.0)), 0.0), "all of it");
    }
}
