//! The search for a course: a beam of the most promising ones, from instant to instant.

use super::course::{Cost, Judge, State};
use crate::geometry::{Point, Velocity};

/// A state that some course leads to.
#[derive(Clone, Copy, Debug)]
struct Node {
    state: State,
    cost: Cost,
    /// Index of the node before it.
    parent: u32,
    /// Time so far, cost so far and time to go \[s\].
    total_s: f64,
    /// It is at the end of the route before the next instant.
    arrives: bool,
    bin: u64,
}

/// Memory to search in.
#[derive(Debug, Default)]
pub(super) struct Beam {
    nodes: Vec<Node>,
    children: Vec<Node>,
    order: Vec<u32>,
    bins: Vec<u64>,
    /// The best course: its velocities at the instants after its beginning.
    pub(super) best: Vec<Velocity>,
}

/// How a search is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) knots: u32,
    pub(super) width: usize,
    /// Positions of one bin are no farther apart \[m\].
    pub(super) bin_m: f64,
    pub(super) backwards: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) tried: u32,
    pub(super) touching: u32,
    /// Courses that come near to a mover.
    pub(super) meeting: u32,
}

impl Beam {
    /// Finds the best course from a state; `best` is empty when all touch something.
    pub(super) fn search(
        &mut self,
        start: State,
        judge: &Judge<'_>,
        extent: &Extent,
        begins: &mut dyn FnMut(Velocity) -> bool,
    ) -> Tally {
        let mut tally = Tally::default();
        self.nodes.clear();
        self.best.clear();
        let root =
            Node { state: start, cost: Cost::default(), parent: u32::MAX, total_s: 0.0, arrives: false, bin: 0 };
        self.nodes.push(root);
        let (mut from, mut to) = (0, 1);
        let mut arrived: Option<(f64, usize)> = None;
        for _ in 0..extent.knots {
            self.children.clear();
            for parent in from..to {
                if self.nodes[parent].arrives {
                    continue;
                }
                self.expand(parent, judge, extent, &mut tally);
            }
            if from == 0 {
                self.children.retain(|child| begins(child.state.velocity));
            }
            if self.children.is_empty() {
                break;
            }
            self.keep(extent.width);
            (from, to) = (to, self.nodes.len());
            for (index, node) in self.nodes.iter().enumerate().take(to).skip(from) {
                let is_better = arrived.is_none_or(|(total_s, _)| node.total_s < total_s);
                if node.arrives && is_better {
                    arrived = Some((node.total_s, index));
                }
            }
        }
        // The nodes of an instant are in their order.
        let farthest = (from > 0).then(|| (self.nodes[from].total_s, from));
        let ends = [arrived, farthest].into_iter().flatten();
        if let Some((_, end)) = ends.min_by(|a, b| a.0.total_cmp(&b.0)) {
            self.trace(end);
        }
        tally
    }

    fn expand(&mut self, parent: usize, judge: &Judge<'_>, extent: &Extent, tally: &mut Tally) {
        let node = self.nodes[parent];
        let targets = targets(&node.state, judge, extent.backwards);
        for &v in &targets.speeds[..targets.speed_count] {
            for &omega in &targets.rates[..targets.rate_count] {
                tally.tried += 1;
                let to = Velocity::new(v, omega);
                let Some((state, cost)) = judge.drive(&node.state, &node.cost, to) else {
                    tally.touching += 1;
                    continue;
                };
                tally.meeting += u32::from(cost.movers_s > 0.1);
                let left_s = judge.time_to_go_s(&state);
                let total_s = state.after_s + cost.sum_s() + left_s;
                let arrives = left_s <= judge.knot_s;
                let bin = bin(&state, extent.bin_m);
                let parent = parent as u32;
                self.children.push(Node { state, cost, parent, total_s, arrives, bin });
            }
        }
    }

    /// The best children of different bins become nodes.
    fn keep(&mut self, width: usize) {
        let Self { nodes, children, order, bins, .. } = self;
        order.clear();
        order.extend(0..children.len() as u32);
        order.sort_unstable_by(|&a, &b| {
            let (a, b) = (&children[a as usize], &children[b as usize]);
            a.total_s.total_cmp(&b.total_s).then(a.bin.cmp(&b.bin)).then(a.parent.cmp(&b.parent))
        });
        bins.clear();
        for &index in order.iter() {
            let child = children[index as usize];
            if bins.contains(&child.bin) {
                continue;
            }
            bins.push(child.bin);
            nodes.push(child);
            if bins.len() == width {
                break;
            }
        }
    }

    fn trace(&mut self, end: usize) {
        let mut index = end as u32;
        while index != 0 {
            let node = &self.nodes[index as usize];
            self.best.push(node.state.velocity);
            index = node.parent;
        }
        self.best.reverse();
    }
}

/// What a course costs all in all \[s\]; `None` where it touches something.
pub(super) fn total_s(start: &State, course: &[Velocity], judge: &Judge<'_>) -> Option<(f64, Cost)> {
    let (mut state, mut cost) = (*start, Cost::default());
    let mut left_s = f64::INFINITY;
    for &to in course {
        (state, cost) = judge.drive(&state, &cost, to)?;
        left_s = judge.time_to_go_s(&state);
        if left_s <= judge.knot_s {
            break;
        }
    }
    Some((state.after_s + cost.sum_s() + left_s, cost))
}

/// Courses of one bin lead to nearly the same.
fn bin(state: &State, bin_m: f64) -> u64 {
    let part = |value: f64, width: f64| ((value / width).floor() as i64 as u64) & 0xffff;
    let heading = libm::atan2(state.ahead.y, state.ahead.x);
    part(state.at.x, bin_m)
        | part(state.at.y, bin_m) << 16
        | part(heading, 0.35) << 32
        | part(state.velocity.v, 2.0 * bin_m) << 48
}

/// Velocities that a course may have at its next instant.
struct Targets {
    speeds: [f64; 4],
    speed_count: usize,
    rates: [f64; 8],
    rate_count: usize,
}

fn targets(state: &State, judge: &Judge<'_>, backwards: bool) -> Targets {
    let (limits, knot_s) = (judge.limits, judge.knot_s);
    let Velocity { v, omega } = state.velocity;
    let lowest = if backwards { limits.v_min_mps } else { 0.0 };
    let slowest = limits.reached(state.velocity, Velocity::new(lowest, 0.0), knot_s).v;
    let fastest = limits.reached(state.velocity, Velocity::new(limits.v_max_mps, 0.0), knot_s).v;
    let mut targets =
        Targets { speeds: [0.0; 4], speed_count: 0, rates: [0.0; 8], rate_count: 0 };
    for speed in [fastest, v.max(lowest), 0.5 * (v + slowest), slowest] {
        targets.add_speed(speed);
    }
    let reach = |wanted: f64| limits.reached(state.velocity, Velocity::new(v, wanted), knot_s).omega;
    let most = limits.omega_max_radps;
    let (left, right) = (reach(most), reach(-most));
    let direction = judge.cost_to_go.direction(state.at);
    let cross = state.ahead.x * direction.y - state.ahead.y * direction.x;
    let bearing = libm::atan2(cross, state.ahead.dot(direction));
    for rate in [
        omega,
        left,
        right,
        0.5 * (omega + left),
        0.5 * (omega + right),
        reach(0.0),
        reach(bearing / knot_s),
    ] {
        targets.add_rate(rate);
    }
    targets
}

impl Targets {
    fn add_speed(&mut self, speed: f64) {
        if self.speeds[..self.speed_count].iter().all(|known| (known - speed).abs() > 1e-6) {
            self.speeds[self.speed_count] = speed;
            self.speed_count += 1;
        }
    }

    fn add_rate(&mut self, rate: f64) {
        if self.rates[..self.rate_count].iter().all(|known| (known - rate).abs() > 1e-6) {
            self.rates[self.rate_count] = rate;
            self.rate_count += 1;
        }
    }
}

/// Makes a course better by small changes, one velocity after the other.
pub(super) fn polish(course: &mut [Velocity], start: &State, judge: &Judge<'_>, backwards: bool) {
    let Some((mut best_s, _)) = total_s(start, course, judge) else { return };
    let limits = judge.limits;
    let lowest = if backwards { limits.v_min_mps } else { 0.0 };
    for part in [0.25, 0.1, 0.04] {
        let omega_step = part * limits.angular_acceleration_radps2 * judge.knot_s;
        let v_step = part * limits.acceleration_mps2 * judge.knot_s;
        for knot in 0..course.len() {
            for step in [
                Velocity::new(0.0, omega_step),
                Velocity::new(0.0, -omega_step),
                Velocity::new(v_step, 0.0),
                Velocity::new(-v_step, 0.0),
            ] {
                let old = course[knot];
                let before = if knot == 0 { start.velocity } else { course[knot - 1] };
                let wanted = Velocity::new((old.v + step.v).max(lowest), old.omega + step.omega);
                let tried = limits.reached(before, wanted, judge.knot_s);
                course[knot] = tried;
                let follows = course.get(knot + 1).is_none_or(|&next| {
                    let reached = limits.reached(tried, next, judge.knot_s);
                    (reached.v - next.v).abs() < 1e-9 && (reached.omega - next.omega).abs() < 1e-9
                });
                match total_s(start, course, judge) {
                    Some((total, _)) if follows && total < best_s - 1e-9 => best_s = total,
                    _ => course[knot] = old,
                }
            }
        }
    }
}

/// A direction of length 1.
pub(super) fn unit(heading_rad: f64) -> Point {
    let (sin, cos) = libm::sincos(heading_rad);
    Point::new(cos, sin)
}
