//! Corridors with rooms on both sides.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// Corridors from left to right, as many as fit, with a row of rooms on both sides of each. Every
/// room has a door to its corridor, at a random position in the wall. Between two corridors the
/// rows of rooms lie back to back. A passage through both rows, as wide as a corridor, joins the
/// two corridors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Corridors {
    /// Width of a corridor \[m\].
    pub corridor_m: f64,
    /// Width and depth of a room with its wall \[m\].
    pub room_m: [f64; 2],
    /// Width of a door \[m\].
    pub door_m: f64,
    /// Thickness of a wall \[m\].
    pub wall_m: f64,
}

impl Corridors {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("corridor_m", self.corridor_m)?;
        ConfigError::unless_positive("room_m[0]", self.room_m[0])?;
        ConfigError::unless_positive("room_m[1]", self.room_m[1])?;
        ConfigError::unless_positive("door_m", self.door_m)?;
        ConfigError::unless_positive("wall_m", self.wall_m)?;
        if self.door_m > self.room_m[0] - self.wall_m {
            let expected = "at most room_m[0] less wall_m";
            return Err(ConfigError::must_be("door_m", expected, self.door_m));
        }
        if self.wall_m > 0.5 * self.room_m[1] {
            let expected = "at most half of room_m[1]";
            return Err(ConfigError::must_be("wall_m", expected, self.wall_m));
        }
        Ok(())
    }

    /// Distance from one corridor to the next \[m\].
    fn pitch_m(&self) -> f64 {
        self.corridor_m + 2.0 * self.room_m[1]
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        let count = (height_m / self.pitch_m() + 1e-9).floor() as i32;
        // The remaining height is too small for another corridor.
        let rest = Point::new(0.0, f64::from(count) * self.pitch_m());
        canvas.fill_box(rest, Point::new(width_m, height_m));
        for corridor in 0..count {
            let low_m = f64::from(corridor) * self.pitch_m();
            // Rooms below, the corridor, rooms above.
            self.row(canvas, random, low_m, true);
            self.row(canvas, random, low_m + self.room_m[1] + self.corridor_m, false);
        }
        for corridor in 1..count {
            let middle_m = f64::from(corridor) * self.pitch_m();
            let left_m = random.between([0.0, (width_m - self.corridor_m).max(0.0)]);
            let depth_m = self.room_m[1] + self.wall_m;
            let low = Point::new(left_m, middle_m - depth_m);
            canvas.clear_box(low, Point::new(left_m + self.corridor_m, middle_m + depth_m));
        }
    }

    /// Draws the walls and doors of a row of rooms whose corridor is above or below it.
    fn row(&self, canvas: &mut Canvas, random: &mut Random, low_m: f64, is_corridor_above: bool) {
        let [width_m, _] = canvas.size_m();
        let [room_m, depth_m] = self.room_m;
        let high_m = low_m + depth_m;
        let (back_m, front_m) = if is_corridor_above {
            (low_m, high_m - self.wall_m)
        } else {
            (high_m - 0.5 * self.wall_m, low_m)
        };
        let back_high_m = back_m + 0.5 * self.wall_m;
        canvas.fill_box(Point::new(0.0, back_m), Point::new(width_m, back_high_m));
        let front_high_m = front_m + self.wall_m;
        canvas.fill_box(Point::new(0.0, front_m), Point::new(width_m, front_high_m));
        let count = (width_m / room_m).ceil() as i32;
        for room in 0..count {
            let left_m = f64::from(room) * room_m;
            if room > 0 {
                let low = Point::new(left_m, low_m);
                canvas.fill_box(low, Point::new(left_m + self.wall_m, high_m));
            }
            let right_m = (left_m + room_m).min(width_m) - self.door_m;
            let first_m = left_m + self.wall_m;
            let door_m = random.between([first_m, right_m.max(first_m)]);
            let low = Point::new(door_m, front_m);
            canvas.clear_box(low, Point::new(door_m + self.door_m, front_high_m));
        }
    }
}
