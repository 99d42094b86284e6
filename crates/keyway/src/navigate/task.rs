//! A goal, and the progress towards it.

use super::met::Met;
use super::mode::Mode;
use super::recovery::RecoveryCursor;
use super::route::{Router, check_goal_heading};
use super::start::StartTooNear;
use super::walked_ground::Hold;
use super::watch::Watch;
use super::{FittedStack, Goal, Misfit, NavigateError};
use crate::geometry::{Point, Polyline};
use crate::guide::{Guidance, GuideMemory};
use crate::local::DriveMemory;
use crate::map::OccupancyGrid;
use crate::robot::Robot;
use crate::route::Route;
use serde::{Deserialize, Serialize};

/// A goal, the route to it, and the state of driving there.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Task {
    /// Way-points, then the goal, each with the length of the leg that leads there \[m\].
    pub(super) stops: Vec<(Point, f64)>,
    /// Number of stops that the robot has passed; never the goal.
    pub(super) passed: usize,
    /// Indices of the way-points that were skipped, in order.
    pub(super) skipped: Vec<usize>,
    /// The requested way-points; a stop may be a position beside one.
    pub(super) asked: Vec<Point>,
    pub(super) goal: Goal,
    /// The external path that the route is a part of.
    pub(super) given: Option<GivenPath>,
    /// Route to the next stop.
    pub(super) route: Route,
    /// Length of the route that the robot has covered \[m\].
    pub(super) covered_m: f64,
    pub(super) mode: Mode,
    /// Guide point of the last cycle; before the first one, the next stop.
    pub(super) guidance: Guidance,
    pub(super) guide_memory: GuideMemory,
    /// Memory of the local planner.
    pub(super) memory: DriveMemory,
    /// True if no point of the route is in line of sight.
    pub(super) is_lost: bool,
    pub(super) watch: Watch,
    pub(super) hold: Hold,
    /// Moving obstacle that the robot has met.
    #[serde(default)]
    pub(super) met: Met,
    pub(super) order: RecoveryCursor,
    /// Duration of the last wait between two attempts at a route \[s\].
    pub(super) waited_s: f64,
    /// Position from which no manoeuvre was found that leads beyond the point of no return: near
    /// it, none is tried again.
    #[serde(default)]
    pub(super) led_from: Option<Point>,
    /// True once the robot has made no progress on this leg, or gaps on its routes have closed:
    /// further routes have the largest clearance, however long they are.
    #[serde(default)]
    pub(super) takes_any_detour: bool,
    /// Sum of what new routes on this leg were longer than the rest of the last one \[m\].
    #[serde(default)]
    pub(super) detoured_m: f64,
    /// The obstacle that the robot has to leave first, until it has.
    pub(super) too_near: Option<StartTooNear>,
}

/// An external path that is followed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct GivenPath {
    pub(super) path: Polyline,
    /// Length of the path that the robot has covered \[m\].
    pub(super) covered_m: f64,
}

impl Task {
    /// Largest distance of an external path from the robot at its start \[m\].
    pub(super) fn near_m(robot: &Robot) -> f64 {
        (4.0 * robot.footprint.circumscribed_radius_m()).max(1.0)
    }

    /// The task of driving from a start to a goal by way-points, with the first route, on the map
    /// of a router.
    pub(super) fn plan(
        router: &mut Router,
        known: &OccupancyGrid,
        parts: &FittedStack,
        start: Point,
        (way_points, goal): (&[Point], Goal),
    ) -> Result<Self, NavigateError> {
        let FittedStack { robot, stack, .. } = parts;
        let start_error_m = stack.controller.start_error_m;
        let too_near = router.check_start(start, &robot.footprint, start_error_m)?;
        let begin = too_near.as_ref().map_or(start, |too_near| too_near.nearest);
        let mut legs = plan_legs(router, known, begin, way_points, goal.position)?;
        let stops: Vec<_> = legs.iter().map(|(to, leg)| (*to, leg.smoothed.length_m())).collect();
        let (_, route) = legs.swap_remove(0);
        let tolerance_rad = stack.controller.goal_yaw_tolerance_rad;
        if goal.heading_rad.is_some() {
            let around = router.distances(robot);
            check_goal_heading(&goal, &robot.footprint, tolerance_rad, &around)?;
        }
        Ok(Self::new(stops, goal, route, too_near))
    }

    /// The task of driving along an external path to its end.
    pub(super) fn along(
        router: &Router,
        parts: &FittedStack,
        start: Point,
        path: Polyline,
    ) -> Result<Self, NavigateError> {
        let (end, is_finite) = match path.points() {
            points @ [_, .., end] => (*end, points.iter().all(|point| point.is_finite())),
            _ => return Err(NavigateError::NoPathToFollow),
        };
        if !is_finite || !start.is_finite() {
            return Err(NavigateError::NoPathToFollow);
        }
        let begin = path.points()[0];
        let (away_m, most_m) = (begin.distance(start), Self::near_m(&parts.robot));
        if away_m > most_m {
            return Err(NavigateError::PathFarAway { away_m, most_m });
        }
        let footprint = &parts.robot.footprint;
        if let Some(misfit) = Misfit::first_along(&path, footprint, &router.distances(&parts.robot))
        {
            return Err(NavigateError::Misfit(misfit));
        }
        let clearance_m = router.clearance_along(&path);
        let length_m = path.length_m();
        let given = Some(GivenPath { path: path.clone(), covered_m: 0.0 });
        let route = Route { smoothed: path, clearance_m, ..Route::default() };
        let task = Self::new(vec![(end, length_m)], end.into(), route, None);
        Ok(Self { given, ..task })
    }

    fn new(
        stops: Vec<(Point, f64)>,
        goal: Goal,
        route: Route,
        too_near: Option<StartTooNear>,
    ) -> Self {
        let remaining_m = stops.iter().map(|(_, length_m)| length_m).sum();
        let asked = stops.iter().map(|stop| stop.0).collect();
        let point = stops.first().map_or(goal.position, |stop| stop.0);
        Self {
            stops,
            passed: 0,
            skipped: Vec::new(),
            asked,
            goal,
            given: None,
            route,
            covered_m: 0.0,
            mode: Mode::default(),
            guidance: Guidance { point, remaining_m },
            guide_memory: GuideMemory::default(),
            memory: DriveMemory::default(),
            is_lost: false,
            watch: Watch::NEW,
            hold: Hold::default(),
            met: Met::default(),
            order: RecoveryCursor::default(),
            waited_s: 0.0,
            led_from: None,
            takes_any_detour: false,
            detoured_m: 0.0,
            too_near,
        }
    }

    pub(super) const fn begin_next_leg(&mut self) {
        self.passed += 1;
        self.waited_s = 0.0;
        (self.takes_any_detour, self.detoured_m) = (false, 0.0);
    }

    /// Takes over what an earlier task to the same stop has learned of the gaps on the way.
    pub(super) fn go_on_from(&mut self, earlier: &Self) {
        if self.next_stop() == earlier.next_stop() {
            self.takes_any_detour = earlier.takes_any_detour;
            self.detoured_m = earlier.detoured_m;
        }
    }

    pub(super) fn next_stop(&self) -> Point {
        self.stops[self.passed].0
    }

    /// True if the next stop is the goal.
    pub(super) fn is_last_leg(&self) -> bool {
        self.passed + 1 == self.stops.len()
    }

    /// True on the route to the next stop, and not to a position beside the path of a moving
    /// obstacle.
    pub(super) const fn is_on_its_way(&self) -> bool {
        !matches!(self.mode, Mode::MakingWay { .. })
    }

    /// Length of the legs after the present one \[m\].
    pub(super) fn later_m(&self) -> f64 {
        if !self.is_on_its_way() {
            return 0.0;
        }
        self.stops[self.passed + 1..].iter().map(|(_, length_m)| length_m).sum()
    }
}

/// The legs of a route, each with its end.
fn plan_legs(
    router: &mut Router,
    known: &OccupancyGrid,
    start: Point,
    way_points: &[Point],
    goal: Point,
) -> Result<Vec<(Point, Route)>, NavigateError> {
    let mut from = start;
    let mut legs = Vec::with_capacity(way_points.len() + 1);
    for (index, &to) in way_points.iter().chain([&goal]).enumerate() {
        let leg = router.first(known, from, to);
        let is_way_point = index < way_points.len();
        let named = |why| {
            if is_way_point {
                NavigateError::WayPoint { number: index + 1, why: Box::new(why) }
            } else {
                why
            }
        };
        legs.push((to, leg.map_err(named)?));
        from = to;
    }
    Ok(legs)
}
