//! Searches with distant nodes: jump points and the scans between them, trees.

use super::SearchTrace;
use super::shades::{self, SHADES, SIDES};
use crate::canvas::Canvas;
use crate::color::Rgb;
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use keyway::map::Cell;
use keyway::search::{SearchEvent, Side};
use std::collections::{BTreeMap, BTreeSet};

/// Width of scans and links \[px\].
const LINE_PX: f64 = 0.7;
/// Range of the radius of nodes \[px\]: smaller if there are many.
const DOT_PX: (f64, f64) = (0.8, 2.4);
const SAMPLE_DOT_PX: f64 = 1.6;

/// Ends of lines, by side and shade.
type Lines = [[Vec<(Cell, Cell)>; SHADES as usize]; 2];

pub(super) fn draw_jump_points(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>) {
    let mut lines = Lines::default();
    let mut seen = [BTreeSet::new(), BTreeSet::new()];
    for (event, shade) in trace.events() {
        if let SearchEvent::Scanned { side, from, to } = event {
            // A node that is expanded again scans the same lines.
            if seen[shades::index(side)].insert((from, to)) {
                lines[shades::index(side)][usize::from(shade)].push((from, to));
            }
        }
    }
    draw_lines(trace, canvas, &lines, "scans, early to late");
}

pub(super) fn draw_tree(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>) {
    // The last known parent counts.
    let mut links = BTreeMap::new();
    for (event, shade) in trace.events() {
        if let SearchEvent::Generated { side, at, parent }
        | SearchEvent::Reparented { side, at, parent } = event
        {
            links.insert((shades::index(side), at), (parent, shade));
        }
    }
    let mut lines = Lines::default();
    for ((side, at), (parent, shade)) in links {
        lines[side][usize::from(shade)].push((parent, at));
    }
    draw_lines(trace, canvas, &lines, "search tree, early to late");
}

/// Draws late lines first: early ones, which lead to all others, stay in front.
fn draw_lines(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>, lines: &Lines, text: &str) {
    for side in SIDES {
        let mut is_drawn = false;
        for shade in (0..SHADES).rev() {
            let part = &lines[shades::index(side)][usize::from(shade)];
            let style = LineStyle::solid(shades::line(side, shade), LINE_PX);
            is_drawn |= canvas.segments(part.iter().copied(), style);
        }
        if is_drawn {
            let mark = LegendMark::ShadedLine(shades::samples(side, shades::line));
            canvas.explain(LegendEntry::new(trace.label(text, side), mark));
        }
    }
}

/// Draws expanded nodes as dots, the other ones as rings.
pub(super) fn draw_nodes(trace: &SearchTrace<'_>, canvas: &mut Canvas<'_>, text: &str) {
    let radius_px = dot_radius_px(trace, canvas);
    // Large enough to be seen in the legend.
    let sample_px = radius_px.max(SAMPLE_DOT_PX);
    for side in SIDES {
        let (expanded, generated) = nodes(trace, side);
        let open = || generated.difference(&expanded).copied();
        let color = shades::line(side, SHADES / 4);
        if canvas.dots(open(), radius_px, color) {
            canvas.dots(open(), 0.6 * radius_px, Rgb(0xff, 0xff, 0xff));
            let ring = LineStyle::solid(color, 0.4 * radius_px);
            let label = trace.label(&format!("{text}, generated only"), side);
            let sample = LineStyle { width_px: 0.4 * sample_px, ..ring };
            canvas.explain(LegendEntry::new(label, LegendMark::SmallRing(sample, 0.8 * sample_px)));
        }
        if canvas.dots(expanded.iter().copied(), radius_px, color) {
            let label = trace.label(&format!("{text}, expanded"), side);
            canvas.explain(LegendEntry::new(label, LegendMark::Dot(color, sample_px)));
        }
    }
}

/// Returns the cells of expanded and of all generated nodes of a side.
fn nodes(trace: &SearchTrace<'_>, side: Side) -> (BTreeSet<Cell>, BTreeSet<Cell>) {
    let (mut expanded, mut generated) = (BTreeSet::new(), BTreeSet::new());
    for (event, _) in trace.events() {
        match event {
            SearchEvent::Expanded { side: of, at } if of == side => expanded.insert(at),
            SearchEvent::Generated { side: of, at, .. } if of == side => generated.insert(at),
            _ => false,
        };
    }
    (expanded, generated)
}

/// Returns a share of the mean distance between nodes, assuming that they are spread evenly over
/// the picture.
fn dot_radius_px(trace: &SearchTrace<'_>, canvas: &Canvas<'_>) -> f64 {
    let count = trace.recording.statistics().generated().max(1);
    let area = canvas.view().width_px() * canvas.view().height_px();
    (0.08 * (area / count as f64).sqrt()).clamp(DOT_PX.0, DOT_PX.1)
}
