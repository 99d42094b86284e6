//! Pictures of the results of a batch, which the caller draws.

use super::Record;
use std::error::Error;

/// Drawer of pictures of the results of a batch. `()` draws nothing.
pub trait Pictures {
    /// Returns the names of all files that may be drawn, relative to the folder of the results.
    fn names(&self) -> Vec<&'static str>;

    /// Draws the runs of these stacks.
    ///
    /// # Errors
    /// Returns an error if a picture cannot be drawn.
    fn draw(
        &self,
        records: &[Record],
        stacks: &[&str],
    ) -> Result<Vec<PictureFile>, Box<dyn Error + Send + Sync>>;
}

/// Picture that is to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// One of the [names](Pictures::names).
    pub name: &'static str,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

impl Pictures for () {
    fn names(&self) -> Vec<&'static str> {
        Vec::new()
    }

    fn draw(
        &self,
        _: &[Record],
        _: &[&str],
    ) -> Result<Vec<PictureFile>, Box<dyn Error + Send + Sync>> {
        Ok(Vec::new())
    }
}
