//! Remedies for a robot that cannot drive.
//!
//! The [`Change`]s are tried in turn, each alone: the change is applied, and the planner decides
//! again. So each result is the planner's own. Of turns, the smallest multiple of 15 degrees that
//! helps is given, trying the side of the guide point first; of margins and footprints, the least
//! change, found by bisection.
//!
//! # Errors / cost
//! None. Up to 40 decisions.

use super::{Change, Remedy, Scene, Scratch, StopRule, StopRuleConfig, Surroundings};
use crate::geometry::Pose;
use crate::robot::{Limits, Robot};
use std::f64::consts::PI;
use std::sync::Arc;

/// Turns that are tried are multiples of this \[rad\].
const TURN_STEP_RAD: f64 = PI / 12.0;

/// Resolution of the largest margin and of the largest footprint that help \[m\].
const MARGIN_STEP_M: f64 = 1e-4;
const FOOTPRINT_STEP_M: f64 = 1e-3;

/// A local planner that can be evaluated under changed conditions.
pub(super) trait Remediable: Sized {
    /// The robot that is driven.
    fn robot(&self) -> &Robot;

    /// True if some candidate drives.
    fn drives(&self, scene: &Scene<'_>) -> bool;

    /// The same planner for another robot; `None` if its parameters do not fit.
    fn for_other(&self, robot: Robot) -> Option<Self>;

    /// True if the planner may drive backwards with a robot that can.
    fn backs_up(&self) -> bool;

    /// The same planner for a robot that backs up, with backing up enabled.
    fn backing_up(&self, robot: Robot) -> Option<Self>;

    /// Margin that the planner keeps from obstacles \[m\]; 0 for none.
    fn margin_m(&self) -> f64 {
        0.0
    }

    /// The same planner with another margin \[m\].
    fn with_margin(&self, _margin_m: f64) -> Option<Self> {
        None
    }
}

/// Remedies for a robot that cannot drive.
pub(super) fn of(planner: &impl Remediable, scene: &Scene<'_>) -> Vec<Remedy> {
    let (standing, duration_s) = stopped(planner.robot(), scene);
    let wait = Remedy {
        change: Change::Wait { duration_s },
        frees: standing.is_some_and(|standing| planner.drives(&standing)),
    };
    let mut remedies = vec![wait];
    let turns = planner.robot().limits.turns_in_place();
    remedies.extend(turns.then(|| turn(planner, standing.as_ref())));
    remedies.extend(back_up(planner, standing.as_ref()));
    remedies.extend(smaller_margin(planner, scene));
    remedies.extend(smaller_footprint(planner, scene));
    remedies
}

/// The scene in which the robot is stationary after braking on its arc, and the duration of that
/// \[s\], at least a cycle; no scene if braking does not keep the margin of the [stop
/// rule](StopRule).
fn stopped<'a>(robot: &Robot, scene: &Scene<'a>) -> (Option<Scene<'a>>, f64) {
    let braking = robot.limits.braked(scene.velocity, robot.cycle_s);
    let (mut standing, mut duration_s) = (*scene, 0.0);
    for motion in robot.motion_to_stop(scene.pose, scene.velocity, braking) {
        (standing.pose, standing.velocity) = (motion.end, motion.to);
        duration_s += robot.cycle_s;
    }
    let rule = StopRule::for_any_brakes(StopRuleConfig::for_robot(robot), Arc::new(robot.clone()));
    let around = Surroundings::standing(scene);
    let is_free =
        rule.is_ok_and(|rule| rule.admits(&around, braking, &mut Scratch::default()).is_ok());
    (is_free.then_some(standing), duration_s)
}

fn turn(planner: &impl Remediable, standing: Option<&Scene<'_>>) -> Remedy {
    let not = Remedy { change: Change::Turn { by_rad: PI }, frees: false };
    let Some(scene) = standing else { return not };
    let (point, theta) = (scene.pose.point(), scene.pose.theta);
    let towards_rad = TURN_STEP_RAD.copysign(scene.pose.bearing_to(scene.guide));
    let steps = (PI / TURN_STEP_RAD).round() as u32;
    let turns = (1..=steps).map(f64::from).flat_map(|k| [k * towards_rad, -k * towards_rad]);
    let frees = |by_rad: &f64| {
        let turned = Scene { pose: Pose::new(point.x, point.y, theta + by_rad), ..*scene };
        planner.robot().footprint.is_free_turn(point, theta, *by_rad, scene.obstacles)
            && planner.drives(&turned)
    };
    let found = turns.into_iter().find(frees);
    found.map_or(not, |by_rad| Remedy { change: Change::Turn { by_rad }, frees: true })
}

/// Backing up at the largest speed that can be reached in a cycle; `None` for a robot that may
/// anyway.
fn back_up(planner: &impl Remediable, standing: Option<&Scene<'_>>) -> Option<Remedy> {
    let robot = planner.robot();
    let can_reverse = robot.limits.v_min_mps < 0.0;
    if can_reverse && planner.backs_up() {
        return None;
    }
    let limits = &robot.limits;
    let by_a_cycle_mps = -(limits.acceleration_mps2 * robot.cycle_s).min(limits.v_max_mps);
    let v_min_mps = if can_reverse { limits.v_min_mps } else { by_a_cycle_mps };
    let limits = Limits { v_min_mps, ..limits.clone() };
    let changed = planner.backing_up(Robot { limits, ..robot.clone() });
    let frees =
        changed.is_some_and(|changed| standing.is_some_and(|standing| changed.drives(standing)));
    Some(Remedy { change: Change::BackUp { v_min_mps }, frees })
}

/// The largest margin that helps; `None` if there is no margin.
fn smaller_margin(planner: &impl Remediable, scene: &Scene<'_>) -> Option<Remedy> {
    let kept_m = planner.margin_m();
    if kept_m == 0.0 {
        return None;
    }
    let frees =
        |margin_m: f64| planner.with_margin(margin_m).is_some_and(|changed| changed.drives(scene));
    let without_frees = frees(0.0);
    let (mut safety_margin_m, mut too_large_m) = (0.0, kept_m);
    // Floating-point numbers are dense near 0: this ends for any margin.
    while without_frees && too_large_m - safety_margin_m > MARGIN_STEP_M {
        let middle_m = 0.5 * (safety_margin_m + too_large_m);
        *(if frees(middle_m) { &mut safety_margin_m } else { &mut too_large_m }) = middle_m;
    }
    Some(Remedy { change: Change::SafetyMargin { safety_margin_m }, frees: without_frees })
}

/// The least reduction of the footprint that helps; `None` for a point.
fn smaller_footprint(planner: &impl Remediable, scene: &Scene<'_>) -> Option<Remedy> {
    let robot = planner.robot();
    // Almost a point: a polygon needs some area.
    let most_m = 0.99 * robot.footprint.inscribed_radius_m();
    if most_m == 0.0 {
        return None;
    }
    let frees = |smaller_by_m| {
        let Some(footprint) = robot.footprint.smaller_by(smaller_by_m) else { return false };
        let changed = planner.for_other(Robot { footprint, ..robot.clone() });
        changed.is_some_and(|changed| changed.drives(scene))
    };
    let found_m = least(most_m, FOOTPRINT_STEP_M, frees);
    let change = Change::Footprint { smaller_by_m: found_m.unwrap_or(most_m) };
    Some(Remedy { change, frees: found_m.is_some() })
}

/// A change up to `most` that helps, such that one that is smaller by `step` does not (if more
/// always helps more).
fn least(most: f64, step: f64, helps: impl Fn(f64) -> bool) -> Option<f64> {
    if !helps(most) {
        return None;
    }
    let (mut low, mut high) = (0.0, most);
    while high - low > step {
        let middle = 0.5 * (low + high);
        *(if helps(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}
