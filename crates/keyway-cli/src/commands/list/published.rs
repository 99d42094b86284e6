//! How the papers use a part: their own methods and their baselines, as options to paste.
//!
//! A part already has its paper's values (`paper` in the list of its parameters). What belongs to a
//! method beside it (another corner rule, a layer of the map, the planner that feeds a smoother) is
//! listed here.

use keyway::guide::{CarrotConfig, GuideConfig, KeyPointsConfig, LocalGoalsConfig};
use keyway::local::{
    AdaptiveDwaConfig, DwaConfig, GuidedDwaConfig, KeyPointDwaConfig, LocalConfig,
};
use keyway::map::LayerConfig;
use keyway::navigate::{ControllerConfig, Stack};
use keyway::plan::{BidirectionalJpsConfig, DensityAStarConfig, HstaConfig, PlannerConfig};
use keyway::robot::Robot;
use keyway::smooth::{
    BidirectionalSmoothingConfig, HierarchicalSmoothingConfig, KeyPointSmoothingConfig,
    SmootherConfig,
};
use serde::Serialize;
use serde_json::Value;

/// A method of a paper in which a part is used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Published {
    /// The paper's key, as in docs/PAPERS.md.
    pub(super) source: &'static str,
    /// Which of its methods.
    pub(super) method: &'static str,
    /// The options of `keyway plan` (of a local planner: `keyway navigate`) that make it.
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

/// The same for a local planner: a whole stack, with the robot that it was published with.
pub(super) fn of_local(name: &str) -> Vec<Published> {
    let robot = Robot::paper();
    let published = |(source, method, stack): (&'static str, &'static str, Stack)| Published {
        source,
        method,
        options: options_from_default(&stack, &robot),
    };
    stacks().into_iter().filter(|(.., stack)| stack.local.name() == name).map(published).collect()
}

/// The stacks in which the papers use their local planners.
fn stacks() -> [(&'static str, &'static str, Stack); 5] {
    let key_points = |local| Stack {
        map: LayerConfig::default(),
        planner: PlannerConfig::BidirectionalJps(BidirectionalJpsConfig::PAPER),
        smoother: SmootherConfig::KeyPoints(KeyPointSmoothingConfig::PAPER),
        guide: GuideConfig::KeyPoints(KeyPointsConfig::PAPER),
        local,
        controller: ControllerConfig::PAPER,
    };
    let classic = key_points(LocalConfig::Dwa(DwaConfig::PAPER));
    let sample = key_points(LocalConfig::Dwa(DwaConfig::SAMPLE));
    let key_point = key_points(LocalConfig::KeyPointDwa(KeyPointDwaConfig::PAPER));
    let adaptive = Stack {
        planner: PlannerConfig::DensityAStar(DensityAStarConfig::PAPER),
        smoother: SmootherConfig::Bidirectional(BidirectionalSmoothingConfig::PAPER),
        guide: GuideConfig::LocalGoals(LocalGoalsConfig::PAPER),
        ..key_points(LocalConfig::AdaptiveDwa(AdaptiveDwaConfig::PAPER))
    };
    let guided = Stack {
        planner: PlannerConfig::Hsta(HstaConfig::PAPER),
        smoother: SmootherConfig::Hierarchical(HierarchicalSmoothingConfig::PAPER),
        guide: GuideConfig::Carrot(CarrotConfig { look_ahead_m: 1.0 }),
        ..key_points(LocalConfig::GuidedDwa(GuidedDwaConfig::PAPER))
    };
    [
        ("You2021", "classic DWA along the key points, tables 2 and 3", classic),
        ("You2021", "the same as in the MATLAB sample: distance at the end, at most 2 R1", sample),
        ("You2021", "the paper's method, with the weights of its fused runs", key_point),
        ("S1", "the paper's method", adaptive),
        ("ZhuYin2024", "the paper's method", guided),
    ]
}

/// The options that turn the default stack for the published robot into this one.
fn options_from_default(stack: &Stack, robot: &Robot) -> Vec<String> {
    let default = Stack::key_point_fusion(robot);
    let mut options = vec![
        "--robot paper".to_owned(),
        format!("--set planner.name={}", stack.planner.name()),
        format!("--set smoother.name={}", stack.smoother.name()),
    ];
    let (guide, local) = (stack.guide.name(), stack.local.name());
    for (part, name, by_default) in
        [("guide", guide, default.guide.name()), ("local", local, default.local.name())]
    {
        if name != by_default {
            options.push(format!("--set {part}.name={name}"));
        }
    }
    // A part of a name begins with what that has by default.
    let named = Stack {
        planner: PlannerConfig::by_name(stack.planner.name()).unwrap_or(default.planner),
        smoother: SmootherConfig::by_name(stack.smoother.name()).unwrap_or(default.smoother),
        guide: GuideConfig::by_name(guide, robot).unwrap_or(default.guide),
        local: LocalConfig::by_name(local, robot).unwrap_or(default.local),
        ..default
    };
    let tree = |stack: &Stack| serde_json::to_value(stack).unwrap_or_default();
    changes("", &tree(&named), &tree(stack), &mut options);
    options
}

fn changes(path: &str, from: &Value, to: &Value, options: &mut Vec<String>) {
    for (key, value) in to.as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        match value {
            Value::Object(_) => changes(&path, &from[key], value, options),
            Value::String(text) if from[key] != *value => {
                options.push(format!("--set {path}={text}"));
            }
            _ if from[key] != *value => options.push(format!("--set {path}={value}")),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_local_planner_gets_all_its_values() {
        let options = |name: &str, method: usize| of_local(name)[method].options.clone();
        let has = |options: &[String], one: &str| {
            assert!(options.iter().any(|option| option == one), "{one} in {options:?}");
        };
        let classic = options("dwa", 0);
        for one in ["--robot paper", "local.window.horizon_s=3.0", "local.window.prediction=euler"]
        {
            has(&classic, &format!("--set {one}").replace("--set --", "--"));
        }
        for one in ["guide.reach_m=1.5", "controller.goal_tolerance_m=0.5", "map.clearance_m=0.0"] {
            has(&classic, &format!("--set {one}"));
        }
        assert!(!classic.iter().any(|option| option.contains("local.name")), "it is the default");
        has(&options("dwa", 1), "--set local.distance_term_cap_m=1.0");
        has(&options("key-point-dwa", 0), "--set local.name=key-point-dwa");
        has(&options("adaptive-dwa", 0), "--set guide.name=local-goals");
        has(&options("guided-dwa", 0), "--set planner.if_no_path=fail");
    }

    #[test]
    fn a_local_planner_with_a_paper_has_a_method() {
        for name in LocalConfig::NAMES {
            let config = LocalConfig::by_name(name, &Robot::paper()).unwrap();
            let has_paper = config.as_published().is_some();
            assert_eq!(of_local(name).is_empty(), !has_paper, "{name}");
        }
    }
}
