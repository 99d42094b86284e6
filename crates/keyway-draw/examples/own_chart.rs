//! A custom chart made with the public interface only: the empirical distribution of the
//! clearance along a path, with its 95 % confidence band (Dvoretzky, Kiefer and Wolfowitz).
//!
//! `cargo run -p keyway-draw --example own_chart -- clearances.svg`

use keyway::geometry::Point;
use keyway_draw::{Axis, Chart, ChartPoint, LegendEntry, LegendMark, LineStyle, Rgb, SERIES, Svg};
use std::error::Error;

const BAND: Rgb = Rgb(0xcf, 0xdf, 0xee);
const RADIUS_M: f64 = 0.45;

/// Distances to the nearest of three posts along a straight path \[m\], ascending.
fn clearances_m() -> Vec<f64> {
    let posts = [[2.0, 0.3], [5.0, -1.0], [7.5, 0.6]].map(Point::from);
    let places = (0..=200).map(|i| Point::new(0.05 * f64::from(i), 0.0));
    let nearest = |at: Point| posts.iter().map(|post| at.distance(*post)).fold(f64::MAX, f64::min);
    let mut clearances: Vec<f64> = places.map(nearest).collect();
    clearances.sort_by(f64::total_cmp);
    clearances
}

/// Step function of the ascending values, with the confidence band.
fn distribution(values: &[f64]) -> Vec<ChartPoint> {
    let count = values.len() as f64;
    let half = ((2.0 / 0.05_f64).ln() / (2.0 * count)).sqrt();
    let point = |value: f64, below: usize| {
        let share = below as f64 / count;
        ChartPoint::new(value, share).with_interval(share - half, share + half)
    };
    let steps = values.iter().enumerate();
    steps.flat_map(|(i, &value)| [point(value, i), point(value, i + 1)]).collect()
}

fn distribution_chart(values: &[f64]) -> Svg {
    let steps = distribution(values);
    let line = LineStyle::solid(SERIES[0], 1.4);
    let entries = [
        LegendEntry::new("share of the points that keep no more", LegendMark::Line(line)),
        LegendEntry::new("95 % confidence band", LegendMark::Area(BAND)),
        LegendEntry::new("robot's radius", LegendMark::Line(LineStyle::LIMIT)),
    ];
    let longest = values.last().copied().unwrap_or(1.0);
    Chart::new(Axis::linear(0.0, longest, 8).label("clearance [m]"), 480.0, 240.0)
        .title("Clearances along a way past three posts")
        .legend(entries)
        .panel(Axis::linear(0.0, 1.0, 5).label("share"), |plot| {
            plot.band(steps.iter().copied(), BAND);
            plot.line(steps.iter().copied(), line);
            plot.rule_x(RADIUS_M, LineStyle::LIMIT);
        })
        .svg()
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: own_chart FILE.svg")?;
    Ok(std::fs::write(file, distribution_chart(&clearances_m()).as_str())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_as_high_as_values_are_many() {
        let values = [0.5, 1.0, 1.0, 2.0];
        let steps = distribution(&values);
        for at in [0.0, 0.5, 0.7, 1.0, 1.5, 2.0] {
            let share = values.iter().filter(|&&value| value <= at).count() as f64 / 4.0;
            let reached = steps.iter().rfind(|step| step.x <= at).map_or(0.0, |step| step.y);
            assert_eq!(reached, share, "{at}");
        }
        // The line has a point at the foot and at the head of each step.
        let svg = distribution_chart(&values).into_string();
        let line = svg.split("<path").find(|tag| tag.contains("fill=\"none\""));
        assert_eq!(line.map(|tag| tag.matches(['M', 'L']).count()), Some(8));
    }
}
