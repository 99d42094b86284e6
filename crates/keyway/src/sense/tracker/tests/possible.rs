//! Tracks that may move: not confirmed to be stationary.

use super::*;

/// Posts around the robot.
fn posts(off_m: f64) -> Vec<(Point, f64)> {
    (0..4).map(|i| (Point::new(1.2 - off_m, 0.7 * f64::from(i) - 1.0), 0.15)).collect()
}

/// Posts seen 0.1 m off their position by one scan, and posts that are pushed by as much: both
/// may be moving obstacles for a while.
#[test]
fn what_stands_after_all_is_no_mover_for_long() {
    for is_pushed in [false, true] {
        let mut drive = Drive::new(map(&[]), &[]);
        let mut possible = Vec::new();
        for cycle in 0..60 {
            let is_off = !is_pushed && cycle == 20;
            let off_m = if is_off || is_pushed && cycle >= 20 { 0.1 } else { 0.0 };
            let movers = drive.step(Pose::default(), &posts(off_m));
            assert!(is_pushed || movers.is_empty(), "cycle {cycle}: {movers:?}");
            possible.push(drive.tracker.possible_movers().len());
        }
        let last = possible.iter().rposition(|&count| count > 0).unwrap();
        let longest = if is_pushed { 45 } else { 37 };
        assert!(last >= 20 && last <= longest, "{is_pushed}: {possible:?}");
    }
}

/// Range errors on many beams, more than twice as large as the tracker expects.
#[test]
fn single_beams_are_errors() {
    let mut drive = Drive::new(map(&[]), &[]);
    drive.robot = Robot::jackal();
    let mut noise = 1u32;
    let mut cycles = 0;
    for _ in 0..100 {
        let mut scan = drive.scan(Pose::default(), &posts(0.0));
        for range_m in scan.ranges_m.iter_mut().filter(|range_m| range_m.is_finite()) {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *range_m += 0.045 * (f64::from(noise) / f64::from(u32::MAX) * 2.0 - 1.0);
        }
        let scan = projected(drive.known.frame(), Pose::default(), &scan);
        drive.tracker.update(&drive.known, &scan, 0.05);
        cycles += u32::from(!drive.tracker.possible_movers().is_empty());
    }
    assert!(cycles <= 10, "{cycles}");
}

/// Too narrow for its shape to be known, so nothing shows that it has left its position. Beams
/// see through that position forever.
#[test]
fn what_was_pushed_away_stands_again() {
    let mut drive = Drive::new(map(&[]), &[]);
    for cycle in 0..60 {
        let x_m = if cycle < 20 { 0.9 } else { 0.98 };
        let pair = [-0.03, 0.03].map(|y_m| (Point::new(x_m, y_m), 0.04));
        let movers = drive.step(Pose::default(), &pair);
        assert!(movers.is_empty(), "cycle {cycle}: {movers:?}");
    }
    assert!(drive.tracker.possible_movers().is_empty());
}

/// The visible middle of an object that is not round moves as more of it comes into view: it may
/// be stationary, however fast it seems. A disc that moves may not.
#[test]
fn who_is_not_round_may_stand() {
    let seen = |discs: &[(Point, f64)]| {
        let mut drive = Drive::new(map(&[]), &[]);
        for cycle in 0..20 {
            let moved = Point::new(0.0, 0.08 * f64::from(cycle) - 1.2);
            let now: Vec<_> = discs.iter().map(|&(at, radius_m)| (at + moved, radius_m)).collect();
            drive.step(Pose::default(), &now);
        }
        assert_eq!(drive.tracker.movers().len(), 1, "{:?}", drive.tracker.movers());
        let points = drive.tracker.surfaces_after(0.5);
        points.map(|point| point.velocity_mps.norm()).collect::<Vec<f64>>()
    };
    assert!(seen(&[(Point::new(1.8, 0.0), 0.25)]).is_empty());
    // Two touching discs move as one.
    let pair = seen(&[(Point::new(1.8, -0.17), 0.17), (Point::new(1.8, 0.17), 0.17)]);
    let standing = pair.iter().filter(|&&speed_mps| speed_mps == 0.0).count();
    assert!(standing > 5 && 2 * standing == pair.len(), "once as it goes on: {pair:?}");
    assert!(pair.iter().any(|&speed_mps| speed_mps > 0.5), "{pair:?}");
}
