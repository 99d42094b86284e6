//! The YAML file of the map server of ROS, which says how an image is a map.
//!
//! | field | meaning | when missing |
//! |---|---|---|
//! | `image` | image file, absolute or relative to the folder of the YAML file | error |
//! | `resolution` | side of a cell \[m\] | error |
//! | `origin` | `[x, y, yaw]` of the lower-left corner \[m, m, rad\] | error |
//! | `negate` | white is occupied: 0, 1 or a boolean | error |
//! | `occupied_thresh`, `free_thresh` | see [`CellRule`] | error |
//! | `mode` | `trinary`, `scale` or `raw` | `trinary` |
//!
//! The fields that Nav2 requires are required here; other fields are ignored, as there.

use super::ImagePlacement;
use super::rule::{CellRule, MapMode};
use super::text::{TextError, shown, text_from_bytes};
use crate::geometry::Pose;
use crate::map::{GridFrame, OccupancyGrid, is_origin};
use serde::Deserialize;
use serde_saphyr::{DuplicateKeyPolicy, Location, Spanned};
use thiserror::Error;

const IMAGE: &str = "the name of an image file";
const RESOLUTION: &str = "a number of metres per cell from 1e-6 to 1e6";
const ORIGIN: &str = "three numbers [x, y, yaw] in metres and radians, up to 1e9";
const NEGATE: &str = "0, 1, true or false";
const THRESHOLD: &str = "an occupancy from 0 to 1";
const MODE: &str = "trinary, scale or raw";

/// What each field should be.
const EXPECTED: [(&str, &str); 7] = [
    ("image", IMAGE),
    ("resolution", RESOLUTION),
    ("origin", ORIGIN),
    ("negate", NEGATE),
    ("occupied_thresh", THRESHOLD),
    ("free_thresh", THRESHOLD),
    ("mode", MODE),
];

/// Letters of a wrong value that are shown.
const SHOWN: usize = 40;

/// What the YAML file of a map says.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The image file, absolute or relative to the folder of the YAML file.
    pub image: String,
    /// Where the map lies.
    pub placement: ImagePlacement,
    /// How pixels become cells.
    pub rule: CellRule,
}

/// What is wrong with the YAML file of a map.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RosMapError {
    /// Not UTF-8.
    #[error(transparent)]
    Text(#[from] TextError),
    /// Not YAML, or not a mapping with the right kinds of values.
    #[error("line {line}, column {column}: {reason}")]
    Syntax {
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: u64,
        /// What is wrong there.
        reason: String,
    },
    /// A field that is not there.
    #[error("the field `{field}` is missing, expected {expected}")]
    Missing {
        /// Its name.
        field: &'static str,
        /// What would be right.
        expected: &'static str,
    },
    /// A field of another kind or out of range.
    #[error("line {line}: `{field}` is {got}, expected {expected}")]
    Field {
        /// Line, from 1.
        line: u64,
        /// Its name.
        field: &'static str,
        /// What was found there.
        got: String,
        /// What would be right.
        expected: &'static str,
    },
}

/// The fields as they are written. Numbers are read as text, so that this module, not the parser,
/// says what was expected of which field.
#[derive(Deserialize)]
#[serde(expecting = "a mapping with the fields of a map (image, resolution, origin, ...)")]
struct Fields {
    image: Option<Spanned<String>>,
    resolution: Option<Spanned<String>>,
    origin: Option<Spanned<Vec<String>>>,
    negate: Option<Spanned<String>>,
    occupied_thresh: Option<Spanned<String>>,
    free_thresh: Option<Spanned<String>>,
    mode: Option<Spanned<String>>,
}

impl RosMap {
    /// Reads the content of a YAML file.
    ///
    /// # Errors
    /// When it is not YAML, or a field is missing or not usable.
    pub fn parse(bytes: &[u8]) -> Result<Self, RosMapError> {
        let text = text_from_bytes(bytes)?;
        let options = serde_saphyr::options! {
            with_snippet: false,
            duplicate_keys: DuplicateKeyPolicy::Error,
        };
        let fields: Fields = serde_saphyr::from_str_with_options(text, options)
            .map_err(|error| unreadable(&error, text))?;
        let mode = fields.mode.map_or(Ok(MapMode::Trinary), |mode| parse_mode(&mode))?;
        Ok(Self {
            image: parse_image(fields.image)?,
            placement: ImagePlacement {
                resolution_m: parse_resolution(fields.resolution)?,
                origin: parse_origin(fields.origin)?,
            },
            rule: CellRule {
                mode,
                negate: parse_negate(fields.negate)?,
                occupied_thresh: parse_threshold("occupied_thresh", fields.occupied_thresh)?,
                free_thresh: parse_threshold("free_thresh", fields.free_thresh)?,
            },
        })
    }

    /// The description with which `grid` is written, its picture in the file `image`: trinary, or
    /// raw for a grid with values.
    pub fn for_grid(grid: &OccupancyGrid, image: String) -> Self {
        let rule = grid.thresholds().map_or(CellRule::IMAGE, |thresholds| CellRule {
            mode: MapMode::Raw,
            negate: false,
            occupied_thresh: f64::from(thresholds.occupied()) / 100.0,
            free_thresh: f64::from(thresholds.free()) / 100.0,
        });
        let frame = grid.frame();
        Self {
            image,
            placement: ImagePlacement {
                resolution_m: frame.resolution_m(),
                origin: frame.origin(),
            },
            rule,
        }
    }

    /// The content of a YAML file. Numbers are written so that they are read back bit by bit.
    pub fn to_yaml(&self) -> String {
        let ImagePlacement { resolution_m, origin: Pose { x, y, theta } } = self.placement;
        let CellRule { mode, negate, occupied_thresh, free_thresh } = self.rule;
        let image = quoted(&self.image);
        let mode = match mode {
            MapMode::Trinary => "trinary",
            MapMode::Scale => "scale",
            MapMode::Raw => "raw",
        };
        let negate = u8::from(negate);
        format!(
            "image: {image}\nmode: {mode}\nresolution: {resolution_m}\n\
             origin: [{x}, {y}, {theta}]\nnegate: {negate}\n\
             occupied_thresh: {occupied_thresh}\nfree_thresh: {free_thresh}\n"
        )
    }
}

/// What is wrong where the parser of YAML stops, in words that say what to change.
fn unreadable(error: &serde_saphyr::Error, text: &str) -> RosMapError {
    use serde_saphyr::Error;
    let at = error.location().unwrap_or(Location::UNKNOWN);
    let (line, column) = (at.line().max(1), at.column().max(1));
    let reason = match error {
        Error::MultipleDocuments { .. } => {
            "a second document begins here, expected one; remove the line `---` and what is not the map's"
        }
        Error::DuplicateMappingKey { .. } => "a field is given twice, expected each field once",
        Error::Budget { .. } => "there is far more here than the YAML file of a map can hold",
        Error::AliasError { .. }
        | Error::UnknownAnchor { .. }
        | Error::RecursiveReferencesRequireWeakTypes { .. }
        | Error::AliasReplayLimitExceeded { .. }
        | Error::AliasExpansionLimitExceeded { .. }
        | Error::AliasReplayStackDepthExceeded { .. } => {
            "an alias (`*name`) cannot be resolved; write the value in its place"
        }
        _ => return unexpected(text, line, column),
    };
    RosMapError::Syntax { line, column, reason: reason.to_owned() }
}

/// Something other than a field, or a field with another kind of value.
fn unexpected(text: &str, line: u64, column: u64) -> RosMapError {
    if let Some(line) = indented_by_tab(text, line) {
        let reason = "the line begins with a tab, expected spaces or nothing before a field";
        return RosMapError::Syntax { line, column: 1, reason: reason.to_owned() };
    }
    let written = text.lines().nth(line as usize - 1).unwrap_or_default();
    let (name, value) = written.split_once(':').unwrap_or_default();
    let expected = EXPECTED.iter().find(|(field, _)| *field == name.trim());
    if let Some(&(field, expected)) = expected.filter(|_| !value.trim().is_empty()) {
        return RosMapError::Field { line, field, got: shown(value.trim(), SHOWN), expected };
    }
    let reason = "expected lines of the form `field: value`, such as `resolution: 0.05`";
    RosMapError::Syntax { line, column, reason: reason.to_owned() }
}

/// The line with a tab in its indentation, if it is the one at which the parser stopped, or one beside
/// that: the parser blames the field whose value the tab breaks.
fn indented_by_tab(text: &str, stopped: u64) -> Option<u64> {
    let has_tab = |line: &str| {
        line.chars().take_while(|letter| letter.is_whitespace()).any(|letter| letter == '\t')
    };
    let mut lines = text.lines().zip(1..).filter(|(_, number)| stopped.abs_diff(*number) <= 1);
    lines.find(|(line, _)| has_tab(line)).map(|(_, number)| number)
}

fn required<T>(
    field: &'static str,
    value: Option<T>,
    expected: &'static str,
) -> Result<T, RosMapError> {
    value.ok_or(RosMapError::Missing { field, expected })
}

fn wrong<T>(
    field: &'static str,
    value: &Spanned<T>,
    got: impl Into<String>,
    expected: &'static str,
) -> RosMapError {
    let got = shown(&got.into(), SHOWN);
    RosMapError::Field { line: value.referenced.line(), field, got, expected }
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

fn parse_image(value: Option<Spanned<String>>) -> Result<String, RosMapError> {
    let image = required("image", value, IMAGE)?;
    if image.value.is_empty() {
        return Err(wrong("image", &image, "empty", IMAGE));
    }
    Ok(image.value)
}

fn parse_resolution(value: Option<Spanned<String>>) -> Result<f64, RosMapError> {
    let text = required("resolution", value, RESOLUTION)?;
    let number = finite(&text.value).filter(|number| GridFrame::RESOLUTIONS_M.contains(number));
    number.ok_or_else(|| wrong("resolution", &text, &text.value, RESOLUTION))
}

fn parse_origin(value: Option<Spanned<Vec<String>>>) -> Result<Pose, RosMapError> {
    let parts = required("origin", value, ORIGIN)?;
    let numbers: Option<Vec<f64>> = parts.value.iter().map(|part| finite(part)).collect();
    if let Some(&[x, y, yaw]) = numbers.as_deref()
        && is_origin(Pose::new(x, y, yaw))
    {
        return Ok(Pose::new(x, y, yaw));
    }
    let got = format!("[{}]", parts.value.join(", "));
    Err(wrong("origin", &parts, got, ORIGIN))
}

fn parse_negate(value: Option<Spanned<String>>) -> Result<bool, RosMapError> {
    let text = required("negate", value, NEGATE)?;
    match text.value.to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "off" | "n" => Ok(false),
        "1" | "true" | "yes" | "on" | "y" => Ok(true),
        _ => Err(wrong("negate", &text, &text.value, NEGATE)),
    }
}

fn parse_threshold(
    field: &'static str,
    value: Option<Spanned<String>>,
) -> Result<f64, RosMapError> {
    let text = required(field, value, THRESHOLD)?;
    let number = finite(&text.value).filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| wrong(field, &text, &text.value, THRESHOLD))
}

fn parse_mode(text: &Spanned<String>) -> Result<MapMode, RosMapError> {
    match text.value.to_ascii_lowercase().as_str() {
        "trinary" => Ok(MapMode::Trinary),
        "scale" => Ok(MapMode::Scale),
        "raw" => Ok(MapMode::Raw),
        _ => Err(wrong("mode", text, &text.value, MODE)),
    }
}

/// A YAML scalar; in quotes unless it is plainly a file name.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain) {
        return text.to_owned();
    }
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            // Line ends would be folded, other control characters are not allowed.
            _ if c.is_control() || "\u{2028}\u{2029}\u{feff}".contains(c) => {
                quoted.push_str("\\u");
                for shift in [12, 8, 4, 0] {
                    quoted.extend(char::from_digit(u32::from(c) >> shift & 0xf, 16));
                }
            }
            _ => quoted.push(c),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DEPOT: &str = "image: depot.pgm\nmode: trinary\nresolution: 0.05\n\
        origin: [1.5, -2, 0.25]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

    fn parse(text: &str) -> Result<RosMap, RosMapError> {
        RosMap::parse(text.as_bytes())
    }

    /// [`DEPOT`] with one line replaced.
    fn with(field: &str, line: &str) -> Result<RosMap, RosMapError> {
        let lines = DEPOT.lines().map(|old| if old.starts_with(field) { line } else { old });
        parse(&lines.collect::<Vec<_>>().join("\n"))
    }

    fn depot() -> RosMap {
        RosMap {
            image: "depot.pgm".to_owned(),
            placement: ImagePlacement { resolution_m: 0.05, origin: Pose::new(1.5, -2.0, 0.25) },
            rule: CellRule::IMAGE,
        }
    }

    #[test]
    fn as_published() {
        assert_eq!(parse(DEPOT), Ok(depot()));
        assert_eq!(with("mode", "# -3.071 3.583"), Ok(depot()));
        assert_eq!(with("mode", "cell: {size: [1, 2], ? x : !thing y}"), Ok(depot()));
        assert_eq!(parse(&format!("---\n{}", DEPOT.replace('\n', "\r\n"))), Ok(depot()));
        assert_eq!(parse(&format!("\u{feff}{DEPOT}")), Ok(depot()));
        assert_eq!(with("origin", "origin:\n  - 1.5\n  - -2.0\n  - 2.5e-1"), Ok(depot()));
    }

    #[test]
    fn modes_and_negation() {
        for (text, mode) in [("Raw", MapMode::Raw), ("scale", MapMode::Scale)] {
            assert_eq!(with("mode", &format!("mode: {text}")).unwrap().rule.mode, mode);
        }
        for (text, negate) in [("1", true), ("true", true), ("False", false), ("no", false)] {
            assert_eq!(with("negate", &format!("negate: {text}")).unwrap().rule.negate, negate);
        }
        assert_eq!(with("image", "image: 7").unwrap().image, "7");
        let swapped = with("free", "free_thresh: 0.9").unwrap();
        assert_eq!((swapped.rule.free_thresh, swapped.rule.occupied_thresh), (0.9, 0.65));
    }

    #[test]
    fn a_tab_is_blamed_on_its_own_line() {
        for (field, tab, line) in [
            ("image", "\timage: depot.pgm", 1),
            ("mode", "\tmode: trinary", 2),
            ("resolution", "  \tresolution: 0.05", 3),
            ("origin", "origin:\n\t- 1.5\n\t- -2\n\t- 0.25", 5),
            ("free", "\tfree_thresh: 0.196", 7),
        ] {
            let text = with(field, tab).unwrap_err().to_string();
            let expected = format!("line {line}, column 1: the line begins with a tab, expected");
            assert!(text.starts_with(&expected), "{text}");
        }
        let between = DEPOT.replace(": ", ":\t");
        assert_eq!(parse(&between), Ok(depot()), "a tab may stand before a value");
    }

    #[test]
    fn missing_fields_are_named() {
        for field in ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"] {
            for line in ["", &format!("{field}:")] {
                let error = with(field, line).unwrap_err();
                assert!(matches!(error, RosMapError::Missing { .. }), "{field}: {error}");
                let text = format!("the field `{field}` is missing, expected ");
                assert!(error.to_string().starts_with(&text), "{error}");
            }
        }
        assert!(matches!(parse(""), Err(RosMapError::Missing { field: "image", .. })));
        assert!(matches!(parse("a: b"), Err(RosMapError::Missing { field: "image", .. })));
    }

    #[test]
    fn unusable_fields_are_named_with_line_and_expectation() {
        let cases = [
            ("image", "\"\"", 1, "a file"),
            ("mode", "binary", 2, "trinary, scale or raw"),
            ("resolution", "0", 3, "a number of metres per cell"),
            ("resolution", "-0.05", 3, "a number of metres per cell"),
            ("resolution", ".nan", 3, "a number of metres per cell"),
            ("resolution", "NaN", 3, "a number of metres per cell"),
            ("resolution", "1e999", 3, "a number of metres per cell"),
            ("resolution", "5 cm", 3, "a number of metres per cell"),
            ("resolution", "1e7", 3, "a number of metres per cell from 1e-6 to 1e6"),
            ("resolution", "1e-300", 3, "a number of metres per cell from 1e-6 to 1e6"),
            ("origin", "[1e300, 0, 0]", 4, "up to 1e9"),
            ("origin", "[1, 2]", 4, "three numbers [x, y, yaw]"),
            ("origin", "[1, 2, 3, 4]", 4, "three numbers [x, y, yaw]"),
            ("origin", "[1, 2, .inf]", 4, "three numbers [x, y, yaw]"),
            ("negate", "2", 5, "0, 1, true or false"),
            ("occupied_thresh", "nan", 6, "an occupancy from 0 to 1"),
            ("free_thresh", "-0.1", 7, "an occupancy from 0 to 1"),
        ];
        for (name, value, at, text) in cases {
            let error = with(name, &format!("{name}: {value}")).unwrap_err();
            let RosMapError::Field { line, field, expected, .. } = &error else {
                panic!("{name}: {error}")
            };
            assert_eq!((*line, *field), (at, name), "{error}");
            assert!(expected.contains(text) || name == "image", "{error}");
            assert!(error.to_string().starts_with(&format!("line {at}: `{name}` is ")), "{error}");
        }
        let error = with("origin", "origin: [1, b, .inf]").unwrap_err();
        assert_eq!(
            error.to_string(),
            "line 4: `origin` is [1, b, .inf], expected three numbers [x, y, yaw] in metres and \
             radians, up to 1e9"
        );
    }

    #[test]
    fn what_is_not_such_a_mapping() {
        let duplicate = format!("{DEPOT}mode: raw\n");
        let cases = [
            ("- a\n- b\n", 1),
            ("[", 1),
            ("image: a\n---\nimage: b\n", 3),
            ("x\n", 1),
            (&duplicate, 8),
        ];
        for (text, at) in cases {
            let error = parse(text).unwrap_err();
            let RosMapError::Syntax { line, reason, .. } = &error else { panic!("{error}") };
            assert!(*line == at && !reason.is_empty(), "{text}: {error}");
            assert_eq!(error.to_string().matches("column").count(), 1, "{error}");
        }
        for (field, value, at) in
            [("origin", "3", 4), ("image", "[a, b]", 1), ("negate", "{a: b}", 5)]
        {
            let error = with(field, &format!("{field}: {value}")).unwrap_err();
            let text = error.to_string();
            assert!(
                text.starts_with(&format!("line {at}: `{field}` is {value}, expected ")),
                "{text}"
            );
        }
        let error = RosMap::parse(b"image: a\nmode: \xff\n").unwrap_err();
        assert!(matches!(error, RosMapError::Text(_)));
        assert!(error.to_string().starts_with("line 2"), "{error}");
    }

    #[test]
    fn names_that_need_quotes() {
        assert_eq!(quoted("maps/a-b_1.pgm"), "maps/a-b_1.pgm");
        assert_eq!(quoted("a b: \"c\"\n.pgm"), "\"a b: \\\"c\\\"\\u000a.pgm\"");
    }

    proptest! {
        #[test]
        fn written_is_read_back(image in "\\PC{1,20}|[a-z\n\t\"\\\\:#' ]{1,9}", x in -1e9..1e9f64, y in -1e3..1e3f64,
                                yaw in -3.1..3.1f64, resolution_m in 1e-6..1e6f64, negate: bool,
                                thresholds in (0.0..=1.0, 0.0..=1.0), mode in 0..3usize) {
            let (occupied_thresh, free_thresh) = thresholds;
            let mode = [MapMode::Trinary, MapMode::Scale, MapMode::Raw][mode];
            let map = RosMap {
                image,
                placement: ImagePlacement { resolution_m, origin: Pose::new(x, y, yaw) },
                rule: CellRule { mode, negate, occupied_thresh, free_thresh },
            };
            prop_assert_eq!(parse(&map.to_yaml()), Ok(map.clone()), "{}", map.to_yaml());
        }

        #[test]
        fn nothing_panics(bytes: Vec<u8>, at in 0..DEPOT.len(), text in "\\PC{0,4}|[\\[\\]{}:&*!|>\n -]{0,6}") {
            let _ = RosMap::parse(&bytes);
            let mutated = format!("{}{text}{}", &DEPOT[..at], &DEPOT[at..]);
            let _ = parse(&mutated);
            let _ = parse(&DEPOT[..at]);
        }
    }
}
