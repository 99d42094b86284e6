//! The start of a cycle: the parts of the robot, and the obstacles from which each must keep
//! away.

use super::Surroundings;
use crate::geometry::{Point, Pose};
use crate::map::{Cell, Clearance, Core};
use crate::robot::Robot;
use crate::sense::ProjectedScan;
use arrayvec::ArrayVec;

/// Largest rounding error of a distance \[m\]: an obstacle at this distance or less is touched,
/// because a negative distance cannot be kept from it.
pub(super) const ROUNDING_M: f64 = 1e-9;

/// The part of the robot that must not come near to stationary obstacles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<'a> {
    pub(super) core: Core<'a>,
    /// The body is all ground this near to the core \[m\].
    pub(super) radius_m: f64,
    /// Distance that it must keep \[m\].
    pub(super) kept_m: f64,
    /// True if it must keep that from the map's border, too.
    pub(super) keeps_border: bool,
}

/// The centre of rotation is inside an obstacle or outside the map.
pub(super) struct Covered;

/// Obstacles that a robot touches at the beginning of a cycle.
#[derive(Debug, Default)]
pub(super) struct Touched {
    /// Obstacle squares, row by row: those that it touches, and those beside them in which the
    /// latest scans have hits.
    pub(super) squares: Vec<Cell>,
    /// Hits of the scans near the robot, outside of it.
    pub(super) places: Vec<Point>,
    /// Distance that it must keep from those hits \[m\].
    pub(super) places_kept_m: f64,
}

impl Touched {
    /// Nothing is touched.
    pub(super) fn clear(&mut self) {
        self.squares.clear();
        self.places.clear();
        self.places_kept_m = f64::INFINITY;
    }

    /// Clearance of a robot from the hits, beyond the distance to keep \[m\]; infinite without
    /// any.
    pub(super) fn spare_m(&self, (core, radius_m): (&Core<'_>, f64), pose: Pose) -> f64 {
        let least_m = radius_m + self.places_kept_m;
        let spare_m = |&place: &Point| core.distance_to_m(pose, place) - least_m;
        self.places.iter().map(spare_m).fold(f64::INFINITY, f64::min)
    }

    /// Adds the squares with scan hits beside those that are touched: the hits locate the
    /// obstacle better than the squares.
    fn add_squares_met(&mut self, scans: &[ProjectedScan], clearance: &Clearance<'_>) {
        let count = self.squares.len();
        let hits = scans.iter().flat_map(ProjectedScan::hits);
        for cell in hits.filter_map(|(_, hit)| hit.cell) {
            let is_beside =
                |&one: &Cell| (one.x - cell.x).abs() <= 1 && (one.y - cell.y).abs() <= 1;
            let touched = &self.squares[..count];
            if clearance.obstacles().get(cell) && touched.iter().any(is_beside) {
                self.squares.push(cell);
            }
        }
        self.squares.sort_unstable_by_key(|cell| (cell.y, cell.x));
        self.squares.dedup();
    }

    /// Collects the scan hits around a robot; those inside of the robot are ignored. Returns the
    /// distance to the nearest, `reach_m` if none is nearer.
    fn note_places(
        &mut self,
        scans: &[ProjectedScan],
        (core, radius_m): (&Core<'_>, f64),
        pose: Pose,
        (reach_m, cell_m): (f64, f64),
    ) -> f64 {
        let around_m = core.swing_m() + radius_m + reach_m;
        let joined_m = Self::JOINED_CELLS * cell_m;
        for scan in scans {
            scan.note_places(pose.point(), around_m, joined_m, &mut self.places);
        }
        let mut nearest_m = reach_m;
        self.places.retain(|&place| {
            let room_m = core.distance_to_m(pose, place) - radius_m;
            let matters = room_m > ROUNDING_M && room_m <= reach_m;
            if matters {
                nearest_m = nearest_m.min(room_m);
            }
            matters
        });
        nearest_m
    }

    /// Hits of neighbouring beams that are no farther apart than this belong to the same obstacle
    /// \[cells\].
    const JOINED_CELLS: f64 = 1.5;
}

/// A robot at the beginning of a cycle.
pub(super) struct Start<'a> {
    pub(super) robot: &'a Robot,
    pub(super) around: &'a Surroundings<'a>,
    pub(super) margin_m: f64,
}

impl<'a> Start<'a> {
    /// Halvings after which a shrunk footprint is exact enough: a part in 65536.
    const HALVINGS: u32 = 16;

    /// The bodies that count for motions of up to `moves_m`: none if nothing is within reach. If
    /// the robot touches something, first the part of it that may touch nothing at all, then the
    /// whole, which may touch nothing except `touched`.
    pub(super) fn bodies(
        &self,
        moves_m: f64,
        shrunk: &'a mut Vec<Point>,
        touched: &mut Touched,
    ) -> Result<ArrayVec<Body<'a>, 2>, Covered> {
        let (obstacles, (pose, _)) = (self.around.obstacles, self.around.robot());
        let clearance = obstacles.clearance();
        let (core, radius_m) = self.robot.footprint.core();
        let reach_m = radius_m + self.margin_m + moves_m;
        let centre_m = obstacles.square_bounds_m(pose.point()).0;
        if centre_m.min(clearance.to_border(pose.point())) - core.swing_m() >= reach_m {
            return Ok(ArrayVec::new());
        }
        let core_room_m = room_m(&core, pose, &clearance, reach_m);
        let room_m = core_room_m - radius_m;
        let first = Body { core, radius_m, kept_m: self.kept_m(room_m), keeps_border: true };
        if room_m > ROUNDING_M {
            return Ok(ArrayVec::from_iter([first]));
        }
        let centre = Core::polygon(&[]);
        if self::room_m(&centre, pose, &clearance, reach_m) <= ROUNDING_M {
            return Err(Covered);
        }
        let part = if core.vertices().is_empty() {
            first
        } else {
            let core = self.shrink(core.vertices(), shrunk, reach_m);
            let room_m = self::room_m(&core, pose, &clearance, reach_m);
            Body { core, radius_m: 0.0, kept_m: self.kept_m(room_m), keeps_border: true }
        };
        Ok(ArrayVec::from([part, self.whole(moves_m, touched)]))
    }

    /// The whole robot, against obstacles that it does not touch now. In the squares beside the
    /// touched ones, it keeps away from the scan hits, so that a robot that touches the squares
    /// of a wall may drive along it.
    fn whole(&self, moves_m: f64, touched: &mut Touched) -> Body<'a> {
        let Surroundings { obstacles, seen, .. } = *self.around;
        let (pose, _) = self.around.robot();
        let clearance = obstacles.clearance();
        let (core, radius_m) = self.robot.footprint.core();
        let touch_m = radius_m + ROUNDING_M;
        core.touched(pose, &clearance, touch_m, &mut touched.squares);
        if !seen.scans.is_empty() {
            touched.add_squares_met(seen.scans, &clearance);
            let reach = (self.margin_m + moves_m, obstacles.frame().resolution_m());
            let room_m = touched.note_places(seen.scans, (&core, radius_m), pose, reach);
            touched.places_kept_m = self.kept_m(room_m);
        }
        let reach_m = touch_m.max(radius_m + self.margin_m);
        let to_others_m = core.distance_without_m(pose, &clearance, reach_m, &touched.squares);
        let to_others_m = to_others_m - radius_m;
        let to_border_m = core.to_border_m(pose, &clearance) - radius_m;
        let keeps_border = to_border_m > ROUNDING_M;
        let room_m = if keeps_border { to_others_m.min(to_border_m) } else { to_others_m };
        Body { core, radius_m, kept_m: self.kept_m(room_m), keeps_border }
    }

    /// The margin, or the present clearance if that is less.
    fn kept_m(&self, room_m: f64) -> f64 {
        self.margin_m.min(room_m - ROUNDING_M)
    }

    /// The polygon, scaled around the centre of rotation to the largest size that covers nothing.
    fn shrink(&self, vertices: &[Point], shrunk: &'a mut Vec<Point>, reach_m: f64) -> Core<'a> {
        let (obstacles, (pose, _)) = (self.around.obstacles, self.around.robot());
        let mut fill = |scale: f64| {
            shrunk.clear();
            shrunk.extend(vertices.iter().map(|&vertex| vertex * scale));
            let room_m = room_m(&Core::polygon(shrunk), pose, &obstacles.clearance(), reach_m);
            room_m > ROUNDING_M
        };
        let (mut free, mut covering) = (0.0, 1.0);
        for _ in 0..Self::HALVINGS {
            let middle = 0.5 * (free + covering);
            *(if fill(middle) { &mut free } else { &mut covering }) = middle;
        }
        fill(free);
        Core::polygon(shrunk)
    }
}

/// Clearance at a pose from obstacles and border \[m\], negative outside the map.
fn room_m(core: &Core<'_>, pose: Pose, clearance: &Clearance<'_>, reach_m: f64) -> f64 {
    core.distance_m(pose, clearance, reach_m).min(core.to_border_m(pose, clearance))
}
