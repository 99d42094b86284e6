//! The version of a scene file.

use serde::Deserialize;

/// The version that is written.
pub(super) const VERSION: u32 = 2;

/// The version, and what files of version 1 do not have: the rest of a later format may be anything.
#[derive(Deserialize)]
pub(super) struct Versioned {
    pub(super) version: toml::Value,
    world: Option<toml::Value>,
    seed: Option<toml::Value>,
    rules: Option<toml::Value>,
    disturbances: Option<toml::Value>,
    robots: Option<toml::Value>,
    random: Option<toml::Value>,
}

impl Versioned {
    /// The first field that is not one of version 1.
    pub(super) fn newer(&self) -> Option<&'static str> {
        let Self { world, seed, rules, disturbances, robots, random, .. } = self;
        let fields = [
            ("world", world),
            ("seed", seed),
            ("rules", rules),
            ("disturbances", disturbances),
            ("robots", robots),
            ("random", random),
        ];
        fields.into_iter().find(|(_, value)| value.is_some()).map(|(field, _)| field)
    }
}
