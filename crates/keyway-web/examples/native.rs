//! Answers the questions of a page natively, for comparison with the WebAssembly module: reads
//! messages from the standard input, each after its length (4 bytes, little-endian), and writes
//! their answers in the same way.

use keyway_web::{Message, Page};
use std::io::{Read, Write, stdin, stdout};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut questions, mut page) = (Vec::new(), Page::default());
    stdin().read_to_end(&mut questions)?;
    let mut rest = questions.as_slice();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let length = u32::from_le_bytes(*length) as usize;
        let question = after.get(..length).ok_or("the last message is cut off")?;
        let answer = page.answer(&Message::from_bytes(question)?).to_bytes();
        stdout().write_all(&(answer.len() as u32).to_le_bytes())?;
        stdout().write_all(&answer)?;
        rest = &after[length..];
    }
    Ok(())
}
