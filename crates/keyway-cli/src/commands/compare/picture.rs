//! One query with the paths of all planners and smoothers.

use super::Compared;
use super::contest::Entry;
use crate::commands::plan::CHORD_CELLS;
use keyway::geometry::Polyline;
use keyway_draw::layers::{CellTint, Goal, PathLine, Start};
use keyway_draw::{LineStyle, MapPicture, Rgb, SERIES, Svg};

/// The last colour of the series is that of the shortest line.
const COLORS: usize = SERIES.len() - 1;
/// Narrowest line, how much wider the pair of lines behind is at most, and the widest line \[px\].
const NARROWEST_PX: f64 = 1.6;
const STEP_PX: f64 = 1.8;
const WIDEST_PX: f64 = 7.0;
/// Two paths are drawn as one when no point of one is farther from that of the other \[m\].
const SAME_M: f64 = 1e-6;
const SHORTEST: LineStyle = LineStyle { color: SERIES[COLORS], width_px: 0.8, dashes: "1.5 2" };
/// Free cells too close for the robot.
const TOO_CLOSE: Rgb = Rgb(0xea, 0xe8, 0xe4);

/// Paths on top of each other are all seen: in pairs, the second of a pair dashed over the first, and each
/// pair narrower than the one behind it. Neighbours differ in colour; once all colours are used, they
/// change from solid to dashed lines and back, then the dashes are others.
fn style(index: usize, count: usize) -> LineStyle {
    let (pair, last_pair) = (index / 2, count.saturating_sub(1) / 2);
    let step_px = ((WIDEST_PX - NARROWEST_PX) / last_pair.max(1) as f64).min(STEP_PX);
    let dashes = match (index / (2 * COLORS) % 2, index % 2) {
        (0, 0) => "",
        (0, _) => "6 6",
        (_, 0) => "14 3",
        (_, _) => "2 4",
    };
    LineStyle {
        color: SERIES[(index + index / COLORS) % COLORS],
        width_px: NARROWEST_PX + step_px * (last_pair - pair) as f64,
        dashes,
    }
}

/// A path, and all that found it.
struct Line {
    labels: Vec<String>,
    points: Polyline,
}

/// Each path once, in the order in which it was first found.
fn distinct(found: impl IntoIterator<Item = (String, Polyline)>) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (label, points) in found {
        match lines.iter_mut().find(|line| is_same(&line.points, &points)) {
            Some(line) => line.labels.push(label),
            None => lines.push(Line { labels: vec![label], points }),
        }
    }
    lines
}

fn is_same(a: &Polyline, b: &Polyline) -> bool {
    let mut pairs = a.points().iter().zip(b.points());
    a.points().len() == b.points().len() && pairs.all(|(a, b)| a.distance(*b) <= SAME_M)
}

/// The paths of one query, and the shortest line under the corner rule of the first planner.
pub(super) fn picture(map: &Compared, query: usize) -> Svg {
    let deviation_m = CHORD_CELLS * map.map.frame().resolution_m();
    let line = |entry: &Entry| -> Option<(String, Polyline)> {
        let found = entry.answers[query].found.as_ref()?;
        let (planner, smoother, length_m) = (entry.planner, entry.smoother, found.metrics.length_m);
        let label = format!("{planner}, {smoother}: {length_m:.2} m");
        Some((label, found.done.path.flattened(deviation_m).merged()))
    };
    let lines = distinct(map.contest.entries.iter().filter_map(line));
    let ends = map.queries[query];
    let title = format!("{}, query {} of {}", map.name, query + 1, map.queries.len());
    let mut picture = MapPicture::new(&map.loaded.grid)
        .title(title)
        .with(CellTint::blocked(map.map.blocked()).color(TOO_CLOSE))
        .with(Start(ends.start))
        .with(Goal { point: ends.goal, tolerance_m: None });
    for (i, line) in lines.iter().enumerate() {
        for label in &line.labels {
            let style = style(i, lines.len());
            picture = picture.with(PathLine::new(&line.points, label.clone(), style));
        }
    }
    let oracle = map.contest.oracles.first().and_then(|oracle| oracle.lines[query].as_ref());
    if let Some(line) = oracle {
        let label = format!("shortest line: {:.2} m", line.length_m());
        picture = picture.with(PathLine::new(line, label, SHORTEST));
    }
    picture.svg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_on_top_of_each_other_are_told_apart() {
        for count in 1..=24 {
            let styles: Vec<LineStyle> = (0..count).map(|i| style(i, count)).collect();
            for pair in styles.windows(2) {
                assert_ne!(pair[0].color, pair[1].color);
                // What is behind shows at its rim, or through the gaps.
                let wider_px = pair[0].width_px - pair[1].width_px;
                assert!(wider_px > 0.4 || (wider_px == 0.0 && !pair[1].dashes.is_empty()));
            }
            let looks = |a: &LineStyle, b: &LineStyle| a.color == b.color && a.dashes == b.dashes;
            let is_new = |i: usize| !styles[..i].iter().any(|other| looks(other, &styles[i]));
            assert!((0..count).all(is_new), "{count}: {styles:?}");
            let widths = styles.iter().map(|style| style.width_px);
            assert!(widths.clone().all(|px| (NARROWEST_PX..=WIDEST_PX + 1e-9).contains(&px)));
        }
    }

    #[test]
    fn equal_paths_are_one_line_with_all_names() {
        let line = |y: f64| Polyline::new(vec![[0.0, 0.0].into(), [1.0, y].into()]);
        let found = [("a", 0.0), ("b", 1.0), ("c", 1e-9), ("d", 2.0)];
        let lines = distinct(found.map(|(name, y)| (name.to_owned(), line(y))));
        let labels: Vec<Vec<String>> = lines.into_iter().map(|line| line.labels).collect();
        assert_eq!(labels, [vec!["a", "c"], vec!["b"], vec!["d"]]);
    }
}
