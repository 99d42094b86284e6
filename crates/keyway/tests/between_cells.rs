//! Routes between the centres of cells, compared with brute force over obstacle squares.
#![allow(clippy::unwrap_used)]

#[path = "support/driving.rs"]
mod driving;

use driving::bound_for;
use keyway::geometry::{Path, PathSample, Point, Pose};
use keyway::map::{Cell, CellState, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::AStar;
use keyway::random::Random;
use keyway::robot::{Footprint, Robot};
use keyway::route::{
    BetweenCells, EndRule, Route, RouteQuery, looser_clearance_m, plan_between_cells, plan_route,
};
use keyway::search::Workspace;
use keyway::smooth::Taut;

/// The occupied squares of a map, and its size.
struct Squares {
    frame: GridFrame,
    cells: Vec<Cell>,
}

impl Squares {
    fn of(grid: &OccupancyGrid) -> Self {
        let frame = *grid.frame();
        let cells = frame.cells().filter(|&cell| grid.occupied().get(cell)).collect();
        Self { frame, cells }
    }

    /// Distance from a point to the nearest square or the border \[m\], tested one by one.
    fn room_at(&self, world: Point) -> f64 {
        let at = self.frame.grid_from_world(world);
        let (width, height) = (f64::from(self.frame.width()), f64::from(self.frame.height()));
        let border = at.x.min(at.y).min(width - at.x).min(height - at.y);
        let outside =
            |at: f64, low: i32| (f64::from(low) - at).max(at - f64::from(low) - 1.0).max(0.0);
        let distance_sq =
            |cell: &Cell| outside(at.x, cell.x).powi(2) + outside(at.y, cell.y).powi(2);
        let nearest_sq = self.cells.iter().map(distance_sq).fold(f64::INFINITY, f64::min);
        border.min(nearest_sq.sqrt()) * self.frame.resolution_m()
    }
}

/// The least clearance along a route, on its path and on its chords.
fn room_along(grid: &OccupancyGrid, route: &Route) -> f64 {
    let squares = Squares::of(grid);
    let step_m = 0.02 * grid.frame().resolution_m();
    let samples = route.smoothing.path.samples(step_m);
    let of_path = samples.iter().map(PathSample::position);
    let chords = Path::from(&route.smoothed).samples(step_m);
    let of_chords = chords.iter().map(PathSample::position);
    of_path.chain(of_chords).map(|at| squares.room_at(at)).fold(f64::INFINITY, f64::min)
}

fn planned(grid: &OccupancyGrid, clearance_m: f64, query: &RouteQuery) -> Option<Route> {
    let looser_m = looser_clearance_m(grid.frame(), clearance_m);
    let config = LayerConfig { clearance_m: looser_m, ..LayerConfig::default() };
    let mut looser = SearchMap::new(grid, config).unwrap();
    let before = looser.blocked().clone();
    let (planner, mut workspace) = (AStar::default(), Workspace::default());
    let route = plan_between_cells(
        &mut looser,
        BetweenCells { clearance_m, attempts: 16 },
        &planner,
        &Taut,
        query,
        &mut workspace,
        &mut (),
    );
    assert_eq!(looser.blocked(), &before, "all cells are open again");
    route
}

/// Clearance at points that are an eighth of a cell apart.
struct FinePoints {
    frame: GridFrame,
    rooms: Vec<f64>,
    size: [i32; 2],
}

impl FinePoints {
    const PER_CELL: i32 = 8;

    fn of(grid: &OccupancyGrid) -> Self {
        let (frame, squares) = (*grid.frame(), Squares::of(grid));
        let size = [frame.width(), frame.height()].map(|cells| cells as i32 * Self::PER_CELL + 1);
        let mut points = Self { frame, rooms: Vec::new(), size };
        let all = (0..size[0] * size[1]).map(|index| points.place(index as usize));
        points.rooms = all.map(|at| squares.room_at(frame.world_from_grid(at))).collect();
        points
    }

    fn place(&self, index: usize) -> Point {
        let (x, y) = (index as i32 % self.size[0], index as i32 / self.size[0]);
        Point::new(f64::from(x), f64::from(y)) * (1.0 / f64::from(Self::PER_CELL))
    }

    /// Two flags: true if a disc can certainly go from one point to the other; true if it
    /// certainly cannot.
    fn joins(&self, radius_m: f64, ends: [Point; 2]) -> [bool; 2] {
        let half = 0.5 * std::f64::consts::SQRT_2 / f64::from(Self::PER_CELL);
        let (half_m, radius_m) = (half * self.frame.resolution_m(), radius_m);
        let bend_m = 0.02 * self.frame.resolution_m();
        [
            self.reaches(ends, radius_m + half_m + bend_m, half),
            !self.reaches(ends, radius_m - half_m, 2.0 * half),
        ]
    }

    /// True if points with this clearance lead from near one position to near the other.
    fn reaches(&self, ends: [Point; 2], least_m: f64, near: f64) -> bool {
        let [start, goal] = ends.map(|end| self.frame.grid_from_world(end));
        let is_open = |index: usize| self.rooms[index] >= least_m;
        let all = 0..self.rooms.len();
        let mut open: Vec<usize> =
            all.filter(|&i| is_open(i) && self.place(i).distance(start) <= near).collect();
        let mut seen = vec![false; self.rooms.len()];
        let [width, height] = self.size;
        while let Some(index) = open.pop() {
            if std::mem::replace(&mut seen[index], true) {
                continue;
            }
            if self.place(index).distance(goal) <= near {
                return true;
            }
            let (x, y) = (index as i32 % width, index as i32 / width);
            let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
            let inside =
                beside.filter(|&(x, y)| (0..width).contains(&x) && (0..height).contains(&y));
            open.extend(inside.map(|(x, y)| (y * width + x) as usize).filter(|&i| is_open(i)));
        }
        false
    }
}

/// Map, radius, start and goal for which no path of cells exists, by seed; few seeds have one.
fn random_case(seed: u64, radii: [f64; 2]) -> Option<(OccupancyGrid, f64, RouteQuery)> {
    const SIDE: u32 = 16;
    let mut random = Random::new(seed);
    let density = random.between([0.03, 0.15]);
    let frame = GridFrame::new(SIDE.into(), SIDE.into(), 1.0, Pose::new(3.0, -2.0, 0.7)).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |_| {
        if random.is_chosen(density) { CellState::Occupied } else { CellState::Free }
    });
    let radius = random.between(radii);
    let squares = Squares::of(&grid);
    let mut end = || {
        let place = |_| Point::new(random.unit(), random.unit()) * f64::from(SIDE);
        let mut places = (0..50).map(place).map(|at| frame.world_from_grid(at));
        places.find(|&at| squares.room_at(at) >= radius)
    };
    let (start, goal) = (end()?, end()?);
    let ends = EndRule::NearestFree { radius_m: radius };
    let query = RouteQuery { ends, ..RouteQuery::new(start, goal) };
    on_cells(&grid, radius, &query).is_none().then_some((grid, radius, query))
}

fn on_cells(grid: &OccupancyGrid, clearance_m: f64, query: &RouteQuery) -> Option<Route> {
    let map = SearchMap::new(grid, LayerConfig { clearance_m, ..LayerConfig::default() }).unwrap();
    let mut workspace = Workspace::default();
    plan_route(&map, &AStar::default(), &Taut, query, &mut workspace, &mut ()).ok()
}

#[test]
fn random_maps_have_a_route_where_a_disc_can_go_and_nowhere_else() {
    let (mut possible, mut impossible) = (0, 0);
    for seed in 0..600 {
        let Some((grid, radius, query)) = random_case(seed, [1.0, 2.2]) else { continue };
        let route = planned(&grid, radius, &query);
        let [yes, no] = FinePoints::of(&grid).joins(radius, [query.start, query.goal]);
        assert!(!yes || route.is_some(), "seed {seed}: missed");
        assert!(!no || route.is_none(), "seed {seed}: found");
        possible += u32::from(yes);
        impossible += u32::from(no);
        let Some(route) = route else { continue };
        let points = route.smoothed.points();
        assert_eq!((points[0], points.last()), (query.start, Some(&query.goal)));
        let room = room_along(&grid, &route);
        assert!(room >= radius - 1e-9, "seed {seed}: {room} < {radius}");
    }
    assert!(possible > 15 && impossible > 100, "{possible} {impossible}");
}

/// A wall between two halls, with a tunnel that is four cells wide: from y = 3 m to 7 m.
fn tunnel() -> OccupancyGrid {
    let frame = GridFrame::new(16, 10, 1.0, Pose::default()).unwrap();
    OccupancyGrid::from_fn(frame, |cell| {
        let is_wall = (5..11).contains(&cell.x) && !(3..7).contains(&cell.y);
        if is_wall { CellState::Occupied } else { CellState::Free }
    })
}

#[test]
fn a_tunnel_of_an_even_number_of_cells_is_passed_along_its_middle() {
    let grid = tunnel();
    let query = RouteQuery::new(Point::new(2.5, 5.2), Point::new(13.5, 4.7));
    for radius in [1.6, 1.9, 1.98] {
        assert_eq!(on_cells(&grid, radius, &query), None);
        let route = planned(&grid, radius, &query).unwrap();
        assert!(room_along(&grid, &route) >= radius && route.clearance_m >= radius);
        let samples = route.smoothing.path.samples(0.1);
        let inside = samples.iter().filter(|sample| (5.0..11.0).contains(&sample.x_m));
        assert!(inside.map(|sample| sample.y_m).all(|y| (y - 5.0).abs() <= 0.06));
    }
    assert_eq!(planned(&grid, 2.01, &query), None, "too narrow");
}

#[test]
fn a_route_begins_and_ends_in_the_middle_between_two_rows() {
    let grid = tunnel();
    let ends = EndRule::NearestFree { radius_m: 1.9 };
    for (start, goal) in
        [([6.5, 5.0], [13.0, 5.0]), ([2.0, 5.0], [9.0, 5.05]), ([6.2, 4.95], [9.0, 5.05])]
    {
        let query = RouteQuery { ends, ..RouteQuery::new(start.into(), goal.into()) };
        assert_eq!(on_cells(&grid, 1.9, &query), None);
        let route = planned(&grid, 1.9, &query).unwrap();
        assert!(room_along(&grid, &route) >= 1.9 - 1e-9);
        // With the other rule the centres of their cells count, and start and goal must have
        // clearance.
        let own = RouteQuery { ends: EndRule::OwnCell, ..query };
        assert!(planned(&grid, 1.9, &own).is_some());
    }
    let beside = RouteQuery::new(Point::new(6.5, 5.2), Point::new(13.0, 5.0));
    assert_eq!(planned(&grid, 1.9, &beside), None, "1.8 m from the wall");
}

/// Walls along the outside of a bend by a right angle, four cells wide.
#[test]
fn a_bend_is_passed_along_its_middle() {
    let frame = GridFrame::new(20, 20, 0.05, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| {
        let is_free =
            (8..12).contains(&cell.x) && cell.y < 12 || (8..12).contains(&cell.y) && cell.x >= 8;
        if is_free { CellState::Free } else { CellState::Occupied }
    });
    let query = RouteQuery::new(Point::new(0.5, 0.15), Point::new(0.85, 0.5));
    assert_eq!(on_cells(&grid, 0.095, &query), None);
    let route = planned(&grid, 0.095, &query).unwrap();
    assert!(room_along(&grid, &route) >= 0.095);
    assert_eq!(planned(&grid, 0.1001, &query), None, "too narrow");
}

/// A straight tunnel across the cells' rows.
#[test]
fn a_slanted_tunnel_is_passed_as_far_as_it_is_wide() {
    let mut found = 0;
    for degrees in [7, 20, 31, 45, 64] {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let frame = GridFrame::new(24, 24, 1.0, Pose::default()).unwrap();
        let middle = Point::new(12.0, 12.0);
        let grid = OccupancyGrid::from_fn(frame, |cell| {
            let off = frame.world_from_cell(cell) - middle;
            let (along, across) = (off.x * cos + off.y * sin, off.y * cos - off.x * sin);
            let is_wall = along.abs() < 4.0 && across.abs() > 2.6;
            if is_wall { CellState::Occupied } else { CellState::Free }
        });
        let away = Point::new(cos, sin) * 8.0;
        let query = RouteQuery::new(middle - away, middle + away);
        let points = FinePoints::of(&grid);
        for radius in [1.8, 1.9, 2.0, 2.1, 2.2, 2.3, 2.4] {
            if on_cells(&grid, radius, &query).is_some() {
                continue;
            }
            let [yes, no] = points.joins(radius, [query.start, query.goal]);
            let route = planned(&grid, radius, &query);
            assert!((!yes || route.is_some()) && (!no || route.is_none()), "{degrees} {radius}");
            let Some(route) = route else { continue };
            assert!(room_along(&grid, &route) >= radius, "{degrees} {radius}");
            found += 1;
        }
    }
    assert!(found >= 5, "{found}");
}

/// The robot's own routes: the first one, and one from its current position.
#[test]
fn a_navigator_leads_between_the_cells_only_where_no_path_of_cells_does() {
    let footprint = Footprint::circle(0.22).unwrap();
    let robot = Robot { footprint, safety_margin_m: Some(0.02), ..Robot::small() };
    let stack = Stack::keyway(&robot);
    let fitted = stack.fit(&robot).unwrap();
    let needed_m = stack.controller.least_clearance_m;
    assert!((needed_m - 0.24).abs() < 1e-9, "4.8 cells");
    let grid = |odd: i32| {
        let frame = GridFrame::new(100, 60, 0.05, Pose::default()).unwrap();
        let lane = 25..35 + odd;
        OccupancyGrid::from_fn(frame, |cell| {
            let is_wall = (40..60).contains(&cell.x) && !lane.contains(&cell.y);
            if is_wall { CellState::Occupied } else { CellState::Free }
        })
    };
    let (start, goal) = (Point::new(0.8, 1.5), Point::new(4.2, 1.5));
    for (odd, is_on_cells) in [(0, false), (1, true)] {
        let grid = grid(odd);
        let ends = EndRule::NearestFree { radius_m: 0.22 };
        let query = RouteQuery { ends, ..RouteQuery::new(start, goal) };
        let least =
            SearchMap::new(&grid, LayerConfig { clearance_m: needed_m, ..stack.map.clone() });
        let least = least.unwrap();
        let planner = stack.planner.build(&least).unwrap();
        let mut workspace = Workspace::default();
        let on_cells = plan_route(&least, &*planner, &Taut, &query, &mut workspace, &mut ());
        assert_eq!(on_cells.is_ok(), is_on_cells);
        let mut navigator = bound_for(&grid, &fitted, start, goal).unwrap();
        let first = navigator.route().unwrap().clone();
        if is_on_cells {
            continue;
        }
        assert!(room_along(&grid, &first) >= needed_m);
        assert_eq!(navigator.plan(start, goal).unwrap(), first);
        // From inside, the rule for start and goal applies: straight, if the disc fits.
        let from = Point::new(2.5, 1.5);
        for to in [goal, Point::new(2.2, 1.5)] {
            let inside = navigator.plan(from, to).unwrap();
            assert!(room_along(&grid, &inside) >= 0.22 - 1e-9);
            let first = bound_for(&grid, &fitted, from, to).unwrap();
            assert!(room_along(&grid, first.route().unwrap()) >= 0.22 - 1e-9);
        }
    }
}
