//! Sensor errors in the scans given to the controller.

use super::gaussian::Gaussian;
use super::{Kind, SensorFaults, Source, cycles_late};
use keyway::random::Random;
use keyway::robot::RangeSensor;
use keyway::sense::Scan;
use std::collections::VecDeque;

/// A robot's sensor: its scan times and its faults.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Sensing {
    clock: ScanClock,
    source: Source,
    faults: Option<Faults>,
}

/// Cycles in which a sensor scans: the first one, and then one in each period.
#[derive(Clone, Copy, Debug)]
struct ScanClock {
    period_s: f64,
    cycle_s: f64,
}

impl ScanClock {
    fn scans_in(self, cycle: u64) -> bool {
        // A period that ends at the beginning of a cycle has ended, despite rounding.
        let periods = |cycle: u64| (cycle as f64 * self.cycle_s / self.period_s + 1e-9).floor();
        cycle == 0 || periods(cycle) > periods(cycle - 1)
    }
}

/// Faults of a sensor, with their random numbers.
#[derive(Clone, Debug)]
struct Faults {
    sensor: SensorFaults,
    /// Index of the sensor on the robot.
    index: usize,
    ranges: Gaussian,
    beams: Random,
    scans: Random,
    repeats: Random,
    /// Delay from a scan to its arrival at the controller \[cycles\].
    late: usize,
    /// Scans in transit, oldest first, each with the cycle in which it arrives.
    under_way: VecDeque<(u64, Vec<f64>)>,
    /// Ranges of the last new scan, for repetitions.
    last_m: Vec<f64>,
}

impl Sensing {
    /// A sensor with these faults on a robot with this control cycle.
    pub(in crate::sim) fn new(
        sensor: SensorFaults,
        source: Source,
        (described, cycle_s): (&RangeSensor, f64),
    ) -> Self {
        let described_s = described.period_in_s(cycle_s);
        let period_s = if sensor.period_s > 0.0 { sensor.period_s } else { described_s };
        let faults = (!sensor.is_none()).then(|| Faults {
            ranges: Gaussian::new(source, Kind::Range),
            beams: source.stream(Kind::DroppedBeam),
            scans: source.stream(Kind::DroppedScan),
            repeats: source.stream(Kind::RepeatedScan),
            late: cycles_late(sensor.delay_s, cycle_s),
            under_way: VecDeque::new(),
            last_m: Vec::new(),
            index: source.sensor,
            sensor,
        });
        Self { clock: ScanClock { period_s, cycle_s }, source, faults }
    }

    /// True if the sensor scans in this cycle.
    pub(in crate::sim) fn scans_in(&self, cycle: u64) -> bool {
        self.clock.scans_in(cycle)
    }

    /// Stamp of the scan that the controller gets in a cycle \[s\].
    pub(in crate::sim) fn stamp_s(&self, cycle: u64) -> f64 {
        let cycle_s = self.clock.cycle_s;
        self.faults.as_ref().map_or(cycle as f64 * cycle_s, |faults| {
            cycle.saturating_sub(faults.late as u64) as f64 * cycle_s + faults.sensor.stamp_late_s
        })
    }

    /// Random numbers that decide which beams of a cycle's scan detect an elusive obstacle.
    pub(in crate::sim) fn glimpses(&self, cycle: u64) -> Random {
        Random::new(self.source.stream(Kind::Glimpse).bits() ^ cycle)
    }

    /// Replaces the exact scan of a cycle by the one that the controller gets in it. The exact
    /// scan is ignored outside the cycles of [`Self::scans_in`]. Returns false if the controller
    /// gets no scan; every beam is then NaN.
    pub(in crate::sim) fn give(&mut self, cycle: u64, scan: &mut Scan) -> bool {
        let is_new = self.scans_in(cycle);
        match &mut self.faults {
            Some(faults) => faults.give(cycle, is_new, scan),
            None if is_new => true,
            None => {
                scan.ranges_m.fill(f64::NAN);
                false
            }
        }
    }
}

impl Faults {
    fn give(&mut self, cycle: u64, is_new: bool, scan: &mut Scan) -> bool {
        let is_lost = self.sensor.lost.contains(&self.index);
        let is_made = is_new && !is_lost && self.disturb(scan);
        if is_new {
            self.repeat(scan, is_made);
        }
        let is_made = is_made || !is_lost && self.hold(scan);
        if self.late == 0 {
            if !is_made {
                scan.ranges_m.fill(f64::NAN);
            }
            return is_made;
        }
        if is_made {
            self.under_way.push_back((cycle + self.late as u64, scan.ranges_m.clone()));
        }
        scan.ranges_m.fill(f64::NAN);
        let mut arrives_now = false;
        while self.under_way.front().is_some_and(|&(arrives, _)| arrives <= cycle) {
            if let Some((_, ranges_m)) = self.under_way.pop_front() {
                scan.ranges_m = ranges_m;
                arrives_now = true;
            }
        }
        arrives_now
    }

    /// Replaces the new scan by the previous one, or stores it. A lost scan stays lost.
    fn repeat(&mut self, scan: &mut Scan, is_made: bool) {
        let share = self.sensor.repeated_scans;
        if share == 0.0 && !self.sensor.held_scans {
            return;
        }
        let is_repeated = self.repeats.is_chosen(share) && !self.last_m.is_empty();
        if !is_made {
            return;
        }
        if is_repeated {
            scan.ranges_m.clone_from(&self.last_m);
        } else {
            self.last_m.clone_from(&scan.ranges_m);
        }
    }

    /// Repeats the last scan if scans are held; false if there is none.
    fn hold(&self, scan: &mut Scan) -> bool {
        let is_held = self.sensor.held_scans && !self.last_m.is_empty();
        if is_held {
            scan.ranges_m.clone_from(&self.last_m);
        }
        is_held
    }

    /// Turns an exact scan into a measured one. Returns false if it is lost: every beam is then
    /// NaN.
    fn disturb(&mut self, scan: &mut Scan) -> bool {
        let SensorFaults { range_m, range_relative, dropped_beams, dropped_scans, .. } =
            self.sensor;
        let range_max_m = scan.range_max_m;
        if range_m > 0.0 || range_relative > 0.0 {
            for measured_m in scan.ranges_m.iter_mut().filter(|range_m| range_m.is_finite()) {
                let deviation_m = libm::hypot(range_m, range_relative * *measured_m);
                let disturbed_m = *measured_m + deviation_m * self.ranges.next_cut();
                *measured_m = disturbed_m.clamp(0.0, range_max_m);
            }
        }
        if dropped_beams > 0.0 {
            for range_m in &mut scan.ranges_m {
                if self.beams.is_chosen(dropped_beams) {
                    *range_m = f64::NAN;
                }
            }
        }
        for beam in 0..scan.ranges_m.len() {
            if self.is_blind_towards(scan.bearing_rad(beam).to_degrees()) {
                scan.ranges_m[beam] = f64::NAN;
            }
        }
        let is_lost = dropped_scans > 0.0 && self.scans.is_chosen(dropped_scans);
        if is_lost {
            scan.ranges_m.fill(f64::NAN);
        }
        !is_lost
    }

    fn is_blind_towards(&self, bearing_deg: f64) -> bool {
        // Bearings come from radians, so a sector includes its edges within rounding.
        const ROUNDING_DEG: f64 = 1e-9;
        self.sensor.blind_deg.iter().any(|&[from_deg, to_deg]| {
            let width_deg = to_deg - from_deg;
            let width_deg = if width_deg < 0.0 { width_deg.rem_euclid(360.0) } else { width_deg };
            let past_deg = (bearing_deg - from_deg + ROUNDING_DEG).rem_euclid(360.0);
            past_deg <= width_deg + 2.0 * ROUNDING_DEG
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensing(sensor: SensorFaults) -> Sensing {
        let described = RangeSensor::new(1, 90.0, 10.0);
        Sensing::new(sensor, Source { seed: 11, robot: 0, sensor: 0 }, (&described, 0.1))
    }

    /// Many scans of beams that all have the same exact range.
    fn measured(noise: SensorFaults, exact_m: f64, scans: usize) -> Vec<Vec<f64>> {
        let mut sensing = sensing(noise);
        let measure = |cycle| {
            let ranges_m = vec![exact_m; 100];
            let mut scan = Scan { range_max_m: 10.0, ranges_m, ..Scan::default() };
            sensing.give(cycle, &mut scan);
            scan.ranges_m
        };
        (0..scans as u64).map(measure).collect()
    }

    #[test]
    fn ranges_deviate_as_told() {
        for (range_m, range_relative, exact_m) in [
            (0.02, 0.0, 1.0),
            (0.02, 0.0, 8.0),
            (0.0, 0.01, 2.0),
            (0.0, 0.01, 8.0),
            (0.03, 0.01, 4.0),
        ] {
            let noise = SensorFaults { range_m, range_relative, ..SensorFaults::default() };
            let all = measured(noise, exact_m, 1000).concat();
            let count = all.len() as f64;
            let expected_m = (range_m * range_m + (range_relative * exact_m).powi(2)).sqrt();
            let mean_m = all.iter().map(|range_m| range_m - exact_m).sum::<f64>() / count;
            let variance =
                all.iter().map(|range_m| (range_m - exact_m).powi(2)).sum::<f64>() / count;
            assert!(mean_m.abs() < 4.0 * expected_m / count.sqrt(), "{mean_m}");
            // Four standard deviations of a standard deviation.
            let deviation_m = variance.sqrt() / 0.9975;
            let tolerance_m = 4.0 * expected_m / (2.0 * count).sqrt();
            assert!((deviation_m - expected_m).abs() < tolerance_m, "{deviation_m} {expected_m}");
            let beyond = |range_m: &f64| (range_m - exact_m).abs() > 3.0 * expected_m + 1e-12;
            assert!(!all.iter().any(beyond));
        }
    }

    #[test]
    fn beams_and_scans_are_dropped_as_often_as_told() {
        let noise = SensorFaults { dropped_beams: 0.1, ..SensorFaults::default() };
        let all = measured(noise, 1.0, 1000).concat();
        assert!(all.iter().all(|range_m| range_m.is_nan() || *range_m == 1.0));
        let dropped = all.iter().filter(|range_m| range_m.is_nan()).count();
        // Expected are 10,000 with a standard deviation of 95.
        assert!((9620..10_380).contains(&dropped), "{dropped}");
        let noise = SensorFaults { dropped_scans: 0.1, ..SensorFaults::default() };
        let scans = measured(noise, 1.0, 10_000);
        let nans = |scan: &Vec<f64>| scan.iter().filter(|range_m| range_m.is_nan()).count();
        assert!(scans.iter().all(|scan| [0, 100].contains(&nans(scan))), "whole scans");
        let dropped = scans.iter().filter(|scan| nans(scan) == 100).count();
        // Expected are 1000 with a standard deviation of 30.
        assert!((880..1120).contains(&dropped), "{dropped}");
        // A dropped scan has no ranges, and its other fields do not change.
        let exact = Scan { range_max_m: 10.0, ranges_m: vec![f64::INFINITY; 3], ..Scan::default() };
        let mut scan = exact.clone();
        sensing(SensorFaults { dropped_scans: 1.0, ..SensorFaults::default() }).give(0, &mut scan);
        assert_eq!((scan.ranges_m.len(), scan.reading(0), scan.reading(2)), (3, None, None));
        assert_eq!(Scan { ranges_m: exact.ranges_m.clone(), ..scan }, exact);
    }

    #[test]
    fn measured_ranges_stay_within_the_sensor() {
        let noise = SensorFaults { range_m: 0.5, ..SensorFaults::default() };
        for exact_m in [0.1, 9.9] {
            let all = measured(noise.clone(), exact_m, 100).concat();
            assert!(all.iter().all(|range_m| (0.0..=10.0).contains(range_m)));
            let edge_m = if exact_m < 5.0 { 0.0 } else { 10.0 };
            assert!(all.contains(&edge_m));
        }
        let nothing = measured(noise, f64::INFINITY, 2).concat();
        assert!(nothing.iter().all(|range_m| *range_m == f64::INFINITY));
    }

    /// Number of the scan that a sensor delivers in each of some cycles; `None` for no scan. Each
    /// scan has its cycle as its range.
    fn given(sensor: SensorFaults, cycles: u64) -> Vec<Option<u64>> {
        let mut sensing = sensing(sensor);
        let mut give = |cycle| {
            let ranges_m = vec![cycle as f64];
            let mut scan = Scan { range_max_m: 1e3, ranges_m, ..Scan::default() };
            sensing.give(cycle, &mut scan);
            let range_m = scan.ranges_m[0];
            (!range_m.is_nan()).then_some(range_m as u64)
        };
        (0..cycles).map(&mut give).collect()
    }

    #[test]
    fn a_scan_comes_once_in_every_period() {
        let scans = |period_s| {
            let given = given(SensorFaults { period_s, ..SensorFaults::default() }, 13);
            given.into_iter().flatten().collect::<Vec<_>>()
        };
        let all: Vec<_> = (0..=12).collect();
        // The period of the robot's description, or another one.
        assert_eq!((scans(0.0), scans(0.05)), (all.clone(), all));
        assert_eq!(scans(0.3), [0, 3, 6, 9, 12]);
        assert_eq!(scans(0.25), [0, 3, 5, 8, 10]);
    }

    #[test]
    fn a_late_scan_comes_once_and_in_the_next_cycle_that_begins() {
        let late = |delay_s, period_s| {
            given(SensorFaults { delay_s, period_s, ..SensorFaults::default() }, 8)
        };
        let [none, at] = [None, Some(0)];
        assert_eq!(late(0.2, 0.0)[..4], [none, none, at, Some(1)]);
        assert_eq!(late(0.11, 0.0)[..4], [none, none, at, Some(1)]);
        assert_eq!(late(0.3, 0.3), [none, none, none, at, none, none, Some(3), none]);
    }

    #[test]
    fn as_many_scans_as_told_are_those_before_again() {
        let scans = given(SensorFaults { repeated_scans: 0.3, ..SensorFaults::default() }, 10_000);
        let scans: Vec<u64> = scans.into_iter().flatten().collect();
        assert_eq!((scans.len(), scans[0]), (10_000, 0));
        let (mut repeated, mut last) = (0, 0);
        for (cycle, &scan) in scans.iter().enumerate().skip(1) {
            assert!(scan == cycle as u64 || scan == last, "{cycle}: {scan}");
            repeated += usize::from(scan == last);
            last = scan;
        }
        // Expected are 3000 with a standard deviation of 46.
        assert!((2816..3184).contains(&repeated), "{repeated}");
    }

    /// The same scans are lost with and without repetitions.
    #[test]
    fn a_lost_scan_is_not_replaced_by_the_one_before() {
        let scans = |repeated_scans| {
            let dropped = SensorFaults { dropped_scans: 0.5, ..SensorFaults::default() };
            given(SensorFaults { repeated_scans, ..dropped }, 1000)
        };
        let (new, some_again) = (scans(0.0), scans(0.5));
        assert!(new.iter().zip(&some_again).all(|(a, b)| a.is_none() == b.is_none()));
        assert_ne!(new, some_again);
    }

    #[test]
    fn blind_sectors_are_counter_clockwise_and_may_lie_behind() {
        // Beams at -180, -90, 0, 90 and 180 degrees.
        let blind = |blind_deg: &[[f64; 2]]| {
            let faults = SensorFaults { blind_deg: blind_deg.to_vec(), ..SensorFaults::default() };
            let mut scan = Scan {
                angle_min_rad: -std::f64::consts::PI,
                angle_increment_rad: std::f64::consts::FRAC_PI_2,
                range_max_m: 4.0,
                ranges_m: vec![2.0; 5],
                ..Scan::default()
            };
            sensing(faults).give(0, &mut scan);
            std::array::from_fn::<bool, 5, _>(|beam| scan.ranges_m[beam].is_nan())
        };
        assert_eq!(blind(&[[-10.0, 90.0]]), [false, false, true, true, false]);
        assert_eq!(blind(&[[90.0, -10.0]]), [true, true, false, true, true]);
        assert_eq!(blind(&[[170.0, 190.0]]), [true, false, false, false, true]);
        assert_eq!(blind(&[[10.0, 20.0], [-90.0, -90.0]]), [false, true, false, false, false]);
        assert_eq!(blind(&[[-180.0, 180.0]]), [true; 5]);
        assert_eq!(blind(&[[10.0, 80.0]]), [false; 5]);
    }
}
