//! Progress along a way: what is left of it becomes shorter. Controllers and simulated runs ask for
//! the same steps.

use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// The shortest remaining way so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WayProgress {
    shortest_m: f64,
}

impl WayProgress {
    /// Nothing is known of the way yet: whatever comes first is progress.
    pub const NEW: Self = Self { shortest_m: f64::INFINITY };

    /// The largest step that is asked for \[m\].
    const LARGEST_STEP_M: f64 = 0.05;

    /// The part of what a slow robot drives in the time by which it has to get closer.
    const SLOW_PART: f64 = 0.1;

    /// The step by which a robot has to get closer within a time \[m\]: 5 cm, or a tenth of what a
    /// slow robot drives in that time.
    pub fn step_m(robot: &Robot, within_s: f64) -> f64 {
        (Self::SLOW_PART * robot.limits.v_max_mps * within_s).min(Self::LARGEST_STEP_M)
    }

    /// True if the way has become shorter by the step since the last time that this was true.
    pub fn has_progressed(&mut self, remaining_m: f64, step_m: f64) -> bool {
        let has_progressed = remaining_m <= self.shortest_m - step_m;
        if has_progressed {
            self.shortest_m = remaining_m;
        }
        has_progressed
    }

    /// The robot takes another way. Where that is longer, progress is measured on it.
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
        let progressed =
            [5.0, 4.96, 4.95, 4.91, 5.5, 4.9].map(|m| progress.has_progressed(m, 0.05));
        assert_eq!(progressed, [true, false, true, false, false, true]);
        progress.begin_another_way(3.0);
        assert!(!progress.has_progressed(4.88, 0.05), "a shorter way is none by itself");
        progress.begin_another_way(7.0);
        assert!(progress.has_progressed(6.95, 0.05) && !progress.has_progressed(6.95, 0.05));
    }
}
