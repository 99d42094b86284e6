//! Both directions of rotation of a sensor.

use super::*;

/// The same scan of a sensor that rotates clockwise.
fn clockwise(mut scan: Scan) -> Scan {
    scan.angle_min_rad = scan.bearing_rad(scan.ranges_m.len() - 1);
    scan.angle_increment_rad = -scan.angle_increment_rad;
    scan.ranges_m.reverse();
    scan
}

#[test]
fn beams_may_go_either_way() {
    let walls = [[2.5, -3.0, 2.6, 3.0]];
    let [mut left, mut right] =
        [(); 2].map(|()| Drive::new(map(&walls), &[[1.0, -2.0, 1.4, -1.6]]));
    let mut seen = 0;
    for cycle in 0..60 {
        let (pose, t_s) = (slalom(cycle), 0.1 * f64::from(cycle));
        let circles = [(Point::new(1.5, -2.0 + 0.6 * t_s), RADIUS_M), (Point::new(-3.0, 1.0), 0.2)];
        let scan = left.scan(pose, &circles);
        let movers = left.step_with(pose, &scan).to_vec();
        let others = right.step_with(pose, &clockwise(scan));
        assert_eq!(movers.len(), others.len(), "cycle {cycle}");
        for (one, other) in movers.iter().zip(others) {
            assert!(one.centre.distance(other.centre) < 1e-6, "cycle {cycle}: {one:?} {other:?}");
            assert!((one.velocity_mps - other.velocity_mps).norm() < 1e-6, "cycle {cycle}");
        }
        seen += movers.len();
    }
    assert!(seen > 40 && left.layer.count() > 0, "{seen}");
    assert_eq!(left.layer.count(), right.layer.count());
}
