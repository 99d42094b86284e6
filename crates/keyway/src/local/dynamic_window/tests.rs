use super::*;
use crate::geometry::{Polyline, Pose};
use crate::local::{DriveMemory, Dwa, DwaConfig, LocalPlanner};
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

fn scene(obstacles: &DistanceField, pose: Pose, velocity: Velocity, guide: [f64; 2]) -> Scene<'_> {
    let sensed = obstacles.clearance().obstacles();
    Scene {
        obstacles,
        sensed,
        seen: crate::sense::SeenCells::ANYWHERE,
        movers: &[],
        walked: &[],
        pose,
        velocity,
        guide: guide.into(),
        path: &NO_PATH,
        goal_heading_rad: None,
        remaining_m: f64::INFINITY,
        jerk_limited: None,
    }
}

/// This planner uses the guide point alone.
static NO_PATH: Polyline = Polyline::new(Vec::new());

fn decide(dwa: &Dwa, scene: &Scene<'_>) -> Result<Decision, NoCommand> {
    dwa.decide(scene, &mut DriveMemory::default(), &mut Scratch::default())
}

fn small() -> Dwa {
    let robot = Robot::small();
    Dwa::new(DwaConfig::for_robot(&robot), robot).unwrap()
}

fn paper() -> DynamicWindow {
    DynamicWindow::new(WindowConfig::PAPER, Robot::paper()).unwrap()
}

#[test]
fn what_does_not_fit_the_robot_is_refused() {
    let robot = Robot::small();
    let base = WindowConfig::for_robot(&robot);
    let field = |config| DynamicWindow::new(config, Robot::small()).unwrap_err().path;
    // Stopping takes 1 s, a cycle 0.1 s.
    assert_eq!(field(WindowConfig { horizon_s: 1.099, ..base.clone() }), "window.horizon_s");
    let short = WindowConfig { horizon_s: 0.5, ..base.clone() };
    let short = DynamicWindow::new(short, Robot::small()).unwrap_err().to_string();
    assert!(short.contains("at least 1.1, for a cycle"), "{short}");
    assert_eq!(field(WindowConfig { horizon_s: 1e300, ..base.clone() }), "window.horizon_s");
    assert!(DynamicWindow::new(WindowConfig { horizon_s: 1.1, ..base.clone() }, robot).is_ok());
    let euler = WindowConfig { prediction: Prediction::Euler, ..base.clone() };
    assert_eq!(field(euler), "window.admissible");
    assert_eq!(field(WindowConfig { judged_s: 1.101, ..base.clone() }), "window.judged_s");
    assert_eq!(field(WindowConfig { judged_s: 0.099, ..base.clone() }), "window.judged_s");
    assert_eq!(field(WindowConfig { movers_s: 111.0, ..base.clone() }), "window.movers_s");
    let tiny = WindowConfig { prediction_step_s: 1e-9, ..base.clone() };
    assert_eq!(field(tiny), "window.prediction_step_s");
    assert_eq!(field(WindowConfig { v_step_mps: 1e-9, ..base.clone() }), "window.v_step_mps");
    let mut bad = Robot::small();
    bad.cycle_s = f64::NAN;
    assert_eq!(DynamicWindow::new(base, bad).unwrap_err().path, "robot.cycle_s");
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

/// However long a step may be, the whole horizon is checked.
#[test]
fn a_long_prediction_step_leaves_nothing_out() {
    let wall = grid(200, 0.05, |x, _| x >= 100);
    let robot = Robot::small();
    let base = WindowConfig::for_robot(&robot);
    for prediction_step_s in [base.prediction_step_s, 1e9, 1e300] {
        let config = WindowConfig { prediction_step_s, ..base.clone() };
        let window = DynamicWindow::new(config, robot.clone()).unwrap();
        // 0.3 m before the wall, at 0.5 m/s.
        let at = scene(&wall, Pose::new(4.52, 5.0, 0.0), Velocity::new(0.5, 0.0), [9.0, 5.0]);
        let mut shrunk = Vec::new();
        let mut lattice = Lattice::default();
        lattice.fill_with(Velocity::new(0.5, 0.0));
        let mut memory = RollMemory::default();
        window.roller(&at, &mut shrunk).roll(&lattice, &mut memory);
        assert_eq!(memory.rollouts().count(&lattice, |_| true), 0, "{prediction_step_s}");
    }
}

#[test]
fn equation_4_euler_steps() {
    let open = grid(40, 1.0, |_, _| false);
    let window = paper();
    let at = scene(&open, Pose::new(10.0, 10.0, 0.0), Velocity::ZERO, [20.0, 10.0]);
    let mut shrunk = Vec::new();
    let roller = window.roller(&at, &mut shrunk);
    let mut lattice = Lattice::default();
    lattice.fill_with(Velocity::new(1.0, 0.2));
    let mut memory = RollMemory::default();
    roller.roll(&lattice, &mut memory);
    let end = memory.rollouts().admissible(&lattice).next().unwrap().1.judged;
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
    let window = paper();
    let refused = |v, omega| window.refused_by(Velocity::new(v, omega), 0.4);
    // dist 0.4 m, 0.2 m/s²: v <= 0.4 m/s; 50 deg/s²: omega <= 0.8355 rad/s.
    assert_eq!(refused(0.399, 0.83), None);
    assert_eq!(refused(0.401, 0.0), Some(CANNOT_STOP));
    assert_eq!(refused(0.1, -0.84), Some(TURNS_TOO_FAST));
    assert_eq!(refused(0.0, -0.84), None, "on the spot");
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

/// Round, a box, and a box that turns around its back.
fn shaped(robot: Robot, shape: usize) -> Robot {
    let shapes: [&[[f64; 2]]; 2] = [
        &[[0.3, 0.15], [-0.3, 0.15], [-0.3, -0.15], [0.3, -0.15]],
        &[[0.5, 0.1], [-0.05, 0.1], [-0.05, -0.1], [0.5, -0.1]],
    ];
    if shape == 0 {
        return robot;
    }
    let vertices = shapes[shape - 1].iter().map(|&vertex| vertex.into()).collect();
    Robot { footprint: Footprint::polygon(vertices).unwrap(), ..robot }
}

/// Drives for a number of cycles towards a guide point and checks every fiftieth of a cycle.
fn touches_nothing(
    config: DwaConfig,
    robot: &Robot,
    world: &DistanceField,
    mut pose: Pose,
    guides: impl Iterator<Item = [f64; 2]>,
) -> Result<(), TestCaseError> {
    let dwa = Dwa::new(config, robot.clone()).unwrap();
    prop_assume!(
        robot.footprint.is_free(pose, world)
            && robot.footprint.distance_m(pose, &world.clearance(), 1.0)
                > robot.safety_margin_or_default_m()
    );
    let mut velocity = Velocity::ZERO;
    for guide in guides {
        let at = scene(world, pose, velocity, guide);
        let command = match decide(&dwa, &at) {
            Ok(decision) => {
                let window = Window::of(robot, velocity, f64::INFINITY, true);
                let Velocity { v, omega, .. } = decision.command;
                prop_assert!(v >= window.slowest.v && v <= window.fastest.v);
                prop_assert!(omega >= window.slowest.omega && omega <= window.fastest.omega);
                decision.command
            }
            Err(why) => why.fallback,
        };
        let next = robot.limits.reached(velocity, command, robot.cycle_s);
        for i in 1..=50 {
            let part = f64::from(i) / 50.0;
            let between =
                pose.after_ramp(velocity, velocity.lerp(next, part), robot.cycle_s * part);
            prop_assert!(
                robot.footprint.is_free(between, world),
                "touched at {:?} with {:?}",
                between,
                next
            );
        }
        pose = pose.after_ramp(velocity, next, robot.cycle_s);
        velocity = next;
    }
    Ok(())
}

fn blocks() -> impl Strategy<Value = DistanceField> {
    prop::collection::vec((0i32..60, 0i32..60), 0..60).prop_map(|blocks| {
        let is_block = |x: i32, y: i32| {
            blocks.iter().any(|&(bx, by)| (bx - x).abs() < 2 && (by - y).abs() < 2)
        };
        grid(60, 0.05, is_block)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// A robot that starts free never touches stationary obstacles: neither while a command is
    /// admissible nor while it brakes.
    #[test]
    fn never_touches_what_stands_still(world in blocks(), heading in -3.0..3.0f64,
                                       guide in (0.0..3.0f64, 0.0..3.0f64), shape in 0..3usize) {
        let robot = shaped(Robot::small(), shape);
        let guides = std::iter::repeat_n([guide.0, guide.1], 100);
        touches_nothing(DwaConfig::for_robot(&robot), &robot, &world, Pose::new(1.5, 1.5, heading), guides)?;
    }

    /// Also if a robot brakes in less than a cycle, of which it then needs the whole all the
    /// same. Its guide point keeps moving, so it keeps driving.
    #[test]
    fn strong_brakes_and_long_cycles_touch_nothing(
        world in blocks(), heading in -3.0..3.0f64, shape in 0..3usize,
        (v_max_mps, cycle_s) in (0.3..2.0f64, 0.05..0.6f64), cycles_to_stop in 0.01..3.5f64,
        guides in prop::collection::vec((0.0..3.0f64, 0.0..3.0f64), 8),
    ) {
        let per_s = 1.0 / (cycles_to_stop * cycle_s);
        let mut robot = shaped(Robot::small(), shape);
        (robot.cycle_s, robot.limits.v_max_mps) = (cycle_s, v_max_mps);
        robot.limits.acceleration_mps2 = v_max_mps * per_s;
        robot.limits.deceleration_mps2 = v_max_mps * per_s;
        robot.limits.angular_acceleration_radps2 = robot.limits.omega_max_radps * per_s;
        robot.limits.angular_deceleration_radps2 = robot.limits.omega_max_radps * per_s;
        let config = DwaConfig::for_robot(&robot);
        let guides = guides.iter().flat_map(|&(x, y)| std::iter::repeat_n([x, y], 6));
        touches_nothing(config, &robot, &world, Pose::new(1.5, 1.5, heading), guides)?;
    }
}
