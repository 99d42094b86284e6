use super::*;
use crate::sim::test_shapes::{grid_of, star};
use proptest::prelude::*;

fn circle(x: f64, y: f64, radius_m: f64) -> Disc {
    Disc::new(Point::new(x, y), radius_m)
}

fn point() -> Footprint {
    Footprint::circle(0.0).unwrap()
}

/// Names of obstacles in reports.
#[test]
fn what_was_touched_in_reports() {
    use Obstacle::{Border, Circle, HiddenSquare, Mover, Polygon, Robot, Square};
    let all = [Square, HiddenSquare, Border, Circle(1), Polygon(2), Mover(3), Robot(4)];
    let expected = serde_json::json!([
        "square", "hidden_square", "border", {"circle": 1}, {"polygon": 2}, {"mover": 3}, {"robot": 4}
    ]);
    assert_eq!(serde_json::to_value(all).unwrap(), expected);
}

#[test]
fn distances_by_hand() {
    let known = OccupancyGrid::from_ascii(&["?....", ".....", "#...."]);
    let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
    let within = |world: &World, x, y, reach_m| {
        world.at(0.0).distance(&point(), Pose::new(x, y, 0.0), reach_m)
    };
    let at = |x, y| within(&world, x, y, 10.0);
    assert_eq!(at(2.0, 0.5), 1.0);
    assert_eq!(at(3.0, 2.0), 0.5);
    assert_eq!(at(4.2, 2.0), 0.0);
    assert_eq!(within(&world, 3.0, 2.0, 0.2), 0.2);
    // Unknown cells are not occupied: the nearest obstacle is the square (0, 0), 1.5 m below.
    assert_eq!(at(0.5, 2.5), 1.5);
    let mut hidden = BitGrid::new(5, 3, true);
    hidden.set(Cell::new(0, 2), true);
    let world = world.with_hidden(&hidden).unwrap();
    assert_eq!(within(&world, 0.5, 2.5, 10.0), 0.0);
    assert_eq!(world.squares().count_ones(), 2);
}

#[test]
fn the_border_and_the_nearest() {
    let known = OccupancyGrid::from_ascii(&[".....", ".....", "#...."]);
    let world = World::from_known(&known, vec![circle(4.0, 2.0, 0.5)]).unwrap();
    let border = |x, y| world.at(0.0).border_distance(&point(), Pose::new(x, y, 0.0));
    assert_eq!((border(2.0, 2.25), border(5.5, 1.0)), (0.75, -0.5));
    let nearest = |x, y| world.at(0.0).nearest_standing(&point(), Pose::new(x, y, 0.0));
    assert_eq!(nearest(2.5, 2.9), Obstacle::Border);
    assert_eq!(nearest(3.4, 1.9), Obstacle::Circle(0));
    assert_eq!(nearest(1.2, 0.9), Obstacle::Square);
    // A box that extends 1.2 m ahead of its centre is nearest to the circle there.
    let ahead = [[0.0, 0.1], [0.0, -0.1], [1.2, -0.1], [1.2, 0.1]];
    let ahead = Footprint::polygon(ahead.map(Point::from).to_vec()).unwrap();
    assert_eq!(
        world.at(0.0).nearest_standing(&ahead, Pose::new(2.2, 2.0, 0.0)),
        Obstacle::Circle(0)
    );
    let gap_m = world.at(0.0).distance(&ahead, Pose::new(2.2, 2.0, 0.0), 9.0);
    assert!((gap_m - 0.1).abs() < 1e-12);
}

proptest! {
        /// The bound by free cells changes no distance.
        #[test]
        fn distances_are_those_to_all_squares(
            cells in prop::collection::vec(prop::bool::weighted(0.01), 30 * 20), yaw in -3.1..3.1f64,
            at in (-0.2..3.2f64, -0.2..2.2f64, -3.1..3.1f64), radii in prop::collection::vec(0.05..0.4f64, 3..7),
            radius_m in 0.0..0.3f64, reach_m in 0.0..2.0f64,
        ) {
            let frame = GridFrame::new(30, 20, 0.1, Pose::new(0.0, 0.0, yaw)).unwrap();
            let known = grid_of(frame, &cells);
            let world = World::from_known(&known, vec![]).unwrap();
            let place = frame.world_from_grid(Point::new(at.0 * 10.0, at.1 * 10.0));
            let pose = Pose::new(place.x, place.y, at.2);
            for footprint in [Footprint::polygon(star(&radii, (0.0, 0.0))), Footprint::circle(radius_m)] {
                let footprint = footprint.unwrap();
                let expected_m = footprint.distance_m(pose, &world.clearance(), reach_m);
let distance_m = world.distance_to_standing(&footprint, pose, 0.0, reach_m);
                prop_assert!((distance_m - expected_m).abs() < 1e-14, "{distance_m} {expected_m}");
            }
        }
    }

#[test]
fn movers_are_obstacles_too() {
    let known = OccupancyGrid::from_ascii(&[".....", ".....", "....."]);
    let mover =
        MovingObstacle::straight(Point::new(1.0, 2.0), 0.5, Point::new(0.5, -0.25)).unwrap();
    let world = World::from_known(&known, vec![circle(4.5, 0.5, 0.1)]).unwrap();
    let world = world.with_movers(vec![mover]);
    let gap = |t_s| world.at(t_s).distance(&point(), Pose::new(3.0, 2.0, 0.0), 9.0);
    assert_eq!(gap(0.0), 1.5);
    // At (2, 1.5) after 2 s, and at (3, 1) after 4 s.
    assert!((gap(2.0) - (1.25_f64.sqrt() - 0.5)).abs() < 1e-15);
    assert_eq!(gap(4.0), 0.5);
    let to_movers =
        |reach_m| world.at(4.0).distance_to_movers(&point(), Pose::new(3.0, 1.7, 0.0), reach_m);
    assert_eq!((to_movers(0.1), to_movers(1.0).1), ((0.1, None), Some(0)));
    let places: Vec<Point> = world.at(2.0).discs().map(|circle| circle.centre).collect();
    assert_eq!(places, [Point::new(4.5, 0.5), Point::new(2.0, 1.5)]);
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
        let discs = vec![circle(0.0, 0.0, 0.0), bad];
        let error = World::new(frame, BitGrid::new(5, 1, false), discs).unwrap_err();
        assert!(matches!(error, WorldError::Circle { index: 1, .. }), "{error}");
    }
}
