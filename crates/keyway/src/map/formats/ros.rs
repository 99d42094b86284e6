//! The YAML file of the ROS map server, which defines how an image is read as a map.
//!
//! | field | meaning | when missing |
//! |---|---|---|
//! | `image` | image file, absolute or relative to the folder of the YAML file | error |
//! | `resolution` | side of a cell \[m\] | error |
//! | `origin` | `[x, y, yaw]` of the lower-left corner \[m, m, rad\] | error |
//! | `negate` | white is occupied: 0, 1 or a boolean | 0, and a warning |
//! | `occupied_thresh`, `free_thresh` | see [`CellRule`] | 0.65 and 0.196, and a warning |
//! | `mode` | `trinary`, `scale` or `raw` | `trinary` |
//!
//! Nav2 requires `negate` and the thresholds, too. Many files lack them; the values written by
//! the map saver of ROS are then used ([`CellRule::IMAGE`]). Other fields are ignored, as in
//! Nav2.

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

const NEGATE_FIELD: &str = "negate";
const OCCUPIED_FIELD: &str = "occupied_thresh";
const FREE_FIELD: &str = "free_thresh";

/// The expected value of each field.
const EXPECTED: [(&str, &str); 7] = [
    ("image", IMAGE),
    ("resolution", RESOLUTION),
    ("origin", ORIGIN),
    (NEGATE_FIELD, NEGATE),
    (OCCUPIED_FIELD, THRESHOLD),
    (FREE_FIELD, THRESHOLD),
    ("mode", MODE),
];

/// Number of characters of a wrong value that are shown.
const SHOWN: usize = 40;

/// Content of the YAML file of a map.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RosMap {
    /// The image file, absolute or relative to the folder of the YAML file.
    pub image: String,
    /// Resolution and origin of the map.
    pub placement: ImagePlacement,
    /// Rule that converts pixels to cells.
    pub rule: CellRule,
    /// The missing fields of the rule, which take their usual values.
    pub assumed: Vec<&'static str>,
}

/// Error in the YAML file of a map.
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
        /// Description of the error.
        reason: String,
    },
    /// A missing field.
    #[error("the field `{field}` is missing, expected {expected}")]
    Missing {
        /// Name of the field.
        field: &'static str,
        /// Expected value.
        expected: &'static str,
    },
    /// A field of another type or out of range.
    #[error("line {line}: `{field}` is {got}, expected {expected}")]
    Field {
        /// Line, from 1.
        line: u64,
        /// Name of the field.
        field: &'static str,
        /// Value found there.
        got: String,
        /// Expected value.
        expected: &'static str,
    },
}

/// The fields as written in the file. Numbers are read as text, so that this module, not the
/// parser, reports which value was expected.
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
    /// Returns [`RosMapError`] if the content is not YAML, or a field is missing or not usable.
    pub fn parse(bytes: &[u8]) -> Result<Self, RosMapError> {
        let text = text_from_bytes(bytes)?;
        let options = serde_saphyr::options! {
            with_snippet: false,
            duplicate_keys: DuplicateKeyPolicy::Error,
        };
        let fields: Fields = serde_saphyr::from_str_with_options(text, options)
            .map_err(|error| unreadable(&error, text))?;
        let mode = fields.mode.map_or(Ok(MapMode::Trinary), |mode| parse_mode(&mode))?;
        let mut assumed = Vec::new();
        let mut usual = |field, is_missing| {
            if is_missing {
                assumed.push(field);
            }
        };
        usual(NEGATE_FIELD, fields.negate.is_none());
        usual(OCCUPIED_FIELD, fields.occupied_thresh.is_none());
        usual(FREE_FIELD, fields.free_thresh.is_none());
        let CellRule { negate, occupied_thresh, free_thresh, .. } = CellRule::IMAGE;
        let threshold = |field, value: Option<Spanned<String>>, usual| {
            value.map_or(Ok(usual), |text| parse_threshold(field, &text))
        };
        Ok(Self {
            image: parse_image(fields.image)?,
            placement: ImagePlacement {
                resolution_m: parse_resolution(fields.resolution)?,
                origin: parse_origin(fields.origin)?,
            },
            rule: CellRule {
                mode,
                negate: fields.negate.map_or(Ok(negate), |text| parse_negate(&text))?,
                occupied_thresh: threshold(
                    OCCUPIED_FIELD,
                    fields.occupied_thresh,
                    occupied_thresh,
                )?,
                free_thresh: threshold(FREE_FIELD, fields.free_thresh, free_thresh)?,
            },
            assumed,
        })
    }

    /// The description for writing `grid`, with its image in the file `image`: trinary, or raw
    /// for a grid with values.
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
            assumed: Vec::new(),
        }
    }

    /// Writes the content of a YAML file. Numbers are written so that they are read back bit by
    /// bit.
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

/// Converts an error of the YAML parser to one that tells the user what to change.
fn unreadable(error: &serde_saphyr::Error, text: &str) -> RosMapError {
    use serde_saphyr::Error;
    let at = error.location().unwrap_or(Location::UNKNOWN);
    let (line, column) = (at.line().max(1), at.column().max(1));
    let reason = match error {
        Error::MultipleDocuments { .. } => {
            "a second document begins here, expected one; remove the line `---` and everything \
             that does not belong to the map"
        }
        Error::DuplicateMappingKey { .. } => "a field is given twice, expected each field once",
        Error::Budget { .. } => {
            "the content is too large or too complex for the YAML file of a map"
        }
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

/// Error for content that is not a field, or for a field with another type of value.
fn unexpected(text: &str, line: u64, column: u64) -> RosMapError {
    if let Some(line) = indented_by_tab(text, line) {
        let reason = "the line begins with a tab, expected spaces or nothing before a field";
        return RosMapError::Syntax { line, column: 1, reason: reason.to_owned() };
    }
    if let Some((field, line, column)) = without_space(text) {
        let reason = format!("YAML needs a space after the colon, such as `{field}: ...`");
        return RosMapError::Syntax { line, column, reason };
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

/// The line with a tab in its indentation, if it is the line at which the parser stopped or one
/// next to it: the parser reports the field whose value the tab breaks.
fn indented_by_tab(text: &str, stopped: u64) -> Option<u64> {
    let has_tab = |line: &str| {
        line.chars().take_while(|letter| letter.is_whitespace()).any(|letter| letter == '\t')
    };
    let mut lines = text.lines().zip(1..).filter(|(_, number)| stopped.abs_diff(*number) <= 1);
    lines.find(|(line, _)| has_tab(line)).map(|(_, number)| number)
}

/// Name and position of the first field with something other than a space after its colon. For
/// YAML it is part of the value before it, so the parser reports another line, or none.
fn without_space(text: &str) -> Option<(&'static str, u64, u64)> {
    let of_line = |(line, number): (&str, u64)| {
        let start = line.trim_start_matches(['\u{feff}', ' ']);
        let (name, value) = start.split_once(':')?;
        let (field, _) = EXPECTED.iter().find(|(field, _)| *field == name)?;
        let column = (line.chars().count() - value.chars().count()) as u64 + 1;
        let is_split = value.starts_with(|letter: char| !letter.is_whitespace());
        is_split.then_some((*field, number, column))
    };
    text.lines().zip(1..).find_map(of_line)
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

fn parse_negate(text: &Spanned<String>) -> Result<bool, RosMapError> {
    match text.value.to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "off" | "n" => Ok(false),
        "1" | "true" | "yes" | "on" | "y" => Ok(true),
        _ => Err(wrong(NEGATE_FIELD, text, &text.value, NEGATE)),
    }
}

fn parse_threshold(field: &'static str, text: &Spanned<String>) -> Result<f64, RosMapError> {
    let number = finite(&text.value).filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| wrong(field, text, &text.value, THRESHOLD))
}

fn parse_mode(text: &Spanned<String>) -> Result<MapMode, RosMapError> {
    match text.value.to_ascii_lowercase().as_str() {
        "trinary" => Ok(MapMode::Trinary),
        "scale" => Ok(MapMode::Scale),
        "raw" => Ok(MapMode::Raw),
        _ => Err(wrong("mode", text, &text.value, MODE)),
    }
}

/// Writes a YAML scalar, in quotes unless it is a plain file name.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(plain) {
        return text.to_owned();
    }
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            // Line ends would be folded, and other control characters are not allowed.
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
#[path = "ros_tests.rs"]
mod tests;
