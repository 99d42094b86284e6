//! Takes in scans, and notices that they show nothing.

use super::Controller;
use crate::geometry::Pose;
use crate::map::CellWindow;
use crate::navigate::Blocked;
use crate::sense::{ProjectedScan, Scan, SeenCells, SeenGround, Walls};

/// The memory from look to look.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// The last scan.
    scan: ProjectedScan,
    /// Since the last scan was taken in \[s\].
    elapsed_s: f64,
    /// Since the last scan that said something \[s\]; infinite before the first one.
    silent_s: f64,
}

impl Default for Look {
    fn default() -> Self {
        Self { scan: ProjectedScan::default(), elapsed_s: 0.0, silent_s: f64::INFINITY }
    }
}

impl Look {
    /// A cycle has passed.
    pub(super) const fn wait(&mut self, cycle_s: f64) {
        self.elapsed_s += cycle_s;
        self.silent_s += cycle_s;
    }

    /// A scan has been taken in; how long after the last one \[s\].
    fn taken_in(&mut self) -> f64 {
        if !self.scan.is_silent() {
            self.silent_s = 0.0;
        }
        std::mem::take(&mut self.elapsed_s)
    }
}

impl Controller {
    /// Adds what a scan shows to the movers and to the sensed layer, and to every map that follows
    /// from it.
    pub(super) fn take_in(&mut self, pose: Pose, scan: &Scan) {
        self.look.scan.project(self.known.frame(), &self.robot.footprint, pose, scan);
        let elapsed_s = self.look.taken_in();
        let scan = &self.look.scan;
        if let Some(tracker) = &mut self.tracker {
            tracker.update(&self.known, scan, elapsed_s);
            if self.stack.controller.go_around {
                self.walked.note(tracker.movers(), elapsed_s);
            }
            let delay_s = self.robot.actuation_delay_s;
            self.movers_then.clear();
            self.movers_then.extend(tracker.movers().iter().map(|mover| mover.after(delay_s)));
        }
        self.sensed.update(&self.known, scan, self.tracker.as_ref(), &mut self.edits);
        for map in &mut self.router.layers.maps {
            map.apply(&self.edits);
        }
        let cells = self.edits.iter().map(|edit| CellWindow { low: edit.cell, high: edit.cell });
        if let Some(window) = cells.reduce(|all, cell| all.union(&cell)) {
            let obstacles = self.router.layers.obstacles().obstacles();
            self.obstacles.update(obstacles, window);
        }
        if let Some(seen) = &mut self.seen {
            let obstacles = self.router.layers.obstacles().obstacles();
            let walls = Walls { obstacles, unknown: self.known.unknown() };
            seen.update(self.known.frame(), scan, walls, elapsed_s);
        }
    }

    /// The reason to stop, if the sensor has said nothing for too long. Before its first scan it
    /// has never seen anything.
    pub(super) fn silence(&self) -> Option<Blocked> {
        let silent_s = self.look.silent_s;
        let is_silent = silent_s > self.robot.sensor_timeout_s() * (1.0 + 1e-9);
        (self.stack.controller.stop_when_blind && is_silent)
            .then_some(Blocked::SensorSilent { silent_s })
    }

    /// The ground that has been seen, and the latest scan.
    pub(super) fn seen_cells(&self) -> SeenCells<'_> {
        let cells = self.seen.as_ref().map_or(SeenCells::ANYWHERE, SeenGround::cells);
        SeenCells { scan: Some(&self.look.scan), ..cells }
    }
}
