//! Cost to go: the remaining path length from every position around the robot to the end of the
//! route, and its direction of steepest descent.
//!
//! The path length is weighted by clearance: a metre counts as more if the robot has less
//! clearance than it would like. So the cheapest path keeps clear of corners if that costs
//! little, and is the shortest one if nothing else fits.
//!
//! # Source
//! \[Tsitsiklis1995\]: values grow outwards from the end, as in Dijkstra's search, but a path may
//! cross the line between two neighbours anywhere, with an interpolated value. So paths are not
//! bound to the directions of a grid. The eight triangles around a point, and the closed form of
//! [`across`], are those of \[Ferguson2006\].
//!
//! # Where this differs from the paper
//! A blocked metre costs 200 m instead of being infinite, so that there always is a direction,
//! and interpolation never meets infinity. A point applies its own weight to a whole step to it.
//! The excess of values between the directions of the grid is subtracted, so that values are the
//! distance to the end within line of sight of it.
//!
//! # Cost
//! Linear in the number of points from which the path is not much longer than from the robot.

use super::buckets::Buckets;
use super::lattice::Lattice;
use crate::geometry::{Disc, Point};
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// The cost to go from the points of a lattice.
#[derive(Debug, Default)]
pub(super) struct CostToGo {
    lattice: Lattice,
    /// Cost to go of each point \[m\].
    values: Vec<f32>,
    /// Weight of a metre at each point; infinite if it is blocked.
    weights: Vec<f32>,
    /// Cost of a straight step to each point \[m\].
    steps_m: Vec<f32>,
    /// For each settled point, the value that it passes on to its neighbours \[m\]; infinite for
    /// the others, and [`Self::NO_WAY_ON`] at the edge.
    leaving_m: Vec<f32>,
    open: Buckets,
    end: Point,
}

/// Weight of a metre, by the clearance of the centre of rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighing {
    /// Less clearance than this blocks \[m\].
    pub(super) blocked_m: f64,
    /// With less clearance than this the robot cannot turn around \[m\].
    pub(super) turning_m: f64,
    /// More clearance than this changes nothing \[m\].
    pub(super) comfortable_m: f64,
    /// Additional weight of a metre if the robot can just turn around.
    pub(super) discomfort: f64,
    /// Additional weight if the robot cannot turn around. It is 0 if a heading is required at the
    /// end: to drive in with the wrong heading, and out again, has to cost more than the
    /// reduction of the remaining path.
    pub(super) tight: f64,
}

/// The route ahead, in the positions of the lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayAhead<'a> {
    pub(super) robot: Point,
    /// The route from near the robot to its last point on the lattice.
    pub(super) route: &'a [Point],
    /// Ground on which moving obstacles walk, and around which the route leads.
    pub(super) walked: &'a [Disc],
}

impl Weighing {
    /// Usual value of `tight`: a heading has to fit there, and often does not.
    pub(super) const TIGHT: f64 = 3.0;

    fn weight(&self, room_m: f64) -> f64 {
        if room_m < self.blocked_m {
            return f64::INFINITY;
        }
        let missing = (self.comfortable_m - room_m) / (self.comfortable_m - self.turning_m);
        let missing = missing.clamp(0.0, 1.0);
        let tight = if room_m < self.turning_m { self.tight } else { 0.0 };
        1.0 + self.discomfort * missing * missing + tight
    }

    /// Weight of the tightest ground that is not blocked.
    fn largest(&self) -> f64 {
        1.0 + self.discomfort + self.tight
    }
}

impl CostToGo {
    /// Weight of a metre through an obstacle.
    const THROUGH: f32 = 200.0;

    /// No path leads along the edge of the lattice: only its inner side is known, so values there
    /// would depend on the order in which points are settled.
    const NO_WAY_ON: f32 = f32::MAX;

    /// On open ground values are too large by no more than this fraction of the distance.
    const EXCESS: f32 = 0.03;

    /// Computes the cost to go from all points from which the path is at most `beyond_m` longer
    /// than from the robot; all others get the largest value found.
    pub(super) fn fill(
        &mut self,
        lattice: Lattice,
        weighing: &Weighing,
        room_m: impl Fn(Point) -> f64,
        way: &WayAhead<'_>,
        beyond_m: f64,
    ) {
        self.lattice = lattice;
        self.values.clear();
        self.values.resize(lattice.count(), f32::INFINITY);
        self.leaving_m.clear();
        self.leaving_m.resize(lattice.count(), f32::INFINITY);
        self.weights.clear();
        self.open.clear(FRAC_1_SQRT_2 * lattice.spacing_m as f32);
        for y in 0..lattice.side {
            let weights =
                (0..lattice.side).map(|x| weighing.weight(room_m(lattice.position(x, y))) as f32);
            self.weights.extend(weights);
        }
        self.block_walked(way.walked, weighing);
        self.open_route(way.route, weighing);
        // A blocked point has the value of the free ground beside it, so that values in between
        // are those of the free ground.
        let free = |&weight: &f32| if weight.is_finite() { weight } else { 1.0 };
        self.steps_m.clear();
        self.steps_m
            .extend(self.weights.iter().map(|weight| free(weight) * lattice.spacing_m as f32));
        let end = way.route.last().copied().unwrap_or(way.robot);
        self.end = end;
        self.begin(end);
        self.grow(way.robot, beyond_m as f32);
        self.straighten(end);
    }

    /// Blocks ground on which moving obstacles walk, as stationary obstacles do.
    fn block_walked(&mut self, walked: &[Disc], weighing: &Weighing) {
        let Lattice { side, spacing_m, .. } = self.lattice;
        for disc in walked {
            let reach = (disc.radius_m + weighing.blocked_m) / spacing_m;
            let centre = self.lattice.place(disc.centre);
            let [columns, rows] = self.lattice.within(centre, reach);
            for y in rows {
                for x in columns.clone() {
                    if Point::new(x as f64, y as f64).distance(centre) <= reach {
                        self.weights[y * side + x] = f32::INFINITY;
                    }
                }
            }
        }
    }

    /// Keeps the route open even if its passages fall between the points.
    fn open_route(&mut self, route: &[Point], weighing: &Weighing) {
        let most = weighing.largest() as f32;
        let side = self.lattice.side;
        for ends in route.windows(2) {
            let steps = (2.0 * ends[0].distance(ends[1]) / self.lattice.spacing_m).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let at = ends[0].lerp(ends[1], f64::from(step) / steps);
                // Opens both points if it is in the middle between two: neither side is
                // preferred.
                let [columns, rows] = self.lattice.within(self.lattice.place(at), 0.5);
                for index in rows.flat_map(|y| columns.clone().map(move |x| y * side + x)) {
                    self.weights[index] = self.weights[index].min(most);
                }
            }
        }
    }

    /// Initializes the points around the end with their distance to it.
    fn begin(&mut self, end: Point) {
        let Lattice { side, spacing_m, .. } = self.lattice;
        let place = self.lattice.place(end);
        let [columns, rows] = self.lattice.within(place, 2.0);
        for y in rows {
            for x in columns.clone() {
                let off = Point::new(x as f64, y as f64).distance(place);
                self.lower(y * side + x, (off * spacing_m) as f32);
            }
        }
    }

    fn lower(&mut self, index: usize, value: f32) {
        if value < self.values[index] {
            self.values[index] = value;
            self.open.push(value, index as u32);
        }
    }

    fn grow(&mut self, robot: Point, beyond_m: f32) {
        let side = self.lattice.side;
        let robot = self.lattice.nearest(robot);
        // Cost of a step through an obstacle.
        let through_m = Self::THROUGH * self.lattice.spacing_m as f32;
        let (mut most, mut farthest) = (f32::INFINITY, 0.0_f32);
        while let Some(index) = self.open.pop() {
            let index = index as usize;
            let value = self.values[index];
            if self.leaving_m[index].is_finite() {
                continue;
            }
            // No `break`: the order within a bucket must not decide which points are settled.
            if value > most {
                continue;
            }
            farthest = farthest.max(value);
            if Some(index) == robot {
                most = value + beyond_m;
            }
            let (x, y) = (index % side, index / side);
            if x == 0 || y == 0 || x + 1 == side || y + 1 == side {
                self.leaving_m[index] = Self::NO_WAY_ON;
                continue;
            }
            let is_blocked = self.weights[index].is_infinite();
            self.leaving_m[index] = value + if is_blocked { through_m } else { 0.0 };
            self.pass_on(index);
        }
        let all = self.values.iter_mut().zip(&self.leaving_m);
        all.filter(|(_, leaving_m)| leaving_m.is_infinite())
            .for_each(|(value, _)| *value = farthest);
    }

    /// Passes the value of a settled point on to its neighbours. It shares two triangles with
    /// each of them, whose third corners are neighbours as well: a path may cross the edge to
    /// such a corner if it is settled. The corner with the lower value is used.
    fn pass_on(&mut self, from: usize) {
        let side = self.lattice.side;
        let (below, above) = (from - side, from + side);
        let around = [from + 1, above + 1, above, above - 1, from - 1, below - 1, below, below + 1];
        let own = self.leaving_m[from];
        let leaving_m = around.map(|at| self.leaving_m[at]);
        for (at, &to) in around.iter().enumerate() {
            if leaving_m[at].is_finite() {
                continue;
            }
            let is_diagonal = at % 2 == 1;
            let aside = if is_diagonal { [7, 1] } else { [6, 2] };
            let [first, second] = aside.map(|by| leaving_m[(at + by) % 8]);
            let other = if first < second { first } else { second };
            let (straight, diagonal) = if is_diagonal { (other, own) } else { (own, other) };
            self.lower(to, across(straight, diagonal, self.steps_m[to]));
        }
    }

    /// Subtracts the excess of values between the directions of the grid, so that values are the
    /// distance to the end within line of sight of it, and directions are exact.
    fn straighten(&mut self, end: Point) {
        let Self { lattice, values, .. } = self;
        for y in 0..lattice.side {
            for x in 0..lattice.side {
                let value = &mut values[y * lattice.side + x];
                let straight = lattice.position(x, y).distance(end) as f32;
                *value = straight.max(*value - Self::EXCESS * straight);
            }
        }
    }

    /// The cost to go from a position \[m\], and its direction of steepest descent (not of length
    /// 1).
    pub(super) fn way(&self, position: Point) -> (f64, Point) {
        match self.straight_to_end(position) {
            Some(way) => (way.norm(), way),
            None => (self.at(position), -self.lattice.slope(&self.values, position)),
        }
    }

    /// The cost to go from a position, interpolated \[m\].
    fn at(&self, position: Point) -> f64 {
        self.lattice.value(&self.values, position)
    }

    /// Vector to the end, if the path is straight and has no additional weight; `None` at the end
    /// itself.
    pub(super) fn straight_to_end(&self, position: Point) -> Option<Point> {
        let way = self.end - position;
        let straight_m = way.norm();
        let longer_m = self.at(position) - straight_m;
        (straight_m > 0.0 && longer_m <= Self::ROUNDING * straight_m + Self::ROUNDING)
            .then_some(way)
    }

    /// Interpolation error of distances, as a fraction of them and in metres.
    const ROUNDING: f64 = 0.005;
}

/// Least value of a point that is a straight step from a neighbour with the value `straight` and
/// a diagonal one from a neighbour with the value `diagonal`, if the path to it may begin
/// anywhere between the two; `step` is the cost of a straight step. A neighbour that is not
/// settled has an infinite value: then the path comes from the other one.
///
/// At the fraction t of the line between them the value is straight - t g, with g = straight -
/// diagonal, and the path from there costs step sqrt(1 + t²). Their sum is least at t = g /
/// sqrt(step² - g²), with the value straight + sqrt(step² - g²).
fn across(straight: f32, diagonal: f32, step: f32) -> f32 {
    let gain = straight - diagonal;
    if gain <= 0.0 {
        straight + step
    } else if gain >= FRAC_1_SQRT_2 * step {
        diagonal + SQRT_2 * step
    } else {
        straight + (step * step - gain * gain).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::GridFrame;

    fn filled(room_m: impl Fn(Point) -> f64, robot: Point, route: &[Point]) -> CostToGo {
        filled_beside(&[], room_m, robot, route)
    }

    fn filled_beside(
        walked: &[Disc],
        room_m: impl Fn(Point) -> f64,
        robot: Point,
        route: &[Point],
    ) -> CostToGo {
        let frame = GridFrame::new(200, 200, 0.1, Pose::default()).unwrap();
        let lattice = Lattice::around(&frame, Point::new(10.0, 10.0), 8.0, 0.1);
        let weighing = Weighing {
            blocked_m: 0.3,
            turning_m: 0.4,
            comfortable_m: 0.6,
            discomfort: 0.5,
            tight: 3.0,
        };
        let mut cost_to_go = CostToGo::default();
        cost_to_go.fill(lattice, &weighing, room_m, &WayAhead { robot, route, walked }, 100.0);
        cost_to_go
    }

    #[test]
    fn the_best_place_between_two_neighbours_is_that_of_a_fine_search() {
        for [straight, diagonal, step] in
            [[1.0, 1.2, 0.5], [1.0, 0.9, 0.5], [1.0, 0.7, 0.5], [1.0, 0.5, 0.5], [3.0, 2.9, 2.0]]
        {
            let value = |t: f32| straight - t * (straight - diagonal) + step * (1.0 + t * t).sqrt();
            let best = (0..=10_000).map(|i| value(1e-4 * i as f32)).fold(f32::INFINITY, f32::min);
            assert!((across(straight, diagonal, step) - best).abs() < 1e-4);
        }
    }

    #[test]
    fn in_the_open_it_is_the_distance() {
        let end = Point::new(12.34, 9.87);
        let cost_to_go = filled(|_| 9.0, Point::new(4.0, 4.0), &[end]);
        for i in 0..400 {
            let at = Point::new(3.0 + 0.7 * f64::from(i % 20), 3.0 + 0.7 * f64::from(i / 20));
            let exact = at.distance(end);
            let found = cost_to_go.at(at);
            assert!((found - exact).abs() < 0.006, "{at:?}: {found}, {exact}");
            assert!(cost_to_go.straight_to_end(at).is_some());
            if exact > 1.0 {
                let off = cost_to_go.way(at).1.heading() - (end - at).heading();
                assert!(libm::sin(off).abs() < 0.005 && libm::cos(off) > 0.0, "{at:?}: {off}");
            }
        }
    }

    /// Around the end of a wall: two straight lines joined by an arc at the required clearance.
    #[test]
    fn around_a_corner_it_is_the_taut_line() {
        let corner = Point::new(10.0, 10.0);
        // A wall upwards from the corner; paths keep 1 m from it.
        let room = |at: Point| {
            let up = Point::new(10.0, at.y.max(10.0));
            if at.distance(up) < 1.0 { 0.0 } else { 9.0 }
        };
        let end = Point::new(13.0, 14.0);
        let cost_to_go = filled(room, Point::new(7.0, 14.0), &[end]);
        let at = Point::new(7.0, 14.0);
        // Tangents from both to the circle of 1 m around the corner, and the arc in between.
        let tangent = |from: Point| (from.distance(corner).powi(2) - 1.0).sqrt();
        let angle = |from: Point| libm::acos(1.0 / from.distance(corner));
        let all = 2.0 * std::f64::consts::PI - 2.0 * libm::atan2(3.0, 4.0);
        let arc = all - angle(at) - angle(end);
        let exact = tangent(at) + tangent(end) + arc;
        let found = cost_to_go.at(at);
        assert!((found / exact - 1.0).abs() < 0.03, "{found}, {exact}");
        assert!(cost_to_go.straight_to_end(at).is_none());
    }

    /// Tangents from both positions to the circle of 0.5 m around the end of the lane, and the
    /// arc in between.
    #[test]
    fn ground_on_which_movers_walk_is_gone_around() {
        let lane =
            |i: i32| Disc { centre: Point::new(10.0, 10.5 - 0.2 * f64::from(i)), radius_m: 0.2 };
        let lane: Vec<Disc> = (0..20).map(lane).collect();
        let (at, end) = (Point::new(8.0, 10.0), Point::new(13.0, 10.0));
        let cost_to_go = filled_beside(&lane, |_| 9.0, at, &[end]);
        let around_m = 2.0 + 3.0 + 0.41;
        let found_m = cost_to_go.at(at);
        assert!((found_m / around_m - 1.0).abs() < 0.03, "{found_m}");
        assert!(cost_to_go.way(at).1.y > 0.0);
    }

    /// Blocks, some of them at the edge, and an end beside the edge.
    #[test]
    fn a_mirror_changes_nothing() {
        let blocks: Vec<(i32, i32)> =
            (0..60).map(|i| (20 + (i * 37) % 163, 20 + (i * i * 11 + i * 29) % 163)).collect();
        let middle = 10.05;
        let values = |side: f64| {
            let mirrored = |at: Point| Point::new(at.x, middle + side * (at.y - middle));
            let room = |at: Point| {
                let at = mirrored(at) * 10.0;
                let off_m = |&(x, y): &(i32, i32)| {
                    0.1 * at.distance(Point::new(f64::from(x) + 0.53, f64::from(y) + 0.53))
                };
                blocks.iter().map(off_m).fold(9.0, f64::min)
            };
            let route = [Point::new(10.0, 10.0), Point::new(4.33, 2.14)].map(mirrored);
            filled(room, route[0], &route).values
        };
        let (left, right) = (values(1.0), values(-1.0));
        let side = 163;
        assert_eq!(left.len(), side * side);
        for (index, value) in left.iter().enumerate() {
            let (x, y) = (index % side, index / side);
            let other = right[(side - 1 - y) * side + x];
            assert!((value - other).abs() < 2e-5 * value, "({x}, {y}): {value}, mirrored {other}");
        }
    }

    #[test]
    fn a_closed_ring_is_left_through_its_thinnest_side() {
        // Blocked between 2 and 3 m from the middle, but to the left of it up to 2.3 m only.
        let middle = Point::new(10.0, 10.0);
        let room = |at: Point| {
            let (off, left) = (at.distance(middle), at.x < 10.0 && (at.y - 10.0).abs() < 0.6);
            if (2.0..if left { 2.3 } else { 3.0 }).contains(&off) { 0.0 } else { 9.0 }
        };
        let cost_to_go = filled(room, middle, &[Point::new(16.0, 10.0)]);
        assert!(cost_to_go.way(middle).1.x < 0.0);
        // Half a metre of blocked ground.
        assert!(cost_to_go.at(middle) < 8.0 + 100.0);
    }

    #[test]
    fn a_route_is_a_way_where_the_points_see_none() {
        let room = |at: Point| if (9.0..10.0).contains(&at.x) { 0.0 } else { 9.0 };
        let route = [Point::new(8.0, 10.0), Point::new(13.0, 10.0)];
        let through = filled(room, route[0], &route).at(route[0]);
        assert!(through < 5.0 + 1.2 * 3.5, "{through}");
    }
}
