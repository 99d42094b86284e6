//! Claims of \[You2021\], S0. No corners are cut.
//!
//! The paper's times include drawing, and do not cover its optimisation: only the search is
//! compared. The run times are simulated times, from the paper's lengths and mean speeds.

use super::claim::{Bound, Claim, Figure};
use super::clutter_speeds::Part;
use super::experiment::{Experiment, ExperimentScene};
use super::measure::Measure;
use super::method::Method;
use super::planned::Planning;
use super::planners::{JPS, astar};
use super::reconstruction::{Baseline, Published, Reconstruction};
use super::square::square;
use keyway::map::Cell;
use keyway::plan::{
    BidirectionalAStarConfig, BidirectionalJpsConfig, BidirectionalJpsFixedConfig, Heuristic,
    PlannerConfig,
};
use keyway::search::CornerRule;
use keyway::smooth::{KeyPointSmoothingConfig, SmootherConfig};
use keyway_sim::worlds::{Blocks, GeneratedMap, Pattern};

const ASTAR: &str = "astar";
const BOTH_ENDS: &str = "bidirectional-astar";
const FIXED: &str = "bidirectional-jps-fixed";
const MOVING: &str = "bidirectional-jps";
const OPTIMISED: &str = "bidirectional-jps, key-points";

/// Maps of both experiments.
pub(super) const ABOUT: &str =
    "20 x 20 cells, 20 % of them in blocks of 1 to 3 cells, from corner to corner";
pub(super) const FAMILY: GeneratedMap =
    square(20.0, 0.0, Pattern::Blocks(Blocks { share: 0.2, side_m: [1.0, 3.0] }));
pub(super) const ENDS: [Cell; 2] = [Cell::new(0, 0), Cell::new(19, 19)];
const SCENE: ExperimentScene = ExperimentScene {
    file: "scenes/you2021/corner_to_corner.toml",
    ends: ENDS,
    map: include_str!("maps/you2021.map"),
};

/// Table 4.
pub(super) static FITTED: Reconstruction = Reconstruction {
    name: "you2021",
    family: FAMILY,
    ends: ENDS,
    baselines: &[
        Baseline {
            name: "A*",
            planning: Planning::new(astar(CornerRule::Forbid), None),
            ends: None,
            published: Published::Steps(8, 15),
        },
        Baseline {
            name: "bidirectional A*",
            planning: Planning::new(BIDIRECTIONAL_ASTAR, None),
            ends: None,
            published: Published::Steps(4, 19),
        },
    ],
};

pub(super) const BIDIRECTIONAL_ASTAR: PlannerConfig =
    PlannerConfig::BidirectionalAStar(BidirectionalAStarConfig {
        corners: CornerRule::Forbid,
        heuristic: Heuristic::Octile,
    });

/// Figures 3 and 7 to 10, table 4.
static SEARCH: Experiment = Experiment {
    name: "you2021-search",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(ASTAR, astar(CornerRule::Forbid), None),
        Method::new(BOTH_ENDS, BIDIRECTIONAL_ASTAR, None),
        Method::new(
            FIXED,
            PlannerConfig::BidirectionalJpsFixed(BidirectionalJpsFixedConfig::PAPER),
            None,
        ),
        Method::new(MOVING, PlannerConfig::BidirectionalJps(BidirectionalJpsConfig::PAPER), None),
        Method::new(
            OPTIMISED,
            PlannerConfig::BidirectionalJps(BidirectionalJpsConfig::PAPER),
            Some(SmootherConfig::KeyPoints(KeyPointSmoothingConfig::PAPER)),
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: Some(SCENE),
    reconstruction: Ok(&FITTED),
};

/// Figures 11 and 12, table 5.
static RUNS: Experiment = Experiment {
    name: "you2021-runs",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[Method::driving(TO_GOAL, TO_GOAL), Method::driving(FUSED, FUSED)],
    scene: Some(SCENE),
    reconstruction: Ok(&FITTED),
};

/// Figure 12: the speed curve.
static SPEEDS: Experiment = Experiment {
    name: "you2021-speeds",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::driving(SPARSE, FUSED).speed_of(Part::Sparse),
        Method::driving(DENSE, FUSED).speed_of(Part::Dense),
    ],
    scene: Some(SCENE),
    reconstruction: Ok(&FITTED),
};

/// Distance D of the key-point optimisation \[m\], with the tolerance of the smoother.
const SAFE_M: f64 = 0.5 - 1e-9;

pub(super) const PAPER: &str = "You2021";
pub(super) const FUSED: &str = "s0-key-point";
pub(super) const TO_GOAL: &str = "dwa-to-goal";
/// A run has both parts; sparse and dense are relative to the run ([`Part`]).
const SPARSE: &str = "s0-key-point where obstacles are sparse";
const DENSE: &str = "s0-key-point where obstacles are dense";

pub(super) static CLAIMS: [Claim; 7] = [
    Claim {
        id: "S0-1",
        paper: PAPER,
        statement: "Improved bidirectional jump point A* needs less time and fewer nodes than A*, and its optimised path is \
                    shorter",
        figures: &[
            Figure::lower(Measure::SearchTime, OPTIMISED, ASTAR, Some([6.538, 3.212])),
            Figure::lower(Measure::Expanded, OPTIMISED, ASTAR, Some([87.0, 35.0])),
            Figure::lower(Measure::Length, OPTIMISED, ASTAR, Some([29.213, 28.697])),
        ],
        experiment: &SEARCH,
    },
    Claim {
        id: "S0-2",
        paper: PAPER,
        statement: "Plain bidirectional A* is faster than A*, but expands more nodes, and its path is longer",
        figures: &[
            Figure::lower(Measure::SearchTime, BOTH_ENDS, ASTAR, Some([6.538, 3.837])),
            Figure::higher(Measure::Expanded, BOTH_ENDS, ASTAR, Some([87.0, 100.0])),
            Figure::higher(Measure::Length, BOTH_ENDS, ASTAR, Some([29.213, 30.870])),
        ],
        experiment: &SEARCH,
    },
    Claim {
        id: "S0-3",
        paper: PAPER,
        statement: "The fused planner arrives sooner than the classic DWA, on a shorter trajectory and at a higher mean speed",
        figures: &[
            Figure::lower(Measure::RunTime, FUSED, TO_GOAL, Some([47.90, 41.39])),
            Figure::lower(Measure::DrivenLength, FUSED, TO_GOAL, Some([29.843, 28.723])),
            Figure::higher(Measure::MeanSpeed, FUSED, TO_GOAL, Some([0.623, 0.694])),
        ],
        experiment: &RUNS,
    },
    Claim {
        id: "S0-4",
        paper: PAPER,
        statement: "The optimised path has fewer turns and keeps the safe distance D",
        figures: &[
            Figure::lower(Measure::Turns, OPTIMISED, MOVING, None),
            Figure::always(Measure::Clearance, OPTIMISED, Bound::AtLeast(SAFE_M)),
        ],
        experiment: &SEARCH,
    },
    Claim {
        id: "S0-5",
        paper: PAPER,
        statement: "With moving targets there is no double path, and fewer nodes are expanded than with fixed ones",
        figures: &[
            Figure::always(Measure::Revisited, MOVING, Bound::AtMost(0.0)),
            Figure::lower(Measure::Expanded, MOVING, FIXED, None),
        ],
        experiment: &SEARCH,
    },
    Claim {
        id: "S0-6",
        paper: PAPER,
        statement: "The global path is optimal",
        figures: &[Figure::always(Measure::Excess, MOVING, Bound::AtMost(Measure::ROUNDING))],
        experiment: &SEARCH,
    },
    Claim {
        id: "S0-7",
        paper: PAPER,
        statement: "The fused robot drives fast where obstacles are sparse and slowly where they are dense",
        figures: &[Figure::lower(Measure::MeanSpeed, DENSE, SPARSE, None)],
        experiment: &SPEEDS,
    },
];
