//! Scenarios of the MovingAI benchmarks: `.scen` files with starts, goals and optimal lengths.
//!
//! After an optional line `version 1`, each line holds nine fields, separated by tabs or spaces:
//! bucket, map, width and height of the map, start x, start y, goal x, goal y, optimal length.
//! The files count y from the top; here it counts from the bottom, as in all grids. Files of
//! version 0, whose lines have no map size, cannot be converted that way and are rejected.

use super::text::{TextError, numbered_lines, shown, text_from_bytes};
use crate::map::{Cell, GridFrame};
use serde::Serialize;
use thiserror::Error;

/// Number of characters of a wrong field that are shown.
const SHOWN: usize = 40;

/// One line of a `.scen` file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Scenario {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Group of similar lengths.
    pub bucket: u32,
    /// The map's name as written, often with folders that do not exist.
    pub map: String,
    /// Columns of the map that the scenario is for.
    pub width: u32,
    /// Rows of that map.
    pub height: u32,
    /// Start of the path.
    pub start: Cell,
    /// Goal of the path.
    pub goal: Cell,
    /// The published length of the shortest path \[cells\], octile, without cutting corners. 0
    /// for two different cells means that no path exists.
    pub optimal_length: f64,
}

/// Error in a `.scen` file.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// Not UTF-8.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A version that is not 1.
    #[error("line {line}: the version is \"{got}\", expected 1")]
    Version {
        /// Line, from 1.
        line: usize,
        /// Version found there.
        got: String,
    },
    /// A line with too few or too many fields.
    #[error(
        "line {line}: {got} fields, expected 9 (bucket, map, width, height, start x, start y, \
         goal x, goal y, optimal length) separated by tabs, or by spaces if the map's name has none"
    )]
    Fields {
        /// Line, from 1.
        line: usize,
        /// Number of fields.
        got: usize,
    },
    /// A field that is not a usable number.
    #[error("line {line}: the {field} is \"{got}\", expected {expected}")]
    Number {
        /// Line, from 1.
        line: usize,
        /// Name of the field.
        field: &'static str,
        /// Text found there.
        got: String,
        /// Expected value.
        expected: String,
    },
    /// A scenario for a map of another size (such as a scaled one).
    #[error(
        "line {line}: the scenario is for a map of {width} x {height} cells, this map has {map_width} x {map_height}"
    )]
    OtherMap {
        /// Line, from 1.
        line: usize,
        /// Columns according to the scenario.
        width: u32,
        /// Rows according to the scenario.
        height: u32,
        /// Columns of the map.
        map_width: u32,
        /// Rows of the map.
        map_height: u32,
    },
}

impl Scenario {
    /// Checks that the scenario is for a map of this size: otherwise its cells are wrong.
    ///
    /// # Errors
    /// Returns [`ScenarioError`] if the sizes differ.
    pub fn check_map(&self, frame: &GridFrame) -> Result<(), ScenarioError> {
        let &Self { line, width, height, .. } = self;
        let (map_width, map_height) = (frame.width(), frame.height());
        if (width, height) == (map_width, map_height) {
            return Ok(());
        }
        Err(ScenarioError::OtherMap { line, width, height, map_width, map_height })
    }
}

/// Reads the content of a `.scen` file, in the order of its lines.
///
/// # Errors
/// Returns [`ScenarioError`] if a line is not a scenario; the error names the line.
pub fn parse_scenarios(bytes: &[u8]) -> Result<Vec<Scenario>, ScenarioError> {
    let lines = numbered_lines(text_from_bytes(bytes)?);
    let mut lines = lines.filter(|(_, text)| !text.trim_ascii().is_empty()).peekable();
    if let Some(&(line, text)) = lines.peek()
        && let Some(version) = text.trim_ascii().strip_prefix("version")
    {
        let version = version.trim_ascii();
        if version.parse() != Ok(1.0) {
            return Err(ScenarioError::Version { line, got: shown(version, SHOWN) });
        }
        lines.next();
    }
    lines.map(|(line, text)| parse_line(line, text)).collect()
}

fn parse_line(line: usize, text: &str) -> Result<Scenario, ScenarioError> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    // Names with spaces are recognised by the tabs around them.
    let tabbed: Vec<&str> = text.trim_ascii().split('\t').map(str::trim_ascii).collect();
    let fields = if words.len() != 9 && tabbed.len() > 1 { tabbed } else { words };
    let got = fields.len();
    let [bucket, map, width, height, x, y, goal_x, goal_y, length] = fields[..] else {
        return Err(ScenarioError::Fields { line, got });
    };
    let row = Row { line };
    let width = row.number("width", width, 1, i32::MAX as u32)?;
    let height = row.number("height", height, 1, i32::MAX as u32)?;
    let cell = |fields: [&'static str; 2], x, y| -> Result<Cell, ScenarioError> {
        let x = row.number(fields[0], x, 0, width - 1)?;
        let y = row.number(fields[1], y, 0, height - 1)?;
        // Converts y from the top to y from the bottom.
        Ok(Cell::new(x as i32, (height - 1 - y) as i32))
    };
    Ok(Scenario {
        line,
        bucket: row.number("bucket", bucket, 0, u32::MAX)?,
        map: map.to_owned(),
        width,
        height,
        start: cell(["start x", "start y"], x, y)?,
        goal: cell(["goal x", "goal y"], goal_x, goal_y)?,
        optimal_length: row.length(length)?,
    })
}

/// Reads the fields of one line.
struct Row {
    line: usize,
}

impl Row {
    fn number(
        &self,
        field: &'static str,
        got: &str,
        from: u32,
        to: u32,
    ) -> Result<u32, ScenarioError> {
        let number = got.parse().ok().filter(|n| (from..=to).contains(n));
        number.ok_or_else(|| self.wrong(field, got, format!("a whole number from {from} to {to}")))
    }

    fn length(&self, got: &str) -> Result<f64, ScenarioError> {
        let number = got.parse().ok().filter(|n: &f64| n.is_finite() && *n >= 0.0);
        number.ok_or_else(|| self.wrong("optimal length", got, "a number from 0".to_owned()))
    }

    fn wrong(&self, field: &'static str, got: &str, expected: String) -> ScenarioError {
        ScenarioError::Number { line: self.line, field, got: shown(got, SHOWN), expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use proptest::prelude::*;

    const ROW: &str = "0\tmaps/dao/arena.map\t49\t50\t1\t11\t2\t49\t3.41421";

    fn parse(text: &str) -> Result<Vec<Scenario>, ScenarioError> {
        parse_scenarios(text.as_bytes())
    }

    fn arena(line: usize) -> Scenario {
        Scenario {
            line,
            bucket: 0,
            map: "maps/dao/arena.map".to_owned(),
            width: 49,
            height: 50,
            start: Cell::new(1, 38),
            goal: Cell::new(2, 0),
            optimal_length: 3.41421,
        }
    }

    #[test]
    fn versions_separators_and_line_ends() {
        let spaced = ROW.replace('\t', " ");
        let mixed = ROW.replacen('\t', " ", 3);
        for row in [ROW, &spaced, &mixed, &format!("{ROW}\t "), &format!(" {ROW}\r")] {
            for version in ["version 1", "version 1.0", "version\t1\r"] {
                assert_eq!(parse(&format!("{version}\n{row}\n\n")), Ok(vec![arena(2)]), "{row}");
            }
            assert_eq!(parse(row), Ok(vec![arena(1)]), "{row}");
        }
        assert_eq!(parse("version 1\n"), Ok(vec![]));
        assert_eq!(parse(&format!("version 1\n{ROW}\n\n{ROW}")), Ok(vec![arena(2), arena(4)]));
    }

    #[test]
    fn names_with_spaces_between_tabs() {
        let row = ROW.replace("dao/arena", "Dragon Age/the arena");
        assert_eq!(parse(&row).unwrap()[0].map, "maps/Dragon Age/the arena.map");
        let spaced = row.replace('\t', " ");
        assert!(matches!(parse(&spaced), Err(ScenarioError::Fields { line: 1, got: 11 })));
    }

    #[test]
    fn errors_name_line_and_field() {
        let error = parse("version 2\n").unwrap_err();
        assert!(matches!(error, ScenarioError::Version { line: 1, .. }));
        assert_eq!(error.to_string(), "line 1: the version is \"2\", expected 1");
        assert!(matches!(parse("\nversion\n"), Err(ScenarioError::Version { line: 2, .. })));

        let old = parse("0 maps/a.map 1 2 3 4 5.0").unwrap_err();
        assert_eq!(old, ScenarioError::Fields { line: 1, got: 7 });
        assert!(old.to_string().starts_with("line 1: 7 fields, expected 9 (bucket, map"));

        for (position, value, name) in [
            (0, "-1", "bucket"),
            (2, "0", "width"),
            (3, "4294967296", "height"),
            (4, "49", "start x"),
            (5, "50", "start y"),
            (6, "1.5", "goal x"),
            (7, "x", "goal y"),
            (8, "nan", "optimal length"),
            (8, "-1", "optimal length"),
        ] {
            let mut fields: Vec<_> = ROW.split('\t').collect();
            fields[position] = value;
            let error = parse(&format!("version 1\n{ROW}\n{}", fields.join("\t"))).unwrap_err();
            assert!(matches!(error, ScenarioError::Number { line: 3, .. }), "{error}");
            let start = format!("line 3: the {name} is \"{value}\", expected a ");
            assert!(error.to_string().starts_with(&start), "{error}");
        }
        let error = parse_scenarios(b"version 1\n0\t\xc3").unwrap_err();
        assert!(matches!(error, ScenarioError::Text(TextError { line: 2, column: 3, .. })));
    }

    #[test]
    fn scaled_scenarios_are_refused() {
        let frame = |width, height| GridFrame::new(width, height, 1.0, Pose::default()).unwrap();
        assert_eq!(arena(2).check_map(&frame(49, 50)), Ok(()));
        let error = arena(2).check_map(&frame(98, 100)).unwrap_err();
        assert!(matches!(error, ScenarioError::OtherMap { .. }));
        assert_eq!(
            error.to_string(),
            "line 2: the scenario is for a map of 49 x 50 cells, this map has 98 x 100"
        );
    }

    proptest! {
        #[test]
        fn nothing_panics(bytes: Vec<u8>, at in 0..ROW.len(), insert in "[0-9a-z.\t\n -]{0,4}") {
            let _ = parse_scenarios(&bytes);
            let _ = parse(&ROW[..at]);
            let _ = parse(&format!("{}{insert}{}", &ROW[..at], &ROW[at..]));
        }
    }
}
