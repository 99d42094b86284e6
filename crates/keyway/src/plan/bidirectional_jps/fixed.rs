//! Bidirectional jump point A* with fixed targets \[You2021, fig. 3\]: a map and two cells -> an
//! 8-connected path without corner cutting, searched for from both ends.
//!
//! The intermediate design from which the paper starts: the same search as
//! [`BidirectionalJps`](super::BidirectionalJps), but each side aims at the other's root all the
//! time. The paper says of it that it finds two paths of equal cost and expands more nodes than
//! necessary.
//!
//! # Source
//! See [`BidirectionalJps`](super::BidirectionalJps). In equation (2) the target is a root, so `b
//! G2` is 0.
//!
//! # Where this differs from the paper
//! As there. Keys need no renewal, as the targets do not move. With [`JumpMeeting::Literal`] only
//! the other side's root stops a scan; this does not miss, as a side finds the root in the end.
//!
//! # Errors / cost
//! As there.

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
    /// The sides have met when a scan comes upon any node of the other side (`generated`; with
    /// `best` they go on until nothing better can come), when one takes a node that the other has
    /// expanded (`expanded`), or when the same node is in both lists (`literal`).
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
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-jps-fixed";

    /// A planner with these parameters.
    ///
    /// # Errors
    /// When the weight is not a number of at least 0.
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
