//! \[You2021\]: parts of the search, of its optimisation and of the DWA; a, b, D and the weights.

use super::super::experiment::Experiment;
use super::super::measure::Measure;
use super::super::method::Method;
use super::super::planners::JPS;
use super::super::you2021::{
    ABOUT, BIDIRECTIONAL_ASTAR, ENDS, FAMILY, FITTED, FUSED, PAPER, TO_GOAL,
};
use super::{Ablation, on_maps_of, sweep};
use keyway::local::{DwaConfig, KeyPointDwaConfig, KeyPointWeights, LocalConfig, SpeedWeight};
use keyway::plan::{BidirectionalJpsConfig, JumpMeeting, OpenKeys, PlannerConfig};
use keyway::smooth::{KeyPointSmoothingConfig, SmootherConfig};

const ALL: &str = "as published";

const fn search(config: BidirectionalJpsConfig) -> PlannerConfig {
    PlannerConfig::BidirectionalJps(config)
}

const fn key_points(safe_distance_m: f64) -> SmootherConfig {
    let config = KeyPointSmoothingConfig { safe_distance_m, ..KeyPointSmoothingConfig::PAPER };
    SmootherConfig::KeyPoints(config)
}

const PUBLISHED: BidirectionalJpsConfig = BidirectionalJpsConfig::PAPER;
const D_M: f64 = KeyPointSmoothingConfig::PAPER.safe_distance_m;
const YARDSTICK: Method = Method::new(Experiment::YARDSTICK, JPS, None);

/// Creates an experiment on the maps of the paper, with other methods.
const fn on_maps(name: &'static str, methods: &'static [Method]) -> Experiment {
    on_maps_of(name, ABOUT, FAMILY, ENDS, methods)
}

static PARTS: Experiment = on_maps(
    "you2021-parts",
    &[
        Method::new(ALL, search(PUBLISHED), Some(key_points(D_M))),
        Method::new("from one end", JPS, Some(key_points(D_M))),
        Method::new("without jump points", BIDIRECTIONAL_ASTAR, Some(key_points(D_M))),
        Method::new(
            "without the other side's cost, b = 0",
            search(BidirectionalJpsConfig { b: 0.0, ..PUBLISHED }),
            Some(key_points(D_M)),
        ),
        Method::new(
            "literal meeting",
            search(BidirectionalJpsConfig { meeting: JumpMeeting::Literal, ..PUBLISHED }),
            Some(key_points(D_M)),
        )
        .may_fail(),
        Method::new("without optimisation", search(PUBLISHED), None),
        Method::new("without D", search(PUBLISHED), Some(key_points(0.0))),
        YARDSTICK,
    ],
);

/// Variant with another interpretation of the meeting condition and of the keys of open nodes,
/// with a weight a.
const fn reading(name: &'static str, meeting: JumpMeeting, keys: OpenKeys, a: f64) -> Method {
    Method::new(name, search(BidirectionalJpsConfig { meeting, keys, a, ..PUBLISHED }), None)
}

/// Interpretations of the search: table 4 gives its path the same length as that of A*, and this
/// experiment shows which interpretation reproduces that.
static READINGS: Experiment = Experiment {
    name: "you2021-readings",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(ALL, search(PUBLISHED), None),
        reading("renewed keys", JumpMeeting::Generated, OpenKeys::Renewed, 3.0),
        reading("met at expanded nodes", JumpMeeting::Expanded, OpenKeys::Kept, 3.0),
        reading(
            "met at expanded nodes, renewed keys",
            JumpMeeting::Expanded,
            OpenKeys::Renewed,
            3.0,
        ),
        reading("until nothing better can come", JumpMeeting::Best, OpenKeys::Kept, 3.0),
        reading(
            "until nothing better can come, renewed keys",
            JumpMeeting::Best,
            OpenKeys::Renewed,
            3.0,
        ),
        reading("literal meeting", JumpMeeting::Literal, OpenKeys::Kept, 3.0).may_fail(),
        reading("a = 1", JumpMeeting::Generated, OpenKeys::Kept, 1.0),
        reading("a = 1, renewed keys", JumpMeeting::Generated, OpenKeys::Renewed, 1.0),
        reading("a = 1, met at expanded nodes", JumpMeeting::Expanded, OpenKeys::Kept, 1.0),
        reading(
            "a = 1, met at expanded nodes, renewed keys",
            JumpMeeting::Expanded,
            OpenKeys::Renewed,
            1.0,
        ),
        reading("a = 1, until nothing better can come", JumpMeeting::Best, OpenKeys::Kept, 1.0),
        YARDSTICK,
    ],
    scene: None,
    reconstruction: Ok(&FITTED),
};

/// The paper's DWA with other weights.
const fn dwa(weights: KeyPointWeights, speed_weight: SpeedWeight) -> LocalConfig {
    let config = KeyPointDwaConfig { weights, speed_weight, ..KeyPointDwaConfig::PAPER };
    LocalConfig::KeyPointDwa(config)
}

const WEIGHTS: KeyPointWeights = KeyPointDwaConfig::PAPER.weights;
const SPEED: SpeedWeight = SpeedWeight::PAPER;
/// Speed weight that does not depend on obstacles.
const FIXED: SpeedWeight = SpeedWeight { high_risk: 0.0, low_risk: 0.0, ..SPEED };

const fn driven(name: &'static str, local: LocalConfig) -> Method {
    Method::driving(name, FUSED).with_local(local).may_fail()
}

static GAMMA: Experiment = on_maps(
    "you2021-gamma",
    &[driven(ALL, dwa(WEIGHTS, SPEED)), driven("fixed gamma", dwa(WEIGHTS, FIXED))],
);

/// Distance term up to 2 R1 and at the end of the trajectory, as in the sample program; regions
/// of 30 degrees to either side.
const SAMPLE_FUSED: LocalConfig = LocalConfig::KeyPointDwa(KeyPointDwaConfig {
    window: DwaConfig::SAMPLE.window,
    speed_weight: SpeedWeight { half_angle_deg: 30.0, ..SPEED },
    distance_term_cap_m: DwaConfig::SAMPLE.distance_term_cap_m,
    ..KeyPointDwaConfig::PAPER
});
/// Distance term up to 2 R1 along the trajectory; the same regions.
const CAPPED_FUSED: LocalConfig = LocalConfig::KeyPointDwa(KeyPointDwaConfig {
    speed_weight: SpeedWeight { half_angle_deg: 30.0, ..SPEED },
    distance_term_cap_m: DwaConfig::SAMPLE.distance_term_cap_m,
    ..KeyPointDwaConfig::PAPER
});
const CAPPED_CLASSIC: LocalConfig = LocalConfig::Dwa(DwaConfig {
    distance_term_cap_m: DwaConfig::SAMPLE.distance_term_cap_m,
    ..DwaConfig::PAPER
});

/// Table 5 with other routes, and with the sample program's evaluation.
static ROUTE: Experiment = on_maps(
    "you2021-route",
    &[
        Method::driving(TO_GOAL, TO_GOAL),
        Method::driving("the paper's route as read here", FUSED).may_fail(),
        Method::driving("a shortest route", FUSED).with_planner(JPS).may_fail(),
        Method::driving("the paper's route, sample evaluation", FUSED)
            .with_local(SAMPLE_FUSED)
            .may_fail(),
        Method::driving("a shortest route, sample evaluation", FUSED)
            .with_planner(JPS)
            .with_local(SAMPLE_FUSED)
            .may_fail(),
        Method::driving("the paper's route, distance term up to 2 R1", FUSED)
            .with_local(CAPPED_FUSED)
            .may_fail(),
        Method::driving("a shortest route, distance term up to 2 R1", FUSED)
            .with_planner(JPS)
            .with_local(CAPPED_FUSED)
            .may_fail(),
        Method::driving("DWA as in the sample program", TO_GOAL)
            .with_local(LocalConfig::Dwa(DwaConfig::SAMPLE))
            .may_fail(),
        Method::driving("DWA, distance term up to 2 R1", TO_GOAL)
            .with_local(CAPPED_CLASSIC)
            .may_fail(),
    ],
);

const fn with_a(name: &'static str, a: f64) -> Method {
    Method::new(name, search(BidirectionalJpsConfig { a, ..PUBLISHED }), None)
}

static A: Experiment = on_maps(
    "you2021-a",
    &[
        with_a("a = 0.5", 0.5),
        with_a("a = 1", 1.0),
        with_a("a = 2", 2.0),
        with_a("a = 3", 3.0),
        with_a("a = 5", 5.0),
        YARDSTICK,
    ],
);

const fn with_b(name: &'static str, b: f64) -> Method {
    Method::new(name, search(BidirectionalJpsConfig { b, ..PUBLISHED }), None)
}

static B: Experiment = on_maps(
    "you2021-b",
    &[
        with_b("b = 0", 0.0),
        with_b("b = 0.5", 0.5),
        with_b("b = 1", 1.0),
        with_b("b = 2", 2.0),
        with_b("b = 4", 4.0),
        YARDSTICK,
    ],
);

const fn with_d(name: &'static str, d_m: f64) -> Method {
    Method::new(name, search(PUBLISHED), Some(key_points(d_m)))
}

static D: Experiment = on_maps(
    "you2021-d",
    &[
        with_d("D = 0", 0.0),
        with_d("D = 0.25", 0.25),
        with_d("D = 0.5", 0.5),
        with_d("D = 1", 1.0),
        with_d("D = 1.5", 1.5),
        YARDSTICK,
    ],
);

const fn with_alpha(name: &'static str, key_point: f64) -> Method {
    driven(name, dwa(KeyPointWeights { key_point, ..WEIGHTS }, SPEED))
}

static ALPHA: Experiment = on_maps(
    "you2021-alpha",
    &[
        with_alpha("alpha = 0.05", 0.05),
        with_alpha("alpha = 0.15", 0.15),
        with_alpha("alpha = 0.3", 0.3),
        with_alpha("alpha = 0.6", 0.6),
    ],
);

const fn with_beta(name: &'static str, distance: f64) -> Method {
    driven(name, dwa(KeyPointWeights { distance, ..WEIGHTS }, SPEED))
}

static BETA: Experiment = on_maps(
    "you2021-beta",
    &[
        with_beta("beta = 0.02", 0.02),
        with_beta("beta = 0.05", 0.05),
        with_beta("beta = 0.1", 0.1),
        with_beta("beta = 0.2", 0.2),
    ],
);

const fn with_gamma(name: &'static str, largest: f64) -> Method {
    driven(name, dwa(WEIGHTS, SpeedWeight { largest, ..SPEED }))
}

static GAMMA_MAX: Experiment = on_maps(
    "you2021-gamma-max",
    &[
        with_gamma("gamma_max = 0.1", 0.1),
        with_gamma("gamma_max = 0.3", 0.3),
        with_gamma("gamma_max = 0.6", 0.6),
        with_gamma("gamma_max = 1.2", 1.2),
    ],
);

const OF_PATHS: &[Measure] =
    &[Measure::Expanded, Measure::Length, Measure::Turns, Measure::Clearance, Measure::SearchTime];
const OF_RUNS: &[Measure] = &[Measure::Reached, Measure::RunTime, Measure::MeanSpeed];

pub(super) static ABLATIONS: [Ablation; 10] = [
    Ablation {
        paper: PAPER,
        about: "Parts of the search and of its optimisation, each left out",
        experiment: &PARTS,
        base: ALL,
        parameter: None,
        measures: &[
            Measure::Missed,
            Measure::Expanded,
            Measure::Length,
            Measure::Turns,
            Measure::Clearance,
            Measure::PlanningTime,
        ],
    },
    Ablation {
        paper: PAPER,
        about: "Readings of when the two sides have met, of the keys of open nodes, and of a",
        experiment: &READINGS,
        base: ALL,
        parameter: None,
        measures: &[Measure::Shortest, Measure::Length, Measure::Expanded],
    },
    Ablation {
        paper: PAPER,
        about: "The fused planner against DWA straight to the goal, by route and by evaluation",
        experiment: &ROUTE,
        base: TO_GOAL,
        parameter: None,
        measures: &[Measure::Reached, Measure::RunTime, Measure::DrivenLength, Measure::MeanSpeed],
    },
    Ablation {
        paper: PAPER,
        about: "The weight of speed without the obstacles ahead",
        experiment: &GAMMA,
        base: ALL,
        parameter: None,
        measures: OF_RUNS,
    },
    sweep(
        PAPER,
        "Weight a of the estimate in equation (2)",
        (&A, "a = 3"),
        ("a", &[0.5, 1.0, 2.0, 3.0, 5.0]),
        OF_PATHS,
    ),
    sweep(
        PAPER,
        "Weight b of the other side's cost in equation (2)",
        (&B, "b = 1"),
        ("b", &[0.0, 0.5, 1.0, 2.0, 4.0]),
        OF_PATHS,
    ),
    sweep(
        PAPER,
        "Safe distance D of the optimisation",
        (&D, "D = 0.5"),
        ("D [m]", &[0.0, 0.25, 0.5, 1.0, 1.5]),
        OF_PATHS,
    ),
    sweep(
        PAPER,
        "Weight alpha of the heading",
        (&ALPHA, "alpha = 0.15"),
        ("alpha", &[0.05, 0.15, 0.3, 0.6]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Weight beta of the distance",
        (&BETA, "beta = 0.1"),
        ("beta", &[0.02, 0.05, 0.1, 0.2]),
        OF_RUNS,
    ),
    sweep(
        PAPER,
        "Largest weight of speed",
        (&GAMMA_MAX, "gamma_max = 0.3"),
        ("gamma_max", &[0.1, 0.3, 0.6, 1.2]),
        OF_RUNS,
    ),
];
