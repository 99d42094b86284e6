//! A navigator with a goal, cycle by cycle.
#![allow(dead_code, reason = "each test uses its part")]

use keyway::geometry::{Point, Pose, Velocity};
use keyway::map::OccupancyGrid;
use keyway::navigate::{FittedStack, Goal, NavigateError, Navigator, Step};
use keyway::sense::{Observation, Scan, SensorScan};

/// A navigator that drives from a start to a goal.
pub(crate) fn bound_for(
    map: &OccupancyGrid,
    stack: &FittedStack,
    start: Point,
    goal: impl Into<Goal>,
) -> Result<Navigator, NavigateError> {
    let mut navigator = Navigator::new(map, stack)?;
    navigator.relocate(Pose { x: start.x, y: start.y, theta: 0.0 });
    navigator.set_goal(goal)?;
    Ok(navigator)
}

/// The stamp of the next cycle.
pub(crate) fn next_stamp_s(navigator: &Navigator) -> f64 {
    let cycle_s = navigator.stack().robot().cycle_s;
    navigator.now_s().map_or(0.0, |stamp_s| stamp_s + cycle_s)
}

/// The next cycle, with a scan of the only sensor.
pub(crate) fn next_step(
    navigator: &mut Navigator,
    pose: Pose,
    velocity: Velocity,
    scan: &Scan,
) -> Step {
    let stamp_s = next_stamp_s(navigator);
    let scans = [SensorScan::centred(stamp_s, scan)];
    navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
    navigator.step()
}
