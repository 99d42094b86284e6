//! Experiments with runs among unknown obstacles.
//!
//! The sizes of the roadways, the mine and the laboratory are not published. Each family is
//! chosen by the published figures of the baselines: the length of 4-neighbour A* in each of the
//! three roadways (77, 80 and 88 m), the length of A* in the mine (86.31 m), and the number of
//! turns of A*'s path in the laboratory (10). RRT, A* and Dijkstra do not avoid unknown
//! obstacles; their runs end at the first one. A length, a search time or a contact of these
//! methods is therefore measured on their path, as in the paper's tables: a robot that follows
//! the path also touches the mapped walls whose corners it cuts. In the laboratory, A*'s path
//! keeps clear of the walls, so a robot follows it.

use super::super::driven::Vehicle;
use super::super::experiment::{Experiment, ExperimentScene};
use super::super::method::Method;
use super::super::planned::Planning;
use super::super::planners::{EUCLIDEAN_ASTAR, JPS};
use super::super::reconstruction::{Baseline, Published, Reconstruction};
use super::super::square::square;
use keyway::geometry::Point;
use keyway::map::Cell;
use keyway::plan::{AStar4Config, DijkstraConfig, Heuristic, PlannerConfig, RrtConfig};
use keyway::search::CornerRule;
use keyway_sim::worlds::{Clutter, GeneratedMap, Mine, Pattern};

pub(super) const GUIDED: &str = "s4-guided";
pub(super) const REF20: &str = "s4-ref20";
pub(super) const ASTAR_FOLLOW: &str = "astar-follow";
pub(super) const PATH_OF_ASTAR: &str = "astar";
pub(super) const PATH_OF_ASTAR4: &str = "astar4";
pub(super) const PATH_OF_DIJKSTRA: &str = "dijkstra";
pub(super) const PATH_OF_RRT: &str = "rrt";

const ASTAR4: PlannerConfig =
    PlannerConfig::AStar4(AStar4Config { heuristic: Heuristic::Manhattan });
const DIJKSTRA: PlannerConfig =
    PlannerConfig::Dijkstra(DijkstraConfig { corners: CornerRule::Allow });
const RRT: PlannerConfig = PlannerConfig::Rrt(RrtConfig {
    corners: CornerRule::Forbid,
    step_m: 1.0,
    goal_bias: 0.05,
    samples: 1_000_000,
    seed: 0,
});

/// Reason why no maps fit.
const LENGTHS_FIT_ALL: &str = "the lengths of 4-neighbour A* are the distances of start and goal along the axes, so every open map fits them; \
    the number of turns depends on the choice among equally short paths, not on the map; RRT is random";
const NO_ROOM: &str = "neither plan nor size of the room is published, nor the limits of its robot; the family was chosen by the published 10 turns of A*";

/// Maximum distance of the unknown obstacles' centres from the path \[m\].
const ON_THE_WAY_M: f64 = 0.5;
/// Unknown obstacles of figure 7, as in its scenes: static and walking ones.
const STANDING_AND_WALKING: [u32; 2] = [3, 2];
/// Unknown obstacles of figure 8: no moving ones.
const STANDING: [u32; 2] = [3, 0];

/// A square mine; the rough sides of its pillars make each map different. Its start and goal have
/// enough clearance for the constraint.
const fn mine(
    side_m: f64,
    [roadway_m, pillar_m]: [f64; 2],
    roughness_m: f64,
    fallen_in: f64,
) -> GeneratedMap {
    square(side_m, 0.5, Pattern::Mine(Mine { roadway_m, pillar_m, roughness_m, fallen_in }))
}

/// Share of the roadway sections between two crossings that have collapsed.
const FALLEN_IN: f64 = 0.2;
/// Roughness \[m\]; more than a cell, so that it changes the map.
const ROUGH_M: f64 = 2.0;

/// A stack among three static obstacles on its path.
pub(in super::super) const fn past_three(name: &'static str, stack: &'static str) -> Method {
    Method::driving(name, stack).among_unknown(STANDING, ON_THE_WAY_M)
}

/// Figure 7.
pub(in super::super) const UNKNOWN_ABOUT: &str = "42 x 42 cells, roadways of 6 m around pillars of 9 m with rough sides, across, with 3 unknown obstacles on the way";
pub(in super::super) const UNKNOWN_FAMILY: GeneratedMap =
    mine(42.0, [6.0, 9.0], ROUGH_M, FALLEN_IN);
pub(in super::super) const UNKNOWN_ENDS: [Cell; 2] = [Cell::new(2, 2), Cell::new(33, 33)];

/// Figure 7.
pub(super) static UNKNOWN: Experiment = Experiment {
    name: "zhuyin2024-unknown",
    about: UNKNOWN_ABOUT,
    family: UNKNOWN_FAMILY,
    kind: None,
    ends: UNKNOWN_ENDS,
    methods: &[
        Method::new(PATH_OF_ASTAR, EUCLIDEAN_ASTAR, None).among_unknown(STANDING, ON_THE_WAY_M),
        Method::new(PATH_OF_DIJKSTRA, DIJKSTRA, None).among_unknown(STANDING, ON_THE_WAY_M),
        past_three(GUIDED, GUIDED).may_fail(),
        Method::new(Experiment::YARDSTICK, JPS, None).among_unknown(STANDING, ON_THE_WAY_M),
    ],
    scene: None,
    reconstruction: Err(LENGTHS_FIT_ALL),
};

/// Methods in the roadways. The unknown obstacles have the same positions for the paths and the
/// run.
static IN_ROADWAYS: [Method; 4] = [
    Method::new(PATH_OF_RRT, RRT, None).among_unknown(STANDING_AND_WALKING, ON_THE_WAY_M),
    Method::new(PATH_OF_ASTAR4, ASTAR4, None).among_unknown(STANDING_AND_WALKING, ON_THE_WAY_M),
    Method::driving(GUIDED, GUIDED).among_unknown(STANDING_AND_WALKING, ON_THE_WAY_M),
    Method::new(Experiment::YARDSTICK, JPS, None),
];

/// A roadway of figure 7 and table 2, as wide as in its scene.
const fn roadway(
    (name, about): (&'static str, &'static str),
    family: GeneratedMap,
    ends: [Cell; 2],
    scene: ExperimentScene,
) -> Experiment {
    let (scene, reconstruction) = (Some(scene), Err(LENGTHS_FIT_ALL));
    Experiment {
        name,
        about,
        family,
        kind: None,
        ends,
        methods: &IN_ROADWAYS,
        scene,
        reconstruction,
    }
}

/// The pillar is as large as the map, so only the roadways along its lower and left sides remain.
pub(super) static TURNING_ROADWAY: Experiment = roadway(
    (
        "zhuyin2024-turning-roadway",
        "46 x 46 cells, a roadway of 10 m with one bend and rough sides, with 3 unknown obstacles on the way and 2 that walk across it",
    ),
    mine(46.0, [10.0, 40.0], ROUGH_M, 0.0),
    [Cell::new(44, 5), Cell::new(5, 43)],
    ExperimentScene {
        file: "scenes/zhuyin2024/turning_roadway.toml",
        ends: [Cell::new(1, 1), Cell::new(40, 39)],
        map: include_str!("../maps/zhuyin2024_turning_roadway.map"),
    },
);

/// The path leads up the left roadway, along the upper one and into the stub of another vertical
/// one, which has collapsed farther up and below. No other path exists.
pub(super) static CONSECUTIVE_TURNS: Experiment = roadway(
    (
        "zhuyin2024-consecutive-turns",
        "50 x 50 cells, a roadway of 5 m with two bends and rough sides, with 3 unknown obstacles on the way and 2 that walk across it",
    ),
    mine(50.0, [5.0, 33.0], ROUGH_M, 1.0),
    [Cell::new(2, 4), Cell::new(40, 46)],
    ExperimentScene {
        file: "scenes/zhuyin2024/consecutive_turns.toml",
        ends: [Cell::new(0, 1), Cell::new(41, 40)],
        map: include_str!("../maps/zhuyin2024_consecutive_turns.map"),
    },
);

/// The path leads along the lower roadway, through the left one of the vertical ones, since the
/// other has collapsed, and back along the upper roadway.
pub(super) static ROADWAY_TO_ROADWAY: Experiment = roadway(
    (
        "zhuyin2024-roadway-to-roadway",
        "38 x 38 cells, two roadways of 5 m and a third that joins them, with rough sides, with 3 unknown obstacles on the way and 2 that walk across it",
    ),
    mine(38.0, [5.0, 28.0], ROUGH_M, 1.0),
    [Cell::new(30, 2), Cell::new(31, 35)],
    ExperimentScene {
        file: "scenes/zhuyin2024/roadway_to_roadway.toml",
        ends: [Cell::new(4, 2), Cell::new(37, 3)],
        map: include_str!("../maps/zhuyin2024_roadway_to_roadway.map"),
    },
);

/// Table 3: roadways with the width of the family, around one large pillar.
static FITTED_MINE: Reconstruction = Reconstruction {
    name: "zhuyin2024-coal-mine",
    family: mine(66.0, [6.0, 40.0], 1.4, 0.0),
    ends: [Cell::new(2, 2), Cell::new(48, 47)],
    baselines: &[fitted("A*", EUCLIDEAN_ASTAR), fitted("Dijkstra", DIJKSTRA)],
};

const fn fitted(name: &'static str, planner: PlannerConfig) -> Baseline {
    let published = Published::Steps(75, 8);
    Baseline { name, planning: Planning::new(planner, None), ends: None, published }
}

/// Figure 8, table 3.
pub(super) static COAL_MINE: Experiment = Experiment {
    name: "zhuyin2024-coal-mine",
    about: "66 x 66 cells, roadways of 6 m around pillars of 9 m with rough sides, across, with 3 unknown obstacles on the way",
    family: mine(66.0, [6.0, 9.0], ROUGH_M, FALLEN_IN),
    kind: None,
    ends: [Cell::new(2, 2), Cell::new(63, 47)],
    methods: &[
        Method::new(PATH_OF_ASTAR, EUCLIDEAN_ASTAR, None).among_unknown(STANDING, ON_THE_WAY_M),
        Method::new(PATH_OF_DIJKSTRA, DIJKSTRA, None).among_unknown(STANDING, ON_THE_WAY_M),
        past_three(REF20, REF20),
        past_three(GUIDED, GUIDED),
        Method::new(Experiment::YARDSTICK, JPS, None),
    ],
    scene: Some(ExperimentScene {
        file: "scenes/zhuyin2024/coal_mine.toml",
        ends: [Cell::new(2, 1), Cell::new(2, 22)],
        map: include_str!("../maps/zhuyin2024_coal_mine.map"),
    }),
    reconstruction: Ok(&FITTED_MINE),
};

/// A simulated room in place of the real one, and the robot `small` in place of the real robot.
const ROOM: GeneratedMap = GeneratedMap {
    width_m: 12.5,
    height_m: 9.0,
    resolution_m: 0.05,
    origin: Point::new(0.0, 0.0),
    free_ends_m: 0.5,
    obstacles: Pattern::Clutter(Clutter { share: 0.05, radius_m: [0.2, 0.4] }),
};
const ROOM_ENDS: [Cell; 2] = [Cell::new(30, 30), Cell::new(215, 150)];

/// Figure 10.
pub(super) static LABORATORY: Experiment = Experiment {
    name: "zhuyin2024-laboratory",
    about: "12.5 m x 9 m in cells of 5 cm, discs of 0.2 to 0.4 m that cover 5 %, with the robot small",
    family: ROOM,
    kind: None,
    ends: ROOM_ENDS,
    methods: &[
        Method::driving(ASTAR_FOLLOW, ASTAR_FOLLOW).on(Vehicle::Small),
        Method::driving(GUIDED, GUIDED).on(Vehicle::Small),
    ],
    scene: None,
    reconstruction: Err(NO_ROOM),
};

/// Radius of the unknown obstacles in the laboratory \[m\], as in its scene; as elsewhere it is
/// also the largest distance of their centres from the path.
const IN_ROOM_M: f64 = 0.2;

/// Figure 11.
pub(super) static LABORATORY_UNKNOWN: Experiment = Experiment {
    name: "zhuyin2024-laboratory-unknown",
    about: "12.5 m x 9 m in cells of 5 cm, discs of 0.2 to 0.4 m that cover 5 %, with the robot small and 3 unknown obstacles on the way",
    family: ROOM,
    kind: None,
    ends: ROOM_ENDS,
    methods: &[
        Method::driving(ASTAR_FOLLOW, ASTAR_FOLLOW)
            .on(Vehicle::Small)
            .unwatched()
            .among_unknown(STANDING, IN_ROOM_M)
            .with_radius(IN_ROOM_M)
            .may_fail(),
        Method::driving(GUIDED, GUIDED)
            .on(Vehicle::Small)
            .among_unknown(STANDING, IN_ROOM_M)
            .with_radius(IN_ROOM_M)
            .may_fail(),
    ],
    scene: None,
    reconstruction: Err(NO_ROOM),
};

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Pose;
    use keyway::navigate::{Navigator, Stack};
    use keyway::robot::Robot;
    use keyway::search::Workspace;
    use keyway_sim::episode::Episode;

    const MAPS: u64 = 100;

    /// Mean length of a method over the maps of an experiment.
    fn mean_length_m(experiment: &Experiment, method: &str) -> f64 {
        let (_, method) = experiment.method(method).unwrap();
        let mut workspace = Workspace::default();
        let mut length_m = |seed| {
            let grid = experiment.map(seed).unwrap();
            let found = method.run(&grid, (experiment.ends, seed), &mut workspace, None).unwrap();
            found.unwrap().planned().unwrap().path.length_m
        };
        (1..=MAPS).map(&mut length_m).sum::<f64>() / MAPS as f64
    }

    /// Mean number of turns of A*'s path in the laboratory with another share.
    fn mean_turns(share: f64) -> f64 {
        let obstacles = Pattern::Clutter(Clutter { share, radius_m: [0.2, 0.4] });
        let family = GeneratedMap { obstacles, ..LABORATORY.family.clone() };
        let ends = LABORATORY.ends.map(|Cell { x, y }| {
            Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * family.resolution_m
        });
        let turns = (1..=MAPS).filter_map(|seed| {
            let [start, goal] = ends;
            let grid = family.generate(seed, &ends).unwrap();
            let mut episode = Episode::new(grid, Robot::small(), start, goal);
            let robot = &mut episode.robots[0];
            robot.stack = Stack::by_name(ASTAR_FOLLOW, &robot.robot).unwrap();
            let stack = robot.stack.fit(&robot.robot).ok()?;
            let mut navigator = Navigator::new(&episode.known, &stack).ok()?;
            navigator.relocate(Pose::new(start.x, start.y, 0.0));
            navigator.set_goal(goal).ok()?;
            Some(navigator.route()?.line.polyline().turns_rad().len() as f64)
        });
        let turns: Vec<f64> = turns.collect();
        turns.iter().sum::<f64>() / turns.len() as f64
    }

    #[test]
    fn families_have_what_is_published_of_the_baselines() {
        let roadways =
            [(&TURNING_ROADWAY, 77.0), (&CONSECUTIVE_TURNS, 80.0), (&ROADWAY_TO_ROADWAY, 88.0)];
        for (roadway, published_m) in roadways {
            let roadway_m = mean_length_m(roadway, PATH_OF_ASTAR4);
            assert!((roadway_m - published_m).abs() < 0.01 * published_m, "{roadway_m}");
        }
        let mine_m = mean_length_m(&COAL_MINE, PATH_OF_ASTAR);
        assert!((mine_m - 86.31).abs() < 0.01 * 86.31, "{mine_m}");
        // Of all shares in steps of 5 %, this one is nearest to 10 turns.
        let Pattern::Clutter(Clutter { share, .. }) = LABORATORY.family.obstacles else {
            panic!("no clutter")
        };
        let off = |share: f64| (mean_turns(share) - 10.0).abs();
        assert!(share == 0.05 && off(share) < 1.0 && off(0.1) > 5.0);
    }
}
