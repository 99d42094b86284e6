//! Mazes.

use super::canvas::Canvas;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};

/// A perfect maze: exactly one way between any two places. It is dug by depth-first search, so the
/// ways are long and have many dead ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Maze {
    /// Width of the ways \[m\].
    pub corridor_m: f64,
    /// Thickness of the walls \[m\].
    pub wall_m: f64,
}

impl Maze {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("corridor_m", self.corridor_m)?;
        ConfigError::unless_positive("wall_m", self.wall_m)
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        canvas.fill_box(Point::default(), Point::new(width_m, height_m));
        let pitch_m = self.corridor_m + self.wall_m;
        let count = |length_m: f64| (((length_m - self.wall_m) / pitch_m).floor() as i32).max(1);
        let size = [count(width_m), count(height_m)];
        let corner = |n: i32| self.wall_m + f64::from(n) * pitch_m;
        let mut dig = |from: [i32; 2], to: [i32; 2]| {
            let low = [0, 1].map(|axis| corner(from[axis].min(to[axis])));
            let high = [0, 1].map(|axis| corner(from[axis].max(to[axis])) + self.corridor_m);
            canvas.clear_box(low.into(), high.into());
        };
        let mut is_dug = vec![false; size[0] as usize * size[1] as usize];
        let index = |[x, y]: [i32; 2]| (y * size[0] + x) as usize;
        let mut way = vec![[0, 0]];
        is_dug[0] = true;
        dig([0, 0], [0, 0]);
        while let Some(&here) = way.last() {
            let steps = [[1, 0], [0, 1], [-1, 0], [0, -1]];
            let neighbours = steps.map(|step| [here[0] + step[0], here[1] + step[1]]);
            let is_open = |to: &[i32; 2]| {
                (0..size[0]).contains(&to[0])
                    && (0..size[1]).contains(&to[1])
                    && !is_dug[index(*to)]
            };
            let open: Vec<_> = neighbours.into_iter().filter(is_open).collect();
            if open.is_empty() {
                way.pop();
                continue;
            }
            let next = open[random.below(open.len() as u32) as usize];
            is_dug[index(next)] = true;
            dig(here, next);
            way.push(next);
        }
    }
}
