//! Planners that were left out of a comparison of all planners, with the reasons.

use super::Compared;
use keyway::plan::PlanError;
use serde::Serialize;

/// A planner that cannot plan on a map, whatever the query.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    planner: &'static str,
    reason: String,
}

impl LeftOut {
    /// True if the error is caused by the map, and not by a parameter.
    pub(super) const fn is_for(error: &PlanError) -> bool {
        matches!(error, PlanError::NeedsUniformCost { .. } | PlanError::Preparation(_))
    }

    pub(super) fn new(planner: &'static str, error: &PlanError) -> Self {
        let reason = match error {
            // The text is the same for every such planner.
            PlanError::NeedsUniformCost { .. } => {
                "needs one cost for all cells; treat unknown cells as blocked or free".to_owned()
            }
            error => error.to_string(),
        };
        Self { planner, reason }
    }
}

/// Text below the table; `None` if all planners were compared.
pub fn left_out_note(maps: &[Compared]) -> Option<String> {
    let lines: Vec<String> =
        maps.iter().flat_map(|map| lines(&map.name, &map.contest.left_out)).collect();
    (!lines.is_empty()).then(|| format!("\nLeft out:\n  {}", lines.join("\n  ")))
}

/// One line for all planners with the same reason.
fn lines(map: &str, left_out: &[LeftOut]) -> Vec<String> {
    let mut reasons: Vec<&str> = Vec::new();
    for one in left_out {
        if !reasons.contains(&one.reason.as_str()) {
            reasons.push(&one.reason);
        }
    }
    let line = |reason: &str| {
        let planners = left_out.iter().filter(|one| one.reason == reason).map(|one| one.planner);
        format!("{map}: {}: {reason}", planners.collect::<Vec<_>>().join(", "))
    };
    reasons.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planners_share_a_line_by_reason() {
        let one = |planner, reason: &str| LeftOut { planner, reason: reason.to_owned() };
        let left_out = [one("jps", "a"), one("prepared", "b"), one("rrt", "a")];
        assert_eq!(lines("m", &left_out), ["m: jps, rrt: a", "m: prepared: b"]);
    }
}
