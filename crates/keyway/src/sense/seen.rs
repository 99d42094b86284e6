//! The ground in which the robot has looked.

use super::ProjectedScan;
use super::spread::{Spread, Walls};
use crate::geometry::Pose;
use crate::map::{BitGrid, Cell, CellWindow, GridFrame};
use crate::robot::{Footprint, RangeSensor, Robot};
use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

/// The cells in which nothing stands, as far as a robot has looked: see [`SeenGround`].
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenCells<'a> {
    /// Cells over which it may drive ahead so fast that it could not stop before; `None`: anywhere.
    pub ahead: Option<&'a BitGrid>,
    /// Cells over which it may back up; `None`: anywhere.
    pub behind: Option<&'a BitGrid>,
    /// The latest scans, which know better than cells where they met something; empty: only cells
    /// are known.
    pub scans: &'a [ProjectedScan],
}

impl SeenCells<'_> {
    /// No cell need be seen.
    pub const ANYWHERE: Self = Self { ahead: None, behind: None, scans: &[] };
}

/// Which seen ground is kept ([`SeenGround::new`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenWanted {
    /// That over which a robot may back up.
    Behind,
    /// That within which it must be able to stop, too.
    AheadAndBehind,
}

/// Cells whose centres lie between beams that go on beyond them, or which the robot has covered:
/// nothing stands in them, except what has been met there as well. One of the beams passes so near
/// that it would have met a thing as wide as [`RangeSensor::NARROWEST_M`], or as a cell, if that is
/// larger.
///
/// - A robot that drives **ahead** must be able to stop within them: what stands beyond them would
///   be met too late, whether it is beyond the sensor's range, behind a corner, or where no beam
///   says anything.
/// - A robot whose sensor does not see all around may not drive **backwards** elsewhere: what
///   stands there would be touched before it is met.
///
/// They are kept as far around the robot as it comes before it stands, ahead and backwards.
///
/// # Where somebody walks
/// Ground behind the robot that was seen a while ago may not be free any more. With walkers of up
/// to V, unseen ground spreads into what is out of view at that speed, from cell to cell, but not
/// through [`Walls`]; what is farther away than somebody walks in a second counts as unseen.
/// [`SeenCells::behind`] are then those to which nobody can come before a robot has stopped that
/// backs up, whether or not he was ever seen. Cells count as covered by whoever covers their
/// centres; who is less wide than a cell's diagonal may be missed.
///
/// Memory: a bit per cell, three where somebody walks. An update looks at the cells around the
/// robot that are not known to be free, about 30 ns each.
#[derive(Clone, Debug)]
pub struct SeenGround {
    /// By anything that stands.
    seen: BitGrid,
    footprint: Footprint,
    /// As far as cells are looked at from the robot \[m\].
    reach_m: f64,
    looks_ahead: bool,
    backs_up: bool,
    walkers: Option<Walkers>,
}

/// Who may walk over seen ground while nobody looks.
#[derive(Clone, Debug)]
struct Walkers {
    speed_mps: f64,
    /// Until a robot stands that backs up \[s\].
    stop_s: f64,
    /// As far as cells are looked at from the robot \[m\].
    reach_m: f64,
    /// All that is known is inside of it.
    window: CellWindow,
    /// Seen cells to which nobody can have come by now.
    left: BitGrid,
    /// Those to which nobody can come until a robot stands that backs up.
    free: BitGrid,
    spread: Spread,
}

/// The cells of seen ground.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SeenStored {
    seen: BitGrid,
    /// Window, and the cells to which nobody can have come by now, and until a robot has stopped.
    walkers: Option<(CellWindow, BitGrid, BitGrid)>,
}

impl SeenGround {
    /// Its cells.
    pub(crate) fn stored(&self) -> SeenStored {
        let cells =
            |walkers: &Walkers| (walkers.window, walkers.left.clone(), walkers.free.clone());
        SeenStored { seen: self.seen.clone(), walkers: self.walkers.as_ref().map(cells) }
    }

    /// The same ground with the cells that were stored; false where those are of another size.
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

    /// Somebody's walk for so long is looked at around the robot \[s\].
    const WALK_S: f64 = 1.0;

    /// Nothing seen, on a grid of `frame`'s size, among walkers of up to `walker_mps`, 0 where
    /// nobody walks. `None` where nothing has to be seen: behind a robot that does not drive
    /// backwards, or sees all around with a single sensor.
    pub fn new(
        frame: &GridFrame,
        robot: &Robot,
        walker_mps: f64,
        wanted: SeenWanted,
    ) -> Option<Self> {
        let limits = &robot.limits;
        // One of several sensors may be lost, and the robot drives on.
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
        // The front stops before the end of what is seen, and cells are whole.
        let cells_m = 2.0 * frame.resolution_m();
        let ahead_m = if looks_ahead { robot.looks_ahead_m() + cells_m } else { 0.0 };
        let behind_m = walkers.as_ref().map_or(back_m, |walkers| walkers.reach_m);
        let reach_m = if backs_up { ahead_m.max(behind_m) } else { ahead_m };
        let footprint = robot.footprint.clone();
        Some(Self { seen, footprint, reach_m, looks_ahead, backs_up, walkers })
    }

    /// Cells that have been seen; behind the robot, where somebody walks, those of them that are
    /// still free when the robot has backed up there, and stopped.
    pub fn cells(&self) -> SeenCells<'_> {
        let behind = self.walkers.as_ref().map_or(&self.seen, |walkers| &walkers.free);
        SeenCells {
            ahead: self.looks_ahead.then_some(&self.seen),
            behind: self.backs_up.then_some(behind),
            scans: &[],
        }
    }

    /// Takes in a scan made `elapsed_s` after the last one, 0 for another sensor's of the same
    /// time, on the frame given to [`Self::new`], with the walls that are known. A pose that is not
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
            // Of two scans of the same time only the first finds time that has passed.
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

    /// Nothing has been seen any more.
    pub(crate) fn clear(&mut self) {
        let nothing = BitGrid::new(self.seen.width(), self.seen.height(), false);
        if let Some(walkers) = &mut self.walkers {
            (walkers.left, walkers.free) = (nothing.clone(), nothing.clone());
        }
        self.seen = nothing;
    }

    /// Brings the cells to the present, `age_s` after the last scan: somebody may have come
    /// farther.
    pub fn look_ahead(&mut self, frame: &GridFrame, walls: Walls<'_>, age_s: f64) {
        if let Some(walkers) = &mut self.walkers {
            walkers.foresee((frame, walls), age_s);
        }
    }
}

impl Walkers {
    /// What was seen may be walked on meanwhile.
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

    /// Finds the seen cells that stay free until a robot has stopped that was told of them `age_s`
    /// late.
    fn foresee(&mut self, (frame, walls): (&GridFrame, Walls<'_>), age_s: f64) {
        for y in self.window.low.y..=self.window.high.y {
            self.free.copy_row(y, &self.left);
        }
        let steps = self.steps(frame, self.stop_s + age_s);
        let Self { spread, free, window, .. } = self;
        let _ = (0..steps).find(|_| !spread.step(free, walls, window));
    }

    /// Cells that somebody may come farther in a time.
    ///
    /// A place that he covers then is as far from one that he covers now as he walks; and from
    /// there a centre that he covers, too, is no farther than a cell's diagonal if he is as wide.
    fn steps(&self, frame: &GridFrame, duration_s: f64) -> u64 {
        (self.speed_mps * duration_s / frame.resolution_m() + SQRT_2) as u64
    }
}

#[cfg(test)]
#[path = "seen_tests.rs"]
mod tests;
