//! \[S1\]: weight, density, safe children, passes of the smoother, and distance factors.

use super::super::experiment::Experiment;
use super::super::measure::Measure;
use super::super::method::Method;
use super::super::planners::{JPS, astar};
use super::super::s1::{ABOUT, ENDS, FAMILY, FUSED, PAPER};
use super::{Ablation, on_maps_of};
use crate::local::{AdaptiveDwaConfig, DistanceAt, DwaConfig, LocalConfig, WindowConfig};
use crate::plan::{Density, DensityAStarConfig, PlannerConfig};
use crate::search::CornerRule;
use crate::smooth::{BidirectionalSmoothingConfig, SmootherConfig, UnsmoothedConfig};

const ALL: &str = "as published";
const SMOOTHER: Option<SmootherConfig> =
    Some(SmootherConfig::Bidirectional(BidirectionalSmoothingConfig::PAPER));
const PUBLISHED: DensityAStarConfig = DensityAStarConfig::PAPER;

const fn search(config: DensityAStarConfig) -> PlannerConfig {
    PlannerConfig::DensityAStar(config)
}

static PARTS: Experiment = on_maps_of(
    "s1-parts",
    ABOUT,
    FAMILY,
    ENDS,
    &[
        Method::new(ALL, search(PUBLISHED), SMOOTHER),
        Method::new("without the weight and the density", astar(CornerRule::Forbid), SMOOTHER),
        Method::new(
            "without the density",
            search(DensityAStarConfig { density: Density::None, ..PUBLISHED }),
            SMOOTHER,
        ),
        Method::new(
            "without safe children",
            search(DensityAStarConfig { corners: CornerRule::Allow, ..PUBLISHED }),
            SMOOTHER,
        ),
        Method::new("without smoothing", search(PUBLISHED), None),
        Method::new(
            "with its first pass alone",
            search(PUBLISHED),
            Some(SmootherConfig::None(UnsmoothedConfig {})),
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
);

/// The weights of the paper without the factors.
const CLASSIC: LocalConfig = LocalConfig::Dwa(DwaConfig {
    window: WindowConfig { distance_at: DistanceAt::End, ..WindowConfig::PAPER },
    weights: AdaptiveDwaConfig::PAPER.weights,
    ..DwaConfig::PAPER
});

static FACTORS: Experiment = on_maps_of(
    "s1-factors",
    ABOUT,
    FAMILY,
    ENDS,
    &[
        Method::driving(ALL, FUSED).may_fail(),
        Method::driving("without distance factors", FUSED).with_local(CLASSIC).may_fail(),
    ],
);

pub(super) static ABLATIONS: [Ablation; 2] = [
    Ablation {
        paper: PAPER,
        about: "Parts of the search and of the smoother, each left out",
        experiment: &PARTS,
        base: ALL,
        parameter: None,
        measures: &[
            Measure::Expanded,
            Measure::Length,
            Measure::TurningAngle,
            Measure::Clearance,
            Measure::PlanningTime,
        ],
    },
    Ablation {
        paper: PAPER,
        about: "The evaluation without the factors of the distance",
        experiment: &FACTORS,
        base: ALL,
        parameter: None,
        measures: &[
            Measure::Reached,
            Measure::RunTime,
            Measure::Oscillation,
            Measure::DrivenLength,
        ],
    },
];
