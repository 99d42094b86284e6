//! Axes of charts: their ranges, and the texts along them.

use crate::name_lines::NameLines;
use crate::text::{SMALL_TEXT_PX, text_width_px};
use crate::ticks::{Ticks, span};

/// Minimum number of marks of a readable axis.
const MIN_MARKS: usize = 3;
/// Maximum number of intervals of an axis whose marks are not powers of ten.
const EVEN_INTERVALS: usize = 5;
/// Width of grid lines \[px\].
const GRID_PX: f64 = 0.7;
/// Length of ticks, and space around texts \[px\].
pub(crate) const TICK_PX: f64 = 4.0;
pub(crate) const GAP_PX: f64 = 4.0;
/// Size of axis labels \[px\].
pub(crate) const TEXT_PX: f64 = 12.0;
/// Minimum distance between two categories in a column \[px\].
const ROW_PX: f64 = 30.0;
/// Space between the name or the note of a category and the next one, and between the outer
/// categories and the ends of the axis \[px\].
const ROW_GAP_PX: f64 = 6.0;
pub(crate) const ROWS_INSET_PX: f64 = 4.0;
/// Distance between a category's name or note and the panel \[px\].
pub(crate) const NAME_GAP_PX: f64 = 8.0;
pub(crate) const NOTE_GAP_PX: f64 = 6.0;

/// The axis of a chart: its range, the texts along it, and its quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    is_logarithmic: bool,
    pub(crate) is_of_categories: bool,
    /// Ends of the range; logarithms of them for a logarithmic axis.
    low: f64,
    high: f64,
    /// Values, each with its text.
    pub(crate) marks: Vec<(f64, String)>,
    pub(crate) label: Option<String>,
    pub(crate) has_strong_zero: bool,
    pub(crate) grid_px: f64,
    /// The texts of an axis of categories, at both sides of the panel.
    pub(crate) names: Vec<NameLines>,
    pub(crate) notes: Vec<NameLines>,
    /// Minimum distance between two categories in a column \[px\].
    pub(crate) row_px: f64,
}

impl Axis {
    /// Creates a linear axis with round numbers that make at most `max_intervals` intervals.
    pub fn linear(low: f64, high: f64, max_intervals: usize) -> Self {
        Self::with_ticks(low, high, &Ticks::new(low, high, max_intervals))
    }

    /// Creates a linear axis with the given ticks, which need not reach its ends.
    pub fn with_ticks(low: f64, high: f64, ticks: &Ticks) -> Self {
        let marks = ticks.values.iter().copied().zip(ticks.texts()).collect();
        Self { low, high, marks, grid_px: GRID_PX, ..Self::default() }
    }

    /// Creates a logarithmic axis that covers all positive values. Its marks are powers of ten;
    /// if these are few, 2 and 5 times them are added; if they are still few, the marks are round
    /// numbers at equal distances.
    pub fn powers(values: &[f64]) -> Self {
        let (low, high) = log_range(values, 0.06);
        let powers = low.floor() as i32..=high.ceil() as i32;
        let times = |factors: &[f64]| -> Vec<f64> {
            let all =
                powers.clone().flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
            all.filter(|value| (low..=high).contains(&value.log10())).collect()
        };
        let is_short = high - low < 2.5;
        let candidates = [(!is_short).then(|| times(&[1.0])), Some(times(&[1.0, 2.0, 5.0]))];
        let enough = candidates.into_iter().flatten().find(|marks| marks.len() >= MIN_MARKS);
        let evenly = || Ticks::new(10f64.powf(low), 10f64.powf(high), EVEN_INTERVALS).values;
        Self::logarithmic(low, high, enough.unwrap_or_else(evenly))
    }

    /// Creates a logarithmic axis with a mark at each positive value.
    pub fn powers_at(values: &[f64]) -> Self {
        let (low, high) = log_range(values, 0.03);
        let mut places: Vec<f64> = positive(values).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        Self::logarithmic(low, high, places)
    }

    fn logarithmic(low: f64, high: f64, marks: Vec<f64>) -> Self {
        let marks = marks.into_iter().map(|value| (value, plain(value))).collect();
        Self { is_logarithmic: true, low, high, marks, grid_px: GRID_PX, ..Self::default() }
    }

    /// Creates an axis of categories: the first one has the value 0, the next one 1. A vertical
    /// one runs downwards, is as long as its names and notes need, and breaks names that are
    /// wider than `max_name_px`.
    pub fn categories<'n>(names: impl IntoIterator<Item = &'n str>, max_name_px: f64) -> Self {
        let marks: Vec<_> =
            (0..).map(f64::from).zip(names.into_iter().map(str::to_owned)).collect();
        let lines = |(_, name): &(f64, String)| NameLines::new(name, max_name_px);
        let (names, high) = (marks.iter().map(lines).collect(), marks.len() as f64 - 0.5);
        let (low, row_px) = (-0.5, ROW_PX);
        Self { is_of_categories: true, low, high, marks, names, row_px, ..Self::default() }
    }

    /// Sets texts at the other ends of the rows of a vertical axis of categories, such as their
    /// numbers; a text may have several lines.
    #[must_use]
    pub fn notes<'n>(self, notes: impl IntoIterator<Item = &'n str>) -> Self {
        Self { notes: notes.into_iter().map(NameLines::of_lines).collect(), ..self }
    }

    /// Sets the quantity along the axis, with its unit.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }

    /// Makes the grid line at 0 a strong one, which separates positive values from negative ones.
    #[must_use]
    pub fn strong_zero(self) -> Self {
        Self { has_strong_zero: true, ..self }
    }

    /// Position of a value along the axis: 0 at its low end, 1 at its high one.
    pub fn fraction(&self, value: f64) -> f64 {
        let at = if self.is_logarithmic { value.log10() } else { value };
        let span = self.high - self.low;
        if span == 0.0 { 0.5 } else { (at - self.low) / span }
    }

    /// Width of the widest text along the axis \[px\].
    pub(crate) fn widest_px(&self) -> f64 {
        let width_px = |(_, text): &(f64, String)| text_width_px(text, SMALL_TEXT_PX);
        self.marks.iter().map(width_px).fold(0.0, f64::max)
    }

    /// Width of everything beside the panel that belongs to a left or right axis \[px\].
    pub(crate) fn side_px(&self) -> f64 {
        if self.is_of_categories {
            return self.names.iter().map(NameLines::width_px).fold(0.0, f64::max) + NAME_GAP_PX;
        }
        TICK_PX + GAP_PX + self.widest_px() + 2.0 * GAP_PX + TEXT_PX
    }

    /// Width of the notes at the other side of the panel, with the space before them \[px\].
    pub(crate) fn notes_px(&self) -> f64 {
        let gap_px = if self.is_of_categories { NOTE_GAP_PX } else { 0.0 };
        gap_px + self.notes.iter().map(NameLines::width_px).fold(0.0, f64::max)
    }

    /// Length of a vertical axis of categories \[px\].
    pub(crate) fn length_px(&self) -> Option<f64> {
        let heights = self.names.iter().chain(&self.notes).map(NameLines::height_px);
        let row_px = heights.map(|height_px| height_px + ROW_GAP_PX).fold(self.row_px, f64::max);
        let length_px = self.names.len() as f64 * row_px + 2.0 * ROWS_INSET_PX;
        self.is_of_categories.then_some(length_px)
    }
}

/// Returns the finite positive values.
fn positive(values: &[f64]) -> impl Iterator<Item = f64> {
    values.iter().copied().filter(|&value| value > 0.0 && value.is_finite())
}

/// Returns the logarithms of the smallest and the largest positive value, at least a little
/// apart, with a margin at both ends as a share of their distance.
fn log_range(values: &[f64], room: f64) -> (f64, f64) {
    let ends = span(positive(values)).map(|(low, high)| (low.log10(), high.log10()));
    let (low, high) = match ends {
        None => (0.0, 1.0),
        Some((low, high)) if high - low > 0.1 => (low, high),
        Some((low, high)) => (low - 0.3, high + 0.3),
    };
    let room = room * (high - low);
    (low - room, high + room)
}

/// Formats a positive number without an exponent, as long as that is short.
fn plain(value: f64) -> String {
    if (1e-4..1e7).contains(&value) {
        // Twelve digits hide the rounding of powers.
        let text = format!("{value:.12}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(values: &[f64]) -> Vec<String> {
        let axis = Axis::powers(values);
        assert!(axis.low < axis.high);
        axis.marks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn marks_by_hand() {
        assert_eq!(marks(&[0.02, 300.0]), ["0.1", "1", "10", "100"]);
        assert_eq!(marks(&[90.0, 1100.0]), ["100", "200", "500", "1000"]);
        assert_eq!(marks(&[3.0]), ["2", "4", "6"]);
        // The peak memory of two planners on two maps [MB].
        assert_eq!(marks(&[13.9, 16.7, 28.7, 15.2]), ["15", "20", "25"]);
        assert_eq!(marks(&[100.0, 101.0]), ["50", "100", "200"]);
        // Only two powers, but a long range.
        assert_eq!(marks(&[1.42, 251.0]), ["2", "5", "10", "20", "50", "100", "200"]);
        assert_eq!(marks(&[1e9, 1e12]), ["1e9", "1e10", "1e11", "1e12"]);
        assert_eq!(marks(&[0.0, f64::NAN, -1.0, f64::INFINITY]), ["1", "2", "5", "10"]);
    }

    #[test]
    fn fractions_by_hand() {
        assert_eq!(Axis::linear(-1.0, 3.0, 4).fraction(0.0), 0.25);
        let axis = Axis::powers(&[1.0, 100.0]);
        assert_eq!(axis.fraction(10.0), 0.5);
        assert!(axis.fraction(1.0) > 0.0 && axis.fraction(100.0) < 1.0);
        assert!(!axis.fraction(0.0).is_finite());
        let axis = Axis::categories(["a", "b"], 100.0);
        assert_eq!([0.0, 1.0].map(|value| axis.fraction(value)), [0.25, 0.75]);
        assert_eq!(Axis::linear(2.0, 2.0, 4).fraction(2.0), 0.5);
    }

    /// Rows are as high as the highest of the names and notes.
    #[test]
    fn categories_have_room_for_their_texts() {
        let axis = Axis::categories(["a", "b"], 100.0);
        assert_eq!(axis.length_px(), Some(68.0));
        assert_eq!(axis.clone().notes(["1\n2\n3", ""]).length_px(), Some(2.0 * 43.5 + 8.0));
        let wide = axis.clone().notes(["", "mmmm"]).notes_px();
        assert!(wide > axis.notes_px() && axis.notes_px() == NOTE_GAP_PX);
    }
}
