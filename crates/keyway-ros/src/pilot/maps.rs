//! Maps from messages and files, and the robot's costmaps.

use super::Pilot;
use crate::costmaps::{Known, Shown};
use crate::messages::map_msgs::OccupancyGridUpdate;
use crate::messages::nav_msgs::OccupancyGrid;
use crate::messages::nav2_msgs::services::Costmap;
use keyway::geometry::Point;
use keyway::map::formats::{MapFileError, read_map};
use keyway::map::{Cell, CellState, Edit, GridFrame};
use keyway::navigate::{NavigateError, Navigator};
use std::path::PathBuf;
use thiserror::Error;

/// Error of an invalid map.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum MapError {
    #[error("a map of {width} x {height} cells has {values} values")]
    Count { width: u32, height: u32, values: usize },
    #[error("the origin of the map is not a valid pose")]
    Origin,
    #[error("{0}")]
    Frame(String),
    #[error(transparent)]
    Navigate(#[from] NavigateError),
}

/// Error of a map that cannot be loaded.
#[derive(Debug, Error)]
pub(crate) enum UrlError {
    #[error("there is no map at {0}")]
    Missing(String),
    #[error(transparent)]
    File(#[from] MapFileError),
    #[error(transparent)]
    Map(#[from] MapError),
}

impl Pilot {
    /// Replaces the map. If the new one is invalid, the old one is kept.
    pub(crate) fn take_map(&mut self, message: &OccupancyGrid) -> Result<(), MapError> {
        self.check_frame(&message.header.frame_id)?;
        let map = map_of(message)?;
        self.drive_on(&map)
    }

    /// Refuses grids in another frame than the map frame. An empty frame name is accepted.
    pub(super) fn check_frame(&self, own: &str) -> Result<(), MapError> {
        let frame = self.settings.frames.map.trim_start_matches('/');
        let own = own.trim_start_matches('/');
        if own.is_empty() || own == frame {
            return Ok(());
        }
        Err(MapError::Frame(format!(
            "its frame is `{own}`, but the parameter `global_frame` is `{frame}`"
        )))
    }

    fn drive_on(&mut self, map: &keyway::OccupancyGrid) -> Result<(), MapError> {
        if let Some(navigator) = &mut self.navigator {
            return Ok(navigator.set_map(map)?);
        }
        self.navigator = Some(Navigator::new(map, &self.settings.stack)?);
        self.set_masks();
        Ok(())
    }

    /// Applies a changed rectangle of the map. One that came before the map is already part of
    /// it.
    pub(crate) fn take_update(&mut self, update: &OccupancyGridUpdate) -> Result<(), MapError> {
        let &OccupancyGridUpdate { x, y, width, height, ref data, .. } = update;
        if u64::from(width) * u64::from(height) != data.len() as u64 {
            return Err(MapError::Count { width, height, values: data.len() });
        }
        self.check_frame(&update.header.frame_id)?;
        let Some(navigator) = &mut self.navigator else { return Ok(()) };
        let map = navigator.map();
        let cells = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let edit = |(&value, (column, row)): (&i8, (u32, u32))| {
            let along = |from: i32, steps: u32| from.checked_add_unsigned(steps);
            let cell = Cell::new(along(x, column)?, along(y, row)?);
            let state = state_of(value);
            // Most cells of an update are unchanged.
            map.state(cell).filter(|&before| before != state).map(|_| Edit { cell, state })
        };
        let edits: Vec<Edit> = data.iter().zip(cells).filter_map(edit).collect();
        if !edits.is_empty() {
            navigator.edit_map(&edits);
        }
        Ok(())
    }

    /// Loads a map from a file and returns its message, without cells if there are too many.
    pub(crate) fn load_map(&mut self, url: &str, now_s: f64) -> Result<OccupancyGrid, UrlError> {
        let path = PathBuf::from(url.strip_prefix("file://").unwrap_or(url));
        if !path.exists() {
            return Err(UrlError::Missing(url.to_owned()));
        }
        let map = read_map(&path, None)?.grid;
        self.drive_on(&map)?;
        let mut message = OccupancyGrid::of(&map, self.header(now_s));
        // A larger answer may never arrive: omit the cells.
        if message.data.len() > Shown::MOST_BYTES {
            message.data = Vec::new();
        }
        Ok(message)
    }

    /// Clears all sensed obstacles.
    pub(crate) fn forget_sensed(&mut self) {
        if let Some(navigator) = &mut self.navigator {
            navigator.forget_sensed();
        }
    }

    /// Nav2 costs of the map and the sensed obstacles; `None` before there is a map. The robot
    /// does not plan with them.
    pub(crate) fn costmap(&self, shown: Shown, now_s: f64) -> Option<Costmap> {
        let navigator = self.navigator.as_ref()?;
        let frame = navigator.map().frame();
        let middle = Point::new(0.5 * f64::from(frame.width()), 0.5 * f64::from(frame.height()));
        let place = self.pose.map_or_else(|| frame.world_from_grid(middle), |pose| pose.point());
        let known = Known::of(navigator);
        Some(known.costs(known.window(shown, place))?.costmap(self.header(now_s)))
    }
}

/// Converts the values of a message to a map.
fn map_of(message: &OccupancyGrid) -> Result<keyway::OccupancyGrid, MapError> {
    let mut values = message.data.iter();
    Ok(keyway::OccupancyGrid::from_fn(frame_of(message)?, |_| {
        values.next().map_or(CellState::Unknown, |&value| state_of(value))
    }))
}

/// The frame of a message's grid. The number of values must match that of the cells.
pub(super) fn frame_of(message: &OccupancyGrid) -> Result<GridFrame, MapError> {
    let info = &message.info;
    let (width, height) = (info.width, info.height);
    let values = message.data.len();
    if u64::from(width) * u64::from(height) != values as u64 {
        return Err(MapError::Count { width, height, values });
    }
    let origin = info.origin.on_ground().ok_or(MapError::Origin)?;
    // 0.05 in single precision is not exactly 0.05; cell sizes are rounded to micrometres.
    let resolution_m = (f64::from(info.resolution) * 1e6).round() / 1e6;
    GridFrame::new(u64::from(width), u64::from(height), resolution_m, origin)
        .map_err(|error| MapError::Frame(error.to_string()))
}

/// 65 and more is occupied, as for map servers; negative values are unknown.
const fn state_of(value: i8) -> CellState {
    const OCCUPIED: i8 = 65;
    match value {
        OCCUPIED.. => CellState::Occupied,
        0.. => CellState::Free,
        _ => CellState::Unknown,
    }
}
