//! Exact distances of a core at many nearby poses.
//!
//! The obstacles that can be nearest to a core depend little on its exact position. The obstacle
//! squares that can be nearest are therefore gathered once for each small tile that the centre of
//! rotation enters, joined to boxes and sorted by distance. They are taken from the boxes of a
//! larger block, whose rows are read once. A measurement then costs a few comparisons. All
//! lengths are in cells.

use super::core::Core;
use super::line::Line;
use super::near_box::{Apart, Frame, NearBox, Sweep, Winding};
use super::turned::{Placement, Turned};
use crate::geometry::{Point, Pose, Segment};
use crate::map::clearance::TOUCH_TOLERANCE_CELLS;
use crate::map::{Cell, DistanceField};
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

/// The boxes of the tiles visited so far: scratch memory that can be reused for other fields and
/// cores.
#[derive(Debug, Default)]
pub(crate) struct NearBoxes {
    /// Hash table of tiles with open addressing; entries of an earlier round are free slots.
    slots: Vec<Slot>,
    /// The blocks gathered so far: only a few, searched linearly.
    blocks: Vec<Block>,
    boxes: Vec<NearBox>,
    used: usize,
    round: u32,
}

/// Hash table entry: a tile and its boxes.
#[derive(Clone, Copy, Debug)]
struct Slot {
    round: u32,
    tile: Cell,
    known: Around,
}

/// The boxes around a tile, as indices into the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    first: u32,
    end: u32,
    /// All boxes no farther than this from the tile's middle are included.
    reach: f64,
}

impl Slot {
    const FREE: Self =
        Self { round: 0, tile: Cell::new(0, 0), known: Around { first: 0, end: 0, reach: 0.0 } };
}

impl Around {
    /// Indices of the boxes, sorted by distance from the tile's middle.
    pub(crate) fn boxes(&self) -> Range<u32> {
        self.first..self.end
    }
}

/// The boxes of a square block of tiles, from which those of each tile are taken.
#[derive(Clone, Copy, Debug)]
struct Block {
    at: Cell,
    middle: Point,
    known: Around,
}

/// Query limits of one round.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Upper limit of distances: larger ones are not distinguished.
    pub(crate) distance: f64,
    /// Largest sum of a distance and half a motion's length for which [`NearObstacles::is_kept`]
    /// can answer.
    pub(crate) way: f64,
    /// Largest half length of a motion for which the boxes around its middle include the nearest
    /// obstacle at every point of it.
    pub(crate) spread: f64,
}

/// A core among the obstacles of a field.
#[derive(Debug)]
pub(crate) struct NearObstacles<'a> {
    field: &'a DistanceField,
    /// Distance of the farthest vertex from the centre of rotation.
    swing: f64,
    /// Distance of the nearest point of the core from the centre of rotation.
    aside: f64,
    winding: Winding,
    /// A tile has 2 to the power of this cells along each side.
    tile_bits: u32,
    /// Largest distance of a point of a tile from its middle.
    half_diagonal: f64,
    reach: Reach,
    /// Squares that are ignored, row by row.
    left_out: &'a [Cell],
    memory: &'a mut NearBoxes,
}

impl<'a> NearObstacles<'a> {
    /// Number of recent boxes that are checked for one that continues in the next row.
    const OPEN: usize = 16;

    /// Largest tile size, as a power of 2.
    const MOST_TILE_BITS: u32 = 4;

    /// A block has 2 to the power of this tiles along each side.
    const BLOCK_BITS: u32 = 3;

    /// Starts a new round: entries of earlier rounds in the memory become invalid.
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
        // Tiles are small compared with the core, so their size adds few boxes.
        let tile_bits = ((swing / 3.0).max(1.0).log2() as u32).min(Self::MOST_TILE_BITS);
        let half_diagonal = half_diagonal(tile_bits);
        let winding = Winding::of(core.vertices());
        let left_out = &[];
        Self { field, swing, aside, winding, tile_bits, half_diagonal, reach, left_out, memory }
    }

    /// Ignores some squares, each row's in the order of its columns.
    pub(crate) fn without(self, left_out: &'a [Cell]) -> Self {
        Self { left_out, ..self }
    }

    /// True only if the core is at no heading nearer than `distance` to an obstacle square. Costs
    /// one load.
    #[inline]
    pub(crate) fn is_beyond(&self, origin: Point, distance: f64) -> bool {
        self.field.is_beyond(origin, distance + self.swing)
    }

    /// Distance to the nearest obstacle square: 0 if an edge touches one, `most` if none is
    /// nearer than that or than the reach. Squares wholly inside a polygon are not detected: use
    /// it only for poses on a motion that begins in free space.
    pub(crate) fn distance(&mut self, at: &Placement<'_>, most: f64) -> f64 {
        let around = self.around(at.origin);
        let still = Sweep::still(*at);
        let mut nearest = most.min(self.reach.distance);
        for index in around.boxes() {
            if !self.may_be_nearer(index, nearest) {
                break;
            }
            if let Some(apart) = self.apart(index, &still, nearest) {
                nearest = apart.at_least.begin.min(nearest);
            }
        }
        nearest
    }

    /// The boxes near a position of the centre of rotation.
    #[inline]
    pub(crate) fn around(&mut self, origin: Point) -> Around {
        let tile = self.tile(origin);
        self.memory.find(tile).unwrap_or_else(|| self.gather(tile))
    }

    /// Lower bound of the distance from a core at that position to any box not in `around`.
    pub(crate) fn to_others(&self, around: &Around) -> f64 {
        around.reach - self.slack()
    }

    /// False if a box and all after it are at least `distance` away from a core in the tile that
    /// they are around.
    #[inline]
    pub(crate) fn may_be_nearer(&self, index: u32, distance: f64) -> bool {
        self.memory.boxes[index as usize].from_middle - self.slack() < distance
    }

    /// Bounds of the distance from a box to a core during a motion, if it may be less than
    /// `limit`.
    #[inline]
    pub(crate) fn apart(&self, index: u32, sweep: &Sweep<'_>, limit: f64) -> Option<Apart> {
        self.memory.boxes[index as usize].apart(sweep, self.winding, limit)
    }

    /// A part of a motion, from -1 to 1, during which a core is nearer than a distance to a box,
    /// if one is found. Non-convex polygons are not tested.
    #[inline]
    pub(crate) fn meets(&self, index: u32, sweep: &Sweep<'_>, distance: f64) -> Option<[f64; 2]> {
        self.memory.boxes[index as usize].meets(sweep, self.winding, distance)
    }

    /// Distance of a core from the map's border; negative outside.
    pub(crate) fn to_border(&self, at: &Placement<'_>) -> f64 {
        self.to_sides(at).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Distances of a core from the four sides of the map.
    fn to_sides(&self, at: &Placement<'_>) -> [f64; 4] {
        let frame = self.field.frame();
        let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
        let Turned { left, right, lowest, highest, .. } = at.turned;
        [
            at.origin.x + left.x,
            at.origin.y + lowest.y,
            width - (at.origin.x + right.x),
            height - (at.origin.y + highest.y),
        ]
    }

    /// Bounds of the distance from the border during a motion. The distance is the minimum of
    /// four linear functions: each of them is an upper bound, and the line between two of its
    /// values is a lower bound.
    pub(crate) fn border_apart(&self, sweep: &Sweep<'_>) -> Apart {
        let [before, middle, after] = [-sweep.half, Point::default(), sweep.half].map(|by| {
            let origin = sweep.middle.origin + by;
            self.to_sides(&Placement { origin, ..sweep.middle })
        });
        let nearest = (0..4).fold(0, |a, b| if middle[b] < middle[a] { b } else { a });
        let least = |sides: [f64; 4]| sides.into_iter().fold(f64::INFINITY, f64::min);
        Apart {
            at_least: Line { begin: least(before), end: least(after) },
            at_most: Line { begin: before[nearest], end: after[nearest] },
        }
    }

    /// True only if the core keeps a distance from all obstacle squares during a short motion in
    /// which each of its vertices (or the centre, if it is alone) moves along a straight line.
    /// Returns false for motions and distances beyond [`Reach::way`]. For a distance of 0 or
    /// less, the core may touch a square but not enter it; the centre alone is then tested as a
    /// line ([`Clearance::crosses_nothing`](crate::map::Clearance::crosses_nothing)).
    ///
    /// An edge stays in the convex hull of the four end points of its first and last position, so
    /// it stays on one side of a line if these four do. The line is put across the shortest
    /// connection at the middle of the motion.
    pub(crate) fn is_kept(
        &mut self,
        from: &Placement<'_>,
        to: &Placement<'_>,
        distance: f64,
    ) -> bool {
        let middle = from.origin.lerp(to.origin, 0.5);
        let half_way = 0.5 * from.origin.distance(to.origin);
        let is_within_reach = distance + half_way <= self.reach.way;
        if !is_within_reach {
            return false;
        }
        let is_point = from.turned.vertices.is_empty();
        if is_point && distance <= 0.0 {
            return self.is_line_free(Segment::new(from.origin, to.origin));
        }
        let slack = self.slack() + half_way;
        let around = self.around(middle);
        let near = &self.memory.boxes[around.first as usize..around.end as usize];
        let mut near = near.iter().take_while(|near| near.from_middle - slack < distance);
        if is_point {
            let way = Segment::new(from.origin, to.origin);
            return near.all(|near| near.way_to_edge(way).norm() >= distance);
        }
        let outward = self.winding.outward();
        let frame = Frame::of_both(from, to);
        near.all(|near| {
            if near.is_beside(&frame, distance) {
                return true;
            }
            if outward.is_some_and(|outward| near.is_kept_by_convex([from, to], outward, distance))
            {
                return true;
            }
            let mut pairs = from.edges().zip(to.edges());
            pairs.all(|(from, to)| near.is_kept_by(from, to, distance))
        })
    }

    /// True if the centre alone may drive along a line. A distance cannot distinguish touching
    /// from entering, as it is 0 for both.
    fn is_line_free(&mut self, way: Segment) -> bool {
        let is_beyond = |to_way: Point| to_way.norm() > 2.0 * TOUCH_TOLERANCE_CELLS;
        let around = self.around(way.a.lerp(way.b, 0.5));
        let near = &self.memory.boxes[around.first as usize..around.end as usize];
        let stands = way.a == way.b;
        stands
            || near.iter().all(|near| is_beyond(near.way_to_edge(way)))
            || self.field.clearance().crosses_nothing(way)
    }

    /// Largest distance from a point of the core to the middle of the tile that contains its
    /// centre of rotation.
    fn slack(&self) -> f64 {
        self.swing + self.half_diagonal
    }

    /// The tile that holds a point, on the map or not.
    #[inline]
    fn tile(&self, point: Point) -> Cell {
        // Rounds down: one less than rounding towards 0 for negative values.
        let cell = |value: f64| {
            let towards_0 = value as i32;
            towards_0.saturating_sub(i32::from(value < f64::from(towards_0)))
        };
        Cell::new(cell(point.x) >> self.tile_bits, cell(point.y) >> self.tile_bits)
    }

    /// Gathers the boxes of a tile from those of the block of tiles that contains it.
    #[inline(never)]
    fn gather(&mut self, tile: Cell) -> Around {
        let Ground { middle, reach } = self.ground(tile, self.tile_bits);
        let block = Cell::new(tile.x >> Self::BLOCK_BITS, tile.y >> Self::BLOCK_BITS);
        let known = self.memory.blocks.iter().find(|known| known.at == block).copied();
        let Block { middle: of_block, known, .. } =
            known.unwrap_or_else(|| self.gather_block(block));
        let reach = reach.min(known.reach - middle.distance(of_block));
        let boxes = &mut self.memory.boxes;
        let first = boxes.len();
        for index in known.boxes() {
            let near = boxes[index as usize];
            let from_middle = near.way_to_point(middle).norm();
            if from_middle <= reach {
                boxes.push(NearBox { from_middle, ..near });
            }
        }
        boxes[first..].sort_unstable_by(|a, b| a.from_middle.total_cmp(&b.from_middle));
        let around = Around { first: first as u32, end: boxes.len() as u32, reach };
        self.memory.insert(tile, around);
        around
    }

    /// Gathers the boxes of a block, unsorted: all that are near any of its tiles.
    fn gather_block(&mut self, block: Cell) -> Block {
        let Ground { middle, reach } = self.ground(block, self.tile_bits + Self::BLOCK_BITS);
        let frame = self.field.frame();
        let clipped = |value: f64, count: u32| (value.max(0.0) as i32).min(count as i32 - 1);
        let columns =
            [middle.x - reach, middle.x + reach].map(|value| clipped(value, frame.width()));
        let rows = [middle.y - reach, middle.y + reach].map(|value| clipped(value, frame.height()));
        let boxes = &mut self.memory.boxes;
        let first = boxes.len();
        for y in rows[0]..=rows[1] {
            let left_out = self.left_out.iter().filter(|cell| cell.y == y).map(|cell| cell.x);
            let row = self.field.obstacles().row(y);
            for_each_run_without(row, columns, &left_out, |from, to| {
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
        let known = Around { first: first as u32, end: boxes.len() as u32, reach };
        let block = Block { at: block, middle, known };
        self.memory.blocks.push(block);
        block
    }

    /// The area that has to be read around a square of the grid, of 2 to the power of `bits`
    /// cells. A point of the core is not much farther from the obstacle that is nearest to the
    /// square's middle.
    fn ground(&self, square: Cell, bits: u32) -> Ground {
        let middle = |index: i32| (f64::from(index) + 0.5) * f64::from(1 << bits);
        let middle = Point::new(middle(square.x), middle(square.y));
        let half_diagonal = half_diagonal(bits);
        let (_, at_most) = self.field.square_bounds_on_grid(middle);
        // The bound is for all squares: with some of them ignored, the nearest one may be
        // anywhere.
        let at_most = if self.left_out.is_empty() { at_most } else { f64::INFINITY };
        let nearest = at_most + half_diagonal + self.aside;
        let Reach { distance, way, spread } = self.reach;
        let reach = (nearest + 2.0 * spread).min(distance).max(way);
        Ground { middle, reach: self.swing + half_diagonal + reach }
    }
}

/// A square of the grid and the search radius around its middle.
#[derive(Clone, Copy, Debug)]
struct Ground {
    middle: Point,
    reach: f64,
}

/// Largest distance of a point from the middle of a square of 2 to the power of `bits` cells.
fn half_diagonal(bits: u32) -> f64 {
    f64::from(1 << bits) * FRAC_1_SQRT_2 + 1e-9
}

/// Visits the same runs without the columns `left_out`, which are in order.
fn for_each_run_without(
    row: &[u64],
    columns: [i32; 2],
    left_out: &(impl Iterator<Item = i32> + Clone),
    mut visit: impl FnMut(i32, i32),
) {
    for_each_run(row, columns, |from, to| {
        let mut first = from;
        for x in left_out.clone().filter(|x| (from..=to).contains(x)) {
            if first < x {
                visit(first, x - 1);
            }
            first = x + 1;
        }
        if first <= to {
            visit(first, to);
        }
    });
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

impl NearBoxes {
    /// Initial number of slots: one cycle visits some hundred tiles.
    const FIRST_SLOTS: usize = 1024;

    fn begin(&mut self) {
        self.boxes.clear();
        self.blocks.clear();
        self.used = 0;
        self.round = self.round.wrapping_add(1);
        if self.slots.is_empty() || self.round == 0 {
            let count = self.slots.len().max(Self::FIRST_SLOTS);
            self.slots.clear();
            self.slots.resize(count, Slot::FREE);
            self.round = 1;
        }
    }

    /// The slot of a tile, or the free one for it.
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
    fn find(&self, tile: Cell) -> Option<Around> {
        let slot = self.slots[self.place(tile)];
        (slot.round == self.round).then_some(slot.known)
    }

    fn insert(&mut self, tile: Cell, known: Around) {
        self.used += 1;
        if 2 * self.used > self.slots.len() {
            self.grow();
        }
        let place = self.place(tile);
        self.slots[place] = Slot { round: self.round, tile, known };
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
#[path = "near_obstacles_tests.rs"]
mod tests;
