//! All robots of a simulation, cycle by cycle.

mod drive;

use super::cycle_motion::CycleMotion;
use super::giving_way::GivingWay;
use super::participant::{Action, Control, Participant};
use super::rules::Arrival;
use super::social_force::Body;
use super::sweep::Sweep;
use super::{Disturbances, Outcome, RobotState, Run, RunRules, World, WorldAt};
use drive::{Clearances, Drive, Sensor};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::Robot;
use keyway::sense::{Scan, SensorScan};
use std::borrow::Cow;

/// Robots that drive in a world at the same time. Between two cycles, each robot has decided, or
/// its run has ended and it is stationary.
pub(super) struct Fleet<'a> {
    /// World with the current positions of the obstacles that give way.
    world: Cow<'a, World>,
    giving_way: Vec<GivingWay>,
    /// Number of cycles driven.
    cycle: u64,
    cycle_s: f64,
    drives: Vec<Drive<'a>>,
}

/// A robot before its run, without its controller: the fields are those of [`Participant`].
pub(super) struct Entrant<'a> {
    pub(super) robot: Cow<'a, Robot>,
    pub(super) start: Pose,
    pub(super) goal: Point,
    pub(super) disturbances: Disturbances,
    pub(super) rules: RunRules,
}

impl<'a> Entrant<'a> {
    pub(super) fn of<'p: 'a>(participant: &Participant<'p>) -> Self {
        let Participant { robot, start, goal, ref disturbances, ref rules, .. } = *participant;
        let (disturbances, rules) = (disturbances.clone(), rules.clone());
        Self { robot: Cow::Borrowed(robot), start, goal, disturbances, rules }
    }
}

/// Object that a robot touched.
#[derive(Clone, Copy)]
enum Touched {
    /// The nearest static obstacle, or the border; `appeared` if it has just appeared there.
    Standing { appeared: bool },
    /// The moving obstacle of this index, with its speed; `jumped_onto` if it has just jumped
    /// there.
    Mover { index: usize, jumped_onto: bool, speed_mps: f64 },
    /// The robot of this index.
    Robot(usize),
}

/// A robot's contact, and its position along the motion of a cycle.
struct Contact {
    place: f64,
    robot: usize,
    with: Touched,
}

impl<'a> Fleet<'a> {
    /// All robots at rest at their starts; the runs of robots in contact have ended.
    pub(super) fn new(
        mut world: Cow<'a, World>,
        entrants: impl IntoIterator<Item = Entrant<'a>>,
        cycle_s: f64,
    ) -> Self {
        let drive = |(robot, entrant)| Drive::new(robot, entrant, cycle_s);
        let giving_way = GivingWay::begin(&mut world);
        let drives = entrants.into_iter().enumerate().map(drive).collect();
        let mut fleet = Self { world, giving_way, cycle: 0, cycle_s, drives };
        fleet.measure_starts();
        fleet
    }

    /// True if any run has not ended.
    pub(super) fn is_driving(&self) -> bool {
        self.drives.iter().any(|drive| drive.outcome.is_none())
    }

    /// Measures a robot's inputs for its next decision. Returns false if its run has ended or
    /// ends now.
    pub(super) fn sense(&mut self, index: usize) -> bool {
        let drive = &mut self.drives[index];
        if drive.outcome.is_some() {
            return false;
        }
        drive.learn_place(self.cycle_s);
        let is_there = drive.arrival == Arrival::Passing && drive.is_near_goal();
        if is_there || drive.cycles >= drive.last_cycle {
            drive.end(if is_there { Outcome::Reached } else { Outcome::Timeout }, self.cycle_s);
            return false;
        }
        for sensor in 0..self.drives[index].sensors.len() {
            self.scan_with(index, sensor);
        }
        self.drives[index].learn_scans();
        true
    }

    /// Takes the exact scan of a sensor, if it scans in this cycle.
    fn scan_with(&mut self, index: usize, sensor: usize) {
        let cycle = self.drives[index].cycles;
        let scanning = &mut self.drives[index].sensors[sensor];
        if !scanning.sensing.scans_in(cycle) {
            return;
        }
        let mut scan = std::mem::take(&mut scanning.scan);
        let drive = &self.drives[index];
        let Sensor { beams, sensing, .. } = &drive.sensors[sensor];
        let mut glimpses = sensing.glimpses(cycle);
        let world = self.world.at(drive.time_s(self.cycle_s));
        let others = self.others(index).map(|other| (&other.robot.footprint, other.pose));
        world.cast_among(drive.pose, beams, others, &mut glimpses, &mut scan);
        self.drives[index].sensors[sensor].scan = scan;
    }

    /// Last scan of a robot's first sensor.
    pub(super) fn scan(&self, index: usize) -> &Scan {
        &self.drives[index].sensors[0].scan
    }

    /// Scans that a robot's controller gets in this cycle.
    pub(super) fn scans(&self, index: usize) -> Vec<SensorScan<'_>> {
        self.drives[index].scans()
    }

    /// The world at the end of the last cycle.
    pub(super) fn world(&self) -> WorldAt<'_> {
        self.world.at(self.cycle as f64 * self.cycle_s)
    }

    /// State that was last reported to a robot, at the beginning of a cycle.
    pub(super) fn told(&self, index: usize) -> RobotState {
        self.drives[index].told
    }

    /// Number of the cycle that a robot begins.
    pub(super) fn cycle(&self, index: usize) -> u64 {
        self.drives[index].cycles
    }

    /// Tests a robot's arrival and progress after its controller's decision; true if the run
    /// continues.
    pub(super) fn goes_on(&mut self, index: usize, control: &Control) -> bool {
        let drive = &mut self.drives[index];
        if control.action == Action::Arrived && drive.is_at_rest() && drive.is_near_goal() {
            drive.end(Outcome::Reached, self.cycle_s);
            return false;
        }
        let is_stuck = drive.progress.is_stuck(control, drive.cycles);
        if is_stuck {
            drive.end(Outcome::Stuck, self.cycle_s);
        }
        !is_stuck
    }

    /// Sets a robot's command for the next cycle.
    pub(super) fn command(&mut self, index: usize, command: Velocity) {
        let drive = &mut self.drives[index];
        let Drive { robot, pose, velocity, actuation, .. } = drive;
        let (pose, velocity, limits) = (*pose, *velocity, &robot.limits);
        drive.motion = if let Some(actuation) = actuation {
            actuation.motion(pose, velocity, command, limits)
        } else {
            let reached = limits.reached(velocity, command, self.cycle_s);
            CycleMotion::new(pose, velocity, reached, self.cycle_s)
        };
    }

    /// Drives one cycle of all robots at the same time. Contacts are handled in the order in
    /// which they occur, because a robot that has touched something is an obstacle for the others
    /// from then on.
    pub(super) fn drive_cycle(&mut self) {
        let end_s = (self.cycle + 1) as f64 * self.cycle_s;
        let robots: Vec<Body> = self.drives.iter().map(Drive::body).collect();
        GivingWay::advance_all(&mut self.giving_way, &mut self.world, &robots, self.cycle_s, end_s);
        while let Some(Contact { place, robot, with }) = self.first_contact() {
            self.drives[robot].touch(place, with);
            if let Touched::Robot(other) = with {
                self.drives[other].touch(place, Touched::Robot(robot));
            }
        }
        for index in 0..self.drives.len() {
            self.drives[index].least = self.least_clearances(index);
        }
        for drive in self.drives.iter_mut().filter(|drive| drive.outcome.is_none()) {
            drive.advance(&self.world, self.cycle_s);
        }
        self.cycle += 1;
    }

    /// Outcome of a robot's run, if it has ended.
    pub(super) fn outcome(&self, index: usize) -> Option<Outcome> {
        self.drives[index].outcome
    }

    /// A robot's true pose and velocity.
    pub(super) fn state(&self, index: usize) -> RobotState {
        let Drive { pose, velocity, .. } = self.drives[index];
        RobotState { stamp_s: self.drives[index].time_s(self.cycle_s), pose, velocity }
    }

    /// Runs of all robots, which have all ended.
    pub(super) fn into_runs(self) -> Vec<Run> {
        let ways = GivingWay::ways(&self.giving_way, &self.world);
        self.drives.into_iter().filter_map(|drive| drive.into_run(&ways)).collect()
    }

    /// Measures clearances and contacts before anything moves.
    fn measure_starts(&mut self) {
        for index in 0..self.drives.len() {
            let (least, touched) = self.clearances_at_start(index);
            self.drives[index].least = least;
            if let Some(with) = touched {
                self.drives[index].collide(0.0, with, &self.world.at(0.0), self.cycle_s);
            }
        }
    }

    /// Distances from a robot to everything else, and the object it touches. Ties go to static
    /// obstacles, then moving obstacles, then robots, and to the lowest index.
    fn clearances_at_start(&self, index: usize) -> (Clearances, Option<Touched>) {
        let Drive { ref robot, pose, .. } = self.drives[index];
        let footprint = &robot.footprint;
        let border_m = self.world.border_distance(footprint, pose);
        let standing_m = self.world.distance_to_standing(footprint, pose, 0.0, f64::INFINITY);
        let world = self.world.at(0.0);
        let (movers_m, mover) = world.distance_to_movers(footprint, pose, f64::INFINITY);
        let (mut robots_m, mut nearest_robot) = (f64::INFINITY, None);
        for (other, Drive { robot, pose: at, .. }) in self.drives.iter().enumerate() {
            if other != index {
                let other_footprint = &robot.footprint;
                let gap_m = footprint.distance_to_footprint_m(pose, other_footprint, *at, robots_m);
                if gap_m < robots_m {
                    (robots_m, nearest_robot) = (gap_m, Some(other));
                }
            }
        }
        let touched = if border_m.min(standing_m) <= 0.0 {
            Some(Touched::Standing { appeared: false })
        } else if movers_m <= 0.0 {
            mover.map(|index| {
                let speed_mps = self.world.movers()[index].speed_mps(0.0);
                Touched::Mover { index, jumped_onto: false, speed_mps }
            })
        } else {
            nearest_robot.filter(|_| robots_m <= 0.0).map(Touched::Robot)
        };
        (Clearances { standing_m, movers_m, robots_m }, touched)
    }

    /// The first contact that has not been handled yet. Ties go to static obstacles, then moving
    /// obstacles, then robots, and to the lowest indices.
    fn first_contact(&self) -> Option<Contact> {
        let standing = (0..self.drives.len()).filter_map(|robot| self.contact_with_standing(robot));
        let mut first = standing.min_by(|a, b| a.place.total_cmp(&b.place));
        // Search only up to the first known contact. Until then robots are on the map, so two
        // robots with speeds that overflow are not followed forever.
        let until = |first: &Option<Contact>| {
            first.as_ref().map_or(CycleMotion::END, |contact| contact.place)
        };
        for robot in 0..self.drives.len() {
            for mover in 0..self.world.movers().len() {
                first = self.contact_with_mover(robot, mover, until(&first)).or(first);
            }
        }
        for robot in 0..self.drives.len() {
            for with in robot + 1..self.drives.len() {
                first = self.contact_of(robot, with, until(&first)).or(first);
            }
        }
        first
    }

    fn contact_with_standing(&self, robot: usize) -> Option<Contact> {
        let drive = &self.drives[robot];
        if !drive.is_moving() {
            return None;
        }
        let now_s = drive.time_s(self.cycle_s);
        let times_s = [now_s - self.cycle_s, now_s];
        let (footprint, pose) = (&drive.robot.footprint, drive.motion.pose(0.0));
        if self.world.appears_onto(footprint, pose, times_s) {
            return Some(Contact { place: 0.0, robot, with: Touched::Standing { appeared: true } });
        }
        let place = drive.sweep(&self.world, self.cycle_s).first_contact(CycleMotion::END)?;
        Some(Contact { place, robot, with: Touched::Standing { appeared: false } })
    }

    fn contact_with_mover(&self, robot: usize, mover: usize, until: f64) -> Option<Contact> {
        let drive = &self.drives[robot];
        if !drive.is_moving() {
            return None;
        }
        let sweep = drive.beside(&self.world.movers()[mover], self.cycle_s);
        let place = sweep.first_contact(until)?;
        let (jumped_onto, speed_mps) = (sweep.jumped_before(place), sweep.mover_speed_mps(place));
        let with = Touched::Mover { index: mover, jumped_onto, speed_mps };
        Some(Contact { place, robot, with })
    }

    fn contact_of(&self, robot: usize, other: usize, until: f64) -> Option<Contact> {
        let (one, two) = (&self.drives[robot], &self.drives[other]);
        if !(one.is_moving() || two.is_moving()) {
            return None;
        }
        let place = one.pair(two).first_contact(until)?;
        Some(Contact { place, robot, with: Touched::Robot(other) })
    }

    /// Smallest clearances of a robot's run up to the end of the cycle.
    fn least_clearances(&self, index: usize) -> Clearances {
        let drive = &self.drives[index];
        let least = drive.least;
        if drive.outcome.is_some() {
            return least;
        }
        let until = drive.motion.stop();
        // The clearance stays infinite if there is never an obstacle of the kind.
        let anything = least.standing_m.is_finite() || !self.world.elusive().is_empty();
        let standing_m = if anything {
            drive.sweep(&self.world, self.cycle_s).least_clearance(until, least.standing_m)
        } else {
            least.standing_m
        };
        let beside =
            |known_m, mover| drive.beside(mover, self.cycle_s).least_clearance(until, known_m);
        let movers_m = self.world.movers().iter().fold(least.movers_m, beside);
        let nearer = |known_m, other| drive.pair(other).least_clearance(until, known_m);
        let robots_m = self.others(index).fold(least.robots_m, nearer);
        Clearances { standing_m, movers_m, robots_m }
    }

    /// All robots except one.
    fn others(&self, index: usize) -> impl Iterator<Item = &Drive<'a>> {
        let (before, from) = self.drives.split_at(index);
        before.iter().chain(&from[1..])
    }
}
