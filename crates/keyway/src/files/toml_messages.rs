//! What the reader of TOML says, in the words of somebody who writes a file, not of one who writes
//! a program.

use super::did_you_mean;
use crate::map::formats::shown;

/// Letters of a value that are shown, and of a message, which may list all fields.
const VALUE_LETTERS: usize = 40;
const MESSAGE_LETTERS: usize = 500;

/// The message of an error of the reader, without names of Rust's types.
pub(super) fn in_plain_words(message: &str) -> String {
    let message = message.trim();
    let got_and_expected = |start: &str| message.strip_prefix(start)?.rsplit_once(", expected ");
    for start in ["invalid type: ", "invalid value: "] {
        if let Some((got, expected)) = got_and_expected(start) {
            if let Some(number) = beyond_64_bits(got) {
                return format!(
                    "the whole number {number} is out of range, expected {} to {}",
                    i64::MIN,
                    i64::MAX
                );
            }
            return format!("expected {}, got {}", expected_in_words(expected), got_in_words(got));
        }
    }
    if let Some((count, expected)) = got_and_expected("invalid length ") {
        return format!("expected {}, got {count} values", expected_in_words(expected));
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        return format!("unknown value {rest}{}", name_meant(rest));
    }
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return shown(message, MESSAGE_LETTERS) + &name_meant(rest);
    }
    if message.contains("recursion") {
        return "lists and tables are nested too deeply".to_owned();
    }
    if message.starts_with("wanted exactly 1 element") {
        let count = if message.ends_with("found 0 elements") { "none" } else { "several" };
        return format!("expected exactly one field, got {count}");
    }
    if message.starts_with("wanted string or table") {
        return "expected a text or a table".to_owned();
    }
    let message =
        TERMS.iter().fold(message.to_owned(), |text, (term, words)| text.replace(term, words));
    shown(&message, MESSAGE_LETTERS)
}

/// Which name may have been meant, of a message such as "`gaol`, expected `start` or `goal`".
fn name_meant(message: &str) -> String {
    let mut names = message.split('`').skip(1).step_by(2);
    names.next().map_or_else(String::new, |given| did_you_mean(given, names))
}

/// Terms of TOML's grammar, the longer ones first.
const TERMS: [(&str, &str); 15] = [
    (
        "u64 value was too large",
        "the whole number is out of range, expected -9223372036854775808 to 9223372036854775807",
    ),
    ("floating-point number overflowed", "the number is too large"),
    ("integer number overflowed", "the number is too large"),
    ("non-double-quote visible characters", "visible characters"),
    ("non-single-quote visible characters", "visible characters"),
    ("string values must be quoted, expected literal string", "texts must be in quotes"),
    ("multi-line basic string", "text of several lines"),
    ("multi-line literal string", "text of several lines"),
    ("basic string", "text in quotes"),
    ("literal string", "text in single quotes"),
    ("invalid float", "invalid number"),
    ("invalid mantissa", "invalid number"),
    ("invalid fraction", "invalid number"),
    ("invalid exponent", "invalid number"),
    (", expected nothing", ""),
];

/// A kind of value as `serde` names it.
fn expected_in_words(expected: &str) -> String {
    let count: String = expected.chars().filter(char::is_ascii_digit).collect();
    match expected {
        "u8" | "u16" | "u32" | "u64" | "u128" | "usize" => {
            let largest = match expected {
                "u8" => u64::from(u8::MAX),
                "u16" => u64::from(u16::MAX),
                "u32" => u64::from(u32::MAX),
                // The largest of TOML.
                _ => i64::MAX as u64,
            };
            format!("a whole number from 0 to {largest}")
        }
        "i8" | "i16" | "i32" | "i64" | "i128" | "isize" => "a whole number".to_owned(),
        "f32" | "f64" => "a number".to_owned(),
        "a string" | "a borrowed string" | "string" | "str" | "path string" | "a character" => {
            "a text".to_owned()
        }
        "a boolean" | "bool" => "true or false".to_owned(),
        "a sequence" | "sequence" => "a list".to_owned(),
        "a map" | "map" => "a table".to_owned(),
        "variant identifier" | "field identifier" => "a name".to_owned(),
        _ if expected.contains("tuple") || expected.contains("array") => {
            format!("a list of {count} values")
        }
        _ if ["struct ", "enum ", "unit", "newtype"].iter().any(|kind| expected.contains(kind)) => {
            "a table".to_owned()
        }
        _ => expected.to_owned(),
    }
}

/// A whole number, of which TOML has only those of 64 bits.
fn beyond_64_bits(got: &str) -> Option<String> {
    let number = got.strip_prefix("integer `")?.split('`').next()?;
    number.parse::<i64>().is_err().then(|| shown(number, VALUE_LETTERS))
}

/// A value as `serde` shows it.
fn got_in_words(got: &str) -> String {
    let kinds = [
        ("string \"", "the text \""),
        ("integer `", ""),
        ("floating point `", ""),
        ("boolean `", ""),
        ("character `", ""),
    ];
    for (kind, words) in kinds {
        if let Some(value) = got.strip_prefix(kind) {
            // Behind a number its type may follow.
            let is_text = kind.ends_with('"');
            let value = if is_text { value } else { value.split('`').next().unwrap_or(value) };
            return format!("{words}{}", shown(value, VALUE_LETTERS));
        }
    }
    let words = match got {
        "sequence" | "tuple variant" => "a list",
        "map" | "struct variant" => "a table",
        "Option value" | "unit value" | "null" => "nothing",
        "byte array" => "bytes",
        _ => return shown(got, VALUE_LETTERS),
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_words_of_a_program() {
        for (message, words) in [
            ("invalid type: string \"a\", expected f64", "expected a number, got the text \"a\""),
            (
                "invalid value: integer `-1`, expected u32",
                "expected a whole number from 0 to 4294967295, got -1",
            ),
            ("invalid type: map, expected a sequence", "expected a list, got a table"),
            ("invalid type: boolean `true`, expected path string", "expected a text, got true"),
            (
                "invalid length 3, expected an array of length 2",
                "expected a list of 2 values, got 3 values",
            ),
            ("invalid type: sequence, expected struct Limits", "expected a table, got a list"),
            ("unknown variant `x`, expected `a` or `b`", "unknown value `x`, expected `a` or `b`"),
            (
                "unknown field `gaol`, expected `start` or `goal`",
                "unknown field `gaol`, expected `start` or `goal`; did you mean `goal`?",
            ),
            ("missing field `radius_m`", "missing field `radius_m`"),
            (
                "invalid value: integer `9` as i128, expected u8",
                "expected a whole number from 0 to 255, got 9",
            ),
            ("invalid float, expected nothing", "invalid number"),
            (
                "u64 value was too large",
                "the whole number is out of range, expected \
                 -9223372036854775808 to 9223372036854775807",
            ),
            (
                "invalid type: integer `9223372036854775808` as i128, expected any valid TOML value",
                "the whole number 9223372036854775808 is out of range, expected \
                 -9223372036854775808 to 9223372036854775807",
            ),
        ] {
            assert_eq!(in_plain_words(message), words);
        }
        let long = format!("invalid type: string \"{}\", expected u8", "\n".repeat(9999));
        assert!(in_plain_words(&long).len() < 200);
    }
}
