//! Conversion of a pixel's brightness to the state of a cell, as in the ROS map server.
//!
//! # Source
//! `nav2_map_server/src/map_io.cpp` of Nav2: the same comparisons and rounding.

use crate::map::{CellState, GridFrame, OccupancyGrid, OccupancyThresholds};
use serde::{Deserialize, Serialize};

/// Mode in which the map server reads the pixels of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MapMode {
    /// Two thresholds separate occupied, unknown and free. In an image with transparency, alpha
    /// enters the mean as a fourth colour (opaque counts as bright).
    #[default]
    Trinary,
    /// Like trinary, but between the thresholds the occupancy rises from 0 to 100, which
    /// [`OccupancyThresholds::default`] converts to states; pixels that are not opaque are
    /// unknown.
    Scale,
    /// The grey value itself (0 to 255) is the occupancy in percent, which the thresholds convert
    /// to states; above 100 it is unknown. Negation has no effect.
    Raw,
}

/// Rule that makes a pixel occupied, free or unknown.
///
/// The occupancy of a pixel is its darkness, 0 (white) to 1 (black), or its brightness when
/// negated. Occupied is tested first, so no pixel is unknown if the thresholds are exchanged:
/// Nav2 accepts such files, and so does this library, with a [`super::MapWarning`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellRule {
    /// Mode of using thresholds and values.
    pub mode: MapMode,
    /// White is occupied and black free, instead of the reverse.
    pub negate: bool,
    /// Pixels with more than this occupancy are occupied.
    pub occupied_thresh: f64,
    /// Pixels with less than this occupancy are free.
    pub free_thresh: f64,
}

impl CellRule {
    /// The rule for images without a YAML file: trinary, occupied above 0.65, free below 0.196.
    /// With the 0.25 of newer map savers, the grey that they all use for unknown cells (205 of
    /// 255: occupancy 0.19608) would be free.
    pub const IMAGE: Self =
        Self { mode: MapMode::Trinary, negate: false, occupied_thresh: 0.65, free_thresh: 0.196 };

    /// Value of a pixel: 0 to 100, or [`OccupancyGrid::UNKNOWN_VALUE`].
    pub(super) fn value(&self, pixel: Pixel) -> u8 {
        let shade = pixel.shade(self.mode == MapMode::Trinary);
        let occupancy = if self.negate { shade } else { 1.0 - shade };
        let unknown = OccupancyGrid::UNKNOWN_VALUE;
        match self.mode {
            MapMode::Raw => {
                let grey = (shade * 255.0).round();
                if grey <= 100.0 { grey as u8 } else { unknown }
            }
            MapMode::Scale if !pixel.is_opaque() => unknown,
            _ if self.occupied_thresh < occupancy => 100,
            _ if occupancy < self.free_thresh => 0,
            MapMode::Trinary => unknown,
            MapMode::Scale => {
                let span = self.occupied_thresh - self.free_thresh;
                // Equal thresholds leave one shade between them, and no value for it.
                if span == 0.0 {
                    return unknown;
                }
                ((occupancy - self.free_thresh) / span * 100.0).round_ties_even() as u8
            }
        }
    }

    /// The thresholds that convert values to states.
    fn thresholds(&self) -> OccupancyThresholds {
        match self.mode {
            MapMode::Raw => OccupancyThresholds::of_file(self.occupied_thresh, self.free_thresh),
            MapMode::Trinary | MapMode::Scale => OccupancyThresholds::default(),
        }
    }

    /// Builds the grid from the results of [`Self::value`], top row first.
    pub(super) fn grid(&self, frame: GridFrame, top_row_first: &[u8]) -> OccupancyGrid {
        let width = frame.width() as usize;
        if self.mode != MapMode::Trinary {
            let values = top_row_first.chunks_exact(width).rev().flatten().copied().collect();
            return OccupancyGrid::from_value_per_cell(frame, values, self.thresholds());
        }
        let height = frame.height() as usize;
        let row = |y: usize| &top_row_first[(height - 1 - y) * width..(height - y) * width];
        OccupancyGrid::from_rows(frame, row, |value| match value {
            0 => CellState::Free,
            100 => CellState::Occupied,
            _ => CellState::Unknown,
        })
    }
}

/// Likely mistakes of an image: pixels with the grey of unknown cells in map savers that are read
/// as free, and a format that does not preserve greys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Doubts {
    /// Pixels read as free because of the threshold.
    pub(super) by_threshold: u64,
    /// Pixels read as free because an opaque alpha counts as a bright colour.
    pub(super) by_opacity: u64,
    pub(super) is_lossy: bool,
}

/// Converts pixels to cells, and counts likely mistakes.
pub(super) struct Translator<'a> {
    rule: &'a CellRule,
    pub(super) doubts: Doubts,
    /// The last pixel whose value is no mistake: most pixels equal the one before.
    last: Option<(Pixel, u8)>,
}

impl<'a> Translator<'a> {
    pub(super) fn new(rule: &'a CellRule) -> Self {
        Self { rule, doubts: Doubts::default(), last: None }
    }

    /// Like [`CellRule::value`].
    #[inline]
    pub(super) fn value(&mut self, pixel: Pixel) -> u8 {
        match self.last {
            Some((last, value)) if last == pixel => value,
            _ => self.value_of_another(pixel),
        }
    }

    fn value_of_another(&mut self, pixel: Pixel) -> u8 {
        let value = self.rule.value(pixel);
        if value == 0 && pixel.is_saved_unknown() {
            let trinary = CellRule { mode: MapMode::Trinary, ..*self.rule };
            if trinary.value(Pixel { alpha: None, ..pixel }) == 0 {
                self.doubts.by_threshold += 1;
            } else if self.rule.mode == MapMode::Trinary {
                // In scale mode no cells are unknown between the thresholds.
                self.doubts.by_opacity += 1;
            }
        } else {
            self.last = Some((pixel, value));
        }
        value
    }
}

/// One pixel of any kind of image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixel {
    /// Sum of red, green and blue; three times the grey of a grey pixel.
    pub(super) rgb_sum: u32,
    /// Alpha, for images with transparency.
    pub(super) alpha: Option<u32>,
    /// The sample value for white, and for opaque.
    pub(super) white: u32,
}

impl Pixel {
    pub(super) const fn grey(grey: u32, white: u32) -> Self {
        Self { rgb_sum: 3 * grey, alpha: None, white }
    }

    /// Brightness, 0 to 1.
    fn shade(self, with_alpha: bool) -> f64 {
        let (sum, count) = match self.alpha {
            Some(alpha) if with_alpha => (self.rgb_sum + alpha, 4.0),
            _ => (self.rgb_sum, 3.0),
        };
        f64::from(sum) / count / f64::from(self.white)
    }

    /// True for the grey of 205 of 255.
    const fn is_saved_unknown(self) -> bool {
        self.rgb_sum as u64 * 255 == 3 * 205 * self.white as u64
    }

    fn is_opaque(self) -> bool {
        self.alpha.is_none_or(|alpha| alpha == self.white)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNKNOWN: u8 = 255;

    fn rule(mode: MapMode, occupied_thresh: f64, free_thresh: f64) -> CellRule {
        CellRule { mode, negate: false, occupied_thresh, free_thresh }
    }

    fn values(rule: CellRule, greys: &[u32]) -> Vec<u8> {
        greys.iter().map(|&grey| rule.value(Pixel::grey(grey, 255))).collect()
    }

    #[test]
    fn trinary_compares_strictly() {
        assert_eq!(
            values(CellRule::IMAGE, &[0, 89, 90, 205, 206, 255]),
            [100, 100, UNKNOWN, UNKNOWN, 0, 0]
        );
        // 205 of 255 is the grey of unknown cells; only thresholds below 0.19608 keep it so.
        assert_eq!(values(rule(MapMode::Trinary, 0.65, 0.25), &[205]), [0]);
        // 1 - 204 / 255 is 0.2 and 1 - 102 / 255 is 0.6, up to rounding: values on a threshold
        // are unknown.
        let rule = rule(MapMode::Trinary, 1.0 - 102.0 / 255.0, 1.0 - 204.0 / 255.0);
        assert_eq!(values(rule, &[101, 102, 204, 205]), [100, UNKNOWN, UNKNOWN, 0]);
    }

    #[test]
    fn negation_swaps_black_and_white() {
        let rule = CellRule { negate: true, ..CellRule::IMAGE };
        assert_eq!(values(rule, &[0, 49, 50, 165, 166, 255]), [0, 0, UNKNOWN, UNKNOWN, 100, 100]);
    }

    #[test]
    fn swapped_thresholds_leave_nothing_unknown_and_prefer_occupied() {
        for mode in [MapMode::Trinary, MapMode::Scale] {
            assert_eq!(
                values(rule(mode, 0.2, 0.8), &[0, 127, 203, 205, 255]),
                [100, 100, 100, 0, 0]
            );
        }
    }

    #[test]
    fn scale_rises_between_the_thresholds() {
        let scale = rule(MapMode::Scale, 0.9, 0.1);
        assert_eq!(values(scale, &[0, 25, 26, 127, 229, 230]), [100, 100, 100, 50, 0, 0]);
        // Half-way values are rounded to even: 0.5, 1.5 and 2.5.
        let exact = rule(MapMode::Scale, 100.0 / 256.0, 0.0);
        let at = |darkness: u32| exact.value(Pixel::grey(512 - darkness, 512));
        assert_eq!([at(1), at(3), at(5)], [0, 2, 2]);
        assert_eq!(values(rule(MapMode::Scale, 0.0, 0.0), &[255]), [UNKNOWN]);
    }

    #[test]
    fn raw_keeps_the_grey_value() {
        let raw = CellRule { negate: true, ..rule(MapMode::Raw, 0.5, 0.4) };
        assert_eq!(
            values(raw, &[0, 1, 99, 100, 101, 205, 255]),
            [0, 1, 99, 100, UNKNOWN, UNKNOWN, UNKNOWN]
        );
        // Rounded half away from zero.
        assert_eq!(raw.value(Pixel::grey(5, 510)), 3);
    }

    #[test]
    fn transparency() {
        let pixel = |grey: u32, alpha| Pixel { rgb_sum: 3 * grey, alpha: Some(alpha), white: 255 };
        let trinary = CellRule::IMAGE;
        // Black: opaque has the mean shade 0.25, transparent 0.
        assert_eq!([trinary.value(pixel(0, 255)), trinary.value(pixel(0, 0))], [100, 100]);
        // White: 1 and 0.75, which is unknown.
        assert_eq!([trinary.value(pixel(255, 255)), trinary.value(pixel(255, 0))], [0, UNKNOWN]);
        // Grey 89 alone is occupied (see above); with an opaque alpha it is not.
        assert_eq!(trinary.value(pixel(89, 255)), UNKNOWN);
        let scale = rule(MapMode::Scale, 0.65, 0.196);
        assert_eq!([scale.value(pixel(0, 255)), scale.value(pixel(0, 254))], [100, UNKNOWN]);
        assert_eq!(rule(MapMode::Raw, 0.65, 0.196).value(pixel(42, 0)), 42);
    }

    #[test]
    fn grids_have_the_top_row_last() {
        let frame = GridFrame::new(2, 2, 1.0, crate::geometry::Pose::default()).unwrap();
        let drawn = OccupancyGrid::from_ascii(&["#.", "?."]);
        assert_eq!(CellRule::IMAGE.grid(frame, &[100, 0, UNKNOWN, 0]), drawn);
        let raw = rule(MapMode::Raw, 0.4, 0.1).grid(frame, &[100, 0, UNKNOWN, 7]);
        assert_eq!(raw.values(), Some(&[UNKNOWN, 7, 100, 0][..]));
    }

    #[test]
    fn values_of_files_become_states_by_the_same_rule() {
        use CellState::{Free, Occupied, Unknown};
        let frame = GridFrame::new(4, 1, 1.0, crate::geometry::Pose::default()).unwrap();
        let states = |rule: CellRule| {
            let grid = rule.grid(frame, &[90, 50, 20, 15]);
            frame.cells().filter_map(|cell| grid.state(cell)).collect::<Vec<_>>()
        };
        let [raw, scale] =
            [MapMode::Raw, MapMode::Scale].map(|mode| states(rule(mode, 0.65, 0.196)));
        assert_eq!((&raw, &scale), (&vec![Occupied, Unknown, Free, Free], &raw));
        assert_eq!(states(rule(MapMode::Raw, 0.5, 0.16)), [Occupied, Occupied, Unknown, Free]);
    }
}
