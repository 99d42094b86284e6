//! All rollouts of a cycle.

use super::body::Body;
use super::contacts::Contacts;
use super::counting::Counting;
use super::motion::{Judged, Motion, Timing};
use super::rollout::Rollout;
use super::speeds::{Bounds, Speeds};
use super::stretch::Stretch;
use super::window::Lattice;
use crate::geometry::Point;
use crate::local::Scene;
use crate::local::terms::heading;
use crate::map::{NearBoxes, Placement, Reach, Surroundings, Turned, on_grid};

/// What all rollouts of a cycle share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roller<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) body: Body<'a>,
    pub(super) timing: Timing,
    /// Whether the nearest of all poses counts, or the last one alone.
    pub(super) counts_all: bool,
    pub(super) distance_cap_m: f64,
}

/// Memory to work in.
#[derive(Debug, Default)]
pub(super) struct RollMemory {
    near: NearBoxes,
    turned: Turned,
    motion: Motion,
    /// The speeds that surely touch something.
    touching: Vec<bool>,
    bounds: Bounds,
    /// The last rollouts made, in the order of the lattice's candidates.
    rollouts: Vec<Option<Rollout>>,
    headings: Headings,
}

/// Of where candidates are compared with the guide point, [`heading::raw`]: all speeds of a turn rate at once.
#[derive(Debug, Default)]
struct Headings {
    of_column: Vec<f64>,
    /// In the order of the lattice's candidates.
    of_all: Vec<f64>,
}

impl Headings {
    /// Those of one turn rate.
    fn fill(
        &mut self,
        column: usize,
        columns: usize,
        speeds_mps: &[f64],
        judged: Judged,
        guide: Point,
    ) {
        self.of_column.resize(speeds_mps.len(), 0.0);
        for (heading, v_mps) in self.of_column.iter_mut().zip(speeds_mps) {
            *heading = heading::raw(judged.at(*v_mps), guide);
        }
        let of_all = self.of_all[column..].iter_mut().step_by(columns);
        of_all.zip(&self.of_column).for_each(|(one, of_column)| *one = *of_column);
    }
}

impl RollMemory {
    /// The same candidates' headings; of those that touch something any number.
    pub(super) fn headings(&self) -> &[f64] {
        &self.headings.of_all
    }

    /// Those that [`Roller::roll`] made last.
    pub(super) fn rollouts(&self) -> &[Option<Rollout>] {
        &self.rollouts
    }
}

impl Roller<'_> {
    /// What is near a core is kept this much less than it has to be \[cells\], because distances are rounded.
    const ROUNDING_CELLS: f64 = 1e-9;

    /// Rolls out every candidate, in the lattice's order: `None` where the footprint would touch something
    /// on the way or leave the map, and for numbers that are not finite.
    pub(super) fn roll(&self, lattice: &Lattice, memory: &mut RollMemory) {
        let (speeds_mps, turn_rates) = (lattice.speeds_mps(), lattice.turn_rates_radps());
        let RollMemory { near, turned, motion, touching, bounds, rollouts, headings } = memory;
        rollouts.resize(speeds_mps.len() * turn_rates.len(), None);
        headings.of_all.resize(rollouts.len(), 0.0);
        if !self.is_finite() {
            rollouts.fill(None);
            return;
        }
        let (field, core) = (self.scene.obstacles, &self.body.core);
        let frame = field.frame();
        let mut counting = self.counting(lattice);
        let reach = self.reach(&counting, lattice);
        let mut surroundings = Surroundings::new(core, field, reach, near);
        let (origin, ahead) = on_grid(self.scene.pose, frame);
        turned.turn(core, ahead);
        let start = Placement { origin, turned };
        let border = surroundings.to_border(&start);
        counting.is_near_border = border < self.farthest_way_cells(lattice) + reach.way;
        let is_open = !counting.is_near_border
            && surroundings.is_beyond(origin, self.farthest_way_cells(lattice) + counting.enough);
        for (column, &omega_radps) in turn_rates.iter().enumerate() {
            motion.fill(&self.timing, omega_radps, frame);
            let near = if is_open {
                0..0
            } else {
                counting.near_poses(motion, &surroundings, lattice.ends_mps())
            };
            Contacts {
                counting: &counting,
                motion,
                surroundings: &mut surroundings,
                core,
                all_mps: speeds_mps,
                turned,
            }
            .find(&near, touching);
            let judged = motion.judged(&self.timing, frame);
            if touching.contains(&false) {
                motion.turn(core, &near);
                headings.fill(column, turn_rates.len(), speeds_mps, judged, self.scene.guide);
            }
            let mut speeds = Speeds {
                frame,
                counting: &counting,
                timing: &self.timing,
                motion,
                surroundings: &mut surroundings,
                bounds,
                all_mps: speeds_mps,
                omega_radps,
                core,
            };
            speeds.judge(&near, touching, |row, distance| {
                rollouts[row * turn_rates.len() + column] = distance.map(|distance| Rollout {
                    judged: judged.at(speeds_mps[row]),
                    distance_m: distance * frame.resolution_m() - self.body.offset_m,
                });
            });
        }
    }

    fn is_finite(&self) -> bool {
        let Scene { pose, velocity, .. } = self.scene;
        [pose.x, pose.y, pose.theta, velocity.v, velocity.omega].iter().all(|n| n.is_finite())
    }

    fn counting(&self, lattice: &Lattice) -> Counting {
        let cell_m = self.scene.obstacles.frame().resolution_m();
        let contact = self.body.contact_m / cell_m - Self::ROUNDING_CELLS;
        let farthest = (self.distance_cap_m + self.body.offset_m) / cell_m;
        let [longest, _] = self.stretches(lattice);
        Counting {
            contact,
            farthest,
            counts_all: self.counts_all,
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

    /// What is asked for: all distances up to those that count, with the candidates of the window looked at
    /// together.
    fn reach(&self, counting: &Counting, lattice: &Lattice) -> Reach {
        let ([longest, _], contact) = (self.stretches(lattice), counting.contact.abs());
        let Timing { ramp_s, steps, step_s, .. } = self.timing;
        let horizon_s = ramp_s + step_s * steps as f64;
        let cell_m = self.scene.obstacles.frame().resolution_m();
        let [low_mps, high_mps] = lattice.ends_mps();
        let spread = 0.5 * (high_mps - low_mps) * horizon_s / cell_m;
        let distance = counting.enough + spread;
        // Half a stretch, and how far it may deviate from a straight line.
        // On longer ways than the robot is large, boxes are looked for again in parts of them.
        let size = self.body.core.swing_m() / cell_m + contact;
        Reach { distance, way: contact + longest, spread: spread.min(size) }
    }
}
