//! The pipeline: a map and a goal -> a route -> one command per cycle. No simulator is needed: a
//! [`Controller`] sees the known map, poses, velocities and scans, and nothing else.

mod controller;
mod route;
mod stack;

pub use controller::{Blocked, Controller, Step};
pub use route::NavigateError;
pub use stack::{ControllerConfig, Stack, StackError};
