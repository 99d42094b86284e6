//! Exact distances of a core at many places near each other.
//!
//! What can be nearest to a core depends little on where exactly it is. So for each small tile that its centre of
//! rotation comes to, the obstacle squares that can be nearest are gathered once, joined to boxes, the nearest box first. After
//! that a measurement is a few comparisons. All lengths are in cells.

use super::core::Core;
use crate::geometry::{Point, Pose, Segment, outline};
use crate::map::{Cell, DistanceField, GridFrame};
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

/// A core turned to a heading: its vertices around the centre of rotation, along the grid's axes \[cells\].
#[derive(Clone, Debug, Default)]
pub(crate) struct Turned {
    vertices: Vec<Point>,
    /// The vertices that are farthest to the left, to the right, down and up; the centre where it is alone.
    left: Point,
    right: Point,
    lowest: Point,
    highest: Point,
}

/// Where a core is on a grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement<'a> {
    /// The centre of rotation \[cells\].
    pub(crate) origin: Point,
    pub(crate) turned: &'a Turned,
}

/// The boxes of the tiles visited so far: memory, which can be used again for other fields and cores.
#[derive(Debug, Default)]
pub(crate) struct NearBoxes {
    /// A hash table of tiles with open addressing; entries of an earlier round are free places.
    slots: Vec<Slot>,
    boxes: Vec<NearBox>,
    used: usize,
    round: u32,
}

/// The boxes of a tile.
#[derive(Clone, Copy, Debug)]
struct Slot {
    round: u32,
    tile: Cell,
    first: u32,
    end: u32,
}

impl Slot {
    const FREE: Self = Self { round: 0, tile: Cell::new(0, 0), first: 0, end: 0 };
}

/// Obstacle squares that make up a rectangle.
#[derive(Clone, Copy, Debug)]
struct NearBox {
    low: Point,
    high: Point,
    /// Its distance from the tile's middle.
    from_middle: f64,
}

/// What is asked for in one round.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Distances of at least this are not told apart.
    pub(crate) distance: f64,
    /// The distance and half the length of a way for which [`Surroundings::is_kept`] is asked, together.
    pub(crate) way: f64,
}

/// A core among the obstacles of a field.
#[derive(Debug)]
pub(crate) struct Surroundings<'a> {
    field: &'a DistanceField,
    /// Distance of the farthest vertex from the centre of rotation.
    swing: f64,
    /// Distance of the nearest point of the core from the centre of rotation.
    aside: f64,
    /// A tile has 2 to the power of this cells along each side.
    tile_bits: u32,
    /// No point of a tile is farther from its middle.
    half_diagonal: f64,
    reach: Reach,
    memory: &'a mut NearBoxes,
}

impl Turned {
    /// Turns a core so that its x axis points along `ahead`, which is as long as a metre \[cells\].
    pub(crate) fn turn(&mut self, core: &Core<'_>, ahead: Point) {
        let left = Point::new(-ahead.y, ahead.x);
        let turned = |vertex: &Point| ahead * vertex.x + left * vertex.y;
        self.vertices.clear();
        self.vertices.extend(core.vertices().iter().map(turned));
        let first = self.vertices.first().copied().unwrap_or_default();
        (self.left, self.right, self.lowest, self.highest) = (first, first, first, first);
        for &vertex in &self.vertices {
            if vertex.x < self.left.x {
                self.left = vertex;
            }
            if vertex.x > self.right.x {
                self.right = vertex;
            }
            if vertex.y < self.lowest.y {
                self.lowest = vertex;
            }
            if vertex.y > self.highest.y {
                self.highest = vertex;
            }
        }
    }
}

impl Placement<'_> {
    fn edges(&self) -> impl Iterator<Item = Segment> {
        outline(self.turned.vertices.iter().map(|&vertex| self.origin + vertex))
    }
}

/// A pose on the grid: its place \[cells\], and where its x axis points, as long as a metre.
pub(crate) fn on_grid(pose: Pose, frame: &GridFrame) -> (Point, Point) {
    let (sin, cos) = libm::sincos(pose.theta - frame.origin().theta);
    (frame.grid_from_world(pose.point()), Point::new(cos, sin) * (1.0 / frame.resolution_m()))
}

impl<'a> Surroundings<'a> {
    /// So many boxes are looked at for one that goes on in the next row.
    const OPEN: usize = 16;

    /// Tiles are at most so large.
    const MOST_TILE_BITS: u32 = 4;

    /// A new round: what the memory holds of an earlier one is forgotten.
    pub(crate) fn new(
        core: &Core<'_>,
        field: &'a DistanceField,
        reach: Reach,
        memory: &'a mut NearBoxes,
    ) -> Self {
        memory.begin();
        let cell_m = field.frame().resolution_m();
        let swing = core.swing_m() / cell_m;
        let aside = core.distance_to_m(Pose::default(), Point::default()) / cell_m;
        // Tiles small beside the core: their size hardly makes more boxes near.
        let tile_bits = ((swing / 3.0).max(1.0).log2() as u32).min(Self::MOST_TILE_BITS);
        let half_diagonal = f64::from(1 << tile_bits) * FRAC_1_SQRT_2 + 1e-9;
        Self { field, swing, aside, tile_bits, half_diagonal, reach, memory }
    }

    /// True only when at no heading the core is nearer than `distance` to an obstacle square. One load.
    #[inline]
    pub(crate) fn is_beyond(&self, origin: Point, distance: f64) -> bool {
        self.field.is_beyond(origin, distance + self.swing)
    }

    /// Distance to the nearest obstacle square: 0 when an edge touches one, `most` when none is nearer than
    /// that or than the reach. What lies wholly inside a polygon is not seen: for poses on a way that begins
    /// free. Where the centre of rotation is outside the map, this is a lower bound.
    pub(crate) fn distance(&mut self, at: &Placement<'_>, most: f64) -> f64 {
        let (tile, outside) = self.tile(at.origin);
        let slack = self.slack() + outside;
        let most = most.min(self.reach.distance);
        let boxes = self.boxes_around(tile);
        let mut nearest_sq = most * most;
        for near in &self.memory.boxes[boxes] {
            let least = near.from_middle - slack;
            if least > 0.0 && least * least >= nearest_sq {
                break;
            }
            let distance_sq = near.distance_sq_to_core(at, nearest_sq);
            if distance_sq < nearest_sq {
                nearest_sq = distance_sq;
            }
        }
        (nearest_sq.sqrt() - outside).max(0.0)
    }

    /// Distance of a core from the map's border; negative outside.
    pub(crate) fn to_border(&self, at: &Placement<'_>) -> f64 {
        let frame = self.field.frame();
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let Turned { left, right, lowest, highest, .. } = at.turned;
        let low = (at.origin.x + left.x).min(at.origin.y + lowest.y);
        low.min(width - (at.origin.x + right.x)).min(height - (at.origin.y + highest.y))
    }

    /// True only when the core keeps a distance from all obstacle squares on a short way on which each of
    /// its vertices (or the centre, where it is alone) moves along a straight line. False for ways and distances
    /// beyond [`Reach::way`].
    ///
    /// An edge is then always in the hull of its four ends, and if these are all on one side of a
    /// line, so is the edge. The line is put across the shortest connection half-way.
    pub(crate) fn is_kept(
        &mut self,
        from: &Placement<'_>,
        to: &Placement<'_>,
        distance: f64,
    ) -> bool {
        let middle = from.origin.lerp(to.origin, 0.5);
        let (tile, outside) = self.tile(middle);
        let half_way = 0.5 * from.origin.distance(to.origin);
        let is_within_reach = distance + half_way <= self.reach.way;
        if !is_within_reach {
            return false;
        }
        let slack = self.slack() + outside + half_way;
        let boxes = self.boxes_around(tile);
        let near = &self.memory.boxes[boxes];
        let mut near = near.iter().take_while(|near| near.from_middle - slack < distance);
        if from.turned.vertices.is_empty() {
            let way = Segment::new(from.origin, to.origin);
            return near.all(|near| near.way_to_edge(way).norm() >= distance);
        }
        near.all(|near| {
            let mut pairs = from.edges().zip(to.edges());
            pairs.all(|(from, to)| near.is_kept_by(from, to, distance))
        })
    }

    /// No point of the core is farther from the middle of the tile in which its centre of rotation is.
    fn slack(&self) -> f64 {
        self.swing + self.half_diagonal
    }

    /// Whether a point is on the map \[cells\].
    #[inline]
    pub(crate) fn is_inside(&self, point: Point) -> bool {
        let frame = self.field.frame();
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        point.x >= 0.0 && point.y >= 0.0 && point.x <= width && point.y <= height
    }

    /// The tile nearest to a point, and how far the point is outside the map.
    #[inline]
    fn tile(&self, point: Point) -> (Cell, f64) {
        let (cell, frame) = (self.field.nearest_cell(point), self.field.frame());
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let beyond = |value: f64, count: f64| (-value).max(value - count).max(0.0);
        let outside = if self.is_inside(point) {
            0.0
        } else {
            Point::new(beyond(point.x, width), beyond(point.y, height)).norm()
        };
        (Cell::new(cell.x >> self.tile_bits, cell.y >> self.tile_bits), outside)
    }

    /// The boxes that can be nearest while the centre of rotation is in a tile.
    fn boxes_around(&mut self, tile: Cell) -> Range<usize> {
        if let Some(known) = self.memory.find(tile) {
            return known;
        }
        let first = self.memory.boxes.len();
        self.gather(tile);
        self.memory.insert(tile, first)
    }

    /// One of the core's points is not much farther from the square that is nearest to the tile's middle.
    fn gather(&mut self, tile: Cell) {
        let middle = |index: i32| (f64::from(index) + 0.5) * f64::from(1 << self.tile_bits);
        let middle = Point::new(middle(tile.x), middle(tile.y));
        let (_, at_most) = self.field.square_bounds_on_grid(middle);
        let nearest = at_most + self.half_diagonal + self.aside;
        let reach = self.slack() + nearest.min(self.reach.distance).max(self.reach.way);
        let frame = self.field.frame();
        let clipped = |value: f64, count: u32| (value.max(0.0) as i32).min(count as i32 - 1);
        let columns =
            [middle.x - reach, middle.x + reach].map(|value| clipped(value, frame.width()));
        let rows = [middle.y - reach, middle.y + reach].map(|value| clipped(value, frame.height()));
        let boxes = &mut self.memory.boxes;
        let first = boxes.len();
        for y in rows[0]..=rows[1] {
            for_each_run(self.field.obstacles().row(y), columns, |from, to| {
                let (low, high) = (f64::from(from), f64::from(to + 1));
                let bottom = f64::from(y);
                let is_below =
                    |one: &NearBox| one.high.y == bottom && one.low.x == low && one.high.x == high;
                if let Some(below) =
                    boxes[first..].iter_mut().rev().take(Self::OPEN).find(|one| is_below(one))
                {
                    below.high.y += 1.0;
                } else {
                    let (low, high) = (Point::new(low, bottom), Point::new(high, bottom + 1.0));
                    boxes.push(NearBox { low, high, from_middle: 0.0 });
                }
            });
        }
        let mut kept = first;
        for index in first..boxes.len() {
            let from_middle = boxes[index].way_to_point(middle).norm();
            if from_middle <= reach {
                boxes[kept] = NearBox { from_middle, ..boxes[index] };
                kept += 1;
            }
        }
        boxes.truncate(kept);
        boxes[first..].sort_unstable_by(|a, b| a.from_middle.total_cmp(&b.from_middle));
    }
}

/// Visits the runs of set bits among columns of a row ([`crate::map::BitGrid::row`]) of the grid.
fn for_each_run(row: &[u64], [from, to]: [i32; 2], mut visit: impl FnMut(i32, i32)) {
    let (mut at, end) = ((from + 1) as usize, (to + 2) as usize);
    let next = |at: usize, flip: u64| {
        let mut word = at / 64;
        let mut bits = (row[word] ^ flip) & (u64::MAX << (at % 64));
        while bits == 0 && (word + 1) * 64 < end {
            word += 1;
            bits = row[word] ^ flip;
        }
        (word * 64 + bits.trailing_zeros() as usize).min(end)
    };
    while at < end {
        let first = next(at, 0);
        if first == end {
            return;
        }
        at = next(first, u64::MAX);
        visit(first as i32 - 1, at as i32 - 2);
    }
}

/// The larger of two numbers, the second one where the first is NaN: one instruction, unlike [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl NearBox {
    /// The shortest way from a point to the box; 0 inside.
    fn way_to_point(&self, point: Point) -> Point {
        let beside = |low: f64, high: f64, at: f64| {
            if at < low {
                low - at
            } else if at > high {
                high - at
            } else {
                0.0
            }
        };
        Point::new(
            beside(self.low.x, self.high.x, point.x),
            beside(self.low.y, self.high.y, point.y),
        )
    }

    /// Squared distance from a core, if it is less than a limit; otherwise some number of at least the limit.
    #[inline]
    fn distance_sq_to_core(&self, at: &Placement<'_>, limit_sq: f64) -> f64 {
        let Turned { left, right, lowest, highest, vertices } = at.turned;
        let (low, high) = (self.low - at.origin, self.high - at.origin);
        // A frame around the core that touches it at these four vertices is not farther away.
        let (beside, vertex_x) = if left.x >= high.x {
            (left.x - high.x, left)
        } else {
            (larger(low.x - right.x, 0.0), right)
        };
        let (above, vertex_y) = if lowest.y >= high.y {
            (lowest.y - high.y, lowest)
        } else {
            (larger(low.y - highest.y, 0.0), highest)
        };
        let least_sq = beside * beside + above * above;
        // Mostly such a vertex is the nearest.
        let is_level = |vertex: &Point| vertex.y >= low.y && vertex.y <= high.y;
        let is_upright = |vertex: &Point| vertex.x >= low.x && vertex.x <= high.x;
        if least_sq >= limit_sq
            || vertices.is_empty()
            || beside > 0.0 && above == 0.0 && is_level(vertex_x)
            || above > 0.0 && beside == 0.0 && is_upright(vertex_y)
        {
            return least_sq;
        }
        let to_edge = |edge| self.way_to_edge(edge).norm_sq();
        at.edges().map(to_edge).fold(f64::INFINITY, f64::min)
    }

    /// The shortest way from an edge to the box; 0 when they meet.
    ///
    /// Two convex shapes that do not meet are nearest at a corner of one of them. Among the box's
    /// corners this can only be the one nearest to the edge's line.
    #[inline]
    fn way_to_edge(&self, Segment { a, b }: Segment) -> Point {
        let along = b - a;
        let (low, high) = (self.low - a, self.high - a);
        let is_left = along.cross(low + high) >= 0.0;
        let corner = Point::new(
            if (along.y > 0.0) == is_left { high.x } else { low.x },
            if (along.x > 0.0) == is_left { low.y } else { high.y },
        );
        let normal =
            if is_left { Point::new(-along.y, along.x) } else { Point::new(along.y, -along.x) };
        // How far the corner is from the line, times the edge's length; at most 0 where the line meets the box.
        let off = normal.dot(corner);
        let (ahead, length_sq) = (along.dot(corner), along.norm_sq());
        if off > 0.0 && ahead > 0.0 && ahead < length_sq {
            return normal * (off / length_sq);
        }
        let meet = |a: f64, b: f64, low: f64, high: f64| a.max(b) >= low && a.min(b) <= high;
        if off <= 0.0
            && meet(a.x, b.x, self.low.x, self.high.x)
            && meet(a.y, b.y, self.low.y, self.high.y)
        {
            return Point::default();
        }
        let (from_a, from_b) = (self.way_to_point(a), self.way_to_point(b));
        if from_a.norm_sq() <= from_b.norm_sq() { from_a } else { from_b }
    }

    /// Whether an edge that moves keeps a distance; see [`Surroundings::is_kept`].
    fn is_kept_by(&self, from: Segment, to: Segment, distance: f64) -> bool {
        let half_way = Segment::new(from.a.lerp(to.a, 0.5), from.b.lerp(to.b, 0.5));
        let shortest = self.way_to_edge(half_way);
        let apart = shortest.norm();
        if apart <= 0.0 {
            return false;
        }
        let towards = shortest * (1.0 / apart);
        let corner = Point::new(
            if towards.x > 0.0 { self.low.x } else { self.high.x },
            if towards.y > 0.0 { self.low.y } else { self.high.y },
        );
        let box_at = towards.dot(corner);
        [from.a, from.b, to.a, to.b].iter().all(|&end| box_at - towards.dot(end) >= distance)
    }
}

impl NearBoxes {
    /// Places at first: a cycle comes to some hundred tiles.
    const FIRST_SLOTS: usize = 1024;

    fn begin(&mut self) {
        self.boxes.clear();
        self.used = 0;
        self.round = self.round.wrapping_add(1);
        if self.slots.is_empty() || self.round == 0 {
            let count = self.slots.len().max(Self::FIRST_SLOTS);
            self.slots.clear();
            self.slots.resize(count, Slot::FREE);
            self.round = 1;
        }
    }

    /// The place of a tile, or the free one where it belongs.
    fn place(&self, tile: Cell) -> usize {
        let mask = self.slots.len() - 1;
        let mixed = (tile.x as u32).wrapping_add((tile.y as u32).wrapping_mul(0x9e37_79b1));
        let mut place = (mixed ^ mixed >> 15) as usize & mask;
        while self.slots[place].round == self.round && self.slots[place].tile != tile {
            place = (place + 1) & mask;
        }
        place
    }

    #[inline]
    fn find(&self, tile: Cell) -> Option<Range<usize>> {
        let slot = self.slots[self.place(tile)];
        (slot.round == self.round).then_some(slot.first as usize..slot.end as usize)
    }

    fn insert(&mut self, tile: Cell, first: usize) -> Range<usize> {
        self.used += 1;
        if 2 * self.used > self.slots.len() {
            self.grow();
        }
        let (place, end) = (self.place(tile), self.boxes.len());
        self.slots[place] = Slot { round: self.round, tile, first: first as u32, end: end as u32 };
        first..end
    }

    fn grow(&mut self) {
        let free = vec![Slot::FREE; 2 * self.slots.len()];
        let old = std::mem::replace(&mut self.slots, free);
        for slot in old.into_iter().filter(|slot| slot.round == self.round) {
            let place = self.place(slot.tile);
            self.slots[place] = slot;
        }
    }
}

#[cfg(test)]
#[path = "surroundings_tests.rs"]
mod tests;
