//! Searches from cell to cell: the ground that they covered.

use super::SearchTrace;
use super::shades::{self, SHADES, SIDES};
use crate::canvas::Canvas;
use crate::legend::{Entry, Sample};
use keyway::map::{Cell, GridFrame};
use keyway::search::{SearchEvent, Side};

/// What a search did with each cell of the map: one byte per cell.
struct Marks {
    width: u32,
    height: u32,
    of_cells: Vec<u8>,
}

/// A cell that the search did not touch.
const UNTOUCHED: u8 = 0;
/// The mark of open cells of a side, after those of expanded ones.
const OPEN: u8 = SHADES;
/// Marks of a side.
const MARKS_OF_SIDE: u8 = SHADES + 1;

/// The first mark of a side: those of its expanded cells by shade.
const fn first_mark(side: Side) -> u8 {
    1 + MARKS_OF_SIDE * shades::index(side) as u8
}

impl Marks {
    fn new(frame: &GridFrame) -> Self {
        let (width, height) = (frame.width(), frame.height());
        Self { width, height, of_cells: vec![UNTOUCHED; width as usize * height as usize] }
    }

    /// A cell counts as expanded when it was first expanded; the first side keeps it.
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
        let Some(i) = self.index(cell) else { return };
        let known = self.of_cells[i];
        let is_open = SIDES.iter().any(|&side| known == first_mark(side) + OPEN);
        if known == UNTOUCHED || is_open {
            self.of_cells[i] = mark;
        }
    }

    fn get(&self, cell: Cell) -> u8 {
        self.index(cell).map_or(UNTOUCHED, |i| self.of_cells[i])
    }

    fn index(&self, cell: Cell) -> Option<usize> {
        let (x, y) = (u32::try_from(cell.x).ok()?, u32::try_from(cell.y).ok()?);
        (x < self.width && y < self.height).then(|| y as usize * self.width as usize + x as usize)
    }
}

pub(super) fn draw(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>) {
    let mut marks = Marks::new(canvas.map().frame());
    marks.read(trace);
    for side in SIDES {
        let first = first_mark(side);
        let expanded = first..first + SHADES;
        // A ground under all shades: no white shows in the seams between two of them.
        if canvas.cells(shades::area(side, SHADES / 2), |cell| expanded.contains(&marks.get(cell)))
        {
            for shade in 0..SHADES {
                let mark = first + shade;
                canvas.cells(shades::area(side, shade), |cell| marks.get(cell) == mark);
            }
            let sample = Sample::Shades(shades::samples(side, shades::area));
            canvas.explain(Entry::new(trace.label("expanded, early to late", side), sample));
        }
        if canvas.cells(shades::open(side), |cell| marks.get(cell) == first + OPEN) {
            let sample = Sample::Area(shades::open(side));
            canvas.explain(Entry::new(trace.label("generated only", side), sample));
        }
    }
}
