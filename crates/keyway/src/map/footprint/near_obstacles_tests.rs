use super::*;
use crate::geometry::{holds_point, outline};
use crate::map::{BitGrid, DistanceTo, FieldConfig};
use crate::map::{GridFrame, on_grid};
use crate::robot::{Footprint, star};
use proptest::prelude::*;

const CELL_M: f64 = 0.05;

/// A field of 70 x 20 cells, so that rows take two words.
fn field(cells: &[bool], yaw: f64, to: DistanceTo, reach_m: f64) -> DistanceField {
    let frame = GridFrame::new(70, 20, CELL_M, Pose::new(1.0, -2.0, yaw)).unwrap();
    let mut obstacles = BitGrid::new(70, 20, false);
    for (cell, _) in frame.cells().zip(cells).filter(|&(_, &is)| is) {
        // Walls as well as single squares.
        obstacles.fill_span(cell.y, cell.x, cell.x + cell.x % 4);
    }
    DistanceField::new(&frame, &obstacles, &FieldConfig { to, reach_m, ..FieldConfig::default() })
}

fn footprint(radii: &[f64], offset: (f64, f64), is_round: bool) -> Footprint {
    let disc = Footprint::circle(0.1).unwrap();
    if is_round { disc } else { Footprint::polygon(star(radii, offset)).unwrap() }
}

/// Footprints of all kinds: a disc, a star, and convex polygons wound to the left and to the
/// right.
fn shaped(shape: usize, radii: &[f64], offset: (f64, f64)) -> Footprint {
    let box_of = |mirror: f64| {
        let corners = [[0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.25, -0.2]];
        let turned = corners.map(|[x, y]| [x + offset.0, (y + offset.1) * mirror].into());
        Footprint::polygon(turned.to_vec()).unwrap()
    };
    match shape {
        0 => footprint(radii, offset, true),
        1 => footprint(radii, offset, false),
        2 => box_of(1.0),
        _ => box_of(-1.0),
    }
}

#[test]
fn runs_of_a_row() {
    let mut grid = BitGrid::new(140, 1, false);
    for (from, to) in [(0, 0), (3, 70), (126, 128), (139, 139)] {
        grid.fill_span(0, from, to);
    }
    let runs = |from: i32, to: i32| {
        let mut found = Vec::new();
        for_each_run(grid.row(0), [from, to], |from, to| found.push((from, to)));
        found
    };
    assert_eq!(runs(0, 139), [(0, 0), (3, 70), (126, 128), (139, 139)]);
    assert_eq!(runs(1, 2), []);
    assert_eq!(runs(62, 126), [(62, 70), (126, 126)]);
    assert_eq!(runs(64, 64), [(64, 64)]);
}

proptest! {
    #[test]
    fn distances_are_those_of_the_squares(
        cells in prop::collection::vec(prop::bool::weighted(0.02), 70 * 20), yaw in -3.0..3.0f64,
        radii in prop::collection::vec(0.05..0.3f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64), is_round: bool,
        poses in prop::collection::vec((-0.5..4.0f64, -0.5..1.5f64, -3.1..3.1f64), 20),
        to in prop_oneof![Just(DistanceTo::Squares), Just(DistanceTo::Centres)],
        field_reach_m in prop_oneof![Just(f64::INFINITY), 0.05..1.0f64], reach in 0.1..30.0f64, most in 0.1..40.0f64,
    ) {
        let field = field(&cells, yaw, to, field_reach_m);
        let footprint = footprint(&radii, offset, is_round);
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let mut near = NearObstacles::new(&core, &field, Reach { distance: reach, way: 0.0, spread: 0.0 }, &mut memory);
        for (x, y, theta) in poses {
            let at = field.frame().world_from_grid(Point::new(x / CELL_M, y / CELL_M));
            let pose = Pose::new(at.x, at.y, theta);
            let (origin, ahead) = on_grid(pose, field.frame());
            let mut turned = Turned::default();
            turned.turn(&core, ahead);
            let placement = Placement { origin, turned: &turned };
            let expected = core.distance_m(pose, &field.clearance(), 10.0) / CELL_M;
            if expected == 0.0 {
                // A square wholly inside the polygon is not detected.
                continue;
            }
            let measured = near.distance(&placement, most);
            prop_assert!((measured - expected.min(reach).min(most)).abs() < 1e-9, "{measured} {expected}");
            let border = core.to_border_m(pose, &field.clearance()) / CELL_M;
            prop_assert!((near.to_border(&placement) - border).abs() < 1e-9);
            if !(0.0..=70.0).contains(&origin.x) || !(0.0..=20.0).contains(&origin.y) {
                continue;
            }
            prop_assert!(!near.is_beyond(placement.origin, expected + 1e-9), "{expected}");
            let is_far = expected > 3.0 * near.swing.max(2.0) && field_reach_m.is_infinite();
            prop_assert!(!is_far || near.is_beyond(placement.origin, 0.2 * expected), "{expected}");
        }
    }

    /// Samples poses along a motion. The distance to each box lies between its bounds; a box
    /// without bounds is beyond the limit, and a square in no box is no nearer than `to_others`.
    /// The distance to the border lies between its bounds, too. A box reported as met is within
    /// the limit.
    #[test]
    fn bounds_hold_on_the_whole_way(
        cells in prop::collection::vec(prop::bool::weighted(0.02), 70 * 20),
        radii in prop::collection::vec(0.05..0.3f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64), shape in 0..4usize,
        x in -0.2..3.7f64, y in -0.2..1.2f64, theta in -3.1..3.1f64, length in 0.0..6.0f64, heading in -3.1..3.1f64,
        distance in 0.5..10.0f64, spread in 0.0..6.0f64, limit in 0.1..12.0f64,
    ) {
        let field = field(&cells, 0.0, DistanceTo::Squares, f64::INFINITY);
        let footprint = shaped(shape, &radii, offset);
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let reach = Reach { distance, way: 0.0, spread };
        let mut near = NearObstacles::new(&core, &field, reach, &mut memory);
        let mut turned = Turned::default();
        turned.turn(&core, Point::new(libm::cos(theta), libm::sin(theta)) * (1.0 / CELL_M));
        let middle = Placement { origin: Point::new(x / CELL_M, y / CELL_M), turned: &turned };
        let half = Point::new(libm::cos(heading), libm::sin(heading)) * length;
        let sweep = Sweep { middle, half, half_length: length };
        let around = near.around(middle.origin);
        let boxes: Vec<_> = around.boxes().map(|index| near.memory.boxes[index as usize]).collect();
        let bounds: Vec<_> = around.boxes().map(|index| near.apart(index, &sweep, limit)).collect();
        let met: Vec<_> = around.boxes().map(|index| near.meets(index, &sweep, limit)).collect();
        let to_others = near.to_others(&around) - length;
        let border = near.border_apart(&sweep);
        let (is_convex, is_point) = (near.winding != Winding::Both, core.vertices().is_empty());
        for i in 0..=20 {
            let fraction = f64::from(i) / 20.0;
            let at = Placement { origin: middle.origin + half * (2.0 * fraction - 1.0), ..middle };
            let holds = |bounds: &Apart, distance: f64| {
                bounds.at_least.at(fraction) <= distance + 1e-9 && bounds.at_most.at(fraction) >= distance - 1e-9
            };
            let to_box = |near: &NearBox| {
                if core.vertices().is_empty() {
                    return near.way_to_point(at.origin).norm();
                }
                let covers = holds_point(at.edges(), near.low) && is_convex;
                let from_edges = at.edges().map(|edge| near.way_to_edge(edge).norm());
                if covers { 0.0 } else { from_edges.fold(f64::INFINITY, f64::min) }
            };
            for (near, bounds) in boxes.iter().zip(&bounds) {
                let distance = to_box(near);
                prop_assert!(bounds.map_or(distance >= limit - 1e-9, |bounds| holds(&bounds, distance)),
                    "{bounds:?} {fraction} {distance} {limit}");
            }
            for (near, part) in boxes.iter().zip(&met) {
                let (at, distance) = (2.0 * fraction - 1.0, to_box(near));
                let is_on = |by: f64| part.is_some_and(|[begin, end]| at >= begin - by && at <= end + by);
                prop_assert!(!is_on(0.0) || distance < limit + 1e-9, "{part:?} {at} {distance} {limit}");
                // A convex core that meets the box is always detected; so is the centre alone
                // within half the distance, even at a corner.
                let is_surely = if is_point { distance < 0.5 * limit } else { is_convex && distance == 0.0 };
                prop_assert!(!is_surely || is_on(1e-9), "{part:?} {at} {distance} {limit}");
            }
            for cell in field.frame().cells().filter(|&cell| field.obstacles().get(cell)) {
                let low = Point::new(f64::from(cell.x), f64::from(cell.y));
                let square = NearBox { low, high: low + Point::new(1.0, 1.0), from_middle: 0.0 };
                let is_around = boxes.iter().any(|near| {
                    near.low.x <= low.x && near.low.y <= low.y && near.high.x > low.x && near.high.y > low.y
                });
                prop_assert!(is_around || to_box(&square) >= to_others - 1e-9);
            }
            prop_assert!(holds(&border, near.to_border(&at)));
        }
    }

    /// A motion reported as kept keeps its distance; one that keeps it by a wide margin is
    /// reported.
    #[test]
    fn straight_ways_that_keep_a_distance(
        cells in prop::collection::vec(prop::bool::weighted(0.01), 70 * 20),
        radii in prop::collection::vec(0.05..0.3f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64), shape in 0..4usize,
        x in 0.0..3.5f64, y in 0.0..1.0f64, theta in -3.1..3.1f64, driven in -3.0..3.0f64, turned in -0.3..0.3f64,
        distance in 0.0..5.0f64,
    ) {
        let field = field(&cells, 0.0, DistanceTo::Squares, f64::INFINITY);
        let footprint = shaped(shape, &radii, offset);
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let mut near =
            NearObstacles::new(&core, &field, Reach { distance: 30.0, way: 10.0, spread: 0.0 }, &mut memory);
        let ahead = Point::new(libm::cos(theta), libm::sin(theta)) * (1.0 / CELL_M);
        let [mut at_first, mut at_last] = [Turned::default(), Turned::default()];
        at_first.turn(&core, ahead);
        at_last.turn(&core, Point::new(libm::cos(theta + turned), libm::sin(theta + turned)) * (1.0 / CELL_M));
        let from = Placement { origin: Point::new(x / CELL_M, y / CELL_M), turned: &at_first };
        let to = Placement { origin: from.origin + ahead * (driven * CELL_M), turned: &at_last };
        prop_assume!(field.nearest_cell(to.origin) == Cell::new(to.origin.x.floor() as i32, to.origin.y.floor() as i32));
        let ends = |at: &Placement<'_>| -> Vec<Point> {
            let vertices = &at.turned.vertices;
            if vertices.is_empty() { vec![at.origin] } else { vertices.iter().map(|&v| at.origin + v).collect() }
        };
        let squares: Vec<NearBox> = field.frame().cells().filter(|&cell| field.obstacles().get(cell)).map(|cell| {
            let low = Point::new(f64::from(cell.x), f64::from(cell.y));
            NearBox { low, high: low + Point::new(1.0, 1.0), from_middle: 0.0 }
        }).collect();
        let nearest = (0..=100).map(|i| f64::from(i) / 100.0).flat_map(|part| {
            let moved: Vec<Point> = ends(&from).iter().zip(ends(&to)).map(|(a, b)| a.lerp(b, part)).collect();
            outline(moved.into_iter())
        }).flat_map(|edge| squares.iter().map(move |square| square.way_to_edge(edge).norm())).fold(f64::INFINITY, f64::min);
        let is_kept = near.is_kept(&from, &to, distance);
        prop_assert!(!is_kept || nearest >= distance - 1e-9, "{nearest} {distance}");
        let way = driven.abs() + 2.0 * near.swing * turned.abs();
        prop_assert!(is_kept || nearest <= distance + way + 1e-9, "{nearest} {distance} {way}");
    }
}

/// Coordinates in quarters of a cell, so that motions touch corners and edges.
fn coordinate(cells: u32) -> impl Strategy<Value = f64> {
    let most = f64::from(cells);
    prop_oneof![(0..=4 * cells).prop_map(|quarters| 0.25 * f64::from(quarters)), 0.0..=most]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// With a distance of 0 a point may touch a square's corner or edge, as a line may. It enters
    /// no square and slips between none, but may leave a square that contains it.
    #[test]
    fn straight_ways_of_a_point_are_lines(
        cells in prop::collection::vec(prop::bool::weighted(0.1), 12 * 12), is_disc: bool,
        from in (coordinate(12), coordinate(12)), to in (coordinate(12), coordinate(12)),
        distance in prop_oneof![Just(0.0), Just(-1e-9), -2.0..0.0f64],
    ) {
        let frame = GridFrame::new(12, 12, CELL_M, Pose::new(1.0, -2.0, 0.7)).unwrap();
        let mut obstacles = BitGrid::new(12, 12, false);
        frame.cells().zip(cells).filter(|cell| cell.1).for_each(|cell| _ = obstacles.set(cell.0, true));
        let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
        let footprint = Footprint::circle(if is_disc { 0.1 } else { 0.0 }).unwrap();
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let reach = Reach { distance: 30.0, way: 30.0, spread: 0.0 };
        let mut near = NearObstacles::new(&core, &field, reach, &mut memory);
        let turned = Turned::default();
        let [from, to] = [from, to].map(|(x, y)| Placement { origin: Point::new(x, y), turned: &turned });
        let is_kept = near.is_kept(&from, &to, distance);
        let in_world = |at: &Placement<'_>| frame.world_from_grid(at.origin);
        let is_in = |square: &Cell| {
            let off = from.origin - Point::new(f64::from(square.x) + 0.5, f64::from(square.y) + 0.5);
            off.x.abs().max(off.y.abs()) < 0.5 - 1e-6
        };
        let begins_inside = frame.cells().filter(|&cell| obstacles.get(cell)).any(|cell| is_in(&cell));
        let goes_nowhere = from.origin == to.origin;
        let line = Segment::new(in_world(&from), in_world(&to));
        let is_clear = field.clearance().is_clear(line, 0.0);
        prop_assert_eq!(is_kept, is_clear || begins_inside || goes_nowhere);
    }
}

proptest! {
    /// At a hundred poses of a motion reported as kept, the outline of a polygon enters no
    /// square, or by no more than requested.
    #[test]
    fn straight_ways_of_a_polygon_enter_nothing(
        cells in prop::collection::vec(prop::bool::weighted(0.02), 70 * 20),
        radii in prop::collection::vec(0.05..0.3f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64), shape in 1..4usize,
        x in coordinate(70), y in coordinate(20), theta in prop_oneof![Just(0.0), -3.1..3.1f64],
        driven in prop_oneof![-3.0..3.0f64, -1e-6..1e-6f64], turned in prop_oneof![Just(0.0), -0.3..0.3f64],
        distance in prop_oneof![Just(0.0), Just(-1e-9)],
    ) {
        let field = field(&cells, 0.0, DistanceTo::Squares, f64::INFINITY);
        let footprint = shaped(shape, &radii, offset);
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let reach = Reach { distance: 30.0, way: 10.0, spread: 0.0 };
        let mut near = NearObstacles::new(&core, &field, reach, &mut memory);
        let ahead = |theta: f64| Point::new(libm::cos(theta), libm::sin(theta)) * (1.0 / CELL_M);
        let [mut at_first, mut at_last] = [Turned::default(), Turned::default()];
        at_first.turn(&core, ahead(theta));
        at_last.turn(&core, ahead(theta + turned));
        let from = Placement { origin: Point::new(x, y), turned: &at_first };
        let to = Placement { origin: from.origin + ahead(theta) * (driven * CELL_M), turned: &at_last };
        if !near.is_kept(&from, &to, distance) {
            return Ok(());
        }
        let vertices = |at: &Placement<'_>| -> Vec<Point> { at.edges().map(|edge| edge.a).collect() };
        let ends = [vertices(&from), vertices(&to)];
        for part in (0..=100).map(|i| f64::from(i) / 100.0) {
            let moved = ends[0].iter().zip(&ends[1]).map(|(a, b)| a.lerp(*b, part));
            for edge in outline(moved.collect::<Vec<_>>().into_iter()) {
                let enters = |cell: Cell| {
                    // A square shrunk by the tolerance.
                    let corner = Point::new(f64::from(cell.x), f64::from(cell.y)) + Point::new(1e-6, 1e-6);
                    let scale = |point: Point| (point - corner) * (1.0 / (1.0 - 2e-6));
                    let unit = crate::geometry::Square { corner: Point::default() };
                    Segment::new(scale(edge.a), scale(edge.b)).meets(unit)
                };
                let entered = field.frame().cells().find(|&cell| field.obstacles().get(cell) && enters(cell));
                prop_assert_eq!(entered, None, "{} {:?}", part, edge);
            }
        }
    }
}

#[test]
fn many_cells_are_remembered_until_the_next_round() {
    let field = field(&[false; 70 * 20], 0.0, DistanceTo::Squares, f64::INFINITY);
    let footprint = Footprint::circle(0.1).unwrap();
    let (core, _) = footprint.core();
    let mut memory = NearBoxes::default();
    for round in 0..3 {
        let mut near = NearObstacles::new(
            &core,
            &field,
            Reach { distance: 1.0, way: 0.0, spread: 0.0 },
            &mut memory,
        );
        for cell in field.frame().cells() {
            near.gather(cell);
        }
        let used = near.memory.used;
        assert_eq!(used, 70 * 20, "round {round}");
        assert!(field.frame().cells().all(|cell| near.memory.find(cell).is_some()));
    }
    memory.begin();
    assert!(memory.find(Cell::new(3, 3)).is_none());
    assert_eq!(memory.used, 0);
}

/// No point of a tile is farther from its middle than `half_diagonal`, on the map or not.
#[test]
fn tiles_hold_their_points() {
    let field = field(&[false; 70 * 20], 0.0, DistanceTo::Squares, f64::INFINITY);
    for footprint in [Footprint::circle(0.1).unwrap(), Footprint::rectangle(3.0, 2.0).unwrap()] {
        let (core, _) = footprint.core();
        let mut memory = NearBoxes::default();
        let reach = Reach { distance: 1.0, way: 0.0, spread: 0.0 };
        let near = NearObstacles::new(&core, &field, reach, &mut memory);
        let size = f64::from(1 << near.tile_bits);
        for (x, y) in (-40..40).flat_map(|x| (-40..40).map(move |y| (x, y))) {
            let point = Point::new(0.37 * f64::from(x), 0.37 * f64::from(y));
            let tile = near.tile(point);
            let middle = Point::new(f64::from(tile.x) + 0.5, f64::from(tile.y) + 0.5) * size;
            assert!(point.distance(middle) <= near.half_diagonal, "{point:?} {tile:?}");
        }
    }
}

/// A box that drives along a wall, towards it and away from it: its bounds equal its distance.
#[test]
fn beside_a_wall_the_bounds_meet() {
    let mut obstacles = BitGrid::new(70, 20, false);
    obstacles.fill_span(19, 0, 69);
    let frame = GridFrame::new(70, 20, CELL_M, Pose::default()).unwrap();
    let field = DistanceField::new(&frame, &obstacles, &FieldConfig::default());
    let footprint = Footprint::rectangle(0.5, 0.4).unwrap();
    let (core, _) = footprint.core();
    let mut memory = NearBoxes::default();
    let reach = Reach { distance: 20.0, way: 0.0, spread: 4.0 };
    let mut near = NearObstacles::new(&core, &field, reach, &mut memory);
    for heading in [0.0, 0.1, -0.7, 2.0] {
        let mut turned = Turned::default();
        turned.turn(&core, Point::new(libm::cos(heading), libm::sin(heading)) * (1.0 / CELL_M));
        let middle = Placement { origin: Point::new(35.0, 9.0), turned: &turned };
        let half = Point::new(libm::cos(heading), libm::sin(heading)) * 3.0;
        let around = near.around(middle.origin);
        assert_eq!(around.boxes().len(), 1);
        let sweep = Sweep { middle, half, half_length: 3.0 };
        let Apart { at_least, at_most } = near.apart(around.boxes().start, &sweep, 20.0).unwrap();
        let top = 5.0 * libm::sin(heading).abs() + 4.0 * libm::cos(heading).abs();
        for (bound, by) in
            [(at_least.begin, -1.0), (at_most.begin, -1.0), (at_least.end, 1.0), (at_most.end, 1.0)]
        {
            let distance = 19.0 - (9.0 + top + by * half.y);
            assert!((bound - distance).abs() < 1e-12, "{heading} {bound} {distance}");
        }
    }
}
