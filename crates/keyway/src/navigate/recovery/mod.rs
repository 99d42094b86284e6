//! Recoveries of a robot that makes no progress, in a configurable order.
//!
//! Each is a few [`Motion`]s, certified free of contact before they start and again in every
//! cycle; or a new route; or a pause.

mod line_up;
mod manoeuvre;
mod motion;
mod off_wall;
mod primitives;
mod track;

pub(super) use manoeuvre::TightPlace;
pub(super) use motion::{Moment, Motion, MotionStep, MotionUnderWay, kept_room_m};
pub(super) use track::DrivenTrack;

use crate::geometry::{Point, Pose, Shift, Velocity, wrap_angle};
use crate::map::DistanceField;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};
use std::fmt::{self, Display, Formatter};

/// A kind of recovery, run when a robot makes no progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum RecoveryKind {
    /// Plan a new route. If it is the same as before, the next kind is tried at once.
    Replan,
    /// Rotate on the spot towards the guide point, in the shorter direction that has space.
    Turn,
    /// Rotate and drive straight to a position at which the robot can turn around again, farther
    /// along the route, or at which it can face the route. Needs little margin, and no curves; a
    /// robot that cannot turn in place drives arcs instead.
    Manoeuvre,
    /// Drive straight back to an earlier position; a robot that cannot drive backwards turns
    /// around first.
    BackUp,
    /// Stay stationary for a while.
    Wait,
}

/// Number of recoveries of each kind, and of detours around moving obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecoveryCounts {
    /// Routes replanned because the robot made no progress.
    pub replan: u32,
    /// Rotations towards the guide point.
    pub turn: u32,
    /// Manoeuvres.
    pub manoeuvre: u32,
    /// Drives back.
    pub back_up: u32,
    /// Pauses.
    pub wait: u32,
    /// Detours around moving obstacles that held the robot up.
    #[serde(default)]
    pub go_around: u32,
    /// Drives to a position beside the path of a moving obstacle that needs to pass.
    #[serde(default)]
    pub make_way: u32,
}

impl RecoveryCounts {
    /// Sum of all counts.
    pub const fn total(&self) -> u32 {
        let of_kinds = self.replan + self.turn + self.manoeuvre + self.back_up + self.wait;
        of_kinds + self.go_around + self.make_way
    }

    pub(super) const fn add(&mut self, kind: RecoveryKind) {
        let count = match kind {
            RecoveryKind::Replan => &mut self.replan,
            RecoveryKind::Turn => &mut self.turn,
            RecoveryKind::Manoeuvre => &mut self.manoeuvre,
            RecoveryKind::BackUp => &mut self.back_up,
            RecoveryKind::Wait => &mut self.wait,
        };
        *count += 1;
    }
}

impl Display for RecoveryKind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Replan => "plans a new route",
            Self::Turn => "turns towards its route",
            Self::Manoeuvre => "manoeuvres in a tight place",
            Self::BackUp => "backs up along its track",
            Self::Wait => "waits",
        })
    }
}

/// The kinds that have been tried since the last progress.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct RecoveryCursor {
    /// Number of kinds tried.
    pub(super) tried: usize,
    /// Remaining path length at the first of them \[m\].
    trouble_m: f64,
}

impl RecoveryCursor {
    /// Decrease of the remaining length, from that at the first recovery, that counts as progress
    /// and restarts the order \[m\].
    const PROGRESS_M: f64 = 0.3;

    /// Updates the progress of the robot.
    pub(super) fn note_progress(&mut self, remaining_m: f64) {
        if self.tried > 0 && remaining_m < self.trouble_m - Self::PROGRESS_M {
            self.tried = 0;
        }
    }

    /// The next kind of the order.
    pub(super) fn next(
        &mut self,
        order: &[RecoveryKind],
        remaining_m: f64,
    ) -> Option<RecoveryKind> {
        if self.tried == 0 {
            self.trouble_m = remaining_m;
        }
        let kind = order.get(self.tried % order.len().max(1)).copied()?;
        self.tried = self.tried.wrapping_add(1);
        Some(kind)
    }

    /// Postpones the last kind.
    pub(super) const fn put_off(&mut self) {
        self.tried = self.tried.saturating_sub(1);
    }
}

/// The motions of a recovery.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RecoveryUnderWay {
    kind: RecoveryKind,
    motion: MotionUnderWay,
    /// Remaining motions.
    later: VecDeque<Motion>,
    /// Clearance that all of them keep \[m\].
    #[serde(default)]
    room_m: f64,
}

impl RecoveryUnderWay {
    /// Starts a recovery of motions that keep a clearance \[m\]; `None` without motions.
    pub(super) fn begin(kind: RecoveryKind, motions: Vec<Motion>, room_m: f64) -> Option<Self> {
        let mut later = VecDeque::from(motions);
        let motion = MotionUnderWay::with_room(later.pop_front()?, room_m);
        Some(Self { kind, motion, later, room_m })
    }

    /// Moves it along with a correction of the robot's pose.
    pub(super) fn shift(&mut self, shift: &Shift) {
        self.motion.shift(shift);
    }

    /// Continues: returns the kind and the next command. `None` if it has just ended or was
    /// refused.
    pub(super) fn step(
        &mut self,
        moment: &Moment<'_>,
        obstacles: &DistanceField,
    ) -> Option<(RecoveryKind, Velocity)> {
        loop {
            match self.motion.step(moment, obstacles) {
                MotionStep::Moving(command) => return Some((self.kind, command)),
                MotionStep::Refused => return None,
                MotionStep::Done => {
                    self.motion = MotionUnderWay::with_room(self.later.pop_front()?, self.room_m);
                }
            }
        }
    }
}

/// A robot that has to rotate.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnTheSpot<'a> {
    pub(super) robot: &'a Robot,
    pub(super) obstacles: &'a DistanceField,
    /// Clearance that its motions keep \[m\].
    pub(super) room_m: f64,
}

impl OnTheSpot<'_> {
    /// A robot that cannot turn in place drives straight to a point this much aside \[rad\].
    const NEARLY_RAD: f64 = 0.5;

    /// Smallest useful rotation \[rad\].
    const LEAST_TURN_RAD: f64 = 0.1;

    /// A rotation by an angle, in the shorter direction that has space.
    pub(super) fn turn(&self, pose: Pose, left_rad: f64) -> Option<f64> {
        if !self.robot.limits.turns_in_place() {
            return None;
        }
        let left_rad = wrap_angle(left_rad);
        let other_way_rad = left_rad - TAU.copysign(left_rad);
        [left_rad, other_way_rad].into_iter().find(|&turn_rad| {
            let footprint = &self.robot.footprint;
            let turn = [pose.theta, turn_rad];
            footprint.keeps_room_turning(pose.point(), turn, self.room_m, self.obstacles)
        })
    }

    /// True if a robot that cannot turn in place makes do without a rotation.
    fn drives_straight(&self, turn_rad: f64) -> bool {
        let turns_in_place = self.robot.limits.turns_in_place();
        !turns_in_place && wrap_angle(turn_rad).abs() <= Self::NEARLY_RAD
    }

    /// A rotation towards a point, if it is large enough to be useful.
    pub(super) fn turn_towards(&self, pose: Pose, place: Point) -> Option<Vec<Motion>> {
        let bearing_rad = pose.bearing_to(place);
        let turn_rad = self.turn(pose, bearing_rad)?;
        (bearing_rad.abs() >= Self::LEAST_TURN_RAD).then(|| vec![Motion::Turn(turn_rad)])
    }

    /// A straight drive to one of the points of a track, the farthest that can be reached:
    /// backwards if the robot can, otherwise after a rotation.
    pub(super) fn back_up(
        &self,
        pose: Pose,
        mut places: impl Iterator<Item = Point>,
        least_m: f64,
    ) -> Option<Vec<Motion>> {
        let can_reverse = self.robot.limits.v_min_mps < 0.0;
        places.find_map(|place| {
            let length_m = pose.point().distance(place);
            if length_m < least_m {
                return None;
            }
            let ahead_rad = pose.bearing_to(place);
            let backwards = can_reverse.then_some((wrap_angle(ahead_rad + PI), -length_m));
            let mut ways = backwards.into_iter().chain([(ahead_rad, length_m)]);
            ways.find_map(|(turn_rad, length_m)| {
                let turn_rad = match self.turn(pose, turn_rad) {
                    None if self.drives_straight(turn_rad) => 0.0,
                    turn_rad => turn_rad?,
                };
                let facing = Pose::new(pose.x, pose.y, pose.theta + turn_rad);
                let (footprint, room_m) = (&self.robot.footprint, self.room_m);
                let is_free =
                    footprint.keeps_room_driving(facing, length_m, room_m, self.obstacles);
                is_free.then(|| vec![Motion::Turn(turn_rad), Motion::Drive(length_m)])
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{FieldConfig, OccupancyGrid};
    use crate::robot::{Footprint, Limits};

    fn field(rows: &[&str]) -> DistanceField {
        let map = OccupancyGrid::from_ascii(rows);
        DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default())
    }

    #[test]
    fn turns_take_the_side_with_room() {
        // The box extends ahead of its centre of rotation, and there is a pillar to its left.
        let obstacles = field(&["#....", ".....", ".....", "....."]);
        let vertices = [[0.0, 0.3], [0.0, -0.3], [1.9, -0.3], [1.9, 0.3]];
        let footprint = Footprint::polygon(vertices.map(Point::from).to_vec()).unwrap();
        let robot = Robot { footprint, ..Robot::small() };
        let spot = OnTheSpot { robot: &robot, obstacles: &obstacles, room_m: 0.0 };
        let pose = Pose::new(2.5, 1.95, PI / 2.0);
        let turn_rad = spot.turn(pose, PI).unwrap();
        assert!((turn_rad + PI).abs() < 1e-9, "{turn_rad}");
        assert_eq!(spot.turn_towards(pose, Point::new(2.5, 3.9)), None, "it faces it already");
    }

    #[test]
    fn back_to_where_it_has_been() {
        let obstacles = field(&["########", "........", "........", "########"]);
        let forward = Robot::small();
        let limits = Limits { v_min_mps: -0.3, ..forward.limits.clone() };
        let both_ways = Robot { limits, ..forward.clone() };
        let pose = Pose::new(5.0, 2.0, 0.0);
        let places = [Point::new(3.0, 2.0), Point::new(4.0, 2.0)];
        let motions = |robot: &Robot| {
            let spot = OnTheSpot { robot, obstacles: &obstacles, room_m: 0.0 };
            spot.back_up(pose, places.into_iter(), 0.2).unwrap()
        };
        let [Motion::Turn(turn_rad), Motion::Drive(length_m)] = motions(&both_ways)[..] else {
            panic!()
        };
        assert!(turn_rad.abs() < 1e-9 && (length_m + 2.0).abs() < 1e-9);
        let [Motion::Turn(turn_rad), Motion::Drive(length_m)] = motions(&forward)[..] else {
            panic!()
        };
        assert!((turn_rad.abs() - PI).abs() < 1e-9 && (length_m - 2.0).abs() < 1e-9);
    }

    #[test]
    fn kinds_come_in_order_until_there_is_progress() {
        let order = [RecoveryKind::Replan, RecoveryKind::Wait];
        let mut recovery = RecoveryCursor::default();
        let next = |recovery: &mut RecoveryCursor| recovery.next(&order, 5.0).unwrap();
        assert_eq!(next(&mut recovery), RecoveryKind::Replan);
        recovery.note_progress(4.9);
        assert_eq!(next(&mut recovery), RecoveryKind::Wait);
        assert_eq!(next(&mut recovery), RecoveryKind::Replan);
        assert_eq!(next(&mut recovery), RecoveryKind::Wait);
        recovery.note_progress(4.6);
        assert_eq!(next(&mut recovery), RecoveryKind::Replan);
        assert_eq!(recovery.next(&[], 5.0), None);
    }
}
