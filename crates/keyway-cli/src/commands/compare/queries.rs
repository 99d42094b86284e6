//! Which starts and goals are compared: random ones, those of a file of pairs, or those of a scenario
//! file.

use crate::args::CompareArgs;
use crate::error::{CliError, Kind};
use crate::inputs::read_text;
use keyway::geometry::Point;
use keyway::map::formats::{Scenario, read_scenarios_for};
use keyway::map::{Cell, Connectivity, GridFrame, SearchMap};
use keyway::search::random_queries;
use std::path::Path;

/// Queries on each map where no file gives any.
const RANDOM_QUERIES: usize = 10;

/// A start and a goal, and the cells in which they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) start: Point,
    pub(super) goal: Point,
    pub(super) start_cell: Cell,
    pub(super) goal_cell: Cell,
}

impl Ends {
    fn of_cells(frame: &GridFrame, start_cell: Cell, goal_cell: Cell) -> Self {
        let [start, goal] = [start_cell, goal_cell].map(|cell| frame.world_from_cell(cell));
        Self { start, goal, start_cell, goal_cell }
    }
}

/// The queries on one map; of a file all, or so many of them, evenly spread.
pub(super) fn queries(
    args: &CompareArgs,
    file: &Path,
    map: &SearchMap,
) -> Result<Vec<Ends>, CliError> {
    let frame = map.frame();
    let all = if let Some(path) = &args.pairs {
        let text = read_text(path, "--pairs")?;
        let blame = |line: usize, message: String| {
            let message = format!("{}: line {line}: {message}", path.display());
            CliError::new(Kind::Input, message).field("--pairs")
        };
        ends_of_pairs(&text, file, frame).map_err(|(line, message)| blame(line, message))?
    } else if let Some(path) = &args.scen {
        ends_of_scenarios(path, file, frame)?
    } else {
        return random_ends(args, map);
    };
    Ok(spread(all, args.queries))
}

/// Connected for every planner: also for those that do not cut corners.
fn random_ends(args: &CompareArgs, map: &SearchMap) -> Result<Vec<Ends>, CliError> {
    let count = args.queries.unwrap_or(RANDOM_QUERIES);
    let queries = random_queries(map, Connectivity::Four, count, args.seed);
    if queries.is_empty() {
        let message = "the map has no two free cells that are connected";
        return Err(CliError::new(Kind::Input, message).field("MAP"));
    }
    Ok(queries.iter().map(|query| Ends::of_cells(map.frame(), query.start, query.goal)).collect())
}

fn ends_of_scenarios(path: &Path, map: &Path, frame: &GridFrame) -> Result<Vec<Ends>, CliError> {
    let blame = |message: String| CliError::new(Kind::Input, message).field("--scen");
    let scenarios = read_scenarios_for(path, frame).map_err(|error| blame(error.to_string()))?;
    // Many maps have the same size: without the name, those of another map would pass for this one's.
    let is_other = |one: &&Scenario| Path::new(&one.map).file_stem() != map.file_stem();
    if let Some(Scenario { line, map: other, .. }) = scenarios.iter().find(is_other) {
        let (path, map) = (path.display(), map.display());
        return Err(blame(format!("{path}: line {line}: for the map {other}, not for {map}")));
    }
    if scenarios.is_empty() {
        return Err(blame(format!("{}: there is no scenario", path.display())));
    }
    Ok(scenarios.iter().map(|one| Ends::of_cells(frame, one.start, one.goal)).collect())
}

/// One query in each line: `start_x,start_y,goal_x,goal_y` in metres. The first line may be a header; when
/// it has a column `map`, only lines of this map count, and that column says of which one a line is
/// ([`is_of_map`]). Empty lines, and those that begin with `#`, are left out. Errors come with their line,
/// from 1.
fn ends_of_pairs(text: &str, map: &Path, frame: &GridFrame) -> Result<Vec<Ends>, (usize, String)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().map(str::trim).enumerate().map(|(i, line)| (i + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let is_header = |line: &str| line.split(',').all(|word| word.trim().parse::<f64>().is_err());
    let header = lines.next_if(|(_, line)| is_header(line)).map_or("", |(_, line)| line);
    let map_column = header.split(',').position(|name| name.trim() == "map");
    let mut all = Vec::new();
    for (number, line) in lines {
        let mut fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let of = map_column.filter(|&column| column < fields.len());
        let of = of.map(|column| fields.remove(column));
        if of.is_none_or(|name| is_of_map(name, map)) {
            all.push(ends_of_fields(&fields, frame).map_err(|message| (number, message))?);
        }
    }
    if !all.is_empty() {
        return Ok(all);
    }
    Err(match map_column {
        Some(_) => (1, format!("the column `map` names {} in no line", map.display())),
        None => (1, "there is no pair, expected start_x,start_y,goal_x,goal_y".to_owned()),
    })
}

/// Whether a name is that of a map: its file's name without the extension, or its path, or the end of its
/// path.
fn is_of_map(name: &str, map: &Path) -> bool {
    let name = Path::new(name.strip_prefix("./").unwrap_or(name));
    let whole = std::path::absolute(map).unwrap_or_else(|_| map.to_owned());
    // Every path ends with the empty one.
    let has_name = name.file_name().is_some();
    has_name && (map == name || whole.ends_with(name) || map.file_stem() == Some(name.as_os_str()))
}

fn ends_of_fields(fields: &[&str], frame: &GridFrame) -> Result<Ends, String> {
    let [start_x, start_y, goal_x, goal_y] = *fields else {
        let count = fields.len();
        return Err(format!(
            "{count} coordinates, expected 4: start_x,start_y,goal_x,goal_y in metres (and a column \
             `map` when the header has one)"
        ));
    };
    let number = |text: &str| match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{text}` is not a number")),
    };
    let place = |what: &str, x: &str, y: &str| {
        let point = Point::new(number(x)?, number(y)?);
        let cell = frame.cell_from_world(point);
        let outside = || format!("the {what} ({x}, {y}) is outside the map");
        cell.map(|cell| (point, cell)).ok_or_else(outside)
    };
    let (start, start_cell) = place("start", start_x, start_y)?;
    let (goal, goal_cell) = place("goal", goal_x, goal_y)?;
    Ok(Ends { start, goal, start_cell, goal_cell })
}

/// So many of them, evenly spread, the first one among them; all, where nothing is said.
fn spread<T>(all: Vec<T>, count: Option<usize>) -> Vec<T> {
    let total = all.len();
    let Some(count) = count.filter(|&count| count < total) else { return all };
    let is_kept = |i: usize| (i * count).div_ceil(total) != ((i + 1) * count).div_ceil(total);
    all.into_iter().enumerate().filter(|&(i, _)| is_kept(i)).map(|(_, item)| item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Pose;

    fn frame() -> GridFrame {
        GridFrame::new(8, 4, 0.5, Pose::new(-1.0, 0.0, 0.0)).unwrap()
    }

    #[test]
    fn pairs_by_hand() {
        let text =
            "\u{feff}start_x,start_y,goal_x,goal_y\r\n# a remark\n\n-0.75, 0.25,2.9,1.9\r\n0,0,0,0";
        let ends = ends_of_pairs(text, Path::new("a.map"), &frame()).unwrap();
        let cells: Vec<[Cell; 2]> = ends.iter().map(|e| [e.start_cell, e.goal_cell]).collect();
        let expected = [[(0, 0), (7, 3)], [(2, 0), (2, 0)]];
        assert_eq!(cells, expected.map(|pair| pair.map(|(x, y)| Cell::new(x, y))));
        assert_eq!((ends[0].start, ends[0].goal), (Point::new(-0.75, 0.25), Point::new(2.9, 1.9)));
        assert_eq!(
            ends_of_pairs("0,0,1,1", Path::new("a.map"), &frame()).unwrap().len(),
            1,
            "no header"
        );
    }

    #[test]
    fn errors_name_the_line() {
        for (text, line, part) in [
            ("a,b,c,d\n0,0,1,1\n\n0,0,1", 4, "3 coordinates"),
            ("0,0,1,x", 1, "`x` is not a number"),
            ("0,0,1,inf", 1, "`inf`"),
            ("a,b,c,d\nb,c,d,e", 2, "`b`"),
            ("0,0,1,1\n0,0,3.5,1", 2, "the goal (3.5, 1) is outside the map"),
            ("-2,0,1,1", 1, "the start (-2, 0) is outside the map"),
            ("start_x,start_y,goal_x,goal_y\n", 1, "no pair"),
            ("", 1, "no pair"),
            ("map,a,b,c,d\nb,0,0,1,1", 1, "names a.map in no line"),
            ("map,a,b,c,d\na,0,0,1", 2, "3 coordinates"),
            ("map,a,b,c,d\na", 2, "0 coordinates"),
            ("a,b,c,d\na,0,0,1,1", 2, "5 coordinates"),
        ] {
            let (number, message) = ends_of_pairs(text, Path::new("a.map"), &frame()).unwrap_err();
            assert!(number == line && message.contains(part), "{text}: {number} {message}");
        }
    }

    #[test]
    fn a_column_says_of_which_map_a_line_is() {
        // Positions of other maps are not looked at.
        let text = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\na,0,0,0,0\nb.yaml,99,0,0,0\nx/a.map,1,0,0,0";
        let starts = |text: &str, map: &str| -> Vec<f64> {
            let ends = ends_of_pairs(text, Path::new(map), &frame()).unwrap();
            ends.iter().map(|ends| ends.start.x).collect()
        };
        assert_eq!(starts(text, "/y/x/a.map"), [0.0, 1.0]);
        assert_eq!(starts(text, "y/a.map"), [0.0]);
        // Wherever it stands.
        assert_eq!(starts("sx,sy,gx,gy,map\n1,0,0,0,b\n2,0,0,0,a\n", "a.yaml"), [2.0]);
        for (name, is_right) in [
            ("x/a.map", true),
            ("./x/a.map", true),
            ("a.map", true),
            ("a", true),
            ("a.yaml", false),
            ("/x/a.map", false),
            ("b/a.map", false),
            ("", false),
        ] {
            assert_eq!(is_of_map(name, Path::new("x/a.map")), is_right, "{name}");
        }
    }

    #[test]
    fn evenly_spread() {
        let all = |count| spread((0..10).collect(), count);
        assert_eq!(all(None), (0..10).collect::<Vec<i32>>());
        assert_eq!(all(Some(99)).len(), 10);
        assert_eq!((all(Some(2)), all(Some(1))), (vec![0, 5], vec![0]));
        for count in 1..=10 {
            assert_eq!((all(Some(count)).len(), all(Some(count))[0]), (count, 0));
        }
    }
}
