//! One control cycle of a differential drive, and what it touches on its way.

use super::{World, WorldAt};
use crate::geometry::{Pose, Velocity};
use crate::robot::Footprint;

/// Pieces of a cycle's motion, each an exact arc.
const ARCS: usize = Pose::RAMP_ARCS as usize;

/// Below this \[m\] a stretch is not halved any more: it touches when it cannot be shown not to,
/// and the smallest clearance is accurate to that.
pub(super) const TOLERANCE_M: f64 = 1e-4;

/// The motion of one cycle, in which the velocity changes linearly: the arcs of
/// [`Pose::after_ramp`]. Places on it are given in arcs, from 0 to [`Self::END`].
#[derive(Clone, Debug)]
pub(super) struct CycleMotion {
    from: Velocity,
    to: Velocity,
    duration_s: f64,
    arcs: [Arc; ARCS],
}

/// One of the arcs.
#[derive(Clone, Copy, Debug)]
struct Arc {
    start: Pose,
    velocity: Velocity,
    /// Length driven before it \[m\].
    driven_m: f64,
    /// What was turned before it, to either side \[rad\].
    turned_rad: f64,
}

impl CycleMotion {
    /// The place at the end of the cycle.
    pub(super) const END: f64 = ARCS as f64;

    pub(super) fn new(start: Pose, from: Velocity, to: Velocity, duration_s: f64) -> Self {
        let arc_s = duration_s / Self::END;
        let (mut pose, mut driven_m, mut turned_rad) = (start, 0.0, 0.0);
        let arcs = std::array::from_fn(|i| {
            let velocity = from.lerp(to, (i as f64 + 0.5) / Self::END);
            let arc = Arc { start: pose, velocity, driven_m, turned_rad };
            pose = pose.after_arc(velocity, arc_s);
            driven_m += velocity.v.abs() * arc_s;
            turned_rad += velocity.omega.abs() * arc_s;
            arc
        });
        Self { from, to, duration_s, arcs }
    }

    pub(super) fn pose(&self, place: f64) -> Pose {
        let (arc, since_s) = self.arc(place);
        arc.start.after_arc(arc.velocity, since_s)
    }

    pub(super) fn velocity(&self, place: f64) -> Velocity {
        self.from.lerp(self.to, place / Self::END)
    }

    /// Length driven up to a place \[m\].
    pub(super) fn driven_m(&self, place: f64) -> f64 {
        let (arc, since_s) = self.arc(place);
        arc.driven_m + arc.velocity.v.abs() * since_s
    }

    /// What was turned up to a place, to either side \[rad\].
    pub(super) fn turned_rad(&self, place: f64) -> f64 {
        let (arc, since_s) = self.arc(place);
        arc.turned_rad + arc.velocity.omega.abs() * since_s
    }

    /// Time from the beginning to a place \[s\].
    pub(super) fn elapsed_s(&self, place: f64) -> f64 {
        place * (self.duration_s / Self::END)
    }

    /// The arc of a place, and the time since its beginning \[s\].
    fn arc(&self, place: f64) -> (&Arc, f64) {
        let i = (place as usize).min(ARCS - 1);
        (&self.arcs[i], (place - i as f64) * (self.duration_s / Self::END))
    }
}

/// A footprint swept along a cycle's motion, among obstacles that move at the same time.
///
/// The distance between two things changes at most by how far parts of both move. So between two places
/// between which they move by `ds` together and whose clearances are `c1` and `c2`, a place after a
/// move of `s` has at least `max(c1 - s, c2 - (ds - s))`, which is smallest where both are equal:
/// `(c1 + c2 - ds) / 2`. Where that bound is not enough the stretch is halved.
pub(super) struct Sweep<'a> {
    pub(super) world: &'a World,
    pub(super) motion: &'a CycleMotion,
    pub(super) footprint: &'a Footprint,
    /// Time at the motion's beginning \[s\].
    pub(super) start_s: f64,
}

/// A place on the motion and the footprint's clearance there \[m\].
#[derive(Clone, Copy)]
struct Probe {
    place: f64,
    clearance_m: f64,
}

impl Sweep<'_> {
    /// The first place from which on the footprint touches an obstacle or leaves the map, to
    /// [`TOLERANCE_M`]: a gap that the bound cannot tell from contact on a shorter stretch than
    /// that (so one of at most half of it) is contact. The motion's beginning is assumed to be
    /// free.
    pub(super) fn first_contact(&self) -> Option<f64> {
        let moved_m = self.moved_m(0.0, CycleMotion::END);
        if moved_m == 0.0 {
            return None;
        }
        // Two clearances of the stretch's length are always enough: none needs to be known beyond.
        // The tolerance keeps a length shorter than the radius' last digit from looking like
        // contact.
        let reach_m = moved_m + TOLERANCE_M;
        let probe = |place| {
            let pose = self.motion.pose(place);
            let world = self.world_at(place);
            let free_m = world.distance(self.footprint, pose, reach_m);
            let clearance_m = free_m.min(world.border_distance(self.footprint, pose));
            Probe { place, clearance_m }
        };
        self.contact_between(probe(0.0), probe(CycleMotion::END), &probe)
    }

    fn contact_between(&self, a: Probe, b: Probe, probe: &impl Fn(f64) -> Probe) -> Option<f64> {
        let moved_m = self.moved_m(a.place, b.place);
        if least_between(a, b, moved_m) > 0.0 {
            return None;
        }
        let half_way = 0.5 * (a.place + b.place);
        // A velocity beyond all measure can exhaust the places before the tolerance is met.
        if moved_m < TOLERANCE_M || half_way <= a.place || half_way >= b.place {
            return Some(a.place);
        }
        let middle = probe(half_way);
        self.contact_between(a, middle, probe).or_else(|| self.contact_between(middle, b, probe))
    }

    /// The smaller of `known_m` and the footprint's smallest clearance to an obstacle up to a place
    /// on the motion, accurate to [`TOLERANCE_M`].
    pub(super) fn least_clearance(&self, until: f64, known_m: f64) -> f64 {
        // Anything farther away cannot matter on this motion.
        let reach_m = known_m + self.moved_m(0.0, until);
        let probe = |place| {
            let pose = self.motion.pose(place);
            let clearance_m = self.world_at(place).distance(self.footprint, pose, reach_m);
            Probe { place, clearance_m }
        };
        let (a, b) = (probe(0.0), probe(until));
        let mut least = known_m.min(a.clearance_m).min(b.clearance_m);
        self.least_within(a, b, &probe, &mut least);
        least
    }

    fn least_within(&self, a: Probe, b: Probe, probe: &impl Fn(f64) -> Probe, least: &mut f64) {
        let half_way = 0.5 * (a.place + b.place);
        let moved_m = self.moved_m(a.place, b.place);
        let enough = least_between(a, b, moved_m) >= *least - TOLERANCE_M;
        if enough || half_way <= a.place || half_way >= b.place {
            return;
        }
        let middle = probe(half_way);
        *least = least.min(middle.clearance_m);
        self.least_within(a, middle, probe, least);
        self.least_within(middle, b, probe, least);
    }

    fn world_at(&self, place: f64) -> WorldAt<'_> {
        self.world.at(self.start_s + self.motion.elapsed_s(place))
    }

    /// What parts of the footprint and any obstacle move together between two places, at most \[m\].
    fn moved_m(&self, from: f64, to: f64) -> f64 {
        let driven_m = self.motion.driven_m(to) - self.motion.driven_m(from);
        let turned_rad = self.motion.turned_rad(to) - self.motion.turned_rad(from);
        let elapsed_s = self.motion.elapsed_s(to) - self.motion.elapsed_s(from);
        let (core, _) = self.footprint.core();
        core.moves_m(driven_m, turned_rad) + self.world.fastest_mps() * elapsed_s
    }
}

/// The least clearance that a stretch between two places can have.
fn least_between(a: Probe, b: Probe, moved_m: f64) -> f64 {
    0.5 * (a.clearance_m + b.clearance_m - moved_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Segment, holds_point, outline};
    use crate::map::{Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
    use crate::sim::Circle;
    use proptest::prelude::*;

    fn open(circles: Vec<Circle>) -> World {
        let frame = GridFrame::new(100, 100, 0.1, Pose::new(-5.0, -5.0, 0.0)).unwrap();
        World::from_known(&OccupancyGrid::all_free(frame), circles).unwrap()
    }

    #[test]
    fn ends_where_the_ramp_ends() {
        let (from, to) = (Velocity::new(0.5, -0.3), Velocity::new(0.4, 0.2));
        let start = Pose::new(1.0, 2.0, 0.7);
        let motion = CycleMotion::new(start, from, to, 0.1);
        assert_eq!(motion.pose(CycleMotion::END), start.after_ramp(from, to, 0.1));
        assert_eq!(motion.pose(0.0), start);
        assert_eq!((motion.velocity(0.0), motion.velocity(CycleMotion::END)), (from, to));
        assert!((motion.driven_m(CycleMotion::END) - 0.045).abs() < 1e-15);
        // 0.05 s at a mean of 0.475 m/s.
        assert!((motion.driven_m(2.0) - 0.02375).abs() < 1e-15);
    }

    #[test]
    fn a_stretch_is_certified_by_its_ends_or_halved() {
        let at = |place, clearance_m| Probe { place, clearance_m };
        assert!((least_between(at(0.0, 0.3), at(4.0, 0.2), 0.4) - 0.05).abs() < 1e-15);
        assert!(least_between(at(0.0, 0.3), at(4.0, 0.2), 0.6) < 0.0);
    }

    #[test]
    fn a_turn_on_the_spot_touches_nothing_new() {
        let world = open(vec![Circle::standing(Point::new(0.3, 0.0), 0.1)]);
        let turn = Velocity::new(0.0, 1.0);
        let motion = CycleMotion::new(Pose::default(), turn, turn, 0.5);
        let footprint = Footprint::circle(0.2).unwrap();
        let sweep = Sweep { world: &world, motion: &motion, footprint: &footprint, start_s: 0.0 };
        assert_eq!(sweep.first_contact(), None);
    }

    #[test]
    fn leaving_the_map_is_contact() {
        let world = open(vec![]);
        let ahead = Velocity::new(1.0, 0.0);
        let motion = CycleMotion::new(Pose::new(4.5, 0.0, 0.0), ahead, ahead, 1.0);
        let footprint = Footprint::circle(0.25).unwrap();
        let sweep = Sweep { world: &world, motion: &motion, footprint: &footprint, start_s: 0.0 };
        let place = sweep.first_contact().unwrap();
        assert!((motion.pose(place).x - 4.75).abs() < TOLERANCE_M);
    }

    proptest! {
        #[test]
        fn agrees_with_dense_sampling(occupied in prop::collection::vec(prop::bool::weighted(0.03), 20 * 20),
                                      circle in (0.0..2.0f64, 0.0..2.0f64, 0.0..0.1f64),
                                      v in (-1.0..1.0f64, -1.0..1.0f64),
                                      omega in (-3.0..3.0f64, -3.0..3.0f64),
                                      theta in -3.0..3.0f64, radius_m in 0.0..0.2f64) {
            let frame = GridFrame::new(20, 20, 0.1, Pose::default()).unwrap();
            let mut each = occupied.iter();
            let start = Pose::new(1.0, 1.0, theta);
            let known = OccupancyGrid::from_fn(frame, |cell| {
                let near = (cell.x - 10).abs().max((cell.y - 10).abs()) <= 2;
                if *each.next().unwrap() && !near { CellState::Occupied } else { CellState::Free }
            });
            let circle = Circle::standing(Point::new(circle.0, circle.1), circle.2);
            let footprint = Footprint::circle(radius_m).unwrap();
            let world = World::from_known(&known, vec![circle]).unwrap();
            prop_assume!(world.at(0.0).distance(&footprint, start, 1.0) > TOLERANCE_M);
            let motion = CycleMotion::new(start, Velocity::new(v.0, omega.0), Velocity::new(v.1, omega.1), 1.0);
            let sweep = Sweep { world: &world, motion: &motion, footprint: &footprint, start_s: 0.0 };
            // Brute force over all squares at 20000 places, 0.05 mm apart.
            let squares: Vec<Cell> = frame.cells().filter(|&c| known.occupied().get(c)).collect();
            let clearance = |place: f64| {
                let p = motion.pose(place).point();
                let to_square = |c: &Cell| {
                    let half = |centre: f64, at: f64| ((at - centre).abs() - 0.05).max(0.0);
                    let centre = frame.world_from_cell(*c);
                    half(centre.x, p.x).hypot(half(centre.y, p.y))
                };
                squares.iter().map(to_square).fold(circle.distance(p), f64::min) - radius_m
            };
            let border = |place: f64| {
                let p = motion.pose(place).point();
                p.x.min(p.y).min(2.0 - p.x).min(2.0 - p.y) - radius_m
            };
            let places = (0..=20_000).map(|i| f64::from(i) / 5000.0);
            let touched = places.clone().find(|&s| clearance(s).min(border(s)) <= 0.0);
            let contact = sweep.first_contact();
            if let Some(touched) = touched {
                prop_assert!(contact.is_some_and(|s| s <= touched), "{contact:?} {touched}");
            }
            if let Some(contact) = contact {
                let gap = clearance(contact).min(border(contact));
                prop_assert!(gap > -1e-12 && gap < TOLERANCE_M, "gap {gap}");
            }
            let until = contact.unwrap_or(CycleMotion::END);
            let sampled = places.filter(|&s| s <= until).map(clearance).fold(9.0, f64::min);
            let least = sweep.least_clearance(until, 9.0);
            prop_assert!((least - sampled).abs() < 2.0 * TOLERANCE_M, "{least} {sampled}");
            prop_assert_eq!(sweep.least_clearance(until, least * 0.5), least * 0.5);
        }

        /// Polygons that turn among squares and a circle that moves: free before the contact, and touching
        /// there.
        #[test]
        fn first_contact_of_polygons_among_movers(
            occupied in prop::collection::vec(prop::bool::weighted(0.02), 20 * 20),
            circle in (0.0..2.0f64, 0.0..2.0f64, 0.0..0.1f64), speed in (-2.0..2.0f64, -2.0..2.0f64),
            radii in prop::collection::vec(0.05..0.4f64, 3..7), offset in (-0.2..0.2f64, -0.2..0.2f64),
            v in (-1.0..1.0f64, -1.0..1.0f64), omega in (-3.0..3.0f64, -3.0..3.0f64),
            theta in -3.0..3.0f64, start_s in 0.0..3.0f64,
        ) {
            let frame = GridFrame::new(20, 20, 0.1, Pose::default()).unwrap();
            let known = OccupancyGrid::from_occupied(frame, &occupied);
            let velocity_mps = Point::new(speed.0, speed.1);
            let circle = Circle { velocity_mps, ..Circle::standing(Point::new(circle.0, circle.1), circle.2) };
            let world = World::from_known(&known, vec![circle]).unwrap();
            let step = std::f64::consts::TAU / radii.len() as f64;
            let vertices: Vec<Point> = radii.iter().enumerate().map(|(i, &radius)| {
                let (sin, cos) = (step * i as f64).sin_cos();
                Point::new(offset.0 + radius * cos, offset.1 + radius * sin)
            }).collect();
            let footprint = Footprint::polygon(vertices.clone()).unwrap();
            let motion = CycleMotion::new(Pose::new(1.0, 1.0, theta), Velocity::new(v.0, omega.0),
                                          Velocity::new(v.1, omega.1), 1.0);
            let sweep = Sweep { world: &world, motion: &motion, footprint: &footprint, start_s };
            let field = DistanceField::new(&frame, known.occupied(), &FieldConfig::default());
            let is_free = |place: f64| {
                let (pose, t_s) = (motion.pose(place), start_s + 0.25 * place);
                let centre = circle.centre + velocity_mps * t_s;
                let placed: Vec<Point> = vertices.iter().map(|&v| pose.world_from_body(v)).collect();
                let gap = |i: usize| {
                    let edge = Segment::new(placed[i], placed[(i + 1) % placed.len()]);
                    edge.distance_sq_to_point(centre).sqrt() - circle.radius_m
                };
                let is_apart = (0..placed.len()).all(|i| gap(i) > 0.0);
                is_apart && !holds_point(outline(placed.iter().copied()), centre)
                    && footprint.is_free(pose, &field)
            };
            prop_assume!(is_free(0.0) && world.at(start_s).distance(&footprint, motion.pose(0.0), 1.0) > TOLERANCE_M);
            let contact = sweep.first_contact();
            let until = contact.unwrap_or(CycleMotion::END);
            let mut places = (0..=4000).map(|i| f64::from(i) / 1000.0).filter(|&place| place <= until);
            prop_assert!(places.all(is_free));
            if contact.is_some() {
                let (pose, world) = (motion.pose(until), sweep.world_at(until));
                let gap_m = world.distance(&footprint, pose, 1.0).min(world.border_distance(&footprint, pose));
                prop_assert!(gap_m < TOLERANCE_M, "{gap_m}");
            }
        }
    }
}
