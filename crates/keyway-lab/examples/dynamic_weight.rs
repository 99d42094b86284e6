//! Effect of the dynamic weight of [ZhuYin2024] on empty maps: a table of nodes expanded and of
//! lengths, for `docs/lab/findings.md`.
//!
//! `cargo run --release -p keyway-lab --example dynamic_weight`

use keyway::geometry::Pose;
use keyway::map::{Cell, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{GlobalPlanner, Hsta, HstaConfig, Plan, Weight};
use keyway::search::{Query, Workspace};
use std::error::Error;

/// Cells of 1 m along each side of the maps.
const SIDES: [i32; 3] = [42, 200, 1024];
/// Distance of the last goal from the corner \[cells\].
const MOST_SHORT: i32 = 10;

/// Nodes expanded and length \[m\] of one path.
type Answer = (u64, f64);

fn measure(weight: Weight, side: i32, goals: &[Cell]) -> Result<Vec<Answer>, Box<dyn Error>> {
    let frame = GridFrame::new(side as u64, side as u64, 1.0, Pose::default())?;
    let map = SearchMap::new(&OccupancyGrid::all_free(frame), LayerConfig::default())?;
    let hsta = Hsta::new(HstaConfig { weight, ..HstaConfig::PAPER })?;
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let mut ask = |&goal: &Cell| {
        let query = Query::new(Cell::new(0, 0), goal);
        hsta.plan_into(&map, &query, &mut workspace, None, &mut plan)?;
        Ok((plan.statistics.expanded(), plan.cost.cells()))
    };
    goals.iter().map(&mut ask).collect()
}

/// The least and the largest of some numbers.
fn range(values: impl Iterator<Item = f64> + Clone, digits: usize) -> String {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let largest = values.fold(f64::NEG_INFINITY, f64::max);
    format!("{least:.digits$} to {largest:.digits$}")
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| cells | query | expanded: `weight=dynamic` (the paper) | `weight=one` | length \\[m\\]: dynamic | one |"
    );
    println!("|---|---|--:|--:|--:|--:|");
    for side in SIDES {
        let far = side - 1;
        // The first goal is the opposite corner; the others are short of it along both borders.
        let short =
            (1..=MOST_SHORT).flat_map(|k| [Cell::new(far - k, far), Cell::new(far, far - k)]);
        let goals: Vec<Cell> = std::iter::once(Cell::new(far, far)).chain(short).collect();
        let [dynamic, one] =
            [measure(Weight::Dynamic, side, &goals)?, measure(Weight::One, side, &goals)?];
        println!(
            "| {side} x {side} | corner to corner | {} | {} | {:.1} | {:.1} |",
            dynamic[0].0, one[0].0, dynamic[0].1, one[0].1
        );
        let expanded = |answers: &[Answer]| range(answers.iter().map(|answer| answer.0 as f64), 0);
        let length = |answers: &[Answer]| range(answers.iter().map(|answer| answer.1), 1);
        println!(
            "| | to all {} goals | {} | {} | {} | {} |",
            goals.len(),
            expanded(&dynamic),
            expanded(&one),
            length(&dynamic),
            length(&one)
        );
    }
    Ok(())
}
