//! Errands of the robot, and their ends.

use super::codes::{Ended, Fault};
use super::waits::Waits;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use keyway::geometry::{Pose, wrap_angle};
use keyway::navigate::{Blocked, Navigator, Step, WayLeft, WayProgress};

/// Something that the robot is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wanted {
    /// To drive to the last of these poses, by way of the others.
    Poses(Vec<PoseStamped>),
    /// To stop at each of these poses, from one on, and again at all of them so many times.
    Stops { poses: Vec<PoseStamped>, first: usize, again: usize },
    /// To drive along a path.
    Path(Path),
    /// A single motion.
    Act(Act),
    /// To stand for a time \[s\].
    Wait(f64),
}

/// A single motion, the time that it may take \[s\] (0: an hour), and the speed that is not to be
/// exceeded \[m/s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Act {
    pub(crate) motion: Motion,
    pub(crate) allowance_s: f64,
    pub(crate) most_mps: Option<f64>,
    /// The reason why it cannot be done by anybody.
    pub(crate) fault: Option<&'static str>,
}

impl Act {
    /// The time that it may take \[s\].
    pub(super) const fn allowed_s(&self) -> f64 {
        const HOUR_S: f64 = 3600.0;
        if self.allowance_s == 0.0 { HOUR_S } else { self.allowance_s }
    }
}

/// A motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// A turn on the spot, positive to the left \[rad\].
    Turn(f64),
    /// A drive ahead \[m\].
    Ahead(f64),
    /// A drive back \[m\].
    Back(f64),
}

/// An errand under way.
#[derive(Clone, Debug)]
pub(super) struct Errand {
    began_s: f64,
    progress: WayProgress,
    progressed_s: f64,
    /// Something has been in the way of a single motion since then \[s\].
    blocked_s: Option<f64>,
    /// The robot has stood in doubt since then \[s\].
    in_doubt_s: Option<f64>,
    /// It ends then \[s\].
    pub(super) until_s: Option<f64>,
    /// The stop to which it drives, if it has some, and those after it.
    pub(super) present_stop: Option<PoseStamped>,
    stops: Stops,
    /// A single motion has to end until then \[s\].
    pub(super) deadline_s: Option<f64>,
    /// The speed that a single motion may have \[m/s\].
    pub(super) most_mps: Option<f64>,
    /// Poses to which it drives.
    pub(super) poses: usize,
    /// Recoveries before it.
    recoveries: u32,
    pub(super) made: Made,
    last: Option<Pose>,
}

/// Stops, in their order.
#[derive(Clone, Debug, Default)]
struct Stops {
    poses: Vec<PoseStamped>,
    next: usize,
    /// So many times at all of them, once these are done.
    again: usize,
}

impl Iterator for Stops {
    type Item = PoseStamped;

    fn next(&mut self) -> Option<PoseStamped> {
        if self.next >= self.poses.len() && self.again > 0 {
            (self.next, self.again) = (0, self.again - 1);
        }
        let pose = self.poses.get(self.next)?.clone();
        self.next += 1;
        Some(pose)
    }
}

/// The part of an errand that is done.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Made {
    /// All turns, to either side \[rad\].
    pub(crate) turned_rad: f64,
    pub(crate) driven_m: f64,
    /// Index of the present stop.
    pub(crate) stop: usize,
    /// Stops that were not reached.
    pub(crate) missed: Vec<Missed>,
}

/// A stop that was not reached.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Missed {
    pub(crate) stop: usize,
    pub(crate) pose: PoseStamped,
    pub(crate) ended: Ended,
}

impl Errand {
    /// The longest time in which the robot may get no farther \[s\].
    const PATIENCE_S: f64 = 60.0;

    /// The longest time for which something may be in the way of a single motion \[s\].
    const BLOCKED_S: f64 = 1.0;

    /// One that begins at a time \[s\], after so many recoveries.
    pub(super) fn new(now_s: f64, recoveries: u32) -> Self {
        Self {
            began_s: now_s,
            progress: WayProgress::NEW,
            progressed_s: now_s,
            blocked_s: None,
            in_doubt_s: None,
            until_s: None,
            present_stop: None,
            stops: Stops::default(),
            deadline_s: None,
            most_mps: None,
            poses: 0,
            recoveries,
            made: Made::default(),
            last: None,
        }
    }

    /// Since it began \[s\].
    pub(super) fn under_way_s(&self, now_s: f64) -> f64 {
        now_s - self.began_s
    }

    /// Recoveries since it began, when there were so many in all.
    pub(super) const fn recoveries(&self, in_all: u32) -> u32 {
        in_all.saturating_sub(self.recoveries)
    }

    /// Will stop at poses, from one on, and again at all of them so many times.
    pub(super) fn stop_at(&mut self, poses: &[PoseStamped], first: usize, again: usize) {
        self.poses = poses.len();
        self.made.stop = first;
        self.stops = Stops { poses: poses.to_vec(), next: first, again };
    }

    /// The next stop, if one is left.
    pub(super) fn next_stop(&mut self) -> Option<PoseStamped> {
        self.stops.next()
    }

    /// The stop to which it has driven is missed. Of very many the last ones are not counted.
    pub(super) fn miss(&mut self, pose: PoseStamped, ended: Ended) {
        const MOST: usize = 1000;
        if self.made.missed.len() < MOST {
            self.made.missed.push(Missed { stop: self.made.stop, pose, ended });
        }
    }

    /// Goes on to the next stop.
    pub(super) fn leave_stop(&mut self, now_s: f64) {
        (self.progress, self.progressed_s) = (WayProgress::NEW, now_s);
        self.made.stop = (self.made.stop + 1) % self.poses.max(1);
    }

    /// The robot is here now.
    pub(super) fn note(&mut self, pose: Pose) {
        if let Some(before) = self.last.replace(pose) {
            self.made.turned_rad += wrap_angle(pose.theta - before.theta).abs();
            self.made.driven_m += pose.point().distance(before.point());
        }
    }

    /// Its end, if the robot has stood in doubt for too long.
    pub(super) fn stand(&mut self, why: &Waits, now_s: f64) -> Option<Ended> {
        let since_s = *self.in_doubt_s.get_or_insert(now_s);
        let is_over = now_s - since_s > Self::PATIENCE_S;
        is_over.then(|| Ended::failed(Fault::Transform, why.to_string()))
    }

    /// Its end, if this step is the last one.
    pub(super) fn end(&mut self, navigator: &Navigator, step: &Step, now_s: f64) -> Option<Ended> {
        self.in_doubt_s = None;
        if let Some(until_s) = self.until_s {
            return (now_s >= until_s).then_some(Ended::Succeeded);
        }
        // Nothing counts the time of a motion that cannot even begin, such as beside the map.
        if self.deadline_s.is_some_and(|deadline_s| now_s > deadline_s) {
            let why =
                step.why().map_or_else(|| Blocked::OutOfTime.to_string(), ToString::to_string);
            return Some(Ended::failed(Fault::Timeout, why));
        }
        match step {
            Step::Arrived => return Some(Ended::Succeeded),
            Step::Blocked { why: why @ Blocked::OutOfTime, .. } => {
                return Some(Ended::failed(Fault::Timeout, why.to_string()));
            }
            Step::Blocked { why: why @ Blocked::NoRoomForAct, .. } => {
                let since_s = *self.blocked_s.get_or_insert(now_s);
                return (now_s - since_s > Self::BLOCKED_S)
                    .then(|| Ended::failed(Fault::NoRoom, why.to_string()));
            }
            _ => self.blocked_s = None,
        }
        self.without_progress(navigator, step, now_s)
    }

    fn without_progress(
        &mut self,
        navigator: &Navigator,
        step: &Step,
        now_s: f64,
    ) -> Option<Ended> {
        // A single motion has a time of its own.
        let way_m = navigator.guidance()?.remaining_m;
        let left = WayLeft { way_m, turn_rad: navigator.turn_left_rad() };
        let step_m = WayProgress::step_m(navigator.stack().robot(), Self::PATIENCE_S);
        if self.progress.has_progressed(left, step_m) {
            self.progressed_s = now_s;
        }
        let stuck_s = now_s - self.progressed_s;
        (stuck_s > Self::PATIENCE_S).then(|| {
            let last =
                step.why().map_or_else(String::new, |why| format!("; the last problem: {why}"));
            let why = format!("the robot got no farther for {stuck_s:.0} s{last}");
            Ended::failed(Fault::NoProgress, why)
        })
    }
}
