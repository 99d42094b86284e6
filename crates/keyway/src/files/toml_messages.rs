//! The messages of the TOML parser, without names of Rust types.

use super::did_you_mean;
use crate::map::formats::shown;

/// Maximum length of a type with its value, and of a message, which may list all fields
/// \[letters\].
const VALUE_LETTERS: usize = 60;
const MESSAGE_LETTERS: usize = 500;
/// Every integer that TOML can hold has at most this many letters.
const MOST_DIGITS: usize = 20;

/// The message of a parser error, in terms of TOML's value types.
pub(super) fn in_plain_words(message: &str) -> String {
    let message = message.trim();
    if message.contains("recurs") {
        return "arrays and tables are nested too deeply".to_owned();
    }
    if message == "u64 value was too large" {
        return format!("the whole number is too large, expected at most {}", i64::MAX);
    }
    // The parser's messages if a choice between kinds is not a table with one of them.
    match message {
        "wanted exactly 1 element, more than 1 element" => {
            return "give exactly one kind, got several".to_owned();
        }
        "wanted exactly 1 element, found 0 elements" => {
            return "give exactly one kind, got none".to_owned();
        }
        _ => {}
    }
    let Some((got, expected)) = message.rsplit_once(", expected ") else {
        return shown(message, MESSAGE_LETTERS);
    };
    // A number may be followed by its type.
    let got = got.trim_end_matches(" as i128").trim_end_matches(" as u128");
    let got = match got {
        "invalid type: map" => "invalid type: table".to_owned(),
        "invalid type: sequence" => "invalid type: array".to_owned(),
        // The parser's message if a choice between names is not text.
        "invalid type: unit variant" => "invalid type".to_owned(),
        _ => {
            shown(&few_digits(got), VALUE_LETTERS).replacen("unknown variant ", "unknown value ", 1)
        }
    };
    format!("{got}, expected {}{}", kind(expected), name_meant(message))
}

/// Shortens a long number to a power of ten; other numbers keep all digits.
fn few_digits(got: &str) -> String {
    let number = got.strip_suffix('`').and_then(|got| got.split_once('`'));
    let number = number.filter(|(_, number)| number.len() > MOST_DIGITS);
    let parsed = number.and_then(|(before, number)| Some((before, number.parse::<f64>().ok()?)));
    parsed.map_or_else(|| got.to_owned(), |(before, number)| format!("{before}`{number:e}`"))
}

/// The suggested name for a message such as "unknown field `gaol`, expected `start` or `goal`".
fn name_meant(message: &str) -> String {
    if !message.starts_with("unknown") {
        return String::new();
    }
    let mut names = message.split('`').skip(1).step_by(2);
    names.next().map_or_else(String::new, |given| did_you_mean(given, names))
}

/// A value type as `serde` names it.
fn kind(expected: &str) -> String {
    let whole = |least: i64, most: i64| format!("a whole number from {least} to {most}");
    let count: String = expected.chars().filter(char::is_ascii_digit).collect();
    match expected {
        "u8" => whole(0, i64::from(u8::MAX)),
        "u16" => whole(0, i64::from(u16::MAX)),
        "u32" => whole(0, i64::from(u32::MAX)),
        "u64" | "usize" => whole(0, i64::MAX),
        // Only an integer of more bits is not one.
        "i64" | "any valid TOML value" => whole(i64::MIN, i64::MAX),
        "f64" => "a number".to_owned(),
        "a sequence" => "an array".to_owned(),
        "variant identifier" | "field identifier" | "path string" | "string only" => {
            "a string".to_owned()
        }
        _ if expected.contains("tuple") => format!("an array of {count} values"),
        "a map" => "a table".to_owned(),
        _ if expected.contains("struct ") || expected.contains("enum ") => "a table".to_owned(),
        _ => shown(expected, MESSAGE_LETTERS),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_words_of_a_program() {
        for (message, words) in [
            (
                "invalid type: string \"a\", expected f64",
                "invalid type: string \"a\", expected a number",
            ),
            (
                "invalid value: integer `-1`, expected u32",
                "invalid value: integer `-1`, expected a whole number from 0 to 4294967295",
            ),
            (
                "invalid type: floating point `1000000000000000000000.0`, expected u32",
                "invalid type: floating point `1e21`, expected a whole number from 0 to 4294967295",
            ),
            ("invalid type: map, expected a sequence", "invalid type: table, expected an array"),
            ("invalid type: unit variant, expected string only", "invalid type, expected a string"),
            (
                "invalid type: boolean `true`, expected path string",
                "invalid type: boolean `true`, expected a string",
            ),
            (
                "invalid type: sequence, expected struct Limits",
                "invalid type: array, expected a table",
            ),
            (
                "unknown field `gaol`, expected `start` or `goal`",
                "unknown field `gaol`, expected `start` or `goal`; did you mean `goal`?",
            ),
            ("unknown variant `x`, expected `a` or `b`", "unknown value `x`, expected `a` or `b`"),
            ("missing field `radius_m`", "missing field `radius_m`"),
            ("wanted exactly 1 element, more than 1 element", "give exactly one kind, got several"),
            ("wanted exactly 1 element, found 0 elements", "give exactly one kind, got none"),
            (
                "invalid value: integer `9` as i128, expected u8",
                "invalid value: integer `9`, expected a whole number from 0 to 255",
            ),
            (
                "invalid type: integer `9223372036854775808` as i128, expected any valid TOML value",
                "invalid type: integer `9223372036854775808`, expected a whole number from \
                 -9223372036854775808 to 9223372036854775807",
            ),
        ] {
            assert_eq!(in_plain_words(message), words);
        }
        let long = format!("invalid type: string \"{}\", expected u8", "\n".repeat(9999));
        assert!(in_plain_words(&long).len() < 250);
    }
}
