//! Tasks of the robot, and their outcomes.

use super::codes::{Ended, Fault};
use super::waits::Waits;
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use keyway::geometry::{Pose, wrap_angle};
use keyway::navigate::{Blocked, Navigator, Step, WayLeft, WayProgress};

/// A task for the robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wanted {
    /// Drive to the last of these poses, via the others.
    Poses(Vec<PoseStamped>),
    /// Stop at each of these poses, from index `first` on, and repeat all of them `again` times.
    Stops { poses: Vec<PoseStamped>, first: usize, again: usize },
    /// Follow a path.
    Path(Path),
    /// A single motion.
    Act(Act),
    /// Wait in place for a time \[s\].
    Wait(f64),
}

/// A single motion, its time allowance \[s\] (0: an hour), and its speed limit \[m/s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Act {
    pub(crate) motion: Motion,
    pub(crate) allowance_s: f64,
    pub(crate) most_mps: Option<f64>,
    /// The reason why the request is invalid.
    pub(crate) fault: Option<&'static str>,
}

impl Act {
    /// The time allowance \[s\].
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

/// A running task.
#[derive(Clone, Debug)]
pub(super) struct Errand {
    began_s: f64,
    progress: WayProgress,
    progressed_s: f64,
    /// Time since when an obstacle has blocked a single motion \[s\].
    blocked_s: Option<f64>,
    /// Time since when the robot has been waiting for inputs \[s\].
    in_doubt_s: Option<f64>,
    /// End time of a wait \[s\].
    pub(super) until_s: Option<f64>,
    /// The current stop, for a task with stops.
    pub(super) present_stop: Option<PoseStamped>,
    stops: Stops,
    /// End time of a single motion \[s\].
    pub(super) deadline_s: Option<f64>,
    /// Speed limit of a single motion \[m/s\].
    pub(super) most_mps: Option<f64>,
    /// Number of goal poses.
    pub(super) poses: usize,
    /// Recoveries before the task.
    recoveries: u32,
    pub(super) made: Made,
    last: Option<Pose>,
}

/// Remaining stops, in their order.
#[derive(Clone, Debug, Default)]
struct Stops {
    poses: Vec<PoseStamped>,
    next: usize,
    /// Number of repetitions of all stops, after these.
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

/// Progress of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Made {
    /// Sum of all turns, to either side \[rad\].
    pub(crate) turned_rad: f64,
    pub(crate) driven_m: f64,
    /// Index of the current stop.
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
    /// Maximum time without progress \[s\].
    const PATIENCE_S: f64 = 60.0;

    /// Maximum time for which an obstacle may block a single motion \[s\].
    const BLOCKED_S: f64 = 1.0;

    /// Creates a task that starts at a time \[s\], after a number of recoveries.
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

    /// Time since the start \[s\].
    pub(super) fn under_way_s(&self, now_s: f64) -> f64 {
        now_s - self.began_s
    }

    /// Recoveries since the start. `in_all` is the total number.
    pub(super) const fn recoveries(&self, in_all: u32) -> u32 {
        in_all.saturating_sub(self.recoveries)
    }

    /// Sets the stops: poses from index `first` on, and `again` repetitions of all of them.
    pub(super) fn stop_at(&mut self, poses: &[PoseStamped], first: usize, again: usize) {
        self.poses = poses.len();
        self.made.stop = first;
        self.stops = Stops { poses: poses.to_vec(), next: first, again };
    }

    /// Takes the next stop, if there is one.
    pub(super) fn next_stop(&mut self) -> Option<PoseStamped> {
        self.stops.next()
    }

    /// Records the current stop as missed. The list is bounded: later ones are dropped.
    pub(super) fn miss(&mut self, pose: PoseStamped, ended: Ended) {
        const MOST: usize = 1000;
        if self.made.missed.len() < MOST {
            self.made.missed.push(Missed { stop: self.made.stop, pose, ended });
        }
    }

    /// Advances to the next stop.
    pub(super) fn leave_stop(&mut self, now_s: f64) {
        (self.progress, self.progressed_s) = (WayProgress::NEW, now_s);
        self.made.stop = (self.made.stop + 1) % self.poses.max(1);
    }

    /// Updates the progress with the current pose.
    pub(super) fn note(&mut self, pose: Pose) {
        if let Some(before) = self.last.replace(pose) {
            self.made.turned_rad += wrap_angle(pose.theta - before.theta).abs();
            self.made.driven_m += pose.point().distance(before.point());
        }
    }

    /// Returns the outcome if the robot has been waiting for inputs for too long.
    pub(super) fn stand(&mut self, why: &Waits, now_s: f64) -> Option<Ended> {
        let since_s = *self.in_doubt_s.get_or_insert(now_s);
        let is_over = now_s - since_s > Self::PATIENCE_S;
        is_over.then(|| Ended::failed(Fault::Transform, why.to_string()))
    }

    /// Returns the outcome if this step is the last one.
    pub(super) fn end(&mut self, navigator: &Navigator, step: &Step, now_s: f64) -> Option<Ended> {
        self.in_doubt_s = None;
        if let Some(until_s) = self.until_s {
            return (now_s >= until_s).then_some(Ended::Succeeded);
        }
        // The navigator does not count the time of a motion that cannot start, such as outside
        // the map.
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
        // A single motion has its own time limit.
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
            let why = format!("the robot made no progress for {stuck_s:.0} s{last}");
            Ended::failed(Fault::NoProgress, why)
        })
    }
}
