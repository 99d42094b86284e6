//! The real program: its commands, its JSON, its exit codes, its errors.
#![allow(clippy::unwrap_used)]

mod bench;
mod compare;
mod curve;
mod docs;
mod errors;
mod examples;
mod list;
mod map;
mod navigate;
mod plan;
mod prepare;
mod readers;
mod support;
