//! World model of a navigator: the map and the observations.

mod changing;
mod scene;
mod storing;

pub(super) use storing::StoredWorld;

use super::doubts::{Doubt, Doubts, ScanFault};
use super::masks::Masks;
use super::motors::Motors;
use super::poses::Poses;
use super::recovery::DrivenTrack;
use super::route::Router;
use super::time::Time;
use super::walked_ground::WalkedGround;
use super::{Blocked, FittedStack, NavigateError, Step};
use crate::geometry::{Pose, Shift, Velocity};
use crate::map::{Cell, CellState, CellWindow, DistanceField, Edit, OccupancyGrid};
use crate::robot::Robot;
use crate::sense::{
    Mover, MovingPoint, Observation, ProjectedScan, SeenCells, SeenGround, SensedLayer,
    SensorPoints, SensorScan, Tracker, Walls,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The world model. Observations update it, decisions read it.
pub(super) struct World {
    /// Number of changes of the map.
    pub(super) changes: u64,
    /// The map, with keep-out zones as obstacles.
    pub(super) known: Arc<OccupancyGrid>,
    /// The map without keep-out zones; `None` if there are none.
    unmasked: Option<Arc<OccupancyGrid>>,
    pub(super) masks: Masks,
    /// Plans on layers that include the sensed obstacles.
    pub(super) router: Router,
    /// Distances to known and sensed obstacles.
    pub(super) obstacles: DistanceField,
    pub(super) sensed: SensedLayer,
    seen: Option<SeenGround>,
    /// Tracks moving obstacles, which are not in the sensed layer; `None` if everything counts as
    /// stationary.
    pub(super) tracker: Option<Tracker>,
    pub(super) walked: WalkedGround,
    /// Recent positions of the robot.
    pub(super) track: DrivenTrack,
    pub(super) motors: Motors,
    /// Moving obstacles, predicted to the time at which the next command takes effect.
    pub(super) movers_then: Vec<Mover>,
    /// Surface points of those that may as well be stationary, at that time.
    pub(super) surfaces_then: Vec<MovingPoint>,
    /// Cells that have become occupied since the last decision.
    pub(super) edits: Vec<Edit>,
    /// True if these were too many to be listed.
    pub(super) has_changed_much: bool,
    poses: Poses,
    /// State of the last accepted observation.
    told: Option<Told>,
    /// The latest of all stamps.
    now: Option<Time>,
    /// Reason why the last observation was discarded.
    refused: Option<Blocked>,
    /// The last scan of each sensor; without beams before the first one, and while the sensor is
    /// silent.
    scans: Vec<ProjectedScan>,
    times: Vec<SensorTimes>,
    /// Time of the last points of each sensor that gives points.
    points_at: [Option<Time>; SensorPoints::MOST_SENSORS],
    /// Ranges of each sensor's last scan \[m\].
    ranges_m: Vec<Vec<f64>>,
    /// Time of the latest scan of any sensor.
    scanned: Option<Time>,
    /// A repeated scan, projected from the present pose; not meaningful between scans.
    again: ProjectedScan,
    doubts: Doubts,
    /// Changes of the map by the last scan.
    changed: Vec<Edit>,
}

/// State of a robot when it was observed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Told {
    pub(super) time: Time,
    pub(super) pose: Pose,
    pub(super) velocity: Velocity,
}

/// Times of a sensor's scans.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct SensorTimes {
    /// Last scan.
    scanned: Option<Time>,
    /// Last scan with a valid beam.
    said: Option<Time>,
    /// True if the sensor is silent because it repeats itself.
    #[serde(default)]
    repeats: bool,
}

impl World {
    /// Maximum number of listed cells; beyond it, only a flag is set.
    const MOST_EDITS: usize = 4096;

    /// A world model of the map alone.
    pub(super) fn new(
        known: &Arc<OccupancyGrid>,
        parts: &FittedStack,
    ) -> Result<Self, NavigateError> {
        let FittedStack { robot, stack, tracker, .. } = parts;
        let frame = known.frame();
        let router = Router::new(known, parts)?;
        Ok(Self {
            obstacles: router.distances(robot),
            sensed: SensedLayer::new(frame),
            seen: stack.build_seen_ground(frame, robot),
            tracker: tracker.clone(),
            walked: WalkedGround::default(),
            track: DrivenTrack::new(frame.resolution_m()),
            motors: Motors::new(robot),
            movers_then: Vec::new(),
            surfaces_then: Vec::new(),
            edits: Vec::new(),
            has_changed_much: false,
            poses: Poses::new(),
            told: None,
            now: None,
            refused: None,
            scans: vec![ProjectedScan::default(); robot.sensors.len()],
            times: vec![SensorTimes::default(); robot.sensors.len()],
            points_at: [None; SensorPoints::MOST_SENSORS],
            ranges_m: vec![Vec::new(); robot.sensors.len()],
            scanned: None,
            again: ProjectedScan::default(),
            doubts: Doubts::new(robot.sensors.len()),
            changed: Vec::new(),
            known: Arc::clone(known),
            unmasked: None,
            changes: 0,
            masks: Masks::default(),
            router,
        })
    }

    /// Takes in an observation, unless it is implausible. Returns the shift of all sensed
    /// obstacles if the pose is one that the robot cannot have reached by driving.
    pub(super) fn observe(
        &mut self,
        parts: &FittedStack,
        observation: &Observation<'_>,
    ) -> Option<Shift> {
        let Observation { pose, velocity: told, .. } = *observation;
        let time = match self.believe(&parts.robot, observation) {
            Ok(time) => time,
            Err(why) => {
                self.refused = Some(why);
                return None;
            }
        };
        self.refused = None;
        let command = self.motors.acts_at(time).unwrap_or(told);
        let velocity = self.motors.observe(time, pose, told);
        let shift = self.follow_jump(&parts.robot, time, (pose, velocity));
        self.told = Some(Told { time, pose, velocity });
        self.poses.note(time, pose, velocity);
        self.doubts.note(time, (pose, told), command);
        self.now = self.now.max(Some(time));
        if self.known.frame().cell_from_world(pose.point()).is_some() {
            self.track.note(pose.point());
            self.forget_silent(&parts.robot);
            observation.scans.iter().for_each(|scan| self.take_in(parts, scan));
            observation.points.iter().for_each(|points| self.take_in_points(parts, points));
        }
        self.doubts.look(time, &self.motors);
        shift
    }

    /// Moves sensed obstacles along with a jump of the robot's pose, so that they keep their
    /// relative position.
    fn follow_jump(&mut self, robot: &Robot, time: Time, now: (Pose, Velocity)) -> Option<Shift> {
        let Told { time: before, pose, velocity } = self.told?;
        let elapsed_s = time.since_s(before);
        let expected = self.doubts.jump(robot, (pose, velocity), now, elapsed_s)?;
        let shift = self.relocate(expected, now.0);
        self.doubts.note_jump(time, expected, now.0);
        Some(shift)
    }

    /// Contradictions in recent observations.
    pub(super) fn doubts(&self) -> &[Doubt] {
        self.doubts.found()
    }

    /// The time of an observation, if it is plausible.
    fn believe(&self, robot: &Robot, observation: &Observation<'_>) -> Result<Time, Blocked> {
        let Observation { stamp_s, pose, velocity, .. } = *observation;
        let time = Time::of_stamp(stamp_s).ok_or(Blocked::BadInput("stamp_s"))?;
        if let Some(told) = self.told.filter(|told| time < told.time) {
            return Err(Blocked::TimeRunsBack { stamp_s, last_s: told.time.stamp_s() });
        }
        match unbelievable(robot, pose, velocity) {
            Some(field) => Err(Blocked::BadInput(field)),
            None => Ok(time),
        }
    }

    /// Clears the last scan of each silent sensor: its obstacles may have left.
    fn forget_silent(&mut self, robot: &Robot) {
        for sensor in 0..self.scans.len() {
            if self.silent_s(sensor) > robot.sensors[sensor].timeout_in_s(robot.cycle_s) {
                let scan = &mut self.scans[sensor];
                scan.clear(scan.robot());
            }
        }
    }

    /// Time since the last valid beam of a sensor \[s\]; infinite if there was none.
    fn silent_s(&self, sensor: usize) -> f64 {
        let said = self.times[sensor].said;
        said.zip(self.now).map_or(f64::INFINITY, |(said, now)| now.since_s(said))
    }

    /// Takes in a scan at the robot's pose at the time of the scan. Ignored are scans of a sensor
    /// that the robot does not have, scans without valid beams, scans that are not newer than the
    /// last one or older than all remembered poses, and scans that repeat the last ranges from
    /// another pose, unless they show nothing new: such a scan carries no new information,
    /// whatever its stamp. Once one is refused of a sensor that is silent, repetitions are refused
    /// while the robot is stationary, too: otherwise a sensor that hangs would let it start again
    /// and again.
    fn take_in(&mut self, parts: &FittedStack, scan: &SensorScan<'_>) {
        let Some(time) = Time::of_stamp(scan.stamp_s) else { return };
        let Some(sensor) = parts.robot.sensors.get(scan.sensor) else { return };
        let is_silent = self.silent_s(scan.sensor) > sensor.timeout_in_s(parts.robot.cycle_s);
        let times = &mut self.times[scan.sensor];
        // A scan that is handed over again says nothing about clocks.
        let told = self.told.filter(|_| times.scanned != Some(time));
        let fault = told.and_then(|told| ScanFault::of(scan, time.since_s(told.time)));
        if let (Some(fault), Some(told)) = (fault, self.told) {
            self.doubts.note_fault(scan.sensor, told.time, fault);
        }
        let Some(mut pose) = self.poses.at(time) else { return };
        let is_usable = fault != Some(ScanFault::Bearings) && !scan.scan.says_nothing();
        if !is_usable || times.scanned.is_some_and(|last| time <= last) {
            return;
        }
        self.now = self.now.max(Some(time));
        let (ranges_m, projected) = (&mut self.ranges_m[scan.sensor], &mut self.scans[scan.sensor]);
        let velocity = self.told.map_or(Velocity::ZERO, |told| told.velocity);
        let given = scan.scan.ranges_m;
        let is_same = ranges_m.iter().map(|m| m.to_bits()).eq(given.iter().map(f64::to_bits));
        let (frame, footprint) = (self.known.frame(), &parts.robot.footprint);
        if is_same && scan.scan.has_hits() {
            if times.repeats || Doubts::has_come_far(velocity, projected.robot(), pose) {
                self.doubts.note_repeated(scan.sensor, time);
                self.again.project(frame, footprint, pose, scan);
                if !is_known(&self.again, &self.obstacles) {
                    times.repeats |= is_silent;
                    return;
                }
            } else {
                // The robot has hardly moved: the scan keeps the pose at which it was first
                // given.
                pose = projected.robot();
            }
        }
        times.scanned = Some(time);
        times.repeats = is_same && times.repeats;
        ranges_m.clear();
        ranges_m.extend(given.iter());
        projected.project(frame, footprint, pose, scan);
        if !projected.is_silent() {
            times.said = Some(time);
        }
        self.note(parts, scan.sensor, time);
    }

    /// Takes in points at the robot's pose at their time, by the rules for scans.
    fn take_in_points(&mut self, parts: &FittedStack, points: &SensorPoints<'_>) {
        let Some(time) = Time::of_stamp(points.stamp_s) else { return };
        let Some(last) = self.points_at.get_mut(points.sensor) else { return };
        let Some(robot) = self.poses.at(time) else { return };
        if last.is_some_and(|last| time <= last) {
            return;
        }
        *last = Some(time);
        self.now = self.now.max(Some(time));
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        let (footprint, tracker) = (&parts.robot.footprint, self.tracker.as_ref());
        self.sensed.update_points(map, footprint, robot, points, tracker, &mut self.changed);
        self.keep_out();
        self.spread_changes();
    }

    /// Updates the tracker and the sensed layer with the scan of a sensor, all maps derived from
    /// them, and the observed free space.
    fn note(&mut self, parts: &FittedStack, sensor: usize, time: Time) {
        let scan = &self.scans[sensor];
        // Keep-out zones are not walls: obstacles in them are sensed.
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        // Of scans of the same time, only the first advances time.
        let elapsed_s = self.scanned.map_or(0.0, |last| time.since_s(last).max(0.0));
        self.scanned = self.scanned.max(Some(time));
        if let Some(tracker) = &mut self.tracker {
            tracker.update_from(map, sensor, scan, elapsed_s);
            if parts.stack.controller.go_around {
                self.walked.note(tracker.movers(), elapsed_s);
            }
        }
        let (changed, tracker) = (&mut self.changed, self.tracker.as_ref());
        self.sensed.update_from(map, sensor, scan, tracker, changed);
        self.keep_out();
        self.spread_changes();
        let scan = &self.scans[sensor];
        if let Some(seen) = &mut self.seen {
            let walls = walls(self.unmasked.as_deref(), &self.known, &self.router);
            seen.update(self.known.frame(), scan, walls, elapsed_s);
        }
    }

    /// Keeps cells that have just become free blocked if they are in a keep-out zone.
    fn keep_out(&mut self) {
        if self.unmasked.is_some() {
            for edit in self.changed.iter_mut().filter(|it| it.state != CellState::Occupied) {
                edit.state = self.known.state(edit.cell).unwrap_or(edit.state);
            }
        }
    }

    /// Updates all derived maps with the cells that have just changed.
    fn spread_changes(&mut self) {
        let Self { router, obstacles, changed, edits, .. } = self;
        router.layers.maps.iter_mut().for_each(|map| map.apply(changed));
        let cells = changed.iter().map(|edit| CellWindow { low: edit.cell, high: edit.cell });
        if let Some(window) = cells.reduce(|all, cell| all.union(&cell)) {
            obstacles.update(router.layers.obstacles().obstacles(), window);
        }
        let marked = changed.iter().filter(|edit| edit.state == CellState::Occupied);
        edits.extend(marked);
        if edits.len() > Self::MOST_EDITS {
            edits.clear();
            self.has_changed_much = true;
        }
    }

    /// Forgets the edits after a decision has used them.
    pub(super) fn forget_edits(&mut self) {
        self.edits.clear();
        self.has_changed_much = false;
    }

    /// The last observed state, if it is plausible.
    pub(super) fn told(&self) -> Result<Told, Blocked> {
        match &self.refused {
            Some(why) => Err(why.clone()),
            None => self.told.ok_or(Blocked::NothingObserved),
        }
    }

    /// Advances the time to this one \[s\]; true if it was earlier before.
    pub(super) fn pass_time(&mut self, now_s: f64) -> bool {
        let now = Time::of_stamp(now_s).filter(|&now| self.now.is_some_and(|before| before < now));
        self.now = now.or(self.now);
        now.is_some()
    }

    /// The latest time that was observed or set.
    pub(super) const fn now(&self) -> Option<Time> {
        self.now
    }

    /// Predicts the state of the latest scan to the present, and moving obstacles to the time at
    /// which a robot that lags its reference by `lag_s` is there \[s\].
    pub(super) fn look_ahead(&mut self, lag_s: f64) {
        // Another sensor may have seen through a cell that one sensor has marked.
        let sensed = self.sensed.sensed();
        let known = self.known.occupied();
        self.edits.retain(|edit| sensed.get(edit.cell) || known.get(edit.cell));
        let age_s = self.scan_age_s();
        if let Some(tracker) = &self.tracker {
            let ahead_s = self.motors.delay_s() + age_s + lag_s;
            self.movers_then.clear();
            self.movers_then.extend(tracker.movers().iter().map(|mover| mover.after(ahead_s)));
            self.surfaces_then.clear();
            self.surfaces_then.extend(tracker.surfaces_after(ahead_s));
        }
        if let Some(seen) = self.seen.as_mut().filter(|_| age_s > 0.0) {
            let walls = walls(self.unmasked.as_deref(), &self.known, &self.router);
            seen.look_ahead(self.known.frame(), walls, age_s);
        }
    }

    /// The same step with a command that the motors can follow.
    pub(super) fn within_reach(&self, velocity: Velocity, step: Step) -> Step {
        let command = step.command();
        let given = self.motors.within_reach(velocity, command);
        if given == command { step } else { step.commanding(given) }
    }

    /// Age of the latest scan \[s\].
    pub(super) fn scan_age_s(&self) -> f64 {
        self.scanned.zip(self.now).map_or(0.0, |(scanned, now)| now.since_s(scanned))
    }

    /// The reason to stop if sensors have had no valid beam for too long: all of them, or any one
    /// of them if the robot need not stay within observed free space. Before its first scan, a
    /// sensor counts as silent forever.
    pub(super) fn silence(&self, parts: &FittedStack) -> Option<Blocked> {
        if !parts.stack.controller.stop_when_blind {
            return None;
        }
        let Robot { sensors, cycle_s, .. } = &*parts.robot;
        let silences = || (0..sensors.len()).map(|sensor| (sensor, self.silent_s(sensor)));
        let mut timed_out = silences()
            .filter(|&(sensor, silent_s)| {
                silent_s > sensors[sensor].timeout_in_s(*cycle_s) * (1.0 + 1e-9)
            })
            .peekable();
        let drives_by_sight = self.seen_cells().ahead.is_some();
        let (sensor, silent_s) = if drives_by_sight {
            let all = timed_out.count() == sensors.len();
            silences().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|_| all)?
        } else {
            timed_out.peek().copied()?
        };
        Some(Blocked::SensorSilent { sensor, silent_s })
    }

    /// Evaluates a query on the known map alone, without the sensed obstacles.
    pub(super) fn on_known<T>(&mut self, ask: impl FnOnce(&mut Router, &OccupancyGrid) -> T) -> T {
        let (sensed, Self { router, known, .. }) = (self.sensed.cells(), self);
        router.layers.unmark(&sensed, known);
        let answer = ask(router, known);
        router.layers.mark(&sensed, |_| CellState::Occupied);
        answer
    }

    /// Adds the layer of the clearance \[m\] that a route was found on, unless it exists.
    pub(super) fn add_layer(&mut self, clearance_m: Option<f64>) {
        if clearance_m.is_none() || clearance_m == self.router.layers.inserted_m() {
            return;
        }
        if let Some(clearance_m) = clearance_m {
            self.router.layers.insert_again(&self.known, clearance_m);
            self.router.layers.mark(&self.sensed.cells(), |_| CellState::Occupied);
        }
    }

    /// A router on the known map alone.
    pub(super) fn known_router(&self) -> Router {
        let mut router = self.router.clone();
        router.layers.unmark(&self.sensed.cells(), &self.known);
        router
    }

    /// The observed free space, and the latest scans.
    pub(super) fn seen_cells(&self) -> SeenCells<'_> {
        let cells = self.seen.as_ref().map_or(SeenCells::ANYWHERE, SeenGround::cells);
        SeenCells { scans: &self.scans, ..cells }
    }
}

/// True if nearly all hits of a scan are at occupied cells: along a uniform wall, the next scan
/// may be identical to the one before.
fn is_known(scan: &ProjectedScan, obstacles: &DistanceField) -> bool {
    const NEARLY_ALL: f64 = 0.98;
    let is_known = |cell: Cell| obstacles.half_cells_sq(cell) == Some(0);
    let known = scan.hits().filter(|(_, hit)| hit.cell.is_some_and(is_known)).count();
    known as f64 >= NEARLY_ALL * scan.hits().count() as f64
}

/// Walls that pedestrians do not walk through.
fn walls<'a>(
    unmasked: Option<&'a OccupancyGrid>,
    known: &'a OccupancyGrid,
    router: &'a Router,
) -> Walls<'a> {
    let map = unmasked.unwrap_or(known);
    // If keep-out zones are among the obstacles, only those of the map are walls.
    let obstacles = match unmasked {
        Some(map) => map.occupied(),
        None => router.layers.obstacles().obstacles(),
    };
    Walls { obstacles, unknown: map.unknown() }
}

/// The field that is implausible, if any: not finite, or faster than twice the robot's limits.
fn unbelievable(robot: &Robot, pose: Pose, velocity: Velocity) -> Option<&'static str> {
    let limits = &robot.limits;
    let fastest_mps = limits.v_max_mps.max(-limits.v_min_mps);
    let checks = [
        ("pose.x", pose.x.is_finite()),
        ("pose.y", pose.y.is_finite()),
        ("pose.theta", pose.theta.is_finite()),
        ("velocity.v", velocity.v.abs() <= 2.0 * fastest_mps),
        ("velocity.omega", velocity.omega.abs() <= 2.0 * limits.omega_max_radps),
    ];
    checks.into_iter().find(|check| !check.1).map(|(field, _)| field)
}
