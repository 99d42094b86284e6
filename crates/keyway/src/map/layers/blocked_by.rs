//! Reasons why a cell is blocked.

use crate::given::Computed;
use crate::map::{Cell, Hindrance, SearchMap};

/// Reason why no path may visit a cell. If several reasons hold, the first of these is reported.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BlockedBy {
    /// It is an obstacle cell.
    Obstacle,
    /// It is unknown, and unknown cells are obstacles ([`crate::map::UnknownPolicy::Blocked`]).
    Unknown,
    /// Its centre is nearer to an obstacle, or to the border of the map, than the clearance.
    Clearance {
        /// [`crate::map::LayerConfig::clearance_m`] \[m\].
        radius_m: f64,
        /// The obstacle or border nearest to its centre.
        nearest: Hindrance,
    },
    /// It is in the expanded zone of an obstacle.
    Expansion {
        /// [`crate::map::PublishedConstraints::expansion_cells`].
        cells: u32,
    },
    /// It is nearer to an obstacle than the constraint allows.
    Constraint {
        /// [`crate::map::PublishedConstraints::l1_constraint`], in reference cells.
        distance: f64,
    },
}

/// The reason as a clause after the cell's name: "is inside an obstacle".
impl std::fmt::Display for BlockedBy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Obstacle => f.write_str("is inside an obstacle"),
            Self::Unknown => f.write_str("is in unknown space, which counts as an obstacle"),
            Self::Clearance { radius_m, nearest } => {
                let radius_m = Computed(*radius_m);
                write!(
                    f,
                    "has too little clearance for a radius of {radius_m} m: measured from \
                           its centre, {nearest}"
                )
            }
            Self::Expansion { cells } => write!(
                f,
                "is free, but in the expanded zone of an obstacle (map.published.expansion_cells is {cells})"
            ),
            Self::Constraint { distance } => write!(
                f,
                "is free, but closer to an obstacle than the constraint allows \
                 (map.published.l1_constraint is {distance})"
            ),
        }
    }
}

impl SearchMap {
    /// Reason why a cell of the map is blocked; `None` for a free one. Cells outside the map
    /// count as obstacles.
    pub fn blocked_by(&self, cell: Cell) -> Option<BlockedBy> {
        if self.is_free(cell) {
            return None;
        }
        if self.obstacles().get(cell) || !self.frame().contains(cell) {
            let is_unknown = self.unknown().get(cell);
            return Some(if is_unknown { BlockedBy::Unknown } else { BlockedBy::Obstacle });
        }
        let (config, obstacles) = (self.config(), self.obstacles());
        let zones = &self.neighbourhoods;
        Some(if self.near_border(cell) || zones.clearance.is_blocked(cell, obstacles) {
            let nearest = self.hindrance(self.frame().world_from_cell(cell));
            BlockedBy::Clearance { radius_m: config.clearance_m, nearest }
        } else if zones.expansion.is_blocked(cell, obstacles) {
            BlockedBy::Expansion { cells: config.published.expansion_cells }
        } else {
            BlockedBy::Constraint { distance: config.published.l1_constraint }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid, PublishedConstraints};

    /// The obstacle is in column 0. Clearance 0.6 reaches column 1 (its centre is 0.5 from the
    /// square), expansion 2 reaches column 2, the constraint 4 reaches column 3. With the clearance
    /// the last column is too near to the border.
    #[test]
    fn each_reason_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["......", "......", "#.....", "......", "......"]);
        let config = LayerConfig {
            clearance_m: 0.6,
            published: PublishedConstraints {
                expansion_cells: 2,
                l1_constraint: 4.0,
                ..PublishedConstraints::NONE
            },
            ..LayerConfig::default()
        };
        let map = SearchMap::new(&grid, config).unwrap();
        let reasons = (0..6).map(|x| map.blocked_by(Cell::new(x, 2))).collect::<Vec<_>>();
        let clearance = |nearest| Some(BlockedBy::Clearance { radius_m: 0.6, nearest });
        let near = clearance(Hindrance::Obstacle { distance_m: 0.5 });
        let border = clearance(Hindrance::Border { distance_m: 0.5 });
        let expansion = Some(BlockedBy::Expansion { cells: 2 });
        let constraint = Some(BlockedBy::Constraint { distance: 4.0 });
        assert_eq!(reasons, [Some(BlockedBy::Obstacle), near, expansion, constraint, None, border]);
        assert_eq!(map.blocked_by(Cell::new(-1, 0)), Some(BlockedBy::Obstacle));
    }

    #[test]
    fn unknown_space_is_told_from_obstacles() {
        let grid = OccupancyGrid::from_ascii(&[".....", "...?.", "....."]);
        let config = LayerConfig { clearance_m: 0.5, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        assert_eq!(map.blocked_by(Cell::new(3, 1)), Some(BlockedBy::Unknown));
        let config = LayerConfig { clearance_m: 0.6, ..LayerConfig::default() };
        let map = SearchMap::new(&grid, config).unwrap();
        let why = map.blocked_by(Cell::new(2, 1)).unwrap();
        let nearest = Hindrance::Unknown { distance_m: 0.5 };
        assert_eq!(why, BlockedBy::Clearance { radius_m: 0.6, nearest });
        let text = "has too little clearance for a radius of 0.6 m: measured from its centre, unknown space, which counts \
                    as an obstacle, is 0.500 m away";
        assert_eq!(why.to_string(), text);
    }
}
