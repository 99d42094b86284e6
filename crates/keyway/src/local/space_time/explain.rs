//! Explains the choice of a trajectory: the best one for each beginning that was tried, and the
//! changes that would free a robot that cannot drive.
//!
//! The first candidate is the chosen trajectory, as a decision finds it. Each other one is the
//! best trajectory that begins with one of the other velocities that the search tries first; it
//! is not polished. Candidates are identified by their commands. As each is searched for alone,
//! one may be better than the result of a decision; the runner-up is the best of those that are
//! not.
//!
//! # Errors / cost
//! None. About 30 decisions; if none drives, up to 40 times as many.

use super::commitment::go_on;
use super::course::{Cost, Judge, State};
use super::polish::Total;
use super::search::Beam;
use super::targets::Targets;
use super::{Around, CONTACT, RULES, STOP_RULE, SpaceTime, SpaceTimeConfig, shares};
use crate::geometry::{Pose, Velocity};
use crate::local::remedies::{self, Remediable};
use crate::local::{
    Course, DriveMemory, Explanation, Fate, JudgedCandidate, LocalPlanner, Scene, Scratch,
};
use crate::robot::Robot;
use std::borrow::Cow;

/// Number of poses of a candidate.
const POSES: u32 = 10;

/// Number of ramps between two of them.
const RAMPS: u32 = 8;

/// Resolution of the time of a contact, in parts of a stretch.
const CONTACT_PARTS: u32 = 50;

/// Velocities no farther apart than this are the same \[m/s, rad/s\].
const SAME: f64 = 1e-6;

/// The planner of a robot with its progress along the route.
struct OnItsWay {
    planner: SpaceTime,
    memory: DriveMemory,
}

/// One cycle, evaluated again.
struct Cycle<'a> {
    planner: &'a SpaceTime,
    scene: &'a Scene<'a>,
    start: &'a State,
    judge: &'a Judge<'a>,
}

impl SpaceTime {
    /// The fate of each beginning of a trajectory.
    pub(super) fn explained(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Explanation {
        let mut explanation = self.candidates(scene, memory);
        if !self.drives_on(scene, &mut memory.clone()) {
            let memory = DriveMemory { covered_m: memory.covered_m, ..DriveMemory::default() };
            explanation.remedies = remedies::of(&OnItsWay { planner: self.clone(), memory }, scene);
        }
        explanation
    }

    /// True if some candidate drives.
    fn drives_on(&self, scene: &Scene<'_>, memory: &mut DriveMemory) -> bool {
        let decided = self.decide(scene, memory, &mut Scratch::default());
        let evaluation = decided.map_or_else(|why| why.evaluation, |decision| decision.evaluation);
        evaluation.driving > 0
    }

    fn candidates(&self, scene: &Scene<'_>, memory: &DriveMemory) -> Explanation {
        let (mut around, mut scratch, mut beam) =
            (Around::default(), Scratch::default(), Beam::default());
        let position = scene.pose.point();
        let covered_m = scene.path.nearest_along(position, memory.covered_m, self.reach_m());
        let beyond_m = self.look(&mut around, scene, covered_m);
        let meeting = self.meeting(&around);
        let (start, judge) = self.judge(scene, &around, (&meeting, memory.course()), beyond_m);
        let cycle = Cycle { planner: self, scene, start: &start, judge: &judge };
        let mut rest = Vec::new();
        let extent = (self.config.stretches, self.robot.cycle_s);
        go_on(&mut rest, memory.course(), &start, &judge, extent);
        self.search(scene, (&start, &judge), (&mut beam, &mut rest), &mut scratch);
        let mut explanation = Explanation::default();
        explanation.candidates.extend(cycle.course(&beam.best));
        explanation.chosen = explanation.best(|_, _| true);
        let lowest_mps = self.extent(scene, &judge).lowest_mps;
        let targets = Targets::of(&start, &judge, lowest_mps, true);
        let chosen = explanation.chosen().map(|one| one.velocity);
        let is_chosen = |velocity: Velocity| {
            chosen.is_some_and(|it| {
                (it.v - velocity.v).abs().max((it.omega - velocity.omega).abs()) < SAME
            })
        };
        let beginnings =
            targets.velocities().map(|to| cycle.beginning(to, &mut beam, &mut scratch));
        let others = beginnings.filter(|one| !is_chosen(one.velocity));
        explanation.candidates.extend(others);
        let score = explanation.chosen.and_then(|one| explanation.candidates[one].score());
        let is_second = |place: usize, its: f64| {
            Some(place) != explanation.chosen && score.is_some_and(|score| its <= score)
        };
        explanation.runner_up = explanation.best(is_second);
        explanation
    }
}

impl Cycle<'_> {
    /// The best trajectory that begins with a stretch to this velocity.
    fn beginning(&self, to: Velocity, beam: &mut Beam, scratch: &mut Scratch) -> JudgedCandidate {
        if self.judge.drive(self.start, &Cost::default(), to).is_none() {
            let free_for_s = self.free_for_s(to);
            return self.refused(to, CONTACT, Some(free_for_s));
        }
        if !self.planner.passes(self.scene, to, self.judge, scratch) {
            return self.refused(to, STOP_RULE, None);
        }
        let extent = self.planner.extent(self.scene, self.judge);
        beam.search(*self.start, self.judge, &extent, |first| first == to);
        self.course(&beam.best).unwrap_or_else(|| self.refused(to, STOP_RULE, None))
    }

    fn course(&self, course: &[Velocity]) -> Option<JudgedCandidate> {
        let shares = shares(&Total::of(self.start, course, self.judge)?);
        let velocity = self.command(*course.first()?);
        let duration_s = self.judge.stretch_s * course.len() as f64;
        let poses = self.poses(course, duration_s);
        let score = shares.total();
        Some(JudgedCandidate { velocity, fate: Fate::Admissible { shares, score }, poses })
    }

    fn refused(
        &self,
        to: Velocity,
        rule: &'static str,
        free_for_s: Option<f64>,
    ) -> JudgedCandidate {
        let because = RULES.iter().find(|(name, _)| *name == rule).map_or("", |(_, why)| *why);
        let fate = Fate::Refused {
            rule: Cow::Borrowed(rule),
            because: Cow::Borrowed(because),
            free_for_s,
        };
        let poses = self.poses(&[to], free_for_s.unwrap_or(self.judge.stretch_s));
        JudgedCandidate { velocity: self.command(to), fate, poses }
    }

    fn command(&self, first: Velocity) -> Velocity {
        self.planner.command(self.scene, first, self.judge)
    }

    /// Time for which a stretch with a contact is free.
    fn free_for_s(&self, to: Velocity) -> f64 {
        let part = |parts: u32| f64::from(parts) / f64::from(CONTACT_PARTS);
        let is_free = |parts: &u32| {
            let stretch_s = part(*parts) * self.judge.stretch_s;
            let judge = Judge { stretch_s, ..*self.judge };
            let to = self.start.velocity.lerp(to, part(*parts));
            judge.drive(self.start, &Cost::default(), to).is_some()
        };
        let free = (1..CONTACT_PARTS).take_while(is_free).count() as u32;
        part(free) * self.judge.stretch_s
    }

    /// Poses at equal intervals over a duration.
    fn poses(&self, course: &[Velocity], duration_s: f64) -> Vec<Pose> {
        let velocities = course.iter().copied().take(Course::MOST_STRETCHES).collect();
        let course = Course { stretch_s: self.judge.stretch_s, velocities };
        let (first, mut pose) = (self.start.velocity, self.scene.pose);
        let ramp_s = duration_s / f64::from(POSES * RAMPS);
        let mut poses = Vec::new();
        for ramp in 0..POSES * RAMPS {
            let at = |ramps: u32| course.velocity(first, ramp_s * f64::from(ramps));
            pose = pose.after_ramp(at(ramp), at(ramp + 1), ramp_s);
            if (ramp + 1) % RAMPS == 0 {
                poses.push(pose);
            }
        }
        poses
    }
}

impl OnItsWay {
    fn with(&self, config: SpaceTimeConfig, robot: Robot) -> Option<Self> {
        let planner = SpaceTime::new(config, robot).ok()?;
        Some(Self { planner, memory: self.memory.clone() })
    }
}

impl Remediable for OnItsWay {
    fn robot(&self) -> &Robot {
        &self.planner.robot
    }

    fn drives(&self, scene: &Scene<'_>) -> bool {
        self.planner.drives_on(scene, &mut self.memory.clone())
    }

    fn for_other(&self, robot: Robot) -> Option<Self> {
        self.with(self.planner.config.clone(), robot)
    }

    fn backs_up(&self) -> bool {
        self.planner.config.backwards
    }

    fn backing_up(&self, robot: Robot) -> Option<Self> {
        self.with(SpaceTimeConfig { backwards: true, ..self.planner.config.clone() }, robot)
    }
}
