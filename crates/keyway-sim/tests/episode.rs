//! Whole runs and their reports.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Disc, Point, Pose};
use keyway::map::{GridFrame, OccupancyGrid, UnknownPolicy};
use keyway::navigate::{NavigateError, Navigator, RecoveryCounts, Stack};
use keyway::robot::Robot;
use keyway::sense::Observation;
use keyway_sim::episode::{
    Cycle, Episode, EpisodeObserver, EpisodeOutcome, RunError, RunOptions, run_episode,
    watch_episode,
};
use keyway_sim::report::PlanOutcome;
use keyway_sim::sim::{
    Disturbances, ElusiveObstacle, ElusiveShape, KeyFrame, KeyFrames, LocalisationFaults,
    MovingObstacle, ObstacleMotion, Presence, Run,
};
use std::sync::atomic::{AtomicU32, Ordering};

/// A hall of 6 m x 3 m in cells of 0.25 m, drawn in blocks of 1 m.
fn hall(rows: [&str; 3]) -> OccupancyGrid {
    let blocks = OccupancyGrid::from_ascii(&rows);
    let frame = GridFrame::new(24, 12, 0.25, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        blocks.state(keyway::map::Cell::new(cell.x / 4, cell.y / 4)).unwrap()
    })
}

fn episode(rows: [&str; 3]) -> Episode {
    Episode::new(hall(rows), Robot::small(), Point::new(0.6, 1.5), Point::new(5.4, 1.5))
}

const OPEN: [&str; 3] = ["......"; 3];

/// Counts the calls of an observer.
#[derive(Default)]
struct Counts {
    started: u64,
    decided: u64,
    ended: u64,
    no_route: Option<NavigateError>,
    run: Option<Run>,
}

impl EpisodeObserver for Counts {
    fn no_route(&mut self, why: &NavigateError) {
        self.no_route = Some(why.clone());
    }

    fn started(&mut self, navigator: &Navigator) {
        assert_eq!((self.decided, navigator.routes_planned()), (0, 1));
        self.started += 1;
    }

    fn decided(&mut self, cycle: &Cycle<'_>) {
        assert_eq!((cycle.index, self.ended), (self.decided, 0));
        let Observation { pose, scans, .. } = *cycle.observation;
        assert!(pose.x >= 0.6 && scans[0].scan.range_max_m > 0.0);
        self.decided += 1;
    }

    fn ended(&mut self, run: &Run, _navigator: &Navigator) {
        self.ended += 1;
        self.run = Some(run.clone());
    }
}

#[test]
fn equal_episodes_have_equal_reports_without_times() {
    let report = run_episode(&episode(OPEN)).unwrap().first();
    assert_eq!(report, run_episode(&episode(OPEN)).unwrap().first());
    assert_eq!((report.outcome, &report.reason), (EpisodeOutcome::Reached, &None));
    let smoothed = report.smoothed.as_ref().unwrap();
    assert_eq!((report.plan.time_s, smoothed.time_s), (None, None));
    assert_eq!(report.run.unwrap().mean_cycle_us, None);
}

#[test]
fn an_observer_sees_every_cycle_and_its_clock_gives_the_times() {
    let readings = AtomicU32::new(0);
    // A millisecond passes between two readings.
    let now_s = || f64::from(readings.fetch_add(1, Ordering::Relaxed)) * 1e-3;
    let mut counts = Counts::default();
    let report = {
        let options = RunOptions { clock: Some(&now_s), ..RunOptions::default() };
        watch_episode(&episode(OPEN), options, std::slice::from_mut(&mut counts)).unwrap().first()
    };
    let run = report.run.as_ref().unwrap();
    // The last decision is arrival, after which no cycle is driven.
    assert_eq!((counts.started, counts.decided, counts.ended), (1, run.cycles + 1, 1));
    assert!((run.mean_cycle_us.unwrap() - 1000.0).abs() < 1e-6);
    assert!((report.plan.time_s.unwrap() - 1e-3).abs() < 1e-9);
    // The trajectory is that of the run: the start, and the end of each cycle.
    let (rows, samples) = (report.trajectory.as_ref().unwrap(), counts.run.unwrap().samples);
    assert_eq!((rows.len(), rows.len() as u64), (samples.len(), run.cycles + 1));
    let last = samples.last().unwrap();
    assert_eq!(rows.last().unwrap()[..3], [last.t_s, last.pose.x, last.pose.y]);
}

#[test]
fn what_is_not_on_the_map_is_real() {
    let mut blocked = episode(OPEN);
    blocked.obstacles = vec![Disc::new(Point::new(3.0, 1.4), 0.3)];
    let (free, around) =
        (run_episode(&episode(OPEN)).unwrap().first(), run_episode(&blocked).unwrap().first());
    assert_eq!(around.outcome, EpisodeOutcome::Reached);
    let length_m =
        |report: &keyway_sim::episode::RobotReport| report.run.as_ref().unwrap().length_m;
    assert!(length_m(&around) > length_m(&free) + 0.01);
    assert_eq!(around.inputs.obstacles, [[3.0, 1.4, 0.3]]);
    // An obstacle over the start causes immediate contact.
    blocked.obstacles[0].centre = blocked.robots[0].start.position;
    let touched = run_episode(&blocked).unwrap().first();
    assert_eq!(touched.outcome, EpisodeOutcome::Collided);
    assert_eq!(touched.reason.unwrap(), "touched unknown obstacle 0 at (0.600, 1.500)");
    assert_eq!(touched.run.unwrap().cycles, 0);
}

#[test]
fn unknown_cells_are_real_where_they_are_planned_around() {
    let with_gap = ["...?..", "...?..", "......"];
    let around = run_episode(&episode(with_gap)).unwrap().first();
    let mut through = episode(with_gap);
    through.robots[0].stack.map.unknown = UnknownPolicy::Free;
    let through = run_episode(&through).unwrap().first();
    let outcomes = (around.outcome, through.outcome);
    assert_eq!(outcomes, (EpisodeOutcome::Reached, EpisodeOutcome::Reached));
    let (around, through) = (around.run.unwrap(), through.run.unwrap());
    assert!(around.length_m > through.length_m + 0.2);
    // Only the unknown cells are near.
    assert!(around.min_clearance_m.is_some() && through.min_clearance_m.is_none());
}

#[test]
fn no_route_is_a_report() {
    let mut counts = Counts::default();
    let closed = episode(["..#...", "..#...", "..#..."]);
    let observers = std::slice::from_mut(&mut counts);
    let report = watch_episode(&closed, RunOptions::default(), observers).unwrap().first();
    assert_eq!(
        (report.outcome, report.plan.outcome),
        (EpisodeOutcome::NoPath, PlanOutcome::NoPath)
    );
    assert_eq!((counts.started, counts.ended), (0, 0));
    assert_eq!(report.reason, counts.no_route.map(|why| why.to_string()));
    assert!(report.reason.unwrap().contains("separate parts of the map"));
    assert!(report.run.is_none() && report.trajectory.is_none());
}

/// A delay of 0.1 s, noise of 5 %, and sensor and localisation errors.
fn disturbed(seed: u64) -> Disturbances {
    let mut disturbances = Disturbances { seed, ..Disturbances::default() };
    let sensor = &mut disturbances.sensor;
    (sensor.range_m, sensor.dropped_beams, sensor.dropped_scans) = (0.01, 0.05, 0.05);
    let actuation = &mut disturbances.actuation;
    (actuation.delay_s, actuation.v_relative, actuation.omega_relative) = (0.1, 0.05, 0.05);
    disturbances.localisation = LocalisationFaults {
        position_m: 0.02,
        heading_rad: 0.01,
        correlation_s: 5.0,
        v_relative: 0.05,
        omega_relative: 0.05,
        ..LocalisationFaults::default()
    };
    disturbances
}

/// Errors of the poses that were reported to the controller.
#[derive(Default)]
struct Errors {
    told: Vec<Pose>,
    largest_m: f64,
    lost_scans: usize,
}

impl EpisodeObserver for Errors {
    fn decided(&mut self, cycle: &Cycle<'_>) {
        self.told.push(cycle.observation.pose);
        self.lost_scans += usize::from(cycle.observation.scans.is_empty());
    }

    fn ended(&mut self, run: &Run, _navigator: &Navigator) {
        for (told, sample) in self.told.iter().zip(&run.samples) {
            self.largest_m = self.largest_m.max(told.point().distance(sample.pose.point()));
        }
    }
}

/// A goal that is missed by an error of the localisation is no robot that is stuck.
#[test]
fn a_robot_that_believed_it_was_at_its_goal_is_told_apart() {
    let drifting = LocalisationFaults { drift: 0.1, ..LocalisationFaults::default() };
    let noisy = episode(OPEN).with_each_robot(|robot| robot.disturbances.localisation = drifting);
    let report = run_episode(&noisy).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck);
    let reason = report.reason.unwrap();
    let off_m = reason.split("but it was ").nth(1).and_then(|rest| rest.split(' ').next());
    let off_m: f64 =
        off_m.and_then(|off_m| off_m.parse().ok()).unwrap_or_else(|| panic!("{reason}"));
    let driven_m = report.run.unwrap().length_m;
    assert!((off_m - 0.1 * driven_m).abs() < 0.25, "{off_m} {driven_m}");
    assert!(!reason.contains("the last problem"), "{reason}");
    // The robot knows nothing of the rules of the scene.
    let mut strict = episode(OPEN);
    strict.rules.goal_tolerance_m = Some(1e-6);
    let reason = run_episode(&strict).unwrap().first().reason.unwrap();
    assert!(reason.contains("within its own tolerance of"), "{reason}");
}

#[test]
fn a_disturbed_robot_gets_through_a_hall() {
    let mut errors = Errors::default();
    let ideal = run_episode(&episode(OPEN)).unwrap().first();
    let noisy = episode(OPEN).with_each_robot(|robot| robot.disturbances = disturbed(1));
    let report = watch_episode(&noisy, RunOptions::default(), std::slice::from_mut(&mut errors));
    let report = report.unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    let run = report.run.as_ref().unwrap();
    assert!(run.time_s > ideal.run.unwrap().time_s, "it begins later");
    assert!(errors.largest_m > 0.02 && errors.largest_m < 0.09, "{}", errors.largest_m);
    assert!(errors.lost_scans > 0 && errors.lost_scans < errors.told.len() / 5);
    // The trajectory is the true one: it begins at the true start, with the delay.
    let rows = report.trajectory.as_ref().unwrap();
    assert_eq!(rows[0][..3], [0.0, 0.6, 1.5]);
    assert_eq!((rows[1][4], rows[1][1]), (0.0, 0.6));
    assert!(rows[2][4] > 0.0);
    // The inputs in the report reproduce it.
    assert_eq!(report.inputs.disturbances.as_ref(), Some(&noisy.robots[0].disturbances));
    let text = serde_json::to_string(&report.inputs.disturbances).unwrap();
    let disturbances: Disturbances = serde_json::from_str(&text).unwrap();
    let again = episode(OPEN).with_each_robot(|robot| robot.disturbances = disturbances.clone());
    assert_eq!(run_episode(&again).unwrap().first(), report);
    let other = episode(OPEN).with_each_robot(|robot| robot.disturbances = disturbed(2));
    assert_ne!(run_episode(&other).unwrap().first().trajectory, report.trajectory);
}

/// The beams that detect an elusive obstacle are drawn from the seed.
#[test]
fn a_report_has_the_seed_by_which_things_are_seen() {
    let seed = |seen| {
        let disc = ElusiveShape::Disc(Disc::new(Point::new(3.5, 2.6), 0.1));
        let elusive = ElusiveObstacle::new(disc, Presence { seen, ..Presence::ALWAYS }).unwrap();
        let mut episode = episode(OPEN).with_each_robot(|robot| robot.disturbances.seed = 7);
        episode.elusive = vec![elusive];
        run_episode(&episode).unwrap().first().inputs.disturbances.map(|it| it.seed)
    };
    assert_eq!([0.0, 0.5, 1.0].map(seed), [None, Some(7), None]);
}

/// A map alone is not enough, because an unmapped obstacle may be there.
#[test]
fn a_robot_without_any_scan_stands() {
    let mut blind = episode(["......", "..##..", "......"]);
    blind.robots[0].disturbances.sensor.dropped_scans = 1.0;
    let report = run_episode(&blind).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck, "{:?}", report.reason);
    assert_eq!(report.run.unwrap().length_m, 0.0);
    // A stack without this check drives by its map, and collides with unsensed obstacles.
    blind.robots[0].stack = Stack::key_point_fusion(&blind.robots[0].robot);
    blind.robots[0].stack.controller.stop_when_blind = false;
    assert_eq!(run_episode(&blind).unwrap().first().outcome, EpisodeOutcome::Reached);
    blind.obstacles = vec![Disc::new(Point::new(3.0, 0.5), 0.4)];
    blind.obstacles.push(Disc::new(Point::new(3.0, 2.5), 0.4));
    assert_eq!(run_episode(&blind).unwrap().first().outcome, EpisodeOutcome::Collided);
}

#[test]
fn rules_end_a_run() {
    let mut short = episode(OPEN);
    short.rules.time_limit_s = Some(1.5);
    let report = run_episode(&short).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Timeout);
    assert_eq!(report.inputs.time_limit_s, Some(1.5));
    assert!((report.run.unwrap().time_s - 1.5).abs() < 1e-9);
    short.rules.stuck_window_s = 0.1;
    short.rules.stuck_progress_m = Some(5.0);
    let report = run_episode(&short).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck);
    assert_eq!(report.inputs.stuck_window_s, Some(0.1));
}

/// A pedestrian stands in a lane until 30 s and then walks on: too long for the default window of
/// 20 s, but not for 40 s.
#[test]
fn who_may_wait_longer_is_not_stuck() {
    let mut lane = episode(["######", "......", "######"]);
    let frame = |t_s, x| KeyFrame { t_s, position: Point::new(x, 1.5) };
    let frames = vec![frame(0.0, 2.5), frame(30.0, 2.5), frame(38.0, 5.5)];
    let motion = ObstacleMotion::KeyFrames(KeyFrames::new(frames).unwrap());
    lane.movers = vec![MovingObstacle::new(0.45, motion).unwrap()];
    lane.robots[0].goal = Point::new(4.0, 1.5).into();
    let report = run_episode(&lane).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Stuck, "{:?}", report.reason);
    assert!(report.reason.unwrap().contains("within 20 s"));
    lane.rules.stuck_window_s = 40.0;
    let report = run_episode(&lane).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
}

#[test]
fn a_slow_robot_is_not_stuck() {
    let mut slow = episode(OPEN);
    // 4 cm in 10 s: less than the progress that other robots need.
    slow.robots[0].robot.limits.v_max_mps = 0.004;
    (slow.robots[0].start.position, slow.robots[0].goal) =
        (Point::new(2.5, 1.5), Point::new(3.2, 1.5).into());
    slow.robots[0].stack = Stack::key_point_fusion(&slow.robots[0].robot);
    let report = run_episode(&slow).unwrap().first();
    assert_eq!(report.outcome, EpisodeOutcome::Reached, "{:?}", report.reason);
    assert_eq!(report.run.unwrap().recoveries, RecoveryCounts::default());
}

#[test]
fn bad_input_is_an_error() {
    let mut bad = episode(["......", ".#....", "......"]);
    bad.robots[0].start.position = Point::new(1.5, 1.5);
    let error = run_episode(&bad).unwrap_err();
    assert!(matches!(error.why, RunError::Navigate(NavigateError::NoRoom { .. })), "{error}");
    bad = episode(OPEN);
    bad.obstacles = vec![Disc::new(Point::new(1.0, f64::NAN), 1.0)];
    assert!(matches!(run_episode(&bad).unwrap_err().why, RunError::World(_)));
    bad = episode(OPEN);
    bad.rules.time_limit_s = Some(-1.0);
    let error = run_episode(&bad).unwrap_err();
    assert_eq!(error.to_string(), "rules.time_limit_s must be a positive number, got -1");
    bad = episode(OPEN);
    bad.robots[0].disturbances.actuation.delay_s = -0.1;
    let error = run_episode(&bad).unwrap_err();
    let expected = "disturbances.actuation.delay_s must be a time from 0 to 10 s, got -0.1";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn reports_have_the_documented_members_in_their_order() {
    let report = run_episode(&episode(OPEN)).unwrap().first();
    let text = serde_json::to_string(&report).unwrap();
    let members = [
        "{\"schema\":\"keyway.navigate/4\",\"outcome\":\"reached\",\"reason\":null,\"plan\":{\"outcome\":\"found\"",
        ",\"smoothed\":{\"length_m\":",
        ",\"key_points_m\":[[",
        ",\"run\":{\"time_s\":",
        ",\"trajectory\":[[0.0,0.6,1.5,",
        ",\"inputs\":{\"version\":",
        "\"config\":{\"map\":{\"unknown\":\"blocked\",\"unknown_penalty\":",
        "\"obstacles\":[],\"polygons\":[],\"hidden_cells\":[],\"absent_cells\":[],\"elusive\":[],\"moving\":[],\"random\":null,\"disturbances\":null,\"goal_tolerance_m\":null,\"arrival\":\"standing\",\"reached_by\":\"truth\",\"time_limit_s\":",
        ",\"stuck_window_s\":20.0,\"budget\":null",
    ];
    let mut rest = text.as_str();
    for member in members {
        let at = rest.find(member);
        assert!(at.is_some(), "{member} is missing or out of order");
        rest = &rest[at.unwrap() + member.len()..];
    }
}
