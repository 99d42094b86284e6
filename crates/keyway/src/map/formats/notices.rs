//! What a user should know of a map that was read or written, and that is not an error.

use super::{MapFormat, MapMode, RosMap};
use crate::geometry::{Pose, degrees};
use crate::map::{OccupancyError, OccupancyGrid};
use std::fmt;
use std::path::{Path, PathBuf};

/// Something in a map file that is allowed, and yet is usually a mistake.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MapWarning {
    /// `free_thresh` is above `occupied_thresh`: nothing is unknown, and what both claim is occupied.
    Thresholds {
        /// The YAML file.
        path: PathBuf,
        /// `occupied_thresh` of the file.
        occupied_thresh: f64,
        /// `free_thresh` of the file.
        free_thresh: f64,
    },
    /// A raw image in which no value comes near to occupied, although not all are 0: usually a mask of 0 and 1.
    Mask {
        /// The YAML file.
        path: PathBuf,
        /// Its largest occupancy, of 100.
        largest: u8,
    },
    /// An image that was read without a placement: cells of 1 m are seldom right.
    Resolution {
        /// The image.
        path: PathBuf,
    },
}

impl MapWarning {
    pub(super) fn of_ros_map(path: &Path, map: &RosMap) -> Option<Self> {
        let (occupied_thresh, free_thresh) = (map.rule.occupied_thresh, map.rule.free_thresh);
        (free_thresh > occupied_thresh).then(|| Self::Thresholds {
            path: path.to_owned(),
            occupied_thresh,
            free_thresh,
        })
    }

    pub(super) fn of_raw_values(path: &Path, map: &RosMap, grid: &OccupancyGrid) -> Option<Self> {
        let values = grid.values().filter(|_| map.rule.mode == MapMode::Raw)?;
        match grid.thresholds()?.check(values) {
            Err(OccupancyError::Mask { largest }) => {
                Some(Self::Mask { path: path.to_owned(), largest })
            }
            _ => None,
        }
    }
}

impl fmt::Display for MapWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Thresholds { path, occupied_thresh, free_thresh } => write!(
                f,
                "{}: `free_thresh` ({free_thresh}) is above `occupied_thresh` ({occupied_thresh}), so \
                 that no cell is unknown; are they swapped?",
                path.display()
            ),
            Self::Mask { path, largest } => write!(
                f,
                "{}: the largest occupancy is {largest} of 100, so that every cell is free; in mode raw an occupied cell \
                 has 100",
                path.display()
            ),
            Self::Resolution { path } => write!(
                f,
                "{}: an image does not say how large its cells are, so 1 m is assumed; set it with \
                 --resolution, or use the map's YAML file",
                path.display()
            ),
        }
    }
}

/// Something of a map that a file of some format does not keep.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MapLoss {
    /// Side of a cell \[m\]; such files are read with cells of 1 m.
    Resolution(f64),
    /// Where the lower-left corner lies; in such files at (0, 0).
    Origin(Pose),
    /// This many unknown cells become occupied.
    Unknown(u64),
    /// This many cells have an occupancy between 0 and 100, of which only the state is kept.
    Values(u64),
}

impl MapLoss {
    /// Everything of a map that a file of this format does not keep.
    pub fn of(grid: &OccupancyGrid, format: MapFormat) -> Vec<Self> {
        if format == MapFormat::Ros {
            return Vec::new();
        }
        let (frame, unknown) = (grid.frame(), grid.unknown().count_ones());
        let resolution_m = Some(frame.resolution_m()).filter(|&side| side != 1.0);
        let origin = Some(frame.origin()).filter(|&origin| origin != Pose::default());
        let unknown = Some(unknown).filter(|&count| count > 0 && format == MapFormat::MovingAi);
        let between = |value: &&u8| (1..100).contains(*value);
        let values = grid.values().map_or(0, |values| values.iter().filter(between).count() as u64);
        let values = Some(values).filter(|&count| count > 0);
        let losses = [
            resolution_m.map(Self::Resolution),
            origin.map(Self::Origin),
            unknown.map(Self::Unknown),
            values.map(Self::Values),
        ];
        losses.into_iter().flatten().collect()
    }
}

impl fmt::Display for MapLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Resolution(side_m) => write!(
                f,
                "the resolution of {side_m} m is not kept; read the file with --resolution {side_m}"
            ),
            Self::Origin(Pose { x, y, theta }) => {
                let yaw = degrees(*theta);
                write!(f, "the origin ({x}, {y}) m, {yaw} deg is not kept; ")?;
                write!(f, "read the file with --origin {x},{y},{yaw}")
            }
            Self::Unknown(1) => write!(f, "1 unknown cell became occupied"),
            Self::Unknown(count) => write!(f, "{count} unknown cells became occupied"),
            Self::Values(count) => {
                write!(f, "the occupancy values of {count} cells are not kept, only their states")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{GridFrame, OccupancyThresholds};

    #[test]
    fn what_each_format_loses() {
        let drawn = OccupancyGrid::from_ascii(&["#?.", "??."]);
        let formats = [MapFormat::Ros, MapFormat::MovingAi, MapFormat::Pgm, MapFormat::Png];
        let lost = |grid: &OccupancyGrid| formats.map(|format| MapLoss::of(grid, format));
        let none = Vec::new;
        assert_eq!(lost(&drawn), [none(), vec![MapLoss::Unknown(3)], none(), none()]);

        let origin = Pose::new(1.0, 2.0, 0.5);
        let frame = GridFrame::new(2, 2, 0.05, origin).unwrap();
        let grid = OccupancyGrid::from_values(
            frame,
            vec![0, 100, 10, 255],
            OccupancyThresholds::default(),
        )
        .unwrap();
        let [resolution, origin] = [MapLoss::Resolution(0.05), MapLoss::Origin(origin)];
        let image = vec![resolution.clone(), origin.clone(), MapLoss::Values(1)];
        let map = vec![resolution, origin, MapLoss::Unknown(1), MapLoss::Values(1)];
        assert_eq!(lost(&grid), [none(), map, image.clone(), image]);
    }
}
