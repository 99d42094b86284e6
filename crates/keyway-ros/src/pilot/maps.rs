//! Maps: from messages and files, and what the robot knows as a costmap.

use super::Pilot;
use crate::messages::builtin_interfaces::Time;
use crate::messages::nav_msgs::{MapMetaData, OccupancyGrid};
use crate::messages::nav2_msgs::services::{Costmap, CostmapMetaData};
use crate::messages::std_msgs::Header;
use keyway::map::formats::{MapFileError, read_map};
use keyway::map::{self, Cell, CellState, CostmapConfig, Edit, GridFrame};
use keyway::navigate::{NavigateError, Navigator};
use std::path::PathBuf;
use thiserror::Error;

/// A map that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum MapError {
    #[error("a map of {width} x {height} cells has {values} values")]
    Count { width: u32, height: u32, values: usize },
    #[error("the origin of the map is no pose")]
    Origin,
    #[error("{0}")]
    Frame(String),
    #[error(transparent)]
    Navigate(#[from] NavigateError),
}

/// A map that cannot be loaded.
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
    /// Takes in a map, in the place of the last one. Where it cannot be used, that one stays.
    pub(crate) fn take_map(&mut self, message: &OccupancyGrid) -> Result<(), MapError> {
        let map = map_of(message)?;
        self.drive_on(&map)
    }

    fn drive_on(&mut self, map: &keyway::OccupancyGrid) -> Result<(), MapError> {
        match &mut self.navigator {
            Some(navigator) => navigator.set_map(map)?,
            None => self.navigator = Some(Navigator::new(map, &self.settings.stack)?),
        }
        Ok(())
    }

    /// Drives on the map of a file from now on; its message.
    pub(crate) fn load_map(&mut self, url: &str, now_s: f64) -> Result<OccupancyGrid, UrlError> {
        let path = PathBuf::from(url.strip_prefix("file://").unwrap_or(url));
        if !path.exists() {
            return Err(UrlError::Missing(url.to_owned()));
        }
        let map = read_map(&path, None)?.grid;
        self.drive_on(&map)?;
        Ok(self.message_of(&map, now_s))
    }

    fn message_of(&self, map: &keyway::OccupancyGrid, now_s: f64) -> OccupancyGrid {
        let frame = map.frame();
        let value = |cell| match map.state(cell) {
            Some(CellState::Free) => 0,
            Some(CellState::Occupied) => 100,
            _ => -1,
        };
        OccupancyGrid {
            header: Header::new(now_s, &self.settings.frames.map),
            info: MapMetaData {
                map_load_time: Time::of(now_s),
                resolution: frame.resolution_m() as f32,
                width: frame.width(),
                height: frame.height(),
                origin: frame.origin().into(),
            },
            data: frame.cells().map(value).collect(),
        }
    }

    /// Forgets all that was sensed.
    pub(crate) fn forget_sensed(&mut self) {
        if let Some(navigator) = &mut self.navigator {
            navigator.forget_sensed();
        }
    }

    /// Costs of Nav2 for all that is known and sensed; `None` before there is a map. The robot does not
    /// drive by them.
    pub(crate) fn costmap(&self, now_s: f64) -> Option<Costmap> {
        let navigator = self.navigator.as_ref()?;
        let mut map = navigator.map().clone();
        let occupied = |cell| Edit { cell, state: CellState::Occupied };
        let is_sensed = |cell: &Cell| navigator.sensed().get(*cell);
        let sensed: Vec<Edit> = map.frame().cells().filter(is_sensed).map(occupied).collect();
        map.apply(&sensed);
        let footprint = &self.settings.stack.robot().footprint;
        let (inscribed_radius_m, config) =
            (footprint.inscribed_radius_m(), CostmapConfig::default());
        let inflation_radius_m = config.inflation_radius_m.max(inscribed_radius_m);
        let config = CostmapConfig { inscribed_radius_m, inflation_radius_m, ..config };
        let costs = map::Costmap::new(&map, config).ok()?;
        let (frame, time) = (map.frame(), Time::of(now_s));
        let metadata = CostmapMetaData {
            map_load_time: time,
            update_time: time,
            layer: "master".to_owned(),
            resolution: frame.resolution_m() as f32,
            size_x: frame.width(),
            size_y: frame.height(),
            origin: frame.origin().into(),
        };
        let header = Header::new(now_s, &self.settings.frames.map);
        Some(Costmap { header, metadata, data: costs.costs().to_vec() })
    }
}

/// A map of values: 65 and more are occupied, as map servers have it; below 0 nothing is known.
fn map_of(message: &OccupancyGrid) -> Result<keyway::OccupancyGrid, MapError> {
    const OCCUPIED: i8 = 65;
    let info = &message.info;
    let (width, height) = (info.width, info.height);
    let values = message.data.len();
    if u64::from(width) * u64::from(height) != values as u64 {
        return Err(MapError::Count { width, height, values });
    }
    let origin = info.origin.on_ground().ok_or(MapError::Origin)?;
    // 0.05 in single precision is not 0.05; nobody makes cells of a part of a micrometre.
    let resolution_m = (f64::from(info.resolution) * 1e6).round() / 1e6;
    let frame = GridFrame::new(u64::from(width), u64::from(height), resolution_m, origin)
        .map_err(|error| MapError::Frame(error.to_string()))?;
    let mut values = message.data.iter();
    Ok(keyway::OccupancyGrid::from_fn(frame, |_| match values.next() {
        Some(&value) if value >= OCCUPIED => CellState::Occupied,
        Some(&value) if value >= 0 => CellState::Free,
        _ => CellState::Unknown,
    }))
}
