//! `map_msgs`.

use super::Named;
use super::std_msgs::Header;
use serde::{Deserialize, Serialize};

/// A changed rectangle of a map.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct OccupancyGridUpdate {
    pub(crate) header: Header,
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) data: Vec<i8>,
}

impl Named for OccupancyGridUpdate {
    const NAME: (&'static str, &'static str) = ("map_msgs", "OccupancyGridUpdate");
}
