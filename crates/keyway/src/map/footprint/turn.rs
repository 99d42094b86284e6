//! Collision checks of a footprint that turns on the spot.

use crate::geometry::{Point, Pose, Square, holds_point, outline};
use crate::map::{Clearance, DistanceField};
use crate::robot::{Footprint, Polygon};
use std::f64::consts::TAU;

/// Distance from an obstacle below which a turning footprint is not free \[cells\].
pub(super) const LEAST_CELLS: f64 = 1e-3;

impl Footprint {
    /// True if the footprint is certainly free ([`Self::is_free`]) at every heading of a turn on
    /// the spot, from `from_rad` on by `turn_rad`, positive to the left. Also false if it comes
    /// within a thousandth of a cell of an obstacle or of the map's border in between, and for
    /// numbers that are not finite.
    ///
    /// The test does not sample headings. Around each heading tested, no part of the footprint
    /// moves farther than the circumscribed radius times the angle; if that is not less than the
    /// clearance, the turn is halved.
    pub fn is_free_turn(
        &self,
        point: Point,
        from_rad: f64,
        turn_rad: f64,
        field: &DistanceField,
    ) -> bool {
        self.keeps_room_turning(point, [from_rad, turn_rad], 0.0, field)
    }

    /// True if the footprint certainly keeps a clearance of `room_m` \[m\] from obstacles and from
    /// the border of the map during a turn: [`Self::is_free_turn`] with a margin. The turn is
    /// given by its initial heading and its angle \[rad\].
    pub fn keeps_room_turning(
        &self,
        point: Point,
        [from_rad, turn_rad]: [f64; 2],
        room_m: f64,
        field: &DistanceField,
    ) -> bool {
        if !turn_rad.is_finite() {
            return false;
        }
        let room_m = room_m.max(0.0);
        let to_rad = from_rad + turn_rad.clamp(-TAU, TAU);
        let keeps_room =
            |theta| self.keeps_room(Pose { x: point.x, y: point.y, theta }, room_m, field);
        if !keeps_room(from_rad) || !keeps_room(to_rad) {
            return false;
        }
        let Self::Polygon(polygon) = self else { return true };
        let room = room_m / field.frame().resolution_m();
        self.is_far(point, room_m, field)
            || turn_rad == 0.0
            || polygon.is_free_between(point, [from_rad, to_rad], room, &field.clearance())
    }
}

impl Polygon {
    /// The test with a clearance of `room` \[cells\].
    fn is_free_between(
        &self,
        point: Point,
        [from_rad, to_rad]: [f64; 2],
        room: f64,
        clearance: &Clearance<'_>,
    ) -> bool {
        let middle_rad = 0.5 * (from_rad + to_rad);
        let middle = Pose { x: point.x, y: point.y, theta: middle_rad };
        let moves_m = self.circumscribed_radius_m() * 0.5 * (to_rad - from_rad).abs();
        let moves_cells = moves_m / clearance.frame().resolution_m();
        if self.has_room(middle, room + moves_cells + 1e-3 * LEAST_CELLS, clearance) {
            return true;
        }
        moves_cells > LEAST_CELLS
            && self.is_clear(middle, clearance)
            && (room <= 0.0 || self.has_room(middle, room, clearance))
            && self.is_free_between(point, [from_rad, middle_rad], room, clearance)
            && self.is_free_between(point, [middle_rad, to_rad], room, clearance)
    }

    /// True if a pose is free with a clearance of `room` \[cells\] around the footprint.
    pub(super) fn has_room(&self, pose: Pose, room: f64, clearance: &Clearance<'_>) -> bool {
        let frame = clearance.frame();
        let to_grid = |&vertex: &Point| frame.grid_from_world(pose.world_from_body(vertex));
        let vertices: Vec<Point> = self.vertices().iter().map(to_grid).collect();
        if !vertices.iter().all(|&vertex| clearance.is_inside(vertex, room)) {
            return false;
        }
        let (mut low, mut high) = (vertices[0], vertices[0]);
        for vertex in &vertices {
            low = Point::new(low.x.min(vertex.x), low.y.min(vertex.y));
            high = Point::new(high.x.max(vertex.x), high.y.max(vertex.y));
        }
        let cell = |coordinate: f64| coordinate.floor() as i32;
        let columns = [cell(low.x - room), cell(high.x + room)];
        (cell(low.y - room)..=cell(high.y + room)).all(|y| {
            clearance.obstacles().ones_in_span(y, columns[0], columns[1]).all(|x| {
                let square = Square { corner: Point::new(f64::from(x), f64::from(y)) };
                let is_far = |edge: crate::geometry::Segment| {
                    edge.distance_sq_to_square(square) >= room * room
                };
                outline(vertices.iter().copied()).all(is_far)
                    && !holds_point(
                        outline(vertices.iter().copied()),
                        square.corner + Point::new(0.5, 0.5),
                    )
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{CellState, DistanceTo, FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::star;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn polygon(vertices: &[[f64; 2]]) -> Footprint {
        Footprint::polygon(vertices.iter().map(|&vertex| vertex.into()).collect()).unwrap()
    }

    fn is_free_turn(
        footprint: &Footprint,
        at: [f64; 2],
        from_rad: f64,
        turn_rad: f64,
        grid: &OccupancyGrid,
    ) -> bool {
        let [by_squares, by_centres] = [DistanceTo::Squares, DistanceTo::Centres].map(|to| {
            let config = FieldConfig { to, ..FieldConfig::default() };
            let field = DistanceField::new(grid.frame(), grid.occupied(), &config);
            footprint.is_free_turn(at.into(), from_rad, turn_rad, &field)
        });
        assert_eq!(by_squares, by_centres);
        by_squares
    }

    #[test]
    fn turns_by_hand() {
        // A box of 2 m x 0.8 m in a lane of 1 m fits along it both ways, and cannot turn around.
        let lane = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let long = polygon(&[[1.0, 0.4], [-1.0, 0.4], [-1.0, -0.4], [1.0, -0.4]]);
        let turns = |turn_rad| is_free_turn(&long, [2.5, 1.5], 0.0, turn_rad, &lane);
        assert!(turns(0.0) && turns(-0.1));
        // A corner 1 m ahead and 0.4 m aside is at sin t + 0.4 cos t: 0.5 m at t = 0.1023.
        assert!(turns(0.1) && !turns(0.103) && !turns(-0.103));
        assert!(!turns(PI), "free at both ends");
        assert!(!turns(f64::NAN) && !turns(f64::INFINITY));
        // The box is ahead of its centre: only a turn to the left hits a pillar on its left.
        let pillar = OccupancyGrid::from_ascii(&["#....", ".....", ".....", "....."]);
        let ahead = polygon(&[[0.0, 0.3], [0.0, -0.3], [1.9, -0.3], [1.9, 0.3]]);
        let turns = |turn_rad| is_free_turn(&ahead, [2.0, 2.0], FRAC_PI_2, turn_rad, &pillar);
        assert!(!turns(FRAC_PI_2), "over the pillar");
        assert!(turns(-3.0 * FRAC_PI_2), "to the same heading, the other way around");
        assert!(!turns(-5.5), "over the pillar at last");
        // At a border.
        let empty = OccupancyGrid::from_ascii(&["....."; 4]);
        assert!(is_free_turn(&ahead, [2.0, 2.0], 0.0, 2.0 * PI, &empty));
        assert!(!is_free_turn(&ahead, [1.8, 2.0], 0.0, 2.0 * PI, &empty));
        assert!(is_free_turn(&ahead, [1.8, 2.0], 0.0, FRAC_PI_2, &empty));
        // Its corners are 1.923 m away: beyond a border at 1.92 m only just before and after
        // straight ahead.
        assert!(!is_free_turn(&ahead, [3.08, 2.0], -1.0, 2.0, &empty));
        assert!(is_free_turn(&ahead, [3.07, 2.0], -1.0, 2.0, &empty));
        for endless in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert!(!is_free_turn(&ahead, [2.0, 2.0], 0.0, endless, &empty));
            assert!(!is_free_turn(&ahead, [2.0, 2.0], endless, 0.0, &empty));
        }
        // A footprint that touches both walls is free only as long as it does not turn.
        let tight = polygon(&[[1.0, 0.5], [-1.0, 0.5], [-1.0, -0.5], [1.0, -0.5]]);
        assert!(is_free_turn(&tight, [2.5, 1.5], 0.0, 0.0, &lane));
        assert!(!is_free_turn(&tight, [2.5, 1.5], 0.0, 0.01, &lane));
        // A needle of 30 m sweeps over one cell at the beginning: at about 0.02 to 0.05 of 0.6
        // rad.
        let frame = GridFrame::new(60, 60, 1.0, Pose::default()).unwrap();
        let post = OccupancyGrid::from_fn(frame, |cell| match (cell.x, cell.y) {
            (43, 26) => CellState::Occupied,
            _ => CellState::Free,
        });
        let needle = polygon(&[[0.0, 0.1], [0.0, -0.1], [30.0, -0.1], [30.0, 0.1]]);
        assert!(!is_free_turn(&needle, [15.5, 25.5], 0.0, 0.6, &post));
        assert!(!is_free_turn(&needle, [15.5, 25.5], 0.6, -0.6, &post));
        assert!(is_free_turn(&needle, [15.5, 25.5], 0.1, 0.5, &post));
        // A disc needs no more space than at rest.
        let disc = Footprint::circle(0.5).unwrap();
        assert!(is_free_turn(&disc, [2.5, 1.5], 0.0, PI, &lane));
        assert!(!is_free_turn(&disc, [2.5, 1.4], 0.0, PI, &lane));
    }

    /// A needle of 300 m hits a post near the end of a turn by 0.2 rad: at headings of about
    /// 0.095 to 0.0995, 28.4 m from its position in the middle of the turn. Its tip moves by 30 m
    /// from there.
    #[test]
    fn no_part_moves_farther_than_is_reckoned_with() {
        let needle = polygon(&[[0.0, 0.1], [0.0, -0.1], [300.0, -0.1], [300.0, 0.1]]);
        for (size, post, ahead_rad) in
            [((420, 100), (347, 79), 0.0), ((100, 420), (21, 347), FRAC_PI_2)]
        {
            let frame = GridFrame::new(size.0, size.1, 1.0, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |cell| {
                if (cell.x, cell.y) == post { CellState::Occupied } else { CellState::Free }
            });
            let at = [50.5, 50.5];
            let turns =
                |from: f64, turn: f64| is_free_turn(&needle, at, ahead_rad + from, turn, &grid);
            assert!(!turns(-0.1, 0.2) && !turns(0.1, -0.2));
            assert!(turns(-0.1, 0.19));
        }
    }

    proptest! {
        #[test]
        fn agrees_with_many_headings(cells in prop::collection::vec(prop::bool::weighted(0.03), 24 * 20),
                                     radii in prop::collection::vec(0.05..0.5f64, 3..9), offset in (-0.2..0.2f64, -0.2..0.2f64),
                                     x in 0.2..1.0f64, y in 0.2..0.8f64, from_rad in -3.1..3.1f64, turn_rad in -6.0..6.0f64,
                                     yaw in -3.0..3.0f64) {
            let frame = GridFrame::new(24, 20, 0.05, Pose::new(1.0, -2.0, yaw)).unwrap();
            let grid = OccupancyGrid::from_occupied(frame, &cells);
            let vertices = star(&radii, offset);
            let polygon = Polygon::new(vertices).unwrap();
            let at = frame.world_from_grid(Point::new(x / 0.05, y / 0.05));
            let free = is_free_turn(&Footprint::Polygon(polygon.clone()), at.into(), from_rad, turn_rad, &grid);
            let clearance = Clearance::new(grid.frame(), grid.occupied());
            let count = 500;
            let mut poses = (0..=count).map(|i| {
                Pose { x: at.x, y: at.y, theta: from_rad + turn_rad * f64::from(i) / f64::from(count) }
            });
            if free {
                prop_assert!(poses.all(|pose| polygon.is_clear(pose, &clearance)));
            } else {
                // Near some heading there is hardly any clearance.
                let between = polygon.circumscribed_radius_m() * turn_rad.abs() / f64::from(count) / 0.05;
                let little = between + 2.0 * LEAST_CELLS;
                prop_assert!(poses.any(|pose| !polygon.has_room(pose, little, &clearance)));
            }
        }
    }
}
