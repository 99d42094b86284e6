//! Manoeuvres: a pose in a tight place -> rotations on the spot and straight drives that lead on
//! along the route. A robot that cannot turn in place drives arcs (`primitives.rs`), which the
//! search alone uses.
//!
//! A route is planned for a disc. If the robot can follow it exactly, with rotations on the spot
//! at its corners, it does so: that needs little margin. If only the inscribed disc fits, a
//! longer robot may have to rotate first, drive out, and rotate again: aligned with a narrow
//! passage (`line_up.rs`), or as found by a search over positions and headings. That is a
//! best-first search by time over squares of at most a cell and headings [`STEP_RAD`] apart, in
//! which each motion is certified for the whole footprint. It ends at a position at which the
//! robot can turn around again, with a point of the route farther on in line of sight, or at the
//! end of the route. If there is no such position, as in front of a lane too narrow to turn in,
//! and if the robot faces away from its route and cannot turn there, the search leads to a
//! position at which it can turn, in line of sight of the nearby route, which it then faces.
//!
//! Cost: up to [`MOST_NODES`] expansions, a few microseconds each, while the robot is stationary.

use super::motion::Motion;
use crate::geometry::{Point, Polyline, Pose, Segment, wrap_angle};
use crate::map::DistanceField;
use crate::navigate::watch::RestOfRoute;
use crate::robot::Robot;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};
use std::f64::consts::{FRAC_PI_6, TAU};

/// Number of headings of the search.
const HEADINGS: i32 = 36;

/// Angle between two headings \[rad\].
pub(super) const STEP_RAD: f64 = TAU / HEADINGS as f64;

/// Expansions after which the search gives up.
const MOST_NODES: usize = 50_000;

/// Largest bearing of the route at which the robot can drive along it \[rad\].
const ASIDE_RAD: f64 = FRAC_PI_6;

/// Reach of the search from the robot \[circumscribed radii, or cells for a robot that is smaller
/// than one\].
const REACH_SIZES: f64 = 10.0;

/// A robot in a tight place.
#[derive(Clone, Copy, Debug)]
pub(in crate::navigate) struct TightPlace<'a> {
    pub(in crate::navigate) robot: &'a Robot,
    pub(in crate::navigate) obstacles: &'a DistanceField,
    pub(in crate::navigate) path: &'a Polyline,
    /// Progress of the robot along the path \[m\].
    pub(in crate::navigate) covered_m: f64,
    /// Tolerance to the end of the path \[m\].
    pub(in crate::navigate) goal_tolerance_m: f64,
    /// Clearance that its motions keep \[m\].
    pub(in crate::navigate) room_m: f64,
}

/// A pose reached by the search.
struct Node {
    pose: Pose,
    heading: i32,
    time_s: f64,
    /// The node before this one, and the motion from there.
    by: Option<(usize, Motion)>,
}

/// End of a manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// At the goal.
    Goal,
    /// In line of sight of this point of the route.
    OnTheWay(Point),
}

/// An entry of the open list: the smallest estimate first (as bits, which order like non-negative
/// numbers), then the oldest.
type Entry = Reverse<(u64, usize)>;

impl TightPlace<'_> {
    /// The motions that lead on, or to a position at which the robot can turn, merged; `None` if
    /// there are none, or the search exceeds its limit.
    pub(in crate::navigate) fn manoeuvre(&self, pose: Pose) -> Option<Vec<Motion>> {
        let stations = self.stations();
        self.along_route(pose, &stations)
            .or_else(|| self.lined_up(pose))
            .or_else(|| self.searched(pose, &stations))
            .or_else(|| self.off_a_wall(pose, &stations))
    }

    /// The route itself, corner by corner, if the footprint fits: no search follows a gap that is
    /// hardly wider than the robot as exactly as the route does.
    fn along_route(&self, pose: Pose, stations: &[Point]) -> Option<Vec<Motion>> {
        let (mut pose, mut motions) = (pose, Vec::new());
        let rest = RestOfRoute { path: self.path, covered_m: self.covered_m };
        for leg in rest.segments() {
            let length_m = pose.point().distance(leg.b);
            let turn = Motion::Turn(pose.bearing_to(leg.b));
            let facing_leg = after(pose, turn);
            let step_m = 0.25 * self.size_m();
            let lengths_m = (1..).map(|i| step_m * f64::from(i)).take_while(|&m| m < length_m);
            let mut places = lengths_m.map(|driven_m| after(facing_leg, Motion::Drive(driven_m)));
            let place = places.find_map(|at| Some((at, self.leads_on(at, stations)?)));
            let end = place.map_or(leg.b, |(at, _)| at.point());
            let drive = Motion::Drive(pose.point().distance(end));
            if !self.is_free(pose, turn) || !self.is_free(facing_leg, drive) {
                return None;
            }
            motions.extend([turn, drive]);
            pose = after(facing_leg, drive);
            if let Some(place) = place.map(|(_, place)| place).or(self.leads_on(pose, stations)) {
                return Some(self.facing(motions, pose, place));
            }
        }
        None
    }

    pub(super) fn searched(&self, pose: Pose, stations: &[Point]) -> Option<Vec<Motion>> {
        let mut nodes = vec![Node { pose, heading: 0, time_s: 0.0, by: None }];
        let mut open: BinaryHeap<Entry> = BinaryHeap::from([Reverse((0, 0))]);
        let mut closed = HashSet::new();
        let here = if self.is_stuck_aside(pose) { self.stations_here() } else { Vec::new() };
        let mut turning_place = None;
        while let Some(Reverse((_, index))) = open.pop() {
            let Node { pose, heading, time_s, .. } = nodes[index];
            if !closed.insert(self.place(pose, heading)) {
                continue;
            }
            if index > 0
                && let Some(place) = self.leads_on(pose, stations)
            {
                return Some(self.facing(merged(&nodes, index), pose, place));
            }
            if closed.len() > MOST_NODES {
                break;
            }
            if index > 0 && turning_place.is_none() && !here.is_empty() {
                turning_place = self.leads_on(pose, &here).map(|place| (index, place));
            }
            for (motion, turned) in self.motions() {
                let to = after(pose, motion);
                let heading = (heading + turned).rem_euclid(HEADINGS);
                let is_known = closed.contains(&self.place(to, heading));
                let is_near = to.point().distance(nodes[0].pose.point()) <= self.reach_m();
                if is_known || !is_near || !self.is_free(pose, motion) {
                    continue;
                }
                let time_s = time_s + self.time_s(motion);
                let estimate_s = time_s + self.least_time_s(to.point(), stations);
                open.push(Reverse((estimate_s.to_bits(), nodes.len())));
                nodes.push(Node { pose: to, heading, time_s, by: Some((index, motion)) });
            }
        }
        let (index, place) = turning_place?;
        Some(self.facing(merged(&nodes, index), nodes[index].pose, place))
    }

    pub(super) fn radius_m(&self) -> f64 {
        self.robot.footprint.circumscribed_radius_m()
    }

    /// The circumscribed radius; for a robot that is smaller than a cell, or a point, the side of
    /// a cell \[m\].
    pub(super) fn size_m(&self) -> f64 {
        self.radius_m().max(self.obstacles.frame().resolution_m())
    }

    pub(super) fn reach_m(&self) -> f64 {
        REACH_SIZES * self.size_m()
    }

    /// Points of the route within reach, from one circumscribed radius ahead.
    fn stations(&self) -> Vec<Point> {
        self.stations_between(self.size_m(), self.reach_m())
    }

    /// Points of the route from the robot's progress to the first station.
    fn stations_here(&self) -> Vec<Point> {
        self.stations_between(0.0, self.size_m())
    }

    /// Points of the route at these distances ahead of the robot.
    fn stations_between(&self, nearest_m: f64, farthest_m: f64) -> Vec<Point> {
        let step_m = 0.25 * self.size_m();
        let ahead = (0..).map(|i| self.covered_m + nearest_m + step_m * f64::from(i));
        let until_m = self.path.length_m().min(self.covered_m + farthest_m);
        let mut stations: Vec<Point> = ahead
            .take_while(|&along_m| along_m < until_m)
            .filter_map(|along_m| self.path.at_length(along_m))
            .collect();
        stations.extend(self.path.at_length(until_m));
        stations
    }

    /// The point of the route to which the robot can go on from here as usual.
    fn leads_on(&self, pose: Pose, stations: &[Point]) -> Option<Place> {
        let point = pose.point();
        if self.is_at_goal(point) {
            return Some(Place::Goal);
        }
        if !self.has_room_to_turn(pose) {
            return None;
        }
        let clearance = self.obstacles.clearance();
        let inscribed_m = self.robot.footprint.inscribed_radius_m();
        let faces = |station: Point| {
            self.robot.limits.turns_in_place() || pose.bearing_to(station).abs() <= ASIDE_RAD
        };
        let is_next = |station: &&Point| {
            station.distance(point) <= self.size_m()
                && faces(**station)
                && clearance.is_clear(Segment::new(point, **station), inscribed_m)
        };
        stations.iter().rev().find(is_next).map(|&station| Place::OnTheWay(station))
    }

    /// Motions to a pose with space to turn, followed by a rotation towards the point that they
    /// lead to, if the robot turns in place.
    fn facing(&self, mut motions: Vec<Motion>, pose: Pose, place: Place) -> Vec<Motion> {
        let Place::OnTheWay(station) = place else { return motions };
        if !self.robot.limits.turns_in_place() {
            return motions;
        }
        let bearing_rad = pose.bearing_to(station);
        if let Some(Motion::Turn(turn_rad)) = motions.last_mut() {
            *turn_rad = wrap_angle(*turn_rad + bearing_rad);
        } else {
            motions.push(Motion::Turn(bearing_rad));
        }
        motions
    }

    /// True if the robot does not face along its route, and has no space to turn there.
    fn is_stuck_aside(&self, pose: Pose) -> bool {
        let ahead = self.path.at_length(self.covered_m + self.size_m());
        ahead.is_some_and(|ahead| pose.bearing_to(ahead).abs() > ASIDE_RAD)
            && !self.is_free(pose, Motion::Turn(TAU))
    }

    pub(super) fn is_free(&self, pose: Pose, motion: Motion) -> bool {
        motion.keeps_room(self.robot, pose, self.room_m, self.obstacles)
    }

    /// Lower bound on the time of a manoeuvre: straight until a point of the route is close
    /// enough.
    fn least_time_s(&self, point: Point, stations: &[Point]) -> f64 {
        let nearest_m = stations.iter().map(|s| s.distance(point)).fold(f64::INFINITY, f64::min);
        let near_m = self.size_m().max(self.goal_tolerance_m);
        self.time_s(Motion::Drive((nearest_m - near_m).max(0.0)))
    }

    /// Key under which two poses count as equal.
    fn place(&self, pose: Pose, heading: i32) -> (i64, i64, i32) {
        let square = |coordinate_m: f64| (coordinate_m / self.square_m()).floor() as i64;
        (square(pose.x), square(pose.y), heading)
    }

    /// Side of the squares in which positions count as equal \[m\]: small compared with the
    /// footprint and the cells.
    pub(super) fn square_m(&self) -> f64 {
        let inscribed_m = self.robot.footprint.inscribed_radius_m();
        let small_m = (0.25 * inscribed_m).max(0.1 * self.size_m());
        small_m.min(self.obstacles.frame().resolution_m())
    }
}

pub(super) fn after(pose: Pose, motion: Motion) -> Pose {
    motion.after_from(pose)
}

/// The motions to a node, in order; successive ones of the same kind and direction are merged.
fn merged(nodes: &[Node], last: usize) -> Vec<Motion> {
    let mut motions: Vec<Motion> = Vec::new();
    let mut index = last;
    while let Some((from, motion)) = nodes[index].by {
        match (motions.last_mut(), motion) {
            (Some(Motion::Arc(all_m, all_rad)), Motion::Arc(one_m, one_rad))
                if *all_m * one_m > 0.0 && *all_rad * one_rad > 0.0 =>
            {
                *all_m += one_m;
                *all_rad += one_rad;
            }
            (Some(Motion::Turn(all)), Motion::Turn(one))
            | (Some(Motion::Drive(all)), Motion::Drive(one))
                if *all * one > 0.0 =>
            {
                *all += one;
            }
            _ => motions.push(motion),
        }
        index = from;
    }
    motions.reverse();
    motions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::Footprint;
    use std::f64::consts::FRAC_PI_2;

    /// A map with cells of 0.1 m.
    fn tight(rows: &[&str]) -> DistanceField {
        let drawn = OccupancyGrid::from_ascii(rows);
        let (width, height) = (drawn.frame().width(), drawn.frame().height());
        let size = (u64::from(width), u64::from(height));
        let frame = GridFrame::new(size.0, size.1, 0.1, Pose::default()).unwrap();
        DistanceField::new(&frame, drawn.occupied(), &FieldConfig::default())
    }

    fn path(points: &[[f64; 2]]) -> Polyline {
        Polyline::new(points.iter().map(|&p| p.into()).collect())
    }

    /// The end pose of free motions.
    fn driven(place: &TightPlace<'_>, start: Pose, motions: &[Motion]) -> Pose {
        motions.iter().fold(start, |pose, &motion| {
            assert!(place.is_free(pose, motion), "{motion:?} at {pose:?}");
            after(pose, motion)
        })
    }

    /// A slot of 0.6 m that opens into a hall.
    const SLOT: [&str; 18] = [
        "######################",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#....................#",
        "#......###############",
        "#......###############",
        "#......###############",
        "#......###############",
        "#......###############",
        "#......###############",
        "#......###############",
        "######################",
    ];

    #[test]
    fn a_point_has_a_manoeuvre_too() {
        let (obstacles, path) = (tight(&SLOT), path(&[[0.4, 0.4], [0.4, 1.1], [1.7, 1.1]]));
        for radius_m in [0.0, 1e-9, 0.01] {
            let footprint = Footprint::circle(radius_m).unwrap();
            let robot = Robot { footprint, ..Robot::small() };
            let place = TightPlace {
                robot: &robot,
                obstacles: &obstacles,
                path: &path,
                covered_m: 0.0,
                goal_tolerance_m: 0.1,
                room_m: 0.0,
            };
            let start = Pose::new(0.4, 0.4, 0.0);
            let motions = place.along_route(start, &place.stations()).unwrap();
            let end = motions.iter().fold(start, |pose, &motion| after(pose, motion));
            assert!(end.point().distance([0.4, 0.45].into()) < 0.03, "{radius_m}: {motions:?}");
            assert!(place.searched(start, &place.stations()).is_some(), "{radius_m}");
        }
    }

    #[test]
    fn out_of_a_slot_and_on() {
        let (obstacles, path) = (tight(&SLOT), path(&[[0.4, 0.4], [0.4, 1.1], [1.7, 1.1]]));
        // It fits lengthwise in the slot and cannot turn around there.
        let footprint = Footprint::rectangle(0.56, 0.34).unwrap();
        let robot = Robot { footprint, ..Robot::small() };
        let place = TightPlace {
            robot: &robot,
            obstacles: &obstacles,
            path: &path,
            covered_m: 0.0,
            goal_tolerance_m: 0.1,
            room_m: 0.0,
        };
        let start = Pose::new(0.4, 0.4, FRAC_PI_2);
        assert!(!robot.footprint.is_free_turn(start.point(), start.theta, TAU, &obstacles));
        let motions = place.manoeuvre(start).unwrap();
        let pose = driven(&place, start, &motions);
        let Some(Place::OnTheWay(station)) = place.leads_on(pose, &place.stations()) else {
            panic!("{pose:?} {motions:?}")
        };
        assert!(pose.bearing_to(station).abs() < 1e-9 && pose.y > 0.7, "{pose:?} {motions:?}");
        // Facing the end of the slot, it could only back out.
        let inwards = Pose { theta: -FRAC_PI_2, ..start };
        assert_eq!(place.manoeuvre(inwards), None);
        let limits = crate::robot::Limits { v_min_mps: -0.2, ..robot.limits.clone() };
        let robot = Robot { limits, ..robot.clone() };
        let backs_out = TightPlace { robot: &robot, ..place }.manoeuvre(inwards).unwrap();
        let driven = backs_out.iter().map(|motion| match motion {
            Motion::Drive(length_m) => *length_m,
            _ => 0.0,
        });
        assert!(driven.sum::<f64>() < -0.3, "{backs_out:?}");
    }

    /// A lane in which it could not turn, longer than the reach of the search, and a robot across
    /// its mouth.
    #[test]
    fn back_to_where_it_can_face_a_lane() {
        let (wall, hall) = ("#".repeat(52), format!("#{}{}", ".".repeat(10), "#".repeat(41)));
        let lane = format!("#{}#", ".".repeat(50));
        let mut rows = vec![wall.as_str()];
        rows.extend([hall.as_str(); 10].into_iter().chain([lane.as_str(); 6]));
        rows.extend([hall.as_str(); 4].into_iter().chain([wall.as_str()]));
        let (obstacles, path) = (tight(&rows), path(&[[0.98, 0.8], [4.9, 0.8]]));
        let footprint = Footprint::rectangle(0.62, 0.2).unwrap();
        let mut robot = Robot { footprint, ..Robot::small() };
        robot.limits.v_min_mps = -0.2;
        let place = TightPlace {
            robot: &robot,
            obstacles: &obstacles,
            path: &path,
            covered_m: 0.0,
            goal_tolerance_m: 0.1,
            room_m: 0.0,
        };
        let start = Pose::new(0.98, 0.8, 100f64.to_radians());
        assert!(!robot.footprint.is_free_turn(start.point(), start.theta, TAU, &obstacles));
        let motions = place.manoeuvre(start).unwrap();
        let pose = driven(&place, start, &motions);
        assert!(place.has_room_to_turn(pose), "{pose:?} {motions:?}");
        let mouth = Point::new(1.1, 0.8);
        assert!(pose.bearing_to(mouth).abs() < 0.5, "{pose:?} {motions:?}");
        // Inside the lane and along it, it is not led out again by what it cannot pass.
        let inside = Pose::new(1.2, 0.8, 0.1);
        let place = TightPlace { covered_m: 0.22, ..place };
        assert!(!place.is_free(inside, Motion::Turn(TAU)));
        assert_eq!(place.searched(inside, &[]), None);
        // Nor is a disc, which can rotate anywhere.
        let footprint = Footprint::circle(0.298).unwrap();
        let robot = Robot { footprint, ..robot.clone() };
        let place = TightPlace { robot: &robot, ..place };
        assert!(!place.has_room_to_turn(inside));
        assert_eq!(place.searched(Pose { theta: FRAC_PI_2, ..inside }, &[]), None);
    }

    /// A gap of 0.4 m for a disc of 0.398 m, through which no heading of the search leads.
    #[test]
    fn along_the_route_through_a_gap_hardly_wider_than_the_robot() {
        let rows = [
            "####################",
            "#........##........#",
            "#........##........#",
            "#........##........#",
            "#..................#",
            "#..................#",
            "#..................#",
            "#..................#",
            "#........##........#",
            "#........##........#",
            "#........##........#",
            "####################",
        ];
        let (obstacles, path) = (tight(&rows), path(&[[1.0, 0.6], [1.7, 0.6]]));
        let robot = Robot { footprint: Footprint::circle(0.199).unwrap(), ..Robot::small() };
        let goal_tolerance_m = 0.1;
        let place = TightPlace {
            robot: &robot,
            obstacles: &obstacles,
            path: &path,
            covered_m: 0.0,
            goal_tolerance_m,
            room_m: 0.0,
        };
        let start = Pose::new(1.0, 0.6, 0.05);
        assert_eq!(place.searched(start, &place.stations()), None);
        let motions = place.manoeuvre(start).unwrap();
        let pose = driven(&place, start, &motions);
        assert!(pose.x > 1.1 && (pose.y - 0.6).abs() < 1e-9, "{pose:?}");
    }
}
