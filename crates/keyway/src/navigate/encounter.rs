//! Encounters of two parties where there is space for one: decides which of them makes way, and
//! to where.
//!
//! The other party is assumed to want to pass, to the end of the space behind the robot. The robot
//! makes way at a position beside that path where both discs fit. The cost for the other party is
//! found in the same manner with the roles exchanged, so two robots that use this rule agree: the
//! one with the shorter path makes way.

use crate::geometry::Point;
use crate::map::Clearance;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A robot, and a moving obstacle that needs to pass it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Encounter<'a> {
    /// Stationary obstacles of the map, which contains neither party.
    pub(super) known: Clearance<'a>,
    /// Known and sensed stationary obstacles. Ignored near the two parties, since the other one
    /// may be among them.
    pub(super) seen: Clearance<'a>,
    pub(super) robot: Party,
    pub(super) other: Party,
    /// Distance that a robot keeps from the path of the other party, beyond both radii \[m\].
    pub(super) apart_m: f64,
}

/// One of the two parties.
#[derive(Clone, Copy, Debug)]
pub(super) struct Party {
    pub(super) centre: Point,
    /// Radius of the disc that must fit to drive \[m\].
    pub(super) narrow_m: f64,
    /// Radius of the disc that must fit to stand at any heading \[m\].
    pub(super) wide_m: f64,
}

/// A position at which another party can pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PassingPlace {
    pub(super) at: Point,
    /// Path length to that position \[m\].
    pub(super) way_m: f64,
}

impl Encounter<'_> {
    /// Reach of the search from the midpoint between the two, beyond half of their distance
    /// \[m\].
    pub(super) const REACH_M: f64 = 6.0;

    /// Extra path length, beyond the nearest position, that is accepted for more clearance \[m\].
    const DEEPER_M: f64 = 0.3;

    /// Path lengths that differ by less count as equal \[m\].
    const ALIKE_M: f64 = 0.3;

    /// The position at which the robot makes way, if it is the one to do so: its path is shorter,
    /// or about equal and it is the one on the left, or below. If the other party does not
    /// cooperate (`is_alone`), the robot makes way wherever it can.
    pub(super) fn place(&self, is_alone: bool) -> Option<PassingPlace> {
        let ground = Ground::around(self);
        let own = self.passing_place(&ground)?;
        if is_alone {
            return Some(own);
        }
        let Self { robot, other, .. } = *self;
        let exchanged = Self { robot: other, other: robot, ..*self };
        let Some(others) = exchanged.passing_place(&ground) else { return Some(own) };
        let longer_m = own.way_m - others.way_m;
        let is_first = longer_m.abs() <= Self::ALIKE_M && is_before(robot.centre, other.centre);
        (longer_m < -Self::ALIKE_M || is_first).then_some(own)
    }

    /// The nearest position that the robot reaches without passing the other party, beside the
    /// other party's path to the farthest end of the space behind the robot. `None` if the other
    /// party can pass the robot at its present position, or if no such position exists.
    fn passing_place(&self, ground: &Ground) -> Option<PassingPlace> {
        let Self { robot, other, apart_m, .. } = *self;
        let touching_m = robot.narrow_m + other.narrow_m;
        let nearest_m = touching_m.min(robot.centre.distance(other.centre));
        let from_robot = ground.ways(robot.centre, |place| {
            place.distance(other.centre) >= nearest_m - ground.spacing_m
        });
        let from_other = ground.ways(other.centre, |_| true);
        let behind = (0..from_other.len()).filter(|&place| from_robot[place].is_finite());
        let end = behind
            .filter(|&place| from_other[place].is_finite())
            .max_by(|&a, &b| from_other[a].total_cmp(&from_other[b]))?;
        let clear_m = touching_m + apart_m;
        let past_robot = ground.ways(other.centre, |place| place.distance(robot.centre) >= clear_m);
        if past_robot[end].is_finite() {
            return None;
        }
        let way = ground.way_to(end, &from_other);
        let beside_m = robot.wide_m + other.narrow_m + apart_m;
        let apart_m = |place: Point| {
            way.iter().map(|other| other.distance(place)).fold(f64::INFINITY, f64::min)
        };
        let is_beside = |place: Point| {
            let is_clear = |all: Clearance<'_>| all.is_clear_point(place, robot.wide_m);
            apart_m(place) >= beside_m && is_clear(self.known) && is_clear(self.seen)
        };
        let mut reached: Vec<usize> =
            (0..from_robot.len()).filter(|&place| from_robot[place].is_finite()).collect();
        reached.sort_unstable_by(|&a, &b| from_robot[a].total_cmp(&from_robot[b]));
        let nearest = reached.iter().position(|&place| is_beside(ground.place(place)))?;
        let way_m = from_robot[reached[nearest]];
        // The other party may drive along one side of its path, and there may be more clearance
        // farther on.
        let near = reached[nearest..].iter().map(|&place| (place, ground.place(place)));
        let near = near.take_while(|(place, _)| from_robot[*place] <= way_m + Self::DEEPER_M);
        let all = near.filter(|(_, place)| is_beside(*place));
        let (_, at) = all.max_by(|a, b| apart_m(a.1).total_cmp(&apart_m(b.1)))?;
        Some(PassingPlace { at, way_m })
    }
}

/// An order of two positions that both parties determine identically: along the axis on which
/// they are farther apart.
fn is_before(a: Point, b: Point) -> bool {
    let apart = b - a;
    if apart.x.abs() >= apart.y.abs() { apart.x > 0.0 } else { apart.y > 0.0 }
}

/// Sample positions around an encounter, in rows, with a flag for those at which the smaller
/// party fits.
struct Ground {
    low: Point,
    spacing_m: f64,
    columns: usize,
    is_free: Vec<bool>,
}

impl Ground {
    /// Spacing of the positions as a share of the smaller radius; at least a cell.
    const SPACING: f64 = 0.4;

    fn around(encounter: &Encounter<'_>) -> Self {
        let &Encounter { known, seen, robot, other, .. } = encounter;
        let radius_m = robot.narrow_m.min(other.narrow_m);
        let spacing_m = known.frame().resolution_m().max(Self::SPACING * radius_m);
        let reach_m = Encounter::REACH_M + 0.5 * robot.centre.distance(other.centre);
        let columns = 2 * (reach_m / spacing_m).ceil() as usize + 1;
        let half_m = 0.5 * spacing_m * (columns - 1) as f64;
        let low = robot.centre.lerp(other.centre, 0.5) - Point::new(half_m, half_m);
        let mut ground = Self { low, spacing_m, columns, is_free: Vec::new() };
        // A lane whose centreline lies between two positions counts, too: the router checks
        // exactly.
        let least_m = (radius_m - 0.5 * spacing_m).max(0.0);
        let near_m = robot.wide_m.max(other.wide_m) + radius_m + spacing_m;
        let is_free = |place: usize| {
            let place = ground.place(place);
            let beside = [robot, other].iter().any(|one| place.distance(one.centre) <= near_m);
            known.is_clear_point(place, least_m) && (beside || seen.is_clear_point(place, least_m))
        };
        ground.is_free = (0..columns * columns).map(is_free).collect();
        ground
    }

    fn place(&self, index: usize) -> Point {
        let (x, y) = ((index % self.columns) as f64, (index / self.columns) as f64);
        self.low + Point::new(x, y) * self.spacing_m
    }

    fn nearest(&self, point: Point) -> usize {
        let at = (point - self.low) * (1.0 / self.spacing_m);
        let last = (self.columns - 1) as f64;
        let (x, y) = (at.x.round().clamp(0.0, last), at.y.round().clamp(0.0, last));
        y as usize * self.columns + x as usize
    }

    /// The positions beside one, with their distances \[m\].
    fn neighbours(&self, index: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        const AROUND: [(isize, isize); 8] =
            [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        let (x, y) = (index % self.columns, index / self.columns);
        AROUND.into_iter().filter_map(move |(dx, dy)| {
            let (x, y) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
            let step_m = self.spacing_m * if dx * dy == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
            (x < self.columns && y < self.columns).then_some((y * self.columns + x, step_m))
        })
    }

    /// Shortest path lengths from a point to all positions, over those that may be entered \[m\];
    /// infinite if no path exists.
    fn ways(&self, from: Point, may_enter: impl Fn(Point) -> bool) -> Vec<f64> {
        let mut ways_m = vec![f64::INFINITY; self.is_free.len()];
        let begin = self.nearest(from);
        ways_m[begin] = 0.0;
        // Lengths are not negative, so they are in the order of their bits.
        let mut open = BinaryHeap::from([Reverse((0_u64, begin))]);
        while let Some(Reverse((bits, place))) = open.pop() {
            let way_m = f64::from_bits(bits);
            if way_m > ways_m[place] {
                continue;
            }
            for (next, step_m) in self.neighbours(place) {
                let next_m = way_m + step_m;
                if next_m < ways_m[next] && self.is_free[next] && may_enter(self.place(next)) {
                    ways_m[next] = next_m;
                    open.push(Reverse((next_m.to_bits(), next)));
                }
            }
        }
        ways_m
    }

    /// The shortest path to a position, from its end to its start.
    fn way_to(&self, end: usize, ways_m: &[f64]) -> Vec<Point> {
        let before = |&place: &usize| {
            let nearest = self
                .neighbours(place)
                .min_by(|a, b| (ways_m[a.0] + a.1).total_cmp(&(ways_m[b.0] + b.1)));
            nearest.map(|(next, _)| next).filter(|&next| ways_m[next] < ways_m[place])
        };
        std::iter::successors(Some(end), before).map(|place| self.place(place)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::OccupancyGrid;

    /// Cells of 0.1 m, a lane of 0.8 m with its centreline at y = 1 m, and a bay of 1.2 m above
    /// it.
    fn lane(bay_x: std::ops::Range<i32>) -> OccupancyGrid {
        let frame = crate::map::GridFrame::new(120, 30, 0.1, crate::geometry::Pose::default());
        OccupancyGrid::from_fn(frame.unwrap(), |cell| {
            let is_bay = bay_x.contains(&cell.x) && (14..26).contains(&cell.y);
            let is_free = is_bay || (2..118).contains(&cell.x) && (6..14).contains(&cell.y);
            if is_free { crate::map::CellState::Free } else { crate::map::CellState::Occupied }
        })
    }

    fn met(map: &OccupancyGrid, robot_x: f64, other_x: f64) -> Option<PassingPlace> {
        let clearance = Clearance::new(map.frame(), map.occupied());
        let party = |x| Party { centre: Point::new(x, 1.0), narrow_m: 0.18, wide_m: 0.18 };
        let (robot, other) = (party(robot_x), party(other_x));
        Encounter { known: clearance, seen: clearance, robot, other, apart_m: 0.1 }.place(false)
    }

    #[test]
    fn the_one_that_is_nearer_to_the_bay_makes_way() {
        let map = lane(30..40);
        let found = met(&map, 5.0, 7.0).unwrap();
        // It drives farther into the bay than necessary.
        assert!((3.0..4.0).contains(&found.at.x) && found.at.y > 1.6, "{found:?}");
        assert!((1.5..2.5).contains(&found.way_m), "{found:?}");
        assert_eq!(met(&map, 7.0, 5.0), None, "the other one is nearer");
        // From the other side the bay is between them.
        let between = met(&map, 2.0, 6.0).unwrap();
        assert!((3.0..4.0).contains(&between.at.x) && between.at.y > 1.46, "{between:?}");
    }

    #[test]
    fn of_two_alike_one_makes_way() {
        let map = lane(55..65);
        assert!(met(&map, 5.0, 7.0).is_some());
        assert_eq!(met(&map, 7.0, 5.0), None);
    }

    #[test]
    fn who_can_be_passed_where_it_is_stays() {
        let map = lane(45..75);
        let clearance = Clearance::new(map.frame(), map.occupied());
        let party = |x, y| Party { centre: Point::new(x, y), narrow_m: 0.18, wide_m: 0.18 };
        let place = |x, y| {
            let (robot, other) = (party(x, y), party(8.5, 1.0));
            Encounter { known: clearance, seen: clearance, robot, other, apart_m: 0.1 }.place(true)
        };
        assert_eq!(place(5.5, 2.3), None, "it stands in the bay");
        assert_eq!(place(5.5, 1.0), None, "the other one can drive through the bay");
        assert!(place(4.0, 1.0).is_some());
    }

    #[test]
    fn without_room_nobody_makes_way() {
        let map = lane(0..0);
        assert_eq!(met(&map, 5.0, 7.0), None);
        assert_eq!(met(&map, 7.0, 5.0), None);
    }
}
