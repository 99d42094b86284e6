//! Reports of routes and runs, as types that serde serializes: the JSON of the program, also for
//! other callers. `docs/reference/json.md` lists all fields with their units.
//!
//! [`RouteReport`] is `keyway.plan/3`, [`CurveReport`] `keyway.curve/3`,
//! [`crate::episode::RobotReport`] `keyway.navigate/4`. Metrics are computed in
//! [`crate::metrics`]. Times are measured only if the caller provides a [`Clock`], because the
//! library reads none. Within a version of a schema, members are only ever added.

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

/// Seconds since a fixed instant, by the caller's clock; without a clock, no time is measured.
pub type Clock<'a> = Option<&'a (dyn Fn() -> f64 + Sync)>;

/// Runs a function, and returns its result and its duration \[s\].
pub fn timed<R>(clock: Clock<'_>, work: impl FnOnce() -> R) -> (R, Option<f64>) {
    let begin_s = clock.map(|now_s| now_s());
    let result = work();
    (result, clock.zip(begin_s).map(|(now_s, begin_s)| now_s() - begin_s))
}
