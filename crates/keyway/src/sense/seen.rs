//! The ground in which the robot has looked.

use super::Scan;
use super::layer::is_seen_through;
use super::spread::{Spread, Walls};
use crate::geometry::{Point, Pose, holds_point, outline};
use crate::map::{BitGrid, Cell, CellWindow, GridFrame};
use crate::robot::{Footprint, Robot};
use std::f64::consts::SQRT_2;

/// Cells whose centres lie between beams that go on beyond them, or which the robot has covered: nothing stands in them, except
/// what has been met there as well.
///
/// A robot whose sensor does not see all around may not drive backwards elsewhere: what stands there would be touched before it
/// is met. So this is kept for such robots alone, and only around them: as far as they come backwards.
///
/// # Where somebody walks
/// Ground that was seen a while ago may not be free any more. With walkers of up to V, unseen ground spreads into what is out of
/// view at that speed, from cell to cell, but not through [`Walls`]; what is farther away than somebody walks in a second counts
/// as unseen. [`Self::cells`] are then those to which nobody can come before a robot has stopped that backs up, whether or not he
/// was ever seen. Cells count as covered by whoever covers their centres; who is less wide than a cell's diagonal may be missed.
///
/// Memory: a bit per cell, two where somebody walks. An update looks at the cells around the robot that are not known to be free,
/// about 30 ns each.
#[derive(Clone, Debug)]
pub struct SeenGround {
    seen: BitGrid,
    robot: Robot,
    /// As far as cells are looked at from the robot \[m\].
    reach_m: f64,
    walkers: Option<Walkers>,
}

/// Who may walk over seen ground while nobody looks.
#[derive(Clone, Debug)]
struct Walkers {
    speed_mps: f64,
    /// Until a robot stands that backs up \[s\].
    stop_s: f64,
    /// All that is known is inside of it.
    window: CellWindow,
    /// Seen cells to which nobody can come meanwhile.
    free: BitGrid,
    spread: Spread,
}

impl SeenGround {
    /// Somebody's walk for so long is looked at around the robot \[s\].
    const WALK_S: f64 = 1.0;

    /// Nothing seen, on a grid of `frame`'s size, among walkers of up to `walker_mps`, 0 where nobody walks; `None` for a robot
    /// that does not drive backwards, or sees all around.
    pub fn new(frame: &GridFrame, robot: &Robot, walker_mps: f64) -> Option<Self> {
        let limits = &robot.limits;
        if limits.v_min_mps >= 0.0 || robot.sensor.field_of_view_deg >= 360.0 {
            return None;
        }
        let back_s = robot.cycle_s + 3.0 * limits.stop_s();
        let back_m = robot.footprint.circumscribed_radius_m() - limits.v_min_mps * back_s;
        let seen = BitGrid::new(frame.width(), frame.height(), false);
        let stop_s = robot.backing_s();
        let walkers = (walker_mps > 0.0).then(|| Walkers {
            speed_mps: walker_mps,
            stop_s,
            window: CellWindow { low: Cell::new(0, 0), high: Cell::new(-1, -1) },
            free: seen.clone(),
            spread: Spread::default(),
        });
        let reach_m = back_m + walker_mps * (stop_s + Self::WALK_S);
        Some(Self { seen, robot: robot.clone(), reach_m, walkers })
    }

    /// Cells that have been seen; where somebody walks, those of them that are still free when the robot has backed up there, and
    /// stopped.
    pub fn cells(&self) -> &BitGrid {
        self.walkers.as_ref().map_or(&self.seen, |walkers| &walkers.free)
    }

    /// Takes in a scan made at `pose` (world frame) `elapsed_s` after the last one, on the frame given to [`Self::new`], with the
    /// walls that are known. A pose that is not finite shows nothing.
    pub fn update(
        &mut self,
        frame: &GridFrame,
        (pose, scan): (Pose, &Scan),
        walls: Walls<'_>,
        elapsed_s: f64,
    ) {
        let window = self.window(frame, pose);
        if let Some(walkers) = &mut self.walkers {
            walkers.walk(&mut self.seen, (frame, walls), &window, elapsed_s);
        }
        for y in window.low.y..=window.high.y {
            for x in window.low.x..=window.high.x {
                let cell = Cell::new(x, y);
                if !self.seen.get(cell) {
                    let centre = Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let place = frame.world_from_grid(centre);
                    let is_seen = self.covers(pose, place) || is_seen_through(place, pose, scan);
                    self.seen.set(cell, is_seen);
                }
            }
        }
        if let Some(walkers) = &mut self.walkers {
            walkers.foresee(&self.seen, (frame, walls));
        }
    }

    /// The cells around the robot; for a pose that is not finite some at the border.
    fn window(&self, frame: &GridFrame, pose: Pose) -> CellWindow {
        let centre = frame.grid_from_world(pose.point());
        let reach = self.reach_m / frame.resolution_m();
        let low = |at: f64| (at - reach).floor().max(0.0) as i32;
        let high = |at: f64, count: u32| ((at + reach).floor() as i32).min(count as i32 - 1);
        CellWindow {
            low: Cell::new(low(centre.x), low(centre.y)),
            high: Cell::new(high(centre.x, frame.width()), high(centre.y, frame.height())),
        }
    }

    /// Whether the footprint covers a place.
    fn covers(&self, pose: Pose, place: Point) -> bool {
        let off = place - pose.point();
        let (sin, cos) = libm::sincos(pose.theta);
        let own = Point::new(off.x * cos + off.y * sin, off.y * cos - off.x * sin);
        match &self.robot.footprint {
            Footprint::Circle(circle) => own.norm() <= circle.radius_m(),
            Footprint::Polygon(polygon) => {
                holds_point(outline(polygon.vertices().iter().copied()), own)
            }
        }
    }
}

impl Walkers {
    /// What was seen may be walked on meanwhile.
    fn walk(
        &mut self,
        seen: &mut BitGrid,
        (frame, walls): (&GridFrame, Walls<'_>),
        window: &CellWindow,
        elapsed_s: f64,
    ) {
        for y in self.window.low.y..=self.window.high.y {
            let is_inside = window.low.y <= y && y <= window.high.y;
            let last = if is_inside { window.high.x } else { -1 };
            seen.keep_span(y, window.low.x, last);
            self.free.keep_span(y, 0, -1);
        }
        self.window = *window;
        let steps = self.steps(frame, elapsed_s);
        let _ = (0..steps).find(|_| !self.spread.step(seen, walls, window));
    }

    /// Which seen cells stay free until a robot has stopped.
    fn foresee(&mut self, seen: &BitGrid, (frame, walls): (&GridFrame, Walls<'_>)) {
        for y in self.window.low.y..=self.window.high.y {
            self.free.copy_row(y, seen);
        }
        let steps = self.steps(frame, self.stop_s);
        let Self { spread, free, window, .. } = self;
        let _ = (0..steps).find(|_| !spread.step(free, walls, window));
    }

    /// Cells that somebody may come farther in a time.
    ///
    /// A place that he covers then is as far from one that he covers now as he walks; and from there a centre that he covers,
    /// too, is no farther than a cell's diagonal if he is as wide.
    fn steps(&self, frame: &GridFrame, duration_s: f64) -> u64 {
        (self.speed_mps * duration_s / frame.resolution_m() + SQRT_2) as u64
    }
}

#[cfg(test)]
#[path = "seen_tests.rs"]
mod tests;
