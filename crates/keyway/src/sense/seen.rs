//! The free space that the robot has observed.

use super::ProjectedScan;
use super::spread::{Spread, Walls};
use crate::geometry::Pose;
use crate::map::{BitGrid, Cell, CellWindow, GridFrame};
use crate::robot::{Footprint, RangeSensor, Robot};
use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

/// The cells observed to be free of obstacles: see [`SeenGround`].
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenCells<'a> {
    /// Cells within which the robot must be able to stop when driving forward; `None`: anywhere.
    pub ahead: Option<&'a BitGrid>,
    /// Cells over which it may drive backwards; `None`: anywhere.
    pub behind: Option<&'a BitGrid>,
    /// The latest scans, which locate hits more exactly than cells do; empty: only cells are
    /// available.
    pub scans: &'a [ProjectedScan],
}

impl SeenCells<'_> {
    /// No constraint: no cell has to be observed.
    pub const ANYWHERE: Self = Self { ahead: None, behind: None, scans: &[] };
}

/// The observed free space to keep ([`SeenGround::new`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenWanted {
    /// The cells over which a robot may drive backwards.
    Behind,
    /// Also the cells within which it must be able to stop when driving forward.
    AheadAndBehind,
}

/// Observed free space: cells whose centres lie between beams that continue beyond them, or which
/// the robot has covered. No obstacle is in them, except those that were sensed there as well.
/// One of the beams passes so close that it would have hit an obstacle as wide as
/// [`RangeSensor::NARROWEST_M`], or as a cell if that is larger.
///
/// - A robot that drives **forward** must be able to stop within them: an obstacle beyond them
///   would be detected too late, whether it is out of range, behind a corner, or in the direction
///   of invalid beams.
/// - A robot whose sensor does not see all around may drive **backwards** only within them: an
///   obstacle elsewhere would be touched before it is detected.
///
/// They are kept as far around the robot as it can travel before it stops, forward and backwards.
///
/// # Pedestrians
/// Space behind the robot that was observed a while ago may no longer be free. With pedestrians
/// of up to V, unobserved space spreads at that speed into cells that are out of view, from cell
/// to cell, but not through [`Walls`]. Cells farther away than a pedestrian walks in one second
/// count as unobserved. [`SeenCells::behind`] are then the cells that no pedestrian, tracked or
/// not, can reach before a robot that drives backwards has stopped. A cell counts as covered if
/// its centre is covered; a pedestrian narrower than a cell's diagonal may be missed.
///
/// Memory: one bit per cell, three with pedestrians. An update visits the cells around the robot
/// that are not known to be free, about 30 ns each.
#[derive(Clone, Debug)]
pub struct SeenGround {
    /// Cells observed to be free of stationary obstacles.
    seen: BitGrid,
    footprint: Footprint,
    /// Radius around the robot within which cells are updated \[m\].
    reach_m: f64,
    looks_ahead: bool,
    backs_up: bool,
    walkers: Option<Walkers>,
}

/// Pedestrians that may enter observed free space while it is out of view.
#[derive(Clone, Debug)]
struct Walkers {
    speed_mps: f64,
    /// Time until a robot that drives backwards has stopped \[s\].
    stop_s: f64,
    /// Radius around the robot within which cells are updated \[m\].
    reach_m: f64,
    /// Window that contains all cells in use.
    window: CellWindow,
    /// Observed cells that no pedestrian can have reached by now.
    left: BitGrid,
    /// Observed cells that no pedestrian can reach before a robot that drives backwards has
    /// stopped.
    free: BitGrid,
    spread: Spread,
}

/// The observed free space in serialised form.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SeenStored {
    seen: BitGrid,
    /// Window, the cells that no pedestrian can have reached by now, and those until a robot has
    /// stopped.
    walkers: Option<(CellWindow, BitGrid, BitGrid)>,
}

impl SeenGround {
    /// The cells in serialised form.
    pub(crate) fn stored(&self) -> SeenStored {
        let cells =
            |walkers: &Walkers| (walkers.window, walkers.left.clone(), walkers.free.clone());
        SeenStored { seen: self.seen.clone(), walkers: self.walkers.as_ref().map(cells) }
    }

    /// Restores stored cells; false if they are of another size.
    pub(crate) fn restore(&mut self, stored: SeenStored) -> bool {
        let size = |bits: &BitGrid| (bits.width(), bits.height(), bits.padding());
        let own = size(&self.seen);
        let frame = CellWindow {
            low: Cell::new(0, 0),
            high: Cell::new(own.0 as i32 - 1, own.1 as i32 - 1),
        };
        let fits = |(window, left, free): &(CellWindow, BitGrid, BitGrid)| {
            let is_empty = window.low.x > window.high.x || window.low.y > window.high.y;
            let is_inside = frame.contains(window.low) && frame.contains(window.high);
            size(left) == own && size(free) == own && (is_empty || is_inside)
        };
        let fit = stored.walkers.as_ref().is_none_or(fits) && size(&stored.seen) == own;
        if !fit || stored.walkers.is_some() != self.walkers.is_some() {
            return false;
        }
        self.seen = stored.seen;
        if let (Some(walkers), Some((window, left, free))) = (&mut self.walkers, stored.walkers) {
            (walkers.window, walkers.left, walkers.free) = (window, left, free);
        }
        true
    }

    /// Walking time by which the window extends around the robot \[s\].
    const WALK_S: f64 = 1.0;

    /// Nothing observed yet, on a grid of `frame`'s size, with pedestrians of up to `walker_mps`,
    /// 0 for none. `None` if no space has to be observed: a robot that does not drive backwards,
    /// or sees all around with a single sensor, needs no free space behind it.
    pub fn new(
        frame: &GridFrame,
        robot: &Robot,
        walker_mps: f64,
        wanted: SeenWanted,
    ) -> Option<Self> {
        let limits = &robot.limits;
        // One of several sensors may fail while the robot drives on.
        let always_sees_behind = robot.sensors.len() == 1 && robot.sees_all_around();
        let backs_up = limits.v_min_mps < 0.0 && !always_sees_behind;
        let looks_ahead = wanted == SeenWanted::AheadAndBehind;
        if !(backs_up || looks_ahead) {
            return None;
        }
        let seen = BitGrid::new(frame.width(), frame.height(), false);
        let back_s = robot.cycle_s + 3.0 * limits.stop_s() + robot.smoothing_lag_s();
        let back_m = robot.footprint.circumscribed_radius_m() - limits.v_min_mps * back_s;
        let stop_s = robot.backing_s();
        let walkers = (backs_up && walker_mps > 0.0).then(|| Walkers {
            speed_mps: walker_mps,
            stop_s,
            reach_m: back_m + walker_mps * (stop_s + Self::WALK_S),
            window: CellWindow { low: Cell::new(0, 0), high: Cell::new(-1, -1) },
            left: seen.clone(),
            free: seen.clone(),
            spread: Spread::default(),
        });
        // The front stops before the end of the observed space; cells count as a whole.
        let cells_m = 2.0 * frame.resolution_m();
        let ahead_m = if looks_ahead { robot.looks_ahead_m() + cells_m } else { 0.0 };
        let behind_m = walkers.as_ref().map_or(back_m, |walkers| walkers.reach_m);
        let reach_m = if backs_up { ahead_m.max(behind_m) } else { ahead_m };
        let footprint = robot.footprint.clone();
        Some(Self { seen, footprint, reach_m, looks_ahead, backs_up, walkers })
    }

    /// The observed cells. Behind the robot, with pedestrians, only those that are still free
    /// when the robot has backed up there and stopped.
    pub fn cells(&self) -> SeenCells<'_> {
        let behind = self.walkers.as_ref().map_or(&self.seen, |walkers| &walkers.free);
        SeenCells {
            ahead: self.looks_ahead.then_some(&self.seen),
            behind: self.backs_up.then_some(behind),
            scans: &[],
        }
    }

    /// Takes in a scan made `elapsed_s` after the last one (0 for a scan of another sensor at the
    /// same time), on the frame given to [`Self::new`], with the known walls. A pose that is not
    /// finite shows nothing.
    pub fn update(
        &mut self,
        frame: &GridFrame,
        scan: &ProjectedScan,
        walls: Walls<'_>,
        elapsed_s: f64,
    ) {
        let pose = scan.robot();
        let narrowest_m = RangeSensor::NARROWEST_M.max(frame.resolution_m());
        let window = CellWindow::around(frame, pose.point(), self.reach_m);
        if let Some(walkers) = &mut self.walkers {
            // Of two scans of the same time, only the first advances time.
            let around = CellWindow::around(frame, pose.point(), walkers.reach_m);
            if elapsed_s > 0.0 || walkers.window != around {
                walkers.walk((frame, walls), pose, elapsed_s);
            }
        }
        for cell in window.cells() {
            let walkers = self.walkers.as_mut().filter(|walkers| walkers.window.contains(cell));
            if self.seen.get(cell) && walkers.as_ref().is_none_or(|walkers| walkers.left.get(cell))
            {
                continue;
            }
            let place = frame.world_from_cell(cell);
            let covers = || self.footprint.covers(pose.body_from_world(place));
            if covers() || scan.shows_free(place, narrowest_m) {
                self.seen.set(cell, true);
                walkers.map(|walkers| walkers.left.set(cell, true));
            }
        }
        if let Some(walkers) = &mut self.walkers {
            walkers.foresee((frame, walls), 0.0);
        }
    }

    /// Resets all cells to unobserved.
    pub(crate) fn clear(&mut self) {
        let nothing = BitGrid::new(self.seen.width(), self.seen.height(), false);
        if let Some(walkers) = &mut self.walkers {
            (walkers.left, walkers.free) = (nothing.clone(), nothing.clone());
        }
        self.seen = nothing;
    }

    /// Predicts the cells to the present, `age_s` after the last scan: pedestrians may have come
    /// closer.
    pub fn look_ahead(&mut self, frame: &GridFrame, walls: Walls<'_>, age_s: f64) {
        if let Some(walkers) = &mut self.walkers {
            walkers.foresee((frame, walls), age_s);
        }
    }
}

impl Walkers {
    /// Removes the cells that pedestrians may have entered meanwhile.
    fn walk(&mut self, (frame, walls): (&GridFrame, Walls<'_>), pose: Pose, elapsed_s: f64) {
        let window = CellWindow::around(frame, pose.point(), self.reach_m);
        for y in self.window.low.y..=self.window.high.y {
            let is_inside = window.low.y <= y && y <= window.high.y;
            let last = if is_inside { window.high.x } else { -1 };
            self.left.keep_span(y, window.low.x, last);
            self.free.keep_span(y, 0, -1);
        }
        self.window = window;
        let steps = self.steps(frame, elapsed_s);
        let _ = (0..steps).find(|_| !self.spread.step(&mut self.left, walls, &window));
    }

    /// Finds the observed cells that stay free until a robot has stopped that receives them
    /// `age_s` late.
    fn foresee(&mut self, (frame, walls): (&GridFrame, Walls<'_>), age_s: f64) {
        for y in self.window.low.y..=self.window.high.y {
            self.free.copy_row(y, &self.left);
        }
        let steps = self.steps(frame, self.stop_s + age_s);
        let Self { spread, free, window, .. } = self;
        let _ = (0..steps).find(|_| !spread.step(free, walls, window));
    }

    /// Number of cells that a pedestrian may advance in a time.
    ///
    /// A point that it covers at the end is one walking distance from a point that it covers now.
    /// From there, a covered cell centre is at most a cell's diagonal away if the pedestrian is
    /// that wide.
    fn steps(&self, frame: &GridFrame, duration_s: f64) -> u64 {
        (self.speed_mps * duration_s / frame.resolution_m() + SQRT_2) as u64
    }
}

#[cfg(test)]
#[path = "seen_tests.rs"]
mod tests;
