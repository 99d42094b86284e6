//! The messages of an untrusted file.
//!
//! Such a file declares the lengths of its parts, and these may be wrong: no part takes more
//! memory than a file of its size can sensibly hold, and none reaches beyond its container.

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult, parse_record};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// Maximum number of bytes that one byte of a compressed part expands to.
const MOST_COMPRESSED: usize = 255;

/// Maximum size of a message: more than the map of a city \[bytes\].
const MAX_RECORD_BYTES: usize = 1 << 30;

/// Number of bytes that are read at once.
const READ_BYTES: usize = 1 << 16;

/// Passes each message and its topic to `take`, in the order of the file. Returns `false` if the
/// file is truncated: everything that was written before a loss of power is read.
///
/// `fault` converts the errors of the file.
pub(super) fn for_each_message<E>(
    bytes: &[u8],
    fault: impl Fn(McapError) -> E,
    mut take: impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<bool, E> {
    if !bytes.starts_with(mcap::MAGIC) {
        return Err(fault(McapError::BadMagic));
    }
    let limit_bytes = bytes.len().saturating_mul(MOST_COMPRESSED).min(MAX_RECORD_BYTES);
    let options = LinearReaderOptions::default().with_record_length_limit(limit_bytes);
    let mut topics = Topics::default();
    let file = Records::of(bytes, options.clone().with_emit_chunks(true));
    file.for_each(&fault, &mut |opcode, data| {
        if opcode != op::CHUNK {
            return topics.with_message(opcode, data, &fault, &mut take);
        }
        check_chunk(data).map_err(&fault)?;
        let chunk = Records::of_chunk(data, options.clone());
        let is_whole = chunk.for_each(&fault, &mut |opcode, data| {
            topics.with_message(opcode, data, &fault, &mut take)
        })?;
        if is_whole { Ok(()) } else { Err(fault(McapError::UnexpectedEoc)) }
    })
}

/// Topics of the channels that were declared so far.
#[derive(Default)]
struct Topics(BTreeMap<u16, String>);

impl Topics {
    /// Passes the message of a record to `take`, if the record is one.
    fn with_message<E>(
        &mut self,
        opcode: u8,
        data: &[u8],
        fault: &impl Fn(McapError) -> E,
        take: &mut impl FnMut(&str, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        if !matches!(opcode, op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        match parse_record(opcode, data).map_err(fault)? {
            Record::Channel(channel) => {
                self.0.insert(channel.id, channel.topic);
                Ok(())
            }
            Record::Message { header, data } => {
                let topic = self.0.get(&header.channel_id).ok_or_else(|| {
                    fault(McapError::UnknownChannel(header.sequence, header.channel_id))
                })?;
                take(topic, &data)
            }
            _ => Ok(()),
        }
    }
}

/// Refuses a chunk that is longer than its record, or an uncompressed one whose records reach
/// beyond its end.
fn check_chunk(chunk: &[u8]) -> McapResult<()> {
    const HEAD_BYTES: usize = 1 + 8;
    let Record::Chunk { header, data } = parse_record(op::CHUNK, chunk)? else { return Ok(()) };
    let mut rest = &*data;
    while header.compression.is_empty() && !rest.is_empty() {
        let (head, behind) = rest.split_at_checked(HEAD_BYTES).ok_or(McapError::UnexpectedEoc)?;
        let length = head[1..].iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte));
        let length = usize::try_from(length).unwrap_or(usize::MAX);
        rest = behind.get(length..).ok_or(McapError::UnexpectedEoc)?;
    }
    Ok(())
}

/// Callback that takes the kind and content of a record.
type Take<'a, E> = dyn FnMut(u8, &[u8]) -> Result<(), E> + 'a;

/// Records of a file, or of one of its chunks.
struct Records<R> {
    source: R,
    reader: LinearReader,
}

impl<'a> Records<std::io::Chain<Cursor<Vec<u8>>, &'a [u8]>> {
    fn of_chunk(data: &'a [u8], options: LinearReaderOptions) -> Self {
        let length = (data.len() as u64).to_le_bytes();
        let head = Cursor::new([&[op::CHUNK], &length[..]].concat());
        let options = options
            .with_prevalidate_chunk_crcs(true)
            .with_skip_start_magic(true)
            .with_skip_end_magic(true);
        Self::of(head.chain(data), options)
    }
}

impl<R: Read> Records<R> {
    fn of(source: R, options: LinearReaderOptions) -> Self {
        Self { source, reader: LinearReader::new_with_options(options) }
    }

    /// Passes the kind and content of each record to `take`; `false` if the end is missing.
    fn for_each<E>(
        mut self,
        fault: &impl Fn(McapError) -> E,
        take: &mut Take<'_, E>,
    ) -> Result<bool, E> {
        loop {
            let wanted = match self.reader.next_event().transpose() {
                Ok(Some(LinearReadEvent::Record { opcode, data })) => {
                    take(opcode, data)?;
                    continue;
                }
                Ok(Some(LinearReadEvent::ReadRequest(wanted))) => wanted.min(READ_BYTES),
                Ok(None) => return Ok(true),
                // A chunk that was begun and not ended has no length yet.
                Err(McapError::UnexpectedEof | McapError::RecordTooLarge { len: u64::MAX, .. }) => {
                    return Ok(false);
                }
                Err(reason) => return Err(fault(reason)),
            };
            let read = self.source.read(self.reader.insert(wanted));
            self.reader.notify_read(read.map_err(|reason| fault(reason.into()))?);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::{Compression, WriteOptions};

    /// A file of small messages, in chunks that are compressed or not.
    fn file(compression: Option<Compression>) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        let options = WriteOptions::new().compression(compression).chunk_size(Some(300));
        let mut writer = options.create(&mut out).unwrap();
        let channels =
            ["a", "b"].map(|topic| writer.add_channel(0, topic, "json", &BTreeMap::new()).unwrap());
        for sequence in 0..40 {
            let header = mcap::records::MessageHeader {
                channel_id: channels[sequence as usize % 2],
                sequence,
                log_time: u64::from(sequence),
                publish_time: 0,
            };
            writer.write_to_known_channel(&header, &[sequence as u8; 30]).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        out.into_inner()
    }

    fn messages(bytes: &[u8]) -> McapResult<(Vec<(String, u8)>, bool)> {
        let mut found = Vec::new();
        let is_whole = for_each_message(
            bytes,
            |fault| fault,
            |topic, data| {
                found.push((topic.to_owned(), data.first().copied().unwrap_or(0)));
                Ok(())
            },
        )?;
        Ok((found, is_whole))
    }

    #[test]
    fn messages_come_in_their_order() {
        let expected: Vec<_> =
            (0..40u8).map(|i| (["a", "b"][i as usize % 2].to_owned(), i)).collect();
        for compression in [None, Some(Compression::Lz4)] {
            let bytes = file(compression);
            assert_eq!(messages(&bytes).unwrap(), (expected.clone(), true));
            for length in 8..bytes.len() {
                let (found, is_whole) = messages(&bytes[..length]).unwrap();
                assert!(!is_whole && expected.starts_with(&found), "{length}");
            }
        }
    }

    /// Wrong lengths, at every position that holds one, cause neither a panic nor an allocation.
    #[test]
    fn lies_are_errors() {
        for compression in [None, Some(Compression::Lz4)] {
            let bytes = file(compression);
            let mut refused = 0;
            for at in 8..bytes.len() - 8 {
                for lie in [[0; 8], [0xff; 8], (1u64 << 40).to_le_bytes(), 7u64.to_le_bytes()] {
                    let mut lying = bytes.clone();
                    lying[at..at + 8].copy_from_slice(&lie);
                    refused += usize::from(messages(&lying).is_err());
                }
            }
            assert!(refused > 1000, "{refused}");
        }
    }

    /// A record of a chunk reaches beyond the declared records of the chunk, into the bytes
    /// behind them.
    #[test]
    fn records_end_with_their_chunk() {
        let records = |length: u64| {
            let record = [&[op::MESSAGE][..], &5u64.to_le_bytes(), &[0; 5]].concat();
            // Two times, the length of the records, no checksum, no compression, the length
            // again.
            let head = [&[0; 16][..], &length.to_le_bytes(), &[0; 8], &length.to_le_bytes()];
            [head.concat(), record, vec![0; 20]].concat()
        };
        assert!(check_chunk(&records(14)).is_ok());
        for length in [1, 10, 13, 15, 99] {
            let chunk = records(length);
            let parts = [mcap::MAGIC, &[op::CHUNK], &(chunk.len() as u64).to_le_bytes(), &chunk];
            assert!(messages(&parts.concat()).is_err(), "{length}");
        }
    }
}
