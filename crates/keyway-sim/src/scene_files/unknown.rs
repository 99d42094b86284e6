//! Static obstacles of a scene that are not on its map, and mapped obstacles that do not exist.

use crate::sim::{ElusiveObstacle, ElusiveShape, Presence, StandingPolygon};
use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::map::{Cell, GridFrame, OccupancyGrid};
use serde::{Deserialize, Serialize};

/// An unmapped obstacle. In files it is a table with the fields of its shape, of the time for
/// which it is present, and of its visibility.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnknownTable", into = "UnknownTable")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "UnknownTable"))]
pub struct UnknownObstacle {
    /// Shape of the obstacle.
    pub shape: GroundShape,
    /// Time for which it is present, and its visibility.
    pub presence: Presence,
}

/// Area of a map. In files it is a table with `position` and `radius_m`, or with `vertices_m`, or
/// with `cells`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnknownTable", into = "UnknownTable")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "GroundTable"))]
#[non_exhaustive]
pub enum GroundShape {
    /// A disc.
    Disc(UnknownDisc),
    /// A polygon of any shape.
    Polygon(StandingPolygon),
    /// Cells of the map.
    Cells(Vec<Cell>),
}

/// An unmapped disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownDisc {
    /// Centre \[m\].
    pub position: Point,
    /// Radius \[m\].
    pub radius_m: f64,
}

/// An unmapped obstacle: a table with `position` and `radius_m`, or with `vertices_m`, or with
/// `cells`.
#[derive(Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "UnknownObstacle", extend("oneOf" = [
    {"required": ["position", "radius_m"],
     "propertyNames": {"enum": ["position", "radius_m", "from_s", "until_s", "seen"]}},
    {"required": ["vertices_m"],
     "propertyNames": {"enum": ["vertices_m", "from_s", "until_s", "seen"]}},
    {"required": ["cells"],
     "propertyNames": {"enum": ["cells", "from_s", "until_s", "seen"]}},
])))]
#[serde(deny_unknown_fields)]
struct UnknownTable {
    /// Centre of a disc \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    position: Option<Point>,
    /// Radius of a disc \[m\], at least 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
    /// The 3 to 100 vertices of a polygon of any shape \[m\]; the last one is joined to the
    /// first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(length(min = 3, max = 100)))]
    vertices_m: Option<Vec<Point>>,
    /// Cells that are occupied although the map shows them as free: `[column, row]` each, `[0,
    /// 0]` at the lower left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    cells: Option<Vec<Cell>>,
    /// Time at which the obstacle appears \[s\]; by default, it is there from the beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from_s: Option<f64>,
    /// Time at which the obstacle disappears \[s\]; by default, it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    until_s: Option<f64>,
    /// Share of the beams on the obstacle that detect it, from 0 to 1; by default, all do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 1)))]
    seen: Option<f64>,
}

/// Area that the map shows as occupied although it is free: a table with `position` and
/// `radius_m`, or with `vertices_m`, or with `cells`.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(rename = "AbsentObstacle", extend("oneOf" = [
    {"required": ["position", "radius_m"], "propertyNames": {"enum": ["position", "radius_m"]}},
    {"required": ["vertices_m"], "propertyNames": {"enum": ["vertices_m"]}},
    {"required": ["cells"], "propertyNames": {"enum": ["cells"]}},
]))]
#[expect(dead_code, reason = "only its schema counts")]
struct GroundTable {
    /// Centre of a disc \[m\]: all cells with their centres in it are free.
    position: Option<Point>,
    /// Radius of a disc \[m\], at least 0.
    radius_m: Option<f64>,
    /// The 3 to 100 vertices of a polygon \[m\]: all cells with their centres in it are free.
    #[schemars(length(min = 3, max = 100))]
    vertices_m: Option<Vec<Point>>,
    /// Cells, `[column, row]` each, `[0, 0]` at the lower left.
    #[schemars(length(min = 1))]
    cells: Option<Vec<Cell>>,
}

impl UnknownObstacle {
    /// An obstacle that is always present and visible.
    pub const fn new(shape: GroundShape) -> Self {
        Self { shape, presence: Presence::ALWAYS }
    }

    /// Field that scenes of version 1 do not have.
    pub(super) fn newer(&self) -> Option<&'static str> {
        let Presence { from_s, until_s, seen } = self.presence;
        match self.shape {
            GroundShape::Polygon(_) => Some("unknown.vertices_m"),
            GroundShape::Cells(_) => Some("unknown.cells"),
            GroundShape::Disc(_) if from_s != 0.0 => Some("unknown.from_s"),
            GroundShape::Disc(_) if until_s.is_some() => Some("unknown.until_s"),
            GroundShape::Disc(_) if seen != 1.0 => Some("unknown.seen"),
            GroundShape::Disc(_) => None,
        }
    }

    /// Checks every value of all obstacles.
    pub(super) fn validate_all(unknown: &[Self]) -> Result<(), ConfigError> {
        unknown.iter().enumerate().try_for_each(|(i, obstacle)| {
            let checked = obstacle.shape.validate().and_then(|()| obstacle.presence.validate());
            checked.map_err(|error| error.within(&format!("unknown[{i}]")))
        })
    }

    /// Adds the obstacle to the others, on a map.
    fn put_into(&self, standing: &mut Standing, frame: &GridFrame) -> Result<(), ConfigError> {
        if self.presence != Presence::ALWAYS {
            for shape in self.shape.elusive(frame)? {
                standing.elusive.push(ElusiveObstacle::new(shape, self.presence)?);
            }
            return Ok(());
        }
        match &self.shape {
            GroundShape::Disc(circle) => standing.obstacles.push((*circle).into()),
            GroundShape::Polygon(polygon) => standing.polygons.push(polygon.clone()),
            GroundShape::Cells(cells) => {
                check_cells(cells, frame)?;
                standing.hidden_cells.extend(cells);
            }
        }
        Ok(())
    }
}

impl GroundShape {
    /// Checks every value. Polygons are checked at construction, and cells against the map.
    fn validate(&self) -> Result<(), ConfigError> {
        let Self::Disc(UnknownDisc { position, radius_m }) = self else { return Ok(()) };
        for (field, value) in [("position[0]", position.x), ("position[1]", position.y)] {
            if !value.is_finite() {
                return Err(ConfigError::must_be(field, "a finite number", value));
            }
        }
        if *radius_m >= 0.0 && radius_m.is_finite() {
            return Ok(());
        }
        Err(ConfigError::must_be("radius_m", "a length of at least 0", *radius_m))
    }

    /// Returns the same area as obstacles of limited presence: a square for each cell.
    fn elusive(&self, frame: &GridFrame) -> Result<Vec<ElusiveShape>, ConfigError> {
        match self {
            Self::Disc(disc) => Ok(vec![ElusiveShape::Disc((*disc).into())]),
            Self::Polygon(polygon) => Ok(vec![ElusiveShape::Polygon(polygon.clone())]),
            Self::Cells(cells) => {
                check_cells(cells, frame)?;
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
                let square = |cell: &Cell| {
                    let corner = |(x, y)| {
                        let corner = Point::new(f64::from(cell.x + x), f64::from(cell.y + y));
                        frame.world_from_grid(corner)
                    };
                    StandingPolygon::new(corners.map(corner).to_vec()).map(ElusiveShape::Polygon)
                };
                cells.iter().map(square).collect()
            }
        }
    }

    /// Cells that a map shows as occupied or unknown, and whose centres lie in this area.
    fn cells_on(&self, map: &OccupancyGrid) -> Result<Vec<Cell>, ConfigError> {
        let frame = map.frame();
        let is_blocked = |cell: &Cell| map.occupied().get(*cell) || map.unknown().get(*cell);
        let covers: Box<dyn Fn(Point) -> bool> = match self {
            Self::Cells(cells) => {
                check_cells(cells, frame)?;
                return Ok(cells.iter().copied().filter(is_blocked).collect());
            }
            Self::Disc(disc) => {
                let disc = Disc::from(*disc);
                Box::new(move |centre| disc.distance(centre) <= 0.0)
            }
            Self::Polygon(polygon) => Box::new(|centre| polygon.covers(centre)),
        };
        let rows = 0..frame.height() as i32;
        let cells = rows.flat_map(|y| (0..frame.width() as i32).map(move |x| Cell::new(x, y)));
        let covered = |cell: &Cell| is_blocked(cell) && covers(frame.world_from_cell(*cell));
        Ok(cells.filter(covered).collect())
    }
}

fn check_cells(cells: &[Cell], frame: &GridFrame) -> Result<(), ConfigError> {
    let Some(i) = cells.iter().position(|&cell| !frame.contains(cell)) else { return Ok(()) };
    let (width, height, cell) = (frame.width(), frame.height(), cells[i]);
    let reason = format!("must be a cell of the map of {width} x {height} cells, got {cell}");
    Err(ConfigError::new(format!("cells[{i}]"), reason))
}

/// All unknown obstacles, by kind, as in [`Episode`](crate::episode::Episode).
#[derive(Default)]
pub(super) struct Standing {
    pub(super) obstacles: Vec<Disc>,
    pub(super) polygons: Vec<StandingPolygon>,
    pub(super) hidden_cells: Vec<Cell>,
    pub(super) elusive: Vec<ElusiveObstacle>,
}

impl Standing {
    /// Collects the obstacles on a map; returns an error for cells outside it.
    pub(super) fn of(unknown: &[UnknownObstacle], frame: &GridFrame) -> Result<Self, ConfigError> {
        let mut standing = Self::default();
        for (i, obstacle) in unknown.iter().enumerate() {
            let put = obstacle.put_into(&mut standing, frame);
            put.map_err(|error| error.within(&format!("unknown[{i}]")))?;
        }
        in_order(&mut standing.hidden_cells);
        Ok(standing)
    }
}

/// Checks every value of all mapped obstacles that do not exist.
pub(super) fn validate_absent(absent: &[GroundShape]) -> Result<(), ConfigError> {
    absent.iter().enumerate().try_for_each(|(i, shape)| {
        shape.validate().map_err(|error| error.within(&format!("absent[{i}]")))
    })
}

/// Cells that are free although a map shows them as occupied or unknown; returns an error for
/// cells outside the map.
pub(super) fn absent_cells(
    absent: &[GroundShape],
    map: &OccupancyGrid,
) -> Result<Vec<Cell>, ConfigError> {
    let mut all = Vec::new();
    for (i, shape) in absent.iter().enumerate() {
        all.extend(shape.cells_on(map).map_err(|error| error.within(&format!("absent[{i}]")))?);
    }
    in_order(&mut all);
    Ok(all)
}

fn in_order(cells: &mut Vec<Cell>) {
    cells.sort_unstable();
    cells.dedup();
}

impl TryFrom<UnknownTable> for UnknownObstacle {
    type Error = ConfigError;

    fn try_from(table: UnknownTable) -> Result<Self, ConfigError> {
        let presence = table.presence();
        presence.validate()?;
        Ok(Self { shape: table.shape()?, presence })
    }
}

impl TryFrom<UnknownTable> for GroundShape {
    type Error = ConfigError;

    fn try_from(table: UnknownTable) -> Result<Self, ConfigError> {
        if table.presence() == Presence::ALWAYS {
            return table.shape();
        }
        let reason = "`from_s`, `until_s` and `seen` belong to a static obstacle (`[[unknown]]`)";
        Err(ConfigError::new("the table", format!("has too many fields: {reason}")))
    }
}

impl UnknownTable {
    fn presence(&self) -> Presence {
        let Self { from_s, until_s, seen, .. } = *self;
        let Presence { from_s: always_s, seen: all, .. } = Presence::ALWAYS;
        Presence { from_s: from_s.unwrap_or(always_s), until_s, seen: seen.unwrap_or(all) }
    }

    fn shape(self) -> Result<GroundShape, ConfigError> {
        let Self { position, radius_m, vertices_m, cells, .. } = self;
        match (position, radius_m, vertices_m, cells) {
            (Some(position), Some(radius_m), None, None) => {
                Ok(GroundShape::Disc(UnknownDisc { position, radius_m }))
            }
            (None, None, Some(vertices), None) => {
                StandingPolygon::new(vertices).map(GroundShape::Polygon)
            }
            (None, None, None, Some(cells)) if cells.is_empty() => {
                Err(ConfigError::new("cells", "needs at least one cell, got none"))
            }
            (None, None, None, Some(cells)) => Ok(GroundShape::Cells(cells)),
            (position, radius_m, vertices_m, cells) => Err(not_one_kind([
                ("`position`", position.is_some()),
                ("`radius_m`", radius_m.is_some()),
                ("`vertices_m`", vertices_m.is_some()),
                ("`cells`", cells.is_some()),
            ])),
        }
    }
}

/// Error for too many or too few fields for one kind.
fn not_one_kind(given: [(&str, bool); 4]) -> ConfigError {
    let given: Vec<&str> =
        given.into_iter().filter_map(|(name, is_given)| is_given.then_some(name)).collect();
    let given = if given.is_empty() { "none of them".to_owned() } else { given.join(", ") };
    let kinds = "`position` and `radius_m`, or `vertices_m`, or `cells`";
    ConfigError::new("the shape", format!("must be {kinds}, got {given}"))
}

impl From<GroundShape> for UnknownTable {
    fn from(shape: GroundShape) -> Self {
        let none = Self::default();
        match shape {
            GroundShape::Disc(UnknownDisc { position, radius_m }) => {
                Self { position: Some(position), radius_m: Some(radius_m), ..none }
            }
            GroundShape::Polygon(polygon) => Self { vertices_m: Some(polygon.into()), ..none },
            GroundShape::Cells(cells) => Self { cells: Some(cells), ..none },
        }
    }
}

impl From<UnknownObstacle> for UnknownTable {
    fn from(UnknownObstacle { shape, presence }: UnknownObstacle) -> Self {
        let Presence { from_s, until_s, seen } = presence;
        let from_s = (from_s != Presence::ALWAYS.from_s).then_some(from_s);
        let seen = (seen != Presence::ALWAYS.seen).then_some(seen);
        Self { from_s, until_s, seen, ..shape.into() }
    }
}

impl From<UnknownDisc> for UnknownObstacle {
    fn from(circle: UnknownDisc) -> Self {
        Self::new(GroundShape::Disc(circle))
    }
}

impl From<UnknownDisc> for Disc {
    fn from(circle: UnknownDisc) -> Self {
        Self::new(circle.position, circle.radius_m)
    }
}

#[cfg(test)]
mod tests;
