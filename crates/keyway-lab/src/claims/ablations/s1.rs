//! \[S1\]: weight, density, safe children, passes of the smoother, and distance factors; weights, a
//! and R of the DWA.

use super::super::experiment::Experiment;
use super::super::measure::Measure;
use super::super::method::Method;
use super::super::planners::{JPS, astar};
use super::super::s1::{ABOUT, ENDS, FAMILY, FIXED_FACTORS, FUSED, PAPER};
use super::{Ablation, on_maps_of, sweep};
use keyway::local::{AdaptiveDwaConfig, LocalConfig, Weights};
use keyway::plan::{Density, DensityAStarConfig, EstimateWeight, PlannerConfig};
use keyway::search::CornerRule;
use keyway::smooth::{BidirectionalSmoothingConfig, Passes, SmootherConfig, UnsmoothedConfig};

const ALL: &str = "as published";
const SMOOTHER: Option<SmootherConfig> = Some(smoother(Passes::Both));
const PUBLISHED: DensityAStarConfig = DensityAStarConfig::PAPER;

const fn smoother(passes: Passes) -> SmootherConfig {
    let config = BidirectionalSmoothingConfig { passes, ..BidirectionalSmoothingConfig::PAPER };
    SmootherConfig::Bidirectional(config)
}

const fn search(config: DensityAStarConfig) -> PlannerConfig {
    PlannerConfig::DensityAStar(config)
}

/// Creates an experiment on the maps of the paper, with other methods.
const fn on_maps(name: &'static str, methods: &'static [Method]) -> Experiment {
    on_maps_of(name, ABOUT, FAMILY, ENDS, methods)
}

static PARTS: Experiment = on_maps(
    "s1-parts",
    &[
        Method::new(ALL, search(PUBLISHED), SMOOTHER),
        Method::new("without the weight and the density", astar(CornerRule::Forbid), SMOOTHER),
        Method::new(
            "without the weight",
            search(DensityAStarConfig { weight: EstimateWeight::One, ..PUBLISHED }),
            SMOOTHER,
        ),
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
            "without its pass from the start",
            search(PUBLISHED),
            Some(smoother(Passes::Backward)),
        ),
        Method::new(
            "without its pass from the goal",
            search(PUBLISHED),
            Some(smoother(Passes::Forward)),
        ),
        Method::new(
            "with collinear points removed alone",
            search(PUBLISHED),
            Some(SmootherConfig::None(UnsmoothedConfig {})),
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
);

static FACTORS: Experiment = on_maps(
    "s1-factors",
    &[
        Method::driving(ALL, FUSED).may_fail(),
        Method::driving("without distance factors", FUSED).with_local(FIXED_FACTORS).may_fail(),
    ],
);

/// Creates a method with the paper's DWA and other parameters.
const fn driven(name: &'static str, local: AdaptiveDwaConfig) -> Method {
    Method::driving(name, FUSED).with_local(LocalConfig::AdaptiveDwa(local)).may_fail()
}

const PAPER_DWA: AdaptiveDwaConfig = AdaptiveDwaConfig::PAPER;

const fn with_weights(name: &'static str, weights: Weights) -> Method {
    driven(name, AdaptiveDwaConfig { weights, ..PAPER_DWA })
}

const fn with_alpha(name: &'static str, heading: f64) -> Method {
    with_weights(name, Weights { heading, ..PAPER_DWA.weights })
}

static ALPHA: Experiment = on_maps(
    "s1-alpha",
    &[
        with_alpha("alpha = 0.02", 0.02),
        with_alpha("alpha = 0.08", 0.08),
        with_alpha("alpha = 0.2", 0.2),
        with_alpha("alpha = 0.4", 0.4),
    ],
);

const fn with_beta(name: &'static str, distance: f64) -> Method {
    with_weights(name, Weights { distance, ..PAPER_DWA.weights })
}

static BETA: Experiment = on_maps(
    "s1-beta",
    &[
        with_beta("beta = 0.05", 0.05),
        with_beta("beta = 0.1", 0.1),
        with_beta("beta = 0.2", 0.2),
        with_beta("beta = 0.4", 0.4),
    ],
);

const fn with_gamma(name: &'static str, speed: f64) -> Method {
    with_weights(name, Weights { speed, ..PAPER_DWA.weights })
}

static GAMMA: Experiment = on_maps(
    "s1-gamma",
    &[
        with_gamma("gamma = 0.025", 0.025),
        with_gamma("gamma = 0.05", 0.05),
        with_gamma("gamma = 0.1", 0.1),
        with_gamma("gamma = 0.2", 0.2),
        with_gamma("gamma = 0.4", 0.4),
    ],
);

const fn with_a(name: &'static str, a: f64) -> Method {
    driven(name, AdaptiveDwaConfig { a, ..PAPER_DWA })
}

static A: Experiment = on_maps(
    "s1-a",
    &[
        with_a("a = 0.1", 0.1),
        with_a("a = 0.3", 0.3),
        with_a("a = 0.5", 0.5),
        with_a("a = 0.9", 0.9),
    ],
);

const fn with_r(name: &'static str, safe_radius_m: f64) -> Method {
    driven(name, AdaptiveDwaConfig { safe_radius_m, ..PAPER_DWA })
}

static R: Experiment = on_maps(
    "s1-r",
    &[with_r("R = 0.25", 0.25), with_r("R = 0.5", 0.5), with_r("R = 1", 1.0), with_r("R = 2", 2.0)],
);

const OF_RUNS: &[Measure] =
    &[Measure::Reached, Measure::RunTime, Measure::Oscillation, Measure::DrivenLength];

pub(super) static ABLATIONS: [Ablation; 7] = [
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
        measures: OF_RUNS,
    },
    sweep(
        PAPER,
        "Weight alpha of the heading",
        (&ALPHA, "alpha = 0.08"),
        ("alpha", &[0.02, 0.08, 0.2, 0.4]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Weight beta of the distance",
        (&BETA, "beta = 0.2"),
        ("beta", &[0.05, 0.1, 0.2, 0.4]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Weight gamma of speed",
        (&GAMMA, "gamma = 0.1"),
        ("gamma", &[0.025, 0.05, 0.1, 0.2, 0.4]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Part a of the factors that no distance changes",
        (&A, "a = 0.5"),
        ("a", &[0.1, 0.3, 0.5, 0.9]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Safe radius R of the factors",
        (&R, "R = 0.5"),
        ("R [m]", &[0.25, 0.5, 1.0, 2.0]),
        OF_RUNS,
    ),
];
