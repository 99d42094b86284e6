//! \[ZhuYin2024\]: parts of HSTA*, layers of its smoother, and guidance; L, R and the weights of
//! the DWA.

use super::super::driven::Vehicle;
use super::super::experiment::Experiment;
use super::super::measure::Measure;
use super::super::method::{How, Method};
use super::super::planned::Planning;
use super::super::planners::JPS;
use super::super::zhuyin2024::{
    ABOUT, ENDS, FAMILY, PAPER, UNKNOWN_ABOUT, UNKNOWN_ENDS, UNKNOWN_FAMILY, by_definition, hsta,
    past_three,
};
use super::{Ablation, on_maps_of, sweep};
use keyway::local::{DwaConfig, GuidedDwaConfig, GuidedWeights, LocalConfig, WindowConfig};
use keyway::plan::{Correction, Weight};
use keyway::smooth::{HierarchicalSmoothingConfig, LineOfSightConfig, SmootherConfig};

const ALL: &str = "as published";
const L: f64 = 2.0;
const GUIDED: &str = "s4-guided";
const PUBLISHED: HierarchicalSmoothingConfig = HierarchicalSmoothingConfig::PAPER;

const fn planned(
    name: &'static str,
    (weight, correction, l): (Weight, Correction, f64),
    smoother: SmootherConfig,
) -> Method {
    let planner = hsta(weight, correction, l);
    let how = How::Plan(Planning::new(planner, Some(smoother)));
    Method { name, how, must_succeed: true }
}

const fn with_r(name: &'static str, control_distance_m: f64) -> Method {
    let smoother = HierarchicalSmoothingConfig { control_distance_m, ..PUBLISHED };
    planned(name, AS_PUBLISHED, SmootherConfig::Hierarchical(smoother))
}

const fn with_l(name: &'static str, l: f64) -> Method {
    planned(name, (Weight::Dynamic, Correction::Distance, l), SMOOTHER)
}

const AS_PUBLISHED: (Weight, Correction, f64) = (Weight::Dynamic, Correction::Distance, L);
const SMOOTHER: SmootherConfig = SmootherConfig::Hierarchical(PUBLISHED);
/// First layer of the smoother without the second one: nodes within line of sight of each other.
const INNER_LAYER: SmootherConfig = SmootherConfig::LineOfSight(LineOfSightConfig {});
const YARDSTICK: Method = Method::new(Experiment::YARDSTICK, JPS, None);

/// Creates an experiment on the maps of the static scene, with other methods.
const fn on_static(name: &'static str, methods: &'static [Method]) -> Experiment {
    on_maps_of(name, ABOUT, FAMILY, ENDS, methods)
}

/// Creates an experiment on the maps with unknown obstacles, with other methods.
const fn on_unknown(name: &'static str, methods: &'static [Method]) -> Experiment {
    on_maps_of(name, UNKNOWN_ABOUT, UNKNOWN_FAMILY, UNKNOWN_ENDS, methods)
}

static PARTS: Experiment = on_static(
    "zhuyin2024-parts",
    &[
        planned(ALL, AS_PUBLISHED, SMOOTHER),
        planned("without c", (Weight::Dynamic, Correction::None, L), SMOOTHER),
        planned("k = 1", (Weight::One, Correction::Distance, L), SMOOTHER),
        Method::new(
            "keys renewed, k of the current node",
            by_definition(Weight::Dynamic),
            Some(SMOOTHER),
        ),
        Method::new("keys renewed, k = 1", by_definition(Weight::One), Some(SMOOTHER)),
        planned("L = 0", (Weight::Dynamic, Correction::Distance, 0.0), SMOOTHER),
        planned("inner layer alone", AS_PUBLISHED, INNER_LAYER),
        YARDSTICK,
    ],
);

static CONSTRAINT: Experiment = on_static(
    "zhuyin2024-l",
    &[with_l("L = 0", 0.0), with_l("L = 1", 1.0), with_l("L = 2", 2.0), YARDSTICK],
);

static CONTROL: Experiment = on_static(
    "zhuyin2024-r",
    &[
        with_r("R = 0.25", 0.25),
        with_r("R = 0.5", 0.5),
        with_r("R = 1", 1.0),
        with_r("R = 2", 2.0),
        with_r("R = 4", 4.0),
        YARDSTICK,
    ],
);

static GUIDANCE: Experiment = on_unknown(
    "zhuyin2024-guidance",
    &[
        past_three(ALL, GUIDED).may_fail(),
        past_three("without guidance: a DWA along the path", GUIDED)
            .with_local(LocalConfig::Dwa(DwaConfig::PAPER))
            .may_fail(),
    ],
);

const PAPER_WEIGHTS: GuidedWeights = GuidedDwaConfig::PAPER.weights;
const IN_ORDER: GuidedWeights =
    GuidedWeights { heading: 0.08, target_distance: 0.2, obstacle_distance: 0.1 };

const fn with_window(name: &'static str, weights: GuidedWeights, window: WindowConfig) -> Method {
    let config = GuidedDwaConfig { weights, window, ..GuidedDwaConfig::PAPER };
    past_three(name, GUIDED).with_local(LocalConfig::GuidedDwa(config)).may_fail()
}

/// Interpretations of the weights, which the paper does not give, and of the distance of (16).
static GUIDED_READINGS: Experiment = on_unknown(
    "zhuyin2024-readings",
    &[
        past_three(ALL, GUIDED).may_fail(),
        with_weights("weights in the order of the symbols", IN_ORDER),
        with_window("(16) at the end", PAPER_WEIGHTS, WindowConfig::AT_THE_END),
        with_window(
            "(16) at the end, weights in the order of the symbols",
            IN_ORDER,
            WindowConfig::AT_THE_END,
        ),
        // At 1 m/s, (16) requires 2.5 m with 0.2 m/s2, and 0.5 m with 1 m/s2.
        past_three("a robot that brakes with 1 m/s2", GUIDED)
            .on(Vehicle::PaperWith([0.2, 1.0]))
            .may_fail(),
        past_three("a robot that speeds up and brakes with 1 m/s2", GUIDED)
            .on(Vehicle::PaperWith([1.0, 1.0]))
            .may_fail(),
    ],
);

const fn with_weights(name: &'static str, weights: GuidedWeights) -> Method {
    let local = LocalConfig::GuidedDwa(GuidedDwaConfig { weights, ..GuidedDwaConfig::PAPER });
    past_three(name, GUIDED).with_local(local).may_fail()
}

const fn with_alpha(name: &'static str, heading: f64) -> Method {
    with_weights(name, GuidedWeights { heading, ..PAPER_WEIGHTS })
}

static ALPHA: Experiment = on_unknown(
    "zhuyin2024-alpha",
    &[
        with_alpha("alpha = 0.02", 0.02),
        with_alpha("alpha = 0.08", 0.08),
        with_alpha("alpha = 0.2", 0.2),
        with_alpha("alpha = 0.4", 0.4),
    ],
);

const fn with_beta(name: &'static str, target_distance: f64) -> Method {
    with_weights(name, GuidedWeights { target_distance, ..PAPER_WEIGHTS })
}

static BETA: Experiment = on_unknown(
    "zhuyin2024-beta",
    &[
        with_beta("beta = 0.05", 0.05),
        with_beta("beta = 0.1", 0.1),
        with_beta("beta = 0.2", 0.2),
        with_beta("beta = 0.4", 0.4),
    ],
);

const fn with_gamma(name: &'static str, obstacle_distance: f64) -> Method {
    with_weights(name, GuidedWeights { obstacle_distance, ..PAPER_WEIGHTS })
}

static GAMMA: Experiment = on_unknown(
    "zhuyin2024-gamma",
    &[
        with_gamma("gamma = 0.1", 0.1),
        with_gamma("gamma = 0.2", 0.2),
        with_gamma("gamma = 0.5", 0.5),
        with_gamma("gamma = 1", 1.0),
    ],
);

const OF_RUNS: &[Measure] = &[Measure::Reached, Measure::RunTime, Measure::RunClearance];
const OF_PATHS: &[Measure] = &[
    Measure::Expanded,
    Measure::Length,
    Measure::Turns,
    Measure::NonSmoothTurns,
    Measure::Clearance,
    Measure::PlanningTime,
];

pub(super) static ABLATIONS: [Ablation; 8] = [
    Ablation {
        paper: PAPER,
        about: "Parts of the search and of the smoother, each left out",
        experiment: &PARTS,
        base: ALL,
        parameter: None,
        measures: OF_PATHS,
    },
    Ablation {
        paper: PAPER,
        about: "The path around unknown obstacles without guide points",
        experiment: &GUIDANCE,
        base: ALL,
        parameter: None,
        measures: OF_RUNS,
    },
    Ablation {
        paper: PAPER,
        about: "Readings of the weights of (18), of the distance of (16), and of the robot's limits",
        experiment: &GUIDED_READINGS,
        base: ALL,
        parameter: None,
        measures: OF_RUNS,
    },
    Ablation {
        paper: PAPER,
        about: "Distance L that the search keeps from obstacles",
        experiment: &CONSTRAINT,
        base: "L = 2",
        parameter: Some(("L [cells]", &[0.0, 1.0, 2.0])),
        measures: OF_PATHS,
    },
    Ablation {
        paper: PAPER,
        about: "Distance R of the control nodes from their corner",
        experiment: &CONTROL,
        base: "R = 1",
        parameter: Some(("R [m]", &[0.25, 0.5, 1.0, 2.0, 4.0])),
        measures: OF_PATHS,
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
        "Weight beta of the distance to the target",
        (&BETA, "beta = 0.1"),
        ("beta", &[0.05, 0.1, 0.2, 0.4]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Weight gamma of the distance to obstacles",
        (&GAMMA, "gamma = 0.2"),
        ("gamma", &[0.1, 0.2, 0.5, 1.0]),
        OF_RUNS,
    ),
];
