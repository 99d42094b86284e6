//! What moves, and where everything is at the same moments.

use super::{Depth, DrivenPoint, Layer};
use crate::canvas::{Canvas, LineStyle};
use crate::color::{INK, OBSTACLE, Rgb};
use crate::legend::{Entry, Sample};
use crate::marks::{TIME_MARK_PX, hatched_disc, time_mark};
use crate::ticks::Ticks;
use keyway::geometry::Point;
use keyway::sim::Mover;

/// Moments that are marked in a run, at most.
const MOST_MOMENTS: usize = 8;
/// Times at one place that are written there; of more, the last one after dots.
const MOST_TIMES: usize = 3;
/// Points along a mover's way.
const STEPS: u32 = 4000;

/// Obstacles that move: where they are at the beginning of a run, their way in its time, and the time in
/// seconds where they are at equal times, with the same numbers along the robot's way. What lies outside the
/// map does not make the picture larger.
#[derive(Clone, Debug)]
pub struct Movers<'a> {
    all: &'a [Mover],
    run: &'a [DrivenPoint],
}

/// Times at one place \[px\].
struct Mark {
    px: (f64, f64),
    times: Vec<String>,
}

impl<'a> Movers<'a> {
    const WAY: LineStyle = LineStyle { color: OBSTACLE, width_px: 1.3, dashes: "5 3" };
    const OUTLINE: LineStyle = LineStyle { color: OBSTACLE, width_px: 0.9, dashes: "" };

    /// Movers while a robot drives a run; without a run, at its beginning.
    pub const fn new(movers: &'a [Mover], run: &'a [DrivenPoint]) -> Self {
        Self { all: movers, run }
    }

    fn end_s(&self) -> f64 {
        self.run.last().map_or(0.0, |point| point.t_s).max(0.0)
    }

    fn draw_mover(&self, canvas: &mut Canvas<'_>, mover: &Mover, moments: &Ticks) {
        let view = *canvas.view();
        let radius_px = mover.radius_m() * view.px_per_m();
        let end_s = self.end_s();
        let at = |step: u32| mover.at(end_s * f64::from(step) / f64::from(STEPS)).centre;
        let way: Vec<Point> = (0..=STEPS).map(at).collect();
        canvas.line(&way, Self::WAY);
        for &t_s in &moments.values {
            let (x, y) = view.px_from_world(mover.at(t_s).centre);
            let outline = canvas.writer().tag("circle").round(x, y, radius_px);
            outline.attr("fill", "none").stroke(Self::OUTLINE.color, Self::OUTLINE.width_px).leaf();
        }
        hatched_disc(
            canvas.writer(),
            view.px_from_world(mover.at(0.0).centre),
            radius_px,
            OBSTACLE,
        );
        draw_marks(canvas, moments, OBSTACLE, |t_s| Some(mover.at(t_s).centre));
    }

    /// Where the robot is at a moment of the run.
    fn robot_at(&self, t_s: f64) -> Option<Point> {
        let after = self.run.partition_point(|point| point.t_s <= t_s);
        let from = self.run.get(after.checked_sub(1)?)?;
        let Some(to) = self.run.get(after) else { return Some(from.pose.point()) };
        let part = (t_s - from.t_s) / (to.t_s - from.t_s);
        Some(from.pose.point().lerp(to.pose.point(), part))
    }
}

impl Layer for Movers<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if self.all.is_empty() {
            return;
        }
        canvas.explain(Entry::new("moving obstacle", Sample::HatchedDisc(OBSTACLE)));
        let moments = Ticks::new(0.0, self.end_s(), MOST_MOMENTS);
        if self.end_s() > 0.0 {
            canvas.explain(Entry::new("its way", Sample::Line(Self::WAY)));
            canvas.explain(Entry::new("where it is at a time [s]", Sample::Time(OBSTACLE)));
            canvas.explain(Entry::new("robot at a time [s]", Sample::Time(INK)));
        }
        for mover in self.all {
            self.draw_mover(canvas, mover, &moments);
        }
        draw_marks(canvas, &moments, INK, |t_s| self.robot_at(t_s));
    }
}

/// Writes times where something is; one mark where it is at the same place several times.
fn draw_marks(
    canvas: &mut Canvas<'_>,
    moments: &Ticks,
    color: Rgb,
    place: impl Fn(f64) -> Option<Point>,
) {
    let view = *canvas.view();
    let mut marks: Vec<Mark> = Vec::new();
    // Where everything begins is seen without a number.
    for &t_s in moments.values.iter().filter(|&&t_s| t_s > 0.0) {
        let Some(at) = place(t_s).filter(|at| at.is_finite()) else { continue };
        let px = view.px_from_world(at);
        let apart = |mark: &Mark| (mark.px.0 - px.0).hypot(mark.px.1 - px.1);
        match marks.iter_mut().find(|mark| apart(mark) < 2.0 * TIME_MARK_PX) {
            Some(mark) => mark.times.push(moments.text(t_s)),
            None => marks.push(Mark { px, times: vec![moments.text(t_s)] }),
        }
    }
    for Mark { px, times } in marks {
        let text = match times.as_slice() {
            [first, .., last] if times.len() > MOST_TIMES => format!("{first} \u{2026} {last}"),
            _ => times.join(", "),
        };
        time_mark(canvas.writer(), px, &text, color);
        canvas.discs.push((px, TIME_MARK_PX));
    }
}
