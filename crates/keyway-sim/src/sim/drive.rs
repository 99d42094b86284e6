//! Simulation of robots and their controllers in a world until they arrive, collide or give up.

use super::fleet::{Entrant, Fleet};
use super::participant::{Action, Control, Participant};
use super::{RobotState, Run, World};
use crate::parallel::for_each;
use keyway::ConfigError;
use keyway::geometry::{Point, Pose, Velocity};
use keyway::given::Given;
use keyway::sense::Observation;
use std::borrow::Cow;
use thiserror::Error;

/// Reason why a simulation failed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimError {
    /// A value of a robot, its rules, its start or its goal is invalid. The path begins with the
    /// name of this argument; with several participants, with the participant:
    /// `participants[1].start.x`.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A controller commanded a velocity that is not a number.
    #[error(
        "the command of cycle {cycle} for robot {robot} is not a number: v = {} m/s, omega = {} rad/s; \
         its controller must return numbers",
        command.v, command.omega
    )]
    Command {
        /// Index of the participant.
        robot: usize,
        /// The cycle, from 0.
        cycle: u64,
        /// The command.
        command: Velocity,
    },
    /// A controller gave up the simulation ([`Action::GiveUp`]).
    #[error("the simulation was aborted in cycle {cycle}")]
    GivenUp {
        /// The cycle, from 0.
        cycle: u64,
    },
}

/// Drives robots in the same world at the same time, each from rest at its start towards its
/// goal, until each has an outcome. Returns the runs in the order of the participants. A single
/// robot is a slice of one.
///
/// All robots have the same cycle. At the start and at the end of every cycle, each robot's goal
/// is tested ([`Arrival::Passing`](super::Arrival)), then its time limit. Then its controller
/// gets the pose, the velocity and the scans of its sensors, as changed by its
/// [`Disturbances`](super::Disturbances), and returns its decision. Then its arrival
/// ([`Arrival::Standing`](super::Arrival)) and progress are tested. The controllers are called in
/// the order of the participants, but all decide on the state at the beginning of the cycle.
/// During the cycle the velocities change linearly towards the commands within the robots'
/// limits, and contact is tested along the whole swept motions.
///
/// Robots sense each other, have a clearance from each other ([`Run::min_clearance_m`]) and may
/// collide. A contact between two robots ends both runs
/// ([`Obstacle::Robot`](super::Obstacle::Robot)). A robot whose run has ended for any reason is
/// stationary from that instant on and is an obstacle for the others; later contacts do not
/// change its run. Contacts at the same instant are handled in this order: with static obstacles,
/// with moving obstacles, then between the robots with the lowest indices.
///
/// Deterministic: equal arguments give equal bytes.
///
/// # Cost
/// In addition to the cost of each robot alone: a few operations per pair of robots and cycle if
/// the two cannot meet in that cycle, and a few more per pair of their edges if they can.
///
/// # Errors
/// Returns an error if an argument is invalid, the robots have different cycles, or a controller
/// commands NaN.
pub fn simulate(world: &World, participants: &mut [Participant<'_>]) -> Result<Vec<Run>, SimError> {
    simulate_on(1, world, participants)
}

/// Returns the runs of [`simulate`], with the decisions of a cycle spread over this many threads.
/// Controllers of different robots are then called concurrently and in any order.
///
/// # Errors
/// Those of [`simulate`].
pub fn simulate_on(
    threads: usize,
    world: &World,
    participants: &mut [Participant<'_>],
) -> Result<Vec<Run>, SimError> {
    check(participants)?;
    let Some(first) = participants.first() else { return Ok(Vec::new()) };
    let entrants = participants.iter().map(Entrant::of);
    let mut fleet = Fleet::new(Cow::Borrowed(world), entrants, first.robot.cycle_s);
    while fleet.is_driving() {
        let is_asked: Vec<bool> = (0..participants.len()).map(|index| fleet.sense(index)).collect();
        let mut asked: Vec<Asked<'_, '_>> = participants
            .iter_mut()
            .enumerate()
            .filter(|(index, _)| is_asked[*index])
            .map(|(index, participant)| Asked { index, participant, control: None })
            .collect();
        decide_all(&mut asked, &fleet, threads);
        let controls: Vec<_> = asked.iter().map(|asked| (asked.index, asked.control)).collect();
        for (index, control) in controls {
            let (Some(control), cycle) = (control, fleet.cycle(index)) else { continue };
            if fleet.goes_on(index, &control) {
                fleet.command(index, command(control.action, index, cycle)?);
            }
        }
        fleet.drive_cycle();
    }
    Ok(fleet.into_runs())
}

/// A robot with a decision due in a cycle, and its decision.
struct Asked<'a, 'p> {
    index: usize,
    participant: &'a mut Participant<'p>,
    control: Option<Control>,
}

impl Asked<'_, '_> {
    fn decide(&mut self, fleet: &Fleet<'_>) {
        let RobotState { stamp_s, pose, velocity } = fleet.told(self.index);
        let scans = fleet.scans(self.index);
        let observation = Observation::new(stamp_s, pose, velocity, &scans);
        self.control = Some((self.participant.controller)(&observation));
    }
}

/// Calls the controllers. All decide on the same state, so their order does not matter.
fn decide_all(asked: &mut [Asked<'_, '_>], fleet: &Fleet<'_>, threads: usize) {
    let threads = threads.min(asked.len());
    for_each(asked, threads, |asked| asked.decide(fleet));
}

/// Checks all arguments. With several participants, a path begins with the participant.
pub(super) fn check(participants: &[Participant<'_>]) -> Result<(), ConfigError> {
    let is_alone = participants.len() == 1;
    let named = |index: usize, error: ConfigError| {
        if is_alone { error } else { error.within(&format!("participants[{index}]")) }
    };
    for (index, Participant { robot, .. }) in participants.iter().enumerate() {
        let valid = robot.validate().map_err(|error| error.within("robot"));
        let same = valid.and_then(|()| check_cycle(robot.cycle_s, participants[0].robot.cycle_s));
        same.map_err(|error| named(index, error))?;
    }
    for (index, Participant { start, goal, rules, .. }) in participants.iter().enumerate() {
        let valid = rules.validate().map_err(|error| error.within("rules"));
        valid.and_then(|()| check_places(*start, *goal)).map_err(|error| named(index, error))?;
    }
    for (index, Participant { robot, disturbances, .. }) in participants.iter().enumerate() {
        let valid = disturbances.validate_for(robot);
        let valid = valid.map_err(|error| error.within("disturbances"));
        valid.map_err(|error| named(index, error))?;
    }
    Ok(())
}

fn check_cycle(cycle_s: f64, first_cycle_s: f64) -> Result<(), ConfigError> {
    if cycle_s == first_cycle_s {
        return Ok(());
    }
    let expected = format!("{}, the cycle of the first robot", Given(first_cycle_s));
    Err(ConfigError::must_be("robot.cycle_s", &expected, cycle_s))
}

/// Velocity that an action commands.
pub(super) fn command(action: Action, robot: usize, cycle: u64) -> Result<Velocity, SimError> {
    match action {
        Action::Drive(command) if command.v.is_nan() || command.omega.is_nan() => {
            Err(SimError::Command { robot, cycle, command })
        }
        Action::Drive(command) => Ok(command),
        Action::Arrived | Action::Stop => Ok(Velocity::ZERO),
        Action::GiveUp => Err(SimError::GivenUp { cycle }),
    }
}

fn check_places(start: Pose, goal: Point) -> Result<(), ConfigError> {
    let values = [
        ("start.x", start.x),
        ("start.y", start.y),
        ("start.theta", start.theta),
        ("goal.x", goal.x),
        ("goal.y", goal.y),
    ];
    match values.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((path, value)) => Err(ConfigError::must_be(path, "finite", value)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
