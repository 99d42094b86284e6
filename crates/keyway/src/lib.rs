#![doc = include_str!("../README.md")]

pub mod geometry;
pub mod local;
pub mod map;
pub mod plan;
pub mod search;
pub mod sense;
