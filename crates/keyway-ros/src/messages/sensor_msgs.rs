//! `sensor_msgs`.

use super::Named;
use super::std_msgs::Header;
use keyway::sense::Scan;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LaserScan {
    pub(crate) header: Header,
    pub(crate) angle_min: f32,
    pub(crate) angle_max: f32,
    pub(crate) angle_increment: f32,
    pub(crate) time_increment: f32,
    pub(crate) scan_time: f32,
    pub(crate) range_min: f32,
    pub(crate) range_max: f32,
    pub(crate) ranges: Vec<f32>,
    pub(crate) intensities: Vec<f32>,
}

impl Named for LaserScan {
    const NAME: (&'static str, &'static str) = ("sensor_msgs", "LaserScan");
}

impl From<LaserScan> for Scan<Vec<f32>> {
    fn from(scan: LaserScan) -> Self {
        Self {
            angle_min_rad: f64::from(scan.angle_min),
            angle_increment_rad: f64::from(scan.angle_increment),
            range_min_m: f64::from(scan.range_min),
            range_max_m: f64::from(scan.range_max),
            ranges_m: scan.ranges,
        }
    }
}
