//! Facts about a path, each with its name.

use super::smoothing_targets::SmoothingTargets;
use crate::table::quantity;
use keyway::plan::Relaxed;
use keyway::smooth::SharpCorner;
use keyway_sim::report::{PlanPart, SmoothedPart};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Text about a constraint that was lowered.
pub(super) fn lowered(plan: &PlanPart) -> Option<(&'static str, String)> {
    plan.relaxed.map(|Relaxed { asked_m, used_m, .. }| {
        let text =
            format!("lowered from {asked_m:.3} m to {used_m:.3} m, the largest value with a path");
        ("constraint", text)
    })
}

/// Texts about a smoothed path.
pub(super) fn smoothed_facts(
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
    facts.extend(not_kept(targets, part.kept_clearance_m));
    let points = format!("{} removed, {} inserted", part.removed_points, part.inserted_points);
    facts.push(("points", points));
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for SharpCorner { at, why, .. } in &part.sharp_corners {
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

/// Text about a distance that is not kept.
pub(super) fn not_kept(
    target: impl Display,
    kept_clearance_m: Option<f64>,
) -> Option<(&'static str, String)> {
    kept_clearance_m.map(|kept_m| ("not kept", format!("{target}, only {kept_m:.3} m")))
}
