//! The evaluation of a node: equations (1) and (3) to (5).

use super::{Correction, HstaConfig, Weight, WeightAt};
use crate::map::{Cell, CellIndex, SearchMap};
use crate::search::{Euclidean, GridStep, Metric, Rule};

/// The terms of f, and the unit of distances in k.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    weight: Weight,
    weight_at: WeightAt,
    correction: Correction,
    cells_per_unit: f64,
    /// l + m, in the unit of the distances.
    sides: f64,
}

/// The rule by which one side expands its current node: its root, its goal, and the current node
/// of the other side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evaluation<'m> {
    pub(super) map: &'m SearchMap,
    pub(super) terms: Terms,
    /// first1, the root of this side.
    pub(super) first: Cell,
    /// goal1, the root of the other side.
    pub(super) goal: Cell,
    /// The current node of this side.
    pub(super) own: Cell,
    /// x2, the current node of the other side.
    pub(super) other: Cell,
}

impl Terms {
    pub(super) fn new(config: &HstaConfig, map: &SearchMap) -> Self {
        let cells_per_unit = config.cells_per_unit(map);
        let (l, m) = (f64::from(map.frame().width()), f64::from(map.frame().height()));
        let HstaConfig { weight, weight_at, correction, .. } = *config;
        Self { weight, weight_at, correction, cells_per_unit, sides: (l + m) / cells_per_unit }
    }
}

impl Rule for Evaluation<'_> {
    fn value(&self, g: u64, step: GridStep) -> u64 {
        g + step.cost
    }

    /// Eq. (1): f = g + k h + c.
    ///
    /// Upper bounds: on a map of n x n cells, taken literally, k is at most 1 + (2 n)^2 / (4 * 2
    /// n) = 1 + n / 2 and h at most 1.42 n cells of 2^26.5 each. For n = 16384 that is 2^13 *
    /// 2^14.5 * 2^26.5 = 2^54; g is below 2^55 without penalties, as no path has more than n^2 =
    /// 2^28 steps. Long thin maps and tiny reference cells may exceed 2^64: f then saturates, and
    /// ties decide the order.
    fn key(&self, at: CellIndex, g: u64) -> u64 {
        let at = self.map.cell(at);
        // Eq. (4).
        let h = straight_line(at, self.other);
        let weighted = match self.terms.weight {
            Weight::Dynamic => {
                let x1 = if self.terms.weight_at == WeightAt::Node { at } else { self.own };
                (self.weight(x1) * h as f64) as u64
            }
            Weight::One => h,
        };
        // Eq. (5).
        let c = match self.terms.correction {
            Correction::Distance => straight_line(at, self.goal),
            Correction::None => 0,
        };
        g.saturating_add(weighted).saturating_add(c)
    }
}

impl Evaluation<'_> {
    fn weight(&self, at: Cell) -> f64 {
        let (dx, dy) = (at.x.abs_diff(self.first.x), at.y.abs_diff(self.first.y));
        let from_first = (f64::from(dx) + f64::from(dy)) / self.terms.cells_per_unit;
        dynamic_weight(from_first, self.terms.sides)
    }
}

/// Eq. (3): k = 1 + |x - first|_1^2 / (4 (l + m)), from that distance and from l + m.
fn dynamic_weight(from_first: f64, sides: f64) -> f64 {
    1.0 + from_first * from_first / (4.0 * sides)
}

/// The straight line between two cells, as a [`crate::search::Cost::key`].
fn straight_line(a: Cell, b: Cell) -> u64 {
    Euclidean.length(a.x.abs_diff(b.x), a.y.abs_diff(b.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{GridFrame, LayerConfig, OccupancyGrid};
    use crate::plan::hsta::DistanceUnit;
    use crate::search::Cost;

    const Q: u64 = Cost::KEY_STRAIGHT;

    fn free_map(width: u64, height: u64, resolution_m: f64) -> SearchMap {
        let frame = GridFrame::new(width, height, resolution_m, Pose::default()).unwrap();
        SearchMap::new(&OccupancyGrid::all_free(frame), LayerConfig::default()).unwrap()
    }

    fn rule<'m>(map: &'m SearchMap, config: &HstaConfig) -> Evaluation<'m> {
        let (first, goal) = (Cell::new(0, 0), Cell::new(6, 11));
        let (own, other) = (Cell::new(2, 4), Cell::new(9, 7));
        Evaluation { map, terms: Terms::new(config, map), first, goal, own, other }
    }

    #[test]
    fn weights_by_hand() {
        assert_eq!(dynamic_weight(0.0, 84.0), 1.0);
        // The paper's map, 42 x 42, from corner to corner: 82^2 = 6724, 4 * 84 = 336.
        assert_eq!(dynamic_weight(42.0, 84.0), 6.25);
        assert!((dynamic_weight(82.0, 84.0) - 21.011_904_76).abs() < 1e-8);
    }

    /// Eq. (4), h, to (9, 7): 6 columns and 4 rows from (3, 3) are sqrt(52) = 7.211; 3 and 4 from
    /// (6, 3) are 5. Eq. (5), c, to (6, 11): 8 rows from (6, 3) are 8.
    #[test]
    fn distances_by_hand() {
        let (other, goal) = (Cell::new(9, 7), Cell::new(6, 11));
        let cells = |from, to| straight_line(from, to) as f64 / Q as f64;
        assert!((cells(Cell::new(3, 3), other) - 7.211).abs() < 1e-3);
        assert_eq!(straight_line(Cell::new(6, 3), other), 5 * Q);
        assert_eq!(straight_line(Cell::new(6, 3), goal), 8 * Q);
    }

    /// From (0, 0) to (3, 3) with g = 3 p; other (9, 7): dx 6, dy 4; goal (6, 11): dx 3, dy 8.
    #[test]
    fn f_by_hand() {
        let map = free_map(12, 12, 1.0);
        let at = map.index(Cell::new(6, 3));
        let g = Cost::new(3, 3).key();
        // h: dx 3, dy 4, so 5. c: dx 0, dy 8, so 8. k: (6 + 3)^2 / (4 * 24) = 81 / 96 = 0.84375.
        let key = |config: HstaConfig| rule(&map, &config).key(at, g);
        let exact = |cells: f64| g + (cells * Q as f64) as u64;
        assert_eq!(key(HstaConfig::PAPER), exact(1.84375 * 5.0 + 8.0));
        // k of the current node, (2, 4): 6^2 / 96 = 0.375.
        let weight_at = WeightAt::Current;
        assert_eq!(key(HstaConfig { weight_at, ..HstaConfig::PAPER }), exact(1.375 * 5.0 + 8.0));
        let weight = Weight::One;
        assert_eq!(key(HstaConfig { weight, ..HstaConfig::PAPER }), g + 13 * Q);
        let correction = Correction::None;
        assert_eq!(key(HstaConfig { weight, correction, ..HstaConfig::PAPER }), g + 5 * Q);
    }

    /// Twice as many cells per metre: distances in reference cells stay the same, those in cells
    /// double.
    #[test]
    fn the_weight_does_not_depend_on_the_resolution() {
        let (coarse, fine) = (free_map(12, 12, 1.0), free_map(24, 24, 0.5));
        let config = HstaConfig::PAPER;
        let weight = rule(&coarse, &config).weight(Cell::new(6, 3));
        assert_eq!(weight, 1.84375);
        assert_eq!(rule(&fine, &config).weight(Cell::new(12, 6)), weight);
        // 18^2 / (4 * 48) = 1.6875.
        let literal = HstaConfig { distances: DistanceUnit::Cells, ..config };
        assert_eq!(rule(&fine, &literal).weight(Cell::new(12, 6)), 2.6875);
    }

    #[test]
    fn large_values_saturate() {
        let map = free_map(3_000_000, 1, 1.0);
        let config = HstaConfig { reference_cell_m: 1e-9, ..HstaConfig::PAPER };
        let rule = rule(&map, &config);
        assert_eq!(rule.key(map.index(Cell::new(2_999_999, 0)), 7), u64::MAX);
    }
}
