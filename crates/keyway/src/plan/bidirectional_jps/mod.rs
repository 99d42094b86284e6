//! Improved bidirectional jump point A* \[You2021\]: a map and two cells -> an 8-connected path
//! without corner cutting, searched for from start and goal.
//!
//! Jump point searches from the start and from the goal take turns: a side expands nodes until it
//! has inserted some into its open list, then the other side continues, until both have a node in
//! common. Each side aims at the node that the other one expanded last, which draws the two
//! searches together. [`BidirectionalJpsFixed`] is the design that the paper improves on: there
//! each side aims at the other's root.
//!
//! # Source
//! \[You2021\]: sections 1.2 and 1.3, equations (2) and (3), figs. 3 to 5, table 1. Jump points:
//! \[Harabor2011\].
//!
//! | paper | here | unit | table 1 |
//! |---|---|---|---|
//! | `F1(n)`, `F2(n)` of eq. (2) | the key of `TowardsTarget` | [`Cost::key`](crate::search::Cost::key) | |
//! | `G1(n)`, `G2(n)` | the sides' values g: cost from the start, to the goal | [`Cost::key`](crate::search::Cost::key) | |
//! | `H1(n)`, `H2(n)` of eq. (3) | [`heuristic`](BidirectionalJpsConfig::heuristic), from the node to the other side's target | [`Cost::key`](crate::search::Cost::key) | `mean` |
//! | a, b | [`a`](BidirectionalJpsConfig::a), [`b`](BidirectionalJpsConfig::b) | | 3.0, 1.0 |
//! | openlist 1, openlist 2 | the frontiers of both sides | | |
//!
//! # Where this differs from the paper
//! The paper leaves these points open; they are decided as follows:
//! - **Target.** "The jump point before" the ones just found is the node that the other side
//!   expanded last, initially its root. In eq. (2) `H1` and `G2` belong to that one point.
//! - **Meeting.** The paper ends when the same jump point is in both lists. Taken literally
//!   ([`JumpMeeting::Literal`]) the searches can pass each other: see `docs/lab/findings.md`. By
//!   default ([`JumpMeeting::Generated`]) every node of the other side, open or closed, stops a
//!   scan and becomes a node of this side, too, even if it is not a jump point of this side.
//! - **Several meetings** in one expansion: the one with the cheapest path counts, in a tie the
//!   first.
//! - **Keys** are computed when a node is inserted into the open list, with the target of that
//!   moment, and kept while targets move ([`OpenKeys`]). If they were renewed, `b G2` would be the
//!   same value for all open nodes, and b would have no effect.
//! - **Duplicates** are compared by g; closed nodes are not reopened. Ties: key, then larger g,
//!   then lower cell index. The forward side begins.
//! - **An empty open list** of either side ends the search.
//!
//! The two halves of a path may share cells before they meet: the path then doubles back (6 of
//! 92,513 random queries; `docs/lab/findings.md`). It is returned exactly as the method finds it.
//!
//! (3) exceeds the true cost even with a = 1 (a diagonal step: 1.707 for 1.414), and the search
//! ends at the first meeting: paths need not be shortest ones.
//!
//! # Does it miss?
//! With [`JumpMeeting::Generated`], a side whose list ran empty has scanned every cell reachable
//! from its root, in jumps that end at the first node of the other side: it would have found the
//! other root. This argument needs only one direction of arrival per node, in whatever order nodes
//! are expanded. That is not proved here, but tested: on 20 million small random maps with nodes
//! in random order no cell was missed, and `tests/bidirectional_jps.rs` checks it with all kinds
//! of weights.
//!
//! # Errors / cost
//! See [`PlanError`]; a map with penalised cells is refused, as jump points need one cost for all
//! cells. [`Miss::SidesPassed`](super::Miss::SidesPassed) with [`JumpMeeting::Literal`] only.
//! Memory per cell of the padded map: 32 bytes, and half a byte for stops of scans; only the pages
//! of nodes are touched.

mod fixed;
mod jumps;
mod marks;
mod search;
#[cfg(test)]
mod tests;

pub use fixed::{BidirectionalJpsFixed, BidirectionalJpsFixedConfig};

use super::heuristic::with_metric;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::two_sided::OpenKeys;
use super::{GlobalPlanner, Heuristic, Plan, PlanError};
use crate::ConfigError;
use crate::map::{Connectivity, SearchMap};
use crate::search::{Observer, Query, Workspace};
use search::{Method, Targets};
use serde::{Deserialize, Serialize};

/// The condition under which the two sides have met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum JumpMeeting {
    /// They meet when a scan reaches any node of the other side.
    #[default]
    Generated,
    /// They meet when one side takes a node from its list that the other has expanded.
    Expanded,
    /// After a meeting as with [`Self::Generated`] they continue until no open node of one side
    /// can lead to a cheaper path. As closed nodes stay closed, even this path need not be a
    /// shortest one.
    Best,
    /// They meet when the same node is in both lists; of the other side's nodes only the target
    /// stops a scan. This can miss a path.
    Literal,
}

/// Parameters of [`BidirectionalJps`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct BidirectionalJpsConfig {
    /// The meeting condition: a scan reaches any node of the other side (`generated`; with `best`
    /// the search continues until no better meeting is possible), a side takes a node that the
    /// other has expanded (`expanded`), or the same node is in both lists (`literal`, which can
    /// miss a path).
    pub meeting: JumpMeeting,
    /// The treatment of the keys of open nodes when the target moves: `kept` or `renewed`. If they
    /// are renewed, b has no effect.
    pub keys: OpenKeys,
    /// The estimate H of the cost to the target: `octile`, `euclidean`, `manhattan` or `mean`, eq.
    /// (3).
    pub heuristic: Heuristic,
    /// Weight of the estimate in eq. (2), at least 0.
    pub a: f64,
    /// Weight of the target's cost from the other side in eq. (2), at least 0.
    pub b: f64,
}

impl BidirectionalJpsConfig {
    /// Equations (2) and (3) with the values of table 1.
    pub const PAPER: Self = Self {
        meeting: JumpMeeting::Generated,
        keys: OpenKeys::Kept,
        heuristic: Heuristic::Mean,
        a: 3.0,
        b: 1.0,
    };
}

impl Default for BidirectionalJpsConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Bidirectional jump point A* with moving targets; not optimal.
#[derive(Clone, Debug, Default)]
pub struct BidirectionalJps {
    config: BidirectionalJpsConfig,
}

impl BidirectionalJps {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "bidirectional-jps";

    /// Creates a planner with these parameters.
    ///
    /// # Errors
    /// Returns an error if a weight is not a number of at least 0.
    pub fn new(config: BidirectionalJpsConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config })
    }
}

impl PlannerParameters for BidirectionalJpsConfig {
    fn check(&self) -> Result<(), ConfigError> {
        ConfigError::unless_not_negative("a", self.a)?;
        ConfigError::unless_not_negative("b", self.b)
    }

    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(BidirectionalJps::new(self.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        &["meeting", "keys"]
    }
}

impl GlobalPlanner for BidirectionalJps {
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
        let BidirectionalJpsConfig { meeting, keys, heuristic, a, b } = self.config;
        let (planner, targets) = (Self::NAME, Targets::Moving);
        with_metric!(heuristic, metric => {
            let method = Method { planner, targets, meeting, keys, metric, a, b };
            method.plan(map, query, workspace, seen, plan)
        })
    }
}
