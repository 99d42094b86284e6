//! The search for a course: the most promising ones are followed from stretch to stretch.

use super::course::{Cost, Judge, State};
use super::targets::Targets;
use crate::geometry::Velocity;

/// A state that some course leads to.
#[derive(Clone, Copy, Debug)]
struct Node {
    state: State,
    cost: Cost,
    /// Index of the node before it.
    parent: u32,
    /// Time and cost so far, and the time to go \[s\].
    total_s: f64,
    /// It is at the end of the route before the next stretch ends.
    arrives: bool,
    bin: u64,
}

/// How far and how wide a search looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) stretches: u32,
    pub(super) width: usize,
    /// The slowest speed of a course \[m/s\].
    pub(super) lowest_mps: f64,
    /// Of courses that lead to nearly the same state, only the best one is followed: the positions of a bin are no farther
    /// apart than this along each axis \[m\].
    pub(super) bin_m: f64,
    /// Who comes no farther than this within the horizon does not drive, but has no room to \[m\].
    pub(super) elsewhere_m: f64,
}

/// What became of the stretches that a search has tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub(super) tried: u32,
    /// They touch something.
    pub(super) touching: u32,
    /// They touch nothing, and at their end the robot is elsewhere.
    pub(super) driving: u32,
    /// They are beginnings that are not let pass.
    pub(super) refused: u32,
    /// They come near to a mover.
    pub(super) meeting: u32,
}

/// Memory to search in, and the result.
#[derive(Debug, Default)]
pub(super) struct Beam {
    nodes: Vec<Node>,
    children: Vec<Node>,
    order: Vec<u32>,
    /// The bins of the nodes of a level.
    bins: Vec<u64>,
    /// The best course: its velocities at the ends of its stretches; empty when none is free.
    pub(super) best: Vec<Velocity>,
}

impl Beam {
    /// So many stretches at the beginning of a course have more targets than later ones.
    const NEAR: u32 = 2;

    /// Costs of movers of more than this count as near to one \[s\].
    pub(super) const MEETING_S: f64 = 0.1;

    /// Finds the best course from a state, of those whose first velocity `begins` lets pass.
    pub(super) fn search(
        &mut self,
        start: State,
        judge: &Judge<'_>,
        extent: &Extent,
        mut begins: impl FnMut(Velocity) -> bool,
    ) -> Tally {
        let mut tally = Tally::default();
        self.nodes.clear();
        self.nodes.push(Node::first(start));
        let (mut level, mut arrived) = (0..1, None);
        for stretch in 0..extent.stretches {
            self.children.clear();
            for parent in level.clone() {
                let Node { state, arrives, .. } = &self.nodes[parent];
                if *arrives {
                    continue;
                }
                let is_near = stretch < Self::NEAR;
                let targets = Targets::of(state, judge, extent.lowest_mps, is_near);
                self.expand(parent, judge, extent, &targets, &mut tally);
            }
            if stretch == 0 {
                let tried = self.children.len();
                self.children.retain(|child| begins(child.state.velocity));
                tally.refused += (tried - self.children.len()) as u32;
            }
            let first = self.nodes.len();
            self.keep(extent.width, judge);
            if self.nodes.len() == first {
                break;
            }
            level = first..self.nodes.len();
            // Nodes of a level are in the order of their totals.
            let best = level.clone().find(|&node| self.nodes[node].arrives);
            arrived = self.better(arrived, best);
        }
        // Without a stretch there is no course.
        let farthest = Some(level.start).filter(|&node| node > 0);
        self.trace(self.better(arrived, farthest));
        tally
    }

    /// The one of two nodes with the lower total.
    fn better(&self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        let both = [a, b].into_iter().flatten();
        both.min_by(|&a, &b| self.nodes[a].total_s.total_cmp(&self.nodes[b].total_s))
    }

    fn expand(
        &mut self,
        parent: usize,
        judge: &Judge<'_>,
        extent: &Extent,
        targets: &Targets,
        tally: &mut Tally,
    ) {
        let Node { state: from, cost, .. } = self.nodes[parent];
        let start = self.nodes[0].state.at;
        for to in targets.velocities() {
            tally.tried += 1;
            let Some((state, cost)) = judge.drive(&from, &cost, to) else {
                tally.touching += 1;
                continue;
            };
            tally.driving += u32::from(state.at.distance(start) > extent.elsewhere_m);
            tally.meeting += u32::from(cost.movers_s > Self::MEETING_S);
            let left_s = judge.time_to_go_s(&state);
            self.children.push(Node {
                state,
                cost,
                parent: parent as u32,
                total_s: state.after_s + cost.sum_s() + left_s,
                arrives: judge.arrives(&state, left_s),
                bin: bin(&state, extent.bin_m),
            });
        }
    }

    /// The best children of different bins from which the robot could stop become nodes, the best one first.
    fn keep(&mut self, width: usize, judge: &Judge<'_>) {
        let Self { nodes, children, order, bins, .. } = self;
        order.clear();
        order.extend(0..children.len() as u32);
        order.sort_unstable_by(|&a, &b| {
            let total_s = |index: u32| children[index as usize].total_s;
            total_s(a).total_cmp(&total_s(b)).then(a.cmp(&b))
        });
        bins.clear();
        for child in order.iter().map(|&index| children[index as usize]) {
            if bins.len() == width {
                break;
            }
            if !bins.contains(&child.bin) && judge.can_stop(&child.state) {
                bins.push(child.bin);
                nodes.push(child);
            }
        }
    }

    fn trace(&mut self, end: Option<usize>) {
        self.best.clear();
        let mut index = end.unwrap_or_default();
        while index != 0 {
            let node = &self.nodes[index];
            self.best.push(node.state.velocity);
            index = node.parent as usize;
        }
        self.best.reverse();
    }
}

impl Node {
    const fn first(state: State) -> Self {
        let cost = Cost { clearance_s: 0.0, movers_s: 0.0, steering_s: 0.0 };
        Self { state, cost, parent: 0, total_s: 0.0, arrives: false, bin: 0 }
    }
}

/// States of one bin are nearly the same.
fn bin(state: &State, bin_m: f64) -> u64 {
    const HEADING_RAD: f64 = 0.35;
    let part = |value: f64, width: f64| ((value / width).floor() as i64 as u64) & 0xffff;
    let heading_rad = libm::atan2(state.ahead.y, state.ahead.x);
    part(state.at.x, bin_m)
        | part(state.at.y, bin_m) << 16
        | part(heading_rad, HEADING_RAD) << 32
        | part(state.velocity.v, 2.0 * bin_m) << 48
}
