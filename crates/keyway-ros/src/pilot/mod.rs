//! The robot between messages and commands: the navigator observes the received messages and
//! returns a command in every cycle. This module knows no network and reads no clock.

mod clouds;
mod codes;
mod errand;
mod goals;
mod maps;
mod masks;
mod sensing;
mod views;
mod waits;

pub(crate) use codes::{Ended, Family, Fault};
pub(crate) use errand::{Act, Made, Missed, Motion, Wanted};
#[cfg(test)]
use maps::MapError;
pub(crate) use maps::UrlError;
pub(crate) use waits::Waits;

use crate::settings::{Change, Settings};
use crate::transforms::Transforms;
use errand::Errand;
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::{Blocked, Masks, Navigator, Step};
use sensing::Sensing;

/// A robot controlled by messages.
pub(crate) struct Pilot {
    settings: Settings,
    pub(crate) transforms: Transforms,
    pub(crate) sensing: Sensing,
    /// `None` before there is a map.
    navigator: Option<Navigator>,
    errand: Option<Errand>,
    /// Keep-out zones and speed limits.
    masks: Masks,
    /// Last known pose in the map.
    pose: Option<Pose>,
    /// Speed limit for all tasks \[m/s\].
    limit_mps: Option<f64>,
    /// True if the lifecycle state is active.
    is_active: bool,
}

/// The result of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) command: Velocity,
    /// The outcome and final report of a task that ended in this cycle.
    pub(crate) ended: Option<(Ended, Report)>,
    /// The missing input, if the robot waits for one.
    pub(crate) waits: Option<Waits>,
}

/// Progress report of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Report {
    /// Pose in the map.
    pub(crate) pose: Pose,
    /// Time since the start of the task \[s\].
    pub(crate) under_way_s: f64,
    /// Remaining distance \[m\].
    pub(crate) way_m: f64,
    /// Remaining time \[s\], at the current speed; 0 for a stationary robot.
    pub(crate) left_s: f64,
    pub(crate) speed_mps: f64,
    pub(crate) recoveries: u32,
    /// Number of goal poses, and of those already passed.
    pub(crate) poses: usize,
    pub(crate) passed: usize,
    pub(crate) made: Made,
}

/// Reason for not driving while inactive.
const INACTIVE: &str = "the node is inactive: a lifecycle request has stopped it";

impl Pilot {
    pub(crate) fn new(settings: Settings) -> Self {
        let sensing = Sensing::new(&settings);
        Self {
            settings,
            transforms: Transforms::default(),
            sensing,
            navigator: None,
            errand: None,
            masks: Masks::default(),
            pose: None,
            limit_mps: None,
            is_active: true,
        }
    }

    /// Restarts the clock, such as that of a simulation.
    pub(crate) fn restart_clock(&mut self) {
        self.transforms.restart_clock();
        self.sensing.restart_clock();
        self.pose = None;
        if let Some(navigator) = &mut self.navigator {
            navigator.restart_clock();
        }
    }

    /// True if it is active and has a map.
    pub(crate) const fn is_active(&self) -> bool {
        self.is_active && self.navigator.is_some()
    }

    /// Activates or deactivates the robot. On deactivation the task is aborted in the next cycle.
    pub(crate) const fn set_active(&mut self, is_active: bool) {
        self.is_active = is_active;
    }

    /// The navigator, once there is a map.
    pub(crate) const fn navigator(&self) -> Option<&Navigator> {
        self.navigator.as_ref()
    }

    pub(crate) const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Applies a parameter change.
    pub(crate) fn change(&mut self, change: &Change) {
        self.settings.change(change);
        self.sensing.points_taken = self.settings.points_taken.clone();
    }

    /// True while it has a task.
    pub(crate) const fn drives(&self) -> bool {
        self.errand.is_some()
    }

    /// Last known pose in the map.
    pub(crate) const fn pose(&self) -> Option<Pose> {
        self.pose
    }

    /// Progress of the task; `None` without a task, or if the pose is unknown.
    pub(crate) fn report(&self, now_s: f64) -> Option<Report> {
        const SLOW_MPS: f64 = 0.01;
        let (errand, pose) = (self.errand.as_ref()?, self.pose?);
        let navigator = self.navigator.as_ref()?;
        let way_m = navigator.guidance().map_or(0.0, |guidance| guidance.remaining_m);
        let speed_mps = self.sensing.velocity().map_or(0.0, |velocity| velocity.v);
        let is_slow = speed_mps.abs() <= SLOW_MPS;
        let driving_s = if is_slow { 0.0 } else { way_m / speed_mps.abs() };
        Some(Report {
            pose,
            under_way_s: errand.under_way_s(now_s),
            way_m,
            left_s: errand.until_s.map_or(driving_s, |until_s| until_s - now_s),
            speed_mps,
            recoveries: errand.recoveries(self.recoveries()),
            poses: errand.poses,
            passed: navigator.way_points_passed(),
            made: errand.made.clone(),
        })
    }

    /// Recoveries so far, over all tasks.
    fn recoveries(&self) -> u32 {
        self.navigator.as_ref().map_or(0, |navigator| navigator.recoveries().total())
    }

    /// Runs a cycle at a time \[s\] and returns its command. The robot stops if its pose is
    /// uncertain.
    pub(crate) fn cycle(&mut self, now_s: f64) -> Cycle {
        let step = self.look(now_s).map(|navigator| navigator.step_at(now_s));
        let (ended, waits) = match &step {
            _ if !self.is_active && self.errand.is_some() => {
                let report = self.report(now_s).unwrap_or_default();
                (Some((Ended::failed(Fault::Unknown, INACTIVE), report)), None)
            }
            Ok(step) => (self.end_of_errand(step, now_s), None),
            Err(waits) => (self.end_of_doubt(waits, now_s), Some(waits.clone())),
        };
        let waits = waits.or_else(|| self.blindness(step.as_ref().ok()?));
        let is_failed = matches!(ended, Some((Ended::Failed { .. }, _)));
        if is_failed {
            self.stop();
        }
        let command = match step {
            Ok(step) if !is_failed => step.command(),
            _ => self.stand(now_s),
        };
        Cycle { command, ended, waits }
    }

    /// The reason if the robot has stopped because its sensors are silent.
    fn blindness(&self, step: &Step) -> Option<Waits> {
        let why = step.why().filter(|why| matches!(why, Blocked::SensorSilent { .. }))?;
        let topics = self.settings.scan_topics.join(", ");
        Some(Waits::Blind { why: why.to_string(), topics })
    }

    /// The command of a stopped robot, overriding the navigator.
    fn stand(&mut self, now_s: f64) -> Velocity {
        if let Some(navigator) = &mut self.navigator {
            navigator.note_override(now_s, Velocity::ZERO);
        }
        Velocity::ZERO
    }

    /// Passes the received messages to the navigator.
    fn look(&mut self, now_s: f64) -> Result<&mut Navigator, Waits> {
        let Settings { frames, max_pose_age_s, .. } = &self.settings;
        let navigator = self.navigator.as_mut().ok_or(Waits::Map)?;
        let stamp_s = self.transforms.latest_s(&frames.map, &frames.base)?.min(now_s);
        let pose = self.transforms.at(&frames.map, &frames.base, stamp_s)?.on_ground();
        self.pose = Some(pose);
        let age_s = now_s - stamp_s;
        if age_s > *max_pose_age_s {
            return Err(Waits::NewPose { age_s });
        }
        let age = (now_s, *max_pose_age_s);
        self.sensing.observe(navigator, (stamp_s, pose), &self.transforms, age)?;
        Ok(navigator)
    }

    /// Outcome of the task if the robot has been waiting for inputs for too long.
    fn end_of_doubt(&mut self, why: &Waits, now_s: f64) -> Option<(Ended, Report)> {
        let ended = self.errand.as_mut()?.stand(why, now_s)?;
        Some((ended, self.report(now_s).unwrap_or_default()))
    }

    /// Outcome of the task if this step is the last one.
    fn end_of_errand(&mut self, step: &Step, now_s: f64) -> Option<(Ended, Report)> {
        let (navigator, errand) = (self.navigator.as_ref()?, self.errand.as_mut()?);
        errand.note(self.pose?);
        let ended = errand.end(navigator, step, now_s)?;
        let ended = self.next_stop(ended, now_s)?;
        let report = self.report(now_s).unwrap_or_default();
        self.errand = None;
        Some((ended, report))
    }
}

#[cfg(test)]
pub(crate) mod tests;
