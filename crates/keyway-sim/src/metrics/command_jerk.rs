//! Jerk of commands.

use keyway::geometry::Velocity;

/// Largest jerk of a sequence of commands, one per cycle, to a robot that is initially at rest.
#[derive(Clone, Copy, Debug)]
pub struct CommandJerk {
    cycle_s: f64,
    last: Velocity,
    /// Change of the velocity from the previous command to the last one.
    change: Velocity,
    most: Velocity,
}

impl CommandJerk {
    /// Creates the metric without commands.
    pub const fn new(cycle_s: f64) -> Self {
        let (last, change, most) = (Velocity::ZERO, Velocity::ZERO, Velocity::ZERO);
        Self { cycle_s, last, change, most }
    }

    /// Adds the command of the next cycle.
    pub fn note(&mut self, command: Velocity) {
        let change = difference(self.last, command);
        let Velocity { v, omega, .. } = difference(self.change, change);
        self.most = Velocity::new(self.most.v.max(v.abs()), self.most.omega.max(omega.abs()));
        (self.last, self.change) = (command, change);
    }

    /// Returns the largest change of the acceleration from cycle to cycle, per time \[m/s³\].
    pub fn max_mps3(&self) -> f64 {
        self.most.v / (self.cycle_s * self.cycle_s)
    }

    /// Returns the largest change of the angular acceleration from cycle to cycle, per time
    /// \[rad/s³\].
    pub fn max_radps3(&self) -> f64 {
        self.most.omega / (self.cycle_s * self.cycle_s)
    }
}

fn difference(from: Velocity, to: Velocity) -> Velocity {
    Velocity::new(to.v - from.v, to.omega - from.omega)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_change_of_the_acceleration_counts() {
        let mut jerk = CommandJerk::new(0.5);
        assert_eq!((jerk.max_mps3(), jerk.max_radps3()), (0.0, 0.0));
        for (v, omega) in [(0.25, 0.0), (0.5, 0.5), (0.5, 0.5), (0.25, 0.5), (0.25, 0.5)] {
            jerk.note(Velocity::new(v, omega));
        }
        // Changes of the speed 0.25, 0.25, 0, -0.25, 0, and of the turn rate 0, 0.5, 0, 0, 0.
        assert_eq!((jerk.max_mps3(), jerk.max_radps3()), (1.0, 2.0));
        jerk.note(Velocity::new(-0.25, 0.5));
        assert_eq!((jerk.max_mps3(), jerk.max_radps3()), (2.0, 2.0));
    }
}
