//! Picture of one query with the paths of all planners and smoothers.

use keyway::geometry::Polyline;
use keyway::route::CHORD_CELLS;
use keyway_draw::layers::{CellTint, GoalMark, Layer, PathLine, StartMark};
use keyway_draw::{LineStyle, MapPanels, MapPicture, Rgb, SERIES, Svg};
use keyway_lab::compare::{Compared, ContestEntry};

/// Number of colours for paths; the last colour of the series is that of the shortest line.
const COLORS: usize = SERIES.len() - 1;
/// Width of the narrowest line, largest step in width from one pair of lines to the next, and
/// width of the widest line \[px\].
const NARROWEST_PX: f64 = 1.6;
const STEP_PX: f64 = 1.8;
const WIDEST_PX: f64 = 7.0;
/// Step in width from one line in a panel to the next \[px\].
const PANEL_STEP_PX: f64 = 0.9;
/// Two paths are drawn as one if no point of one is farther than this from the other \[m\].
const SAME_M: f64 = 1e-6;
const SHORTEST: LineStyle = LineStyle { color: SERIES[COLORS], width_px: 0.8, dashes: "1.5 2" };
/// Maximum number of paths that can be told apart in one picture, or in one panel.
const MAX_LINES: usize = 6;
/// Colour of free cells with too little clearance for the robot.
const TOO_CLOSE: Rgb = Rgb(0xea, 0xe8, 0xe4);

/// Line style that keeps overlapping paths visible: they come in pairs, the second of a pair
/// dashed over the first, and each pair narrower than the one behind it. Neighbours differ in
/// colour; once all colours are used, solid and dashed lines change roles, then the dashes
/// differ.
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

/// Line style in a panel. A path has the colour of its method in all panels, and each line is
/// narrower than the one behind it.
fn panel_style(found_by: usize, index: usize, count: usize) -> LineStyle {
    let width_px = NARROWEST_PX + PANEL_STEP_PX * (count - 1 - index) as f64;
    LineStyle { width_px, ..style(found_by, MAX_LINES) }
}

/// A path, and all methods that found it.
struct Line {
    labels: Vec<String>,
    points: Polyline,
    /// Index of the first method that found it.
    found_by: usize,
}

/// Distinct paths, in the order in which they were first found.
fn distinct(found: impl IntoIterator<Item = (usize, String, Polyline)>) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (found_by, label, points) in found {
        match lines.iter_mut().find(|line| is_same(&line.points, &points)) {
            Some(line) => line.labels.push(label),
            None => lines.push(Line { labels: vec![label], points, found_by }),
        }
    }
    lines
}

fn is_same(a: &Polyline, b: &Polyline) -> bool {
    let mut pairs = a.points().iter().zip(b.points());
    a.points().len() == b.points().len() && pairs.all(|(a, b)| a.distance(*b) <= SAME_M)
}

/// Picture of the paths of one query, and of the shortest line under the corner rule of the first
/// planner. If there are too many paths for one picture, it has panels.
pub(super) fn picture(map: &Compared, query: usize) -> Svg {
    let entries: Vec<&ContestEntry> = map.contest.entries.iter().collect();
    let title = format!("{}, query {} of {}", map.name, query + 1, map.queries.len());
    if entries.len() <= MAX_LINES {
        let name = |entry: &ContestEntry| Some(format!("{}, {}", entry.planner, entry.smoother));
        let lines = lines(map, query, &entries, name);
        // By method: a method has the same colour in the pictures of all queries.
        let all = layers(&lines, |line, _, _| style(line.found_by, entries.len()));
        return all.fold(common(map, query).title(title), MapPicture::with_boxed).svg();
    }
    let Groups { shared, panels, inner } = groups(&entries);
    let title =
        format!("{title}{}", shared.as_ref().map_or(String::new(), |one| format!(", {one}")));
    // Names shared by all panels go into the title.
    let name = |entry: &ContestEntry| shared.is_none().then(|| inner(entry).to_owned());
    let lines = |panel: &Panel<'_>| lines(map, query, &panel.entries, name);
    let lines: Vec<Vec<Line>> = panels.iter().map(lines).collect();
    let mut picture = MapPanels::new(common(map, query).title(title));
    for (panel, lines) in panels.iter().zip(&lines) {
        let style = |line: &Line, index, count| panel_style(line.found_by, index, count);
        picture = picture.panel(panel.title.clone(), layers(lines, style).collect());
    }
    picture.svg()
}

/// The layers below the paths.
fn common(map: &Compared, query: usize) -> MapPicture<'_> {
    let ends = map.queries[query];
    let picture = MapPicture::new(&map.grid)
        .with(CellTint::blocked(map.map.blocked()).color(TOO_CLOSE))
        .with(StartMark(ends.start))
        .with(GoalMark { point: ends.goal, tolerance_m: None });
    match map.contest.oracles.first().and_then(|oracle| oracle.lines[query].as_ref()) {
        Some(line) => {
            let label = format!("shortest line: {:.2} m", line.length_m());
            picture.with(PathLine::new(line, label, SHORTEST).in_front())
        }
        None => picture,
    }
}

/// The distinct paths that were found.
fn lines(
    map: &Compared,
    query: usize,
    entries: &[&ContestEntry],
    name: impl Fn(&ContestEntry) -> Option<String>,
) -> Vec<Line> {
    let deviation_m = CHORD_CELLS * map.map.frame().resolution_m();
    let found = entries.iter().enumerate().filter_map(|(i, entry)| {
        let found = entry.answers[query].found.as_ref()?;
        let name = name(entry).map_or_else(String::new, |name| format!("{name}: "));
        let label = format!("{name}{:.2} m", found.metrics.length_m);
        Some((i, label, found.done.path.flattened(deviation_m).merged()))
    });
    distinct(found)
}

/// Layers of the paths, each with a legend entry for all methods that found it. The style depends
/// on the line, its index and the number of lines.
fn layers(
    lines: &[Line],
    style: impl Fn(&Line, usize, usize) -> LineStyle,
) -> impl Iterator<Item = Box<dyn Layer + '_>> {
    lines.iter().enumerate().flat_map(move |(i, line)| {
        let style = style(line, i, lines.len());
        let layer = move |label: &String| PathLine::new(&line.points, label.clone(), style);
        line.labels.iter().map(move |label| Box::new(layer(label)) as Box<dyn Layer>)
    })
}

/// Paths grouped into panels, by planner or by smoother.
struct Groups<'a> {
    /// The name that all panels share.
    shared: Option<String>,
    panels: Vec<Panel<'a>>,
    /// The name that differs within a panel.
    inner: Name,
}

/// Accessor of the planner's or the smoother's name.
type Name = fn(&ContestEntry) -> &'static str;

struct Panel<'a> {
    title: String,
    entries: Vec<&'a ContestEntry>,
}

/// Groups the paths into panels with as few paths as possible: planners are side by side if there
/// are more planners than smoothers.
fn groups<'a>(entries: &[&'a ContestEntry]) -> Groups<'a> {
    let planner: Name = |entry| entry.planner;
    let smoother: Name = |entry| entry.smoother;
    let names = |name: Name| -> Vec<&'static str> {
        let mut names = Vec::new();
        for name in entries.iter().map(|entry| name(entry)) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    };
    let (planners, smoothers) = (names(planner), names(smoother));
    let by_planner = planners.len() > smoothers.len();
    let (outer, inner) = if by_planner { (planner, smoother) } else { (smoother, planner) };
    let panels_of = |title: &'static str| -> Vec<Panel<'a>> {
        let own: Vec<&ContestEntry> =
            entries.iter().copied().filter(|one| outer(one) == title).collect();
        let count = own.len().div_ceil(MAX_LINES);
        let titled = |(i, entries): (usize, &[&'a ContestEntry])| {
            let part = if count > 1 { format!(" ({} of {count})", i + 1) } else { String::new() };
            Panel { title: format!("{title}{part}"), entries: entries.to_vec() }
        };
        own.chunks(MAX_LINES).enumerate().map(titled).collect()
    };
    let shared = match (&planners[..], &smoothers[..]) {
        ([one], _) => Some(format!("planner {one}")),
        (_, [one]) => Some(format!("smoother {one}")),
        _ => None,
    };
    Groups { shared, panels: names(outer).into_iter().flat_map(panels_of).collect(), inner }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::search::CornerRule;

    #[test]
    fn lines_on_top_of_each_other_are_told_apart() {
        for count in 1..=24 {
            let styles: Vec<LineStyle> = (0..count).map(|i| style(i, count)).collect();
            for pair in styles.windows(2) {
                assert_ne!(pair[0].color, pair[1].color);
                // A line behind another shows at its rim, or through the gaps.
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
        let lines = distinct(found.map(|(name, y)| (0, name.to_owned(), line(y))));
        let labels: Vec<Vec<String>> = lines.into_iter().map(|line| line.labels).collect();
        assert_eq!(labels, [vec!["a", "c"], vec!["b"], vec!["d"]]);
    }
    fn entry(planner: &'static str, smoother: &'static str) -> ContestEntry {
        let corners = CornerRule::Forbid;
        ContestEntry { planner, smoother, corners, preparation: None, answers: Vec::new() }
    }

    /// Titles of the panels and their labels.
    fn panels(planners: &[&'static str], smoothers: &[&'static str]) -> Vec<(String, Vec<String>)> {
        let pairs = planners.iter().flat_map(|p| smoothers.iter().map(|s| entry(p, s)));
        let entries: Vec<ContestEntry> = pairs.collect();
        let groups = groups(&entries.iter().collect::<Vec<_>>());
        let inner = |panel: &Panel<'_>| {
            panel.entries.iter().map(|one| (groups.inner)(one).to_owned()).collect()
        };
        groups.panels.iter().map(|panel| (panel.title.clone(), inner(panel))).collect()
    }

    #[test]
    fn panels_have_few_paths() {
        let panel = |title: &str, inner: &[&str]| {
            (title.to_owned(), inner.iter().map(|&name| name.to_owned()).collect::<Vec<_>>())
        };
        let by_smoother =
            [panel("x", &["a", "b"]), panel("y", &["a", "b"]), panel("z", &["a", "b"])];
        assert_eq!(panels(&["a", "b"], &["x", "y", "z"]), by_smoother);
        let by_planner = [panel("a", &["x"]), panel("b", &["x"]), panel("c", &["x"])];
        assert_eq!(panels(&["a", "b", "c"], &["x"]), by_planner);
        // Seven of each: two panels for each smoother.
        let names = ["a", "b", "c", "d", "e", "f", "g"];
        let many = panels(&names, &names);
        assert_eq!(many.len(), 14);
        assert_eq!(many[1], panel("a (2 of 2)", &["g"]));
        assert!(many.iter().all(|(_, inner)| inner.len() <= MAX_LINES));
    }
}
