//! Keyway's own local planner: it looks for the course through space and time that brings the robot to the end of
//! its route soonest.

mod cost_to_go;
mod course;
mod lattice;
mod meeting;
mod room;
mod search;

use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::{
    Decision, DriveMemory, Evaluation, LocalPlanner, NoCommand, Rejections, Scene, Scratch, StopRule,
    StopRuleConfig, Surroundings,
};
use crate::ConfigError;
use crate::geometry::{Point, Velocity};
use crate::map::GridFrame;
use crate::robot::Robot;
use cost_to_go::{CostToGo, Weighing};
use course::{Judge, State};
use lattice::Lattice;
use meeting::{Foreseen, Meeting};
use room::{Outline, Room};
use search::{Beam, Extent};
use serde::{Deserialize, Serialize};

/// Parameters of [`SpaceTime`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpaceTimeConfig {
    /// How far a course looks ahead \[s\].
    pub horizon_s: f64,
    /// Velocities of a course.
    pub knots: u32,
    /// Courses that are followed at a time.
    pub width: u32,
    /// Room that the robot likes to have around its footprint \[m\].
    pub comfortable_m: f64,
    /// A metre without any room counts as so many more.
    pub discomfort: f64,
    /// Seconds that a second of the hardest steering counts as.
    pub steering: f64,
    /// Room that the robot likes to have to what moves \[m\].
    pub mover_room_m: f64,
    /// Seconds that a second in contact with a mover counts as.
    pub contact: f64,
    /// A standard deviation of what movers accelerate \[m/s²\].
    pub mover_acceleration_mps2: f64,
    /// Whether courses may lead backwards.
    pub backwards: bool,
}

impl SpaceTimeConfig {
    /// Derived from the robot.
    pub fn for_robot(robot: &Robot) -> Self {
        let limits = &robot.limits;
        let inscribed_m = robot.footprint.inscribed_radius_m();
        Self {
            horizon_s: robot.cycle_s + 3.0 * limits.stop_s(),
            knots: 6,
            width: 24,
            comfortable_m: (0.5 * inscribed_m).max(2.0 * limits.v_max_mps * robot.cycle_s),
            discomfort: 0.5,
            steering: 0.03,
            mover_room_m: inscribed_m.max(2.0 * limits.v_max_mps * robot.cycle_s),
            contact: 30.0,
            mover_acceleration_mps2: 0.5,
            backwards: limits.v_min_mps < 0.0,
        }
    }
}

/// The planner.
#[derive(Clone, Debug)]
pub struct SpaceTime {
    config: SpaceTimeConfig,
    robot: Robot,
    outline: Outline,
    gate: StopRule,
}

/// What a decision works in.
#[derive(Debug, Default)]
struct Work {
    room: Room,
    cost_to_go: CostToGo,
    movers: Vec<Foreseen>,
    route: Vec<Point>,
    beam: Beam,
}

impl SpaceTime {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "space-time";

    /// A planner for a robot.
    ///
    /// # Errors
    /// When a value of the robot or the config cannot be used; the error names the field.
    pub fn new(config: SpaceTimeConfig, robot: Robot) -> Result<Self, ConfigError> {
        let gate = StopRule::new(StopRuleConfig::for_robot(&robot), robot.clone())?;
        Ok(Self { outline: Outline::of(&robot), config, robot, gate })
    }

    /// What the first cycle of a course asks for.
    fn command(&self, scene: &Scene<'_>, first: Velocity, knot_s: f64) -> Velocity {
        let Robot { limits, cycle_s, .. } = &self.robot;
        let asked = scene.velocity.lerp(first, (cycle_s / knot_s).min(1.0));
        let stoppable = limits.stoppable_mps(scene.velocity.v, scene.remaining_m, *cycle_s);
        let asked = Velocity::new(asked.v.clamp(-stoppable, stoppable), asked.omega);
        limits.reached(scene.velocity, asked, *cycle_s)
    }

    /// What the stop rule lets pass of it.
    fn gated(&self, scene: &Scene<'_>, command: Velocity, scratch: &mut Scratch) -> Velocity {
        let Scene { obstacles, pose, velocity, .. } = *scene;
        let around = Surroundings { obstacles, movers: &[], delay_s: 0.0, pose, velocity };
        self.gate.gate(&around, command, scratch).command
    }

    fn reach_m(&self) -> f64 {
        self.robot.limits.v_max_mps * self.config.horizon_s
    }

    /// Takes in what is around the robot; the length of the route beyond the lattice.
    fn look(&self, work: &mut Work, scene: &Scene<'_>, covered_m: f64) -> f64 {
        let frame = scene.obstacles.frame();
        let at = local(frame, scene.pose.point());
        let inscribed_m = self.outline.inscribed_m.max(frame.resolution_m());
        let reach_m = self.reach_m() + self.outline.circumscribed_m + 2.0 * inscribed_m;
        let fine = Lattice::around(frame, at, reach_m, inscribed_m / 3.0);
        work.room.fill(fine, scene.obstacles);
        let coarse = Lattice::around(frame, at, reach_m - inscribed_m, inscribed_m / 2.0);
        let outside_m = reach_m - 2.0 * inscribed_m;
        let (end, rest_m) = self.route_ahead(work, scene, covered_m, outside_m);
        let margin_m = self.robot.safety_margin_m();
        let turning_m = self.outline.circumscribed_m + margin_m;
        let weighing = Weighing {
            blocked_m: self.outline.inscribed_m + margin_m,
            turning_m,
            comfortable_m: turning_m + self.config.comfortable_m,
            discomfort: self.config.discomfort,
        };
        let room = &work.room;
        work.cost_to_go.fill(
            coarse,
            &weighing,
            |point| room.of_point(point),
            (at, &work.route, end),
            0.5 * self.reach_m(),
        );
        rest_m
    }

    /// The route from where the robot is until it leaves the square around it: its last point, and what is left of it there.
    fn route_ahead(
        &self,
        work: &mut Work,
        scene: &Scene<'_>,
        covered_m: f64,
        outside_m: f64,
    ) -> (Point, f64) {
        let frame = scene.obstacles.frame();
        let at = local(frame, scene.pose.point());
        let inside = |point: Point| {
            (point.x - at.x).abs() < outside_m && (point.y - at.y).abs() < outside_m
        };
        let length_m = scene.path.length_m();
        work.route.clear();
        let mut along_m = 0.0;
        let mut from = scene.path.at_length(covered_m).map(|point| local(frame, point));
        if let Some(first) = from {
            work.route.push(first);
        }
        for segment in scene.path.segments() {
            let to_m = along_m + segment.a.distance(segment.b);
            if to_m > covered_m {
                let to = local(frame, segment.b);
                let start = from.unwrap_or(to);
                if !inside(to) && inside(start) {
                    // Where it leaves.
                    let (mut near, mut far) = (0.0, 1.0);
                    for _ in 0..20 {
                        let middle = 0.5 * (near + far);
                        *(if inside(start + (to - start) * middle) { &mut near } else { &mut far }) =
                            middle;
                    }
                    let end = start + (to - start) * near;
                    work.route.push(end);
                    let driven_m = start.distance(end);
                    let begun_m = along_m.max(covered_m);
                    return (end, length_m - begun_m - driven_m);
                }
                work.route.push(to);
                from = Some(to);
            }
            along_m = to_m;
        }
        let end = work.route.last().copied().unwrap_or(at);
        (end, 0.0)
    }

    fn foresee(&self, work: &mut Work, scene: &Scene<'_>) {
        let frame = scene.obstacles.frame();
        let (sin, cos) = libm::sincos(-frame.origin().theta);
        let turned = |v: Point| Point::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos);
        let body_m = if self.outline.circumscribed_m > self.outline.inscribed_m {
            0.5 * (self.outline.circumscribed_m + self.outline.inscribed_m)
        } else {
            self.outline.circumscribed_m
        };
        work.movers.clear();
        let horizon_s = self.config.horizon_s;
        for mover in scene.movers.iter().filter(|mover| mover.is_usable()) {
            let apart_m = mover.centre.distance(scene.pose.point());
            let meets_m = self.reach_m() + mover.velocity_mps.norm() * horizon_s;
            if apart_m > meets_m + mover.radius_m + 2.0 {
                continue;
            }
            let disc_m = mover.radius_m;
            work.movers.push(Foreseen {
                centre: local(frame, mover.centre),
                velocity_mps: turned(mover.velocity_mps),
                reach_m: mover.radius_m + body_m,
                off_m: mover.position_uncertainty_m / 3.0,
                off_mps: mover.velocity_uncertainty_mps / 3.0,
                off_mps2: self.config.mover_acceleration_mps2,
                wall_s: 0.0,
            });
            if let Some(mover) = work.movers.last_mut() {
                mover.wall_s = until_wall_s(mover, disc_m, &work.room, horizon_s);
            }
        }
    }
}

/// When a mover comes to something that stands \[s\]; at most the horizon.
fn until_wall_s(mover: &Foreseen, disc_m: f64, room: &Room, horizon_s: f64) -> f64 {
    let speed_mps = mover.velocity_mps.norm();
    let begins_m = room.of_point(mover.centre).min(disc_m);
    let mut after_s = 0.0;
    while after_s < horizon_s {
        let room_m = room.of_point(mover.centre + mover.velocity_mps * after_s);
        if room_m < 0.7 * begins_m {
            return after_s;
        }
        let step_m = (room_m - 0.7 * begins_m).max(0.05);
        after_s += step_m / speed_mps.max(1e-3);
    }
    horizon_s
}

/// A position along the axes of the map's cells, from the map's corner \[m\].
fn local(frame: &GridFrame, point: Point) -> Point {
    frame.grid_from_world(point) * frame.resolution_m()
}

impl LocalParameters for SpaceTimeConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Robot) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(SpaceTime::new(self.clone(), robot.clone())?))
    }
}

impl LocalPlanner for SpaceTime {
    fn decide(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let position = scene.pose.point();
        let window_m = self.reach_m();
        memory.covered_m = scene.path.nearest_along(position, memory.covered_m, window_m);
        let mut work = std::mem::take(scratch.part::<Work>());
        let beyond_m = self.look(&mut work, scene, memory.covered_m);
        self.foresee(&mut work, scene);
        let frame = scene.obstacles.frame();
        let start = State {
            at: local(frame, position),
            ahead: search::unit(scene.pose.theta - frame.origin().theta),
            velocity: scene.velocity,
            after_s: 0.0,
        };
        let meeting = Meeting {
            movers: &work.movers,
            comfortable_m: self.config.mover_room_m,
            contact: self.config.contact,
        };
        let comfortable_m = self.config.comfortable_m;
        let now_m = self.outline.room_m(&work.room, start.at, start.ahead, comfortable_m);
        let judge = Judge {
            limits: &self.robot.limits,
            outline: &self.outline,
            room: &work.room,
            cost_to_go: &work.cost_to_go,
            meeting: &meeting,
            beyond_m,
            comfortable_m,
            discomfort: self.config.discomfort,
            least_m: self.robot.safety_margin_m().min(now_m - 1e-6),
            steering: self.config.steering,
            knot_s: self.config.horizon_s / f64::from(self.config.knots),
            steps: 4,
        };
        let extent = Extent {
            knots: self.config.knots,
            width: self.config.width as usize,
            bin_m: 0.5 * self.outline.inscribed_m.max(0.05),
            backwards: self.config.backwards,
        };
        let mut beam = std::mem::take(&mut work.beam);
        let mut any = |_: Velocity| true;
        let mut tally = beam.search(start, &judge, &extent, &mut any);
        search::polish(&mut beam.best, &start, &judge, extent.backwards);
        let mut command = beam.best.first().map(|&first| self.command(scene, first, judge.knot_s));
        if command.is_some_and(|command| self.gated(scene, command, scratch) != command) {
            let mut passes = |first: Velocity| {
                let command = self.command(scene, first, judge.knot_s);
                self.gated(scene, command, scratch) == command
            };
            tally = beam.search(start, &judge, &extent, &mut passes);
            command = beam.best.first().map(|&first| self.command(scene, first, judge.knot_s));
        }
        work.beam = beam;
        *scratch.part::<Work>() = work;
        let mut rejected = Rejections::none_by(&[
            ("contact", "touch something"),
            (Rejections::MOVER, "lead into something that moves"),
        ]);
        if tally.meeting > 0 {
            rejected.add(Rejections::MOVER);
        }
        let driving = if tally.meeting > 0 { 0 } else { tally.tried - tally.touching };
        let evaluation =
            Evaluation { candidates: tally.tried, driving, rejected, ..Evaluation::default() };
        let cycle_s = self.robot.cycle_s;
        let braked = self.robot.limits.braked(scene.velocity, cycle_s);
        let Some(command) = command else {
            return Err(NoCommand { evaluation, fallback: braked });
        };
        Ok(Decision { command: self.gated(scene, command, scratch), evaluation })
    }
}
