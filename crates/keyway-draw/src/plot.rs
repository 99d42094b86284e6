//! The panel of a chart, as a drawing area.

use crate::axes::Scale;
use crate::color::{GRID, INK, QUIET, Rgb};
use crate::line_style::LineStyle;
use crate::writer::{PathData, SvgWriter};
use std::collections::HashSet;

/// Width of the outline of bars \[px\].
const BAR_LINE_PX: f64 = 0.8;

/// A point of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChartPoint {
    /// Position along the lower axis.
    pub x: f64,
    /// Height.
    pub y: f64,
    /// Interval of its true height.
    pub y_interval: Option<(f64, f64)>,
}

impl ChartPoint {
    /// Creates a point without an interval.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y, y_interval: None }
    }

    /// Returns the point with the interval of its true height.
    #[must_use]
    pub const fn with_interval(self, low: f64, high: f64) -> Self {
        Self { y_interval: Some((low, high)), ..self }
    }
}

/// Position of a panel on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlotArea {
    /// Left edge \[px\].
    pub left_px: f64,
    /// Upper edge \[px\].
    pub top_px: f64,
    /// Right edge \[px\].
    pub right_px: f64,
    /// Lower edge \[px\].
    pub bottom_px: f64,
}

/// A panel of a [`Chart`](crate::Chart) during drawing, in the values of its axes. Later elements
/// cover earlier ones.
pub struct Plot<'a> {
    pub(crate) out: &'a mut SvgWriter,
    pub(crate) x_scale: Scale<'a>,
    pub(crate) y_scale: Scale<'a>,
    pub(crate) area: PlotArea,
}

impl Plot<'_> {
    pub(crate) fn draw_grid(&mut self) {
        for (scale, is_upright) in [(self.x_scale, false), (self.y_scale, true)] {
            for &(value, _) in scale.axis.marks.iter().filter(|_| !scale.axis.is_of_categories) {
                let is_strong = scale.axis.has_strong_zero && value == 0.0;
                let color = if is_strong { QUIET } else { GRID };
                let ends = if is_upright { self.level(value) } else { self.upright(value) };
                self.segment(ends, color, scale.axis.grid_px);
            }
        }
    }

    /// Returns a line across the panel at a value of the lower axis.
    fn upright(&self, value: f64) -> [(f64, f64); 2] {
        let x = self.x_px(value);
        [(x, self.area.top_px), (x, self.area.bottom_px)]
    }

    /// Returns a line across the panel at a value of the vertical axis.
    fn level(&self, value: f64) -> [(f64, f64); 2] {
        let y = self.y_px(value);
        [(self.area.left_px, y), (self.area.right_px, y)]
    }

    pub(crate) fn segment(&mut self, [from, to]: [(f64, f64); 2], color: Rgb, width_px: f64) {
        self.out.tag("line").between(from, to).stroke(color, width_px).leaf();
    }

    /// Returns the position of the panel on the page \[px\].
    pub const fn area(&self) -> PlotArea {
        self.area
    }

    /// Returns the position of a value along the lower axis \[px\].
    pub fn x_px(&self, value: f64) -> f64 {
        self.x_scale.px(value)
    }

    /// Returns the position of a value along the vertical axis \[px\].
    pub fn y_px(&self, value: f64) -> f64 {
        self.y_scale.px(value)
    }

    /// Returns the writer for any other elements, in pixels of the page.
    pub const fn writer(&mut self) -> &mut SvgWriter {
        self.out
    }

    fn px(&self, point: &ChartPoint) -> (f64, f64) {
        (self.x_px(point.x), self.y_px(point.y))
    }

    /// Draws a line from point to point. Points without a position on the axes are gaps.
    pub fn line(&mut self, points: impl IntoIterator<Item = ChartPoint>, style: LineStyle) {
        let (mut path, mut is_open) = (PathData::default(), false);
        for (x, y) in points.into_iter().map(|point| self.px(&point)) {
            let has_place = x.is_finite() && y.is_finite();
            if has_place {
                if is_open { path.line_to((x, y)) } else { path.move_to((x, y)) }
            }
            is_open = has_place;
        }
        let tag = self.out.tag("path").attr("fill", "none").line_style(style);
        tag.attr("stroke-linejoin", "round").attr("d", path.as_str()).leaf();
    }

    /// Draws a dot of the given radius \[px\].
    pub fn dot(&mut self, point: ChartPoint, color: Rgb, radius_px: f64) {
        let (x, y) = self.px(&point);
        if !(x + y).is_finite() {
            return;
        }
        self.out.tag("circle").round(x, y, radius_px).fill(color).leaf();
    }

    /// Draws a cloud of dots `width_px` wide. Of those in the same square with sides of
    /// `square_px`, only one is drawn, so that many thousand points make the picture no larger,
    /// and it looks the same.
    pub fn dots(
        &mut self,
        points: impl IntoIterator<Item = ChartPoint>,
        color: Rgb,
        width_px: f64,
        square_px: f64,
    ) {
        // Lines of length 0 with round ends, in one path.
        let (mut drawn, mut path) = (HashSet::new(), PathData::default());
        for (x, y) in points.into_iter().map(|point| self.px(&point)) {
            let square = [x, y].map(|px| (px / square_px).round() as i64);
            if x.is_finite() && y.is_finite() && drawn.insert(square) {
                path.append([(x, y); 2]);
            }
        }
        let tag = self.out.tag("path").attr("fill", "none").stroke(color, width_px);
        tag.attr("stroke-linecap", "round").attr("d", path.as_str()).leaf();
    }

    /// Draws a bar with two opposite corners. Parts beyond the axes are clipped; a bar with a
    /// number that is not finite is left out.
    pub fn bar(&mut self, corner: ChartPoint, opposite: ChartPoint, fill: Rgb) {
        if !(corner.x + corner.y + opposite.x + opposite.y).is_finite() {
            return;
        }
        let [from, to] = [corner, opposite]
            .map(|point| (self.x_scale.px_within(point.x), self.y_scale.px_within(point.y)));
        let (width, height) = ((to.0 - from.0).abs(), (to.1 - from.1).abs());
        let tag = self.out.tag("rect").at(from.0.min(to.0), from.1.min(to.1)).size(width, height);
        tag.fill(fill).stroke(INK, BAR_LINE_PX).leaf();
    }

    /// Draws the area between the ends of the intervals of points. Points without an interval, or
    /// with a number that is not finite, are left out.
    pub fn band(&mut self, points: impl IntoIterator<Item = ChartPoint>, fill: Rgb) {
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        let all = points.into_iter().filter_map(|point| Some((point.x, point.y_interval?)));
        for (x, (low, high)) in all.filter(|(x, (low, high))| (x + low + high).is_finite()) {
            lower.push((self.x_px(x), self.y_scale.px_within(low)));
            upper.push((self.x_px(x), self.y_scale.px_within(high)));
        }
        let mut path = PathData::line(lower.into_iter().chain(upper.into_iter().rev()));
        path.close();
        self.out.tag("path").fill(fill).attr("d", path.as_str()).leaf();
    }

    /// Draws a vertical line at a value of the lower axis, such as a limit.
    pub fn rule_x(&mut self, value: f64, style: LineStyle) {
        self.rule(self.upright(value), style);
    }

    /// Draws a horizontal line at a value of the vertical axis, such as a limit.
    pub fn rule_y(&mut self, value: f64, style: LineStyle) {
        self.rule(self.level(value), style);
    }

    fn rule(&mut self, [from, to]: [(f64, f64); 2], style: LineStyle) {
        if !(from.0 + from.1 + to.0 + to.1).is_finite() {
            return;
        }
        self.out.tag("line").between(from, to).line_style(style).leaf();
    }

    /// Draws an interval at a value of the lower axis, or at a category of the vertical one. Its
    /// caps extend by `half_cap_px` to both sides. Parts beyond the axis are clipped, and have no
    /// cap. An interval with an end that is not finite is left out. Dashes are not used.
    pub fn interval(&mut self, at: f64, low: f64, high: f64, style: LineStyle, half_cap_px: f64) {
        if !(low + high).is_finite() {
            return;
        }
        let is_level = self.y_scale.axis.is_of_categories;
        let (x_scale, y_scale) = (self.x_scale, self.y_scale);
        let (along, across) = if is_level { (x_scale, y_scale) } else { (y_scale, x_scale) };
        let place = |value_px: f64, aside_px: f64| {
            let at_px = across.px(at) + aside_px;
            if is_level { (value_px, at_px) } else { (at_px, value_px) }
        };
        let whole = [low, high].map(|end| place(along.px_within(end), 0.0));
        self.segment(whole, style.color, style.width_px);
        for end in [low, high] {
            if (0.0..=1.0).contains(&along.axis.fraction(end)) {
                let cap = [-half_cap_px, half_cap_px].map(|aside| place(along.px(end), aside));
                self.segment(cap, style.color, style.width_px);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Chart};

    const STYLE: LineStyle = LineStyle::solid(INK, 2.0);

    /// Returns the drawing on a panel of 100 px x 100 px over an axis from 0 to 10.
    fn drawn(y_axis: Axis, draw: impl Fn(&mut Plot<'_>)) -> String {
        let chart = Chart::new(Axis::linear(0.0, 10.0, 5), 100.0, 100.0).panel(y_axis, |plot| {
            plot.writer().tag("mark").leaf();
            draw(plot);
            plot.writer().tag("mark").leaf();
        });
        chart.svg().as_str().split("<mark/>\n").nth(1).unwrap().to_owned()
    }

    fn upright() -> Axis {
        Axis::linear(0.0, 10.0, 5)
    }

    /// Returns the numbers of an attribute, in drawing order.
    fn numbers(svg: &str, name: &str) -> Vec<f64> {
        let before = format!(" {name}=\"");
        let values = svg.split(&before).skip(1);
        values.map(|rest| rest.split('"').next().unwrap().parse().unwrap()).collect()
    }

    #[test]
    fn values_have_their_places() {
        drawn(upright(), |plot| {
            let area = plot.area();
            assert!((area.right_px - area.left_px - 100.0).abs() < 1e-9);
            assert!((area.bottom_px - area.top_px - 100.0).abs() < 1e-9);
            assert!((plot.x_px(4.0) - area.left_px - 40.0).abs() < 1e-9);
            assert!((plot.y_px(4.0) - area.bottom_px + 40.0).abs() < 1e-9);
        });
        // Two rows of 30 px with 4 px at both ends, the first one above.
        drawn(Axis::categories(["a", "b"], 50.0), |plot| {
            let area = plot.area();
            assert!((area.bottom_px - area.top_px - 68.0).abs() < 1e-9);
            assert!((plot.y_px(0.0) - area.top_px - 19.0).abs() < 1e-9);
            assert!((plot.y_px(1.0) - area.bottom_px + 19.0).abs() < 1e-9);
        });
    }

    #[test]
    fn lines_have_gaps_where_a_point_has_no_place() {
        let points = [1.0, 2.0, f64::NAN, 3.0, 4.0].map(|y| ChartPoint::new(y, y));
        let svg = drawn(upright(), |plot| plot.line(points, STYLE));
        assert_eq!((svg.matches('M').count(), svg.matches('L').count()), (2, 2));
        // The logarithm of 0 is not finite.
        let points = [1.0, 0.0, 100.0].map(|y| ChartPoint::new(1.0, y));
        let svg = drawn(Axis::powers(&[1.0, 100.0]), |plot| plot.line(points, STYLE));
        assert_eq!((svg.matches('M').count(), svg.matches('L').count()), (2, 0));
    }

    #[test]
    fn bars_end_where_the_panel_ends() {
        let svg = drawn(upright(), |plot| {
            plot.bar(ChartPoint::new(2.0, 0.0), ChartPoint::new(4.0, 5.0), INK);
            plot.bar(ChartPoint::new(4.0, 99.0), ChartPoint::new(-3.0, -1.0), INK);
            plot.bar(ChartPoint::new(4.0, f64::NAN), ChartPoint::new(2.0, 0.0), INK);
            plot.dot(ChartPoint::new(f64::NAN, 1.0), INK, 2.0);
            plot.rule_x(f64::NAN, LineStyle::LIMIT);
            plot.rule_y(f64::INFINITY, LineStyle::LIMIT);
        });
        assert!(!svg.contains("circle") && !svg.contains(LineStyle::LIMIT.dashes), "{svg}");
        assert_eq!(
            (numbers(&svg, "width"), numbers(&svg, "height")),
            (vec![20.0, 40.0], vec![50.0, 100.0])
        );
    }

    #[test]
    fn an_interval_has_caps_where_it_ends() {
        let lengths = |svg: &str| -> Vec<f64> {
            let ends = ["x1", "x2", "y1", "y2"].map(|name| numbers(svg, name));
            let length = |i: usize| (ends[1][i] - ends[0][i]).hypot(ends[3][i] - ends[2][i]);
            (0..ends[0].len()).map(|i| length(i).round()).collect()
        };
        let svg = drawn(upright(), |plot| plot.interval(5.0, 2.0, 7.0, STYLE, 3.0));
        assert_eq!(lengths(&svg), [50.0, 6.0, 6.0]);
        let svg = drawn(upright(), |plot| {
            plot.interval(5.0, 2.0, 70.0, STYLE, 3.0);
            plot.interval(5.0, 2.0, f64::INFINITY, STYLE, 3.0);
        });
        assert_eq!(lengths(&svg), [80.0, 6.0]);
        // Horizontal, along the lower axis.
        let rows = Axis::categories(["a", "b"], 50.0);
        let svg = drawn(rows, |plot| plot.interval(1.0, 0.0, 9.0, STYLE, 3.0));
        assert_eq!(lengths(&svg), [90.0, 6.0, 6.0]);
        assert_eq!(numbers(&svg, "y1")[0], numbers(&svg, "y2")[0]);
    }

    #[test]
    fn rules_and_bands_by_hand() {
        let svg = drawn(upright(), |plot| {
            plot.rule_x(5.0, LineStyle::LIMIT);
            plot.rule_y(5.0, LineStyle::LIMIT);
        });
        let [x, y] = [["x1", "x2"], ["y1", "y2"]].map(|names| {
            let [from, to] = names.map(|name| numbers(&svg, name));
            [to[0] - from[0], to[1] - from[1]].map(f64::abs)
        });
        assert_eq!((x, y), ([0.0, 100.0], [100.0, 0.0]));
        let points = [ChartPoint::new(1.0, 1.0), ChartPoint::new(2.0, 2.0).with_interval(1.0, 3.0)];
        let points = [points[0], points[1], ChartPoint { x: 5.0, ..points[1] }];
        let svg = drawn(upright(), |plot| plot.band(points, INK));
        assert_eq!((svg.matches('L').count(), svg.matches('Z').count()), (3, 1));
    }

    #[test]
    fn of_dots_in_the_same_square_one_is_drawn() {
        let points = [1.0, 1.01, 5.0, f64::NAN].map(|x| ChartPoint::new(x, x));
        let svg = drawn(upright(), |plot| plot.dots(points, INK, 3.0, 2.0));
        assert_eq!(svg.matches('M').count(), 2);
    }
}
