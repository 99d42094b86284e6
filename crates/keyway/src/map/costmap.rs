//! A costmap as used in ROS: one byte per cell that decreases with the distance to the nearest
//! obstacle.
//!
//! # Source
//! The inflation layer of Nav2 (`nav2_costmap_2d`): parameter names, values and rounding follow
//! it. As there, distances run between the centres of cells.
//!
//! # Safe cells
//! A robot at the centre of a cell with cost 253 or 254 touches an obstacle, whatever its
//! heading; the converse does not hold. Distances run from centre to centre, so an obstacle's
//! square may be nearer by up to half of its diagonal (0.71 cells) than the cost suggests: a
//! round robot of the inscribed radius whose centre is on a cell below 253 may still touch a
//! corner of an obstacle. To rule that out, add half a diagonal to the inscribed radius, or plan
//! on a [`SearchMap`](super::SearchMap), whose clearance is measured to the squares. A footprint
//! that is not round needs a check at its heading in all cells up to its circumscribed radius
//! ([`Footprint::is_free`](super::Footprint::is_free)).
//!
//! # Use
//! Keyway's planners do not read it: they find shortest paths at a clearance. It is for programs
//! that use costmaps, such as Nav2's planners and controllers, and for display.
//!
//! # Differences from Nav2
//! - Nav2 finds the nearest obstacle by a wavefront that can miss it by a fraction of a cell;
//!   here the distance is exact.
//! - Nav2 only logs an inflation radius below the inscribed one, although cells that the robot
//!   cannot pass may then cost nothing; here it is an error.

use super::{
    BitGrid, Cell, CellWindow, DistanceField, DistanceTo, FieldConfig, GridFrame, OccupancyGrid,
};
use crate::ConfigError;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Parameters of a [`Costmap`], named as in Nav2's inflation layer (there without units).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct CostmapConfig {
    /// Radius of the largest disc around the robot's centre inside its footprint \[m\]: cells
    /// within this distance of an obstacle cost 253. Nav2 takes it from the footprint.
    #[serde(alias = "inscribed_radius")]
    pub inscribed_radius_m: f64,
    /// Distance beyond which cells cost nothing \[m\]; rounded up to whole cells. At least the
    /// inscribed radius: otherwise cells beside obstacles that the robot cannot pass would cost
    /// nothing.
    #[serde(alias = "inflation_radius")]
    pub inflation_radius_m: f64,
    /// Rate at which the cost decreases with the distance \[1/m\].
    pub cost_scaling_factor: f64,
    /// Unknown cells take the cost of any obstacle near them, not only costs of 253 and more.
    pub inflate_unknown: bool,
    /// Unknown cells count as obstacles.
    pub inflate_around_unknown: bool,
}

impl Default for CostmapConfig {
    /// The defaults of Nav2, and the inscribed radius of its default robot radius.
    fn default() -> Self {
        Self {
            inscribed_radius_m: 0.1,
            inflation_radius_m: 0.55,
            cost_scaling_factor: 10.0,
            inflate_unknown: false,
            inflate_around_unknown: false,
        }
    }
}

/// Costs of all cells, kept up to date by [`Self::update`].
///
/// Memory: 5 bytes and one bit per cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Costmap {
    config: CostmapConfig,
    field: DistanceField,
    /// Cost by squared distance in cells.
    cost_of_cells_sq: Vec<u8>,
    /// Costs of all cells, row by row from the bottom.
    costs: Vec<u8>,
}

impl Costmap {
    /// Cost of an obstacle.
    pub const LETHAL: u8 = 254;
    /// Cost of cells at which a robot's centre makes it touch an obstacle, whatever its heading.
    pub const INSCRIBED: u8 = 253;
    /// Cost of an unknown cell.
    pub const UNKNOWN: u8 = 255;
    /// Cost of a cell with no obstacle within the inflation radius.
    pub const FREE: u8 = 0;

    /// Creates the costmap of a map.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a number of the config is not usable; the error names its
    /// field.
    pub fn new(grid: &OccupancyGrid, config: CostmapConfig) -> Result<Self, ConfigError> {
        let frame = grid.frame();
        config.check(frame.resolution_m())?;
        let radius_cells = config.radius_cells(frame);
        let field_config = FieldConfig {
            to: DistanceTo::Centres,
            reach_m: f64::from(radius_cells + 1) * frame.resolution_m(),
            threads: None,
        };
        let mut costmap = Self {
            field: DistanceField::new(frame, &config.obstacles(grid), &field_config),
            cost_of_cells_sq: (0..=radius_cells * radius_cells)
                .map(|cells_sq| config.cost(f64::from(cells_sq).sqrt(), frame.resolution_m()))
                .collect(),
            costs: vec![0; frame.cell_count() as usize],
            config,
        };
        let high = Cell::new(frame.width() as i32 - 1, frame.height() as i32 - 1);
        costmap.recost(grid, &CellWindow { low: Cell::new(0, 0), high });
        Ok(costmap)
    }

    /// Copies the cells of a window from a map, and corrects every cost that they change.
    ///
    /// # Panics
    /// Panics if the map's size is not the one that the costmap was created for.
    pub fn update(&mut self, grid: &OccupancyGrid, window: CellWindow) {
        let changed = self.field.update(&self.config.obstacles(grid), window);
        self.recost(grid, &changed.map_or(window, |changed| changed.union(&window)));
    }

    /// Geometry of the costmap: size, resolution and origin.
    pub const fn frame(&self) -> &GridFrame {
        self.field.frame()
    }

    /// Costs of all cells, row by row from the bottom, as `nav2_costmap_2d` stores them.
    pub fn costs(&self) -> &[u8] {
        &self.costs
    }

    /// The cost of a cell; `None` outside the map.
    pub fn cost(&self, cell: Cell) -> Option<u8> {
        self.frame().contains(cell).then(|| self.costs[self.index(cell)])
    }

    const fn index(&self, cell: Cell) -> usize {
        cell.y as usize * self.frame().width() as usize + cell.x as usize
    }

    /// Writes the costs of a window, clipped to the map.
    fn recost(&mut self, grid: &OccupancyGrid, window: &CellWindow) {
        let (width, height) = (self.frame().width() as i32, self.frame().height() as i32);
        for y in window.low.y.max(0)..=window.high.y.min(height - 1) {
            for x in window.low.x.max(0)..=window.high.x.min(width - 1) {
                let cell = Cell::new(x, y);
                let inflated = self.inflated(cell);
                let cost = if grid.unknown().get(cell) {
                    self.config.cost_of_unknown(inflated)
                } else {
                    inflated
                };
                let index = self.index(cell);
                self.costs[index] = cost;
            }
        }
    }

    /// The cost from the distance alone.
    fn inflated(&self, cell: Cell) -> u8 {
        // Centres are whole cells apart, and 4 squared half cells are one squared cell.
        let cells_sq = self.field.half_cells_sq(cell).map_or(usize::MAX, |sq| sq as usize / 4);
        self.cost_of_cells_sq.get(cells_sq).copied().unwrap_or(Self::FREE)
    }
}

impl CostmapConfig {
    /// Largest allowed inflation \[cells\].
    const MAX_RADIUS_CELLS: f64 = 4096.0;

    fn check(&self, resolution_m: f64) -> Result<(), ConfigError> {
        let limit_m = Self::MAX_RADIUS_CELLS * resolution_m;
        let length = "a length of at least 0 and at most 4096 cells";
        let checks = [
            ("inscribed_radius_m", self.inscribed_radius_m, limit_m, length),
            ("inflation_radius_m", self.inflation_radius_m, limit_m, length),
            ("cost_scaling_factor", self.cost_scaling_factor, f64::MAX, "a number of at least 0"),
        ];
        if let Some((field, value, _, expected)) =
            checks.into_iter().find(|&(_, value, limit, _)| !(0.0..=limit).contains(&value))
        {
            return Err(ConfigError::must_be(field, expected, value));
        }
        if self.inflation_radius_m < self.inscribed_radius_m {
            let expected = "at least inscribed_radius_m: raise it, or cells that the robot cannot pass \
                            would cost nothing";
            let value = self.inflation_radius_m;
            return Err(ConfigError::must_be("inflation_radius_m", expected, value));
        }
        Ok(())
    }

    /// The inflation radius \[cells\], at most the largest distance between two cells of the map.
    fn radius_cells(&self, frame: &GridFrame) -> u32 {
        let farthest = libm::hypot(f64::from(frame.width()), f64::from(frame.height()));
        (self.inflation_radius_m / frame.resolution_m()).min(farthest).ceil() as u32
    }

    fn obstacles<'a>(&self, grid: &'a OccupancyGrid) -> Cow<'a, BitGrid> {
        let mut obstacles = Cow::Borrowed(grid.occupied());
        if self.inflate_around_unknown {
            obstacles.to_mut().merge(grid.unknown());
        }
        obstacles
    }

    /// The cost at a distance in cells: `computeCost` of Nav2.
    fn cost(&self, distance_cells: f64, resolution_m: f64) -> u8 {
        let distance_m = distance_cells * resolution_m;
        if distance_cells == 0.0 {
            Costmap::LETHAL
        } else if distance_m <= self.inscribed_radius_m {
            Costmap::INSCRIBED
        } else {
            let beyond_m = distance_m - self.inscribed_radius_m;
            let factor = libm::exp(-self.cost_scaling_factor * beyond_m);
            // Truncated, not rounded.
            (f64::from(Costmap::INSCRIBED - 1) * factor) as u8
        }
    }

    /// The cost of an unknown cell that would have the cost `inflated` if it were free.
    fn cost_of_unknown(&self, inflated: u8) -> u8 {
        let least = if self.inflate_unknown { Costmap::FREE + 1 } else { Costmap::INSCRIBED };
        if inflated >= least { inflated } else { Costmap::UNKNOWN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::map::{CellState, Edit};
    use proptest::prelude::*;

    fn one_metre() -> CostmapConfig {
        CostmapConfig {
            inscribed_radius_m: 1.0,
            inflation_radius_m: 3.0,
            cost_scaling_factor: 1.0,
            ..CostmapConfig::default()
        }
    }

    #[test]
    fn worked_costs() {
        // 252 exp(-(d - 1)): d = sqrt(2): 166.5; 2: 92.7; sqrt(5): 73.2; 3: 34.1; 4 is too far.
        let grid = OccupancyGrid::from_ascii(&[".....", "#...."]);
        let costmap = Costmap::new(&grid, one_metre()).unwrap();
        assert_eq!(costmap.costs(), [254, 253, 92, 34, 0, 253, 166, 73, 0, 0]);
        assert_eq!(costmap.cost(Cell::new(2, 1)), Some(73));
        assert_eq!(costmap.cost(Cell::new(5, 0)), None);
        // The same on cells of another size, with all lengths scaled likewise.
        for resolution_m in [0.5, 7.0] {
            let config = CostmapConfig {
                inscribed_radius_m: 1.01 * resolution_m,
                inflation_radius_m: 3.0 * resolution_m,
                cost_scaling_factor: 1.0 / resolution_m,
                ..CostmapConfig::default()
            };
            let frame = GridFrame::new(5, 2, resolution_m, Pose::default()).unwrap();
            let grid = OccupancyGrid::from_fn(frame, |cell| match (cell.x, cell.y) {
                (0, 0) => CellState::Occupied,
                _ => CellState::Free,
            });
            let costmap = Costmap::new(&grid, config).unwrap();
            // 252 exp(-(d - 1.01)).
            assert_eq!(costmap.costs(), [254, 253, 93, 34, 0, 253, 168, 73, 0, 0]);
        }
    }

    #[test]
    fn a_window_may_be_larger_than_the_map_and_than_what_has_changed() {
        let mut grid = OccupancyGrid::from_ascii(&["..............?", "..............."]);
        let mut costmap = Costmap::new(&grid, one_metre()).unwrap();
        grid.apply(&[
            Edit { cell: Cell::new(0, 0), state: CellState::Occupied },
            Edit { cell: Cell::new(14, 0), state: CellState::Unknown },
            Edit { cell: Cell::new(14, 1), state: CellState::Free },
        ]);
        let window = CellWindow { low: Cell::new(-3, -2), high: Cell::new(99, 98) };
        costmap.update(&grid, window);
        assert_eq!(costmap.costs()[..5], [254, 253, 92, 34, 0]);
        assert_eq!([0, 1].map(|y| costmap.cost(Cell::new(14, y))), [Some(255), Some(0)]);
        assert!(costmap == Costmap::new(&grid, one_metre()).unwrap());
    }

    #[test]
    fn unknown_cells() {
        let grid = OccupancyGrid::from_ascii(&["#??."]);
        let costs = |config| Costmap::new(&grid, config).unwrap().costs().to_vec();
        assert_eq!(costs(one_metre()), [254, 253, 255, 34]);
        let inflate_unknown = CostmapConfig { inflate_unknown: true, ..one_metre() };
        assert_eq!(costs(inflate_unknown.clone()), [254, 253, 92, 34]);
        let far = OccupancyGrid::from_ascii(&["#....?"]);
        let costs_of_far = Costmap::new(&far, inflate_unknown).unwrap().costs().to_vec();
        assert_eq!(costs_of_far, [254, 253, 92, 34, 0, 255], "no obstacle is near");
        let around = CostmapConfig { inflate_around_unknown: true, ..one_metre() };
        assert_eq!(costs(around), [254, 254, 254, 253]);
    }

    #[test]
    fn parameters_of_nav2_are_read_by_their_names() {
        let text = "inflation_radius = 0.7\ncost_scaling_factor = 3.0\ninflate_unknown = true";
        let config: CostmapConfig = toml::from_str(text).unwrap();
        let expected = (0.7, 3.0, true);
        assert_eq!(
            (config.inflation_radius_m, config.cost_scaling_factor, config.inflate_unknown),
            expected
        );
        let grid = OccupancyGrid::from_ascii(&["."]);
        let refused = |config| Costmap::new(&grid, config).unwrap_err().path;
        for value in [-0.1, 4097.0, f64::NAN] {
            let inflation = CostmapConfig { inflation_radius_m: value, ..config.clone() };
            assert_eq!(refused(inflation), "inflation_radius_m");
            let inscribed = CostmapConfig { inscribed_radius_m: value, ..config.clone() };
            assert_eq!(refused(inscribed), "inscribed_radius_m");
        }
        for cost_scaling_factor in [-0.1, f64::INFINITY, f64::NAN] {
            let scaling = CostmapConfig { cost_scaling_factor, ..config.clone() };
            assert_eq!(refused(scaling), "cost_scaling_factor");
        }
    }

    /// The cost table ends at the largest distance between two cells of the map.
    #[test]
    fn a_wide_inflation_costs_no_more_than_the_map() {
        let grid = OccupancyGrid::from_ascii(&["#..", "...", "..."]);
        let wide = CostmapConfig { inflation_radius_m: 4096.0, ..CostmapConfig::default() };
        let costmap = Costmap::new(&grid, wide.clone()).unwrap();
        assert!(costmap.cost_of_cells_sq.len() <= 26, "{}", costmap.cost_of_cells_sq.len());
        let farthest = costmap.cost(Cell::new(2, 0)).unwrap();
        assert_eq!(farthest, wide.cost(8_f64.sqrt(), 1.0));
    }

    #[test]
    fn an_inflation_that_does_not_reach_the_inscribed_radius_is_refused() {
        let grid = OccupancyGrid::from_ascii(&["#...."]);
        let of = |inflation_radius_m| CostmapConfig {
            inscribed_radius_m: 2.0,
            inflation_radius_m,
            ..CostmapConfig::default()
        };
        let refused = Costmap::new(&grid, of(1.0)).unwrap_err();
        assert_eq!(refused.path, "inflation_radius_m");
        assert!(refused.reason.ends_with(", got 1"), "{refused}");
        assert!(refused.to_string().contains("inscribed_radius_m: raise it"), "{refused}");
        assert_eq!(Costmap::new(&grid, of(2.0)).unwrap().costs(), [254, 253, 253, 0, 0]);
        // The default of Nav2 is for a small robot.
        let wide = CostmapConfig { inscribed_radius_m: 0.6, ..CostmapConfig::default() };
        assert!(Costmap::new(&grid, wide).is_err());
    }

    #[test]
    fn a_cell_below_253_may_still_touch_a_corner() {
        // The centre of (1, 1) is sqrt(2) m from that of the obstacle, and half a diagonal nearer
        // to it.
        let grid = OccupancyGrid::from_ascii(&["...", "...", "#.."]);
        let config = CostmapConfig {
            inscribed_radius_m: 1.4,
            inflation_radius_m: 2.0,
            ..CostmapConfig::default()
        };
        let costmap = Costmap::new(&grid, config).unwrap();
        let cell = Cell::new(1, 1);
        assert!(costmap.cost(cell).unwrap() < Costmap::INSCRIBED);
        let clearance = crate::map::Clearance::new(grid.frame(), grid.occupied());
        let kept_m = clearance.of_point(grid.frame().world_from_cell(cell), 9.0);
        assert!((kept_m - 0.5f64.sqrt()).abs() < 1e-12, "{kept_m}");
    }

    proptest! {
        #[test]
        fn agrees_with_the_formula_cell_by_cell(cells in prop::collection::vec(0..20u8, 12 * 9),
                                                inscribed_radius_m in 0.0..0.3f64, beyond_m in 0.0..0.4f64,
                                                cost_scaling_factor in 0.0..20.0f64) {
            let inflation_radius_m = inscribed_radius_m + beyond_m;
            let frame = GridFrame::new(12, 9, 0.05, Pose::default()).unwrap();
            let mut each = cells.iter();
            let grid = OccupancyGrid::from_fn(frame, |_| match each.next() {
                Some(0) => CellState::Occupied,
                Some(1) => CellState::Unknown,
                _ => CellState::Free,
            });
            let config = CostmapConfig {
                inscribed_radius_m, inflation_radius_m, cost_scaling_factor, ..CostmapConfig::default()
            };
            let mut costmap = Costmap::new(&grid, config.clone()).unwrap();
            let reach = (inflation_radius_m / 0.05).ceil();
            for cell in frame.cells() {
                let nearest = frame.cells().filter(|&other| grid.occupied().get(other))
                    .map(|other| f64::from((other.x - cell.x).pow(2) + (other.y - cell.y).pow(2)).sqrt())
                    .fold(f64::INFINITY, f64::min);
                let inflated = if nearest > reach { 0 } else { config.cost(nearest, 0.05) };
                let unknown = grid.unknown().get(cell) && inflated < 253;
                prop_assert_eq!(costmap.cost(cell), Some(if unknown { 255 } else { inflated }));
            }
            let mut grid = grid;
            grid.apply(&[Edit { cell: Cell::new(5, 5), state: CellState::Occupied },
                         Edit { cell: Cell::new(6, 3), state: CellState::Free }]);
            costmap.update(&grid, CellWindow { low: Cell::new(5, 3), high: Cell::new(6, 5) });
            prop_assert!(costmap == Costmap::new(&grid, config).unwrap());
        }
    }
}
