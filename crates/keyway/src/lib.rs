#![doc = include_str!("../README.md")]

pub mod geometry;
pub mod guide;
pub mod local;
pub mod map;
pub mod metrics;
pub mod navigate;
pub mod plan;
pub mod robot;
pub mod search;
pub mod sense;
pub mod sim;
pub mod smooth;
