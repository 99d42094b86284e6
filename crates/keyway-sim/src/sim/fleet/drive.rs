//! State of one robot during a simulation.

use super::{Entrant, Touched};
use crate::sim::cycle_motion::CycleMotion;
use crate::sim::disturbances::{Actuation, Localisation, Sensing, Source, TrueState};
use crate::sim::lidar::Beams;
use crate::sim::rules::{Arrival, ReachedBy, StuckWatch, cycles_within};
use crate::sim::social_force::Body;
use crate::sim::sweep::{MoverSweep, Moving, PairSweep, StandingSweep};
use crate::sim::{
    MoverWay, MovingObstacle, Obstacle, Outcome, RobotState, Run, TrajectoryPoint, World, WorldAt,
};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::robot::{RangeSensor, Robot};
use keyway::sense::{Scan, SensorScan};
use std::borrow::Cow;

/// A run that is in progress or has ended.
pub(super) struct Drive<'a> {
    pub(super) robot: Cow<'a, Robot>,
    goal: Point,
    goal_tolerance_m: f64,
    pub(super) arrival: Arrival,
    reached_by: ReachedBy,
    pub(super) last_cycle: u64,
    pub(super) pose: Pose,
    pub(super) velocity: Velocity,
    pub(super) cycles: u64,
    length_m: f64,
    pub(super) least: Clearances,
    pub(super) sensors: Vec<Sensor>,
    /// State that is reported to the controller for [`Self::pose`] and [`Self::velocity`].
    pub(super) told: RobotState,
    /// Disturbances of the robot, each `None` if nothing is disturbed.
    pub(super) actuation: Option<Actuation>,
    localisation: Option<Localisation>,
    samples: Vec<TrajectoryPoint>,
    pub(super) progress: StuckWatch,
    /// Motion in the current cycle.
    pub(super) motion: CycleMotion,
    /// Object touched in the current cycle.
    touched: Option<Touched>,
    pub(super) outcome: Option<Outcome>,
}

/// Smallest clearances of a run so far \[m\]; infinite if there is no obstacle of the kind.
#[derive(Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "names end with their unit")]
pub(super) struct Clearances {
    pub(super) standing_m: f64,
    pub(super) movers_m: f64,
    pub(super) robots_m: f64,
}

/// A sensor of a robot.
pub(super) struct Sensor {
    pub(super) beams: Beams,
    pub(super) sensing: Sensing,
    /// The last scan; every beam is NaN if there was none in the last cycle.
    pub(super) scan: Scan,
    /// True if there was a scan in the last cycle.
    pub(super) is_given: bool,
}

impl Sensor {
    fn new(described: &RangeSensor, sensing: Sensing) -> Self {
        let beams = Beams::of(described);
        Self { scan: beams.scan(), beams, sensing, is_given: false }
    }
}

impl<'a> Drive<'a> {
    pub(super) fn new(index: usize, entrant: Entrant<'a>, cycle_s: f64) -> Self {
        let Entrant { robot, start: pose, goal, disturbances, rules } = entrant;
        let source = Source { seed: disturbances.seed, robot: index, sensor: 0 };
        let velocity = Velocity::ZERO;
        let sensor = |(sensor, described): (usize, &RangeSensor)| {
            let source = Source { sensor, ..source };
            let faults = disturbances.sensor.clone();
            Sensor::new(described, Sensing::new(faults, source, (described, cycle_s)))
        };
        let sensors = robot.sensors.iter().enumerate().map(sensor).collect();
        let actuation = Actuation::new(disturbances.actuation, source, &robot);
        let infinite_m = f64::INFINITY;
        Self {
            robot,
            goal,
            goal_tolerance_m: rules.goal_tolerance_m,
            arrival: rules.arrival,
            reached_by: rules.reached_by,
            last_cycle: cycles_within(rules.time_limit_s, cycle_s),
            pose,
            velocity,
            cycles: 0,
            length_m: 0.0,
            least: Clearances {
                standing_m: infinite_m,
                movers_m: infinite_m,
                robots_m: infinite_m,
            },
            sensors,
            told: RobotState { stamp_s: 0.0, pose, velocity },
            actuation,
            localisation: Localisation::new(disturbances.localisation, source, cycle_s),
            samples: vec![TrajectoryPoint { t_s: 0.0, pose, velocity }],
            progress: StuckWatch::new(&rules, cycle_s),
            motion: CycleMotion::standing(pose, cycle_s),
            touched: None,
            outcome: None,
        }
    }

    /// Time at the beginning of the next cycle \[s\].
    pub(super) fn time_s(&self, cycle_s: f64) -> f64 {
        self.cycles as f64 * cycle_s
    }

    pub(super) fn is_near_goal(&self) -> bool {
        let pose = match self.reached_by {
            ReachedBy::Truth => self.pose,
            ReachedBy::Belief => self.told.pose,
        };
        pose.point().distance(self.goal) <= self.goal_tolerance_m
    }

    /// Turns the exact scans of this cycle, if any, into the scans that the controller gets.
    pub(super) fn learn_scans(&mut self) {
        for sensor in &mut self.sensors {
            sensor.is_given = sensor.sensing.give(self.cycles, &mut sensor.scan);
        }
    }

    /// Updates the reported pose and velocity.
    pub(super) fn learn_place(&mut self, cycle_s: f64) {
        let (pose, t_s, driven_m) = (self.pose, self.time_s(cycle_s), self.length_m);
        let actuation = self.actuation.as_ref();
        let odometry = actuation.map_or(self.velocity, |it| it.odometry(self.velocity));
        let (mut stamp_s, mut told) = (t_s, (pose, odometry));
        if let Some(localisation) = &mut self.localisation {
            told = localisation.told(TrueState { t_s, pose, odometry, driven_m });
            stamp_s = localisation.stamp_s(self.cycles);
        }
        self.told = RobotState { stamp_s, pose: told.0, velocity: told.1 };
    }

    /// Scans that the controller gets in this cycle.
    pub(super) fn scans(&self) -> Vec<SensorScan<'_>> {
        let given = self.sensors.iter().enumerate().filter(|(_, sensor)| sensor.is_given);
        given
            .map(|(sensor, Sensor { beams, sensing, scan, .. })| SensorScan {
                stamp_s: sensing.stamp_s(self.cycles),
                sensor,
                mount: beams.mount(),
                scan: scan.borrowed(),
            })
            .collect()
    }

    /// True if the robot is stationary and no pending command moves it.
    pub(super) fn is_at_rest(&self) -> bool {
        let will_stand = self.actuation.as_ref().is_none_or(Actuation::is_at_rest);
        self.velocity == Velocity::ZERO && will_stand
    }

    /// True if the robot's run has not ended and it has touched nothing.
    pub(super) const fn is_moving(&self) -> bool {
        self.outcome.is_none() && self.touched.is_none()
    }

    fn moving(&self) -> Moving<'_> {
        Moving { footprint: &self.robot.footprint, motion: &self.motion }
    }

    pub(super) fn sweep<'s>(&'s self, world: &'s World, cycle_s: f64) -> StandingSweep<'s> {
        StandingSweep { world, start_s: self.time_s(cycle_s), robot: self.moving() }
    }

    pub(super) fn beside<'s>(&'s self, mover: &'s MovingObstacle, cycle_s: f64) -> MoverSweep<'s> {
        MoverSweep { mover, robot: self.moving(), start_s: self.time_s(cycle_s) }
    }

    pub(super) fn pair<'s>(&'s self, other: &'s Self) -> PairSweep<'s> {
        PairSweep { robots: [self.moving(), other.moving()] }
    }

    /// Records a contact in the current cycle, unless the robot is already stopped.
    pub(super) fn touch(&mut self, place: f64, with: Touched) {
        if self.is_moving() {
            self.touched = Some(with);
            self.motion.stop_at(place);
        }
    }

    /// Moves the robot to the end of the cycle or to the contact.
    pub(super) fn advance(&mut self, world: &World, cycle_s: f64) {
        let end = self.motion.stop();
        self.pose = self.motion.pose(end);
        self.velocity = self.motion.velocity(end);
        self.length_m += self.motion.driven_m(end);
        let start_s = self.time_s(cycle_s);
        let t_s = (self.cycles as f64 + end / CycleMotion::END) * cycle_s;
        self.cycles += 1;
        self.samples.push(TrajectoryPoint { t_s, pose: self.pose, velocity: self.velocity });
        if let Some(with) = self.touched {
            self.collide(end, with, &world.at(start_s), cycle_s);
        }
    }

    /// Ends the run with a contact at a place on the current motion, in the world at the
    /// beginning of the cycle.
    pub(super) fn collide(&mut self, place: f64, with: Touched, world: &WorldAt<'_>, cycle_s: f64) {
        let (jumped_onto, mover_speed_mps) = match with {
            Touched::Mover { jumped_onto, speed_mps, .. } => (jumped_onto, Some(speed_mps)),
            Touched::Standing { appeared } => (appeared, None),
            Touched::Robot(_) => (false, None),
        };
        let with = match with {
            Touched::Standing { .. } => world.nearest_standing(&self.robot.footprint, self.pose),
            Touched::Mover { index, .. } => Obstacle::Mover(index),
            Touched::Robot(index) => Obstacle::Robot(index),
        };
        match with {
            Obstacle::Border => {}
            Obstacle::Square
            | Obstacle::HiddenSquare
            | Obstacle::Circle(_)
            | Obstacle::Polygon(_)
            | Obstacle::Elusive(_) => self.least.standing_m = 0.0,
            Obstacle::Mover(_) => self.least.movers_m = 0.0,
            Obstacle::Robot(_) => self.least.robots_m = 0.0,
        }
        let robot_stood = self.motion.keeps_ground_at(place, &self.robot.footprint);
        let pose = self.pose;
        let outcome = Outcome::Collided { pose, with, robot_stood, jumped_onto, mover_speed_mps };
        self.end(outcome, cycle_s);
    }

    /// Ends the run. The robot is stationary from now on.
    pub(super) fn end(&mut self, outcome: Outcome, cycle_s: f64) {
        self.outcome = Some(outcome);
        self.motion = CycleMotion::standing(self.pose, cycle_s);
    }

    /// Body of the robot for the obstacles that give way.
    pub(super) fn body(&self) -> Body {
        let (sin, cos) = libm::sincos(self.pose.theta);
        let v_mps = if self.outcome.is_none() { self.velocity.v } else { 0.0 };
        Body {
            centre: self.pose.point(),
            radius_m: self.robot.footprint.circumscribed_radius_m(),
            velocity_mps: Point::new(cos, sin) * v_mps,
        }
    }

    /// Returns the finished run. `ways` are the paths of all obstacles that give way, up to the
    /// end of the last run.
    pub(super) fn into_run(self, ways: &[MoverWay]) -> Option<Run> {
        let movers = ways.iter().map(|way| way.until(self.cycles)).collect();
        let Clearances { standing_m, movers_m, robots_m } = self.least;
        let if_any = |clearance_m: f64| clearance_m.is_finite().then_some(clearance_m);
        Some(Run {
            outcome: self.outcome?,
            samples: self.samples,
            length_m: self.length_m,
            min_clearance_m: if_any(standing_m.min(movers_m).min(robots_m)),
            min_standing_clearance_m: if_any(standing_m),
            min_mover_clearance_m: if_any(movers_m),
            min_robot_clearance_m: if_any(robots_m),
            movers,
            cycles: self.cycles,
        })
    }
}
