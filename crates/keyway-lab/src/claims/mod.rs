//! Claims of the papers as data, experiments that measure them, and the rule for the
//! verdicts.
//!
//! A [`Claim`] has figures, such as fewer nodes than A*. An [`Experiment`] runs all its methods
//! on a family of maps, one for each seed, and on the paper's reconstructed scene. A [`Finding`]
//! summarises a figure over the family: the change on each map, their mean and its 95 % interval.
//! [`FigureVerdict::of`] applies the rule for verdicts. No results are stored here.
//!
//! ```
//! use keyway_lab::claims::{Claim, ClaimReport, Family, Verdict};
//!
//! let claim = Claim::named("S0-5")[0];
//! let experiment = claim.experiment;
//! let (mut family, mut seed) = (Family::default(), 1);
//! while family.take(experiment, experiment.on_seed(seed, None)?, 5) {
//!     seed += 1;
//! }
//! let report = ClaimReport::new(claim, &family, true);
//! assert_ne!(report.verdict, Verdict::NotMeasured);
//! # Ok::<(), keyway_sim::episode::EpisodeError>(())
//! ```
//!
//! # Errors / cost
//! Invalid methods are errors; a missing path and a missed goal are outcomes. The module reads no
//! clock: callers pass theirs.

mod ablations;
mod catalogue;
mod claim;
mod clutter_speeds;
mod driven;
mod experiment;
mod family;
mod findings;
mod measure;
mod method;
mod planned;
mod planners;
mod reconstruction;
mod report;
mod s1;
mod shown;
mod square;
mod unknown;
mod verdict;
mod wang2019;
mod you2021;
mod zhuyin2024;

pub use ablations::{Ablation, AblationReport};
pub use claim::{Bound, Claim, Direction, Expected, Figure, Rule};
pub use clutter_speeds::Part;
pub use driven::{Driving, RunFigures, Vehicle};
pub use experiment::{Experiment, ExperimentScene, MapRow};
pub use family::Family;
pub use findings::{Finding, change_on};
pub use measure::{Measure, Scale};
pub use method::{How, Method, MethodResult};
pub use planned::{PlanTimes, Planned, Planning};
pub use reconstruction::{Baseline, Fitted, Published, Reconstruction};
pub use report::{
    ClaimReport, ExperimentReport, FamilyFigure, FamilyReport, MethodReport, PublishedFigure,
    PublishedReport, ReconstructedReport, SceneFigure, SceneReport,
};
pub use shown::{Place, Shown};
pub use verdict::{Evidence, FigureCounts, FigureVerdict, Verdict};
