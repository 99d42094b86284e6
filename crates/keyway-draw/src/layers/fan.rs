//! The velocities that a local planner tried, as the resulting trajectories.

use super::{Depth, Layer};
use crate::canvas::Canvas;
use crate::color::{FREE, INK, OVER_DRIVEN, Rgb, viridis};
use crate::legend::{ColorBar, LegendEntry, LegendMark};
use crate::line_style::LineStyle;
use crate::ticks::span;
use crate::view::Extent;
use crate::writer::PathData;
use keyway::geometry::{Point, Pose};
use keyway::local::{Explanation, Fate, JudgedCandidate};
use std::collections::BTreeMap;

/// Distinct colours of scores.
const SHADES: usize = 24;
/// Colours of the rules that refuse candidates, that of contacts first: none is a colour of the
/// scores.
const RULES: [Rgb; 4] =
    [Rgb(0xd5, 0x5e, 0x00), Rgb(0x8c, 0x56, 0x4b), Rgb(0xcc, 0x79, 0xa7), Rgb(0x99, 0x99, 0x99)];
/// Radius of the dot at a predicted contact \[px\].
const CONTACT_PX: f64 = 1.3;
/// Colours of candidates in an animation: admissible, and refused.
const PALE: Rgb = Rgb(0x8f, 0xb8, 0xde);
const PALE_REFUSED: Rgb = Rgb(0xf0, 0xc9, 0xa8);

/// Trajectories of all candidates of a cycle: refused ones thin and coloured by rule, with a dot
/// at a predicted contact; admissible ones coloured by score; the best and the second best one
/// thick.
#[derive(Clone, Debug)]
pub struct Fan<'a> {
    from: Pose,
    explanation: &'a Explanation,
    is_pale: bool,
}

impl<'a> Fan<'a> {
    const CHOSEN: LineStyle = LineStyle::solid(INK, 2.6);
    const RUNNER_UP: LineStyle = LineStyle { color: OVER_DRIVEN, width_px: 5.6, dashes: "6 4" };

    /// Creates the fan of a robot at a pose.
    pub const fn new(from: Pose, explanation: &'a Explanation) -> Self {
        Self { from, explanation, is_pale: false }
    }

    /// Makes the fan pale and draws it behind everything else, with only the best candidate
    /// highlighted: for animations.
    #[must_use]
    pub const fn pale(self) -> Self {
        Self { is_pale: true, ..self }
    }

    fn points(&self, candidate: &JudgedCandidate) -> Vec<Point> {
        std::iter::once(&self.from).chain(&candidate.poses).map(Pose::point).collect()
    }

    /// Adds a candidate's trajectory to a line.
    fn add(&self, line: &mut PathData, candidate: &JudgedCandidate, canvas: &Canvas<'_>) {
        let points = self.points(candidate);
        if points.iter().all(|point| point.is_finite()) {
            line.append(points.iter().map(|&point| canvas.view().px_from_world(point)));
        }
    }

    /// Returns the rules that refused candidates, with the reason and the number of candidates:
    /// that of contacts first, the others by name, so that pictures can be compared.
    fn rules(&self) -> Vec<(&str, &str, usize)> {
        let mut rules: BTreeMap<(bool, &str), (&str, usize)> = BTreeMap::new();
        for candidate in &self.explanation.candidates {
            if let Fate::Refused { rule, because, free_for_s } = &candidate.fate {
                rules.entry((free_for_s.is_none(), rule)).or_insert((because, 0)).1 += 1;
            }
        }
        rules.into_iter().map(|((_, rule), (because, count))| (rule, because, count)).collect()
    }

    fn draw_refused(&self, canvas: &mut Canvas<'_>) {
        for (i, (rule, because, count)) in self.rules().into_iter().enumerate() {
            let color = RULES[i.min(RULES.len() - 1)];
            let style = LineStyle::solid(color, 0.5);
            let by_it = |one: &&JudgedCandidate| matches!(&one.fate, Fate::Refused { rule: by, .. } if by == rule);
            let refused: Vec<_> = self.explanation.candidates.iter().filter(by_it).collect();
            let mut line = PathData::default();
            for one in &refused {
                self.add(&mut line, one, canvas);
            }
            canvas.path(&line, style);
            for one in refused {
                let touches = matches!(one.fate, Fate::Refused { free_for_s: Some(_), .. });
                if let Some(pose) = one.poses.last().filter(|_| touches) {
                    let (x, y) = canvas.view().px_from_world(pose.point());
                    canvas.writer().tag("circle").round(x, y, CONTACT_PX).fill(color).leaf();
                }
            }
            canvas.explain(LegendEntry::new(
                format!("refused: {count} {because}"),
                LegendMark::Line(style),
            ));
        }
    }

    fn draw_admissible(&self, canvas: &mut Canvas<'_>) {
        let scores = || self.explanation.candidates.iter().filter_map(JudgedCandidate::score);
        let Some((low, high)) = span(scores()) else { return };
        let width = if high > low { high - low } else { 1.0 };
        let mut shades = vec![PathData::default(); SHADES];
        for candidate in &self.explanation.candidates {
            if let Some(score) = candidate.score() {
                let shade = ((score - low) / width * (SHADES - 1) as f64).round() as usize;
                self.add(&mut shades[shade.min(SHADES - 1)], candidate, canvas);
            }
        }
        // Good candidates are drawn over bad ones.
        for (i, line) in shades.iter().enumerate() {
            let color = viridis(i as f64 / (SHADES - 1) as f64);
            canvas.path(line, LineStyle::solid(color, 1.1));
        }
        let count = scores().count();
        let mark = LegendMark::ShadedLine(std::array::from_fn(|i| viridis((i as f64 + 0.5) / 8.0)));
        canvas.explain(LegendEntry::new(format!("{count} admissible, by score"), mark));
        canvas.explain_colors(ColorBar { label: "score".to_owned(), low, high: low + width });
    }

    fn draw_best(&self, canvas: &mut Canvas<'_>) {
        let Explanation { candidates, chosen, runner_up, .. } = self.explanation;
        // The second best first: it is wider, so both are visible where they overlap.
        for (place, style, label) in
            [(runner_up, Self::RUNNER_UP, "second best"), (chosen, Self::CHOSEN, "chosen")]
        {
            let Some(candidate) = place.and_then(|place| candidates.get(place)) else { continue };
            let points = self.points(candidate);
            if style.dashes.is_empty() {
                let width_px = style.width_px + 1.2;
                canvas.line(&points, LineStyle { color: FREE, width_px, ..style });
            }
            if canvas.line(&points, style) {
                canvas.explain(LegendEntry::new(label, LegendMark::Line(style)));
            }
        }
    }

    fn draw_pale(&self, canvas: &mut Canvas<'_>) {
        let Explanation { candidates, chosen, .. } = self.explanation;
        for (is_admissible, color, label) in
            [(false, PALE_REFUSED, "refused"), (true, PALE, "admissible")]
        {
            let mut line = PathData::default();
            let fitting = candidates.iter().filter(|one| one.score().is_some() == is_admissible);
            fitting.for_each(|one| self.add(&mut line, one, canvas));
            let style = LineStyle::solid(color, 0.7);
            if canvas.path(&line, style) {
                canvas.explain(LegendEntry::new(label, LegendMark::Line(style)));
            }
        }
        if let Some(candidate) = chosen.and_then(|place| candidates.get(place)) {
            let style = LineStyle { width_px: 1.6, ..Self::CHOSEN };
            canvas.line(&self.points(candidate), style);
            canvas.explain(LegendEntry::new("chosen", LegendMark::Line(style)));
        }
    }
}

impl Layer for Fan<'_> {
    fn depth(&self) -> Depth {
        if self.is_pale { Depth::Cells } else { Depth::Driven }
    }

    fn extend(&self, extent: &mut Extent) {
        extent.include(self.from.point());
        let poses = self.explanation.candidates.iter().flat_map(|one| &one.poses);
        poses.for_each(|pose| extent.include(pose.point()));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) {
        if self.is_pale {
            self.draw_pale(canvas);
        } else {
            self.draw_refused(canvas);
            self.draw_admissible(canvas);
            self.draw_best(canvas);
        }
    }
}
