//! Shapes that pictures and their legends share.

use crate::color::{INK, Rgb};
use crate::text::text_width_px;
use crate::ticks::span;
use crate::writer::{Anchor, PathData, SvgWriter};

/// Distance between the lines of the hatching \[px\].
const HATCH_PX: f64 = 5.0;

/// Draws a disc with a translucent fill and lines at 45 degrees; one that is too small for such
/// lines is filled, so that it is visible among other marks. The lines are computed instead of a
/// pattern, so that several pictures can be in one page without name clashes.
pub(crate) fn hatched_disc(out: &mut SvgWriter, (x, y): (f64, f64), radius: f64, color: Rgb) {
    let opacity = if radius < 0.5 * HATCH_PX { "1" } else { "0.18" };
    let disc = out.tag("circle").round(x, y, radius).fill(color).attr("fill-opacity", opacity);
    disc.stroke(color, 1.1).leaf();
    let mut lines = PathData::default();
    let half = (radius / HATCH_PX).floor().min(200.0) as i32;
    for i in -half..=half {
        let offset = f64::from(i) * HATCH_PX;
        let chord = (radius * radius - offset * offset).max(0.0).sqrt();
        // Rotates (+-chord, offset) by -45 degrees: lines rise to the right.
        let turn = std::f64::consts::FRAC_1_SQRT_2;
        let point = |s: f64| (x + (s + offset) * turn, y + (offset - s) * turn);
        lines.append([point(-chord), point(chord)]);
    }
    let path = out.tag("path").attr("fill", "none").stroke(color, 0.7);
    path.attr("d", lines.as_str()).leaf();
}

/// Draws the same for a polygon.
pub(crate) fn hatched_polygon(out: &mut SvgWriter, vertices: &[(f64, f64)], color: Rgb) {
    let mut border = PathData::line(vertices.iter().copied());
    border.close();
    let path =
        out.tag("path").fill(color).attr("fill-opacity", "0.18").attr("fill-rule", "evenodd");
    path.stroke(color, 1.1).attr("d", border.as_str()).leaf();
    let mut lines = PathData::default();
    // Lines that rise to the right, x + y = c, one of them through (0, 0).
    let step = HATCH_PX * std::f64::consts::SQRT_2;
    let sums = vertices.iter().map(|(x, y)| (x + y) / step);
    let (low, high) = span(sums).unwrap_or((0.0, -1.0));
    // A polygon that is far larger than the picture is not hatched throughout.
    for i in (low.ceil() as i64..=high.floor() as i64).take(2000) {
        let line = i as f64 * step;
        let mut crossings = crossings(vertices, line);
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            lines.append([(pair[0], line - pair[0]), (pair[1], line - pair[1])]);
        }
    }
    let path = out.tag("path").attr("fill", "none").stroke(color, 0.7);
    path.attr("d", lines.as_str()).leaf();
}

/// Returns the x coordinates at which the line x + y = `line` crosses the border of a polygon: an
/// even number of them.
fn crossings(vertices: &[(f64, f64)], line: f64) -> Vec<f64> {
    let next = vertices.iter().cycle().skip(1);
    let edges = vertices.iter().zip(next);
    let crossing = |(&(ax, ay), &(bx, by)): (&(f64, f64), &(f64, f64))| {
        let (from, to) = (ax + ay - line, bx + by - line);
        // A vertex on the line belongs to one side.
        ((from < 0.0) != (to < 0.0)).then(|| ax + (bx - ax) * from / (from - to))
    };
    edges.filter_map(crossing).collect()
}

/// Radius of a small ring \[px\], visible on both sides of a driven line.
pub(crate) const KEY_RING_PX: f64 = 4.0;

/// Half the height of a mark with a time \[px\].
pub(crate) const TIME_MARK_PX: f64 = 5.5;
const TIME_TEXT_PX: f64 = 8.0;

/// Half the width of a mark with a time \[px\].
pub(crate) fn time_mark_half_px(text: &str) -> f64 {
    (0.5 * text_width_px(text, TIME_TEXT_PX) + 2.5).max(TIME_MARK_PX)
}

/// Draws a time, or another short text, on a light background with round ends.
pub(crate) fn time_mark(out: &mut SvgWriter, (x, y): (f64, f64), text: &str, color: Rgb) {
    let half = time_mark_half_px(text);
    let ground =
        out.tag("rect").at(x - half, y - TIME_MARK_PX).size(2.0 * half, 2.0 * TIME_MARK_PX);
    let ground = ground.num("rx", TIME_MARK_PX).attr("fill", "#fff").attr("fill-opacity", "0.85");
    ground.stroke(color, 0.8).leaf();
    let place = out.tag("text").at(x, y + 0.365 * TIME_TEXT_PX);
    place.num("font-size", TIME_TEXT_PX).fill(color).anchor(Anchor::Middle).text(text);
}

/// Radius of a disc with a letter \[px\].
pub(crate) const LETTER_MARK_PX: f64 = 7.0;

/// Draws a letter or a number in a disc, dark on white or white on dark, with a light rim.
pub(crate) fn letter_mark(out: &mut SvgWriter, (x, y): (f64, f64), text: &str, dark: bool) {
    let (ground, ink) = if dark { (INK, "#fff") } else { (Rgb(0xff, 0xff, 0xff), "#222222") };
    out.tag("circle").round(x, y, LETTER_MARK_PX + 1.2).attr("fill", "#fff").leaf();
    out.tag("circle").round(x, y, LETTER_MARK_PX - 0.6).fill(ground).stroke(INK, 1.2).leaf();
    // Small enough for two digits.
    let size = if text.len() > 1 { 8.0 } else { 10.0 };
    out.tag("text")
        .at(x, y + 0.365 * size)
        .num("font-size", size)
        .attr("fill", ink)
        .anchor(Anchor::Middle)
        .text(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// True if a point is inside, by the number of crossings of a line from it to the right.
    fn holds(vertices: &[(f64, f64)], (x, y): (f64, f64)) -> bool {
        let next = vertices.iter().cycle().skip(1);
        let meets = |((ax, ay), (bx, by)): (&(f64, f64), &(f64, f64))| {
            (*ay > y) != (*by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
        };
        vertices.iter().zip(next).filter(|edge| meets(*edge)).count() % 2 == 1
    }

    #[test]
    fn the_hatching_of_a_polygon_is_inside_of_it() {
        let hook = [(0.0, 0.0), (90.0, 5.0), (85.0, 70.0), (60.0, 66.0), (63.0, 30.0), (4.0, 28.0)];
        let mut count = 0;
        for i in 0..200 {
            let line = f64::from(i);
            let mut xs = crossings(&hook, line);
            xs.sort_by(f64::total_cmp);
            assert_eq!(xs.len() % 2, 0);
            count += xs.len();
            let is_inside = |x: f64| holds(&hook, (x, line - x));
            for (i, pair) in xs.windows(2).enumerate().filter(|(_, pair)| pair[1] - pair[0] > 1e-6)
            {
                assert_eq!(is_inside(0.5 * (pair[0] + pair[1])), i % 2 == 0, "{line} {xs:?}");
            }
        }
        assert!(count > 300, "{count}");
        let mut out = SvgWriter::new();
        hatched_polygon(&mut out, &hook, Rgb(0, 0, 0));
        let svg = out.finish();
        assert!(svg.contains("M0 0L90 5L85 70L60 66L63 30L4 28Z"), "{svg}");
        assert!(svg.matches('M').count() > 10, "{svg}");
    }
}
