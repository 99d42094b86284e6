//! How the papers use a part: their own methods and their baselines, as options to paste.
//!
//! A part already has its paper's values (`paper` in the list of its parameters). What belongs to a
//! method beside it (another corner rule, a layer of the map, the planner that feeds a smoother) is
//! listed here.

use keyway::local::Dwa;
use keyway::navigate::Stack;
use serde::Serialize;

/// A method of a paper in which a part is used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Published {
    /// The paper's key, as in docs/PAPERS.md.
    pub(super) source: &'static str,
    /// Which of its methods.
    pub(super) method: &'static str,
    /// The options of `keyway plan` (of a local planner or a stack: `keyway navigate`) that make it.
    pub(super) options: Vec<String>,
}

/// A method of a paper: its planner, its smoother, and what is set beside them.
struct Row {
    source: &'static str,
    method: &'static str,
    planner: &'static str,
    smoother: &'static str,
    set: &'static [&'static str],
}

const fn row(
    source: &'static str,
    method: &'static str,
    planner: &'static str,
    smoother: &'static str,
    set: &'static [&'static str],
) -> Row {
    Row { source, method, planner, smoother, set }
}

const CORNERS: &[&str] = &["planner.corners=allow"];

/// The traditional A* of Wang 2019, whose g is the straight line from the start.
const STRAIGHT_LINE: &[&str] =
    &["planner.corners=allow", "planner.g=straight-line", "planner.heuristic=euclidean"];

/// Of planners and smoothers; those of the whole method are listed with both.
const ROWS: &[Row] = &[
    row("You2021", "the paper's method", "bidirectional-jps", "key-points", &[]),
    row("You2021", "fixed targets, its first design", "bidirectional-jps-fixed", "none", &[]),
    row("You2021", "A*, its baseline", "astar", "none", &[]),
    row("You2021", "bidirectional A*, its baseline", "bidirectional-astar", "none", &[]),
    row("S1", "the paper's method", "density-astar", "bidirectional", &[]),
    row("S1", "traditional A*, its baseline", "astar", "none", CORNERS),
    row("Wang2019", "the paper's method", "ratio-astar", "shortcut", &["map.expansion_cells=1"]),
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

/// The methods of the papers in which the planner or smoother of this name is used.
pub(super) fn of_part(name: &str) -> Vec<Published> {
    let uses = |one: &&Row| one.planner == name || (one.smoother == name && name != "none");
    let published = |&Row { source, method, planner, smoother, set }: &Row| {
        let mut options = vec![format!("--planner {planner}"), format!("--smoother {smoother}")];
        options.extend(set.iter().map(|set| format!("--set {set}")));
        Published { source, method, options }
    };
    ROWS.iter().filter(uses).map(published).collect()
}

/// The stack of this name as published, where it was.
pub(super) fn of_stack(name: &'static str) -> Vec<Published> {
    let Some((method, Some(source))) = Stack::about(name) else { return Vec::new() };
    let options = vec![format!("--stack {name}"), "--as-published".to_owned()];
    vec![Published { source, method, options }]
}

/// The published stacks in which the local planner of this name is used.
pub(super) fn of_local(name: &str) -> Vec<Published> {
    let uses = |stack: &&str| {
        Stack::published_by_name(stack).is_some_and(|stack| stack.local.name() == name)
    };
    let mut published: Vec<Published> =
        Stack::NAMES.into_iter().filter(|stack| uses(stack)).flat_map(of_stack).collect();
    if name == Dwa::NAME {
        published.push(sample());
    }
    published
}

/// The program behind much of this literature.
fn sample() -> Published {
    let options = ["--stack dwa-to-goal", "--as-published"].into_iter().chain(SAMPLE);
    Published {
        source: "You2021",
        method: "the same as in the MATLAB sample: distance at the end, at most 2 R1",
        options: options.map(str::to_owned).collect(),
    }
}

/// What turns `DwaConfig::PAPER` into `DwaConfig::SAMPLE`.
const SAMPLE: [&str; 2] =
    ["--set local.window.distance_at=end", "--set local.distance_term_cap_m=1.0"];

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::local::{DwaConfig, LocalConfig, SpaceTime};
    use keyway::plan::PlannerConfig;
    use keyway::smooth::SmootherConfig;

    #[test]
    fn rows_name_what_exists() {
        for &Row { source, method, planner, smoother, .. } in ROWS {
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
        tree["window"]["distance_at"] = "end".into();
        tree["distance_term_cap_m"] = 1.0.into();
        assert_eq!(tree.try_into::<DwaConfig>().unwrap(), DwaConfig::SAMPLE);
        let options = of_local("dwa").pop().unwrap().options;
        assert_eq!(
            options[2..],
            ["--set local.window.distance_at=end", "--set local.distance_term_cap_m=1.0"]
        );
    }

    #[test]
    fn every_local_planner_but_our_own_is_used_in_a_paper() {
        assert!(of_local(SpaceTime::NAME).is_empty());
        for name in LocalConfig::NAMES.into_iter().filter(|name| *name != SpaceTime::NAME) {
            let published = of_local(name);
            assert!(published.iter().all(|one| one.options[1] == "--as-published"), "{name}");
            assert!(!published.is_empty(), "{name}");
        }
        assert_eq!(of_local("guided-dwa")[0].options, ["--stack s4-guided", "--as-published"]);
        assert!(of_stack("key-point-fusion").is_empty());
    }
}
