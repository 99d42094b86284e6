//! External changes: the pose of the robot, the clock, the map, masks and speed limits.

use super::Navigator;
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
use crate::map::{Edit, OccupancyGrid};
use crate::navigate::{Masks, NavigateError};
use std::sync::Arc;

impl Navigator {
    /// Sets the pose of the robot: before the first observation, or when the localisation has
    /// been corrected. Sensed obstacles keep their position relative to the robot, and the
    /// correction adds no velocity to moving obstacles; the route is replanned.
    ///
    /// The pose is that at the time of the last observation. A pose that is not finite is
    /// ignored; as the first one, it makes every goal unreachable.
    pub fn relocate(&mut self, pose: Pose) {
        let is_place = |pose: &Pose| pose.point().is_finite() && pose.theta.is_finite();
        if self.place.is_some() && !is_place(&pose) {
            return;
        }
        let before = self.place.replace(pose).filter(|before| *before != pose);
        if let Some(before) = before.filter(is_place) {
            let shift = self.world.relocate(before, pose);
            self.shift_errand(&shift);
            self.plan_again();
        }
    }

    /// Records that the robot was given a command from another source in place of the last
    /// step's, at a time by the clock of the stamps \[s\]: from a joystick, a safety controller,
    /// or a driver that stops the robot as a precaution. The command holds until the next step.
    /// Call this whenever such a command is given; otherwise the navigator concludes that its own
    /// commands do not move the robot.
    ///
    /// A command that is not finite is ignored. A time before the latest known one counts as
    /// that.
    pub fn note_override(&mut self, now_s: f64, command: Velocity) {
        if !(command.v.is_finite() && command.omega.is_finite()) {
            return;
        }
        self.forget_last();
        self.issued = command;
        self.world.note_override(now_s, command);
    }

    /// Forgets all sensed obstacles, stationary and moving, such as points of a bumper that
    /// observes no free space. The route is replanned on the map alone.
    pub fn forget_sensed(&mut self) {
        self.world.forget_sensed(&self.parts);
        self.plan_again();
    }

    /// Restarts the clock of all stamps, for example with a simulation: the next observation may
    /// have any stamp. The robot stays stationary until it has a pose by the new clock and, if
    /// the stack requires that, valid scans by it. Then the route is replanned.
    pub fn restart_clock(&mut self) {
        self.forget_last();
        self.world.restart_clock();
        (self.stepped, self.place) = (None, None);
    }

    /// Replaces the map, of which the navigator takes a copy, for example by one that has grown
    /// or whose origin has moved. Sensed obstacles keep their position in the world; the route is
    /// replanned. Costs as much as a new navigator.
    ///
    /// # Errors
    /// As for [`Self::new`]. The navigator then keeps the last map.
    pub fn set_map(&mut self, map: &OccupancyGrid) -> Result<(), NavigateError> {
        self.world.set_map(Arc::new(map.clone()), &self.parts)?;
        self.plan_again();
        Ok(())
    }

    /// Changes cells of the map; those outside it are ignored. The cost is linear in the changed
    /// cells, plus a search: the route is replanned.
    pub fn edit_map(&mut self, edits: &[Edit]) {
        self.world.edit_map(edits);
        self.plan_again();
    }

    /// Replaces the keep-out zones and speed zones. A robot on a cell that becomes forbidden
    /// stays stationary, unless it can leave as from a start that is too close to an obstacle.
    pub fn set_masks(&mut self, masks: Masks) {
        self.world.set_masks(masks);
        self.plan_again();
    }

    /// Limits the speed in any direction \[m/s\]; `None`: no limit but the robot's own. A robot
    /// that is faster brakes within its limits.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if the speed is not positive and finite. The last limit then
    /// stays.
    pub fn set_speed_limit(&mut self, speed_mps: Option<f64>) -> Result<(), ConfigError> {
        if let Some(speed_mps) = speed_mps {
            ConfigError::unless_positive("speed_mps", speed_mps)?;
        }
        self.speed_limit_mps = speed_mps;
        self.forget_last();
        Ok(())
    }
}
