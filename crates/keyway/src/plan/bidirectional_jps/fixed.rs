//! Bidirectional jump point A* with fixed targets \[You2021, fig. 3\]: a map and two cells -> an
//! 8-connected path without corner cutting, searched for from start and goal.
//!
//! The intermediate design that precedes the paper's own: the same search as
//! [`BidirectionalJps`](super::BidirectionalJps), but each side always aims at the other's root.
//! According to the paper it finds two paths of equal cost and expands more nodes than necessary.
//!
//! # Source
//! See [`BidirectionalJps`](super::BidirectionalJps). In equation (2) the target is a root, so `b
//! G2` is 0.
//!
//! # Where this differs from the paper
//! See [`BidirectionalJps`](super::BidirectionalJps). Keys need no renewal, as the targets do not
//! move. With [`JumpMeeting::Literal`] only the other side's root stops a scan; no path is missed,
//! as a side eventually reaches the root.
//!
//! # Errors / cost
//! See [`BidirectionalJps`](super::BidirectionalJps).

use super::search::{Method, Targets};
use super::{JumpMeeting, with_metric};
use crate::ConfigError;
use crate::map::{Connectivity, SearchMap};
use crate::plan::parameters::{BoxedPlanner, PlannerParameters};
use crate::plan::two_sided::OpenKeys;
use crate::plan::{GlobalPlanner, Heuristic, Plan, PlanError};
use crate::search::{Observer, Query, Workspace};
use serde::{Deserialize, Serialize};

/// Parameters of [`BidirectionalJpsFixed`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct BidirectionalJpsFixedConfig {
    /// The meeting condition: a scan reaches any node of the other side (`generated`; with `best`
    /// the search continues until no better meeting is possible), a side takes a node that the
    /// other has expanded (`expanded`), or the same node is in both lists (`literal`).
    pub meeting: JumpMeeting,
    /// The estimate H of the cost to the other side's root: `octile`, `euclidean`, `manhattan` or
    /// `mean`, eq. (3).
    pub heuristic: Heuristic,
    /// Weight of the estimate in eq. (2), at least 0.
    pub a: f64,
}

impl BidirectionalJpsFixedConfig {
    /// Equations (2) and (3) with the values of table 1.
    pub const PAPER: Self =
        Self { meeting: JumpMeeting::Generated, heuristic: Heuristic::Mean, a: 3.0 };
}

impl Default for BidirectionalJpsFixedConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Bidirectional jump point A* with fixed targets; not optimal.
#[derive(Clone, Debug, Default)]
pub struct BidirectionalJpsFixed {
    config: BidirectionalJpsFixedConfig,
}

impl BidirectionalJpsFixed {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-jps-fixed";

    /// Creates a planner with these parameters.
    ///
    /// # Errors
    /// Returns an error if the weight is not a number of at least 0.
    pub fn new(config: BidirectionalJpsFixedConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config })
    }
}

impl PlannerParameters for BidirectionalJpsFixedConfig {
    fn check(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("a", self.a)
    }

    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(BidirectionalJpsFixed::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["meeting"]
    }
}

impl GlobalPlanner for BidirectionalJpsFixed {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        Connectivity::Four
    }

    fn needs_uniform_cost(&self) -> bool {
        true
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let BidirectionalJpsFixedConfig { meeting, heuristic, a } = self.config;
        let (planner, targets, keys) = (Self::NAME, Targets::Fixed, OpenKeys::Kept);
        with_metric!(heuristic, metric => {
            let method = Method { planner, targets, meeting, keys, metric, a, b: 0.0 };
            method.plan(map, query, workspace, seen, plan)
        })
    }
}
