//! Reading a file up to a size limit.

use crate::file_error::ReadError;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Maximum size read from a pipe or a device, whose size is unknown and which may never end.
const STREAM_BYTES: u64 = 256 << 20;

/// Reads a whole file of at most `limit_bytes`. Pipes and devices are read as well, but never more
/// than 256 MiB of them.
///
/// # Errors
/// Returns [`ReadError`] if the file cannot be read, is a folder, or holds more.
pub fn read_file(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ReadError> {
    read_file_if(path, limit_bytes, |_| Ok(()))
}

/// Length of the beginning of a file that decides if the rest is read \[bytes\].
const HEAD_BYTES: u64 = 1 << 16;

/// As [`read_file`], if `check` accepts the beginning. Memory for the rest is allocated only then.
pub(crate) fn read_file_if<E: From<ReadError>>(
    path: &Path,
    limit_bytes: u64,
    check: impl FnOnce(&[u8]) -> Result<(), E>,
) -> Result<Vec<u8>, E> {
    let failed = |reason| ReadError::System { path: path.to_owned(), reason };
    let mut file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if metadata.is_dir() {
        return Err(ReadError::Folder { path: path.to_owned() }.into());
    }
    let limit_bytes = if metadata.is_file() { limit_bytes } else { limit_bytes.min(STREAM_BYTES) };
    let too_large = || E::from(ReadError::TooLarge { path: path.to_owned(), limit_bytes });
    let mut bytes = Vec::new();
    let head_bytes = HEAD_BYTES.min(limit_bytes + 1);
    file.by_ref().take(head_bytes).read_to_end(&mut bytes).map_err(failed)?;
    check(&bytes)?;
    if metadata.len() > limit_bytes {
        return Err(too_large());
    }
    let room = bytes.try_reserve_exact((metadata.len() as usize).saturating_sub(bytes.len()));
    room.map_err(|_| failed(io::ErrorKind::OutOfMemory.into()))?;
    let rest_bytes = limit_bytes + 1 - bytes.len() as u64;
    file.take(rest_bytes).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limit_bytes {
        return Err(too_large());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::super::test_folder::TestFolder;
    use super::*;

    #[test]
    fn no_more_than_the_limit() {
        let folder = TestFolder::new();
        let path = folder.write("a", [7; 2048]);
        assert_eq!(read_file(&path, 2048).unwrap(), [7; 2048]);
        let text = read_file(&path, 2047).unwrap_err().to_string();
        assert!(text.ends_with("a: it is larger than the limit of 2047 bytes"), "{text}");
        let text = read_file(&folder.path(""), 9).unwrap_err().to_string();
        assert!(text.ends_with(": it is a folder, expected a file"), "{text}");
        let text = read_file(&folder.path("b"), 9).unwrap_err().to_string();
        assert!(text.ends_with("b: there is no such file or folder"), "{text}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_end() {
        assert_eq!(read_file(Path::new("/dev/null"), 9).unwrap(), b"");
        for (limit, text) in [(1 << 20, "1 MiB"), (u64::MAX, "256 MiB")] {
            let error = read_file(Path::new("/dev/zero"), limit).unwrap_err().to_string();
            assert!(
                error.contains(&format!("/dev/zero: it is larger than the limit of {text}")),
                "{error}"
            );
        }
    }
}
