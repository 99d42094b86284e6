//! One query with the paths of all planners and smoothers.

use super::Compared;
use super::contest::Entry;
use crate::commands::plan::CHORD_CELLS;
use keyway::geometry::Polyline;
use keyway_draw::layers::{CellTint, Goal, PathLine, Start};
use keyway_draw::{LineStyle, MapPicture, Rgb, SERIES, Svg};

/// The last colour of the series is that of the shortest line.
const COLORS: usize = SERIES.len() - 1;
/// Once all colours are used, the next ones are dashed, then dotted.
const DASHES: [&str; 3] = ["", "7 3", "2 2.5"];
const SHORTEST: LineStyle = LineStyle { color: SERIES[COLORS], width_px: 0.8, dashes: "1.5 2" };
/// Free cells too close for the robot.
const TOO_CLOSE: Rgb = Rgb(0xea, 0xe8, 0xe4);

/// Paths on top of each other are all seen: the first is the widest.
fn style(index: usize, count: usize) -> LineStyle {
    let behind = (count - 1 - index) as f64 / count.max(2).saturating_sub(1) as f64;
    LineStyle {
        color: SERIES[index % COLORS],
        width_px: 1.4 + 3.6 * behind,
        dashes: DASHES[index / COLORS % DASHES.len()],
    }
}

/// The paths of one query, and the shortest line under the corner rule of the first planner.
pub(super) fn picture(map: &Compared, query: usize) -> Svg {
    let deviation_m = CHORD_CELLS * map.map.frame().resolution_m();
    let line = |entry: &Entry| -> Option<(String, Polyline)> {
        let found = entry.answers[query].found.as_ref()?;
        let (planner, smoother, length_m) = (entry.planner, entry.smoother, found.metrics.length_m);
        let label = format!("{planner}, {smoother}: {length_m:.2} m");
        Some((label, found.done.path.flattened(deviation_m)))
    };
    let lines: Vec<(String, Polyline)> = map.contest.entries.iter().filter_map(line).collect();
    let ends = map.queries[query];
    let title = format!("{}, query {}, the longest", map.name, query + 1);
    let mut picture = MapPicture::new(&map.loaded.grid)
        .title(title)
        .with(CellTint::blocked(map.map.blocked()).color(TOO_CLOSE))
        .with(Start(ends.start))
        .with(Goal { point: ends.goal, tolerance_m: None });
    for (i, (label, line)) in lines.iter().enumerate() {
        picture = picture.with(PathLine::new(line, label.clone(), style(i, lines.len())));
    }
    let oracle = map.contest.oracles.first().and_then(|oracle| oracle.lines[query].as_ref());
    if let Some(line) = oracle {
        let label = format!("shortest line: {:.2} m", line.length_m());
        picture = picture.with(PathLine::new(line, label, SHORTEST));
    }
    picture.svg()
}
