//! Alignment with a narrow passage that is hardly wider than the robot, which no search over a
//! grid of headings finds: along the centreline of the passage, from a pose at which the robot
//! can turn.

use super::manoeuvre::{TightPlace, after};
use super::motion::Motion;
use crate::geometry::{Point, Pose, wrap_angle};

impl TightPlace<'_> {
    /// A rotation, a drive and a rotation to a pose in front of the narrow passage ahead, and a
    /// drive into it. From there, the straight line must be free to a position at which the robot
    /// can turn around again, or as far as its horizon. `None` if no such motions exist.
    pub(super) fn lined_up(&self, pose: Pose) -> Option<Vec<Motion>> {
        let narrow = self.narrow_place()?;
        let degrees = Self::both_ways(1);
        degrees.map(|degree| f64::from(degree).to_radians()).find_map(|turn_rad| {
            let inside = after(narrow, Motion::Turn(turn_rad));
            let (size_m, step_m) = (self.size_m(), 0.25 * self.size_m());
            if !self.is_free(after(inside, Motion::Drive(-size_m)), Motion::Drive(2.0 * size_m)) {
                return None;
            }
            let ahead_m = self.straight_m(inside)?;
            let steps = (1..).map(|i| step_m * f64::from(i)).take_while(|&m| m <= self.reach_m());
            let backs = steps
                .filter(|&back_m| self.has_room_to_turn(after(inside, Motion::Drive(-back_m))));
            backs.take(Self::BEGINNINGS).find_map(|back_m| {
                self.through(pose, after(inside, Motion::Drive(-back_m)), [back_m, ahead_m])
            })
        })
    }

    /// Maximum number of start poses of a line that are tried.
    const BEGINNINGS: usize = 6;

    /// Largest rotation that is tried \[deg\].
    const MOST_DEG: i32 = 40;

    /// Rotations that are tried \[deg\], small ones first.
    fn both_ways(step_deg: usize) -> impl Iterator<Item = i32> {
        let degrees = (0..=Self::MOST_DEG).step_by(step_deg);
        degrees.flat_map(|degree| [degree, -degree]).skip(1)
    }

    /// The motions to the start of a line and along it, through the narrow passage and beyond.
    fn through(&self, pose: Pose, begin: Pose, [back_m, ahead_m]: [f64; 2]) -> Option<Vec<Motion>> {
        let away_m = pose.point().distance(begin.point());
        let turn_rad = if away_m > 0.0 { pose.bearing_to(begin.point()) } else { 0.0 };
        let left_rad = wrap_angle(begin.theta - pose.theta - turn_rad);
        let line_up = [Motion::Turn(turn_rad), Motion::Drive(away_m), Motion::Turn(left_rad)];
        let mut at = pose;
        for motion in line_up.into_iter().chain([Motion::Drive(back_m + ahead_m)]) {
            if !self.is_free(at, motion) {
                return None;
            }
            at = after(at, motion);
        }
        // Inside the passage and aligned, it drives on as usual.
        let in_line = Motion::Drive(back_m + ahead_m.min(self.size_m()));
        Some(line_up.into_iter().chain([in_line]).collect())
    }

    /// The middle of the first narrow passage on the route, facing along the route.
    fn narrow_place(&self) -> Option<Pose> {
        let step_m = 0.1 * self.size_m();
        let end_m = self.path.length_m().min(self.covered_m + self.reach_m());
        let places = (0..).map(|i| self.covered_m + step_m * f64::from(i));
        let poses = places.take_while(|&m| m < end_m).filter_map(|along_m| {
            let (at, next) =
                (self.path.at_length(along_m)?, self.path.at_length(along_m + step_m)?);
            let heading_rad = (next - at).heading();
            Some(Pose { x: at.x, y: at.y, theta: heading_rad })
        });
        let narrow: Vec<Pose> = poses
            .skip_while(|&at| self.has_room_to_turn(at))
            .take_while(|&at| !self.has_room_to_turn(at))
            .take(Self::SAMPLES)
            .collect();
        narrow.get(narrow.len() / 2).map(|&at| self.in_the_middle(at))
    }

    /// Maximum number of samples of a narrow passage, spaced by a tenth of the robot's size: in
    /// the middle of them, the robot is entirely inside.
    const SAMPLES: usize = 30;

    /// The pose beside the given one that has the same clearance on both sides.
    fn in_the_middle(&self, at: Pose) -> Pose {
        let reach_m = 0.5 * self.robot.footprint.inscribed_radius_m();
        let room_m = |at: Point| self.obstacles.clearance().of_point(at, 2.0 * self.size_m());
        let (sin, cos) = libm::sincos(at.theta);
        let aside = Point::new(-sin, cos);
        let mut middle = at.point();
        for _ in 0..8 {
            let off_m = room_m(middle + aside * reach_m) - room_m(middle - aside * reach_m);
            middle = middle + aside * (0.5 * off_m).clamp(-reach_m, reach_m);
        }
        Pose { x: middle.x, y: middle.y, ..at }
    }

    /// True if the robot can turn around at a pose, or is at the goal.
    fn can_turn_around(&self, pose: Pose) -> bool {
        self.is_at_goal(pose.point()) || self.has_room_to_turn(pose)
    }

    pub(super) fn is_at_goal(&self, point: Point) -> bool {
        let end = self.path.points().last();
        end.is_some_and(|end| end.distance(point) <= self.goal_tolerance_m)
    }

    pub(super) fn has_room_to_turn(&self, pose: Pose) -> bool {
        let turning_m = self.radius_m() + self.robot.safety_margin_or_default_m();
        self.obstacles.clearance().is_clear_point(pose.point(), turning_m)
    }

    /// A rotation and a straight drive to a position at which the robot can turn around, or to
    /// the goal; no motions if it can turn around at once. `None` if no such motions exist.
    pub(in crate::navigate) fn straight_on(&self, pose: Pose) -> Option<Vec<Motion>> {
        if self.can_turn_around(pose) {
            return Some(Vec::new());
        }
        Self::both_ways(2).find_map(|degree| {
            let motions = self.turned_by(pose, degree)?;
            let end = motions.iter().fold(pose, |at, &motion| after(at, motion));
            self.can_turn_around(end).then(|| motions.to_vec())
        })
    }

    /// True if the robot is sure to get on from a pose: it can turn around there, or it can drive
    /// straight to a position at which it can, or as far as its horizon, either as it faces or in
    /// two neighbouring directions. A single direction may be blocked a millimetre farther on.
    pub(in crate::navigate) fn surely_gets_on(&self, pose: Pose) -> bool {
        let leads_on = |degree| self.turned_by(pose, degree).is_some();
        let beside = |degree| [Self::BESIDE_DEG, -Self::BESIDE_DEG].map(|off| degree + off);
        self.can_turn_around(pose)
            || leads_on(0)
            || Self::both_ways(2)
                .any(|degree| leads_on(degree) && beside(degree).into_iter().any(leads_on))
    }

    /// Angle between neighbouring directions \[deg\].
    const BESIDE_DEG: i32 = 4;

    /// A rotation, and a straight drive to a position at which the robot can turn around, to the
    /// goal, or as far as its horizon; `None` if they are not free.
    fn turned_by(&self, pose: Pose, degree: i32) -> Option<[Motion; 2]> {
        let turn = Motion::Turn(f64::from(degree).to_radians());
        let facing = after(pose, turn);
        let drive = Motion::Drive(self.straight_m(facing)?);
        (self.is_free(pose, turn) && self.is_free(facing, drive)).then_some([turn, drive])
    }

    /// Length of the straight drive to a position at which the robot can turn around, to the
    /// goal, or as far as the horizon \[m\]; `None` if its inscribed disc does not get that far.
    fn straight_m(&self, pose: Pose) -> Option<f64> {
        let step_m = 0.25 * self.size_m();
        let inscribed_m = self.robot.footprint.inscribed_radius_m();
        let clearance = self.obstacles.clearance();
        let mut driven_m = 0.0;
        while driven_m < self.reach_m() {
            driven_m += step_m;
            let at = after(pose, Motion::Drive(driven_m));
            if !clearance.is_clear_point(at.point(), inscribed_m) {
                return None;
            }
            if self.can_turn_around(at) {
                break;
            }
        }
        Some(driven_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::map::{CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::{Footprint, Robot};

    /// A hall to the left of x = 2 m, followed by a lane of 0.4 m with its centreline at y = 3 m,
    /// up to x = 9 m; cells of 2 cm.
    fn hall_and_lane() -> DistanceField {
        let frame = GridFrame::new(500, 300, 0.02, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| {
            let is_wall = (100..450).contains(&cell.x) && !(140..160).contains(&cell.y);
            if is_wall { CellState::Occupied } else { CellState::Free }
        });
        DistanceField::new(&frame, map.occupied(), &FieldConfig::default())
    }

    /// No heading of the search leads in a robot of 0.6 m x 0.36 m, which has 1 cm of clearance
    /// on each side.
    #[test]
    fn into_a_lane_that_is_hardly_wider_than_the_robot() {
        let obstacles = hall_and_lane();
        let footprint = Footprint::rectangle(0.6, 0.36).unwrap();
        let robot = Robot { footprint, safety_margin_m: Some(0.01), ..Robot::small() };
        let path = Polyline::new([[1.0, 2.5], [2.1, 3.01], [9.5, 3.01]].map(Point::from).to_vec());
        let place = TightPlace {
            robot: &robot,
            obstacles: &obstacles,
            path: &path,
            covered_m: 0.6,
            goal_tolerance_m: 0.1,
            room_m: 0.009,
        };
        let start = Pose::new(1.6, 2.8, 0.5);
        let motions = place.manoeuvre(start).unwrap();
        let end = motions.iter().fold(start, |pose, &motion| {
            assert!(place.is_free(pose, motion), "{motion:?} at {pose:?}");
            after(pose, motion)
        });
        assert!(end.x > 2.3 && (end.y - 3.0).abs() < 0.01 && end.theta.abs() < 0.03, "{end:?}");
        // It could not turn around any more, but the straight line is free as far as its horizon.
        assert!(place.surely_gets_on(end) && place.straight_on(end).is_none());
        assert_eq!(place.straight_on(start), Some(Vec::new()));
        // At an angle in the mouth it does not get on, and it is not sure to if only one
        // direction is free.
        assert!(!place.surely_gets_on(Pose::new(1.76, 3.0, -0.35)));
        let aslant = Pose { theta: 0.035, ..end };
        assert!(place.turned_by(aslant, -2).is_some() && !place.surely_gets_on(aslant));
        // Near the other end, it reaches a position at which it can turn around.
        let near_end = Pose::new(8.0, 3.0, 0.0);
        let motions = place.straight_on(near_end).unwrap();
        assert!(matches!(motions[..], [Motion::Turn(_), Motion::Drive(m)] if m > 1.0));
    }
}
