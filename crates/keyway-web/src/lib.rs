//! Keyway for a page in a browser, as one WebAssembly module without imports.
//!
//! A [`Page`] opens maps from bytes, plans on them, shows searches step by step and drives
//! scenes. Every question and every answer is a [`Message`] with a JSON head. Long data, such as
//! the cells of a map or the events of a search, comes as binary parts beside the head. It reads
//! no files and no clock: times in reports are `null`, and equal questions have equal answers on
//! every machine.
//!
//! ```
//! use keyway_web::{Message, Page};
//!
//! let mut page = Page::default();
//! let map = b"type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n".to_vec();
//! let open = Message::new(r#"{"ask": "open_map", "name": "small.map"}"#).with("small.map", map);
//! let opened = page.answer(&open);
//! assert_eq!(opened.part("cells"), Some(&[0, 1, 0, 0, 0, 0][..]));
//! let plan = r#"{"ask": "plan", "planner": "jps", "start": [0.5, 0.5], "goal": [2.5, 0.5]}"#;
//! let planned = page.answer(&Message::new(plan));
//! assert!(planned.head.contains(r#""outcome":"found""#), "{}", planned.head);
//! ```
//!
//! | question | answer | parts |
//! |---|---|---|
//! | [`names`](names::Names) | the names of all available choices | |
//! | [`open_map`](map::OpenMap) | facts about the map | `cells` |
//! | [`edit_map`](map::EditMap) | the number of changed cells | |
//! | [`plan`](route::Plan) | the report `keyway.plan/3` | `line`, `smoothed`, `shortest` |
//! | [`search`](route::Plan) | events and path of the search | see [`search::Search`] |
//! | [`open_scene`](scene::OpenScene) | facts about the scene and its map | `cells` |
//! | [`barn_scenes`](scene::BarnScenes) | the scenes of a BARN table | |
//! | [`drive`](drive::Drive) | reports `keyway.navigate/4`, and cycles | see [`drive::Driven`] |
//! | [`compare`](compare::Compare) | the report `keyway.compare/1`, and tables | |
//! | [`summary`](compare::Summarise) | a summary of the runs of several stacks | |
//! | [`claims`](claims::ClaimFacts) | the claims of the papers | |
//! | [`open_claim`](claims::OpenClaim) | a map of a claim | see [`claims::ClaimMap`] |
//! | [`measure_claim`](claims::MeasureClaim) | results on one map | |
//! | [`judge_claim`](claims::JudgeClaim) | the verdict on a claim | |
//!
//! An error answer is `{"error": {"kind", "message", "field"}}`; the state of the page does not
//! change.

pub mod claims;
pub mod compare;
pub mod drive;
mod error;
#[cfg(target_family = "wasm")]
mod exports;
pub mod film;
pub mod map;
mod message;
pub mod names;
mod page;
pub mod route;
pub mod scene;
pub mod search;

pub use error::{Kind, PageError};
pub use message::{Message, MessageError};
pub use page::Page;
