//! Motions of recoveries: rotations on the spot, arcs of a robot that cannot do those, straight
//! drives and pauses, each certified before it is commanded.
//!
//! In every cycle, the whole rest of a motion is certified to keep its clearance by
//! [`Footprint::keeps_room_turning`], [`Footprint::keeps_room_on_arc`] or
//! [`Footprint::keeps_room_driving`], and the velocity is one from which the robot can stop within
//! that rest. A motion can therefore be aborted in any cycle: braking needs no more space than was
//! certified. Arcs are driven less exactly, and rely on their clearance.
//!
//! [`Footprint::keeps_room_on_arc`]: crate::robot::Footprint::keeps_room_on_arc
//! [`Footprint::keeps_room_turning`]: crate::robot::Footprint::keeps_room_turning
//! [`Footprint::keeps_room_driving`]: crate::robot::Footprint::keeps_room_driving

use crate::geometry::{Pose, Shift, Velocity, wrap_angle};
use crate::map::DistanceField;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// A motion, or the rest of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::navigate) enum Motion {
    /// Rotation on the spot, positive to the left \[rad\].
    Turn(f64),
    /// Straight drive, negative backwards \[m\].
    Drive(f64),
    /// Arc of a robot that does not turn in place: the length, negative backwards \[m\], and the
    /// angle, positive to the left \[rad\].
    Arc(f64, f64),
    /// Pause \[s\].
    Wait(f64),
}

/// The step of a motion in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::navigate) enum MotionStep {
    /// Command this velocity.
    Moving(Velocity),
    /// The robot is stationary at the end of the motion.
    Done,
    /// The rest would touch an obstacle: the robot must brake.
    Refused,
}

/// State of a robot at the time of a decision.
#[derive(Clone, Copy, Debug)]
pub(in crate::navigate) struct Moment<'a> {
    pub(in crate::navigate) robot: &'a Robot,
    pub(in crate::navigate) pose: Pose,
    pub(in crate::navigate) velocity: Velocity,
    /// State of the robot itself; the same, unless its commands are averaged.
    pub(in crate::navigate) robot_then: (Pose, Velocity),
    /// True if averaged commands will move it on.
    pub(in crate::navigate) moves_on: bool,
    /// Time since the last decision \[s\].
    pub(in crate::navigate) elapsed_s: f64,
    /// Smallest speed and turn rate that its motors follow.
    pub(in crate::navigate) least: Velocity,
}

impl Moment<'_> {
    /// True if it is stationary, and no averaged command moves it on.
    pub(in crate::navigate) fn stands(&self) -> bool {
        self.robot.stands(self.velocity) && !self.moves_on
    }
}

/// An active motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::navigate) struct MotionUnderWay {
    left: Motion,
    /// Clearance with which the motion was found \[m\]; `None`: that of the robot at the start.
    #[serde(default)]
    room_m: Option<f64>,
    /// Pose of the robot when `left` was updated; `None` before the start, while the robot still
    /// brakes.
    from: Option<Pose>,
}

/// Speed of recoveries near obstacles, as a share of the robot's limits.
pub(in crate::navigate) const SPEED_SHARE: f64 = 0.25;

/// Clearance that motions from a pose keep \[m\]: almost the margin of trajectories, or almost
/// half of the present clearance if that is less.
pub(in crate::navigate) fn kept_room_m(
    robot: &Robot,
    pose: Pose,
    obstacles: &DistanceField,
) -> f64 {
    let (margin_m, clearance) = (robot.safety_margin_or_default_m(), obstacles.clearance());
    let to_border_m = robot.footprint.to_border_m(pose, &clearance);
    let room_m = robot.footprint.distance_m(pose, &clearance, 2.0 * margin_m).min(to_border_m);
    NEARLY * margin_m.min(0.5 * room_m.max(0.0))
}

/// Share that leaves a tolerance, so that a robot that just keeps the margin may move.
const NEARLY: f64 = 0.9;

impl MotionUnderWay {
    /// Share of the clearance that is required during the motion, because no robot drives
    /// exactly.
    const KEEPS: f64 = 0.5;

    /// A motion from the pose of the robot at its start.
    pub(in crate::navigate) const fn new(motion: Motion) -> Self {
        Self { left: motion, room_m: None, from: None }
    }

    /// One of several motions that were found with this clearance \[m\].
    pub(in crate::navigate) const fn with_room(motion: Motion, room_m: f64) -> Self {
        Self { left: motion, room_m: Some(room_m), from: None }
    }

    /// Moves it along with a correction of the robot's pose: a correction is no motion.
    pub(in crate::navigate) fn shift(&mut self, shift: &Shift) {
        self.from = self.from.map(|from| shift.pose(from));
    }

    /// Runs one cycle. `obstacles` are all known and sensed ones.
    pub(in crate::navigate) fn step(
        &mut self,
        moment: &Moment<'_>,
        obstacles: &DistanceField,
    ) -> MotionStep {
        let &Moment { robot, pose, velocity, elapsed_s, least, .. } = moment;
        let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
        let is_standing = moment.stands();
        if self.from.is_none() && !is_standing {
            return MotionStep::Moving(limits.braked(velocity, cycle_s));
        }
        let from = self.from.replace(pose).unwrap_or(pose);
        let room_m = *self.room_m.get_or_insert_with(|| kept_room_m(robot, pose, obstacles));
        let room_m = Self::KEEPS * room_m;
        self.left = self.left.after(from, pose, elapsed_s);
        // An averaged command needs as many cycles to reach what the motors follow in one.
        let least_s = limits.smoothing_cycles(cycle_s) as f64 * cycle_s;
        if is_standing && self.left.size() <= self.left.nothing(least, least_s) {
            return MotionStep::Done;
        }
        let footprint = &robot.footprint;
        let share = || share(robot, pose, self.left, obstacles);
        let command = match self.left {
            Motion::Wait(_) => Velocity::ZERO,
            Motion::Turn(left_rad) => {
                let turn = [pose.theta, left_rad];
                let turns = limits.turns_in_place();
                if !turns || !footprint.keeps_room_turning(pose.point(), turn, room_m, obstacles) {
                    return MotionStep::Refused;
                }
                let most = share() * limits.omega_max_radps;
                let stops = limits.stoppable_radps(velocity.omega, left_rad.abs(), cycle_s);
                Velocity::new(0.0, stops.min(most).copysign(left_rad))
            }
            Motion::Drive(left_m) | Motion::Arc(left_m, _) => {
                if !self.left.keeps_room(robot, pose, room_m, obstacles) {
                    return MotionStep::Refused;
                }
                let fastest = if left_m < 0.0 { -limits.v_min_mps } else { limits.v_max_mps };
                let most = fastest.min(share() * limits.v_max_mps).min(seen_mps(robot, left_m));
                let stops = limits.stoppable_mps(velocity.v, left_m.abs(), cycle_s);
                let straight = Velocity::new(stops.min(most).copysign(left_m), 0.0);
                match self.left {
                    Motion::Arc(..) => self.on_arc(straight, moment),
                    _ => straight,
                }
            }
        };
        MotionStep::Moving(command)
    }
}

impl MotionUnderWay {
    /// A velocity on the arc, with the speed that is reached towards a straight one in this cycle:
    /// speed and turn rate grow in proportion, so that the robot stays on the arc.
    fn on_arc(&self, straight: Velocity, moment: &Moment<'_>) -> Velocity {
        let limits = &moment.robot.limits;
        let curvature = self.left.curvature_radpm();
        let most_mps = limits.omega_max_radps / curvature.abs();
        let within = Velocity::new(straight.v.clamp(-most_mps, most_mps), 0.0);
        let v = limits.reached(moment.velocity, within, moment.robot.cycle_s).v;
        limits.clamped(Velocity::new(v, v * curvature))
    }
}

/// Speed up to which a drive meets no obstacle that was not sensed before \[m/s\]; a quarter of
/// the robot's full speed if its sensors do not cover the direction.
fn seen_mps(robot: &Robot, left_m: f64) -> f64 {
    let looks_there = left_m >= 0.0 || robot.sees_all_around();
    let sight_mps = if looks_there { robot.sight_mps() } else { 0.0 };
    sight_mps.max(SPEED_SHARE * robot.limits.v_max_mps)
}

/// Speed of a motion, as a share of the robot's limits: the largest one at which the robot keeps
/// a wide clearance until it stops, even if it overshoots.
fn share(robot: &Robot, pose: Pose, motion: Motion, obstacles: &DistanceField) -> f64 {
    let is_wide = |share: &f64| is_wide(robot, pose, (motion, *share), obstacles);
    [1.0, 2.0 * SPEED_SHARE].into_iter().find(is_wide).unwrap_or(SPEED_SHARE)
}

/// True if the robot keeps its margin until it stops, braking in the next cycle from this share
/// of its limits; a drive keeps more.
fn is_wide(
    robot: &Robot,
    pose: Pose,
    (motion, share): (Motion, f64),
    obstacles: &DistanceField,
) -> bool {
    /// Extra clearance of a drive, which drifts sideways if it is slightly misaligned.
    const BESIDE_DRIVES_M: f64 = 0.05;
    let (limits, footprint, margin_m) =
        (&robot.limits, &robot.footprint, robot.safety_margin_or_default_m());
    let stops_within = |most: f64, brakes: f64| {
        let fast = share * most;
        fast * robot.cycle_s + fast * fast / (2.0 * brakes)
    };
    match motion {
        Motion::Turn(left_rad) => {
            let ahead_rad =
                stops_within(limits.omega_max_radps, limits.angular_deceleration_radps2);
            let turn = [pose.theta, ahead_rad.copysign(left_rad)];
            footprint.keeps_room_turning(pose.point(), turn, margin_m, obstacles)
        }
        Motion::Drive(left_m) | Motion::Arc(left_m, _) => {
            let ahead_m = stops_within(limits.v_max_mps, limits.deceleration_mps2);
            let ahead_m = ahead_m.copysign(left_m);
            let ahead = match motion {
                Motion::Arc(..) => Motion::Arc(ahead_m, ahead_m * motion.curvature_radpm()),
                _ => Motion::Drive(ahead_m),
            };
            ahead.keeps_room(robot, pose, margin_m + BESIDE_DRIVES_M, obstacles)
        }
        Motion::Wait(_) => false,
    }
}

impl Motion {
    /// True if the footprint certainly keeps a clearance \[m\] during the motion, and the robot can
    /// make it.
    pub(in crate::navigate) fn keeps_room(
        self,
        robot: &Robot,
        pose: Pose,
        room_m: f64,
        obstacles: &DistanceField,
    ) -> bool {
        let footprint = &robot.footprint;
        match self {
            Self::Turn(turn_rad) => {
                let turn = [pose.theta, turn_rad];
                (robot.limits.turns_in_place() || turn_rad == 0.0)
                    && footprint.keeps_room_turning(pose.point(), turn, room_m, obstacles)
            }
            Self::Drive(length_m) => {
                footprint.keeps_room_driving(pose, length_m, room_m, obstacles)
            }
            Self::Arc(length_m, turn_rad) => {
                footprint.keeps_room_on_arc(pose, [length_m, turn_rad], room_m, obstacles)
            }
            Self::Wait(_) => true,
        }
    }

    /// Turn per length driven; 0 for a motion without one \[rad/m\].
    fn curvature_radpm(self) -> f64 {
        match self {
            Self::Arc(length_m, turn_rad) if length_m != 0.0 => turn_rad / length_m,
            _ => 0.0,
        }
    }

    /// Pose after the motion.
    pub(in crate::navigate) fn after_from(self, pose: Pose) -> Pose {
        match self {
            Self::Turn(turn_rad) => Pose::new(pose.x, pose.y, pose.theta + turn_rad),
            Self::Drive(length_m) => {
                let (sin, cos) = libm::sincos(pose.theta);
                Pose { x: pose.x + length_m * cos, y: pose.y + length_m * sin, ..pose }
            }
            Self::Arc(length_m, turn_rad) => pose.after_arc(Velocity::new(length_m, turn_rad), 1.0),
            Self::Wait(_) => pose,
        }
    }

    /// The rest after the robot has moved from one pose to another.
    fn after(self, from: Pose, to: Pose, elapsed_s: f64) -> Self {
        match self {
            Self::Turn(left_rad) => Self::Turn(left_rad - wrap_angle(to.theta - from.theta)),
            Self::Drive(left_m) => {
                let (sin, cos) = libm::sincos(from.theta);
                let moved = to.point() - from.point();
                Self::Drive(left_m - (moved.x * cos + moved.y * sin))
            }
            Self::Arc(left_m, left_rad) => {
                let turned_rad = wrap_angle(to.theta - from.theta);
                // The chord of a short arc lies halfway between both headings.
                let (sin, cos) = libm::sincos(from.theta + 0.5 * turned_rad);
                let moved = to.point() - from.point();
                Self::Arc(left_m - (moved.x * cos + moved.y * sin), left_rad - turned_rad)
            }
            Self::Wait(left_s) => Self::Wait((left_s - elapsed_s).max(0.0)),
        }
    }

    fn size(self) -> f64 {
        match self {
            Self::Turn(left) | Self::Drive(left) | Self::Arc(left, _) | Self::Wait(left) => {
                left.abs()
            }
        }
    }

    /// Negligible rest: 2 mm, or 2 mrad, or 0.6 times the smallest motion that the motors make in
    /// a time.
    fn nothing(self, least: Velocity, least_s: f64) -> f64 {
        const NOTHING: f64 = 2e-3;
        let least = match self {
            Self::Turn(_) => least.omega,
            Self::Drive(_) | Self::Arc(..) => least.v,
            Self::Wait(_) => 0.0,
        };
        NOTHING.max(0.6 * least * least_s)
    }
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
