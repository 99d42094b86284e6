//! The world turns out to be otherwise: the place of the robot, the clock, the map, what is
//! allowed.

use super::Navigator;
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
use crate::map::{Edit, OccupancyGrid};
use crate::navigate::{Masks, NavigateError};
use std::sync::Arc;

impl Navigator {
    /// Tells it where the robot is: before the first observation, or when the localisation has been
    /// corrected. What was sensed keeps its place beside the robot, and nothing that moves becomes
    /// fast; the route is planned anew.
    ///
    /// The pose is that at the time of the last observation. A pose that is not finite moves
    /// nothing; as the first one it is none from which a goal can be reached.
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

    /// Notes that the robot was given a command of somebody else in the place of the last step's,
    /// at a time by the clock of the stamps \[s\]: of a person with a joystick, of a safety
    /// controller, or of a driver that stands still in doubt. It holds until the next step. Without
    /// this the navigator would believe that its own commands do not move the robot. To be called
    /// whenever such a command is given.
    ///
    /// A command that is not finite is none. A time before the latest that was told counts as that.
    pub fn note_override(&mut self, now_s: f64, command: Velocity) {
        if !(command.v.is_finite() && command.omega.is_finite()) {
            return;
        }
        self.forget_last();
        self.issued = command;
        self.world.note_override(now_s, command);
    }

    /// Forgets all that was sensed, standing and moving, such as points of a bumper that sees no
    /// ground. The route is planned anew on the map alone.
    pub fn forget_sensed(&mut self) {
        self.world.forget_sensed(&self.parts);
        self.plan_again();
    }

    /// The clock of all stamps begins anew, such as that of a simulation: the next observation may
    /// have any stamp. The robot stands until it is told its pose by the new clock, and its sensors
    /// have said something by it where the stack asks for that. Then the route is planned anew.
    pub fn restart_clock(&mut self) {
        self.forget_last();
        self.world.restart_clock();
        (self.stepped, self.place) = (None, None);
    }

    /// Drives on another map from now on, of which it takes a copy: one that has grown, or whose
    /// origin has moved. What was sensed keeps its place in the world; the route is planned anew.
    /// Costs as much as a new navigator.
    ///
    /// # Errors
    /// As for [`Self::new`]. Then it drives on with the last map.
    pub fn set_map(&mut self, map: &OccupancyGrid) -> Result<(), NavigateError> {
        self.world.set_map(Arc::new(map.clone()), &self.parts)?;
        self.plan_again();
        Ok(())
    }

    /// Changes cells of the map; those outside it are ignored. Costs as much as the cells that
    /// change, and a search: the route is planned anew.
    pub fn edit_map(&mut self, edits: &[Edit]) {
        self.world.edit_map(edits);
        self.plan_again();
    }

    /// Keeps out of some ground from now on, and is slow on some, in the place of what was given
    /// before. On ground that becomes forbidden under the robot it stands, unless it can leave as
    /// from a start that is too near to something.
    pub fn set_masks(&mut self, masks: Masks) {
        self.world.set_masks(masks);
        self.plan_again();
    }

    /// Drives no faster than this from now on \[m/s\], in any direction; `None`: as fast as the
    /// robot can. A robot that is faster brakes as its limits allow.
    ///
    /// # Errors
    /// When the speed is not positive and finite. Then the last limit stays.
    pub fn set_speed_limit(&mut self, speed_mps: Option<f64>) -> Result<(), ConfigError> {
        if let Some(speed_mps) = speed_mps {
            ConfigError::unless_positive("speed_mps", speed_mps)?;
        }
        self.speed_limit_mps = speed_mps;
        self.forget_last();
        Ok(())
    }
}
