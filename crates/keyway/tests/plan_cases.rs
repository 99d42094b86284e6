//! The cases of `testdata/plan`, which every front end of the library runs as well.
#![allow(clippy::unwrap_used)]

use keyway::map::{Cell, Connectivity, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{AStarConfig, Plan, PlanError, PlannerConfig};
use keyway::search::{CornerRule, Cost, Query, Workspace};
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
struct Cases {
    case: Vec<Case>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    map: String,
    start: [i32; 2],
    goal: [i32; 2],
    #[serde(default)]
    corners: CornerRule,
    /// Straight and diagonal steps of the cheapest path; `None`: there is none.
    cost: Option<[u64; 2]>,
    #[serde(default)]
    missed_by: Vec<String>,
}

fn cases() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/plan");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let cases = files.flat_map(|path| {
        let text = std::fs::read_to_string(path).unwrap();
        toml::from_str::<Cases>(&text).unwrap().case
    });
    cases.collect()
}

impl Case {
    fn search_map(&self) -> SearchMap {
        let rows: Vec<&str> = self.map.lines().collect();
        SearchMap::new(&OccupancyGrid::from_ascii(&rows), LayerConfig::default()).unwrap()
    }

    /// True if a planner passes between two blocked cells that share a corner.
    fn cuts_corners(&self, planner: &PlannerConfig) -> bool {
        planner.build(&self.search_map()).unwrap().connectivity() == Connectivity::Eight
    }

    fn plan(&self, planner: &PlannerConfig) -> Result<Plan, PlanError> {
        let map = self.search_map();
        let [start, goal] = [self.start, self.goal].map(|[x, y]| Cell::new(x, y));
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let planner = planner.build(&map)?;
        let query = Query::new(start, goal);
        planner.plan_into(&map, &query, &mut workspace, None, &mut plan).map(|()| plan)
    }

    /// Checks that an answer is no better than the truth, and no worse if the planner claims to be
    /// optimal.
    fn check(&self, planner: &PlannerConfig) {
        let about = format!("{}, {}\n{}", self.name, planner.name(), self.map);
        let optimum = self.cost.map(|[straight, diagonal]| Cost::new(straight, diagonal).cells());
        let may_miss = self.missed_by.iter().any(|name| name == planner.name());
        match (self.plan(planner), optimum) {
            (Ok(plan), Some(optimum)) => {
                let longer = plan.cost.cells() - optimum;
                assert!(longer > -1e-9 || !planner.is_optimal(), "{longer}: {about}");
                assert!(longer < 1e-9 || !planner.is_optimal(), "{longer}: {about}");
            }
            (Err(PlanError::NoPath { .. }), None) => {}
            (Err(PlanError::Missed { .. } | PlanError::Constrained { .. }), Some(_))
                if may_miss => {}
            (answer, _) => panic!("{answer:?}: {about}"),
        }
    }
}

#[test]
fn every_planner_gives_what_the_cases_say() {
    let cases = cases();
    assert!(cases.len() >= 14, "{} cases", cases.len());
    for case in cases {
        if case.corners == CornerRule::Allow {
            let config = AStarConfig { corners: CornerRule::Allow, ..AStarConfig::default() };
            let cost = case.plan(&PlannerConfig::AStar(config)).unwrap().cost;
            assert_eq!(cost.steps(), case.cost.map(|[s, d]| Cost::new(s, d)), "{}", case.name);
            continue;
        }
        let planners = PlannerConfig::NAMES.map(|name| PlannerConfig::by_name(name).unwrap());
        // The others have rules of their own, and other cheapest paths.
        let planners = planners.iter().filter(|planner| !case.cuts_corners(planner));
        let count = planners.inspect(|planner| case.check(planner)).count();
        assert!(count > 12, "{count} planners");
    }
}
