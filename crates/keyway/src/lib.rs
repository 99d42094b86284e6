#![doc = include_str!("../README.md")]

pub mod geometry;
pub mod local;
pub mod map;
pub mod sense;
