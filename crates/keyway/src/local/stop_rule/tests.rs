use super::*;
use crate::geometry::Point;
use crate::map::{BitGrid, FieldConfig, GridFrame};
use crate::robot::{Footprint, star};
use proptest::prelude::*;

/// Stationary obstacles, with their distances.
pub(super) struct Ground {
    field: DistanceField,
}

impl Ground {
    pub(super) fn new(frame: &GridFrame, cells: &[bool]) -> Self {
        let mut obstacles = BitGrid::new(frame.width(), frame.height(), false);
        for (cell, _) in frame.cells().zip(cells).filter(|(_, occupied)| **occupied) {
            obstacles.set(cell, true);
        }
        Self { field: DistanceField::new(frame, &obstacles, &FieldConfig::default()) }
    }

    /// A wall 0.2 m thick whose face is at x = 5 m, on a map of 10 m x 8 m.
    pub(super) fn wall() -> Self {
        let frame = GridFrame::new(100, 80, 0.1, Pose::default()).unwrap();
        let is_wall = |i: usize| (50..52).contains(&(i % 100));
        Self::new(&frame, &(0..8000).map(is_wall).collect::<Vec<_>>())
    }

    pub(super) fn open() -> Self {
        Self::new(&GridFrame::new(200, 200, 0.1, Pose::new(-10.0, -10.0, 0.0)).unwrap(), &[])
    }

    /// Clearance of a footprint \[m\]: exact, up to 1 m.
    pub(super) fn room_m(&self, footprint: &Footprint, pose: Pose) -> f64 {
        let clearance = self.field.clearance();
        footprint.distance_m(pose, &clearance, 1.0).min(footprint.to_border_m(pose, &clearance))
    }

    pub(super) fn around<'a>(
        &'a self,
        pose: Pose,
        velocity: Velocity,
        movers: &'a [Mover],
    ) -> Surroundings<'a> {
        let seen = SeenCells::ANYWHERE;
        Surroundings {
            obstacles: &self.field,
            seen,
            movers,
            delay_s: 0.0,
            pose,
            velocity,
            jerk_limited: None,
        }
    }
}

pub(super) fn rule(robot: &Robot) -> StopRule {
    StopRule::new(StopRuleConfig::for_robot(robot), robot.clone()).unwrap()
}

pub(super) fn gate(rule: &StopRule, around: &Surroundings<'_>, command: Velocity) -> Gated {
    rule.gate(around, command, &mut Scratch::default())
}

const AHEAD: Velocity = Velocity::new(0.5, 0.0);

#[test]
fn stops_before_a_wall_by_hand() {
    let (ground, rule) = (Ground::wall(), rule(&Robot::small()));
    let at = |to_wall_m: f64| {
        let pose = Pose::new(5.0 - to_wall_m, 4.0, 0.0);
        gate(&rule, &ground.around(pose, AHEAD, &[]), AHEAD)
    };
    // 0.05 m in this cycle, 0.5² / (2 * 0.5) = 0.25 m of braking, 0.18 m of robot, 0.0025 m of
    // margin.
    let least_m = 0.05 + 0.25 + 0.18 + 0.0025;
    assert_eq!(at(least_m + 1e-6), Gated { command: AHEAD, why: None });
    let refused = at(least_m - 1e-6);
    assert!(matches!(refused.why, Some(Refusal::Standing { after_s }) if after_s > 0.9));
    // A velocity between braking (0.45 m/s) and the requested one still fits.
    assert!(refused.command.v > 0.45 && refused.command.v < 0.5, "{refused:?}");
    // Along the wall it does not matter.
    let along = Pose::new(5.0 - 0.18 - 0.003, 4.0, std::f64::consts::FRAC_PI_2);
    assert!(!gate(&rule, &ground.around(along, AHEAD, &[]), AHEAD).changed());
    // Beyond the point at which it could stop it brakes as hard as it can.
    assert_eq!(at(0.35).command, Velocity::new(0.45, 0.0));
}

#[test]
fn movers_by_hand() {
    let (ground, robot) = (Ground::open(), Robot::small());
    let config = StopRuleConfig {
        movers: MoverBounds { speed_mps: 1.0, acceleration_mps2: None },
        ..StopRuleConfig::for_robot(&robot)
    };
    let any_way = StopRule::new(config.clone(), robot.clone()).unwrap();
    let admits = |rule: &StopRule, gap_m: f64, ahead: f64, velocity_mps: f64| {
        let centre = Point::new((gap_m + 0.18 + 0.3) * ahead, 0.0);
        let velocity_mps = Point::new(velocity_mps, 0.0);
        let movers = [Mover { velocity_mps, ..Mover::standing(7, centre, 0.3) }];
        let gated = gate(rule, &ground.around(Pose::default(), AHEAD, &movers), AHEAD);
        let by_mover = gated.why.is_none_or(|why| matches!(why, Refusal::Mover { id: 7, .. }));
        assert!(by_mover, "{gated:?}");
        !gated.changed()
    };
    // It stops after 1.1 s and 0.3 m: until then a moving obstacle approaches by 1.1 m. Accurate
    // to a margin's length.
    assert!(admits(&any_way, 1.4 + 0.006, 1.0, 0.0) && !admits(&any_way, 1.4, 1.0, 0.0));
    // From behind it has to catch up.
    assert!(admits(&any_way, 0.8 + 0.006, -1.0, 0.0) && !admits(&any_way, 0.8, -1.0, 0.0));
    // Its observed velocity does not matter.
    assert!(!admits(&any_way, 1.4, 1.0, 0.9));
    // With an acceleration bound it does: after 1.1 s it may be 0.605 m off its path.
    let movers = MoverBounds { acceleration_mps2: Some(1.0), ..config.movers };
    let inert = StopRule::new(StopRuleConfig { movers, ..config }, robot).unwrap();
    assert!(admits(&inert, 0.3 + 0.605 + 0.006, 1.0, 0.0) && !admits(&inert, 0.9, 1.0, 0.0));
    assert!(admits(&inert, 0.1, 1.0, 0.8) && !admits(&inert, 0.1, 1.0, -0.8));
}

/// A moving obstacle approaches before the command acts.
#[test]
fn a_mover_has_the_delay_in_addition() {
    let (ground, robot) = (Ground::open(), Robot::small());
    let movers = MoverBounds { speed_mps: 1.0, acceleration_mps2: None };
    let rule = StopRule::new(StopRuleConfig { movers, ..StopRuleConfig::for_robot(&robot) }, robot)
        .unwrap();
    let admits = |gap_m: f64, delay_s: f64| {
        let movers = [Mover::standing(7, Point::new(gap_m + 0.18 + 0.3, 0.0), 0.3)];
        let around = ground.around(Pose::default(), AHEAD, &movers);
        !gate(&rule, &Surroundings { delay_s, ..around }, AHEAD).changed()
    };
    for delay_s in [0.0, 0.1, 0.35] {
        // As without a delay, plus 1 m/s times the delay.
        assert!(admits(1.4 + delay_s + 0.006, delay_s) && !admits(1.4 + delay_s, delay_s));
    }
}

#[test]
fn a_robot_that_stands_may_be_run_into() {
    let (ground, rule) = (Ground::open(), rule(&Robot::small()));
    let movers = [Mover::standing(3, Point::new(0.6, 0.0), 0.3)];
    let around = ground.around(Pose::default(), Velocity::ZERO, &movers);
    assert!(!gate(&rule, &around, Velocity::ZERO).changed());
    let gated = gate(&rule, &around, AHEAD);
    assert!(gated.changed() && gated.command.v < 0.02, "{gated:?}");
}

#[test]
fn inside_the_margin_it_may_leave_and_pass_but_not_come_nearer() {
    let ground = Ground::wall();
    let back = Robot {
        limits: crate::robot::Limits { v_min_mps: -0.5, ..Robot::small().limits },
        ..Robot::small()
    };
    let long = Robot { footprint: Footprint::rectangle(0.6, 0.3).unwrap(), ..back.clone() };
    // Both a millimetre from the wall (inside the margin), and 1 cm inside it.
    for (robot, front_m) in [(back, 0.18), (long, 0.3)] {
        let rule = rule(&robot);
        for depth_m in [-0.001, 0.01] {
            let pose = Pose::new(5.0 - front_m + depth_m, 4.0, 0.0);
            let from_rest =
                |command| gate(&rule, &ground.around(pose, Velocity::ZERO, &[]), command);
            assert!(!from_rest(Velocity::new(-0.05, 0.0)).changed(), "{robot:?} {depth_m}");
            assert!(!from_rest(Velocity::new(-0.05, 0.1)).changed(), "{robot:?} {depth_m}");
            for v in [0.05, 0.001] {
                let nearer = from_rest(Velocity::new(v, 0.0));
                assert_eq!(nearer.command, Velocity::ZERO, "{robot:?} {depth_m}");
                assert!(matches!(nearer.why, Some(Refusal::Standing { .. })), "{nearer:?}");
            }
            // A small odometry speed towards the wall prevents neither driving back nor, if the
            // robot is round, turning.
            let noise = Velocity::new(0.004, 0.0);
            let from_noise = |command| gate(&rule, &ground.around(pose, noise, &[]), command);
            assert!(!from_noise(Velocity::new(-0.05, 0.0)).changed(), "{robot:?} {depth_m}");
            let turned = from_noise(Velocity::new(0.0, 0.3));
            let is_round = matches!(robot.footprint, Footprint::Circle(_));
            assert_eq!(turned.changed(), !is_round, "{robot:?} {depth_m}");
        }
    }
    let rule = rule(&Robot::small());
    let along = Pose::new(5.0 - 0.18 - 0.001, 4.0, std::f64::consts::FRAC_PI_2);
    assert!(!gate(&rule, &ground.around(along, AHEAD, &[]), AHEAD).changed());
    // It must not move away from a moving obstacle either, which could follow it.
    let movers = [Mover::standing(1, Point::new(1.0 + 0.18 + 0.3 - 0.01, 1.0), 0.3)];
    for theta in [0.0, 3.0] {
        let around = ground.around(Pose::new(1.0, 1.0, theta), Velocity::ZERO, &movers);
        let gated = gate(&rule, &around, Velocity::new(0.05, 0.0));
        assert!(matches!(gated.why, Some(Refusal::Mover { id: 1, .. })), "{gated:?}");
    }
}

#[test]
fn what_cannot_be_judged_is_stopped() {
    let (ground, rule) = (Ground::wall(), rule(&Robot::small()));
    let covered = gate(&rule, &ground.around(Pose::new(5.1, 4.0, 0.0), AHEAD, &[]), AHEAD);
    assert_eq!(covered, Gated { command: Velocity::new(0.45, 0.0), why: Some(Refusal::Covered) });
    let outside = gate(&rule, &ground.around(Pose::new(-1.0, 4.0, 0.0), AHEAD, &[]), AHEAD);
    assert_eq!(outside.why, Some(Refusal::Covered));
    let pose = Pose::new(1.0, 1.0, 0.0);
    let nan = Velocity::new(f64::NAN, 0.0);
    let command = gate(&rule, &ground.around(pose, AHEAD, &[]), nan);
    assert_eq!(
        command,
        Gated { command: Velocity::new(0.45, 0.0), why: Some(Refusal::NotANumber) }
    );
    for around in [
        ground.around(pose, nan, &[]),
        ground.around(Pose { theta: f64::INFINITY, ..pose }, AHEAD, &[]),
    ] {
        let gated = gate(&rule, &around, AHEAD);
        assert_eq!(gated, Gated { command: Velocity::ZERO, why: Some(Refusal::NotANumber) });
    }
    // An invalid moving obstacle.
    let movers = [Mover::standing(1, Point::new(f64::NAN, 1.0), 0.3)];
    assert!(!gate(&rule, &ground.around(pose, AHEAD, &movers), AHEAD).changed());
}

#[test]
fn bad_values_are_named_and_nothing_is_allocated() {
    let robot = Robot::small();
    let good = StopRuleConfig::for_robot(&robot);
    let path = |config| StopRule::new(config, Robot::small()).unwrap_err().path;
    assert_eq!(path(StopRuleConfig { margin_m: 0.0, ..good.clone() }), "margin_m");
    let movers = MoverBounds { speed_mps: -1.0, acceleration_mps2: None };
    assert_eq!(path(StopRuleConfig { movers, ..good.clone() }), "movers.speed_mps");
    let mut slow = robot.clone();
    slow.limits.deceleration_mps2 = 1e-4;
    assert_eq!(StopRule::new(good, slow).unwrap_err().path, "robot.limits.deceleration_mps2");
    let long = Robot { footprint: Footprint::rectangle(0.6, 0.3).unwrap(), ..robot };
    let (ground, rule, mut scratch) = (Ground::wall(), rule(&long), Scratch::default());
    let movers = [Mover::standing(1, Point::new(4.0, 4.3), 0.2)];
    let around = ground.around(Pose::new(4.75, 4.0, 0.1), AHEAD, &movers);
    let mut gates = || allocation_counter::measure(|| _ = rule.gate(&around, AHEAD, &mut scratch));
    assert!(gates().count_total > 0, "the polygon is shrunk");
    assert_eq!(gates().count_total, 0);
}

/// Round, long, and with the centre of rotation near an edge, on two sets of limits.
pub(super) fn robots() -> impl Strategy<Value = Robot> {
    let footprint = prop_oneof![
        (0.0..0.3f64).prop_map(|radius_m| Footprint::circle(radius_m).unwrap()),
        (0.1..0.7f64, 0.1..0.4f64).prop_map(|(l, w)| Footprint::rectangle(l, w).unwrap()),
        (prop::collection::vec(0.1..0.4f64, 3..7), -0.15..0.15f64)
            .prop_map(|(radii, x)| Footprint::polygon(star(&radii, (x, 0.0))).unwrap()),
    ];
    (footprint, prop::bool::ANY, 0.0..0.5f64).prop_map(|(footprint, is_fast, back_mps)| {
        let robot = if is_fast { Robot::jackal() } else { Robot::small() };
        let limits = crate::robot::Limits { v_min_mps: -back_mps, ..robot.limits };
        Robot { footprint, limits, ..robot }
    })
}

/// Commands of a mad local planner: each for a number of cycles, as fractions of the limits.
pub(super) fn commands() -> impl Strategy<Value = Vec<(f64, f64, usize)>> {
    let v = prop_oneof![Just(1.0), Just(0.0), -0.2..1.0f64];
    let omega = prop_oneof![Just(0.0), -1.0..1.0f64];
    prop::collection::vec((v, omega, 1usize..20), 6)
}

pub(super) fn every_cycle(robot: &Robot, commands: &[(f64, f64, usize)]) -> Vec<Velocity> {
    let Robot { limits, .. } = robot;
    let asked = |&(v, omega, cycles): &(f64, f64, usize)| {
        std::iter::repeat_n(
            Velocity::new(v * limits.v_max_mps, omega * limits.omega_max_radps),
            cycles,
        )
    };
    commands.iter().flat_map(asked).collect()
}

/// True if a cycle brakes along the present arc. That is issued unchecked, as part of the
/// manoeuvre that was admitted last: it keeps the clearance of that time.
fn brakes(robot: &Robot, velocity: Velocity, next: Velocity) -> bool {
    next == robot.limits.reached(
        velocity,
        robot.limits.braked(velocity, robot.cycle_s),
        robot.cycle_s,
    )
}

/// Distance that a robot moves in a cycle in which it counts as stationary and gets no other
/// command: its odometry is then taken for noise.
fn drifts_m(robot: &Robot, velocity: Velocity, next: Velocity) -> f64 {
    if !robot.stands(velocity) {
        return 0.0;
    }
    let unless_asked =
        |now: f64, next: f64| if next == 0.0 { 0.5 * now * robot.cycle_s } else { 0.0 };
    let (core, _) = robot.footprint.core();
    core.moves_m(unless_asked(velocity.v, next.v), unless_asked(velocity.omega, next.omega))
}

/// Instants of a cycle: pose, velocity and time since its beginning.
pub(super) fn instants(
    robot: &Robot,
    mut pose: Pose,
    from: Velocity,
    to: Velocity,
) -> impl Iterator<Item = (Pose, Velocity, f64)> {
    const PARTS: u32 = 6;
    let arc_s = robot.cycle_s / f64::from(Pose::RAMP_ARCS);
    Pose::ramp_arcs(from, to).enumerate().flat_map(move |(arc, velocity)| {
        let start = pose;
        pose = pose.after_arc(velocity, arc_s);
        (0..=PARTS).map(move |part| {
            let elapsed_s = arc_s * f64::from(part) / f64::from(PARTS);
            (start.after_arc(velocity, elapsed_s), velocity, arc as f64 * arc_s + elapsed_s)
        })
    })
}

fn frame() -> GridFrame {
    GridFrame::new(40, 30, 0.1, Pose::new(1.0, -2.0, 0.3)).unwrap()
}

fn cells() -> impl Strategy<Value = Vec<bool>> {
    prop::collection::vec(prop::bool::weighted(0.015), 40 * 30)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn a_mad_planner_touches_nothing_that_stands(
        cells in cells(), robot in robots(), x in 3.0..37.0f64, y in 3.0..27.0f64, theta in -3.1..3.1f64,
        commands in commands(),
    ) {
        let ground = Ground::new(&frame(), &cells);
        let at = frame().world_from_grid(Point::new(x, y));
        let (mut pose, mut velocity) = (Pose::new(at.x, at.y, theta), Velocity::ZERO);
        let start_m = ground.room_m(&robot.footprint, pose);
        prop_assume!(start_m > 2e-4);
        let rule = rule(&robot);
        let mut scratch = Scratch::default();
        let mut kept_m = start_m.min(rule.config.margin_m);
        for command in every_cycle(&robot, &commands) {
            let gated = rule.gate(&ground.around(pose, velocity, &[]), command, &mut scratch);
            let next = robot.limits.reached(velocity, gated.command, robot.cycle_s);
            if !brakes(&robot, velocity, next) {
                kept_m = ground.room_m(&robot.footprint, pose).min(rule.config.margin_m);
                kept_m -= drifts_m(&robot, velocity, next);
            }
            for (on_way, ..) in instants(&robot, pose, velocity, next) {
                let room_m = ground.room_m(&robot.footprint, on_way);
                prop_assert!(room_m >= 0.5 * kept_m - 1e-9, "{room_m} {kept_m} {on_way:?} {gated:?}");
            }
            (pose, velocity) = (pose.after_ramp(velocity, next, robot.cycle_s), next);
            let room_m = ground.room_m(&robot.footprint, pose);
            prop_assert!(room_m >= kept_m - 1e-8, "{room_m} {kept_m} {gated:?}");
        }
    }

    /// A robot that begins in contact may leave it, and touches nothing else meanwhile.
    #[test]
    fn a_mad_planner_in_contact_touches_nothing_more(
        cells in cells(), robot in robots(), x in 3.0..37.0f64, y in 3.0..27.0f64, theta in -3.1..3.1f64,
        beside in 0.0..0.3f64, commands in commands(),
    ) {
        let at = frame().world_from_grid(Point::new(x, y));
        let (mut pose, mut velocity) = (Pose::new(at.x, at.y, theta), Velocity::ZERO);
        // An obstacle beside the middle of the robot: mostly within it.
        let mut cells = cells;
        let post = frame().cell_from_world(pose.world_from_body(Point::new(0.12 + beside, 0.05)));
        prop_assume!(post.is_some());
        let post = post.unwrap();
        cells[(post.y * 40 + post.x) as usize] = true;
        let ground = Ground::new(&frame(), &cells);
        let (core, radius_m) = robot.footprint.core();
        let near_at = |pose, gap_m: f64| {
            let (mut near, touch_m) = (Vec::new(), radius_m + gap_m);
            core.touched(pose, &ground.field.clearance(), touch_m, &mut near);
            near
        };
        let centre_m = ground.field.clearance().of_point(pose.point(), 1.0);
        prop_assume!(!near_at(pose, 0.0).is_empty() && centre_m > 1e-3);
        let mut allowed = Vec::new();
        prop_assume!(robot.footprint.to_border_m(pose, &ground.field.clearance()) > 0.0);
        let rule = rule(&robot);
        let mut scratch = Scratch::default();
        for command in every_cycle(&robot, &commands) {
            let gated = rule.gate(&ground.around(pose, velocity, &[]), command, &mut scratch);
            let next = robot.limits.reached(velocity, gated.command, robot.cycle_s);
            if !brakes(&robot, velocity, next) {
                // Smaller distances cannot be distinguished from contact.
                allowed = near_at(pose, 1e-4 + drifts_m(&robot, velocity, next));
            }
            for (on_way, ..) in instants(&robot, pose, velocity, next) {
                let touched = near_at(on_way, 0.0);
                let more = touched.iter().find(|cell| !allowed.contains(cell));
                prop_assert!(velocity == Velocity::ZERO && next == velocity || more.is_none(), "{more:?} at {on_way:?} {gated:?}");
            }
            (pose, velocity) = (pose.after_ramp(velocity, next, robot.cycle_s), next);
        }
    }

    /// Against a literal reading of the rule: the manoeuvre at closely spaced instants.
    #[test]
    fn admissible_is_what_the_whole_manoeuvre_says(
        cells in cells(), robot in robots(), x in 3.0..37.0f64, y in 3.0..27.0f64, theta in -3.1..3.1f64,
        (from_v, from_omega, v, omega) in (0.0..1.0f64, -1.0..1.0f64, -0.2..1.0f64, -1.0..1.0f64),
        mover in (0.0..4.0f64, 0.0..3.0f64, 0.0..0.4f64, -1.0..1.0f64, -1.0..1.0f64), acceleration_mps2 in prop::option::of(0.0..2.0f64),
    ) {
        let ground = Ground::new(&frame(), &cells);
        let at = frame().world_from_grid(Point::new(x, y));
        let pose = Pose::new(at.x, at.y, theta);
        let Robot { limits, cycle_s, .. } = &robot;
        let part = |v: f64, omega: f64| Velocity::new(v * limits.v_max_mps, omega * limits.omega_max_radps);
        let bounds = MoverBounds { speed_mps: 0.6, acceleration_mps2 };
        let config = StopRuleConfig { movers: bounds, ..StopRuleConfig::for_robot(&robot) };
        let margin_m = config.margin_m;
        let rule = StopRule::new(config, robot.clone()).unwrap();
        let mover_at = frame().world_from_grid(Point::new(mover.0 * 10.0, mover.1 * 10.0));
        let mover = Mover {
            velocity_mps: Point::new(mover.3, mover.4) * 0.5, velocity_uncertainty_mps: 0.1,
            ..Mover::standing(9, mover_at, mover.2)
        };
        let (core, radius_m) = robot.footprint.core();
        let room_m = |on_way: Pose, after_s: f64| {
            let gap_m = |disc: crate::geometry::Disc| core.distance_to_m(on_way, disc.centre) - disc.radius_m - radius_m;
            let by_speed_m = gap_m(mover.by_speed(after_s, &bounds));
            let by_mover_m = mover.by_estimate(after_s, &bounds).map_or(by_speed_m, |disc| gap_m(disc).max(by_speed_m));
            ground.room_m(&robot.footprint, on_way).min(by_mover_m)
        };
        prop_assume!(room_m(pose, 0.0) > margin_m);
        let (mut from, mut to) = (part(from_v, from_omega), part(v, omega));
        let gated = gate(&rule, &ground.around(pose, from, &[mover]), to);
        let is_braking = limits.reached(from, to, *cycle_s) == limits.braked(from, *cycle_s);
        let (mut on_way, mut after_s, mut least_m) = (pose, 0.0, f64::INFINITY);
        while from != Velocity::ZERO || to != Velocity::ZERO {
            let next = limits.reached(from, to, *cycle_s);
            for (at, _, elapsed_s) in instants(&robot, on_way, from, next) {
                least_m = least_m.min(room_m(at, after_s + elapsed_s));
            }
            on_way = on_way.after_ramp(from, next, *cycle_s);
            after_s += cycle_s;
            (from, to) = (next, limits.braked(next, *cycle_s));
        }
        // Steps and instants are a margin apart at most.
        if least_m >= 2.0 * margin_m {
            prop_assert!(!gated.changed(), "{least_m} {gated:?}");
        }
        if least_m < 0.5 * margin_m && !is_braking {
            prop_assert!(gated.changed(), "{least_m}");
        }
    }

    /// If there is space for everything the robot can do, it may do everything.
    #[test]
    fn nothing_is_changed_in_the_open(
        robot in robots(), commands in commands(), theta in -3.1..3.1f64, bearing in -3.1..3.1f64,
    ) {
        let (rule, ground) = (rule(&robot), Ground::open());
        let reach_m = 2.0 * robot.decision_reach_m();
        let far = Mover::standing(1, direction(bearing) * (reach_m + 4.0), 0.3);
        let mut velocity = Velocity::ZERO;
        for command in every_cycle(&robot, &commands) {
            let around = ground.around(Pose::new(0.0, 0.0, theta), velocity, std::slice::from_ref(&far));
            prop_assert_eq!(gate(&rule, &around, command), Gated { command, why: None });
            velocity = robot.limits.reached(velocity, command, robot.cycle_s);
        }
    }
}

pub(super) fn direction(rad: f64) -> Point {
    Point::new(libm::cos(rad), libm::sin(rad))
}
