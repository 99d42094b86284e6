//! Escape from a wall beside which the robot is stationary: small rotations and straight drives.
//!
//! Parallel to a wall and close to it, no rotation of the search (`manoeuvre.rs`) is free: a
//! corner would touch the wall. The robot therefore rotates as far as it can and drives on, which
//! takes it away from the wall, rotates farther, and so on, until it can rotate by a step of the
//! search. The search takes over from there.

use super::manoeuvre::{STEP_RAD, TightPlace, after};
use super::motion::Motion;
use crate::geometry::{Point, Pose};

/// Maximum number of rotations.
const MOST_TURNS: u32 = 24;

/// Smallest useful rotation \[rad\].
const LEAST_RAD: f64 = 0.003;

/// Share of the largest free rotation that is used: a robot that almost touches the wall cannot
/// drive on.
const SHARE: f64 = 0.75;

/// Bisection steps of the range of rotations.
const HALVINGS: u32 = 10;

/// Length of a drive \[circumscribed radii\].
const DRIVE_SIZES: f64 = 0.5;

impl TightPlace<'_> {
    /// The motions that lead away from a wall and on along the route; `None` if the robot can
    /// rotate already, or makes no progress.
    pub(super) fn off_a_wall(&self, pose: Pose, stations: &[Point]) -> Option<Vec<Motion>> {
        let can_turn = |side: f64| self.is_free(pose, Motion::Turn(side * STEP_RAD));
        if can_turn(1.0) || can_turn(-1.0) {
            return None;
        }
        let can_reverse = self.robot.limits.v_min_mps < 0.0;
        let directions = [1.0, -1.0].into_iter().filter(|&ahead| ahead > 0.0 || can_reverse);
        let mut ways = directions.flat_map(|ahead| [(1.0, ahead), (-1.0, ahead)]);
        ways.find_map(|(side, ahead)| {
            let (mut motions, away) = self.turned_away(pose, side, ahead)?;
            motions.extend(self.searched(away, stations)?);
            Some(motions)
        })
    }

    /// Rotates to one side, and drives ahead (1) or back (-1), until a rotation of the search is
    /// free.
    fn turned_away(&self, pose: Pose, side: f64, ahead: f64) -> Option<(Vec<Motion>, Pose)> {
        let drive = Motion::Drive(ahead * DRIVE_SIZES * self.size_m());
        let (mut pose, mut motions) = (pose, Vec::new());
        for _ in 0..MOST_TURNS {
            if self.is_free(pose, Motion::Turn(side * STEP_RAD)) {
                return Some((motions, pose));
            }
            let turn = Motion::Turn(side * self.largest_turn_rad(pose, side)?);
            let turned = after(pose, turn);
            if !self.is_free(turned, drive) {
                return None;
            }
            pose = after(turned, drive);
            motions.extend([turn, drive]);
        }
        None
    }

    /// A rotation to one side, close to the largest free one, below a step of the search \[rad\].
    fn largest_turn_rad(&self, pose: Pose, side: f64) -> Option<f64> {
        let (mut free_rad, mut far_rad) = (0.0, STEP_RAD);
        for _ in 0..HALVINGS {
            let turn_rad = 0.5 * (free_rad + far_rad);
            if self.is_free(pose, Motion::Turn(side * turn_rad)) {
                free_rad = turn_rad;
            } else {
                far_rad = turn_rad;
            }
        }
        let turn_rad = SHARE * free_rad;
        (turn_rad >= LEAST_RAD).then_some(turn_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::map::{CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
    use crate::robot::{Footprint, Robot};

    /// A hall of 10 m x 5 m below a wall at y = 5 m; cells of 5 cm.
    fn hall() -> DistanceField {
        let frame = GridFrame::new(200, 110, 0.05, Pose::default()).unwrap();
        let map = OccupancyGrid::from_fn(frame, |cell| {
            if cell.y < 100 { CellState::Free } else { CellState::Occupied }
        });
        DistanceField::new(&frame, map.occupied(), &FieldConfig::default())
    }

    /// The motions of a robot of 0.5 m x 0.4 m, 1 cm below the wall, whose goal is behind it.
    fn motions(robot: &Robot, obstacles: &DistanceField) -> Option<Vec<Motion>> {
        let start = Pose::new(5.0, 4.79, 0.0);
        let path = Polyline::new([[5.0, 4.79], [2.0, 2.0]].map(Point::from).to_vec());
        let place = TightPlace {
            robot,
            obstacles,
            path: &path,
            covered_m: 0.0,
            goal_tolerance_m: 0.1,
            room_m: 0.0045,
        };
        let motions = place.off_a_wall(start, &[[4.5, 4.3].into(), [4.0, 3.9].into()])?;
        let end = motions.iter().fold(start, |pose, &motion| {
            assert!(place.is_free(pose, motion), "{motion:?} at {pose:?}");
            after(pose, motion)
        });
        let clearance = obstacles.clearance();
        let room_m = robot.footprint.distance_m(end, &clearance, 1.0);
        assert!(room_m > 0.05 && end.y < 4.7, "{end:?}");
        Some(motions)
    }

    #[test]
    fn it_comes_away_from_a_wall_with_and_without_a_reverse_gear() {
        let obstacles = hall();
        for v_min_mps in [0.0, -0.2] {
            let mut robot = Robot::small();
            robot.footprint = Footprint::rectangle(0.5, 0.4).unwrap();
            robot.limits.v_min_mps = v_min_mps;
            let found = motions(&robot, &obstacles).unwrap();
            let Motion::Turn(first_rad) = found[0] else { panic!("{found:?}") };
            assert!(first_rad < 0.0 && first_rad > -0.05, "{found:?}");
        }
    }

    #[test]
    fn who_can_turn_needs_none_of_it() {
        let obstacles = hall();
        let robot = Robot { footprint: Footprint::circle(0.2).unwrap(), ..Robot::small() };
        assert_eq!(motions(&robot, &obstacles), None);
    }
}
