//! Files of pairs: each line has a start and a goal.

use super::ends::Ends;
use super::map_names::{AmbiguousMap, MapNames};
use keyway::geometry::Point;
use keyway::map::GridFrame;
use keyway::plan::PathEnd;
use thiserror::Error;

/// Columns that every file of pairs has, in the order of a file without a header.
const COORDINATES: [&str; 4] = ["start_x_m", "start_y_m", "goal_x_m", "goal_y_m"];
/// The column with the map of a line.
const MAP: &str = "map";
const EXPECTED: &str =
    "expected start_x_m,start_y_m,goal_x_m,goal_y_m, in any order, and `map` where it is needed";

/// Fault in a file of pairs, and its line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {fault}")]
pub struct PairsError {
    /// Line of the file, from 1.
    pub line: usize,
    /// Fault of the line.
    pub fault: PairsFault,
}

/// Fault in a line of a file of pairs.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PairsFault {
    /// No column has this name.
    #[error("`{name}` is not a column of pairs, {EXPECTED}")]
    UnknownColumn {
        /// The name, shortened.
        name: String,
    },
    /// A column is repeated.
    #[error("the column `{name}` is given twice, {EXPECTED}")]
    RepeatedColumn {
        /// Name of the repeated column, shortened.
        name: String,
    },
    /// A column is missing.
    #[error("the column `{name}` is missing, {EXPECTED}")]
    MissingColumn {
        /// Name of the column.
        name: &'static str,
    },
    /// A line has too few or too many values.
    #[error("{count} values, but {expected} columns; {EXPECTED}")]
    Count {
        /// Number of values.
        count: usize,
        /// Number of columns.
        expected: usize,
    },
    /// A coordinate is not a finite number.
    #[error("the {column} is `{got}`, expected a number")]
    Number {
        /// Name of the column.
        column: &'static str,
        /// The value, shortened.
        got: String,
    },
    /// A position is not on the map.
    #[error("the {end} ({x}, {y}) is outside the map")]
    Outside {
        /// Start or goal.
        end: PathEnd,
        /// Its x as written, shortened.
        x: String,
        /// Its y as written, shortened.
        y: String,
    },
    /// A line names several maps.
    #[error(transparent)]
    Ambiguous(#[from] AmbiguousMap),
    /// No line is for the map.
    #[error("no line has {map} in the column `map`")]
    NoneOfMap {
        /// Name of the map.
        map: String,
    },
    /// The file has no pair.
    #[error("there are no pairs, {EXPECTED}")]
    Empty,
}

/// Returns the beginning of a word, for error messages.
fn shown(word: &str) -> String {
    let visible =
        |letter: char| if letter.is_control() { char::REPLACEMENT_CHARACTER } else { letter };
    let short: String = word.chars().take(40).map(visible).collect();
    if word.chars().nth(40).is_some() { short + "..." } else { short }
}

/// Returns the name of a column with its unit.
fn in_full(name: &str) -> &str {
    let is_it = |full: &&str| *full == name || full.strip_suffix("_m") == Some(name);
    COORDINATES.into_iter().find(is_it).unwrap_or(name)
}

/// Indices of the values in a line.
struct Columns {
    /// Index for each of [`COORDINATES`].
    coordinates: [usize; 4],
    map: Option<usize>,
    count: usize,
}

impl Columns {
    /// Columns of a file without a header.
    const USUAL: Self = Self { coordinates: [0, 1, 2, 3], map: None, count: 4 };

    /// Finds the columns by their names; the unit may be left out, as in `start_x`.
    fn of_header(header: &str) -> Result<Self, PairsFault> {
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let full: Vec<&str> = names.iter().map(|&name| in_full(name)).collect();
        let is_known = |i: &usize| COORDINATES.contains(&full[*i]) || names[*i] == MAP;
        let is_repeated = |i: &usize| full[..*i].contains(&full[*i]);
        if let Some(i) = (0..names.len()).find(|i| !is_known(i)) {
            return Err(PairsFault::UnknownColumn { name: shown(names[i]) });
        }
        if let Some(i) = (0..names.len()).find(is_repeated) {
            return Err(PairsFault::RepeatedColumn { name: shown(names[i]) });
        }
        let place = |wanted: &'static str| {
            let place = full.iter().position(|name| *name == wanted);
            place.ok_or(PairsFault::MissingColumn { name: wanted })
        };
        let [a, b, c, d] = COORDINATES.map(place);
        let map = names.iter().position(|name| *name == MAP);
        Ok(Self { coordinates: [a?, b?, c?, d?], map, count: names.len() })
    }

    /// Returns the name of a column.
    fn name(&self, column: usize) -> &'static str {
        let place = self.coordinates.iter().position(|&own| own == column);
        place.map_or(MAP, |place| COORDINATES[place])
    }

    /// Returns the start and goal of a line.
    fn ends(&self, fields: &[&str], frame: &GridFrame) -> Result<(Point, Point), PairsFault> {
        if fields.len() != self.count {
            return Err(PairsFault::Count { count: fields.len(), expected: self.count });
        }
        let number = |column: usize| match fields[column].parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(PairsFault::Number { column: self.name(column), got: shown(fields[column]) }),
        };
        let place = |end: PathEnd, x: usize, y: usize| {
            let point = Point::new(number(x)?, number(y)?);
            let [x, y] = [x, y].map(|column| shown(fields[column]));
            let outside = || PairsFault::Outside { end, x, y };
            frame.cell_from_world(point).map(|_| point).ok_or_else(outside)
        };
        let [start_x, start_y, goal_x, goal_y] = self.coordinates;
        Ok((place(PathEnd::Start, start_x, start_y)?, place(PathEnd::Goal, goal_x, goal_y)?))
    }
}

/// Returns the queries on a map, one in each line. The first line may be a header, which names the
/// columns; without one they are [`COORDINATES`]. With a column `map`, only lines of this map count
/// ([`MapNames::named`]). Empty lines, and those that begin with `#`, are left out.
pub(super) fn ends_of_pairs(
    text: &str,
    (names, map): (&MapNames, usize),
    frame: &GridFrame,
) -> Result<Vec<Ends>, PairsError> {
    let at = |line: usize| move |fault: PairsFault| PairsError { line, fault };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().map(str::trim).enumerate().map(|(i, line)| (i + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let is_header = |line: &str| line.split(',').all(|word| word.trim().parse::<f64>().is_err());
    let columns = match lines.next_if(|(_, line)| is_header(line)) {
        Some((number, header)) => Columns::of_header(header).map_err(at(number))?,
        None => Columns::USUAL,
    };
    let mut all = Vec::new();
    for (number, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let of = columns.map.and_then(|column| fields.get(column)).map(|name| names.named(name));
        let of = of.transpose().map_err(|error| at(number)(error.into()))?;
        if of.is_none_or(|of| of == Some(map)) {
            let ends = columns.ends(&fields, frame).map_err(at(number))?;
            all.extend(Ends::of_points(frame, ends, number));
        }
    }
    if !all.is_empty() {
        return Ok(all);
    }
    Err(at(1)(match columns.map {
        Some(_) => PairsFault::NoneOfMap { map: names.name(map).to_owned() },
        None => PairsFault::Empty,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Pose;
    use keyway::map::Cell;
    use std::path::PathBuf;

    fn frame() -> GridFrame {
        GridFrame::new(8, 4, 0.5, Pose::new(-1.0, 0.0, 0.0)).unwrap()
    }

    fn ends_of_map(text: &str, map: &str) -> Result<Vec<Ends>, PairsError> {
        let names = MapNames::new(&[PathBuf::from(map)]).unwrap();
        ends_of_pairs(text, (&names, 0), &frame())
    }

    #[test]
    fn pairs_by_hand() {
        let text =
            "\u{feff}start_x,start_y,goal_x,goal_y\r\n# a remark\n\n-0.75, 0.25,2.9,1.9\r\n0,0,0,0";
        let ends = ends_of_map(text, "a.map").unwrap();
        let cells: Vec<[Cell; 2]> = ends.iter().map(|e| [e.start_cell, e.goal_cell]).collect();
        let expected = [[(0, 0), (7, 3)], [(2, 0), (2, 0)]];
        assert_eq!(cells, expected.map(|pair| pair.map(|(x, y)| Cell::new(x, y))));
        assert_eq!((ends[0].start, ends[0].goal), (Point::new(-0.75, 0.25), Point::new(2.9, 1.9)));
        assert_eq!((ends[0].line, ends[1].line), (Some(4), Some(5)));
    }

    #[test]
    fn columns_are_read_by_their_names() {
        let (start, goal) = (Point::new(0.0, 1.0), Point::new(2.0, 1.5));
        for text in [
            "0,1,2,1.5",
            "goal_x,goal_y,start_x,start_y\n2,1.5,0,1",
            "start_y_m , goal_x_m,map,start_x_m,goal_y_m\n1,2,a,0,1.5",
        ] {
            let ends = ends_of_map(text, "a.map").unwrap();
            assert_eq!((ends[0].start, ends[0].goal), (start, goal), "{text}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        const HEADER: &str = "start_x,start_y,goal_x,goal_y";
        for (text, line, part) in [
            ("H\n0,0,1,1\n\n0,0,1", 4, "3 values, but 4 columns"),
            ("0,0,1,x", 1, "the goal_y_m is `x`, expected a number"),
            ("0,0,1,inf", 1, "`inf`"),
            ("H\nb,c,d,e", 2, "`b`"),
            ("0,0,1,1\n0,0,3.5,1", 2, "the goal (3.5, 1) is outside the map"),
            ("-2,0,1,1", 1, "the start (-2, 0) is outside the map"),
            ("H\n", 1, "no pair"),
            ("", 1, "no pair"),
            ("map,H\nb,0,0,1,1", 1, "no line has a.map in the column `map`"),
            ("map,H\na,0,0,1", 2, "4 values, but 5 columns"),
            ("map,H\na", 2, "1 values"),
            ("H\na,0,0,1,1", 2, "5 values"),
            (
                "# old names\nsx,sy,gx,gy\n0,0,1,1",
                2,
                "`sx` is not a column of pairs, expected start_x_m,",
            ),
            ("H,name\n0,0,1,1,a", 1, "`name` is not a column"),
            ("map_m,H\na,0,0,1,1", 1, "`map_m` is not a column"),
            (
                "start_x,start_y,goal_x,map\n0,0,1,a",
                1,
                "the column `goal_y_m` is missing, expected",
            ),
            ("H,goal_x_m\n0,0,1,1,2", 1, "the column `goal_x_m` is given twice"),
        ] {
            let text = text.replace('H', HEADER);
            let error = ends_of_map(&text, "a.map").unwrap_err();
            let message = error.to_string();
            assert!(error.line == line && message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn a_column_says_of_which_map_a_line_is() {
        // Positions on other maps are not checked.
        let text = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\na,0,0,0,0\nb.yaml,99,0,0,0\nx/a.map,1,0,0,0";
        let starts = |text: &str, map: &str| -> Vec<f64> {
            let ends = ends_of_map(text, map).unwrap();
            ends.iter().map(|ends| ends.start.x).collect()
        };
        assert_eq!(starts(text, "/y/x/a.map"), [0.0, 1.0]);
        assert_eq!(starts(text, "y/a.map"), [0.0]);
        // The column may be at any index.
        let text = "start_x,start_y,goal_x,goal_y,map\n1,0,0,0,b\n2,0,0,0,a\n";
        assert_eq!(starts(text, "a.yaml"), [2.0]);
    }
    #[test]
    fn a_name_of_several_maps_is_refused() {
        let maps = ["x/map.yaml", "y/map.yaml"].map(PathBuf::from);
        let names = MapNames::new(&maps).unwrap();
        let of = |line: &str, map| {
            let text = format!("map,start_x,start_y,goal_x,goal_y\n{line}");
            ends_of_pairs(&text, (&names, map), &frame()).map(|ends| ends.len())
        };
        let lines = "x/map.yaml,0,0,0,0\ny/map,0,0,1,1\nx/map,0,0,1,1";
        assert_eq!((of(lines, 0), of(lines, 1)), (Ok(2), Ok(1)));
        let error = of("x/map,0,0,0,0\nmap,0,0,0,0", 0).unwrap_err();
        let expected = "line 3: `map` names several maps; write x/map.yaml or y/map.yaml";
        assert_eq!(error.to_string(), expected);
    }
}
