//! Terms of an evaluation: what is good about a candidate, larger is better. One file each.

pub(super) mod distance;
pub(super) mod heading;
pub(super) mod speed;
