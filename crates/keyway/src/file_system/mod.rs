//! Reading files within limits, and replacing them as a whole.

mod atomic;
mod read;
#[cfg(test)]
pub(crate) mod test_folder;

pub(crate) use atomic::Staged;
pub use atomic::{check_writable, remove_leftovers, write_atomically};
pub use read::read_file;
pub(crate) use read::read_file_if;
