//! Scenes of the field's benchmarks, of tables of starts and goals, of the papers' maps, and of
//! narrow places.
//!
//! Each request reads the files that it names, if any, and returns scenes with the names of their
//! files. Nothing is written. [`scene_schema`] describes the fields of all scene files.

mod barn;
mod dynabarn;
mod error;
mod narrow;
mod pairs;
mod papers;
mod schema;
mod table;

pub use barn::BarnRequest;
pub use dynabarn::DynabarnRequest;
pub use error::ScenesError;
pub use narrow::NarrowRequest;
pub use pairs::PairsRequest;
pub use papers::PapersRequest;
pub use schema::scene_schema;
pub use table::TableError;

use keyway_sim::scene_files::SceneFile;

/// A scene with the name of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedScene {
    /// Name of the file, such as `barn_007.toml`.
    pub file: String,
    /// The scene.
    pub scene: SceneFile,
}
