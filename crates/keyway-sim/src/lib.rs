//! Simulation of robots of [`keyway`] in a world in time: lidars, delayed motors, moving
//! obstacles, several robots at once; and the metrics of a run.
//!
//! | stage | module | from -> to |
//! |---|---|---|
//! | worlds | [`worlds`] | a seed -> a map |
//! | simulate | [`sim`] | controllers, robots and a world -> runs |
//! | measure | [`metrics`] | a path or a run -> metrics |
//! | report | [`report`] | a route or a run -> the content of a JSON report |
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

/// The examples of the repository's pages run as tests.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../../README.md")]
    mod readme {}
    #[doc = include_str!("../../../docs/rust.md")]
    mod rust {}
}
