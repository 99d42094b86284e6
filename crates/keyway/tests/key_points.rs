//! The jump points of a plan, and the key-point optimisation of [You2021] written out step by
//! step, as slowly as in the paper, with integers in place of the library's geometry.
#![allow(clippy::unwrap_used)]

mod support;

use keyway::geometry::{Path, Point, Polyline};
use keyway::map::{Cell, SearchMap};
use keyway::plan::{BidirectionalJpsConfig, JumpMeeting, Plan, PlannerConfig};
use keyway::search::{Observer, Query, Side, Workspace};
use keyway::smooth::{KeyPointCandidates, KeyPointSmoothingConfig, SmootherConfig};
use proptest::prelude::*;
use std::collections::HashMap;
use support::{Raw, Rules, query_on};

/// Records the parent of each node, and the node at which the sides met.
#[derive(Default)]
struct Parents {
    parents: HashMap<(bool, Cell), (f64, Cell)>,
    met: Option<Cell>,
}

impl Observer for Parents {
    fn generated(&mut self, side: Side, at: Cell, parent: Cell, g_cells: f64) {
        let known = self.parents.entry((side == Side::Forward, at)).or_insert((g_cells, parent));
        // A path of the same length is another direction of arrival, not another parent.
        if g_cells < known.0 {
            *known = (g_cells, parent);
        }
    }

    fn met(&mut self, at: Cell) {
        self.met = Some(at);
    }
}

impl Parents {
    /// The nodes from one on back to the root.
    fn way_back(&self, is_forward: bool, from: Cell, root: Cell) -> Vec<Cell> {
        let mut way = vec![from];
        while way[way.len() - 1] != root {
            way.push(self.parents[&(is_forward, way[way.len() - 1])].1);
        }
        way
    }

    /// The nodes of a two-sided search on its path.
    fn nodes_of_both_sides(&self, query: &Query) -> Vec<Cell> {
        let met = self.met.unwrap_or(query.goal);
        let mut nodes = self.way_back(true, met, query.start);
        nodes.reverse();
        nodes.extend(&self.way_back(false, met, query.goal)[1..]);
        nodes
    }

    /// The nodes of `jps` on its path, with the cells at which its legs, diagonal first, turn.
    fn nodes_and_turns(&self, query: &Query) -> Vec<Cell> {
        let mut nodes = self.way_back(true, query.goal, query.start);
        nodes.reverse();
        let mut all = vec![query.start];
        for pair in nodes.windows(2) {
            let (dx, dy) = (pair[1].x - pair[0].x, pair[1].y - pair[0].y);
            let diagonal = dx.abs().min(dy.abs());
            let turn = (pair[0].x + diagonal * dx.signum(), pair[0].y + diagonal * dy.signum());
            all.extend([Cell::new(turn.0, turn.1), pair[1]]);
        }
        all.dedup();
        all
    }
}

fn any_map() -> impl Strategy<Value = Raw> {
    (4i32..24, 4i32..20, 0.0..0.4f64).prop_flat_map(|(width, height, share)| {
        let cells = prop::collection::vec(prop::bool::weighted(share), (width * height) as usize);
        cells.prop_map(move |blocked| {
            Raw::from_fn(width, height, |x, y| !blocked[(y * width + x) as usize])
        })
    })
}

/// A plan, and what an observer saw of it.
fn planned(planner: &PlannerConfig, map: &SearchMap, query: &Query) -> Option<(Plan, Parents)> {
    let (mut workspace, mut plan, mut seen) =
        (Workspace::default(), Plan::default(), Parents::default());
    let planner = planner.build(map).unwrap();
    planner.plan_into(map, query, &mut workspace, Some(&mut seen), &mut plan).ok()?;
    Some((plan, seen))
}

fn jump_points(plan: &Plan) -> Vec<Cell> {
    plan.jump_points.iter().map(|&at| plan.cells[at]).collect()
}

fn literal() -> PlannerConfig {
    let meeting = JumpMeeting::Literal;
    PlannerConfig::BidirectionalJps(BidirectionalJpsConfig {
        meeting,
        ..BidirectionalJpsConfig::PAPER
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn jump_points_are_the_nodes_of_the_search(raw in any_map(), ends in any::<(u32, u32, u32, u32)>()) {
        let (map, query) = (raw.search_map(&Rules::default()), query_on(&raw, ends));
        let by_name = |name| PlannerConfig::by_name(name).unwrap();
        for planner in [by_name("bidirectional-jps"), by_name("bidirectional-jps-fixed"), literal()] {
            let Some((plan, seen)) = planned(&planner, &map, &query) else { continue };
            prop_assert_eq!(jump_points(&plan), seen.nodes_of_both_sides(&query), "{}", raw.drawing());
            prop_assert!(jump_points(&plan).contains(&plan.meeting.unwrap()));
        }
        if let Some((plan, seen)) = planned(&by_name("jps"), &map, &query) {
            prop_assert_eq!(jump_points(&plan), seen.nodes_and_turns(&query), "{}", raw.drawing());
        }
    }

    #[test]
    fn jump_points_of_every_planner_are_its_ends_and_turns_at_least(raw in any_map(), ends in any::<(u32, u32, u32, u32)>()) {
        let (map, query) = (raw.search_map(&Rules::default()), query_on(&raw, ends));
        for name in PlannerConfig::NAMES {
            let Some((plan, _)) = planned(&PlannerConfig::by_name(name).unwrap(), &map, &query) else { continue };
            let (cells, points) = (&plan.cells, &plan.jump_points);
            prop_assert!(points.windows(2).all(|pair| pair[0] < pair[1]), "{} {:?}", name, plan);
            prop_assert_eq!((points[0], points[points.len() - 1]), (0, cells.len() - 1), "{}", name);
            for i in 1..cells.len() - 1 {
                let way = |a: Cell, b: Cell| (b.x - a.x, b.y - a.y);
                let ((ax, ay), (bx, by)) = (way(cells[i - 1], cells[i]), way(cells[i], cells[i + 1]));
                let goes_straight_on = ax * by == ay * bx && ax * bx + ay * by > 0;
                prop_assert!(goes_straight_on || points.contains(&i), "{} turns at {}: {:?}", name, i, plan);
            }
        }
    }
}

/// A cell's centre in half cells: odd numbers, while the corners of squares are even.
type At = (i64, i64);

const fn centre(cell: Cell) -> At {
    (2 * cell.x as i64 + 1, 2 * cell.y as i64 + 1)
}

/// The paper's steps on one map of cells of 1 m.
struct Steps {
    /// The lower left corners of the obstacles.
    squares: Vec<At>,
    safe_m: f64,
}

impl Steps {
    fn new(raw: &Raw, safe_m: f64) -> Self {
        let occupied = |cell: &Cell| !raw.is_free(cell.x, cell.y, Rules::default().unknown);
        let corner = |cell: Cell| (2 * i64::from(cell.x), 2 * i64::from(cell.y));
        Self { squares: raw.cells().filter(occupied).map(corner).collect(), safe_m }
    }

    /// The side of the line through a and b that a point is on.
    const fn side((ax, ay): At, (bx, by): At, (px, py): At) -> i64 {
        (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    }

    /// True if the line runs through the interior of a square, or between two that meet in a
    /// corner.
    fn meets_obstacle(&self, a: At, b: At) -> bool {
        let is_crossed = |&(x, y): &At| {
            let overlaps_x = a.0.max(b.0) > x && a.0.min(b.0) < x + 2;
            let overlaps_y = a.1.max(b.1) > y && a.1.min(b.1) < y + 2;
            let sides =
                [(x, y), (x + 2, y), (x, y + 2), (x + 2, y + 2)].map(|p| Self::side(a, b, p));
            overlaps_x && overlaps_y && sides.iter().any(|&s| s > 0) && sides.iter().any(|&s| s < 0)
        };
        let is_occupied = |x: i64, y: i64| self.squares.contains(&(x, y));
        // The line passes corners on it between the two squares beside it.
        let is_gap = |&(x, y): &At| {
            let is_between = (a.0.min(b.0)..=a.0.max(b.0)).contains(&x)
                && (a.1.min(b.1)..=a.1.max(b.1)).contains(&y);
            let rises = (b.0 - a.0) * (b.1 - a.1) > 0;
            let beside = if rises { [(x - 2, y), (x, y - 2)] } else { [(x - 2, y - 2), (x, y)] };
            is_between
                && Self::side(a, b, (x, y)) == 0
                && beside.iter().all(|&(x, y)| is_occupied(x, y))
        };
        let corners = self
            .squares
            .iter()
            .flat_map(|&(x, y)| [(x, y), (x + 2, y), (x, y + 2), (x + 2, y + 2)]);
        a != b
            && (self.squares.iter().any(is_crossed)
                || corners.into_iter().any(|corner| is_gap(&corner)))
    }

    /// The distance of a line from the nearest obstacle \[m\].
    fn distance_m(&self, a: At, b: At) -> f64 {
        if self.meets_obstacle(a, b) {
            return 0.0;
        }
        let real = |(x, y): At| (x as f64, y as f64);
        let to_square = |p: At, (x, y): At| {
            let gap = |p: i64, low: i64| (low - p).max(p - low - 2).max(0) as f64;
            gap(p.0, x).hypot(gap(p.1, y))
        };
        let to_line = |p: At| {
            let ((ax, ay), (bx, by), (px, py)) = (real(a), real(b), real(p));
            let length_sq = (bx - ax).powi(2) + (by - ay).powi(2);
            let share = if length_sq == 0.0 {
                0.0
            } else {
                ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / length_sq
            };
            let share = share.clamp(0.0, 1.0);
            (ax + share * (bx - ax) - px).hypot(ay + share * (by - ay) - py)
        };
        let distance = |&(x, y): &At| {
            let corners = [(x, y), (x + 2, y), (x, y + 2), (x + 2, y + 2)].map(to_line);
            corners
                .into_iter()
                .chain([to_square(a, (x, y)), to_square(b, (x, y))])
                .fold(f64::INFINITY, f64::min)
        };
        0.5 * self.squares.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    /// d >= D.
    fn is_safe(&self, a: At, b: At) -> bool {
        self.distance_m(a, b) >= self.safe_m - 1e-9
    }

    /// Steps 2 and 3 for the points Q of step 1: the path of step 4.
    fn key_points(&self, q: &[At]) -> Vec<At> {
        let mut u = vec![0];
        for next in 2..q.len() {
            // The previous point is kept if the line past it meets an obstacle.
            if self.meets_obstacle(q[u[u.len() - 1]], q[next]) {
                u.push(next - 1);
            }
        }
        u.extend((q.len() > 1).then(|| q.len() - 1));
        let mut way = vec![q[0]];
        for pair in u.windows(2) {
            let (from, to) = (q[pair[0]], q[pair[1]]);
            if !self.is_safe(from, to) {
                let length = |via: At| {
                    let leg = |a: At, b: At| ((a.0 - b.0) as f64).hypot((a.1 - b.1) as f64);
                    leg(from, via) + leg(via, to)
                };
                let between = q[pair[0] + 1..pair[1]].iter().copied();
                let safe = between.filter(|&via| self.is_safe(from, via) && self.is_safe(via, to));
                // The first of equal ones.
                way.extend(safe.min_by(|&a, &b| length(a).total_cmp(&length(b))));
            }
            way.push(to);
        }
        way
    }
}

/// The line through some points in metres, as a path.
fn path_over(points: &[At]) -> Path {
    let metres = |&(x, y): &At| Point::new(0.5 * x as f64, 0.5 * y as f64);
    Path::from(&Polyline::new(points.iter().map(metres).collect()).merged())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn key_points_are_those_of_the_papers_steps(raw in any_map(), ends in any::<(u32, u32, u32, u32)>(),
                                                safe_m in prop_oneof![3 => Just(0.5), 1 => Just(0.0), 1 => 0.1..1.6f64]) {
        let (map, query) = (raw.search_map(&Rules::default()), query_on(&raw, ends));
        let found = planned(&PlannerConfig::by_name("bidirectional-jps").unwrap(), &map, &query);
        // Not an assumption: rejected cases would end long runs.
        let Some((plan, _)) = found else { return Ok(()) };
        let [start, goal] = [query.start, query.goal].map(|end| map.frame().world_from_cell(end));
        let line = plan.line(&map, start, goal);
        let steps = Steps::new(&raw, safe_m);
        let candidates_of = |candidates, cells: Vec<Cell>| {
            let q: Vec<At> = cells.into_iter().map(centre).collect();
            (SmootherConfig::KeyPoints(KeyPointSmoothingConfig { candidates, safe_distance_m: safe_m }), q)
        };
        let by_cells = candidates_of(KeyPointCandidates::Cells, plan.cells.clone());
        let paper = KeyPointSmoothingConfig::PAPER.candidates;
        for (smoother, q) in [candidates_of(paper, jump_points(&plan)), by_cells] {
            let done = smoother.build().unwrap().smooth(&line, &map.clearance(), 0.0);
            prop_assert_eq!(done.path, path_over(&steps.key_points(&q)), "{:?}\n{}", plan, raw.drawing());
        }
    }
}
