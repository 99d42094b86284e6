//! The ground in which the robot has looked.

use super::Scan;
use super::layer::is_seen_through;
use crate::geometry::{Point, Pose, holds_point, outline};
use crate::map::{BitGrid, Cell, GridFrame};
use crate::robot::{Footprint, Robot};

/// Cells whose centres a beam has passed, or the robot has covered: nothing that stands is in them, but what has been met
/// there, too.
///
/// A robot whose sensor does not see all around may not drive backwards elsewhere: what stands there would be touched before it
/// is met. So this is kept for such robots alone, and only around them: as far as they come backwards.
///
/// Memory: one bit per cell. An update looks at the cells around the robot that have not been seen, about 30 ns each.
#[derive(Clone, Debug)]
pub struct SeenGround {
    seen: BitGrid,
    robot: Robot,
    /// As far as cells are looked at from the robot \[m\].
    reach_m: f64,
}

impl SeenGround {
    /// Nothing seen, on a grid of `frame`'s size; `None` for a robot that does not drive backwards, or sees all around.
    pub fn new(frame: &GridFrame, robot: &Robot) -> Option<Self> {
        let limits = &robot.limits;
        if limits.v_min_mps >= 0.0 || robot.sensor.field_of_view_deg >= 360.0 {
            return None;
        }
        let back_s = robot.cycle_s + 3.0 * limits.stop_s();
        let reach_m = robot.footprint.circumscribed_radius_m() - limits.v_min_mps * back_s;
        let seen = BitGrid::new(frame.width(), frame.height(), false);
        Some(Self { seen, robot: robot.clone(), reach_m })
    }

    /// Cells that have been seen.
    pub const fn cells(&self) -> &BitGrid {
        &self.seen
    }

    /// Takes in a scan made at `pose` (world frame), on the frame given to [`Self::new`]. A pose that is not finite shows nothing.
    pub fn update(&mut self, frame: &GridFrame, pose: Pose, scan: &Scan) {
        let centre = frame.grid_from_world(pose.point());
        let reach = self.reach_m / frame.resolution_m();
        let span = |at: f64, count: u32| {
            let low = (at - reach).floor().max(0.0) as i32;
            low..=((at + reach).floor() as i32).min(count as i32 - 1)
        };
        for y in span(centre.y, frame.height()) {
            for x in span(centre.x, frame.width()) {
                let cell = Cell::new(x, y);
                if !self.seen.get(cell) {
                    let place =
                        frame.world_from_grid(Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
                    let is_seen = self.covers(pose, place) || is_seen_through(place, pose, scan);
                    self.seen.set(cell, is_seen);
                }
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seen: &SeenGround, x: f64, y: f64) -> bool {
        seen.cells().get(Cell::new((x / 0.05) as i32, (y / 0.05) as i32))
    }

    #[test]
    fn the_blind_sector_is_unseen_until_it_is_looked_at() {
        let frame = GridFrame::new(200, 200, 0.05, Pose::default()).unwrap();
        let robot = Robot::jackal();
        let mut seen = SeenGround::new(&frame, &robot).unwrap();
        let mut scan = Scan::of_nothing(&robot.sensor);
        // A wall on its left, 0.5 m away.
        for beam in 0..scan.ranges_m.len() {
            let sin = libm::sin(scan.bearing_rad(beam));
            if sin > 0.1 {
                scan.ranges_m[beam] = 0.5 / sin;
            }
        }
        seen.update(&frame, Pose::new(5.0, 5.0, 0.0), &scan);
        // The sensor sees 135 degrees to each side; the box reaches 0.254 m back.
        assert!(at(&seen, 5.5, 5.0) && at(&seen, 5.0, 4.5) && at(&seen, 4.8, 5.0));
        assert!(!at(&seen, 4.6, 5.0) && !at(&seen, 4.6, 4.7) && at(&seen, 4.6, 4.4));
        assert!(at(&seen, 5.0, 5.4) && !at(&seen, 5.0, 5.6), "behind the wall");
        let nowhere = Pose::new(f64::NAN, 5.0, -1.5);
        seen.update(&frame, nowhere, &scan);
        assert!(!at(&seen, 4.6, 5.0));
        seen.update(&frame, Pose::new(5.0, 5.0, -2.0), &scan);
        assert!(at(&seen, 4.6, 5.0), "it has turned");
    }

    #[test]
    fn who_sees_all_around_or_does_not_back_up_needs_none() {
        let frame = GridFrame::new(9, 9, 0.05, Pose::default()).unwrap();
        assert!(SeenGround::new(&frame, &Robot::small()).is_none());
        let mut robot = Robot::jackal();
        robot.sensor.field_of_view_deg = 360.0;
        assert!(SeenGround::new(&frame, &robot).is_none());
    }
}
