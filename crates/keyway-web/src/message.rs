//! Questions and answers as bytes: a head of JSON, and parts.

use serde::Serialize;
use std::fmt;

/// A question or an answer.
///
/// As bytes, with all numbers little-endian: the length of the head (4 bytes), the head, and for
/// each part the length of its name (4 bytes), the name, the length of its bytes (4 bytes), and the
/// bytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Message {
    /// JSON.
    pub head: String,
    /// Names and bytes, in any order.
    pub parts: Vec<(String, Vec<u8>)>,
}

/// Error of an incomplete message, or of a text that is not UTF-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageError {
    /// Offset of the text or of its length.
    pub at: usize,
}

impl fmt::Display for MessageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the message is truncated, or not UTF-8, at byte {}", self.at)
    }
}

impl std::error::Error for MessageError {}

impl Message {
    /// A message without parts.
    pub fn new(head: impl Into<String>) -> Self {
        Self { head: head.into(), parts: Vec::new() }
    }

    /// The same with one more part.
    #[must_use]
    pub fn with(mut self, name: &str, bytes: Vec<u8>) -> Self {
        self.parts.push((name.to_owned(), bytes));
        self
    }

    /// The bytes of the first part with a name.
    pub fn part(&self, name: &str) -> Option<&[u8]> {
        let found = self.parts.iter().find(|(own, _)| own == name);
        found.map(|(_, bytes)| bytes.as_slice())
    }

    /// Encodes the message.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut put = |content: &[u8]| {
            bytes.extend((content.len() as u32).to_le_bytes());
            bytes.extend(content);
        };
        put(self.head.as_bytes());
        for (name, content) in &self.parts {
            put(name.as_bytes());
            put(content);
        }
        bytes
    }

    /// Decodes a message.
    ///
    /// # Errors
    /// Returns [`MessageError`] if the bytes are cut off, or the head or a name is not UTF-8.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, MessageError> {
        let mut reader = Reader { bytes, at: 0 };
        let mut message = Self::new(reader.text()?);
        while reader.at < bytes.len() {
            message.parts.push((reader.text()?, reader.next()?.to_vec()));
        }
        Ok(message)
    }
}

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Reader<'b> {
    fn next(&mut self) -> Result<&'b [u8], MessageError> {
        let error = MessageError { at: self.at };
        let rest = self.bytes.get(self.at..).ok_or(error)?;
        let (length, rest) = rest.split_first_chunk::<4>().ok_or(error)?;
        let content = rest.get(..u32::from_le_bytes(*length) as usize).ok_or(error)?;
        self.at += 4 + content.len();
        Ok(content)
    }

    fn text(&mut self) -> Result<String, MessageError> {
        let error = MessageError { at: self.at };
        String::from_utf8(self.next()?.to_vec()).map_err(|_| error)
    }
}

/// Encodes 32-bit numbers.
pub(crate) fn numbers(numbers: impl Iterator<Item = i32>) -> Vec<u8> {
    numbers.flat_map(i32::to_le_bytes).collect()
}

/// Encodes a value as the head of a message. Plain data with string keys: this cannot fail.
pub(crate) fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_after_writing_and_reading() {
        let message = Message::new("{}").with("a", vec![1, 2]).with("", vec![]);
        assert_eq!(Message::from_bytes(&message.to_bytes()), Ok(message.clone()));
        assert_eq!(message.part("a"), Some(&[1, 2][..]));
        assert_eq!(message.part("b"), None);
    }

    #[test]
    fn every_cut_is_seen() {
        let bytes = Message::new("{}").with("a", vec![1, 2]).to_bytes();
        // A message may end after its head, or after any part.
        for end in (0..bytes.len()).filter(|&end| end != 6) {
            assert!(Message::from_bytes(&bytes[..end]).is_err(), "{end}");
        }
        assert_eq!(Message::from_bytes(&[1, 0, 0, 0, 0xff]), Err(MessageError { at: 0 }));
        assert_eq!(Message::from_bytes(&[0xff; 8]), Err(MessageError { at: 0 }));
    }
}
