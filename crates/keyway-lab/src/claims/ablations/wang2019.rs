//! \[Wang2019\]: the ratio X. The claims' experiment covers its four steps one after another.

use super::super::experiment::Experiment;
use super::super::measure::Measure;
use super::super::method::Method;
use super::super::planners::JPS;
use super::super::wang2019::{
    COMPLETE_METHOD, PAPER, STEPS_ABOUT, STEPS_ENDS, STEPS_FAMILY, ratio, shortcut,
};
use super::{Ablation, on_maps_of};

static PARTS: Experiment = on_maps_of(
    "wang2019-parts",
    STEPS_ABOUT,
    STEPS_FAMILY,
    STEPS_ENDS,
    &[
        COMPLETE_METHOD,
        Method::new("without expansion", ratio(1.1), Some(shortcut(0))),
        Method::new("without expansion and shortcut", ratio(1.1), None),
        Method::new("without expansion, shortcut and X", ratio(1.0), None),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
);

static X: Experiment = on_maps_of(
    "wang2019-x",
    STEPS_ABOUT,
    STEPS_FAMILY,
    STEPS_ENDS,
    &[
        Method::new("X = 1", ratio(1.0), None),
        Method::new("X = 1.05", ratio(1.05), None),
        Method::new("X = 1.1", ratio(1.1), None),
        Method::new("X = 1.2", ratio(1.2), None),
        Method::new("X = 1.5", ratio(1.5), None),
        Method::new("X = 2", ratio(2.0), None),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
);

const MEASURES: &[Measure] = &[
    Measure::Expanded,
    Measure::Length,
    Measure::Turns,
    Measure::Clearance,
    Measure::PlanningTime,
];

pub(super) static ABLATIONS: [Ablation; 2] = [
    Ablation {
        paper: PAPER,
        about: "The steps of the method, removed one after another",
        experiment: &PARTS,
        base: COMPLETE_METHOD.name,
        parameter: None,
        measures: MEASURES,
    },
    Ablation {
        paper: PAPER,
        about: "The weight ratio X",
        experiment: &X,
        base: "X = 1.1",
        parameter: Some(("X", &[1.0, 1.05, 1.1, 1.2, 1.5, 2.0])),
        measures: MEASURES,
    },
];
