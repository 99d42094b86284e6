//! Static obstacles of a scene that are not on its map.

use crate::sim::StandingPolygon;
use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::map::{Cell, GridFrame};
use serde::{Deserialize, Serialize};

/// An obstacle that no map shows. In files it is a table with `position` and `radius_m`, or with
/// `vertices_m`, or with `cells`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnknownTable", into = "UnknownTable")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "UnknownTable"))]
#[non_exhaustive]
pub enum UnknownObstacle {
    /// A round one.
    Disc(UnknownDisc),
    /// A polygon of any shape.
    Polygon(StandingPolygon),
    /// Cells of the map that are in truth occupied.
    Cells(Vec<Cell>),
}

/// A round obstacle that no map shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownDisc {
    /// Its centre \[m\].
    pub position: Point,
    /// Its radius \[m\].
    pub radius_m: f64,
}

/// An obstacle that no map shows: a table with `position` and `radius_m`, or with `vertices_m`, or
/// with `cells`.
#[derive(Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "UnknownObstacle", extend("oneOf" = [
    {"required": ["position", "radius_m"], "propertyNames": {"enum": ["position", "radius_m"]}},
    {"required": ["vertices_m"], "propertyNames": {"enum": ["vertices_m"]}},
    {"required": ["cells"], "propertyNames": {"enum": ["cells"]}},
])))]
#[serde(deny_unknown_fields)]
struct UnknownTable {
    /// The centre of a round one \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    position: Option<Point>,
    /// The radius of a round one \[m\], at least 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
    /// The 3 to 100 vertices of a polygon of any shape \[m\]; the last one is joined to the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(length(min = 3, max = 100)))]
    vertices_m: Option<Vec<Point>>,
    /// Cells of the map that are occupied although it does not show it: `[column, row]` each, `[0,
    /// 0]` at the lower left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    cells: Option<Vec<Cell>>,
}

impl UnknownObstacle {
    /// Field that determines the kind, if scenes of version 1 do not have it.
    pub(super) const fn newer(&self) -> Option<&'static str> {
        match self {
            Self::Disc(_) => None,
            Self::Polygon(_) => Some("unknown.vertices_m"),
            Self::Cells(_) => Some("unknown.cells"),
        }
    }

    /// Checks every value of all obstacles.
    pub(super) fn validate_all(unknown: &[Self]) -> Result<(), ConfigError> {
        let mut unknown = unknown.iter().enumerate();
        unknown.try_for_each(|(i, obstacle)| obstacle.validate().map_err(|error| within(i, error)))
    }

    fn validate(&self) -> Result<(), ConfigError> {
        // Polygons are checked at construction, and cells when there is a map.
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

    /// Adds the obstacle to the others, on a map.
    fn put_into(&self, standing: &mut Standing, frame: &GridFrame) -> Result<(), ConfigError> {
        match self {
            Self::Disc(circle) => standing.obstacles.push((*circle).into()),
            Self::Polygon(polygon) => standing.polygons.push(polygon.clone()),
            Self::Cells(cells) => {
                if let Some(i) = cells.iter().position(|&cell| !frame.contains(cell)) {
                    let (width, height, cell) = (frame.width(), frame.height(), cells[i]);
                    let reason = format!(
                        "must be a cell of the map of {width} x {height} cells, got {cell}"
                    );
                    return Err(ConfigError::new(format!("cells[{i}]"), reason));
                }
                standing.hidden_cells.extend(cells);
            }
        }
        Ok(())
    }
}

/// Adds the index of the unknown obstacle to an error.
fn within(index: usize, error: ConfigError) -> ConfigError {
    error.within(&format!("unknown[{index}]"))
}

/// All unknown obstacles, by kind, as in [`Episode`](crate::episode::Episode) and
/// [`Episode`](crate::episode::Episode).
#[derive(Default)]
pub(super) struct Standing {
    pub(super) obstacles: Vec<Disc>,
    pub(super) polygons: Vec<StandingPolygon>,
    pub(super) hidden_cells: Vec<Cell>,
}

impl Standing {
    /// Collects the obstacles on a map; refuses cells that are not on it.
    pub(super) fn of(unknown: &[UnknownObstacle], frame: &GridFrame) -> Result<Self, ConfigError> {
        let mut standing = Self::default();
        for (i, obstacle) in unknown.iter().enumerate() {
            obstacle.put_into(&mut standing, frame).map_err(|error| within(i, error))?;
        }
        standing.hidden_cells.sort_unstable();
        standing.hidden_cells.dedup();
        Ok(standing)
    }
}

impl TryFrom<UnknownTable> for UnknownObstacle {
    type Error = ConfigError;

    fn try_from(table: UnknownTable) -> Result<Self, ConfigError> {
        match table {
            UnknownTable {
                position: Some(position),
                radius_m: Some(radius_m),
                vertices_m: None,
                cells: None,
            } => Ok(Self::Disc(UnknownDisc { position, radius_m })),
            UnknownTable {
                vertices_m: Some(vertices),
                position: None,
                radius_m: None,
                cells: None,
            } => StandingPolygon::new(vertices).map(Self::Polygon),
            UnknownTable {
                cells: Some(cells),
                position: None,
                radius_m: None,
                vertices_m: None,
            } => {
                if cells.is_empty() {
                    return Err(ConfigError::new("cells", "needs at least one cell, got none"));
                }
                Ok(Self::Cells(cells))
            }
            table => Err(table.not_one_kind()),
        }
    }
}

impl UnknownTable {
    /// Error for too many or too few fields for one kind.
    fn not_one_kind(&self) -> ConfigError {
        let Self { position, radius_m, vertices_m, cells } = self;
        let given = [
            ("`position`", position.is_some()),
            ("`radius_m`", radius_m.is_some()),
            ("`vertices_m`", vertices_m.is_some()),
            ("`cells`", cells.is_some()),
        ];
        let given: Vec<&str> =
            given.into_iter().filter_map(|(name, is_given)| is_given.then_some(name)).collect();
        let given = if given.is_empty() { "none of them".to_owned() } else { given.join(", ") };
        let kinds = "`position` and `radius_m`, or `vertices_m`, or `cells`";
        ConfigError::new("the shape", format!("must be {kinds}, got {given}"))
    }
}

impl From<UnknownObstacle> for UnknownTable {
    fn from(obstacle: UnknownObstacle) -> Self {
        let none = Self::default();
        match obstacle {
            UnknownObstacle::Disc(UnknownDisc { position, radius_m }) => {
                Self { position: Some(position), radius_m: Some(radius_m), ..none }
            }
            UnknownObstacle::Polygon(polygon) => Self { vertices_m: Some(polygon.into()), ..none },
            UnknownObstacle::Cells(cells) => Self { cells: Some(cells), ..none },
        }
    }
}

impl From<UnknownDisc> for UnknownObstacle {
    fn from(circle: UnknownDisc) -> Self {
        Self::Disc(circle)
    }
}

impl From<UnknownDisc> for Disc {
    fn from(circle: UnknownDisc) -> Self {
        Self::new(circle.position, circle.radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SceneError, SceneFile};
    use super::*;
    use crate::episode::Episode;
    use keyway::map::formats::map_from_bytes;
    use keyway::navigate::Stack;
    use keyway::robot::Robot;
    use std::path::Path;

    const SCENE: &str = "version = 2\nmap = \"a.map\"\nstart = [1, 2]\ngoal = [3.5, 4]\n";
    const SHAPES: &str = "[[unknown]]\nvertices_m = [[0, 0], [2, 0], [2, 1], [1, 0.5]]\n\
                          [[unknown]]\ncells = [[3, 2], [4, 0]]\n\
                          [[unknown]]\nposition = [2, 3]\nradius_m = 0.5\n";

    fn error(text: &str) -> String {
        SceneFile::from_toml(text).unwrap_err().to_string()
    }

    fn episode(text: &str) -> Result<Episode, SceneError> {
        let octile = b"type octile\nheight 5\nwidth 5\nmap\n.....\n.....\n.....\n.....\n.....\n";
        let map = map_from_bytes(Path::new("a.map"), octile, |_| Ok(vec![]), None).unwrap();
        let robot = Robot::small();
        let stack = Stack::key_point_fusion(&robot);
        SceneFile::from_toml(text).unwrap().episode_with(map, &robot, &stack)
    }

    #[test]
    fn each_kind_comes_into_the_world() {
        let scene = SceneFile::from_toml(&format!("{SCENE}{SHAPES}")).unwrap();
        assert_eq!(SceneFile::from_toml(&toml::to_string(&scene).unwrap()).unwrap(), scene);
        let episode = episode(&format!("{SCENE}{SHAPES}")).unwrap();
        assert_eq!(episode.obstacles, [Disc::new(Point::new(2.0, 3.0), 0.5)]);
        assert_eq!(episode.hidden_cells, [Cell::new(3, 2), Cell::new(4, 0)]);
        assert_eq!(episode.polygons[0].vertices()[3], Point::new(1.0, 0.5));
    }

    #[test]
    fn what_is_random_follows_from_the_seed() {
        let walk = "[[moving]]\nradius_m = 0.1\n[moving.random_walk]\nposition = [2, 2]\n\
                    area = [[1, 1], [3, 3]]\nspeed_mps = [1, 2]\nleg_s = [1, 2]\n";
        let own = format!("{walk}seed = 9\n");
        let random = "[random.unknown]\ncount = 1\nradius_m = [0.1, 0.2]\n";
        let scene = |seed: u32, text: &str| {
            let scene = SCENE.replace("version = 2", &format!("version = 2\nseed = {seed}"));
            format!("{scene}{text}{own}{random}")
        };
        let read = |text: &str| SceneFile::from_toml(text).unwrap();
        let first = read(&scene(1, walk));
        assert!(first.is_random());
        assert_eq!(read(&toml::to_string(&first).unwrap()), first);
        let movers = |seed| episode(&scene(seed, walk)).unwrap().movers;
        assert_eq!(movers(1), movers(1));
        assert_ne!(movers(1)[0], movers(2)[0]);
        assert_eq!(movers(1)[1], movers(2)[1]);
        // Two walks without a seed are different.
        let twice = episode(&scene(1, &format!("{walk}{walk}"))).unwrap().movers;
        assert_ne!(twice[0], twice[1]);
        let alone = |text: &str| read(&format!("{SCENE}{text}")).is_random();
        assert!(alone(walk) && alone(random) && !alone(&own));
        assert_eq!(episode(&scene(1, walk)).unwrap().random.unwrap().unknown_asked, 1);
        let bad = error(&format!("{SCENE}{}", random.replace("0.1, ", "-0.1, ")));
        assert_eq!(bad, "`random.unknown.radius_m[0]` must be a positive number, got -0.1");
        let old = error(&format!("{SCENE}{random}").replace("version = 2", "version = 1"));
        assert_eq!(old, "`random` needs `version = 2`");
    }

    #[test]
    fn errors_name_the_field() {
        let bad = |table: &str| error(&format!("{SCENE}[[unknown]]\n{table}\n"));
        let both = bad("cells = [[1, 1]]\nradius_m = 1");
        assert!(both.contains("`unknown[0]`: the shape must be"), "{both}");
        assert!(both.contains("got `radius_m`, `cells`"), "{both}");
        assert!(bad("cells = []").contains("`unknown[0]`: cells needs at least one cell"));
        let bow = bad("vertices_m = [[0, 0], [1, 1], [1, 0], [0, 1]]");
        assert!(
            bow.contains("line 5") && bow.contains("`unknown[0]`: vertices_m must not"),
            "{bow}"
        );
        let half = bad("cells = [[0.5, 1]]");
        assert!(half.contains("`unknown[0].cells[0]") || half.contains("`unknown[0]"), "{half}");
        let nan = bad("position = [nan, 1]\nradius_m = 1");
        assert!(nan.starts_with("`unknown[0].position[0]` must be a finite"), "{nan}");
        let off = format!("{SCENE}{SHAPES}[[unknown]]\ncells = [[1, 1], [5, 0]]\n");
        let off = episode(&off).unwrap_err().to_string();
        assert_eq!(
            off,
            "`unknown[3].cells[1]` must be a cell of the map of 5 x 5 cells, got (5, 0)"
        );
        let first = format!("{SCENE}{SHAPES}").replace("version = 2", "version = 1");
        assert_eq!(error(&first), "`unknown.vertices_m` needs `version = 2`");
    }
}
