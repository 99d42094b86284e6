//! Terms of an evaluation; larger values are better. One file each.

pub(super) mod distance;
pub(super) mod heading;
pub(super) mod speed;
