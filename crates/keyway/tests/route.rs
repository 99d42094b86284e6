//! The pipeline from two positions to a smoothed route.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::bound_for;
use keyway::geometry::Point;
use keyway::guide::{Carrot, CarrotConfig};
use keyway::map::{Cell, Connectivity, LayerConfig, OccupancyGrid, SearchMap, Separation};
use keyway::navigate::{FittedStack, Stack};
use keyway::plan::{AStar, Dijkstra, PathEnd, PlanError};
use keyway::robot::{Footprint, Robot};
use keyway::route::{EndRule, Route, RouteQuery, Stage, StageObserver, plan_route, why_no_path};
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::{Taut, Unsmoothed};
use std::sync::Arc;

/// A wall with a gap at its right end, and a closed room.
const ROOM: [&str; 5] = ["......###", "......#.#", "####..###", ".........", "........."];

fn layers(rows: &[&str], clearance_m: f64) -> (OccupancyGrid, SearchMap) {
    let grid = OccupancyGrid::from_ascii(rows);
    let map = SearchMap::new(&grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap();
    (grid, map)
}

fn planned(map: &SearchMap, query: &RouteQuery) -> Result<Route, PlanError> {
    plan_route(map, &AStar::default(), &Taut, query, &mut Workspace::default(), &mut ())
}

#[derive(Default)]
struct Log(Vec<(&'static str, Stage)>);

impl StageObserver for Log {
    fn begin(&mut self, stage: Stage) {
        self.0.push(("begin", stage));
    }

    fn end(&mut self, stage: Stage) {
        self.0.push(("end", stage));
    }
}

#[test]
fn a_route_goes_from_position_to_position() {
    let (_, map) = layers(&ROOM, 0.0);
    let query = RouteQuery::new(Point::new(0.2, 4.9), Point::new(0.3, 0.1));
    let route = planned(&map, &query).unwrap();
    for line in [route.line.polyline(), &route.smoothed] {
        assert_eq!((line.points()[0], *line.points().last().unwrap()), (query.start, query.goal));
    }
    // Taut around the lower and upper corner of the wall's end.
    let corners = [query.start, Point::new(4.0, 3.0), Point::new(4.0, 2.0), query.goal];
    let expected_m: f64 = corners.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    assert!((route.smoothed.length_m() - expected_m).abs() < 1e-9);
    assert_eq!(route.end(), Some(query.goal));
}

#[test]
fn an_end_in_a_blocked_cell_is_joined_only_where_the_disc_fits() {
    // Cells beside the wall are blocked for this clearance; a smaller disc fits there.
    let rows = [".#.######", "#########", ".........", ".........", "........."];
    let (_, map) = layers(&rows, 0.8);
    let beside = RouteQuery::new(Point::new(1.5, 2.4), Point::new(7.5, 1.5));
    let refused = planned(&map, &beside).unwrap_err();
    assert!(matches!(refused, PlanError::Blocked { end: PathEnd::Start, .. }), "{refused}");
    let joined = |radius_m| RouteQuery { ends: EndRule::NearestFree { radius_m }, ..beside };
    let route = planned(&map, &joined(0.3)).unwrap();
    assert_eq!(route.line.polyline().points()[0], beside.start);
    assert_eq!(route.clearance_m, 0.8);
    // In the closed recess, the path to the nearest free cell leads through the wall.
    let inside = RouteQuery { start: Point::new(2.5, 4.5), ..joined(0.3) };
    assert!(planned(&map, &inside).is_err());
}

#[test]
fn in_the_place_of_a_goal_the_line_ends_at_a_centre() {
    let (_, map) = layers(&ROOM, 0.0);
    let query = RouteQuery::new(Point::new(0.5, 4.5), Point::new(7.3, 3.3));
    assert!(matches!(planned(&map, &query), Err(PlanError::NoPath { .. })));
    let nearest = RouteQuery { if_unreachable: IfUnreachable::NearestReachable, ..query };
    let route = planned(&map, &nearest).unwrap();
    assert_eq!(route.plan.reached(), Some(Cell::new(7, 1)));
    assert_eq!(route.end(), Some(Point::new(7.5, 1.5)));
}

#[test]
fn stages_begin_and_end_in_turn_and_nothing_is_smoothed_without_a_path() {
    let (grid, map) = layers(&ROOM, 0.0);
    let planner = AStar::default();
    let (mut log, mut workspace) = (Log::default(), Workspace::default());
    let query = RouteQuery::new(Point::new(0.5, 4.5), Point::new(0.5, 0.5));
    plan_route(&map, &planner, &Taut, &query, &mut workspace, &mut log).unwrap();
    let search = [("begin", Stage::Search), ("end", Stage::Search)];
    let smoothing = [("begin", Stage::Smoothing), ("end", Stage::Smoothing)];
    assert_eq!(log.0, [search, smoothing].concat());

    let mut log = Log::default();
    let query = RouteQuery { goal: Point::new(7.5, 3.5), ..query };
    plan_route(&map, &planner, &Taut, &query, &mut workspace, &mut log).unwrap_err();
    assert_eq!(log.0, search);
    let cells = [Cell::new(0, 4), Cell::new(7, 3)];
    let why = why_no_path(&map, &grid, cells, Connectivity::Four).unwrap();
    let separation = Separation::Apart { start_cells: 32, goal_cells: 1, meet_at_corners: false };
    assert!(why.separation == separation && !why.is_joined_through_unknown, "{why:?}");
}

#[test]
fn unknown_cells_may_be_what_separates() {
    let (grid, map) = layers(&["..?..", "..?.."], 0.0);
    let cells = [Cell::new(0, 0), Cell::new(4, 0)];
    let why = why_no_path(&map, &grid, cells, Connectivity::Four).unwrap();
    assert!(why.is_joined_through_unknown);
    let through = LayerConfig { unknown: keyway::map::UnknownPolicy::Free, ..map.config().clone() };
    let open = SearchMap::new(&grid, through).unwrap();
    assert_eq!(why_no_path(&open, &grid, cells, Connectivity::Four), None);
}

#[test]
fn a_navigator_follows_the_route_of_the_pipeline() {
    let rows = ["..........", "....##....", "....##....", ".........."];
    let (grid, robot) = (OccupancyGrid::from_ascii(&rows), Robot::small());
    let stack = Stack::key_point_fusion(&robot);
    let (start, goal) = (Point::new(0.5, 0.5), Point::new(9.4, 3.6));
    let navigator = bound_for(&grid, &stack.fit(&robot).unwrap(), start, goal).unwrap();
    let map = SearchMap::new(&grid, stack.map.clone()).unwrap();
    let planner = stack.planner.build(&map).unwrap();
    let smoother = stack.smoother.build().unwrap();
    let ends = EndRule::NearestFree { radius_m: robot.footprint.inscribed_radius_m() };
    let query = RouteQuery { ends, ..RouteQuery::new(start, goal) };
    let mut workspace = Workspace::default();
    let route = plan_route(&map, &*planner, &*smoother, &query, &mut workspace, &mut ()).unwrap();
    assert_eq!(navigator.route(), Some(&route));
}

/// Each part of a fitted stack can be replaced.
#[test]
fn a_navigator_takes_parts_of_ones_own() {
    let grid = OccupancyGrid::from_ascii(&["..........", "....##....", ".........."]);
    let robot = Robot { footprint: Footprint::circle(0.1).unwrap(), ..Robot::small() };
    let fitted = Stack::keyway(&robot).fit(&robot).unwrap();
    let (start, goal) = (Point::new(0.5, 1.5), Point::new(9.5, 1.5));
    let route = |stack: &FittedStack| {
        let navigator = bound_for(&grid, stack, start, goal).unwrap();
        (navigator.route().unwrap().smoothed.points().len(), navigator.guide_points().len())
    };
    let (smoothed, _) = route(&fitted);
    let own = fitted
        .with_planner(Arc::new(Dijkstra::default()))
        .with_smoother(Arc::new(Unsmoothed))
        .with_guide(Arc::new(Carrot::new(CarrotConfig { look_ahead_m: 0.5 }).unwrap()));
    let (unsmoothed, guide_points) = route(&own);
    assert!(unsmoothed > smoothed, "{unsmoothed} {smoothed}");
    assert_eq!(guide_points, 1, "the point moves along");
}
