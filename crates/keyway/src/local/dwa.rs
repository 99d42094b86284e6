//! Dynamic window approach (DWA): a scene -> the velocity for the next cycle.
//!
//! Velocities that can be reached within a cycle are rolled out; those that touch something or could
//! not stop in time are refused; the winner of the rest is the one that best combines heading
//! towards the guide point, distance to obstacles, and speed.
//!
//! # Source
//! \[Fox1997\], in the form of \[You2021\]: equations (4) to (10), tables 2 and 3.
//!
//! | paper | here | unit | table 3 |
//! |---|---|---|---|
//! | dt | `prediction_step_s` | s | 0.1 |
//! | dv | `v_step_mps` | m/s | 0.01 |
//! | d omega | `omega_step_radps` | rad/s | 1 deg/s |
//! | prediction time | `horizon_s` | s | 3 |
//! | alpha | `weights.heading` | | 0.08 |
//! | beta | `weights.distance` | | 0.2 |
//! | gamma | `weights.speed` | | 0.1 |
//! | dist(v, omega) | the footprint's distance along the rollout | m | |
//! | Vm, Vd, Va, Vr | limits, window, admissible, all of them together | | |
//!
//! # Where this differs from the paper
//! - `dist` is capped at `distance_cap_m`, the sensing range.
//! - Contact anywhere on a rollout refuses the candidate, wherever `dist` is measured.
//! - In (10) a term whose sum over the candidates is 0 contributes 0.
//! - (7) bounds the turn rate's magnitude, in radians, and does not apply on the spot, where contact is
//!   refused anyway and nothing else can come nearer.
//! - The window of \[You2021\] is centred on the present velocity; here its ends are candidates, too.
//! - The footprint may be a polygon; the paper's robot is a point.
//! - Nothing admissible: the robot brakes so that it stays on its arc, and at standstill, when it is round,
//!   turns towards the guide point.
//!
//! # Safety
//! With [`Prediction::Arcs`] the horizon is at least a cycle and the time to stop, and the arc on which
//! the robot brakes after a command was part of that command's rollout: among obstacles that stand
//! still and are seen, a robot that starts free never touches anything.
//!
//! # Errors / cost
//! [`NoCommand`] when nothing is admissible. Cost: candidates times poses, most of which need no
//! distance look-up.

use super::body::Standing;
use super::evaluation::{Candidate, Ranking, Weighing};
use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::rollout::{Roller, Rollout, Seen};
use super::terms::{distance, heading, speed};
use super::window::{Lattice, Window};
use super::{
    Decision, DriveMemory, DwaConfig, Evaluation, LocalPlanner, NoCommand, Prediction, Rejections,
    Scene, Scratch,
};
use crate::ConfigError;
use crate::geometry::{Point, Velocity};
use crate::robot::{Footprint, Robot};

/// The classic dynamic window approach.
#[derive(Clone, Debug)]
pub struct Dwa {
    config: DwaConfig,
    robot: Robot,
}

/// The terms of eq. (9).
const TERMS: [&str; 3] = [heading::NAME, distance::NAME, speed::NAME];

/// The footprint would touch something or leave the map.
const CONTACT: &str = "contact";

/// v > sqrt(2 dist deceleration), eq. (7): it could not stop in time.
const CANNOT_STOP: &str = "cannot-stop";

/// |omega| > sqrt(2 dist angular deceleration), eq. (7): it could not stop turning in time.
const TURNS_TOO_FAST: &str = "turns-too-fast";

const RULES: [(&str, &str); 3] = [
    (CONTACT, "touch something"),
    (CANNOT_STOP, "could not stop in time"),
    (TURNS_TOO_FAST, "turn too fast"),
];

/// What a decision works in.
#[derive(Debug, Default)]
struct Work {
    lattice: Lattice,
    admissible: Vec<Candidate<{ TERMS.len() }>>,
    near: Vec<Seen>,
    shrunk: Vec<Point>,
}

impl Dwa {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "dwa";

    /// More candidates than this in one cycle are a mistake in the config.
    const MAX_CANDIDATES: f64 = 100_000.0;

    /// More predicted poses than this for one candidate are a mistake in the config.
    const MAX_POSES: f64 = 10_000.0;

    /// A planner for a robot.
    ///
    /// # Errors
    /// When a value of the robot or the config cannot be used, or the two do not fit together (a
    /// horizon too short to stop within it, or steps too small for one cycle); the error names the
    /// field.
    pub fn new(config: DwaConfig, robot: Robot) -> Result<Self, ConfigError> {
        robot.validate().map_err(|error| error.within("robot"))?;
        config.validate()?;
        let cycle_s = robot.cycle_s;
        let refuse = |field, expected, value| Err(ConfigError::must_be(field, expected, value));
        let stop_s = cycle_s + robot.limits.stop_s();
        if config.prediction == Prediction::Arcs && config.horizon_s < stop_s * (1.0 - 1e-9) {
            let expected = "at least a cycle and the time to stop";
            return refuse("horizon_s", expected, config.horizon_s);
        }
        if config.horizon_s / config.prediction_step_s > Self::MAX_POSES {
            let expected = "at least a 10000th of the horizon";
            return refuse("prediction_step_s", expected, config.prediction_step_s);
        }
        let limits = &robot.limits;
        let speeds = (limits.acceleration_mps2 + limits.deceleration_mps2) * cycle_s;
        let rates =
            (limits.angular_acceleration_radps2 + limits.angular_deceleration_radps2) * cycle_s;
        let count = (speeds / config.v_step_mps + 3.0) * (rates / config.omega_step_radps + 3.0);
        if count > Self::MAX_CANDIDATES {
            let expected = "larger: with omega_step_radps it gives over 100000 candidates";
            return refuse("v_step_mps", expected, config.v_step_mps);
        }
        Ok(Self { config, robot })
    }

    /// The robot that it drives.
    pub const fn robot(&self) -> &Robot {
        &self.robot
    }

    fn roller<'a>(&'a self, scene: &'a Scene<'a>, shrunk: &'a mut Vec<Point>) -> Roller<'a> {
        let cap_m = self.config.distance_cap_m;
        let body = Standing { robot: &self.robot, scene, reach_m: cap_m }
            .body(self.config.safety_margin_m, shrunk);
        let enough_m = cap_m + body.offset_m;
        Roller {
            start: Seen::new(scene.pose, &body.core, scene.obstacles, enough_m),
            scene,
            body,
            cycle_s: self.robot.cycle_s,
            prediction: self.config.prediction,
            step_s: self.config.prediction_step_s,
            horizon_s: self.config.horizon_s,
            distance_at: self.config.distance_at,
            distance_cap_m: cap_m,
        }
    }

    /// The rule of Va, eq. (7), that refuses a candidate. Within the safety margin the robot may creep, and
    /// on the spot it may turn at any rate: contact is refused anyway.
    fn refused_by(&self, velocity: Velocity, dist_m: f64) -> Option<&'static str> {
        let limits = &self.robot.limits;
        let dist_m = dist_m.max(self.config.safety_margin_m);
        if velocity.v.abs() > (2.0 * dist_m * limits.deceleration_mps2).sqrt() {
            return Some(CANNOT_STOP);
        }
        let is_turning_on_the_spot = velocity.v == 0.0;
        let fastest_radps = (2.0 * dist_m * limits.angular_deceleration_radps2).sqrt();
        (!is_turning_on_the_spot && velocity.omega.abs() > fastest_radps).then_some(TURNS_TOO_FAST)
    }

    /// The terms of eq. (9) before normalisation.
    fn terms(&self, scene: &Scene<'_>, velocity: Velocity, rollout: &Rollout) -> [f64; 3] {
        [
            heading::raw(rollout.end, scene.guide),
            distance::raw(rollout.distance_m, self.config.distance_term_cap_m),
            speed::raw(velocity),
        ]
    }

    fn weighing(&self) -> Weighing<{ TERMS.len() }> {
        let weights = &self.config.weights;
        Weighing { names: TERMS, weights: [weights.heading, weights.distance, weights.speed] }
    }

    /// Brakes along the present arc; at standstill a round robot, which always may, turns towards the guide
    /// point.
    fn fallback(&self, scene: &Scene<'_>) -> Velocity {
        let is_driving =
            scene.velocity.v.abs() > self.robot.limits.standing_mps(self.robot.cycle_s);
        let is_round = matches!(self.robot.footprint, Footprint::Circle(_));
        if is_driving || !is_round {
            return self.robot.limits.braked(scene.velocity, self.robot.cycle_s);
        }
        let wanted = scene.pose.bearing_to(scene.guide) / self.robot.cycle_s;
        let limits = &self.robot.limits;
        limits.reached(scene.velocity, Velocity::new(0.0, wanted), self.robot.cycle_s)
    }
}

impl LocalParameters for DwaConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Robot) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(Dwa::new(self.clone(), robot.clone())?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for Dwa {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let window = Window::of(&self.robot.limits, scene.velocity, self.robot.cycle_s);
        let Work { lattice, admissible, near, shrunk } = scratch.part();
        let roller = self.roller(scene, shrunk);
        lattice.fill(&window, self.config.v_step_mps, self.config.omega_step_radps);
        admissible.clear();
        let mut evaluation =
            Evaluation { rejected: Rejections::none_by(&RULES), ..Evaluation::default() };
        for velocity in lattice.candidates() {
            evaluation.candidates += 1;
            let Some(rollout) = roller.roll(velocity, near) else {
                evaluation.rejected.add(CONTACT);
                continue;
            };
            if let Some(rule) = self.refused_by(velocity, rollout.distance_m) {
                evaluation.rejected.add(rule);
                continue;
            }
            evaluation.driving += u32::from(velocity.v != 0.0);
            admissible.push(Candidate { velocity, raw: self.terms(scene, velocity, &rollout) });
        }
        match self.weighing().rank(admissible) {
            Some(Ranking { command, chosen, runner_up }) => {
                Ok(Decision { command, evaluation: Evaluation { chosen, runner_up, ..evaluation } })
            }
            None => Err(NoCommand { fallback: self.fallback(scene), evaluation }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Polyline, Pose};
    use crate::map::{CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
    use proptest::prelude::*;

    fn grid(size: u64, resolution_m: f64, occupied: impl Fn(i32, i32) -> bool) -> DistanceField {
        let frame = GridFrame::new(size, size, resolution_m, Pose::default()).unwrap();
        let grid = OccupancyGrid::from_fn(frame, |cell| {
            if occupied(cell.x, cell.y) { CellState::Occupied } else { CellState::Free }
        });
        // Beyond this reach the distances are measured.
        let config = FieldConfig { reach_m: 20.0 * resolution_m, ..FieldConfig::default() };
        DistanceField::new(&frame, grid.occupied(), &config)
    }

    fn scene(
        obstacles: &DistanceField,
        pose: Pose,
        velocity: Velocity,
        guide: [f64; 2],
    ) -> Scene<'_> {
        Scene { obstacles, pose, velocity, guide: guide.into(), path: &NO_PATH }
    }

    /// This planner looks at the guide point alone.
    static NO_PATH: Polyline = Polyline::new(Vec::new());

    fn decide(dwa: &Dwa, scene: &Scene<'_>) -> Result<Decision, NoCommand> {
        dwa.decide(scene, &mut DriveMemory::default(), &mut Scratch::default())
    }

    fn small() -> Dwa {
        let robot = Robot::small();
        Dwa::new(DwaConfig::for_robot(&robot), robot).unwrap()
    }

    fn paper() -> Dwa {
        Dwa::new(DwaConfig::PAPER, Robot::paper()).unwrap()
    }

    #[test]
    fn what_does_not_fit_the_robot_is_refused() {
        let robot = Robot::small();
        let base = DwaConfig::for_robot(&robot);
        let field = |config| Dwa::new(config, Robot::small()).unwrap_err().path;
        // Stopping takes 1 s, a cycle 0.1 s.
        assert_eq!(field(DwaConfig { horizon_s: 1.09, ..base.clone() }), "horizon_s");
        assert!(Dwa::new(DwaConfig { horizon_s: 1.1, ..base.clone() }, robot).is_ok());
        let tiny = DwaConfig { prediction_step_s: 1e-9, ..base.clone() };
        assert_eq!(field(tiny), "prediction_step_s");
        assert_eq!(field(DwaConfig { v_step_mps: 1e-9, ..base.clone() }), "v_step_mps");
        let mut bad = Robot::small();
        bad.cycle_s = f64::NAN;
        assert_eq!(Dwa::new(base, bad).unwrap_err().path, "robot.cycle_s");
    }

    #[test]
    fn noise_at_a_wall_does_not_freeze_the_robot() {
        let wall = grid(200, 0.05, |x, _| x >= 199);
        let pose = Pose::new(9.95 - 0.18 - 0.003, 5.0, 0.0);
        let noise = Velocity::new(0.001, 0.0);
        let at = scene(&wall, pose, noise, [2.0, 6.0]);
        let command = decide(&small(), &at).unwrap().command;
        assert!(command.v.abs() < 1e-9 && command.omega.abs() > 0.2, "{command:?}");
    }

    #[test]
    fn equation_4_euler_steps() {
        let open = grid(40, 1.0, |_, _| false);
        let dwa = paper();
        let at = scene(&open, Pose::new(10.0, 10.0, 0.0), Velocity::ZERO, [20.0, 10.0]);
        let mut shrunk = Vec::new();
        let roller = dwa.roller(&at, &mut shrunk);
        let end = roller.roll(Velocity::new(1.0, 0.2), &mut Vec::new()).unwrap().end;
        let (mut x, mut y, mut theta) = (10.0, 10.0, 0.0_f64);
        for _ in 0..30 {
            x += 0.1 * theta.cos();
            y += 0.1 * theta.sin();
            theta += 0.2 * 0.1;
        }
        assert!((end.x - x).abs() < 1e-9 && (end.y - y).abs() < 1e-9);
        assert!((end.theta - theta).abs() < 1e-9);
    }

    #[test]
    fn equation_7_admissible_velocities() {
        let dwa = paper();
        let refused = |v, omega| dwa.refused_by(Velocity::new(v, omega), 0.4);
        // dist 0.4 m, 0.2 m/s²: v <= 0.4 m/s; 50 deg/s²: omega <= 0.8355 rad/s.
        assert_eq!(refused(0.399, 0.83), None);
        assert_eq!(refused(0.401, 0.0), Some(CANNOT_STOP));
        assert_eq!(refused(0.1, -0.84), Some(TURNS_TOO_FAST));
        assert_eq!(refused(0.0, -0.84), None, "on the spot");
    }

    #[test]
    fn terms_in_the_order_of_their_names() {
        let open = grid(40, 1.0, |_, _| false);
        let at = scene(&open, Pose::new(5.0, 5.0, 0.0), Velocity::ZERO, [5.0, 15.0]);
        let rollout = Rollout { end: Pose::new(5.0, 10.0, 0.0), distance_m: 9.0 };
        let terms = paper().terms(&at, Velocity::new(-0.5, 0.0), &rollout);
        assert!((terms[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((TERMS, terms[1], terms[2]), (["heading", "distance", "speed"], 5.0, 0.5));
    }

    #[test]
    fn drives_straight_on_in_the_open_and_turns_to_what_lies_behind() {
        let open = grid(200, 0.05, |_, _| false);
        let at = scene(&open, Pose::new(5.0, 5.0, 0.0), Velocity::new(0.3, 0.0), [9.0, 5.0]);
        let command = decide(&small(), &at).unwrap().command;
        assert!((command.v - 0.35).abs() < 1e-9 && command.omega.abs() < 1e-9);
        let behind = scene(&open, Pose::new(5.0, 5.0, 0.0), Velocity::ZERO, [1.0, 5.5]);
        assert!(decide(&small(), &behind).unwrap().command.omega > 0.2);
    }

    #[test]
    fn brakes_before_a_wall_that_it_cannot_pass() {
        // Too fast, too near: every candidate of the window would touch the wall.
        let wall = grid(200, 0.05, |x, _| x >= 104);
        let at = scene(&wall, Pose::new(5.0 - 0.03, 5.0, 0.0), Velocity::new(0.5, 0.0), [9.0, 5.0]);
        let why = decide(&small(), &at).unwrap_err();
        assert_eq!(why.evaluation.rejected.count(CONTACT), why.evaluation.candidates);
        assert!((why.fallback.v - 0.45).abs() < 1e-12);
        assert!(why.to_string().contains("touch something"));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        /// A robot that starts free never touches what stands around it: neither while a
        /// command is admissible nor while it brakes.
        #[test]
        fn never_touches_what_stands_still(blocks in prop::collection::vec((0i32..60, 0i32..60), 0..60),
                                           heading in -3.0..3.0f64, guide in (0.0..3.0f64, 0.0..3.0f64),
                                           shape in 0..3usize) {
            let world = grid(60, 0.05, |x, y| blocks.iter().any(|&(bx, by)| (bx - x).abs() < 2 && (by - y).abs() < 2));
            // Round, a box, and a box that turns around its back.
            let shapes = [vec![], vec![[0.3, 0.15], [-0.3, 0.15], [-0.3, -0.15], [0.3, -0.15]],
                          vec![[0.5, 0.1], [-0.05, 0.1], [-0.05, -0.1], [0.5, -0.1]]];
            let mut robot = Robot::small();
            if shape > 0 {
                let vertices = shapes[shape].iter().map(|&vertex| vertex.into()).collect();
                robot.footprint = Footprint::polygon(vertices).unwrap();
            }
            let dwa = Dwa::new(DwaConfig::for_robot(&robot), robot.clone()).unwrap();
            let mut pose = Pose::new(1.5, 1.5, heading);
            prop_assume!(robot.footprint.is_free(pose, &world)
                && robot.footprint.distance_m(pose, &world.clearance(), 1.0) > 0.005);
            let mut velocity = Velocity::ZERO;
            for _ in 0..100 {
                let at = Scene { obstacles: &world, pose, velocity, guide: Point::new(guide.0, guide.1), path: &NO_PATH };
                let command = match decide(&dwa, &at) {
                    Ok(decision) => {
                        let window = Window::of(&robot.limits, velocity, robot.cycle_s);
                        let Velocity { v, omega } = decision.command;
                        prop_assert!(v >= window.slowest.v && v <= window.fastest.v);
                        prop_assert!(omega >= window.slowest.omega && omega <= window.fastest.omega);
                        decision.command
                    }
                    Err(why) => why.fallback,
                };
                let next = robot.limits.reached(velocity, command, robot.cycle_s);
                for i in 1..=50 {
                    let part = f64::from(i) / 50.0;
                    let between = pose.after_ramp(velocity, velocity.lerp(next, part), robot.cycle_s * part);
                    prop_assert!(robot.footprint.is_free(between, &world),
                                 "touched at {:?} with {:?}", between, next);
                }
                pose = pose.after_ramp(velocity, next, robot.cycle_s);
                velocity = next;
            }
        }
    }
}
