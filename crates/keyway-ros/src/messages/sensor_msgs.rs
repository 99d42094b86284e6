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

/// An image in a format such as PNG.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct CompressedImage {
    pub(crate) header: Header,
    pub(crate) format: String,
    pub(crate) data: Vec<u8>,
}

/// Rows of points, each a fixed number of bytes that contain its fields.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointCloud2 {
    pub(crate) header: Header,
    pub(crate) height: u32,
    pub(crate) width: u32,
    pub(crate) fields: Vec<PointField>,
    pub(crate) is_bigendian: bool,
    pub(crate) point_step: u32,
    pub(crate) row_step: u32,
    pub(crate) data: Vec<u8>,
    pub(crate) is_dense: bool,
}

impl Named for PointCloud2 {
    const NAME: (&'static str, &'static str) = ("sensor_msgs", "PointCloud2");
}

/// A field of the points of a cloud.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PointField {
    pub(crate) name: String,
    /// Offset in bytes.
    pub(crate) offset: u32,
    pub(crate) datatype: u8,
    pub(crate) count: u32,
}

impl PointField {
    pub(crate) const FLOAT32: u8 = 7;
    pub(crate) const FLOAT64: u8 = 8;
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
