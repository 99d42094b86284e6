//! Passages that are hardly wider than the robot.

use super::*;

/// Cells of 2 cm; two halls, and a tunnel of 0.44 m from one to the other, 2 m long.
fn tunnel() -> DistanceField {
    world_of(0.02, 250, |x, y| (75..175).contains(&x) && !(114..136).contains(&y))
}

fn disc(radius_m: f64) -> Robot {
    Robot { footprint: Footprint::circle(radius_m).unwrap(), ..Robot::small() }
}

/// The middle of the tunnel is beside the points at which distances are known, which are too
/// small there by up to 3 cm.
#[test]
fn a_tunnel_with_room_on_both_sides_is_driven_through() {
    let world = tunnel();
    for radius_m in [0.18, 0.19, 0.2] {
        let robot = disc(radius_m);
        let route = [[0.8, 2.5], [4.2, 2.5]];
        let mut drive = Drive::new(&robot, &world, Pose::new(0.8, 2.5, 0.0), &route);
        // 3.25 m at full speed take 6.5 s, and a second more to speed up and to brake.
        let taken_s = drive.arrive(30.0);
        assert!(taken_s.is_some_and(|taken_s| taken_s < 1.3 * 7.5), "{radius_m}: {taken_s:?}");
    }
}

/// A centimetre beside a wall, along it: to stay would cost nothing, and not make the passage
/// wider.
#[test]
fn a_robot_in_a_tight_place_drives_on() {
    let world = world(100, |_, y| y == 0);
    let robot = Robot { footprint: Footprint::rectangle(0.6, 0.4).unwrap(), ..Robot::small() };
    let route = [[1.0, 0.26], [1.05, 0.6], [4.6, 3.4]];
    let mut drive = Drive::new(&robot, &world, Pose::new(1.0, 0.26, 0.0), &route);
    for _ in 0..100 {
        drive.cycle();
    }
    assert!(drive.pose.x > 1.1, "{:?}", drive.pose);
}
