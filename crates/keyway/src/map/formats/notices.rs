//! Notices to the user about a map that was read or written, other than errors.

use super::rule::Doubts;
use super::{CellRule, MapFormat, MapMode, RosMap};
use crate::geometry::{Pose, degrees};
use crate::map::{OccupancyError, OccupancyGrid};
use std::fmt;
use std::path::{Path, PathBuf};

/// A property of a map file that is allowed, but usually a mistake.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MapWarning {
    /// `free_thresh` is above `occupied_thresh`: no cell is unknown, and values that satisfy both
    /// are occupied.
    Thresholds {
        /// The YAML file.
        path: PathBuf,
        /// `occupied_thresh` of the file.
        occupied_thresh: f64,
        /// `free_thresh` of the file.
        free_thresh: f64,
    },
    /// A raw image in which no value comes near to occupied, although not all are 0: usually a
    /// mask of 0 and 1.
    Mask {
        /// The YAML file.
        path: PathBuf,
        /// Its largest occupancy, of 100.
        largest: u8,
    },
    /// A field that is missing in the YAML file and takes its usual value.
    Assumed {
        /// The YAML file.
        path: PathBuf,
        /// The field.
        field: &'static str,
    },
    /// Cells with the grey of unknown cells in map savers are free, because `free_thresh` is
    /// higher.
    UnknownBelowThreshold {
        /// The YAML file.
        path: PathBuf,
        /// Number of these cells.
        cells: u64,
        /// `free_thresh` of the file.
        free_thresh: f64,
    },
    /// Such cells are free, because the image has an alpha channel: opaque alpha counts as a
    /// bright colour.
    UnknownBelowAlpha {
        /// The image.
        path: PathBuf,
        /// Number of these cells.
        cells: u64,
    },
    /// An image format that preserves greys only approximately.
    Lossy {
        /// The image.
        path: PathBuf,
    },
    /// A MovingAI map with heights, of which only the terrain is kept.
    Heights {
        /// The file.
        path: PathBuf,
    },
    /// An image that was read without a placement: its cells of 1 m are seldom right.
    Resolution {
        /// The image.
        path: PathBuf,
    },
}

impl MapWarning {
    pub(super) fn of_raw_values(path: &Path, map: &RosMap, grid: &OccupancyGrid) -> Option<Self> {
        let values = grid.values().filter(|_| map.rule.mode == MapMode::Raw)?;
        match grid.thresholds()?.check(values) {
            Err(OccupancyError::Mask { largest }) => {
                Some(Self::Mask { path: path.to_owned(), largest })
            }
            _ => None,
        }
    }

    pub(super) fn of_ros_map(path: &Path, map: &RosMap) -> Vec<Self> {
        let assumed = map.assumed.iter();
        let assumed = assumed.map(|&field| Self::Assumed { path: path.to_owned(), field });
        let CellRule { occupied_thresh, free_thresh, .. } = map.rule;
        let are_swapped = free_thresh > occupied_thresh;
        let swapped = are_swapped.then(|| Self::Thresholds {
            path: path.to_owned(),
            occupied_thresh,
            free_thresh,
        });
        assumed.chain(swapped).collect()
    }

    /// Warnings about an image; `path` is the file that holds the rule.
    pub(super) fn of_image(
        path: &Path,
        image: &Path,
        (rule, found): (&CellRule, Doubts),
    ) -> impl Iterator<Item = Self> {
        let Doubts { by_threshold, by_opacity, is_lossy } = found;
        let threshold = (by_threshold > 0).then(|| Self::UnknownBelowThreshold {
            path: path.to_owned(),
            cells: by_threshold,
            free_thresh: rule.free_thresh,
        });
        let opacity = (by_opacity > 0)
            .then(|| Self::UnknownBelowAlpha { path: image.to_owned(), cells: by_opacity });
        let lossy = is_lossy.then(|| Self::Lossy { path: image.to_owned() });
        [threshold, opacity, lossy].into_iter().flatten()
    }
}

impl fmt::Display for MapWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Thresholds { path, occupied_thresh, free_thresh } => write!(
                f,
                "{}: `free_thresh` ({free_thresh}) is above `occupied_thresh` ({occupied_thresh}), \
                 so no cell is unknown; are they swapped?",
                path.display()
            ),
            Self::Mask { path, largest } => write!(
                f,
                "{}: the largest occupancy is {largest} of 100, so every cell is free; in mode raw \
                 an occupied cell has 100",
                path.display()
            ),
            Self::Assumed { path, field } => {
                let usual = CellRule::IMAGE;
                let value = match *field {
                    "occupied_thresh" => usual.occupied_thresh,
                    "free_thresh" => usual.free_thresh,
                    _ => f64::from(u8::from(usual.negate)),
                };
                let path = path.display();
                write!(
                    f,
                    "{path}: the field `{field}` is missing; {value} is assumed, as map savers write it"
                )
            }
            Self::UnknownBelowThreshold { path, cells, free_thresh } => write!(
                f,
                "{}: {cells} cells with the grey value of unknown cells (205 in saved maps) are \
                 read as free, because `free_thresh` is {free_thresh}; with 0.196 they are unknown",
                path.display()
            ),
            Self::UnknownBelowAlpha { path, cells } => write!(
                f,
                "{}: {cells} cells with the grey value of unknown cells (205 in saved maps) are \
                 read as free, because an opaque alpha channel counts as a bright colour, as in \
                 the map server; save the image without it",
                path.display()
            ),
            Self::Lossy { path } => write!(
                f,
                "{}: JPEG does not preserve grey values exactly, so unknown cells may be read as \
                 free or occupied; export the original as PNG",
                path.display()
            ),
            Self::Heights { path } => write!(
                f,
                "{}: heights of a map of type octile-corner are ignored, so paths across steps in \
                 the terrain count as free",
                path.display()
            ),
            Self::Resolution { path } => write!(
                f,
                "{}: an image does not contain its resolution, so cells of 1 m are assumed",
                path.display()
            ),
        }
    }
}

/// A property of a map that a file format does not keep.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MapLoss {
    /// Side of a cell \[m\]; such files are read with cells of 1 m.
    Resolution(f64),
    /// Pose of the lower-left corner; such files are read with it at (0, 0).
    Origin(Pose),
    /// Number of unknown cells that become occupied.
    Unknown(u64),
    /// Number of cells with an occupancy between 0 and 100, of which only the state is kept.
    Values(u64),
}

impl MapLoss {
    /// All properties of a map that a file of this format does not keep.
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
            Self::Resolution(side_m) => write!(f, "the resolution of {side_m} m is not kept"),
            Self::Origin(Pose { x, y, theta }) => {
                write!(f, "the origin ({x}, {y}) m, {} deg is not kept", degrees(*theta))
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
