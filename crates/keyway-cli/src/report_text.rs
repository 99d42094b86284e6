//! The reports of the library, for people and as files.

use crate::smoothing_targets::SmoothingTargets;
use keyway::plan::Relaxed;
use keyway::smooth::SharpCorner;
use keyway_lab::table::quantity;
use keyway_sim::report::{PlanPart, SmoothedPart};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Display;

/// A report, and the files that were written beside it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct WithFiles<'a, R> {
    #[serde(flatten)]
    pub(crate) report: &'a R,
    /// Their paths, in the order in which they were written.
    pub(crate) files: &'a [String],
}

/// The text about a constraint that was lowered.
pub(crate) fn lowered(plan: &PlanPart) -> Option<(&'static str, String)> {
    plan.relaxed.map(|Relaxed { asked_m, used_m }| {
        let text =
            format!("lowered from {asked_m:.3} m to {used_m:.3} m, the largest that leaves a path");
        ("constraint", text)
    })
}

/// The text about a smoothed path.
pub(crate) fn smoothed_facts(
    part: &SmoothedPart,
    targets: SmoothingTargets,
) -> Vec<(&'static str, String)> {
    let mut facts = vec![
        ("smoothed length", quantity(Some(part.length_m), 3, "m")),
        ("smoothed turns", format!("{}, {} not smooth", part.turns, part.non_smooth_turns)),
        ("smoothed turning angle", quantity(Some(part.turning_angle_deg), 1, "deg")),
        ("smoothed clearance", quantity(part.min_clearance_m, 3, "m")),
    ];
    if let Some(time_s) = part.time_s {
        facts.push(("smoothing time", quantity(Some(time_s * 1e3), 3, "ms")));
    }
    facts.extend(not_kept(targets, part.shortfall_m));
    let points = format!("{} removed, {} inserted", part.removed_points, part.inserted_points);
    facts.push(("points", points));
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for SharpCorner { at, why } in &part.sharp_corners {
        places
            .entry(targets.why_sharp(*why))
            .or_default()
            .push(format!("({:.3}, {:.3})", at.x, at.y));
    }
    for (why, places) in places {
        let more = if places.len() > 1 {
            format!(" and {} more", places.len() - 1)
        } else {
            String::new()
        };
        facts.push(("sharp corners", format!("{why}: {}{more}", places[0])));
    }
    facts
}

/// The text about a distance that is not kept.
pub(crate) fn not_kept(
    target: impl Display,
    shortfall_m: Option<f64>,
) -> Option<(&'static str, String)> {
    shortfall_m.map(|kept_m| ("not kept", format!("{target}, only {kept_m:.3} m")))
}
