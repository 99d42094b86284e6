//! Measurements of a range sensor in a world: exact ray casting.

mod beams;
mod shapes;

pub(super) use beams::Beams;

use super::{StandingPolygon, WorldAt};
use keyway::geometry::{Point, Pose};
use keyway::map::RayCells;
use keyway::random::Random;
use keyway::robot::{Footprint, RangeSensor};
use keyway::sense::Scan;
use shapes::Shapes;

impl WorldAt<'_> {
    /// Returns the scan of a sensor of a robot at `pose`, without noise. Each range is the exact
    /// distance to the first square, circle or polygon: infinity beyond the sensor's range, 0
    /// inside an obstacle. There are no squares outside the map.
    ///
    /// With a field of view of 360 degrees, beam 0 points backwards (-180 degrees) and the others
    /// follow at equal angles. With a smaller field of view, the first and the last beam lie on
    /// its edges. A single beam points straight ahead.
    ///
    /// A beam is a line without width: it passes between two squares that only share a corner.
    /// Along the border of two squares, it hits the one that `map::ray` visits.
    ///
    /// The beams that [miss](super::Presence::seen) an elusive obstacle are chosen by the same
    /// random numbers for each scan.
    ///
    /// Costs a few operations per free square of cells on a beam (not per cell), per circle
    /// within range, and per beam in its direction.
    pub fn cast(&self, pose: Pose, sensor: &RangeSensor) -> Scan {
        let beams = Beams::of(sensor);
        let mut scan = beams.scan();
        self.cast_among(pose, &beams, std::iter::empty(), &mut Random::new(0), &mut scan);
        scan
    }

    /// Casts prepared beams into their scan, among other robots, each with its footprint at its
    /// pose. `glimpses` decides which beams detect an elusive obstacle.
    pub(super) fn cast_among<'f>(
        &self,
        robot: Pose,
        beams: &Beams,
        robots: impl Iterator<Item = (&'f Footprint, Pose)>,
        glimpses: &mut Random,
        scan: &mut Scan,
    ) {
        let pose = beams.pose_on(robot);
        let (point, range_max_m) = (pose.point(), scan.range_max_m);
        let ranges_m = &mut scan.ranges_m;
        self.cast_at_squares(pose, beams, range_max_m, ranges_m);
        let mut shapes = Shapes { beams, from: point, theta: pose.theta, range_max_m, ranges_m };
        self.discs().for_each(|circle| shapes.add_disc(&circle));
        for (footprint, at) in self.world().polygons().iter().map(StandingPolygon::placed) {
            shapes.add_footprint(footprint, at);
        }
        robots.for_each(|(footprint, at)| shapes.add_footprint(footprint, at));
        for elusive in self.elusive() {
            shapes.add_elusive(elusive, glimpses);
        }
        for range_m in &mut scan.ranges_m {
            if *range_m > range_max_m {
                *range_m = f64::INFINITY;
            }
        }
    }

    /// Distances along all beams to the first square; infinity if none is within `range_m` \[m\].
    fn cast_at_squares(&self, pose: Pose, beams: &Beams, range_m: f64, ranges_m: &mut Vec<f64>) {
        let frame = self.world().frame();
        let start = frame.grid_from_world(pose.point());
        let length = range_m / frame.resolution_m();
        let free = self.world().free();
        let cast = |direction: Point| {
            let ray = RayCells::new(frame, start, direction, length);
            let enter = ray.enters_first(|cell| free.steps(cell));
            enter.map_or(f64::INFINITY, |enter| enter * frame.resolution_m())
        };
        ranges_m.clear();
        ranges_m.extend(beams.directions(pose.theta - frame.origin().theta).map(cast));
    }
}

#[cfg(test)]
mod tests;
