//! Choice of the runs whose full records a batch stores.

use keyway_sim::episode::EpisodeOutcome;

/// The runs whose full records a batch stores.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// No runs.
    #[default]
    None,
    /// Runs that did not reach their goal.
    Failures,
    /// All runs.
    All,
}

impl Keep {
    /// All names.
    pub const NAMES: [&str; 3] = ["none", "failures", "all"];

    /// Finds a choice by its name; `None` if there is no such choice.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "none" => Some(Self::None),
            "failures" => Some(Self::Failures),
            "all" => Some(Self::All),
            _ => None,
        }
    }

    /// True if the record of a run that ended so is stored.
    pub(super) fn wants(self, outcome: EpisodeOutcome) -> bool {
        match self {
            Self::None => false,
            Self::Failures => outcome != EpisodeOutcome::Reached,
            Self::All => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_have_names() {
        let named = Keep::NAMES.map(|name| Keep::by_name(name).unwrap());
        assert_eq!(named, [Keep::None, Keep::Failures, Keep::All]);
        assert_eq!(Keep::by_name("some"), None);
        let wants = |outcome| named.map(|keep| keep.wants(outcome));
        assert_eq!(wants(EpisodeOutcome::Reached), [false, false, true]);
        assert_eq!(wants(EpisodeOutcome::Stuck), [false, true, true]);
    }
}
