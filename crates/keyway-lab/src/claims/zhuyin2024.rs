//! Claims of \[ZhuYin2024\], S4. A*, bidirectional A* and Dijkstra cut corners; HSTA* keeps L = 2.
//!
//! Of the static scene, only the size, 42 x 42 cells, and the numbers of turns of the baselines'
//! paths are published. Single maps of scattered blocks fit these figures, but no share does on
//! average: at 35 % and more, where paths have that many turns, no path keeps L = 2. So the family
//! has the largest share, in steps of 5 %, at which the constraint leaves a path on half of the
//! maps: 15 %. There A* has 10 turns.

mod runs;

use super::claim::{Bound, Claim, Figure};
use super::experiment::Experiment;
use super::measure::Measure;
use super::method::{How, Method};
use super::planned::Planning;
use super::planners::{EUCLIDEAN_ASTAR, EUCLIDEAN_BIDIRECTIONAL_ASTAR, JPS};
use super::reconstruction::{Baseline, Published, Reconstruction};
use super::square::square;
use keyway::map::Cell;
use keyway::plan::{
    Correction, DistanceUnit, HstaConfig, IfNoPath, OpenKeys, PlannerConfig, Weight, WeightAt,
};
use keyway::search::CornerRule;
use keyway::smooth::{HierarchicalSmoothingConfig, SmootherConfig};
use keyway_sim::worlds::{Blocks, GeneratedMap, Pattern};
use runs::{
    ASTAR_FOLLOW, COAL_MINE, CONSECUTIVE_TURNS, GUIDED, LABORATORY, LABORATORY_UNKNOWN,
    PATH_OF_ASTAR, PATH_OF_ASTAR4, PATH_OF_DIJKSTRA, PATH_OF_RRT, REF20, ROADWAY_TO_ROADWAY,
    TURNING_ROADWAY, UNKNOWN,
};
pub(super) use runs::{UNKNOWN_ABOUT, UNKNOWN_ENDS, UNKNOWN_FAMILY, past_three};

const ASTAR: &str = "astar";
const BOTH_ENDS: &str = "bidirectional-astar";
const HSTA: &str = "hsta";
const WITHOUT_K: &str = "hsta, k = 1";
const WITHOUT_C: &str = "hsta, without c";
const BY_DEFINITION: &str = "hsta, keys renewed";
const BY_DEFINITION_WITHOUT_K: &str = "hsta, keys renewed, k = 1";
const CONSTRAINED: &str = "astar, L = 2";
const SMOOTHED: &str = "hsta, hierarchical";

/// Equations (1) to (5) with or without k and c, and with another L.
pub(super) const fn hsta(weight: Weight, correction: Correction, l: f64) -> PlannerConfig {
    PlannerConfig::Hsta(HstaConfig {
        l1_constraint: l,
        reference_cell_m: 1.0,
        distances: DistanceUnit::Reference,
        weight,
        weight_at: WeightAt::Node,
        keys: OpenKeys::Kept,
        correction,
        if_no_path: IfNoPath::Fail,
        free_ends_m: 0.0,
        corners: CornerRule::Forbid,
    })
}

/// Equation (2).
const L: f64 = 2.0;
const PUBLISHED: PlannerConfig = hsta(Weight::Dynamic, Correction::Distance, L);

/// The definitions in place of step 4: k of the current node weighs the whole open list.
pub(super) const fn by_definition(weight: Weight) -> PlannerConfig {
    PlannerConfig::Hsta(HstaConfig {
        weight,
        weight_at: WeightAt::Current,
        keys: OpenKeys::Renewed,
        ..HstaConfig::PAPER
    })
}

/// Maps of both experiments. Their starts and goals have enough clearance for the constraint.
pub(super) const ABOUT: &str =
    "42 x 42 cells, 15 % of them in blocks of 1 to 3 cells, from corner to corner";
pub(super) const FAMILY: GeneratedMap =
    square(42.0, 0.5, Pattern::Blocks(Blocks { share: 0.15, side_m: [1.0, 3.0] }));
pub(super) const ENDS: [Cell; 2] = [Cell::new(0, 0), Cell::new(41, 41)];

/// Table 1. Blocks as in the family, with a share at which more maps fit than with 15 %.
static FITTED: Reconstruction = Reconstruction {
    name: "zhuyin2024",
    family: square(42.0, 0.5, Pattern::Blocks(Blocks { share: 0.2, side_m: [1.0, 3.0] })),
    ends: ENDS,
    baselines: &[
        Baseline {
            name: "A*",
            planning: Planning::new(EUCLIDEAN_ASTAR, None),
            ends: None,
            published: Published::Turns(18),
        },
        Baseline {
            name: "bidirectional A*",
            planning: Planning::new(EUCLIDEAN_BIDIRECTIONAL_ASTAR, None),
            ends: None,
            published: Published::Turns(16),
        },
        Baseline {
            name: "a way with L = 2",
            planning: WITH_L,
            ends: None,
            published: Published::Found,
        },
    ],
};

/// HSTA* keeps L = 2 with its cells and cuts no corner of an obstacle: this planner finds every
/// path that HSTA* could find.
const WITH_L: Planning = Planning {
    planner: EUCLIDEAN_ASTAR,
    smoother: None,
    expansion_cells: 0,
    l1_constraint: L,
    unknown: None,
};

/// Table 1.
static STATIC: Experiment = Experiment {
    name: "zhuyin2024-static",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(ASTAR, EUCLIDEAN_ASTAR, None),
        Method::new(BOTH_ENDS, EUCLIDEAN_BIDIRECTIONAL_ASTAR, None),
        Method::new(HSTA, PUBLISHED, None),
        Method::new(WITHOUT_K, hsta(Weight::One, Correction::Distance, L), None),
        Method::new(BY_DEFINITION, by_definition(Weight::Dynamic), None),
        Method::new(BY_DEFINITION_WITHOUT_K, by_definition(Weight::One), None),
        Method::new(
            SMOOTHED,
            PUBLISHED,
            Some(SmootherConfig::Hierarchical(HierarchicalSmoothingConfig::PAPER)),
        ),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: None,
    reconstruction: Ok(&FITTED),
};

/// Maps on which the constraint leaves a path, to test if the two sides meet.
static MEETING: Experiment = Experiment {
    name: "zhuyin2024-meeting",
    about: ABOUT,
    family: FAMILY,
    kind: None,
    ends: ENDS,
    methods: &[
        Method::new(HSTA, PUBLISHED, None).may_fail(),
        Method::new(WITHOUT_C, hsta(Weight::Dynamic, Correction::None, L), None).may_fail(),
        Method { name: CONSTRAINED, how: How::Plan(WITH_L), must_succeed: true },
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: None,
    reconstruction: Ok(&FITTED),
};

pub(super) const PAPER: &str = "ZhuYin2024";

/// Row of table 2: heading jumps of RRT and 4-neighbour A*, lengths of RRT, 4-neighbour A* and the
/// planner \[m\], and the clearance of the planner \[m\]. The planner has no heading jumps and the
/// others no clearance: they touch unknown obstacles.
const fn of_roadway(
    jumps: [f64; 2],
    [rrt_m, astar4_m, guided_m]: [f64; 3],
    clearance_m: f64,
) -> [Figure; 8] {
    let clearance = Some([0.0, clearance_m]);
    [
        Figure::lower(Measure::WayLength, GUIDED, PATH_OF_RRT, Some([rrt_m, guided_m])),
        Figure::lower(Measure::WayLength, GUIDED, PATH_OF_ASTAR4, Some([astar4_m, guided_m])),
        Figure::lower(Measure::NonSmoothTurns, GUIDED, PATH_OF_RRT, Some([jumps[0], 0.0])),
        Figure::lower(Measure::NonSmoothTurns, GUIDED, PATH_OF_ASTAR4, Some([jumps[1], 0.0])),
        Figure::always(Measure::NonSmoothTurns, GUIDED, Bound::AtMost(0.0)),
        Figure::higher(Measure::WayClearance, GUIDED, PATH_OF_RRT, clearance),
        Figure::higher(Measure::WayClearance, GUIDED, PATH_OF_ASTAR4, clearance),
        Figure::always(Measure::RunClearance, GUIDED, Bound::AtLeast(clearance_m)),
    ]
}

pub(super) static CLAIMS: [Claim; 10] = [
    Claim {
        id: "S4-1",
        paper: PAPER,
        statement: "In a static scene the planner needs less time than A* and bidirectional A*, turns less often, has no \
                    heading jumps and keeps its distance",
        figures: &[
            Figure::lower(Measure::PlanningTime, SMOOTHED, ASTAR, Some([31.57, 5.74])),
            Figure::lower(Measure::PlanningTime, SMOOTHED, BOTH_ENDS, Some([16.23, 5.74])),
            Figure::lower(Measure::Expanded, SMOOTHED, ASTAR, None),
            Figure::lower(Measure::Expanded, SMOOTHED, BOTH_ENDS, None),
            Figure::lower(Measure::Expanded, BY_DEFINITION, ASTAR, None),
            Figure::lower(Measure::Expanded, BY_DEFINITION, BOTH_ENDS, None),
            Figure::lower(Measure::Turns, SMOOTHED, ASTAR, Some([18.0, 4.0])),
            Figure::lower(Measure::Turns, SMOOTHED, BOTH_ENDS, Some([16.0, 4.0])),
            Figure::lower(Measure::NonSmoothTurns, SMOOTHED, ASTAR, Some([18.0, 0.0])),
            Figure::lower(Measure::NonSmoothTurns, SMOOTHED, BOTH_ENDS, Some([16.0, 0.0])),
            Figure::higher(Measure::Clearance, SMOOTHED, ASTAR, Some([0.0, 0.83])),
            Figure::higher(Measure::Clearance, SMOOTHED, BOTH_ENDS, Some([0.0, 0.83])),
        ],
        experiment: &STATIC,
    },
    Claim {
        id: "S4-2",
        paper: PAPER,
        statement: "In a turning roadway with unknown obstacles the path is shorter than those of RRT and 4-neighbour A*, has \
                    no heading jumps and keeps its distance",
        figures: &of_roadway([38.0, 51.0], [66.78, 77.0, 60.09], 1.11),
        experiment: &TURNING_ROADWAY,
    },
    Claim {
        id: "S4-3",
        paper: PAPER,
        statement: "In a coal mine the path is shorter than those of A*, Dijkstra and the paper's reference 20, takes less time \
                    to search, and keeps its distance",
        figures: &[
            Figure::lower(Measure::WayLength, GUIDED, PATH_OF_ASTAR, Some([86.31, 73.68])),
            Figure::lower(Measure::WayLength, GUIDED, PATH_OF_DIJKSTRA, Some([86.31, 73.68])),
            Figure::lower(Measure::WayLength, GUIDED, REF20, Some([75.53, 73.68])),
            Figure::lower(Measure::TotalSearchTime, GUIDED, PATH_OF_ASTAR, Some([36.72, 19.31])),
            Figure::lower(Measure::TotalSearchTime, GUIDED, PATH_OF_DIJKSTRA, Some([58.69, 19.31])),
            Figure::lower(Measure::TotalSearchTime, GUIDED, REF20, Some([65.42, 19.31])),
            Figure::higher(Measure::WayClearance, GUIDED, PATH_OF_ASTAR, Some([0.0, 0.82])),
            Figure::higher(Measure::WayClearance, GUIDED, PATH_OF_DIJKSTRA, Some([0.0, 0.82])),
            Figure::higher(Measure::WayClearance, GUIDED, REF20, Some([0.81, 0.82])),
        ],
        experiment: &COAL_MINE,
    },
    Claim {
        id: "S4-4",
        paper: PAPER,
        statement: "In a laboratory (here a simulated one) the robot arrives sooner than along the path of A*, and keeps more \
                    distance",
        figures: &[
            Figure::lower(Measure::RunTime, GUIDED, ASTAR_FOLLOW, Some([27.54, 11.36])),
            Figure::higher(Measure::RunClearance, GUIDED, ASTAR_FOLLOW, Some([0.11, 0.82])),
        ],
        experiment: &LABORATORY,
    },
    Claim {
        id: "S4-5",
        paper: PAPER,
        statement: "The correction factor c makes the two searches meet; without it they may miss each other",
        figures: &[
            Figure::always(Measure::Missed, HSTA, Bound::AtMost(0.0)),
            Figure::lower(Measure::Missed, HSTA, WITHOUT_C, None),
        ],
        experiment: &MEETING,
    },
    Claim {
        id: "S4-6",
        paper: PAPER,
        statement: "The dynamic weight k removes irrelevant expanded nodes",
        // Step 4 of the paper, and its definitions.
        figures: &[
            Figure::lower(Measure::Expanded, HSTA, WITHOUT_K, None),
            Figure::lower(Measure::Expanded, BY_DEFINITION, BY_DEFINITION_WITHOUT_K, None),
        ],
        experiment: &STATIC,
    },
    Claim {
        id: "S4-7",
        paper: PAPER,
        statement: "The paths of A* and Dijkstra lead into unknown obstacles; the planner passes them",
        figures: &[
            Figure::always(Measure::UnknownClearance, PATH_OF_ASTAR, Bound::AtMost(0.0)),
            Figure::always(Measure::UnknownClearance, PATH_OF_DIJKSTRA, Bound::AtMost(0.0)),
            Figure::always(Measure::Reached, GUIDED, Bound::AtLeast(1.0)),
        ],
        experiment: &UNKNOWN,
    },
    Claim {
        id: "S4-8",
        paper: PAPER,
        statement: "With three unknown obstacles in a laboratory (here a simulated one) A* collides; the planner arrives and \
                    keeps its distance",
        figures: &[
            Figure::always(Measure::Touched, ASTAR_FOLLOW, Bound::AtLeast(1.0)),
            Figure::always(Measure::Reached, GUIDED, Bound::AtLeast(1.0)),
            Figure::always(Measure::RunClearance, GUIDED, Bound::AtLeast(0.86)),
        ],
        experiment: &LABORATORY_UNKNOWN,
    },
    Claim {
        id: "S4-9",
        paper: PAPER,
        statement: "In a roadway with consecutive turns and unknown obstacles the path is shorter than those of RRT and \
                    4-neighbour A*, has no heading jumps and keeps its distance",
        figures: &of_roadway([46.0, 5.0], [77.99, 80.0, 69.72], 1.17),
        experiment: &CONSECUTIVE_TURNS,
    },
    Claim {
        id: "S4-10",
        paper: PAPER,
        statement: "From one roadway into another, past unknown obstacles, the path is shorter than those of RRT and \
                    4-neighbour A*, has no heading jumps and keeps its distance",
        figures: &of_roadway([61.0, 7.0], [90.39, 88.0, 80.94], 1.09),
        experiment: &ROADWAY_TO_ROADWAY,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Point;
    use keyway::search::Workspace;

    /// Mean number of turns of A* over 100 maps of this share, and the number of maps on which the
    /// constraint leaves a path.
    fn turns_and_paths(share: f64) -> (f64, usize) {
        let blocks = Blocks { share, side_m: [1.0, 3.0] };
        let family = GeneratedMap { obstacles: Pattern::Blocks(blocks), ..FAMILY };
        let ends = ENDS.map(|Cell { x, y }| Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let (mut workspace, mut turns, mut paths) = (Workspace::default(), Vec::new(), 0);
        for seed in 1..=100 {
            let grid = family.generate(seed, &ends).unwrap();
            let mut on =
                |method: &Method| method.run(&grid, (ENDS, seed), &mut workspace, None).unwrap();
            let path = on(&STATIC.methods[0]);
            turns.extend(path.iter().filter_map(|it| Some(it.planned()?.path.turns as f64)));
            paths += usize::from(on(&MEETING.methods[2]).is_some());
        }
        (turns.iter().sum::<f64>() / turns.len() as f64, paths)
    }

    #[test]
    fn the_share_is_the_largest_that_leaves_a_path_on_half_of_the_maps() {
        let shares = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4];
        let found = shares.map(|share| (share, turns_and_paths(share)));
        let Pattern::Blocks(chosen) = &FAMILY.obstacles else { panic!("no blocks") };
        let largest = found.iter().rfind(|(_, (_, paths))| *paths >= 50).unwrap();
        assert_eq!(largest.0, chosen.share, "{found:?}");
        // Where A* has as many turns as published, the constraint leaves no path.
        let fitting: Vec<_> = found.iter().filter(|(_, (turns, _))| *turns >= 18.0).collect();
        assert!(
            fitting.len() == 2 && fitting.iter().all(|(_, (_, paths))| *paths == 0),
            "{found:?}"
        );
    }
}
