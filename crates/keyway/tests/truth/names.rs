//! The self-description of planners.

use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{
    AStarConfig, BidirectionalOptimalConfig, DijkstraConfig, Heuristic, PathCost, PlannerConfig,
};
use keyway::search::CornerRule;

#[test]
fn names_lead_to_planners_and_back() {
    let grid = OccupancyGrid::from_ascii(&["..."]);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    for name in PlannerConfig::NAMES {
        let config = PlannerConfig::by_name(name).unwrap();
        assert_eq!((config.name(), config.build(&map).unwrap().name()), (name, name));
        let json = serde_json::to_value(&config).unwrap();
        assert_eq!(json["name"], name);
        assert_eq!(serde_json::from_value::<PlannerConfig>(json.clone()).unwrap(), config);
        // Parameters have defaults, and only existing ones can be set.
        let bare = serde_json::json!({ "name": name });
        assert_eq!(serde_json::from_value::<PlannerConfig>(bare).unwrap(), config);
        let wrong = serde_json::json!({ "name": name, "hueristic": "octile" });
        assert!(serde_json::from_value::<PlannerConfig>(wrong).is_err(), "{name}");
    }
    assert!(PlannerConfig::by_name("a-star").is_none());
}

#[test]
fn only_shortest_paths_without_cutting_are_called_optimal() {
    let names = PlannerConfig::NAMES.into_iter();
    let optimal: Vec<&str> =
        names.filter(|name| PlannerConfig::by_name(name).unwrap().is_optimal()).collect();
    for name in ["dijkstra", "astar", "bidirectional-optimal", "jps", "prepared"] {
        assert!(optimal.contains(&name), "{name}");
    }
    assert_eq!(optimal.len(), 5, "{optimal:?}");
    for name in ["greedy", "astar4"] {
        assert!(!optimal.contains(&name), "{name}");
    }
    let astar = |heuristic, g| {
        let corners = CornerRule::Forbid;
        PlannerConfig::AStar(AStarConfig { corners, heuristic, g }).is_optimal()
    };
    assert!(astar(Heuristic::Euclidean, PathCost::Accumulated));
    assert!(!astar(Heuristic::Manhattan, PathCost::Accumulated));
    assert!(!astar(Heuristic::Mean, PathCost::Accumulated));
    assert!(!astar(Heuristic::Octile, PathCost::StraightLine));
    let corners = CornerRule::Allow;
    assert!(!PlannerConfig::AStar(AStarConfig { corners, ..AStarConfig::default() }).is_optimal());
    assert!(!PlannerConfig::Dijkstra(DijkstraConfig { corners }).is_optimal());
    let bidirectional = BidirectionalOptimalConfig { corners };
    assert!(!PlannerConfig::BidirectionalOptimal(bidirectional).is_optimal());
}

#[test]
fn parameters_are_plain_words() {
    let text =
        r#"{ "name": "astar", "corners": "allow", "heuristic": "mean", "g": "straight-line" }"#;
    let expected = AStarConfig {
        corners: CornerRule::Allow,
        heuristic: Heuristic::Mean,
        g: PathCost::StraightLine,
    };
    assert_eq!(
        serde_json::from_str::<PlannerConfig>(text).unwrap(),
        PlannerConfig::AStar(expected)
    );
}
