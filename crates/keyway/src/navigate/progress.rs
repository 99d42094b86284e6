//! Progress along a route: its remaining length decreases, or the remaining rotation does.
//! Controllers and simulated runs use the same steps.

use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// The rest of a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayLeft {
    /// Length \[m\]; NaN or infinity: unknown.
    pub way_m: f64,
    /// Absolute angle by which the robot has to rotate to face it \[rad\].
    pub turn_rad: f64,
}

/// The smallest rest so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WayProgress {
    shortest_m: f64,
    /// Smallest remaining rotation since the length last decreased \[rad\].
    smallest_rad: f64,
}

impl WayProgress {
    /// The state of a new route: the first value is progress.
    pub const NEW: Self = Self { shortest_m: f64::INFINITY, smallest_rad: f64::INFINITY };

    /// Largest step that is required \[m\].
    const LARGEST_STEP_M: f64 = 0.05;

    /// Share of the distance covered at full speed that a slow robot must get closer by.
    const SLOW_PART: f64 = 0.1;

    /// Step of a rotation \[rad\]. Rotations cannot count as progress forever: between two steps
    /// of the length, there are at most as many of them as fit into half a circle.
    const TURN_STEP_RAD: f64 = 0.1;

    /// The step by which a robot has to get closer within a time \[m\]: 5 cm, or for a slow robot
    /// a tenth of the distance that it covers in that time at full speed.
    pub fn step_m(robot: &Robot, within_s: f64) -> f64 {
        (Self::SLOW_PART * robot.limits.v_max_mps * within_s).min(Self::LARGEST_STEP_M)
    }

    /// True if the remaining length has decreased by the step since the last time that this was
    /// true, or if the robot has rotated towards the route by 0.1 rad.
    pub fn has_progressed(&mut self, left: WayLeft, step_m: f64) -> bool {
        let WayLeft { way_m, turn_rad } = left;
        if way_m <= self.shortest_m - step_m {
            *self = Self { shortest_m: way_m, smallest_rad: turn_rad };
            return true;
        }
        let has_turned = turn_rad <= self.smallest_rad - Self::TURN_STEP_RAD;
        if has_turned {
            self.smallest_rad = turn_rad;
        }
        has_turned
    }

    /// Switches to another route. If that is longer, progress is measured on it.
    pub const fn begin_another_way(&mut self, remaining_m: f64) {
        self.shortest_m = self.shortest_m.max(remaining_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_by_hand() {
        // 0.5 m/s for 3 s are 1.5 m; at 0.01 m/s they are 3 cm.
        let mut robot = Robot::small();
        assert_eq!(WayProgress::step_m(&robot, 3.0), 0.05);
        robot.limits.v_max_mps = 0.01;
        assert!((WayProgress::step_m(&robot, 3.0) - 0.003).abs() < 1e-15);
    }

    #[test]
    fn progress_is_a_way_that_becomes_shorter() {
        let mut progress = WayProgress::NEW;
        let left = |way_m| WayLeft { way_m, turn_rad: 0.0 };
        let progressed =
            [5.0, 4.96, 4.95, 4.91, 5.5, 4.9].map(|m| progress.has_progressed(left(m), 0.05));
        assert_eq!(progressed, [true, false, true, false, false, true]);
        progress.begin_another_way(3.0);
        assert!(!progress.has_progressed(left(4.88), 0.05), "a shorter way is none by itself");
        progress.begin_another_way(7.0);
        assert!(
            progress.has_progressed(left(6.95), 0.05) && !progress.has_progressed(left(6.95), 0.05)
        );
    }

    /// A robot that rotates back and forth makes no progress; one that rotates towards its route
    /// does.
    #[test]
    fn a_turn_towards_the_way_is_progress_once() {
        let mut progress = WayProgress::NEW;
        let mut turned = |turn_rad| progress.has_progressed(WayLeft { way_m: 5.0, turn_rad }, 0.05);
        let expected = [(3.0, true), (2.95, false), (2.9, true), (3.1, false), (2.85, false)];
        for (turn_rad, is_progress) in expected {
            assert_eq!(turned(turn_rad), is_progress, "{turn_rad}");
        }
        assert!(turned(1.0) && !turned(3.0) && !turned(1.0));
        assert!(progress.has_progressed(WayLeft { way_m: 4.9, turn_rad: 2.0 }, 0.05));
        assert!(progress.has_progressed(WayLeft { way_m: 4.9, turn_rad: 1.9 }, 0.05));
    }
}
