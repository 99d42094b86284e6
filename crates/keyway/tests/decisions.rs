//! Local planners in the loop: nothing is allocated once they are warm.
#![allow(clippy::unwrap_used)]

use keyway::geometry::{Polyline, Pose, Velocity};
use keyway::local::{DriveMemory, LocalConfig, Scene, Scratch};
use keyway::map::{BitGrid, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
use keyway::robot::Robot;

#[test]
fn warm_decisions_allocate_nothing() {
    let frame = GridFrame::new(200, 200, 0.05, Pose::default()).unwrap();
    let grid = OccupancyGrid::from_fn(frame, |cell| {
        let is_post = cell.x % 40 < 2 && cell.y % 40 < 2;
        let is_on_the_route = (60..62).contains(&cell.x) && (19..21).contains(&cell.y);
        if is_post || is_on_the_route { CellState::Occupied } else { CellState::Free }
    });
    let obstacles = &DistanceField::new(&frame, grid.occupied(), &FieldConfig::default());
    let mut sensed = BitGrid::new(200, 200, false);
    (19..21).for_each(|y| sensed.fill_span(y, 60, 61));
    let sensed = &sensed;
    let path = Polyline::new([[1.0, 1.0], [5.0, 1.0], [9.0, 9.0]].map(Into::into).to_vec());
    let guide = path.points()[1];
    let robots = [Robot::small(), Robot::jackal()];
    for (name, robot) in
        LocalConfig::NAMES.iter().flat_map(|name| robots.iter().map(move |r| (name, r)))
    {
        let planner = LocalConfig::by_name(name, robot).unwrap().build(robot).unwrap();
        let mut scratch = Scratch::default();
        let mut drive = || {
            let (mut pose, mut velocity) = (Pose::new(1.0, 1.0, 0.3), Velocity::ZERO);
            let mut memory = DriveMemory::default();
            let mut is_on_detour = false;
            for _ in 0..60 {
                let scene = Scene {
                    obstacles,
                    sensed,
                    seen: keyway::sense::SeenCells::ANYWHERE,
                    movers: &[],
                    walked: &[],
                    pose,
                    velocity,
                    guide,
                    path: &path,
                    goal_heading_rad: None,
                    remaining_m: f64::INFINITY,
                    jerk_limited: None,
                };
                let decision = planner.decide(&scene, &mut memory, &mut scratch);
                let command = decision.map_or_else(|why| why.fallback, |decision| decision.command);
                pose = pose.after_ramp(velocity, command, robot.cycle_s);
                velocity = command;
                is_on_detour |= memory.detour().is_some();
            }
            (pose.point().distance(path.points()[0]), is_on_detour)
        };
        let (driven_m, is_on_detour) = drive();
        // The same drive again.
        let info = allocation_counter::measure(|| assert_eq!(drive(), (driven_m, is_on_detour)));
        assert_eq!(info.count_total, 0, "{name}");
        assert!(driven_m > 1.0, "{name} drove {driven_m} m");
        assert_eq!(is_on_detour, *name == "guided-dwa", "{name}");
    }
}
