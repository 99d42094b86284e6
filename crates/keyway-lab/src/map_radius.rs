//! Radii that no map has room for.

use keyway::map::GridFrame;
use thiserror::Error;

/// A radius for which no cell of a map can be free: more than half of the map's shorter side.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "a radius of {} m leaves no cell free on this map of {width_m:.3} x {height_m:.3} m; lengths \
     are in metres, not in millimetres",
    shown(*.radius_m)
)]
pub struct RadiusBeyondMap {
    /// The radius \[m\].
    pub radius_m: f64,
    /// Width of the map \[m\].
    pub width_m: f64,
    /// Height of the map \[m\].
    pub height_m: f64,
}

impl RadiusBeyondMap {
    /// Checks a radius.
    ///
    /// # Errors
    /// When the map has no room for it.
    pub fn check(radius_m: f64, frame: &GridFrame) -> Result<(), Self> {
        let [width_m, height_m] =
            [frame.width(), frame.height()].map(|cells| f64::from(cells) * frame.resolution_m());
        let is_too_large = 2.0 * radius_m > width_m.min(height_m) * (1.0 + 1e-9);
        if is_too_large { Err(Self { radius_m, width_m, height_m }) } else { Ok(()) }
    }
}

fn shown(radius_m: f64) -> String {
    if radius_m < 1e9 { format!("{radius_m}") } else { format!("{radius_m:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Pose;

    #[test]
    fn half_of_the_shorter_side_is_the_largest_radius() {
        let frame = GridFrame::new(6, 4, 0.5, Pose::default()).unwrap();
        assert_eq!(RadiusBeyondMap::check(1.0, &frame), Ok(()));
        let text = |radius_m| RadiusBeyondMap::check(radius_m, &frame).unwrap_err().to_string();
        assert_eq!(
            text(1.01),
            "a radius of 1.01 m leaves no cell free on this map of 3.000 x 2.000 m; lengths are in \
             metres, not in millimetres"
        );
        assert!(text(f64::INFINITY).starts_with("a radius of inf m"));
    }
}
