//! Lines of text files.

use thiserror::Error;

/// Error of a file that is not UTF-8 text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "line {line} is not UTF-8 text (byte {column} of the line is {byte:#04x}); save the file as UTF-8"
)]
#[non_exhaustive]
pub struct TextError {
    /// Line, from 1.
    pub line: usize,
    /// Byte within the line, from 1.
    pub column: usize,
    /// The byte that is not part of a character.
    pub byte: u8,
}

/// Decodes text, without a byte order mark.
///
/// # Errors
/// Returns [`TextError`] if the bytes are not UTF-8; the error names the first invalid byte.
pub fn text_from_bytes(bytes: &[u8]) -> Result<&str, TextError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let sound = &bytes[..error.valid_up_to()];
            let (mut line, mut column) = (1, 1);
            for &byte in sound {
                (line, column) = if byte == b'\n' { (line + 1, 1) } else { (line, column + 1) };
            }
            Err(TextError { line, column, byte: bytes[sound.len()] })
        }
    }
}

/// The beginning of a text for an error message: in one line, and shortened.
pub(crate) fn shown(text: &str, letters: usize) -> String {
    let mut short = String::new();
    for letter in text.chars().take(letters) {
        if letter.is_control() {
            short.extend(letter.escape_default());
        } else {
            short.push(letter);
        }
    }
    if text.chars().nth(letters).is_some() { short + "..." } else { short }
}

/// Lines with their numbers, from 1, without the line ends (LF or CRLF). A final line end is not
/// followed by an empty line.
pub(super) fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.strip_suffix('\n')
        .unwrap_or(text)
        .split('\n')
        .map(|line| line.strip_suffix('\r').unwrap_or(line))
        .zip(1..)
        .map(|(l, n)| (n, l))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_and_line_ends_are_dropped() {
        let text = text_from_bytes("\u{feff}a\r\nb\n\nc".as_bytes()).unwrap();
        let lines: Vec<_> = numbered_lines(text).collect();
        assert_eq!(lines, [(1, "a"), (2, "b"), (3, ""), (4, "c")]);
        let ends_of = |text: &str| numbered_lines(text).last().map(|(number, _)| number);
        assert_eq!(["", "a", "a\n", "a\r\n\r\n"].map(ends_of), [1, 1, 1, 2].map(Some));
    }

    #[test]
    fn what_is_shown_is_short_and_in_one_line() {
        assert_eq!(shown("a\nb", 3), "a\\nb");
        assert_eq!(shown("abcd", 3), "abc...");
    }

    #[test]
    fn the_bad_byte_is_named() {
        let error = text_from_bytes(b"ab\ncd\xe9f").unwrap_err();
        assert_eq!(error, TextError { line: 2, column: 3, byte: 0xe9 });
        assert_eq!(
            error.to_string(),
            "line 2 is not UTF-8 text (byte 3 of the line is 0xe9); save the file as UTF-8"
        );
    }
}
