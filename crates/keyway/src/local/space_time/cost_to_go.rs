//! How far it is to the end of the route from everywhere around the robot.
//!
//! The way is weighed by the room along it: a metre counts as more where the robot has less room than it would like. So the
//! cheapest way keeps clear of corners where that costs little, and is the shortest one where it cannot.
//!
//! # Source
//! Values grow outwards from the place where the route leaves the surroundings, as in Dijkstra's search; between two neighbours
//! they are taken to be linear, so directions are not bound to the grid: \[Ferguson2006\], and \[Tsitsiklis1995\].

use super::lattice::Lattice;
use crate::geometry::Point;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The ways of one cycle.
#[derive(Debug, Default)]
pub(super) struct CostToGo {
    pub(super) lattice: Lattice,
    /// What is left from each point \[m\].
    pub(super) values: Vec<f32>,
    /// What a metre at each point counts as.
    weights: Vec<f32>,
    is_final: Vec<bool>,
    open: BinaryHeap<Reverse<(u32, u32)>>,
}

/// What a metre counts as beside an obstacle, and where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighing {
    /// Less room than this blocks \[m\], from the centre of rotation.
    pub(super) blocked_m: f64,
    /// With less than this the robot cannot turn everywhere \[m\].
    pub(super) turning_m: f64,
    /// More room than this changes nothing \[m\].
    pub(super) comfortable_m: f64,
    /// What a metre counts as in addition where the room is just enough to turn.
    pub(super) discomfort: f64,
}

impl Weighing {
    /// A metre where only the inscribed circle fits counts as this much more.
    const TIGHT: f64 = 3.0;

    /// What a metre counts as with so much room; infinite where it blocks.
    fn weight(&self, room_m: f64) -> f64 {
        if room_m < self.blocked_m {
            return f64::INFINITY;
        }
        let missing = (self.comfortable_m - room_m) / (self.comfortable_m - self.turning_m);
        let missing = missing.clamp(0.0, 1.0);
        let tight = if room_m < self.turning_m { Self::TIGHT } else { 0.0 };
        1.0 + self.discomfort * missing * missing + tight
    }
}

impl CostToGo {
    /// Metres that a step through a blocked cell counts as, per metre: so there always is a way, and it leads to
    /// the place where the obstacle is thinnest.
    const THROUGH: f32 = 20.0;

    /// The ways to `end` from everywhere from which it is at most `beyond_m` farther than from the robot.
    pub(super) fn fill(
        &mut self,
        lattice: Lattice,
        weighing: &Weighing,
        room_m: impl Fn(Point) -> f64,
        (robot, route, end): (Point, &[Point], Point),
        beyond_m: f64,
    ) {
        self.lattice = lattice;
        let count = lattice.len();
        self.values.clear();
        self.values.resize(count, f32::INFINITY);
        self.is_final.clear();
        self.is_final.resize(count, false);
        self.weights.clear();
        self.open.clear();
        for y in 0..lattice.side {
            for x in 0..lattice.side {
                let weight = weighing.weight(room_m(lattice.position(x, y)));
                self.weights.push(weight as f32);
            }
        }
        self.open_route(route, weighing);
        self.begin(end);
        self.grow(robot, beyond_m as f32);
    }

    /// The route is a way even where its passages fall between the points.
    fn open_route(&mut self, route: &[Point], weighing: &Weighing) {
        let spacing_m = self.lattice.spacing_m();
        let most = (1.0 + Weighing::TIGHT + weighing.discomfort) as f32;
        for ends in route.windows(2) {
            let steps = (2.0 * ends[0].distance(ends[1]) / spacing_m).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let at = ends[0] + (ends[1] - ends[0]) * (f64::from(step) / steps);
                if let Some(index) = self.lattice.nearest(at) {
                    self.weights[index] = self.weights[index].min(most);
                }
            }
        }
    }

    fn begin(&mut self, end: Point) {
        let place = self.lattice.place(end);
        let side = self.lattice.side as i32;
        let spacing = self.lattice.spacing_m();
        for y in place.y.floor() as i32 - 1..=place.y.floor() as i32 + 2 {
            for x in place.x.floor() as i32 - 1..=place.x.floor() as i32 + 2 {
                if (0..side).contains(&x) && (0..side).contains(&y) {
                    let index = (y * side + x) as usize;
                    let off = Point::new(f64::from(x), f64::from(y)).distance(place) * spacing;
                    self.lower(index, off as f32);
                }
            }
        }
    }

    fn lower(&mut self, index: usize, value: f32) {
        if value < self.values[index] {
            self.values[index] = value;
            // Bits of positive numbers are in their order.
            self.open.push(Reverse((value.to_bits(), index as u32)));
        }
    }

    fn grow(&mut self, robot: Point, beyond_m: f32) {
        let side = self.lattice.side;
        let robot = self.lattice.nearest(robot);
        let mut most = f32::INFINITY;
        while let Some(Reverse((bits, index))) = self.open.pop() {
            let (index, value) = (index as usize, f32::from_bits(bits));
            if self.is_final[index] {
                continue;
            }
            if value > most {
                break;
            }
            self.is_final[index] = true;
            if Some(index) == robot {
                most = value + beyond_m;
            }
            let (x, y) = (index % side, index / side);
            if x == 0 || y == 0 || x + 1 == side || y + 1 == side {
                continue;
            }
            for (dx, dy) in NEIGHBOURS {
                let (to_x, to_y) = (x as i32 + dx, y as i32 + dy);
                self.pass(index, (dx, dy), (to_y * side as i32 + to_x) as usize);
            }
        }
        // What was not looked at is farther than everything that was.
        let farthest = if most.is_finite() { most } else { self.farthest() };
        for (value, is_final) in self.values.iter_mut().zip(&self.is_final) {
            if !is_final {
                *value = farthest;
            }
        }
    }

    fn farthest(&self) -> f32 {
        let known = self.values.iter().zip(&self.is_final).filter(|(_, is_final)| **is_final);
        known.map(|(value, _)| *value).fold(0.0, f32::max)
    }

    /// What a step away from a point that is done makes of a neighbour.
    fn pass(&mut self, from: usize, (dx, dy): (i32, i32), to: usize) {
        if self.is_final[to] {
            return;
        }
        let side = self.lattice.side as i32;
        let (to_x, to_y) = (to as i32 % side, to as i32 / side);
        let own = self.step_weight(to) * self.lattice.spacing_m() as f32;
        let leaving = self.leaving(from);
        let best = if dx != 0 && dy != 0 {
            // The line between this corner and an axial neighbour of the point.
            let across = [(to_x - dx, to_y), (to_x, to_y - dy)];
            let mut best = self.values[from] + leaving + own * std::f32::consts::SQRT_2;
            for (x, y) in across {
                let axial = (y * side + x) as usize;
                if self.is_final[axial] {
                    let (a, b) = (self.values[axial] + self.leaving(axial), self.values[from] + leaving);
                    best = best.min(between(a, b, own));
                }
            }
            best
        } else {
            let a = self.values[from] + leaving;
            let mut best = a + own;
            for turn in [-1, 1] {
                let (x, y) = (to_x - dx + turn * dy, to_y - dy + turn * dx);
                if !((0..side).contains(&x) && (0..side).contains(&y)) {
                    continue;
                }
                let diagonal = (y * side + x) as usize;
                if self.is_final[diagonal] {
                    best = best.min(between(a, self.values[diagonal] + self.leaving(diagonal), own));
                }
            }
            best
        };
        self.lower(to, best);
    }

    /// A blocked point has the value of the free ones beside it, so that values in between are those of the free ground.
    fn step_weight(&self, index: usize) -> f32 {
        let weight = self.weights[index];
        if weight.is_finite() { weight } else { 1.0 }
    }

    /// But to go on from there costs.
    fn leaving(&self, index: usize) -> f32 {
        if self.weights[index].is_finite() {
            0.0
        } else {
            Self::THROUGH * self.lattice.spacing_m() as f32
        }
    }

    /// What is left from a position \[m\].
    pub(super) fn at(&self, position: Point) -> f64 {
        f64::from(self.lattice.value(&self.values, position))
    }

    /// The direction in which that falls fastest.
    pub(super) fn direction(&self, position: Point) -> Point {
        let slope = self.lattice.slope(&self.values, position);
        Point::new(-slope.x, -slope.y)
    }
}

const NEIGHBOURS: [(i32, i32); 8] =
    [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// The least value beside a line from an axial neighbour with value `a` to a diagonal one with value `b`, when a step to the
/// former counts as `own`.
fn between(a: f32, b: f32, own: f32) -> f32 {
    let gain = a - b;
    if gain <= 0.0 {
        a + own
    } else if gain * std::f32::consts::SQRT_2 >= own {
        b + own * std::f32::consts::SQRT_2
    } else {
        a + (own * own - gain * gain).sqrt()
    }
}
