//! Detection of odometry that always reports a velocity of 0.

use super::delay_filter::Measured;
use crate::geometry::{Pose, Velocity, wrap_angle};
use crate::navigate::time::Time;
use serde::{Deserialize, Serialize};

/// Detects that the velocity is reported as 0 while the robot drives, as by a localisation
/// without odometry.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Odometry {
    last: Option<(Time, Pose)>,
    /// Pose of the robot at its first drive command since which the velocity has been 0.
    began: Option<Pose>,
    /// Commanded distance since then \[m\], and commanded rotation \[rad\].
    asked: [f64; 2],
    says_nothing: bool,
}

impl Odometry {
    /// Smallest motion that counts \[m\], \[rad\]; it must also be at least half of the commanded
    /// motion.
    const MOVED: [f64; 2] = [0.05, 0.1];

    /// Largest distance of two poses that counts as motion, beyond that of twice the full speed
    /// \[m\], \[rad\]. A larger one is a jump of the localisation.
    const ROUGH: [f64; 2] = [0.05, 0.1];

    /// True if the velocity is not reported.
    pub(super) const fn says_nothing(&self) -> bool {
        self.says_nothing
    }

    /// Takes in the reported pose and velocity and the acting command of a robot with this full
    /// speed. Returns the reported velocity, or that of the poses if none is reported; `None` if
    /// the poses have jumped or there is only one.
    pub(super) fn note(
        &mut self,
        time: Time,
        (pose, told): (Pose, Velocity),
        command: Velocity,
        full: Velocity,
    ) -> Option<Measured> {
        let last = self.last.replace((time, pose));
        if told != Velocity::ZERO {
            *self = Self { last: self.last, ..Self::default() };
            return Some(Measured::Now(told));
        }
        let passed = last.map(|(before, from)| (time.since_s(before), from));
        let passed = passed.filter(|&(elapsed_s, from)| {
            let [way_m, turn_rad] = apart(from, pose);
            way_m <= 2.0 * full.v * elapsed_s + Self::ROUGH[0]
                && turn_rad <= 2.0 * full.omega * elapsed_s + Self::ROUGH[1]
        });
        if let Some((elapsed_s, from)) = passed.filter(|_| command != Velocity::ZERO) {
            let began = *self.began.get_or_insert(from);
            self.asked[0] += command.v.abs() * elapsed_s;
            self.asked[1] += command.omega.abs() * elapsed_s;
            let moved = apart(began, pose);
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

/// The distance between two poses \[m\], and the rotation between them \[rad\].
fn apart(from: Pose, to: Pose) -> [f64; 2] {
    [to.point().distance(from.point()), wrap_angle(to.theta - from.theta).abs()]
}

/// The mean velocity between two poses.
fn mean(from: Pose, to: Pose, elapsed_s: f64) -> Velocity {
    let turn_rad = wrap_angle(to.theta - from.theta);
    let (sin, cos) = libm::sincos(from.theta + 0.5 * turn_rad);
    let way = to.point() - from.point();
    Velocity::new((way.x * cos + way.y * sin) / elapsed_s, turn_rad / elapsed_s)
}
