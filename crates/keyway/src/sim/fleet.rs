//! All robots of a simulation, cycle by cycle.

use super::motion::CycleMotion;
use super::participant::{Action, Control, Participant};
use super::rules::{Arrival, Progress, cycles_within};
use super::sweep::{Moving, PairSweep, Sweep, WorldSweep};
use super::{Obstacle, Outcome, Run, RunRules, Sample, World};
use crate::geometry::{Point, Pose, Velocity};
use crate::robot::Robot;
use crate::sense::Scan;

/// Robots that drive in a world at the same time. Between two cycles each has decided, or its run has
/// ended and it stands.
pub(super) struct Fleet<'a> {
    world: &'a World,
    cycle_s: f64,
    goal_tolerance_m: f64,
    arrival: Arrival,
    last_cycle: u64,
    drives: Vec<Drive<'a>>,
}

/// A run under way, or ended.
struct Drive<'a> {
    robot: &'a Robot,
    goal: Point,
    pose: Pose,
    velocity: Velocity,
    cycles: u64,
    length_m: f64,
    /// Infinite when there is nothing to keep clear of.
    min_clearance_m: f64,
    samples: Vec<Sample>,
    progress: Progress,
    /// In the present cycle.
    motion: CycleMotion,
    /// What was touched in the present cycle.
    touched: Option<Touched>,
    outcome: Option<Outcome>,
}

/// What a robot touched.
#[derive(Clone, Copy)]
enum Touched {
    /// Something of the world: the nearest.
    World,
    /// The robot of this index.
    Robot(usize),
}

/// Who touches what, and where on the motion of a cycle.
struct Contact {
    place: f64,
    robot: usize,
    with: Touched,
}

impl<'a> Fleet<'a> {
    /// All robots at rest at their starts; those in contact have ended.
    pub(super) fn new<'p: 'a>(
        world: &'a World,
        participants: &[Participant<'p>],
        rules: &RunRules,
        cycle_s: f64,
    ) -> Self {
        let drive = |participant| Drive::new(participant, Progress::new(rules, cycle_s), cycle_s);
        let mut fleet = Self {
            world,
            cycle_s,
            goal_tolerance_m: rules.goal_tolerance_m,
            arrival: rules.arrival,
            last_cycle: cycles_within(rules.time_limit_s, cycle_s),
            drives: participants.iter().map(drive).collect(),
        };
        fleet.measure_starts();
        fleet
    }

    /// Whether any run has not ended.
    pub(super) fn is_driving(&self) -> bool {
        self.drives.iter().any(|drive| drive.outcome.is_none())
    }

    /// The scan for a robot's next decision, unless its run has ended or ends now.
    pub(super) fn scan(&mut self, index: usize) -> Option<Scan> {
        let drive = &mut self.drives[index];
        if drive.outcome.is_some() {
            return None;
        }
        let is_there =
            self.arrival == Arrival::Passing && drive.is_near_goal(self.goal_tolerance_m);
        if is_there || drive.cycles >= self.last_cycle {
            drive.end(if is_there { Outcome::Reached } else { Outcome::Timeout }, self.cycle_s);
            return None;
        }
        let drive = &self.drives[index];
        let world = self.world.at(drive.time_s(self.cycle_s));
        let others = self.others(index).map(|other| (&other.robot.footprint, other.pose));
        Some(world.cast_among(drive.pose, &drive.robot.sensor, others))
    }

    /// State of a robot at the beginning of the cycle, and the number of the cycle.
    pub(super) fn state(&self, index: usize) -> (Pose, Velocity, u64) {
        let Drive { pose, velocity, cycles, .. } = self.drives[index];
        (pose, velocity, cycles)
    }

    /// Tests a robot's arrival and progress by its controller's answer; true when the run goes on.
    pub(super) fn goes_on(&mut self, index: usize, control: &Control) -> bool {
        let drive = &mut self.drives[index];
        let is_standing = drive.velocity == Velocity::ZERO;
        if control.action == Action::Arrived
            && is_standing
            && drive.is_near_goal(self.goal_tolerance_m)
        {
            drive.end(Outcome::Reached, self.cycle_s);
            return false;
        }
        let is_stuck = drive.progress.is_stuck(control, drive.cycles);
        if is_stuck {
            drive.end(Outcome::Stuck, self.cycle_s);
        }
        !is_stuck
    }

    /// A robot's command for the next cycle.
    pub(super) fn command(&mut self, index: usize, command: Velocity) {
        let drive = &mut self.drives[index];
        let reached = drive.robot.limits.reached(drive.velocity, command, self.cycle_s);
        drive.motion = CycleMotion::new(drive.pose, drive.velocity, reached, self.cycle_s);
    }

    /// One cycle of all robots at the same time. Contacts are taken in the order in which they happen,
    /// because who has touched something stands from then on, in the way of the others.
    pub(super) fn drive_cycle(&mut self) {
        while let Some(Contact { place, robot, with }) = self.first_contact() {
            self.drives[robot].touch(place, with);
            if let Touched::Robot(other) = with {
                self.drives[other].touch(place, Touched::Robot(robot));
            }
        }
        for index in 0..self.drives.len() {
            self.drives[index].min_clearance_m = self.least_clearance(index);
        }
        for drive in self.drives.iter_mut().filter(|drive| drive.outcome.is_none()) {
            drive.advance(self.world, self.cycle_s);
        }
    }

    /// What happened to each robot; all of them have ended.
    pub(super) fn into_runs(self) -> Vec<Run> {
        self.drives.into_iter().filter_map(Drive::into_run).collect()
    }

    /// Clearances and contacts before anything moves.
    fn measure_starts(&mut self) {
        for index in 0..self.drives.len() {
            let (min_clearance_m, nearest) = self.nearest_at_start(index);
            let Drive { robot, pose, .. } = self.drives[index];
            let border_m = self.world.at(0.0).border_distance(&robot.footprint, pose);
            let drive = &mut self.drives[index];
            drive.min_clearance_m = min_clearance_m;
            if border_m.min(min_clearance_m) <= 0.0 {
                let with = if border_m <= 0.0 { Touched::World } else { nearest };
                drive.collide(0.0, with, self.world, self.cycle_s);
            }
        }
    }

    /// Distance from a robot to the nearest obstacle or other robot (ties: the obstacle, then the lowest
    /// index).
    fn nearest_at_start(&self, index: usize) -> (f64, Touched) {
        let Drive { robot: Robot { footprint, .. }, pose, .. } = self.drives[index];
        let obstacle_m = self.world.at(0.0).distance(footprint, pose, f64::INFINITY);
        let others = self.drives.iter().enumerate().filter(|(other, _)| *other != index);
        let gaps = others.map(|(other, Drive { robot, pose: at, .. })| {
            let gap_m =
                footprint.distance_to_footprint_m(pose, &robot.footprint, *at, f64::INFINITY);
            (gap_m, Touched::Robot(other))
        });
        let nearer = |best: (f64, Touched), next: (f64, Touched)| {
            if next.0 < best.0 { next } else { best }
        };
        gaps.fold((obstacle_m, Touched::World), nearer)
    }

    /// The first contact that has not been taken yet (ties: with the world, then the lowest indices).
    fn first_contact(&self) -> Option<Contact> {
        let with_world = (0..self.drives.len()).filter_map(|robot| self.contact_with_world(robot));
        let mut first = with_world.min_by(|a, b| a.place.total_cmp(&b.place));
        for robot in 0..self.drives.len() {
            for with in robot + 1..self.drives.len() {
                // Only up to what is known to happen first. Until then both are on the map, so two robots
                // faster than any number holds are not followed for ever.
                let until = first.as_ref().map_or(CycleMotion::END, |contact| contact.place);
                first = self.contact_of(robot, with, until).or(first);
            }
        }
        first
    }

    fn contact_with_world(&self, robot: usize) -> Option<Contact> {
        let drive = &self.drives[robot];
        if !drive.is_moving() {
            return None;
        }
        let place = drive.sweep(self.world, self.cycle_s).first_contact(CycleMotion::END)?;
        Some(Contact { place, robot, with: Touched::World })
    }

    fn contact_of(&self, robot: usize, other: usize, until: f64) -> Option<Contact> {
        let (one, two) = (&self.drives[robot], &self.drives[other]);
        if !(one.is_moving() || two.is_moving()) {
            return None;
        }
        let place = one.pair(two).first_contact(until)?;
        Some(Contact { place, robot, with: Touched::Robot(other) })
    }

    /// The smallest clearance of a robot's run up to the end of the cycle.
    fn least_clearance(&self, index: usize) -> f64 {
        let drive = &self.drives[index];
        if drive.outcome.is_some() || drive.min_clearance_m.is_infinite() {
            return drive.min_clearance_m;
        }
        let until = drive.motion.stop();
        let sweep = drive.sweep(self.world, self.cycle_s);
        let to_world = sweep.least_clearance(until, drive.min_clearance_m);
        let nearer = |known_m, other| drive.pair(other).least_clearance(until, known_m);
        self.others(index).fold(to_world, nearer)
    }

    /// All robots except one.
    fn others(&self, index: usize) -> impl Iterator<Item = &Drive<'a>> {
        let (before, from) = self.drives.split_at(index);
        before.iter().chain(&from[1..])
    }
}

impl<'a> Drive<'a> {
    fn new<'p: 'a>(participant: &Participant<'p>, progress: Progress, cycle_s: f64) -> Self {
        let Participant { robot, start: pose, goal, .. } = *participant;
        let velocity = Velocity::ZERO;
        Self {
            robot,
            goal,
            pose,
            velocity,
            cycles: 0,
            length_m: 0.0,
            min_clearance_m: f64::INFINITY,
            samples: vec![Sample { t_s: 0.0, pose, velocity }],
            progress,
            motion: CycleMotion::standing(pose, cycle_s),
            touched: None,
            outcome: None,
        }
    }

    /// Time at the beginning of the next cycle \[s\].
    fn time_s(&self, cycle_s: f64) -> f64 {
        self.cycles as f64 * cycle_s
    }

    fn is_near_goal(&self, tolerance_m: f64) -> bool {
        self.pose.point().distance(self.goal) <= tolerance_m
    }

    /// Whether the robot has neither ended nor touched anything.
    const fn is_moving(&self) -> bool {
        self.outcome.is_none() && self.touched.is_none()
    }

    fn moving(&self) -> Moving<'_> {
        Moving { footprint: &self.robot.footprint, motion: &self.motion }
    }

    fn sweep<'s>(&'s self, world: &'s World, cycle_s: f64) -> WorldSweep<'s> {
        WorldSweep { world, robot: self.moving(), start_s: self.time_s(cycle_s) }
    }

    fn pair<'s>(&'s self, other: &'s Self) -> PairSweep<'s> {
        PairSweep { robots: [self.moving(), other.moving()] }
    }

    /// A contact in the present cycle, unless the robot stood already.
    fn touch(&mut self, place: f64, with: Touched) {
        if self.is_moving() {
            self.touched = Some(with);
            self.motion.stop_at(place);
        }
    }

    /// To the end of the cycle, or to the contact.
    fn advance(&mut self, world: &World, cycle_s: f64) {
        let end = self.motion.stop();
        self.pose = self.motion.pose(end);
        self.velocity = self.motion.velocity(end);
        self.length_m += self.motion.driven_m(end);
        let t_s = (self.cycles as f64 + end / CycleMotion::END) * cycle_s;
        self.cycles += 1;
        self.samples.push(Sample { t_s, pose: self.pose, velocity: self.velocity });
        if let Some(with) = self.touched {
            self.collide(t_s, with, world, cycle_s);
        }
    }

    fn collide(&mut self, t_s: f64, with: Touched, world: &World, cycle_s: f64) {
        let with = match with {
            Touched::World => world.at(t_s).nearest(&self.robot.footprint, self.pose),
            Touched::Robot(index) => Obstacle::Robot(index),
        };
        if with != Obstacle::Border {
            self.min_clearance_m = 0.0;
        }
        self.end(Outcome::Collided { pose: self.pose, with }, cycle_s);
    }

    /// Ends the run: from now on the robot stands.
    fn end(&mut self, outcome: Outcome, cycle_s: f64) {
        self.outcome = Some(outcome);
        self.motion = CycleMotion::standing(self.pose, cycle_s);
    }

    fn into_run(self) -> Option<Run> {
        Some(Run {
            outcome: self.outcome?,
            samples: self.samples,
            length_m: self.length_m,
            min_clearance_m: self.min_clearance_m.is_finite().then_some(self.min_clearance_m),
            cycles: self.cycles,
        })
    }
}
