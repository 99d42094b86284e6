//! Backing up outside the field of view.

use super::tests::{Ground, gate, rule};
use super::*;
use crate::geometry::Pose;
use crate::map::{BitGrid, Cell, GridFrame};
use std::f64::consts::PI;

const BACK: Velocity = Velocity::new(-0.5, 0.0);
const REST: Velocity = Velocity::ZERO;

/// A map of 20 m x 20 m with cells of 0.1 m around the origin, seen in these columns.
fn seen(columns: std::ops::RangeInclusive<i32>) -> BitGrid {
    let mut cells = BitGrid::new(200, 200, false);
    for y in 0..200 {
        cells.fill_span(y, *columns.start(), *columns.end());
    }
    cells
}

#[test]
fn it_backs_up_over_seen_ground_only() {
    let (ground, rule) = (Ground::open(), rule(&Robot::jackal()));
    let at = |theta: f64, velocity: Velocity, command: Velocity, seen: &BitGrid| {
        let around = ground.around(Pose::new(0.0, 0.0, theta), velocity, &[]);
        gate(
            &rule,
            &Surroundings {
                seen: SeenCells { behind: Some(seen), ..SeenCells::ANYWHERE },
                ..around
            },
            command,
        )
    };
    // Its rear is at x = -0.254 m, it stops from 0.15 m/s within 0.02 m; columns begin at -0.3 m.
    assert!(!at(0.0, REST, BACK, &seen(97..=199)).changed());
    let refused = at(0.0, REST, BACK, &seen(98..=199));
    assert!(matches!(refused.why, Some(Refusal::Unseen { after_s }) if after_s < 0.2));
    assert_eq!(refused.command, REST);
    // With its back to the observed ground, and ahead, it may go.
    assert!(!at(PI, REST, BACK, &seen(0..=102)).changed());
    assert!(!at(0.0, REST, Velocity::new(0.5, 1.0), &seen(98..=199)).changed());
    assert!(!at(0.0, REST, Velocity::new(0.0, 1.0), &seen(98..=199)).changed());
    // A robot that backs up already brakes as hard as it can; to turn meanwhile would be another
    // motion.
    let braking = Robot::jackal().limits.braked(BACK, 0.05);
    for command in [BACK, Velocity::new(-0.2, 0.3), REST, Velocity::new(2.0, 0.0)] {
        let gated = at(0.0, BACK, command, &seen(98..=199));
        let reached = Robot::jackal().limits.reached(BACK, gated.command, 0.05);
        assert_eq!(reached, braking, "{command:?}");
    }
    // The rest of its backward motion has to be driven, or is noise of a robot that drives off.
    for v in [-0.1, -0.01] {
        let (before, ahead) = (Velocity::new(v, 0.0), Velocity::new(0.5, 0.0));
        assert!(!at(0.0, before, ahead, &seen(98..=199)).changed());
    }
    // The distance that it moves in the cycle and while it brakes: 0.025 m and 0.04 m.
    let mut some = seen(97..=199);
    assert!(!at(0.0, BACK, BACK, &seen(96..=199)).changed());
    assert!(at(0.0, BACK, BACK, &some).changed());
    // A robot that turns fast needs longer to stop than the ground is known to be free.
    for (omega, is_refused) in [(0.5, false), (-0.5, false), (2.0, true), (-3.0, true)] {
        let arc = Velocity::new(-0.5, omega);
        let gated = at(0.0, arc, arc, &seen(0..=199));
        assert_eq!(matches!(gated.why, Some(Refusal::Unseen { .. })), is_refused, "{omega}");
    }
    // A corner is enough.
    for y in 0..=98 {
        (0..98).for_each(|x| _ = some.set(Cell::new(x, y), false));
        some.set(Cell::new(97, y), false);
    }
    assert!(at(0.0, REST, BACK, &some).changed());
}

/// In cells of 1 m, there may be no observed cell three quarters of a cell before a wall or the
/// end of the map: no beam continues beyond either.
#[test]
fn it_drives_up_to_what_is_known_to_end_the_way() {
    let frame = GridFrame::new(6, 3, 1.0, Pose::default()).unwrap();
    let wall = Cell::new(5, 1);
    let walled = frame.cells().map(|cell| cell == wall).collect::<Vec<_>>();
    let (with_wall, open) = (Ground::new(&frame, &walled), Ground::new(&frame, &[]));
    let rule = rule(&Robot::paper());
    let passes = |ground: &Ground, x: f64, is_seen: &dyn Fn(Cell) -> bool| {
        let mut cells = BitGrid::new(6, 3, false);
        for cell in frame.cells() {
            cells.set(cell, is_seen(cell));
        }
        let around = ground.around(Pose::new(x, 1.5, 0.0), REST, &[]);
        let seen = SeenCells { ahead: Some(&cells), ..SeenCells::ANYWHERE };
        !gate(&rule, &Surroundings { seen, ..around }, Velocity::new(0.02, 0.0)).changed()
    };
    // 0.4 m before the wall, and before the end of the map.
    assert!(passes(&with_wall, 4.6, &|cell| cell != wall));
    assert!(passes(&open, 5.6, &|_| true));
    // An unobserved cell may be occupied.
    assert!(!passes(&open, 4.6, &|cell| cell.x < 5));
}
