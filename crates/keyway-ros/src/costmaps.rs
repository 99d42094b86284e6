//! Costmaps for display: Nav2 costs of the robot's map and sensed obstacles. The robot does not
//! plan with them.

use crate::messages::nav_msgs::{MapMetaData, OccupancyGrid};
use crate::messages::nav2_msgs::services::{Costmap, CostmapMetaData};
use crate::messages::std_msgs::Header;
use keyway::geometry::{Point, Pose};
use keyway::map::{self, BitGrid, Cell, CellState, CellWindow, CostmapConfig, GridFrame};
use keyway::navigate::Navigator;

/// The displayed costmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// The surroundings of the robot.
    Local,
    /// The map, as far as it fits into one message.
    Global,
}

impl Shown {
    /// Maximum number of cells along a side.
    const MOST_CELLS: f64 = 400.0;

    /// Maximum message size. Larger messages do not fit into the default receive buffers (208 kB)
    /// of the receivers: they arrive seconds later, or never.
    pub(crate) const MOST_BYTES: usize = 160_000;

    /// Half the side length around the robot, along both axes \[m\].
    fn reach_m(self, resolution_m: f64) -> f64 {
        const LOCAL_M: f64 = 3.0;
        let most_m = 0.5 * (Self::MOST_CELLS - 1.0) * resolution_m;
        match self {
            Self::Local => most_m.min(LOCAL_M),
            Self::Global => most_m,
        }
    }
}

/// A copy of the robot's map and sensed obstacles.
pub(crate) struct Known {
    map: keyway::OccupancyGrid,
    sensed: BitGrid,
    inscribed_radius_m: f64,
}

/// The costs of a rectangle of cells.
pub(crate) struct Costs {
    frame: GridFrame,
    /// Row by row from the bottom.
    costs: Vec<u8>,
}

impl Known {
    /// Copies the state of a navigator.
    pub(crate) fn of(navigator: &Navigator) -> Self {
        Self {
            map: navigator.map().clone(),
            sensed: navigator.sensed().clone(),
            inscribed_radius_m: navigator.stack().robot().footprint.inscribed_radius_m(),
        }
    }

    /// The window of all cells.
    fn everything(&self) -> CellWindow {
        let frame = self.map.frame();
        let high = Cell::new(frame.width() as i32 - 1, frame.height() as i32 - 1);
        CellWindow { low: Cell::new(0, 0), high }
    }

    /// The window for a robot at a position.
    pub(crate) fn window(&self, shown: Shown, place: Point) -> CellWindow {
        let frame = self.map.frame();
        let reach_m = shown.reach_m(frame.resolution_m());
        let longer_m = f64::from(frame.width().max(frame.height())) * frame.resolution_m();
        if shown == Shown::Global && longer_m <= 2.0 * reach_m {
            return self.everything();
        }
        CellWindow::around(frame, place, reach_m)
    }

    /// Costs of a window, computed from its cells and those around it; `None` for an empty
    /// window.
    pub(crate) fn costs(&self, window: CellWindow) -> Option<Costs> {
        let config = CostmapConfig::default();
        let inflation_radius_m = config.inflation_radius_m.max(self.inscribed_radius_m);
        let inscribed_radius_m = self.inscribed_radius_m;
        let config = CostmapConfig { inscribed_radius_m, inflation_radius_m, ..config };
        let wider = self.wider(window, inflation_radius_m);
        let wide = keyway::OccupancyGrid::from_fn(self.frame(wider)?, |cell| {
            self.state(Cell::new(wider.low.x + cell.x, wider.low.y + cell.y))
        });
        let inflated = map::Costmap::new(&wide, config).ok()?;
        let cost = |cell: Cell| {
            let inner = Cell::new(cell.x - wider.low.x, cell.y - wider.low.y);
            inflated.cost(inner).unwrap_or(map::Costmap::UNKNOWN)
        };
        Some(Costs { frame: self.frame(window)?, costs: window.cells().map(cost).collect() })
    }

    fn state(&self, cell: Cell) -> CellState {
        if self.sensed.get(cell) {
            return CellState::Occupied;
        }
        self.map.state(cell).unwrap_or(CellState::Unknown)
    }

    /// The window extended on all sides.
    fn wider(&self, window: CellWindow, by_m: f64) -> CellWindow {
        let by = (by_m / self.map.frame().resolution_m()).ceil() as i32 + 1;
        let CellWindow { low, high } = window;
        let all = self.everything().high;
        CellWindow {
            low: Cell::new((low.x - by).max(0), (low.y - by).max(0)),
            high: Cell::new((high.x + by).min(all.x), (high.y + by).min(all.y)),
        }
    }

    /// The frame of a window.
    fn frame(&self, window: CellWindow) -> Option<GridFrame> {
        let CellWindow { low, high } = window;
        let frame = self.map.frame();
        let corner = frame.world_from_grid(Point::new(f64::from(low.x), f64::from(low.y)));
        let origin = Pose::new(corner.x, corner.y, frame.origin().theta);
        let count = |low: i32, high: i32| u64::try_from(i64::from(high) - i64::from(low) + 1);
        let (width, height) = (count(low.x, high.x).ok()?, count(low.y, high.y).ok()?);
        GridFrame::new(width, height, frame.resolution_m(), origin).ok()
    }
}

impl Costs {
    /// Converts them to costs, for services.
    pub(crate) fn costmap(self, header: Header) -> Costmap {
        let Self { frame, costs } = self;
        let metadata = CostmapMetaData {
            map_load_time: header.stamp,
            update_time: header.stamp,
            layer: "master".to_owned(),
            resolution: frame.resolution_m() as f32,
            size_x: frame.width(),
            size_y: frame.height(),
            origin: frame.origin().into(),
        };
        Costmap { header, metadata, data: costs }
    }

    /// Converts them to occupancies, for topics.
    pub(crate) fn grid(&self, header: Header) -> OccupancyGrid {
        let info = MapMetaData::of(&self.frame, header.stamp);
        OccupancyGrid { header, info, data: self.costs.iter().map(|&cost| shown(cost)).collect() }
    }
}

/// The occupancy value that Nav2 displays for a cost.
fn shown(cost: u8) -> i8 {
    const LARGEST: u16 = map::Costmap::INSCRIBED as u16 - 1;
    match cost {
        map::Costmap::FREE => 0,
        map::Costmap::INSCRIBED => 99,
        map::Costmap::LETHAL => 100,
        map::Costmap::UNKNOWN => -1,
        _ => (1 + 97 * (u16::from(cost) - 1) / (LARGEST - 1)) as i8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::Robot;
    use keyway::map::Edit;
    use keyway::navigate::Stack;

    /// A field of 10 m x 8 m with its origin at (-2, 1), with a post.
    fn field() -> Known {
        let robot = Robot::small();
        let frame = GridFrame::new(100, 80, 0.1, Pose::new(-2.0, 1.0, 0.0)).unwrap();
        let mut map = keyway::OccupancyGrid::all_free(frame);
        map.apply(&[Edit { cell: Cell::new(50, 40), state: CellState::Occupied }]);
        let stack = Stack::keyway(&robot).fit(&robot).unwrap();
        let mut known = Known::of(&Navigator::new(&map, &stack).unwrap());
        known.sensed.set(Cell::new(60, 40), true);
        known
    }

    /// Obstacles beside the window are included: the costs of a part equal those of the whole map
    /// there.
    #[test]
    fn a_part_is_a_part_of_the_whole() {
        let known = field();
        let whole = known.costs(known.everything()).unwrap();
        let window = CellWindow { low: Cell::new(52, 30), high: Cell::new(59, 99 - 20) };
        let part = known.costs(window).unwrap();
        assert_eq!((part.frame.width(), part.frame.height()), (8, 50));
        let origin = part.frame.origin();
        assert!((origin.x - 3.2).abs() < 1e-9 && (origin.y - 4.0).abs() < 1e-9, "{origin:?}");
        let same = window.cells().map(|cell| whole.costs[(cell.y * 100 + cell.x) as usize]);
        assert_eq!(part.costs, same.collect::<Vec<_>>());
        assert!(part.costs.iter().any(|&cost| cost > 0), "the posts beside it");
        assert_eq!(whole.costs[40 * 100 + 60], map::Costmap::LETHAL, "what was sensed");
    }

    #[test]
    fn costs_are_shown_as_nav2_shows_them() {
        let values = [0, 1, 126, 252, 253, 254, 255].map(shown);
        assert_eq!(values, [0, 1, 49, 98, 99, 100, -1]);
    }

    #[test]
    fn around_the_border_there_is_less() {
        let known = field();
        let local = |x| known.costs(known.window(Shown::Local, Point::new(x, 1.0)));
        let grid = local(-2.0).unwrap().grid(Header::new(1.0, "map"));
        assert_eq!((grid.info.width, grid.info.height, grid.data.len()), (31, 31, 961));
        assert!(local(-9.0).is_none(), "beside the map");
    }
}
