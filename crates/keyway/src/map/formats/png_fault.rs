//! Where a PNG file is broken, in words that say what to do.

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// What is wrong with a file that cannot be decoded: the first of its chunks that is cut off or
/// damaged.
pub(super) fn fault(bytes: &[u8]) -> String {
    let mut at = SIGNATURE.len();
    loop {
        let Some(chunk) = Chunk::at(bytes, at) else {
            return format!("the file ends at byte {}, before the image does", bytes.len());
        };
        let name = chunk.name();
        if at == SIGNATURE.len() && name != "IHDR" {
            return format!("it begins with the chunk {name}, expected the header IHDR");
        }
        let Some(content) = chunk.content else {
            return format!("the file ends within the chunk {name}, which begins at byte {at}");
        };
        if checksum(chunk.kind, content) != chunk.checksum {
            return format!("the chunk {name}, which begins at byte {at}, is damaged");
        }
        if name == "IHDR"
            && let Some(fault) = header_fault(content)
        {
            return fault;
        }
        if name == "IEND" {
            return "its pixels cannot be unpacked".to_owned();
        }
        at += CHUNK_BYTES + content.len();
    }
}

/// Length, kind and checksum.
const CHUNK_BYTES: usize = 12;

struct Chunk<'a> {
    kind: [u8; 4],
    /// `None` where the file ends before it does.
    content: Option<&'a [u8]>,
    checksum: u32,
}

impl<'a> Chunk<'a> {
    fn at(bytes: &'a [u8], at: usize) -> Option<Self> {
        let (length, rest) = bytes.get(at..)?.split_first_chunk()?;
        let (&kind, rest) = rest.split_first_chunk()?;
        let whole = rest.split_at_checked(u32::from_be_bytes(*length) as usize);
        let whole = whole.and_then(|(content, rest)| Some((content, *rest.first_chunk()?)));
        let (content, checksum) = whole.unzip();
        Some(Self { kind, content, checksum: checksum.map_or(0, u32::from_be_bytes) })
    }

    fn name(&self) -> String {
        self.kind.escape_ascii().to_string()
    }
}

/// The columns and rows that the header announces; nothing where there is none.
pub(super) fn size(bytes: &[u8]) -> Option<(u64, u64)> {
    let header = bytes.strip_prefix(SIGNATURE).and_then(|_| Chunk::at(bytes, SIGNATURE.len()))?;
    let (width, rest) = header.content.filter(|_| header.kind == *b"IHDR")?.split_first_chunk()?;
    let height = rest.first_chunk()?;
    let [width, height] = [*width, *height].map(|side| u64::from(u32::from_be_bytes(side)));
    (width > 0 && height > 0).then_some((width, height))
}

fn header_fault(header: &[u8]) -> Option<String> {
    let &[w0, w1, w2, w3, h0, h1, h2, h3, depth, colour, compression, filter, interlace] = header
    else {
        return Some(format!("its header has {} bytes, expected 13", header.len()));
    };
    let [width, height] = [[w0, w1, w2, w3], [h0, h1, h2, h3]].map(u32::from_be_bytes);
    if width == 0 || height == 0 {
        return Some(format!("it has {width} x {height} pixels, expected at least 1 x 1"));
    }
    let depths: &[u8] = match colour {
        0 => &[1, 2, 4, 8, 16],
        3 => &[1, 2, 4, 8],
        2 | 4 | 6 => &[8, 16],
        _ => return Some(format!("its colour type is {colour}, expected 0, 2, 3, 4 or 6")),
    };
    if !depths.contains(&depth) {
        return Some(format!("its colour type {colour} cannot have {depth} bits per sample"));
    }
    if compression != 0 || filter != 0 || interlace > 1 {
        return Some(
            "it is compressed, filtered or interlaced in a way that PNG does not allow".to_owned(),
        );
    }
    None
}

/// The fault of a palette, of an image that is drawn with one.
pub(super) fn palette_fault(palette: &[u8]) -> Option<String> {
    let length = palette.len();
    let is_sound = length.is_multiple_of(3) && (3..=3 * 256).contains(&length);
    (!is_sound).then(|| {
        format!("its palette has {length} bytes, expected three for each of 1 to 256 colours")
    })
}

/// CRC-32 of kind and content, as the PNG specification defines it.
pub(super) fn checksum(kind: [u8; 4], content: &[u8]) -> u32 {
    let shift = |sum: u32| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 };
    let byte = |sum: u32, &byte: &u8| (0..8).fold(sum ^ u32::from(byte), |sum, _| shift(sum));
    !kind.iter().chain(content).fold(u32::MAX, byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Vec<u8> {
        super::super::png::encode(2, 1, &[0, 255])
    }

    /// The same with another header, and its checksum.
    fn with_header(change: impl Fn(&mut [u8])) -> String {
        let mut bytes = small();
        change(&mut bytes[16..29]);
        let sum = checksum(*b"IHDR", &bytes[16..29]);
        bytes[29..33].copy_from_slice(&sum.to_be_bytes());
        fault(&bytes)
    }

    #[test]
    fn the_first_fault_is_named() {
        let whole = small();
        assert_eq!(fault(&whole), "its pixels cannot be unpacked", "that is all that is left");
        assert_eq!(fault(&whole[..10]), "the file ends at byte 10, before the image does");
        let cut = fault(&whole[..45]);
        assert_eq!(cut, "the file ends within the chunk IDAT, which begins at byte 33");
        let mut damaged = whole.clone();
        damaged[42] ^= 1;
        assert_eq!(fault(&damaged), "the chunk IDAT, which begins at byte 33, is damaged");
        damaged[12] = b'J';
        assert_eq!(fault(&damaged), "it begins with the chunk JHDR, expected the header IHDR");
        assert!(fault(&whole[..whole.len() - 12]).contains("before the image does"));
    }

    #[test]
    fn headers() {
        assert_eq!(with_header(|h| h[3] = 0), "it has 0 x 1 pixels, expected at least 1 x 1");
        assert_eq!(with_header(|h| h[8] = 3), "its colour type 0 cannot have 3 bits per sample");
        assert_eq!(with_header(|h| h[9] = 5), "its colour type is 5, expected 0, 2, 3, 4 or 6");
        assert!(with_header(|h| h[12] = 2).contains("in a way that PNG does not allow"));
    }
}
