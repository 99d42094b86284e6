//! Navigators in continuous use: goals, maps, limits and clocks change while the robot drives.
#![allow(clippy::unwrap_used)]

mod acts;
mod changes;
mod clocks;
mod doubts;
mod goals;
mod jerk;
mod mishaps;
mod points;
mod random_calls;
mod robot_in_a_world;
mod snapshots;
mod way_points;
