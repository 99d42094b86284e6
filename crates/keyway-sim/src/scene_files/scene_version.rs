//! The version of a scene file.

use serde::Deserialize;

/// Version of the format that is written.
pub(super) const VERSION: u32 = 2;

/// The version, and the fields that version 1 does not have. The rest of a later format may be
/// anything.
#[derive(Deserialize)]
pub(super) struct Versioned {
    pub(super) version: Option<toml::Value>,
    map: Option<toml::Value>,
    start: Option<toml::Value>,
    goal: Option<toml::Value>,
    world: Option<toml::Value>,
    seed: Option<toml::Value>,
    safe: Option<toml::Value>,
    rules: Option<toml::Value>,
    disturbances: Option<toml::Value>,
    robots: Option<toml::Value>,
    absent: Option<toml::Value>,
    random: Option<toml::Value>,
}

impl Versioned {
    /// True if the file has a field that every scene and no other file has.
    pub(super) fn looks_like_a_scene(&self) -> bool {
        let names_a_map = self.map.as_ref().is_some_and(toml::Value::is_str);
        names_a_map || [&self.start, &self.goal, &self.robots].into_iter().any(Option::is_some)
    }

    /// Returns the first field that version 1 does not have.
    pub(super) fn newer(&self) -> Option<&'static str> {
        let Self { world, seed, safe, rules, disturbances, robots, absent, random, .. } = self;
        let fields = [
            ("world", world),
            ("seed", seed),
            ("safe", safe),
            ("rules", rules),
            ("disturbances", disturbances),
            ("robots", robots),
            ("absent", absent),
            ("random", random),
        ];
        fields.into_iter().find(|(_, value)| value.is_some()).map(|(field, _)| field)
    }
}
