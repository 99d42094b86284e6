//! A planner whose memory is warm allocates nothing, for any query.
#![allow(clippy::unwrap_used)]

use keyway::geometry::Pose;
use keyway::map::{
    Cell, CellState, Connectivity, GridFrame, LayerConfig, OccupancyGrid, SearchMap,
};
use keyway::plan::{GlobalPlanner, HstaConfig, IfNoPath, Plan, PlannerConfig};
use keyway::search::{IfUnreachable, Query, Workspace};

const WIDTH: i32 = 150;
const HEIGHT: i32 = 90;

/// Scattered obstacles, and a closed room around (100, 40).
fn map() -> SearchMap {
    let frame = GridFrame::new(WIDTH as u64, HEIGHT as u64, 1.0, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |Cell { x, y }| {
        let is_wall = (x - 100).abs().max((y - 40).abs()) == 8;
        let is_scattered = (x * 7919 + y * 104_729) % 11 == 0 && x % 9 > 1 && y % 7 > 1;
        if is_wall || is_scattered { CellState::Occupied } else { CellState::Free }
    });
    SearchMap::new(&grid, LayerConfig::default()).unwrap()
}

/// From each corner to each other one, into and out of the closed room, and into a wall.
fn long_queries(map: &SearchMap) -> Vec<Query> {
    let corners = [(0, 0), (WIDTH - 1, 0), (0, HEIGHT - 1), (WIDTH - 1, HEIGHT - 1), (100, 40)];
    let free = |(x, y)| map.nearest_free(Cell::new(x, y)).unwrap();
    let ends = corners.iter().flat_map(|&a| corners.iter().map(move |&b| (a, b)));
    let mut queries: Vec<Query> = ends.map(|(a, b)| Query::new(free(a), free(b))).collect();
    queries.push(Query::new(free((0, 0)), Cell::new(100, 48)));
    let nearest =
        |query: &Query| Query { if_unreachable: IfUnreachable::NearestReachable, ..*query };
    let replaced: Vec<Query> = queries.iter().map(nearest).collect();
    queries.extend(replaced);
    queries
}

fn short_queries(map: &SearchMap) -> Vec<Query> {
    let free = |x, y| map.nearest_free(Cell::new(x, y)).unwrap();
    (0..60).map(|i| Query::new(free(i * 2, i), free(i * 2 + 11 - i % 23, i + i % 7))).collect()
}

fn planner(name: &str, map: &SearchMap) -> Box<dyn GlobalPlanner + Send + Sync> {
    let config = match PlannerConfig::by_name(name).unwrap() {
        // The map's lanes are narrow: without this, no path would exist.
        PlannerConfig::Hsta(config) => {
            PlannerConfig::Hsta(HstaConfig { if_no_path: IfNoPath::Relax, ..config })
        }
        config => config,
    };
    config.build(map).unwrap()
}

#[test]
fn warm_planners_allocate_nothing() {
    let map = map();
    map.components(Connectivity::Four);
    let (long, short) = (long_queries(&map), short_queries(&map));
    for name in PlannerConfig::NAMES {
        let planner = planner(name, &map);
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        let mut run = |queries: &[Query]| {
            let mut found = 0;
            let info = allocation_counter::measure(|| {
                for query in queries {
                    let result = planner.plan_into(&map, query, &mut workspace, None, &mut plan);
                    found += u32::from(result.is_ok());
                }
            });
            (found, info.count_total)
        };
        let (found, first) = run(&long);
        assert!(found > 30, "{name} found {found} paths");
        assert!(first > 0, "{name}: the counter sees the first queries");
        assert_eq!(run(&long), (found, 0), "{name}, the same queries again");
        assert_eq!(run(&short).1, 0, "{name}, shorter queries");
    }
}

/// Planners that take turns on one workspace leave each other's memory alone, and find the same
/// paths as on their own.
#[test]
fn planners_share_a_workspace() {
    let map = map();
    map.components(Connectivity::Four);
    let queries = short_queries(&map);
    let planners = PlannerConfig::NAMES.map(|name| planner(name, &map));
    let (mut shared, mut plan) = (Workspace::default(), Plan::default());
    let mut run = || {
        let mut costs = Vec::with_capacity(planners.len() * queries.len());
        let info = allocation_counter::measure(|| {
            for query in &queries {
                for planner in &planners {
                    let result = planner.plan_into(&map, query, &mut shared, None, &mut plan);
                    costs.push(result.ok().map(|()| (plan.cost, plan.statistics)));
                }
            }
        });
        (costs, info.count_total)
    };
    let (first, allocations) = run();
    assert!(allocations > 0 && first.iter().flatten().count() > 500);
    assert_eq!(run(), (first.clone(), 0), "warm");
    let on_their_own = queries.iter().flat_map(|query| {
        planners.iter().map(|planner| {
            let mut plan = Plan::default();
            let result = planner.plan_into(&map, query, &mut Workspace::default(), None, &mut plan);
            result.ok().map(|()| (plan.cost, plan.statistics))
        })
    });
    assert!(on_their_own.eq(first));
}

#[test]
fn a_warmed_up_search_allocates_nothing_in_its_first_query() {
    let map = map();
    let jps = planner("jps", &map);
    let queries = short_queries(&map);
    let allocated_by_first = |is_warm: bool| {
        let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
        plan.cells.reserve(1000);
        plan.jump_points.reserve(1000);
        if is_warm {
            jps.warm_up(&map, &mut workspace);
        }
        let info = allocation_counter::measure(|| {
            jps.plan_into(&map, &queries[5], &mut workspace, None, &mut plan).unwrap();
        });
        assert!(plan.cells.len() > 1);
        info.count_total
    };
    assert!(allocated_by_first(false) > 0);
    assert_eq!(allocated_by_first(true), 0);
}
