//! Routes between the centres of cells, compared with brute force over obstacle squares.

use keyway::geometry::{Path, Point, Pose};
use keyway::map::{GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::AStar;
use keyway::random::Random;
use keyway::route::{
    EndRule, Route, RouteQuery, looser_clearance_m, plan_between_cells, plan_route,
};
use keyway::search::Workspace;
use keyway::smooth::Taut;

/// Distance from a point to the nearest occupied square or the border, cell by cell.
fn room_at(grid: &OccupancyGrid, world: Point) -> f64 {
    let frame = grid.frame();
    let at = frame.grid_from_world(world);
    let (width, height) = (f64::from(frame.width()), f64::from(frame.height()));
    let border = at.x.min(at.y).min(width - at.x).min(height - at.y);
    let occupied = frame.cells().filter(|&cell| grid.occupied().get(cell));
    let outside = |at: f64, low: i32| (f64::from(low) - at).max(at - f64::from(low) - 1.0).max(0.0);
    let distances = occupied.map(|cell| outside(at.x, cell.x).hypot(outside(at.y, cell.y)));
    distances.fold(border, f64::min) * frame.resolution_m()
}

/// The least room along a route, on its path and on its chords.
fn room_along(grid: &OccupancyGrid, route: &Route) -> f64 {
    let step_m = 0.02 * grid.frame().resolution_m();
    let samples = route.smoothing.path.samples(step_m);
    let of_path = samples.iter().map(|sample| sample.point);
    let chords = Path::from(&route.smoothed).samples(step_m);
    let of_chords = chords.iter().map(|sample| sample.point);
    of_path.chain(of_chords).map(|at| room_at(grid, at)).fold(f64::INFINITY, f64::min)
}

fn planned(grid: &OccupancyGrid, clearance_m: f64, query: &RouteQuery) -> Option<Route> {
    let looser_m = looser_clearance_m(grid.frame(), clearance_m);
    let config = LayerConfig { clearance_m: looser_m, ..LayerConfig::default() };
    let mut looser = SearchMap::new(grid, config).unwrap();
    let before = looser.blocked().clone();
    let (planner, mut workspace) = (AStar::default(), Workspace::default());
    let route = plan_between_cells(
        &mut looser,
        clearance_m,
        &planner,
        &Taut,
        query,
        &mut workspace,
        &mut (),
    );
    assert_eq!(looser.blocked(), &before, "all cells are open again");
    route
}

/// Which of two points in a random map can be joined by a disc: certainly, certainly not. By points
/// that are an eighth of a cell apart.
fn joined(grid: &OccupancyGrid, radius: f64, ends: [Point; 2]) -> [bool; 2] {
    const PER_CELL: i32 = 8;
    let frame = grid.frame();
    let (width, height) = (frame.width() as i32 * PER_CELL, frame.height() as i32 * PER_CELL);
    let place =
        |x: i32, y: i32| Point::new(f64::from(x), f64::from(y)) * (1.0 / f64::from(PER_CELL));
    let rooms: Vec<f64> = (0..=height)
        .flat_map(|y| (0..=width).map(move |x| (x, y)))
        .map(|(x, y)| room_at(grid, frame.world_from_grid(place(x, y))))
        .collect();
    let reaches = |least: f64, near: f64| {
        let mut seen = vec![false; rooms.len()];
        let index = |x: i32, y: i32| (y * (width + 1) + x) as usize;
        let around = |end: Point| {
            let at = frame.grid_from_world(end);
            (0..=height)
                .flat_map(|y| (0..=width).map(move |x| (x, y)))
                .filter(move |&(x, y)| place(x, y).distance(at) <= near)
        };
        let mut open: Vec<(i32, i32)> =
            around(ends[0]).filter(|&(x, y)| rooms[index(x, y)] >= least).collect();
        while let Some((x, y)) = open.pop() {
            if std::mem::replace(&mut seen[index(x, y)], true) {
                continue;
            }
            let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
            open.extend(beside.filter(|&(x, y)| {
                (0..=width).contains(&x) && (0..=height).contains(&y) && rooms[index(x, y)] >= least
            }));
        }
        around(ends[1]).any(|(x, y)| seen[index(x, y)])
    };
    let half = 0.5 * std::f64::consts::SQRT_2 / f64::from(PER_CELL);
    [reaches(radius + half + 0.02, half), !reaches(radius - half, 2.0 * half)]
}

#[test]
fn explore() {
    let mut random = Random::new(7);
    let (mut certain, mut found, mut missed, mut wrong, mut open, mut worst) =
        (0, 0, 0, 0, 0, 0.0f64);
    for round in 0..1000 {
        let size = 16_u32;
        let density = 0.03 + 0.12 * random.unit();
        let occupied: Vec<bool> = (0..size * size).map(|_| random.is_chosen(density)).collect();
        let frame = GridFrame::new(size, size, 1.0, Pose::new(0.0, 0.0, 0.0)).unwrap();
        let grid = OccupancyGrid::from_occupied(frame, &occupied);
        let radius = 0.7 + 1.5 * random.unit();
        let mut end = || {
            (0..50)
                .map(|_| {
                    Point::new(random.unit() * f64::from(size), random.unit() * f64::from(size))
                })
                .find(|&at| room_at(&grid, at) >= radius)
        };
        let (Some(start), Some(goal)) = (end(), end()) else { continue };
        let config = LayerConfig { clearance_m: radius, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let ends = EndRule::NearestFree { radius_m: radius };
        let query = RouteQuery { ends, ..RouteQuery::new(start, goal) };
        if plan_route(&map, &AStar::default(), &Taut, &query, &mut Workspace::default(), &mut ())
            .is_ok()
        {
            continue;
        }
        let [yes, no] = joined(&grid, radius, [start, goal]);
        let route = planned(&grid, radius, &query);
        if let Some(route) = &route {
            found += 1;
            worst = worst.max(radius - room_along(&grid, route));
            if no {
                wrong += 1;
            }
        } else if yes {
            missed += 1;
            if missed < 6 {
                println!("missed {round} r {radius} {start:?} {goal:?}");
            }
        } else if !no {
            open += 1;
        }
        if yes {
            certain += 1;
        }
    }
    println!(
        "certain {certain} found {found} missed {missed} wrong {wrong} open {open} worst {worst}"
    );
}
