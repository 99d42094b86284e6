//! The real program: its commands, its JSON, its exit codes, its errors.
#![allow(clippy::unwrap_used)]

mod arguments;
mod batch;
mod batch_fleet;
mod bench;
mod compare;
mod compare_pictures;
mod compare_statistics;
mod complaints;
mod curve;
mod docs;
mod ends;
mod errors;
mod examples;
mod explain;
mod fleet;
mod latex_reader;
mod latex_tables;
mod list;
mod made_scenes;
mod map;
mod measurements;
mod navigate;
mod own_parameters;
mod papers;
mod plan;
mod prepare;
mod readers;
mod replay;
mod reproduce;
mod scene_schema;
mod scenes;
mod size;
mod stacks;
mod support;
mod written;
