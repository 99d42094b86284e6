//! The stop rule: a command is issued only if the robot can then still brake to a stop before it
//! touches anything. A gate of its own, behind any local planner.
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
//! The *manoeuvre* of a command: in one cycle the velocity changes linearly from the present one to
//! what the limits let the robot reach of the command; then, cycle by cycle, it brakes along its
//! arc ([`Limits::braked`](crate::robot::Limits::braked)) until it stands. A command is admissible
//! when on the whole manoeuvre
//!
//! 1. the footprint keeps `margin_m` from all obstacle squares and from the map's border;
//! 2. at every instant it keeps `margin_m` from all ground that a mover may cover by then
//!    ([`Mover::by_speed`] or, if an acceleration is given, [`Mover::by_estimate`]);
//! 3. its rear keeps to the ground of [`Surroundings::seen`] wherever it drives backwards, if its
//!    sensor does not see all around: to where nobody can have come by then, seen before or not
//!    ([`SeenGround`](crate::sense::SeenGround)), and it stands within the time for which that is
//!    known. What is left of a way back that is reversed in the cycle is not asked about.
//! 4. wherever it drives ahead, its front stays three quarters of a cell before the end of what has
//!    been seen ([`Surroundings::seen`]); to either side, the next cell is as good. Within what has
//!    been seen it may come as near as it likes to an obstacle that is known and to the end of the
//!    map, where nothing else stands. What stands farther away is met too late. So the robot never
//!    drives faster than it can stop within what it has seen free: within its sensor's range,
//!    before it can look around a corner, and where no beam says anything.
//!
//! The manoeuvre begins when the command acts, [`Surroundings::delay_s`] after the instant at which
//! the movers are known. What the robot does until then was decided before, when it was the
//! beginning of the manoeuvre of an earlier command.
//!
//! Of a robot with limits of jerk ([`Surroundings::smoothed`]), what is asked for is a velocity of
//! its reference, and so is braking; the manoeuvre is that of the robot itself: in every cycle it
//! gets the mean of the last velocities of the reference
//! ([`CommandWindow`](crate::robot::CommandWindow)), those of the cycles before included, until
//! nothing of them is left. (3) and (4) are then asked, too, where only what is left leads back or
//! ahead.
//!
//! An admissible command passes unchanged. Otherwise the gate goes from there towards braking along
//! the present arc and issues the nearest velocity on that line which it finds admissible; and
//! braking when there is none. Who asks for braking along the present arc always gets it.
//!
//! # What follows from it
//! With ideal motion (as above), a pose and velocity that are right, a delay that is known, and
//! every mover in view:
//!
//! - no contact ever with anything that stands in view;
//! - none with anything that stands out of view while the robot drives ahead, if its sensor looks
//!   at all of its front: such a thing stands on ground that has not been seen, and the robot could
//!   stop before that. One that is narrower than three cells may be missed between other things,
//!   and one that is narrower than 6 cm, or than a cell, between two beams;
//! - no contact with a mover while the robot moves. A mover may run into a robot that stands, or
//!   into a disc that turns on the spot, which covers no other ground.
//!
//! With a sensor that does not see all around, the robot backs into nobody, to within a cell: all
//! of the manoeuvre lies within the time for which cells are known to be free. Nobody is expected
//! to come through walls that the map shows, or through what was seen to stand. Who comes from
//! where it does not look may still run into the robot while it drives ahead, and into the corners
//! of a polygon that turns.
//!
//! *Proof sketch.* Say that a state is safe when braking along the present arc touches nothing,
//! whatever the movers do within their bounds. A robot at rest is safe: its manoeuvre is standing
//! still. Let the state be safe. If the gate issues an admissible command, (1) to (4) hold on its
//! manoeuvre: obstacles stand, what was seen stays seen, and a mover that is inside its disc and
//! keeps the bounds is inside the discs of all later instants. Its first cycle is what happens, and
//! the rest of it is braking along the arc of the next state, which is therefore safe. If the gate
//! brakes, what happens is the first cycle of a manoeuvre that touches nothing, and the next state
//! has the rest of it. So every state is safe, and the way from one to the next is part of a
//! manoeuvre that touches nothing. It does not matter that estimates change from cycle to cycle, if
//! each of them holds the mover. With limits of jerk, a state is that of the robot along with what
//! is averaged, and braking is that of its reference. The first cycle of a manoeuvre is again what
//! happens, and leaves a state from which braking is the rest of that manoeuvre; the rest of the
//! proof needs no more. ∎
//!
//! No place of a manoeuvre is skipped: between two poses no part of the footprint moves farther
//! than [`Core::moves_m`], so a step as long as the room less the margin stays clear of the margin.
//! Steps are never shorter than the margin; on one of that length at least half of the margin is
//! left.
//!
//! # A start inside the margin or in contact
//! An obstacle nearer than the margin may be as near as it is when a command is admitted, but not
//! nearer, until the next command is admitted: the robot may leave it or pass along it. Braking is
//! not admitted anew. So where the robot has meanwhile come farther from something, and then
//! brakes, it may come as near again as it was at the last command that was. All of this holds to a
//! nanometre for each command, which is more than rounding takes, and, where the robot counts as
//! standing, to what it drifts until the end of the cycle: such a velocity is taken for noise of
//! odometry (at most half of a cycle at a hundredth of full speed). In between two instants that
//! are looked at, half of a distance of at least 0.1 mm is kept. No such exception is made for
//! movers: beside one that may touch it, no part of a robot moves farther than a nanometre in
//! a quarter of a cycle, until the mover is gone, or has stood so long that it counts as standing
//! ([`TrackerConfig::standing_s`](crate::sense::TrackerConfig::standing_s)).
//!
//! A robot that touches something when a command is admitted, or is nearer to it than 0.1 mm, may
//! touch nothing else until the next one is, but for the squares beside those that it touches in
//! which the latest scan met something ([`SeenCells::scan`]). There it keeps away from the very
//! places that the scan met, as it does from obstacles, so that it may go along a wall whose
//! squares it touches. What such squares hold is met by no more than two beams are apart there.
//! From what it touches, a disc may be as far as it is, while a polygon is shrunk around its centre
//! of rotation until it touches nothing, and that part of it may touch nothing. A robot whose
//! centre of rotation is inside an obstacle or outside the map is stopped: no way out can be told
//! from a way in. When not even braking is admissible (something came into view too late, or a
//! mover broke the bounds), the robot brakes.
//!
//! # Where this differs from the paper
//! - Directional: what counts is the ground that the footprint covers on its arc, not a distance to
//!   all sides.
//! - The footprint is a disc or a polygon; the paper's robot is a point.
//! - The cycle's motion is known, where the paper allows anything up to A.
//!
//! # Out of scope
//! Who comes out of what the sensor does not see, but for (3): beyond its range, from the shadow of
//! something. He counts as a mover as soon as about 0.1 m of him is where the robot has seen
//! through before ([`Tracker::possible_movers`](crate::sense::Tracker::possible_movers)). Whoever
//! needs more adds a mover where one could come from. Errors of pose and motion: the margin is what
//! there is for them.
//!
//! # Errors / cost
//! [`ConfigError`]. Where nothing is near, one look into the field and one distance per mover;
//! otherwise a look-up for every step, which are few in the open and at most as many as margins fit
//! into the manoeuvre. Up to four manoeuvres are looked at. Allocates nothing once the scratch is
//! warm.

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
use super::{Scene, Scratch, Smoothed};
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
    /// The footprint is kept this far from everything, once it is that far away \[m\]; positive.
    pub margin_m: f64,
    /// What movers can do at most.
    pub movers: MoverBounds,
}

impl StopRuleConfig {
    /// For a robot: half of what its local planner keeps from obstacles
    /// ([`Robot::safety_margin_m`]), so that the gate leaves alone what such a planner finds
    /// admissible. Movers are people: they walk at up to 1.5 m/s, and may turn around at once.
    pub fn for_robot(robot: &Robot) -> Self {
        Self {
            margin_m: 0.5 * robot.safety_margin_m(),
            movers: MoverBounds { speed_mps: 1.5, acceleration_mps2: None },
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// Names the first field that cannot be used.
    pub fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("margin_m", self.margin_m)?;
        self.movers.validate().map_err(|error| error.within("movers"))
    }
}

/// What is around a robot in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Distances to the squares of everything that stands, known and sensed.
    pub obstacles: &'a DistanceField,
    /// Ground that has been seen ([`SeenGround::cells`](crate::sense::SeenGround::cells)): to where
    /// it may drive so fast that it can just stop before, and over what it may back up.
    pub seen: SeenCells<'a>,
    /// Everything that moves, or may move, as it was observed last. One with a number that is not
    /// finite, or a negative length, is left out.
    pub movers: &'a [Mover],
    /// From that instant to the one at which the command acts \[s\].
    pub delay_s: f64,
    /// Pose of the robot when the command acts; that of its reference, if its commands are averaged.
    pub pose: Pose,
    /// Its velocity then.
    pub velocity: Velocity,
    /// The robot itself, if its commands are averaged.
    pub smoothed: Option<Smoothed<'a>>,
}

impl<'a> Surroundings<'a> {
    /// Everything that stands, as a local planner sees it. Nothing is asked about what has been
    /// seen, and nothing moves.
    pub const fn standing(scene: &Scene<'a>) -> Self {
        let Scene { obstacles, pose, velocity, smoothed, .. } = *scene;
        let (seen, movers, delay_s) = (SeenCells::ANYWHERE, &[], 0.0);
        Self { obstacles, seen, movers, delay_s, pose, velocity, smoothed }
    }

    /// The robot itself.
    fn robot(&self) -> (Pose, Velocity) {
        self.smoothed.map_or((self.pose, self.velocity), |robot| (robot.pose, robot.velocity))
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

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gated {
    /// The command to issue.
    pub command: Velocity,
    /// Why it is not the one that was asked for; none when it is.
    pub why: Option<Refusal>,
}

impl Gated {
    /// True if the command is another one than was asked for.
    pub const fn changed(&self) -> bool {
        self.why.is_some()
    }
}

/// Why a command was not issued.
#[derive(Clone, Copy, Debug, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Refusal {
    /// Before it could stop, the robot would come too near to something that stands, or to the
    /// map's border.
    #[error("the robot could not stop before something that stands, {after_s:.2} s from now")]
    Standing {
        /// When, from now \[s\].
        after_s: f64,
    },
    /// Before it could stop, a mover could touch it.
    #[error(
        "the robot could not stop before what it follows as track {id} may be there, {after_s:.2} s from now"
    )]
    Mover {
        /// The number of its track ([`Mover::id`]).
        id: u64,
        /// When, from now \[s\].
        after_s: f64,
    },
    /// The robot would back up where it does not look, and somebody may come before it could stop.
    #[error(
        "the robot could not stop before somebody may be behind it, where it does not look, {after_s:.2} s from now"
    )]
    Unseen {
        /// When, from now \[s\].
        after_s: f64,
    },
    /// Before it could stop, the robot would be where it has not seen that nothing stands.
    #[error("the robot could not stop within what it has seen to be free, {after_s:.2} s from now")]
    OutOfSight {
        /// When, from now \[s\].
        after_s: f64,
    },
    /// The robot's centre of rotation is inside an obstacle or outside the map.
    #[error("the robot's centre is inside an obstacle or outside the map")]
    Covered,
    /// A pose, a velocity or a command that is not finite.
    #[error("the pose, the velocity or the command is not a number")]
    NotANumber,
}

/// How many commands were changed, by reason.
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
    /// Counts one more.
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

    /// All of them.
    pub const fn total(&self) -> u32 {
        let Self { standing, mover, unseen, out_of_sight, covered, not_a_number } = *self;
        standing + mover + unseen + out_of_sight + covered + not_a_number
    }
}

/// The gate.
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
///         smoothed: None,
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
    /// Manoeuvres that are tried between what was asked for and braking.
    const HALVINGS: u32 = 3;

    /// Distance of two points of the front or rear that are looked at, in inscribed radii.
    const SPACING: f64 = 0.2;

    /// More cycles than this until a robot stands are a mistake in its limits.
    const MAX_CYCLES: f64 = 10_000.0;

    /// The gate of a robot.
    ///
    /// # Errors
    /// When a value of the robot or the config cannot be used; the error names the field.
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
    /// When a value of the robot or the config cannot be used; the error names the field.
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

    /// Tells whether a command is admissible: the robot keeps the margin (or what it has, where
    /// that is less) until it stands when it brakes from the next cycle on. Asked for braking, it
    /// tells whether that does.
    ///
    /// # Errors
    /// The first reason for which it is not.
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

    /// Tells whether [`Self::gate`] leaves a command as it is: it is braking, or admissible.
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

    /// True if a command leads to what braking along the present arc leads to.
    fn is_braking(&self, around: &Surroundings<'_>, command: Velocity) -> bool {
        let braking = self.robot.limits.braked(around.velocity, self.robot.cycle_s);
        self.reached(around, command) == self.reached(around, braking)
    }

    /// The command to issue when `command` is asked for. See the module's documentation.
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

    /// The velocity nearest to what was asked for, of those that are tried and admissible.
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
