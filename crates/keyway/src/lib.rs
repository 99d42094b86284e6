#![doc = include_str!("../README.md")]

pub mod geometry;
pub mod local;
pub mod map;
pub mod metrics;
pub mod sense;
pub mod sim;
