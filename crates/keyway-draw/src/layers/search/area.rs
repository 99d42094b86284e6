//! Cell-by-cell searches: the area that they covered.

use super::SearchTrace;
use super::shades::{self, SHADES, SIDES};
use crate::canvas::{Blocks, Canvas};
use crate::legend::{LegendEntry, LegendMark};
use keyway::map::Cell;
use keyway::search::{SearchEvent, Side};

/// Marks of a search on each block of cells in view: one byte per block.
struct Marks {
    blocks: Blocks,
    of_blocks: Vec<u8>,
}

/// A cell that the search did not touch.
const UNTOUCHED: u8 = 0;
/// Mark of the open cells of a side, after those of expanded ones.
const OPEN: u8 = SHADES;
/// Number of marks of a side.
const MARKS_OF_SIDE: u8 = SHADES + 1;

/// Returns the first mark of a side: its expanded cells are marked by shade.
const fn first_mark(side: Side) -> u8 {
    1 + MARKS_OF_SIDE * shades::index(side) as u8
}

impl Marks {
    fn new(blocks: Blocks) -> Self {
        let count = blocks.columns() as usize * blocks.rows() as usize;
        Self { blocks, of_blocks: vec![UNTOUCHED; count] }
    }

    /// The first expansion of a cell decides its shade and its side.
    fn read(&mut self, trace: &SearchTrace<'_>) {
        for (event, shade) in trace.events() {
            match event {
                SearchEvent::Expanded { side, at } => self.mark(at, first_mark(side) + shade),
                SearchEvent::Generated { side, at, .. } => self.mark(at, first_mark(side) + OPEN),
                _ => {}
            }
        }
    }

    fn mark(&mut self, cell: Cell, mark: u8) {
        let Some(i) = self.blocks.index(cell) else { return };
        let known = self.of_blocks[i];
        let is_open = SIDES.iter().any(|&side| known == first_mark(side) + OPEN);
        if known == UNTOUCHED || is_open {
            self.of_blocks[i] = mark;
        }
    }
}

pub(super) fn draw(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>) {
    let mut marks = Marks::new(canvas.blocks());
    marks.read(trace);
    let marks = marks.of_blocks;
    for side in SIDES {
        let first = first_mark(side);
        let expanded = first..first + SHADES;
        // A base under all shades, so that no white shows in the seams between two of them.
        if canvas.paint(shades::area(side, SHADES / 2), |i| expanded.contains(&marks[i])) {
            for shade in 0..SHADES {
                canvas.paint(shades::area(side, shade), |i| marks[i] == first + shade);
            }
            let mark = LegendMark::Shades(shades::samples(side, shades::area));
            canvas.explain(LegendEntry::new(trace.label("expanded, early to late", side), mark));
        }
        if canvas.paint(shades::open(side), |i| marks[i] == first + OPEN) {
            let mark = LegendMark::Area(shades::open(side));
            canvas.explain(LegendEntry::new(trace.label("generated only", side), mark));
        }
    }
}
