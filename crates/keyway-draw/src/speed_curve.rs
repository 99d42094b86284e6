//! Speed and turn rate over time: two charts with one time axis.

use crate::axes::{BOTTOM_AXIS_PX, Scale, TITLE_PX, border, bottom_axis, left_axis, side_axis_px};
use crate::caption::Caption;
use crate::color::{GRID, QUIET, SERIES};
use crate::layers::DrivenPoint;
use crate::legend::{Entry, Legend, Sample};
use crate::line_style::LineStyle;
use crate::svg::Svg;
use crate::text::text_width_px;
use crate::ticks::Ticks;
use crate::writer::{Anchor, PathData, SvgWriter};

const WIDTH_PX: f64 = 520.0;
const PANEL_PX: f64 = 140.0;
const PANEL_GAP_PX: f64 = 14.0;
const EDGE_PX: f64 = 8.0;
/// Line styles in addition to the colours, so that runs can be told apart without colour.
const DASHES: [&str; 4] = ["", "6 2.5", "2 2", "8 2.5 2 2.5"];

/// A run in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedSeries<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Its states in the order of time.
    pub points: &'a [DrivenPoint],
}

/// What a [`speed_curve`] shows besides the runs; nothing by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpeedCurveOptions {
    /// A title above the charts.
    pub title: Option<String>,
    /// Limit of the speed \[m/s\], drawn as a line.
    pub v_max_mps: Option<f64>,
    /// Limit of the turn rate to both sides \[rad/s\], drawn as two lines.
    pub omega_max_radps: Option<f64>,
    /// What is to be said below; empty for nothing.
    pub caption: String,
}

/// One of the two charts: what it shows of a state.
struct Panel {
    label: &'static str,
    limits: Vec<f64>,
    value: fn(&DrivenPoint) -> f64,
    scale: Scale,
    ticks: Ticks,
}

/// Speed v and turn rate omega against time, one above the other. Between two states they change
/// linearly. States that are not finite are gaps.
pub fn speed_curve(series: &[SpeedSeries<'_>], options: &SpeedCurveOptions) -> Svg {
    let top = EDGE_PX + if options.title.is_some() { TITLE_PX + 10.0 } else { 4.0 };
    let omega_max = options.omega_max_radps.map(f64::abs);
    let omega_limits = omega_max.map_or(Vec::new(), |limit| vec![-limit, limit]);
    let v_limits = options.v_max_mps.into_iter().collect();
    let lower = top + PANEL_PX + PANEL_GAP_PX;
    let panels = [
        Panel::new(series, "v [m/s]", v_limits, |p| p.velocity.v, top),
        Panel::new(series, "\u{3c9} [rad/s]", omega_limits, |p| p.velocity.omega, lower),
    ];
    let axis_px = panels.iter().map(|panel| side_axis_px(&panel.ticks)).fold(0.0, f64::max);
    let left = EDGE_PX + axis_px;
    let (t_low, t_high) = range(series, |p| p.t_s, &[]);
    let time = Scale { low: t_low, high: t_high, low_px: left, high_px: left + WIDTH_PX };
    let t_ticks = Ticks::new(t_low, t_high, 10);
    let mut out = SvgWriter::new();
    for panel in &panels {
        panel.draw(&mut out, series, time, &t_ticks);
        left_axis(&mut out, panel.scale, left, axis_px, &panel.ticks, panel.label);
    }
    let bottom = lower + PANEL_PX;
    bottom_axis(&mut out, time, bottom, &t_ticks, "t [s]");
    if let Some(title) = &options.title {
        let x = left + 0.5 * (WIDTH_PX - text_width_px(title, TITLE_PX)).max(0.0);
        out.label(x, EDGE_PX + TITLE_PX - 1.0, TITLE_PX, Anchor::Start, title);
    }
    let entries = entries(series, panels.iter().any(|panel| !panel.limits.is_empty()));
    let legend = Legend::new(&entries, WIDTH_PX);
    let legend_y = bottom + BOTTOM_AXIS_PX + 8.0;
    legend.draw(&mut out, left, legend_y);
    let title_px = options.title.as_ref().map_or(0.0, |title| text_width_px(title, TITLE_PX));
    let right = left + WIDTH_PX.max(legend.width_px()).max(title_px);
    let caption = Caption::new(&options.caption, right - EDGE_PX);
    let caption_y = legend_y + legend.height_px() + 4.0;
    caption.draw(&mut out, EDGE_PX, caption_y);
    let right = right.max(EDGE_PX + caption.width_px());
    Svg::page(right + EDGE_PX + 8.0, caption_y + caption.height_px() + EDGE_PX, out)
}

/// The line of the run of this index among several: in a colour, and dashes that tell it from its
/// neighbours without colour.
pub fn series_style(index: usize) -> LineStyle {
    let color = SERIES[index % SERIES.len()];
    LineStyle { color, width_px: 1.4, dashes: DASHES[index % DASHES.len()] }
}

const LIMIT: LineStyle = LineStyle { color: QUIET, width_px: 0.9, dashes: "4 3" };

/// One run explains itself; several need names.
fn entries(series: &[SpeedSeries<'_>], has_limits: bool) -> Vec<Entry> {
    let named =
        series.iter().enumerate().filter(|(_, run)| series.len() > 1 && !run.name.is_empty());
    let mut entries: Vec<Entry> =
        named.map(|(i, run)| Entry::new(run.name, Sample::Line(series_style(i)))).collect();
    if has_limits {
        entries.push(Entry::new("limit", Sample::Line(LIMIT)));
    }
    entries
}

fn is_drawable(point: &DrivenPoint) -> bool {
    point.t_s.is_finite() && point.velocity.v.is_finite() && point.velocity.omega.is_finite()
}

/// The smallest range that holds a value of all states, and further values.
fn range(
    series: &[SpeedSeries<'_>],
    value: impl Fn(&DrivenPoint) -> f64,
    further: &[f64],
) -> (f64, f64) {
    let states = series.iter().flat_map(|run| run.points).filter(|point| is_drawable(point));
    let values = states.map(value).chain(further.iter().copied());
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if high > low {
        (low, high)
    } else if low.is_finite() {
        (low, low + 1.0)
    } else {
        (0.0, 1.0)
    }
}

impl Panel {
    fn new(
        series: &[SpeedSeries<'_>],
        label: &'static str,
        mut limits: Vec<f64>,
        value: fn(&DrivenPoint) -> f64,
        top: f64,
    ) -> Self {
        limits.retain(|limit| limit.is_finite());
        let with_zero: Vec<f64> = limits.iter().copied().chain([0.0]).collect();
        let (low, high) = range(series, value, &with_zero);
        let ticks = Ticks::new(low, high, 6);
        // Room beyond the curves, except at zero speed, which is an end in itself.
        let room = 0.06 * (high - low);
        let low = if low < 0.0 { low - room } else { low };
        let high = if high > 0.0 { high + room } else { high };
        let scale = Scale { low, high, low_px: top + PANEL_PX, high_px: top };
        Self { label, limits, value, scale, ticks: Ticks::with_step(low, high, ticks.step) }
    }

    fn draw(&self, out: &mut SvgWriter, series: &[SpeedSeries<'_>], time: Scale, t_ticks: &Ticks) {
        let (left, right) = (time.low_px, time.high_px);
        let (top, bottom) = (self.scale.high_px, self.scale.low_px);
        for &t in &t_ticks.values {
            let x = time.px(t);
            out.tag("line").between((x, top), (x, bottom)).stroke(GRID, 0.7).leaf();
        }
        for &value in &self.ticks.values {
            // The zero line is stronger: it separates left turns from right ones.
            let color = if value == 0.0 { QUIET } else { GRID };
            let y = self.scale.px(value);
            out.tag("line").between((left, y), (right, y)).stroke(color, 0.7).leaf();
        }
        for &limit in &self.limits {
            let y = self.scale.px(limit);
            let line = out.tag("line").between((left, y), (right, y));
            let line = line.stroke(LIMIT.color, LIMIT.width_px);
            line.attr("stroke-dasharray", LIMIT.dashes).leaf();
        }
        for (i, run) in series.iter().enumerate() {
            let mut path = PathData::default();
            for part in run.points.split(|point| !is_drawable(point)) {
                let px = |p: &DrivenPoint| (time.px(p.t_s), self.scale.px((self.value)(p)));
                let Some((first, rest)) = part.split_first() else { continue };
                path.move_to(px(first));
                for point in rest {
                    path.line_to(px(point));
                }
            }
            let style = series_style(i);
            let tag = out.tag("path").attr("fill", "none").stroke(style.color, style.width_px);
            let tag = tag.attr("stroke-dasharray", style.dashes).attr("stroke-linejoin", "round");
            tag.attr("d", path.as_str()).leaf();
        }
        border(out, left, top, right - left, bottom - top);
    }
}
