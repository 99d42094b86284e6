//! Reports of routes.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Point;
use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{AStar, PathEnd, PlanError};
use keyway::robot::Robot;
use keyway::search::{IfUnreachable, Workspace};
use keyway::smooth::Taut;
use keyway_sim::report::{MapSource, PlanOutcome, RouteAnswer, RouteFailure, RouteRequest};
use std::sync::atomic::{AtomicU32, Ordering};

/// A wall, unknown cells behind it, and an enclosed cell.
const ROWS: [&str; 4] = ["....?...", "....?.##", ".##.?.#.", "....?.##"];

fn with_request<R>(goals: &[Point], work: impl FnOnce(RouteRequest<'_>) -> R) -> R {
    let grid = OccupancyGrid::from_ascii(&ROWS);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    work(RouteRequest {
        grid: &grid,
        map: &map,
        planner: &AStar::default(),
        smoother: Some(&Taut),
        start: Point::new(0.5, 0.5),
        goals,
        budget: None,
        if_unreachable: IfUnreachable::Fail,
        with_optimum: false,
    })
}

fn answer(goals: &[Point]) -> Result<RouteAnswer, PlanError> {
    with_request(goals, |request| request.answer(None, &mut Workspace::default()))
}

#[test]
fn several_goals_are_reported_nearest_first() {
    let goals = [[3.5, 3.5], [5.5, 0.5], [0.5, 1.6], [1.5, 1.5], [99.0, 0.0]].map(Point::from);
    let found = answer(&goals).unwrap();
    assert_eq!((found.goal, found.reached.unwrap().index), (2, 2));
    assert_eq!(found.route.unwrap().end(), Some(goals[2]));
    let parts = found.goals.unwrap();
    let order: Vec<_> = parts.iter().map(|part| (part.index, part.outcome)).collect();
    let expected = [
        (2, PlanOutcome::Found),
        (0, PlanOutcome::Found),
        (1, PlanOutcome::NoPath),
        (3, PlanOutcome::Blocked),
        (4, PlanOutcome::OutsideMap),
    ];
    assert_eq!(order, expected);
    assert!((parts[0].length_m.unwrap() - 1.1).abs() < 1e-9);
    assert_eq!(parts[0].time_s, None);
}

#[test]
fn no_path_says_what_separates_the_ends() {
    let through_unknown = answer(&[Point::new(5.5, 0.5)]).unwrap();
    assert_eq!((through_unknown.plan.outcome, through_unknown.route), (PlanOutcome::NoPath, None));
    let why = through_unknown.plan.why.unwrap();
    assert!(why.contains("separate parts of the map") && why.contains("unknown space"), "{why}");
    let closed = answer(&[Point::new(7.5, 1.5)]).unwrap();
    let Some(RouteFailure::Separated(why)) = closed.failure else { panic!("no separation") };
    assert!(!why.is_joined_through_unknown);
    assert_eq!(closed.plan.why.unwrap(), why.separation.to_string());
}

#[test]
fn what_cannot_begin_is_an_error() {
    let blocked = answer(&[Point::new(1.5, 1.5)]).unwrap_err();
    assert!(matches!(blocked, PlanError::Blocked { end: PathEnd::Goal, .. }), "{blocked}");
    assert!(matches!(answer(&[]), Err(PlanError::NoPath { .. })));
}

#[test]
fn a_clock_gives_times_and_an_optimum_the_excess() {
    let readings = AtomicU32::new(0);
    // A second passes between two readings.
    let now_s = || f64::from(readings.fetch_add(1, Ordering::Relaxed));
    let answer = with_request(&[Point::new(3.5, 3.5)], |request| {
        let request = RouteRequest { with_optimum: true, ..request };
        request.answer(Some(&now_s), &mut Workspace::default())
    });
    let answer = answer.unwrap();
    assert_eq!((answer.plan.time_s, answer.smoothed.unwrap().time_s), (Some(1.0), Some(1.0)));
    assert_eq!(
        (answer.plan.optimum_cells, answer.plan.excess),
        (answer.plan.cost_cells, Some(0.0))
    );
}

#[test]
fn reports_have_the_documented_members_in_their_order() {
    let goals = [Point::new(3.5, 3.5), Point::new(0.5, 2.5)];
    let text = with_request(&goals, |request| {
        let answer = request.answer(None, &mut Workspace::default()).unwrap();
        let source = MapSource { name: "a.map".to_owned(), ..MapSource::default() };
        let robot = Robot::small();
        let inputs = request.inputs(source, None, &Stack::key_point_fusion(&robot));
        serde_json::to_string(&answer.report(inputs)).unwrap()
    });
    let members = [
        "{\"schema\":\"keyway.plan/3\",\"outcome\":\"found\",\"planner\":\"astar\",\"length_m\":",
        ",\"time_s\":null,",
        ",\"goal\":{\"index\":1,\"cell\":[0,2],\"gap_m\":0.0}",
        ",\"goals\":[{\"index\":1,",
        ",\"smoothed\":{\"length_m\":",
        ",\"inputs\":{\"version\":",
        ",\"map\":\"a.map\",",
        ",\"stack\":null,\"config\":{\"map\":{",
        ",\"start\":[0.5,0.5],\"goal\":[3.5,3.5],\"goals\":[[3.5,3.5],[0.5,2.5]],\"via\":null,\"nearest_reachable\":false,",
    ];
    let mut rest = text.as_str();
    for member in members {
        let at = rest.find(member);
        assert!(at.is_some(), "{member} is missing or out of order in {rest}");
        rest = &rest[at.unwrap() + member.len()..];
    }
}
