//! Why a scene cannot be used.

use super::scene_version::VERSION;
use keyway::ConfigError;
use keyway::files::TomlError;
use keyway::given::Given;
use thiserror::Error;

/// Why a scene cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Not TOML, or not a scene.
    #[error(transparent)]
    Toml(#[from] TomlError),
    /// Another file, such as a stack or a robot.
    #[error("this is no scene: it has no `version`, no `start`, no `goal` and no `[[robots]]`")]
    NoScene,
    /// A scene that does not say of which version it is.
    #[error("missing field `version`: a scene begins with `version = {}`", VERSION)]
    NoVersion,
    /// A scene of a later format.
    #[error("`version` is {found}; this program reads scenes of version 1 and {}", VERSION)]
    Version {
        /// What the file says.
        found: String,
    },
    /// A field that files of version 1 do not have.
    #[error("`{field}` needs `version = {}`", VERSION)]
    NeedsVersion {
        /// The field.
        field: &'static str,
    },
    /// Neither a map file nor a generated map, or both.
    #[error("a scene has either a `map` or a `[world]`, got {}", if *.both { "both" } else { "neither" })]
    MapOrWorld {
        /// Whether there are both.
        both: bool,
    },
    /// Neither a start and a goal nor several robots, or both.
    #[error("a scene has either `start` and `goal` or `[[robots]]`, got {got}")]
    OneOrSeveral {
        /// What there is of them.
        got: String,
    },
    /// Several robots where one was expected.
    #[error("a scene with `[[robots]]` is no run of one robot")]
    SeveralRobots,
    /// A seed of the disturbances alone.
    #[error("`disturbances.seed` is the `seed` of the scene; give it there")]
    SeedOfDisturbances,
    /// A value of the rules that cannot be used.
    #[error("`rules.{}` {}", .0.path, .0.reason)]
    Rules(ConfigError),
    /// A value of the disturbances that cannot be used.
    #[error("`disturbances.{}` {}", .0.path, .0.reason)]
    Disturbances(ConfigError),
    /// A value of the random obstacles that cannot be used.
    #[error("`random.{}` {}", .0.path, .0.reason)]
    Random(ConfigError),
    /// A value of a generated map that cannot be used.
    #[error("`world.{}` {}", .0.path, .0.reason)]
    World(ConfigError),
    /// An obstacle that cannot be used; the path is one such as `unknown[0].radius_m`.
    #[error("`{}` {}", .0.path, .0.reason)]
    Obstacle(ConfigError),
    /// A value that cannot be used.
    #[error("`{field}` must be {expected}, got {}", Given(*.value))]
    Value {
        /// The field, as a path such as `unknown[0].radius_m`.
        field: String,
        /// What was expected.
        expected: &'static str,
        /// What was given.
        value: f64,
    },
}
