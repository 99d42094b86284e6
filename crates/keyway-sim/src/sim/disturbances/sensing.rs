//! Sensor errors in the scans given to the controller.

use super::gaussian::Gaussian;
use super::{Kind, SensorNoise, Source};
use keyway::random::Random;
use keyway::sense::Scan;

/// The faults of a robot's sensor.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Sensing {
    noise: SensorNoise,
    ranges: Gaussian,
    beams: Random,
    scans: Random,
}

impl Sensing {
    /// Returns the faults, or `None` for a sensor without any.
    pub(in crate::sim) fn new(noise: SensorNoise, source: Source) -> Option<Self> {
        let ranges = Gaussian::new(source, Kind::Range);
        let (beams, scans) = (source.stream(Kind::DroppedBeam), source.stream(Kind::DroppedScan));
        (!noise.is_none()).then_some(Self { noise, ranges, beams, scans })
    }

    /// Turns an exact scan into a measured one.
    pub(in crate::sim) fn disturb(&mut self, scan: &mut Scan) {
        let SensorNoise { range_m, range_relative, dropped_beams, dropped_scans } = self.noise;
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
        if dropped_scans > 0.0 && self.scans.is_chosen(dropped_scans) {
            scan.ranges_m.fill(f64::NAN);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensing(noise: SensorNoise) -> Sensing {
        Sensing::new(noise, Source { seed: 11, robot: 0 }).unwrap()
    }

    /// Many scans of beams that all have the same exact range.
    fn measured(noise: SensorNoise, exact_m: f64, scans: usize) -> Vec<Vec<f64>> {
        let mut sensing = sensing(noise);
        let measure = |_| {
            let ranges_m = vec![exact_m; 100];
            let mut scan = Scan { range_max_m: 10.0, ranges_m, ..Scan::default() };
            sensing.disturb(&mut scan);
            scan.ranges_m
        };
        (0..scans).map(measure).collect()
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
            let noise = SensorNoise { range_m, range_relative, ..SensorNoise::default() };
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
        let noise = SensorNoise { dropped_beams: 0.1, ..SensorNoise::default() };
        let all = measured(noise, 1.0, 1000).concat();
        assert!(all.iter().all(|range_m| range_m.is_nan() || *range_m == 1.0));
        let dropped = all.iter().filter(|range_m| range_m.is_nan()).count();
        // Expected are 10,000 with a standard deviation of 95.
        assert!((9620..10_380).contains(&dropped), "{dropped}");
        let noise = SensorNoise { dropped_scans: 0.1, ..SensorNoise::default() };
        let scans = measured(noise, 1.0, 10_000);
        let nans = |scan: &Vec<f64>| scan.iter().filter(|range_m| range_m.is_nan()).count();
        assert!(scans.iter().all(|scan| [0, 100].contains(&nans(scan))), "whole scans");
        let dropped = scans.iter().filter(|scan| nans(scan) == 100).count();
        // Expected are 1000 with a standard deviation of 30.
        assert!((880..1120).contains(&dropped), "{dropped}");
        // A dropped scan has no ranges, and its other fields do not change.
        let exact = Scan { range_max_m: 10.0, ranges_m: vec![f64::INFINITY; 3], ..Scan::default() };
        let mut scan = exact.clone();
        sensing(SensorNoise { dropped_scans: 1.0, ..SensorNoise::default() }).disturb(&mut scan);
        assert_eq!((scan.ranges_m.len(), scan.reading(0), scan.reading(2)), (3, None, None));
        assert_eq!(Scan { ranges_m: exact.ranges_m.clone(), ..scan }, exact);
    }

    #[test]
    fn measured_ranges_stay_within_the_sensor() {
        let noise = SensorNoise { range_m: 0.5, ..SensorNoise::default() };
        for exact_m in [0.1, 9.9] {
            let all = measured(noise, exact_m, 100).concat();
            assert!(all.iter().all(|range_m| (0.0..=10.0).contains(range_m)));
            let edge_m = if exact_m < 5.0 { 0.0 } else { 10.0 };
            assert!(all.contains(&edge_m));
        }
        let nothing = measured(noise, f64::INFINITY, 2).concat();
        assert!(nothing.iter().all(|range_m| *range_m == f64::INFINITY));
    }
}
