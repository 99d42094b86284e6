//! All rollouts of a cycle.

use super::body::Body;
use super::contacts::Contacts;
use super::counting::Counting;
use super::motion::{Timing, TurnRatePoses};
use super::rollout::DistanceAt;
use super::rollouts::Rollouts;
use super::speeds::{Bounds, Speeds};
use super::stretch::Stretch;
use super::window::Lattice;
use crate::local::Scene;
use crate::map::{NearBoxes, NearObstacles, Placement, Reach, Turned, on_grid};

/// The inputs that all rollouts of a cycle share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roller<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) body: Body<'a>,
    pub(super) timing: Timing,
    /// Point of the trajectory for the distance in the evaluation.
    pub(super) evaluated_at: DistanceAt,
    /// Point of the trajectory for the distance in eq. (7).
    pub(super) stopping_at: DistanceAt,
    pub(super) distance_cap_m: f64,
}

/// Working memory.
#[derive(Debug, Default)]
pub(super) struct RollMemory {
    near: NearBoxes,
    turned: Turned,
    motion: TurnRatePoses,
    /// The speeds with a certain contact.
    touching: Vec<bool>,
    bounds: Bounds,
    rollouts: Rollouts,
}

impl RollMemory {
    /// The rollouts that [`Roller::roll`] made last.
    pub(super) const fn rollouts(&self) -> &Rollouts {
        &self.rollouts
    }

    /// The same, for rules that refuse more of them.
    pub(super) const fn rollouts_mut(&mut self) -> &mut Rollouts {
        &mut self.rollouts
    }
}

impl Roller<'_> {
    /// Slack subtracted from every required distance \[cells\], because distances are rounded.
    const ROUNDING_CELLS: f64 = 1e-9;

    /// Rolls out every candidate. Those whose footprint would touch something or leave the map
    /// are refused, and all of them if numbers are not finite.
    pub(super) fn roll(&self, lattice: &Lattice, memory: &mut RollMemory) {
        memory.rollouts.forget_stopping_distances();
        if self.stopping_at != self.evaluated_at {
            self.roll_at(self.stopping_at, lattice, memory);
            memory.rollouts.keep_as_stopping_distances();
        }
        self.roll_at(self.evaluated_at, lattice, memory);
    }

    /// The same with the distances at one point of the trajectory.
    fn roll_at(&self, distance_at: DistanceAt, lattice: &Lattice, memory: &mut RollMemory) {
        let RollMemory { near, turned, motion, touching, bounds, rollouts } = memory;
        if !self.is_finite() {
            rollouts.refuse_all(lattice);
            return;
        }
        let (field, core) = (self.scene.obstacles, &self.body.core);
        let frame = field.frame();
        let mut counting = self.counting(lattice, distance_at);
        let reach = self.reach(&counting, lattice);
        let mut surroundings = NearObstacles::new(core, field, reach, near);
        let (origin, ahead) = on_grid(self.scene.pose, frame);
        turned.turn(core, ahead);
        let start = Placement { origin, turned };
        let border = surroundings.to_border(&start);
        counting.is_near_border = border < self.farthest_way_cells(lattice) + reach.way;
        let is_open = !counting.is_near_border
            && surroundings.is_beyond(origin, self.farthest_way_cells(lattice) + counting.enough);
        let all_mps = lattice.speeds_mps();
        rollouts.reset(lattice, self.distance_m(counting.farthest));
        for &omega_radps in lattice.turn_rates_radps() {
            motion.fill(&self.timing, (origin, ahead), omega_radps, !is_open);
            rollouts.push(motion.judged(&self.timing, frame));
            let near = if is_open {
                0..0
            } else {
                counting.near_poses(motion, &surroundings, lattice.ends_mps())
            };
            if near.is_empty() {
                rollouts.compare(lattice, self.scene.guide);
                continue;
            }
            Contacts {
                counting: &counting,
                motion,
                surroundings: &mut surroundings,
                core,
                all_mps,
                turned,
            }
            .find(&near, touching);
            if touching.contains(&false) {
                motion.turn(core, &near);
                rollouts.compare(lattice, self.scene.guide);
            }
            let mut speeds = Speeds {
                frame,
                counting: &counting,
                timing: &self.timing,
                motion,
                surroundings: &mut surroundings,
                bounds,
                all_mps,
                omega_radps,
                core,
            };
            speeds.judge(&near, touching, |row, distance| {
                rollouts.set(lattice, row, distance.map(|distance| self.distance_m(distance)));
            });
        }
    }

    /// The footprint's distance for a distance of the core in cells \[m\].
    fn distance_m(&self, cells: f64) -> f64 {
        cells * self.scene.obstacles.frame().resolution_m() - self.body.offset_m
    }

    fn is_finite(&self) -> bool {
        let Scene { pose, velocity, .. } = self.scene;
        [pose.x, pose.y, pose.theta, velocity.v, velocity.omega].iter().all(|n| n.is_finite())
    }

    fn counting(&self, lattice: &Lattice, distance_at: DistanceAt) -> Counting {
        let cell_m = self.scene.obstacles.frame().resolution_m();
        let contact = self.body.contact_m / cell_m - Self::ROUNDING_CELLS;
        let farthest = (self.distance_cap_m + self.body.offset_m) / cell_m;
        let [longest, _] = self.stretches(lattice);
        let is_point = self.body.core.vertices().is_empty();
        Counting {
            contact,
            certain: if is_point { contact.max(Self::ROUNDING_CELLS) } else { contact },
            farthest,
            counts_all: distance_at == DistanceAt::Trajectory,
            enough: farthest.max(contact.abs() + longest),
            is_near_border: true,
        }
    }

    /// The longest stretch of any candidate, and all of them together \[cells\].
    fn stretches(&self, lattice: &Lattice) -> [f64; 2] {
        let fastest = lattice.fastest();
        let moves = |number| {
            let swing_m = self.body.core.swing_m();
            let stretch = Stretch::new(&self.timing, number, fastest, swing_m);
            stretch.moves_m / self.scene.obstacles.frame().resolution_m()
        };
        let (first, other) = (moves(0), moves(1));
        [first.max(other), first + other * self.timing.steps as f64]
    }

    fn farthest_way_cells(&self, lattice: &Lattice) -> f64 {
        self.stretches(lattice)[1]
    }

    /// The reach of the queries: all distances up to those that count, with the candidates of the
    /// window evaluated together.
    fn reach(&self, counting: &Counting, lattice: &Lattice) -> Reach {
        let ([longest, _], contact) = (self.stretches(lattice), counting.contact.abs());
        let Timing { ramp_s, steps, step_s, .. } = self.timing;
        let horizon_s = ramp_s + step_s * steps as f64;
        let cell_m = self.scene.obstacles.frame().resolution_m();
        let [low_mps, high_mps] = lattice.ends_mps();
        let spread = 0.5 * (high_mps - low_mps) * horizon_s / cell_m;
        let distance = counting.enough + spread;
        // `way`: half a stretch, and its largest deviation from a straight line. `spread`: on
        // distances longer than the size of the robot, boxes are searched for again in parts of
        // them.
        let size = self.body.core.swing_m() / cell_m + contact;
        Reach { distance, way: contact + longest, spread: spread.min(size) }
    }
}
