//! What one decision may look at.

use super::Smoothed;
use crate::geometry::{Disc, Point, Polyline, Pose, Velocity};
use crate::map::{BitGrid, DistanceField};
use crate::sense::{Mover, SeenCells};

/// Everything a local planner sees in one control cycle; built by the caller. It is that of the
/// instant at which the command acts: of now, or
/// [`Robot::actuation_delay_s`](crate::robot::Robot::actuation_delay_s) later.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Distances to the squares of everything that stands, known and sensed.
    pub obstacles: &'a DistanceField,
    /// Those of the obstacle cells that were sensed and that the known map does not have.
    pub sensed: &'a BitGrid,
    /// The cells in which the robot has looked, or been ([`SeenGround`](crate::sense::SeenGround)).
    pub seen: SeenCells<'a>,
    /// Everything that moves, as far as it is known.
    pub movers: &'a [Mover],
    /// Ground on which movers walk, and around which the route leads since the robot has waited for
    /// them; mostly none.
    pub walked: &'a [Disc],
    /// Where the robot is.
    pub pose: Pose,
    /// How it moves.
    pub velocity: Velocity,
    /// Where it is to go.
    pub guide: Point,
    /// The smoothed route, from its beginning to the goal.
    pub path: &'a Polyline,
    /// Heading at the end of the route \[rad\], counter-clockwise from the x axis; `None` where any
    /// is right.
    pub goal_heading_rad: Option<f64>,
    /// What is left of the way to the place where the robot is to stop \[m\]; infinite where it
    /// need not stop. A local planner issues nothing after which the robot could not stop within
    /// this way any more.
    pub remaining_m: f64,
    /// The robot itself, if its commands are averaged: then `pose` and `velocity` are those of its
    /// reference, which is what a local planner decides for.
    pub smoothed: Option<Smoothed<'a>>,
}
