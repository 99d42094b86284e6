//! The layers that a search reads: blocked cells, connected components, and reasons for
//! unreachable goals.

mod blocked_by;
mod components;
mod config;
mod diagonals;
pub(in crate::map) mod dilation;
mod edited;
mod fingerprint;
mod free_ends;
mod hindrance;
mod narrowest;
mod nearest_free;
mod published;
mod search_map;
mod separation;
mod stops;

pub use blocked_by::BlockedBy;
pub use components::{Components, Connectivity};
pub use config::{LayerConfig, UnknownPolicy};
pub(crate) use diagonals::DiagonalEvents;
#[cfg(feature = "formats")]
pub(crate) use fingerprint::mix;
pub use hindrance::Hindrance;
pub use published::PublishedConstraints;
pub use search_map::SearchMap;
pub use separation::Separation;
pub(in crate::map) use stops::StopBitmaps;
