//! What is reported of a route and of a run, as types that serde writes: the JSON of the program, for every other
//! caller as well. `docs/JSON.md` has all fields with their units.
//!
//! [`RouteReport`] is `keyway.plan/3`, [`CurveReport`] `keyway.curve/3`, [`crate::episode::EpisodeReport`]
//! `keyway.navigate/4`. Figures are measured
//! in [`crate::metrics`]; times only where the caller has a [`Clock`], as the library reads none. Members are only
//! ever added within a version of a schema.

mod curve;
mod inputs;
mod plan;
mod route;
mod run;
mod smoothed;

pub use curve::{CurveReport, CurveSample};
pub use inputs::{Inputs, MapSource, Parameters, Placed, PlacementInput};
pub use plan::{PlanOutcome, PlanPart};
pub use route::{GoalPart, ReachedGoal, RouteAnswer, RouteFailure, RouteReport, RouteRequest};
pub use run::{ContactPart, Controlled, RunPart, WayPointPart, trajectory_row};
pub use smoothed::SmoothedPart;

/// Seconds since any fixed moment, by a clock of the caller's; without one no time is measured.
pub type Clock<'a> = Option<&'a (dyn Fn() -> f64 + Sync)>;

/// Does a piece of work, and measures how long it took \[s\].
pub fn timed<R>(clock: Clock<'_>, work: impl FnOnce() -> R) -> (R, Option<f64>) {
    let begin_s = clock.map(|now_s| now_s());
    let result = work();
    (result, clock.zip(begin_s).map(|(now_s, begin_s)| now_s() - begin_s))
}
