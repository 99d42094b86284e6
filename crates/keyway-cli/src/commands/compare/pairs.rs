//! Files of pairs: a start and a goal in each line.

use super::names::MapNames;
use keyway::geometry::Point;
use keyway::map::GridFrame;
use keyway_lab::compare::Ends;

/// Columns that every file of pairs has, in the order of a file without a header.
const COORDINATES: [&str; 4] = ["start_x", "start_y", "goal_x", "goal_y"];
/// The column that says which map a line is for.
const MAP: &str = "map";
const EXPECTED: &str =
    "expected start_x,start_y,goal_x,goal_y in metres, in any order, and `map` where it is needed";

/// The beginning of a word, for an error message.
fn shown(word: &str) -> String {
    let visible =
        |letter: char| if letter.is_control() { char::REPLACEMENT_CHARACTER } else { letter };
    let short: String = word.chars().take(40).map(visible).collect();
    if word.chars().nth(40).is_some() { short + "..." } else { short }
}

/// Where in a line the values are.
struct Columns {
    /// For each of [`COORDINATES`].
    coordinates: [usize; 4],
    map: Option<usize>,
    count: usize,
}

impl Columns {
    /// For a file without a header.
    const USUAL: Self = Self { coordinates: [0, 1, 2, 3], map: None, count: 4 };

    /// By their names, which may end in the unit: `start_x` or `start_x_m`.
    fn of_header(header: &str) -> Result<Self, String> {
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let bare: Vec<&str> =
            names.iter().map(|name| name.strip_suffix("_m").unwrap_or(name)).collect();
        let is_known = |i: &usize| COORDINATES.contains(&bare[*i]) || names[*i] == MAP;
        let is_repeated = |i: &usize| bare[..*i].contains(&bare[*i]);
        if let Some(i) = (0..names.len()).find(|i| !is_known(i)) {
            return Err(format!("`{}` is not a column of pairs, {EXPECTED}", shown(names[i])));
        }
        if let Some(i) = (0..names.len()).find(is_repeated) {
            return Err(format!("the column `{}` is given twice, {EXPECTED}", shown(names[i])));
        }
        let place = |wanted: &str| {
            let place = bare.iter().position(|name| *name == wanted);
            place.ok_or_else(|| format!("the column `{wanted}` is missing, {EXPECTED}"))
        };
        let [a, b, c, d] = COORDINATES.map(place);
        let map = names.iter().position(|name| *name == MAP);
        Ok(Self { coordinates: [a?, b?, c?, d?], map, count: names.len() })
    }

    /// The name of a column.
    fn name(&self, column: usize) -> &'static str {
        let place = self.coordinates.iter().position(|&own| own == column);
        place.map_or(MAP, |place| COORDINATES[place])
    }

    /// Start and goal of a line.
    fn ends(&self, fields: &[&str], frame: &GridFrame) -> Result<(Point, Point), String> {
        if fields.len() != self.count {
            let (count, expected) = (fields.len(), self.count);
            return Err(format!("{count} values, but {expected} columns; {EXPECTED}"));
        }
        let number = |column: usize| match fields[column].parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!(
                "the {} is `{}`, expected a number",
                self.name(column),
                shown(fields[column])
            )),
        };
        let place = |what: &str, x: usize, y: usize| {
            let point = Point::new(number(x)?, number(y)?);
            let [x, y] = [x, y].map(|column| shown(fields[column]));
            let outside = || format!("the {what} ({x}, {y}) is outside the map");
            frame.cell_from_world(point).map(|_| point).ok_or_else(outside)
        };
        let [start_x, start_y, goal_x, goal_y] = self.coordinates;
        Ok((place("start", start_x, start_y)?, place("goal", goal_x, goal_y)?))
    }
}

/// One query in each line. The first line may be a header, which names the columns; without one they are
/// [`COORDINATES`]. With a column `map`, only lines of this map count ([`MapNames::named`]). Empty lines, and
/// those that begin with `#`, are left out. Errors come with their line, from 1.
pub(super) fn ends_of_pairs(
    text: &str,
    (names, map): (&MapNames, usize),
    frame: &GridFrame,
) -> Result<Vec<Ends>, (usize, String)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().map(str::trim).enumerate().map(|(i, line)| (i + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let is_header = |line: &str| line.split(',').all(|word| word.trim().parse::<f64>().is_err());
    let columns = match lines.next_if(|(_, line)| is_header(line)) {
        Some((number, header)) => {
            Columns::of_header(header).map_err(|message| (number, message))?
        }
        None => Columns::USUAL,
    };
    let mut all = Vec::new();
    for (number, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let of = columns.map.and_then(|column| fields.get(column)).map(|name| names.named(name));
        let of = of.transpose().map_err(|message| (number, message))?;
        if of.is_none_or(|of| of == Some(map)) {
            let ends = columns.ends(&fields, frame).map_err(|message| (number, message))?;
            all.extend(Ends::of_points(frame, ends, number));
        }
    }
    if !all.is_empty() {
        return Ok(all);
    }
    Err(match columns.map {
        Some(_) => (1, format!("the column `map` names {} in no line", names.name(map))),
        None => (1, format!("there is no pair, {EXPECTED}")),
    })
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

    fn ends_of_map(text: &str, map: &str) -> Result<Vec<Ends>, (usize, String)> {
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
            ("0,0,1,x", 1, "the goal_y is `x`, expected a number"),
            ("0,0,1,inf", 1, "`inf`"),
            ("H\nb,c,d,e", 2, "`b`"),
            ("0,0,1,1\n0,0,3.5,1", 2, "the goal (3.5, 1) is outside the map"),
            ("-2,0,1,1", 1, "the start (-2, 0) is outside the map"),
            ("H\n", 1, "no pair"),
            ("", 1, "no pair"),
            ("map,H\nb,0,0,1,1", 1, "names a.map in no line"),
            ("map,H\na,0,0,1", 2, "4 values, but 5 columns"),
            ("map,H\na", 2, "1 values"),
            ("H\na,0,0,1,1", 2, "5 values"),
            (
                "# old names\nsx,sy,gx,gy\n0,0,1,1",
                2,
                "`sx` is not a column of pairs, expected start_x,",
            ),
            ("H,name\n0,0,1,1,a", 1, "`name` is not a column"),
            ("map_m,H\na,0,0,1,1", 1, "`map_m` is not a column"),
            ("start_x,start_y,goal_x,map\n0,0,1,a", 1, "the column `goal_y` is missing, expected"),
            ("H,goal_x_m\n0,0,1,1,2", 1, "the column `goal_x_m` is given twice"),
        ] {
            let text = text.replace('H', HEADER);
            let (number, message) = ends_of_map(&text, "a.map").unwrap_err();
            assert!(number == line && message.contains(part), "{text}: {number} {message}");
        }
    }

    #[test]
    fn a_column_says_of_which_map_a_line_is() {
        // Positions of other maps are not looked at.
        let text = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\na,0,0,0,0\nb.yaml,99,0,0,0\nx/a.map,1,0,0,0";
        let starts = |text: &str, map: &str| -> Vec<f64> {
            let ends = ends_of_map(text, map).unwrap();
            ends.iter().map(|ends| ends.start.x).collect()
        };
        assert_eq!(starts(text, "/y/x/a.map"), [0.0, 1.0]);
        assert_eq!(starts(text, "y/a.map"), [0.0]);
        // Wherever it stands.
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
        let (line, message) = of("x/map,0,0,0,0\nmap,0,0,0,0", 0).unwrap_err();
        assert!(line == 3 && message.contains("write x/map.yaml or y/map.yaml"), "{message}");
    }
}
