//! Tests which scenes can be driven, by a slow search over position and heading with the exact
//! footprint: every 4 cm and 6 degrees at first, and if that finds nothing, every 2 cm and 4
//! degrees, every centimetre and 2 degrees, and every 5 mm and 2 degrees. It shares no code with
//! the library except the readers of the scene file, its map and its robot, which must be a disc
//! or a rectangle.
//!
//! `cargo run --release -p keyway-lab --example possible_poses -- ROOM_M SCENE.toml...`
//!
//! It prints one line for each scene: `possible`, with the time of the path that was found,
//! without accelerations (it need not be the fastest one), `impossible`, or `unknown` if the
//! search would be too large. The robot keeps a clearance of `ROOM_M` from everything.

use keyway::files::robot_in_place;
use keyway::geometry::{Point, Pose};
use keyway::map::{Cell, OccupancyGrid};
use keyway::robot::{Footprint, Robot};
use keyway_sim::scene_files::SceneFile;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::error::Error;
use std::f64::consts::TAU;

/// Sides of the squares in which positions count as equal \[m\], and number of headings.
const LEVELS: [(f64, i32); 4] = [(0.04, 60), (0.02, 90), (0.01, 180), (0.005, 180)];
/// Distance between two collision checks along a motion \[m\].
const LOOK_M: f64 = 0.01;
const MOST_NODES: usize = 10_000_000;
const GOAL_TOLERANCE_M: f64 = 0.1;
const GOAL_TOLERANCE_RAD: f64 = 0.1;
/// Weight of the cost to go relative to the driven cost.
const GREED: f64 = 1.5;

/// The footprint in its own frame: x from `rear` to `ahead`, y up to `half` to both sides,
/// inflated by `round`, which is the whole radius of a disc.
struct Body {
    rear: f64,
    ahead: f64,
    half: f64,
    round: f64,
}

impl Body {
    fn of(footprint: &Footprint) -> Result<Self, Box<dyn Error>> {
        let vertices = match footprint {
            Footprint::Circle(circle) => {
                return Ok(Self { rear: 0.0, ahead: 0.0, half: 0.0, round: circle.radius_m() });
            }
            Footprint::Polygon(polygon) => polygon.vertices(),
        };
        let most = |of: fn(&Point) -> f64| vertices.iter().map(of).fold(f64::MIN, f64::max);
        let (ahead, rear, half) = (most(|at| at.x), -most(|at| -at.x), most(|at| at.y));
        let is_corner = |at: &Point| (at.x == ahead || at.x == rear) && at.y.abs() == half;
        if vertices.len() != 4 || !vertices.iter().all(is_corner) {
            return Err("the robot is neither a disc nor a rectangle".into());
        }
        Ok(Self { rear, ahead, half, round: 0.0 })
    }

    fn radius(&self) -> f64 {
        self.ahead.max(-self.rear).hypot(self.half) + self.round
    }

    fn inscribed(&self) -> f64 {
        self.ahead.min(-self.rear).min(self.half) + self.round
    }

    /// Distance to a square of this side with its centre at `x`, `y` in the frame of the
    /// footprint, rotated by the angle with this sine and cosine; 0 if they overlap.
    fn distance(&self, [x, y]: [f64; 2], [sin, cos]: [f64; 2], side: f64) -> f64 {
        let h = 0.5 * side;
        let corners = [[h, h], [-h, h], [-h, -h], [h, -h]]
            .map(|[u, v]| [x + u * cos - v * sin, y + u * sin + v * cos]);
        // From the corners of the square to the box, and from those of the box to the square.
        let outside = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let to_box = |[u, v]: [f64; 2]| {
            outside(u, self.rear, self.ahead).hypot(outside(v, -self.half, self.half))
        };
        let to_square = |[u, v]: [f64; 2]| {
            let (du, dv) = (u - x, v - y);
            outside(du * cos + dv * sin, -h, h).hypot(outside(dv * cos - du * sin, -h, h))
        };
        let own = [
            [self.rear, -self.half],
            [self.rear, self.half],
            [self.ahead, -self.half],
            [self.ahead, self.half],
        ];
        // Separating axes: those of the box, and those of the square.
        let span = |points: &[[f64; 2]; 4], [a, b]: [f64; 2]| {
            let along = points.map(|[u, v]| u * a + v * b);
            (
                along.iter().fold(f64::MAX, |m, &p| m.min(p)),
                along.iter().fold(f64::MIN, |m, &p| m.max(p)),
            )
        };
        let apart = [[1.0, 0.0], [0.0, 1.0], [cos, sin], [-sin, cos]].into_iter().any(|axis| {
            let (a, b) = (span(&corners, axis), span(&own, axis));
            a.0 > b.1 || b.0 > a.1
        });
        if !apart {
            return 0.0;
        }
        let nearest = corners.map(to_box).into_iter().chain(own.map(to_square));
        (nearest.fold(f64::MAX, f64::min) - self.round).max(0.0)
    }
}

struct World<'a> {
    grid: &'a OccupancyGrid,
    body: Body,
    room_m: f64,
    low: Point,
    cell_m: f64,
    size: [i32; 2],
    /// Distance from the centre of each cell to that of the nearest occupied one, in cells.
    far: Vec<f64>,
}

impl<'a> World<'a> {
    fn new(grid: &'a OccupancyGrid, body: Body, room_m: f64) -> Self {
        let frame = grid.frame();
        let size = [frame.width() as i32, frame.height() as i32];
        let mut world = Self {
            grid,
            body,
            room_m,
            low: frame.origin().point(),
            cell_m: frame.resolution_m(),
            size,
            far: Vec::new(),
        };
        let reach = (2.0 * world.body.radius() / world.cell_m).ceil() as i32 + 3;
        let occupied: Vec<(i32, i32)> = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .filter(|&(x, y)| world.is_occupied(x, y))
            .collect();
        let mut far = vec![f64::from(reach); (size[0] * size[1]) as usize];
        for (x, y) in occupied {
            // Cells inside walls are nearest to no free cell.
            let inside = |dx: i32, dy: i32| world.is_occupied(x + dx, y + dy);
            if inside(1, 0) && inside(-1, 0) && inside(0, 1) && inside(0, -1) {
                far[(y * size[0] + x) as usize] = 0.0;
                continue;
            }
            for ny in (y - reach).max(0)..(y + reach + 1).min(size[1]) {
                for nx in (x - reach).max(0)..(x + reach + 1).min(size[0]) {
                    let value = f64::from(nx - x).hypot(f64::from(ny - y));
                    let of = &mut far[(ny * size[0] + nx) as usize];
                    *of = of.min(value);
                }
            }
        }
        world.far = far;
        world
    }

    /// True also for cells outside the map.
    fn is_occupied(&self, x: i32, y: i32) -> bool {
        let is_inside = (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y);
        !is_inside || self.grid.occupied().get(Cell::new(x, y))
    }

    fn cell(&self, x: f64, y: f64) -> [i32; 2] {
        [
            ((x - self.low.x) / self.cell_m).floor() as i32,
            ((y - self.low.y) / self.cell_m).floor() as i32,
        ]
    }

    fn is_free(&self, x: f64, y: f64, theta: f64) -> bool {
        let [column, row] = self.cell(x, y);
        if self.is_occupied(column, row) {
            return false;
        }
        let radius = self.body.radius() + self.room_m;
        let reach = (radius / self.cell_m).ceil() as i32 + 1;
        let far = self.far[(row * self.size[0] + column) as usize];
        let to_edge = column.min(row).min(self.size[0] - 1 - column).min(self.size[1] - 1 - row);
        if (far - 2.0) * self.cell_m > radius && to_edge > reach {
            return true;
        }
        let (sin, cos) = theta.sin_cos();
        // No cell whose centre is farther away reaches the robot.
        let near_sq = (radius + 0.71 * self.cell_m).powi(2);
        for v in row - reach..=row + reach {
            for u in column - reach..=column + reach {
                if !self.is_occupied(u, v) {
                    continue;
                }
                let dx = self.low.x + (f64::from(u) + 0.5) * self.cell_m - x;
                let dy = self.low.y + (f64::from(v) + 0.5) * self.cell_m - y;
                if dx * dx + dy * dy > near_sq {
                    continue;
                }
                let at = [dx * cos + dy * sin, dy * cos - dx * sin];
                if self.body.distance(at, [-sin, cos], self.cell_m) <= self.room_m {
                    return false;
                }
            }
        }
        true
    }

    /// Cost to go from every cell for the inscribed disc \[m\].
    fn left_m(&self, goal: Point) -> Vec<f64> {
        let mut left = vec![f64::INFINITY; self.far.len()];
        let [x, y] = self.cell(goal.x, goal.y);
        let least = (self.body.inscribed() + self.room_m) / self.cell_m - 1.5;
        let mut open = BinaryHeap::from([Reverse((0_u64, x, y))]);
        while let Some(Reverse((bits, x, y))) = open.pop() {
            let value = f64::from_bits(bits);
            let index = (y * self.size[0] + x) as usize;
            if left[index] <= value {
                continue;
            }
            left[index] = value;
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)] {
                let (u, v) = (x + dx, y + dy);
                let is_free =
                    !self.is_occupied(u, v) && self.far[(v * self.size[0] + u) as usize] >= least;
                if is_free {
                    let step = f64::from(dx).hypot(f64::from(dy)) * self.cell_m;
                    open.push(Reverse(((value + step).to_bits(), u, v)));
                }
            }
        }
        left
    }
}

enum Found {
    Possible { time_s: f64 },
    Impossible,
    Unknown,
}

struct Node {
    x: f64,
    y: f64,
    /// Heading index, counted from that of the start.
    heading: i32,
    time_s: f64,
}

fn search(
    (world, left_m): (&World<'_>, &[f64]),
    robot: &Robot,
    start: Pose,
    (goal, heading): (Point, Option<f64>),
    (bin_m, headings): (f64, i32),
) -> Found {
    let [width, height] = world.size.map(|n| (f64::from(n) * world.cell_m / bin_m) as u64 + 1);
    let mut closed = vec![0_u64; (width * height * headings as u64 / 64 + 1) as usize];
    let step_rad = TAU / f64::from(headings);
    let limits = &robot.limits;
    let estimate = |node: &Node| {
        let [x, y] = world.cell(node.x, node.y);
        let left_m = left_m[(y * world.size[0] + x) as usize];
        let turn_rad = heading.map_or(0.0, |wanted| {
            let off = (start.theta + step_rad * f64::from(node.heading) - wanted).rem_euclid(TAU);
            off.min(TAU - off)
        });
        let left_s = (left_m / limits.v_max_mps).max(turn_rad / limits.omega_max_radps);
        (node.time_s + GREED * left_s).to_bits()
    };
    let mut nodes = vec![Node { x: start.x, y: start.y, heading: 0, time_s: 0.0 }];
    if !world.is_free(start.x, start.y, start.theta) {
        return Found::Impossible;
    }
    let mut open = BinaryHeap::from([Reverse((estimate(&nodes[0]), 0_usize))]);
    while let Some(Reverse((bits, index))) = open.pop() {
        if f64::from_bits(bits).is_infinite() {
            continue;
        }
        let Node { x, y, heading: at, time_s } = nodes[index];
        let theta = start.theta + step_rad * f64::from(at);
        let bin = |along: f64, low: f64| ((along - low) / bin_m) as u64;
        let place =
            (bin(y, world.low.y) * width + bin(x, world.low.x)) * headings as u64 + at as u64;
        let (word, bit) = ((place / 64) as usize, 1 << (place % 64));
        if closed[word] & bit != 0 {
            continue;
        }
        closed[word] |= bit;
        let is_there = (x - goal.x).hypot(y - goal.y) <= GOAL_TOLERANCE_M;
        let off_rad = heading.map_or(0.0, |wanted| {
            let off = (theta - wanted).rem_euclid(TAU);
            off.min(TAU - off)
        });
        if is_there && off_rad <= GOAL_TOLERANCE_RAD {
            return Found::Possible { time_s };
        }
        if nodes.len() > MOST_NODES {
            return Found::Unknown;
        }
        let (sin, cos) = theta.sin_cos();
        let from = (x, y, theta);
        let step_m = 1.5 * bin_m;
        let mut add = |x: f64, y: f64, heading: i32, took_s: f64| {
            let theta = start.theta + step_rad * f64::from(heading);
            let is_free = world.is_free(x, y, theta);
            // Checks the middle of the motion, and intermediate points.
            let looks = ((x - from.0).hypot(y - from.1) / LOOK_M).ceil().max(2.0);
            let is_free = is_free
                && (1..looks as u32).all(|look| {
                    let part = f64::from(look) / looks;
                    let turned = wrapped(theta - from.2);
                    let at = (from.0 + part * (x - from.0), from.1 + part * (y - from.1));
                    world.is_free(at.0, at.1, from.2 + part * turned)
                });
            if is_free {
                let node = Node { x, y, heading, time_s: time_s + took_s };
                open.push(Reverse((estimate(&node), nodes.len())));
                nodes.push(node);
            }
        };
        for turned in [1, -1] {
            add(x, y, (at + turned).rem_euclid(headings), step_rad / limits.omega_max_radps);
        }
        add(x + step_m * cos, y + step_m * sin, at, step_m / limits.v_max_mps);
        if limits.v_min_mps < 0.0 {
            add(x - step_m * cos, y - step_m * sin, at, -step_m / limits.v_min_mps);
        }
    }
    Found::Impossible
}

/// Wraps an angle to less than half a turn to either side.
fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let room_m: f64 =
        arguments.next().ok_or("usage: possible_poses ROOM_M SCENE.toml...")?.parse()?;
    for file in arguments {
        let scene = SceneFile::from_toml(&std::fs::read_to_string(&file)?)?;
        let robot = match Robot::by_name(&scene.robot) {
            Some(robot) => robot,
            None => robot_in_place(&scene.robot)?,
        };
        let (Some(map), Some(start), Some(goal)) = (&scene.world, scene.start, scene.goal) else {
            return Err(format!("{file}: not a scene of one robot in a generated world").into());
        };
        let grid = map.generate(scene.seed, &[start.position, goal.position])?;
        let world = World::new(&grid, Body::of(&robot.footprint)?, room_m);
        let start = Pose {
            x: start.position.x,
            y: start.position.y,
            theta: start.heading_rad.unwrap_or_default(),
        };
        let goal = (goal.position, goal.heading_rad);
        let left_m = world.left_m(goal.0);
        let mut found = Found::Unknown;
        for level in LEVELS {
            found = search((&world, &left_m), &robot, start, goal, level);
            if matches!(found, Found::Possible { .. }) {
                break;
            }
        }
        match found {
            Found::Possible { time_s } => println!("{file} possible {time_s:.2}"),
            Found::Impossible => println!("{file} impossible"),
            Found::Unknown => println!("{file} unknown"),
        }
    }
    Ok(())
}
