//! The stop rule: a command is issued only if the robot can still brake to a stop afterwards
//! before it touches anything. It is a gate that works behind any local planner.
//!
//! # Source
//! \[Mitsch2017\], passive safety: no contact while the robot moves, proved there for a robot that
//! keeps `|p_r - p_o| > s² / (2 b) + V s / b + (A / b + 1) (A e² / 2 + e (s + V))` from every
//! obstacle.
//!
//! | paper | here | unit |
//! |---|---|---|
//! | e | `Robot::cycle_s` | s |
//! | A, b | the acceleration and the deceleration of [`Limits`](crate::robot::Limits) | m/s² |
//! | s | forward speed of [`Surroundings::velocity`] | m/s |
//! | V | [`MoverBounds::speed_mps`] of [`StopRuleConfig::movers`] | m/s |
//! | `p_r`, `p_o` | the footprint at its pose; obstacle squares, and the discs of [`Mover`]s | m |
//!
//! # The rule
//! The *manoeuvre* of a command: in one cycle the velocity changes linearly from the present one
//! to the velocity that the limits let the robot reach towards the command. Then, cycle by cycle,
//! it brakes along its arc ([`Limits::braked`](crate::robot::Limits::braked)) until it is
//! stationary. A command is admissible if on the whole manoeuvre
//!
//! 1. the footprint keeps `margin_m` from all obstacle squares and from the map's border;
//! 2. at every instant it keeps `margin_m` from all ground that a moving obstacle may cover by
//!    then ([`Mover::by_speed`] or, if an acceleration is given, [`Mover::by_estimate`]);
//! 3. if the sensor does not see all around, the rear stays on the ground of
//!    [`Surroundings::seen`] wherever the robot drives backwards: ground that no moving obstacle
//!    can have reached by then, seen before or not ([`SeenGround`](crate::sense::SeenGround)).
//!    The robot also stops within the time for which that is known. The rest of a backward motion
//!    that the command reverses in the cycle is not checked.
//! 4. wherever the robot drives ahead, its front stays three quarters of a cell before the end of
//!    the observed free space ([`Surroundings::seen`]); the next cell to either side counts as
//!    well. From within observed free space, it may come arbitrarily close to a known obstacle
//!    and to the map's border, as nothing else can be there. An obstacle beyond the observed
//!    space would be detected too late. So the robot never drives faster than it can stop within
//!    observed free space: within its sensor's range, before it can see around a corner, and
//!    where no beam gives information.
//!
//! The manoeuvre begins when the command acts, [`Surroundings::delay_s`] after the instant at
//! which the moving obstacles were observed. The motion until then was decided earlier, as the
//! beginning of the manoeuvre of an earlier command.
//!
//! For a robot with jerk limits ([`Surroundings::jerk_limited`]), a command is a velocity of its
//! reference, and braking is that of the reference; the manoeuvre is that of the robot itself. In
//! every cycle the robot gets the mean of the last velocities of the reference
//! ([`CommandWindow`](crate::robot::CommandWindow)), including those of earlier cycles, until
//! none of them is left. (3) and (4) are then also checked if only those earlier velocities lead
//! back or ahead.
//!
//! An admissible command passes unchanged. Otherwise the gate moves from the command towards
//! braking along the present arc and issues the nearest velocity on that line that it finds
//! admissible, or braking if there is none. A command to brake along the present arc always
//! passes.
//!
//! # Guarantees
//! With ideal motion (as above), a correct pose and velocity, a known delay, and every moving
//! obstacle in view:
//!
//! - no contact ever with a stationary obstacle in view;
//! - no contact with a stationary obstacle out of view while the robot drives ahead, if its
//!   sensor covers all of its front: such an obstacle is on ground that has not been seen, and
//!   the robot can stop before that. An obstacle narrower than three cells may be missed between
//!   other obstacles, and one narrower than 6 cm, or than a cell, between two beams;
//! - no contact with a moving obstacle while the robot moves. A moving obstacle may run into a
//!   stationary robot, or into a disc that turns on the spot, which covers no other ground.
//!
//! With a sensor that does not see all around, the robot backs into no moving obstacle, to within
//! a cell: all of the manoeuvre lies within the time for which cells are known to be free. Moving
//! obstacles are assumed not to come through walls of the map, or through observed stationary
//! obstacles. One that comes from outside the field of view may still run into the robot while it
//! drives ahead, and into the corners of a polygon that turns.
//!
//! *Proof sketch.* Call a state safe if braking along the present arc touches nothing, whatever
//! the moving obstacles do within their bounds. A robot at rest is safe: its manoeuvre is to stay
//! at rest. Let the state be safe. If the gate issues an admissible command, (1) to (4) hold on
//! its manoeuvre: obstacles are stationary, observed space stays observed, and a moving obstacle
//! that is inside its disc and keeps the bounds is inside the discs of all later instants. The
//! robot executes the first cycle of the manoeuvre, and the rest of it is braking along the arc
//! of the next state, which is therefore safe. If the gate brakes, the robot executes the first
//! cycle of a manoeuvre that touches nothing, and the next state has the rest of it. So every
//! state is safe, and the motion from one to the next is part of a manoeuvre that touches
//! nothing. Estimates may change from cycle to cycle, if each of them contains the moving
//! obstacle. With jerk limits, a state is that of the robot along with the averaged velocities,
//! and braking is that of its reference. The robot again executes the first cycle of a manoeuvre,
//! which leaves a state from which braking is the rest of that manoeuvre; the rest of the proof
//! needs no more. ∎
//!
//! No pose of a manoeuvre is skipped: between two poses no part of the footprint moves farther
//! than [`Core::moves_m`], so a step as long as the clearance less the margin stays clear of the
//! margin. Steps are never shorter than the margin; on a step of that length at least half of the
//! margin is left.
//!
//! # A start inside the margin or in contact
//! An obstacle nearer than the margin may stay as near as it is when a command is admitted, but
//! not come nearer, until the next command is admitted: the robot may leave it or pass along it.
//! Braking is not admitted anew. So if the robot has meanwhile moved away from an obstacle, and
//! then brakes, it may come as near again as it was at the last admitted command. All of this
//! holds to a nanometre for each command, which exceeds the rounding errors, and, while the robot
//! counts as stationary, to its drift until the end of the cycle: such a velocity is taken for
//! odometry noise (at most half of a cycle at a hundredth of full speed). Between two checked
//! instants, half of a distance of at least 0.1 mm is kept. There is no such exception for moving
//! obstacles: beside one that may touch it, no part of a robot moves farther than a nanometre in
//! a quarter of a cycle, until the moving obstacle is gone, or has been still so long that it
//! counts as stationary ([`TrackerConfig::standing_s`](crate::sense::TrackerConfig::standing_s)).
//!
//! A robot that touches an obstacle when a command is admitted, or is nearer to it than 0.1 mm,
//! may touch nothing else until the next command is, except the squares beside the touched ones
//! in which the latest scan has hits ([`SeenCells::scans`]). There it keeps its distance from the
//! hits themselves, as from obstacles, so that it may drive along a wall whose squares it
//! touches. It overlaps the contents of such squares by no more than the distance of two beams
//! there. From the obstacle that it touches, a disc keeps its present distance, while a polygon
//! is shrunk around its centre of rotation until it touches nothing, and the shrunk polygon may
//! touch nothing. A robot whose centre of rotation is inside an obstacle or outside the map is
//! stopped: a motion out cannot be told from a motion in. If not even braking is admissible (an
//! obstacle came into view too late, or a moving obstacle broke the bounds), the robot brakes.
//!
//! # Where this differs from the paper
//! - Directional: the rule considers the ground that the footprint covers on its arc, not a
//!   distance to all sides.
//! - The footprint is a disc or a polygon; the paper's robot is a point.
//! - The motion of the cycle is known, where the paper allows any acceleration up to A.
//!
//! # Out of scope
//! Occlusion, except for (3): an unseen obstacle may emerge from beyond the sensor's range or
//! from behind another obstacle. It counts as a moving obstacle as soon as about 0.1 m of it is
//! on ground that the robot has seen through before
//! ([`Tracker::possible_movers`](crate::sense::Tracker::possible_movers)). A caller that needs
//! more adds a moving obstacle wherever one could emerge. Errors of pose and motion: the margin
//! covers them.
//!
//! # Errors / cost
//! [`ConfigError`]. With nothing near, one look-up in the distance field and one distance per
//! moving obstacle. Otherwise one look-up per step: few steps on open ground, and at most as many
//! as margins fit into the manoeuvre. Up to four manoeuvres are checked. Allocates nothing once
//! the scratch is warm.

#[cfg(test)]
mod admits_tests;
#[cfg(test)]
mod jerk_tests;
mod manoeuvre;
#[cfg(test)]
mod mover_tests;
#[cfg(test)]
mod seen_tests;
mod start;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod touching_tests;

use super::rear::{Front, Rear};
use super::{JerkLimited, Scene, Scratch};
use crate::ConfigError;
use crate::geometry::{Pose, Velocity};
#[cfg(doc)]
use crate::map::Core;
use crate::map::DistanceField;
use crate::robot::Robot;
use crate::sense::{Mover, MoverBounds, SeenCells};
use manoeuvre::{Manoeuvres, Work};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// Parameters of [`StopRule`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StopRuleConfig {
    /// Distance that the footprint keeps from everything, once it is that far away \[m\];
    /// positive.
    pub margin_m: f64,
    /// Bounds on the motion of moving obstacles.
    pub movers: MoverBounds,
}

impl StopRuleConfig {
    /// Defaults for a robot: half of the margin that its local planner keeps from obstacles
    /// ([`Robot::safety_margin_or_default_m`]), so that the gate does not change commands that
    /// such a planner finds admissible. Moving obstacles are people: they walk at up to 1.5 m/s,
    /// and may turn around at once.
    pub fn for_robot(robot: &Robot) -> Self {
        Self {
            margin_m: 0.5 * robot.safety_margin_or_default_m(),
            movers: MoverBounds { speed_mps: 1.5, acceleration_mps2: None },
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Returns an error that names the first invalid field.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("margin_m", self.margin_m)?;
        self.movers.validate().map_err(|error| error.within("movers"))
    }
}

/// The surroundings of a robot in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Distances to the squares of all stationary obstacles, mapped and sensed.
    pub obstacles: &'a DistanceField,
    /// Observed ground ([`SeenGround::cells`](crate::sense::SeenGround::cells)): the cells within
    /// which the robot must be able to stop, and those over which it may back up.
    pub seen: SeenCells<'a>,
    /// Everything that moves, or may move, as last observed. An entry with a number that is not
    /// finite, or a negative length, is ignored.
    pub movers: &'a [Mover],
    /// Time from that instant to the one at which the command acts \[s\].
    pub delay_s: f64,
    /// Pose of the robot when the command acts; that of its reference, if its commands are
    /// averaged.
    pub pose: Pose,
    /// Its velocity then.
    pub velocity: Velocity,
    /// The robot itself, if its commands are averaged.
    pub jerk_limited: Option<JerkLimited<'a>>,
}

impl<'a> Surroundings<'a> {
    /// The stationary obstacles, as a local planner sees them. Observed space is not checked, and
    /// nothing moves.
    pub const fn standing(scene: &Scene<'a>) -> Self {
        let Scene { obstacles, pose, velocity, jerk_limited, .. } = *scene;
        let (seen, movers, delay_s) = (SeenCells::ANYWHERE, &[], 0.0);
        Self { obstacles, seen, movers, delay_s, pose, velocity, jerk_limited }
    }

    /// Pose and velocity of the robot itself.
    fn robot(&self) -> (Pose, Velocity) {
        self.jerk_limited.map_or((self.pose, self.velocity), |robot| (robot.pose, robot.velocity))
    }

    fn is_finite(&self) -> bool {
        let is_finite = |(pose, velocity): (Pose, Velocity)| {
            let Pose { x, y, theta } = pose;
            [x, y, theta].iter().all(|number| number.is_finite()) && is_finite(velocity)
        };
        is_finite((self.pose, self.velocity)) && is_finite(self.robot())
    }
}

fn is_finite(velocity: Velocity) -> bool {
    velocity.v.is_finite() && velocity.omega.is_finite()
}

/// The result of the gate for a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gated {
    /// The command to issue.
    pub command: Velocity,
    /// Reason for which it is not the requested command; `None` if it is.
    pub why: Option<Refusal>,
}

impl Gated {
    /// True if the command differs from the requested one.
    pub const fn changed(&self) -> bool {
        self.why.is_some()
    }
}

/// Reason for which a command was not issued.
#[derive(Clone, Copy, Debug, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Refusal {
    /// Before it could stop, the robot would come too near to a stationary obstacle, or to the
    /// map's border.
    #[error("the robot could not stop before a stationary obstacle, {after_s:.2} s from now")]
    Standing {
        /// Time of the violation, from now \[s\].
        after_s: f64,
    },
    /// Before it could stop, a moving obstacle could touch it.
    #[error(
        "the robot could not stop before the moving obstacle of track {id} may be there, \
         {after_s:.2} s from now"
    )]
    Mover {
        /// Number of the track ([`Mover::id`]).
        id: u64,
        /// Time of the violation, from now \[s\].
        after_s: f64,
    },
    /// The robot would back up outside its field of view, and a moving obstacle may be there
    /// before it could stop.
    #[error(
        "the robot could not stop before a moving obstacle may be behind it, outside its field of \
         view, {after_s:.2} s from now"
    )]
    Unseen {
        /// Time of the violation, from now \[s\].
        after_s: f64,
    },
    /// Before it could stop, the robot would leave the observed free space.
    #[error("the robot could not stop within observed free space, {after_s:.2} s from now")]
    OutOfSight {
        /// Time of the violation, from now \[s\].
        after_s: f64,
    },
    /// The robot's centre of rotation is inside an obstacle or outside the map.
    #[error("the robot's centre is inside an obstacle or outside the map")]
    Covered,
    /// A pose, a velocity or a command that is not finite.
    #[error("the pose, the velocity or the command is not finite")]
    NotANumber,
}

/// Numbers of commands that were changed, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusalCounts {
    /// [`Refusal::Standing`].
    pub standing: u32,
    /// [`Refusal::Mover`].
    pub mover: u32,
    /// [`Refusal::Unseen`].
    #[serde(default)]
    pub unseen: u32,
    /// [`Refusal::OutOfSight`].
    #[serde(default)]
    pub out_of_sight: u32,
    /// [`Refusal::Covered`].
    pub covered: u32,
    /// [`Refusal::NotANumber`].
    pub not_a_number: u32,
}

impl RefusalCounts {
    /// Counts one refusal.
    pub const fn add(&mut self, refusal: &Refusal) {
        let count = match refusal {
            Refusal::Standing { .. } => &mut self.standing,
            Refusal::Mover { .. } => &mut self.mover,
            Refusal::Unseen { .. } => &mut self.unseen,
            Refusal::OutOfSight { .. } => &mut self.out_of_sight,
            Refusal::Covered => &mut self.covered,
            Refusal::NotANumber => &mut self.not_a_number,
        };
        *count += 1;
    }

    /// Total of all reasons.
    pub const fn total(&self) -> u32 {
        let Self { standing, mover, unseen, out_of_sight, covered, not_a_number } = *self;
        standing + mover + unseen + out_of_sight + covered + not_a_number
    }
}

/// The stop rule for one robot.
///
/// ```
/// use keyway::geometry::{Pose, Velocity};
/// use keyway::local::{Scratch, StopRule, StopRuleConfig, Surroundings};
/// use keyway::map::{DistanceField, FieldConfig, OccupancyGrid};
/// use keyway::robot::Robot;
/// use keyway::sense::SeenCells;
///
/// let map = OccupancyGrid::from_ascii(&["......", ".....#", "......"]);
/// let obstacles = DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
/// let robot = Robot::small();
/// let rule = StopRule::new(StopRuleConfig::for_robot(&robot), robot)?;
/// let (velocity, mut scratch) = (Velocity::new(0.5, 0.0), Scratch::default());
/// let mut at = |x| {
///     let pose = Pose::new(x, 1.5, 0.0);
///     let around = Surroundings {
///         obstacles: &obstacles, seen: SeenCells::ANYWHERE, movers: &[], delay_s: 0.0, pose, velocity,
///         jerk_limited: None,
///     };
///     rule.gate(&around, velocity, &mut scratch)
/// };
/// // The wall begins at 5 m: 0.18 m of footprint, 0.05 m of the next cycle and 0.25 m to stop fit
/// // before it.
/// assert!(!at(4.4).changed());
/// assert!(at(4.55).command.v < 0.5);
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct StopRule {
    config: StopRuleConfig,
    robot: Arc<Robot>,
    front: Front,
    rear: Rear,
}

impl StopRule {
    /// Number of manoeuvres that are tried between the requested command and braking.
    const HALVINGS: u32 = 3;

    /// Distance between two checked points of the front or rear, in inscribed radii.
    const SPACING: f64 = 0.2;

    /// Upper limit of the cycles until a robot stops; more are an error in its limits.
    const MAX_CYCLES: f64 = 10_000.0;

    /// The stop rule of a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid; the error
    /// names the field.
    pub fn new(config: StopRuleConfig, robot: impl Into<Arc<Robot>>) -> Result<Self, ConfigError> {
        let rule = Self::for_any_brakes(config, robot.into())?;
        let robot = &rule.robot;
        if robot.limits.stop_s() / robot.cycle_s > Self::MAX_CYCLES {
            let expected = "longer: the robot needs over 10000 cycles to stop";
            return Err(ConfigError::must_be("robot.cycle_s", expected, robot.cycle_s));
        }
        Ok(rule)
    }

    /// The same for robots that take any number of cycles to stop.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid; the error
    /// names the field.
    pub(super) fn for_any_brakes(
        config: StopRuleConfig,
        robot: Arc<Robot>,
    ) -> Result<Self, ConfigError> {
        robot.validate().map_err(|error| error.within("robot"))?;
        config.validate()?;
        let front = Front::of(&robot, Self::SPACING);
        let rear = Rear::of(&robot.footprint, Self::SPACING);
        Ok(Self { config, robot, front, rear })
    }

    /// Checks whether a command is admissible: braking from the next cycle on, the robot keeps
    /// the margin (or its present clearance, if that is less) until it is stationary. For a
    /// braking command, the check applies to braking itself.
    ///
    /// # Errors
    /// Returns the first reason for which it is not.
    pub fn admits(
        &self,
        around: &Surroundings<'_>,
        command: Velocity,
        scratch: &mut Scratch,
    ) -> Result<(), Refusal> {
        if !around.is_finite() || !is_finite(command) {
            return Err(Refusal::NotANumber);
        }
        let asked = self.reached(around, command);
        Manoeuvres::new(self, around, asked, scratch.part()).check(asked)
    }

    /// True if [`Self::gate`] leaves a command unchanged: it is braking, or admissible.
    pub(super) fn lets_pass(
        &self,
        around: &Surroundings<'_>,
        command: Velocity,
        scratch: &mut Scratch,
    ) -> bool {
        self.is_braking(around, command) || self.admits(around, command, scratch).is_ok()
    }

    fn reached(&self, around: &Surroundings<'_>, command: Velocity) -> Velocity {
        self.robot.limits.reached(around.velocity, command, self.robot.cycle_s)
    }

    /// True if a command leads to the same velocity as braking along the present arc.
    fn is_braking(&self, around: &Surroundings<'_>, command: Velocity) -> bool {
        let braking = self.robot.limits.braked(around.velocity, self.robot.cycle_s);
        self.reached(around, command) == self.reached(around, braking)
    }

    /// Returns the command to issue when `command` is requested. See the module's documentation.
    pub fn gate(
        &self,
        around: &Surroundings<'_>,
        command: Velocity,
        scratch: &mut Scratch,
    ) -> Gated {
        if !around.is_finite() {
            return Gated { command: Velocity::ZERO, why: Some(Refusal::NotANumber) };
        }
        let braking = self.robot.limits.braked(around.velocity, self.robot.cycle_s);
        if !is_finite(command) {
            return Gated { command: braking, why: Some(Refusal::NotANumber) };
        }
        if self.is_braking(around, command) {
            return Gated { command, why: None };
        }
        let asked = self.reached(around, command);
        let work: &mut Work = scratch.part();
        let mut manoeuvres = Manoeuvres::new(self, around, asked, work);
        match manoeuvres.check(asked) {
            Ok(()) => Gated { command, why: None },
            Err(why) => {
                let command = Self::nearest(&mut manoeuvres, braking, asked);
                Gated { command, why: Some(why) }
            }
        }
    }

    /// The admissible velocity nearest to the requested one, among those that are tried.
    fn nearest(manoeuvres: &mut Manoeuvres<'_>, braking: Velocity, asked: Velocity) -> Velocity {
        let mut admissible = 0.0;
        let mut refused = 1.0;
        for _ in 0..Self::HALVINGS {
            let middle = 0.5 * (admissible + refused);
            let tried = manoeuvres.check(braking.lerp(asked, middle));
            *(if tried.is_ok() { &mut admissible } else { &mut refused }) = middle;
        }
        braking.lerp(asked, admissible)
    }
}
