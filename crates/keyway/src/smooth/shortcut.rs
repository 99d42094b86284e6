//! Grandparent shortcuts \[Wang2019\]: a line -> the same line without the points that a free
//! connection can skip.
//!
//! Going back from the goal, a point is dropped if its predecessor and its successor can be
//! joined. A pass keeps at least every second point; a few passes straighten most of a path.
//!
//! # Source
//! \[Wang2019\]: third improvement (path generation), equations (16), (17); the fourth one for the
//! expansion.
//!
//! | paper | here | unit | paper's value |
//! |---|---|---|---|
//! | n passes | [`ShortcutConfig::passes`] | 1 | 2 |
//! | expanded obstacles | [`ShortcutConfig::expansion_cells`] | cells | 1 |
//!
//! # Where this differs from the paper
//! - The paper tests the line's points between two x values (16), (17). That misses vertical lines
//!   and cells that the line only clips. Here every cell that the line touches must be free, even
//!   if only a corner is touched.
//! - In the paper the expansion belongs to the map, which the search and the shortcuts share. Here
//!   a smoother is given obstacles and distances, not the layers of a search, so the expansion is
//!   a parameter; [`ShortcutConfig::for_layers`] takes that of the search. A part of the line that
//!   leads through expanded cells, as it may if the search had a smaller expansion, stays as it
//!   was. [`Smoothed::kept_clearance_m`] reports it: n expanded cells are a distance of n cells.
//! - A second run adds that many passes, so it can drop further points. If a run ended because a
//!   pass dropped no point, a second run changes nothing.
//! - In addition, a connection is free only if it keeps the required clearance.
//!
//! # Errors / cost
//! None. One test per point and pass.

use super::parameters::SmootherParameters;
use super::required_clearance::RequiredClearance;
use super::{Smoothed, Smoother};
use crate::ConfigError;
use crate::geometry::{PlannedLine, Point, Polyline, Segment};
use crate::map::{Clearance, LayerConfig};
use serde::{Deserialize, Serialize};

/// Parameters of the grandparent shortcuts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ShortcutConfig {
    /// Number of passes back along the line.
    pub passes: u32,
    /// A shortcut must not touch cells that are at most this many rows and columns away from an
    /// obstacle; the same number as the search's `map.published.expansion_cells` \[cells\].
    pub expansion_cells: u32,
}

impl ShortcutConfig {
    /// The paper's values.
    pub const PAPER: Self = Self { passes: 2, expansion_cells: 1 };

    /// The paper's passes, with the expansion of the map that the line was planned on.
    pub const fn for_layers(layers: &LayerConfig) -> Self {
        Self { expansion_cells: layers.published.expansion_cells, ..Self::PAPER }
    }
}

impl Default for ShortcutConfig {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Smooths by grandparent shortcuts.
#[derive(Clone, Debug, Default)]
pub struct Shortcut {
    config: ShortcutConfig,
}

impl Shortcut {
    /// Its name on the command line and in reports.
    pub const NAME: &'static str = "shortcut";

    /// The smoother with these parameters.
    pub const fn new(config: ShortcutConfig) -> Self {
        Self { config }
    }
}

impl SmootherParameters for ShortcutConfig {
    fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        Ok(Box::new(Shortcut::new(self.clone())))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn safe_distance_m(&self, cell_m: f64) -> f64 {
        f64::from(self.expansion_cells) * cell_m
    }
}

impl Smoother for Shortcut {
    fn smooth_distinct(
        &self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        let line = line.polyline();
        let is_free = |shortcut: Segment| {
            clearance.is_clear(shortcut, clearance_m)
                && !clearance.touches_expanded(shortcut, self.config.expansion_cells)
        };
        let mut points = line.points().to_vec();
        for _ in 0..self.config.passes {
            let fewer = walked_back(&points, is_free);
            if fewer.len() == points.len() {
                break;
            }
            points = fewer;
        }
        let expansion_m = self.config.safe_distance_m(clearance.frame().resolution_m());
        let required = RequiredClearance::new(clearance, clearance_m, expansion_m);
        Smoothed::straight(line, &Polyline::new(points), &required)
    }
}

/// One pass. It continues from the grandparent if the parent was dropped, otherwise from the
/// parent.
fn walked_back(points: &[Point], is_free: impl Fn(Segment) -> bool) -> Vec<Point> {
    let mut kept: Vec<Point> = points.last().copied().into_iter().collect();
    let mut at = points.len().saturating_sub(1);
    while at > 0 {
        let skips = at >= 2 && is_free(Segment::new(points[at], points[at - 2]));
        at -= if skips { 2 } else { 1 };
        kept.push(points[at]);
    }
    kept.reverse();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{OccupancyGrid, PublishedConstraints};

    fn smooth(
        config: &ShortcutConfig,
        line: &Polyline,
        clearance: &Clearance<'_>,
        clearance_m: f64,
    ) -> Smoothed {
        Shortcut::new(config.clone()).smooth(&line.clone().into(), clearance, clearance_m)
    }

    fn points_of(points: &[[f64; 2]]) -> Vec<Point> {
        points.iter().map(|&p| p.into()).collect()
    }

    #[test]
    fn a_pass_drops_at_most_every_second_point() {
        let along: Vec<[f64; 2]> = (0..7).map(|x| [f64::from(x), f64::from(x * x)]).collect();
        let at = |kept: &[usize]| kept.iter().map(|&x| along[x].into()).collect::<Vec<Point>>();
        let all = points_of(&along);
        assert_eq!(walked_back(&all, |_| true), at(&[0, 2, 4, 6]));
        // From 6 over 4 to 2, which has no grandparent.
        assert_eq!(walked_back(&at(&[0, 2, 4, 6]), |_| true), at(&[0, 2, 6]));
        // If only 5 and 3 cannot be joined: 6 to 4, 4 to 2, 2 to 0 can. If only 6 and 4 cannot:
        // then 5 to 3, 3 to 1, and from there to the start.
        let only_not = |x: f64| move |shortcut: Segment| shortcut.a.x != x;
        assert_eq!(walked_back(&all, only_not(5.0)), at(&[0, 2, 4, 6]));
        assert_eq!(walked_back(&all, only_not(6.0)), at(&[0, 1, 3, 5, 6]));
        assert_eq!(walked_back(&all, |_| false), all);
        for few in 0..3 {
            assert_eq!(walked_back(&all[..few], |_| false), all[..few]);
        }
    }

    #[test]
    fn expanded_cells_by_hand() {
        // The obstacle (3, 3), which expands by one cell to everything from (2, 2) to (5, 4).
        let grid = OccupancyGrid::from_ascii(&["...#...", ".......", ".......", "......."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let line =
            [[0.5, 2.5], [1.5, 1.5], [2.5, 1.5], [3.5, 1.5], [4.5, 1.5], [5.5, 1.5], [6.5, 2.5]];
        let run = |passes, expansion_cells| {
            let line = Polyline::new(points_of(&line));
            let config = ShortcutConfig { passes, expansion_cells };
            let done = smooth(&config, &line, &clearance, 0.0);
            done.path.flattened(0.0).points().to_vec()
        };
        // Pass 1 joins (6.5, 2.5) - (4.5, 1.5), at (5, 1.75) below the corner (5, 2), and likewise
        // (2.5, 1.5) - (0.5, 2.5). (3.5, 1.5) is dropped too.
        let first = points_of(&[[0.5, 2.5], [2.5, 1.5], [4.5, 1.5], [6.5, 2.5]]);
        assert_eq!(run(1, 1), first);
        // Pass 2 finds (6.5, 2.5) - (2.5, 1.5) at (5, 2.125), in an expanded cell, and likewise
        // from (4.5, 1.5) to the start.
        assert_eq!(run(2, 1), first);
        assert_eq!(run(2, 0), points_of(&[[0.5, 2.5], [2.5, 1.5], [6.5, 2.5]]));
        assert_eq!(run(9, 0), points_of(&[[0.5, 2.5], [6.5, 2.5]]), "y = 2.5, 0.5 m below it");
        assert_eq!(run(0, 1).len(), 4, "only collinear points are merged");
        // A second run of one pass is a second pass.
        let again = ShortcutConfig { passes: 1, expansion_cells: 0 };
        let once = Polyline::new(run(1, 0));
        let twice = smooth(&again, &once, &clearance, 0.0).path.flattened(0.0);
        assert_eq!((once.points().len(), twice.points()), (4, &run(2, 0)[..]));
        let published = PublishedConstraints { expansion_cells: 3, ..PublishedConstraints::NONE };
        let layers = LayerConfig { published, ..LayerConfig::default() };
        assert_eq!(
            ShortcutConfig::for_layers(&layers),
            ShortcutConfig { passes: 2, expansion_cells: 3 }
        );
    }

    #[test]
    fn a_line_through_expanded_cells_stays_and_is_reported() {
        let grid = OccupancyGrid::from_ascii(&["..#..", ".....", "....."]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let line = Polyline::new(points_of(&[[0.5, 0.5], [1.5, 1.5], [2.5, 1.5], [3.5, 0.5]]));
        let done = smooth(&ShortcutConfig::PAPER, &line, &clearance, 0.0);
        // (3.5, 0.5) - (1.5, 1.5) and (2.5, 1.5) - (0.5, 0.5) enter the expanded cells, from (1,
        // 1).
        assert_eq!(done.path, (&line).into());
        assert_eq!(done.kept_clearance_m, Some(0.5));
        // The expansion is in cells, whatever their size.
        let frame =
            crate::map::GridFrame::new(5, 3, 0.1, crate::geometry::Pose::default()).unwrap();
        let small = Clearance::new(&frame, grid.occupied());
        let shrunk = line.points().iter().map(|&at| at * 0.1).collect();
        let done = smooth(&ShortcutConfig::PAPER, &Polyline::new(shrunk), &small, 0.0);
        assert!(
            done.kept_clearance_m.is_some_and(|kept_m| (kept_m - 0.05).abs() < 1e-9),
            "{done:?}"
        );
        let far = Polyline::new(points_of(&[[0.05, 0.05], [0.45, 0.05]]));
        assert_eq!(
            smooth(&ShortcutConfig::PAPER, &far, &small, 0.0).kept_clearance_m,
            None,
            "1.5 cells away"
        );
        // The required clearance applies as well: (0.5, 0.5) - (4.5, 2.5) is at 1.75 below the
        // corner (3, 2), 0.25 cos(26.6 degrees) = 0.224 m from it.
        let line = Polyline::new(points_of(&[[0.5, 0.5], [2.5, 0.5], [4.5, 2.5]]));
        let none = ShortcutConfig { passes: 1, expansion_cells: 0 };
        assert_eq!(smooth(&none, &line, &clearance, 0.2).path.pieces().len(), 1);
        assert_eq!(smooth(&none, &line, &clearance, 0.3).path.pieces().len(), 2);
    }
}
