//! The robot between messages and commands: what came in is observed by the navigator, and in every
//! cycle it says what to do. It knows no network and reads no clock.

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

/// A robot that drives by messages.
pub(crate) struct Pilot {
    settings: Settings,
    pub(crate) transforms: Transforms,
    pub(crate) sensing: Sensing,
    /// Nothing can be done before there is a map.
    navigator: Option<Navigator>,
    errand: Option<Errand>,
    /// Ground to keep out of, and to be slow on.
    masks: Masks,
    /// Pose in the map, when it was last known.
    pose: Option<Pose>,
    /// The speed that is not to be exceeded, whatever the errand \[m/s\].
    limit_mps: Option<f64>,
    /// It may drive.
    is_active: bool,
}

/// The result of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) command: Velocity,
    /// The errand has ended in this cycle, having come so far.
    pub(crate) ended: Option<(Ended, Report)>,
    /// The reason, if it stands in doubt.
    pub(crate) waits: Option<Waits>,
}

/// The state of an errand.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Report {
    /// Pose in the map.
    pub(crate) pose: Pose,
    /// Since the errand began \[s\].
    pub(crate) under_way_s: f64,
    /// The rest of the way \[m\].
    pub(crate) way_m: f64,
    /// The rest of the time \[s\], at the present speed; 0 when the robot stands.
    pub(crate) left_s: f64,
    pub(crate) speed_mps: f64,
    pub(crate) recoveries: u32,
    /// Poses to which it drives, and those of them that were passed.
    pub(crate) poses: usize,
    pub(crate) passed: usize,
    pub(crate) made: Made,
}

/// The reason why it does not drive when it is not active.
const INACTIVE: &str = "the node is not active: its lifecycle was ended";

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

    /// The clock begins anew, such as that of a simulation.
    pub(crate) fn restart_clock(&mut self) {
        self.transforms.restart_clock();
        self.sensing.restart_clock();
        self.pose = None;
        if let Some(navigator) = &mut self.navigator {
            navigator.restart_clock();
        }
    }

    /// True if it may drive, and has a map to drive on.
    pub(crate) const fn is_active(&self) -> bool {
        self.is_active && self.navigator.is_some()
    }

    /// Lets the robot drive, or not: what it was asked for is then given up in the next cycle.
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

    /// Makes a change of its settings.
    pub(crate) fn change(&mut self, change: &Change) {
        self.settings.change(change);
        self.sensing.points_taken = self.settings.points_taken.clone();
    }

    /// True while it has something to do.
    pub(crate) const fn drives(&self) -> bool {
        self.errand.is_some()
    }

    /// The pose in the map, when it was last known.
    pub(crate) const fn pose(&self) -> Option<Pose> {
        self.pose
    }

    /// The state of the errand; `None` without one, or where nobody has said where the robot is.
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

    /// Recoveries so far, whatever the errand.
    fn recoveries(&self) -> u32 {
        self.navigator.as_ref().map_or(0, |navigator| navigator.recoveries().total())
    }

    /// The next command, at a time \[s\]. In doubt of where it is the robot stands.
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

    /// The reason, if the robot stands because it sees nothing.
    fn blindness(&self, step: &Step) -> Option<Waits> {
        let why = step.why().filter(|why| matches!(why, Blocked::SensorSilent { .. }))?;
        let topics = self.settings.scan_topics.join(", ");
        Some(Waits::Blind { why: why.to_string(), topics })
    }

    /// The command of a robot that stands, whatever the navigator would do.
    fn stand(&mut self, now_s: f64) -> Velocity {
        if let Some(navigator) = &mut self.navigator {
            navigator.note_override(now_s, Velocity::ZERO);
        }
        Velocity::ZERO
    }

    /// Observes what has come.
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

    /// The end of the errand, if the robot has stood in doubt for too long.
    fn end_of_doubt(&mut self, why: &Waits, now_s: f64) -> Option<(Ended, Report)> {
        let ended = self.errand.as_mut()?.stand(why, now_s)?;
        Some((ended, self.report(now_s).unwrap_or_default()))
    }

    /// The end of the errand, if this step is the last one.
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
