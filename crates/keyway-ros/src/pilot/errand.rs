//! Errands of the robot, and their ends.

use super::codes::{Code, Ended};
use crate::messages::geometry_msgs::PoseStamped;
use crate::messages::nav_msgs::Path;
use keyway::navigate::{Blocked, Navigator, Step, WayLeft, WayProgress};

/// Something that the robot is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wanted {
    /// To drive to a pose.
    Pose(PoseStamped),
    /// To drive along a path.
    Path(Path),
}

/// An errand under way.
#[derive(Clone, Debug)]
pub(super) struct Errand {
    began_s: f64,
    progress: WayProgress,
    progressed_s: f64,
}

impl Errand {
    /// The longest time in which the robot may get no farther \[s\].
    const PATIENCE_S: f64 = 60.0;

    /// One that begins at a time \[s\].
    pub(super) const fn new(now_s: f64) -> Self {
        Self { began_s: now_s, progress: WayProgress::NEW, progressed_s: now_s }
    }

    /// Since it began \[s\].
    pub(super) fn under_way_s(&self, now_s: f64) -> f64 {
        now_s - self.began_s
    }

    /// Its end, if this step is the last one.
    pub(super) fn end(&mut self, navigator: &Navigator, step: &Step, now_s: f64) -> Option<Ended> {
        match step {
            Step::Arrived => return Some(Ended::Succeeded),
            Step::Blocked { why: why @ Blocked::OutOfTime, .. } => {
                return Some(Ended::failed(Code::FailedToMakeProgress, why.to_string()));
            }
            _ => {}
        }
        let way_m = navigator.guidance().map_or(f64::NAN, |guidance| guidance.remaining_m);
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
            Ended::failed(Code::FailedToMakeProgress, why)
        })
    }
}
