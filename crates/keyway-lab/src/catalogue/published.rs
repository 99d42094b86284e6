//! Uses of a part in the papers: their own methods and their baselines.
//!
//! A part has the values of its paper by default. The table below lists the other settings of a
//! method: another corner rule, a layer of the map, or the planner whose path a smoother smooths.

use keyway::local::Dwa;
use keyway::navigate::Stack;

/// A method of a paper in which a part is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PublishedUse {
    /// Key of the paper in docs/papers.md.
    pub source: &'static str,
    /// Description of the method.
    pub method: &'static str,
    /// The method as parts and parameters.
    pub setup: PublishedSetup,
}

/// Parts and parameters of a published method. Assignments have the form `path=value`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PublishedSetup {
    /// A path planner.
    Plan {
        /// Name of the planner.
        planner: &'static str,
        /// Name of the smoother.
        smoother: &'static str,
        /// Parameters beside them, as assignments.
        set: &'static [&'static str],
    },
    /// A stack with the values of its paper.
    Drive {
        /// Name of the stack.
        stack: &'static str,
        /// Parameters that differ, as assignments.
        set: &'static [&'static str],
    },
}

const fn row(
    source: &'static str,
    method: &'static str,
    planner: &'static str,
    smoother: &'static str,
    set: &'static [&'static str],
) -> PublishedUse {
    PublishedUse { source, method, setup: PublishedSetup::Plan { planner, smoother, set } }
}

const CORNERS: &[&str] = &["planner.corners=allow"];

/// Traditional A* of Wang 2019, whose g is the straight line from the start.
const STRAIGHT_LINE: &[&str] =
    &["planner.corners=allow", "planner.g=straight-line", "planner.heuristic=euclidean"];

/// Methods with a planner or a smoother of this library. The paper's own method has both.
const ROWS: &[PublishedUse] = &[
    row("You2021", "the paper's method", "bidirectional-jps", "key-points", &[]),
    row("You2021", "fixed targets, its first design", "bidirectional-jps-fixed", "none", &[]),
    row("You2021", "A*, its baseline", "astar", "none", &[]),
    row("You2021", "bidirectional A*, its baseline", "bidirectional-astar", "none", &[]),
    row("S1", "the paper's method", "density-astar", "bidirectional", &[]),
    row("S1", "traditional A*, its baseline", "astar", "none", CORNERS),
    row(
        "Wang2019",
        "the paper's method",
        "ratio-astar",
        "shortcut",
        &["map.published.expansion_cells=1"],
    ),
    row("Wang2019", "traditional A*, its baseline", "astar", "none", STRAIGHT_LINE),
    row("Wang2019", "Dijkstra's algorithm, its baseline", "dijkstra", "none", CORNERS),
    row(
        "Wang2019",
        "greedy best-first search, its baseline",
        "greedy",
        "none",
        &["planner.corners=allow", "planner.heuristic=euclidean"],
    ),
    row("Wang2019", "bidirectional A*, its reference 17", "bidirectional-astar", "none", CORNERS),
    row("Wang2019", "24 neighbours, its reference 18", "bidirectional-24", "none", CORNERS),
    row("ZhuYin2024", "the paper's method", "hsta", "hierarchical", &[]),
    row("ZhuYin2024", "A*, its baseline", "astar", "none", CORNERS),
    row("ZhuYin2024", "bidirectional A*, its baseline", "bidirectional-astar", "none", CORNERS),
    row("ZhuYin2024", "Dijkstra's algorithm, its baseline", "dijkstra", "none", CORNERS),
    row("ZhuYin2024", "4-neighbour A*, its baseline", "astar4", "none", &[]),
    row("ZhuYin2024", "RRT, its baseline", "rrt", "none", &[]),
];

/// Returns the methods in which the planner or smoother of this name is used.
pub(super) fn of_part(name: &str) -> Vec<PublishedUse> {
    let is_used = |one: &&PublishedUse| match one.setup {
        PublishedSetup::Plan { planner, smoother, .. } => {
            planner == name || (smoother == name && name != "none")
        }
        PublishedSetup::Drive { .. } => false,
    };
    ROWS.iter().filter(is_used).copied().collect()
}

/// Returns the stack of this name as published, if it is published.
pub(super) fn of_stack(stack: &'static str) -> Option<PublishedUse> {
    let (method, source) = (Stack::summary(stack)?, Stack::source(stack)?);
    let setup = PublishedSetup::Drive { stack, set: &[] };
    Some(PublishedUse { source, method, setup })
}

/// Returns the published stacks in which the local planner of this name is used.
pub(super) fn of_local(name: &str) -> Vec<PublishedUse> {
    let is_used = |stack: &&str| {
        Stack::published_by_name(stack).is_some_and(|stack| stack.local.name() == name)
    };
    let stacks = Stack::NAMES.into_iter().filter(is_used).filter_map(of_stack);
    stacks.chain((name == Dwa::NAME).then_some(SAMPLE)).collect()
}

const SAMPLE_SET: &[&str] = &[
    "local.window.stopping_distance_at=end",
    "local.window.distance_at=end",
    "local.distance_term_cap_m=1.0",
];

/// The sample program behind much of this literature: its settings turn `DwaConfig::PAPER` into
/// `DwaConfig::SAMPLE`.
const SAMPLE: PublishedUse = PublishedUse {
    source: "You2021",
    method: "the same as in the MATLAB sample: distance at the end, at most 2 R1",
    setup: PublishedSetup::Drive { stack: "dwa-to-goal", set: SAMPLE_SET },
};

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::local::{DwaConfig, LocalConfig, SpaceTime};
    use keyway::plan::PlannerConfig;
    use keyway::smooth::SmootherConfig;

    #[test]
    fn rows_name_what_exists() {
        for &PublishedUse { source, method, setup } in ROWS {
            let PublishedSetup::Plan { planner, smoother, .. } = setup else {
                panic!("{method} drives")
            };
            assert!(PlannerConfig::by_name(planner).is_some(), "{source}: {method}: {planner}");
            assert!(SmootherConfig::by_name(smoother).is_some(), "{source}: {method}: {smoother}");
        }
        let with_paper = |name: &&&str| {
            PlannerConfig::by_name(name).is_some_and(|config| config.as_published().is_some())
        };
        for name in PlannerConfig::NAMES.iter().filter(with_paper) {
            assert!(!of_part(name).is_empty(), "{name} has a paper, but no method");
        }
        assert!(of_part("none").is_empty() && of_part("jps").is_empty());
    }

    #[test]
    fn the_sample_has_all_its_values() {
        let mut tree = toml::Table::try_from(DwaConfig::PAPER).unwrap();
        tree["window"]["stopping_distance_at"] = "end".into();
        tree["window"]["distance_at"] = "end".into();
        tree["distance_term_cap_m"] = 1.0.into();
        assert_eq!(tree.try_into::<DwaConfig>().unwrap(), DwaConfig::SAMPLE);
        let expected = PublishedSetup::Drive { stack: "dwa-to-goal", set: SAMPLE_SET };
        assert_eq!(of_local("dwa").pop().unwrap().setup, expected);
    }

    /// Local planners of our own, which no paper describes.
    const OWN: [&str; 1] = [SpaceTime::NAME];

    #[test]
    fn every_local_planner_but_our_own_is_used_in_a_paper() {
        assert!(OWN.iter().all(|name| of_local(name).is_empty()));
        for name in LocalConfig::NAMES.into_iter().filter(|name| !OWN.contains(name)) {
            let published = of_local(name);
            let drives = |one: &PublishedUse| matches!(one.setup, PublishedSetup::Drive { .. });
            assert!(published.iter().all(drives), "{name}");
            assert!(!published.is_empty(), "{name}");
        }
        let guided = PublishedSetup::Drive { stack: "s4-guided", set: &[] };
        assert_eq!(of_local("guided-dwa")[0].setup, guided);
        assert_eq!(of_stack("key-point-fusion"), None);
    }
}
