use super::*;
use crate::sim::mover::{moving_obstacle, place_of};
use crate::sim::test_shapes::{grid_of, star};
use crate::sim::{KeyFrame, MovingObstacle, ObstacleMotion, Spline, StandingPolygon};
use keyway::geometry::{Disc, Point, Pose, Segment, Velocity, holds_point, outline};
use keyway::map::{Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use proptest::prelude::*;

fn open(circles: Vec<Disc>) -> World {
    let frame = GridFrame::new(100, 100, 0.1, Pose::new(-5.0, -5.0, 0.0)).unwrap();
    World::from_known(&OccupancyGrid::all_free(frame), circles).unwrap()
}

#[test]
fn a_stretch_is_certified_by_its_ends_or_halved() {
    let at = |place, clearance_m| Probe { place, clearance_m };
    assert!((least_between(at(0.0, 0.3), at(4.0, 0.2), 0.4) - 0.05).abs() < 1e-15);
    assert!(least_between(at(0.0, 0.3), at(4.0, 0.2), 0.6) < 0.0);
}

#[test]
fn a_turn_on_the_spot_touches_nothing_new() {
    let world = open(vec![Disc::new(Point::new(0.3, 0.0), 0.1)]);
    let turn = Velocity::new(0.0, 1.0);
    let motion = CycleMotion::new(Pose::default(), turn, turn, 0.5);
    let footprint = Footprint::circle(0.2).unwrap();
    let robot = Moving { footprint: &footprint, motion: &motion };
    let sweep = StandingSweep { world: &world, start_s: 0.0, robot };
    assert_eq!(sweep.first_contact(CycleMotion::END), None);
}

#[test]
fn leaving_the_map_is_contact() {
    let world = open(vec![]);
    let ahead = Velocity::new(1.0, 0.0);
    let motion = CycleMotion::new(Pose::new(4.5, 0.0, 0.0), ahead, ahead, 1.0);
    let footprint = Footprint::circle(0.25).unwrap();
    let robot = Moving { footprint: &footprint, motion: &motion };
    let sweep = StandingSweep { world: &world, start_s: 0.0, robot };
    let place = sweep.first_contact(CycleMotion::END).unwrap();
    assert!((motion.pose(place).x - 4.75).abs() < TOLERANCE_M);
}

proptest! {
    #[test]
    fn agrees_with_dense_sampling(occupied in prop::collection::vec(prop::bool::weighted(0.03), 20 * 20),
                                  circle in (0.0..2.0f64, 0.0..2.0f64, 0.0..0.1f64),
                                  v in (-1.0..1.0f64, -1.0..1.0f64),
                                  omega in (-3.0..3.0f64, -3.0..3.0f64),
                                  theta in -3.0..3.0f64, radius_m in 0.0..0.2f64) {
        let frame = GridFrame::new(20, 20, 0.1, Pose::default()).unwrap();
        let mut each = occupied.iter();
        let start = Pose::new(1.0, 1.0, theta);
        let known = OccupancyGrid::from_fn(frame, |cell| {
            let near = (cell.x - 10).abs().max((cell.y - 10).abs()) <= 2;
            if *each.next().unwrap() && !near { CellState::Occupied } else { CellState::Free }
        });
        let circle = Disc::new(Point::new(circle.0, circle.1), circle.2);
        let footprint = Footprint::circle(radius_m).unwrap();
        let world = World::from_known(&known, vec![circle]).unwrap();
        prop_assume!(world.at(0.0).distance(&footprint, start, 1.0) > TOLERANCE_M);
        let motion = CycleMotion::new(start, Velocity::new(v.0, omega.0), Velocity::new(v.1, omega.1), 1.0);
        let sweep = StandingSweep { world: &world, start_s: 0.0, robot: Moving { footprint: &footprint, motion: &motion } };
        // Brute force over all squares at 20000 places, 0.05 mm apart.
        let squares: Vec<Cell> = frame.cells().filter(|&c| known.occupied().get(c)).collect();
        let clearance = |place: f64| {
            let p = motion.pose(place).point();
            let to_square = |c: &Cell| {
                let half = |centre: f64, at: f64| ((at - centre).abs() - 0.05).max(0.0);
                let centre = frame.world_from_cell(*c);
                half(centre.x, p.x).hypot(half(centre.y, p.y))
            };
            squares.iter().map(to_square).fold(circle.distance(p), f64::min) - radius_m
        };
        let border = |place: f64| {
            let p = motion.pose(place).point();
            p.x.min(p.y).min(2.0 - p.x).min(2.0 - p.y) - radius_m
        };
        let places = (0..=20_000).map(|i| f64::from(i) / 5000.0);
        let touched = places.clone().find(|&s| clearance(s).min(border(s)) <= 0.0);
        let contact = sweep.first_contact(CycleMotion::END);
        if let Some(touched) = touched {
            prop_assert!(contact.is_some_and(|s| s <= touched), "{contact:?} {touched}");
        }
        if let Some(contact) = contact {
            let gap = clearance(contact).min(border(contact));
            prop_assert!(gap > -1e-12 && gap < TOLERANCE_M, "gap {gap}");
        }
        let until = contact.unwrap_or(CycleMotion::END);
        let sampled = places.filter(|&s| s <= until).map(clearance).fold(9.0, f64::min);
        let least = sweep.least_clearance(until, 9.0);
        prop_assert!((least - sampled).abs() < 2.0 * TOLERANCE_M, "{least} {sampled}");
        prop_assert_eq!(sweep.least_clearance(until, least * 0.5), least * 0.5);
    }

    /// Polygons that turn among squares and a circle: free before the contact, touching at it.
    #[test]
    fn first_contact_of_polygons(
        occupied in prop::collection::vec(prop::bool::weighted(0.02), 20 * 20),
        circle in (0.0..2.0f64, 0.0..2.0f64, 0.0..0.1f64),
        radii in prop::collection::vec(0.05..0.4f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64),
        v in (-1.0..1.0f64, -1.0..1.0f64), omega in (-3.0..3.0f64, -3.0..3.0f64),
        theta in -3.0..3.0f64,
    ) {
        let frame = GridFrame::new(20, 20, 0.1, Pose::default()).unwrap();
        let known = grid_of(frame, &occupied);
        let circle = Disc::new(Point::new(circle.0, circle.1), circle.2);
        let world = World::from_known(&known, vec![circle]).unwrap();
        let vertices = star(&radii, offset);
        let footprint = Footprint::polygon(vertices.clone()).unwrap();
        let motion = CycleMotion::new(Pose::new(1.0, 1.0, theta), Velocity::new(v.0, omega.0),
                                      Velocity::new(v.1, omega.1), 1.0);
        let sweep = StandingSweep { world: &world, start_s: 0.0, robot: Moving { footprint: &footprint, motion: &motion } };
        let field = DistanceField::new(&frame, known.occupied(), &FieldConfig::default());
        let is_free = |place: f64| {
            let pose = motion.pose(place);
            polygon_gap_m(&vertices, pose, &circle) > 0.0 && footprint.is_free(pose, &field)
        };
        prop_assume!(is_free(0.0) && world.distance_to_standing(&footprint, motion.pose(0.0), 0.0, 1.0) > TOLERANCE_M);
        let contact = sweep.first_contact(CycleMotion::END);
        let until = contact.unwrap_or(CycleMotion::END);
        let mut places = (0..=4000).map(|i| f64::from(i) / 1000.0).filter(|&place| place <= until);
        prop_assert!(places.all(is_free));
        if contact.is_some() {
            let gap_m = sweep.gap_m(until, 1.0);
            prop_assert!(gap_m < TOLERANCE_M, "{gap_m}");
        }
    }

    /// A disc that drives past a static polygon: free before the contact, touching at it, and
    /// with the sampled smallest clearance.
    #[test]
    fn contact_with_standing_polygons_agrees_with_dense_sampling(
        radii in prop::collection::vec(0.05..0.6f64, 3..9), at in (-1.2..1.2f64, -1.2..1.2f64),
        v in (-1.0..1.0f64, -1.0..1.0f64), omega in (-3.0..3.0f64, -3.0..3.0f64),
        theta in -3.0..3.0f64, radius_m in 0.0..0.2f64,
    ) {
        let vertices = star(&radii, at);
        let world = open(vec![]).with_polygons(vec![StandingPolygon::new(vertices.clone()).unwrap()]);
        let motion = CycleMotion::new(Pose::new(0.0, 0.0, theta), Velocity::new(v.0, omega.0),
                                      Velocity::new(v.1, omega.1), 1.0);
        let footprint = Footprint::circle(radius_m).unwrap();
        let sweep = StandingSweep { world: &world, start_s: 0.0, robot: Moving { footprint: &footprint, motion: &motion } };
        let gap_m = |place: f64| {
            let robot = Disc::new(motion.pose(place).point(), radius_m);
            polygon_gap_m(&vertices, Pose::default(), &robot)
        };
        prop_assume!(gap_m(0.0) > TOLERANCE_M);
        let contact = sweep.first_contact(CycleMotion::END);
        let until = contact.unwrap_or(CycleMotion::END);
        let gaps_m = (0..=4000).map(|i| f64::from(i) / 1000.0).filter(|&place| place <= until).map(gap_m);
        let least_m = gaps_m.fold(gap_m(until), f64::min);
        prop_assert!(least_m > -1e-9, "{least_m}");
        prop_assert!(contact.is_none() || gap_m(until) < TOLERANCE_M, "{}", gap_m(until));
        let known_m = sweep.least_clearance(until, 9.0);
        // Between two samples the robot moves by 1 mm at most.
        prop_assert!(known_m <= least_m + TOLERANCE_M && known_m > least_m - 2e-3, "{known_m} {least_m}");
    }

    /// A disc or a polygon that drives and turns, stops or is stationary, and an obstacle of any
    /// motion, which may turn corners in the cycle: apart before the contact, touching at it, and
    /// with the smallest clearance of 4000 instants.
    #[test]
    fn contact_with_movers_agrees_with_dense_sampling(
        (shape, motion) in mover(), mover in moving_obstacle(), start_s in 0.0..4.0f64, stands in prop::bool::weighted(0.3),
    ) {
        let motion = if stands { CycleMotion::standing(motion.pose(0.0), 1.0) } else { motion };
        let sweep = MoverSweep {
            mover: &mover, robot: Moving { footprint: &shape, motion: &motion }, start_s,
        };
        // Positions come from the motion's parameters, not from its own code.
        let gap_m = |place: f64| {
            let circle = Disc::new(place_of(&mover, start_s + place / 4.0), mover.radius_m());
            match &shape {
                Footprint::Circle(disc) => {
                    circle.centre.distance(motion.pose(place).point()) - disc.radius_m() - circle.radius_m
                }
                Footprint::Polygon(polygon) => {
                    polygon_gap_m(polygon.vertices(), motion.pose(place), &circle)
                }
            }
        };
        prop_assume!(gap_m(0.0) > TOLERANCE_M);
        let places = (0..=4000).map(|i| f64::from(i) / 1000.0);
        let contact = sweep.first_contact(CycleMotion::END);
        if let Some(place) = contact {
            // A jump may be off by the last digits of its place.
            let gap_m = gap_m(place).min(gap_m(place + 1e-9));
            prop_assert!(gap_m < TOLERANCE_M, "gap {gap_m}");
        }
        let until = contact.unwrap_or(CycleMotion::END);
        let sampled_m = places.filter(|&place| place <= until).map(gap_m).fold(9.0, f64::min);
        prop_assert!(sampled_m > 0.0, "{sampled_m}");
        // Parts of the robot move by at most 1 mm between two instants, the obstacle by 1.5 mm.
        let least_m = sweep.least_clearance(until, 9.0);
        prop_assert!(least_m < sampled_m + TOLERANCE_M, "{least_m} {sampled_m}");
        prop_assert!(least_m > sampled_m - 0.0015 - TOLERANCE_M, "{least_m} {sampled_m}");
    }
}

/// Distance from a polygon to a circle by its edges; negative inside.
fn polygon_gap_m(vertices: &[Point], pose: Pose, circle: &Disc) -> f64 {
    let placed: Vec<Point> = vertices.iter().map(|&v| pose.world_from_body(v)).collect();
    let gap = |i: usize| {
        let edge = Segment::new(placed[i], placed[(i + 1) % placed.len()]);
        edge.distance_sq_to_point(circle.centre).sqrt() - circle.radius_m
    };
    let is_inside = holds_point(outline(placed.iter().copied()), circle.centre);
    let edges_m = (0..placed.len()).map(gap).fold(f64::INFINITY, f64::min);
    if is_inside { edges_m.min(-circle.radius_m) } else { edges_m }
}

/// A shape around a point: a disc with the first radius, or a polygon with its vertices at all
/// radii.
fn shape(is_disc: bool, radii: &[f64], offset: (f64, f64)) -> Footprint {
    if is_disc {
        return Footprint::circle(radii[0]).unwrap();
    }
    Footprint::polygon(star(radii, offset)).unwrap()
}

/// A robot of any shape near the origin, and its motion in a cycle of a second; it may stop
/// within the cycle.
fn mover() -> impl Strategy<Value = (Footprint, CycleMotion)> {
    let shape =
        (any::<bool>(), prop::collection::vec(0.05..0.4f64, 3..7), (-0.2..0.2f64, -0.2..0.2f64))
            .prop_map(|(is_disc, radii, offset)| shape(is_disc, &radii, offset));
    let start = (-0.8..0.8f64, -0.8..0.8f64, -3.0..3.0f64);
    let ends = prop::array::uniform2((-1.0..1.0f64, -3.0..3.0f64));
    let stop = prop_oneof![4 => Just(CycleMotion::END), 1 => 0.0..CycleMotion::END];
    (shape, start, ends, stop).prop_map(|(footprint, (x, y, theta), [from, to], stop)| {
        let (from, to) = (Velocity::new(from.0, from.1), Velocity::new(to.0, to.1));
        let mut motion = CycleMotion::new(Pose::new(x, y, theta), from, to, 1.0);
        motion.stop_at(stop);
        (footprint, motion)
    })
}

#[test]
fn two_discs_meet_half_way() {
    let disc = Footprint::circle(0.2).unwrap();
    let (slow, fast) = (Velocity::new(0.5, 0.0), Velocity::new(1.5, 0.0));
    let right = CycleMotion::new(Pose::new(0.0, 0.0, 0.0), slow, slow, 1.0);
    let left = CycleMotion::new(Pose::new(1.9, 0.0, std::f64::consts::PI), fast, fast, 1.0);
    let robots = [&right, &left].map(|motion| Moving { footprint: &disc, motion });
    // A gap of 1.5 m at 2 m/s.
    let place = PairSweep { robots }.first_contact(CycleMotion::END).unwrap();
    assert!((right.elapsed_s(place) - 0.75).abs() < TOLERANCE_M, "{place}");
    // The robot that stops after 0.25 s and the other one do not collide in this cycle.
    let mut stopped = left.clone();
    stopped.stop_at(1.0);
    let robots = [&right, &stopped].map(|motion| Moving { footprint: &disc, motion });
    assert_eq!(PairSweep { robots }.first_contact(CycleMotion::END), None);
    let least_m = PairSweep { robots }.least_clearance(CycleMotion::END, 9.0);
    assert!((least_m - (1.5 - 0.5 - 0.375)).abs() < TOLERANCE_M, "{least_m}");
}

proptest! {
    /// Two discs, a disc and a polygon, or two polygons, that drive and turn: apart before the
    /// contact, touching at it, and with the smallest clearance of 4000 places.
    #[test]
    fn contact_of_two_robots_agrees_with_dense_sampling(one in mover(), other in mover()) {
        let moving = |mover: &'_ (Footprint, CycleMotion)| (mover.0.clone(), mover.1.clone());
        let ((shape, motion), (other_shape, other_motion)) = (moving(&one), moving(&other));
        let robots = [Moving { footprint: &shape, motion: &motion },
                      Moving { footprint: &other_shape, motion: &other_motion }];
        let sweep = PairSweep { robots };
        let gap_m = |place: f64| {
            let (pose, other_pose) = (motion.pose(place), other_motion.pose(place));
            shape.distance_to_footprint_m(pose, &other_shape, other_pose, 9.0)
        };
        prop_assume!(gap_m(0.0) > TOLERANCE_M);
        let places = (0..=4000).map(|i| f64::from(i) / 1000.0);
        let contact = sweep.first_contact(CycleMotion::END);
        if let Some(place) = contact {
            prop_assert!(gap_m(place) < TOLERANCE_M, "gap {}", gap_m(place));
        }
        let until = contact.unwrap_or(CycleMotion::END);
        // Parts of both move by at most 1.4 mm together between two places.
        let sampled_m = places.filter(|&place| place <= until).map(gap_m).fold(9.0, f64::min);
        prop_assert!(sampled_m > 0.0);
        let least_m = sweep.least_clearance(until, 9.0);
        prop_assert!(least_m < sampled_m + TOLERANCE_M, "{least_m} {sampled_m}");
        prop_assert!(least_m > sampled_m - 0.0014 - TOLERANCE_M, "{least_m} {sampled_m}");
        prop_assert_eq!(sweep.least_clearance(until, least_m * 0.5), least_m * 0.5);
    }
}

/// An obstacle that moves aside from (x, 0), and again in each lap of 0.45 s.
fn comes_again(x: f64) -> MovingObstacle {
    let frames = [[0.0, x, 0.0], [0.4, x, 5.0]].map(KeyFrame::from).to_vec();
    MovingObstacle::new(0.1, ObstacleMotion::Spline(Spline::new(frames, 0.45).unwrap())).unwrap()
}

#[test]
fn a_jump_is_no_way() {
    // The jump passes over the robot, which a continuous motion would hit.
    let frames = [[0.0, -2.0, 0.0], [0.1, -2.0, 0.5], [0.2, 2.0, 0.5], [0.3, 2.0, 0.0]];
    let frames = frames.map(|[t_s, x, y]| KeyFrame::from([t_s, x, y + 3.0 * t_s])).to_vec();
    let mover = MovingObstacle::new(0.1, ObstacleMotion::Spline(Spline::new(frames, 0.3).unwrap()))
        .unwrap();
    let footprint = Footprint::circle(0.2).unwrap();
    let motion = CycleMotion::standing(Pose::default(), 0.05);
    let robot = Moving { footprint: &footprint, motion: &motion };
    let sweep = MoverSweep { mover: &mover, robot, start_s: 0.275 };
    assert_eq!(sweep.first_contact(CycleMotion::END), None);
    // At the end of its lap the obstacle is at (2, 0.9), then at (-2, 0), which is nearer than
    // any position before.
    let least_m = |until| sweep.least_clearance(until, 9.0);
    assert!((least_m(CycleMotion::END) - 1.7).abs() < 2.0 * TOLERANCE_M);
    let before_m = 2.0_f64.hypot(0.9) - 0.3;
    assert!((least_m(1.99) - before_m).abs() < 0.05, "{} {before_m}", least_m(1.99));
}

#[test]
fn contact_by_a_jump_is_at_its_instant() {
    let footprint = Footprint::circle(0.2).unwrap();
    let start = Pose::new(2.0, 0.0, 0.0);
    let mover = comes_again(2.25);
    // The jump falls within each cycle once, including its beginning and end, and twice in the
    // long cycle.
    for (start_s, duration_s) in
        [(0.41, 0.1), (0.45, 0.1), (0.449, 0.1), (0.2, 0.8), (3.55, 0.1), (4.05, 0.1)]
    {
        let motion = CycleMotion::standing(start, duration_s);
        let robot = Moving { footprint: &footprint, motion: &motion };
        let sweep = MoverSweep { mover: &mover, robot, start_s };
        let place = sweep.first_contact(CycleMotion::END).unwrap();
        let jump_s = mover.motion().last_jump_s(start_s + duration_s).unwrap();
        let jump_s = if duration_s > 0.5 { 0.45 } else { jump_s };
        assert!((start_s + motion.elapsed_s(place) - jump_s).abs() < 1e-12, "{start_s} {place}");
        assert!(sweep.jumped_before(place));
    }
    // If a cycle ends with the jump, the contact is in the next cycle.
    let motion = CycleMotion::standing(start, 0.125);
    let robot = Moving { footprint: &footprint, motion: &motion };
    let sweep = MoverSweep { mover: &mover, robot, start_s: 0.325 };
    assert_eq!(sweep.first_contact(CycleMotion::END), None);
    assert!(sweep.least_clearance(CycleMotion::END, 9.0) > 2.0);
    // An obstacle that has been stationary there for longer than a cycle did not just jump.
    let standing = [[0.0, 2.25, 0.0], [0.3, 2.25, 0.0], [0.4, 2.25, 5.0]].map(KeyFrame::from);
    let standing = Spline::new(standing.to_vec(), 0.5).unwrap();
    let mover = MovingObstacle::new(0.1, ObstacleMotion::Spline(standing)).unwrap();
    let motion = CycleMotion::standing(start, 0.1);
    let robot = Moving { footprint: &footprint, motion: &motion };
    let jumped = |start_s, place| MoverSweep { mover: &mover, robot, start_s }.jumped_before(place);
    assert!(jumped(0.55, 0.0) && jumped(0.55, 1.9) && !jumped(0.55, 2.1) && !jumped(0.65, 0.0));
    assert!(!jumped(0.0, 1.0) && !jumped(0.45, 1.9) && jumped(0.45, 2.1));
}
