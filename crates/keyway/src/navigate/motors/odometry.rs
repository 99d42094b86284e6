//! Velocities that are always told as 0.

use super::delay_filter::Measured;
use crate::geometry::{Pose, Velocity, wrap_angle};
use crate::navigate::time::Time;
use serde::{Deserialize, Serialize};

/// Notices that the velocity is told as 0 while the robot drives, as by a localisation without
/// odometry.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Odometry {
    last: Option<(Time, Pose)>,
    /// Where the robot was when it was first told to drive, with a velocity of 0 since.
    began: Option<Pose>,
    /// How far it should have come since \[m\], and turned \[rad\].
    asked: [f64; 2],
    says_nothing: bool,
}

impl Odometry {
    /// A robot that has come so far, and at least half as far as it was told to, has moved.
    const MOVED: [f64; 2] = [0.05, 0.1];

    /// Whether the velocity says nothing.
    pub(super) const fn says_nothing(&self) -> bool {
        self.says_nothing
    }

    /// Notes what was told, and the command that acts meanwhile. What that shows: the velocity as
    /// told, or where it says nothing that of the poses, if there was one before.
    pub(super) fn note(
        &mut self,
        time: Time,
        (pose, told): (Pose, Velocity),
        command: Velocity,
    ) -> Option<Measured> {
        let last = self.last.replace((time, pose));
        if told != Velocity::ZERO {
            *self = Self { last: self.last, ..Self::default() };
            return Some(Measured::Now(told));
        }
        let passed = last.map(|(before, from)| (time.since_s(before), from));
        if let Some((elapsed_s, from)) = passed.filter(|_| command != Velocity::ZERO) {
            let began = *self.began.get_or_insert(from);
            self.asked[0] += command.v.abs() * elapsed_s;
            self.asked[1] += command.omega.abs() * elapsed_s;
            let moved =
                [pose.point().distance(began.point()), wrap_angle(pose.theta - began.theta).abs()];
            let all = moved.into_iter().zip(self.asked).zip(Self::MOVED);
            self.says_nothing |= { all }.any(|((m, asked), least)| m > least.max(0.5 * asked));
        } else if !self.says_nothing {
            (self.began, self.asked) = (None, [0.0; 2]);
        }
        if !self.says_nothing {
            return Some(Measured::Now(told));
        }
        let (elapsed_s, from) = passed.filter(|&(elapsed_s, _)| elapsed_s > 0.0)?;
        Some(Measured::OnMean(mean(from, pose, elapsed_s)))
    }
}

/// The mean velocity between two poses.
fn mean(from: Pose, to: Pose, elapsed_s: f64) -> Velocity {
    let turn_rad = wrap_angle(to.theta - from.theta);
    let (sin, cos) = libm::sincos(from.theta + 0.5 * turn_rad);
    let way = to.point() - from.point();
    Velocity::new((way.x * cos + way.y * sin) / elapsed_s, turn_rad / elapsed_s)
}
