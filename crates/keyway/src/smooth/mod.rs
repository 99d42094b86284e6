//! Smoothers: from the line of a plan to a shorter line that keeps its clearance; and how fast a path
//! can be driven.

mod bidirectional;
mod continuous_curvature;
mod corner_blend;
mod hierarchical;
mod key_points;
mod line_of_sight;
mod room;
mod shadow;
mod shadows;
mod shortcut;
mod smoothed;
mod speed_profile;
mod stretches;
mod taut;

pub use bidirectional::{BidirectionalSmoothingConfig, Select};
pub use continuous_curvature::{ContinuousCurvatureConfig, continuous_curvature};
pub use hierarchical::{BendsKeep, HierarchicalSmoothingConfig};
pub use key_points::{KeyPointCandidates, KeyPointSmoothingConfig};
pub use line_of_sight::line_of_sight;
pub use shortcut::ShortcutConfig;
pub use smoothed::{SharpCorner, Smoothed, WhySharp};
pub use speed_profile::{
    SpeedLimit, SpeedProfile, SpeedProfileConfig, SpeedProfileError, SpeedSample,
};
pub use taut::taut;

use crate::geometry::{PlannedLine, Polyline};
use crate::given::Given;
use crate::map::Clearance;
use room::Room;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A smoother and its parameters, as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "name", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SmootherConfig {
    /// The line as planned, collinear points merged.
    None {},
    /// From each kept point straight on to the farthest point of the path that it can see.
    LineOfSight {},
    /// Key points: the turning points, and points that keep the path away from obstacles.
    KeyPoints(KeyPointSmoothingConfig),
    /// From the start and then from the goal, straight on to the farthest place of the path that can
    /// safely be reached.
    Bidirectional(BidirectionalSmoothingConfig),
    /// A point is dropped where those before and after it can be joined; in several passes.
    Shortcut(ShortcutConfig),
    /// Straight stretches at a safe distance, joined by the bends of a cubic B-spline.
    Hierarchical(HierarchicalSmoothingConfig),
    /// The locally shortest path at the clearance, pulled tight like a string around the same
    /// obstacles; its bends are arcs of the clearance's radius.
    Taut {},
    /// Line of sight, then every corner rounded by two cubic curves, with continuous curvature within
    /// a turning limit.
    ContinuousCurvature(ContinuousCurvatureConfig),
}

/// A parameter of a smoother that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field} must be {expected}, got {}", Given(*.value))]
pub struct SmootherError {
    /// The field of the smoother's config.
    pub field: &'static str,
    /// What was expected.
    pub expected: &'static str,
    /// What was given.
    pub value: f64,
}

impl SmootherError {
    /// Refuses what is not a number of at least 0.
    fn unless_distance(field: &'static str, value: f64) -> Result<(), Self> {
        if value >= 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(Self { field, expected: "a number of at least 0", value })
    }
}

impl SmootherConfig {
    /// Names of all smoothers, for [`Self::by_name`].
    pub const NAMES: [&'static str; 8] = [
        "none",
        "line-of-sight",
        "key-points",
        "bidirectional",
        "shortcut",
        "hierarchical",
        "taut",
        "continuous-curvature",
    ];

    /// A smoother with its default parameters.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "none" => Some(Self::None {}),
            "line-of-sight" => Some(Self::LineOfSight {}),
            "key-points" => Some(Self::KeyPoints(KeyPointSmoothingConfig::default())),
            "bidirectional" => Some(Self::Bidirectional(BidirectionalSmoothingConfig::default())),
            "shortcut" => Some(Self::Shortcut(ShortcutConfig::default())),
            "hierarchical" => Some(Self::Hierarchical(HierarchicalSmoothingConfig::default())),
            "taut" => Some(Self::Taut {}),
            "continuous-curvature" => {
                Some(Self::ContinuousCurvature(ContinuousCurvatureConfig::default()))
            }
            _ => None,
        }
    }

    /// The smoother's name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::None {} => Self::NAMES[0],
            Self::LineOfSight {} => Self::NAMES[1],
            Self::KeyPoints(_) => Self::NAMES[2],
            Self::Bidirectional(_) => Self::NAMES[3],
            Self::Shortcut(_) => Self::NAMES[4],
            Self::Hierarchical(_) => Self::NAMES[5],
            Self::Taut {} => Self::NAMES[6],
            Self::ContinuousCurvature(_) => Self::NAMES[7],
        }
    }

    /// The parameters as the smoother's paper has them; `None` for smoothers without such a paper.
    pub const fn as_published(&self) -> Option<Self> {
        Some(match self {
            Self::KeyPoints(_) => Self::KeyPoints(KeyPointSmoothingConfig::PAPER),
            Self::Bidirectional(_) => Self::Bidirectional(BidirectionalSmoothingConfig::PAPER),
            Self::Shortcut(_) => Self::Shortcut(ShortcutConfig::PAPER),
            Self::Hierarchical(_) => Self::Hierarchical(HierarchicalSmoothingConfig::PAPER),
            _ => return None,
        })
    }

    /// The fields of [`Self::as_published`] for which the paper gives no value: they are readings.
    pub const fn readings(&self) -> &'static [&'static str] {
        match self {
            Self::Bidirectional(_) => BidirectionalSmoothingConfig::READINGS,
            Self::Hierarchical(_) => HierarchicalSmoothingConfig::READINGS,
            _ => &[],
        }
    }

    /// Checks the parameters. With others the result is a path all the same, but of no use.
    ///
    /// # Errors
    /// Names the first one that cannot be used.
    pub fn check(&self) -> Result<(), SmootherError> {
        match self {
            Self::None {} | Self::LineOfSight {} | Self::Shortcut(_) | Self::Taut {} => Ok(()),
            Self::KeyPoints(config) => config.check(),
            Self::Bidirectional(config) => config.check(),
            Self::Hierarchical(config) => config.check(),
            Self::ContinuousCurvature(config) => config.check(),
        }
    }

    /// Smooths the line of a plan, or another one (`PlannedLine::from(polyline)`); points that are not finite
    /// are left out, and so are repeated ones. The result
    /// begins and ends where the line does, is never longer, and keeps `clearance_m` (or the smoother's
    /// own safe distance, if that is larger; with [`BendsKeep::Clearance`], only straight stretches
    /// do) wherever the line did; where that is not kept, [`Smoothed::shortfall_m`] says what is. A
    /// negative clearance counts as none.
    pub fn smooth(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let planned = &distinct(line);
        let line = planned.polyline();
        let clearance_m = clearance_m.max(0.0);
        let room = Room::new(clearance, clearance_m, 0.0);
        let straight = |smooth: &Polyline| Smoothed::straight(line, smooth, &room);
        match self {
            Self::None {} => straight(&line.merged()),
            Self::LineOfSight {} => straight(&line_of_sight(line, clearance, clearance_m)),
            Self::KeyPoints(config) => config.smooth(planned, clearance, clearance_m),
            Self::Bidirectional(config) => config.smooth(line, clearance, clearance_m),
            Self::Shortcut(config) => config.smooth(line, clearance, clearance_m),
            Self::Hierarchical(config) => config.smooth(line, clearance, clearance_m),
            Self::Taut {} => taut(line, clearance, clearance_m),
            Self::ContinuousCurvature(config) => {
                continuous_curvature(line, clearance, clearance_m, config)
            }
        }
    }
}

/// The line without points that are not finite and without repeated ones; its ends are jump points.
fn distinct(line: &PlannedLine) -> PlannedLine {
    let mut waypoints: Vec<_> = line.waypoints().filter(|(point, _)| point.is_finite()).collect();
    waypoints.dedup_by(|(point, is_jump_point), (kept, keeps)| {
        *keeps |= point == kept && *is_jump_point;
        point == kept
    });
    for end in [0, waypoints.len().saturating_sub(1)] {
        if let Some((_, is_jump_point)) = waypoints.get_mut(end) {
            *is_jump_point = true;
        }
    }
    waypoints.into_iter().collect()
}
