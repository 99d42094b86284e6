//! Corrections of the robot's pose, and changes of the map.

use super::World;
use crate::geometry::{Disc, Pose, Shift, Velocity};
use crate::map::{Cell, CellState, Edit, OccupancyGrid};
use crate::navigate::doubts::Doubts;
use crate::navigate::masks::Masks;
use crate::navigate::walked_ground::WalkedGround;
use crate::navigate::{FittedStack, NavigateError};
use std::sync::Arc;

impl World {
    /// Corrects the pose of the robot. Sensed obstacles keep their position relative to the
    /// robot; observed free space becomes unobserved.
    pub(in crate::navigate) fn relocate(&mut self, from: Pose, to: Pose) -> Shift {
        let (shift, frame) = (Shift::new(from, to), *self.known.frame());
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        self.sensed.shift(map, |place| shift.point(place), &mut self.changed);
        self.keep_out();
        self.spread_changes();
        if let Some(tracker) = &mut self.tracker {
            tracker.shift(&frame, &shift);
        }
        self.walked.shift(&shift);
        self.track.shift(&shift);
        self.scans.iter_mut().for_each(|scan| scan.shift(&frame, &shift));
        if let Some(seen) = &mut self.seen {
            seen.clear();
        }
        self.poses.clear();
        if let Some(told) = &mut self.told {
            told.pose = shift.pose(told.pose);
            self.poses.note(told.time, told.pose, told.velocity);
        }
        shift
    }

    /// Clears everything that was sensed.
    pub(in crate::navigate) fn forget_sensed(&mut self, parts: &FittedStack) {
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        self.sensed.forget(map, &mut self.changed);
        self.keep_out();
        self.spread_changes();
        self.tracker.clone_from(&parts.tracker);
        self.walked = WalkedGround::default();
        self.scans.iter_mut().for_each(|scan| scan.clear(scan.robot()));
        if let Some(seen) = &mut self.seen {
            seen.clear();
        }
    }

    /// Clears everything that was sensed on a disc, except the hits of the last scans: an
    /// obstacle that was there and is out of view is assumed to have left.
    pub(in crate::navigate) fn forget_disc(&mut self, disc: &Disc) {
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        self.sensed.forget_disc(map, disc, &mut self.changed);
        self.keep_out();
        self.spread_changes();
        for sensor in 0..self.scans.len() {
            let map = self.unmasked.as_ref().unwrap_or(&self.known);
            let scan = &self.scans[sensor];
            // The next scan separates the moving obstacles.
            self.sensed.update_from(map, sensor, scan, None, &mut self.changed);
            self.keep_out();
            self.spread_changes();
        }
    }

    /// Records a command from another source at a time \[s\].
    pub(in crate::navigate) fn note_override(&mut self, now_s: f64, command: Velocity) {
        self.pass_time(now_s);
        let Some(now) = self.now else { return };
        self.motors.note_override(now, command);
        if let Some(acting) = self.motors.acts_at(now) {
            self.doubts.note_command(now, acting);
        }
    }

    /// Restarts the clock.
    pub(in crate::navigate) fn restart_clock(&mut self) {
        (self.told, self.now, self.scanned, self.refused) = (None, None, None, None);
        self.times.fill(super::SensorTimes::default());
        self.points_at.fill(None);
        self.poses.clear();
        self.motors.restart_clock();
        self.doubts = Doubts::new(self.times.len());
    }

    /// The map as given and edited, without keep-out zones.
    pub(in crate::navigate) fn map(&self) -> &OccupancyGrid {
        self.unmasked.as_ref().unwrap_or(&self.known)
    }

    /// Replaces the map. Sensed obstacles keep their position in the world.
    pub(in crate::navigate) fn set_map(
        &mut self,
        map: Arc<OccupancyGrid>,
        parts: &FittedStack,
    ) -> Result<(), NavigateError> {
        let known = self.masks.over(&map);
        let next = Self::new(&known, parts)?;
        self.unmasked = self.masks.keep_out.is_some().then_some(map);
        self.known = known;
        (self.router, self.obstacles, self.seen) = (next.router, next.obstacles, next.seen);
        let frame = *self.known.frame();
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        self.sensed.shift(map, |place| place, &mut self.changed);
        // The cells of the last map are meaningless on this one.
        self.changed.retain(|edit| edit.state == CellState::Occupied);
        self.edits.clear();
        self.spread_changes();
        let nothing = Shift::new(Pose::default(), Pose::default());
        if let Some(tracker) = &mut self.tracker {
            tracker.shift(&frame, &nothing);
        }
        self.scans.iter_mut().for_each(|scan| scan.shift(&frame, &nothing));
        self.changes += 1;
        Ok(())
    }

    /// Changes cells of the map; those outside it are ignored.
    pub(in crate::navigate) fn edit_map(&mut self, edits: &[Edit]) {
        let frame = *self.known.frame();
        let masked = |edit: &Edit| {
            let state = self.masks.state(frame.world_from_cell(edit.cell), edit.state);
            Edit { cell: edit.cell, state }
        };
        let inside = edits.iter().filter(|edit| frame.contains(edit.cell));
        let masked: Vec<Edit> = inside.map(masked).collect();
        if let Some(map) = &mut self.unmasked {
            Arc::make_mut(map).apply(edits);
        }
        Arc::make_mut(&mut self.known).apply(&masked);
        self.learn(&masked);
    }

    /// Replaces the keep-out zones and speed zones.
    pub(in crate::navigate) fn set_masks(&mut self, masks: Masks) {
        self.masks = masks;
        let map = self.unmasked.take().unwrap_or_else(|| Arc::clone(&self.known));
        let next = self.masks.over(&map);
        let before = std::mem::replace(&mut self.known, next);
        self.unmasked = self.masks.keep_out.is_some().then_some(map);
        let known = &self.known;
        let is_changed = |cell: &Cell| known.state(*cell) != before.state(*cell);
        let to = |cell| Some(Edit { cell, state: known.state(cell)? });
        let cells = known.frame().cells();
        let edits: Vec<Edit> = cells.filter(is_changed).filter_map(to).collect();
        self.learn(&edits);
    }

    /// Takes in changed cells of the known map.
    fn learn(&mut self, edits: &[Edit]) {
        let map = self.unmasked.as_ref().unwrap_or(&self.known);
        self.sensed.learn(map, edits, &mut self.changed);
        self.spread_changes();
        self.changes += 1;
    }
}
