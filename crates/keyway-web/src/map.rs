//! The map of a page.

use crate::error::{Kind, PageError};
use crate::message::{Message, json};
use keyway::file_error::ReadError;
use keyway::geometry::Pose;
use keyway::map::formats::{ImagePlacement, LoadedMap, digest, map_from_bytes};
use keyway::map::{Cell, CellState, Edit, OccupancyGrid};
use keyway_sim::report::MapSource;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;

/// `{"ask": "open_map", "name", "resolution_m"}`: opens a map. The parts are its files by their
/// names: the one called `name`, and the image that it may name.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpenMap {
    /// The file of the map: `.yaml`, `.map`, `.png` or `.pgm`.
    pub name: String,
    /// Cell size \[m\], for a file that does not contain it.
    pub resolution_m: Option<f64>,
}

/// Facts about a map. The part `cells` of the answer has a byte for each cell, row by row from
/// the bottom: 0 free, 1 occupied, 2 unknown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapFacts {
    /// Its name.
    pub name: String,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Cell size \[m\].
    pub resolution_m: f64,
    /// Pose of the lower left corner, `[x_m, y_m, yaw_rad]`.
    pub origin: [f64; 3],
    /// Digest of the map, as in reports.
    pub digest: String,
    /// Warnings about its files.
    pub warnings: Vec<String>,
}

/// `{"ask": "edit_map", "cells": [[x, y], ..], "state": "occupied"}`: changes cells.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EditMap {
    /// Columns and rows from the lower left corner; cells outside the map are ignored.
    pub cells: Vec<(i32, i32)>,
    /// The new state of the cells.
    pub state: State,
}

/// The state of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Free.
    Free,
    /// Occupied.
    Occupied,
    /// Unknown.
    Unknown,
}

/// Result of an edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Edited {
    /// Number of changed cells.
    pub changed: usize,
}

/// An open map.
#[derive(Clone, Debug)]
pub(crate) struct Opened {
    pub(crate) grid: OccupancyGrid,
    pub(crate) source: MapSource,
}

impl Opened {
    /// Error of a question about a map if none is open.
    pub(crate) fn none() -> PageError {
        PageError::new(Kind::Usage, "no map is open; call `open_map` first").field("ask")
    }
}

impl From<LoadedMap> for Opened {
    fn from(loaded: LoadedMap) -> Self {
        Self { source: MapSource::from(&loaded), grid: loaded.grid }
    }
}

/// Reads a map from the parts of a message.
pub(crate) fn open(ask: &OpenMap, message: &Message) -> Result<(Opened, Message), PageError> {
    let (opened, warnings) = open_file(Path::new(&ask.name), ask.resolution_m, message)?;
    let answer = Message::new(json(&facts(&opened, warnings))).with("cells", cells_of(&opened));
    Ok((opened, answer))
}

/// Reads a map from the parts of a message, with warnings about its files.
pub(crate) fn open_file(
    name: &Path,
    resolution_m: Option<f64>,
    message: &Message,
) -> Result<(Opened, Vec<String>), PageError> {
    let blame = |error: &dyn std::fmt::Display| PageError::new(Kind::Input, error).field("name");
    let bytes = part(message, name).map_err(|error| blame(&error))?;
    let image = |name: &Path| part(message, name).map(<[u8]>::to_vec);
    let placement =
        resolution_m.map(|resolution_m| ImagePlacement { resolution_m, origin: Pose::default() });
    let loaded = map_from_bytes(name, bytes, image, placement).map_err(|error| blame(&error))?;
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    Ok((Opened::from(loaded), warnings))
}

/// The file with a name. A page knows files by their names alone, so folders in the name are
/// ignored.
pub(crate) fn part<'m>(message: &'m Message, name: &Path) -> Result<&'m [u8], ReadError> {
    let file = name.file_name().and_then(|name| name.to_str());
    let found = file.and_then(|file| message.part(file));
    let missing =
        || ReadError::System { path: name.to_owned(), reason: ErrorKind::NotFound.into() };
    found.ok_or_else(missing)
}

/// Collects the facts about a map.
pub(crate) fn facts(opened: &Opened, warnings: Vec<String>) -> MapFacts {
    let Opened { grid, source } = opened;
    let frame = grid.frame();
    let Pose { x, y, theta } = frame.origin();
    MapFacts {
        name: source.name.clone(),
        width: frame.width(),
        height: frame.height(),
        resolution_m: frame.resolution_m(),
        origin: [x, y, theta],
        digest: digest(grid),
        warnings,
    }
}

/// A byte for each cell ([`MapFacts`]).
pub(crate) fn cells_of(Opened { grid, .. }: &Opened) -> Vec<u8> {
    let state = |cell: Cell| match grid.state(cell) {
        Some(CellState::Occupied) => 1,
        Some(CellState::Unknown) => 2,
        Some(CellState::Free) | None => 0,
    };
    grid.frame().cells().map(state).collect()
}

/// Changes cells of the map.
pub(crate) fn edit(ask: &EditMap, opened: &mut Opened) -> (Edited, Vec<Edit>) {
    let state = match ask.state {
        State::Free => CellState::Free,
        State::Occupied => CellState::Occupied,
        State::Unknown => CellState::Unknown,
    };
    let is_other = |cell: &Cell| opened.grid.state(*cell).is_some_and(|known| known != state);
    let cells = ask.cells.iter().map(|&(x, y)| Cell::new(x, y)).filter(is_other);
    let edits: Vec<Edit> = cells.map(|cell| Edit { cell, state }).collect();
    opened.grid.apply(&edits);
    opened.source.digest = digest(&opened.grid);
    (Edited { changed: edits.len() }, edits)
}
