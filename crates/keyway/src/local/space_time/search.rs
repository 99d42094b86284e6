//! Beam search for a trajectory: the most promising ones are extended from stretch to stretch.

use super::course::{Cost, Judge, State};
use super::targets::Targets;
use crate::geometry::Velocity;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A state that some trajectory leads to.
#[derive(Clone, Copy, Debug)]
struct Node {
    state: State,
    cost: Cost,
    /// Index of the node before it.
    parent: u32,
    /// Time and cost so far, and the time to go \[s\].
    total_s: f64,
    /// True if it reaches the end of the route before the next stretch ends.
    arrives: bool,
}

/// A stretch that may become a node. Its end state is known at once; the cost of its surroundings
/// is more expensive, and computed only if the trajectory might be one of the best.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    /// Lower bound of the cost of the trajectory until it `is_driven`; then, its cost \[s\].
    total_s: f64,
    /// Number of the proposal within its level.
    number: u32,
    parent: u32,
    is_driven: bool,
    /// True if it touches nothing and ends elsewhere; known once it `is_driven`.
    leads_elsewhere: bool,
    /// Its cost lacks that of the surroundings until it `is_driven`.
    state: State,
    cost: Cost,
    left_s: f64,
}

/// The one with the lowest total comes first; ties go to the first one.
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

/// Size and resolution of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) stretches: u32,
    pub(super) width: usize,
    /// The slowest speed of a trajectory \[m/s\].
    pub(super) lowest_mps: f64,
    /// Width of the bins along each axis \[m\]: of the trajectories that lead to nearly the same
    /// state, only the best one is extended.
    pub(super) bin_m: f64,
    /// A robot that moves no farther than this within the horizon does not drive, for lack of
    /// space \[m\].
    pub(super) elsewhere_m: f64,
}

/// Counters of a search over the evaluated stretches. Each is counted once: it touches something,
/// is refused, drives, or none of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub(super) tried: u32,
    /// Stretches with a contact.
    pub(super) touching: u32,
    /// Stretches from whose end the robot could not stop, and beginnings that are not admitted.
    pub(super) refused: u32,
    /// Stretches at whose end the robot is elsewhere.
    pub(super) driving: u32,
    /// True if some that lead elsewhere come near a moving obstacle.
    pub(super) meets: bool,
}

/// Working memory of a search, and the result.
#[derive(Debug, Default)]
pub(super) struct Beam {
    nodes: Vec<Node>,
    open: BinaryHeap<Proposal>,
    /// The bins of the nodes of a level.
    bins: Vec<u64>,
    /// The best trajectory: its velocities at the ends of its stretches; empty if none is free.
    pub(super) best: Vec<Velocity>,
}

impl Beam {
    /// Number of stretches at the beginning of a trajectory with more targets than later ones.
    const NEAR: u32 = 2;

    /// Costs of moving obstacles above this count as near to one \[s\].
    pub(super) const MEETING_S: f64 = 0.1;

    /// Finds the best trajectory from a state, of those whose first velocity `begins` admits.
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
        // Without a stretch there is no trajectory.
        let farthest = Some(level.start).filter(|&node| node > 0);
        self.trace(self.better(arrived, farthest));
        tally
    }

    /// The one of two nodes with the lower total.
    fn better(&self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        let both = [a, b].into_iter().flatten();
        both.min_by(|&a, &b| self.nodes[a].total_s.total_cmp(&self.nodes[b].total_s))
    }

    /// Proposes the next stretches of a node, with their end states and lower bounds of their
    /// costs.
    fn propose(&mut self, parent: usize, judge: &Judge<'_>, targets: &Targets) {
        let Node { state: from, cost: so_far, .. } = self.nodes[parent];
        for to in targets.velocities() {
            let (state, cost) = judge.leads_to(&from, &so_far, to);
            let left_s = judge.time_to_go_s(&state);
            self.open.push(Proposal {
                total_s: rounded_s(state.after_s + cost.sum_s() + left_s),
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

    /// Turns the best proposals of different bins from which the robot could stop into nodes, the
    /// best one first.
    ///
    /// A proposal returns to the queue once its cost is known, which is no less than its bound.
    /// So proposals come up in the order of their costs, and those that come up too late are
    /// never evaluated. If nothing drives, all are.
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

    /// Evaluates the surroundings of a proposal, which may return to the queue.
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
        let total_s = rounded_s(state.after_s + cost.sum_s() + proposal.left_s);
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

/// A total in steps of 2⁻³⁰ s. Rounding errors would decide between equal trajectories, and would
/// decide differently in a mirrored world.
fn rounded_s(total_s: f64) -> f64 {
    // Neighbouring numbers of this size differ by that step.
    const COARSE: f64 = 1.5 * (1_u64 << 22) as f64;
    total_s + COARSE - COARSE
}

/// The bin of a state; states of one bin are nearly the same. Bins are relative to the start
/// pose, so its position on the map changes nothing. Positions to the left of the line ahead
/// share no bin with those to the right, so a mirror changes nothing, either.
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

/// Number of a bin to the left, or its negative to the right; 0 straight ahead, up to rounding.
fn part_to_a_side(value: f64, width: f64) -> i64 {
    const ROUNDING: f64 = 1e-6;
    ((value / width).abs() - ROUNDING).ceil().copysign(value) as i64
}

#[cfg(test)]
#[path = "search_tests.rs"]
mod tests;
