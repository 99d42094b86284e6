//! Errors of scenes.

use super::scene_version::VERSION;
use keyway::ConfigError;
use keyway::files::TomlError;
use keyway::given::Given;
use thiserror::Error;

/// Reason why a scene is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The text is not TOML, or not a scene.
    #[error(transparent)]
    Toml(#[from] TomlError),
    /// The file is of another kind, such as a stack or a robot.
    #[error("this is not a scene: it has no `version`, no `start`, no `goal` and no `[[robots]]`")]
    NoScene,
    /// The scene has no version.
    #[error("missing field `version`: a scene begins with `version = {}`", VERSION)]
    NoVersion,
    /// The scene has a later format.
    #[error("`version` is {found}; this program reads scenes of version 1 and {}", VERSION)]
    Version {
        /// Version in the file.
        found: String,
    },
    /// The scene uses a field that version 1 does not have.
    #[error("`{field}` needs `version = {}`", VERSION)]
    NeedsVersion {
        /// The field.
        field: &'static str,
    },
    /// The scene has neither a map file nor a generated map, or both.
    #[error("a scene has either a `map` or a `[world]`, got {}", if *.both { "both" } else { "neither" })]
    MapOrWorld {
        /// True if there are both.
        both: bool,
    },
    /// The scene has neither a start and a goal nor several robots, or both.
    #[error("a scene has either `start` and `goal` or `[[robots]]`, got {got}")]
    OneOrSeveral {
        /// Fields that the scene has.
        got: String,
    },
    /// The scene has several robots where one was expected.
    #[error("a scene with `[[robots]]` is not a run of one robot")]
    SeveralRobots,
    /// The disturbances have their own seed.
    #[error("set `seed` of the scene instead of `disturbances.seed`")]
    SeedOfDisturbances,
    /// A value of the rules is invalid.
    #[error("`rules.{}` {}", .0.path, .0.reason)]
    Rules(ConfigError),
    /// A value of the disturbances is invalid.
    #[error("`disturbances.{}` {}", .0.path, .0.reason)]
    Disturbances(ConfigError),
    /// A value of the random obstacles is invalid.
    #[error("`random.{}` {}", .0.path, .0.reason)]
    Random(ConfigError),
    /// A value of a generated map is invalid.
    #[error("`world.{}` {}", .0.path, .0.reason)]
    World(ConfigError),
    /// An obstacle is invalid; the path has the form `unknown[0].radius_m`.
    #[error("`{}` {}", .0.path, .0.reason)]
    Obstacle(ConfigError),
    /// A value is invalid.
    #[error("`{field}` must be {expected}, got {}", Given(*.value))]
    Value {
        /// The field, as a path such as `unknown[0].radius_m`.
        field: String,
        /// Expected value.
        expected: &'static str,
        /// Given value.
        value: f64,
    },
}
