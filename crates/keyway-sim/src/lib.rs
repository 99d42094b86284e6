//! A world in time for robots of [`keyway`]: lidars, late motors, obstacles that move, several
//! robots at once; and what is measured of a run.
//!
//! | stage | module | from -> to |
//! |---|---|---|
//! | worlds | [`worlds`] | a seed -> a map |
//! | simulate | [`sim`] | controllers, robots and a world -> runs |
//! | measure | [`metrics`] | a path or a run -> figures |
//! | report | [`report`] | a route or a run -> what JSON reports say of it |
//! | all of it | [`episode`] | a world, a robot and a stack -> a run and its report |
//! | files | `scene_files` | a text -> an episode |
//! | threads | [`parallel`] | items -> results, in their order |
//!
//! Everything is deterministic: equal inputs and seeds give equal bytes. No function prints or
//! reads a clock.

pub mod episode;
pub mod metrics;
pub mod parallel;
pub mod report;
#[cfg(feature = "formats")]
pub mod scene_files;
pub mod sim;
pub mod worlds;

/// The library example of the repository's README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
mod readme {}
