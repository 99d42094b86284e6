//! Tests that the text of whole pictures has enough space.

use crate::layers::{GoalMark, Layer, PathLine, StartMark};
use crate::svg::Svg;
use crate::{
    BoxGroup, BoxPlot, ChartPoint, IntervalChart, IntervalRow, MapPanels, MapPicture, PointPanels,
    PointSeries, SpeedCurveOptions, SpeedSeries, box_plot, interval_chart, point_panels,
    speed_curve,
};
use keyway::geometry::{Point, Polyline, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway_sim::metrics::statistics;
use keyway_sim::sim::TrajectoryPoint;
use resvg::usvg::{Group, Node, Rect, TextChunk};

/// Margin at the page's edge that must stay free \[px\].
const EDGE_PX: f32 = 4.0;

/// Fails if a text leaves the page or overlaps another one, drawn with the bundled font.
fn expect_room_for_all_text(picture: &Svg) {
    let Ok(tree) = picture.tree() else { panic!("no SVG") };
    let (width, height) = (tree.size().width(), tree.size().height());
    let texts = texts_of(tree.root());
    assert!(texts.len() > 4, "{texts:?}");
    for (i, (text, place)) in texts.iter().enumerate() {
        let is_in_view = place.left() >= EDGE_PX
            && place.top() >= EDGE_PX
            && place.right() <= width - EDGE_PX
            && place.bottom() <= height - EDGE_PX;
        assert!(is_in_view, "`{text}` at {place:?} of {width} x {height}");
        for (other, taken) in &texts[..i] {
            let is_apart = place.left() >= taken.right()
                || place.right() <= taken.left()
                || place.top() >= taken.bottom()
                || place.bottom() <= taken.top();
            assert!(is_apart, "`{text}` at {place:?} over `{other}` at {taken:?}");
        }
    }
}

/// Returns every text, with the bounding box of its letters \[px\].
fn texts_of(group: &Group) -> Vec<(String, Rect)> {
    let of_node = |node: &Node| match node {
        Node::Group(group) => texts_of(group),
        Node::Text(text) => {
            let words = text.chunks().iter().map(TextChunk::text).collect();
            vec![(words, text.flattened().abs_bounding_box())]
        }
        Node::Path(_) | Node::Image(_) => Vec::new(),
    };
    group.children().iter().flat_map(of_node).collect()
}

const LONG: &str = "total search time of the stack s4-guided, a point of 30_long_words/in-a-folder.toml, lower than that of astar";
const CAPTION: &str = "Bars: mean over the maps, and its 95 % interval. How it was made: keyway reproduce S4-3 --maps 100 --seed 1 --out DIR.";

#[test]
fn of_bars_and_boxes() {
    let row = |value: f64, name| IntervalRow {
        name,
        value: Some(value),
        interval: Some((value - 1.0, 2.0 * value)),
        reference: Some(-value),
        note: "+72608.57 % (+53632.46 to +99270.25)\npublished -47.41 %, n = 100",
    };
    for rows in [&[row(14.0, LONG)][..], &[row(14.0, "a"), row(7e4, LONG), row(-9.0, LONG)]] {
        let label = "change of the total search time [%]";
        let chart = IntervalChart { label, ends: None, rows, caption: CAPTION };
        expect_room_for_all_text(&interval_chart(&chart));
    }
    let values = statistics::Sample::new(vec![1.0, 2.0, 2.5, 9.0]).unwrap();
    let group = |name| BoxGroup { name, values: Some(&values), note: "n = 100" };
    let (label, groups) = ("time to the goal [s]", [group(LONG), group("a"), group(LONG)]);
    let plot = BoxPlot { title: "Runs", label, groups: &groups, caption: CAPTION };
    expect_room_for_all_text(&box_plot(&plot));
}

#[test]
fn of_curves_and_points() {
    let velocity = Velocity::new(0.5, -0.2);
    let run = [0.0, 7.0, 9.5].map(|t_s| TrajectoryPoint { t_s, pose: Pose::default(), velocity });
    let series = [LONG, "a", LONG].map(|name| SpeedSeries { name, points: &run });
    let caption = CAPTION.to_owned();
    let options = SpeedCurveOptions { caption, ..SpeedCurveOptions::default() };
    expect_room_for_all_text(&speed_curve(&series, &options));
    let point = |x| ChartPoint { x, y: -1234.5 * x, y_interval: None };
    let points = [point(0.025), point(0.4)];
    let series = [LONG, "a", "b", LONG].map(|name| PointSeries { name, points: &points });
    let (x_label, y_label) = ("gamma", "change of the driven length [%]");
    expect_room_for_all_text(&point_panels(&PointPanels {
        x_label,
        y_label,
        y_ends: None,
        are_joined: true,
        series: &series,
        caption: CAPTION,
    }));
}

#[test]
fn of_panels() {
    let map = OccupancyGrid::from_ascii(&["....................."; 21]);
    let [start, goal] = [Point::new(3.5, 3.5), Point::new(17.5, 17.5)];
    let path = Polyline::new(vec![start, goal]);
    for titles in [&[LONG][..], &[LONG, "a", LONG, LONG, "b"]] {
        let common = MapPicture::new(&map)
            .with(StartMark(start))
            .with(GoalMark { point: goal, tolerance_m: None });
        let mut panels = MapPanels::new(common).caption(CAPTION);
        for title in titles {
            let layer: Box<dyn Layer> = Box::new(PathLine::smoothed(&path));
            panels = panels.panel(*title, vec![layer]);
        }
        expect_room_for_all_text(&panels.svg());
    }
}
