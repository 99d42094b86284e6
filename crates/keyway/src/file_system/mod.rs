//! Reading files within limits, and replacing them as a whole.

mod atomic;
mod read;
mod system_error;
#[cfg(test)]
pub(crate) mod test_folder;

pub(crate) use atomic::Staged;
pub use atomic::{WriteError, check_writable, remove_leftovers, write_atomically};
pub(crate) use read::read_file_if;
pub use read::{ReadError, read_file};
pub use system_error::system_error_in_words;
