//! Claims of \[S1\]. The traditional A* cuts corners, the improved one does not; table 1 compares
//! only weights, on paths of one length, so there both cut corners.
//!
//! References 9 and 14 of the paper cannot be identified from its text. Their substitutes are A*
//! with collinear points removed, and a classic DWA guided by the turning points of A*.

use super::claim::{Bound, Claim, Figure};
use super::experiment::{Experiment, ExperimentScene};
use super::measure::Measure;
use super::method::Method;
use super::planned::Planning;
use super::planners::{EUCLIDEAN_ASTAR, JPS};
use super::reconstruction::{Baseline, Published, Reconstruction};
use super::square::square;
use keyway::local::{AdaptiveDwaConfig, DwaConfig, LocalConfig, WindowConfig};
use keyway::map::{Cell, OccupancyGrid};
use keyway::plan::{
    Closed, Density, DensityAStarConfig, EstimateWeight, Heuristic, PathCost, PlannerConfig,
};
use keyway::search::CornerRule;
use keyway::smooth::{BidirectionalSmoothingConfig, SmootherConfig, UnsmoothedConfig};
use keyway_sim::worlds::{Blocks, GeneratedMap, Pattern, UTraps};

const ASTAR: &str = "astar";
const WEIGHTED: &str = "density-astar, corners cut";
const REF9: &str = "astar, collinear points removed";
const SAFE_CHILDREN: &str = "density-astar";
const WHOLE: &str = "density-astar, bidirectional";

/// Maps of all experiments.
pub(super) const ABOUT: &str =
    "30 x 30 cells, 15 % of them in blocks of 1 to 3 cells, from corner to corner";
pub(super) const FAMILY: GeneratedMap =
    square(30.0, 0.0, Pattern::Blocks(Blocks { share: 0.15, side_m: [1.0, 3.0] }));
pub(super) const ENDS: [Cell; 2] = [Cell::new(0, 0), Cell::new(29, 29)];
const SCENE_MAP: &str = include_str!("maps/s1.map");

/// Tables 1 and 3. A robot must be able to pass without cutting corners.
const fn fitted(name: &'static str, ends: [Cell; 2]) -> Reconstruction {
    Reconstruction { name, family: FAMILY, ends, baselines: &BASELINES }
}
static FITTED: Reconstruction = fitted("s1", ENDS);
static FITTED_WEIGHTS: Reconstruction = fitted("s1-weights", WEIGHTS_ENDS);
const WEIGHTS_ENDS: [Cell; 2] = [Cell::new(1, 1), Cell::new(29, 29)];
static BASELINES: [Baseline; 3] = [
    baseline("A*, table 3", EUCLIDEAN_ASTAR, ENDS, Published::Steps(6, 26)),
    baseline("A*, table 1", EUCLIDEAN_ASTAR, WEIGHTS_ENDS, Published::Steps(6, 25)),
    baseline("a way without cut corners", JPS, ENDS, Published::Found),
];

const fn baseline(
    name: &'static str,
    planner: PlannerConfig,
    ends: [Cell; 2],
    published: Published,
) -> Baseline {
    Baseline { name, planning: Planning::new(planner, None), ends: Some(ends), published }
}

/// Table 1.
static WEIGHTS: Experiment = Experiment {
    name: "s1-weights",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(ASTAR, EUCLIDEAN_ASTAR, None),
        Method::new(
            WEIGHTED,
            PlannerConfig::DensityAStar(DensityAStarConfig {
                weight: EstimateWeight::Sigmoid,
                density: Density::Box,
                g: PathCost::Accumulated,
                corners: CornerRule::Allow,
                closed: Closed::Stay,
                heuristic: Heuristic::Euclidean,
            }),
            None,
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: Some(ExperimentScene {
        file: "scenes/s1/weights.toml",
        ends: WEIGHTS_ENDS,
        map: SCENE_MAP,
    }),
    reconstruction: Ok(&FITTED_WEIGHTS),
};

/// Figures 3, 5 and 8, table 3.
static SMOOTHING: Experiment = Experiment {
    name: "s1-smoothing",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(ASTAR, EUCLIDEAN_ASTAR, None),
        Method::new(REF9, EUCLIDEAN_ASTAR, Some(SmootherConfig::None(UnsmoothedConfig {}))),
        Method::new(SAFE_CHILDREN, PlannerConfig::DensityAStar(DensityAStarConfig::PAPER), None),
        Method::new(
            WHOLE,
            PlannerConfig::DensityAStar(DensityAStarConfig::PAPER),
            Some(SmootherConfig::Bidirectional(BidirectionalSmoothingConfig::PAPER)),
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
        // For the pictures: figure 8 (d) has the fused planner.
        Method::driving(FUSED, FUSED).may_fail(),
    ],
    scene: Some(RANDOM_00),
    reconstruction: Ok(&FITTED),
};

/// Creates an experiment with runs. Each compares only the methods of its claim, so that no map
/// is left out because of another method.
const fn runs(
    name: &'static str,
    methods: &'static [Method],
    scene: ExperimentScene,
) -> Experiment {
    let scene = Some(scene);
    let reconstruction = Ok(&FITTED);
    let (about, ends, kind) = (ABOUT, ENDS, None);
    Experiment { name, about, family: FAMILY, kind, ends, methods, scene, reconstruction }
}

const RANDOM_00: ExperimentScene =
    ExperimentScene { file: "scenes/s1/random_00.toml", ends: ENDS, map: SCENE_MAP };

/// Figure 6: the two evaluation functions without a route as guidance. Both drive straight to the
/// goal and measure the distance as the paper does.
static AGAINST_CLASSIC: Experiment = runs(
    "s1-classic",
    &[
        Method::driving(CLASSIC, TO_GOAL).with_local(FIXED_FACTORS),
        Method::driving(ADAPTIVE, TO_GOAL)
            .with_local(LocalConfig::AdaptiveDwa(AdaptiveDwaConfig::PAPER)),
    ],
    ExperimentScene {
        file: "scenes/s1/scattered.toml",
        ends: ENDS,
        map: include_str!("maps/s1_scattered.map"),
    },
);

/// Evaluation function of the paper without the distance factors.
pub(super) const FIXED_FACTORS: LocalConfig = LocalConfig::Dwa(DwaConfig {
    window: WindowConfig::AT_THE_END,
    weights: AdaptiveDwaConfig::PAPER.weights,
    ..DwaConfig::PAPER
});

/// Figure 9.
static HALF_ENCLOSED: Experiment = Experiment {
    name: "s1-half-enclosed",
    about: "30 x 30 cells, three walls of 10 to 14 cells between start and goal, open towards the robot",
    family: square(
        30.0,
        0.0,
        Pattern::UTraps(UTraps { count: 1, size_m: [10.0, 14.0], wall_m: 1.0 }),
    ),
    kind: Some(encloses),
    ends: HALF_ENCLOSED_ENDS,
    methods: &[
        Method::driving(TO_GOAL, TO_GOAL).may_fail(),
        Method::driving(FUSED, FUSED).may_fail(),
    ],
    scene: Some(ExperimentScene {
        file: "scenes/s1/half_enclosed.toml",
        ends: HALF_ENCLOSED_ENDS,
        map: include_str!("maps/s1_half_enclosed.map"),
    }),
    reconstruction: Err("only the enclosure of its map is published"),
};
const HALF_ENCLOSED_ENDS: [Cell; 2] = [Cell::new(2, 14), Cell::new(27, 14)];

/// True if the straight line to the goal meets a single wall, with a wall on each side before it.
fn encloses(map: &OccupancyGrid, [start, goal]: [Cell; 2]) -> bool {
    let is_wall = |x: i32, y: i32| map.occupied().get(Cell::new(x, y));
    let mut walls = (start.x..=goal.x).filter(|&x| is_wall(x, start.y));
    let (Some(wall), None) = (walls.next(), walls.next()) else { return false };
    let sides = [0..start.y, start.y + 1..map.frame().height() as i32];
    wall > start.x + 1 && sides.into_iter().all(|mut side| side.any(|y| is_wall(wall - 1, y)))
}

/// Figures 10 to 12. The unknown obstacles are discs as wide as a cell; each smaller set is part
/// of the larger ones. Their numbers are those of the scenes. All runs must reach the goal, so
/// that the numbers are compared on the same maps.
static AMONG_MORE: Experiment = runs(
    "s1-unknown",
    &[
        Method::driving(FUSED, FUSED),
        among(AMONG_5, FUSED, 5),
        among(AMONG_10, FUSED, 10),
        among(AMONG_20, FUSED, 20),
        among(AMONG_40, FUSED, 40),
    ],
    RANDOM_00,
);

/// Figures 10 to 12: without unknown obstacles, and among many.
static AGAINST_REF14: Experiment = runs(
    "s1-ref14",
    &[
        Method::driving(REF14, REF14),
        Method::driving(FUSED, FUSED),
        among(REF14_AMONG_20, REF14, 20),
        among(AMONG_20, FUSED, 20),
    ],
    RANDOM_00,
);

const fn among(name: &'static str, stack: &'static str, count: u32) -> Method {
    Method::driving(name, stack).among_unknown([count, 0], ANYWHERE_M)
}

/// Distance from a path within which every point of the map lies \[m\].
const ANYWHERE_M: f64 = 60.0;
/// Change of a length that counts as none.
const SAME_LENGTH: f64 = 0.01;
/// Change of a time that counts as small.
const HARDLY_MORE: f64 = 0.1;
/// Distance beyond which an obstacle is not touched \[m\].
const TOUCHED_M: f64 = 1e-6;

pub(super) const PAPER: &str = "S1";
pub(super) const FUSED: &str = "s1-adaptive";
const REF14: &str = "s1-ref14";
const TO_GOAL: &str = "dwa-to-goal";
/// Method that drives straight to the goal.
const CLASSIC: &str = "classic dwa";
const ADAPTIVE: &str = "adaptive dwa";
const AMONG_5: &str = "s1-adaptive, 5 unknown obstacles";
const AMONG_10: &str = "s1-adaptive, 10 unknown obstacles";
const AMONG_20: &str = "s1-adaptive, 20 unknown obstacles";
const AMONG_40: &str = "s1-adaptive, 40 unknown obstacles";
const REF14_AMONG_20: &str = "s1-ref14, 20 unknown obstacles";

pub(super) static CLAIMS: [Claim; 8] = [
    Claim {
        id: "S1-1",
        paper: PAPER,
        statement: "The weighted cost expands fewer nodes and takes less time, for a path of the same length",
        figures: &[
            Figure::lower(Measure::Expanded, WEIGHTED, ASTAR, Some([273.0, 155.0])),
            Figure::lower(Measure::SearchTime, WEIGHTED, ASTAR, Some([0.0177, 0.0124])),
            Figure::same(Measure::Length, WEIGHTED, ASTAR, SAME_LENGTH, Some([41.3553, 41.3553])),
        ],
        experiment: &WEIGHTS,
    },
    Claim {
        id: "S1-2",
        paper: PAPER,
        statement: "The smoothed path is shorter and turns less than that of A*, and than its own input",
        figures: &[
            Figure::lower(Measure::Length, WHOLE, ASTAR, Some([42.7696, 42.6809])),
            Figure::lower(Measure::TurningAngle, WHOLE, ASTAR, Some([315.0, 152.1])),
            Figure::lower(Measure::Length, WHOLE, SAFE_CHILDREN, Some([44.6985, 42.6809])),
            Figure::lower(Measure::TurningAngle, WHOLE, SAFE_CHILDREN, Some([765.0, 152.1])),
        ],
        experiment: &SMOOTHING,
    },
    Claim {
        id: "S1-3",
        paper: PAPER,
        statement: "The adaptive-distance DWA is faster than the classic one, and does not oscillate",
        figures: &[
            Figure::lower(Measure::RunTime, ADAPTIVE, CLASSIC, None),
            Figure::lower(Measure::CycleTime, ADAPTIVE, CLASSIC, None),
            Figure::lower(Measure::Oscillation, ADAPTIVE, CLASSIC, None),
        ],
        experiment: &AGAINST_CLASSIC,
    },
    Claim {
        id: "S1-4",
        paper: PAPER,
        statement: "Behind a half-enclosed obstacle the classic DWA never arrives, the fused planner does",
        figures: &[
            Figure::always(Measure::Reached, TO_GOAL, Bound::AtMost(0.0)),
            Figure::always(Measure::Reached, FUSED, Bound::AtLeast(1.0)),
        ],
        experiment: &HALF_ENCLOSED,
    },
    Claim {
        id: "S1-5",
        paper: PAPER,
        statement: "More random obstacles hardly cost more",
        figures: &[
            Figure::not_higher(Measure::RunTime, AMONG_5, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::RunTime, AMONG_10, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::RunTime, AMONG_20, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::RunTime, AMONG_40, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::CycleTime, AMONG_5, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::CycleTime, AMONG_10, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::CycleTime, AMONG_20, FUSED, HARDLY_MORE),
            Figure::not_higher(Measure::CycleTime, AMONG_40, FUSED, HARDLY_MORE),
        ],
        experiment: &AMONG_MORE,
    },
    Claim {
        id: "S1-6",
        paper: PAPER,
        statement: "With safe children the path touches no corner of an obstacle, but is longer and turns more",
        figures: &[
            Figure::always(Measure::Clearance, SAFE_CHILDREN, Bound::AtLeast(TOUCHED_M)),
            Figure::higher(Measure::Clearance, SAFE_CHILDREN, ASTAR, None),
            Figure::higher(Measure::Length, SAFE_CHILDREN, ASTAR, Some([42.7696, 44.6985])),
            Figure::higher(Measure::TurningAngle, SAFE_CHILDREN, ASTAR, Some([315.0, 765.0])),
            // Printed as 8 and 13: 8 turns of at least 45 degrees would be more than 315, so the
            // paper counts the segments between them.
            Figure::higher(Measure::Turns, SAFE_CHILDREN, ASTAR, Some([7.0, 12.0])),
        ],
        experiment: &SMOOTHING,
    },
    Claim {
        id: "S1-7",
        paper: PAPER,
        statement: "The whole planner is smoother and has fewer nodes than A* and the paper's reference 9",
        figures: &[
            Figure::lower(Measure::TurningAngle, WHOLE, ASTAR, None),
            Figure::lower(Measure::TurningAngle, WHOLE, REF9, None),
            Figure::lower(Measure::Points, WHOLE, ASTAR, None),
            Figure::lower(Measure::Points, WHOLE, REF9, None),
        ],
        experiment: &SMOOTHING,
    },
    Claim {
        id: "S1-8",
        paper: PAPER,
        statement: "Without and with random obstacles the trajectory of the fused robot is shorter, and its speed steadier, than with the \
                    paper's reference 14",
        figures: &[
            Figure::lower(Measure::DrivenLength, FUSED, REF14, None),
            Figure::lower(Measure::SpeedDeviation, FUSED, REF14, None),
            Figure::lower(Measure::SpeedVariation, FUSED, REF14, None),
            Figure::lower(Measure::DrivenLength, AMONG_20, REF14_AMONG_20, None),
            Figure::lower(Measure::SpeedDeviation, AMONG_20, REF14_AMONG_20, None),
            Figure::lower(Measure::SpeedVariation, AMONG_20, REF14_AMONG_20, None),
        ],
        experiment: &AGAINST_REF14,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_encloses_the_straight_way() {
        let is_so = |rows: &[&str]| {
            encloses(&OccupancyGrid::from_ascii(rows), [Cell::new(0, 2), Cell::new(6, 2)])
        };
        assert!(is_so(&["..###..", "....#..", "....#..", "....#..", "..###.."]));
        // The walls open to the other side; lie beside the straight line; enclose only half;
        // surround the goal and do not hide it.
        assert!(!is_so(&["..###..", "..#....", "..#....", "..#....", "..###.."]));
        assert!(!is_so(&["..###..", "....#..", ".......", "....#..", "..###.."]));
        assert!(!is_so(&["..###..", "....#..", "....#..", "....#..", "....#.."]));
        assert!(!is_so(&["..#####", "..#...#", "..#...#", "..#...#", "..#####"]));
    }
}
