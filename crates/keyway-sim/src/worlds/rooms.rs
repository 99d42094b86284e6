//! Rooms with doors between them.

use super::canvas::Canvas;
use super::clutter::unless_share;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// Square rooms side by side. Each has a door to a neighbour that is closer to the first one, so
/// all are connected. Some of the other walls also have a door. A door is at a random position in
/// its wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rooms {
    /// Distance from the middle of one wall to the next \[m\].
    pub room_m: f64,
    /// Width of a door \[m\].
    pub door_m: f64,
    /// Thickness of a wall \[m\].
    pub wall_m: f64,
    /// Share of the walls that need no door but have one, from 0 to 1.
    #[serde(default)]
    pub more_doors: f64,
}

impl Rooms {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("room_m", self.room_m)?;
        ConfigError::unless_positive("door_m", self.door_m)?;
        ConfigError::unless_positive("wall_m", self.wall_m)?;
        unless_share("more_doors", self.more_doors)?;
        let inside_m = self.room_m - self.wall_m;
        if self.door_m > inside_m {
            let expected = "at most room_m less wall_m";
            return Err(ConfigError::must_be("door_m", expected, self.door_m));
        }
        Ok(())
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        let count = |length_m: f64| (length_m / self.room_m).ceil() as i32;
        let (columns, rows) = (count(width_m), count(height_m));
        let half_m = 0.5 * self.wall_m;
        for column in 1..columns {
            let x = f64::from(column) * self.room_m;
            canvas.fill_box(Point::new(x - half_m, 0.0), Point::new(x + half_m, height_m));
        }
        for row in 1..rows {
            let y = f64::from(row) * self.room_m;
            canvas.fill_box(Point::new(0.0, y - half_m), Point::new(width_m, y + half_m));
        }
        // A binary tree: every room except the first has a door to the left or downwards.
        for row in 0..rows {
            for column in 0..columns {
                let (can_left, can_down) = (column > 0, row > 0);
                let is_left = can_left && (!can_down || random.is_chosen(0.5));
                let another = random.is_chosen(self.more_doors);
                if can_left && (is_left || another) {
                    self.door(canvas, random, [column, row], true);
                }
                if can_down && (!is_left || another) {
                    self.door(canvas, random, [column, row], false);
                }
            }
        }
    }

    /// Cuts a door into the left or the lower wall of a room.
    fn door(&self, canvas: &mut Canvas, random: &mut Random, room: [i32; 2], is_left: bool) {
        let half_m = 0.5 * self.wall_m;
        let [x, y] = room.map(|n| f64::from(n) * self.room_m);
        let sizes_m = canvas.size_m();
        // The last room of a row may be cut off by the map's border.
        let (begin, size_m) = if is_left { (y, sizes_m[1]) } else { (x, sizes_m[0]) };
        let end_m = (begin + self.room_m - half_m).min(size_m) - self.door_m;
        let from_m = random.between([begin + half_m, end_m.max(begin + half_m)]);
        let (low, high) = if is_left {
            ([x - half_m, from_m], [x + half_m, from_m + self.door_m])
        } else {
            ([from_m, y - half_m], [from_m + self.door_m, y + half_m])
        };
        canvas.clear_box(low.into(), high.into());
    }
}
