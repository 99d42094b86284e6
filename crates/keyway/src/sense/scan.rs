//! One turn of a range sensor.

/// Ranges measured at one instant from the robot's centre, as in ROS `sensor_msgs/LaserScan`.
///
/// Beam i looks at bearing `angle_min_rad + i * angle_increment_rad` (0 straight ahead,
/// counter-clockwise).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// Bearing of the first beam \[rad\].
    pub angle_min_rad: f64,
    /// Bearing from one beam to the next \[rad\].
    pub angle_increment_rad: f64,
    /// Ranges up to this one are hits \[m\]; anything longer, infinity included, means that
    /// nothing was met within the range. NaN: the beam says nothing.
    pub range_max_m: f64,
    /// Range of every beam \[m\].
    pub ranges_m: Vec<f64>,
}

impl Scan {
    /// Bearing of a beam \[rad\], 0 straight ahead, counter-clockwise.
    pub fn bearing_rad(&self, beam: usize) -> f64 {
        self.angle_min_rad + beam as f64 * self.angle_increment_rad
    }
}
