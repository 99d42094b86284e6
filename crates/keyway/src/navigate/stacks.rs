//! The stacks by name: the default one, those of the papers, and the baselines of the papers.
//!
//! A stack is data: each is a row of parts, given by name. It comes in two versions:
//!
//! - For a robot, every part has the parameters that it derives from the robot, or its defaults.
//!   Routes keep the robot's clearance, smoothers with their own safe distance keep the same, and
//!   no corner is cut.
//! - As published, every part has its paper's values, the robot is the point of [`Robot::paper`]
//!   on cells of 1 m, and corners are cut if the paper's own search cuts them. The route is
//!   planned once.
//!
//! # Interpretations
//! - \[Wang2019\] does not drive, and the baselines of \[ZhuYin2024\] are paths. Here a robot
//!   follows them ([`Follower`](crate::local::Follower)), in the published version so closely
//!   that it hardly leaves them.
//! - References 9 and 14 of \[S1\] and reference 20 of \[ZhuYin2024\] cannot be identified from
//!   the texts. Their stand-ins follow the descriptions in the texts: the turning points of A*,
//!   followed, and as the guide of a classic DWA; key points of A* that guide the DWA of
//!   \[You2021\] with a fixed weight of speed.
//! - \[ZhuYin2024\] replans only when no position behind an obstacle is free. Since its DWA may
//!   stop in front of an obstacle (see [`GuidedDwa`](crate::local::GuidedDwa)), a robot that
//!   makes no progress waits, then replans. Its collision constraint is lifted within a cell of
//!   the start and the goal, so that a robot beside an obstacle can plan at all.

use super::{ControllerConfig, RecoveryKind, Stack};
use crate::guide::GuideConfig;
use crate::local::{DwaConfig, LocalConfig};
use crate::map::{LayerConfig, PublishedConstraints};
use crate::plan::PlannerConfig;
use crate::robot::Robot;
use crate::search::CornerRule;
use crate::smooth::SmootherConfig;
use std::borrow::Cow;

/// A stack as a row of parts.
struct Parts {
    name: &'static str,
    /// Description in one sentence.
    about: &'static str,
    /// Key in docs/papers.md, if it was published.
    source: Option<&'static str>,
    planner: &'static str,
    smoother: &'static str,
    guide: &'static str,
    local: &'static str,
    /// Corner rule of the search as published, if the planner has one.
    corners: CornerRule,
}

const fn parts(
    name: &'static str,
    about: &'static str,
    source: Option<&'static str>,
    [planner, smoother, guide, local]: [&'static str; 4],
    corners: CornerRule,
) -> Parts {
    Parts { name, about, source, planner, smoother, guide, local, corners }
}

const YOU: Option<&str> = Some("You2021");
const S1: Option<&str> = Some("S1");
const WANG: Option<&str> = Some("Wang2019");
const ZHU: Option<&str> = Some("ZhuYin2024");

use CornerRule::{Allow, Forbid};

const KEYWAY: Parts = parts(
    "keyway",
    "Jump point search, line-of-sight smoothing, space-time trajectories: the default",
    None,
    ["jps", "line-of-sight", "key-points", "space-time"],
    Forbid,
);

const KEY_POINT_FUSION: Parts = parts(
    "key-point-fusion",
    "Jump point search, line-of-sight smoothing, key points, DWA",
    None,
    ["jps", "line-of-sight", "key-points", "dwa"],
    Forbid,
);

/// Side of the papers' cells \[m\].
const CELL_M: f64 = 1.0;

const S2_EXPANDED: &str = "s2-expanded";
const S4_GUIDED: &str = "s4-guided";
const S4_REF20: &str = "s4-ref20";
const DWA_TO_GOAL: &str = "dwa-to-goal";

const STACKS: [Parts; 14] = [
    KEYWAY,
    KEY_POINT_FUSION,
    parts(
        "s0-key-point",
        "Improved bidirectional jump point A*, key points that guide a DWA with an adaptive weight of speed",
        YOU,
        ["bidirectional-jps", "key-points", "key-points", "key-point-dwa"],
        Forbid,
    ),
    parts(
        "s1-adaptive",
        "Density-weighted A*, bidirectional smoothing, local goals for a DWA with distance factors",
        S1,
        ["density-astar", "bidirectional", "local-goals", "adaptive-dwa"],
        Forbid,
    ),
    parts(
        "s1-ref9",
        "Stand-in for the paper's reference 9: the turning points of A*, followed",
        S1,
        ["astar", "none", "carrot", "follower"],
        Allow,
    ),
    parts(
        "s1-ref14",
        "Stand-in for the paper's reference 14: the turning points of A* guide a DWA",
        S1,
        ["astar", "none", "key-points", "dwa"],
        Allow,
    ),
    parts(
        S2_EXPANDED,
        "Weight-ratio A* among expanded obstacles, grandparent shortcuts, followed",
        WANG,
        ["ratio-astar", "shortcut", "carrot", "follower"],
        Allow,
    ),
    parts(
        S4_GUIDED,
        "HSTA*, hierarchical smoothing, followed; around unknown obstacles by a guided DWA",
        ZHU,
        ["hsta", "hierarchical", "carrot", "guided-dwa"],
        Forbid,
    ),
    parts(
        S4_REF20,
        "Stand-in for the paper's reference 20: key points of A* guide a DWA all the way",
        ZHU,
        ["astar", "key-points", "key-points", "dwa"],
        Allow,
    ),
    parts(
        DWA_TO_GOAL,
        "DWA straight to the goal, without a route to guide it",
        YOU,
        ["jps", "none", "goal", "dwa"],
        Forbid,
    ),
    parts(
        "astar-follow",
        "A* with 8 neighbours, followed",
        ZHU,
        ["astar", "none", "carrot", "follower"],
        Allow,
    ),
    parts(
        "astar4-follow",
        "A* with 4 neighbours, followed",
        ZHU,
        ["astar4", "none", "carrot", "follower"],
        Forbid,
    ),
    parts(
        "dijkstra-follow",
        "Dijkstra's algorithm, followed",
        ZHU,
        ["dijkstra", "none", "carrot", "follower"],
        Allow,
    ),
    parts(
        "rrt-follow",
        "A rapidly-exploring random tree, followed",
        ZHU,
        ["rrt", "none", "carrot", "follower"],
        Forbid,
    ),
];

impl Stack {
    /// Names of all stacks, for [`Self::by_name`].
    pub const NAMES: [&'static str; STACKS.len()] = {
        let mut names = [""; STACKS.len()];
        let mut i = 0;
        while i < names.len() {
            names[i] = STACKS[i].name;
            i += 1;
        }
        names
    };

    /// Name of the default stack.
    pub const DEFAULT: &'static str = KEYWAY.name;

    /// The stack of this name with the parameters for a robot.
    pub fn by_name(name: &str, robot: &Robot) -> Option<Self> {
        of_name(name)?.for_robot(robot)
    }

    /// Keyway's own stack, the default, with the parameters for a robot. If possible, routes keep
    /// the distance covered in one cycle at full speed plus the circumscribed radius from
    /// obstacles, at which the robot can rotate on the spot. Otherwise they try the circumscribed
    /// radius and the margin alone, then [`ControllerConfig::least_clearance_m`].
    pub fn keyway(robot: &Robot) -> Self {
        of_known_parts(KEYWAY.for_robot(robot))
    }

    /// The classic stack: key points that guide a dynamic window, with the parameters for a
    /// robot. Its routes are those of [`Self::keyway`].
    pub fn key_point_fusion(robot: &Robot) -> Self {
        of_known_parts(KEY_POINT_FUSION.for_robot(robot))
    }

    /// A stack with the values of its paper, for [`Robot::paper`]; `None` also for an unpublished
    /// one.
    pub fn published_by_name(name: &str) -> Option<Self> {
        let parts = of_name(name)?;
        parts.source.and_then(|_| parts.as_published())
    }

    /// A one-sentence description of the stack of this name.
    pub fn summary(name: &str) -> Option<&'static str> {
        of_name(name).map(|parts| parts.about)
    }

    /// Key in docs/papers.md of the paper that published the stack of this name; `None` for an
    /// unpublished one.
    pub fn source(name: &str) -> Option<&'static str> {
        of_name(name)?.source
    }
}

/// Unwraps a stack whose parts are named above.
#[expect(clippy::expect_used, reason = "tests make every stack")]
fn of_known_parts(stack: Option<Stack>) -> Stack {
    stack.expect("its parts exist")
}

fn of_name(name: &str) -> Option<&'static Parts> {
    STACKS.iter().find(|parts| parts.name == name)
}

impl Parts {
    /// Routes keep the distance covered in one cycle at full speed plus the circumscribed radius
    /// from obstacles, if possible.
    fn for_robot(&self, robot: &Robot) -> Option<Stack> {
        let clearance_m = robot.preferred_clearance_m();
        let mut stack = Stack {
            map: LayerConfig { clearance_m, ..self.layers() },
            planner: with_corners(PlannerConfig::by_name(self.planner)?, Forbid)
                .keeping(clearance_m),
            smoother: SmootherConfig::by_name(self.smoother)?.keeping(clearance_m),
            guide: GuideConfig::by_name(self.guide, robot)?,
            local: LocalConfig::by_name(self.local, robot)?,
            controller: ControllerConfig::for_robot(robot),
        };
        if self.name == DWA_TO_GOAL {
            let without_route = &[RecoveryKind::Turn, RecoveryKind::BackUp, RecoveryKind::Wait];
            stack.controller.watch_route = false;
            stack.controller.recoveries = Cow::Borrowed(without_route);
        }
        if self.name == KEYWAY.name {
            // Its local planner rotates and backs up by itself, before it has to.
            let others = &[RecoveryKind::Replan, RecoveryKind::Manoeuvre, RecoveryKind::Wait];
            stack.controller.recoveries = Cow::Borrowed(others);
        }
        Some(stack)
    }

    fn as_published(&self) -> Option<Stack> {
        let robot = Robot::paper();
        let planner = PlannerConfig::by_name(self.planner)?;
        let smoother = SmootherConfig::by_name(self.smoother)?;
        let guide = GuideConfig::by_name(self.guide, &robot)?;
        let local = LocalConfig::by_name(self.local, &robot)?;
        let planner = planner.as_published().unwrap_or(planner);
        let mut stack = Stack {
            map: self.layers(),
            planner: with_corners(planner, self.corners),
            smoother: smoother.as_published().unwrap_or(smoother),
            guide: guide.as_published().unwrap_or(guide),
            local: local.as_published().unwrap_or(local),
            controller: ControllerConfig::PAPER,
        };
        match self.name {
            S4_REF20 => stack.local = LocalConfig::Dwa(DwaConfig::FUSED),
            S4_GUIDED => {
                let at_last = &[RecoveryKind::Wait, RecoveryKind::Replan];
                stack.controller.recoveries = Cow::Borrowed(at_last);
                if let PlannerConfig::Hsta(hsta) = &mut stack.planner {
                    hsta.free_ends_m = CELL_M;
                }
            }
            _ => {}
        }
        Some(stack)
    }

    /// The layers of its search, without a clearance.
    fn layers(&self) -> LayerConfig {
        let expansion_cells = u32::from(self.name == S2_EXPANDED);
        let published = PublishedConstraints { expansion_cells, ..PublishedConstraints::NONE };
        LayerConfig { published, ..LayerConfig::default() }
    }
}

/// Applies a corner rule to a planner, if it has one.
fn with_corners(mut planner: PlannerConfig, corners: CornerRule) -> PlannerConfig {
    match &mut planner {
        PlannerConfig::AStar(config) => config.corners = corners,
        PlannerConfig::Dijkstra(config) => config.corners = corners,
        PlannerConfig::RatioAStar(config) => config.corners = corners,
        _ => {}
    }
    planner
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth::ShortcutConfig;

    #[test]
    fn every_stack_has_parts_that_exist_and_fit_together() {
        for (name, parts) in Stack::NAMES.into_iter().zip(&STACKS) {
            for robot in Robot::NAMES.map(|name| Robot::by_name(name).unwrap()) {
                let stack = Stack::by_name(name, &robot).expect(name);
                assert_eq!(stack.fit(&robot).map(drop), Ok(()), "{name}");
                let names = [
                    stack.planner.name(),
                    stack.smoother.name(),
                    stack.guide.name(),
                    stack.local.name(),
                ];
                let Parts { planner, smoother, guide, local, .. } = *parts;
                assert_eq!(names, [planner, smoother, guide, local], "{name}");
                assert!(stack.map.clearance_m > robot.footprint.circumscribed_radius_m());
            }
            let source = Stack::source(name);
            let published = Stack::published_by_name(name);
            assert_eq!(published.is_some(), source.is_some(), "{name}");
            if let Some(stack) = published {
                assert_eq!(stack.fit(&Robot::paper()).map(drop), Ok(()), "{name}");
                assert_eq!((stack.map.clearance_m, stack.controller.goal_tolerance_m), (0.0, 0.5));
            }
        }
        assert_eq!((Stack::by_name("none", &Robot::small()), Stack::summary("none")), (None, None));
        let usual = Stack::by_name(Stack::DEFAULT, &Robot::jackal());
        assert_eq!(usual, Some(Stack::keyway(&Robot::jackal())));
        let classic = Stack::by_name("key-point-fusion", &Robot::jackal());
        assert_eq!(classic, Some(Stack::key_point_fusion(&Robot::jackal())));
    }

    #[test]
    fn corners_are_cut_as_the_papers_cut_them_and_by_no_robot() {
        let corners = |stack: Stack| match stack.planner {
            PlannerConfig::AStar(config) => Some(config.corners),
            PlannerConfig::Dijkstra(config) => Some(config.corners),
            PlannerConfig::RatioAStar(config) => Some(config.corners),
            PlannerConfig::DensityAStar(config) => Some(config.corners),
            PlannerConfig::Hsta(config) => Some(config.corners),
            PlannerConfig::Rrt(config) => Some(config.corners),
            _ => None,
        };
        for name in Stack::NAMES {
            let robots = corners(Stack::by_name(name, &Robot::small()).unwrap());
            assert!(robots.is_none_or(|rule| rule == Forbid), "{name}");
        }
        for name in ["s1-ref9", "s1-ref14", "s2-expanded", "s4-ref20", "astar-follow"] {
            let published = Stack::published_by_name(name).unwrap();
            assert_eq!(corners(published), Some(Allow), "{name}");
        }
        for name in ["s1-adaptive", "s4-guided", "rrt-follow"] {
            let published = Stack::published_by_name(name).unwrap();
            assert_eq!(corners(published), Some(Forbid), "{name}");
        }
    }

    #[test]
    fn parts_that_belong_together_agree() {
        let published = Stack::published_by_name("s2-expanded").unwrap();
        assert_eq!(published.smoother, SmootherConfig::Shortcut(ShortcutConfig::PAPER));
        assert_eq!(published.map.published.expansion_cells, ShortcutConfig::PAPER.expansion_cells);
        for name in ["s0-key-point", "s4-guided"] {
            let stack = Stack::by_name(name, &Robot::small()).unwrap();
            assert_eq!(stack.smoother.safe_distance_m(0.05), stack.map.clearance_m, "{name}");
        }
        // Without a route there is none to watch, and none to replan.
        let to_goal = Stack::by_name("dwa-to-goal", &Robot::small()).unwrap().controller;
        assert!(!to_goal.watch_route && !to_goal.recoveries.contains(&RecoveryKind::Replan));
    }
}
