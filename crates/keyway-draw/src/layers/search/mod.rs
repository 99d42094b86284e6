//! Layers of a recorded search.
//!
//! Time is shown as shade, from dark to light: blues from the start, oranges from the goal, which
//! colour-blind readers can distinguish as well. The drawing style depends on the kind of search,
//! see [`TraceStyle`].

mod area;
mod lines;
mod shades;

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::legend::{LegendEntry, LegendMark};
use crate::marks::letter_mark;
use keyway::map::Cell;
use keyway::search::{Recording, SearchEvent, Side};

/// Drawing style of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TraceStyle {
    /// Cell after cell: expanded cells shaded by order, open ones in a pale tint.
    Cells,
    /// Jump points as dots, and the scans between them as lines shaded by order.
    JumpPoints,
    /// Links from nodes to their parents as lines shaded by order.
    Tree,
}

impl TraceStyle {
    /// Returns the style that suits a search: a tree if links were recorded, jump points if scans
    /// were recorded, cells otherwise.
    pub fn of(recording: &Recording) -> Self {
        let has = |event: fn(&SearchEvent) -> bool| recording.events().iter().any(event);
        if has(|event| matches!(event, SearchEvent::Linked { .. })) {
            Self::Tree
        } else if has(|event| matches!(event, SearchEvent::Scanned { .. })) {
            Self::JumpPoints
        } else {
            Self::Cells
        }
    }
}

/// Trace of a search: all of it, or its beginning.
#[derive(Clone, Copy, Debug)]
pub struct SearchTrace<'a> {
    recording: &'a Recording,
    shown: usize,
    style: TraceStyle,
}

impl<'a> SearchTrace<'a> {
    /// Creates the trace of a search in the style that suits it.
    pub fn new(recording: &'a Recording) -> Self {
        let style = TraceStyle::of(recording);
        Self { recording, shown: recording.events().len(), style }
    }

    /// Shows only the first events. Shades stay those of the whole search.
    #[must_use]
    pub fn first(self, events: usize) -> Self {
        Self { shown: events, ..self }
    }

    /// Sets another style.
    #[must_use]
    pub fn style(self, style: TraceStyle) -> Self {
        Self { style, ..self }
    }

    /// Returns the cell in which the two sides last met, among the shown events.
    fn meeting(&self) -> Option<Cell> {
        self.recording.first(self.shown).iter().rev().find_map(|event| match *event {
            SearchEvent::Met { at } => Some(at),
            _ => None,
        })
    }

    /// Returns the shown events, each with its shade.
    fn events(&self) -> impl Iterator<Item = (SearchEvent, u8)> {
        let all = self.recording.events().len();
        let shade = move |i: usize| shades::of_order(i, all);
        self.recording.first(self.shown).iter().enumerate().map(move |(i, &e)| (e, shade(i)))
    }

    /// Returns the text of a side in the legend.
    fn label(&self, text: &str, side: Side) -> String {
        let is_backward = |event: &SearchEvent| {
            matches!(
                event,
                SearchEvent::Expanded { side: Side::Backward, .. }
                    | SearchEvent::Generated { side: Side::Backward, .. }
            )
        };
        match side {
            _ if !self.recording.events().iter().any(is_backward) => text.to_owned(),
            Side::Forward => format!("{text}, from the start"),
            Side::Backward => format!("{text}, from the goal"),
        }
    }
}

impl Layer for SearchTrace<'_> {
    fn depth(&self) -> Depth {
        Depth::Search
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        match self.style {
            TraceStyle::Cells => area::draw(self, canvas),
            TraceStyle::JumpPoints => lines::draw_jump_points(self, canvas),
            TraceStyle::Tree => lines::draw_tree(self, canvas),
        }
    }
}

/// Nodes of a search with distant nodes: jump points, and those of a tree. They are in front of
/// paths. Cell-by-cell searches have none.
#[derive(Clone, Copy, Debug)]
pub struct SearchNodes<'a>(
    /// The search, or its beginning.
    pub SearchTrace<'a>,
);

impl Layer for SearchNodes<'_> {
    fn depth(&self) -> Depth {
        Depth::Points
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        match self.0.style {
            TraceStyle::Cells => {}
            TraceStyle::JumpPoints => lines::draw_nodes(&self.0, canvas, "jump point"),
            TraceStyle::Tree => lines::draw_nodes(&self.0, canvas, "node"),
        }
    }
}

/// Meeting point of the two sides of a search: M. Nothing is drawn if they did not meet.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<'a>(
    /// The search, or its beginning.
    pub SearchTrace<'a>,
);

impl Layer for Meeting<'_> {
    fn depth(&self) -> Depth {
        Depth::Markers
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        let Some(cell) = self.0.meeting() else { return };
        let at = canvas.map().frame().world_from_cell(cell);
        let px = canvas.view().px_from_world(at);
        letter_mark(canvas.writer(), px, "M", false);
        let mark = LegendMark::Letter { letter: 'M', dark: false };
        canvas.explain(LegendEntry::new("the two sides met", mark));
    }
}
