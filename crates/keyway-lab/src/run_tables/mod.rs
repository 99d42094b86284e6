//! Routes, episodes and teams as tables for the terminal.

mod episode;
mod path_facts;
mod route;
mod smoothing_targets;
mod team;

pub use episode::episode_table;
pub use route::route_table;
pub use smoothing_targets::SmoothingTargets;
pub use team::team_table;
