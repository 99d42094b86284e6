//! Roadways of a mine.

use super::canvas::Canvas;
use super::clutter::unless_share;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::random::Random;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A room-and-pillar mine: roadways that cross each other around pillars of rock. The sides of
/// the pillars are rough, and some of the roadways between two crossings have collapsed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Mine {
    /// Width of a roadway \[m\].
    pub roadway_m: f64,
    /// Side of a pillar \[m\].
    pub pillar_m: f64,
    /// Largest deviation of the sides from straight lines \[m\].
    pub roughness_m: f64,
    /// Share of the sections between two crossings that have collapsed, from 0 to 1. The leftmost
    /// vertical sections and all horizontal sections stay open, so every crossing is reachable.
    #[serde(default)]
    pub fallen_in: f64,
}

/// Number of waves of the rough sides, and length of each as a multiple of the one before.
const WAVES: u32 = 8;
const SHORTER: f64 = 0.75;

impl Mine {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("roadway_m", self.roadway_m)?;
        ConfigError::unless_positive("pillar_m", self.pillar_m)?;
        ConfigError::unless_not_negative("roughness_m", self.roughness_m)?;
        unless_share("fallen_in", self.fallen_in)?;
        if self.roughness_m >= 0.5 * self.roadway_m {
            let expected = "less than half of roadway_m";
            return Err(ConfigError::must_be("roughness_m", expected, self.roughness_m));
        }
        Ok(())
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, random: &mut Random) {
        let [width_m, height_m] = canvas.size_m();
        let pitch_m = self.roadway_m + self.pillar_m;
        let waves: Vec<[f64; 2]> =
            (0..WAVES).map(|_| [random.unit(), random.unit()].map(|unit| unit * TAU)).collect();
        canvas.fill_where(|at| {
            let [x, y] = [at.x, at.y].map(|along_m| along_m.rem_euclid(pitch_m) - self.roadway_m);
            // Depth inside the pillar, negative outside.
            let depth_m = [x, y].map(|from_m| from_m.min(self.pillar_m - from_m));
            depth_m[0].min(depth_m[1]) > self.rough_m(at, &waves)
        });
        let count = |length_m: f64| (length_m / pitch_m).ceil() as i32;
        for row in 0..count(height_m) {
            for column in 1..count(width_m) {
                if random.is_chosen(self.fallen_in) {
                    let low = [column, row].map(|n| f64::from(n) * pitch_m);
                    let low = Point::new(low[0], low[1] + self.roadway_m + 0.25 * self.pillar_m);
                    let high = low + Point::new(self.roadway_m, 0.5 * self.pillar_m);
                    // The box extends into the rock on both sides, regardless of their roughness.
                    let into = Point::new(self.roughness_m, 0.0);
                    canvas.fill_box(low - into, high + into);
                }
            }
        }
    }

    /// Deviation of a pillar's side near a position \[m\], at most `roughness_m`: the sum of
    /// waves, each given by its direction and its phase.
    fn rough_m(&self, at: Point, waves: &[[f64; 2]]) -> f64 {
        let (mut sum, mut wave_m) = (0.0, self.pillar_m.max(self.roadway_m));
        for &[direction_rad, phase_rad] in waves {
            let (sin, cos) = libm::sincos(direction_rad);
            sum += libm::sin(TAU * (at.x * cos + at.y * sin) / wave_m + phase_rad);
            wave_m *= SHORTER;
        }
        self.roughness_m * sum / f64::from(WAVES)
    }
}
