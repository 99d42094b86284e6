//! The manoeuvre of a command, braking included, and its checks against contact.

use super::start::{Body, Covered, ROUNDING_M, Start, Touched};
use super::{Refusal, StopRule, StopRuleConfig, Surroundings};
use crate::geometry::{Disc, Point, Pose, Velocity, wrap_angle};
use crate::local::JerkLimited;
use crate::local::rear::{Seen, SeenAhead};
use crate::map::{self, Cell, Core, DistanceField, NearBoxes, Placement, Turned, on_grid};
use crate::robot::Robot;
use crate::sense::{Mover, MoverBounds};
use arrayvec::ArrayVec;

/// Working memory.
#[derive(Debug, Default)]
pub(super) struct Work {
    near: Vec<Mover>,
    shrunk: Vec<Point>,
    touched: Touched,
    /// For each body.
    boxes: [NearBoxes; 2],
    turned: [Turned; 2],
}

/// A body among the obstacles around it.
struct Ground<'a> {
    body: Body<'a>,
    squares: map::NearObstacles<'a>,
    turned: &'a mut Turned,
}

/// All manoeuvres of one cycle: they begin at the same pose and velocity.
pub(super) struct Manoeuvres<'a> {
    config: &'a StopRuleConfig,
    robot: &'a Robot,
    around: &'a Surroundings<'a>,
    /// Ground within which it must stop, and ground over which it may back up; `None`: anywhere.
    ahead: Option<SeenAhead<'a>>,
    behind: Option<Seen<'a>>,
    /// Moving obstacles that may matter.
    near: &'a [Mover],
    /// Empty if no stationary obstacle is within reach of any manoeuvre; two if the robot touches
    /// something.
    grounds: ArrayVec<Ground<'a>, 2>,
    touched: &'a Touched,
    /// The pose at which the clearance from the scan's hits was computed last, and the spare
    /// clearance there \[m\].
    looked: Option<(Pose, f64)>,
    is_covered: bool,
    /// Steps are never shorter than this \[m\].
    least_step_m: f64,
}

/// A stretch of a manoeuvre: an arc that is driven with a constant velocity.
#[derive(Clone, Copy)]
struct Stretch {
    start: Pose,
    velocity: Velocity,
    duration_s: f64,
    /// Time from now to its beginning \[s\].
    after_s: f64,
}

impl Stretch {
    fn pose(&self, elapsed_s: f64) -> Pose {
        self.start.after_arc(self.velocity, elapsed_s)
    }

    fn moves_m(&self, core: &Core<'_>) -> f64 {
        core.moves_m(self.velocity.v * self.duration_s, self.velocity.omega * self.duration_s)
    }

    fn halves(&self) -> [Self; 2] {
        let duration_s = 0.5 * self.duration_s;
        let second =
            Self { start: self.pose(duration_s), after_s: self.after_s + duration_s, ..*self };
        [Self { duration_s, ..*self }, Self { duration_s, ..second }]
    }
}

/// Upper bounds of all manoeuvres of a cycle.
struct Reach {
    /// Largest motion of any part of the footprint \[m\].
    moves_m: f64,
    /// Longest duration \[s\].
    duration_s: f64,
}

impl Reach {
    /// Bounds of all manoeuvres whose velocities lie between the present and the requested one.
    fn new(robot: &Robot, core: &Core<'_>, around: &Surroundings<'_>, asked: Velocity) -> Self {
        let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
        let from = around.jerk_limited.map_or(around.velocity, |robot| robot.fastest());
        let v = from.v.abs().max(asked.v.abs());
        let omega = from.omega.abs().max(asked.omega.abs());
        let stop_s = (v / limits.deceleration_mps2).max(omega / limits.angular_deceleration_radps2);
        // The mean speed while braking is half of the initial one; the last cycle may be braked
        // more gently.
        let full_s = cycle_s + 0.5 * (stop_s + cycle_s);
        let duration_s = 2.0 * cycle_s + stop_s;
        // With averaging, a robot moves no farther than the reference, and what is still
        // averaged; one that deviates from its commands first brakes to them.
        let (more_s, later_s) = around.jerk_limited.map_or((0.0, 0.0), |_| {
            let smoothed_s = 2.0 * robot.smoothing_lag_s() + cycle_s;
            (smoothed_s + full_s, smoothed_s + duration_s)
        });
        let full_s = full_s + more_s;
        Self { moves_m: core.moves_m(v * full_s, omega * full_s), duration_s: duration_s + later_s }
    }
}

impl<'a> Manoeuvres<'a> {
    /// Distances below this cannot be distinguished from contact \[m\].
    const LEAST_STEP_M: f64 = 1e-4;

    /// The manoeuvres whose first velocity lies between braking and the requested one.
    pub(super) fn new(
        StopRule { config, robot, front, rear }: &'a StopRule,
        around: &'a Surroundings<'a>,
        asked: Velocity,
        Work { near, shrunk, touched, boxes, turned }: &'a mut Work,
    ) -> Self {
        let (core, _) = robot.footprint.core();
        let reach = Reach::new(robot, &core, around, asked);
        collect_near(near, config, robot, around, &reach);
        let start = Start { robot, around, margin_m: config.margin_m };
        touched.clear();
        let (bodies, is_covered) = match start.bodies(reach.moves_m, shrunk, touched) {
            Ok(bodies) => (bodies, false),
            Err(Covered) => (ArrayVec::new(), true),
        };
        let touched = &*touched;
        let kept_m = bodies.iter().map(|body| body.kept_m).chain([touched.places_kept_m]);
        let least_kept_m = kept_m.fold(config.margin_m, f64::min);
        let left_out: [&[Cell]; 2] = [&[], &touched.squares];
        let places = boxes.iter_mut().zip(turned).zip(left_out);
        let grounds = bodies.into_iter().zip(places).map(|(body, ((boxes, turned), left_out))| {
            let farthest_m = body.radius_m + config.margin_m + reach.moves_m;
            let distance = farthest_m / around.obstacles.frame().resolution_m();
            let reach = map::Reach { distance, way: 0.0, spread: 0.0 };
            let squares = map::NearObstacles::new(&body.core, around.obstacles, reach, boxes);
            Ground { body, squares: squares.without(left_out), turned }
        });
        let grounds = grounds.collect();
        Self {
            config,
            robot,
            around,
            ahead: around.seen.ahead.map(|cells| front.over(cells, around.obstacles.clearance())),
            behind: around.seen.behind.map(|cells| rear.over(cells, around.obstacles.frame())),
            near,
            grounds,
            touched,
            looked: None,
            is_covered,
            least_step_m: least_kept_m.max(Self::LEAST_STEP_M),
        }
    }

    /// Checks that a manoeuvre that begins with a cycle towards `first` is admissible.
    pub(super) fn check(&mut self, first: Velocity) -> Result<(), Refusal> {
        let from = self.from(first);
        let is_moved = self.around.jerk_limited.is_some_and(|robot| !robot.window.is_zero());
        if from == Velocity::ZERO && first == Velocity::ZERO && !is_moved {
            return Ok(());
        }
        if self.is_covered {
            return Err(Refusal::Covered);
        }
        // The rest of a motion that is reversed leads back, too, which is unavoidable.
        let leads = |sign: f64| {
            let is_there = |v: f64| v * sign > 0.0;
            is_there(first.v) || self.around.jerk_limited.is_some_and(|robot| robot.leads(is_there))
        };
        let behind = self.behind.filter(|_| leads(-1.0));
        let ahead = self.ahead.filter(|_| leads(1.0));
        let is_seen = behind.is_none() && ahead.is_none();
        if self.grounds.is_empty() && self.near.is_empty() && is_seen {
            return Ok(());
        }
        let robot = self.robot;
        let (limits, cycle_s) = (&robot.limits, robot.cycle_s);
        let braking = std::iter::successors(Some(first), |&last| {
            let braked = || limits.reached(last, limits.braked(last, cycle_s), cycle_s);
            (last != Velocity::ZERO).then(braked)
        });
        match self.around.jerk_limited {
            None => self.follow(from, braking, (ahead, behind)),
            Some(it) => self.follow(from, it.velocities(from, braking, robot), (ahead, behind)),
        }
    }

    /// Refuses a manoeuvre that is not admissible, given its initial velocity and those at the
    /// ends of its cycles.
    fn follow(
        &mut self,
        mut from: Velocity,
        velocities: impl Iterator<Item = Velocity>,
        (ahead, behind): (Option<SeenAhead<'a>>, Option<Seen<'a>>),
    ) -> Result<(), Refusal> {
        let arc_s = self.robot.cycle_s / f64::from(Pose::RAMP_ARCS);
        let (mut pose, mut after_s) = (self.around.robot().0, self.around.delay_s);
        let mut spare_m = f64::NEG_INFINITY;
        // Distance driven ahead since the front was checked last.
        let (mut unlooked_m, cell_m) = (0.0, self.around.obstacles.frame().resolution_m());
        for to in velocities {
            for velocity in Pose::ramp_arcs(from, to) {
                let stretch = Stretch { start: pose, velocity, duration_s: arc_s, after_s };
                spare_m = self.check_standing(&stretch, spare_m)?;
                self.near.iter().try_for_each(|mover| self.check_mover(&stretch, mover))?;
                pose = stretch.pose(arc_s);
                after_s += arc_s;
                let is_late = after_s > self.robot.backing_s() + 1e-9;
                let refuses =
                    |seen: Seen<'_>| is_late || !self.is_on(pose, |at, to| seen.holds(at, to));
                if velocity.v < 0.0 && behind.is_some_and(refuses) {
                    return Err(Refusal::Unseen { after_s });
                }
                // Cells need not be checked more than once.
                unlooked_m += velocity.v.max(0.0) * arc_s;
                if unlooked_m >= 0.5 * cell_m {
                    self.check_sight(ahead, pose, after_s)?;
                    unlooked_m = 0.0;
                }
            }
            // If steps are longer than the spare clearance, the ends of cycles are checked,
            // because the next command begins there.
            if spare_m < 0.0 {
                spare_m = self.look(pose, after_s, 0.0)?;
            }
            from = to;
        }
        if unlooked_m > 0.0 { self.check_sight(ahead, pose, after_s) } else { Ok(()) }
    }

    /// Refuses a pose whose front is not within observed free space.
    fn check_sight(
        &self,
        ahead: Option<SeenAhead<'_>>,
        pose: Pose,
        after_s: f64,
    ) -> Result<(), Refusal> {
        let is_seen = ahead.is_none_or(|seen| self.is_on(pose, |at, to| seen.holds(at, to)));
        if is_seen { Ok(()) } else { Err(Refusal::OutOfSight { after_s }) }
    }

    /// True if a pose is on some cells. The predicate gets its position from the corner of the
    /// grid \[m\] and its direction there.
    fn is_on(&self, pose: Pose, holds: impl Fn(Point, Point) -> bool) -> bool {
        let frame = self.around.obstacles.frame();
        let (origin, ahead) = on_grid(pose, frame);
        holds(origin * frame.resolution_m(), ahead * frame.resolution_m())
    }

    /// The velocity at which a manoeuvre begins. The odometry of a stationary robot is noise,
    /// unless it is asked to move: otherwise it could not turn away from a wall that the noise
    /// seems to lead to. If it is not noise, it is the end of a manoeuvre that was admissible.
    fn from(&self, first: Velocity) -> Velocity {
        let (_, now) = self.around.robot();
        let Velocity { v, omega, .. } = now;
        let is_still = |it: JerkLimited<'_>| it.window.is_still(self.robot);
        let is_standing = self.robot.stands(now) && self.around.jerk_limited.is_none_or(is_still);
        let unless_noise =
            |now: f64, asked: f64| if is_standing && asked == 0.0 { 0.0 } else { now };
        Velocity::new(unless_noise(v, first.v), unless_noise(omega, first.omega))
    }

    /// Follows a stretch with at least this spare clearance at its beginning (unknown if
    /// negative); returns that at its end.
    fn check_standing(&mut self, stretch: &Stretch, known_m: f64) -> Result<f64, Refusal> {
        // Motion of the whole footprint, even if only a part of it counts.
        let (core, _) = self.robot.footprint.core();
        let moves_m = stretch.moves_m(&core);
        let (mut fraction, mut spare_m) = (0.0, known_m);
        loop {
            let left_m = moves_m * (1.0 - fraction);
            if spare_m >= left_m {
                return Ok(spare_m - left_m);
            }
            let elapsed_s = fraction * stretch.duration_s;
            let after_s = stretch.after_s + elapsed_s;
            spare_m = self.look(stretch.pose(elapsed_s), after_s, left_m)?;
            if spare_m >= left_m {
                return Ok(spare_m - left_m);
            }
            fraction += spare_m.max(self.least_step_m) / moves_m;
            if fraction >= 1.0 {
                return Ok(f64::NEG_INFINITY);
            }
            spare_m = f64::NEG_INFINITY;
        }
    }

    /// Spare clearance at a pose \[m\]; values above `wanted_m` need not be distinguished.
    /// Refused if it is negative.
    fn look(&mut self, pose: Pose, after_s: f64, wanted_m: f64) -> Result<f64, Refusal> {
        let obstacles = self.around.obstacles;
        let spare_m =
            self.grounds.iter_mut().map(|ground| ground.spare_m(pose, obstacles, wanted_m));
        let by_squares_m = spare_m.fold(f64::INFINITY, f64::min);
        let by_places_m = self.places_spare_m(pose, wanted_m.min(by_squares_m));
        let spare_m = by_squares_m.min(by_places_m);
        if spare_m >= 0.0 { Ok(spare_m) } else { Err(Refusal::Standing { after_s }) }
    }

    /// Lower bound of the clearance from the scan's hits, beyond the distance to keep \[m\]. Not
    /// recomputed if it is more than `wanted_m`, nor, like other steps, within the distance to
    /// keep.
    fn places_spare_m(&mut self, pose: Pose, wanted_m: f64) -> f64 {
        if self.touched.places.is_empty() {
            return f64::INFINITY;
        }
        let (core, radius_m) = self.robot.footprint.core();
        if let Some((last, spare_m)) = self.looked {
            let turned_rad = wrap_angle(pose.theta - last.theta);
            let moved_m = core.moves_m(pose.point().distance(last.point()), turned_rad);
            let step_m = self.touched.places_kept_m.max(Self::LEAST_STEP_M);
            if spare_m - moved_m > wanted_m || (wanted_m > 0.0 && moved_m <= step_m) {
                return (spare_m - moved_m).max(0.0);
            }
        }
        let spare_m = self.touched.spare_m((&core, radius_m), pose);
        self.looked = (spare_m >= 0.0).then_some((pose, spare_m));
        spare_m
    }

    /// Shows that a moving obstacle cannot touch the footprint on a stretch, unless the robot is
    /// at rest.
    fn check_mover(&self, stretch: &Stretch, mover: &Mover) -> Result<(), Refusal> {
        let (core, _) = self.robot.footprint.core();
        let stands = stretch.moves_m(&core) <= ROUNDING_M;
        if stands { Ok(()) } else { self.check_apart(stretch, mover) }
    }

    /// Shows it: at the middle of the stretch the footprint is farther from all ground that the
    /// moving obstacle may cover meanwhile than any part of it moves from there. Otherwise each
    /// half is checked.
    fn check_apart(&self, stretch: &Stretch, mover: &Mover) -> Result<(), Refusal> {
        let (core, radius_m) = self.robot.footprint.core();
        let moves_m = stretch.moves_m(&core);
        let bounds = &self.config.movers;
        let middle = stretch.pose(0.5 * stretch.duration_s);
        let until_s = stretch.after_s + stretch.duration_s;
        let gap_m = |disc: &Disc| gap_m(&core, radius_m, middle, disc);
        let by_speed_m = gap_m(&mover.by_speed(until_s, bounds));
        let by_estimate = estimated_between(mover, stretch.after_s, until_s, bounds);
        let apart_m = by_estimate.map_or(by_speed_m, |disc| by_speed_m.max(gap_m(&disc)));
        if apart_m >= self.config.margin_m + 0.5 * moves_m {
            return Ok(());
        }
        let approach_m = moves_m + mover.fastest_mps(bounds) * stretch.duration_s;
        if approach_m < self.config.margin_m.max(Self::LEAST_STEP_M) {
            return Err(Refusal::Mover { id: mover.id, after_s: stretch.after_s });
        }
        stretch.halves().iter().try_for_each(|half| self.check_apart(half, mover))
    }
}

impl Ground<'_> {
    /// Lower bound of the clearance beyond the distance to keep \[m\]: exact if it is neither
    /// `wanted_m` nor a cell.
    fn spare_m(&mut self, pose: Pose, field: &DistanceField, wanted_m: f64) -> f64 {
        let Body { core, radius_m, kept_m, keeps_border } = &self.body;
        let least_m = radius_m + kept_m;
        let (cell_m, point) = (field.frame().resolution_m(), pose.point());
        let seen_m = field.square_bounds_m(point).0.min(field.clearance().to_border(point));
        let lower_m = seen_m - core.swing_m() - least_m;
        if lower_m >= wanted_m.min(cell_m) && lower_m > 0.0 {
            return lower_m;
        }
        let (origin, ahead) = on_grid(pose, field.frame());
        self.turned.turn(core, ahead);
        let at = Placement { origin, turned: self.turned };
        let room = self.squares.distance(&at, f64::INFINITY);
        let room = if *keeps_border { room.min(self.squares.to_border(&at)) } else { room };
        room * cell_m - least_m
    }
}

/// Distance between a footprint and a disc \[m\]; negative when a round footprint overlaps it.
fn gap_m(core: &Core<'_>, radius_m: f64, pose: Pose, disc: &Disc) -> f64 {
    core.distance_to_m(pose, disc.centre) - disc.radius_m - radius_m
}

/// Collects the moving obstacles that some manoeuvre may come near to.
fn collect_near(
    near: &mut Vec<Mover>,
    config: &StopRuleConfig,
    robot: &Robot,
    around: &Surroundings<'_>,
    reach: &Reach,
) {
    let (core, radius_m) = robot.footprint.core();
    near.clear();
    for mover in around.movers.iter().filter(|mover| mover.is_usable()) {
        let gap_m = gap_m(&core, radius_m, around.robot().0, &mover.now());
        let approach_m = mover.fastest_mps(&config.movers) * (around.delay_s + reach.duration_s);
        if gap_m - reach.moves_m - approach_m >= config.margin_m {
            continue;
        }
        near.push(*mover);
    }
}

/// A disc that contains all ground which a moving obstacle may cover between two instants by its
/// estimate.
fn estimated_between(
    mover: &Mover,
    from_s: f64,
    until_s: f64,
    bounds: &MoverBounds,
) -> Option<Disc> {
    let last = mover.by_estimate(until_s, bounds)?;
    let half_way = mover.velocity_mps * (0.5 * (until_s - from_s));
    Some(Disc { centre: last.centre - half_way, radius_m: last.radius_m + half_way.norm() })
}
