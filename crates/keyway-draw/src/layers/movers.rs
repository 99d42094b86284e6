//! Moving obstacles, with time marks that show positions at equal times.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{INK, OBSTACLE, Rgb};
use crate::legend::{LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::marks::{TIME_MARK_PX, hatched_disc, time_mark, time_mark_half_px};
use crate::ticks::Ticks;
use keyway::geometry::Point;
use keyway_sim::sim::{MovingObstacle, ObstacleMotion, TrajectoryPoint};

/// Maximum number of times that are marked in a run.
const MOST_MOMENTS: usize = 6;
/// Maximum number of times written at one position; of more, only the first and the last are
/// written.
const MOST_TIMES: usize = 3;
/// Positions nearer than this are one \[px\].
const SAME_PX: f64 = 3.0;
/// Radius of the dot at a marked time \[px\].
const DOT_PX: f64 = 2.6;
/// Distance from a dot to the middle of its time \[px\].
const ASIDE_PX: f64 = 11.0;
/// Number of points along the trajectory of a moving obstacle.
const STEPS: u32 = 4000;

/// Moving obstacles: their positions at the beginning of a run, their trajectories during it, and
/// marks with the time in seconds at equal intervals, with the same times along the robot's
/// trajectory. Parts outside the map do not enlarge the picture.
#[derive(Clone, Debug)]
pub struct Movers<'a> {
    all: &'a [MovingObstacle],
    /// Runs of one or several robots, with the colour of the time marks.
    runs: Vec<(&'a [TrajectoryPoint], Rgb)>,
}

/// Times at one position \[px\].
struct Mark {
    px: (f64, f64),
    times: Vec<String>,
}

/// Numbers that were already placed: centres and half widths \[px\].
type Taken = Vec<((f64, f64), f64)>;

impl<'a> Movers<'a> {
    const WAY: LineStyle = LineStyle::solid(OBSTACLE, 1.0);
    const OUTLINE: LineStyle = LineStyle::solid(OBSTACLE, 0.9);

    /// Creates the layer for the run of a robot; without a run, it shows the initial positions.
    pub fn new(movers: &'a [MovingObstacle], run: &'a [TrajectoryPoint]) -> Self {
        Self { all: movers, runs: vec![(run, INK)] }
    }

    /// Creates the layer for several robots, each with a colour for the times along its
    /// trajectory. The times are shown without moving obstacles, too: the robots move among each
    /// other.
    pub const fn among(
        movers: &'a [MovingObstacle],
        runs: Vec<(&'a [TrajectoryPoint], Rgb)>,
    ) -> Self {
        Self { all: movers, runs }
    }

    /// End time of the last run.
    fn end_s(&self) -> f64 {
        let ends_s = self.runs.iter().filter_map(|(run, _)| Some(run.last()?.t_s));
        ends_s.fold(0.0, f64::max)
    }

    fn draw_mover(&self, canvas: &mut Canvas<'_>, mover: &MovingObstacle, moments: &Ticks) {
        let view = *canvas.view();
        let radius_px = mover.radius_m() * view.px_per_m();
        for way in ways(mover.motion(), self.end_s()) {
            canvas.line(&way, Self::WAY);
        }
        for &t_s in &moments.values {
            let (x, y) = view.px_from_world(mover.at(t_s).centre);
            let outline = canvas.writer().tag("circle").round(x, y, radius_px);
            outline.attr("fill", "none").stroke(Self::OUTLINE.color, Self::OUTLINE.width_px).leaf();
        }
        let first = view.px_from_world(mover.at(0.0).centre);
        hatched_disc(canvas.writer(), first, radius_px, OBSTACLE);
    }
}

/// Returns the position of a robot at a time during its run, or after it.
fn robot_at(run: &[TrajectoryPoint], t_s: f64) -> Option<Point> {
    let after = run.partition_point(|point| point.t_s <= t_s);
    let from = run.get(after.checked_sub(1)?)?;
    let Some(to) = run.get(after) else { return Some(from.pose.point()) };
    let part = (t_s - from.t_s) / (to.t_s - from.t_s);
    Some(from.pose.point().lerp(to.pose.point(), part))
}

impl Layer for Movers<'_> {
    fn depth(&self) -> Depth {
        Depth::Obstacles
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if self.all.is_empty() && self.runs.len() < 2 {
            return;
        }
        let moments = moments(self.end_s());
        if !self.all.is_empty() {
            canvas.explain(LegendEntry::new("moving obstacle", LegendMark::HatchedDisc(OBSTACLE)));
            if self.end_s() > 0.0 {
                canvas.explain(LegendEntry::new("its path", LegendMark::Line(Self::WAY)));
                canvas.explain(LegendEntry::new(
                    "its position at a time [s]",
                    LegendMark::Time(OBSTACLE),
                ));
            }
        }
        if self.end_s() > 0.0 {
            canvas.explain(LegendEntry::new("robot at a time [s]", LegendMark::Time(INK)));
        }
        for mover in self.all {
            self.draw_mover(canvas, mover, &moments);
        }
        let mut taken = Taken::new();
        // Below the robot's trajectory, but above those of moving obstacles, which it meets at
        // the critical points.
        for &(run, color) in &self.runs {
            let end_s = run.last().map_or(0.0, |point| point.t_s);
            // After its end, the robot is stationary.
            let at = |t_s: f64| robot_at(run, t_s).filter(|_| t_s <= end_s);
            let robot = marks(canvas, &moments, at);
            draw_marks(canvas, &robot, color, ASIDE_PX, &mut taken);
        }
        for mover in self.all {
            let marks = marks(canvas, &moments, |t_s| Some(mover.at(t_s).centre));
            draw_marks(canvas, &marks, OBSTACLE, -ASIDE_PX, &mut taken);
        }
    }
}

/// Returns the trajectory of a moving obstacle up to a time, split at its jumps.
fn ways(motion: &ObstacleMotion, end_s: f64) -> Vec<Vec<Point>> {
    let (mut ways, mut way) = (Vec::new(), Vec::new());
    let mut next_jump_s = motion.next_jump_s(0.0);
    for step in 0..=STEPS {
        let t_s = end_s * f64::from(step) / f64::from(STEPS);
        while let Some(jump_s) = next_jump_s.filter(|&jump_s| jump_s <= t_s) {
            way.push(motion.position_before(jump_s));
            ways.push(std::mem::replace(&mut way, vec![motion.position(jump_s)]));
            next_jump_s = motion.next_jump_s(jump_s);
        }
        way.push(motion.position(t_s));
    }
    ways.push(way);
    ways
}

/// Returns whole seconds at equal intervals.
fn moments(end_s: f64) -> Ticks {
    let step_s = Ticks::new(0.0, end_s, MOST_MOMENTS).step.ceil();
    Ticks::with_step(0.0, end_s, step_s)
}

/// Returns the marks at all times after the first: initial positions are visible without a
/// number.
fn marks(canvas: &Canvas<'_>, moments: &Ticks, place: impl Fn(f64) -> Option<Point>) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for &t_s in moments.values.iter().filter(|&&t_s| t_s > 0.0) {
        let Some(at) = place(t_s).filter(|at| at.is_finite()) else { continue };
        let px = canvas.view().px_from_world(at);
        let is_same = |mark: &&mut Mark| (mark.px.0 - px.0).hypot(mark.px.1 - px.1) < SAME_PX;
        match marks.iter_mut().find(is_same) {
            Some(mark) => mark.times.push(moments.text(t_s)),
            None => marks.push(Mark { px, times: vec![moments.text(t_s)] }),
        }
    }
    marks
}

/// Draws dots, each with its times `aside_px` below it. A number that would cover another one is
/// left out: its neighbours along the trajectory identify it.
fn draw_marks(
    canvas: &mut Canvas<'_>,
    marks: &[Mark],
    color: Rgb,
    aside_px: f64,
    taken: &mut Taken,
) {
    for Mark { px: (x, y), times } in marks {
        let dot = canvas.writer().tag("circle").round(*x, *y, DOT_PX).fill(color);
        dot.attr("stroke", "#fff").num("stroke-width", 0.8).leaf();
        let text = match times.as_slice() {
            [first, .., last] if times.len() > MOST_TIMES => format!("{first} \u{2026} {last}"),
            _ => times.join(", "),
        };
        let (middle, half_px) = ((*x, y + aside_px), time_mark_half_px(&text));
        let covers = |((other_x, other_y), other_half_px): &((f64, f64), f64)| {
            (middle.0 - other_x).abs() < half_px + other_half_px
                && (middle.1 - other_y).abs() < 2.0 * TIME_MARK_PX
        };
        if !taken.iter().any(covers) {
            time_mark(canvas.writer(), middle, &text, color);
            taken.push((middle, half_px));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway_sim::sim::{KeyFrame, Spline};

    #[test]
    fn no_line_leads_along_a_jump() {
        let frames = [[0.0, 0.0, 0.0], [1.0, 3.0, 0.0]].map(KeyFrame::from).to_vec();
        let motion = ObstacleMotion::Spline(Spline::new(frames, 1.5).unwrap());
        let ways = ways(&motion, 4.0);
        let ends: Vec<[f64; 2]> = ways.iter().map(|way| [way[0].x, way[way.len() - 1].x]).collect();
        assert_eq!(ends, [[0.0, 3.0], [0.0, 3.0], [0.0, 3.0]]);
        let steps =
            ways.iter().flat_map(|way| way.windows(2).map(|pair| pair[0].distance(pair[1])));
        assert!(steps.fold(0.0, f64::max) < 0.01);
    }
}
