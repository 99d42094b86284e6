//! All planners against independent truths: brute force, a literal search over lists, a foreign
//! crate, closed forms, symmetry.
#![allow(clippy::unwrap_used)]

mod again;
mod any_angle;
mod brute_force;
mod edge_cases;
mod every_planner;
mod foreign;
mod homotopy;
mod names;
mod planners;
mod serpentine;
mod sleeve;
#[path = "../support/mod.rs"]
mod support;
mod symmetry;
mod taut;
mod textbook;
