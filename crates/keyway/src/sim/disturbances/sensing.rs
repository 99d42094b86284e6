//! What a scan looks like when it reaches the controller.

use super::gaussian::Gaussian;
use super::{Kind, SensorNoise, Source};
use crate::random::Random;
use crate::sense::Scan;

/// The faults of a robot's sensor.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Sensing {
    noise: SensorNoise,
    ranges: Gaussian,
    beams: Random,
    scans: Random,
}

impl Sensing {
    /// `None` for a sensor without faults.
    pub(in crate::sim) fn new(noise: SensorNoise, source: Source) -> Option<Self> {
        let ranges = Gaussian::new(source, Kind::Range);
        let (beams, scans) = (source.stream(Kind::DroppedBeam), source.stream(Kind::DroppedScan));
        (!noise.is_none()).then_some(Self { noise, ranges, beams, scans })
    }

    /// From the exact scan to that which is measured.
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
