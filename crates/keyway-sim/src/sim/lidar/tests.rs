use super::shapes::{outside, range_to_disc, range_to_edge};
use super::*;
use crate::sim::mover::{moving_obstacle, place_of};
use crate::sim::test_shapes::grid_of;
use crate::sim::{MovingObstacle, World};
use keyway::geometry::{Disc, outline};
use keyway::map::{BitGrid, GridFrame, OccupancyGrid};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn cast_among<'f>(
    world: &World,
    from: Pose,
    sensor: &RangeSensor,
    robots: impl Iterator<Item = (&'f Footprint, Pose)>,
) -> Scan {
    let beams = Beams::of(sensor);
    let mut scan = beams.scan();
    world.at(0.0).cast_among(from, &beams, robots, &mut Random::new(0), &mut scan);
    scan
}

/// Ranges from testing every beam against every cell that it crosses, every circle and every edge
/// of a robot.
fn beam_by_beam(
    world: &World,
    t_s: f64,
    pose: Pose,
    sensor: &RangeSensor,
    robots: &[(&Footprint, Pose)],
) -> Vec<f64> {
    let (frame, from, beams) = (world.frame(), pose.point(), Beams::of(sensor));
    let (start, length) = (frame.grid_from_world(from), sensor.range_m / frame.resolution_m());
    let on_grid = beams.directions(pose.theta - frame.origin().theta);
    let range = |(on_grid, in_world): (Point, Point)| {
        let mut ray = RayCells::new(frame, start, on_grid, length);
        let square = ray.find(|passed| world.squares().get(passed.cell));
        let mut nearest_m =
            square.map_or(f64::INFINITY, |passed| passed.enter * frame.resolution_m());
        let mover_at =
            |mover: &MovingObstacle| Disc::new(mover.motion().position(t_s), mover.radius_m());
        let mut circles = world.discs().to_vec();
        circles.extend(world.movers().iter().map(mover_at));
        for (footprint, at) in robots {
            match footprint {
                Footprint::Circle(disc) => {
                    circles.push(Disc::new(at.point(), disc.radius_m()));
                }
                Footprint::Polygon(polygon) => {
                    let vertices = polygon.vertices().iter();
                    let edges = outline(vertices.map(|&vertex| at.world_from_body(vertex)));
                    let (core, _) = footprint.core();
                    let is_inside = core.distance_to_m(*at, from) <= 0.0;
                    let ranges = edges.map(|edge| range_to_edge(from, in_world, &edge));
                    let edges_m = ranges.fold(f64::INFINITY, f64::min);
                    nearest_m = nearest_m.min(if is_inside { 0.0 } else { edges_m });
                }
            }
        }
        for circle in &circles {
            let is_inside = outside(from, circle) <= 0.0;
            let range_m = if is_inside { 0.0 } else { range_to_disc(from, in_world, circle) };
            nearest_m = nearest_m.min(range_m);
        }
        if nearest_m <= sensor.range_m { nearest_m } else { f64::INFINITY }
    };
    on_grid.zip(beams.directions(pose.theta)).map(range).collect()
}

fn sensor(beams: u32, field_of_view_deg: f64, range_m: f64) -> RangeSensor {
    RangeSensor::new(beams, field_of_view_deg, range_m)
}

#[test]
fn ranges_by_hand() {
    let known = OccupancyGrid::from_ascii(&["....#", ".....", "#...."]);
    let circle = Disc::new(Point::new(2.5, 2.5), 0.25);
    let world = World::from_known(&known, vec![circle]).unwrap();
    let cast = |x, y, degrees: f64| {
        let pose = Pose::new(x, y, degrees.to_radians());
        world.at(0.0).cast(pose, &sensor(4, 360.0, 2.25)).ranges_m
    };
    // Beams point backwards, right, ahead, left.
    let ranges = cast(2.5, 0.5, 0.0);
    assert_eq!(ranges[..3], [1.5, f64::INFINITY, f64::INFINITY]);
    assert!((ranges[3] - 1.75).abs() < 1e-12);
    let turned = cast(2.5, 0.5, 90.0);
    assert!((turned[2] - 1.75).abs() < 1e-12 && (turned[3] - 1.5).abs() < 1e-12);
    assert_eq!(cast(0.5, 0.5, 20.0), [0.0; 4], "inside a square");
    assert_eq!(cast(2.4, 2.4, 20.0), [0.0; 4], "inside a circle");
    assert!((cast(6.5, 2.5, 180.0)[2] - 1.5).abs() < 1e-12, "from outside the map");
}

#[test]
fn beam_layouts() {
    let known = OccupancyGrid::from_ascii(&["."]);
    let world = World::from_known(&known, vec![]).unwrap();
    let bearings = |beams, field_deg| {
        let scan = world.at(0.0).cast(Pose::default(), &sensor(beams, field_deg, 1.0));
        assert_eq!(scan.ranges_m.len(), beams as usize);
        (0..beams as usize).map(|i| scan.bearing_rad(i).to_degrees().round()).collect()
    };
    let all: Vec<f64> = bearings(4, 360.0);
    assert_eq!(all, [-180.0, -90.0, 0.0, 90.0]);
    let part: Vec<f64> = bearings(4, 270.0);
    assert_eq!(part, [-135.0, -45.0, 45.0, 135.0]);
    let one: Vec<f64> = bearings(1, 360.0);
    assert_eq!(one, [0.0]);
}

/// True if a segment meets the closed square with this lower left corner and a side of 1: the
/// parts of the segment between the lines of two opposite sides overlap.
fn meets_square(a: Point, b: Point, corner: Point) -> bool {
    let between = |a: f64, b: f64, low: f64| {
        if a == b {
            let is_between = (low..=low + 1.0).contains(&a);
            return if is_between { (0.0, 1.0) } else { (1.0, 0.0) };
        }
        let (first, second) = ((low - a) / (b - a), (low + 1.0 - a) / (b - a));
        (first.min(second), first.max(second))
    };
    let (x, y) = (between(a.x, b.x, corner.x), between(a.y, b.y, corner.y));
    x.0.max(y.0).max(0.0) <= x.1.min(y.1).min(1.0)
}

/// Distance along the ray at which it enters the closed square, by bisection of the length of a
/// segment that meets it.
fn square_by_bisection(start: Point, direction: Point, range: f64, corner: Point) -> f64 {
    let meets = |length: f64| meets_square(start, start + direction * length, corner);
    if !meets(range) {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, range);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if meets(middle) { high = middle } else { low = middle }
    }
    high
}

/// First sample inside the circle, refined by bisection.
fn circle_by_sampling(start: Point, direction: Point, range: f64, circle: &Disc) -> f64 {
    let inside = |t: f64| (start + direction * t).distance(circle.centre) <= circle.radius_m;
    let nearest = (circle.centre - start).dot(direction).clamp(0.0, range);
    if !inside(nearest) {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, nearest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if inside(middle) { high = middle } else { low = middle }
    }
    if inside(0.0) { 0.0 } else { high }
}

proptest! {
    #[test]
    fn agrees_with_brute_force(occupied in prop::collection::vec(prop::bool::weighted(0.08), 14 * 11),
                               circles in prop::collection::vec((0.0..1.4f64, 0.0..1.1f64, 0.0..0.2f64), 0..4),
                               yaw in -3.1..3.1f64, x in -0.3..1.7f64, y in -0.3..1.4f64,
                               theta in -3.1..3.1f64, range in 0.2..2.0f64) {
        let frame = GridFrame::new(14, 11, 0.1, Pose::new(-3.0, 2.0, yaw)).unwrap();
        let world_point = |x: f64, y: f64| frame.world_from_grid(Point::new(x * 10.0, y * 10.0));
        let mut squares = BitGrid::new(14, 11, false);
        let cells: Vec<_> = frame.cells().zip(&occupied).filter(|c| *c.1).map(|c| c.0).collect();
        for &cell in &cells {
            squares.set(cell, true);
        }
        let circles: Vec<Disc> = circles.into_iter()
            .map(|(x, y, radius_m)| Disc::new(world_point(x, y), radius_m)).collect();
        let world = World::new(frame, squares, circles.clone()).unwrap();
        let at = world_point(x, y);
        let scan = world.at(0.0).cast(Pose::new(at.x, at.y, theta), &sensor(24, 360.0, range));
        let start = frame.grid_from_world(at);
        for (i, &measured) in scan.ranges_m.iter().enumerate() {
            let heading = theta - PI + i as f64 * TAU / 24.0;
            let along = Point::new(libm::cos(heading), libm::sin(heading));
            // The grid's own direction, without subtracting angles.
            let ahead = frame.grid_from_world(at + along) - start;
            let by_squares = cells.iter().map(|cell| {
                let corner = Point::new(f64::from(cell.x), f64::from(cell.y));
                range * square_by_bisection(start, ahead * range, 1.0, corner)
            });
            let by_circles = circles.iter().map(|c| circle_by_sampling(at, along, range, c));
            let expected = by_squares.chain(by_circles).fold(f64::INFINITY, f64::min);
            if expected.is_finite() {
                prop_assert!((measured - expected).abs() < 1e-9, "{i}: {measured} {expected}");
            } else {
                prop_assert_eq!(measured, f64::INFINITY);
            }
        }
    }

    /// Checks that no point on a beam before its range is on another robot, and that the point at
    /// its range is.
    #[test]
    fn other_robots_are_seen_as_their_footprints(
        radii in prop::collection::vec(0.1..0.6f64, 3..8), offset in (-0.5..0.5f64, -0.5..0.5f64),
        disc_m in 0.0..0.4f64, poses in prop::array::uniform3((-1.5..1.5f64, -1.5..1.5f64, -3.1..3.1f64)),
        range_m in 0.2..3.0f64,
    ) {
        let step = TAU / radii.len() as f64;
        let vertices = radii.iter().enumerate().map(|(i, &radius)| {
            let (sin, cos) = libm::sincos(step * i as f64);
            Point::new(offset.0 + radius * cos, offset.1 + radius * sin)
        }).collect();
        let footprints = [Footprint::polygon(vertices).unwrap(), Footprint::circle(disc_m).unwrap()];
        let [from, polygon_pose, disc_pose] = poses.map(|(x, y, theta)| Pose::new(x, y, theta));
        let robots = || footprints.iter().zip([polygon_pose, disc_pose]);
        let frame = GridFrame::new(10, 10, 1.0, Pose::new(-5.0, -5.0, 0.0)).unwrap();
        let world = World::from_known(&OccupancyGrid::all_free(frame), vec![]).unwrap();
        let scan = cast_among(&world, from, &sensor(32, 360.0, range_m), robots());
        let gap_m = |point: Point| robots().map(|(footprint, pose)| {
            let (core, radius_m) = footprint.core();
            core.distance_to_m(pose, point) - radius_m
        }).fold(f64::INFINITY, f64::min);
        for (beam, &range) in scan.ranges_m.iter().enumerate() {
            let heading = from.theta + scan.bearing_rad(beam);
            let along = Point::new(libm::cos(heading), libm::sin(heading));
            let free_m = if range.is_finite() { range } else { range_m };
            let met = (0..200).map(|i| from.point() + along * (free_m * f64::from(i) / 200.0))
                .find(|&point| gap_m(point) <= 0.0);
            prop_assert!(met.is_none() || range == 0.0, "{beam}: {range} {met:?}");
            if range.is_finite() {
                let gap = gap_m(from.point() + along * range);
                prop_assert!(gap < 1e-9, "{beam}: {range} {gap}");
            }
        }
    }

    /// Checks that skipping free squares and beams in other directions changes no bit.
    #[test]
    fn ranges_are_those_beam_by_beam(
        density in prop_oneof![Just(0.0), 0.001..0.1f64], cells in prop::collection::vec(0.0..1.0f64, 40 * 31),
        circles in prop::collection::vec((-0.5..4.5f64, -0.5..3.6f64, 0.0..0.3f64), 0..6),
        movers in prop::collection::vec(moving_obstacle(), 0..4), t_s in 0.0..9.0f64,
        yaw in prop_oneof![Just(0.0), -3.1..3.1f64], on_lines in any::<bool>(),
        from in (-1.0..5.0f64, -1.0..4.0f64, -7.0..7.0f64), range_m in 0.2..6.0f64,
        beams in 1..60u32, field_of_view_deg in prop_oneof![Just(360.0), Just(359.0), 1.0..360.0f64],
        robot in (0.1..4.0f64, 0.1..3.0f64, -3.1..3.1f64), disc in (0.1..4.0f64, 0.1..3.0f64, 0.0..0.4f64),
    ) {
        let frame = GridFrame::new(40, 31, 0.1, Pose::new(0.25, -0.5, yaw)).unwrap();
        let occupied: Vec<bool> = cells.iter().map(|&cell| cell < density).collect();
        let known = grid_of(frame, &occupied);
        let circles = circles.into_iter().map(|(x, y, radius_m)| Disc::new(Point::new(x, y), radius_m));
        let world = World::from_known(&known, circles.collect()).unwrap().with_movers(movers);
        let mut from = Pose::new(from.0, from.1, from.2);
        if on_lines {
            // On grid lines and along them.
            let line = |at: f64| (at * 10.0).round() * 0.1;
            from = Pose::new(line(from.x) + 0.25, line(from.y) - 0.5, (from.theta / PI * 4.0).round() * PI / 4.0);
        }
        let sensor = sensor(beams, field_of_view_deg, range_m);
        let (long, round) = (Footprint::rectangle(1.2, 0.3).unwrap(), Footprint::circle(disc.2).unwrap());
        let robots = [(&long, Pose::new(robot.0, robot.1, robot.2)), (&round, Pose::new(disc.0, disc.1, 0.0))];
        let among = |robots: &[(&Footprint, Pose)]| {
            let beams = Beams::of(&sensor);
            let mut scan = beams.scan();
            world.at(t_s).cast_among(
                from,
                &beams,
                robots.iter().copied(),
                &mut Random::new(0),
                &mut scan,
            );
            scan.ranges_m
        };
        prop_assert_eq!(among(&robots), beam_by_beam(&world, t_s, from, &sensor, &robots));
        prop_assert_eq!(&among(&[]), &world.at(t_s).cast(from, &sensor).ranges_m);
        // Directions agree with the bearings.
        let scan = world.at(t_s).cast(from, &sensor);
        for (beam, direction) in Beams::of(&sensor).directions(from.theta).enumerate() {
            let heading = from.theta + scan.bearing_rad(beam);
            let off = direction - Point::new(libm::cos(heading), libm::sin(heading));
            prop_assert!(off.norm() < 1e-14);
        }
    }

    /// Compares ranges with the position of a moving obstacle at the instant of the scan, found
    /// by following its motion.
    #[test]
    fn movers_are_seen_where_they_are(
        mover in moving_obstacle(), t_s in 0.0..9.0f64, from in (-2.0..2.0f64, -2.0..2.0f64, -3.1..3.1f64),
    ) {
        let frame = GridFrame::new(10, 10, 1.0, Pose::new(-5.0, -5.0, 0.0)).unwrap();
        let world = World::from_known(&OccupancyGrid::all_free(frame), vec![]).unwrap();
        let world = world.with_movers(vec![mover.clone()]);
        let (centre, from) = (place_of(&mover, t_s), Pose::new(from.0, from.1, from.2));
        let gap_m = |point: Point| point.distance(centre) - mover.radius_m();
        prop_assume!(mover.radius_m() > 0.01 && gap_m(from.point()) > 1e-6);
        let scan = world.at(t_s).cast(from, &sensor(64, 360.0, 99.0));
        for (beam, &range) in scan.ranges_m.iter().enumerate() {
            let heading = from.theta + scan.bearing_rad(beam);
            let along = Point::new(libm::cos(heading), libm::sin(heading));
            let nearest = (centre - from.point()).dot(along).max(0.0);
            // Grazing beams may hit or miss.
            let depth_m = -gap_m(from.point() + along * nearest);
            prop_assert!(depth_m.abs() < 1e-9 || range.is_finite() == (depth_m > 0.0), "{beam}: {range}");
            if range.is_finite() {
                prop_assert!(gap_m(from.point() + along * range).abs() < 1e-6, "{beam}: {range}");
            }
        }
    }
}
