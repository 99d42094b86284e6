//! Measurements that are passed to a navigator.

use crate::points::Points;
use crate::scan::LaserScan;
use keyway::geometry::{Pose, Velocity};
use keyway::navigate::Navigator;
use keyway::robot::RangeSensor;
use keyway::sense::{Observation, Scan, SensorPoints, SensorScan};
use pyo3::Py;

/// A pose and a velocity, measured at a time \[s\].
pub(crate) struct Measured {
    pub(crate) stamp_s: f64,
    pub(crate) pose: Pose,
    pub(crate) velocity: Velocity,
}

impl Measured {
    /// Passes the measurement to a navigator, with points and the scans of its sensors. `own`
    /// holds the last scan of each sensor.
    pub(crate) fn observe(
        &self,
        navigator: &mut Navigator,
        (sensors, own): (&[RangeSensor], &mut [Scan]),
        given: Vec<Option<LaserScan>>,
        points: &[Py<Points>],
    ) {
        let mut stamps = vec![None; given.len()];
        for ((scan, own), stamp_s) in given.into_iter().zip(&mut *own).zip(&mut stamps) {
            *stamp_s = scan.map(|scan| scan.move_to(own).unwrap_or(self.stamp_s));
        }
        let made = own.iter().take(stamps.len()).enumerate();
        let scans: Vec<SensorScan<'_>> = made
            .filter_map(|(sensor, scan)| {
                let mount = sensors[sensor].mount.pose();
                let stamp_s = stamps[sensor]?;
                Some(SensorScan { stamp_s, sensor, mount, scan: scan.borrowed() })
            })
            .collect();
        let points = points.iter().map(|points| points.get().at(self.stamp_s));
        let points: Vec<SensorPoints<'_>> = points.collect();
        let observation = Observation::new(self.stamp_s, self.pose, self.velocity, &scans);
        navigator.observe(&observation.with_points(&points));
    }
}
