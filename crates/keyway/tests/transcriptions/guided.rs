//! Steps 7 to 10 of Zhu and Yin's algorithm, literally, with equations (18) to (21) and pure
//! pursuit for step 7.

use super::Wanted;
use super::window::{self, State};
use super::world::{World, meets, to_square};
use keyway::geometry::Polyline;
use std::f64::consts::PI;

type P = (f64, f64);

const D: f64 = 0.8;
const AHEAD: f64 = 5.0;
const ZONE: f64 = 0.5;
const LOOK_AHEAD: f64 = 1.0;

fn away(a: P, b: P) -> f64 {
    ((a.0 - b.0).powi(2) + (a.1 - b.1).powi(2)).sqrt()
}

/// The part of the algorithm that the robot is in.
enum Mode {
    Route,
    ToGa { x_j: P, st: f64 },
    ToIt { x_it: P, it: f64 },
}

/// The whole algorithm on a route.
pub(crate) struct Whole {
    corners: Vec<P>,
    /// Nodes with their arc lengths: every metre, and the goal.
    nodes: Vec<(f64, P)>,
    covered: f64,
    mode: Mode,
    /// alpha, beta, gamma of (18).
    weights: [f64; 3],
}

impl Whole {
    pub(crate) fn on(path: &Polyline, weights: [f64; 3]) -> Self {
        let corners: Vec<P> = path.points().iter().map(|point| (point.x, point.y)).collect();
        let mut whole =
            Self { corners, nodes: Vec::new(), covered: 0.0, mode: Mode::Route, weights };
        let length = whole.length();
        let mut along = 1.0;
        while along < length - 1e-9 {
            whole.nodes.push((along, whole.at(along)));
            along += 1.0;
        }
        whole.nodes.push((length, *whole.corners.last().unwrap()));
        whole
    }

    fn length(&self) -> f64 {
        self.corners.windows(2).map(|pair| away(pair[0], pair[1])).sum()
    }

    /// The point at an arc length.
    fn at(&self, along: f64) -> P {
        let mut left = along.max(0.0);
        for pair in self.corners.windows(2) {
            let length = away(pair[0], pair[1]);
            if left <= length {
                let part = left / length;
                return (
                    pair[0].0 + (pair[1].0 - pair[0].0) * part,
                    pair[0].1 + (pair[1].1 - pair[0].1) * part,
                );
            }
            left -= length;
        }
        *self.corners.last().unwrap()
    }

    /// The arc length of the point nearest to a position, among those between two arc lengths.
    fn nearest(&self, place: P, from: f64, to: f64) -> f64 {
        let (mut begin, mut best, mut best_away) = (0.0, from, f64::INFINITY);
        for pair in self.corners.windows(2) {
            let length = away(pair[0], pair[1]);
            let (low, high) = ((from - begin).max(0.0), (to - begin).min(length));
            if low <= high {
                let along = ((pair[1].0 - pair[0].0) / length, (pair[1].1 - pair[0].1) / length);
                let foot = (place.0 - pair[0].0) * along.0 + (place.1 - pair[0].1) * along.1;
                let foot = foot.clamp(low, high);
                let there = (pair[0].0 + along.0 * foot, pair[0].1 + along.1 * foot);
                if away(there, place) < best_away {
                    (best, best_away) = (begin + foot, away(there, place));
                }
            }
            begin += length;
        }
        best
    }

    /// The command of a cycle.
    pub(crate) fn wanted(&mut self, world: &World, state: State) -> Wanted {
        let here = (state.x, state.y);
        if let Mode::ToIt { x_it, it } = self.mode {
            let is_covered = world.seen.iter().any(|square| to_square(x_it.0, x_it.1, square) < D);
            if away(here, x_it) > ZONE && !is_covered {
                return self.best(world, state, x_it);
            }
            if away(here, x_it) <= ZONE {
                self.covered = it;
            }
            self.mode = Mode::Route;
        }
        let upto = if let Mode::ToGa { st, .. } = self.mode { st } else { self.covered + AHEAD };
        let Some((at_ob, seed)) = self.detected(world, upto) else {
            if matches!(self.mode, Mode::ToGa { .. }) {
                self.covered = self.nearest(here, self.covered, upto);
            }
            self.mode = Mode::Route;
            return Wanted::Exactly(self.followed(state));
        };
        let cluster = connected(world, seed, here);
        let n = cluster.len() as f64;
        let x_ob = (
            cluster.iter().map(|square| square.0 + 0.5).sum::<f64>() / n,
            cluster.iter().map(|square| square.1 + 0.5).sum::<f64>() / n,
        );
        let x_j = if let Mode::ToGa { x_j, .. } = self.mode {
            x_j
        } else {
            let next = self.nodes.iter().find(|node| node.0 > self.covered + 1e-9);
            next.filter(|node| node.0 < at_ob).map_or(here, |node| node.1)
        };
        // (19)
        let mut x_ga = (2.0 * x_ob.0 - x_j.0, 2.0 * x_ob.1 - x_j.1);
        let remaining: Vec<(f64, P)> =
            self.nodes.iter().copied().filter(|node| node.0 > at_ob + 1e-9).collect();
        let crossed = world.squares().filter(|square| !cluster.contains(square));
        let is_behind_a_wall = crossed.into_iter().any(|square| enters(x_j, x_ga, square));
        let st = if is_free(world, x_ga) && !is_behind_a_wall && !remaining.is_empty() {
            // (20)
            let mut nearest = remaining[0];
            for &node in &remaining {
                if away(node.1, x_ga) < away(nearest.1, x_ga) {
                    nearest = node;
                }
            }
            nearest
        } else {
            let Some(&free) = remaining.iter().find(|node| is_free(world, node.1)) else {
                return Wanted::Nothing;
            };
            x_ga = free.1;
            free
        };
        if away(here, x_ga) > ZONE {
            self.mode = Mode::ToGa { x_j, st: st.0 };
            return self.best(world, state, x_ga);
        }
        let (it, x_it) = joined(world, state.theta, x_ga, st, &self.nodes);
        self.covered = st.0;
        self.mode = Mode::ToIt { x_it, it };
        self.best(world, state, x_it)
    }

    fn best(&self, world: &World, state: State, target: P) -> Wanted {
        window::best(world, state, target, [false, true], |all| window::guided(all, self.weights))
    }

    /// The first node that a seen square is too close to, and the nearest square there.
    fn detected(&self, world: &World, upto: f64) -> Option<(f64, P)> {
        for &(along, node) in &self.nodes {
            if along <= self.covered + 1e-9 || along > upto {
                continue;
            }
            let mut near: Vec<P> = world.seen.clone();
            near.retain(|square| to_square(node.0, node.1, square) < D);
            near.sort_by(|a, b| {
                let key = |square: &P| (to_square(node.0, node.1, square), square.1, square.0);
                key(a).partial_cmp(&key(b)).unwrap()
            });
            if let Some(&square) = near.first() {
                return Some((along, square));
            }
        }
        None
    }

    /// Step 7: pure pursuit, as fast as the robot can still stop at the end.
    fn followed(&mut self, state: State) -> State {
        let here = (state.x, state.y);
        self.covered = self.nearest(here, self.covered, self.covered + LOOK_AHEAD);
        let carrot = self.at(self.covered + LOOK_AHEAD);
        let left = self.length() - self.covered;
        let bearing = (carrot.1 - state.y).atan2(carrot.0 - state.x) - state.theta;
        let bearing = bearing.sin().atan2(bearing.cos());
        let (v, omega) = if left <= 0.0 {
            (0.0, 0.0)
        } else if bearing.abs() > PI / 2.0 {
            (0.0, (2.0 * 50.0_f64.to_radians() * bearing.abs()).sqrt() * bearing.signum())
        } else {
            let gamma = 2.0 * bearing.sin() / away(here, carrot);
            let v = stoppable(state.v, left).min(20.0_f64.to_radians() / gamma.abs());
            (v, v * gamma)
        };
        let (v, omega) =
            (v.clamp(0.0, 1.0), omega.clamp(-20.0_f64.to_radians(), 20.0_f64.to_radians()));
        let (dv, dw) = (0.2 * 0.1, 50.0_f64.to_radians() * 0.1);
        State {
            v: v.clamp(state.v - dv, state.v + dv),
            omega: omega.clamp(state.omega - dw, state.omega + dw),
            ..state
        }
    }
}

/// The largest speed at the end of a cycle after which the robot still stops within the remaining
/// distance, found by trying.
fn stoppable(u: f64, left: f64) -> f64 {
    let needs = |v: f64| {
        let (mut v, mut way) = (v, 0.05 * (u + v));
        while v > 0.0 {
            let slower = (v - 0.02).max(0.0);
            way += 0.05 * (v + slower);
            v = slower;
        }
        way
    };
    let (mut stops, mut overshoots) = (0.0, 1.0);
    if needs(overshoots) <= left {
        return overshoots;
    }
    for _ in 0..60 {
        let middle = 0.5 * (stops + overshoots);
        *(if needs(middle) <= left { &mut stops } else { &mut overshoots }) = middle;
    }
    stops
}

/// Squares that are connected with one, within reach of the robot.
fn connected(world: &World, seed: P, here: P) -> Vec<P> {
    let mut cluster = vec![seed];
    loop {
        let more: Vec<P> = world
            .seen
            .iter()
            .copied()
            .filter(|square| !cluster.contains(square))
            .filter(|square| away((square.0 + 0.5, square.1 + 0.5), here) <= AHEAD)
            .filter(|square| {
                cluster
                    .iter()
                    .any(|c| (c.0 - square.0).abs() <= 1.0 && (c.1 - square.1).abs() <= 1.0)
            })
            .collect();
        if more.is_empty() {
            return cluster;
        }
        cluster.extend(more);
    }
}

fn is_free(world: &World, p: P) -> bool {
    let border = p.0.min(p.1).min(world.width - p.0).min(world.height - p.1);
    border >= D - 1e-9 && world.squares().all(|square| to_square(p.0, p.1, square) >= D)
}

/// True if a line runs through the interior of a square, without its boundary.
fn enters(a: P, b: P, square: &P) -> bool {
    let n = 4000;
    (0..=n).any(|i| {
        let t = f64::from(i) / f64::from(n);
        let (x, y) = (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t);
        x > square.0 + 1e-6
            && x < square.0 + 1.0 - 1e-6
            && y > square.1 + 1e-6
            && y < square.1 + 1.0 - 1e-6
    }) && meets(a, b, square, 0.0)
}

/// Distance of a line to a square, by samples a millimetre or less apart.
fn line_keeps(world: &World, a: P, b: P) -> bool {
    let n = (away(a, b) * 1000.0).ceil().max(1.0);
    let mut i = 0.0;
    while i <= n {
        let p = (a.0 + (b.0 - a.0) * i / n, a.1 + (b.1 - a.1) * i / n);
        if !is_free(world, p) {
            return false;
        }
        i += 1.0;
    }
    true
}

/// (21): `x_it` and its arc length.
fn joined(world: &World, theta: f64, x_ga: P, st: (f64, P), nodes: &[(f64, P)]) -> (f64, P) {
    let e_gt = (theta.cos(), theta.sin());
    let apart = away(x_ga, st.1);
    let e_gs = if apart < 0.5 {
        (0.0, 0.0)
    } else {
        ((st.1.0 - x_ga.0) / apart, (st.1.1 - x_ga.1) / apart)
    };
    let mut e_gi = (e_gt.0 + e_gs.0, e_gt.1 + e_gs.1);
    if e_gi.0.hypot(e_gi.1) < 1e-9 {
        e_gi = e_gs;
    }
    let mut best = None;
    let mut closest = f64::NEG_INFINITY;
    for &(along, node) in nodes {
        let apart = away(x_ga, node);
        if along <= st.0 + 1e-9 || apart < 0.5 || !line_keeps(world, x_ga, node) {
            continue;
        }
        let cosine = ((node.0 - x_ga.0) * e_gi.0 + (node.1 - x_ga.1) * e_gi.1)
            / (apart * e_gi.0.hypot(e_gi.1));
        if cosine > closest + 1e-9 {
            closest = cosine;
            best = Some((along, node));
        }
    }
    best.unwrap_or(st)
}

/// Maps, routes that are smooth and keep well away from the known obstacles, and an unknown
/// obstacle on each.
pub(crate) fn cases() -> Vec<(World, Polyline)> {
    let line = |points: &[[f64; 2]]| Polyline::new(points.iter().map(|&p| p.into()).collect());
    let hall = [".................."; 8];
    let bend = [
        "..............####",
        "..............####",
        "..................",
        "..................",
        "..................",
        "####..............",
        "####..............",
        "####..............",
    ];
    // A quarter of a circle of 3 m, as a line of many points.
    let quarter = |x: f64, y: f64, from: f64| {
        (0..=30).map(move |i| {
            let angle = (from - 3.0 * f64::from(i)).to_radians();
            [x + 3.0 * angle.cos(), y + 3.0 * angle.sin()]
        })
    };
    let mut points = vec![[5.5, 1.0], [5.5, 2.5]];
    points.extend(quarter(8.5, 2.5, 180.0));
    points.push([16.5, 5.5]);
    let straight = || line(&[[1.0, 3.5], [17.0, 3.5]]);
    vec![
        (World::new(&hall, &[]), straight()),
        (World::new(&hall, &[(8, 3)]), straight()),
        (World::new(&hall, &[(8, 3), (9, 4)]), line(&[[1.0, 3.6], [17.0, 3.2]])),
        (World::new(&bend, &[(10, 5)]), line(&points)),
        (World::new(&bend, &[(7, 4), (12, 5)]), line(&points)),
        (World::new(&hall, &[]).with_mover((8.0, 3.0), (11.0, 5.0)), straight()),
        (World::new(&hall, &[]).with_mover((8.0, 3.0), (12.0, 3.0)), straight()),
    ]
}
