//! Claims of \[Wang2019\], S2. Corners are cut. The tables of times are not in its text, so all
//! claims are judged by sign.
//!
//! Both maps have 100 x 100 cells, and their starts and goals are published; their obstacles are
//! not. So nothing could be fitted, and there is no scene. The families are blocks that cover a
//! fifth of the map, and rooms with doors, without the rectangles in the paper's rooms.
//!
//! According to the paper, the expansion adds to the time to find a path. The complete method is
//! therefore compared by the time from the map to the path. Steps that both methods do without
//! the expansion are compared by search and smoothing.

use super::claim::{Bound, Claim, Figure};
use super::experiment::Experiment;
use super::measure::Measure;
use super::method::{How, Method};
use super::planned::Planning;
use super::planners::{EUCLIDEAN_BIDIRECTIONAL_ASTAR, JPS};
use super::square::square;
use keyway::map::Cell;
use keyway::plan::{
    AStarConfig, Bidirectional24Config, Heuristic, PathCost, PlannerConfig, RatioAStarConfig,
    SearchEnd,
};
use keyway::search::CornerRule;
use keyway::smooth::{ShortcutConfig, SmootherConfig};
use keyway_sim::worlds::{Blocks, GeneratedMap, Pattern, Rooms};

const TRADITIONAL: &str = "traditional";
const ACCUMULATED: &str = "accumulated g";
const RATIO: &str = "accumulated g, X = 1.1";
const SHORTCUT: &str = "accumulated g, X = 1.1, shortcut";
const COMPLETE: &str = "accumulated g, X = 1.1, shortcut, expansion";
const BOTH_ENDS: &str = "bidirectional-astar";
const BOTH_ENDS_24: &str = "bidirectional-24";

/// Equations (3) to (5): g is the straight line from the start.
const STRAIGHT_LINE: PlannerConfig = PlannerConfig::AStar(AStarConfig {
    corners: CornerRule::Allow,
    heuristic: Heuristic::Euclidean,
    g: PathCost::StraightLine,
});

/// Equations (13) to (15); with X = 1, only g differs.
pub(super) const fn ratio(x: f64) -> PlannerConfig {
    PlannerConfig::RatioAStar(RatioAStarConfig {
        x,
        end: SearchEnd::GoalGenerated,
        corners: CornerRule::Allow,
        heuristic: Heuristic::Euclidean,
    })
}

/// Two passes on a map with obstacles expanded by this many cells.
pub(super) const fn shortcut(expansion_cells: u32) -> SmootherConfig {
    SmootherConfig::Shortcut(ShortcutConfig { passes: 2, expansion_cells })
}

pub(super) const COMPLETE_METHOD: Method = Method {
    name: COMPLETE,
    how: How::Plan(Planning {
        planner: ratio(1.1),
        smoother: Some(shortcut(1)),
        expansion_cells: 1,
        l1_constraint: 0.0,
        unknown: None,
    }),
    must_succeed: true,
};

/// A map of 100 x 100 cells, with free space for the expansion around its start and goal.
const fn map(obstacles: Pattern) -> GeneratedMap {
    square(100.0, 1.0, obstacles)
}

/// Map 1.
pub(super) const STEPS_ABOUT: &str =
    "100 x 100 cells, 20 % of them in blocks of 2 to 8 cells, from (50, 85) to (50, 20)";
pub(super) const STEPS_FAMILY: GeneratedMap =
    map(Pattern::Blocks(Blocks { share: 0.2, side_m: [2.0, 8.0] }));
pub(super) const STEPS_ENDS: [Cell; 2] = [Cell::new(50, 85), Cell::new(50, 20)];

/// Map 1: one step after another.
static STEPS: Experiment = Experiment {
    name: "wang2019-steps",
    about: STEPS_ABOUT,
    family: STEPS_FAMILY,
    kind: None,
    ends: STEPS_ENDS,
    methods: &[
        Method::new(TRADITIONAL, STRAIGHT_LINE, None),
        Method::new(ACCUMULATED, ratio(1.0), None),
        Method::new(RATIO, ratio(1.1), None),
        Method::new(SHORTCUT, ratio(1.1), Some(shortcut(0))),
        COMPLETE_METHOD,
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: None,
    reconstruction: Err(NOTHING_FITTED),
};

/// Map 2: comparison with other methods.
static OTHERS: Experiment = Experiment {
    name: "wang2019-others",
    about: "100 x 100 cells, rooms of 20 cells with doors of 4, from (25, 85) to (70, 15)",
    family: map(Pattern::Rooms(Rooms { room_m: 20.0, door_m: 4.0, wall_m: 1.0, more_doors: 0.5 })),
    kind: None,
    ends: [Cell::new(25, 85), Cell::new(70, 15)],
    methods: &[
        Method::new(TRADITIONAL, STRAIGHT_LINE, None),
        Method::new(BOTH_ENDS, EUCLIDEAN_BIDIRECTIONAL_ASTAR, None),
        Method::new(
            BOTH_ENDS_24,
            PlannerConfig::Bidirectional24(Bidirectional24Config {
                corners: CornerRule::Allow,
                heuristic: Heuristic::Euclidean,
            }),
            None,
        ),
        COMPLETE_METHOD,
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: None,
    reconstruction: Err(NOTHING_FITTED),
};

/// Reason why no maps fit.
const NOTHING_FITTED: &str =
    "size, start and goal are published, but no length, turn or node of a baseline";

/// One cell \[m\].
const CELL_M: f64 = 1.0 - 1e-9;

pub(super) const PAPER: &str = "Wang2019";

pub(super) static CLAIMS: [Claim; 6] = [
    Claim {
        id: "S2-1",
        paper: PAPER,
        statement: "With the accumulated cost instead of the straight-line distance, planning takes less time, and the path is \
                    better",
        figures: &[
            Figure::lower(Measure::PlanningTime, ACCUMULATED, TRADITIONAL, None),
            Figure::lower(Measure::Expanded, ACCUMULATED, TRADITIONAL, None),
            Figure::lower(Measure::Length, ACCUMULATED, TRADITIONAL, None),
            Figure::lower(Measure::Turns, ACCUMULATED, TRADITIONAL, None),
        ],
        experiment: &STEPS,
    },
    Claim {
        id: "S2-2",
        paper: PAPER,
        statement: "The weight ratio X = 1.1 removes redundant points and turns, and shortens the time",
        figures: &[
            Figure::lower(Measure::RedundantPoints, RATIO, ACCUMULATED, None),
            Figure::lower(Measure::Turns, RATIO, ACCUMULATED, None),
            Figure::lower(Measure::PlanningTime, RATIO, ACCUMULATED, None),
            Figure::lower(Measure::Expanded, RATIO, ACCUMULATED, None),
        ],
        experiment: &STEPS,
    },
    Claim {
        id: "S2-3",
        paper: PAPER,
        statement: "Two passes of the shortcut remove more points and turns; shortcut and expansion take time",
        figures: &[
            Figure::lower(Measure::Points, SHORTCUT, RATIO, None),
            Figure::lower(Measure::Turns, SHORTCUT, RATIO, None),
            Figure::higher(Measure::PlanningTime, SHORTCUT, RATIO, None),
            Figure::higher(Measure::TimeFromMap, COMPLETE, SHORTCUT, None),
        ],
        experiment: &STEPS,
    },
    Claim {
        id: "S2-4",
        paper: PAPER,
        statement: "With the expansion the path stays at least one cell away from every obstacle",
        figures: &[Figure::always(Measure::Clearance, COMPLETE, Bound::AtLeast(CELL_M))],
        experiment: &STEPS,
    },
    Claim {
        id: "S2-5",
        paper: PAPER,
        statement: "The complete method is smoother than traditional A*, synchronous bidirectional A* and bidirectional \
                    time-efficient A*, and fast",
        figures: &[
            Figure::lower(Measure::TurningAngle, COMPLETE, TRADITIONAL, None),
            Figure::lower(Measure::TurningAngle, COMPLETE, BOTH_ENDS, None),
            Figure::lower(Measure::TurningAngle, COMPLETE, BOTH_ENDS_24, None),
            Figure::lower(Measure::Turns, COMPLETE, TRADITIONAL, None),
            Figure::lower(Measure::Turns, COMPLETE, BOTH_ENDS, None),
            Figure::lower(Measure::Turns, COMPLETE, BOTH_ENDS_24, None),
            Figure::lower(Measure::TimeFromMap, COMPLETE, TRADITIONAL, None),
            Figure::lower(Measure::TimeFromMap, COMPLETE, BOTH_ENDS, None),
            Figure::lower(Measure::TimeFromMap, COMPLETE, BOTH_ENDS_24, None),
            Figure::lower(Measure::Expanded, COMPLETE, TRADITIONAL, None),
            Figure::lower(Measure::Expanded, COMPLETE, BOTH_ENDS, None),
            Figure::lower(Measure::Expanded, COMPLETE, BOTH_ENDS_24, None),
        ],
        experiment: &OTHERS,
    },
    Claim {
        id: "S2-6",
        paper: PAPER,
        statement: "The complete method is still faster than traditional A*",
        figures: &[
            Figure::lower(Measure::TimeFromMap, COMPLETE, TRADITIONAL, None),
            Figure::lower(Measure::Expanded, COMPLETE, TRADITIONAL, None),
        ],
        experiment: &STEPS,
    },
];
