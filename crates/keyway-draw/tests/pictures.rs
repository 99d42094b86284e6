//! Tests of whole pictures: they are SVG, they can be rendered (with the feature `raster`), and
//! their legends match their content.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::local::{Explanation, Fate, JudgedCandidate, Share};
use keyway::map::{BitGrid, Cell, CellState, GridFrame, OccupancyGrid};
use keyway::robot::Footprint;
use keyway_draw::layers::{
    Caption, CellTint, DrivenPath, Fan, Footprints, GoalMark, HatchedDiscs, Hits, Layer, Movers,
    OtherGoals, PathLine, Points, Polygons, StartMark,
};
use keyway_draw::{
    LineStyle, MapPanels, MapPicture, Region, SERIES, SpeedCurveOptions, SpeedSeries, Svg,
    TextTable, speed_curve,
};
use keyway_sim::sim::{MovingObstacle, TrajectoryPoint, WayPoints};

/// Width and height of the page in its text; if pixels can be rendered, they have this size.
fn page_px(picture: &Svg) -> (u32, u32) {
    let numbers = picture.as_str().split('"').filter_map(|text| text.parse().ok());
    let size: Vec<u32> = numbers.take(2).collect();
    #[cfg(feature = "raster")]
    assert_eq!(png_px(picture, 1.0), (size[0], size[1]));
    (size[0], size[1])
}

/// Width and height in the header of a PNG file.
#[cfg(feature = "raster")]
fn png_px(picture: &Svg, scale: f64) -> (u32, u32) {
    let png = picture.to_png(scale).unwrap();
    let word = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (word(16), word(20))
}

fn run() -> Vec<TrajectoryPoint> {
    let state = |i: u32| TrajectoryPoint {
        t_s: f64::from(i) * 0.1,
        pose: Pose::new(1.0 + f64::from(i) * 0.02, 2.0, 0.0),
        velocity: Velocity::new(0.2 + f64::from(i) * 0.003, -0.1),
    };
    (0..100).map(state).collect()
}

fn map(yaw: f64) -> OccupancyGrid {
    let frame = GridFrame::new(50, 40, 0.1, Pose::new(0.0, 0.0, yaw)).unwrap();
    OccupancyGrid::from_fn(frame, |cell| match (cell.x, cell.y) {
        (10..15, 5..30) => CellState::Occupied,
        (40.., _) => CellState::Unknown,
        _ => CellState::Free,
    })
}

fn disc(radius_m: f64) -> Footprint {
    Footprint::circle(radius_m).unwrap()
}

/// One that crosses the robot's path back and forth forever, and one that crosses it once.
fn movers() -> Vec<MovingObstacle> {
    let ends = vec![Point::new(2.0, 1.0), Point::new(2.0, 3.0)];
    let across = keyway_sim::sim::ObstacleMotion::WayPoints(WayPoints::around(ends, 1.0).unwrap());
    let past = MovingObstacle::straight(Point::new(3.0, 3.5), 0.2, Point::new(0.0, -0.3)).unwrap();
    vec![MovingObstacle::new(0.15, across).unwrap(), past]
}

/// A picture with every layer.
fn everything(map: &OccupancyGrid) -> Svg {
    let mut cells = BitGrid::new(map.frame().width(), map.frame().height(), true);
    cells.fill_span(20, 5, 25);
    let points = [Point::new(1.0, 1.0), Point::new(2.0, 2.0), Point::new(3.0, 2.0)];
    let path = Polyline::new(points.to_vec());
    let discs = [Disc { centre: points[1], radius_m: 0.3 }];
    let run = run();
    MapPicture::new(map)
        .title("Everything <& more>")
        .with(CellTint::blocked(&cells))
        .with(CellTint::sensed(&cells))
        .with(HatchedDiscs::unknown_obstacles(&discs))
        .with(PathLine::planned(&path))
        .with(PathLine::smoothed(&path))
        .with(Points::key_points(&points))
        .with(DrivenPath::new(&run))
        .with(Footprints::new(&run, &disc(0.18)))
        .with(Movers::new(&movers(), &run))
        .with(StartMark(points[0]))
        .with(GoalMark { point: points[2], tolerance_m: Some(0.4) })
        .svg()
}

#[test]
fn the_legend_lists_what_is_drawn_and_nothing_else() {
    let labels = [
        "free",
        "occupied",
        "unknown",
        "free, too close for the robot",
        "sensed",
        "unknown obstacle",
        "moving obstacle",
        "its path",
        "its position at a time [s]",
        "robot at a time [s]",
        "planned path",
        "smoothed path",
        "key point",
        "driven",
        "robot",
        "start",
        "goal",
        "goal tolerance",
        "speed [m/s]",
    ];
    let full = everything(&map(0.0));
    let free = OccupancyGrid::from_ascii(&["..", ".."]);
    let nothing = Polyline::default();
    let unset = BitGrid::new(2, 2, true);
    let bare = MapPicture::new(&free)
        .with(PathLine::planned(&nothing))
        .with(CellTint::sensed(&unset))
        .with(CellTint::blocked(&unset))
        .with(HatchedDiscs::unknown_obstacles(&[]))
        .with(Points::key_points(&[]))
        .with(DrivenPath::new(&[]))
        .with(Footprints::new(&[], &disc(0.2)))
        .with(Movers::new(&[], &run()))
        .svg();
    for label in labels {
        let text = format!(">{label}</text>");
        assert_eq!(full.as_str().matches(&text).count(), 1, "{label}");
        assert_eq!(bare.as_str().matches(&text).count(), usize::from(label == "free"), "{label}");
    }
    assert!(full.as_str().contains("Everything &lt;&amp; more&gt;"));
}

#[test]
fn movers_and_the_robot_have_marks_at_the_same_times() {
    let run = run();
    let picture = MapPicture::new(&map(0.0)).with(Movers::new(&movers(), &run)).svg();
    // 9.9 s in steps of 2 s; the one that moves back and forth is at one position after 2, 6 and
    // 10 s, and at another one after 4 and 8 s.
    let marks = |text: &str| picture.as_str().matches(&format!(">{text}</text>")).count();
    assert_eq!(["2, 6", "4, 8"].map(marks), [1, 1]);
    assert_eq!(["2", "4", "6", "8", "10"].map(marks), [2, 2, 2, 2, 0]);
    // A stationary robot has a single mark.
    let resting: Vec<TrajectoryPoint> =
        run.iter().map(|point| TrajectoryPoint { pose: run[0].pose, ..*point }).collect();
    let picture = MapPicture::new(&map(0.0)).with(Movers::new(&movers(), &resting)).svg();
    assert_eq!(picture.as_str().matches(">2 \u{2026} 8</text>").count(), 1);
    let resting = MapPicture::new(&map(0.0)).with(Movers::new(&movers(), &[])).svg();
    assert!(resting.as_str().contains(">moving obstacle</text>"));
    assert!(!resting.as_str().contains(">its way</text>"));
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    for yaw in [0.0, 0.7] {
        let (first, second) = (everything(&map(yaw)), everything(&map(yaw)));
        assert_eq!(first, second);
        #[cfg(feature = "raster")]
        assert_eq!(first.to_png(1.5).unwrap(), second.to_png(1.5).unwrap());
    }
}

#[test]
fn a_rotated_map_is_rotated_and_its_axes_are_not() {
    let straight = everything(&map(0.0));
    let turned = everything(&map(0.5));
    let matrix = |picture: &Svg| {
        let text = picture.as_str();
        let start = text.find("matrix(").unwrap() + 7;
        let numbers = text[start..].split(')').next().unwrap().to_owned();
        numbers.split(' ').map(|n| n.parse::<f64>().unwrap()).collect::<Vec<_>>()
    };
    let (a, b) = (matrix(&straight), matrix(&turned));
    assert!(a[0] > 0.0 && a[1] == 0.0 && a[2] == 0.0 && a[3] < 0.0);
    // Pixels grow downwards: a turn to the left is a turn with a negative second entry.
    assert!((b[1] / b[0] + 0.5f64.tan()).abs() < 1e-6 && b[1] < 0.0);
    assert!(turned.as_str().contains(">x [m]</text>"));
}

#[test]
fn degenerate_maps_and_layers_can_be_drawn() {
    let (empty, dot) = (Polyline::default(), Polyline::new(vec![Point::new(0.5, 0.5)]));
    let bad = Polyline::new(vec![Point::new(f64::NAN, 0.0), Point::new(0.2, f64::INFINITY)]);
    let still = vec![run()[0]; 3];
    let corners = [[0.0, 0.0], [1e9, 0.0], [f64::NAN, 3.0]].map(Point::from);
    let polygons = [&corners[..], &corners[..2], &corners[..1], &[]];
    let strange = [Disc { centre: Point::new(0.5, 0.5), radius_m: -1.0 }];
    let small = BitGrid::new(1, 1, true);
    for rows in [&["."][..], &["#"], &["?"], &["??", "??"], &["...................."]] {
        let map = OccupancyGrid::from_ascii(rows);
        for region in [
            Region::Known,
            Region::Whole,
            Region::Window(Point::new(3.0, 3.0), Point::new(3.0, 3.0)),
            Region::Window(Point::new(-90.0, -90.0), Point::new(-80.0, -80.0)),
            Region::Window(Point::new(f64::NAN, 0.0), Point::new(0.0, f64::NAN)),
        ] {
            let picture = MapPicture::new(&map)
                .region(region)
                .with(PathLine::planned(&empty))
                .with(PathLine::smoothed(&dot))
                .with(PathLine::planned(&bad))
                .with(CellTint::sensed(&small))
                .with(HatchedDiscs::unknown_obstacles(&strange))
                .with(Polygons::unknown_obstacles(&polygons))
                .with(DrivenPath::new(&still).v_max_mps(f64::NAN))
                .with(Footprints::new(&still, &disc(0.1)).every_m(0.0))
                .with(GoalMark { point: Point::new(0.1, 0.1), tolerance_m: Some(f64::NAN) })
                .svg();
            assert!(!picture.as_str().contains("NaN"), "{rows:?} {region:?}");
            let (width, height) = page_px(&picture);
            assert!(width >= 100 && height >= 100 && width <= 1500 && height <= 1500);
        }
    }
}

/// Position of the first text with this content.
fn place(picture: &Svg, text: &str) -> (f64, f64) {
    let before = picture.as_str().split(&format!(">{text}</text>")).next().unwrap();
    let (_, tag) = before.rsplit_once("<text").unwrap();
    let number = |name: &str| -> f64 {
        let (_, rest) = tag.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    (number("x"), number("y"))
}

#[test]
fn a_marker_does_not_hide_an_obstacle() {
    let (map, point) = (map(0.0), Point::new(3.0, 2.0));
    let with_disc = |radius_m: f64| {
        let discs = [Disc { centre: Point::new(3.01, 2.0), radius_m }];
        let discs = HatchedDiscs::unknown_obstacles(&discs);
        MapPicture::new(&map).with(discs).with(GoalMark { point, tolerance_m: None }).svg()
    };
    let alone = MapPicture::new(&map).with(GoalMark { point, tolerance_m: None }).svg();
    let (hidden, wide) = (with_disc(0.02), with_disc(0.4));
    assert_eq!(place(&alone, "G"), place(&wide, "G"), "it looks out on all sides");
    let ((x, y), (beside_x, beside_y)) = (place(&alone, "G"), place(&hidden, "G"));
    // Farther away than the marker and the obstacle together are wide.
    assert!((beside_x - x).hypot(beside_y - y) > 8.2 + 3.1, "{beside_x} {beside_y}");
}

/// The key points of a curve are so close that their rings cover each other, and its line is as
/// wide as the obstacle.
#[test]
fn a_route_does_not_hide_an_obstacle() {
    let map = map(0.0);
    let around: Vec<Point> =
        (-10..=10).map(|i| Point::new(3.0 + 0.01 * f64::from(i), 2.0)).collect();
    let discs = [Disc { centre: Point::new(3.0, 2.0), radius_m: 0.01 }];
    let picture = MapPicture::new(&map)
        .with(HatchedDiscs::unknown_obstacles(&discs))
        .with(Points::key_points(&around))
        .with(PathLine::smoothed(&Polyline::new(around.clone())).over_driven())
        .svg();
    // The legend comes after the plot.
    let plot = picture.as_str().split("</svg>").next().unwrap();
    let (disc, last_ring) = (plot.find("fill-opacity=\"1\""), plot.rfind("fill=\"#fff\" stroke"));
    assert!(disc.is_some() && last_ring.is_some(), "{plot}");
    assert!(disc > last_ring && disc > plot.rfind("#e7298a"), "{plot}");
}

#[test]
fn other_goals_are_told_apart() {
    let map = map(0.0);
    let others = [Point::new(0.5, 0.5), Point::new(3.0, 3.0), Point::new(f64::NAN, 0.0)];
    let goal = GoalMark { point: Point::new(3.0, 2.0), tolerance_m: None };
    let picture = MapPicture::new(&map).with(goal).with(OtherGoals::new(&others)).svg();
    let count = |text: &str| picture.as_str().matches(text).count();
    assert_eq!((count(">G</text>"), count(">goal<"), count(">other goal<")), (5, 1, 1));
}

/// Both are visible even where they overlap.
#[test]
fn a_smoothed_path_is_seen_over_what_was_driven() {
    let (map, run) = (map(0.0), run());
    let path = Polyline::new(run.iter().map(|point| point.pose.point()).collect());
    let picture = MapPicture::new(&map)
        .with(DrivenPath::new(&run))
        .with(PathLine::smoothed(&path).over_driven())
        .svg();
    let plot = picture.as_str().split("</svg>").next().unwrap();
    let last = plot.rsplit("<path").next().unwrap();
    let width = |tag: &str| -> f64 {
        let (_, rest) = tag.split_once("stroke-width=\"").unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    assert!(last.contains("#e7298a"), "{last}");
    let driven = plot.rsplit("<path").nth(1).unwrap();
    assert!(width(last) < 0.5 * width(driven), "{driven} {last}");
}

#[test]
fn panels_have_one_map_and_legends_of_their_own() {
    let map = map(0.0);
    let style = LineStyle { color: SERIES[0], width_px: 1.6, dashes: "" };
    let paths: Vec<Polyline> = (0..5)
        .map(|i| Polyline::new(vec![Point::new(0.5, 0.5), Point::new(3.0, f64::from(i) * 0.5)]))
        .collect();
    let mut panels =
        MapPanels::new(MapPicture::new(&map).title("All").with(StartMark(Point::new(0.5, 0.5))));
    for (i, path) in paths.iter().enumerate() {
        let layer: Box<dyn Layer> = Box::new(PathLine::new(path, format!("path {i}"), style));
        panels = panels.panel(format!("panel {i}"), vec![layer]);
    }
    let picture = panels.svg();
    let count = |text: &str| picture.as_str().matches(text).count();
    for i in 0..5 {
        assert_eq!((count(&format!(">panel {i}<")), count(&format!(">path {i}<"))), (1, 1));
    }
    // Once in every panel, and once in the common legend.
    assert_eq!((count(">S</text>"), count(">start<"), count("<use")), (6, 1, 5));
    assert_eq!((count("#2b2b2b"), count(">occupied<"), count(">All<")), (2, 1, 1));
    // Three in a row: two rows have a y axis, and the panels of the last one have an x axis.
    assert_eq!((count(">y [m]<"), count(">x [m]<")), (2, 2));
    let (first, second, fourth) =
        (place(&picture, "panel 0"), place(&picture, "panel 1"), place(&picture, "panel 3"));
    assert!(first.0 < second.0 && first.1 == second.1);
    assert!(first.0 == fourth.0 && first.1 < fourth.1);
    assert!(page_px(&picture).0 > 750);
    let none = MapPanels::new(MapPicture::new(&map)).svg();
    assert!(page_px(&none).0 > 0 && !none.as_str().contains("NaN"));
}

#[test]
fn large_maps_make_small_files() {
    let frame = GridFrame::new(2000, 2000, 0.05, Pose::default()).unwrap();
    // The worst case: every second cell, so that nothing can be merged.
    let checkers = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
        if (x + y) % 2 == 0 { CellState::Occupied } else { CellState::Free }
    });
    let picture = MapPicture::new(&checkers).side_px(4000.0).svg();
    assert!(picture.as_str().len() < 4_200_000, "{} bytes", picture.as_str().len());
    #[cfg(feature = "raster")]
    {
        let (width, height) = png_px(&picture, 3.0);
        assert_eq!(width.max(height), keyway_draw::MAX_PNG_SIDE_PX);
    }
}

#[test]
fn speed_curves_of_none_one_and_several_runs() {
    let run = run();
    let still: Vec<TrajectoryPoint> =
        run.iter().map(|p| TrajectoryPoint { velocity: Velocity::ZERO, ..*p }).collect();
    let broken = [TrajectoryPoint { t_s: f64::NAN, ..run[0] }];
    let one = [SpeedSeries { name: "alone", points: &run }];
    let options = SpeedCurveOptions {
        title: Some("Runs".to_owned()),
        v_max_mps: Some(0.6),
        omega_max_radps: Some(1.5),
        caption: "How it was made.".to_owned(),
    };
    let several = ["fast & far", "still", "broken"].into_iter().zip([&run[..], &still, &broken]);
    let several: Vec<_> = several.map(|(name, points)| SpeedSeries { name, points }).collect();
    let many = speed_curve(&several, &options);
    assert!(many.as_str().contains(">fast &amp; far</text>"));
    assert!(many.as_str().contains(">limit</text>") && many.as_str().contains(">Runs</text>"));
    assert!(many.as_str().contains(">How it was made.</text>"));
    let single = speed_curve(&one, &SpeedCurveOptions::default());
    assert!(!single.as_str().contains("alone") && !single.as_str().contains("limit"));
    for picture in [many, single, speed_curve(&[], &options), speed_curve(&several[2..], &options)]
    {
        assert!(!picture.as_str().contains("NaN"));
        let (width, height) = page_px(&picture);
        assert!((500..700).contains(&width) && (300..500).contains(&height));
    }
}

#[test]
fn a_speed_curve_has_gaps_where_there_is_no_state() {
    let whole = run();
    let mut with_gap = whole.clone();
    with_gap[whole.len() / 2].velocity.v = f64::NAN;
    let lines = |points: &[TrajectoryPoint]| {
        let svg = speed_curve(&[SpeedSeries { name: "", points }], &SpeedCurveOptions::default());
        let paths = svg.as_str().split("<path").skip(1);
        let starts = paths.map(|path| path.split("/>").next().unwrap().matches('M').count());
        starts.collect::<Vec<_>>()
    };
    assert_eq!((lines(&whole), lines(&with_gap)), (vec![1, 1], vec![2, 2]));
}

/// Two admissible candidates, and two that a rule refused, one of them because of a contact.
fn explanation() -> Explanation {
    let poses = |y: f64| (1..=10).map(|i| Pose::new(1.0 + 0.1 * f64::from(i), y, 0.0)).collect();
    let share = |raw| Share { term: "speed".into(), raw, weighted: 0.1 * raw };
    let good = |v: f64, y: f64| JudgedCandidate {
        velocity: Velocity::new(v, 0.0),
        fate: Fate::Admissible { shares: [share(v)].into_iter().collect(), score: 0.1 * v },
        poses: poses(y),
    };
    let bad = |rule: &'static str, free_for_s: Option<f64>| JudgedCandidate {
        velocity: Velocity::new(0.5, 0.0),
        fate: Fate::Refused { rule: rule.into(), because: "would do it".into(), free_for_s },
        poses: poses(2.2),
    };
    Explanation {
        target: None,
        candidates: vec![
            good(0.2, 2.0),
            bad("contact", Some(1.0)),
            good(0.3, 2.1),
            bad("other", None),
        ],
        chosen: Some(2),
        runner_up: Some(0),
        remedies: Vec::new(),
    }
}

#[test]
fn a_fan_shows_every_candidate_by_its_fate() {
    let (map, explanation, from) = (map(0.0), explanation(), Pose::new(1.0, 2.0, 0.0));
    let svg = MapPicture::new(&map).with(Fan::new(from, &explanation)).svg();
    let text = svg.as_str();
    for entry in
        ["2 admissible, by score", "refused: 1 would do it", "chosen", "second best", ">score<"]
    {
        assert!(text.contains(entry), "{entry}");
    }
    // The colours span the actual scores, whatever their sign.
    let mut bad = explanation.clone();
    for candidate in &mut bad.candidates {
        if let Fate::Admissible { score, .. } = &mut candidate.fate {
            *score = 100.0 * *score - 25.0;
        }
    }
    let bad = MapPicture::new(&map).with(Fan::new(from, &bad)).svg();
    // From -23 to -22.
    assert!(bad.as_str().contains("22.0<") && !bad.as_str().contains(">0<"));
    // A dot at each contact, and nowhere else.
    assert_eq!(text.matches("r=\"1.3\"").count(), 1);
    page_px(&svg);
    let pale = MapPicture::new(&map).with(Fan::new(from, &explanation).pale()).svg();
    assert!(pale.as_str().contains("refused<") && !pale.as_str().contains("second best"));
    let nothing = Explanation::default();
    let empty = MapPicture::new(&map).with(Fan::new(from, &nothing)).svg();
    assert!(!empty.as_str().contains("chosen") && !empty.as_str().contains(">score<"));
}

#[test]
fn a_table_stands_below_the_picture_and_widens_it() {
    let map = map(0.0);
    let plain = MapPicture::new(&map).svg();
    let long = "a line of text that is much longer than the picture is wide ".repeat(3);
    let table = TextTable::new().row(["term", "raw"]).row(["speed", "0.3"]).row([long.trim()]);
    let with = MapPicture::new(&map).table(table).svg();
    let ((width, height), (wider, higher)) = (page_px(&plain), page_px(&with));
    assert!(
        wider > width && (51..80).contains(&(higher - height)),
        "{width} {height} {wider} {higher}"
    );
    assert!(with.as_str().contains(">speed<"));
}

#[test]
fn scans_and_captions() {
    let map = map(0.0);
    let hits = [Point::new(1.0, 1.0), Point::new(f64::NAN, 1.0)];
    let svg = MapPicture::new(&map).with(Hits(&hits)).with(Caption("12.3 s".to_owned())).svg();
    assert!(svg.as_str().contains(">scan<") && svg.as_str().contains(">12.3 s<"));
    assert!(!MapPicture::new(&map).with(Hits(&[])).svg().as_str().contains(">scan<"));
    let cells = [Cell::new(20, 6), Cell::new(20, 7)];
    let listed = MapPicture::new(&map).with(CellTint::sensed_list(&cells)).svg();
    let mut grid = BitGrid::new(50, 40, false);
    for cell in cells {
        grid.set(cell, true);
    }
    assert_eq!(listed, MapPicture::new(&map).with(CellTint::sensed(&grid)).svg());
}
