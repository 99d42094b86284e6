//! The search for a course: the most promising ones are followed from stretch to stretch.

use super::course::{Cost, Judge, State};
use super::targets::Targets;
use crate::geometry::Velocity;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

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
}

/// A stretch that may become a node. Where it leads is known at once; what it costs on its way
/// takes longer to find, and is looked at only when the course might be one of the best.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    /// What the course costs at least, until it `is_driven`: then, what it costs \[s\].
    total_s: f64,
    /// Proposals of a level are numbered.
    number: u32,
    parent: u32,
    is_driven: bool,
    /// It touches nothing, and at its end the robot is elsewhere: known once it `is_driven`.
    leads_elsewhere: bool,
    /// Its cost is that without what its way costs, until it `is_driven`.
    state: State,
    cost: Cost,
    left_s: f64,
}

/// The one with the lowest total comes first, of equal ones the first one.
impl Ord for Proposal {
    fn cmp(&self, other: &Self) -> Ordering {
        other.total_s.total_cmp(&self.total_s).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Proposal {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Proposal {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Proposal {}

/// How far and how wide a search looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) stretches: u32,
    pub(super) width: usize,
    /// The slowest speed of a course \[m/s\].
    pub(super) lowest_mps: f64,
    /// Of courses that lead to nearly the same state, only the best one is followed: the positions
    /// of a bin are no farther apart than this along each axis \[m\].
    pub(super) bin_m: f64,
    /// Who comes no farther than this within the horizon does not drive, but has no room to \[m\].
    pub(super) elsewhere_m: f64,
}

/// What became of the stretches that a search has looked at. Each is counted once: it touches
/// something, is refused, drives, or none of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub(super) tried: u32,
    /// They touch something.
    pub(super) touching: u32,
    /// From their end the robot could not stop, or they are beginnings that are not let pass.
    pub(super) refused: u32,
    /// At their end the robot is elsewhere.
    pub(super) driving: u32,
    /// Some that lead elsewhere come near a mover.
    pub(super) meets: bool,
}

/// Memory to search in, and the result.
#[derive(Debug, Default)]
pub(super) struct Beam {
    nodes: Vec<Node>,
    open: BinaryHeap<Proposal>,
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
            self.open.clear();
            for parent in level.clone() {
                let Node { state, arrives, .. } = &self.nodes[parent];
                if *arrives {
                    continue;
                }
                let is_near = stretch < Self::NEAR;
                let targets = Targets::of(state, judge, extent.lowest_mps, is_near);
                self.propose(parent, judge, &targets);
            }
            let first = self.nodes.len();
            let passes = |velocity| stretch > 0 || begins(velocity);
            self.keep(judge, extent, passes, &mut tally);
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

    /// Where the next stretches of a node lead, and what they cost at least.
    fn propose(&mut self, parent: usize, judge: &Judge<'_>, targets: &Targets) {
        let Node { state: from, cost: so_far, .. } = self.nodes[parent];
        for to in targets.velocities() {
            let (state, cost) = judge.leads_to(&from, &so_far, to);
            let left_s = judge.time_to_go_s(&state);
            self.open.push(Proposal {
                total_s: state.after_s + cost.sum_s() + left_s,
                number: self.open.len() as u32,
                parent: parent as u32,
                is_driven: false,
                leads_elsewhere: false,
                state,
                cost,
                left_s,
            });
        }
    }

    /// The best proposals of different bins from which the robot could stop become nodes, the best
    /// one first.
    ///
    /// A proposal comes up again once its cost is known, which is no less than what it was before.
    /// So proposals come up in the order of their costs, and those that come up too late are never
    /// looked at. Where nothing drives, all are.
    fn keep(
        &mut self,
        judge: &Judge<'_>,
        extent: &Extent,
        mut passes: impl FnMut(Velocity) -> bool,
        tally: &mut Tally,
    ) {
        self.bins.clear();
        while let Some(proposal) = self.open.pop() {
            let is_full = self.bins.len() == extent.width;
            let matters = tally.driving == 0;
            if is_full && !matters {
                break;
            }
            let bin = bin(&self.nodes[0].state, &proposal.state, extent.bin_m);
            let is_new = !is_full && !self.bins.contains(&bin);
            if !proposal.is_driven {
                if is_new || matters {
                    self.drive(proposal, judge, extent, tally);
                }
            } else if is_new {
                if judge.can_stop(&proposal.state) && passes(proposal.state.velocity) {
                    self.bins.push(bin);
                    self.nodes.push(proposal.node(judge));
                } else {
                    tally.refused += 1;
                    tally.driving -= u32::from(proposal.leads_elsewhere);
                }
            }
        }
    }

    /// Looks at the way of a proposal, which may come up again.
    fn drive(&mut self, proposal: Proposal, judge: &Judge<'_>, extent: &Extent, tally: &mut Tally) {
        let Node { state: from, cost, .. } = self.nodes[proposal.parent as usize];
        tally.tried += 1;
        let Some((state, cost)) = judge.drive(&from, &cost, proposal.state.velocity) else {
            tally.touching += 1;
            return;
        };
        let start = self.nodes[0].state.at;
        let leads_elsewhere = state.at.distance(start) > extent.elsewhere_m;
        tally.driving += u32::from(leads_elsewhere);
        tally.meets |= leads_elsewhere && cost.movers_s > Self::MEETING_S;
        let total_s = state.after_s + cost.sum_s() + proposal.left_s;
        self.open.push(Proposal { total_s, is_driven: true, leads_elsewhere, cost, ..proposal });
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

impl Proposal {
    fn node(&self, judge: &Judge<'_>) -> Node {
        let Self { state, cost, parent, total_s, left_s, .. } = *self;
        Node { state, cost, parent, total_s, arrives: judge.arrives(&state, left_s) }
    }
}

impl Node {
    const fn first(state: State) -> Self {
        let cost = Cost { clearance_s: 0.0, movers_s: 0.0, steering_s: 0.0 };
        Self { state, cost, parent: 0, total_s: 0.0, arrives: false }
    }
}

/// States of one bin are nearly the same. Bins are those of somebody who stands at the start and
/// looks ahead: where that is on the map changes nothing. What is to the left of the line ahead
/// shares no bin with what is to the right, and a mirror changes nothing, either.
fn bin(start: &State, state: &State, bin_m: f64) -> u64 {
    const HEADING_RAD: f64 = 0.35;
    let (ahead, off) = (start.ahead, state.at - start.at);
    let turned_rad = libm::atan2(ahead.cross(state.ahead), ahead.dot(state.ahead));
    let part = |value: f64, width: f64| (value / width).floor() as i64;
    let parts = [
        part(ahead.dot(off), bin_m),
        part_to_a_side(ahead.cross(off), bin_m),
        part_to_a_side(turned_rad, HEADING_RAD),
        part(state.velocity.v, 2.0 * bin_m),
    ];
    parts.into_iter().fold(0, |bin, part| bin << 16 | part as u64 & 0xffff)
}

/// The number of a bin to the left, or the same below 0 to the right; 0 for what is straight ahead,
/// but for rounding.
fn part_to_a_side(value: f64, width: f64) -> i64 {
    const ROUNDING: f64 = 1e-6;
    ((value / width).abs() - ROUNDING).ceil().copysign(value) as i64
}

#[cfg(test)]
#[path = "search_tests.rs"]
mod tests;
