//! Maps.

use crate::arrays::{Cells, Floats2, Mask, Occupancy, of_rows};
use crate::errors::{bad_value, check_memory, map_error, warn};
use crate::pictures;
use crate::ready::{PlannerCache, PlannerParts};
use crate::values::{Grid, Numbers, Positions, point_text};
use keyway::geometry::Pose;
use keyway::map::formats::{
    DEFAULT_MAX_CELLS, ImagePlacement, MapReader, MapWarning, TooManyCells, digest, write_map,
};
use keyway::map::{
    BitGrid, Cell, CellState, GridFrame, OccupancyError, OccupancyGrid, OccupancyThresholds,
};
use keyway_sim::report::{MapSource, PlacementInput};
use numpy::PyArray2;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// An occupancy grid: every cell is occupied, unknown or free.
///
/// Row 0 of all arrays is the bottom row of the map, as in `nav_msgs/OccupancyGrid`. Lengths are
/// in metres.
///
/// >>> import keyway, numpy as np
/// >>> occupied = np.zeros((40, 60), dtype=bool)
/// >>> occupied[10:30, 25] = True
/// >>> keyway.Map.from_array(occupied, resolution=0.1, origin=(-1, 0))
/// <keyway.Map 60 x 40 cells of 0.1 m from (-1, 0), 20 occupied, 0 unknown>
#[pyclass(frozen, module = "keyway")]
pub(crate) struct Map {
    pub(crate) grid: Arc<OccupancyGrid>,
    pub(crate) source: MapSource,
    planners: PlannerCache,
}

impl Map {
    fn new(grid: OccupancyGrid, source: MapSource) -> Self {
        Self::shared(Arc::new(grid), source)
    }

    pub(crate) fn shared(grid: Arc<OccupancyGrid>, source: MapSource) -> Self {
        Self { grid, source, planners: PlannerCache::default() }
    }

    pub(crate) fn planners(&self) -> &PlannerCache {
        &self.planners
    }

    pub(crate) fn parts(&self) -> PlannerParts {
        PlannerParts { grid: Arc::clone(&self.grid) }
    }

    /// Creates a mask of the cells for which a function is true.
    pub(crate) fn mask(&self, py: Python<'_>, is_set: impl Fn(Cell) -> bool) -> PyResult<Mask> {
        check_memory(self.grid.frame().cell_count())?;
        let (width, height) =
            (self.grid.frame().width() as usize, self.grid.frame().height() as usize);
        let get = |(y, x): (usize, usize)| is_set(Cell::new(x as i32, y as i32));
        let mask = Array2::from_shape_fn((height, width), get);
        Ok(Mask(PyArray2::from_owned_array(py, mask).unbind()))
    }
}

/// The arguments that restore a map.
type Parts = (Occupancy, (u8, u8), f64, (f64, f64, f64), String, Option<(f64, [f64; 3])>);

/// Creates the map of an array, with a function that reads its values.
fn read_grid(
    cells: &Grid<'_>,
    resolution: f64,
    origin: Pose,
    of_values: impl FnOnce(GridFrame, Vec<u8>) -> Result<OccupancyGrid, OccupancyError>,
) -> PyResult<OccupancyGrid> {
    let (rows, columns) = cells.shape();
    let frame = GridFrame::new(columns as u64, rows as u64, resolution, origin);
    let frame = frame.map_err(bad_value)?;
    // A bit each for occupied and unknown; values are kept as they are.
    let bits = frame.cell_count() / 4;
    check_memory(match cells {
        Grid::Mask(_) => bits,
        Grid::Values(_) => bits + frame.cell_count(),
    })?;
    let at = |cell: Cell| [cell.y as usize, cell.x as usize];
    let grid = cells.read(
        |mask| {
            Ok(OccupancyGrid::from_fn(frame, |cell| {
                if mask[at(cell)] { CellState::Occupied } else { CellState::Free }
            }))
        },
        |values| {
            // As in `nav_msgs`, negative values are unknown.
            let value = |&value: &i8| u8::try_from(value).unwrap_or(OccupancyGrid::UNKNOWN_VALUE);
            of_values(frame, values.iter().map(value).collect())
        },
    )?;
    grid.map_err(bad_value)
}

pub(crate) fn map_of_array(grid: OccupancyGrid) -> Map {
    let source = MapSource { name: "array".to_owned(), digest: digest(&grid), placement: None };
    Map::new(grid, source)
}

impl Map {
    /// Occupancy as in the file, if it is known.
    fn values(&self, py: Python<'_>) -> PyResult<Occupancy> {
        let Some(values) = self.grid.values() else { return self.occupancy(py) };
        check_memory(values.len() as u64)?;
        let (height, width) = self.shape();
        let value = |&value: &u8| i8::try_from(value).unwrap_or(-1);
        let shape = (height as usize, width as usize);
        let array = Array2::from_shape_vec(shape, values.iter().map(value).collect());
        let array = array.map_err(bad_value)?;
        Ok(Occupancy(PyArray2::from_owned_array(py, array).unbind()))
    }
}

fn pose(py: Python<'_>, origin: Option<&Numbers>) -> PyResult<Pose> {
    let Some(origin) = origin else { return Ok(Pose::default()) };
    let (at, yaw_rad) = origin.place(py, "origin")?;
    Ok(Pose::new(at.x, at.y, yaw_rad.unwrap_or_default()))
}

#[pymethods]
impl Map {
    /// Creates a map from an array of shape (rows, columns), row 0 at the bottom.
    ///
    /// `occupied` is an array of bool, or of int8 with the occupancy of each cell, 0 to 100, as
    /// in `nav_msgs`. A cell is occupied from `occupied_threshold` on and free up to
    /// `free_threshold`; it is unknown between the two and below 0. Nav2 saves maps by the same
    /// rule. Raises `ValueError` if the values are not all 0 but all below `free_threshold`: a
    /// mask must be of type bool. The array is read in place, whatever its strides.
    ///
    /// `resolution` is the cell size [m]; `origin` is the position [m] of the lower left corner,
    /// or its pose [m, m, rad].
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.array([[0, 65, 50, -1]], dtype=np.int8), resolution=0.5)
    /// >>> grid.occupied.tolist(), grid.unknown.tolist()
    /// ([[False, True, False, False]], [[False, False, True, True]])
    /// >>> keyway.Map.from_array(np.eye(2, dtype=np.int8), resolution=0.5)
    /// Traceback (most recent call last):
    /// ValueError: the largest occupancy is 1 of 100, so every cell would be free; pass an occupancy mask as type bool
    #[staticmethod]
    #[pyo3(signature = (occupied, resolution, origin=None, occupied_threshold=65, free_threshold=25))]
    fn from_array(
        py: Python<'_>,
        occupied: Grid<'_>,
        resolution: f64,
        origin: Option<Numbers>,
        occupied_threshold: u8,
        free_threshold: u8,
    ) -> PyResult<Self> {
        let thresholds = OccupancyThresholds::new(occupied_threshold, free_threshold);
        let thresholds = thresholds.map_err(bad_value)?;
        let origin = pose(py, origin.as_ref())?;
        let grid = read_grid(&occupied, resolution, origin, |frame, values| {
            OccupancyGrid::from_values(frame, values, thresholds)
        })?;
        Ok(map_of_array(grid))
    }

    /// Reads a map file: ROS (`.yaml` with its image), MovingAI (`.map`), or an image (`.png`,
    /// `.pgm`).
    ///
    /// A YAML file contains the placement of its map. For other files it is given by `resolution`
    /// [m] and `origin`. A likely mistake in such a file is a `UserWarning`. Raises `ValueError`
    /// for a map of more than `max_cells` [2^29], before memory is allocated.
    ///
    /// >>> import keyway
    /// >>> keyway.Map.read("nowhere.yaml")
    /// Traceback (most recent call last):
    /// FileNotFoundError: cannot read nowhere.yaml: there is no such file or folder
    #[staticmethod]
    #[pyo3(signature = (path, resolution=None, origin=None, max_cells=None))]
    pub(crate) fn read(
        py: Python<'_>,
        path: PathBuf,
        resolution: Option<f64>,
        origin: Option<Numbers>,
        max_cells: Option<u64>,
    ) -> PyResult<Self> {
        let usual = ImagePlacement::default();
        let is_given = resolution.is_some() || origin.is_some();
        let origin = pose(py, origin.as_ref())?;
        let resolution_m = resolution.unwrap_or(usual.resolution_m);
        let placement = is_given.then_some(ImagePlacement { resolution_m, origin });
        let max_cells = max_cells.unwrap_or(DEFAULT_MAX_CELLS);
        let reader = MapReader { placement, max_cells };
        let loaded = py.detach(|| reader.read(&path)).map_err(|error| {
            match error.too_many_cells().map(TooManyCells::needed) {
                Some(needed) => {
                    bad_value(format!("{error} with keyway.Map.read(path, max_cells={needed})"))
                }
                None => map_error(&error),
            }
        })?;
        for warning in &loaded.warnings {
            let advice = match warning {
                MapWarning::Resolution { .. } => {
                    "; set it with keyway.Map.read(path, resolution=...), or use the map's YAML file"
                }
                _ => "",
            };
            warn(py, &format!("{warning}{advice}"))?;
        }
        let source = MapSource { placement: placement.map(Into::into), ..MapSource::from(&loaded) };
        Ok(Self::new(loaded.grid, source))
    }

    /// Writes the map; the extension of the file selects the format, as for `read`.
    ///
    /// >>> import keyway, numpy as np, pathlib, tempfile
    /// >>> grid = keyway.Map.from_array(np.eye(3, dtype=bool), resolution=1.0)
    /// >>> folder = pathlib.Path(tempfile.mkdtemp())
    /// >>> grid.write(folder / "eye.map")
    /// >>> keyway.Map.read(folder / "eye.map").digest == grid.digest
    /// True
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_map(&path, &self.grid)).map_err(|error| map_error(&error))
    }

    /// Number of rows and columns.
    #[getter]
    fn shape(&self) -> (u32, u32) {
        (self.grid.frame().height(), self.grid.frame().width())
    }

    /// Cell size [m].
    #[getter]
    fn resolution(&self) -> f64 {
        self.grid.frame().resolution_m()
    }

    /// Pose of the lower left corner [m, m, rad].
    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        let Pose { x, y, theta } = self.grid.frame().origin();
        (x, y, theta)
    }

    /// Identifier of the map's content: equal maps have equal digests.
    #[getter]
    fn digest(&self) -> &str {
        &self.source.digest
    }

    /// Mask of the occupied cells: a new array of bool of shape (rows, columns).
    #[getter]
    fn occupied(&self, py: Python<'_>) -> PyResult<Mask> {
        self.mask(py, |cell| self.grid.occupied().get(cell))
    }

    /// Mask of the unknown cells: a new array of bool of shape (rows, columns).
    #[getter]
    fn unknown(&self, py: Python<'_>) -> PyResult<Mask> {
        self.mask(py, |cell| self.grid.unknown().get(cell))
    }

    /// The map as in `nav_msgs`: a new array of int8, -1 unknown, 0 free, 100 occupied.
    #[getter]
    fn occupancy(&self, py: Python<'_>) -> PyResult<Occupancy> {
        check_memory(self.grid.frame().cell_count())?;
        let (width, height) =
            (self.grid.frame().width() as usize, self.grid.frame().height() as usize);
        let value = |(y, x): (usize, usize)| match self.grid.state(Cell::new(x as i32, y as i32)) {
            Some(CellState::Free) => 0,
            Some(CellState::Occupied) => 100,
            _ => -1,
        };
        let occupancy = Array2::from_shape_fn((height, width), value);
        Ok(Occupancy(PyArray2::from_owned_array(py, occupancy).unbind()))
    }

    /// Returns the cells (column, row) of positions [m]: an array of int32 of shape (n, 2).
    /// Raises a `ValueError` that names the first position outside the map.
    ///
    /// >>> import keyway, numpy as np
    /// >>> grid = keyway.Map.from_array(np.zeros((4, 4), dtype=bool), resolution=0.5)
    /// >>> grid.cells([(0.1, 0.1), (1.9, 0.6)]).tolist()
    /// [[0, 0], [3, 1]]
    fn cells(&self, py: Python<'_>, positions: Positions) -> PyResult<Cells> {
        let frame = self.grid.frame();
        let mut cells = Vec::new();
        for (i, point) in positions.points("positions")?.into_iter().enumerate() {
            let Some(cell) = frame.cell_from_world(point) else {
                let (width, height) = (frame.width(), frame.height());
                let text = format!(
                    "positions[{i}] {} is outside the map of {width} x {height} cells",
                    point_text(point)
                );
                return Err(bad_value(text));
            };
            cells.push([cell.x, cell.y]);
        }
        let count = cells.len();
        Ok(Cells(of_rows(py, cells.into_iter(), count)))
    }

    /// Returns the centres of all free cells [m]: an array of float64 of shape (n, 2), row by row
    /// from the bottom.
    fn free_positions(&self, py: Python<'_>) -> PyResult<Floats2> {
        let frame = self.grid.frame();
        let is_free = |cell: &Cell| self.grid.state(*cell) == Some(CellState::Free);
        let centre = |cell: Cell| {
            let point = frame.world_from_cell(cell);
            [point.x, point.y]
        };
        let [occupied, unknown] =
            [self.grid.occupied(), self.grid.unknown()].map(BitGrid::count_ones);
        let count = frame.cell_count() - occupied - unknown;
        check_memory(count * size_of::<[f64; 2]>() as u64)?;
        Ok(Floats2(of_rows(py, frame.cells().filter(is_free).map(centre), count as usize)))
    }

    /// Supports copying, pickling and sending maps to other processes.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let placement = self.source.placement.map(|at| (at.resolution_m, at.origin));
        let thresholds = self.grid.thresholds().unwrap_or_default();
        let parts = (
            self.values(py)?,
            (thresholds.occupied(), thresholds.free()),
            self.resolution(),
            self.origin(),
            self.source.name.clone(),
            placement,
        );
        Ok((py.get_type::<Self>().getattr("_restored")?, parts))
    }

    #[staticmethod]
    fn _restored(
        values: Grid<'_>,
        thresholds: (u8, u8),
        resolution: f64,
        origin: (f64, f64, f64),
        name: String,
        placement: Option<(f64, [f64; 3])>,
    ) -> PyResult<Self> {
        let (occupied, free) = thresholds;
        let thresholds = OccupancyThresholds::new(occupied, free).map_err(bad_value)?;
        let (x, y, yaw_rad) = origin;
        let origin = Pose::new(x, y, yaw_rad);
        let made = map_of_array(read_grid(&values, resolution, origin, |frame, values| {
            OccupancyGrid::from_known_values(frame, values, thresholds)
        })?);
        let placement =
            placement.map(|(resolution_m, origin)| PlacementInput { resolution_m, origin });
        let source = MapSource { name, placement, ..made.source };
        Ok(Self { source, ..made })
    }

    fn __repr__(&self) -> String {
        let frame = self.grid.frame();
        let (width, height, side_m) = (frame.width(), frame.height(), frame.resolution_m());
        let Pose { x, y, .. } = frame.origin();
        let [occupied, unknown] =
            [self.grid.occupied(), self.grid.unknown()].map(BitGrid::count_ones);
        format!(
            "<keyway.Map {width} x {height} cells of {side_m} m from ({x}, {y}), {occupied} occupied, {unknown} unknown>"
        )
    }

    fn _repr_svg_(&self) -> String {
        pictures::of_map(&self.grid).as_str().to_owned()
    }

    fn _repr_png_(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        py.detach(|| pictures::png(&pictures::of_map(&self.grid)))
    }
}
