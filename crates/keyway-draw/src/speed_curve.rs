//! Speed and turn rate over time: two charts with one time axis.

use crate::ticks::span;
use crate::{
    Axis, Chart, ChartPoint, LegendEntry, LegendMark, LineStyle, Plot, Svg, Ticks, series_style,
};
use keyway_sim::sim::TrajectoryPoint;

/// A run in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedSeries<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// States in the order of time.
    pub points: &'a [TrajectoryPoint],
}

/// Options of a [`speed_curve`]; nothing besides the runs by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpeedCurveOptions {
    /// Title above the charts.
    pub title: Option<String>,
    /// Limit of the speed \[m/s\], drawn as a line.
    pub v_max_mps: Option<f64>,
    /// Limit of the turn rate to both sides \[rad/s\], drawn as two lines.
    pub omega_max_radps: Option<f64>,
    /// Caption below the charts; empty for none.
    pub caption: String,
}

/// The quantity of a state that one of the two charts shows.
struct Quantity {
    label: &'static str,
    value: fn(&TrajectoryPoint) -> f64,
    limits: Vec<f64>,
}

/// Draws speed v and turn rate omega against time, one above the other, interpolated linearly
/// between states. States that are not finite are gaps.
pub fn speed_curve(series: &[SpeedSeries<'_>], options: &SpeedCurveOptions) -> Svg {
    let omega_max = options.omega_max_radps.map(f64::abs);
    let [v_limits, omega_limits] =
        [[options.v_max_mps, None], [omega_max.map(|limit| -limit), omega_max]]
            .map(|limits| limits.into_iter().flatten().filter(|limit| limit.is_finite()).collect());
    let quantities = [
        Quantity { label: "v [m/s]", limits: v_limits, value: |p| p.velocity.v },
        Quantity { label: "\u{3c9} [rad/s]", limits: omega_limits, value: |p| p.velocity.omega },
    ];
    let (t_low, t_high) = range(drawable(series).map(|point| point.t_s));
    let has_limits = quantities.iter().any(|quantity| !quantity.limits.is_empty());
    let mut chart = Chart::new(Axis::linear(t_low, t_high, 10).label("t [s]"), 520.0, 140.0)
        .title(options.title.as_deref().unwrap_or_default())
        .caption(&options.caption)
        .legend(entries(series, has_limits));
    for quantity in &quantities {
        chart = chart.panel(quantity.axis(series), |plot| quantity.draw(plot, series));
    }
    chart.svg()
}

/// Returns the legend: a single run needs no name, several do.
fn entries(series: &[SpeedSeries<'_>], has_limits: bool) -> Vec<LegendEntry> {
    let named =
        series.iter().enumerate().filter(|(_, run)| series.len() > 1 && !run.name.is_empty());
    let named = named.map(|(i, run)| LegendEntry::new(run.name, LegendMark::Line(series_style(i))));
    let limit = has_limits.then(|| LegendEntry::new("limit", LegendMark::Line(LineStyle::LIMIT)));
    named.chain(limit).collect()
}

fn is_drawable(point: &TrajectoryPoint) -> bool {
    point.t_s.is_finite() && point.velocity.v.is_finite() && point.velocity.omega.is_finite()
}

fn drawable<'a>(series: &[SpeedSeries<'a>]) -> impl Iterator<Item = &'a TrajectoryPoint> {
    series.iter().flat_map(|run| run.points).filter(|point| is_drawable(point))
}

/// Returns the smallest range that contains all values.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = span(values).unwrap_or((0.0, 1.0));
    (low, if high > low { high } else { low + 1.0 })
}

impl Quantity {
    fn axis(&self, series: &[SpeedSeries<'_>]) -> Axis {
        let limits = self.limits.iter().copied().chain([0.0]);
        let (low, high) = range(drawable(series).map(self.value).chain(limits));
        let step = Ticks::new(low, high, 6).step;
        // Margin beyond the curves, except at zero speed, which is a natural end.
        let room = 0.06 * (high - low);
        let low = if low < 0.0 { low - room } else { low };
        let high = if high > 0.0 { high + room } else { high };
        let axis = Axis::with_ticks(low, high, &Ticks::with_step(low, high, step));
        // The zero line separates left turns from right ones.
        axis.strong_zero().label(self.label)
    }

    fn draw(&self, plot: &mut Plot<'_>, series: &[SpeedSeries<'_>]) {
        for &limit in &self.limits {
            plot.rule_y(limit, LineStyle::LIMIT);
        }
        for (i, run) in series.iter().enumerate() {
            let points = run.points.iter().map(|point| {
                let y = if is_drawable(point) { (self.value)(point) } else { f64::NAN };
                ChartPoint::new(point.t_s, y)
            });
            plot.line(points, series_style(i));
        }
    }
}
