//! Detection of inputs that contradict each other.

use super::motors::Motors;
use super::time::Time;
use crate::geometry::{Pose, Velocity, wrap_angle};
use crate::robot::Robot;
use crate::sense::SensorScan;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::fmt::{self, Display, Formatter};

/// An inconsistency between the inputs of a robot: its pose, its velocity, its scans, its own
/// commands and its description. The robot drives on, where possible with learned values in place
/// of wrong ones; the operator should be told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Doubt {
    /// The pose was farther away than the velocity could take the robot, within the last 2 s. The
    /// sensed obstacles were moved along with the robot.
    PoseJumped {
        /// Distance of the last jump \[m\].
        by_m: f64,
        /// Rotation of the last jump \[rad\], positive to the left.
        by_rad: f64,
    },
    /// The velocity has been reported as 0 for 2 s, while the pose moved by more than 0.1 m or
    /// 0.1 rad. The velocity that follows from the commands is used instead.
    VelocityAlwaysZero,
    /// The actuation delay is longer than the robot's description says
    /// ([`Robot::actuation_delay_s`]), by enough to show in the motion of the robot. The learned
    /// value is used instead.
    ActsLate {
        /// Learned time from a command to its effect \[s\].
        learned_s: f64,
        /// Time of the description \[s\].
        described_s: f64,
    },
    /// Small commands do not move the robot. Only larger ones are given from now on.
    DeadBand {
        /// Largest speed that has not moved it \[m/s\]; 0 if none is known.
        v_mps: f64,
        /// Largest turn rate that has not moved it \[rad/s\]; 0 if none is known.
        omega_radps: f64,
    },
    /// The robot has been commanded to move for 2 s, and its pose has moved by less than a fifth
    /// of that.
    DoesNotMove,
    /// The robot was stationary, has been commanded to stay so for 2 s, and its pose has moved by
    /// more than 0.1 m or 0.1 rad.
    MovesUntold,
    /// A scan within the last 2 s had bitwise the same ranges as the one before, while the robot
    /// drove or turned by more than 2 cm or 1 degree. It does not count as a new scan, unless
    /// nearly all of its hits are at obstacles that are already known or sensed.
    /// Once the sensor is silent, repetitions do not count while the robot is stationary, either.
    ScanRepeated {
        /// Index of the sensor.
        sensor: usize,
    },
    /// A scan within the last 2 s could not be used as it was given.
    ScanUnusable {
        /// Index of the sensor.
        sensor: usize,
        /// Reason.
        why: ScanFault,
    },
}

/// Reason why a scan cannot be used as it was given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ScanFault {
    /// The bearings of the beams are implausible ([`Scan::check`](crate::sense::Scan::check)). The
    /// scan was ignored.
    Bearings,
    /// All ranges are far beyond the largest range of the scan: they show no obstacle.
    BeyondRange,
    /// The stamp of the scan and that of the pose differ by more than 1 s.
    Stamp {
        /// Time by which the scan is ahead of the pose \[s\]; negative if it is behind.
        ahead_s: f64,
    },
}

impl ScanFault {
    /// Difference of the stamps of a scan and of the pose that is a fault \[s\].
    const STAMP_S: f64 = 1.0;
    /// Factor by which ranges beyond the largest one are in another unit.
    const TIMES: f64 = 5.0;

    /// The fault of a scan that is this time ahead of the pose, if it has one.
    pub(super) fn of(scan: &SensorScan<'_>, ahead_s: f64) -> Option<Self> {
        let beams = &scan.scan;
        if beams.check().is_err() {
            return Some(Self::Bearings);
        }
        // A wall beyond the range is no fault; NaN, 0 and infinity say nothing about the unit.
        let is_length = |range_m: &f64| range_m.is_finite() && *range_m > 0.0;
        let nearest_m = beams.ranges_m.iter().filter(is_length).reduce(f64::min);
        if nearest_m.is_some_and(|nearest_m| nearest_m > Self::TIMES * beams.range_max_m) {
            return Some(Self::BeyondRange);
        }
        (ahead_s.abs() > Self::STAMP_S).then_some(Self::Stamp { ahead_s })
    }
}

impl Display for ScanFault {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Bearings => f.write_str(
                "have no beams, or bearings that cover more than a full turn: give angles in radians",
            ),
            Self::BeyondRange => {
                f.write_str(
                    "have only ranges far beyond their largest one: give metres, and infinity for no return",
                )
            }
            Self::Stamp { ahead_s } => {
                let side = if ahead_s > 0.0 { "ahead of" } else { "behind" };
                write!(f, "are stamped {:.1} s {side} the pose: check the clocks", ahead_s.abs())
            }
        }
    }
}

impl Display for Doubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::PoseJumped { by_m, by_rad } => write!(
                f,
                "the pose has jumped by {by_m:.2} m and {:.1} deg: the localisation was wrong before, or is now",
                by_rad.to_degrees()
            ),
            Self::VelocityAlwaysZero => {
                f.write_str("the velocity is always 0 although the pose moves: check the odometry")
            }
            Self::ActsLate { learned_s, described_s } => write!(
                f,
                "the actuation delay is {learned_s:.2} s, not {described_s:.2} s: set \
                 actuation_delay_s = {learned_s:.2} in the robot file"
            ),
            Self::DeadBand { v_mps, omega_radps } => write!(
                f,
                "commands of up to {v_mps:.3} m/s and {omega_radps:.3} rad/s do not move the robot: check its motors"
            ),
            Self::DoesNotMove => f.write_str(
                "the robot does not follow its commands: check its motors, and whether it is stuck",
            ),
            Self::MovesUntold => f.write_str(
                "the robot moves although its commands are zero: it is pushed, it slides, or its \
                 localisation drifts",
            ),
            Self::ScanRepeated { sensor } => write!(
                f,
                "sensor {sensor} repeats the same scan although the robot moves: check its driver"
            ),
            Self::ScanUnusable { sensor, why } => write!(f, "the scans of sensor {sensor} {why}"),
        }
    }
}

/// The last 2 s of inputs, and the doubts about them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Doubts {
    moments: VecDeque<Moment>,
    /// Usual distance of poses from those predicted by the velocity \[m\], \[rad\].
    usual_m: f64,
    usual_rad: f64,
    /// Time and size of the last jump.
    jump: Option<(Time, [f64; 2])>,
    /// Time at which each sensor last repeated a scan.
    repeated: Vec<Option<Time>>,
    /// Last fault of the scans of each sensor that has had one, and its time.
    #[serde(default)]
    faults: Vec<(usize, Time, ScanFault)>,
    found: Vec<Doubt>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Moment {
    time: Time,
    pose: Pose,
    told: Velocity,
    command: Velocity,
}

impl Doubts {
    /// Length of the window of inputs \[s\].
    const WINDOW_S: f64 = 2.0;

    /// Maximum number of moments; beyond it, the oldest ones are dropped.
    const MOST: usize = 512;

    /// Initial value of the usual error of poses.
    const AT_FIRST_M: f64 = 0.03;
    const AT_FIRST_RAD: f64 = 0.02;

    const MOVED_M: f64 = 0.1;
    const MOVED_RAD: f64 = 0.1;

    pub(super) fn new(sensors: usize) -> Self {
        Self {
            moments: VecDeque::with_capacity(Self::MOST),
            usual_m: Self::AT_FIRST_M,
            usual_rad: Self::AT_FIRST_RAD,
            jump: None,
            repeated: vec![None; sensors],
            faults: Vec::with_capacity(sensors),
            found: Vec::with_capacity(7 + 2 * sensors),
        }
    }

    /// The expected pose, if the observed one is a jump: farther from it than 5 cm or 0.03 rad,
    /// plus four times the usual error of poses, plus what the robot can have sped up or braked
    /// meanwhile. `None` if the last pose is older than three cycles and 0.3 s, since no pose can
    /// be expected then.
    pub(super) fn jump(
        &mut self,
        robot: &Robot,
        (before, velocity): (Pose, Velocity),
        (pose, now): (Pose, Velocity),
        elapsed_s: f64,
    ) -> Option<Pose> {
        /// Weight of the last pose in the usual error.
        const FRESH: f64 = 0.1;
        const TIMES: f64 = 4.0;
        const LONGEST_S: f64 = 0.3;
        if elapsed_s > LONGEST_S.max(3.0 * robot.cycle_s) {
            return None;
        }
        let limits = &robot.limits;
        let changes = 0.5 * elapsed_s * elapsed_s;
        let faster_m = changes * limits.acceleration_mps2.max(limits.deceleration_mps2);
        let angular_radps2 =
            limits.angular_acceleration_radps2.max(limits.angular_deceleration_radps2);
        let expected = before.after_ramp(velocity, now, elapsed_s);
        let off_m = pose.point().distance(expected.point());
        let off_rad = wrap_angle(pose.theta - expected.theta).abs();
        let mut is_jump = false;
        for (off, usual, least) in [
            (off_m, &mut self.usual_m, 0.05 + faster_m),
            (off_rad, &mut self.usual_rad, 0.03 + changes * angular_radps2),
        ] {
            let far = least + TIMES * *usual;
            is_jump |= off > far;
            *usual += FRESH * (off.min(far) - *usual);
        }
        is_jump.then_some(expected)
    }

    /// Records a jump away from the expected pose.
    pub(super) fn note_jump(&mut self, time: Time, expected: Pose, pose: Pose) {
        let by_m = pose.point().distance(expected.point());
        self.jump = Some((time, [by_m, wrap_angle(pose.theta - expected.theta)]));
        self.moments.clear();
    }

    /// True if a robot that moves like this has moved too far for a scan to be the same.
    pub(super) fn has_come_far(velocity: Velocity, from: Pose, to: Pose) -> bool {
        const FAR_M: f64 = 0.02;
        const FAR_RAD: f64 = 0.017;
        let is_far = from.point().distance(to.point()) > FAR_M;
        let is_turned = wrap_angle(to.theta - from.theta).abs() > FAR_RAD;
        !stands(velocity) && (is_far || is_turned)
    }

    /// Records that a sensor has repeated a scan.
    pub(super) fn note_repeated(&mut self, sensor: usize, time: Time) {
        self.repeated[sensor] = Some(time);
    }

    /// Records that a scan of a sensor cannot be used as it was given.
    pub(super) fn note_fault(&mut self, sensor: usize, now: Time, fault: ScanFault) {
        self.faults.retain(|&(other, ..)| other != sensor);
        self.faults.push((sensor, now, fault));
    }

    /// Records the inputs of a cycle and the command in effect.
    pub(super) fn note(&mut self, time: Time, (pose, told): (Pose, Velocity), command: Velocity) {
        self.moments.push_back(Moment { time, pose, told, command });
        // The latest moment that is at least as old as the window is kept.
        let is_old = |moments: &VecDeque<Moment>| {
            moments.get(1).is_some_and(|second| time.since_s(second.time) >= Self::WINDOW_S)
        };
        while is_old(&self.moments) || self.moments.len() > Self::MOST {
            self.moments.pop_front();
        }
    }

    /// Records that another command takes effect now, before the next input of the robot.
    pub(super) fn note_command(&mut self, now: Time, command: Velocity) {
        if let Some(&Moment { time, pose, told, .. }) = self.moments.back()
            && now > time
        {
            self.note(now, (pose, told), command);
        }
    }

    /// Number of monitored sensors.
    pub(super) fn sensors(&self) -> usize {
        self.repeated.len()
    }

    /// The doubts found by the last [`Self::look`].
    pub(super) fn found(&self) -> &[Doubt] {
        &self.found
    }

    /// Evaluates the last 2 s of inputs, and the behaviour of the motors.
    pub(super) fn look(&mut self, now: Time, motors: &Motors) {
        self.found.clear();
        if let Some(learned_s) = motors.learned_s() {
            let described_s = motors.described_s();
            self.found.push(Doubt::ActsLate { learned_s, described_s });
        }
        let Velocity { v: v_mps, omega: omega_radps } = motors.too_small();
        if v_mps > 0.0 || omega_radps > 0.0 {
            self.found.push(Doubt::DeadBand { v_mps, omega_radps });
        }
        let is_recent = |time: &Time| now.since_s(*time) <= Self::WINDOW_S;
        if let Some((_, [by_m, by_rad])) = self.jump.filter(|(time, _)| is_recent(time)) {
            self.found.push(Doubt::PoseJumped { by_m, by_rad });
        }
        for (sensor, time) in self.repeated.iter().enumerate() {
            if time.is_some_and(|time| is_recent(&time)) {
                self.found.push(Doubt::ScanRepeated { sensor });
            }
        }
        for &(sensor, time, why) in &self.faults {
            if is_recent(&time) {
                self.found.push(Doubt::ScanUnusable { sensor, why });
            }
        }
        let (Some(first), Some(last)) = (self.moments.front(), self.moments.back()) else { return };
        if now.since_s(first.time) < Self::WINDOW_S {
            return;
        }
        let moved_m = last.pose.point().distance(first.pose.point());
        let moved_rad = wrap_angle(last.pose.theta - first.pose.theta).abs();
        let has_moved = moved_m > Self::MOVED_M || moved_rad > Self::MOVED_RAD;
        let [asked_m, asked_rad] = self.asked();
        if has_moved && self.moments.iter().all(|moment| moment.told == Velocity::ZERO) {
            self.found.push(Doubt::VelocityAlwaysZero);
        }
        let is_asked = asked_m > Self::MOVED_M || asked_rad > Self::MOVED_RAD;
        if is_asked && moved_m <= 0.2 * asked_m && moved_rad <= 0.2 * asked_rad {
            self.found.push(Doubt::DoesNotMove);
        }
        let is_to_stand = self.moments.iter().all(|moment| moment.command == Velocity::ZERO);
        if is_to_stand && stands(first.told) && has_moved {
            self.found.push(Doubt::MovesUntold);
        }
    }

    /// Distance and rotation from the start of the window to the end of the commanded motion; a
    /// full circle cancels out.
    fn asked(&self) -> [f64; 2] {
        let begin = Pose::default();
        let spans = self.moments.iter().zip(self.moments.iter().skip(1));
        let end = spans.fold(begin, |pose, (one, next)| {
            pose.after_arc(one.command, next.time.since_s(one.time))
        });
        [end.point().distance(begin.point()), end.theta.abs()]
    }
}

/// Below the noise of odometry.
const fn stands(velocity: Velocity) -> bool {
    velocity.v.abs() < 0.01 && velocity.omega.abs() < 0.02
}
