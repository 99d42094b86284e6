//! Recent poses of a robot.

use super::time::Time;
use crate::geometry::{Pose, Velocity, wrap_angle};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The latest observed poses, the oldest first: a scan that arrives late is placed at the pose of
/// its time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Poses {
    poses: VecDeque<(Time, Pose)>,
    velocity: Velocity,
}

impl Poses {
    /// Maximum number of poses.
    const MOST: usize = 128;

    /// Time beyond the last pose for which constant velocity is assumed \[s\].
    const GOES_ON_S: f64 = 0.5;

    pub(super) fn new() -> Self {
        Self { poses: VecDeque::with_capacity(Self::MOST), velocity: Velocity::ZERO }
    }

    /// Records a pose that is not older than the last one. Allocates nothing.
    pub(super) fn note(&mut self, time: Time, pose: Pose, velocity: Velocity) {
        if self.poses.back().is_some_and(|last| last.0 == time) {
            self.poses.pop_back();
        }
        if self.poses.len() >= Self::MOST {
            self.poses.pop_front();
        }
        self.poses.push_back((time, pose));
        self.velocity = velocity;
    }

    /// The pose at a time, interpolated linearly between two observed ones; `None` before all of
    /// them and long after.
    pub(super) fn at(&self, time: Time) -> Option<Pose> {
        let next = self.poses.partition_point(|&(noted, _)| noted < time);
        let Some(&(next_time, next_pose)) = self.poses.get(next) else {
            let &(last_time, last_pose) = self.poses.back()?;
            let since_s = time.since_s(last_time);
            let goes_on = since_s <= Self::GOES_ON_S;
            return goes_on.then(|| last_pose.after_arc(self.velocity, since_s));
        };
        if next_time == time {
            return Some(next_pose);
        }
        let &(before_time, before_pose) = self.poses.get(next.checked_sub(1)?)?;
        let share = time.since_s(before_time) / next_time.since_s(before_time);
        let place = before_pose.point().lerp(next_pose.point(), share);
        let turn_rad = wrap_angle(next_pose.theta - before_pose.theta);
        Some(Pose::new(place.x, place.y, before_pose.theta + share * turn_rad))
    }

    /// True if all poses are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.poses.iter().all(|(_, pose)| pose.point().is_finite() && pose.theta.is_finite())
    }

    /// Forgets all poses, because the next one is unrelated to them.
    pub(super) fn clear(&mut self) {
        self.poses.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn at(stamp_s: f64) -> Time {
        Time::of_stamp(stamp_s).unwrap()
    }

    #[test]
    fn poses_in_between_by_hand() {
        let mut poses = Poses::new();
        assert_eq!(poses.at(at(1.0)), None);
        let velocity = Velocity::new(1.0, 0.0);
        poses.note(at(1.0), Pose::new(2.0, 0.0, PI - 0.1), velocity);
        poses.note(at(1.2), Pose::new(3.0, 1.0, 0.1 - PI), Velocity::new(0.5, 0.0));
        let middle = poses.at(at(1.1)).unwrap();
        assert!(middle.point().distance([2.5, 0.5].into()) < 1e-12);
        assert!((middle.theta.abs() - PI).abs() < 1e-12, "across the half turn: {middle:?}");
        assert_eq!(poses.at(at(1.0)), Some(Pose::new(2.0, 0.0, PI - 0.1)), "what was observed");
        assert_eq!(poses.at(at(0.9)), None);
        // Extrapolation for up to half a second.
        let later = poses.at(at(1.4)).unwrap();
        assert!((later.x - (3.0 - 0.1 * 0.1f64.cos())).abs() < 1e-12, "{later:?}");
        assert!(poses.at(at(1.7)).is_some() && poses.at(at(1.71)).is_none());
        // Of two poses of the same time, the later one counts.
        poses.note(at(1.2), Pose::new(9.0, 1.0, 0.0), velocity);
        assert_eq!(poses.at(at(1.2)).unwrap().x, 9.0);
        poses.clear();
        assert_eq!(poses.at(at(1.2)), None);
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let mut poses = Poses::new();
        let info = allocation_counter::measure(|| {
            for cycle in 0..1000 {
                let time = at(f64::from(cycle) * 0.1);
                poses.note(time, Pose::new(f64::from(cycle), 0.0, 0.0), Velocity::ZERO);
            }
        });
        assert_eq!(info.count_total, 0);
        assert!(poses.at(at(87.2)).is_some() && poses.at(at(87.1)).is_none());
    }
}
